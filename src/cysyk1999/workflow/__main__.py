"""Do one job: ``python -m cysyk1999.workflow MODULE:FUNCTION --log FILE --KEY WORD ... --KEY WORD
...``

The function takes the words by their keys. Everything printed goes into the log; if the job fails,
its last line is also shown where the workflow was started.
"""

from __future__ import annotations

import os
import sys
import traceback
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace


def main(words: list[str]) -> int:
    """Run a job and return its exit code."""
    (module, name), words = words[0].split(":"), words[1:]
    keys: dict[str, list[str]] = {}
    for word in words:
        if word.startswith("--"):
            values = keys.setdefault(word[2:], [])
        else:
            values.append(word)
    (log,) = keys.pop("log")
    terminal = os.fdopen(os.dup(2), "w")
    with open(log, "w", encoding="utf-8") as stream:
        os.dup2(stream.fileno(), 1)
        os.dup2(stream.fileno(), 2)
    try:
        getattr(import_module(module), name)(SimpleNamespace(**keys))
    except KeyboardInterrupt:
        return 130
    except Exception as error:  # noqa: BLE001 - whatever it is, it is shown
        cause = str(error) if isinstance(error, ValueError) else f"{type(error).__name__}: {error}"
        traceback.print_exc()
        rule = Path(log).stem
        print(f"{rule}: {' '.join(cause.split())} (all of it: {log})", file=terminal, flush=True)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

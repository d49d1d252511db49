"""What a process is given, and what it need not do."""

import atexit
import contextlib
import gc
import os
import sys
from collections.abc import Iterator

SPARSE = 20_000
"""Objects made between two searches for unreachable ones: with Python's own 700 they take a tenth
of a short run's time.
"""


def collect_seldom() -> None:
    """Look for unreachable objects seldom, and not at all when the process ends: all that it has
    goes then anyway.
    """
    gc.set_threshold(SPARSE)
    atexit.unregister(gc.freeze)
    atexit.register(gc.freeze)


@contextlib.contextmanager
def waiting(text: str) -> Iterator[None]:
    """A line and a spinner on a terminal's standard error, or in a notebook, while something takes
    long; elsewhere nothing.
    """
    from rich.console import Console
    from rich.errors import LiveError

    console = Console(stderr=True)
    if not (console.is_terminal or console.is_jupyter):
        yield
        return
    with contextlib.ExitStack() as stack:
        try:
            stack.enter_context(console.status(text))
        except LiveError:  # there is a progress bar already
            print(text, file=sys.stderr)
        yield


def threads() -> int:
    """How many threads the process was given, by OMP_NUM_THREADS: one unless told otherwise."""
    given = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return max(int(given), 1) if given.isdecimal() else 1

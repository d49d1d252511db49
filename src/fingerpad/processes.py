"""What a process shows while it waits, and the threads it was given."""

import contextlib
import os
import sys
from collections.abc import Iterator

from rich.console import Console
from rich.errors import LiveError


@contextlib.contextmanager
def waiting(text: str) -> Iterator[None]:
    """Show a line and a spinner on a terminal's standard error, or in a notebook."""
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

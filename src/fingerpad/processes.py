"""What a process shows while it waits or works, and the threads it was given."""

import contextlib
import os
import sys
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from rich.console import Console
from rich.errors import LiveError
from rich.markup import escape
from rich.progress import BarColumn, Progress, ProgressColumn, TextColumn


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


@contextlib.contextmanager
def progress_bar(
    name: str, quiet: bool, *columns: ProgressColumn, total: float | None = None, **fields: Any
) -> Iterator[Callable[..., None] | None]:
    """Show a bar on a terminal's standard error.

    Yields a function that takes what changes of its task (completed, total, ``fields``); None where
    there is no bar.
    """
    if quiet or not sys.stderr.isatty():
        yield None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), *columns)
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, speed_estimate_period=120) as progress:
        yield partial(progress.update, progress.add_task(escape(name), total=total, **fields))


@contextlib.contextmanager
def told_in_a_notebook(
    progress: Callable[[dict[str, Any]], None] | None,
) -> Iterator[Callable[[dict[str, Any]], None] | None]:
    """What is told of each step of a run: `progress`, or, if that is None in a notebook, a bar."""
    if progress or not Console().is_jupyter:
        yield progress
        return
    from IPython.display import ProgressBar  # who runs a notebook has it

    bar = ProgressBar(100)
    bar.display()

    def after_step(state: dict[str, Any]) -> None:
        done = int(100 * state["time_s"] / state["end_time_s"])
        if done != bar.progress:
            bar.progress = done

    yield after_step
    bar.progress = bar.total  # a run in which no time passes has no share of it


def threads() -> int:
    """How many threads the process was given, by OMP_NUM_THREADS: one unless told otherwise."""
    given = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return max(int(given), 1) if given.isdecimal() else 1

"""The process: how many threads it was given, and how seldom it looks for objects that nothing can reach."""

import gc
import os

SELDOM = 100_000
"""Objects made between two searches: with Python's own 700 they take a tenth of the time of what is soon over."""


def threads() -> int:
    """From OMP_NUM_THREADS: one unless told otherwise."""
    given = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return max(int(given), 1) if given.isdecimal() else 1


def collect_seldom() -> None:
    """Search no more often than after `SELDOM` objects."""
    gc.set_threshold(SELDOM)

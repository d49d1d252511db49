"""What a process is given, and what it need not do."""

import atexit
import gc
import os

SPARSE = 20_000
"""Objects made between two searches for unreachable ones: with Python's own 700 they take a tenth of a short run's time."""


def collect_seldom() -> None:
    """Look for unreachable objects seldom, and not at all when the process ends: all that it has goes then anyway."""
    gc.set_threshold(SPARSE)
    atexit.unregister(gc.freeze)
    atexit.register(gc.freeze)


def threads() -> int:
    """How many threads the process was given, by OMP_NUM_THREADS: one unless told otherwise."""
    given = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return max(int(given), 1) if given.isdecimal() else 1

"""How many threads the process was given."""

import os


def threads() -> int:
    """From OMP_NUM_THREADS: one unless told otherwise."""
    given = os.environ.get("OMP_NUM_THREADS", "").split(",")[0]
    return max(int(given), 1) if given.isdecimal() else 1

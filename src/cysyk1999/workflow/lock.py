"""Locks of a working directory that a killed Snakemake left behind."""

from __future__ import annotations

from pathlib import Path
from typing import IO

_held: list[IO] = []


def take_over(folder: str | Path = ".snakemake") -> int:
    """Remove the locks in `folder` if whoever set them is dead, and return how many these were.

    Every Snakemake of this workflow keeps a file of the folder locked while it lives, and the
    kernel lets go of it whatever ends the process. So if that lock is to be had, what else is
    locked is nobody's. Held until this process ends.
    """
    try:
        import fcntl
    except ImportError:  # elsewhere than on POSIX: snakemake --unlock
        return 0
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    alive = (folder / "alive").open("w")
    try:
        fcntl.flock(alive, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        alive.close()
        return 0
    _held.append(alive)
    stale = list((folder / "locks").glob("*.lock"))
    for lock in stale:
        lock.unlink(missing_ok=True)
    return len(stale)

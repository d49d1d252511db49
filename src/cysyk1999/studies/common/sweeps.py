"""Sweeps that a study runs, in folders of their own."""

from __future__ import annotations

import os
from pathlib import Path

from fingerpad.sweeps.engine import held, lay_out, run_layout
from fingerpad.sweeps.language import Read


def run_on_all_cores(read: Read, folder: Path) -> None:
    """Run a sweep in a folder; scenes that are there are not run again."""
    cores = len(os.sched_getaffinity(0))
    with held(folder) as lock:
        run_layout(lay_out(read, folder, cores), cores, lock=lock)

"""A published sweep, run by the rules of sweeps."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

from fingerpad.sweeps.engine import held, lay_out, run_layout
from fingerpad.sweeps.language import load_sweep


def run_sweep(job: SimpleNamespace) -> None:
    """`sweep` (YAML) -> `dataset`, in a folder of its own; scenes that are there are not run
    again.
    """
    folder, cores = Path(job.dataset[0]).parent, len(os.sched_getaffinity(0))
    with held(folder) as lock:
        run_layout(lay_out(load_sweep(job.sweep[0]), folder, cores), cores, lock=lock)

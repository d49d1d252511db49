"""A sweep from its file: its scenes in batches on all cores, by the rules of sweeps."""

import os
from pathlib import Path

from fingerpad.sweeps.engine import held, lay_out, run_layout
from fingerpad.sweeps.language import load_sweep


def run(job):
    """`sweep` (YAML) -> `dataset`, in a folder of its own, where what is there already is not run
    again.
    """
    folder, cores = Path(job.dataset[0]).parent, len(os.sched_getaffinity(0))
    with held(folder) as lock:
        run_layout(lay_out(load_sweep(job.sweep[0]), folder, cores), cores, lock=lock)

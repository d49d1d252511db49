"""A published sweep, run by the rules of sweeps."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

from cysyk1999.studies.common.sweeps import run_on_all_cores
from fingerpad.sweeps.language import load_sweep


def run_sweep(job: SimpleNamespace) -> None:
    """`sweep` (YAML) -> `dataset`, in a folder of its own."""
    run_on_all_cores(load_sweep(job.sweep[0]), Path(job.dataset[0]).parent)

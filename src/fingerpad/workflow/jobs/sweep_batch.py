"""Scenes of a sweep, one after the other in one process."""

from pathlib import Path

from fingerpad.sweeps.batch import run_batch


def run(job):
    """`todo` -> `records`."""
    run_batch(Path(job.todo[0]), Path(job.records[0]))

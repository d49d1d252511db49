"""A stroke with another height of the ridges or coefficient of friction, or on another mesh -> its
histories.
"""

from pathlib import Path

from cysyk1999.studies.ridges.run import Case, run_case
from fingerpad import load_scene
from fingerpad.results import write_history


def run(job):
    """`scene` -> `histories`, whose folders name the cases."""
    for history in map(Path, job.histories):
        write_history(run_case(load_scene(job.scene[0]), Case.named(history.parent.name)), history)

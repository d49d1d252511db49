"""The thesis's scenes, read otherwise in one thing -> the verdicts on its statements of those runs."""

from pathlib import Path

from fingerpad.publishing.write import write_frame
from fingerpad.studies.explanations.run import READINGS, simulated, verdicts


def run(job):
    """The readings `names` of the scenes in the folder `scenes`, which share their runs, the table `reference` -> `data`."""
    histories = simulated(Path(job.scenes[0]), READINGS[job.names[0]])
    for name, data in zip(job.names, job.data, strict=True):
        write_frame(verdicts(histories, READINGS[name], job.reference[0]), Path(data))

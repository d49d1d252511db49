"""The thesis's scenes, read otherwise in one thing -> the verdicts on its statements of those
runs.
"""

from pathlib import Path

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.explanations.run import READINGS, simulated, verdicts


def run(job):
    """The reading `name` of the scenes in the folder `scenes`, the table `reference` -> `data`."""
    reading = READINGS[job.name[0]]
    write_frame(
        verdicts(simulated(Path(job.scenes[0]), reading), reading, job.reference[0]),
        Path(job.data[0]),
    )

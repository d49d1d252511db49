"""Published runs, read otherwise in one thing -> the verdicts on the thesis's statements."""

from pathlib import Path

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.explanations.run import READINGS, verdicts


def run(job):
    """The readings `names` of all `histories`, the table `reference` -> `data`."""
    histories, _, _ = read_results(job.histories)
    for name, data in zip(job.names, job.data, strict=True):
        write_frame(verdicts(histories, READINGS[name], job.reference[0]), Path(data))

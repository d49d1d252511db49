"""A method, and a part of the hard cases -> these solved with it, and what was measured."""

from pathlib import Path

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.stability.run import study


def run(job):
    """`method`, `part` (such as 1/4) -> `data`."""
    part, parts = map(int, job.part[0].split("/"))
    write_frame(study(job.method[0].replace("_", " "), part, parts), Path(job.data[0]))

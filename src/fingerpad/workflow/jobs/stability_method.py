"""A method -> every hard case solved with it, and what was measured."""

from pathlib import Path

from fingerpad.publishing.write import write_frame
from fingerpad.studies.stability.run import study


def run(job):
    """`method` -> `data`."""
    write_frame(study(job.method[0].replace("_", " ")), Path(job.data[0]))

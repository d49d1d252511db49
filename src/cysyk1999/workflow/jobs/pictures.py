"""Data of a study -> its pictures, and the plotted data beside each."""

import importlib
from pathlib import Path

from cysyk1999.publishing.write import publish, read_frame


def run(job):
    """Each of `data` (CSV) -> that of `pictures` in its place, by what `STUDIES` of the module
    `study` has under its name.
    """
    studies = importlib.import_module(job.study[0]).STUDIES
    for data, picture in zip(job.data, job.pictures, strict=True):
        frame, name = read_frame(Path(data)), Path(picture).stem
        publish(studies[name if name in studies else Path(data).stem](frame), frame, picture)

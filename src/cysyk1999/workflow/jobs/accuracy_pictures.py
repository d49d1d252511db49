"""A table of the study of accuracy -> pictures, and the plotted data beside each."""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish
from cysyk1999.studies.accuracy.errors import FRAMES
from cysyk1999.studies.accuracy.picture import STUDIES


def run(job):
    """`table` -> `pictures`."""
    table = pd.read_csv(job.table[0], dtype={"scene": str, "accuracy": str})
    for picture in map(Path, job.pictures):
        frame = FRAMES[picture.stem](table)
        publish(STUDIES[picture.stem](frame), frame, picture)

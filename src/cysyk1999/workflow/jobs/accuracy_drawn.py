"""Scenes drawn at random from a class of stimulus -> what their runs believe of their error, and
the truth.
"""

import tempfile
from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.drawn import beliefs, drawn


def run(job):
    """`kind`, the class -> `rows` (CSV) of all its scenes."""
    with tempfile.TemporaryDirectory() as folder:
        scenes = [(name, kind, document) for name, kind, document in drawn() if kind == job.kind[0]]
        rows = [row for scene in scenes for row in beliefs(*scene, Path(folder))]
    write_frame(pd.DataFrame(rows), Path(job.rows[0]))

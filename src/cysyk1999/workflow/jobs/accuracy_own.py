"""Presses on meshes of every kind of element that users bring -> what they are wrong by, and the
largest errors.
"""

import tempfile
from pathlib import Path

from cysyk1999.publishing.write import publish_table, write_frame
from cysyk1999.studies.accuracy.own import measured, table
from fingerpad import load_scene


def run(job):
    """`scene`, one of the family -> `rows` and `table`."""
    with tempfile.TemporaryDirectory() as folder:
        rows = measured(load_scene(job.scene[0]), Path(folder))
    write_frame(rows, Path(job.rows[0]))
    publish_table(table(rows), job.table[0])

"""Strokes drawn at random over plates or over waves -> what they are wrong by on every mesh and
with every length of steps.
"""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.strokes import stroke_errors, strokes


def run(job):
    """`over`, what is stroked -> `rows` (CSV) of all strokes."""
    over = job.over[0]
    rows = [
        row for name, scene in strokes(over).items() for row in stroke_errors(over, name, scene)
    ]
    write_frame(pd.DataFrame(rows), Path(job.rows[0]))

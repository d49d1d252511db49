"""Errors of single strokes -> the table of strokes that the planner goes by."""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish_table, read_frame
from cysyk1999.studies.accuracy.strokes import strokes_table


def run(job):
    """`parts` (CSV), one below the other -> `table`."""
    publish_table(
        strokes_table(pd.concat([read_frame(Path(part)) for part in job.parts], ignore_index=True)),
        job.table[0],
    )

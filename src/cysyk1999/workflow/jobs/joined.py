"""Parts of a table -> the table."""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish_table, read_frame


def run(job):
    """`parts` (CSV), one below the other -> `table`."""
    publish_table(
        pd.concat([read_frame(Path(part)) for part in job.parts], ignore_index=True), job.table[0]
    )

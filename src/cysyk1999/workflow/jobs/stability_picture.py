"""What the methods did -> the picture, the plotted data beside it, and the table."""

import pandas as pd

from cysyk1999.publishing.write import publish, publish_table
from cysyk1999.studies.stability.picture import assemble, heat_map, long, table


def run(job):
    """`methods` (CSV) -> `picture`, `table`."""
    frame = assemble([pd.read_csv(path) for path in job.methods])
    publish_table(table(frame), job.table[0])
    data = long(frame)
    publish(heat_map(data), data, job.picture[0])

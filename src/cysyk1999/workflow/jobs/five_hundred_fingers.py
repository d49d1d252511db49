"""The table of the sweep -> the picture of five hundred fingers, and what each measure is sensitive
to.
"""

import pandas as pd

from cysyk1999.publishing.write import publish, publish_table
from cysyk1999.studies.five_hundred_fingers.picture import fingers, frame_of, table_of


def run(job):
    """`scenes` (CSV) -> `picture`, its data beside it, `table`."""
    frame = frame_of(pd.read_csv(job.scenes[0]))
    publish_table(table_of(frame), job.table[0])
    publish(fingers(frame), frame, job.picture[0])

"""The table of the sweep -> the map of touch."""

import pandas as pd

from cysyk1999.publishing.write import publish
from cysyk1999.studies.map_of_touch.picture import contours, frame_of


def run(job):
    """`scenes` (CSV) -> `picture`, its data beside it."""
    frame = frame_of(pd.read_csv(job.scenes[0]))
    publish(contours(frame), frame, job.picture[0])

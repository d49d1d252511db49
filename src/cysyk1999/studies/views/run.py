"""The views: of which scenes each is, its data and how it is drawn; the job that draws them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.tables import without_round_off
from cysyk1999.publishing.write import publish
from cysyk1999.studies.views import frames, picture
from cysyk1999.studies.views.storyboard import storyboard, storyboard_rows

FRAMES = {
    "overview": (frames.overview, ("fields_k210",)),
    "fields": (frames.fields, ("fields_flat", "fields_k210", "fields_k1260")),
    "space_time": (frames.space_time, (frames.STROKE,)),
    "stick_slip": (frames.stick_slip, (frames.STROKE,)),
    "stroke_storyboard": (storyboard_rows, (frames.STROKE,)),
}
"""View -> its frame and the scenes it is of."""
VIEWS: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "overview": picture.overview,
    "fields": picture.fields,
    "space_time": picture.space_time,
    "stick_slip": picture.stick_slip,
    "stroke_storyboard": storyboard,
}
"""View -> how it is drawn of its data frame."""


def draw_views(job: SimpleNamespace) -> None:
    """Job: `histories` -> `pictures`, named as in VIEWS."""
    histories, _, _ = read_results(job.histories)
    for path in job.pictures:
        name = Path(path).stem
        frame = without_round_off(FRAMES[name][0](histories))
        publish(VIEWS[name](frame), frame, path)

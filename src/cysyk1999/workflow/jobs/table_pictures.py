"""Tables -> the pictures of them, and the plotted data beside each."""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.views import picture as views


def run(job):
    """`tables`, `reference` -> `pictures`: scorecard of thesis_comparison, candidate_stimuli of the
    table of that name.
    """
    tables = {Path(path).stem: pd.read_csv(path) for path in job.tables}
    for path in job.pictures:
        if Path(path).stem == "scorecard":
            frame, draw = (
                views.scorecard_rows(tables["thesis_comparison"], read_reference(job.reference[0])),
                views.scorecard,
            )
        else:
            frame, draw = views.candidate_rows(tables["candidate_stimuli"]), views.candidate_stimuli
        publish(draw(frame), frame, path)

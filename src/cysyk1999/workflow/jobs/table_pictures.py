"""Tables -> the pictures of them, and the plotted data beside each."""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.views import tables as views


def run(job):
    """`tables`, `reference` -> `pictures`: scorecard of thesis_comparison, candidate_stimuli of the
    table of that name.
    """
    tables = {Path(path).stem: pd.read_csv(path) for path in job.tables}
    for path in job.pictures:
        if Path(path).stem == "scorecard":
            reference = read_reference(job.reference[0])
            frame = views.scorecard_rows(tables["thesis_comparison"], reference)
            publish(views.scorecard(frame), frame, path)
        else:
            frame = views.candidate_rows(tables["candidate_stimuli"])
            publish(views.candidate_stimuli(frame), frame, path)

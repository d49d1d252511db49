"""Strokes with several coefficients and the thesis's stretch of the skin -> the coefficient of
friction, how certain.
"""

from pathlib import Path

import pandas as pd

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import without_round_off, write_frame
from cysyk1999.reference_data import read_friction
from cysyk1999.studies.calibration.friction import calibrate_friction


def run(job):
    """`sweep`, `histories`, the tables `thesis` and `published` -> `data`: friction,
    friction_estimates.
    """
    histories, sweep = read_results(job.histories)[0], read_results(job.sweep)[0].values()
    result = calibrate_friction(
        sweep, histories, pd.read_csv(job.thesis[0]), read_friction(job.published[0])
    )
    for path, frame in zip(job.data, result, strict=True):
        write_frame(without_round_off(frame), Path(path))

"""Strokes with several coefficients and the thesis's stretch of the skin -> the coefficient of friction, how certain."""

from pathlib import Path

import pandas as pd

from fingerpad.measures.inputs import read_coarse, read_results
from fingerpad.publishing.write import without_round_off, write_frame
from fingerpad.reference_data import read_friction
from fingerpad.studies.calibration.friction import calibrate_friction


def run(job):
    """`sweep`, `histories`, `coarse`, the tables `thesis` and `published` -> `data`: friction, friction_estimates."""
    histories, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    sweep, published = read_results(job.sweep)[0].values(), read_friction(job.published[0])
    result = calibrate_friction(sweep, histories, coarse, pd.read_csv(job.thesis[0]), published)
    for path, frame in zip(job.data, (result.friction, result.estimates), strict=True):
        write_frame(without_round_off(frame), Path(path))

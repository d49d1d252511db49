"""Calibrate friction: calibrate_friction.py THESIS_NUMBERS.csv FRICTION.csv OUT/friction.csv HISTORY.nc ...

Writes friction.csv and friction_estimates.csv side by side. Histories in a folder "friction" are those of the sweep.
"""

import sys
from pathlib import Path

import pandas as pd

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import write_frame
from fingerpad.reference_data import ReferenceDataError, read_friction
from fingerpad.studies.calibration.friction import calibrate_friction

thesis, published, out, *paths = sys.argv[1:]
sweep = [path for path in paths if Path(path).parent.parent.name == "friction"]
histories, _, coarse = read_results(path for path in paths if path not in sweep)
try:
    published = read_friction(published)
except ReferenceDataError as error:
    sys.exit(str(error))
result = calibrate_friction(read_results(sweep)[0].values(), histories, coarse, pd.read_csv(thesis), published)
write_frame(result.friction, Path(out))
write_frame(result.estimates, Path(out).with_name("friction_estimates.csv"))

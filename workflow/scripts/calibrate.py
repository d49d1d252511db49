"""Fit the constant on the moduli: calibrate.py FORCE_DEPTH_DIR OUT/fit.csv SPECIMENS_DIR HISTORY.nc ...

Writes fit.csv, identifiability.csv, residuals.csv and estimates.csv side by side, and the calibrated specimens.
"""

import json
import sys
from pathlib import Path

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import write_frame
from fingerpad.reference_data import ReferenceDataError, read_force_depth
from fingerpad.studies.calibration.force import calibrate, write_specimens

folder, out, specimens, *paths = sys.argv[1:]
histories, _, coarse = read_results(paths)
try:
    data = read_force_depth(folder)
except ReferenceDataError as error:
    sys.exit(str(error))
result = calibrate(histories, coarse, data)
for name in ("fit", "identifiability", "residuals", "estimates"):
    write_frame(getattr(result, name), Path(out).with_name(f"{name}.csv"))
scene = json.loads(histories["calibration_plate"].attrs["scene"])
write_specimens(specimens, result, scene["specimen"], data)

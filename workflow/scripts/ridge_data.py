"""Data of the study of ridges: ridge_data.py OUT/offset.csv HISTORY.nc ...

Writes offset.csv, height.csv, friction.csv, mesh.csv and outer.csv side by side. Histories in a folder "ridges" are the cases'.
"""

import sys
from pathlib import Path

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import write_frame
from fingerpad.studies.ridges.frames import frames

out, *paths = sys.argv[1:]
cases = [path for path in paths if Path(path).parent.parent.name == "ridges"]
strokes, _, coarse = read_results(path for path in paths if path not in cases)
for name, frame in frames(read_results(cases)[0], strokes, coarse).items():
    write_frame(frame, Path(out).with_name(f"{name}.csv"))

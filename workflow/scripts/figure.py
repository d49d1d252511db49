"""Draw a figure from results: figure.py NUMBER REFERENCE.csv FIGURE.png [HISTORY.nc | MESH.msh ...]"""

import sys
from pathlib import Path

from fingerpad.figures import FIGURES, publish, read_reference
from fingerpad.figures.inputs import read_results

number, reference, png, *paths = sys.argv[1:]
spec = FIGURES[number]
frame = spec.frame(*read_results(paths), read_reference(reference), *spec.measurements(Path(reference).parent))
publish(spec.draw(frame), frame, png)

"""Draw a figure from results: figure.py NUMBER REFERENCE.csv FIGURE.png [HISTORY.nc | MESH.msh ...]"""

import sys
from pathlib import Path

from fingerpad.figures.registry import FIGURES
from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish
from fingerpad.reference_data import ReferenceDataError, read_reference

number, reference, png, *paths = sys.argv[1:]
spec = FIGURES[number]
try:
    measured = spec.measurements(Path(reference).parent)
except ReferenceDataError as error:
    print(error, file=sys.stderr)
    sys.exit(2)
frame = spec.frame(*read_results(paths), read_reference(reference), *measured)
publish(spec.draw(frame), frame, png)

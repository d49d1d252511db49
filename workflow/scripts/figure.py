"""Draw a figure: figure.py NUMBER REFERENCE.csv FIGURE.png [RESULTS/{simulations,coarse}/SCENE/{history.nc,mesh.msh} ...]"""

import sys

from fingerpad.figures import FIGURES, publish, read_reference
from fingerpad.figures.io import read_results

number, reference, png, *paths = sys.argv[1:]
spec = FIGURES[number]
frame = spec.frame(*read_results(paths), read_reference(reference))
publish(spec.draw(frame), frame, png)

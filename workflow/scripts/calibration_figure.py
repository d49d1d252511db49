"""Draw a figure of the calibration: calibration_figure.py NAME DATA.csv FIGURE.png"""

import sys

from fingerpad.figures.calibration import STUDIES
from fingerpad.figures.io import publish, read_frame

name, data, png = sys.argv[1:]
frame = read_frame(data)
publish(STUDIES[name](frame), frame, png)

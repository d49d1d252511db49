"""Draw a figure of the study of ridges: ridge_figure.py NAME DATA.csv FIGURE.png"""

import sys

from fingerpad.figures.io import publish, read_frame
from fingerpad.figures.ridge_study import STUDIES

name, data, png = sys.argv[1:]
frame = read_frame(data)
publish(STUDIES[name](frame), frame, png)

"""Draw a figure of the study of accuracy: accuracy_figure.py NAME TABLE.csv FIGURE.png"""

import sys

import pandas as pd

from fingerpad.figures.accuracy import STUDIES
from fingerpad.figures.io import publish
from fingerpad.studies.accuracy_errors import FRAMES

name, data, png = sys.argv[1:]
frame = FRAMES[name](pd.read_csv(data, dtype={"scene": str, "accuracy": str}))
publish(STUDIES[name](frame), frame, png)

"""Draw a figure of the study of accuracy: accuracy_figure.py NAME TABLE.csv FIGURE.png"""

import sys

import pandas as pd

from fingerpad.publishing.write import publish
from fingerpad.studies.accuracy.errors import FRAMES
from fingerpad.studies.accuracy.picture import STUDIES

name, data, png = sys.argv[1:]
frame = FRAMES[name](pd.read_csv(data, dtype={"scene": str, "accuracy": str}))
publish(STUDIES[name](frame), frame, png)

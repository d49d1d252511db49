"""Draw a figure of the calibration: calibration_figure.py NAME DATA.csv FIGURE.png"""

import sys

from fingerpad.publishing.write import publish, read_frame
from fingerpad.studies.calibration.picture import STUDIES

name, data, png = sys.argv[1:]
frame = read_frame(data)
publish(STUDIES[name](frame), frame, png)

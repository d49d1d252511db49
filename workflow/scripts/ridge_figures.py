"""Draw the figures of the study of ridges side by side: ridge_figures.py FOLDER/ridges_NAME.png DATA/NAME.csv ..."""

import sys
from pathlib import Path

from fingerpad.publishing.write import publish, read_frame
from fingerpad.studies.ridges.picture import STUDIES

png, *paths = map(Path, sys.argv[1:])
for path in paths:
    frame = read_frame(path)
    publish(STUDIES[path.stem](frame), frame, png.with_name(f"ridges_{path.stem}.png"))

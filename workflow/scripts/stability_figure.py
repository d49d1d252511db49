"""Draw and tabulate the study of stability: stability_figure.py FIGURE.png TABLE.csv METHOD.csv ..."""

import sys

import pandas as pd

from fingerpad.publishing.write import publish, publish_table
from fingerpad.studies.stability.picture import assemble, heat_map, long, table

png, csv, *methods = sys.argv[1:]
frame = assemble([pd.read_csv(path) for path in methods])
publish_table(table(frame), csv)
data = long(frame)
publish(heat_map(data), data, png)

"""Put the estimates of the calibration into one table: calibration_table.py TABLE.csv ESTIMATES.csv ..."""

import sys

import pandas as pd

from fingerpad.publishing.write import publish_table, read_frame

table, *estimates = sys.argv[1:]
publish_table(pd.concat([read_frame(path) for path in estimates], ignore_index=True), table)

"""Put the beliefs of all scenes into one table: accuracy_beliefs.py TABLE.csv ROWS.csv ..."""

import sys

import pandas as pd

from fingerpad.publishing.write import publish_table

table, *parts = sys.argv[1:]
publish_table(pd.concat([pd.read_csv(part, dtype={"accuracy": str}) for part in parts], ignore_index=True), table)

"""Make a table from the measures: table.py NAME REFERENCE.csv MEASURES.csv TABLE.csv"""

import sys

from fingerpad.claims.tables import TABLES
from fingerpad.measures.table import Measures, read_measures
from fingerpad.publishing.write import publish_table

name, reference, path, table = sys.argv[1:]
measures = read_measures(path)
publish_table(TABLES[name](Measures.in_table(measures), Measures.in_table(measures, "companion"), reference), table)

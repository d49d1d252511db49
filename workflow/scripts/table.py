"""Make a table from results: table.py NAME REFERENCE.csv TABLE.csv [HISTORY.nc | MESH.msh ...]"""

import sys

from fingerpad.claims.tables import TABLES
from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish_table

name, reference, table, *paths = sys.argv[1:]
histories, meshes, coarse = read_results(paths)
publish_table(TABLES[name](histories, coarse, meshes, reference), table)

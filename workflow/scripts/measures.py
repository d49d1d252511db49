"""Read every measure of results: measures.py MEASURES.csv [HISTORY.nc | MESH.msh ...]"""

import sys

from fingerpad.measures.inputs import read_results
from fingerpad.measures.table import measures_table, write_measures

table, *paths = sys.argv[1:]
histories, meshes, coarse = read_results(paths)
write_measures(measures_table(histories, coarse, meshes), table)

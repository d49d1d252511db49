"""Put the quality of meshes into a table: mesh_quality.py TABLE.csv MESH.msh ..."""

import sys

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish_table
from fingerpad.specimen.quality import quality_table

table, *paths = sys.argv[1:]
publish_table(quality_table(read_results(paths)[1]), table)

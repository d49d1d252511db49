"""Every number that is read of a scene, its mesh, its history and its companion -> one long
table.
"""

from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.table import measures_table, write_measures


def run(job):
    """`histories`, `meshes`, `coarse` -> `measures`."""
    histories, meshes, coarse = read_results([*job.histories, *job.meshes, *job.coarse])
    write_measures(measures_table(histories, coarse, meshes), job.measures[0])

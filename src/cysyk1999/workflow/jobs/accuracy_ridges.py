"""Pads with ridges of several sizes, pressed on more and fewer elements -> what their strain
energies are wrong by.
"""

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.accuracy.ridges import SURFACES, table
from fingerpad import load_scene


def run(job):
    """`scenes` in the order of SURFACES -> `table`."""
    publish_table(
        table(dict(zip(SURFACES, map(load_scene, job.scenes), strict=True))), job.table[0]
    )

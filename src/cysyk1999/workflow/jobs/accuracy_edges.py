"""Ramps and holds with more and less smoothing of the contact -> kinks of their curves."""

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.accuracy.edges import table
from cysyk1999.studies.accuracy.run import EDGED
from fingerpad import load_scene


def run(job):
    """`scenes` in the order of EDGED -> `table`."""
    publish_table(table(dict(zip(EDGED, map(load_scene, job.scenes), strict=True))), job.table[0])

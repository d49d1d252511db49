"""Ramps and holds with more and less smoothing of the contact -> kinks of their curves."""

from fingerpad import load_scene
from fingerpad.publishing.write import publish_table
from fingerpad.studies.accuracy.edges import table
from fingerpad.studies.accuracy.run import EDGED


def run(job):
    """`scenes` in the order of EDGED -> `table`."""
    publish_table(table(dict(zip(EDGED, map(load_scene, job.scenes), strict=True))), job.table[0])

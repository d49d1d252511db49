"""Pads with ridges of several sizes, pressed on more and fewer elements -> what their strain energies are wrong by."""

from fingerpad import load_scene
from fingerpad.publishing.write import publish_table
from fingerpad.studies.accuracy.ridges import SURFACES, table


def run(job):
    """`scenes` in the order of SURFACES -> `table`."""
    publish_table(table(dict(zip(SURFACES, map(load_scene, job.scenes), strict=True))), job.table[0])

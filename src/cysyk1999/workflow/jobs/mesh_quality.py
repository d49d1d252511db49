"""The meshes of the scenes -> a table of their quality."""

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import publish_table
from fingerpad.specimen.quality import quality_table


def run(job):
    """`meshes` -> `table`."""
    publish_table(quality_table(read_results(job.meshes)[1]), job.table[0])

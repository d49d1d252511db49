"""A press by this package and by a public one -> both answers and what they cost, in one process."""

from fingerpad.publishing.write import publish_table
from fingerpad.studies.peers import study


def run(job):
    """-> `table`."""
    publish_table(study(), job.table[0])

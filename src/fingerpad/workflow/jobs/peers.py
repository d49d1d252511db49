"""A press by this package and by public ones -> their answers and what they cost, a process each, in turn."""

from fingerpad.publishing.write import publish_table
from fingerpad.studies.peers.run import study


def run(job):
    """-> `table`."""
    publish_table(study(), job.table[0])

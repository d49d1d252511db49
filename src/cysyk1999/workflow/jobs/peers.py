"""A press by this package and by public ones -> their answers and what they cost, a process each,
in turn.
"""

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.peers.run import study


def run(job):
    """-> `table`."""
    publish_table(study(), job.table[0])

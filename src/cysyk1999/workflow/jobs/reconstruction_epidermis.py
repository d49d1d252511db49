"""The most probable pad -> what readings of 1999 could have made of the energies inside its
epidermis: a table.
"""

import pandas as pd

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.reconstruction.epidermis import best_pad, study
from cysyk1999.studies.reconstruction.evidence import Evidence, read_evidence


def run(job):
    """`evidence`, `posterior` -> `table`."""
    evidence = Evidence(read_evidence(job.evidence[0]))
    publish_table(study(best_pad(pd.read_csv(job.posterior[0])), evidence), job.table[0])

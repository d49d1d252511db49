"""Verdicts by reading -> what of the thesis's statements holds with which of them, and what each
turns: two tables.
"""

import pandas as pd

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.explanations.run import explanations, turned


def run(job):
    """`readings` by their `names`, the `comparison`, the table `reference` -> `tables`."""
    known = (
        pd.read_csv(job.comparison[0]),
        dict(zip(job.names, map(pd.read_csv, job.readings), strict=True)),
        job.reference[0],
    )
    for table, path in zip((explanations(*known), turned(*known)), job.tables, strict=True):
        publish_table(table, path)

"""Verdicts by reading -> what of the thesis's statements holds with which of them: a table."""

import pandas as pd

from fingerpad.publishing.write import publish_table
from fingerpad.studies.explanations.run import explanations


def run(job):
    """`readings` by their `names`, the `comparison`, the table `reference` -> `table`."""
    found = dict(zip(job.names, map(pd.read_csv, job.readings), strict=True))
    publish_table(explanations(pd.read_csv(job.comparison[0]), found, job.reference[0]), job.table[0])

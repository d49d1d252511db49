"""The measures of all scenes and the thesis's numbers -> the tables that are made of them."""

from pathlib import Path

from fingerpad.claims.tables import TABLES
from fingerpad.measures.table import Measures, read_measures
from fingerpad.publishing.write import publish_table


def run(job):
    """`measures`, the table `reference` -> `tables`, named as in TABLES."""
    measures = read_measures(job.measures[0])
    for table in job.tables:
        both = Measures.in_table(measures), Measures.in_table(measures, "companion")
        publish_table(TABLES[Path(table).stem](*both, job.reference[0]), table)

"""The measures of all scenes and the thesis's numbers -> the tables that are made of them, the
comparison in pages.
"""

from pathlib import Path

from cysyk1999.claims.pages import pages
from cysyk1999.claims.tables import TABLES
from cysyk1999.measures.table import Instead, Measures, read_measures
from cysyk1999.publishing.write import publish_table
from cysyk1999.reference_data import read_reference
from fingerpad.files import write_text


def run(job):
    """`measures`, the table `reference` -> `tables`, named as in TABLES."""
    measures = read_measures(job.measures[0])
    for table in job.tables:
        both = Measures.in_table(measures), Instead.in_table(measures)
        path = Path(table)
        publish_table(TABLES[path.stem](*both, job.reference[0]), path)
        if path.stem == "thesis_comparison":
            for chapter, text in pages(path, read_reference(job.reference[0])).items():
                write_text(
                    path.with_name(
                        f"{path.stem}_chapter{chapter}.md" if chapter else f"{path.stem}.md"
                    ),
                    text,
                )

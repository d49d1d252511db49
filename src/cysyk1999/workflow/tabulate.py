"""What the jobs of tables do: the comparison with the thesis, and the catalogue of its figures."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pandas as pd

from cysyk1999.claims.pages import pages
from cysyk1999.claims.said import figure_verdicts
from cysyk1999.claims.tables import TABLES
from cysyk1999.figures.catalogue import read_catalogue, readme
from cysyk1999.measures.table import Instead, Measures, read_measures
from cysyk1999.publishing.tables import publish_table
from cysyk1999.reference_data import read_reference
from fingerpad.files import write_text


def tables(job: SimpleNamespace) -> None:
    """`measures`, the table `reference` -> `tables`, named as in TABLES."""
    measures = read_measures(job.measures[0])
    for path in map(Path, job.tables):
        both = Measures.in_table(measures), Instead.in_table(measures)
        publish_table(TABLES[path.stem](*both, job.reference[0]), path)
        if path.stem == "thesis_comparison":
            for chapter, text in pages(path, read_reference(job.reference[0])).items():
                ending = f"_chapter{chapter}" if chapter else ""
                write_text(path.with_name(f"{path.stem}{ending}.md"), text)


def catalogue(job: SimpleNamespace) -> None:
    """`catalogue`, `judged` (CSV: the comparison) and `reference`, `titles` (JSON, by number) ->
    `readme`.
    """
    reference, figures = read_reference(job.reference[0]), read_catalogue(job.catalogue[0])
    verdicts = figure_verdicts(pd.read_csv(job.judged[0]), reference)
    write_text(job.readme[0], readme(figures, json.loads(job.titles[0]), verdicts))

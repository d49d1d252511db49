"""The thesis's figures, the titles of those drawn and their verdicts -> figures/README.md."""

import json

import pandas as pd

from cysyk1999.claims.comparison import holding
from cysyk1999.figures.catalogue import read_catalogue, readme
from fingerpad.files import write_text


def run(job):
    """`catalogue` and `judged` (CSV: the comparison with the thesis), `titles` (JSON, number ->
    title) -> `readme`.
    """
    judged = holding(pd.read_csv(job.judged[0]))
    write_text(
        job.readme[0], readme(read_catalogue(job.catalogue[0]), json.loads(job.titles[0]), judged)
    )

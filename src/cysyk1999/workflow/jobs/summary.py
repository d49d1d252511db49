"""Summaries of scenes -> one table: how every scene stood at the end of every leg."""

import json
from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish_table


def run(job):
    """`summaries` (summary.json of each scene) -> `table`: a row a scene and leg, units in the
    columns' names.
    """
    rows = []
    for path in map(Path, job.summaries):
        for number, leg in enumerate(json.loads(path.read_text(encoding="utf-8"))["legs"], start=1):
            plain = {
                key: value for key, value in leg.items() if not isinstance(value, (list, dict))
            }
            rows.append({"scene": path.parent.name, "leg": number} | plain)
    publish_table(pd.DataFrame(rows), job.table[0])

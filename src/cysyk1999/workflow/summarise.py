"""What the jobs of tables of all scenes do: their summaries, and the quality of their meshes."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import pandas as pd

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.tables import publish_table
from fingerpad.specimen.quality import quality_table


def summarise(job: SimpleNamespace) -> None:
    """`summaries` (summary.json of each scene) -> `table` with a row for each scene and leg."""
    rows = []
    for path in map(Path, job.summaries):
        for number, leg in enumerate(json.loads(path.read_text(encoding="utf-8"))["legs"], start=1):
            plain = {k: value for k, value in leg.items() if not isinstance(value, (list, dict))}
            rows.append({"scene": path.parent.name, "leg": number} | plain)
    publish_table(pd.DataFrame(rows), job.table[0])


def mesh_quality(job: SimpleNamespace) -> None:
    """`meshes` -> `table`."""
    publish_table(quality_table(read_results(job.meshes)[1]), job.table[0])

"""Records of a sweep -> its dataset and its table."""

import json
from pathlib import Path

from fingerpad.sweeps.collect import collect
from fingerpad.sweeps.engine import read_layout


def run(job):
    """`folder` -> `dataset` (NetCDF), `table` (CSV)."""
    layout = read_layout(job.folder[0])
    design = json.loads((layout.folder / "design.json").read_text(encoding="utf-8"))
    files = [*layout.known, *(f"batches/{name}.jsonl" for name in layout.batches)]
    collect(design, [layout.folder / name for name in files], Path(job.dataset[0]), Path(job.table[0]))

"""From the published sweep of the pad to its emulator, the page, and the table of its errors."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd

from cysyk1999.publishing.tables import publish_table
from fingerpad.documents import read_yaml
from fingerpad.emulator.explorer import page
from fingerpad.emulator.growing import grow
from fingerpad.files import write_text
from fingerpad.sweeps.engine import held, lay_out, run_layout
from fingerpad.sweeps.language import load_sweep

TOLERANCE = 0.005
"""Relative error that scenes are added until, and most scenes that are."""
MOST_ADDED = 256
UNSEEN = {"seed": 2, "samples": 500}
"""Keys of the sweep that the emulator is judged by."""
FOLDER = Path("results/sweeps")
"""Of the two sweeps; scenes that are there are not run again."""


def pad_page(job: SimpleNamespace) -> None:
    """Job: `sweep` (YAML) -> `emulator`, `page` (HTML), `table`."""
    document, cores = read_yaml(Path(job.sweep[0])), len(os.sched_getaffinity(0))
    name = Path(job.sweep[0]).stem
    swept = _swept(document, FOLDER / name, cores)
    unseen = _swept(document | UNSEEN, FOLDER / f"{name}_unseen", cores)
    made = grow(swept, TOLERANCE, scenes=MOST_ADDED, cores=cores, unseen=unseen)
    Path(job.emulator[0]).parent.mkdir(parents=True, exist_ok=True)
    made.save(job.emulator[0])
    write_text(Path(job.page[0]), page(made))
    publish_table(errors(made.about), job.table[0])


def errors(about: dict[str, Any]) -> pd.DataFrame:
    """How far an emulator is off, a row a quantity, from what it says of itself."""
    columns = {
        "scenes": "unseen scenes",
        "median": "median error (%)",
        "within_95": "95 % within (%)",
        "covered": "in the band (%)",
    }
    rows = pd.DataFrame(about["held_out"]).rename(columns=columns)
    rows[list(columns.values())[1:]] *= 100
    rows.attrs["summary"] = (
        f"The emulator of config/sweeps/pad.yaml, fitted to {about['scenes']} scenes, "
        f"{about['grown']['added']} of them added where it knew least; errors against finite "
        "element runs of the same accuracy, from the end of the press to the end of the hold."
    )
    return rows


def _swept(document: dict[str, Any], folder: Path, cores: int) -> Path:
    """Run a sweep in a folder."""
    with held(folder) as lock:
        run_layout(lay_out(load_sweep(document, folder.name), folder, cores), cores, lock=lock)
    return folder

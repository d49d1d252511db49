"""From the published sweep of the pad to its emulator, the page, and the table of its errors."""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pandas as pd

from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.common.sweeps import run_on_all_cores
from fingerpad.documents import read_yaml
from fingerpad.emulator.explorer import page
from fingerpad.emulator.growing import grow
from fingerpad.files import write_text
from fingerpad.sweeps.language import load_sweep

TOLERANCE, MOST_ADDED = 0.005, 256
"""Relative error until which scenes are added, and how many at most."""
UNSEEN = {"seed": 2, "samples": 500}
"""Keys of the sweep that the emulator is judged by."""
FOLDER = Path("results/sweeps")
"""Of the two sweeps; scenes that are there are not run again."""


def pad_page(job: SimpleNamespace) -> None:
    """Job: `sweep` (YAML) -> `emulator`, `page` (HTML), `table`."""
    document, name = read_yaml(Path(job.sweep[0])), Path(job.sweep[0]).stem
    swept, unseen = FOLDER / name, FOLDER / f"{name}_unseen"
    run_on_all_cores(load_sweep(document, name), swept)
    run_on_all_cores(load_sweep(document | UNSEEN, unseen.name), unseen)
    cores = len(os.sched_getaffinity(0))
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

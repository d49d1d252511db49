"""Tables beside the figures, each written as CSV and as Markdown."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pandas as pd

from fingerpad.figures.comparison import thesis_comparison
from fingerpad.figures.features import Histories
from fingerpad.figures.io import FLOAT_FORMAT, write_atomically, write_frame
from fingerpad.figures.sensitivity import sensitivity
from fingerpad.figures.spec import Meshes
from fingerpad.specimen.quality import quality_table


def mesh_quality(histories: Histories, coarse: Histories, meshes: Meshes, reference_csv: str | os.PathLike) -> pd.DataFrame:
    """Quality of every scene's mesh: nodes, elements, smallest edge, worst scaled Jacobian."""
    return quality_table(meshes)


TABLES: dict[str, Callable[..., pd.DataFrame]] = {
    "thesis_comparison": thesis_comparison,
    "sensitivity": sensitivity,
    "mesh_quality": mesh_quality,
}
"""Table name -> function(histories, coarse, meshes, reference_csv)."""


def markdown(frame: pd.DataFrame) -> str:
    """The table as Markdown: whole numbers in full, others to four digits, empty cells for missing values."""

    def cell(value: object) -> str:
        if isinstance(value, float):
            if value != value:
                return ""
            digits = max(4, len(f"{abs(value):.0f}")) if value.is_integer() else 4
            return f"{value:.{digits}g}"
        return "" if value is None or value is pd.NA else str(value)

    lines = ["| " + " | ".join(frame.columns) + " |", "|" + " --- |" * len(frame.columns)]
    lines += ["| " + " | ".join(cell(v) for v in row) + " |" for row in frame.itertuples(index=False)]
    return "\n".join(lines) + "\n"


def publish_table(frame: pd.DataFrame, csv_path: str | os.PathLike) -> None:
    """Write ``name.csv`` (format %s) and, beside it, ``name.md``."""
    path = Path(csv_path)
    write_frame(frame, path)
    text = markdown(frame)
    write_atomically(path.with_suffix(".md"), lambda p: p.write_text(text, encoding="utf-8"))


publish_table.__doc__ = publish_table.__doc__ % FLOAT_FORMAT

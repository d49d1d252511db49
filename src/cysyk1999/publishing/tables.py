"""Tables: frames as CSV, rounded as they are published, and as Markdown, whole or not at all.

Nothing here draws, so that what only computes does not rest on how pictures look.
"""

from __future__ import annotations

import os
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from pandas import DataFrame

from fingerpad.files import write_atomically, write_text

DIGITS, PUBLISHED_DIGITS, ERROR_DIGITS = 6, 5, 3
"""Significant digits of a number in results, of one that is published, and of its error: a page is
2100 dots wide."""
MOST_SAMPLES = 900
"""Of one curve that is published: about as many as dots across a column of a page."""
TEXT_COLUMNS = (
    "source",
    "surface",
    "phase",
    "layer",
    "panel",
    "series",
    "quantity",
    "pad",
    "convexity",
)


def without_round_off(frame: DataFrame, least: float = 1e-11) -> DataFrame:
    """The frame with zeros for what is below `least` of a column's largest, so that two machines
    publish the same bytes.
    """
    for column in frame.select_dtypes("float"):
        size = frame[column].abs()
        frame[column] = frame[column].mask(size < least * size.max(), 0.0)
    return frame


def write_frame(frame: DataFrame, path: Path, digits: int = DIGITS) -> None:
    """Write a frame as CSV, with so many significant digits."""
    form = f"%.{digits}g"
    write_atomically(
        path, lambda p: frame.to_csv(p, index=False, float_format=form, lineterminator="\n")
    )


def thinned(frame: DataFrame, most: int = MOST_SAMPLES) -> DataFrame:
    """The frame without samples that paper cannot show: of a curve of more than `most`, every n-th
    and the last.

    A curve is a run of rows with the same text whose first number that changes only rises.
    """
    text = frame.select_dtypes(exclude="number").fillna("")
    numbers = frame.select_dtypes("number")
    kept = np.ones(len(frame), dtype=bool)
    for run in np.split(np.arange(len(frame)), np.flatnonzero(text.ne(text.shift()).any(axis=1))):
        if len(run) <= most:
            continue
        steps = numbers.iloc[run].diff().iloc[1:]
        changes = steps.loc[:, steps.ne(0).any() & steps.notna().all()]
        if changes.shape[1] and (changes.iloc[:, 0] > 0).all():
            kept[run[:-1]] = np.arange(len(run) - 1) % -(-len(run) // most) == 0
    return frame[kept]


def published(frame: DataFrame) -> DataFrame:
    """What is published of a frame, and drawn: curves thinned, few digits."""
    frame = thinned(frame).copy()
    numbers = frame.select_dtypes("float").columns
    for column in numbers:
        digits = ERROR_DIGITS if column.endswith("_error (%)") else PUBLISHED_DIGITS
        frame[column] = [float(f"{x:.{digits}g}") for x in frame[column]]
    return frame


def write_published(frame: DataFrame, path: Path) -> None:
    """Write a frame as the CSV beside a picture or table."""
    write_frame(published(frame), path, PUBLISHED_DIGITS)


def read_frame(path: Path) -> DataFrame:
    """Read a figure's CSV back: text columns as text (surface "79" too), everything else as
    numbers.
    """
    return pd.read_csv(path, dtype=dict.fromkeys(TEXT_COLUMNS, str))


def markdown(frame: DataFrame) -> str:
    """The table as Markdown: whole numbers in full, others to four digits, empty cells for missing
    values.
    """

    def cell(value: object) -> str:
        if pd.isna(value):
            return ""
        if not isinstance(value, float):
            return str(value)
        digits = len(f"{abs(value):.0f}") if value.is_integer() else 0
        return f"{value:.{max(4, digits)}g}"

    rows = [frame.columns, ["---"] * len(frame.columns), *frame.map(cell).itertuples(index=False)]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def publish_table(frame: DataFrame, csv_path: str | os.PathLike) -> None:
    """Write ``name.csv`` and, beside it, ``name.md``, headed by ``frame.attrs["summary"]`` if there
    is one, with the columns that ``frame.attrs["columns"]`` names if it does.
    """
    path = Path(csv_path)
    write_published(frame, path)
    text = markdown(frame[frame.attrs.get("columns", list(frame.columns))])
    if summary := frame.attrs.get("summary"):
        text = f"{summary}\n\n{text}"
    write_text(path.with_suffix(".md"), text)


def join_tables(job: SimpleNamespace) -> None:
    """Job: `parts` (CSV), one below the other -> `table`."""
    parts = [read_frame(Path(part)) for part in job.parts]
    publish_table(pd.concat(parts, ignore_index=True), job.table[0])

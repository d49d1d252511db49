"""Measured data that the model is compared with and calibrated to: the CSV files of
``config/reference``.

Every row says where it comes from (``source``) and how it was obtained (``how_obtained``). Forces
over depth are a folder: a further subject is a further file in ``config/reference/force_depth``.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any

import pandas as pd

from fingerpad.tables import TableError
from fingerpad.tables import read_table as read_text_table

INDENTERS = ("flat plate", "flat probe 6.35 mm", "flat probe", "point probe", "cylinder")
"""Indenters that the files may name."""


class ReferenceDataError(ValueError):
    """A reference file is wrong; the message is one line: file, row and column, value, what is
    allowed.
    """


@dataclass(frozen=True)
class Column:
    """What the cells of a column may hold.

    Attributes
    ----------
    allowed
        What is allowed, in words.
    accepts
        Whether it may hold a value, a text or a finite number.
    kind
        `str` or `float`.
    optional
        Whether a cell may be empty: then its value is an empty text, or NaN.
    """

    allowed: str
    accepts: Callable[[Any], bool]
    kind: type = float
    optional: bool = False

    @property
    def or_nothing(self) -> Column:
        """The same, whose cells may be empty."""
        return replace(self, allowed=f"{self.allowed} or nothing", optional=True)

    def read(self, cell: str | float) -> str | float:
        """The value of a cell; ValueError if it is not allowed."""
        if self.optional and not cell:
            return "" if self.kind is str else math.nan
        value = self.kind(cell)
        if not self.accepts(value):
            raise ValueError
        return value


def one_of(*words: str) -> Column:
    """A column of some words."""
    return Column(", ".join(words), words.__contains__, str)


TEXT = Column("text", bool, str)
NUMBER = Column("a number", math.isfinite)
POSITIVE = Column("a number above 0", lambda number: number > 0)
NOT_NEGATIVE = Column("a number from 0", lambda number: number >= 0)

_ORIGIN = {"source": TEXT, "how_obtained": TEXT}

FORCE_DEPTH = {
    "subject": TEXT,
    "indenter": one_of(*INDENTERS),
    "depth_mm": POSITIVE,
    "speed_mm_per_s": NOT_NEGATIVE,
    "force_N": POSITIVE,
    **_ORIGIN,
}
"""Normal force at an indentation depth; a speed of 0 is the steady state."""

SURFACE_PROFILES = {
    "subject": TEXT,
    "indenter": one_of(*INDENTERS),
    "diameter_mm": POSITIVE,
    "depth_mm": POSITIVE,
    "speed_mm_per_s": NOT_NEGATIVE,
    "lateral_distance_mm": NUMBER,
    "deflection_mm": NUMBER,
    **_ORIGIN,
}
"""Deflection of the skin, downward positive, beside an indenter at a depth."""

FRICTION = {
    "kind": one_of("measured", "assumed"),
    "quantity": one_of("coefficient", "factor"),
    "contact": TEXT,
    "condition": TEXT,
    "low": POSITIVE,
    "high": POSITIVE.or_nothing,
    **_ORIGIN,
}
"""Friction coefficients of fingers, single (`high` empty) or ranges, and factors by which a
condition changes them.
"""


def read_force_depth(paths: str | Path | Iterable[str | Path]) -> pd.DataFrame:
    """Forces over depth.

    Parameters
    ----------
    paths
        A folder, all of whose CSV files are read, or files.

    Returns
    -------
    pd.DataFrame
        Columns of :data:`FORCE_DEPTH`, the files one after the other in the order of their names. A
        subject is a file and a name: a name that is in several files stands with its file, ``1
        (dandekar_2003)``.

    Raises
    ------
    ReferenceDataError
        A file is wrong, there is none, or it gives a subject's depth under an indenter at a speed
        twice.
    """
    listed = [paths] if isinstance(paths, (str, Path)) else paths
    files = [
        file
        for path in sorted(map(Path, listed))
        for file in (sorted(path.glob("*.csv")) if path.is_dir() else [path])
    ]
    if not files:
        raise ReferenceDataError(
            f"{paths}: holds no CSV file; allowed: at least one with columns "
            f"{', '.join(FORCE_DEPTH)}"
        )
    frames = [read_table(file, FORCE_DEPTH) for file in files]
    for file, frame in zip(files, frames, strict=True):
        measured = frame[["subject", "indenter", "depth_mm", "speed_mm_per_s"]]
        for row in frame.index[measured.duplicated()]:
            key = measured.loc[row]
            first = frame.index[measured.eq(key).all(axis=1)][0]
            what = "subject '{}', {}, {:g} mm, {:g} mm/s".format(*key)
            raise ReferenceDataError(
                f"{file}: row {row}: {what} is in row {first} already; allowed: each once"
            )
    files_of = Counter(subject for frame in frames for subject in frame["subject"].unique())
    for file, frame in zip(files, frames, strict=True):
        several = frame["subject"].map(files_of) > 1
        frame.loc[several, "subject"] += f" ({file.stem})"
    return pd.concat(frames, ignore_index=True)


def read_surface_profiles(path: str | Path) -> pd.DataFrame:
    """Surface profiles, columns of :data:`SURFACE_PROFILES`; `ReferenceDataError` if the file is
    wrong.
    """
    return read_table(path, SURFACE_PROFILES)


BANDS = {
    "surface": TEXT,
    "measure": TEXT,
    "unit": one_of("mm", "Pa"),
    "low": POSITIVE,
    "high": POSITIVE,
    "pads": POSITIVE,
    "source": TEXT,
}
"""What the thesis leaves open of its pad: lowest and highest of a measure among pads that show what
it shows.
"""


def read_bands(path: str | Path) -> pd.DataFrame:
    """What pads differ by that the thesis's figures do not tell apart, columns of :data:`BANDS`.

    Raises ReferenceDataError: the file is wrong, or a band is upside down.
    """
    return _upright(path, BANDS)


def read_friction(path: str | Path) -> pd.DataFrame:
    """Published friction, columns of :data:`FRICTION`; `ReferenceDataError` if the file is wrong or
    a range is upside down.
    """
    return _upright(path, FRICTION)


def _upright(path: str | Path, schema: dict[str, Column]) -> pd.DataFrame:
    """A table none of whose ranges, columns low and high, is upside down."""
    frame = read_table(path, schema)
    for row in frame.index[frame["high"] < frame["low"]]:
        low, high = frame.loc[row, ["low", "high"]]
        raise ReferenceDataError(
            f"{path}: row {row}, column high: '{high:g}'; allowed: a number from {low:g}"
            + " or nothing" * schema["high"].optional
        )
    return frame


def read_table(path: str | Path, schema: dict[str, Column]) -> pd.DataFrame:
    """A table with exactly the columns of `schema`, in any order, and at least one row.

    Raises
    ------
    ReferenceDataError
        It cannot be read (:func:`fingerpad.tables.read_table`), a column is missing or unknown, or
        a cell holds what its column does not allow.

    Returns
    -------
    pd.DataFrame
        A row for each of the file's, indexed by its number as a text editor counts.
    """
    path, columns = Path(path), ", ".join(schema)
    try:
        table = read_text_table(path)
    except TableError as error:
        raise ReferenceDataError(f"{path}: {error}") from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or type(error).__name__
        raise ReferenceDataError(
            f"{path}: cannot be read ({reason}); allowed: a CSV file in UTF-8"
        ) from None
    for name in schema:
        if name not in table.header:
            found = ", ".join(table.header)[:80]
            raise ReferenceDataError(
                f"{path}: has no column {name}, but {found}; allowed: {columns}"
            )
    for name in table.header:
        if name not in schema:
            raise ReferenceDataError(f"{path}: column '{name}' is not known; allowed: {columns}")
    if not table.rows:
        raise ReferenceDataError(f"{path}: has no rows; allowed: at least one")
    values: dict[str, list] = {name: [] for name in schema}
    for line, row in zip(table.lines, table.rows, strict=True):
        for k, (name, cell) in enumerate(zip(table.header, row, strict=True)):
            column = schema[name]
            try:
                number = cell and column.kind is float
                values[name].append(column.read(table.number(cell, line, k) if number else cell))
            except ValueError:
                raise ReferenceDataError(
                    f"{path}: row {line}, column {name}: '{cell[:60]}'; allowed: {column.allowed}"
                ) from None
    return pd.DataFrame(values, index=table.lines)


EVIDENCE = "reconstruction_evidence.csv"
"""Beside the table of printed numbers: what the pad is inferred from. Its column thesis_ids names
rows of that table.
"""


def read_reference(path: str | PathLike) -> pd.DataFrame:
    """Table of numbers printed in the thesis, indexed by id.

    Columns figure, quantity, condition, low, high, units, kind (stated | axis_range | garbled),
    form (value | range | axis | estimate | unlike: what is shown is not the model's | trend |
    layout), tolerance, tick (the last of an axis but one, if simulated curves alone set its end; 0:
    other traces set it too), role (input: stated by the thesis and by the scenes; count: of the
    model itself; calibrated: one parameter was chosen by it; result; trend; empty for a layout),
    score (none: earns nothing, the reason says why; or empty), same_as (row of the same number of
    the same curve, which alone counts), source; and how this model answers: measure (a name of
    `cysyk1999.measures.table.MEASURES`), at (its condition), of (scenes), reason (of a known
    difference, or of not being judged). An end of which two readings are possible, ``1500 or
    2000``, is the first in high and the second in or_high. A row that is named by the evidence
    beside the table (`EVIDENCE`, where it is there) has the score fitted. Raises ValueError for a
    repeated id, an unknown kind, form, role, score or row.
    """
    words = ["role", "score", "same_as", "measure", "at", "of", "reason"]
    text = dict.fromkeys(["id", "figure", "condition", "units", "high", *words], str)
    table = pd.read_csv(path, dtype=text).set_index("id")
    table[words] = table[words].fillna("")
    ends = table["high"].str.partition(" or ")[[0, 2]].apply(pd.to_numeric)
    table["high"], table["or_high"] = ends[0], ends[2]
    if not table.index.is_unique:
        raise ValueError(f"{path}: repeated id {table.index[table.index.duplicated()][0]}")
    for column, allowed in {
        "kind": {"stated", "axis_range", "garbled"},
        "form": {"value", "range", "axis", "estimate", "unlike", "trend", "layout"},
        "role": {"input", "count", "calibrated", "result", "trend", ""},
        "score": {"none", ""},
        "same_as": {*table.index[table["same_as"] == ""], ""},
    }.items():
        unknown = set(table[column]) - allowed
        if unknown:
            raise ValueError(
                f"{path}: unknown {column} {sorted(map(str, unknown))}, allowed {sorted(allowed)}"
            )
    wrong = table.index[(table["role"] == "trend") != (table["form"] == "trend")]
    wrong = wrong.union(table.index[(table["role"] == "") != (table["form"] == "layout")])
    if len(wrong):
        role, form = table.loc[wrong[0], ["role", "form"]]
        raise ValueError(f"{path}: {wrong[0]}: role '{role}' does not go with form '{form}'")
    if (evidence := Path(path).with_name(EVIDENCE)).exists():
        named = pd.read_csv(evidence, dtype=str)["thesis_ids"].dropna().str.split().explode()
        table.loc[table.index.isin(named) & table["score"].eq(""), "score"] = "fitted"
    return table


def empty_reference() -> pd.DataFrame:
    """A reference table without rows: figures then carry no thesis ranges."""
    return pd.DataFrame(columns=["low", "high", "kind"])

"""Measured data that the model is compared with and calibrated to: the CSV files of
``config/reference``.

Every row says where it comes from (``source``) and how it was obtained (``how_obtained``). Forces
over depth are a folder: a further subject is a further file in ``config/reference/force_depth``.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

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
    """What a column may hold: text, one of some words, or a number above (or from) a bound;
    `optional` allows none.
    """

    words: tuple[str, ...] = ()
    text: bool = False
    above: float | None = None
    least: float | None = None
    optional: bool = False

    @property
    def allowed(self) -> str:
        """What is allowed, in words."""
        if self.words:
            return ", ".join(self.words)
        if self.text:
            return "text or nothing" if self.optional else "text"
        bound = (
            f" above {self.above:g}"
            if self.above is not None
            else f" from {self.least:g}"
            if self.least is not None
            else ""
        )
        return f"a number{bound}{' or nothing' if self.optional else ''}"

    def read(self, cell: str | float) -> str | float:
        """The value of a cell, text or a number; ValueError if it is not allowed."""
        if self.words or self.text:
            if self.optional and not cell:
                return ""
            if not cell or (self.words and cell not in self.words):
                raise ValueError
            return cell
        if self.optional and not cell:
            return math.nan
        value = float(cell)
        if not math.isfinite(value) or (self.above is not None and not value > self.above):
            raise ValueError
        if self.least is not None and not value >= self.least:
            raise ValueError
        return value


_ORIGIN = {"source": Column(text=True), "how_obtained": Column(text=True)}

FORCE_DEPTH = {
    "subject": Column(text=True),
    "indenter": Column(words=INDENTERS),
    "depth_mm": Column(above=0.0),
    "speed_mm_per_s": Column(least=0.0),
    "force_N": Column(above=0.0),
    **_ORIGIN,
}
"""Normal force at an indentation depth; a speed of 0 is the steady state."""

RELAXATION = {
    "series": Column(text=True),
    "indenter": Column(words=INDENTERS),
    "term": Column(least=1.0),
    "g": Column(above=0.0, optional=True),
    "tau_s": Column(above=0.0),
    **_ORIGIN,
}
"""Terms of relaxation functions; g is the share of the instantaneous shear modulus, empty where the
source gives none.
"""

SURFACE_PROFILES = {
    "subject": Column(text=True),
    "indenter": Column(words=INDENTERS),
    "diameter_mm": Column(above=0.0),
    "depth_mm": Column(above=0.0),
    "speed_mm_per_s": Column(least=0.0),
    "lateral_distance_mm": Column(),
    "deflection_mm": Column(),
    **_ORIGIN,
}
"""Deflection of the skin, downward positive, beside an indenter at a depth."""

FRICTION = {
    "kind": Column(words=("measured", "assumed")),
    "quantity": Column(words=("coefficient", "factor")),
    "contact": Column(text=True),
    "condition": Column(text=True),
    "low": Column(above=0.0),
    "high": Column(above=0.0, optional=True),
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
    if isinstance(paths, (str, Path)) and Path(paths).is_dir():
        files = sorted(Path(paths).glob("*.csv"))
    else:
        files = sorted(map(Path, [paths] if isinstance(paths, (str, Path)) else paths))
    if not files:
        raise ReferenceDataError(
            f"{paths}: holds no CSV file; allowed: at least one with columns "
            f"{', '.join(FORCE_DEPTH)}"
        )
    frames = [read_table(file, FORCE_DEPTH) for file in files]
    for file, frame in zip(files, frames, strict=True):
        seen: dict[tuple, int] = {}
        for record in frame.itertuples():
            key = (record.subject, record.indenter, record.depth_mm, record.speed_mm_per_s)
            if key in seen:
                what = f"subject '{key[0]}', {key[1]}, {key[2]:g} mm, {key[3]:g} mm/s"
                raise ReferenceDataError(
                    f"{file}: row {record.Index}: {what} is in row {seen[key]} already; allowed: "
                    "each once"
                )
            seen[key] = record.Index
    files_of = Counter(subject for frame in frames for subject in frame["subject"].unique())
    for file, frame in zip(files, frames, strict=True):
        named = {
            subject: f"{subject} ({file.stem})" for subject, count in files_of.items() if count > 1
        }
        frame["subject"] = frame["subject"].replace(named)
    return pd.concat(frames, ignore_index=True)


def read_relaxation(path: str | Path) -> pd.DataFrame:
    """Relaxation series, columns of :data:`RELAXATION`; `ReferenceDataError` if the file is wrong
    or shares sum to 1 or more.
    """
    frame = read_table(path, RELAXATION)
    totals = frame.groupby("series", sort=False)["g"].sum()
    for series, total in totals[totals >= 1].items():
        row = frame.index[frame["series"] == series][0]
        raise ReferenceDataError(
            f"{path}: row {row}, column g: series '{series}' sums to {total:g}; allowed: less "
            "than 1"
        )
    return frame


def read_surface_profiles(path: str | Path) -> pd.DataFrame:
    """Surface profiles, columns of :data:`SURFACE_PROFILES`; `ReferenceDataError` if the file is
    wrong.
    """
    return read_table(path, SURFACE_PROFILES)


BANDS = {
    "surface": Column(text=True),
    "measure": Column(text=True),
    "unit": Column(words=("mm", "Pa")),
    "low": Column(above=0.0),
    "high": Column(above=0.0),
    "pads": Column(above=0.0),
    "source": Column(text=True),
}
"""What the thesis leaves open of its pad: lowest and highest of a measure among pads that show what
it shows.
"""


def read_bands(path: str | Path) -> pd.DataFrame:
    """What pads differ by that the thesis's figures do not tell apart, columns of :data:`BANDS`.

    Raises ReferenceDataError: the file is wrong, or a band is upside down.
    """
    frame = read_table(path, BANDS)
    for row in frame.index[frame["high"] < frame["low"]]:
        low, high = frame.loc[row, ["low", "high"]]
        raise ReferenceDataError(
            f"{path}: row {row}, column high: '{high:g}'; allowed: from {low:g}"
        )
    return frame


def read_friction(path: str | Path) -> pd.DataFrame:
    """Published friction, columns of :data:`FRICTION`; `ReferenceDataError` if the file is wrong or
    a range is upside down.
    """
    frame = read_table(path, FRICTION)
    for row in frame.index[frame["high"] < frame["low"]]:
        low, high = frame.loc[row, ["low", "high"]]
        raise ReferenceDataError(
            f"{path}: row {row}, column high: '{high:g}'; allowed: a number from {low:g} or nothing"
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
    values: dict[str, list] = {name: [] for name in table.header}
    for line, row in zip(table.lines, table.rows, strict=True):
        for k, (name, cell) in enumerate(zip(table.header, row, strict=True)):
            column = schema[name]
            try:
                number = cell and not (column.words or column.text)
                values[name].append(column.read(table.number(cell, line, k) if number else cell))
            except ValueError:
                raise ReferenceDataError(
                    f"{path}: row {line}, column {name}: '{cell[:60]}'; allowed: {column.allowed}"
                ) from None
    if not table.rows:
        raise ReferenceDataError(f"{path}: has no rows; allowed: at least one")
    return pd.DataFrame(values, index=table.lines)[list(schema)]


def read_reference(path: str | PathLike) -> pd.DataFrame:
    """Table of numbers printed in the thesis, indexed by id.

    Columns figure, quantity, condition, low, high, units, kind (stated | axis_range | garbled),
    form (value | range | axis | estimate | unlike: what is shown is not the model's | trend |
    layout), tolerance, tick (the last of an axis but one, if simulated curves alone set its end),
    role (input: stated by the thesis and by the scenes; count: of the model itself; calibrated: a
    parameter was chosen by it; result; trend; empty for a layout), score (fitted: the pad was, or
    is reconstructed, by it; none: earns nothing, the reason says why; empty: held out), same_as
    (row of the same number of the same curve, which alone counts), source; and how this model
    answers: measure (a name of `cysyk1999.measures.table.MEASURES`), at (its condition), of
    (scenes), reason (of a known difference, or of not being judged). Raises ValueError for a
    repeated id, an unknown kind, form, role, score or row.
    """
    words = ["role", "score", "same_as", "measure", "at", "of", "reason"]
    text = dict.fromkeys(["id", "figure", "condition", "units", *words], str)
    table = pd.read_csv(path, dtype=text).set_index("id")
    table[words] = table[words].fillna("")
    if not table.index.is_unique:
        raise ValueError(f"{path}: repeated id {table.index[table.index.duplicated()][0]}")
    for column, allowed in {
        "kind": {"stated", "axis_range", "garbled"},
        "form": {"value", "range", "axis", "estimate", "unlike", "trend", "layout"},
        "role": {"input", "count", "calibrated", "result", "trend", ""},
        "score": {"fitted", "none", ""},
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
    return table


def empty_reference() -> pd.DataFrame:
    """A reference table without rows: figures then carry no thesis ranges."""
    return pd.DataFrame(columns=["low", "high", "kind"])

"""Measurements: one file a dataset, one schema, one model of a row.

``measured/<dataset>.csv`` holds the rows, ``measured/datasets.csv`` a line about each file. To add
a dataset is to add both.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict, ValidationError, model_validator

from fingerpad.documents import SceneError, nearest
from fingerpad.files import WrongInput
from fingerpad.tables import Table, read_table
from fingerpad.units import parse_quantity

MEASURED = Path(__file__).parent / "measured"
INDEX = MEASURED / "datasets.csv"
QUANTITIES = {
    "force": "N",
    "deflection": "mm",
    "impulse_rate": "1/s",
    "impulses": "1",
    "receptive_field_area": "mm^2",
    "friction_coefficient": "1",
    "friction_fall": "%",
    "friction_growth": "1",
    "slip_distance": "mm",
    "largest_surface_strain": "%",
    "time_constant": "s",
    "dissipated_energy": "%",
    "volume_change": "%",
    "width": "mm",
    "height": "mm",
    "drop": "mm",
    "thickness": "mm",
    "ridge_spacing": "mm",
    "ridge_width": "mm",
    "ridge_height": "mm",
    "bone_width": "mm",
}
"""What is measured -> the unit of its rows."""
ROLES = {
    "fit": "free constants may be fitted to it; never counted",
    "test": "held out; counted",
    "repeat": "another reading of a curve that is there already; never counted",
    "input": "what models are built from; never counted",
}


class BenchmarkError(SceneError):
    """A table of measurements or of predictions is wrong; one line, as `SceneError`."""


def _optional(cell: Any) -> Any:
    return None if cell == "" else cell


def _fragment(cell: Any) -> Any:
    """The part of a scene in a cell, as JSON; none where it is empty."""
    try:
        found = json.loads(cell) if cell else {}
    except json.JSONDecodeError as error:
        raise ValueError("is not JSON") from error
    if not isinstance(found, dict) or not set(found) <= {"kinematics", "stimulus", "specimen"}:
        raise ValueError("is no part of a scene")
    return found


_Number = Annotated[float, BeforeValidator(lambda cell: cell or "nothing")]
_Bound = Annotated[float | None, BeforeValidator(_optional)]


class Row(BaseModel):
    """One measured number.

    Attributes
    ----------
    row : int
        Its number in the dataset, 1 or more.
    quantity, unit : str
        A key of `QUANTITIES` and its unit.
    scene : dict
        Part of a scene: kinematics and stimulus; empty where no scene stands for it.
    at : str
        Where and at what load, as ``depth 1 mm; x 2 mm``.
    condition, species, subject, window : str
        Of the measurement, in words.
    value : float
        In the row's unit.
    low, high : float or None
        The measurement's scatter, one standard deviation to either side unless `doubt` says
        otherwise; both or none.
    source, how_obtained, doubt : str
        Where it was published, how it was read, and what is not certain.
    role : str
        A key of `ROLES`.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    row: int
    quantity: str
    unit: str
    scene: Annotated[dict[str, Any], BeforeValidator(_fragment)]
    at: str
    condition: str
    species: Literal["human", "monkey"]
    subject: str
    window: str
    value: _Number
    low: _Bound
    high: _Bound
    source: str
    how_obtained: str
    doubt: str
    role: Literal["fit", "test", "repeat", "input"]

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.quantity not in QUANTITIES:
            raise ValueError(f"quantity: '{self.quantity}' is not known{_known(self.quantity)}")
        if self.unit != QUANTITIES[self.quantity]:
            raise ValueError(
                f"unit: '{self.unit}' is not that of {self.quantity}; "
                f"allowed: {QUANTITIES[self.quantity]}"
            )
        if not self.source or not self.how_obtained:
            raise ValueError("source, how_obtained: one is empty; allowed: words")
        if (self.low is None) != (self.high is None):
            raise ValueError("low, high: only one is there; allowed: both or none")
        if self.low is not None and not self.low <= self.value <= self.high:
            raise ValueError("low, high: do not hold the value; allowed: low <= value <= high")
        return self

    @property
    def deviation(self) -> float | None:
        """Standard deviation of the measurement in the row's unit, or None."""
        return (self.high - self.low) / 2 if self.low is not None else None

    def place(self, name: str, dimension: str) -> float:
        """A number of `at`, SI.

        Raises
        ------
        KeyError
            `at` does not name it.
        """
        for part in self.at.split(";"):
            key, _, text = part.strip().partition(" ")
            if key == name:
                return float(parse_quantity(text, dimension))
        raise KeyError(name)


def _known(name: str) -> str:
    return f"; allowed: {', '.join(QUANTITIES)}{nearest(name, QUANTITIES)}"


def table_of(path: str | Path, columns: Iterable[str]) -> Table:
    """A table that has some columns.

    Raises
    ------
    BenchmarkError
        It cannot be read, or a column is missing.
    """
    try:
        table = read_table(path)
    except WrongInput as error:
        raise BenchmarkError(f"{path}: {error}") from error
    except OSError as error:
        raise BenchmarkError(f"{path}: cannot be read: {error.strerror}") from error
    for name in columns:
        if name not in table.header:
            raise BenchmarkError(f"{path}: has no column '{name}'; allowed: {','.join(columns)}")
    return table


def read_dataset(path: str | Path) -> list[Row]:
    """Rows of one file.

    Raises
    ------
    BenchmarkError
        A cell is wrong: file, row of the file, column, value and what is allowed, in one line.

    Examples
    --------
    >>> from fingerpad.benchmark.rows import MEASURED, read_dataset
    >>> row = read_dataset(MEASURED / "force_plate.csv")[0]
    >>> row.value, row.unit, row.at
    (0.043, 'N', 'depth 0.5 mm')
    """
    table = table_of(path, Row.model_fields)
    rows: list[Row] = []
    for cells, line in zip(table.rows, table.lines, strict=True):
        try:
            rows.append(Row(**dict(zip(table.header, cells, strict=True))))
        except ValidationError as error:
            raise BenchmarkError(_line(path, line, error)) from error
        if rows[-1].row in {each.row for each in rows[:-1]}:
            raise BenchmarkError(
                f"{path}: row {line}, column 'row': {rows[-1].row} is there twice; "
                "allowed: a number of its own"
            )
    return rows


def _line(path: str | Path, line: int, error: ValidationError) -> str:
    """The first thing that is wrong with a row."""
    first = error.errors()[0]
    told = {"literal_error": "is not known", "int_parsing": "is no whole number"}
    told |= {"float_parsing": "is no number", "finite_number": "is no finite number"}
    what = first["msg"].removeprefix("Value error, ")
    if not first["loc"]:
        return f"{path}: row {line}, {what}"
    allowed = str(first.get("ctx", {}).get("expected", "")).replace("'", "")
    kind = told.get(first["type"], what)
    end = allowed or {"is no number": "a number such as 1.5", "is not JSON": "JSON"}.get(kind)
    return f"{path}: row {line}, column '{first['loc'][0]}': '{first['input']}' {kind}" + (
        f"; allowed: {end}" if end else ""
    )


@cache
def titles() -> dict[str, str]:
    """Every dataset of the package -> what it is, in the order of the index."""
    table = table_of(INDEX, ("dataset", "title"))
    name, title = (table.header.index(column) for column in ("dataset", "title"))
    return {row[name]: row[title] for row in table.rows}


def datasets(names: Iterable[str] = ()) -> dict[str, list[Row]]:
    """The package's datasets, or those named.

    Raises
    ------
    BenchmarkError
        There is no such dataset.
    """
    known = titles()
    for name in (chosen := list(names)):
        if name not in known:
            raise BenchmarkError(
                f"--dataset: '{name}' is not known; allowed: {', '.join(known)}"
                f"{nearest(name, known)}"
            )
    return {name: read_dataset(MEASURED / f"{name}.csv") for name in chosen or known}

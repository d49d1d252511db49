"""How near predictions come to measurements; where they come from does not matter."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import TextIO

import numpy as np

from fingerpad.benchmark.rows import BenchmarkError, Row, datasets, table_of
from fingerpad.tables import TableError

COLUMNS = ("dataset", "row", "predicted")
"""That a table of predictions has; ``mesh_error`` may be there, others are not looked at."""
FIXED = ("unit", "role", "value")
"""Columns that a table may have, as the template has, and not change."""
FEWEST = 3
"""Predicted rows, and half of those held out, below which there is no verdict."""

COARSE = 0.2
"""Error of a mesh that a verdict names."""


@dataclass(frozen=True)
class Prediction:
    """A predicted number in the unit of its row, and its change on a coarser mesh, as a share of
    the largest prediction of its dataset.
    """

    value: float
    mesh_error: float = math.nan


Predictions = dict[tuple[str, int], Prediction]
"""Dataset and row -> prediction."""


@dataclass(frozen=True)
class Score:
    """How near one model comes to one dataset; held-out rows only.

    Attributes
    ----------
    dataset : str
    unit : str
        Of `rms` and `bias`.
    rows, predicted : int
        Rows that are held out, and how many of them have a prediction.
    rms, bias : float
        Root mean square, and mean, of predicted less measured.
    rms_in_deviations : float
        The same in standard deviations of the measurement; not a number where none is published.
    r_squared : float
        Negative where the mean of the measurements does better.
    within_scatter : float
        Share between low and high, of rows that have them.
    within_factor_2 : float
        Share between half and twice the measurement.
    mesh_error : float
        What a coarser mesh changes at most, as a share of the largest prediction; not added to
        the errors above.
    verdict : str
        One sentence.
    """

    dataset: str
    unit: str
    rows: int
    predicted: int
    rms: float
    rms_in_deviations: float
    r_squared: float
    bias: float
    within_scatter: float
    within_factor_2: float
    mesh_error: float
    verdict: str


def read_predictions(path: str | Path) -> Predictions:
    """Predictions in a table with the columns `COLUMNS`; an empty cell is no prediction.

    Raises
    ------
    BenchmarkError
        A cell is wrong, or a row is not one of the measurements or is there twice.
    """
    table = table_of(path, COLUMNS)
    name, number, value = (table.header.index(column) for column in COLUMNS)
    error = table.header.index("mesh_error") if "mesh_error" in table.header else None
    fixed = [(table.header.index(key), key) for key in FIXED if key in table.header]
    known = {dataset: {row.row: row for row in rows} for dataset, rows in datasets().items()}
    found: Predictions = {}
    for cells, line in zip(table.rows, table.lines, strict=True):
        place = f"{path}: row {line}, column"
        if cells[name] not in known:
            allowed = ", ".join(known)
            raise BenchmarkError(f"{place} 'dataset': no '{cells[name]}'; allowed: {allowed}")
        if not cells[number].isdigit() or int(cells[number]) not in known[cells[name]]:
            allowed = f"1 to {max(known[cells[name]])}, the rows of {cells[name]}"
            raise BenchmarkError(f"{place} 'row': no '{cells[number]}'; allowed: {allowed}")
        key = cells[name], int(cells[number])
        if key in found:
            raise BenchmarkError(f"{place} 'row': {key[1]} is there twice; allowed: once")
        for column, text in fixed:
            stated = str(getattr(known[key[0]][key[1]], text))
            if cells[column] not in ("", stated):
                wrong = f"'{cells[column]}' is not the measurement's"
                raise BenchmarkError(f"{place} '{text}': {wrong}; allowed: {stated}")
        try:
            if cells[value]:
                predicted, stated = table.number(cells[value], line, value), math.nan
                if error is not None and cells[error]:
                    stated = table.number(cells[error], line, error)
                    if stated < 0:
                        wrong = f"'{cells[error]}' is below zero; allowed: a share of 0 or more"
                        raise BenchmarkError(f"{place} 'mesh_error': {wrong}")
                found[key] = Prediction(predicted, stated)
        except TableError as wrong:
            raise BenchmarkError(f"{path}: {wrong}") from wrong
    return found


def score(
    predictions: Predictions, measured: Mapping[str, Iterable[Row]] | None = None
) -> list[Score]:
    """Scores of every dataset that has a prediction of a held-out row; one for each unit in it.

    Parameters
    ----------
    predictions : dict
    measured : mapping, optional
        The package's datasets without.

    Examples
    --------
    >>> from fingerpad.benchmark.rows import datasets
    >>> from fingerpad.benchmark.score import Prediction, score
    >>> rows = datasets(["force_plate"])
    >>> same = {("force_plate", r.row): Prediction(2 * r.value) for r in rows["force_plate"]}
    >>> score(same, rows)[0].within_factor_2
    1.0
    """
    scores = []
    for name, rows in (datasets() if measured is None else measured).items():
        held_out = [row for row in rows if row.role == "test"]
        for unit in dict.fromkeys(row.unit for row in held_out):
            same = [row for row in held_out if row.unit == unit]
            pairs = [(row, predictions.get((name, row.row))) for row in same]
            given = [(row, prediction) for row, prediction in pairs if prediction]
            if given:
                scores.append(_score(name, len(same), given))
    return scores


def _score(name: str, total: int, pairs: list[tuple[Row, Prediction]]) -> Score:
    value = np.array([row.value for row, _ in pairs])
    predicted = np.array([prediction.value for _, prediction in pairs])
    error = predicted - value
    spread = float(((value - value.mean()) ** 2).sum())
    scattered = [
        (each / row.deviation, row.low <= row.value + each <= row.high)
        for (row, _), each in zip(pairs, error, strict=True)
        if row.deviation
    ]
    near = float(within_factor_2(predicted, value).mean())
    squared = 1 - float((error**2).sum()) / spread if spread else math.nan
    meshes = [prediction.mesh_error for _, prediction in pairs]
    mesh = float(np.nanmax(meshes)) if np.isfinite(meshes).any() else math.nan
    deviations = np.array([each for each, _ in scattered])
    return Score(
        dataset=name,
        unit=pairs[0][0].unit,
        rows=total,
        predicted=len(pairs),
        rms=float(np.sqrt((error**2).mean())),
        rms_in_deviations=float(np.sqrt((deviations**2).mean())) if scattered else math.nan,
        r_squared=squared,
        bias=float(error.mean()),
        within_scatter=float(np.mean([inside for _, inside in scattered]))
        if scattered
        else math.nan,
        within_factor_2=near,
        mesh_error=mesh,
        verdict=_verdict(squared, near, len(pairs), total, mesh),
    )


def within_factor_2(predicted: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """Whether predictions (n,) lie between half and twice measurements (n,) of the same sign."""
    # a ratio of signs has no meaning: both must be on the same side of zero
    ratio = (2 * abs(predicted) >= abs(measured)) & (abs(predicted) <= 2 * abs(measured))
    return (predicted * measured > 0) & ratio | (predicted == measured)


def _verdict(squared: float, near: float, predicted: int, total: int, mesh: float) -> str:
    """A sentence: what the model may be used for here; where its mesh is coarse it says so."""
    part = "" if predicted == total else f" ({predicted} of {total} rows predicted)"
    if mesh > COARSE:
        part += f", and a coarser mesh changes it by up to {100 * mesh:.0f} %"
    if predicted < max(FEWEST, total / 2):
        return f"Too few rows to judge{part}."
    if squared >= 0.8 and near >= 0.9:
        return f"To be trusted here{part}."
    if squared >= 0.5:
        return f"Right in shape, not in every number{part}."
    if near >= 0.9:
        return f"Right within a factor of two, not in shape{part}."
    return f"Not to be trusted here{part}."


def write_scores(scores: Mapping[str, list[Score]], path: Path) -> None:
    """Scores of models, by name, as a table."""
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["model", *(each.name for each in fields(Score))])
        for model, found in scores.items():
            for each in found:
                table.writerow([model, *map(_cell, asdict(each).values())])


def _cell(value: object) -> object:
    if isinstance(value, float):
        return f"{value:.4g}" if math.isfinite(value) else ""
    return value


def write_predictions(
    predictions: Predictions, file: TextIO, measured: Mapping[str, Iterable[Row]]
) -> None:
    """A table of measurements with predictions beside them; empty where there is none.

    Without predictions it is the template that another model fills in.
    """
    table = csv.writer(file, lineterminator="\n")
    stated = ("quantity", "unit", "at", "condition", "subject", "window", "role", "value")
    table.writerow([*COLUMNS, "mesh_error", *stated])
    for name, rows in measured.items():
        for row in rows:
            found = predictions.get((name, row.row))
            cells = (_cell(found.value), _cell(found.mesh_error)) if found else ("", "")
            table.writerow([name, row.row, *cells, *(getattr(row, each) for each in stated)])

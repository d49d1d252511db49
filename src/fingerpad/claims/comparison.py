"""The thesis against this model, number by number: ``figures/tables/thesis_comparison``.

Every row is a row of the reference table (what the thesis prints, id by id), which says by which measure of which scenes it is
answered; a trend has a function of its own. Numbers are judged by the rules in `verdicts`; a trend holds or fails. `layout` rows
only set axes of figures and have no row here.

Every row has a role. Only a `result` and a `trend` speak for the model: an `input` is what the thesis states and the scenes
repeat, a `count` is of the model itself, and what is `calibrated` was used to choose a parameter.

A row that is outside says by how much, the likeliest reason, and what the sensitivity runs make of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike

import numpy as np
import pandas as pd

from fingerpad.claims import trends_pressing, trends_stroking  # noqa: F401 (enter their trends)
from fingerpad.claims.reasons import REASONS, reason, when_the_hold_starts
from fingerpad.claims.rows import Number
from fingerpad.claims.sensitivity import evidence
from fingerpad.claims.trends import TRENDS
from fingerpad.claims.verdicts import is_inside, judge, significant
from fingerpad.measures.table import Measures
from fingerpad.reference_data import read_reference

GIVEN = ("input", "count")
"""Roles of what goes into the simulations: printed in full, without a discretisation error."""

COLUMNS = (
    "id", "figure", "quantity", "condition", "role", "thesis_low", "thesis_high", "thesis_kind", "simulated",
    "discretisation_error", "units", "verdict", "note",
)  # fmt: skip


def thesis_comparison(fine: Measures, rough: Measures, reference_csv: str | PathLike) -> pd.DataFrame:
    """Compare the thesis's numbers and trends of chapters 3 to 5 with the simulated ones.

    Parameters
    ----------
    fine, rough : measures of the histories, and of their companions on coarser meshes (may know nothing).
    reference_csv : the table of printed numbers (see `read_reference`).

    Returns
    -------
    One row an id, columns `COLUMNS`; numbers in the row's `units`. The discretisation error is the difference
    of the row's number between mesh and companion, in the same units, empty for what is `GIVEN`. Scenes that
    were not simulated give ``not_comparable``. `summary` of the rows is in ``attrs["summary"]``.
    """
    reference = read_reference(reference_csv)
    rows = [_row(entry, fine, rough, reference) for _, entry in reference.iterrows() if entry["form"] != "layout"]
    table = pd.DataFrame(rows, columns=COLUMNS)
    table.attrs["summary"] = summary(table, reference)
    return table


def summary(table: pd.DataFrame, reference: pd.DataFrame) -> str:
    """How many rows agree with the thesis, results and trends first, and apart from them what was put in or chosen by."""

    def of(rows: pd.Series, *verdicts: str) -> str:
        judged = table[rows & (table["verdict"] != "not_comparable")]["verdict"]
        return f"{judged.isin(verdicts).sum()} of {len(judged)}"

    role, axis = table["role"], table["id"].map(reference["form"]).eq("axis")
    return (
        f"**{of(role.eq('result') & ~axis, 'inside')} results are inside a value or range of the thesis, "
        f"{of(role.eq('result') & axis, 'plausible')} are plausible on an axis of its figures "
        f"(below its end and filling half of it), {of(role.eq('trend'), 'trend_holds')} trends hold.** "
        f"Not counted: {of(role.isin(GIVEN), 'inside', 'plausible')} inputs and counts of the model are as in the thesis, "
        f"{of(role.eq('calibrated'), 'inside', 'plausible')} numbers that a parameter was chosen by are inside."
    )


def _row(entry: pd.Series, fine: Measures, rough: Measures, reference: pd.DataFrame) -> dict:
    row = {"id": entry.name} | {k: entry[k] for k in ("figure", "quantity", "condition", "role", "units")}
    row |= {f"thesis_{k}": entry[k] for k in ("low", "high", "kind")}
    row |= {"simulated": float("nan"), "discretisation_error": float("nan")}
    try:
        if entry["form"] == "trend":
            trend = TRENDS[entry.name](fine)
            verdict = "trend_holds" if trend.holds else "trend_fails"
            return row | {"simulated": significant(trend.shown, 4), "verdict": verdict, "note": trend.note}
        number = Number.of(entry)
        value = number(fine)
    except KeyError as missing:
        why = REASONS["subjects"] if entry["reason"] == "subjects" else missing.args[0]
        return row | {"verdict": "not_comparable", "note": f"not simulated: {why}"}
    if entry["role"] in GIVEN:
        verdict, *notes = judge(value, 0.0, entry)
        notes += [reason(entry["reason"], fine, number)] * (verdict == "outside")
        return row | {"simulated": value, "verdict": verdict, "note": _note(*notes, _doubt(entry))}
    error = _error(number, value, rough)
    allowed = float(np.nan_to_num(error))
    verdict, *notes = judge(value, allowed, entry)
    if verdict == "outside" or entry["form"] == "estimate":
        notes.append(reason(entry["reason"], fine, number))
    if verdict == "outside":
        notes.append(evidence(entry.name, number, value, allowed, fine, rough, reference))
    row |= {"simulated": significant(value, 4), "discretisation_error": significant(error, 2)}
    return row | {"verdict": verdict, "note": _note(*notes, _at_start(number, entry, fine), _doubt(entry))}


def _error(number: Number, value: float, rough: Measures) -> float:
    """The discretisation error: what the number changes by when it is made of the companions."""
    try:
        return abs(value - number(rough))
    except KeyError:
        return float("nan")


def _at_start(number: Number, entry: Mapping, fine: Measures) -> str:
    start = when_the_hold_starts(fine, number)
    if start is None:
        return ""
    return f"{start:.3g} when the hold starts" + ("" if is_inside(start, 0.0, entry) else ", outside")


def _doubt(entry: Mapping) -> str:
    return "thesis reading uncertain" if entry["kind"] == "garbled" else ""


def _note(*parts: str) -> str:
    return "; ".join(filter(None, parts))

"""The thesis against this model, number by number: ``figures/tables/thesis_comparison``.

Every row is a row of the reference table (what the thesis prints, id by id), which says by which
measure of which scenes it is answered; a trend has a function of its own. Numbers are judged by the
rules in `verdicts`; a trend holds or fails. `layout` rows only set axes of figures and have no row
here.

Every row has a role. Only a `result` and a `trend` speak for the model: an `input` is what the
thesis states and the scenes repeat, a `count` is of the model itself, and what is `calibrated` was
used to choose a parameter.

What speaks for the model is scored by whether it was held out: a row that the pad was fitted by
earns less than one that it never saw. Rows that repeat another's number count once, those that hold
by construction or are nobody's claim not at all.

A row that is outside says by how much, the reason as far as runs tell it, and what the sensitivity
runs make of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import astuple
from os import PathLike

import pandas as pd

from cysyk1999.claims import trends_pressing, trends_stroking  # noqa: F401 (enter their trends)
from cysyk1999.claims.reasons import REASONS, reason
from cysyk1999.claims.rows import GIVEN, Number, judged
from cysyk1999.claims.sensitivity import evidence
from cysyk1999.claims.trends import TRENDS
from cysyk1999.claims.verdicts import is_inside, joined, significant
from cysyk1999.measures.runs import NINE
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.reference_data import read_reference

AGREES = ("inside", "plausible", "trend_holds")
"""Verdicts of what is as the thesis says."""
PARTS = ("mesh_error", "time_step_error", "sampling_error")
"""Columns of what a number is wrong by, each in the row's units."""

COLUMNS = (
    "id",
    "figure",
    "quantity",
    "condition",
    "role",
    "score",
    "thesis_low",
    "thesis_high",
    "thesis_kind",
    "simulated",
    *PARTS,
    "units",
    "verdict",
    "note",
)


def thesis_comparison(
    fine: Measures, instead: Instead, reference_csv: str | PathLike
) -> pd.DataFrame:
    """Compare the thesis's numbers and trends of chapters 3 to 5 with the simulated ones.

    Parameters
    ----------
    fine, instead : measures of the histories, and of what tells their errors (may know nothing).
    reference_csv : the table of printed numbers (see `read_reference`).

    Returns
    -------
    One row an id, columns `COLUMNS`; numbers in the row's `units`. Its errors, by `PARTS`, are what
    the row's number changes by, in the same units, empty for what is `GIVEN`; it is judged by their
    sum. Scenes that were not simulated give ``not_comparable``. `summary` of the rows is in
    ``attrs["summary"]``.
    """
    reference = read_reference(reference_csv)
    rows = [
        _row(entry, fine, instead, reference)
        for _, entry in reference.iterrows()
        if entry["form"] != "layout"
    ]
    table = pd.DataFrame(rows, columns=COLUMNS)
    table.attrs["summary"] = summary(table, reference)
    return table


SCORES = ("fitted", "held out")


def score_of(entry: pd.Series) -> str:
    """What a row counts among: fitted, held out, or nothing (empty)."""
    if (
        entry["role"] not in ("result", "trend", "calibrated")
        or entry["score"] == "none"
        or entry["same_as"]
    ):
        return ""
    return "fitted" if entry["score"] == "fitted" or entry["role"] == "calibrated" else "held out"


def scores(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """How many rows agree with the thesis: a row for each kind (value or range, axis, trend) and
    score, and both scores together.

    Columns kind, score, agree, judged. Rows that are not comparable are not judged.
    """
    form = table["id"].map(reference["form"])
    kind = form.where(form.isin(("axis", "trend")), "value or range")
    score = table["id"].map(reference.apply(score_of, axis=1))
    judged = table["verdict"].ne("not_comparable") & score.ne("")
    agree = table["verdict"].isin(AGREES)
    rows = []
    for each in ("value or range", "axis", "trend"):
        for name in (*SCORES, "all"):
            chosen = judged & kind.eq(each) & (score.eq(name) | (name == "all"))
            rows.append((each, name, int((chosen & agree).sum()), int(chosen.sum())))
    return pd.DataFrame(rows, columns=["kind", "score", "agree", "judged"])


def holding(table: pd.DataFrame) -> dict[str, tuple[int, int]]:
    """Of each figure how many of the thesis's statements hold here, results and trends, and of how
    many that can be judged.
    """
    rows = table[table["role"].isin(("result", "trend")) & table["verdict"].ne("not_comparable")]
    agree = rows["verdict"].isin(AGREES).groupby(rows["figure"]).agg(["sum", "size"])
    return {figure: (int(good), int(count)) for figure, good, count in agree.itertuples()}


def summary(table: pd.DataFrame, reference: pd.DataFrame) -> str:
    """How many rows agree with the thesis: held out first, then fitted and all; and apart from them
    what was put in.
    """
    counted = scores(table, reference).set_index(["kind", "score"])
    counts = counted["agree"].astype(str) + " of " + counted["judged"].astype(str)

    def told(kind: str) -> str:
        of = counts[kind]
        return f"{of['held out']} (fitted {of['fitted']}, all {of['all']})"

    given = table[table["role"].isin(GIVEN) & table["verdict"].ne("not_comparable")]["verdict"]
    return (
        f"**Held out: {told('value or range')} values and ranges of the thesis are met; "
        f"{told('axis')} axes of its figures are "
        f"filled, their largest curve between the last two ticks; {told('trend')} trends hold.** "
        f"Not counted: {given.isin(('inside', 'plausible')).sum()} of {len(given)} inputs and "
        "counts are as in the thesis; "
        f"{table['id'].map(reference['same_as']).ne('').sum()} rows repeat another's number; "
        f"{table['id'].map(reference['score']).eq('none').sum()} trends hold by construction or "
        "are not the thesis's own; "
        f"{table['id'].map(reference['form']).eq('unlike').sum()} rows show recordings or cannot "
        "be read."
    )


def _row(entry: pd.Series, fine: Measures, instead: Instead, reference: pd.DataFrame) -> dict:
    row = {"id": entry.name} | {
        k: entry[k] for k in ("figure", "quantity", "condition", "role", "units")
    }
    row |= {f"thesis_{k}": entry[k] for k in ("low", "high", "kind")} | {"score": score_of(entry)}
    row |= dict.fromkeys(("simulated", *PARTS), float("nan"))
    try:
        if entry["form"] == "trend":
            trend = TRENDS[entry.name](fine)
            row["simulated"] = significant(trend.shown, 4)
            row["verdict"] = "trend_holds" if trend.holds else "trend_fails"
            return row | {"note": joined(REASONS.get(entry["reason"], ""), trend.note)}
        number, value, errors, verdict, *notes = judged(entry, fine, instead)
    except KeyError as missing:
        why = REASONS["subjects"] if entry["reason"] == "subjects" else missing.args[0]
        return row | {"verdict": "not_comparable", "note": f"not simulated: {why}"}
    outside = verdict == "outside"
    if outside or entry["form"] in ("estimate", "unlike") or entry["reason"] == "panels":
        notes.append(reason(entry["reason"], fine, number))
    if entry["role"] not in GIVEN:
        if outside:
            notes.append(evidence(entry.name, number, value, errors.total, fine, reference))
        value = significant(value, 4)
        row |= {p: significant(e, 2) for p, e in zip(PARTS, astuple(errors), strict=True)}
    notes.append(_at_start(number, entry, fine))
    notes.append("thesis reading uncertain" * (entry["kind"] == "garbled"))
    return row | {"simulated": value, "verdict": verdict, "note": joined(*notes)}


def _at_start(number: Number, entry: Mapping, fine: Measures) -> str:
    """The inverse contact width that the hold starts with, of the rows that give the one it ends
    with.
    """
    scene = number.scenes[0]
    if number.measure != "inverse_width" or scene not in NINE.values():
        return ""
    start = fine(number.measure, scene, "top")
    outside = "" if is_inside(start, 0.0, entry) else ", outside"
    return f"{start:.3g} when the hold starts{outside}"

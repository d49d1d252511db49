"""The thesis against this model, number by number: ``figures/tables/thesis_comparison``.

Every row is a row of the reference table (what the thesis prints, id by id), which says by which
measure of which scenes it is answered; a trend has a function of its own. Numbers are judged by the
rules in `verdicts`; a trend holds or fails. `layout` rows only set axes of figures and have no row
here.

Every row has a role. Only a `result` and a `trend` speak for the model: an `input` is what the
thesis states and the scenes repeat, a `count` is of the model itself, and what is `calibrated` was
used to choose a parameter.

What speaks for the model is scored by whether it was held out: a row that the pad was fitted to
earns less than one that it never saw. Rows that repeat another's number count once. Those that hold
by construction, that a parameter was chosen by, or that are nobody's claim do not count.

Stated numbers, ranges, axes and trends (`KINDS`) are counted apart.

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
        judged_row(entry, fine, instead, reference)
        for _, entry in reference.iterrows()
        if entry["form"] != "layout"
    ]
    table = pd.DataFrame(rows, columns=COLUMNS)
    table.attrs["summary"] = summary(table, reference)
    return table


KINDS = {"value": "stated numbers", "range": "ranges", "axis": "axes", "trend": "trends"}
"""Kinds of statements, which are counted apart, and their plurals."""
SCORES = ("fitted", "held out")


def score_of(entry: pd.Series) -> str:
    """What a row counts among: fitted, held out, or nothing (empty)."""
    given = entry["role"] not in ("result", "trend") or entry["form"] not in KINDS
    if given or entry["score"] == "none" or entry["same_as"]:
        return ""
    return entry["score"] or "held out"


def judged_rows(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """The rows of a comparison that are judged, each with its `kind` (a key of `KINDS`), its
    `score` and whether it `agrees`.
    """
    rows = table[table["verdict"].ne("not_comparable") & table["id"].isin(reference.index)]
    return rows.assign(
        kind=rows["id"].map(reference["form"]),
        score=rows["id"].map(reference.apply(score_of, axis=1)),
        agrees=rows["verdict"].isin(AGREES),
    )


def scores(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """How many rows agree with the thesis: a row for each kind and score, and both scores together.

    Columns kind, score, agree, judged. Rows that are not comparable are not judged.
    """
    rows = judged_rows(table, reference)
    counts = []
    for kind in KINDS:
        for score in (*SCORES, "all"):
            of = SCORES if score == "all" else (score,)
            agrees = rows["agrees"][rows["kind"].eq(kind) & rows["score"].isin(of)]
            counts.append((kind, score, int(agrees.sum()), len(agrees)))
    return pd.DataFrame(counts, columns=["kind", "score", "agree", "judged"])


def summary(table: pd.DataFrame, reference: pd.DataFrame) -> str:
    """How many rows agree with the thesis: held out first, then fitted and all; and apart from them
    what was put in.
    """
    counted = scores(table, reference).set_index(["kind", "score"])
    counts = counted["agree"].astype(str) + " of " + counted["judged"].astype(str)

    def told(kind: str, ends: str) -> str:
        of = counts[kind]
        return f"{of['held out']} {KINDS[kind]} {ends} (fitted {of['fitted']}, all {of['all']})"

    given = table[table["role"].isin(GIVEN) & table["verdict"].ne("not_comparable")]["verdict"]
    of = reference.loc[reference.index.intersection(table["id"])]
    return (
        f"**Held out: {told('value', 'are met')}; {told('range', 'are met')}; "
        f"{told('axis', 'are filled, their largest curve between the last two ticks')}; "
        f"{told('trend', 'hold')}.** "
        f"Not counted: {given.isin(('inside', 'plausible')).sum()} of {len(given)} inputs and "
        f"counts are as in the thesis; {of['role'].eq('calibrated').sum()} numbers chose a "
        f"parameter; {of['same_as'].ne('').sum()} rows repeat another's number; "
        f"{of['score'].eq('none').sum()} rows hold by construction or are not the thesis's own; "
        f"{of['form'].eq('unlike').sum()} rows show recordings or cannot be read."
    )


def judged_row(entry: pd.Series, fine: Measures, instead: Instead, reference: pd.DataFrame) -> dict:
    """A row of the comparison, columns `COLUMNS`, of a row of the reference table."""
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
            note = joined(REASONS.get(entry["reason"], ""), trend.note, trend.parted)
            return row | {"note": note}
        number, value, errors, verdict, *notes = judged(entry, fine, instead)
    except KeyError as missing:
        why = REASONS["subjects"] if entry["reason"] == "subjects" else missing.args[0]
        return row | {"verdict": "not_comparable", "note": f"not simulated: {why}"}
    outside = verdict == "outside"
    unjudged = entry["form"] in ("estimate", "unlike") or entry["score"] == "none"
    if outside or unjudged or entry["reason"] == "panels":
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

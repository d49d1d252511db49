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
from cysyk1999.claims.reasons import REASONS, reason, when_the_hold_starts
from cysyk1999.claims.rows import Number
from cysyk1999.claims.sensitivity import evidence
from cysyk1999.claims.trends import TRENDS
from cysyk1999.claims.verdicts import is_inside, judge, significant
from cysyk1999.measures.errors import Errors
from cysyk1999.measures.table import MEASURES, Instead, Measures
from cysyk1999.reference_data import read_reference

AGREES = ("inside", "plausible", "trend_holds")
"""Verdicts of what is as the thesis says."""
GIVEN = ("input", "count")
"""Roles of what goes into the simulations: printed in full, without an error."""
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
    kind = (
        table["id"]
        .map(reference["form"])
        .map(lambda form: {"axis": "axis", "trend": "trend"}.get(form, "value or range"))
    )
    found = table["id"].map(reference.apply(score_of, axis=1))
    judged = table["verdict"].ne("not_comparable") & found.ne("")
    agree = table["verdict"].isin(AGREES)
    rows = []
    for each in ("value or range", "axis", "trend"):
        for score in (*SCORES, "all"):
            chosen = judged & kind.eq(each) & (found.eq(score) | (score == "all"))
            rows.append((each, score, int((chosen & agree).sum()), int(chosen.sum())))
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

    def told(kind: str) -> str:
        found = {
            score: "{} of {}".format(*counted.loc[(kind, score), ["agree", "judged"]])
            for score in ("held out", "fitted", "all")
        }
        return f"{found['held out']} (fitted {found['fitted']}, all {found['all']})"

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
            verdict = "trend_holds" if trend.holds else "trend_fails"
            note = _note(REASONS.get(entry["reason"], ""), trend.note)
            return row | {
                "simulated": significant(trend.shown, 4),
                "verdict": verdict,
                "note": note,
            }
        number = Number.of(entry)
        value = number(fine)
    except KeyError as missing:
        why = REASONS["subjects"] if entry["reason"] == "subjects" else missing.args[0]
        return row | {"verdict": "not_comparable", "note": f"not simulated: {why}"}
    if entry["role"] in GIVEN:
        verdict, *notes = judge(value, 0.0, entry)
        notes += [reason(entry["reason"], fine, number)] * (
            verdict == "outside" or entry["form"] == "unlike"
        )
        return row | {"simulated": value, "verdict": verdict, "note": _note(*notes, _doubt(entry))}
    # what a scene alone tells is no result
    errors = (
        Errors(0.0, 0.0, 0.0)
        if MEASURES[number.measure].of == "scene"
        else instead.errors(number, value)
    )
    allowed = errors.total
    verdict, *notes = judge(value, allowed, entry)
    if (
        verdict == "outside"
        or entry["form"] in ("estimate", "unlike")
        or entry["reason"] == "panels"
    ):
        notes.append(reason(entry["reason"], fine, number))
    if verdict == "outside":
        notes.append(evidence(entry.name, number, value, allowed, fine, reference))
    row |= {"simulated": significant(value, 4)} | {
        p: significant(e, 2) for p, e in zip(PARTS, astuple(errors), strict=True)
    }
    return row | {
        "verdict": verdict,
        "note": _note(*notes, _at_start(number, entry, fine), _doubt(entry)),
    }


def _at_start(number: Number, entry: Mapping, fine: Measures) -> str:
    start = when_the_hold_starts(fine, number)
    if start is None:
        return ""
    return f"{start:.3g} when the hold starts" + (
        "" if is_inside(start, 0.0, entry) else ", outside"
    )


def _doubt(entry: Mapping) -> str:
    return "thesis reading uncertain" if entry["kind"] == "garbled" else ""


def _note(*parts: str) -> str:
    return "; ".join(filter(None, parts))

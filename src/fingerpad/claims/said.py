"""What the thesis says of a figure and whether it is so here, in a line: of the rows of the comparison that are the figure's own.

The line that speaks is the first trend that fails, else the first stated number that is missed, else a trend or a number that
holds, else the range of an axis; the others are counted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd

from fingerpad.claims import trends_pressing, trends_stroking  # noqa: F401 (enter their trends)
from fingerpad.claims.rows import Number
from fingerpad.claims.trends import TRENDS
from fingerpad.claims.verdicts import judge
from fingerpad.measures.table import Measures


@dataclass(frozen=True)
class Said:
    """A statement of the thesis and its verdict: `ids` names it and counts the figure's others; `verdict` is holds or fails."""

    ids: str
    words: str
    condition: str
    verdict: str
    number: str
    detail: str


def said(number: str, fine: Measures, rough: Measures, reference: pd.DataFrame) -> Said | None:
    """What speaks for a figure of a number (``4-10``), as far as the measures know its scenes; None if nothing does.

    fine, rough: measures of the histories and of their companions. reference: of `read_reference`.
    """
    rows = reference[(reference["figure"] == number) & reference["role"].isin(("trend", "result"))]
    drawn = rows["condition"].astype(str).str.contains(DRAWN, regex=False)  # of several definitions only that which is drawn
    rows = rows[drawn | ~rows["quantity"].isin(rows.loc[drawn, "quantity"])]
    found = [one for _, row in rows.iterrows() if row["form"] != "layout" and (one := _judged(row, fine, rough)) is not None]
    if not found:
        return None
    rank, chosen = min(found, key=lambda pair: pair[0])
    holds = sum(one.verdict == "holds" for _, one in found)
    return Said(f"{chosen.ids}; {holds} of {len(found)} hold", *(getattr(chosen, k) for k in _PARTS))


DRAWN = "(headline)"
"""In the condition of a row that is about the strain energy drawn, where others are about other definitions."""
_PARTS = ("words", "condition", "verdict", "number", "detail")


def _judged(row: pd.Series, fine: Measures, rough: Measures) -> tuple[int, Said] | None:
    try:
        if row["form"] == "trend":
            trend = TRENDS[row.name](fine)
            verdict, *details = "holds" if trend.holds else "fails", *trend.note.split("; ")
            short = next((each for each in details if each.startswith("not for")), "") or _shown(trend.shown, row["units"])
            long = "; ".join(dict.fromkeys(filter(None, (details[0], short if short in details else ""))))
            parts = row.name, _plain(row["quantity"]), _plain(row["condition"]), verdict, short, _plain(long) or short
            return (2 if trend.holds else 0), Said(*parts)
        measured = Number.of(row)
        value = measured(fine)
    except KeyError:
        return None
    try:
        error = abs(value - measured(rough))
    except KeyError:
        error = 0.0
    verdict, remark = judge(value, float(np.nan_to_num(error)), row)
    if verdict == "not_comparable":
        return None
    stated = f"{row['low']:g}" if row["form"] == "value" else f"{row['low']:g} to {row['high']:g}"
    axis = "on an axis of " if row["form"] == "axis" else ""
    doubt = ", reading uncertain" if row["kind"] == "garbled" else ""
    words = f"{_plain(row['quantity'])} {axis}{_shown(stated, row['units'])}{doubt}"
    holds = verdict in ("inside", "plausible")
    shown = _shown(value, row["units"])
    rank = (4 if holds else 3) if row["form"] == "axis" else 2 if holds else 1
    return rank, Said(row.name, words, _plain(row["condition"]), "holds" if holds else "fails", shown,
                                     f"{shown}, {remark}" if remark else shown)  # fmt: skip


def _plain(text: object) -> str:
    """Text without the mark that parts the pieces of a statement; nothing for what is missing."""
    return "" if text != text else str(text).replace(" | ", " ").replace(" um", " µm").strip()


def _shown(value: float | str, units: str) -> str:
    text = value if isinstance(value, str) else f"{value:.3g}" if abs(value) < 1000 else f"{value:.0f}"
    return f"R² {text}" if units == "R2" else text if units == "1" else f"{text} {units}"

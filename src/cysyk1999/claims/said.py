"""What the thesis says of a figure and whether it is so here, in a line: of the rows of the
comparison that are the figure's own.

The line that speaks is the first trend that fails, else the first stated number that is missed,
else a trend or a number that holds, else the range of an axis; the others are counted. What the pad
was fitted to speaks, as such, where nothing else does.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import pandas as pd

from cysyk1999.claims import trends_pressing, trends_stroking  # noqa: F401 (enter their trends)
from cysyk1999.claims.rows import judged
from cysyk1999.claims.trends import TRENDS
from cysyk1999.claims.verdicts import digits, joined
from cysyk1999.measures.table import Instead, Measures


@dataclass(frozen=True)
class Said:
    """A statement of the thesis and its verdict: `ids` names it and counts the figure's others;
    `verdict` is holds or fails.
    """

    ids: str
    words: str
    condition: str
    verdict: str
    number: str
    detail: str


def said(number: str, fine: Measures, instead: Instead, reference: pd.DataFrame) -> Said | None:
    """What speaks for a figure of a number (``4-10``), as far as the measures know its scenes; None
    if nothing does.

    fine, instead: measures of the histories, and of what tells their errors. reference: of
    `read_reference`.
    """
    rows = reference[(reference["figure"] == number) & (reference["form"] != "layout")]
    drawn = (
        rows["condition"].astype(str).str.contains(DRAWN, regex=False)
    )  # of several definitions only that which is drawn
    rows = rows[drawn | ~rows["quantity"].isin(rows.loc[drawn, "quantity"])]
    for roles in SPEAKING:
        judged = (
            _judged(row, fine, instead) for _, row in rows[rows["role"].isin(roles)].iterrows()
        )
        if found := [one for one in judged if one is not None]:
            break
    else:
        return None
    _, chosen = min(found, key=lambda pair: pair[0])
    holds = sum(one.verdict == "holds" for _, one in found)
    return replace(chosen, ids=f"{chosen.ids}; {holds} of {len(found)} hold")


SPEAKING = (("trend", "result"), ("calibrated",))
"""Roles of rows: those after the first speak where no row of the first does."""
DRAWN = "(headline)"
"""In the condition of a row that is about the strain energy drawn, where others are about other
definitions.
"""


def _judged(row: pd.Series, fine: Measures, instead: Instead) -> tuple[int, Said] | None:
    """The rank of a row among those that speak, and what it says."""
    about, condition = _plain(row["quantity"]), _plain(row["condition"])
    try:
        if row["form"] == "trend":
            trend = TRENDS[row.name](fine)
            first, *others = trend.note.split("; ")
            failing = [
                part for part in (first, *others) if part.startswith(("not for", "not from"))
            ]
            short = failing[0] if failing else _counted(trend.shown, row)
            long = _plain(joined(*dict.fromkeys((first, *failing[:1])))) or short
            verdict = "holds" if trend.holds else "fails"
            return 2 * trend.holds, Said(row.name, about, condition, verdict, short, long)
        _, value, _, verdict, remark = judged(row, fine, instead)
    except KeyError:
        return None
    if verdict == "not_comparable":
        return None
    units, scale = row["units"], 1.0
    if units == "Pa" and "pressure" in row["quantity"]:
        units, scale = "kPa", 1e-3
    ends = ("low",) if row["form"] == "value" else ("low", "high")
    stated = _shown(" to ".join(f"{scale * row[end]:g}" for end in ends), units)
    axis = "on an axis of " if row["form"] == "axis" else ""
    doubt = ", reading uncertain" if row["kind"] == "garbled" else ""
    condition = joined(condition, "the pad was fitted to it" * (row["role"] == "calibrated"))
    holds = verdict != "outside"
    shown = _shown(scale * value, units)
    remark = re.sub(r"^by \S+ \((.+)\)$", r"\1", remark.partition(", ")[0])
    rank = (4 if holds else 3) if axis else 2 if holds else 1
    return rank, Said(
        row.name,
        f"{about} {axis}{stated}{doubt}",
        condition,
        "holds" if holds else "fails",
        shown,
        ", ".join(filter(None, (shown, remark))),
    )


def _plain(text: object) -> str:
    """Text without the mark that parts the pieces of a statement; nothing for what is missing."""
    return "" if text != text else str(text).replace(" | ", " ").replace(" um", " µm").strip()


def _shown(value: float | str, units: str) -> str:
    text = value if isinstance(value, str) else digits(value)
    return f"R2 {text}" if units == "R2" else text if units == "1" else f"{text} {units}"


def _counted(value: float, row: pd.Series) -> str:
    """The number of a trend where it says something by itself: with its unit, or of how many it
    counts.
    """
    if row["units"] in ("1", "count"):
        return ""
    return _shown(
        f"{value:g} of {row['low']:g}" if row["low"] == row["low"] else value, row["units"]
    )

"""The comparison with the thesis for reading: a page a chapter in five columns. Everything else is
in the CSV beside them.
"""

from __future__ import annotations

import re
from os import PathLike

import pandas as pd

from cysyk1999.claims.comparison import PARTS, summary
from cysyk1999.claims.verdicts import significant
from cysyk1999.publishing.tables import markdown

CHAPTERS = {
    "3": "the specimen and what it was checked by",
    "4": "pressed and held",
    "5": "stroked, and what follows",
}
"""Chapters that have a page; what the thesis sums up in its sixth stands with the fifth."""
ROLES = {
    "result": "Results",
    "trend": "Trends",
    "calibrated": "Numbers that a parameter was chosen by",
    "input": "What went in",
    "count": "Of the model itself",
}
VERDICTS = {
    "trend_holds": "holds",
    "trend_fails": "**fails**",
    "outside": "**outside**",
    "not_comparable": "not comparable",
}


def pages(csv: str | PathLike, reference: pd.DataFrame) -> dict[str, str]:
    """Markdown of the comparison: "" is the first page, which leads to the others, and each other
    is a chapter's by its number.

    Parameters
    ----------
    csv
        The published table.
    reference
        The table of printed numbers, by id.
    """
    table = pd.read_csv(csv, dtype=dict.fromkeys(("figure", "units", "condition", "note"), str))
    axis = table["id"].map(reference["form"]).eq("axis")
    chapter = table["figure"].map(chapter_of)
    said = {key: _page(key, table[chapter == key], axis[chapter == key]) for key in CHAPTERS}
    links = [
        f"- [Chapter {key}: {about}](thesis_comparison_chapter{key}.md): {(chapter == key).sum()} "
        "rows"
        for key, about in CHAPTERS.items()
    ]
    first = ["# The thesis beside the simulations", summary(table, reference), "\n".join(links)]
    first += ["Every row with all its columns: [thesis_comparison.csv](thesis_comparison.csv)."]
    return {"": "\n\n".join(first) + "\n"} | said


def chapter_of(figure: str) -> str:
    """The chapter on whose page a figure, section or equation of the thesis stands."""
    number = re.search(r"\d", figure)[0]
    return number if number in CHAPTERS else max(CHAPTERS)


def _page(key: str, rows: pd.DataFrame, axis: pd.Series) -> str:
    parts = [f"# Chapter {key}: {CHAPTERS[key]}"]
    for role, title in ROLES.items():
        of = rows[rows["role"] == role]
        if len(of):
            lines = [_line(row, bool(axis[index])) for index, row in of.iterrows()]
            parts += [f"## {title}", markdown(pd.DataFrame(lines)).rstrip("\n")]
    return "\n\n".join(parts) + "\n"


def _line(row: pd.Series, on_axis: bool) -> dict[str, str]:
    conditions = f", {row['condition']}" if pd.notna(row["condition"]) else ""
    return {
        "quantity": f"{row['figure']}: {row['quantity']}{conditions} ({row['id']})",
        "thesis": _thesis(row, on_axis),
        "here": _here(row),
        "verdict": VERDICTS.get(row["verdict"], row["verdict"]),
        "why": row["note"] if pd.notna(row["note"]) else "",
    }


def _thesis(row: pd.Series, on_axis: bool) -> str:
    ends = [_number(row[key]) for key in ("thesis_low", "thesis_high") if pd.notna(row[key])]
    if not ends:
        return "as it says"
    said = _with_unit(" to ".join(dict.fromkeys(ends)), row["units"])
    doubt = "?" if row["thesis_kind"] == "garbled" else ""
    return f"{'axis ' if on_axis else ''}{said}{doubt}"


def _here(row: pd.Series) -> str:
    if not pd.notna(row["simulated"]):
        return ""
    said = [
        f"{word} {_number(significant(error, 2))}"
        for part, word in zip(PARTS, ("mesh", "steps", "sampling"), strict=True)
        if pd.notna(error := row[part])
        and error > 0
        and error >= 5e-5 * abs(row["simulated"])  # in one of four digits
    ]
    return _with_unit(_number(row["simulated"]), row["units"]) + f" (± {', '.join(said)})" * bool(
        said
    )


def _with_unit(text: str, unit: str) -> str:
    return text if unit in ("1", "count") else f"{text} {unit}"


def _number(value: float) -> str:
    """Four significant digits, whole numbers in full, thousands apart."""
    return f"{value:,.0f}" if abs(value) >= 1000 else f"{value:.4g}"

"""What the thesis says of a figure and whether it is so here: one verdict a figure, of the rows of
the comparison that are the figure's own.

It holds where all of them hold, fails where all fail, and else holds in part; the parts are named.
A number that another figure shows too speaks for both. What a parameter was chosen by does not
speak; of what holds by construction that is said, where nothing else is.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import pandas as pd

from cysyk1999.claims.comparison import judged_row, judged_rows
from cysyk1999.measures.table import Instead, Measures

LEADS = {
    "holds": "Thesis: holds here",
    "fails": "Thesis: fails here",
    "partly": "Thesis: holds here in part",
    "not judged": "Thesis: holds by construction, not judged",
}
"""Verdicts on a figure, and how a sentence on it begins."""


@dataclass(frozen=True)
class Said:
    """A verdict on a figure.

    Attributes
    ----------
    verdict : a key of `LEADS`.
    holds, fails : the parts of what the thesis says, named.
    agree, judged, fitted : how many statements hold, of how many, and how many of these the pad was
        fitted to.
    """

    verdict: str
    holds: tuple[str, ...]
    fails: tuple[str, ...]
    agree: int = 0
    judged: int = 0
    fitted: int = 0

    @property
    def texts(self) -> tuple[str, ...]:
        """It in words: whole, without what holds, without details, and without the parts."""
        count = "" if self.judged < 2 else f", {self.agree} of {self.judged}"
        whole = LEADS[self.verdict] + count * (self.verdict == "partly")
        of = "it" if self.judged == 1 else f"{self.fitted} of them"
        of = "all of them" if self.judged == self.fitted > 1 else of
        fitted = f" The pad was fitted to {of}." * (self.fitted > 0)
        fails = bare = holds = ""
        if self.verdict == "partly":
            fails, holds = f" Fails: {'; '.join(self.fails)}.", f" Holds: {'; '.join(self.holds)}."
            bare = re.sub(r" \([^()]*\)", "", fails)
        elif self.fails or self.holds:
            whole += f": {'; '.join(self.fails or self.holds)}"
        short = re.sub(r" \([^()]*\)", "", whole)
        found = (
            f"{whole}.{fails}{holds}{fitted}",
            f"{whole}.{fails}{fitted}",
            f"{short}.{bare}",
            LEADS[self.verdict] + f"{count}.",
        )
        return tuple(dict.fromkeys(found))


def said(number: str, fine: Measures, instead: Instead, reference: pd.DataFrame) -> Said | None:
    """The verdict on a figure of a number (``4-10``), as far as the measures know its scenes; None
    where the thesis says nothing of it that can be judged.

    fine, instead: measures of the histories, and of what tells their errors. reference: of
    `read_reference`.
    """
    entries = reference[reference["figure"].eq(number) & reference["role"].isin(SPEAKING)]
    rows = [judged_row(entry, fine, instead, reference) for _, entry in entries.iterrows()]
    return figure_verdicts(pd.DataFrame(rows), reference).get(number) if rows else None


SPEAKING = ("trend", "result")
"""Roles of the rows that speak for the model."""


def figure_verdicts(table: pd.DataFrame, reference: pd.DataFrame) -> dict[str, Said]:
    """The verdict on every figure, by its number, of rows of the comparison."""
    rows = judged_rows(table, reference)
    rows = rows[rows["role"].isin(SPEAKING)]
    score, why = (rows["id"].map(reference[key]) for key in ("score", "reason"))
    speaks, trivial = score.ne("none"), score.eq("none") & why.eq("by_construction")
    found = {
        figure: Said("not judged", _parts(group), ())
        for figure, group in rows[trivial].groupby("figure")
    }
    for figure, group in rows[speaks].assign(fitted=score.eq("fitted")).groupby("figure"):
        agrees = group["agrees"]
        verdict = "holds" if agrees.all() else "partly" if agrees.any() else "fails"
        sides = [
            tuple(
                part
                for _, of in group.groupby(["quantity", "kind"], sort=False)
                if (part := _part(of, side))
            )
            for side in (True, False)
        ]
        counts = int(agrees.sum()), len(group), int(group["fitted"].sum())
        found[figure] = Said(verdict, *sides, *counts)
    return found


def _parts(group: pd.DataFrame) -> tuple[str, ...]:
    return tuple(dict.fromkeys(map(_plain, group["quantity"])))


def _part(rows: pd.DataFrame, side: bool) -> str:
    """The name of what is said of one quantity, as far as it agrees or, the other `side`, does not;
    with the conditions where there is both, and with what the note of a single row tells of it.
    """
    of = rows[rows["agrees"] == side]
    if of.empty:
        return ""
    name = "axis of " * (of["kind"].iloc[0] == "axis") + _plain(of["quantity"].iloc[0])
    if len(of) < len(rows):
        return f"{name}: {', '.join(map(_short, of['condition']))}"
    if len(of) > 1:
        return name
    note = str(of["note"].iloc[0])
    if of["kind"].iloc[0] == "trend":
        detail = re.search(r"(?:^|; )(holds for .*?; fails for [^;]*)", note)
        return f"{name} ({detail[1]})" if detail else name
    detail = re.match(r"by \S+ \((.+?)\)|(\d+% (?:above|below)[^,;:]*)", note)
    return f"{name} ({detail[1] or detail[2]})" if detail and not side else name


def _short(condition: object) -> str:
    """The first words of a condition, a curvature without its unit."""
    return re.sub(r"K = (\d+)( 1/m)?", r"\1", _plain(condition).partition(";")[0])


def _plain(text: object) -> str:
    """Text with the sign of a micrometre; nothing for what is missing."""
    return "" if text != text else str(text).replace(" um", " µm").strip()

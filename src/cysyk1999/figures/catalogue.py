"""Every figure of the thesis: which are made here, which cannot be, and what stands in for these
(``figures/README.md``).
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Protocol

from pandas import DataFrame

from cysyk1999.publishing.tables import markdown
from cysyk1999.reference_data import TEXT, one_of, read_table

CATALOGUE = {
    "number": TEXT,
    "kind": one_of("simulation", "comparison", "recording", "photograph", "schematic"),
    "thesis_shows": TEXT,
    "stand_in": TEXT.or_nothing,
}
"""Columns of ``config/reference/figures.csv``: what the thesis's figure is, and what is here in
place of what is not public.
"""

DRAWABLE = ("simulation", "comparison")
"""Kinds that need no more than this model to be drawn, a comparison without what was recorded. So
do recordings predicted.
"""


class Judged(Protocol):
    """A verdict on a figure: in one word, and in texts from whole to short."""

    verdict: str
    texts: tuple[str, ...]


def read_catalogue(path: str | PathLike) -> DataFrame:
    """The thesis's figures in its order, columns of :data:`CATALOGUE`.

    Raises
    ------
    ReferenceDataError
        A cell is wrong.
    ValueError
        A number is given twice, or nothing stands in for a figure that cannot be drawn.
    """
    table = read_table(path, CATALOGUE)
    for number in table["number"][table["number"].duplicated()]:
        raise ValueError(f"{path}: figure {number} is given twice")
    bare = table[~table["kind"].isin(DRAWABLE) & (table["stand_in"] == "")]
    for row in bare.itertuples():
        raise ValueError(
            f"{path}: figure {row.number} is a {row.kind} and nothing stands in for it"
        )
    return table


def readme(catalogue: DataFrame, made: Mapping[str, str], judged: Mapping[str, Judged]) -> str:
    """Text of ``figures/README.md``.

    made: the figures that are drawn, number -> title. judged: number -> the verdict on what the
    thesis says of it; figures of which it says nothing that can be judged are not in it.
    """
    drawn = catalogue["number"].isin(list(made))
    drawable = catalogue["kind"].isin(DRAWABLE) | catalogue["stand_in"].str.startswith("predicted")
    head = "kind in the thesis", "in place of what is not public"
    here = [
        (f"[{n}](thesis/fig_{n}.png)", made[n], _verdict(n, judged), kind, stand_in)
        for n, kind, stand_in in catalogue.loc[drawn, ["number", "kind", "stand_in"]].to_numpy()
    ]
    columns = {"number": "figure", "thesis_shows": "thesis shows", "kind": "kind"}
    missing = catalogue[~drawn].rename(columns=columns | {"stand_in": "stands in"})
    never, later = missing[~drawable[~drawn]], missing[drawable[~drawn]]
    parts = [
        "# Figures",
        "Written by the workflow from `config/reference/figures.csv`, the titles of the figures "
        "drawn and the table that compares them with the thesis; do not edit.",
        f"The thesis (Cysyk 1999) has {len(catalogue)} figures. {len(here)} are drawn here from "
        "simulations, on the thesis's axes, each with the plotted data beside it "
        "(`thesis/fig_*.csv`). None of the thesis's recordings and photographs is public: no "
        "recording is drawn, and a figure that stands in for one says *predicted* in the picture. "
        "*Verdict*: whether the thesis's numbers, ranges, axes and trends that belong to a figure "
        "hold here, as it says below the picture.",
        "## Drawn here",
        markdown(DataFrame(here, columns=["figure", "shows", "verdict", *head])).rstrip(),
        "## Not drawn, and what stands in",
        markdown(never[[*columns.values(), "stands in"]]).rstrip(),
    ]
    if len(later):
        parts += ["## Not drawn yet", markdown(later[list(columns.values())]).rstrip()]
    parts += [
        "## Beyond the thesis",
        "`tables/`: numbers, as CSV and Markdown. `studies/`: calibration, moving pictures and "
        "further studies.",
    ]
    return "\n\n".join(parts) + "\n"


def _verdict(number: str, judged: Mapping[str, Judged]) -> str:
    """``partly``, with a link to the rows, and the parts; nothing where the thesis says nothing
    that can be judged.
    """
    if number not in judged:
        return ""
    link = f"[{judged[number].verdict}](tables/thesis_comparison_chapter{number[0]}.md)"
    return f"{link}. {judged[number].texts[0]}"

"""Pictures of two tables: the comparison with the thesis, and candidate stimuli."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.claims.comparison import KINDS, judged_rows
from cysyk1999.claims.verdicts import FILL
from cysyk1999.publishing.style import (
    CATEGORIES,
    GREY,
    MARKERS,
    MEANINGS,
    TALLEST,
    study_figure,
    styled,
)
from cysyk1999.publishing.write import publish
from cysyk1999.reference_data import read_reference

LEAST, MOST = 0.25, 4.0
"""Ends of the axis of the scorecard."""
SHORT = {
    "strain energy density": "energy",
    "strain energy rate": "energy rate",
    "contact of the centre with": "contact with",
    "contact pressure": "pressure",
    "instantaneous frequency": "frequency",
    "vertical displacement of the skin": "sinking",
    "larger of 0.04 x centre pressure and": "0.04 pressure or",
    "mean rate of the hold": "mean rate",
    " um": " µm",
}
"""Words of the comparison -> shorter ones."""


def scorecard_rows(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """The stated numbers, ranges and axes that count: where the simulated number lies, as a share
    of the thesis's number or of the end of its range or axis, and the ends of what is judged right.
    """
    rows = judged_rows(table, reference).query("score != '' and kind != 'trend'")
    known = reference.loc[rows["id"]].set_index(rows.index)
    end = known["high"].where(rows["kind"] != "value", known["low"])
    axis, slack = rows["kind"].eq("axis"), known["tolerance"].fillna(0)
    low = known["tick"].fillna(FILL * end).where(axis, known["low"] * (1 - slack))
    high = end * (1 + slack.where(rows["kind"].eq("value"), 0))
    rows = rows.assign(uncertain=rows["thesis_kind"].eq("garbled"))
    for name, value in (("relative", rows["simulated"]), ("low", low), ("high", high)):
        rows[f"{name} (1)"] = value / end
    chapter = rows["figure"].map(lambda name: [int(part) for part in name.split("-")])
    columns = ["id", "figure", "quantity", "condition", "kind", "score", "agrees"]
    columns += ["relative (1)", "low (1)", "high (1)", "uncertain"]
    rows = rows.loc[chapter.sort_values(kind="stable").index, columns]
    return rows.sort_values("kind", key=lambda kind: kind.eq("axis"), kind="stable")


@styled
def scorecard(frame: pd.DataFrame) -> Figure:
    """Every stated number, range and axis of the thesis that counts, a dot a row."""

    def counted(rows: pd.DataFrame) -> str:
        """How many agree, by kind."""
        groups = ((names, rows.loc[rows["kind"] == kind, "agrees"]) for kind, names in of.items())
        return ", ".join(f"{good.sum()} of {len(good)} {names}" for names, good in groups)

    of = {kind: names for kind, names in KINDS.items() if kind != "trend"}
    held_out = frame[frame["score"] == "held out"]
    title = f"The thesis against this model: {counted(frame)} agree"
    note = (
        f"Of what the pad was not fitted to (circles) {counted(held_out)}. Squares: fitted. Grey: "
        "what is judged right (of an axis from its last tick but one, where it is known, to its "
        "end; broken: reading uncertain). Filled blue: right; open orange: not. Nothing that was "
        "put in or holds by construction."
    )
    fig = study_figure(title, [note], TALLEST)
    axes = fig.subplots(1, 3)
    on_axis = frame["kind"] == "axis"
    stated, rest = frame[~on_axis], frame[on_axis]
    half = int(np.ceil(len(rest) / 2))
    parts = stated, rest[:half], rest[half:]
    for ax, part, name in zip(axes, parts, ("number or range", "axis", "axis"), strict=True):
        for y, row in enumerate(part.to_dict("records")):
            ends = [max(row["low (1)"], LEAST), row["high (1)"]]
            grey = {"color": "0.75", "ls": "-"}
            if row["uncertain"]:
                grey = {"color": "0.8", "ls": (0, (0.7, 0.5))}
            ax.plot(ends, [y, y], lw=2.4, solid_capstyle="butt", zorder=1, **grey)
            colour = MEANINGS["verdict"]["inside" if row["agrees"] else "outside"]["color"]
            dot = {"mec": colour, "mfc": colour if row["agrees"] else "white", "mew": 0.8}
            mark = "s" if row["score"] == "fitted" else "o"
            ax.plot(np.clip(row["relative (1)"], LEAST, MOST), y, mark, ms=2.3, zorder=3, **dot)
        _name_figures(ax, part)
        ax.axvline(1, color=GREY, lw=0.5, zorder=0)
        ax.set(
            xscale="log", xlim=(LEAST * 0.9, MOST * 1.1), ylim=(len(part) - 0.4, -0.6), yticks=[]
        )
        ax.set_xlabel(f"share of the end of\nthe thesis's {name}")
        ticks = (0.25, 0.5, 1, 2, 4)
        ax.set_xticks(ticks, map(str, ticks), fontsize=6)
        ax.minorticks_off()
    return fig


def _name_figures(ax, part: pd.DataFrame) -> None:
    """The figure and quantity of every group of rows, left of them, on bands of two greys."""
    group = part["figure"].ne(part["figure"].shift()).cumsum().to_numpy()
    for k in np.unique(group):
        rows, places = part[group == k], np.flatnonzero(group == k)
        begin, end = places[0] - 0.5, places[-1] + 0.5
        shade = "white" if k % 2 else "0.965"
        ax.axhspan(begin, end, color=shade, lw=0, zorder=0)
        quantity = rows["quantity"].mode()[0]
        for words, short in SHORT.items():
            quantity = quantity.replace(words, short)
        lines = textwrap.wrap(f"{rows['figure'].iloc[0]} {quantity}", 29 if len(rows) > 1 else 36)
        if len(rows) > 2:
            lines.append(f"{len(rows)} numbers")
        look = {"ha": "right", "va": "center", "fontsize": 6, "linespacing": 1.0}
        place = {"transform": ax.get_yaxis_transform()}
        ax.text(-0.03, (begin + end) / 2, "\n".join(lines), **look, **place)


def candidate_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Ranked candidates of every set of recorded rates: how much of the rates each explains, and
    the range by how they are read.
    """
    # recorded ones, not another model's
    rows = table[table["rank"].notna() & ~table["rates"].str.startswith("TouchSim")]
    numbers = ["r_squared", "r_squared_low", "r_squared_high", "rates used", "rank"]
    shown = rows[["rates", "candidate", "depth", *numbers]]
    return shown.rename(columns={name: f"{name} (1)" for name in numbers})


OF_SPHERES = "Goodwin"
"""How sets of recordings begin whose surfaces were spheres or, in most of a set, may have been."""


@styled
def candidate_stimuli(frame: pd.DataFrame) -> Figure:
    """Candidates for what a slowly adapting receptor responds to, ranked by the recorded rates they
    explain: recorded under cylinders, as simulated, and under spheres.
    """
    share = "r_squared (1)"
    spheres = frame["rates"].str.startswith(OF_SPHERES)
    of = {
        "recorded under cylinders": frame[~spheres],
        "under spheres, or most of them": frame[spheres],
    }
    order = frame.groupby("candidate")[share].median().sort_values(ascending=False).index
    note = (
        "Share of the variance of recorded mean rates that a linear law of the simulated stimulus, "
        "always a cylinder, explains (bars: the ways to read which surface a rate is of). Spheres "
        "need a model with spheres: b ranks nothing. Ordered by the median of all. Few rates, of "
        "monkeys: an order, not a proof."
    )
    best, worst = (
        part.loc[how(part[share])]
        for part in (of["recorded under cylinders"],)
        for how in (pd.Series.idxmax, pd.Series.idxmin)
    )
    title = (
        f"Of rates recorded under cylinders {_times(best['candidate'])} explains most (R² "
        f"{best[share]:.2f}), {_times(worst['candidate'])} least ({max(worst[share], 0):.2f})"
    )
    fig = study_figure(title, [note], 3.3)
    axes, looks = fig.subplots(1, 2, sharey=True, width_ratios=(1, 1.2)), iter(range(9))
    for ax, (words, part) in zip(axes, of.items(), strict=True):
        _candidates(ax, part, order, share, looks)
        ax.set_title(words)
    axes[0].set_yticks(range(len(order)), map(_times, order))
    axes[0].set_ylim(len(order) - 0.5, -0.5)
    return fig


def _times(candidate: str) -> str:
    return candidate.replace(" x ", " × ")


def _candidates(ax, frame: pd.DataFrame, order: pd.Index, share: str, looks: Iterator[int]) -> None:
    """One marker a candidate and set of rates."""
    sets = frame["rates"].unique()
    for k, (name, look) in enumerate(zip(sets, looks, strict=False)):
        rows = frame[frame["rates"] == name].set_index("candidate").reindex(order)
        value, y = rows[share], np.arange(len(order)) + 0.15 * (k - (len(sets) - 1) / 2)
        ends = [value - rows["r_squared_low (1)"], rows["r_squared_high (1)"] - value]
        own = {"color": CATEGORIES[look % len(CATEGORIES)], "fmt": MARKERS[look % len(MARKERS)]}
        own |= {"xerr": np.clip(ends, 0, None), "ms": 3.0, "elinewidth": 0.8}
        label = f"{name} ({rows['rates used (1)'].max():.0f} rates)"
        ax.errorbar(value.clip(lower=0), y, label=label, **own)
    for k in range(len(order) - 1):
        ax.axhline(k + 0.5, color="0.92", lw=0.5, zorder=0)
    ax.set(xlim=(0, 1.01), xlabel="variance explained, R²")
    ax.tick_params(axis="y", length=0)
    ax.legend(loc="upper left", bbox_to_anchor=(0.0, -0.2), ncols=1)


def table_pictures(job: SimpleNamespace) -> None:
    """Job: `tables`, `reference` -> `pictures`: scorecard of thesis_comparison, candidate_stimuli
    of the table of that name.
    """
    tables = {Path(path).stem: pd.read_csv(path) for path in job.tables}
    for path in job.pictures:
        if Path(path).stem == "scorecard":
            reference = read_reference(job.reference[0])
            frame = scorecard_rows(tables["thesis_comparison"], reference)
            publish(scorecard(frame), frame, path)
        else:
            frame = candidate_rows(tables["candidate_stimuli"])
            publish(candidate_stimuli(frame), frame, path)

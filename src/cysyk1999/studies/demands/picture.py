"""What accuracy costs, how hard cases end, what effects cost and change: one panel each, drawn from
the tables of the studies of accuracy, stability and effects.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from pandas import DataFrame

from cysyk1999.figures.findings import n
from cysyk1999.publishing.style import (
    CATEGORIES,
    COLUMN_WIDTH,
    HIGHLIGHT,
    INK,
    PALE,
    study_figure,
    styled,
)
from cysyk1999.publishing.write import publish

TABLES = {
    "demand_accuracy": ("presets", "accuracy_belief"),
    "demand_stability": ("stability",),
    "demand_effects": ("effects",),
}
"""Picture -> the tables that it is drawn from."""
NAME, TIME, ERROR, ASKED = "name", "process time (s)", "error (%)", "asked for (%)"
PLANNED, CHANGE, COST = "planned", "change (%)", "cost ratio"
ENDS = {
    "stable": "stable",
    "healed": "healed by itself",
    "labours": "right, but laboured",
    "admits its error": "says that it is wrong",
    "fails cleanly": "stopped, said why",
    "wrong": "wrong",
    "not done": "not done in 2 min",
}
"""Outcome in the table -> in the picture; any other outcome is wrong."""
COLOURS = dict(
    zip(
        ENDS,
        (PALE, "#9fc3d6", "#6b9ab8", HIGHLIGHT, "#003a5d", CATEGORIES[1], "white"),
        strict=True,
    )
)
SAVED = {"symmetry": "half the pad only (saves time)"}
"""What is switched on to save time: there, on should change nothing."""
LEAST = 1e-3  # %, of a change that is drawn


# --- what accuracy costs --------------------------------------------------------------------------


def accuracy_rows(presets: DataFrame, belief: DataFrame) -> DataFrame:
    """One row a preset and a tolerance: the median time and the worst error of any quantity of any
    scene; of a tolerance also what was asked for.
    """
    rows = [
        {NAME: name, TIME: part[TIME].median(), ERROR: part[ERROR].max(), "scenes": len(part)}
        for name, part in presets.groupby("preset", sort=False)
    ]
    of = belief[pd.to_numeric(belief["accuracy"], errors="coerce").notna()]
    for asked, part in of.groupby("accuracy", sort=False):
        row = {NAME: f"accuracy: {asked}", ASKED: 100 * float(asked), "scenes": len(part)}
        rows.append(row | {TIME: part[TIME].median(), ERROR: part["true error (%)"].max()})
    return DataFrame(rows).sort_values(TIME, ignore_index=True)


@styled
def accuracy(frame: DataFrame) -> Figure:
    """Worst error of any quantity against the time of a run."""
    presets, asked = frame[frame[ASKED].isna()], frame[frame[ASKED].notna()]
    first, last = presets.iloc[0], presets.iloc[-1]
    title = (
        f"From {n(first[TIME])} to {n(last[TIME])} s a run the worst error goes from "
        f"{n(first[ERROR])} to {n(last[ERROR])} %; runs asked for "
        f"{_listed(asked[ASKED])} % are wrong by at most {_listed(asked[ERROR])} %"
    )
    note = (
        "Simulated: the worst of depth, width, pressure and strain energy, against a finer run. "
        f"Line: presets, {presets['scenes'].max():g} scenes. Diamonds: tolerances, "
        f"{asked['scenes'].max():g} other scenes; bars reach to what was asked for. Time: median."
    )
    fig = study_figure(title, [note], 3.0, COLUMN_WIDTH)
    ax = fig.subplots()
    ax.loglog(presets[TIME], presets[ERROR], "o-", color=INK, ms=5, lw=1.0)
    ax.vlines(asked[TIME], asked[ERROR], asked[ASKED], color=HIGHLIGHT, lw=0.8)
    ax.plot(asked[TIME], asked[ASKED], "_", color=HIGHLIGHT, ms=8)
    ax.plot(asked[TIME], asked[ERROR], "D", color=HIGHLIGHT, ms=4.5)
    for row in frame.to_dict("records"):
        diamond = row[ASKED] == row[ASKED]
        away = {"xytext": (-6, -2) if diamond else (6, 3), "ha": "right" if diamond else "left"}
        ax.annotate(row[NAME], (row[TIME], row[ERROR]), textcoords="offset points", **away)
    ax.set(xlabel="time of a run, one thread (s)", ylabel="worst error of any quantity (%)")
    ax.set_xlim(frame[TIME].min() / 6, frame[TIME].max() * 2.5)
    ax.set_ylim(0.6 * frame[ERROR].min(), 1.5 * frame[[ERROR, ASKED]].max(axis=None))
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(LogLocator(10, (1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(NullLocator())
    return fig


def _listed(values: pd.Series) -> str:
    return " or ".join(map(n, values))


# --- how hard cases end ---------------------------------------------------------------------------


def stability_rows(table: DataFrame) -> DataFrame:
    """One row a kind of hardness: how many cases ended how."""
    ends = table["with remedies" if "with remedies" in table else "outcome"]
    ends = ends.where(ends.isin(list(ENDS)), "wrong")
    counts = pd.crosstab(table["group"], ends).reindex(columns=list(ENDS), fill_value=0)
    share = counts["stable"] / counts.sum(axis=1)
    return counts.loc[share.sort_values(kind="stable").index].reset_index()


@styled
def stability(frame: DataFrame) -> Figure:
    """One bar a kind of hardness."""
    counts = frame.set_index("group")[list(ENDS)]
    total = counts.sum()
    said = total["admits its error"] + total["fails cleanly"]
    ends = {"are stable": total["stable"], "heal": total["healed"], "labour": total["labours"]}
    ends["stop or say that they are wrong"] = said
    listed = ", ".join(f"{count} {words}" for words, count in ends.items() if count)
    wrong = total["wrong"] or "none"
    title = (
        f"Of {total.sum()} hard cases {listed}, and {wrong} "
        f"{'are' if total['wrong'] > 1 else 'is'} silently wrong"
    )
    how = "with what a run relaxes by itself" if total["healed"] else "as planned"
    note = f"Simulated: the catalogue of hard cases, on a draft's mesh, {how}."
    fig = study_figure(title, [note], 4.2)
    ax, start = fig.subplots(), np.zeros(len(counts))
    for outcome, words in ENDS.items():
        if total[outcome]:
            look = {"color": COLOURS[outcome], "ec": INK, "lw": 0.4, "height": 0.72}
            bars = ax.barh(counts.index, counts[outcome], left=start, label=words, **look)
            dark = outcome in ("admits its error", "fails cleanly", "wrong")
            if dark:
                labels = [f"{count}" * (count > 0) for count in counts[outcome]]
                inside = {"label_type": "center", "color": "white", "fontsize": 6}
                ax.bar_label(bars, labels, **inside)
            start += counts[outcome].to_numpy()
    ax.set(xlim=(0, start.max()), xlabel="cases", ylim=(-0.6, len(counts) - 0.4))
    ax.tick_params(axis="y", length=0)
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=4, borderaxespad=0.2)
    return fig


# --- what effects cost and change -----------------------------------------------------------------


def effects_rows(table: DataFrame) -> DataFrame:
    """One row an effect, carried or left out: the largest change, the greatest cost ratio, and how
    many choices of the planner were wrong, of how many.
    """
    drawn = table["scene"].str.extract(r"^(\d+) drawn", expand=False).astype(float)
    columns = {CHANGE: 100 * table["change"], PLANNED: table[PLANNED] == "on", "choices": drawn}
    groups = table.assign(**columns).groupby(["effect", PLANNED], sort=False)
    wrong = ["wrongly left out", "carried for nothing"]
    most = groups[[CHANGE, COST]].max()
    return most.join(groups[["choices", *wrong]].sum()).reset_index()


@styled
def effects(frame: DataFrame) -> Figure:
    """One bar an effect, and a pale one where it is left out."""
    planned = frame[PLANNED].astype(str) == "True"
    saving = frame["effect"].isin(list(SAVED))
    out, on = frame[~planned & ~saving], frame[planned & ~saving]
    wrong = int(frame[["wrongly left out", "carried for nothing"]].sum(axis=None))
    title = (
        f"Effects that are carried change a result by up to {n(on[CHANGE].max())} %, those left "
        f"out would by {n(out[CHANGE].max())} % at most; {wrong} of "
        f"{int(frame['choices'].sum())} choices are wrong"
    )
    note = (
        "Simulated: the largest change of any headline quantity over its largest value, in scenes "
        "of the catalogue and drawn at random; cost of a run with the effect over without. Half "
        "the pad: how wrong it is, used where the plan uses it and where it does not."
    )
    fig = study_figure(title, [note], 3.1)
    ax = fig.subplots()
    names = list(dict.fromkeys(frame["effect"]))[::-1]
    for shift, mask, face, words in (
        (0.2, planned, HIGHLIGHT, "planned (carried)"),
        (-0.2, ~planned, "white", "not planned (left out)"),
    ):
        rows = frame[mask]
        places = rows["effect"].map(names.index) + shift
        wide = rows[CHANGE].clip(lower=1.5 * LEAST)
        ax.barh(places, wide, 0.36, left=0, fc=face, ec=INK, lw=0.5, label=words)
        for y, row in zip(places, rows.to_dict("records"), strict=True):
            cost = f", costs × {row[COST]:.2g}" if row[COST] == row[COST] else ""
            _say(ax, row[CHANGE], y, f"{n(row[CHANGE])} %{cost}")
    titles = [SAVED.get(name, name.replace("_", " ")) for name in names]
    ax.set_yticks(range(len(names)), titles)
    ax.set(xscale="log", xlim=(LEAST, 4e3), xlabel="largest change of a result (%)")
    ax.xaxis.set_major_formatter("{x:g}")
    ax.tick_params(axis="y", length=0)
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, borderaxespad=0.2)
    return fig


def _say(ax: Axes, x: float, y: float, text: str) -> None:
    """Words beside a bar's end."""
    at = (max(x, 1.5 * LEAST), y)
    ax.annotate(text, at, (3, 0), textcoords="offset points", va="center", fontsize=6)


STUDIES: dict[str, Callable[[DataFrame], Figure]] = {
    "demand_accuracy": accuracy,
    "demand_stability": stability,
    "demand_effects": effects,
}
ROWS: dict[str, Callable[..., DataFrame]] = {
    "demand_accuracy": accuracy_rows,
    "demand_stability": stability_rows,
    "demand_effects": effects_rows,
}


def draw_demand(job: SimpleNamespace) -> None:
    """Job: `tables` (CSV) -> `picture`, of the name that the picture's file has."""
    path = Path(job.picture[0])
    frame = ROWS[path.stem](*map(pd.read_csv, job.tables))
    publish(STUDIES[path.stem](frame), frame, path)

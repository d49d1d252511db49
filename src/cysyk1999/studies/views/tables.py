"""Pictures of two tables: the comparison with the thesis, and candidate stimuli."""

from __future__ import annotations

import textwrap
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

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

WITHIN = ("inside", "plausible")
"""Verdicts on numbers that are met."""
LEAST, MOST = 0.25, 4.0
"""Ends of the axis of the scorecard."""
SHORT = {
    "strain energy density": "energy",
    "contact pressure": "pressure",
    "instantaneous frequency": "frequency",
    "vertical displacement of the skin": "sinking",
    "larger of 0.04 x centre pressure and": "0.04 pressure or",
    "mean rate of the hold": "mean rate",
    " um": " µm",
}
"""Words of the comparison -> shorter ones."""


def scorecard_rows(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """Rows of the comparison that are results with a number: where the simulated one lies, as a
    share of the thesis's number, or of the end of its axis or range.
    """
    judged = table["role"].eq("result") & table["verdict"].ne("not_comparable")
    rows = table[judged & table["simulated"].notna()].copy()
    rows["form"] = rows["id"].map(reference["form"])
    end = rows["thesis_high"].where(rows["form"] != "value", rows["thesis_low"])
    rows["relative (1)"] = rows["simulated"] / end
    forms = [rows["form"] == form for form in ("range", "axis")]
    rows["low (1)"] = np.select(forms, [rows["thesis_low"] / end, 0.5], 1.0)
    rows["uncertain"] = rows["thesis_kind"].eq("garbled")
    number = rows["figure"].map(lambda name: [int(part) for part in name.split("-")])
    columns = ["id", "figure", "quantity", "condition", "form"]
    columns += ["relative (1)", "low (1)", "verdict", "uncertain"]
    return rows.loc[number.sort_values(kind="stable").index, columns]


@styled
def scorecard(frame: pd.DataFrame) -> Figure:
    """Every number of the thesis that is a result, a dot a row."""
    inside = frame["verdict"].isin(WITHIN).sum()
    title = (
        f"Every number of the thesis against this model: {inside} of {len(frame)} within its range"
    )
    note = (
        "Simulated over the thesis's number, or over the end of its range or axis (grey: a number, "
        "a range, or half an axis to its end; broken: reading uncertain). Filled blue: within; "
        "open orange: outside. Results only: nothing that was put in or fitted."
    )
    fig = study_figure(title, [note], TALLEST)
    axes = fig.subplots(1, 3)
    size = int(np.ceil(len(frame) / len(axes)))
    for k, ax in enumerate(axes):
        part = frame.iloc[k * size : (k + 1) * size]
        for y, row in enumerate(part.to_dict("records")):
            ends = (0.97, 1.03) if row["low (1)"] == 1 else (max(row["low (1)"], LEAST), 1.0)
            grey = {"color": "0.75", "ls": "-"}
            if row["uncertain"]:
                grey = {"color": "0.8", "ls": (0, (0.7, 0.5))}
            ax.plot(ends, [y, y], lw=2.4, solid_capstyle="butt", zorder=1, **grey)
            within = row["verdict"] in WITHIN
            colour = MEANINGS["verdict"]["inside" if within else "outside"]["color"]
            dot = {"mec": colour, "mfc": colour if within else "white", "mew": 0.8, "ms": 2.3}
            ax.plot(np.clip(row["relative (1)"], LEAST, MOST), y, "o", zorder=3, **dot)
        _name_figures(ax, part)
        ax.axvline(1, color=GREY, lw=0.5, zorder=0)
        ax.set(xscale="log", xlim=(LEAST * 0.9, MOST * 1.1), ylim=(size - 0.4, -0.6), yticks=[])
        ax.set_xlabel("simulated over thesis")
        ticks = (0.25, 0.5, 1, 2, 4)
        ax.set_xticks(ticks, map(str, ticks), fontsize=5.5)
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
        lines = textwrap.wrap(f"{rows['figure'].iloc[0]} {quantity}", 29)
        if len(rows) > 2:
            lines.append(f"{len(rows)} numbers")
        look = {"ha": "right", "va": "center", "fontsize": 5.6, "linespacing": 1.05}
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


@styled
def candidate_stimuli(frame: pd.DataFrame) -> Figure:
    """Candidates for what a slowly adapting receptor responds to, ranked by the recorded rates they
    explain.
    """
    sets, share = frame["rates"].unique(), "r_squared (1)"
    order = frame.groupby("candidate")[share].median().sort_values(ascending=False).index
    note = (
        "Share of the variance of recorded mean rates that a linear law of the simulated stimulus "
        "explains (bars: the ways to read which surface a rate is of); ordered by the median of "
        "the sets. Few rates, of monkeys, most under spheres: an order, not a proof."
    )
    title = (
        "What does a slowly adapting receptor respond to? Candidate stimuli against recorded rates"
    )
    fig = study_figure(title, [note], 3.3)
    ax = fig.subplots()
    for k, name in enumerate(sets):
        rows = frame[frame["rates"] == name].set_index("candidate").reindex(order)
        value, y = rows[share], np.arange(len(order)) + 0.15 * (k - (len(sets) - 1) / 2)
        ends = [value - rows["r_squared_low (1)"], rows["r_squared_high (1)"] - value]
        look = {"color": CATEGORIES[k % len(CATEGORIES)], "fmt": MARKERS[k % len(MARKERS)]}
        look |= {"xerr": np.clip(ends, 0, None), "ms": 3.0, "elinewidth": 0.8}
        label = f"{name} ({rows['rates used (1)'].max():.0f} rates)"
        ax.errorbar(value.clip(lower=0), y, label=label, **look)
    for k in range(len(order) - 1):
        ax.axhline(k + 0.5, color="0.92", lw=0.5, zorder=0)
    ax.set_yticks(range(len(order)), [name.replace(" x ", " × ") for name in order])
    ax.set(xlim=(0, 1.01), ylim=(len(order) - 0.5, -0.5), xlabel="variance explained, R²")
    ax.tick_params(axis="y", length=0)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return fig


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

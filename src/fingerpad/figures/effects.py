"""Figure of the study of effects: what each changes and costs, and the planner's choices against that."""

from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fingerpad.figures.style import GREY, INK, PAGE_WIDTH, spread, styled

LEAST = 1e-6
"""Smaller changes are drawn here."""
NAMES = {
    "symmetry": "symmetry (half the pad)",
    "viscoelasticity": "viscoelasticity",
    "finite_strain": "finite strain",
    "friction": "friction",
    "ridges": "ridges",
    "local refinement": "local refinement",
    "full-field output": "full-field output",
}
MARKERS = dict(zip(NAMES, "so^DvPX", strict=True))
COLOURS = dict(zip(NAMES, mpl.colormaps["viridis"](np.linspace(0, 0.85, len(NAMES))), strict=True))


def assemble(pairs: pd.DataFrame, found: pd.DataFrame) -> pd.DataFrame:
    """Plotted rows: panel changes (of :func:`fingerpad.studies.effects.study`) and panel planner (of ``verdicts``)."""
    return pd.concat([pairs.assign(panel="changes"), found.assign(panel="planner")], ignore_index=True)


@styled
def effects(frame: pd.DataFrame) -> Figure:
    """Left, change over cost ratio of each effect; right, what each choice of the planner is worth over the accuracy."""
    height = 5.2
    fig = Figure(figsize=(PAGE_WIDTH, height))
    fig.text(0.012, 1 - 0.09 / height, "What effects change and cost", ha="left", va="top", fontweight="bold", fontsize=9.5)
    scenes = frame.loc[frame["panel"] == "planner", "scene"].nunique()
    note = (
        "Simulated on draft meshes, each effect with and without on the same mesh. Change: largest of depth, force, width,\n"
        "centre pressure, strain energy and, in strokes, tangential force and lateral displacement, over its largest value.\n"
        f"Cost: process time with over without. Right: {scenes} scenes drawn at random, planned at the accuracy each asks for,\n"
        "and one effect flipped. Left out may be worth up to the accuracy (line), carried should be worth a tenth of it (dashed)."
    )
    fig.text(0.012, 0.06 / height, note, ha="left", va="bottom", fontsize=7, color=GREY, linespacing=1.35)
    grid = fig.add_gridspec(
        1, 2, left=0.085, right=0.985, top=1 - 0.55 / height, bottom=1.35 / height, wspace=0.42, width_ratios=(1.35, 1)
    )
    _changes(fig.add_subplot(grid[0, 0]), frame[frame["panel"] == "changes"])
    _planner(fig.add_subplot(grid[0, 1]), frame[frame["panel"] == "planner"])
    return fig


def _changes(ax, rows: pd.DataFrame) -> None:
    change = rows["change"].clip(lower=LEAST)
    for row, y in zip(rows.to_dict("records"), change, strict=True):
        colour = COLOURS[row["effect"]]
        face = colour if str(row["planned"]) == "True" else "white"
        ax.plot(row["cost ratio"], y, MARKERS[row["effect"]], color=colour, mfc=face, ms=6, mew=1.2)
    ax.axvline(1, color=GREY, lw=0.7)
    ax.set(
        xscale="log", yscale="log", xlim=(0.1, 400), ylim=(LEAST / 2, 5), xlabel="cost with over cost without (1)",
        ylabel="largest change of a headline quantity (1)", title="filled: the planner's choice for the scene is on",
    )  # fmt: skip
    ax.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    ax.set_xticks([0.2, 0.5, 1, 2, 5])
    ax.xaxis.set_minor_locator(mpl.ticker.NullLocator())
    logs = np.log10(change.to_numpy())
    places = 10 ** spread(logs, 0.31, np.log10(LEAST / 2) + 0.1, 0.62)
    for row, y, place in zip(rows.to_dict("records"), change, places, strict=True):
        ax.plot([row["cost ratio"], 8], [y, place], color=COLOURS[row["effect"]], lw=0.4, alpha=0.6, zorder=0)
        name = NAMES[row["effect"]].split(" (")[0]
        ax.text(8.5, place, f"{name}: {row['scene']}", fontsize=5.6, va="center", color=INK, clip_on=False)


def _planner(ax, rows: pd.DataFrame) -> None:
    names = [name for name in NAMES if name in set(rows["effect"])]
    shift = np.random.default_rng(0)
    for k, name in enumerate(names):
        for row in rows[rows["effect"] == name].to_dict("records"):
            carried = "carried" in row["verdict"]
            wrong = row["verdict"] in ("wrongly left out", "carried for nothing")
            x = max(row["share"], LEAST)
            ax.plot(
                x, k + (0.2 if carried else -0.2) + shift.uniform(-0.13, 0.13), MARKERS[name], ms=4, mew=0.9,
                color="#c8303d" if wrong else COLOURS[name], mfc=COLOURS[name] if carried and not wrong else "white",
            )  # fmt: skip
    ax.axvline(1, color=INK, lw=0.9)
    ax.axvline(0.1, color=GREY, lw=0.9, ls=(0, (4, 1.8)))
    ax.set(xscale="log", xlim=(LEAST / 2, 200), ylim=(-0.6, len(names) - 0.4), xlabel="worth over accuracy (1)")
    ax.set_yticks(range(len(names)), [NAMES[name].replace(" (", "\n(") for name in names], fontsize=7)
    ax.set_title("the planner's choices", pad=18)
    handles = [
        Line2D([], [], ls="", marker="o", color=GREY, ms=4, label="carried"),
        Line2D([], [], ls="", marker="o", color=GREY, mfc="white", ms=4, label="left out"),
        Line2D([], [], ls="", marker="o", color="#c8303d", mfc="white", ms=4, label="wrong"),
    ]
    ax.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(-0.02, 0.985),
        ncols=3,
        fontsize=6.5,
        handletextpad=0.1,
        columnspacing=0.8,
    )

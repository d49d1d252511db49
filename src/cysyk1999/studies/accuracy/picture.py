"""Figures of the study of accuracy: error and cost, growth of cost, belief and truth. Each is drawn
from its data frame.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from cysyk1999.publishing.style import (
    CATEGORIES,
    GREY,
    INK,
    MARKERS,
    MEANINGS,
    haloed,
    look_of,
    study_figure,
    styled,
)
from cysyk1999.publishing.write import publish
from cysyk1999.studies.accuracy.errors import FRAMES

COST, CHANGE, TIME = "cost (1 = default)", "error (%)", "process time (s)"
COLOURS = {name: look["color"] for name, look in MEANINGS["element"].items()}
LOOKS = {"Q2P1": "o", "Q1P0": "s", "P2B": "^", "Q1": "s", "Q2": "o", "Q2R": "D"}
"""Marker of an element: filled with its colour, or grey and open if it is for teaching."""
MODELS = {"elastic half-plane": "P", "water bed": "X"}
EDGE = 0.012
"""Where models are drawn that cost less than the axis shows, in costs of the default."""
KINDS = {
    "Q2P1": "nine-node quads, mixed",
    "Q1P0": "four-node quads, mixed",
    "P2B": "triangles, mixed",
    "Q1": "four-node quads, full",
    "Q2": "nine-node quads, full",
    "Q2R": "nine-node quads, reduced",
}
"""Words for the elements; the last three, displacements only with full or reduced integration, are
for teaching.
"""


def _look(name: str, size: float = 3.6) -> dict[str, object]:
    """Of an element or a model."""
    colour = COLOURS.get(name, "0.55")
    marker = {**LOOKS, **MODELS}[name]
    return {
        "marker": marker,
        "color": colour,
        "mfc": colour if name in COLOURS else "white",
        "ms": size,
        "mew": 0.7,
    }


def _error(frame: pd.DataFrame, title: str, note: list[str]) -> Figure:
    fig = study_figure(title, note, 6.4)
    axes = fig.subplots(2, 4, sharex=True, sharey=True).ravel()
    elements = frame["model"] == "finite elements"
    for ax, (quantity, rows) in zip(axes, frame.groupby("quantity", sort=False), strict=False):
        here = elements[rows.index]
        others = rows[here & ((rows["strain"] == "small") | (rows["tolerance"] != "0.0001"))]
        ax.loglog(others[COST], others[CHANGE], "+", color=GREY, ms=4.5, mew=0.9)
        for element in LOOKS:
            part = rows[here & (rows["element"] == element)].drop(others.index, errors="ignore")
            ax.loglog(part[COST], part[CHANGE], ls="none", **_look(element))
        for preset in ("draft", "thesis", "fine"):
            part = rows[rows["preset"] == preset]
            ax.loglog(part[COST], part[CHANGE], "o", mfc="none", mec=INK, ms=8, mew=0.9)
            for x, y in zip(part[COST], part[CHANGE], strict=True):
                ax.annotate(
                    preset,
                    (x, y),
                    xytext=(5, 4),
                    textcoords="offset points",
                    fontsize=6.5,
                    zorder=6,
                    **haloed(),
                )
        front = rows[rows["pareto"] & here].sort_values(COST)
        ax.loglog(front[COST], front[CHANGE], color=INK, lw=0.9, drawstyle="steps-post", zorder=0)
        for model in MODELS:
            part = rows[rows["model"] == model].dropna(subset=[CHANGE])
            if len(part):
                ax.loglog(
                    np.full(len(part), EDGE),
                    part[CHANGE],
                    ls="none",
                    clip_on=False,
                    zorder=5,
                    **_look(model, 6),
                )
        ax.axhspan(1e-6, rows["uncertainty (%)"].iloc[0], color="0.93", lw=0, zorder=-1)
        ax.set_title(
            quantity.replace("energy 6", "strain energy, 6")
            .replace("energy 9", "strain energy, 9")
            .replace(" um", " µm")
        )
    values = frame.loc[frame[CHANGE] > 0, CHANGE]
    axes[0].set_ylim(max(values.min() / 2, 3e-3), values.max() * 2)
    axes[0].set_xlim(EDGE, frame[COST].max() * 2.5)
    for ax in axes[::4]:
        ax.set_ylabel("error (%)")
    for ax in axes[:4]:
        ax.tick_params(labelbottom=True)
    axes[5].set_xlabel("process time (default preset: 1)")
    axes[7].axis("off")
    looks = [
        Line2D([], [], ls="", label=KINDS[each], **_look(each))
        for each in LOOKS
        if (frame["element"] == each).any()
    ]
    looks += [
        Line2D([], [], ls="", marker="+", color=GREY, label="small strain or other tolerance")
    ]
    looks += [Line2D([], [], color=INK, lw=0.9, label="Pareto front")]
    if not frame[~elements].empty:
        costs = frame[~elements].groupby("model")[COST].mean()
        for model, cost in costs.items():
            looks.append(
                Line2D([], [], ls="", label=f"{model} (cost {cost:.1g})", **_look(model, 5))
            )
    axes[7].legend(handles=looks, loc="upper left", fontsize=6.5, handletextpad=0.3)
    return fig


@styled
def error(frame: pd.DataFrame) -> Figure:
    """Error against cost, ramp and hold by three surfaces."""
    return _error(
        frame,
        "What accuracy costs: ramp and hold",
        [
            "Simulated. Largest error of plate, 210 and 1260 1/m, top of the ramp and end of the hold, against a limit "
            "extrapolated in mesh and steps (grey: its uncertainty). Process time of one thread. Left edge: two models of "
            "before, end of the hold."
        ],
    )


@styled
def error_stroke(frame: pd.DataFrame) -> Figure:
    """Error against cost, a stroke."""
    return _error(
        frame,
        "What accuracy costs: a stroke by a flat plate",
        [
            "Simulated. Error: the largest of the top of the ramp and four places of a stroke of 6 mm with the "
            "calibrated friction, against a limit extrapolated in mesh and steps (grey: its own uncertainty). The peak rate of "
            "strain energy is that of the press before."
        ],
    )


@styled
def growth(frame: pd.DataFrame) -> Figure:
    """Process time, iterations and memory against nodes, with fitted exponents."""
    fig = study_figure(
        "How cost grows with the mesh",
        [
            "Simulated: mean of ramp and hold by plate, 210 and 1260 1/m, 40 steps; nodes of the whole pad, half of which is "
            "solved. Time with meshing; exponents of it from 3000 nodes on. Memory with the interpreter and its libraries."
        ],
        3.3,
    )
    axes = fig.subplots(1, 3)
    for element in LOOKS:
        part = frame[frame["element"] == element]
        exponent = part["exponent"].dropna()
        label = KINDS[element] + (f": {exponent.iloc[0]:.2f}" if len(exponent) else "")
        for ax, column in zip(axes, (TIME, "memory (MB)", "iterations"), strict=True):
            ax.plot(part["nodes"], part[column], label=label, lw=1, **_look(element, 4))
    for ax, label in zip(
        axes, ("process time (s)", "peak memory (MB)", "Newton iterations of 40 steps"), strict=True
    ):
        ax.set(xscale="log", xlabel="nodes", ylabel=label)
    axes[0].set_yscale("log")
    axes[1].set_ylim(0)
    axes[2].set_ylim(0)
    axes[2].legend(
        fontsize=6.5,
        loc="lower right",
        handlelength=1.4,
        title="exponent of time",
        title_fontsize=6.5,
    )
    return fig


@styled
def belief(frame: pd.DataFrame) -> Figure:
    """What runs believe of their error against what it is, scenes outside the study."""
    asked, own = (
        frame[frame["true error (%)"].notna()],
        frame.loc[frame["true error (%)"].isna(), "believed error (%)"],
    )
    covered = (asked["believed error (%)"] >= asked["true error (%)"]).sum()
    fig = study_figure(
        "Does a run know its error?",
        [
            f"Simulated: {asked['scene'].nunique()} scenes outside the study. Truth: largest difference of depth, width, "
            "pressures and strain energies at the legs' ends, of strokes root mean square, to a finer run, which believes in "
            f"{own.min():.1f} to {own.max():.1f} % itself. Below the line the belief covers the truth: {covered} of "
            f"{len(asked)} runs."
        ],
        3.9,
    )
    left, right = _truth_and_belief(fig)
    scenes = list(asked["scene"].unique())
    groups = asked.groupby("accuracy", sort=False)
    for accuracy, part in groups:
        colour, marker = look_of("accuracy", str(accuracy), "color", "marker").values()
        believed, true = part["believed error (%)"], part["true error (%)"]
        name = accuracy if accuracy == "draft" else f"accuracy: {accuracy}"
        left.loglog(believed, true, marker, color=colour, ms=4.5, label=name)
        right.semilogx(
            true / believed,
            [scenes.index(scene) for scene in part["scene"]],
            marker,
            color=colour,
            ms=4,
        )
        if accuracy != "draft":
            left.axvline(100 * float(accuracy), color=colour, lw=0.6, ls=(0, (1, 2)))
    left.legend(loc="upper left")
    _named(right, [scene.replace("_", " ") for scene in scenes])
    return fig


def _truth_and_belief(fig: Figure) -> tuple[Axes, Axes]:
    """Axes of true over believed error, with the line where they agree; and of their ratio, by
    rows.
    """
    left, right = fig.subplots(1, 2, width_ratios=(1, 0.9))
    ends = np.array([0.08, 100.0])
    left.fill_between(ends, ends, 1e-3, color="0.95", lw=0)
    left.loglog(ends, ends, color=GREY, lw=0.8)
    left.set(xlabel="believed error (%)", ylabel="true error (%)", xlim=ends, ylim=ends)
    return left, right


def _named(ax: Axes, rows: list[str]) -> None:
    """Names of the rows of ratios, and what they are."""
    ax.set_xlim(right=max(2.0, ax.get_xlim()[1]))
    ax.axvline(1, color=GREY, lw=0.8)
    ax.set_yticks(range(len(rows)), rows, fontsize=6.5)
    ax.invert_yaxis()
    ax.set_xlabel("truth / belief")


@styled
def drawn(frame: pd.DataFrame) -> Figure:
    """What runs believe of their error against what it is, scenes drawn by class of stimulus."""
    asked = frame[frame["true error (%)"].notna()]
    covers = asked["believed error (%)"] >= asked["true error (%)"]
    fig = study_figure(
        "Does a run know its error under any stimulus?",
        [
            f"Simulated: {asked['scene'].nunique()} random scenes, each asked for 10, 5 or, beside ridges, 2 %. Truth: largest "
            "difference of depth, width, pressures and strain energies at the legs' ends, of strokes root mean square, to edges "
            f"at least 1.7 times as short. Below the line the belief covers the truth: {int(covers.sum())} of {len(asked)} runs."
        ],
        3.9,
    )
    left, right = _truth_and_belief(fig)
    classes = list(asked["class"].unique())
    for place, (name, marker) in enumerate(zip(classes, MARKERS, strict=False)):
        part = asked[asked["class"] == name]
        believed, true = part["believed error (%)"], part["true error (%)"]
        colour = CATEGORIES[place % len(CATEGORIES)]
        left.loglog(believed, true, marker, color=colour, ms=4.5, mfc="white", label=name)
        right.semilogx(
            true / believed, np.full(len(part), place), marker, color=colour, ms=4, mfc="white"
        )
    left.legend(loc="upper left", fontsize=6.5)
    counts = [
        f"{name} ({int(covers[asked['class'] == name].sum())} of {(asked['class'] == name).sum()})"
        for name in classes
    ]
    _named(right, counts)
    return fig


@styled
def ridges(frame: pd.DataFrame) -> Figure:
    """Errors of strain energies beside ridges against the elements among them, and those
    expected.
    """
    fig = study_figure(
        "How many elements does a ridge need?",
        [
            "Simulated. Errors of strain energies about inner ridges, 15 µm or more off their boundary, at the top of a ramp to "
            "20 gram-weight, against 48 elements from ridge to ridge. Points: nineteen places in twenty have no more; bars: to "
            "the largest. Lines: what a run expects."
        ],
        3.3,
    )
    axes = fig.subplots(1, frame["surface"].nunique(), sharey=True)
    across = "elements from ridge to ridge"
    for ax, (surface, here) in zip(axes, frame.groupby("surface", sort=False), strict=True):
        for place, ((height, pitch), part) in enumerate(
            here.groupby(["height (mm)", "pitch (mm)"], sort=False)
        ):
            usual, most = part["error of 19 places in 20 (%)"], part["largest error (%)"]
            beside, colour = part[across] * 1.03 ** (place - 2.5), CATEGORIES[place]
            ax.vlines(beside, usual, most, color=colour, lw=0.8)
            ax.plot(
                beside,
                usual,
                MARKERS[place],
                color=colour,
                ms=4.5,
                mfc="white",
                label=f"{height:g} mm every {pitch:g} mm",
            )
            ax.plot(part[across], part["expected error (%)"], color=colour, lw=0.9, zorder=0)
        ax.set(
            xscale="log",
            yscale="log",
            xlabel=across,
            title="plate" if surface == "flat" else f"{surface} 1/m",
        )
        ax.set_xticks(counts := sorted(frame[across].unique()), [str(count) for count in counts])
        ax.minorticks_off()
    axes[0].set_ylabel("error of strain energy (%)")
    axes[-1].legend(
        fontsize=6.5,
        title="ridges",
        title_fontsize=6.5,
        loc="upper left",
        bbox_to_anchor=(1.0, 1.0),
    )
    return fig


@styled
def shown(frame: pd.DataFrame) -> Figure:
    """Errors that figures state against those of their curves."""
    stated, true = frame["stated error (%)"], frame["true error (%)"]
    covered, above = stated >= true, true > 3
    fig = study_figure(
        "Are the errors in the figures those of their curves?",
        [
            f"Simulated: {len(frame)} curves and numbers, each with the first figure that shows it. Truth: what they change by "
            "on a mesh with half the edges, and what by their order of convergence is left then, root mean square. Stated: mesh, "
            f"time steps and sampling. Below the line the error stated covers the truth: {int(covered.sum())} of {len(frame)}; "
            f"up to twice it does in {int((true <= 2 * stated).sum())}. True errors above 3 %: {int(above.sum())}."
        ],
        3.9,
    )
    left, right = _truth_and_belief(fig)
    left.set(xlabel="stated error (%)")
    figures = list(frame["figure"].unique())
    for place, chapter in enumerate(("3", "4", "5")):
        part = frame[frame["figure"].str.startswith(chapter)]
        look = {
            "color": CATEGORIES[place],
            "marker": MARKERS[place],
            "ls": "",
            "ms": 3.2,
            "mfc": "white",
            "mew": 0.7,
        }
        if len(part):
            left.plot(
                part["stated error (%)"].clip(lower=0.1),
                part["true error (%)"].clip(lower=0.1),
                label=f"chapter {chapter}",
                **look,
            )
            ratio = (part["true error (%)"] / part["stated error (%)"]).clip(lower=0.03)
            right.semilogx(ratio, [figures.index(number) for number in part["figure"]], **look)
    left.legend(loc="upper left")
    _named(right, [f"Fig {number}" for number in figures])
    right.tick_params(axis="y", labelsize=4.5)
    right.set_xlabel("truth / stated")
    return fig


STUDIES: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "accuracy_error": error,
    "accuracy_error_stroke": error_stroke,
    "accuracy_growth": growth,
    "accuracy_belief": belief,
    "accuracy_drawn": drawn,
    "accuracy_ridges": ridges,
    "accuracy_shown": shown,
}
"""Figure name -> drawing function of its data frame."""


def accuracy_pictures(job: SimpleNamespace) -> None:
    """Job: `table` -> `pictures`."""
    table = pd.read_csv(job.table[0], dtype={"scene": str, "accuracy": str})
    for picture in map(Path, job.pictures):
        frame = FRAMES[picture.stem](table)
        publish(STUDIES[picture.stem](frame), frame, picture)

"""Figures of the study of accuracy: error and cost, growth of cost, true and stated error. Each is
drawn from its data frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
from cysyk1999.studies.accuracy.compare import BELIEVED, TRUE, covered
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
    """The look of an element or a model."""
    colour = COLOURS.get(name, "0.55")
    face = colour if name in COLOURS else "white"
    marker = (LOOKS | MODELS)[name]
    return {"marker": marker, "color": colour, "mfc": face, "ms": size, "mew": 0.7, "ls": "none"}


def _error(frame: pd.DataFrame, title: str, note: str) -> Figure:
    fig = study_figure(title, [note], 6.4)
    axes = fig.subplots(2, 4, sharex=True, sharey=True).ravel()
    for ax, (quantity, rows) in zip(axes, frame.groupby("quantity", sort=False), strict=False):
        _error_of(ax, rows)
        title = quantity.replace("energy ", "strain energy, ").replace(" um", " µm")
        ax.set_title(title.replace("peak strain energy, rate", "peak energy rate"))
    values = frame.loc[frame[CHANGE] > 0, CHANGE]
    axes[0].set_ylim(max(values.min() / 2, 3e-3), values.max() * 2)
    axes[0].set_xlim(EDGE, frame[COST].max() * 2.5)
    for ax in axes[::4]:
        ax.set_ylabel("error (%)")
    for ax in axes[:4]:
        ax.tick_params(labelbottom=True)
    axes[5].set_xlabel("process time (default preset: 1)")
    axes[7].axis("off")
    looks = {KINDS[k]: _look(k) for k in LOOKS if (frame["element"] == k).any()}
    looks["small strain or other tolerance"] = {"ls": "", "marker": "+", "color": GREY}
    looks["Pareto front"] = {"color": INK, "lw": 0.9}
    models = frame[frame["model"] != "finite elements"].groupby("model")[COST].mean()
    looks |= {f"{model} (cost {cost:.1g})": _look(model, 5) for model, cost in models.items()}
    handles = [Line2D([], [], label=label, **look) for label, look in looks.items()]
    axes[7].legend(handles=handles, loc="upper left", fontsize=6.5, handletextpad=0.3)
    return fig


def _presets(frame: pd.DataFrame) -> str:
    """The largest error of each preset, in words."""
    worst = frame.groupby("preset")[CHANGE].max()
    found = [f"{name} by {worst[name]:.2g} %" for name in ("draft", "thesis", "fine")]
    return f"a preset is wrong by at most: {', '.join(found)}"


def _error_of(ax: Axes, rows: pd.DataFrame) -> None:
    """Errors of a quantity against costs, its front, and the uncertainty of the reference."""
    elements = rows[rows["model"] == "finite elements"]
    other = (elements["strain"] == "small") | (elements["tolerance"].astype(float) != 1e-4)
    ax.loglog(*_points(elements[other]), "+", color=GREY, ms=4.5, mew=0.9)
    for element in LOOKS:
        ax.loglog(*_points(elements[~other & (elements["element"] == element)]), **_look(element))
    for preset in ("draft", "thesis", "fine"):
        part = rows[rows["preset"] == preset]
        ax.loglog(*_points(part), "o", mfc="none", mec=INK, ms=8, mew=0.9)
        style = {"xytext": (5, 4), "textcoords": "offset points", "fontsize": 6.5, "zorder": 6}
        for place in zip(*_points(part), strict=True):
            ax.annotate(preset, place, **style, **haloed())
    front = elements[elements["pareto"]].sort_values(COST)
    ax.loglog(*_points(front), color=INK, lw=0.9, drawstyle="steps-post", zorder=0)
    for model in MODELS:
        found = rows.loc[rows["model"] == model, CHANGE].dropna()
        if len(found):
            edge = np.full(len(found), EDGE)
            ax.loglog(edge, found, clip_on=False, zorder=5, **_look(model, 6))
    ax.axhspan(1e-6, rows["uncertainty (%)"].iloc[0], color="0.93", lw=0, zorder=-1)


def _points(rows: pd.DataFrame) -> tuple[pd.Series, pd.Series]:
    return rows[COST], rows[CHANGE]


@styled
def error(frame: pd.DataFrame) -> Figure:
    """Error against cost, ramp and hold by three surfaces."""
    return _error(
        frame,
        f"Ramp and hold: {_presets(frame)}",
        "Simulated. Largest error of plate, 210 and 1260 1/m, top of the ramp and end of the hold, "
        "against a limit extrapolated in mesh and steps (grey: its uncertainty). Process time of "
        "one thread. Left edge: two models of before, end of the hold.",
    )


@styled
def error_stroke(frame: pd.DataFrame) -> Figure:
    """Error against cost, a stroke."""
    return _error(
        frame,
        f"A stroke by a flat plate: {_presets(frame)}",
        "Simulated. Error: the largest of the top of the ramp and four places of a stroke of 6 mm "
        "with the calibrated friction, against a limit extrapolated in mesh and steps (grey: its "
        "own uncertainty). The peak rate of strain energy is that of the press before.",
    )


@styled
def growth(frame: pd.DataFrame) -> Figure:
    """Process time, iterations and memory against nodes, with fitted exponents."""
    powers = [f"{power:.2f}" for power in sorted(frame["exponent"].dropna())]
    fig = study_figure(
        f"Time grows with the number of nodes to the power of {powers[0]} to {powers[-1]}",
        [
            "Simulated: mean of ramp and hold by plate, 210 and 1260 1/m, 40 steps; nodes of the "
            "whole pad, half of which is solved. Time with meshing; exponents of it from 3000 "
            "nodes on. Memory with the interpreter and its libraries."
        ],
        3.3,
    )
    axes = fig.subplots(1, 3)
    shown = {
        TIME: TIME,
        "memory (MB)": "peak memory (MB)",
        "iterations": "Newton iterations of 40 steps",
    }
    for ax, (column, label) in zip(axes, shown.items(), strict=True):
        for element in LOOKS:
            part = frame[frame["element"] == element]
            exponent = part["exponent"].dropna()
            name = KINDS[element] + (f": {exponent.iloc[0]:.2f}" if len(exponent) else "")
            look = _look(element, 4) | {"ls": "-", "lw": 1}
            ax.plot(part["nodes"], part[column], label=name, **look)
        ax.set(xscale="log", xlabel="nodes", ylabel=label)
    axes[0].set_yscale("log")
    axes[1].set_ylim(0)
    axes[2].set_ylim(0)
    small = {"fontsize": 6.5, "title_fontsize": 6.5}
    axes[2].legend(loc="lower right", handlelength=1.4, title="exponent of time", **small)
    return fig


def _belief(title: str, note: str, height: float = 3.9) -> tuple[Figure, Axes, Axes]:
    """Axes of true over stated error, with the line where they agree; and of their ratio."""
    fig = study_figure(title, [note], height)
    left, right = fig.subplots(1, 2, width_ratios=(1, 0.9))
    ends = np.array([0.08, 100.0])
    left.fill_between(ends, ends, 1e-3, color="0.95", lw=0)
    left.loglog(ends, ends, color=GREY, lw=0.8)
    left.set(xlabel="stated error (%)", ylabel=TRUE, xlim=ends, ylim=ends)
    right.set_xscale("log")
    return fig, left, right


def _rows(left: Axes, right: Axes, names: Sequence[str], small: bool = False) -> None:
    """Finish both axes: the legend, names of the rows of ratios, and what these are."""
    left.legend(loc="upper left", **({"fontsize": 6.5} if small else {}))
    right.set_xlim(right=max(2.0, right.get_xlim()[1]))
    right.axvline(1, color=GREY, lw=0.8)
    right.set_yticks(range(len(names)), names, fontsize=6.5)
    right.invert_yaxis()
    right.set_xlabel("true error / stated error")


@styled
def belief(frame: pd.DataFrame) -> Figure:
    """What runs state as their error against what it is, scenes outside the study."""
    asked, covers = frame[frame[TRUE].notna()], covered(frame)
    own = frame.loc[frame[TRUE].isna(), BELIEVED]
    fig, left, right = _belief(
        f"The stated error is at least the true one in {covers.sum()} of {len(asked)} runs of "
        f"{asked['scene'].nunique()} scenes outside the study",
        "Simulated. True error: largest difference of depth, width, pressures and strain energies "
        "at the legs' ends, of strokes root mean square, to a finer run, which states "
        f"{own.min():.1f} to {own.max():.1f} % itself. Below the line the stated error is large "
        "enough.",
    )
    scenes = list(asked["scene"].unique())
    for accuracy, part in asked.groupby("accuracy", sort=False):
        colour, marker = look_of("accuracy", str(accuracy), "color", "marker").values()
        name = accuracy if accuracy == "draft" else f"accuracy: {accuracy}"
        left.loglog(part[BELIEVED], part[TRUE], marker, color=colour, ms=4.5, label=name)
        places = part["scene"].map(scenes.index)
        right.plot(part[TRUE] / part[BELIEVED], places, marker, color=colour, ms=4)
        if accuracy != "draft":
            left.axvline(100 * float(accuracy), color=colour, lw=0.6, ls=(0, (1, 2)))
    _rows(left, right, [scene.replace("_", " ") for scene in scenes])
    return fig


@styled
def drawn(frame: pd.DataFrame) -> Figure:
    """What runs state as their error against what it is, scenes drawn by class of stimulus."""
    asked, covers = frame[frame[TRUE].notna()], covered(frame)
    fig, left, right = _belief(
        f"The stated error is at least the true one in {covers.sum()} of {len(asked)} random "
        "scenes",
        "Simulated. Each scene was asked for 10, 5 or, beside ridges, 2 %. True error: largest "
        "difference of depth, width, pressures and strain energies at "
        "the legs' ends, of strokes root mean square, to edges at least 1.7 times as short. Below "
        "the line the stated error is large enough.",
    )
    names = []
    for place, (name, part) in enumerate(asked.groupby("class", sort=False)):
        look = {"marker": MARKERS[place], "color": CATEGORIES[place % len(CATEGORIES)], "ls": ""}
        left.loglog(part[BELIEVED], part[TRUE], ms=4.5, mfc="white", label=name, **look)
        ratios = part[TRUE] / part[BELIEVED]
        right.plot(ratios, np.full(len(part), place), ms=4, mfc="white", **look)
        names.append(f"{name} ({covers[part.index].sum()} of {len(part)})")
    _rows(left, right, names, small=True)
    return fig


@styled
def ridges(frame: pd.DataFrame) -> Figure:
    """Errors of strain energies beside ridges against the elements among them, and those
    expected.
    """
    across, sizes = "elements from ridge to ridge", ["height (mm)", "pitch (mm)"]
    least, most = (
        frame.loc[frame[across] == count, "largest error (%)"].max()
        for count in (frame[across].min(), frame[across].max())
    )
    fig = study_figure(
        f"With {frame[across].min():g} elements from ridge to ridge strain energy is wrong by at "
        f"most {least:.2g} %, with {frame[across].max():g} by {most:.2g} %",
        [
            "Simulated. Errors of strain energies about inner ridges, 15 µm or more off their "
            "boundary, at the top of a ramp to 20 gram-weight, against 48 elements from ridge to "
            "ridge. Points: nineteen places in twenty have no more; bars: to the largest. Lines: "
            "what a run expects."
        ],
        3.3,
    )
    axes = fig.subplots(1, frame["surface"].nunique(), sharey=True)
    for ax, (surface, here) in zip(axes, frame.groupby("surface", sort=False), strict=True):
        for place, ((height, pitch), part) in enumerate(here.groupby(sizes, sort=False)):
            usual, most = part["error of 19 places in 20 (%)"], part["largest error (%)"]
            at, colour = part[across], CATEGORIES[place]
            look = {"color": colour, "ms": 4.5, "mfc": "white"}
            ax.vlines(at, usual, most, color=colour, lw=0.8)
            name = f"{height:g} mm every {pitch:g} mm"
            ax.plot(at, usual, MARKERS[place], label=name, **look)
            ax.plot(at, part["expected error (%)"], color=colour, lw=0.9, zorder=0)
        title = "plate" if surface == "flat" else f"{surface} 1/m"
        ax.set(xscale="log", yscale="log", xlabel=across, title=title)
        ax.set_xticks(counts := sorted(frame[across].unique()), [str(count) for count in counts])
        ax.minorticks_off()
    axes[0].set_ylabel("error of strain energy (%)")
    place = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
    axes[-1].legend(fontsize=6.5, title="ridges", title_fontsize=6.5, **place)
    return fig


@styled
def shown(frame: pd.DataFrame) -> Figure:
    """Errors that figures state against those of their curves."""
    stated, true = frame["stated error (%)"], frame[TRUE]
    figures = list(frame["figure"].unique())
    covered, twice = (stated >= true).sum(), (true <= 2 * stated).sum()
    fig, left, right = _belief(
        f"Figures state an error that covers the true one in {covered} of {len(frame)} curves, "
        f"and is at least half of it in {twice}",
        f"Simulated: {len(frame)} curves and numbers, each with the first figure that shows it. "
        "True error: what they change by on a mesh with half the edges, and what by their order of "
        "convergence is left then, root mean square. Stated: mesh, time steps and sampling. Below "
        f"the line the stated error is large enough. True errors above 3 %: {(true > 3).sum()}.",
        1.0 + 0.112 * len(figures),
    )
    look = {"ls": "", "ms": 3.2, "mfc": "white", "mew": 0.7}
    for place, chapter in enumerate("345"):
        here = frame["figure"].str.startswith(chapter)
        if here.any():
            own = look | {"color": CATEGORIES[place], "marker": MARKERS[place]}
            one, other = (errors[here].clip(lower=0.1) for errors in (stated, true))
            left.plot(one, other, label=f"chapter {chapter}", **own)
            ratio = (true / stated)[here].clip(lower=0.03)
            right.plot(ratio, frame.loc[here, "figure"].map(figures.index), **own)
    _rows(left, right, [f"Fig {number}" for number in figures])
    right.tick_params(axis="y", labelsize=6)
    right.set_ylim(len(figures) - 0.4, -0.6)
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
        frame = FRAMES.get(picture.stem, lambda rows: rows)(table)
        publish(STUDIES[picture.stem](frame), frame, picture)

"""Figures of the calibration: fit, identifiability, friction. Each is drawn from its data frame
alone.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cysyk1999.measures.quantities import DISTANCE, LATERAL
from cysyk1999.publishing.style import (
    CATEGORIES,
    DASHED,
    DOTTED,
    GREY,
    INK,
    MARKERS,
    SOLID,
    haloed,
    ordered,
    spread,
    study_figure,
    styled,
)
from fingerpad.measures.features import is_simulated

DEPTH, FORCE, COEFFICIENT = "depth (mm)", "force (N)", "coefficient (1)"
LOWEST, HIGHEST = "lowest (mm)", "highest (mm)"
CONSTANT, LENGTH = "modulus_constant (1)", "contact_length (mm)"
RELATIVE, RISE = "relative (1)", "rise (1)"
TOUCHED = "#c9dbe8"
"""Shade of what is about a number."""


def _looks(names: Sequence[str]) -> dict[str, dict]:
    """Marker of each subject, and its name for a legend; the mean a star in ink."""
    looks = {"mean": {"color": INK, "marker": "*", "ms": 8, "label": "mean"}}
    colours = ordered("subject", [name for name in names if name != "mean"])
    for name, look in colours.items():
        marker = MARKERS[list(names).index(name) % len(MARKERS)]
        looks[name] = {"color": look["color"], "marker": marker, "ms": 4.5}
        looks[name] |= {"label": f"subject {name}"}
    return {name: {"ls": "none"} | looks[name] for name in names}


@styled
def fit(frame: pd.DataFrame) -> Figure:
    """Measured steady forces, fitted curves with 95 % bands and the thesis's constant; the mean
    with the bone moved.
    """
    measured = frame[~is_simulated(frame)]
    note = (
        "Lines: simulated, steady state; moduli times a fitted constant (dotted: its 95 % "
        "confidence), dashed: the moduli stated in the thesis. "
        f"Points: {'; '.join(measured['source'].unique())}."
    )
    points = {who: rows[[DEPTH, FORCE]].T.to_numpy() for who, rows in measured.groupby("series")}
    curves = dict(
        list(frame[is_simulated(frame) & frame["panel"].eq("subjects")].groupby("series"))
    )
    looks = _looks(measured["series"].unique())
    main = curves[list(looks)[-1]][FORCE].iloc[-1] / curves["thesis"][FORCE].iloc[-1]
    title = f"Measured steady forces under a plate need {main:.2g} times the thesis's moduli"
    fig = study_figure(title, [note], 3.4)
    left, right = fig.subplots(1, 2, sharey=True)
    for who, look in looks.items():
        line, colour = curves[who], look["color"]
        # the ends as lines, for overlapping bands show seams that look like curves
        for end in ("force_low (N)", "force_high (N)"):
            left.plot(line[DEPTH], line[end], color=colour, lw=0.5, ls=DOTTED)
        left.plot(line[DEPTH], line[FORCE], color=colour, lw=1.8 if who == "mean" else 1.1)
        left.plot(*points[who], **look)
    stated = curves["thesis"]
    left.plot(stated[DEPTH], stated[FORCE], color=GREY, ls=DASHED, label="moduli of the thesis")
    top = max(1.6, 1.1 * float(measured[FORCE].max()))
    left.set(ylabel="force (N)", ylim=(0, top), title="each subject, and the mean")
    left.legend(title="measured", loc="upper left", alignment="left")
    bone = frame[frame["panel"] == "bone"].groupby("series", sort=False)
    for style, (name, rows) in zip(((0, (4, 1.8)), "-", (0, (1, 1.2))), bone, strict=False):
        right.plot(rows[DEPTH], rows[FORCE], color=INK, ls=style, lw=1.3, label=name)
    right.plot(*points[who], "*" if who == "mean" else "o", color=INK, ms=8)
    right.set_title(f"{look['label']}, the bone moved, the same constant")
    right.legend(loc="upper left", title="fat under the apex", alignment="left")
    for ax in (left, right):
        ax.set(xlabel="indentation depth (mm)", xlim=(0, 2.5))
    return fig


@styled
def identifiability(frame: pd.DataFrame) -> Figure:
    """The valley of equal misfit over constant and contact length, and the profiles along each and
    across.
    """
    note = (
        "Rise of the sum of squares of simulated against measured forces above its least, "
        "over the squared scatter of the fit. Along the valley nothing changes: force tells "
        "modulus × contact length, nothing of either alone."
    )
    title = "Force tells the product of moduli and contact length, and nothing of either alone"
    fig = study_figure(title, [note], 3.7)
    left, right = fig.subplots(1, 2, width_ratios=(1.15, 1))
    panels = dict(list(frame.groupby("panel")))
    _valley(left, panels["ridge"].pivot(index=LENGTH, columns=CONSTANT, values=RISE))
    styles = {
        "modulus constant x contact length": {"color": INK, "ls": SOLID, "lw": 1.4},
        "contact length": {"color": "0.75", "ls": SOLID, "lw": 2.6},
        "modulus constant": {"color": INK, "ls": DOTTED, "lw": 1.0},  # lies on the one before
    }
    profiles = dict(list(panels["profile"].groupby("series")))
    for name, look in styles.items():
        right.plot(profiles[name][RELATIVE], profiles[name][RISE], **look)
    for series, rise in panels["level"][["series", RISE]].to_numpy():
        right.axhline(rise, color=GREY, lw=0.7)
        look = {"color": GREY, "fontsize": 6.5, "ha": "right", "va": "bottom"}
        right.text(1.49, rise + 0.3, textwrap.fill(series, 16), **look)
    right.set(xlabel="value over best value (1)", xlim=(0.5, 1.5))
    right.set(
        ylabel="rise of the misfit (1)", ylim=(-0.8, 25), title="profiles, the other refitted"
    )
    right.text(1.0, 18, "modulus constant\nx contact length", ha="center", va="center")
    right.text(0.52, 0.5, "either alone", va="bottom")
    return fig


def _valley(ax: Axes, grid: pd.DataFrame) -> None:
    """Misfit over constant and length: contours, the best product, and what the thesis states."""
    constants, lengths = grid.columns.to_numpy(), grid.index.to_numpy()
    levels = {"levels": np.linspace(-1, 3.2, 22), "cmap": "viridis_r", "extend": "max"}
    filled = ax.contourf(constants, lengths, np.log10(grid.to_numpy() + 0.1), **levels)
    filled.set_edgecolor("face")
    levels = {"levels": [3, 10, 30, 100, 300, 1000], "colors": "white", "linewidths": 0.6}
    lines = ax.contour(constants, lengths, grid.to_numpy(), **levels)
    ax.clabel(lines, lines.levels[1:], fmt="%g", fontsize=6.5)
    constant, length = (np.sqrt(axis[0] * axis[-1]) for axis in (constants, lengths))
    ax.plot(constants, constant * length / constants, color=INK, lw=1.2)
    ax.plot([1.0], [length], "X", color=CATEGORIES[1], ms=7, mec="white", mew=0.8)
    look = {"fontsize": 6.5, "color": "white", "ha": "right", "va": "top"}
    look["arrowprops"] = {"arrowstyle": "-", "color": "white", "lw": 0.6}
    words = "stated in the thesis\n(the length inferred)"
    ax.annotate(words, (1.0, length), (0.97, 0.95), textcoords="axes fraction", **look)
    ax.set(xscale="log", xlabel="modulus constant (1)", xlim=constants[[0, -1]])
    ax.set(yscale="log", ylabel="contact length (mm)", ylim=lengths[[0, -1]])
    ax.set_title("misfit over both; line: their best product")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(mpl.ticker.LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")


@styled
def friction(frame: pd.DataFrame) -> Figure:
    """Lateral displacement along the strokes, its mean and range over the coefficient, the thesis's
    stretch, published values.
    """
    panels = dict(list(frame.groupby("panel")))
    note = (
        "Simulated (the first two convexities, 27 gf, 10 mm/s). Blue: about 1 mm, the stretch the "
        "thesis states; dotted: the axis of its Fig. 5-15. Published coefficients were measured by "
        "others: sources in the CSV."
    )
    about, axis = panels["stated"].to_dict("records")
    (estimate,) = panels["estimate"].to_dict("records")
    best = estimate[COEFFICIENT]
    title = (
        f"With a coefficient of friction of {best:.2g} the skin is stretched by "
        f"{abs(about[LATERAL]):g} mm, as the thesis states"
    )
    fig = study_figure(title, [note], 3.8)
    grid = fig.add_gridspec(2, 2, height_ratios=(3.2, 1))
    left, right = fig.add_subplot(grid[:, 0]), fig.add_subplot(grid[0, 1])
    below = fig.add_subplot(grid[1, 1], sharex=right)
    for ax in (left, right):
        ax.axhspan(about[LOWEST], about[HIGHEST], color=TOUCHED, lw=0, zorder=0)
        ax.axhline(about[LATERAL], color=CATEGORIES[0], lw=0.8, zorder=1)
        for end in (axis[LOWEST], axis[HIGHEST]):
            ax.axhline(end, color=GREY, lw=0.8, ls=(0, (1, 1.6)))
    _courses(left, panels["course"], panels["waves"][DISTANCE], (axis[LOWEST], axis[HIGHEST]))
    _stretches(right, panels["stretch"], panels.get("variations", frame[:0])[:4])
    right.plot(best, estimate[LATERAL], "*", color=CATEGORIES[1], ms=8, zorder=4)
    _published(below, panels["published"])
    below.axvline(best, color=CATEGORIES[1], lw=0.8)
    below.text(best + 0.012, len(panels["published"]) - 1, f"{best:.3f}", va="center")
    return fig


def _courses(ax: Axes, rows: pd.DataFrame, waves: pd.Series, ends: tuple[float, float]) -> None:
    """Lateral displacement along every stroke, named at its end."""
    strokes = dict(list(rows.groupby("series", sort=False)))
    last = {name: course[LATERAL].iloc[-1] for name, course in strokes.items()}
    gap = 0.035 * np.ptp([*rows[LATERAL], *ends])
    places = spread([*last.values()], gap, min(last.values()) - 1, max(last.values()) + 1)
    colours = mpl.colormaps["cividis"](np.linspace(0, 0.8, len(strokes)))
    for (name, course), place, colour in zip(strokes.items(), places, colours, strict=True):
        ax.plot(course[DISTANCE], course[LATERAL], color=colour, lw=1.0)
        at = course[DISTANCE].iloc[-1] + 0.8
        ax.text(at, place, name, fontsize=6.5, va="center", **haloed())
    for x in waves:
        ax.axvline(x, color=GREY, lw=0.6)
    look = {"transform": ax.get_xaxis_transform(), "color": GREY, "fontsize": 6.5}
    ax.text(waves.mean(), 0.985, "waves", ha="center", va="top", **look)
    ax.set(xlabel="stroke distance (mm)", xlim=(0, 1.1 * rows[DISTANCE].max()))
    ax.set(ylabel="lateral displacement of the centre (mm)")
    ax.set_title("strokes; number: coefficient of friction")


def _stretches(ax: Axes, curve: pd.DataFrame, variations: pd.DataFrame) -> None:
    """Mean and range over the coefficient, and strokes with one thing changed."""
    x = curve[COEFFICIENT]
    ax.fill_between(x, curve[LOWEST], curve[HIGHEST], color=INK, alpha=0.13, lw=0)
    ax.plot(x, curve[LATERAL], "o-", color=INK, ms=3, lw=1.2)
    low, high = curve[LOWEST].min(), curve[HIGHEST].max()
    box = {"fc": "white", "ec": "none", "alpha": 0.7, "pad": 0.6}
    look = {"va": "center", "color": INK, "fontsize": 6.5, "bbox": box}
    names = spread(variations[LATERAL], 0.08 * (high - low), low, high) if len(variations) else ()
    for marker, row, place in zip("<>^v", variations.to_dict("records"), names, strict=False):
        ax.plot([row[COEFFICIENT], 0.5], [row[LATERAL], place], color=GREY, lw=0.5, zorder=1)
        open_mark = {"color": CATEGORIES[3], "ms": 4, "mfc": "white"}
        ax.plot(row[COEFFICIENT], row[LATERAL], marker, **open_mark)
        ax.text(0.51, place, row["series"], **look)
    ax.margins(y=0.1)
    ax.set(ylabel="displacement over the waves (mm)")
    ax.set_title("mean and range; open: one thing changed")
    ax.tick_params(labelbottom=False)


def _published(ax: Axes, rows: pd.DataFrame) -> None:
    """Coefficients that others measured or assumed."""
    look = {"transform": ax.get_yaxis_transform(), "fontsize": 6.5, "va": "center"}
    for k, row in enumerate(rows.iloc[::-1].to_dict("records")):
        measured = str(row["source"]).startswith("measured")
        ends = [row["lowest_coefficient (1)"], row["highest_coefficient (1)"]]
        ax.plot(ends, [k, k], color=INK, lw=2.2)
        ax.plot(row[COEFFICIENT], k, "o", color=INK, ms=4, mfc=INK if measured else "white")
        words = row["series"] if measured else "assumed in a model"
        ax.text(0.02, k, words, zorder=5, **look, **haloed())
    ax.set(xlabel="coefficient of friction (1)", xlim=(0, 1.12), title="published")
    ax.set(yticks=[], ylim=(-0.7, len(rows) - 0.3))


STUDIES: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "calibration_fit": fit,
    "calibration_identifiability": identifiability,
    "calibration_friction": friction,
}
"""Study figure -> function of its data frame."""

"""Figures of the calibration: fit, identifiability, residuals, relaxation, friction. Each is drawn
from its data frame alone.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence

import matplotlib as mpl
import numpy as np
import pandas as pd
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
    ordered,
    spread,
    study_figure,
    styled,
)
from fingerpad.measures.features import is_simulated

DEPTH, FORCE, COEFFICIENT = "depth (mm)", "force (N)", "coefficient (1)"
TOUCHED = "#c9dbe8"
"""Shade of what is about a number."""
MODEL_LINES = {
    "constant length": (DASHED, CATEGORIES[3]),
    "elliptical patch": (SOLID, CATEGORIES[0]),
    "plane sections": (DOTTED, CATEGORIES[1]),
}


def _looks(names: Sequence[str]) -> dict[str, dict]:
    """Marker of each subject, and its name for a legend; the mean a star in ink."""
    subjects = [name for name in names if name != "mean"]
    looks = {"mean": {"color": INK, "marker": "*", "ms": 8, "label": "mean"}}
    for name, look in ordered("subject", subjects).items():
        mark = {"color": look["color"], "marker": MARKERS[list(names).index(name) % len(MARKERS)]}
        looks[name] = mark | {"ms": 4.5, "label": f"subject {name}"}
    return {name: {"ls": "none"} | looks[name] for name in names}


@styled
def fit(frame: pd.DataFrame) -> Figure:
    """Measured steady forces, fitted curves with 95 % bands and the thesis's constant; the mean
    with the bone moved.
    """
    simulated = is_simulated(frame)
    note = (
        "Lines: simulated, steady state; moduli times a fitted constant (dotted: its 95 % "
        "confidence), dashed: the moduli stated in the thesis. "
        f"Points: {'; '.join(frame.loc[~simulated, 'source'].unique())}."
    )
    fig = study_figure("Calibration: steady force under a flat plate", [note], 3.4)
    left, right = fig.subplots(1, 2, sharey=True)
    subjects = frame[frame["panel"] == "subjects"]
    looks = _looks(subjects.loc[~simulated, "series"].unique())
    for who, look in looks.items():
        rows = subjects[subjects["series"] == who]
        line, points = rows[simulated[rows.index]], rows[~simulated[rows.index]]
        colour = look["color"]
        # the ends as lines, for overlapping bands show seams that look like curves
        for end in ("force_low (N)", "force_high (N)"):
            left.plot(line[DEPTH], line[end], color=colour, lw=0.5, ls=DOTTED)
        left.plot(line[DEPTH], line[FORCE], color=colour, lw=1.8 if who == "mean" else 1.1)
        left.plot(points[DEPTH], points[FORCE], **look)
    stated = subjects[subjects["series"] == "thesis"]
    left.plot(stated[DEPTH], stated[FORCE], color=GREY, ls=DASHED)
    top = max(1.6, 1.1 * float(frame.loc[~simulated, FORCE].max()))
    inside = stated.loc[stated[FORCE] < 0.93 * top, [DEPTH, FORCE]].iloc[-1]
    place = {"textcoords": "offset points", "ha": "right", "va": "center", "color": GREY}
    left.annotate("moduli stated\nin the thesis", inside, (-4, 0), **place)
    left.set(xlabel="indentation depth (mm)", ylabel="force (N)", xlim=(0, 2.5), ylim=(0, top))
    left.set_title("each subject, and the mean")
    left.legend(title="measured", loc="upper left", alignment="left")
    bone = frame[frame["panel"] == "bone"]
    styles = ((0, (4, 1.8)), "-", (0, (1, 1.2)))
    for style, (name, rows) in zip(styles, bone.groupby("series", sort=False), strict=False):
        right.plot(rows[DEPTH], rows[FORCE], color=INK, ls=style, lw=1.3, label=name)
    last, look = list(looks.items())[-1]
    rows = subjects[(subjects["series"] == last) & ~is_simulated(subjects)]
    marker = "*" if last == "mean" else "o"
    right.plot(rows[DEPTH], rows[FORCE], marker, color=INK, ms=8)
    right.set(xlabel="indentation depth (mm)", xlim=(0, 2.5))
    right.set_title(f"{look['label']}, the bone moved, the same constant")
    right.legend(loc="upper left", title="fat under the apex", alignment="left")
    return fig


@styled
def identifiability(frame: pd.DataFrame) -> Figure:
    """The valley of equal misfit over constant and contact length, and the profiles along each and
    across.
    """
    note = [
        "Rise of the sum of squares of simulated against measured forces above its least, "
        "over the squared scatter of the fit. "
        "Along the valley nothing changes: force tells modulus × contact length, nothing "
        "of either alone."
    ]
    fig = study_figure("Calibration: what force can tell", note, 3.7)
    left, right = fig.subplots(1, 2, width_ratios=(1.15, 1))
    ridge = frame[frame["panel"] == "ridge"]
    grid = ridge.pivot(
        index="contact_length (mm)", columns="modulus_constant (1)", values="rise (1)"
    )
    filled = left.contourf(
        grid.columns,
        grid.index,
        np.log10(grid.to_numpy() + 0.1),
        levels=np.linspace(-1, 3.2, 22),
        cmap="viridis_r",
        extend="max",
    )
    filled.set_edgecolor("face")
    lines = left.contour(
        grid.columns,
        grid.index,
        grid.to_numpy(),
        levels=[3, 10, 30, 100, 300, 1000],
        colors="white",
        linewidths=0.6,
    )
    left.clabel(lines, lines.levels[1:], fmt="%g", fontsize=6.5)
    s, length = (np.sqrt(axis[0] * axis[-1]) for axis in (grid.columns, grid.index))
    left.plot(grid.columns, s * length / grid.columns, color=INK, lw=1.2)
    left.plot([1.0], [length], "X", color=CATEGORIES[1], ms=7, mec="white", mew=0.8)
    left.annotate(
        "stated in the thesis\n(the length inferred)",
        (1.0, length),
        xytext=(0.97, 0.95),
        textcoords="axes fraction",
        fontsize=6.5,
        color="white",
        ha="right",
        va="top",
        arrowprops={"arrowstyle": "-", "color": "white", "lw": 0.6},
    )
    left.set(
        xscale="log",
        yscale="log",
        xlabel="modulus constant (1)",
        ylabel="contact length (mm)",
        title="misfit over both; line: their best product",
        xlim=(grid.columns[0], grid.columns[-1]),
        ylim=(grid.index[0], grid.index[-1]),
    )
    for axis in (left.xaxis, left.yaxis):
        axis.set_major_locator(mpl.ticker.LogLocator(subs=(1, 2, 5)))
        axis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
        axis.set_minor_formatter(mpl.ticker.NullFormatter())
    profile = frame[frame["panel"] == "profile"]
    styles = {
        "modulus constant x contact length": (SOLID, 1.4),
        "contact length": (SOLID, 2.6),
        "modulus constant": (DOTTED, 1.0),
    }
    for name, (style, width) in styles.items():
        rows = profile[profile["series"] == name]
        colour = "0.75" if width > 2 else INK  # the two alone lie on one another
        right.plot(
            rows["relative (1)"], rows["rise (1)"], color=colour, ls=style, lw=width, label=name
        )
    for row in frame[frame["panel"] == "level"].itertuples():
        level = frame.loc[row.Index, "rise (1)"]
        right.axhline(level, color=GREY, lw=0.7)
        right.text(
            1.49,
            level + 0.3,
            textwrap.fill(row.series, 16),
            color=GREY,
            fontsize=6.5,
            ha="right",
            va="bottom",
        )
    right.set(
        xlabel="value over best value (1)",
        ylabel="rise of the misfit (1)",
        title="profiles, the other refitted",
        ylim=(-0.8, 25),
        xlim=(0.5, 1.5),
    )
    right.text(1.0, 18, "modulus constant\nx contact length", ha="center", va="center")
    right.text(0.52, 0.5, "either alone", va="bottom")
    return fig


@styled
def residuals(frame: pd.DataFrame) -> Figure:
    """Misfit by depth with a constant contact length and with two that grow, and the effective
    length that force asks for.
    """
    note = [
        "Measured forces less simulated ones, whose contact length has one parameter, "
        "fitted with the thesis's moduli. "
        "Elliptical patch: proportional to the width; plane sections: each pressed by "
        "itself. Thin, a marker a subject; thick: "
        "the mean."
    ]
    fig = study_figure("Calibration: a contact that grows", note, 3.4)
    left, right = fig.subplots(1, 2)
    residual = frame[frame["panel"] == "residuals"]
    subjects = residual["subject"].unique()
    looks = _looks(subjects)
    thick = "mean" if "mean" in subjects else subjects[0]
    for model, (style, colour) in MODEL_LINES.items():
        for who, rows in residual[residual["series"] == model].groupby("subject"):
            look = {"lw": 0.6, "ms": 2.5, "marker": looks[who]["marker"]}
            if who == thick:
                look = {"lw": 1.8, "ms": 4.5, "marker": "*", "label": model}
            left.plot(rows[DEPTH], 1e3 * rows["residual (N)"], color=colour, ls=style, **look)
    left.axhline(0, color=GREY, lw=0.7)
    left.set(
        xlabel="indentation depth (mm)", ylabel="measured less simulated (mN)", title="residuals"
    )
    low, high = left.get_ylim()
    left.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    left.legend(loc="upper left")
    length = frame[frame["panel"] == "length"]
    needed, fitted = length[length["series"] == "needed"], length[length["series"] != "needed"]
    for who, rows in needed.groupby("subject", sort=False):
        right.plot(rows[DEPTH], rows["effective_length (mm)"], **looks[who])
    for model, rows in fitted.groupby("series", sort=False):
        style, colour = MODEL_LINES[model]
        right.plot(rows[DEPTH], rows["effective_length (mm)"], color=colour, ls=style)
    right.set(
        xlabel="indentation depth (mm)",
        ylabel="effective length (mm)",
        title="measured force / simulated force per length",
        ylim=(0, None),
        xlim=(0, 2.5),
    )
    right.legend(loc="upper left", ncols=2, fontsize=6.5)
    return fig


@styled
def friction(frame: pd.DataFrame) -> Figure:
    """Lateral displacement along the strokes, its mean and range over the coefficient, the thesis's
    stretch, published values.
    """
    panels = {name: rows for name, rows in frame.groupby("panel", sort=False)}
    published = panels["published"]
    note = [
        "Simulated (the first two convexities, 20 gf, 10 mm/s). Blue: about 1 mm, the "
        "stretch the thesis states; dotted: the "
        "axis of its Fig. 5-15. Published coefficients were measured by others: sources in "
        "the CSV.",
    ]
    fig = study_figure("Calibration: friction from the stretch of the skin", note, 3.8)
    grid = fig.add_gridspec(2, 2, height_ratios=(3.2, 1))
    left, right = fig.add_subplot(grid[:, 0]), fig.add_subplot(grid[0, 1])
    below = fig.add_subplot(grid[1, 1], sharex=right)
    about, axis = (panels["stated"].iloc[k] for k in (0, 1))
    for ax in (left, right):
        ax.axhspan(about["lowest (mm)"], about["highest (mm)"], color=TOUCHED, lw=0, zorder=0)
        ax.axhline(about[LATERAL], color=CATEGORIES[0], lw=0.8, zorder=1)
        for end in ("lowest (mm)", "highest (mm)"):
            ax.axhline(axis[end], color=GREY, lw=0.8, ls=(0, (1, 1.6)))
    courses = list(panels["course"].groupby("series", sort=False))
    ends = [rows[LATERAL].iloc[-1] for _, rows in courses]
    gap = 0.035 * np.ptp([*panels["course"][LATERAL], axis["lowest (mm)"], axis["highest (mm)"]])
    places = spread(ends, gap, min(ends) - 1, max(ends) + 1)
    for k, ((name, rows), place) in enumerate(zip(courses, places, strict=True)):
        colour = mpl.colormaps["cividis"](0.8 * k / max(len(courses) - 1, 1))
        left.plot(rows[DISTANCE], rows[LATERAL], color=colour, lw=1.0)
        left.text(rows[DISTANCE].iloc[-1] + 0.8, place, name, fontsize=6.5, va="center")
    start, end = panels["waves"][DISTANCE]
    for x in (start, end):
        left.axvline(x, color=GREY, lw=0.6)
    left.text(
        (start + end) / 2,
        0.985,
        "waves",
        transform=left.get_xaxis_transform(),
        color=GREY,
        fontsize=6.5,
        ha="center",
        va="top",
    )
    left.set(
        xlabel="stroke distance (mm)",
        ylabel="lateral displacement of the centre (mm)",
        title="strokes; number: coefficient of friction",
        xlim=(0, 1.1 * frame[DISTANCE].max()),
    )
    curve, estimate = panels["stretch"], panels["estimate"].iloc[0]
    right.fill_between(
        curve[COEFFICIENT], curve["lowest (mm)"], curve["highest (mm)"], color=INK, alpha=0.13, lw=0
    )
    right.plot(curve[COEFFICIENT], curve[LATERAL], "o-", color=INK, ms=3, lw=1.2)
    right.plot(estimate[COEFFICIENT], estimate[LATERAL], "*", color=CATEGORIES[1], ms=8, zorder=4)
    variations = panels.get("variations", frame.iloc[:0])[:4]
    low, high = curve["lowest (mm)"].min(), curve["highest (mm)"].max()
    on_white = {"fc": "white", "ec": "none", "alpha": 0.7, "pad": 0.6}
    names = spread(variations[LATERAL], 0.08 * (high - low), low, high) if len(variations) else ()
    open_mark = {"color": CATEGORIES[3], "ms": 4, "mfc": "white"}
    for marker, row, place in zip("<>^v", variations.to_dict("records"), names, strict=False):
        right.plot([row[COEFFICIENT], 0.5], [row[LATERAL], place], color=GREY, lw=0.5, zorder=1)
        right.plot(row[COEFFICIENT], row[LATERAL], marker, **open_mark)
        right.text(0.51, place, row["series"], va="center", color=INK, fontsize=6.5, bbox=on_white)
    right.margins(y=0.1)
    right.set(
        ylabel="displacement over the waves (mm)", title="mean and range; open: one thing changed"
    )
    right.tick_params(labelbottom=False)
    for k, row in enumerate(published.iloc[::-1].to_dict("records")):
        measured = str(row["source"]).startswith("measured")
        ends = [row["lowest_coefficient (1)"], row["highest_coefficient (1)"]]
        below.plot(ends, [k, k], color=INK, lw=2.2)
        below.plot(row[COEFFICIENT], k, "o", color=INK, ms=4, mfc=INK if measured else "white")
        label = row["series"] if measured else "assumed in a model"
        below.text(0.02, k, label, transform=below.get_yaxis_transform(), fontsize=6.5, va="center")
    below.axvline(estimate[COEFFICIENT], color=CATEGORIES[1], lw=0.8)
    below.text(
        estimate[COEFFICIENT] + 0.012,
        len(published) - 1,
        f"{estimate[COEFFICIENT]:.3f}",
        va="center",
    )
    below.set(
        xlabel="coefficient of friction (1)",
        title="published",
        yticks=[],
        ylim=(-0.7, len(published) - 0.3),
        xlim=(0, 1.12),
    )
    return fig


STUDIES: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "calibration_fit": fit,
    "calibration_identifiability": identifiability,
    "calibration_residuals": residuals,
    "calibration_friction": friction,
}
"""Study figure -> function of its data frame."""

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
    SOLID,
    ordered,
    spread,
    study_figure,
    styled,
)
from fingerpad.measures.features import is_simulated

DEPTH, FORCE, COEFFICIENT = "depth (mm)", "force (N)", "coefficient (1)"
MARKERS = "os^Dv<>P"
TOUCHED = "#c9dbe8"
"""Shade of what is about a number."""
MODEL_LINES = {
    "constant length": (DASHED, CATEGORIES[3]),
    "elliptical patch": (SOLID, CATEGORIES[0]),
    "plane sections": (DOTTED, CATEGORIES[1]),
}


def _colours(names: Sequence[str]) -> dict[str, object]:
    """Colour of each subject; the mean in ink."""
    looks = ordered("subject", [name for name in names if name != "mean"])
    return {name: look["color"] for name, look in looks.items()} | {"mean": INK}


def _title_of(who: str) -> str:
    return who if who == "mean" else f"subject {who}"


@styled
def fit(frame: pd.DataFrame) -> Figure:
    """Measured steady forces, fitted curves with 95 % bands and the thesis's constant; the mean
    with the bone moved.
    """
    note = [
        "Lines: simulated, steady state; moduli times a fitted constant (dotted: its 95 % "
        "confidence), dashed: the moduli stated "
        f"in the thesis. Points: {_measured(frame)}."
    ]
    fig = study_figure("Calibration: steady force under a flat plate", note, 3.4)
    left, right = fig.subplots(1, 2, sharey=True)
    simulated = is_simulated(frame)
    subjects = frame[frame["panel"] == "subjects"]
    names = list(subjects.loc[~simulated, "series"].unique())
    colours = _colours(names)
    for k, who in enumerate(names):
        rows = subjects[subjects["series"] == who]
        line, points = rows[is_simulated(rows)], rows[~is_simulated(rows)]
        mean = who == "mean"
        ends = {"color": colours[who], "lw": 0.5, "ls": DOTTED}
        for end in (
            "force_low (N)",
            "force_high (N)",
        ):  # lines, for overlapping bands show seams that look like curves
            left.plot(line[DEPTH], line[end], **ends)
        left.plot(line[DEPTH], line[FORCE], color=colours[who], lw=1.8 if mean else 1.1)
        marker = "*" if mean else MARKERS[k % len(MARKERS)]
        left.plot(
            points[DEPTH],
            points[FORCE],
            marker,
            color=colours[who],
            ms=8 if mean else 4.5,
            label=_title_of(who),
        )
    stated = subjects[subjects["series"] == "thesis"]
    left.plot(stated[DEPTH], stated[FORCE], color=GREY, ls=DASHED)
    top = max(1.6, 1.1 * float(frame.loc[~simulated, FORCE].max()))
    inside = stated[stated[FORCE] < 0.93 * top].iloc[-1]
    left.annotate(
        "moduli stated\nin the thesis",
        (inside[DEPTH], inside[FORCE]),
        xytext=(-4, 0),
        textcoords="offset points",
        ha="right",
        va="center",
        color=GREY,
    )
    left.set(
        xlabel="indentation depth (mm)",
        ylabel="force (N)",
        title="each subject, and the mean",
        ylim=(0, top),
        xlim=(0, 2.5),
    )
    left.legend(title="measured", loc="upper left", alignment="left")
    bone = frame[frame["panel"] == "bone"]
    styles = ((0, (4, 1.8)), "-", (0, (1, 1.2)))
    for style, (name, rows) in zip(styles, bone.groupby("series", sort=False), strict=False):
        right.plot(rows[DEPTH], rows[FORCE], color=INK, ls=style, lw=1.3, label=name)
    last = subjects[(subjects["series"] == names[-1]) & ~is_simulated(subjects)]
    right.plot(last[DEPTH], last[FORCE], "*" if names[-1] == "mean" else "o", color=INK, ms=8)
    right.set(
        xlabel="indentation depth (mm)",
        title=f"{_title_of(names[-1])}, the bone moved, the same constant",
        xlim=(0, 2.5),
    )
    right.legend(loc="upper left", title="fat under the apex", alignment="left")
    return fig


def _measured(frame: pd.DataFrame) -> str:
    sources = frame.loc[~is_simulated(frame), "source"].drop_duplicates()
    return "; ".join(sources)


@styled
def identifiability(frame: pd.DataFrame) -> Figure:
    """The valley of equal misfit over constant and contact length, and the profiles along each and
    across.
    """
    note = [
        "Rise of the sum of squares of simulated against measured forces above its least, over "
        "the squared scatter of the fit. "
        "Along the valley nothing changes: force tells modulus × contact length, nothing of "
        "either alone."
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
        "Measured forces less simulated ones, whose contact length has one parameter, fitted with "
        "the thesis's moduli. "
        "Elliptical patch: proportional to the width; plane sections: each pressed by itself. "
        "Thin, a marker a subject; thick: "
        "the mean."
    ]
    fig = study_figure("Calibration: a contact that grows", note, 3.4)
    left, right = fig.subplots(1, 2)
    residual = frame[frame["panel"] == "residuals"]
    subjects = residual["subject"].unique()
    thick = "mean" if "mean" in subjects else subjects[0]
    for model, (style, colour) in MODEL_LINES.items():
        for who, rows in residual[residual["series"] == model].groupby("subject"):
            mean = who == thick
            marker = "*" if mean else MARKERS[list(subjects).index(who) % len(MARKERS)]
            left.plot(
                rows[DEPTH],
                1e3 * rows["residual (N)"],
                color=colour,
                ls=style,
                lw=1.8 if mean else 0.6,
                marker=marker,
                ms=4.5 if mean else 2.5,
                label=model if mean else None,
            )
    left.axhline(0, color=GREY, lw=0.7)
    left.set(
        xlabel="indentation depth (mm)", ylabel="measured less simulated (mN)", title="residuals"
    )
    low, high = left.get_ylim()
    left.set_ylim(low, high + 0.35 * (high - low))  # room for the legend
    left.legend(loc="upper left")
    length = frame[frame["panel"] == "length"]
    needed, fitted = length[length["series"] == "needed"], length[length["series"] != "needed"]
    colours = _colours(list(needed["subject"].unique()))
    for k, (who, rows) in enumerate(needed.groupby("subject", sort=False)):
        marker = "*" if who == "mean" else MARKERS[k % len(MARKERS)]
        right.plot(
            rows[DEPTH],
            rows["effective_length (mm)"],
            marker,
            color=colours[who],
            ms=8 if who == "mean" else 4.5,
            label=_title_of(who),
        )
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
def prony(frame: pd.DataFrame) -> Figure:
    """Ramp-and-hold force and its fits, their errors, and how well amplitudes of the measured time
    constants could be told.
    """
    note = [
        "Simulated throughout, with known noise: no measured time courses are at hand. Time "
        "constants of Pawluk and Howe "
        "(1999) are measured, without amplitudes; right: the error any amplitude would have."
    ]
    fig = study_figure("Calibration: relaxation under a held depth of 1 mm", note, 4.0)
    grid = fig.add_gridspec(2, 2, width_ratios=(1.35, 1), height_ratios=(1.5, 1))
    top, below, right = (
        fig.add_subplot(grid[0, 0]),
        fig.add_subplot(grid[1, 0]),
        fig.add_subplot(grid[:, 1]),
    )
    force = frame[frame["panel"] == "force"]
    noisy = force[force["series"] == "with noise"]
    top.plot(noisy["time (s)"], noisy[FORCE], ".", color=GREY, ms=4, label="simulated, with noise")
    styles = {
        "thesis's series, hereditary": (DOTTED, CATEGORIES[3]),
        "fitted, hereditary": (DASHED, CATEGORIES[1]),
        "fitted, corrected": ("-", INK),
        "Pawluk and Howe's constants": ((0, (3, 1.2, 1, 1.2)), CATEGORIES[0]),
    }
    for name, (style, colour) in styles.items():
        rows = force[force["series"] == name]
        top.plot(rows["time (s)"], rows[FORCE], color=colour, ls=style, lw=1.2, label=name)
        below.plot(
            rows["time (s)"], rows["difference (% of the peak)"], color=colour, ls=style, lw=1.2
        )
    for ax in (top, below):
        ax.set(xscale="log", xlim=(0.015, 10.5))
        ax.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    top.tick_params(labelbottom=False)
    top.set(ylabel="force (N)", ylim=(0, 1.6 * noisy[FORCE].max()))
    top.legend(loc="upper left", fontsize=6, ncols=2, columnspacing=0.9, handlelength=1.8)
    below.axhline(0, color=GREY, lw=0.7)
    below.set(xlabel="time (s)", ylabel="off the simulation\n(% of the peak)")
    told = frame[frame["panel"] == "amplitudes"]
    for marker, (speed, rows) in zip(MARKERS, told.groupby("series", sort=False), strict=False):
        right.plot(
            rows["tau (s)"],
            rows["half_width (1)"],
            marker=marker,
            color=INK,
            lw=0.9,
            ms=5,
            mfc="white" if marker == "o" else INK,
            label=f"ramp of {speed}",
        )
    right.set(
        xscale="log",
        yscale="log",
        xlabel="time constant (s)",
        ylabel="95 % half-width of an amplitude\nover the steady force (1)",
        title="error of an amplitude",
    )
    right.xaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    right.yaxis.set_major_formatter(mpl.ticker.FormatStrFormatter("%g"))
    right.legend(loc="upper right")
    return fig


@styled
def friction(frame: pd.DataFrame) -> Figure:
    """Lateral displacement along the strokes, its mean and range over the coefficient, the thesis's
    stretch, published values.
    """
    panels = {name: rows for name, rows in frame.groupby("panel", sort=False)}
    published = panels["published"]
    note = [
        "Simulated (the first two convexities, 20 gf, 10 mm/s). Blue: about 1 mm, the stretch the "
        "thesis states; dotted: the "
        "axis of its Fig. 5-15. Published coefficients were measured by others: sources in the "
        "CSV.",
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
    for marker, row, place in zip("<>^v", variations.to_dict("records"), names, strict=False):
        right.plot([row[COEFFICIENT], 0.5], [row[LATERAL], place], color=GREY, lw=0.5, zorder=1)
        right.plot(
            row[COEFFICIENT],
            row[LATERAL],
            marker,
            color=CATEGORIES[3],
            ms=4,
            mfc="white",
            ls="none",
        )
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
    "calibration_prony": prony,
    "calibration_friction": friction,
}
"""Study figure -> function of its data frame."""

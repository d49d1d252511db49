"""Pictures of the views, each drawn from its data frame alone."""

from __future__ import annotations

import textwrap
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.quantities import DISTANCE, FORCE, IMPULSE, IMPULSE_RATE, SED, TIME, P, X, Y
from cysyk1999.publishing import style
from cysyk1999.publishing.write import publish, without_round_off
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.views import picture as views
from cysyk1999.studies.views.frames import (
    BOUND,
    CORNERS,
    FRAMES,
    LEVELS,
    SKIN_X,
    SLIP,
    SLIPS,
    STATE,
    STICKING,
    TRACTION,
)

LABELLED = (("epidermis", ("skin", "dermis"), -4.6, 7.6), ("dermis", ("dermis", "fat"), -7.6, 5.0))
"""Layer, the lines round it, x it is pointed at, and height of its name, mm."""
ENERGY = "strain energy density on the instantaneous moduli (Pa)"


def _of(frame: pd.DataFrame, panel: str, series: str = "") -> pd.DataFrame:
    rows = frame[frame["panel"] == panel] if panel else frame
    return rows[rows["series"] == series] if series else rows


def _polygons(rows: pd.DataFrame) -> np.ndarray:
    return rows[list(CORNERS)].to_numpy().reshape(len(rows), 4, 2)


def _field(ax: Axes, rows: pd.DataFrame, norm, mesh: float = 0.0):
    """Elements in the colours of their strain energy."""
    drawn = PolyCollection(
        _polygons(rows), array=rows[SED], cmap=style.FIELD, norm=norm, rasterized=True
    )
    drawn.set(edgecolor="face" if not mesh else "0.3", linewidth=mesh or 0.2)
    ax.add_collection(drawn)
    return drawn


def _energies(frame: pd.DataFrame, low: float = 2e-3) -> LogNorm:
    """A scale from a share of the largest energies, rounded, to them, whatever a singular point
    has.
    """
    high = float(np.nanpercentile(frame[SED].dropna(), 99.7))
    return LogNorm(high * low, high)


def _layers(ax: Axes, rows: pd.DataFrame, colour: str = "white", width: float = 0.8) -> None:
    """Boundaries of the layers and the skin."""
    for layer in ("skin", "dermis", "fat", "bone"):
        line = rows[(rows["series"] == "line") & (rows["layer"] == layer)]
        ax.plot(line[X], line[Y], color=style.INK if layer == "skin" else colour, lw=width)


def _surface(ax: Axes, rows: pd.DataFrame, top: float) -> None:
    """The solid that touches."""
    line = rows[(rows["series"] == "line") & (rows["layer"] == "surface")].sort_values(X)
    ax.fill_between(line[X], line[Y], np.maximum(line[Y], top), color=style.PALE, lw=0)
    ax.plot(line[X], line[Y], color=style.GREY, lw=0.7)


def _receptors(ax: Axes, rows: pd.DataFrame, size: float = 3.0) -> None:
    dots = rows[rows["series"] == "receptor"]
    ax.plot(dots[X], dots[Y], "o", ms=size, mfc="white", mec=style.INK, mew=0.7)


def _bar(fig: Figure, drawn, axes, **options) -> None:
    bar = fig.colorbar(drawn, ax=axes, **{"pad": 0.01, "aspect": 22, "extend": "both"} | options)
    bar.outline.set_visible(False)
    bar.set_label(ENERGY)


@style.styled
def overview(frame: pd.DataFrame) -> Figure:
    """One case in a row: the surface on the layered pad, pressure, strain energy, response."""
    fig = style.study_figure(
        "From a surface to impulses: a cylinder of 210 1/m pressed to 20 gf in 0.5 s and held",
        [
            "Simulated in plane strain, not measured; a to c at the top of the ramp. Rate by Eq "
            "5-1 of Cysyk (1999) from the "
            "strain energy at 915 µm (lower circle); impulses of one trial."
        ],
        2.45,
    )
    grid = fig.add_gridspec(2, 4, width_ratios=[1.2, 0.75, 1.45, 1.0])
    pad, press, field = (fig.add_subplot(grid[:, k]) for k in range(3))
    middle, below = (fig.add_subplot(grid[k, 3]) for k in range(2))
    rows = _of(frame, "section")
    lines = {layer: part for layer, part in rows[rows["series"] == "line"].groupby("layer")}
    for layer, colour in (
        ("skin", "epidermis"),
        ("dermis", "dermis"),
        ("fat", "fat"),
        ("bone", "bone"),
    ):
        pad.fill(
            lines[layer][X], lines[layer][Y], fc=style.LAYER_COLOURS[colour], ec=style.INK, lw=0.5
        )
    _surface(pad, rows, 9.0)
    _receptors(pad, rows, 1.8)
    loops = {k: lines[k][[X, Y]].to_numpy() for k in ("skin", "dermis", "fat")}
    for name, (outer, inner), x, y in LABELLED:
        high = [_upper(loops[k], x) for k in (outer, inner)]
        line = {"arrowstyle": "-", "lw": 0.5, "shrinkA": 1, "shrinkB": 0}
        pad.annotate(
            name,
            (x, np.mean(high)),
            (-9.0, y),
            fontsize=6,
            va="center",
            ha="right",
            arrowprops=line,
        )
    pad.text(0, 2.3, "fat", ha="center", va="center", fontsize=6)
    pad.text(0, -1.8, "bone", ha="center", va="center", fontsize=6)
    pad.text(0, 7.1, "surface", ha="center", va="center", fontsize=6)
    pad.set(
        xlim=(-12.8, 10),
        ylim=(-8.4, 9),
        aspect="equal",
        title="the surface on the pad",
        xticks=[],
        yticks=[],
    )
    pad.plot([5, 10], [-8.2, -8.2], color=style.INK, lw=1.6, solid_capstyle="butt")
    pad.text(7.5, -8.0, "5 mm", ha="center", va="bottom", fontsize=6)
    for side in pad.spines.values():
        side.set_visible(False)
    rows = _of(frame, "pressure")
    press.fill_between(rows[X], rows[P], color="#cfd8df", lw=0)
    press.plot(rows[X], rows[P], color=style.INK)
    press.set(
        xlim=(-2.6, 2.6),
        ylim=(0, 1.1 * rows[P].max()),
        xlabel=X.label,
        ylabel="contact pressure (Pa)",
        title="pressure",
    )
    style.in_kilo(press.yaxis)
    rows = _of(frame, "field")
    drawn = _field(field, rows, _energies(rows))
    _layers(field, _of(frame, "section"))
    _surface(field, _of(frame, "section"), 6.8)
    _receptors(field, _of(frame, "section"))
    field.set(
        xlim=(-2.6, 2.6),
        ylim=(3.4, 6.6),
        aspect="equal",
        xlabel=X.label,
        title="strain energy",
        yticks=[4, 5, 6],
        ylabel=Y.label,
    )
    bar = fig.colorbar(drawn, ax=field, pad=0.02, aspect=16, shrink=0.75, extend="both")
    bar.set_label("strain energy\ndensity (Pa)")
    bar.outline.set_visible(False)
    rows = _of(frame, "energy")
    middle.plot(rows[TIME], rows[SED], color=style.INK)
    middle.set(
        ylabel="strain energy\n(Pa)", ylim=(0, 1.12 * rows[SED].max()), title="what it feels"
    )
    rate, ticks = _of(frame, "rate"), _of(frame, "impulses")
    below.plot(rate[TIME], rate[IMPULSE_RATE], color=style.INK)
    top = 1.5 * rate[IMPULSE_RATE].max()
    below.vlines(ticks[IMPULSE], 0.82 * top, 0.97 * top, color=style.INK, lw=0.7)
    below.set(
        ylabel="predicted rate\n(impulses/s)", xlabel=TIME.label, ylim=(0, top), title="and answers"
    )
    for ax in (middle, below):
        ax.set_xlim(0, rate[TIME].max())
        ax.tick_params(labelbottom=ax is below)
    return fig


def _upper(loop: np.ndarray, x: float) -> float:
    """Height at which a closed line (n, 2) passes `x` on its upper side."""
    near = loop[np.argsort(abs(loop[:, 0] - x))]
    return float(near[near[:, 1] > loop[:, 1].mean()][0, 1])


@style.styled
def fields(frame: pd.DataFrame) -> Figure:
    """Strain energy under a plate and two cylinders."""
    fig = style.study_figure(
        "Strain energy under three surfaces, 20 gf at the top of the ramp",
        [
            "Simulated in plane strain, not measured. Lines: skin, epidermis to dermis, dermis to "
            "fat; circles: receptors that "
            "were 600 and 915 µm under the skin. The stiff epidermis holds most of it; the "
            "sharper the surface, the closer to "
            "it."
        ],
        2.6,
    )
    axes, norm = fig.subplots(1, 3, sharey=True), _energies(frame)
    for ax, panel in zip(axes, frame["panel"].drop_duplicates(), strict=True):
        rows = _of(frame, panel)
        drawn = _field(ax, rows[rows["series"] == "element"], norm)
        _layers(ax, rows)
        _surface(ax, rows, 7.0)
        _receptors(ax, rows)
        ax.set(xlim=(-4.3, 4.3), ylim=(1.4, 6.6), aspect="equal", xlabel=X.label)
        ax.set_title("flat plate" if panel == "flat" else f"K = {panel} 1/m")
    axes[0].set_ylabel(Y.label)
    _bar(fig, drawn, axes, orientation="horizontal", aspect=60, shrink=0.6)
    return fig


@style.styled
def mesh_close_up(frame: pd.DataFrame) -> Figure:
    """Deformed meshes from close by, draft to fine, with the pressure that each gives."""
    fig = style.study_figure(
        "The contact on the meshes of draft, thesis and fine",
        [
            "Simulated. Above: deformed elements, circles: skin nodes in contact; below: pressure "
            "at the skin's nodes. Left: a "
            "cylinder of 1260 1/m at 20 gf, top of the ramp; right: convexities of 157, 210 and "
            "315 1/m at 20 gf, steady state."
        ],
        5.3,
    )
    grid = fig.add_gridspec(3, 6, height_ratios=[1.15, 1.15, 1.3])
    looks = dict(zip(LEVELS, style.CATEGORIES, strict=False))
    for row, surface, half, low in ((0, "k1260", 0.6, 4.75), (1, "wavy", 2.4, 4.55)):
        for column, level in enumerate(LEVELS):
            ax = fig.add_subplot(grid[row, 2 * column : 2 * column + 2])
            rows = _of(frame, f"{surface} {level}")
            mesh = rows[rows["series"] == "element"]
            faces = [style.LAYER_COLOURS[layer] for layer in mesh["layer"]]
            ax.add_collection(
                PolyCollection(
                    _polygons(mesh), facecolors=faces, edgecolors="0.25", linewidths=0.35
                )
            )
            _surface(ax, rows, 6.6)
            skin, touching = (
                rows[rows["layer"] == "skin"].sort_values(X),
                rows[(rows["contact (1)"] == 1)],
            )
            ax.plot(
                touching[X],
                np.interp(touching[X], skin[X], skin[Y]),
                "o",
                ms=2.4,
                color=looks[level],
                zorder=4,
            )
            high = skin[Y].max()
            ax.set(
                xlim=(-half, half),
                ylim=(high - 1.15 * half if row == 0 else low, high + 0.28 * half),
                aspect="equal",
            )
            ax.set_title(f"{level}, {'1260 1/m' if row == 0 else 'wavy surface'}")
            if column == 0:
                ax.set_ylabel(Y.label)
    for column, (surface, half) in enumerate((("k1260", 0.6), ("wavy", 3.0))):
        ax = fig.add_subplot(grid[2, 3 * column : 3 * column + 3])
        for level, line, marker in zip(
            LEVELS, style.LINES[1::-1] + style.LINES[:1], "os.", strict=False
        ):
            rows = _of(frame, f"{surface} {level}", "pressure").sort_values(X)
            ax.plot(
                rows[X],
                rows[P],
                color=looks[level],
                ls=line,
                marker=marker,
                ms=2.5,
                lw=0.9,
                label=level,
            )
        ax.set(xlim=(-half, half), ylim=(0, None), xlabel=X.label)
        ax.set_ylabel("contact pressure (Pa)")
        style.in_kilo(ax.yaxis)
        if column == 0:
            ax.legend(loc="upper right")
    return fig


@style.styled
def ridges_both_ways(frame: pd.DataFrame) -> Figure:
    """The field round the inner ridges, pressed, and stroked either way."""
    fig = style.study_figure(
        "Why a ridged pad tells the way of a stroke: strain energy round the inner ridges",
        [
            "Simulated: flat plate, 20 gf, calibrated friction, ridges 0.48 mm apart and 0.15 mm "
            "high (assumed). c is the mirror "
            "image of b, as is its motion. Circles: receptors of the thesis, ±46 µm off the tip "
            "of a ridge, 915 µm deep. White "
            "lines: boundaries of layers."
        ],
        2.9,
    )
    axes, norm = (
        fig.subplots(1, 3, sharey=True),
        LogNorm(20, float(np.nanpercentile(frame[SED].dropna(), 99.5))),
    )
    stroked, low = "stroked to the right", frame.loc[frame["series"] == "receptor", Y].min() - 0.35
    shown = (
        ("pressed", 1.0, "pressed"),
        (stroked, 1.0, "plate to the right"),
        (stroked, -1.0, "plate to the left"),
    )
    for ax, (panel, way, title) in zip(axes, shown, strict=True):
        rows = _of(frame, panel).copy()
        middle = rows.loc[rows["series"] == "receptor", X].mean() * way
        for column in (X, *CORNERS[::2]):
            rows[column] *= way
        drawn = _field(ax, rows[rows["series"] == "element"], norm, mesh=0.08)
        _layers(ax, rows)
        _receptors(ax, rows, 2.6)
        ax.set(
            xlim=(middle - 0.5, middle + 0.5),
            ylim=(low, low + 1.0),
            aspect="equal",
            xlabel=X.label,
            title=title,
        )
        dots = rows[rows["series"] == "receptor"].sort_values(X)
        felt = "   ".join(f"{value:.0f}" for value in dots["felt (Pa)"])
        ax.text(
            middle,
            dots[Y].min() - 0.05,
            f"{felt} Pa",
            ha="center",
            va="top",
            fontsize=6.5,
            color="white",
            fontweight="bold",
        )
        if panel != "pressed":
            arrow = {"arrowstyle": "-|>", "lw": 1.2, "color": "white"}
            ax.annotate(
                "",
                (middle + 0.3 * way, low + 0.93),
                (middle - 0.3 * way, low + 0.93),
                arrowprops=arrow,
            )
            moved = rows["carried (mm)"].iloc[0]
            ax.text(
                middle,
                low + 0.89,
                f"skin carried {abs(moved):.2f} mm",
                ha="center",
                va="top",
                fontsize=6.5,
                color="white",
            )
    axes[0].set_ylabel(Y.label)
    _bar(fig, drawn, axes, shrink=0.9)
    fig.axes[-1].set_ylabel("strain energy density (Pa)")
    return fig


@style.styled
def space_time(frame: pd.DataFrame) -> Figure:
    """Maps of a stroke over the skin and the stroke distance."""
    fig = style.study_figure(
        "A stroke in space and time: what every place on the skin feels, 10 mm/s",
        [
            "Simulated: convexities of 52 to 315 1/m (labels at the right), 20 gf, calibrated "
            "friction. Black: where the middle "
            "of a convexity is over the skin at rest; it is met late, for the skin is dragged "
            "along by the surface. Strain "
            "energy on instantaneous moduli."
        ],
        4.9,
    )
    maps = frame[frame["series"] == "map"]
    axes = fig.subplots(1, 3, sharey=True)
    panels = (
        (P, "contact pressure (kPa)", 1e-3, "magma_r"),
        (SED, "strain energy density, 915 µm (Pa)", 1.0, style.FIELD),
        (SLIP, "speed of slip in contact (mm/s)", 1.0, "viridis"),
    )
    marks = frame[frame["series"] == "convexity"]
    for ax, (column, label, factor, colours) in zip(axes, panels, strict=True):
        grid = maps.pivot(index=DISTANCE, columns=SKIN_X, values=column) * factor
        if column == SLIP:
            grid = grid.where(maps.pivot(index=DISTANCE, columns=SKIN_X, values=P) > 0)
        high = np.nanpercentile(grid, 99.5)
        drawn = ax.pcolormesh(
            grid.columns,
            grid.index,
            grid,
            cmap=colours,
            vmin=0,
            vmax=high,
            shading="nearest",
            rasterized=True,
        )
        for mark in marks.itertuples():
            where = marks.loc[mark.Index, DISTANCE]
            ax.plot([-4, 4], [where + 4, where - 4], color=style.INK, lw=0.5, ls=style.DASHED)
        bar = fig.colorbar(
            drawn, ax=ax, orientation="horizontal", pad=0.01, aspect=26, extend="max"
        )
        bar.set_label(label)
        bar.outline.set_visible(False)
        ax.set(
            xlim=(-4, 4),
            ylim=(maps[DISTANCE].max(), maps[DISTANCE].min()),
            xlabel="place on the skin (mm)",
        )
    for mark in marks.index:
        axes[-1].annotate(
            f"{marks.loc[mark, 'curvature (1/m)']:.0f}",
            (4, marks.loc[mark, DISTANCE] - 4),
            (3, 0),
            textcoords="offset points",
            va="center",
            fontsize=6.5,
            annotation_clip=True,
        )
    axes[0].set_ylabel("stroke distance (mm)")
    return fig


@style.styled
def stick_slip(frame: pd.DataFrame) -> Figure:
    """Where the contact sticks and where it slips, at four instants, and the share that sticks over
    the stroke.
    """
    fig = style.study_figure(
        "Stick and slip along the contact of a stroke, 10 mm/s",
        [
            "Simulated. Line: tangential traction; edge of the grey area: its bound, pressure "
            "times friction. Where both meet "
            "the skin slips, elsewhere it sticks; jumps from node to node are those of mesh and "
            "steps. e: share of the load "
            "carried where it sticks."
        ],
        3.6,
    )
    instants = [panel for panel in frame["panel"].drop_duplicates() if panel != "whole"]
    grid = fig.add_gridspec(2, len(instants), height_ratios=[1.5, 1])
    first = None
    for k, panel in enumerate(instants):
        ax = first = fig.add_subplot(grid[0, k], sharey=first)
        rows = _of(frame, panel).sort_values(SKIN_X)
        ax.fill_between(rows[SKIN_X], rows[BOUND], color="0.88", lw=0)
        ax.plot(rows[SKIN_X], rows[TRACTION], color=style.GREY, lw=0.8)
        touching = rows[rows[P] > 0]
        slips = touching[STATE] == SLIPS
        for part, colour, marker in (
            (touching[~slips], style.CATEGORIES[0], "o"),
            (touching[slips], style.CATEGORIES[1], "^"),
        ):
            ax.plot(part[SKIN_X], part[TRACTION], marker, color=colour, ms=2.6)
        reach = 1.1 * touching[SKIN_X].abs().max() if len(touching) else 4
        ax.set(xlim=(-reach, reach), title=f"after {panel}", xlabel=X.label)
        ax.tick_params(labelleft=k == 0)
        if k == 0:
            ax.set_ylabel("traction (Pa)")
            handles = [
                style.handle("sticks", color=style.CATEGORIES[0], marker="o", ls="none", ms=3),
                style.handle("slips", color=style.CATEGORIES[1], marker="^", ls="none", ms=3),
            ]
            ax.legend(handles=handles, loc="upper left", handletextpad=0.1)
        style.in_kilo(ax.yaxis)
    ax = fig.add_subplot(grid[1, :])
    rows = _of(frame, "whole")
    ax.plot(rows[DISTANCE], rows[STICKING], color=style.INK)
    ax.set(xlabel="stroke distance (mm)", ylabel="load that sticks (%)", xlim=(0, 2), ylim=(0, 105))
    return fig


@style.styled
def adaptation(frame: pd.DataFrame) -> Figure:
    """Slowly and rapidly adapting responses to two ramps and holds."""
    fig = style.study_figure(
        "Slowly and rapidly adapting receptors in ramp and hold, K = 210 1/m, 20 gf",
        [
            "Predicted, not recorded. Slowly adapting: Eq 5-1 of Cysyk (1999), strain energy at "
            "915 µm. Rapidly adapting: from "
            "the rate of the skin's curvature; threshold, scale and highest rate are assumed, "
            "nobody states them. Ticks: "
            "impulses of five trials."
        ],
        3.6,
    )
    kinds, programmes = ("slowly adapting", "rapidly adapting"), ("40 gf/s", "150 gf/s")
    axes = fig.subplots(5, 2, sharex="col", height_ratios=[0.6, 0.55, 1, 0.55, 1])
    highest = {
        kind: frame.loc[frame["panel"].str.startswith(kind), IMPULSE_RATE].max() for kind in kinds
    }
    for column, words in zip(axes.T, programmes, strict=True):
        force = _of(frame, f"force {words}")
        column[0].plot(force[TIME], force[FORCE], color=style.INK)
        column[0].set(title=f"ramp of {words}", ylim=(0, 24), yticks=[0, 20])
        for kind, colour, (ticks, rate) in zip(
            kinds, style.CATEGORIES, (column[1:3], column[3:5]), strict=False
        ):
            rows = _of(frame, f"{kind} {words}")
            impulses = rows[rows["series"] == "impulse"]
            ticks.vlines(
                impulses[IMPULSE],
                impulses["trial (1)"] - 0.4,
                impulses["trial (1)"] + 0.4,
                color=style.INK,
                lw=0.6,
            )
            ticks.set(ylim=(5.6, 0.4), yticks=[])
            line = rows[rows["series"] == "rate"]
            rate.fill_between(line[TIME], line[IMPULSE_RATE], color=colour, alpha=0.25, lw=0)
            rate.plot(line[TIME], line[IMPULSE_RATE], color=colour)
            rate.set(ylim=(0, 1.08 * highest[kind]))
            if column is axes.T[0] or words == programmes[0]:
                ticks.set_ylabel(kind.replace(" ", "\n"), rotation=0, ha="right", va="center")
                rate.set_ylabel("rate (1/s)")
        column[0].set_xlim(0, force[TIME].max())
        column[-1].set_xlabel(TIME.label)
    axes[0, 0].set_ylabel("force (gf)")
    return fig


@style.styled
def assumptions(frame: pd.DataFrame) -> Figure:
    """The section, and what of it the thesis states, what follows from it, and what is assumed."""
    fig = style.study_figure(
        "What the model rests on: stated by the thesis, inferred from it, assumed",
        [
            "The model's own section. Stated: printed in the thesis or drawn in it; inferred: "
            "what its figures and numbers ask "
            "for; assumed: neither. Thick: held, as is the rim of the bone. Ridges, of some "
            "scenes only: sizes published "
            "elsewhere or assumed."
        ],
        3.6,
    )
    ax = fig.subplots()
    lines = {layer: rows for layer, rows in frame[frame["series"] == "line"].groupby("layer")}
    shades = {
        "skin": "stratum corneum",
        "corneum": "epidermis",
        "dermis": "dermis",
        "fat": "fat",
        "bone": "bone",
    }
    for layer, colour in shades.items():
        ax.fill(
            lines[layer][X], lines[layer][Y], fc=style.LAYER_COLOURS[colour], ec=style.INK, lw=0.5
        )
    bone, skin = lines["bone"], lines["skin"]
    ax.plot(bone[X], bone[Y], color=style.INK, lw=2.2)
    held = frame.loc[frame["series"] == "held", X]
    under = skin[(skin[Y] < 0) & skin[X].between(held.min(), held.max())].sort_values(X)
    ax.plot(under[X], under[Y], color=style.INK, lw=2.6, solid_capstyle="butt")
    ax.fill_between([-4.0, 4.0], 6.05, 6.9, color=style.PALE, lw=0)
    ax.text(3.9, 6.48, "flat plate", ha="right", va="center", fontsize=6.5)
    for origin, look in style.MEANINGS["origin"].items():
        for row in frame[frame["series"] == origin].to_dict("records"):
            side = "right" if row[X] < 0 else "left"
            line = {
                "arrowstyle": "-",
                "color": look["color"],
                "lw": 0.9,
                "ls": look["ls"],
                "shrinkA": 1,
                "shrinkB": 0,
            }
            box = {
                "boxstyle": "square,pad=0.25",
                "fc": "white",
                "ec": look["color"],
                "lw": 0.9,
                "ls": look["ls"],
            }
            ax.annotate(
                row["words"],
                (row["to_x (mm)"], row["to_y (mm)"]),
                (row[X], row[Y]),
                ha=side,
                va="center",
                fontsize=6.2,
                arrowprops=line,
                bbox=box,
            )
            ax.plot(row["to_x (mm)"], row["to_y (mm)"], look["marker"], color=look["color"], ms=2.6)
    handles = [style.handle(name, **look, ms=3) for name, look in style.MEANINGS["origin"].items()]
    ax.legend(
        handles=handles, loc="lower center", ncols=3, bbox_to_anchor=(0.5, -0.04), handlelength=3
    )
    ax.set(xlim=(-24, 24), ylim=(-8.6, 9.0), aspect="equal")
    ax.axis("off")
    return fig


# --- of tables ---------------------------------------------------------------------------------------------


def scorecard_rows(table: pd.DataFrame, reference: pd.DataFrame) -> pd.DataFrame:
    """Rows of the comparison that are results with a number: where the simulated one lies, as a
    share of the thesis's number, or of the end of its axis or range.
    """
    rows = table[
        table["role"].eq("result")
        & table["simulated"].notna()
        & ~table["verdict"].eq("not_comparable")
    ].copy()
    rows["form"] = rows["id"].map(reference["form"])
    end = rows["thesis_high"].where(rows["form"] != "value", rows["thesis_low"])
    rows["relative (1)"] = rows["simulated"] / end
    rows["low (1)"] = (rows["thesis_low"] / end).where(
        rows["form"] == "range", np.where(rows["form"] == "axis", 0.5, 1.0)
    )
    rows["uncertain"] = rows["thesis_kind"].eq("garbled")
    rows = rows.sort_values(
        "figure",
        key=lambda of: of.str.split("-").map(lambda part: [*map(int, part)]),
        kind="stable",
    )
    return rows[
        [
            "id",
            "figure",
            "quantity",
            "condition",
            "form",
            "relative (1)",
            "low (1)",
            "verdict",
            "uncertain",
        ]
    ]


@style.styled
def scorecard(frame: pd.DataFrame) -> Figure:
    """Every number of the thesis that is a result, a dot a row."""
    counts = frame["verdict"].value_counts()
    inside = counts.get("inside", 0) + counts.get("plausible", 0)
    fig = style.study_figure(
        f"Every number of the thesis against this model: {inside} of {len(frame)} within its range",
        [
            "Simulated over the thesis's number, or over the end of its range or axis (grey: a "
            "number, a range, or half an "
            "axis to its end; broken: reading uncertain). Filled blue: within; open orange: "
            "outside. Results only: nothing "
            "that was put in or fitted."
        ],
        style.TALLEST,
    )
    columns, low, high = 3, 0.25, 4.0
    size = int(np.ceil(len(frame) / columns))
    axes = fig.subplots(1, columns)
    for ax, start in zip(axes, range(0, len(frame), size), strict=True):
        part = frame.iloc[start : start + size]
        for y, row in enumerate(part.to_dict("records")):
            ends = max(row["low (1)"], low), 1.0
            if ends[0] == 1.0:
                ends = 0.97, 1.03
            grey = {
                "color": "0.75" if not row["uncertain"] else "0.8",
                "lw": 2.4,
                "solid_capstyle": "butt",
            }
            ax.plot(
                ends, [y, y], **grey, ls="-" if not row["uncertain"] else (0, (0.7, 0.5)), zorder=1
            )
            look = style.MEANINGS["verdict"][
                "inside" if row["verdict"] in ("inside", "plausible") else "outside"
            ]
            filled = look["color"] if row["verdict"] in ("inside", "plausible") else "white"
            ax.plot(
                np.clip(row["relative (1)"], low, high),
                y,
                "o",
                ms=2.3,
                mec=look["color"],
                mfc=filled,
                mew=0.8,
                zorder=3,
            )
        starts = np.flatnonzero(part["figure"].ne(part["figure"].shift()))
        for k, (begin, end) in enumerate(zip(starts, [*starts[1:], len(part)], strict=True)):
            rows = part.iloc[begin:end]
            ax.axhspan(begin - 0.5, end - 0.5, color="0.965" if k % 2 else "white", lw=0, zorder=0)
            words = textwrap.wrap(
                f"{rows['figure'].iloc[0]} {_short(rows['quantity'].mode()[0])}", 29
            )
            if end - begin > 2:
                words.append(f"{end - begin} numbers")
            ax.text(
                -0.03,
                (begin + end - 1) / 2,
                "\n".join(words),
                transform=ax.get_yaxis_transform(),
                ha="right",
                va="center",
                fontsize=5.6,
                linespacing=1.05,
            )
        ax.set_yticks([])
        ax.axvline(1, color=style.GREY, lw=0.5, zorder=0)
        ax.set(
            xscale="log",
            xlim=(low * 0.9, high * 1.1),
            ylim=(size - 0.4, -0.6),
            xlabel="simulated over thesis",
        )
        ax.set_xticks([0.25, 0.5, 1, 2, 4], ["0.25", "0.5", "1", "2", "4"], fontsize=5.5)
        ax.minorticks_off()
    return fig


def _short(text: str) -> str:
    for long, brief in (
        ("strain energy density", "energy"),
        ("contact pressure", "pressure"),
        ("instantaneous frequency", "frequency"),
        ("vertical displacement of the skin", "sinking"),
        ("larger of 0.04 x centre pressure and", "0.04 pressure or"),
        ("mean rate of the hold", "mean rate"),
        (" um", " µm"),
    ):
        text = text.replace(long, brief)
    return text


def candidate_rows(table: pd.DataFrame) -> pd.DataFrame:
    """Ranked candidates of every set of recorded rates: how much of the rates each explains, and
    the range by how " "they are read.
    """
    rows = table[
        table["rank"].notna() & ~table["rates"].str.startswith("TouchSim")
    ]  # recorded ones, not another model's
    return rows[
        [
            "rates",
            "candidate",
            "depth",
            "r_squared",
            "r_squared_low",
            "r_squared_high",
            "rates used",
            "rank",
        ]
    ].rename(
        columns={
            name: f"{name} (1)"
            for name in ("r_squared", "r_squared_low", "r_squared_high", "rates used", "rank")
        }
    )


@style.styled
def candidate_stimuli(frame: pd.DataFrame) -> Figure:
    """Candidates for what a slowly adapting receptor responds to, ranked by the recorded rates they
    explain.
    """
    sets = list(frame["rates"].drop_duplicates())
    order = frame.groupby("candidate")["r_squared (1)"].median().sort_values(ascending=False).index
    fig = style.study_figure(
        "What does a slowly adapting receptor respond to? Candidate stimuli against recorded rates",
        [
            "Share of the variance of recorded mean rates that a linear law of the simulated "
            "stimulus explains (bars: the ways "
            "to read which surface a rate is of); ordered by the median of the sets. Few rates, "
            "of monkeys, most under "
            "spheres: an order, not a proof."
        ],
        3.3,
    )
    ax = fig.subplots()
    looks = style._looks(sets)
    for k, name in enumerate(sets):
        rows = frame[frame["rates"] == name].set_index("candidate").reindex(order)
        y = np.arange(len(order)) + 0.15 * (k - (len(sets) - 1) / 2)
        look, value = looks[name], rows["r_squared (1)"]
        reach = np.clip(
            [value - rows["r_squared_low (1)"], rows["r_squared_high (1)"] - value], 0, None
        )
        ax.errorbar(
            value.clip(lower=0),
            y,
            xerr=reach,
            fmt=look["marker"],
            color=look["color"],
            ms=3.0,
            elinewidth=0.8,
            label=f"{name} ({rows['rates used (1)'].max():.0f} rates)",
        )
    for k in range(len(order) - 1):
        ax.axhline(k + 0.5, color="0.92", lw=0.5, zorder=0)
    ax.set_yticks(range(len(order)), [name.replace(" x ", " × ") for name in order])
    ax.set(xlim=(0, 1.01), ylim=(len(order) - 0.5, -0.5), xlabel="variance explained, R²")
    ax.tick_params(axis="y", length=0)
    ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return fig


VIEWS: dict[str, Callable[[pd.DataFrame], Figure]] = {
    each.__name__: each
    for each in (
        overview,
        fields,
        mesh_close_up,
        ridges_both_ways,
        space_time,
        stick_slip,
        adaptation,
        assumptions,
    )
}
"""Name of a picture -> its drawing function of its data frame."""


def draw_views(job: SimpleNamespace) -> None:
    """Job: `histories` -> `pictures`, named as in VIEWS."""
    histories, _, _ = read_results(job.histories)
    for picture in job.pictures:
        name = Path(picture).stem
        frame = without_round_off(FRAMES[name][0](histories))
        publish(VIEWS[name](frame), frame, picture)


def table_pictures(job: SimpleNamespace) -> None:
    """Job: `tables`, `reference` -> `pictures`: scorecard of thesis_comparison, candidate_stimuli of the
    table of that name.
    """
    tables = {Path(path).stem: pd.read_csv(path) for path in job.tables}
    for path in job.pictures:
        if Path(path).stem == "scorecard":
            frame, draw = (
                views.scorecard_rows(tables["thesis_comparison"], read_reference(job.reference[0])),
                views.scorecard,
            )
        else:
            frame, draw = views.candidate_rows(tables["candidate_stimuli"]), views.candidate_stimuli
        publish(draw(frame), frame, path)

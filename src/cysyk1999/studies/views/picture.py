"""Pictures of the views, each drawn from its data frame alone."""

from __future__ import annotations

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
from cysyk1999.publishing.style import (
    CATEGORIES,
    DASHED,
    FIELD,
    GREY,
    INK,
    LAYER_COLOURS,
    LINES,
    MEANINGS,
    PALE,
    handle,
    in_kilo,
    study_figure,
    styled,
)
from cysyk1999.publishing.write import publish, without_round_off
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
CENTRED = {"ha": "center", "va": "center", "fontsize": 6}
WHITE = {"ha": "center", "va": "top", "fontsize": 6.5, "color": "white"}
DOT = {"mfc": "white", "mec": INK, "mew": 0.7}


def _of(frame: pd.DataFrame, panel: str, series: str = "") -> pd.DataFrame:
    rows = frame[frame["panel"] == panel]
    return rows[rows["series"] == series] if series else rows


def _polygons(rows: pd.DataFrame) -> np.ndarray:
    return rows[list(CORNERS)].to_numpy().reshape(len(rows), 4, 2)


def _field(ax: Axes, rows: pd.DataFrame, norm: LogNorm, **edges) -> PolyCollection:
    """Elements in the colours of their strain energy."""
    look = {"cmap": FIELD, "norm": norm, "rasterized": True}
    look |= edges or {"edgecolor": "face", "linewidth": 0.2}
    return ax.add_collection(PolyCollection(_polygons(rows), array=rows[SED], **look))


def _energies(frame: pd.DataFrame) -> LogNorm:
    """A scale to the largest energies but for those of singular points."""
    high = float(np.nanpercentile(frame[SED], 99.7))
    return LogNorm(2e-3 * high, high)


def _line(rows: pd.DataFrame, layer: str) -> pd.DataFrame:
    return rows[(rows["series"] == "line") & (rows["layer"] == layer)]


def _layers(ax: Axes, rows: pd.DataFrame) -> None:
    """Boundaries of the layers and the skin."""
    for layer in ("skin", "dermis", "fat", "bone"):
        line = _line(rows, layer)
        ax.plot(line[X], line[Y], color=INK if layer == "skin" else "white", lw=0.8)


def _areas(ax: Axes, rows: pd.DataFrame, shades: dict[str, str]) -> None:
    """The layers as areas, from the outside in: line round each -> its colour's name."""
    for layer, colour in shades.items():
        line = _line(rows, layer)
        ax.fill(line[X], line[Y], fc=LAYER_COLOURS[colour], ec=INK, lw=0.5)


def _surface(ax: Axes, rows: pd.DataFrame, top: float) -> None:
    """The solid that touches."""
    line = _line(rows, "surface").sort_values(X)
    ax.fill_between(line[X], line[Y], np.maximum(line[Y], top), color=PALE, lw=0)
    ax.plot(line[X], line[Y], color=GREY, lw=0.7)


def _receptors(ax: Axes, rows: pd.DataFrame, size: float = 3.0) -> None:
    dots = rows[rows["series"] == "receptor"]
    ax.plot(dots[X], dots[Y], "o", ms=size, **DOT)


def _bar(fig: Figure, drawn, axes, label: str = ENERGY, **options) -> None:
    options = {"pad": 0.01, "aspect": 22, "extend": "both"} | options
    bar = fig.colorbar(drawn, ax=axes, **options)
    bar.outline.set_visible(False)
    bar.set_label(label)


@styled
def overview(frame: pd.DataFrame) -> Figure:
    """One case in a row: the surface on the layered pad, pressure, strain energy, response."""
    note = (
        "Simulated in plane strain, not measured; a to c at the top of the ramp. Rate by Eq 5-1 of "
        "Cysyk (1999) from the strain energy at 915 µm (lower circle); impulses of one trial."
    )
    title = "From a surface to impulses: a cylinder of 210 1/m pressed to 20 gf in 0.5 s and held"
    fig = study_figure(title, [note], 2.45)
    grid = fig.add_gridspec(2, 4, width_ratios=[1.2, 0.75, 1.45, 1.0])
    pad, press, field = (fig.add_subplot(grid[:, k]) for k in range(3))
    middle, below = (fig.add_subplot(grid[k, 3]) for k in range(2))
    section = _of(frame, "section")
    shades = {"skin": "epidermis", "dermis": "dermis", "fat": "fat", "bone": "bone"}
    _areas(pad, section, shades)
    _surface(pad, section, 9.0)
    _receptors(pad, section, 1.8)
    for name, layers, x, y in LABELLED:
        place = x, np.mean([_upper(_line(section, layer), x) for layer in layers])
        line = {"arrowstyle": "-", "lw": 0.5, "shrinkA": 1, "shrinkB": 0}
        pad.annotate(name, place, (-9.0, y), arrowprops=line, **CENTRED | {"ha": "right"})
    for y, name in ((2.3, "fat"), (-1.8, "bone"), (7.1, "surface")):
        pad.text(0, y, name, **CENTRED)
    pad.set(xlim=(-12.8, 10), ylim=(-8.4, 9), aspect="equal", xticks=[], yticks=[])
    pad.set_title("the surface on the pad")
    pad.plot([5, 10], [-8.2, -8.2], color=INK, lw=1.6, solid_capstyle="butt")
    pad.text(7.5, -8.0, "5 mm", **CENTRED | {"va": "bottom"})
    pad.spines[:].set_visible(False)
    rows = _of(frame, "pressure")
    press.fill_between(rows[X], rows[P], color="#cfd8df", lw=0)
    press.plot(rows[X], rows[P], color=INK)
    press.set(xlim=(-2.6, 2.6), ylim=(0, 1.1 * rows[P].max()), xlabel=X.label, title="pressure")
    press.set_ylabel("contact pressure (Pa)")
    in_kilo(press.yaxis)
    rows = _of(frame, "field")
    drawn = _field(field, rows, _energies(rows))
    _layers(field, section)
    _surface(field, section, 6.8)
    _receptors(field, section)
    field.set(xlim=(-2.6, 2.6), ylim=(3.4, 6.6), aspect="equal", xlabel=X.label, ylabel=Y.label)
    field.set(title="strain energy", yticks=[4, 5, 6])
    _bar(fig, drawn, field, "strain energy\ndensity (Pa)", pad=0.02, aspect=16, shrink=0.75)
    rows = _of(frame, "energy")
    middle.plot(rows[TIME], rows[SED], color=INK)
    middle.set(ylabel="strain energy\n(Pa)", ylim=(0, 1.12 * rows[SED].max()))
    middle.set_title("what it feels")
    middle.tick_params(labelbottom=False)
    rate, ticks = _of(frame, "rate"), _of(frame, "impulses")
    below.plot(rate[TIME], rate[IMPULSE_RATE], color=INK)
    top = 1.5 * rate[IMPULSE_RATE].max()
    below.vlines(ticks[IMPULSE], 0.82 * top, 0.97 * top, color=INK, lw=0.7)
    below.set(ylabel="predicted rate\n(impulses/s)", xlabel=TIME.label, ylim=(0, top))
    below.set_title("and answers")
    for ax in (middle, below):
        ax.set_xlim(0, rate[TIME].max())
    return fig


def _upper(line: pd.DataFrame, x: float) -> float:
    """Height at which a closed line passes `x` on its upper side."""
    upper = line[line[Y] > line[Y].mean()]
    return float(upper[Y].iloc[np.argmin(abs(upper[X] - x))])


@styled
def fields(frame: pd.DataFrame) -> Figure:
    """Strain energy under a plate and two cylinders."""
    note = (
        "Simulated in plane strain, not measured. Lines: skin, epidermis to dermis, dermis to fat; "
        "circles: receptors that were 600 and 915 µm under the skin. The stiff epidermis holds "
        "most of it; the sharper the surface, the closer to it."
    )
    title = "Strain energy under three surfaces, 20 gf at the top of the ramp"
    fig = study_figure(title, [note], 2.6)
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


@styled
def mesh_close_up(frame: pd.DataFrame) -> Figure:
    """Deformed meshes from close by, draft to fine, with the pressure that each gives."""
    note = (
        "Simulated. Above: deformed elements, circles: skin nodes in contact; below: pressure at "
        "the skin's nodes. Left: a cylinder of 1260 1/m at 20 gf, top of the ramp; right: "
        "convexities of 157, 210 and 315 1/m at 20 gf, steady state."
    )
    fig = study_figure("The contact on the meshes of draft, thesis and fine", [note], 5.3)
    grid = fig.add_gridspec(3, 6, height_ratios=[1.15, 1.15, 1.3])
    looks = dict(zip(LEVELS, CATEGORIES, strict=False))
    dashes = dict(zip(LEVELS, ((LINES[1], "o"), (LINES[0], "s"), (LINES[0], ".")), strict=True))
    for row, (surface, half) in enumerate((("k1260", 0.6), ("wavy", 2.4))):
        for column, level in enumerate(LEVELS):
            ax = fig.add_subplot(grid[row, 2 * column : 2 * column + 2])
            rows = _of(frame, f"{surface} {level}")
            mesh = rows[rows["series"] == "element"]
            faces = mesh["layer"].map(LAYER_COLOURS)
            look = {"facecolors": faces, "edgecolors": "0.25", "linewidths": 0.35}
            ax.add_collection(PolyCollection(_polygons(mesh), **look))
            _surface(ax, rows, 6.6)
            skin, touching = _line(rows, "skin").sort_values(X), rows[rows["contact (1)"] == 1]
            height = np.interp(touching[X], skin[X], skin[Y])
            ax.plot(touching[X], height, "o", ms=2.4, color=looks[level], zorder=4)
            high = skin[Y].max()
            low = high - 1.15 * half if row == 0 else 4.55
            ax.set(xlim=(-half, half), ylim=(low, high + 0.28 * half), aspect="equal")
            ax.set_title(f"{level}, {'1260 1/m' if row == 0 else 'wavy surface'}")
            if column == 0:
                ax.set_ylabel(Y.label)
    for column, (surface, half) in enumerate((("k1260", 0.6), ("wavy", 3.0))):
        ax = fig.add_subplot(grid[2, 3 * column : 3 * column + 3])
        for level, (line, marker) in dashes.items():
            rows = _of(frame, f"{surface} {level}", "pressure").sort_values(X)
            look = {"color": looks[level], "ls": line, "marker": marker, "ms": 2.5, "lw": 0.9}
            ax.plot(rows[X], rows[P], label=level, **look)
        ax.set(xlim=(-half, half), ylim=(0, None), xlabel=X.label, ylabel="contact pressure (Pa)")
        in_kilo(ax.yaxis)
        if column == 0:
            ax.legend(loc="upper right")
    return fig


@styled
def ridges_both_ways(frame: pd.DataFrame) -> Figure:
    """The field round the inner ridges, pressed, and stroked either way."""
    note = (
        "Simulated: flat plate, 20 gf, calibrated friction, ridges 0.48 mm apart and 0.15 mm high "
        "(assumed). c is the mirror image of b, as is its motion. Circles: receptors of the "
        "thesis, ±46 µm off the tip of a ridge, 915 µm deep. White lines: boundaries of layers."
    )
    title = "Why a ridged pad tells the way of a stroke: strain energy round the inner ridges"
    fig = study_figure(title, [note], 2.9)
    axes = fig.subplots(1, 3, sharey=True)
    norm = LogNorm(20, float(np.nanpercentile(frame[SED], 99.5)))
    low = frame.loc[frame["series"] == "receptor", Y].min() - 0.35
    panels = (
        ("pressed", 1.0, "pressed"),
        ("stroked to the right", 1.0, "plate to the right"),
        ("stroked to the right", -1.0, "plate to the left"),
    )
    for ax, (panel, way, title) in zip(axes, panels, strict=True):
        rows = _of(frame, panel).copy()
        rows[[X, *CORNERS[::2]]] *= way
        dots = rows[rows["series"] == "receptor"].sort_values(X)
        middle = dots[X].mean()
        mesh = rows[rows["series"] == "element"]
        drawn = _field(ax, mesh, norm, edgecolor="0.3", linewidth=0.08)
        _layers(ax, rows)
        _receptors(ax, rows, 2.6)
        ax.set(xlim=(middle - 0.5, middle + 0.5), ylim=(low, low + 1.0), aspect="equal")
        ax.set(xlabel=X.label, title=title)
        felt = "   ".join(f"{value:.0f}" for value in dots["felt (Pa)"])
        ax.text(middle, dots[Y].min() - 0.05, f"{felt} Pa", fontweight="bold", **WHITE)
        if panel == "pressed":
            continue
        arrow = {"arrowstyle": "-|>", "lw": 1.2, "color": "white"}
        start, end = ((middle + side * way, low + 0.93) for side in (-0.3, 0.3))
        ax.annotate("", end, start, arrowprops=arrow)
        moved = abs(rows["carried (mm)"].iloc[0])
        ax.text(middle, low + 0.89, f"skin carried {moved:.2f} mm", **WHITE)
    axes[0].set_ylabel(Y.label)
    _bar(fig, drawn, axes, "strain energy density (Pa)", shrink=0.9)
    return fig


@styled
def space_time(frame: pd.DataFrame) -> Figure:
    """Maps of a stroke over the skin and the stroke distance."""
    note = (
        "Simulated: convexities of 52 to 315 1/m (labels at the right), 20 gf, calibrated "
        "friction. Black: where the middle of a convexity is over the skin at rest; it is met "
        "late, for the skin is dragged along by the surface. Strain energy on instantaneous moduli."
    )
    title = "A stroke in space and time: what every place on the skin feels, 10 mm/s"
    fig = study_figure(title, [note], 4.9)
    maps = frame[frame["series"] == "map"].pivot(index=DISTANCE, columns=SKIN_X)
    axes = fig.subplots(1, 3, sharey=True)
    panels = (
        (1e-3 * maps[P], "contact pressure (kPa)", "magma_r"),
        (maps[SED], "strain energy density, 915 µm (Pa)", FIELD),
        (maps[SLIP].where(maps[P] > 0), "speed of slip in contact (mm/s)", "viridis"),
    )
    marks = frame[frame["series"] == "convexity"]
    for ax, (grid, label, colours) in zip(axes, panels, strict=True):
        look = {"cmap": colours, "vmin": 0, "vmax": np.nanpercentile(grid, 99.5)}
        look |= {"shading": "nearest", "rasterized": True}
        drawn = ax.pcolormesh(grid.columns, grid.index, grid, **look)
        for place in marks[DISTANCE]:
            ax.plot([-4, 4], [place + 4, place - 4], color=INK, lw=0.5, ls=DASHED)
        _bar(fig, drawn, ax, label, orientation="horizontal", aspect=26, extend="max")
        ax.set(xlim=(-4, 4), ylim=(grid.index[-1], grid.index[0]), xlabel="place on the skin (mm)")
    for place, curvature in zip(marks[DISTANCE], marks["curvature (1/m)"], strict=True):
        label = {"textcoords": "offset points", "va": "center", "fontsize": 6.5}
        ax.annotate(f"{curvature:.0f}", (4, place - 4), (3, 0), annotation_clip=True, **label)
    axes[0].set_ylabel("stroke distance (mm)")
    return fig


@styled
def stick_slip(frame: pd.DataFrame) -> Figure:
    """Where the contact sticks and where it slips, at four instants, and the share that sticks over
    the stroke.
    """
    note = (
        "Simulated. Line: tangential traction; edge of the grey area: its bound, pressure times "
        "friction. Where both meet the skin slips, elsewhere it sticks; jumps from node to node "
        "are those of mesh and steps. e: share of the load carried where it sticks."
    )
    fig = study_figure("Stick and slip along the contact of a stroke, 10 mm/s", [note], 3.6)
    instants = [panel for panel in frame["panel"].drop_duplicates() if panel != "whole"]
    grid = fig.add_gridspec(2, len(instants), height_ratios=[1.5, 1])
    looks = {
        "sticks": {"color": CATEGORIES[0], "marker": "o", "ls": "none"},
        "slips": {"color": CATEGORIES[1], "marker": "^", "ls": "none"},
    }
    ax = None
    for k, panel in enumerate(instants):
        ax = fig.add_subplot(grid[0, k], sharey=ax)
        rows = _of(frame, panel).sort_values(SKIN_X)
        ax.fill_between(rows[SKIN_X], rows[BOUND], color="0.88", lw=0)
        ax.plot(rows[SKIN_X], rows[TRACTION], color=GREY, lw=0.8)
        touching = rows[rows[P] > 0]
        for name, look in looks.items():
            part = touching[(touching[STATE] == SLIPS) == (name == "slips")]
            ax.plot(part[SKIN_X], part[TRACTION], ms=2.6, **look)
        reach = 1.1 * touching[SKIN_X].abs().max() if len(touching) else 4
        ax.set(xlim=(-reach, reach), title=f"after {panel}", xlabel=X.label)
        ax.tick_params(labelleft=k == 0)
        if k == 0:
            ax.set_ylabel("traction (Pa)")
            handles = [handle(name, ms=3, **look) for name, look in looks.items()]
            ax.legend(handles=handles, loc="upper left", handletextpad=0.1)
        in_kilo(ax.yaxis)
    ax = fig.add_subplot(grid[1, :])
    rows = _of(frame, "whole")
    ax.plot(rows[DISTANCE], rows[STICKING], color=INK)
    ax.set(xlabel="stroke distance (mm)", ylabel="load that sticks (%)", xlim=(0, 2), ylim=(0, 105))
    return fig


@styled
def adaptation(frame: pd.DataFrame) -> Figure:
    """Slowly and rapidly adapting responses to two ramps and holds."""
    note = (
        "Predicted, not recorded. Slowly adapting: Eq 5-1 of Cysyk (1999), strain energy at 915 "
        "µm. Rapidly adapting: from the rate of the skin's curvature; threshold, scale and highest "
        "rate are assumed, nobody states them. Ticks: impulses of five trials."
    )
    title = "Slowly and rapidly adapting receptors in ramp and hold, K = 210 1/m, 20 gf"
    fig = study_figure(title, [note], 3.6)
    axes = fig.subplots(5, 2, sharex="col", height_ratios=[0.6, 0.55, 1, 0.55, 1])
    for column, words in zip(axes.T, ("40 gf/s", "150 gf/s"), strict=True):
        force = _of(frame, f"force {words}")
        column[0].plot(force[TIME], force[FORCE], color=INK)
        column[0].set(title=f"ramp of {words}", ylim=(0, 24), yticks=[0, 20])
        column[0].set_xlim(0, force[TIME].max())
        column[-1].set_xlabel(TIME.label)
        for row, kind in ((1, "slowly adapting"), (3, "rapidly adapting")):
            ticks, rate, colour = column[row], column[row + 1], CATEGORIES[row // 2]
            rows = _of(frame, f"{kind} {words}", "impulse")
            trial = rows["trial (1)"]
            ticks.vlines(rows[IMPULSE], trial - 0.4, trial + 0.4, color=INK, lw=0.6)
            ticks.set(ylim=(5.6, 0.4), yticks=[])
            line = _of(frame, f"{kind} {words}", "rate")
            rate.fill_between(line[TIME], line[IMPULSE_RATE], color=colour, alpha=0.25, lw=0)
            rate.plot(line[TIME], line[IMPULSE_RATE], color=colour)
            highest = frame.loc[frame["panel"].str.startswith(kind), IMPULSE_RATE].max()
            rate.set_ylim(0, 1.08 * highest)
            if words == "40 gf/s":
                name = kind.replace(" ", "\n")
                ticks.set_ylabel(name, rotation=0, ha="right", va="center")
                rate.set_ylabel("rate (1/s)")
    axes[0, 0].set_ylabel("force (gf)")
    return fig


@styled
def assumptions(frame: pd.DataFrame) -> Figure:
    """The section, and what of it the thesis states, what follows from it, and what is assumed."""
    note = (
        "The model's own section. Stated: printed in the thesis or drawn in it; inferred: what its "
        "figures and numbers ask for; assumed: neither. Thick: held, as is the rim of the bone. "
        "Ridges, of some scenes only: sizes published elsewhere or assumed."
    )
    title = "What the model rests on: stated by the thesis, inferred from it, assumed"
    fig = study_figure(title, [note], 3.6)
    ax = fig.subplots()
    shades = {"skin": "stratum corneum", "corneum": "epidermis", "dermis": "dermis"}
    _areas(ax, frame, shades | {"fat": "fat", "bone": "bone"})
    bone, skin = _line(frame, "bone"), _line(frame, "skin")
    ax.plot(bone[X], bone[Y], color=INK, lw=2.2)
    held = frame.loc[frame["series"] == "held", X]
    under = skin[(skin[Y] < 0) & skin[X].between(held.min(), held.max())].sort_values(X)
    ax.plot(under[X], under[Y], color=INK, lw=2.6, solid_capstyle="butt")
    ax.fill_between([-4.0, 4.0], 6.05, 6.9, color=PALE, lw=0)
    ax.text(3.9, 6.48, "flat plate", ha="right", va="center", fontsize=6.5)
    origins = MEANINGS["origin"]
    for origin, look in origins.items():
        line = {"lw": 0.9, "ls": look["ls"]}
        arrow = {"arrowstyle": "-", "color": look["color"], "shrinkA": 1, "shrinkB": 0} | line
        box = {"boxstyle": "square,pad=0.25", "fc": "white", "ec": look["color"]} | line
        options = {"va": "center", "fontsize": 6.2, "arrowprops": arrow, "bbox": box}
        for row in frame[frame["series"] == origin].to_dict("records"):
            side = "right" if row[X] < 0 else "left"
            place = row["to_x (mm)"], row["to_y (mm)"]
            ax.annotate(row["words"], place, (row[X], row[Y]), ha=side, **options)
            ax.plot(*place, look["marker"], color=look["color"], ms=2.6)
    handles = [handle(name, **look, ms=3) for name, look in origins.items()]
    place = {"loc": "lower center", "bbox_to_anchor": (0.5, -0.04)}
    ax.legend(handles=handles, ncols=3, handlelength=3, **place)
    ax.set(xlim=(-24, 24), ylim=(-8.6, 9.0), aspect="equal")
    ax.axis("off")
    return fig


VIEWS: dict[str, Callable[[pd.DataFrame], Figure]] = {
    draw.__name__: draw
    for draw in (
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

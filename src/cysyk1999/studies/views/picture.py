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
    LAYER_LINES,
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


def _of(frame: pd.DataFrame, panel: str, series: str = "") -> pd.DataFrame:
    rows = frame[frame["panel"] == panel]
    return rows[rows["series"] == series] if series else rows


def _line(rows: pd.DataFrame, layer: str) -> pd.DataFrame:
    return rows[(rows["series"] == "line") & (rows["layer"] == layer)]


def _energies(frame: pd.DataFrame) -> LogNorm:
    """A scale to the largest energies but for those of singular points."""
    high = float(np.nanpercentile(frame[SED], 99.7))
    return LogNorm(2e-3 * high, high)


def _surface(ax: Axes, section: pd.DataFrame, top: float) -> None:
    """The solid that touches."""
    line = _line(section, "surface").sort_values(X)
    ax.fill_between(line[X], line[Y], np.maximum(line[Y], top), color=PALE, lw=0)
    ax.plot(line[X], line[Y], color=GREY, lw=0.7)


def _receptors(ax: Axes, section: pd.DataFrame, size: float = 3.0) -> None:
    dots = section[section["series"] == "receptor"]
    ax.plot(dots[X], dots[Y], "o", ms=size, mfc="white", mec=INK, mew=0.7)


def _field(
    ax: Axes, mesh: pd.DataFrame, section: pd.DataFrame, norm: LogNorm, top: float
) -> PolyCollection:
    """Elements in the colours of their strain energy, the layers, the solid and the receptors."""
    look = {"cmap": FIELD, "norm": norm, "edgecolor": "face", "linewidth": 0.2}
    corners = mesh[CORNERS].to_numpy().reshape(-1, 4, 2)
    drawn = PolyCollection(corners, array=mesh[SED], rasterized=True, **look)
    ax.add_collection(drawn)
    for layer in LAYER_LINES:
        line = _line(section, layer)
        ax.plot(line[X], line[Y], color=INK if layer == "skin" else "white", lw=0.8)
    _surface(ax, section, top)
    _receptors(ax, section)
    ax.set(aspect="equal", xlabel=X.label)
    return drawn


def _bar(fig: Figure, drawn, axes, label: str = ENERGY, **options) -> None:
    options = {"pad": 0.01, "aspect": 22, "extend": "both"} | options
    bar = fig.colorbar(drawn, ax=axes, label=label, **options)
    bar.outline.set_visible(False)


def _whole_section(ax: Axes, section: pd.DataFrame) -> None:
    """The surface on the layered pad, named, with a scale."""
    colours = {"skin": "epidermis", "dermis": "dermis", "fat": "fat", "bone": "bone"}
    for layer, colour in colours.items():
        line = _line(section, layer)
        ax.fill(line[X], line[Y], fc=LAYER_COLOURS[colour], ec=INK, lw=0.5)
    _surface(ax, section, 9.0)
    _receptors(ax, section, 1.8)
    line = {"arrowstyle": "-", "lw": 0.5, "shrinkA": 1, "shrinkB": 0}
    for name, layers, x, y in LABELLED:
        place = x, np.mean([_upper(_line(section, layer), x) for layer in layers])
        ax.annotate(name, place, (-9.0, y), arrowprops=line, **CENTRED | {"ha": "right"})
    for y, name in ((2.3, "fat"), (-1.8, "bone"), (7.1, "surface")):
        ax.text(0, y, name, **CENTRED)
    ax.set(xlim=(-12.8, 10), ylim=(-8.4, 9), aspect="equal", xticks=[], yticks=[])
    ax.plot([5, 10], [-8.2, -8.2], color=INK, lw=1.6, solid_capstyle="butt")
    ax.text(7.5, -8.0, "5 mm", **CENTRED | {"va": "bottom"})
    ax.spines[:].set_visible(False)


def _upper(line: pd.DataFrame, x: float) -> float:
    """Height at which a closed line passes `x` on its upper side."""
    upper = line[line[Y] > line[Y].mean()]
    return float(upper[Y].iloc[np.argmin(abs(upper[X] - x))])


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
    felt, answer = (fig.add_subplot(grid[k, 3]) for k in range(2))
    section = _of(frame, "section")
    _whole_section(pad, section)
    pad.set_title("the surface on the pad")
    rows = _of(frame, "pressure")
    press.fill_between(rows[X], rows[P], color="#cfd8df", lw=0)
    press.plot(rows[X], rows[P], color=INK)
    press.set(xlim=(-2.6, 2.6), ylim=(0, 1.1 * rows[P].max()), xlabel=X.label, ylabel=P.label)
    press.set_title("pressure")
    in_kilo(press.yaxis)
    rows = _of(frame, "field")
    drawn = _field(field, rows, section, _energies(rows), 6.8)
    field.set(xlim=(-2.6, 2.6), ylim=(3.4, 6.6), yticks=[4, 5, 6], ylabel=Y.label)
    field.set_title("strain energy")
    _bar(fig, drawn, field, "strain energy\ndensity (Pa)", pad=0.02, aspect=16, shrink=0.75)
    rows, rate, ticks = (_of(frame, panel) for panel in ("energy", "rate", "impulses"))
    felt.plot(rows[TIME], rows[SED], color=INK)
    felt.set(ylabel="strain energy\n(Pa)", ylim=(0, 1.12 * rows[SED].max()))
    felt.set(title="what it feels", xlim=(0, rate[TIME].max()))
    felt.tick_params(labelbottom=False)
    answer.plot(rate[TIME], rate[IMPULSE_RATE], color=INK)
    top = 1.5 * rate[IMPULSE_RATE].max()
    answer.vlines(ticks[IMPULSE], 0.82 * top, 0.97 * top, color=INK, lw=0.7)
    answer.set(ylabel="predicted rate\n(impulses/s)", xlabel=TIME.label, ylim=(0, top))
    answer.set(title="and answers", xlim=(0, rate[TIME].max()))
    return fig


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
    for ax, panel in zip(axes, frame["panel"].unique(), strict=True):
        drawn = _field(ax, _of(frame, panel, "element"), _of(frame, panel), norm, 7.0)
        ax.set(xlim=(-4.3, 4.3), ylim=(1.4, 6.6))
        ax.set_title("flat plate" if panel == "flat" else f"K = {panel} 1/m")
    axes[0].set_ylabel(Y.label)
    _bar(fig, drawn, axes, orientation="horizontal", aspect=60, shrink=0.6)
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
    marks = frame.loc[frame["series"] == "convexity", [DISTANCE, "curvature (1/m)"]].to_numpy()
    for ax, (grid, label, colours) in zip(axes, panels, strict=True):
        look = {"cmap": colours, "vmin": 0, "vmax": np.nanpercentile(grid, 99.5)}
        look |= {"shading": "nearest", "rasterized": True}
        drawn = ax.pcolormesh(grid.columns, grid.index, grid, **look)
        for place, _ in marks:
            ax.plot([-4, 4], [place + 4, place - 4], color=INK, lw=0.5, ls=DASHED)
        _bar(fig, drawn, ax, label, orientation="horizontal", aspect=26, extend="max")
        ax.set(xlim=(-4, 4), ylim=(grid.index[-1], grid.index[0]), xlabel="place on the skin (mm)")
    label = {"textcoords": "offset points", "va": "center", "fontsize": 6.5}
    for place, curvature in marks:
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
    *instants, whole = frame["panel"].unique()
    grid = fig.add_gridspec(2, len(instants), height_ratios=[1.5, 1])
    looks = {
        "sticks": {"color": CATEGORIES[0], "marker": "o", "ls": "none"},
        "slips": {"color": CATEGORIES[1], "marker": "^", "ls": "none"},
    }
    first = None
    for k, panel in enumerate(instants):
        ax = fig.add_subplot(grid[0, k], sharey=first)
        first = first or ax
        rows = _of(frame, panel).sort_values(SKIN_X)
        ax.fill_between(rows[SKIN_X], rows[BOUND], color="0.88", lw=0)
        ax.plot(rows[SKIN_X], rows[TRACTION], color=GREY, lw=0.8)
        touching = rows[rows[P] > 0]
        for name, look in looks.items():
            part = touching[(touching[STATE] == SLIPS) == (name == "slips")]
            ax.plot(part[SKIN_X], part[TRACTION], ms=2.6, **look)
        reach = 1.1 * touching[SKIN_X].abs().max()
        ax.set(xlim=(-reach, reach), title=f"after {panel}", xlabel=X.label)
        ax.tick_params(labelleft=ax is first)
        in_kilo(ax.yaxis)
    handles = [handle(name, ms=3, **look) for name, look in looks.items()]
    first.legend(handles=handles, loc="upper left", handletextpad=0.1)
    first.set_ylabel("traction (kPa)")
    ax, rows = fig.add_subplot(grid[1, :]), _of(frame, whole)
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
    for column, ramp in zip(axes.T, ("40 gf/s", "150 gf/s"), strict=True):
        rows = _of(frame, f"force {ramp}")
        column[0].plot(rows[TIME], rows[FORCE], color=INK)
        column[0].set(title=f"ramp of {ramp}", ylim=(0, 24), yticks=[0, 20])
        column[0].set_xlim(0, rows[TIME].max())
        column[-1].set_xlabel(TIME.label)
        for ticks, rate, kind, colour in (
            (*column[1:3], "slowly adapting", CATEGORIES[0]),
            (*column[3:5], "rapidly adapting", CATEGORIES[1]),
        ):
            rows = _of(frame, f"{kind} {ramp}", "impulse")
            trial = rows["trial (1)"]
            ticks.vlines(rows[IMPULSE], trial - 0.4, trial + 0.4, color=INK, lw=0.6)
            ticks.set(ylim=(5.6, 0.4), yticks=[])
            rows = _of(frame, f"{kind} {ramp}", "rate")
            rate.fill_between(rows[TIME], rows[IMPULSE_RATE], color=colour, alpha=0.25, lw=0)
            rate.plot(rows[TIME], rows[IMPULSE_RATE], color=colour)
            highest = frame.loc[frame["panel"].str.startswith(kind), IMPULSE_RATE].max()
            rate.set_ylim(0, 1.08 * highest)
            if ramp == "40 gf/s":
                ticks.set_ylabel(kind.replace(" ", "\n"), rotation=0, ha="right", va="center")
                rate.set_ylabel("rate (1/s)")
    axes[0, 0].set_ylabel("force (gf)")
    return fig


VIEWS: dict[str, Callable[[pd.DataFrame], Figure]] = {
    draw.__name__: draw for draw in (overview, fields, space_time, stick_slip, adaptation)
}
"""Name of a picture -> its drawing function of its data frame."""


def draw_views(job: SimpleNamespace) -> None:
    """Job: `histories` -> `pictures`, named as in VIEWS."""
    histories, _, _ = read_results(job.histories)
    for picture in job.pictures:
        name = Path(picture).stem
        frame = without_round_off(FRAMES[name][0](histories))
        publish(VIEWS[name](frame), frame, picture)

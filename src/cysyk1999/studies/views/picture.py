"""Pictures of the views, each drawn from its data frame alone."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from cysyk1999.figures.findings import n
from cysyk1999.measures.quantities import DISTANCE, IMPULSE, IMPULSE_RATE, SED, TIME, P, X, Y
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
from cysyk1999.studies.views.frames import (
    BOUND,
    CORNERS,
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
TOUCHES = 300.0
"""Pa, from which a map shows contact."""
ENERGY = "strain energy density on the instantaneous moduli (Pa)"
CENTRED = {"ha": "center", "va": "center", "fontsize": 6}


def _of(frame: pd.DataFrame, panel: str, series: str = "") -> pd.DataFrame:
    rows = frame[frame["panel"] == panel]
    return rows[rows["series"] == series] if series else rows


def _line(rows: pd.DataFrame, layer: str) -> pd.DataFrame:
    return rows[(rows["series"] == "line") & (rows["layer"] == layer)]


def energy_scale(frame: pd.DataFrame) -> LogNorm:
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


def _smooth(mesh: pd.DataFrame) -> Iterator[tuple[Triangulation, np.ndarray]]:
    """Each layer in triangles, with the logarithm of the strain energy at its nodes: the mean of
    the elements of the layer that meet there.
    """
    for _, rows in mesh.groupby("layer"):
        corners = rows[CORNERS].to_numpy().reshape(-1, 2)
        points, node = np.unique(corners.round(3), axis=0, return_inverse=True)
        node = node.reshape(-1, 4)
        energy = np.repeat(np.log10(rows[SED].clip(lower=1e-6)), 4)
        mean = np.bincount(node.ravel(), energy) / np.bincount(node.ravel())
        triangles = np.concatenate([node[:, [0, 1, 2]], node[:, [0, 2, 3]]])
        sides = points[triangles]
        flat = np.abs(np.cross(sides[:, 1] - sides[:, 0], sides[:, 2] - sides[:, 0])) < 1e-9
        yield Triangulation(*points.T, triangles[~flat]), mean


def draw_field(
    ax: Axes, mesh: pd.DataFrame, section: pd.DataFrame, norm: LogNorm, top: float
) -> ScalarMappable:
    """Strain energy, smooth within each layer, with lines of equal energy (three a factor of ten);
    the layers, the solid and the receptors.
    """
    ends = np.log10([norm.vmin, norm.vmax])
    scale = Normalize(*ends)
    for triangles, energy in _smooth(mesh):
        levels = np.linspace(*ends, 40)
        ax.tricontourf(triangles, energy, levels, cmap=FIELD, norm=scale, extend="both")
        lines = np.arange(np.ceil(3 * ends[0]), 3 * ends[1]) / 3
        look = {"colors": "white", "linewidths": 0.35, "linestyles": "-"}
        ax.tricontour(triangles, energy, lines, **look)
    for layer in LAYER_LINES:
        line = _line(section, layer)
        ax.plot(line[X], line[Y], color=INK, lw=0.8)
    _surface(ax, section, top)
    _receptors(ax, section)
    ax.set(aspect="equal", xlabel=X.label)
    return ScalarMappable(norm, FIELD)


def colour_bar(fig: Figure, drawn, axes, label: str = ENERGY, **options) -> None:
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
    _receptors(ax, section, 2.6)
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
        "Simulated in plane strain, not measured; a to c at the top of the ramp. White: lines of "
        "equal energy, three a factor of ten. Rate by Eq 5-1 of "
        "Cysyk (1999) from the strain energy at 915 µm (lower circle); impulses of one trial."
    )
    felt, top = _of(frame, "energy")[SED], 1e-3 * _of(frame, "pressure")[P].max()
    title = (
        f"From a surface to impulses: a cylinder of 210 1/m, 20 gf: {n(top)} kPa on the skin, "
        f"{n(felt.max())} Pa at the receptor, {len(_of(frame, 'impulses'))} impulses"
    )
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
    drawn = draw_field(field, rows, section, energy_scale(rows), 6.8)
    field.set(xlim=(-2.6, 2.6), ylim=(3.4, 6.6), yticks=[4, 5, 6], ylabel=Y.label)
    field.set_title("strain energy")
    colour_bar(fig, drawn, field, "strain energy\ndensity (Pa)", pad=0.02, aspect=16, shrink=0.75)
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
        "Simulated in plane strain, not measured; top of the ramp, 20 gf. Black: skin, epidermis "
        "to dermis, dermis to fat; white: lines of equal energy, three a factor of ten; circles: "
        "receptors that were 600 and 915 µm under the skin."
    )
    felt = frame[frame["series"] == "receptor"].pivot(
        index="panel", columns="layer", values="felt (Pa)"
    )
    over = (felt["600 um"] / felt["915 um"]).loc[frame["panel"].unique()]
    title = (
        "Strain energy 600 µm deep, in the epidermis, is "
        + ", ".join(map(n, over))
        + " times that 915 µm deep under a plate, 210 and 1260 1/m"
    )
    fig = study_figure(title, [note], 2.6)
    axes, norm = fig.subplots(1, 3, sharey=True), energy_scale(frame)
    for ax, panel in zip(axes, frame["panel"].unique(), strict=True):
        drawn = draw_field(ax, _of(frame, panel, "element"), _of(frame, panel), norm, 7.0)
        ax.set(xlim=(-4.3, 4.3), ylim=(1.4, 6.6))
        ax.set_title("flat plate" if panel == "flat" else f"K = {panel} 1/m")
    axes[0].set_ylabel(Y.label)
    colour_bar(fig, drawn, axes, orientation="horizontal", aspect=60, shrink=0.6)
    return fig


@styled
def space_time(frame: pd.DataFrame) -> Figure:
    """Maps of a stroke over the skin and the stroke distance."""
    note = (
        "Simulated: convexities of 52 to 315 1/m (labels at the right), 27 gf, calibrated "
        "friction. Dashed: where the middle of a convexity is over the skin at rest; it is met "
        "late, for the skin is dragged along by the surface. Strain energy on instantaneous moduli."
    )
    slip, touched = (frame.loc[frame["series"] == "map", q] for q in (SLIP, P))
    title = (
        f"A stroke at 10 mm/s in space and time: pressure up to {n(1e-3 * touched.max())} kPa, and "
        f"slip, while in contact, at {n(slip[touched > 0].median())} mm/s in the median"
    )
    fig = study_figure(title, [note], 4.9)
    maps = frame[frame["series"] == "map"].pivot(index=DISTANCE, columns=SKIN_X)
    axes = fig.subplots(1, 3, sharey=True)
    panels = (
        (1e-3 * maps[P], "contact pressure (kPa)", FIELD),
        (maps[SED], "strain energy density, 915 µm (Pa)", FIELD),
        # beyond the contact as at its edge, which is drawn over it
        (
            maps[SLIP].where(maps[P] > 0).ffill(axis=1).bfill(axis=1),
            "speed of slip in contact (mm/s)",
            FIELD,
        ),
    )
    marks = frame.loc[frame["series"] == "convexity", [DISTANCE, "curvature (1/m)"]].to_numpy()
    for ax, (grid, label, colours) in zip(axes, panels, strict=True):
        look = {"cmap": colours, "vmin": 0, "vmax": np.nanpercentile(grid, 99.5)}
        look |= {"shading": "gouraud", "rasterized": True}
        drawn = ax.pcolormesh(grid.columns, grid.index, grid, **look)
        if grid is panels[-1][0]:
            pressure = maps[P].to_numpy()
            nothing = {"levels": (-1.0, TOUCHES), "colors": "white"}
            ax.contourf(grid.columns, grid.index, pressure, **nothing)
        for place, _ in marks:
            colour = GREY if grid is panels[-1][0] else "white"
            ax.plot([-4, 4], [place + 4, place - 4], color=colour, lw=0.7, ls=DASHED)
        colour_bar(fig, drawn, ax, label, orientation="horizontal", aspect=26, extend="max")
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
        "Simulated, 10 mm/s. Line: tangential traction; edges of the grey area: its bounds, plus "
        "and minus pressure times friction. Where both meet the skin slips, elsewhere it sticks. "
        "Last panel: share of the load carried where it sticks."
    )
    *instants, whole = frame["panel"].unique()
    stuck = _of(frame, whole).sort_values(DISTANCE)
    gone = stuck.loc[stuck[STICKING] < 5, DISTANCE].min()
    most = stuck.loc[stuck[DISTANCE] >= gone, STICKING].max()
    rest = f"at most {n(most)} % of the load sticks" if most > 0.5 else "the whole contact slips"
    title = f"After {n(gone)} mm of a stroke {rest}"
    fig = study_figure(title, [note], 3.6)
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
        ax.fill_between(rows[SKIN_X], -rows[BOUND], rows[BOUND], color="0.88", lw=0)
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
    ax = fig.add_subplot(grid[1, :])
    ax.plot(stuck[DISTANCE], stuck[STICKING], color=INK)
    ax.set(xlabel="stroke distance (mm)", ylabel="load that sticks (%)", xlim=(0, 2), ylim=(0, 105))
    return fig

"""The study of ridges: what a receptor feels of direction, against its place, ridge height,
friction and mesh; outer ridges.

Each figure is drawn from its data frame alone, see :mod:`cysyk1999.studies.ridges.frames`. The
directional index is that of
:mod:`cysyk1999.measures.direction`.
"""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from cysyk1999.measures.direction import BESIDE, DEPTH, KEY
from cysyk1999.measures.quantities import DISTANCE, SED, P, X
from cysyk1999.publishing.style import (
    CATEGORIES,
    DASHED,
    DOTTED,
    GREY,
    HIGHLIGHT,
    INK,
    LAYER_COLOURS,
    study_figure,
    styled,
)

OFFSET, INDEX, BAND = "offset (um)", "directional_index (1)", "discretisation_error (1)"
HEIGHT, FRICTION, EDGE = "ridge_height (um)", "friction (1)", "element_edge (um)"
RECEPTOR, RIGHT, LEFT, NODES = "receptor_depth (um)", "right (Pa)", "left (Pa)", "nodes (1)"
MESHES = {"coarse": 268.8, "thesis": 134.4, "fine": 67.2}
"""Element edge (um) along the skin of the meshes that resolve the ridges."""
DRAWN = {
    "curved": "curved sides, tip at a corner",
    "straight": "straight sides, tip at a corner",
    "shifted": "straight sides, tip amid an element",
}
"""Meshes with ridges drawn on the thesis's own elements, which the thesis does not describe."""
RECEPTORS_SWEPT = (
    "thesis's place: 915 µm deep, x = −46 µm",
    "epidermis, 25 µm above the flank",
    "dermis, 25 µm below the flank",
)
LOOKS = dict(
    zip(
        RECEPTORS_SWEPT,
        ((INK, "o", "-"), (CATEGORIES[1], "s", DASHED), (CATEGORIES[0], "^", DOTTED)),
        strict=True,
    )
)
DEFINITION = (
    "Simulated. Index: (right − left) / (right + left) of the strain energy under a "
    "plate, over 2 to 4 mm of stroke. "
)


# --- pictures --------------------------------------------------------------------------------------------------


def _curve(
    ax: Axes, rows: pd.DataFrame, x: str, colour: str, marker: str, line, label: str
) -> None:
    """A curve with its band of discretisation error."""
    if x != HEIGHT:
        ax.fill_between(
            rows[x],
            rows[INDEX] - rows[BAND],
            rows[INDEX] + rows[BAND],
            color=colour,
            alpha=0.25,
            lw=0,
        )
    ax.plot(
        rows[x],
        rows[INDEX],
        color=colour,
        ls="none" if x == HEIGHT else line,
        marker=marker,
        ms=3.5,
        label=label,
    )
    if x == HEIGHT:  # five heights tell nothing of what lies between
        ax.errorbar(rows[x], rows[INDEX], rows[BAND], fmt="none", ecolor=colour, elinewidth=0.8)


@styled
def offset(frame: pd.DataFrame) -> Figure:
    """Map round a ridge above, profile at the thesis's depth below."""
    profile_rows = frame[frame["panel"] == "profile"]
    note = [
        f"{DEFINITION}Black line: epidermis to dermis; dashed: {DEPTH * 1e6:.0f} µm; circles: the "
        "thesis's receptors. Fine mesh, "
        "not smoothed; band: difference to twice the edge.",
    ]
    fig = study_figure("Ridges: directional index round a ridge", note, 5.4)
    top, ax = fig.subplots(2, 1, sharex=True, height_ratios=[1.25, 1.0])
    grid = frame[frame["panel"] == "map"].pivot(index=RECEPTOR, columns=OFFSET, values=INDEX)
    shown = top.pcolormesh(
        grid.columns,
        grid.index,
        grid,
        cmap="RdBu_r",
        vmin=-0.6,
        vmax=0.6,
        shading="nearest",
        rasterized=True,
    )
    bar = fig.colorbar(shown, ax=top, pad=0.015, aspect=18)
    bar.set_label("directional index (red: more to the right)")
    edge = frame[frame["panel"] == "boundary"]
    top.plot(edge[OFFSET], edge[RECEPTOR], color=INK, lw=1.5)
    top.axhline(DEPTH * 1e6, color=INK, lw=0.8, ls=(0, (4, 2)))
    top.plot(
        [-BESIDE * 1e6, 0, BESIDE * 1e6],
        [DEPTH * 1e6] * 3,
        "o",
        mfc="white",
        mec=INK,
        ms=5,
        ls="none",
    )
    top.set(ylim=(1105, 695), ylabel="depth below the skin (µm)")
    top.text(-244, 712, "epidermis", va="top", fontsize=6.5)
    top.text(-244, 1092, "dermis", va="bottom", fontsize=6.5)
    looks = {"no ridges": (GREY, "", (0, (4, 1.8))), "inner ridges": (HIGHLIGHT, "o", "-")}
    for series, (colour, marker, line) in looks.items():
        rows = profile_rows[profile_rows["series"] == series]
        _curve(ax, rows, OFFSET, colour, marker, line, series)
    inner = profile_rows[profile_rows["series"] == "inner ridges"].set_index(OFFSET)
    epidermis = edge.loc[edge[RECEPTOR] > DEPTH * 1e6, OFFSET]
    ax.axvspan(epidermis.min(), epidermis.max(), color=LAYER_COLOURS["epidermis"], alpha=0.35, lw=0)
    ax.text(0, -0.72, "epidermis", ha="center", fontsize=6.5)
    value, error = inner.loc[-BESIDE * 1e6, [INDEX, BAND]]
    ax.annotate(
        f"{value:.2f} ± {max(error, 0.005):.2g} at −46 µm:\n{(1 + value) / (1 - value):.1f} times "
        "the energy",
        (-BESIDE * 1e6, value),
        (-75, 0.45),
        ha="right",
        va="center",
        fontsize=6.5,
        arrowprops={"arrowstyle": "-", "lw": 0.6, "color": INK},
    )
    ax.axhline(0, color=GREY, lw=0.6)
    ax.set(
        xlim=(-250, 250),
        ylim=(-0.8, 0.8),
        xlabel="offset from the ridge's tip (µm)",
        ylabel=f"directional index at {DEPTH * 1e6:.0f} µm",
    )
    ax.legend(loc="upper right")
    return fig


def _sweep(frame: pd.DataFrame, column: str, title: str, xlabel: str, extra: str) -> Figure:
    note = [DEFINITION + extra + " Band: difference to up to twice the edge."]
    fig = study_figure(title, note, 4.2)
    ax = fig.subplots()
    for series, (colour, marker, line) in LOOKS.items():
        rows = frame[frame["series"] == series].sort_values(column)
        if series == next(iter(LOOKS)) and column == HEIGHT:  # its layer changes with the height
            for layer, part in rows.groupby("layer", sort=False):
                _curve(ax, part, column, colour, marker, line, series if layer == "dermis" else "")
                if layer == "epidermis":
                    first = part.iloc[0]
                    ax.annotate(
                        "in the epidermis",
                        (first[column], first[INDEX]),
                        (0, 7),
                        textcoords="offset points",
                        ha="center",
                        fontsize=7,
                    )
        else:
            _curve(ax, rows, column, colour, marker, line, series)
    ax.axhline(0, color=GREY, lw=0.6)
    ax.set(xlabel=xlabel, ylabel="directional index", ylim=(-0.8, 0.8))
    ax.margins(x=0.03)
    ax.legend(loc="lower left", fontsize=6.5)
    return fig


@styled
def height(frame: pd.DataFrame) -> Figure:
    """Index against the ridges' height."""
    extra = (
        f"Friction {KEY[1]:g}, ridges 0.48 mm apart. Flank: 120 µm from the tip; its "
        "receptors follow the boundary."
    )
    return _sweep(
        frame, HEIGHT, "Ridges: directional index against their height", "ridge height (µm)", extra
    )


@styled
def friction(frame: pd.DataFrame) -> Figure:
    """Index against the coefficient of friction."""
    extra = f"Ridges {KEY[0]:g} µm high, 0.48 mm apart. Flank: 120 µm from the tip, x = −120 µm."
    return _sweep(
        frame,
        FRICTION,
        "Ridges: directional index against friction",
        "coefficient of friction",
        extra,
    )


@styled
def mesh(frame: pd.DataFrame) -> Figure:
    """Energies and index at the thesis's receptor against the mesh."""
    resolved = frame[frame["panel"] == "resolved"].sort_values(EDGE)
    drawn = frame[frame["panel"] == "drawn"]
    note = [
        DEFINITION
        + f"Receptor {DEPTH * 1e6:.0f} µm deep, {BESIDE * 1e6:.0f} µm left of a tip. Open: ridges on elements of the "
        "thesis's size (four to a pitch, one to a height), in three ways.",
    ]
    fig = study_figure("Ridges: how far to believe the directional index", note, 3.9)
    left, right = fig.subplots(1, 2)
    for column, colour, name in (
        (RIGHT, HIGHLIGHT, "plate to the right"),
        (LEFT, CATEGORIES[1], "plate to the left"),
    ):
        left.plot(resolved[EDGE], resolved[column], "o-", color=colour, ms=4, label=name)
    right.plot(resolved[EDGE], resolved[INDEX], "o-", color=INK, ms=4, label="ridges resolved")
    for marker, (series, name) in zip("D^v", DRAWN.items(), strict=True):
        rows = drawn[drawn["series"] == series]
        for column, colour in ((RIGHT, HIGHLIGHT), (LEFT, CATEGORIES[1])):
            left.plot(rows[EDGE], rows[column], marker, mfc="white", mec=colour, ms=5)
        right.plot(
            rows[EDGE], rows[INDEX], marker, mfc="white", mec=INK, ms=5, ls="none", label=name
        )
    for ax in (left, right):
        ax.set(
            xscale="log",
            xlabel="element edge along the skin (µm)",
            xticks=resolved[EDGE],
            xlim=(58, 310),
        )
        ax.set_xticklabels([f"{e:.0f}" for e in resolved[EDGE]])
        ax.minorticks_off()
    left.set(ylim=(0, None), ylabel="strain energy density (Pa)", title="energy, both ways")
    right.set(ylim=(0, 0.6), ylabel="directional index", title="directional index")
    left.legend(loc="upper right", bbox_to_anchor=(1, 0.62))
    right.legend(loc="lower left", title="thesis's elements below", title_fontsize=0.1)
    right.get_legend().set_title("")
    return fig


@styled
def outer(frame: pd.DataFrame) -> Figure:
    """Islands of contact under outer ridges: pressure, number on the way, and the receptors' energy
    both ways.
    """
    note = [
        "Simulated: flat plate, 20 gf, 10 mm/s, calibrated friction; outer ridges 60 µm high, "
        "0.48 mm apart; islands of 3 to "
        "5 loaded nodes: "
        f"their peaks are the mesh's. Receptors {DEPTH * 1e6:.0f} µm deep, that at 0 in the "
        "epidermis of the tip.",
    ]
    fig = study_figure("Ridges of the skin too: contact in islands", note, 5.0)
    grid = fig.add_gridspec(2, 2)
    axes = [fig.add_subplot(place) for place in (grid[0, 0], grid[0, 1], grid[1, 0], grid[1, 1])]
    part = lambda panel, series: frame[(frame["panel"] == panel) & (frame["series"] == series)]  # noqa: E731
    for series, look in {
        "pressed": {"color": GREY, "lw": 1.0},
        "stroked by 50 mm": {"color": HIGHLIGHT, "lw": 1.0},
    }.items():
        rows = part("pressure", series)
        axes[0].plot(rows[X], rows[P] / 1e3, label=series, **look)
    axes[0].set(
        xlabel="x (mm)", ylabel="contact pressure (kPa)", title="contact pressure", xlim=(-4, 4)
    )
    axes[0].set_ylim(0, 1.28 * frame[P].max() / 1e3)
    axes[0].legend(loc="upper left", ncols=2)
    for series, look in {
        "simulated mesh": {"color": INK},
        "companion": {"color": GREY, "ls": (0, (3, 1.5))},
    }.items():
        rows = part("islands", series)
        if len(rows):
            axes[1].step(
                rows[DISTANCE],
                rows["islands (1)"],
                where="post",
                label=series.replace("companion", "coarser mesh"),
                **look,
            )
    axes[1].set(
        xlabel="stroke distance (mm)",
        ylabel="islands",
        title="number of islands",
        xlim=(0, 50),
        ylim=(0, None),
    )
    axes[1].yaxis.set_major_locator(MultipleLocator(2))
    axes[1].legend(loc="lower right")
    top = 1.05 * frame[SED].max()
    for ax, way in ((axes[2], "right"), (axes[3], "left")):
        for series, (colour, line) in RECEPTORS.items():
            rows = part(way, series)
            ax.plot(
                rows[DISTANCE],
                rows[SED],
                color=colour,
                ls=line,
                label=f"x = {series}".replace("-", "−"),
            )
        ax.set(
            xlabel="stroke distance (mm)", title=f"plate to the {way}", xlim=(0, 50), ylim=(0, top)
        )
    axes[2].set_ylabel("strain energy density (Pa)")
    axes[3].legend(loc="center right", bbox_to_anchor=(1.0, 0.52))
    return fig


RECEPTORS = {
    "-46 µm": (HIGHLIGHT, "-"),
    "0 µm": (INK, (0, (4, 1.8))),
    "46 µm": (CATEGORIES[1], (0, (1, 1.2))),
}
STUDIES = {"offset": offset, "height": height, "friction": friction, "mesh": mesh, "outer": outer}

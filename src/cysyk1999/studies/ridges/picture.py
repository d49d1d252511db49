"""The study of ridges: what a receptor feels of direction, against its place, ridge height and
mesh.

Each figure is drawn from its data frame alone, see :mod:`cysyk1999.studies.ridges.frames`. The
directional index is that of :mod:`cysyk1999.measures.direction`.
"""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.measures.direction import BESIDE, DEPTH, KEY
from cysyk1999.publishing.style import (
    CATEGORIES,
    DASHED,
    GREY,
    HIGHLIGHT,
    INK,
    LAYER_COLOURS,
    study_figure,
    styled,
)

OFFSET, INDEX, BAND = "offset (um)", "directional_index (1)", "discretisation_error (1)"
HEIGHT, EDGE = "ridge_height (um)", "element_edge (um)"
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
DEFINITION = (
    "Simulated. Index: (right − left) / (right + left) of the strain energy under a plate, "
    "over 2 to 4 mm of stroke. "
)
DEEP, BY = DEPTH * 1e6, BESIDE * 1e6  # um


@styled
def offset(frame: pd.DataFrame) -> Figure:
    """Map round a ridge above, profile at the thesis's depth below."""
    note = (
        f"{DEFINITION}Black line: epidermis to dermis; dashed: {DEEP:.0f} µm; circles: the "
        "thesis's receptors. Fine mesh, not smoothed; band: difference to twice the edge."
    )
    fig = study_figure("Ridges: directional index round a ridge", [note], 5.4)
    around, profile = fig.subplots(2, 1, sharex=True, height_ratios=[1.25, 1.0])
    panels = dict(list(frame.groupby("panel")))
    grid = panels["map"].pivot(index=RECEPTOR, columns=OFFSET, values=INDEX)
    look = {"cmap": "RdBu_r", "vmin": -0.6, "vmax": 0.6, "shading": "nearest", "rasterized": True}
    shown = around.pcolormesh(grid.columns, grid.index, grid, **look)
    label = "directional index (red: more to the right)"
    fig.colorbar(shown, ax=around, pad=0.015, aspect=18, label=label)
    edge = panels["boundary"]
    around.plot(edge[OFFSET], edge[RECEPTOR], color=INK, lw=1.5)
    around.axhline(DEEP, color=INK, lw=0.8, ls=(0, (4, 2)))
    around.plot([-BY, 0, BY], [DEEP] * 3, "o", mfc="white", mec=INK, ms=5)
    around.set(ylim=(1105, 695), ylabel="depth below the skin (µm)")
    around.text(-244, 712, "epidermis", va="top", fontsize=6.5)
    around.text(-244, 1092, "dermis", va="bottom", fontsize=6.5)
    looks = {
        "no ridges": {"color": GREY, "ls": DASHED},
        "inner ridges": {"color": HIGHLIGHT, "marker": "o"},
    }
    for series, look in looks.items():
        rows = panels["profile"][panels["profile"]["series"] == series]
        ends = rows[INDEX] - rows[BAND], rows[INDEX] + rows[BAND]
        profile.fill_between(rows[OFFSET], *ends, color=look["color"], alpha=0.25, lw=0)
        profile.plot(rows[OFFSET], rows[INDEX], ms=3.5, label=series, **look)
    inside = edge.loc[edge[RECEPTOR] > DEEP, OFFSET]
    colour = LAYER_COLOURS["epidermis"]
    profile.axvspan(inside.min(), inside.max(), color=colour, alpha=0.35, lw=0)
    profile.text(0, -0.72, "epidermis", ha="center", fontsize=6.5)
    value, error = rows.set_index(OFFSET).loc[-BY, [INDEX, BAND]]
    ratio = (1 + value) / (1 - value)
    profile.annotate(
        f"{value:.2f} ± {max(error, 0.005):.2g} at −46 µm:\n{ratio:.1f} times the energy",
        (-BY, value),
        (-75, 0.45),
        ha="right",
        va="center",
        fontsize=6.5,
        arrowprops={"arrowstyle": "-", "lw": 0.6, "color": INK},
    )
    profile.axhline(0, color=GREY, lw=0.6)
    profile.set(xlim=(-250, 250), xlabel="offset from the ridge's tip (µm)")
    profile.set(ylim=(-0.8, 0.8), ylabel=f"directional index at {DEEP:.0f} µm")
    profile.legend(loc="upper right")
    return fig


@styled
def height(frame: pd.DataFrame) -> Figure:
    """Index against the ridges' height: points with the error of the mesh as bars."""
    note = (
        f"{DEFINITION}Friction {KEY[1]:g}, ridges 0.48 mm apart. Flank: 120 µm from the tip; its "
        "receptors follow the boundary. Band: difference to up to twice the edge."
    )
    deep = frame[frame["series"] == RECEPTORS_SWEPT[0]].set_index(HEIGHT)[INDEX]
    title = (
        f"Ridges {deep.idxmax():g} µm high make a stroke one way felt "
        f"{(1 + deep.max()) / (1 - deep.max()):.2g} times as much as the other; without ridges "
        f"{(1 + deep[0]) / (1 - deep[0]):.3g} times"
    )
    fig = study_figure(title, [note], 3.3)
    ax = fig.subplots()
    colours = (INK, *CATEGORIES[1::-1])
    for series, colour, marker in zip(RECEPTORS_SWEPT, colours, "os^", strict=True):
        rows = frame[frame["series"] == series].sort_values(HEIGHT)
        look = {"color": colour, "marker": marker, "ms": 3.5, "ls": "none", "label": series}
        ax.plot(rows[HEIGHT], rows[INDEX], **look)
        bars = {"fmt": "none", "ecolor": colour, "elinewidth": 0.8}
        ax.errorbar(rows[HEIGHT], rows[INDEX], rows[BAND], **bars)
    thesis = frame[frame["series"] == RECEPTORS_SWEPT[0]].sort_values(HEIGHT)
    for place in thesis.loc[thesis["layer"] == "epidermis", [HEIGHT, INDEX]].to_numpy()[:1]:
        look = {"textcoords": "offset points", "ha": "center", "fontsize": 7}
        ax.annotate("in the epidermis", place, (0, 7), **look)
    ax.axhline(0, color=GREY, lw=0.6)
    ax.set(xlabel="ridge height (µm)", ylabel="directional index")
    ax.margins(x=0.03, y=0.12)
    ax.legend(loc="upper left", fontsize=6.5)
    return fig


@styled
def mesh(frame: pd.DataFrame) -> Figure:
    """Energies and index at the thesis's receptor against the mesh."""
    resolved = frame[frame["panel"] == "resolved"].sort_values(EDGE)
    note = (
        f"{DEFINITION}Receptor {DEEP:.0f} µm deep, {BY:.0f} µm left of a tip. Open: ridges on "
        "elements of the thesis's size (four to a pitch, one to a height), in three ways."
    )
    fig = study_figure("Ridges: how far to believe the directional index", [note], 3.9)
    left, right = fig.subplots(1, 2)
    curves = (
        (left, RIGHT, HIGHLIGHT, "plate to the right"),
        (left, LEFT, CATEGORIES[1], "plate to the left"),
        (right, INDEX, INK, "ridges resolved"),
    )
    for ax, column, colour, label in curves:
        ax.plot(resolved[EDGE], resolved[column], "o-", color=colour, ms=4, label=label)
        for marker, (series, name) in zip("D^v", DRAWN.items(), strict=True):
            rows = frame[frame["series"] == series]
            look = {"mfc": "white", "mec": colour, "ms": 5, "ls": "none"}
            ax.plot(rows[EDGE], rows[column], marker, label=name if ax is right else "", **look)
    for ax in (left, right):
        ax.set(xscale="log", xlabel="element edge along the skin (µm)", xlim=(58, 310))
        ax.set_xticks(resolved[EDGE], [f"{edge:.0f}" for edge in resolved[EDGE]])
        ax.minorticks_off()
    left.set(ylim=(0, None), ylabel="strain energy density (Pa)", title="energy, both ways")
    right.set(ylim=(0, 0.6), ylabel="directional index", title="directional index")
    left.legend(loc="upper right", bbox_to_anchor=(1, 0.62))
    right.legend(loc="lower left")
    return fig


STUDIES = {"offset": offset, "height": height, "mesh": mesh}

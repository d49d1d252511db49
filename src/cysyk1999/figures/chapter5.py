"""Chapter 5: a wavy surface stepped and stroked over the pad: contact, pressure, skin curvature,
stretch and strain energy.

Distances are stroke distances: the point of the surface that is over the middle of the pad at rest;
times count from the moment the surface begins to slide. Above most pictures the surface itself is
drawn, solid above, with the curvatures (1/m) of its convexities.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures import overlaid
from cysyk1999.figures.grammar import (
    HOW,
    Data,
    Figure,
    Lines,
    Page,
    Panels,
    nine,
    stacked,
    upper_profile,
)
from cysyk1999.measures.errors import PARTS, Curve, curve_errors, over_stroke, shared_place
from cysyk1999.measures.quantities import (
    CURVATURE,
    DISTANCE,
    HEIGHT,
    LATERAL,
    NODE,
    P_CENTRE,
    RECEPTOR,
    SCALED_CURVATURE,
    SED,
    SKIN_CURVATURE,
    STROKE_TIME,
    TIME,
    P,
    Q,
    X,
    Y,
    sed,
)
from cysyk1999.measures.runs import NINE, SPEEDS, STEPPED_OVER, SUB_SPEEDS, WITHIN_400, Runs
from cysyk1999.measures.table import MEASURES, reading
from cysyk1999.publishing import style
from fingerpad.measures.features import (
    PRESSURE,
    SIMULATED,
    pressure_at,
    profile,
    skin_at,
)
from fingerpad.measures.skin import skin_curvatures
from fingerpad.measures.strokes import (
    LOCATIONS,
    NODES,
    distance,
    loaded,
    nodes_at,
    profile_and_height,
    time_of,
)
from fingerpad.planning.errors import PROFILE_ORDER

DEEP, SHALLOW = 915e-6, 560e-6  # m, receptors of Figs 5-13 and 5-18, and of 5-24
TEN = "10 mm/s"
TEN_RUN, SUB_TEN = SPEEDS.only((TEN,)), SUB_SPEEDS.only((TEN,))
PREDICTED = f"{SIMULATED}: predicted by Eq 5-1"
PRESSED = NINE.only(WITHIN_400[1:])
OTHER = {"color": style.HIGHLIGHT, "ls": style.DASHED, "lw": 1.1}
"""The second of two curves."""
CURVED = "skin curvature, $A_1 K + A_2$"
WITH_CURVATURE = Lines(
    looks={P_CENTRE: {"color": style.INK}, SCALED_CURVATURE: OTHER},
    names={P_CENTRE: "contact pressure", SCALED_CURVATURE: f"{CURVED}, in contact"},
    hidden={SCALED_CURVATURE: P_CENTRE},
)
SAMPLED = replace(
    WITH_CURVATURE,
    looks={q: look | {"marker": ".", "ms": 4} for q, look in WITH_CURVATURE.looks.items()},
    names=WITH_CURVATURE.names | {SCALED_CURVATURE: CURVED},
    hidden={},
)
"""The same at the points it was stepped to."""
CENTRE = P_CENTRE.reading(P_CENTRE.read, P.label)
TOP_OF_STRETCH = -0.5  # mm, where the thesis's axis of Fig 5-15 begins


# --- rows of their own ----------------------------------------------------------------------------


@stacked
def locations(data: Data, runs: Runs) -> Iterator[DataFrame | Mapping]:
    """The surface's shape; skin and pressure within 5 mm of the middle, and the surface above it,
    at three stroke distances.
    """
    ((_, history, coarse),) = data.runs(runs)
    stroke = loaded(history)
    shape, heights = profile_and_height(stroke)
    yield data.surface(runs[next(iter(runs))], 4, 35)
    for location in LOCATIONS:
        index = int(np.argmin(abs(distance(stroke) - location * 1e-3)))
        reached = distance(stroke)[index]
        (x, p), y = profile(stroke, index), skin_at(stroke, index)[1]
        shown = (abs(x) <= 5e-3) & (stroke["skin_y"].values > 0)
        over = np.linspace(-5e-3, 5e-3, 201)
        height = heights[index] + shape.outline(over + reached)
        curve = Curve(partial(profile_at, at=reached), False, PROFILE_ORDER)
        of = {"source": SIMULATED, "panel": f"{location:g} mm", DISTANCE: reached * 1e3}
        skin = {"series": "skin", X: x[shown] * 1e3, Y: y[shown] * 1e3, P: p[shown]}
        yield of | skin | curve_errors(history, coarse, curve).columns
        yield of | {"series": axs.SURFACE, X: over * 1e3, Y: height * 1e3}


def profile_at(history: Dataset, at: float) -> tuple[np.ndarray, np.ndarray]:
    """Position (m) and pressure (Pa) of the upper skin at the stroke distance nearest to one
    (m).
    """
    stroke = loaded(history)
    return upper_profile(stroke, int(np.argmin(abs(distance(stroke) - at))))


@stacked
def nodes_over_time(data: Data) -> Iterator[Mapping]:
    """Pressure and skin curvature over time at nine nodes, 10 mm/s."""
    ((_, history, coarse),) = data.runs(SUB_TEN)
    stroke = loaded(history)
    nodes = nodes_at(stroke)
    for place, node, curvature in zip(NODES, nodes, skin_curvatures(stroke, nodes), strict=True):
        x = float(stroke["skin_x"].values[node])
        pressed = over_stroke(partial(pressure_at, place=shared_place(x, coarse)))
        of = {"panel": f"X = {place:g} mm", NODE: round(1e3 * x, 5), TIME: time_of(stroke)}
        of |= {P: stroke[PRESSURE].values[:, node], SKIN_CURVATURE: 1e-3 * curvature}
        yield of | curve_errors(history, coarse, pressed).columns


def largest_energies(data: Data) -> DataFrame:
    """Largest strain energy at 915 um for each curvature: pressed by cylinders, and stroked at 10
    mm/s.
    """
    pressed = data.numbers(PRESSED, {SED: reading("highest_energy", "915 um")}, own=True)
    stroked = data.numbers(TEN_RUN, {SED: MEASURES["convexity_energy"]}, own=True)
    rows = pd.concat([pressed.assign(series="ramp and hold"), stroked])
    return rows[["series", CURVATURE, SED, *PARTS]]


# --- what layouts do not say ----------------------------------------------------------------------


def sampled_and_zero(ax, frame, spec):
    """Points that were stepped to, and a line at zero."""
    SAMPLED(ax, frame, spec)
    ax.axhline(0, color=style.GREY, lw=0.5, zorder=1)


def three_locations(fig, frame, spec):
    """The surface with a star at each location above; its window, the skin and the pressure at each
    below.
    """
    grid = fig.add_gridspec(4, 3, height_ratios=[1.0, 1.0, 1.5, 1.5])
    trace = fig.add_subplot(grid[0, :])
    shape, marks = axs.shape_of(frame), axs.from_source(frame, "thesis axis range")
    axs.draw_surface(trace, frame)
    trace.tick_params(labelbottom=True)
    start = marks.loc[marks["panel"] == axs.SURFACE, DISTANCE].min()
    trace.set(xlabel=DISTANCE.label, ylabel=HEIGHT.label)
    trace.set_xlim(5 if np.isnan(start) else start, shape[DISTANCE].max())
    star = {"marker": "*", "ms": 8, "mec": "white", "mew": 0.5, "clip_on": False}
    for column, location in enumerate(LOCATIONS):
        rows = frame[frame["panel"] == f"{location:g} mm"]
        window, touching, pressed = axes = [fig.add_subplot(grid[k, column]) for k in (1, 2, 3)]
        skin, surface = (rows[rows["series"] == series] for series in ("skin", axs.SURFACE))
        at = skin[DISTANCE].iloc[0]
        height = np.interp(at, shape[DISTANCE], shape[HEIGHT])
        for ax in (trace, window):
            ax.plot(at, height, color=style.HIGHLIGHT, **star)
        axs.solid(window, shape[DISTANCE], shape[HEIGHT], 1.0, color=style.INK, lw=1.0)
        ends = axs.from_source(rows, "thesis axis range")[DISTANCE].dropna()
        low, high = (ends.min(), ends.max()) if len(ends) else (at - 4, at + 4)
        window.set(xlim=(low, high), ylim=(-0.52, 0.36))
        window.set(xlabel=DISTANCE.label, title=f"at {at:g} mm")
        axs.solid(touching, surface[X], surface[Y], 6.4, color=style.GREY, lw=0.8)
        touching.plot(skin[X], skin[Y], color=style.INK)
        touching.set(xlim=(-5, 5), ylim=(4, 6), yticks=[4, 5, 6])
        axs.limit_axes(pressed, frame, y=P, text=column == 2)
        axs.curve(pressed, skin, X, P, color=style.INK)
        pressed.set(xlim=(-5, 5), xlabel=X.label)
        style.in_kilo(pressed.yaxis)
        for ax in axes:
            ax.tick_params(labelleft=column == 0)
    names = (HEIGHT.label, "surface and skin,\ny (mm)", "contact pressure\n(kPa)")
    for ax, name in zip(fig.axes[1:4], names, strict=True):
        ax.set_ylabel(name)


LOOKS = {P: {"color": style.INK}, SKIN_CURVATURE: OTHER | {"lw": 0.9}}
AT_NODES = tuple(f"X = {place:g} mm" for place in NODES)


def two_axes(panels, frame):
    """Curvature (dashed, left axis) and pressure (solid, right axis)."""
    least, highest = frame[SKIN_CURVATURE].min(), frame[P].max()
    for number, (panel, ax) in enumerate(panels.items()):
        rows, right = frame[frame["panel"] == panel], ax.twinx()
        right.set_label("twin")
        ax.set_title(panel.replace("-", "−"))
        axs.curve(right, rows, TIME, P, **LOOKS[P])
        right.spines["right"].set_visible(True)
        # zero pressure a third up, as the thesis sets the two apart
        right.set(ylim=(-0.75 * highest, highest), yticks=[0, 5000, 10000])
        style.in_kilo(right.yaxis)
        ax.set(ylim=(least, -2.0 * least), yticks=[-0.2, 0, 0.2])
        ax.tick_params(labelleft=number % 3 == 0)
        right.tick_params(labelright=number % 3 == 2)
        if number == 5:
            right.set_ylabel("contact pressure (kPa)")
    names = ("contact pressure (right axis)", "skin curvature in contact (left axis)")
    looks = dict(zip(names, LOOKS.values(), strict=True))
    style.header_legend(ax.figure, style.handles(looks))


def from_half_a_millimetre(panels, frame):
    """The axis of the thesis, which begins where the skin is already stretched."""
    (ax,) = panels.values()
    axs.limit_axes(ax, frame[frame[LATERAL] <= TOP_OF_STRETCH], y=LATERAL)
    ax.set_ylim(None, TOP_OF_STRETCH)
    text = "from 0 at the start,\noff the axis"
    ax.text(2.0, TOP_OF_STRETCH - 0.02, text, va="top", **axs.NOTE)


def at_locations(number: str, title: str, runs: Runs, pressure: str) -> Figure:
    """Figs 5-5 and 5-6."""
    windows = {f"{location:g} mm": f"T{235 + k}" for k, location in enumerate(LOCATIONS)}
    heights = {axs.SURFACE: "T233a", **dict.fromkeys(windows, "T238")}
    ids = {DISTANCE: windows | {axs.SURFACE: "T234"}, HEIGHT: heights}
    return Figure(
        number,
        title,
        runs,
        X,
        (Y, P),
        ids | {X: "T239", Y: "T239a", P: pressure},
        Page(6.2, three_locations, "panel"),
        rows=partial(locations, runs=runs),
        judged_with=(STEPPED_OVER,),
    )


def energy_figure(number: str, depth: float, thesis: Mapping[str, str], low: float) -> Figure:
    """Figs 5-13 and 5-24."""
    receptor = Q(RECEPTOR.name, RECEPTOR.unit, read=lambda history: depth * 1e6, checked=False)
    columns = (DISTANCE, sed(depth), receptor)
    return Figure(
        number,
        f"Strain energy density {depth * 1e6:.0f} µm under the centre at five stroking velocities",
        SPEEDS,
        DISTANCE,
        (SED,),
        thesis,
        Page(4.2, overlaid.velocities),
        rows=lambda data: data.strokes((SPEEDS,), columns, (low, 80)),
        surface=(low, 80),
    )


FIGURES = (
    at_locations(
        "5-5",
        "Skin and contact pressure, surface stepped over the pad by 1 mm",
        STEPPED_OVER,
        "T240",
    ),
    at_locations(
        "5-6", "Skin and contact pressure, surface stroked over the pad at 10 mm/s", SUB_TEN, "T241"
    ),
    Figure(
        "5-7",
        "Centre pressure and scaled skin curvature, stepped by 1 mm",
        STEPPED_OVER,
        DISTANCE,
        (CENTRE, SCALED_CURVATURE),
        {DISTANCE: "T246", P_CENTRE: "T245"},
        Panels(
            3.2,
            fill=sampled_and_zero,
            legend={"loc": "lower right", "handlelength": 2.6},
        ),
        surface=(0, 50),
    ),
    Figure(
        "5-8",
        "Centre pressure, stepped and stroked",
        (STEPPED_OVER, SUB_TEN),
        DISTANCE,
        (P_CENTRE,),
        {DISTANCE: "T248", P_CENTRE: "T247"},
        Panels(
            3.2,
            fill=Lines(
                looks={
                    "stepped": OTHER | {"marker": ".", "ms": 3},
                    TEN: {"color": style.INK, "ls": "-"},
                },
                names={"stepped": "stepped by 1 mm", TEN: "stroked, 10 mm/s"},
            ),
            legend={"loc": "upper right", "handlelength": 2.6},
        ),
        surface=(0, 50),
    ),
    Figure(
        "5-9",
        "Centre pressure at three stroking velocities",
        SUB_SPEEDS,
        DISTANCE,
        (P_CENTRE,),
        {DISTANCE: "T248", P_CENTRE: "T250"},
        Panels(3.2, legend={"loc": "lower right", "handlelength": 2.8}),
        surface=(0, 50),
    ),
    Figure(
        "5-10",
        "Contact pressure and skin curvature at nine nodes, 10 mm/s",
        SUB_TEN,
        TIME,
        (SKIN_CURVATURE,),
        {TIME: "T255", P: "T254", SKIN_CURVATURE: "T253"},
        nine(
            AT_NODES,
            5.6,
            by="panel",
            extra=two_axes,
            limit="x",
            fill=Lines(by="panel", looks=LOOKS, hidden={SKIN_CURVATURE: P}),
        ),
        rows=nodes_over_time,
        how=HOW,
    ),
    Figure(
        "5-11",
        "Centre pressure and scaled skin curvature, 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (P_CENTRE, SCALED_CURVATURE),
        {TIME: "T257", P_CENTRE: "T256"},
        Panels(3.4, fill=WITH_CURVATURE, legend={"loc": "upper left", "handlelength": 2.6}),
        rows=lambda data: data.strokes(
            (TEN_RUN,), (DISTANCE, STROKE_TIME, P_CENTRE, SCALED_CURVATURE), (0, 80)
        ),
        surface=(0, 80),
    ),
    Figure(
        "5-12",
        "Centre pressure at five stroking velocities",
        SPEEDS,
        DISTANCE,
        (P_CENTRE,),
        {DISTANCE: "T260", P_CENTRE: "T259"},
        Page(4.2, overlaid.velocities),
        surface=(0, 80),
    ),
    energy_figure("5-13", DEEP, {DISTANCE: "T262", SED: "T261"}, 0),
    Figure(
        "5-15",
        "Lateral displacement of the centre node",
        SPEEDS.only(SUB_SPEEDS),
        DISTANCE,
        (LATERAL,),
        {DISTANCE: "T260", LATERAL: "T266b"},
        Panels(
            3.3,
            limit="x",
            legend={"loc": "upper right", "ncols": 3, "handlelength": 2.8},
            extra=from_half_a_millimetre,
        ),
        surface=(0, 80),
    ),
    Figure(
        "5-18",
        "Largest strain energy density 915 µm under the centre",
        (PRESSED, TEN_RUN),
        CURVATURE,
        (SED,),
        {CURVATURE: "T277", SED: "T276"},
        Panels(
            2.8,
            legend={"loc": "upper left", "handlelength": 3},
            fill=Lines(
                by="series",
                names={TEN: f"stroked at {TEN}"},
                looks={
                    "ramp and hold": {"marker": "o", "ms": 3.5, "color": style.INK},
                    TEN: OTHER | {"marker": "s", "ms": 3.5},
                },
            ),
        ),
        rows=largest_energies,
        width=style.COLUMN_WIDTH,
        joined="series",
    ),
    energy_figure("5-24", SHALLOW, {DISTANCE: "T308", SED: "T307"}, 40),
)

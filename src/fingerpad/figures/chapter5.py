"""Chapter 5: a wavy surface stepped and stroked over the pad: contact, pressure, skin curvature, stretch and strain energy.

Frames and pictures as in `chapter4`. Distances are stroke distances: the point of the surface that is over the middle of
the pad at rest; times count from the moment the surface begins to slide. Above most pictures the surface itself is drawn,
solid above, with the curvatures (1/m) of its convexities.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fingerpad.figures.spec import FigureSpec, assemble, axis_rows, rows_of
from fingerpad.measures.features import (
    ERROR,
    PRESSURE,
    SIMULATED,
    SURFACES,
    Histories,
    Meshes,
    Trace,
    centre_pressure,
    error_percent,
    is_simulated,
    profile,
    scene_of,
    scenes,
)
from fingerpad.measures.quantities import (
    CURVATURE,
    DISTANCE,
    HEIGHT,
    LATERAL,
    LENGTH,
    NODE,
    P_CENTRE,
    RADIUS,
    RECEPTOR,
    SCALED_CURVATURE,
    SED,
    SKIN_CURVATURE,
    TIME,
    P,
    X,
    Y,
)
from fingerpad.measures.skin import skin_curvature
from fingerpad.measures.strokes import (
    FULL,
    LOCATIONS,
    NODES,
    SPEEDS,
    STEPPED,
    SUB,
    arcs,
    contact_lengths,
    convexities,
    distance,
    energy_at,
    label_errors,
    lateral,
    loaded,
    nodes_at,
    peaks,
    profile_and_height,
    rms_error,
    scaled_curvature,
    time_of,
)
from fingerpad.publishing import style

SURFACE = "surface"
SURFACE_SOURCE = f"{SIMULATED}: shape of the stimulus"
SHOWN_DEPTH = 915e-6  # m, receptor of Figs 5-13 and 5-18
SHALLOW_DEPTH = 560e-6  # m, receptor of Fig 5-24
COLOURS = dict(zip(SPEEDS, mpl.colormaps["viridis"](np.linspace(0.0, 0.82, len(SPEEDS))), strict=True))
LINES = {"1": (0, (1, 1.4)), "5": (0, (3, 1, 1, 1)), "10": "-", "20": (0, (6, 1.5)), "40": (0, (3.5, 1.5))}
TOP_OF_STRETCH = -0.5  # mm, where the thesis's axis of Fig 5-15 begins
HOW = "r.m.s. over the stroke"


# --- helpers -------------------------------------------------------------------------------------------


def by_speed(scenes_by_speed: Mapping[str, str]) -> dict[str, str]:
    """Scenes by the name of a series: ``10 mm/s``."""
    return {f"{speed} mm/s": scene for speed, scene in scenes_by_speed.items()}


def surface_rows(history: xr.Dataset, low: float, high: float) -> pd.DataFrame:
    """Rows of the surface's shape from `low` to `high` (mm along it): height, and curvature (0 on the flats)."""
    ends = [1e3 * a.start for a in arcs(history)] + [1e3 * arcs(history)[-1].end]
    x = np.union1d(np.arange(low, high + 1e-9, 0.1), [end for end in ends if low < end < high])
    shape, _ = profile_and_height(history)
    curvature = np.zeros(len(x))
    for arc in arcs(history):
        curvature[(x >= arc.start * 1e3) & (x < arc.end * 1e3)] = arc.curvature
    heights = shape.outline(x * 1e-3) * 1e3
    return pd.DataFrame({"source": SURFACE_SOURCE, "panel": SURFACE, DISTANCE: x, HEIGHT: heights, CURVATURE: curvature})


def stroke_rows(histories: Histories, coarse: Histories, names: Mapping[str, str], columns: Mapping[str, Trace]) -> pd.DataFrame:
    """One row a loaded output and stroke: stroke distance, the columns (SI times the column's unit), the traces' error."""
    parts = []
    for series, name in names.items():
        stroke = loaded(histories[name])
        part = {"source": SIMULATED, "series": series, DISTANCE: distance(stroke) * 1e3}
        part |= {column: read(stroke) for column, read in columns.items()}
        checked = [read for column, read in columns.items() if column not in (TIME, SCALED_CURVATURE)]
        part[ERROR] = rms_error(histories[name], coarse.get(name), *checked)
        parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True)


def draw_surface(ax: Axes, frame: pd.DataFrame) -> None:
    """The surface, solid above, with the curvature of each convexity in 1/m."""
    rows = frame[frame["source"] == SURFACE_SOURCE]
    x, y = rows[DISTANCE].to_numpy(), rows[HEIGHT].to_numpy()
    top = y.max() + 0.35
    ax.fill_between(x, y, top, color="0.87", lw=0)
    ax.plot(x, y, color=style.INK, lw=1.0)
    ax.set(xlim=(x[0], x[-1]), ylim=(y.min() - 0.1, top), yticks=[-0.4, 0])
    ax.tick_params(labelbottom=False)
    ax.set_ylabel("mm")
    runs = [run for _, run in rows.groupby((rows[CURVATURE].diff() != 0).cumsum()) if run[CURVATURE].iloc[0] > 0 and len(run) > 2]
    room = 0.034 * (x[-1] - x[0])
    if x[-1] in runs[-1][DISTANCE].to_numpy() and np.ptp(runs[-1][DISTANCE]) < room:  # cut off by the picture's end
        runs.pop()
    places = [(run[DISTANCE].iloc[0] + run[DISTANCE].iloc[-1]) / 2 for run in runs]
    for run, place in zip(runs, style.spread(places, room, x[0] + room / 2, x[-1] - room / 2), strict=True):
        ax.text(place, top - 0.06, f"{run[CURVATURE].iloc[0]:.0f}", ha="center", va="top", fontsize=6.5)


def below_surface(
    frame: pd.DataFrame,
    number: str,
    title: str,
    height: float,
    panels: int = 1,
    header: float = 0.0,
    remarks: list[str] | None = None,
):
    """A figure with the surface above and panels below that share its distances; returns figure and panels.

    `remarks` are lines added to the note.
    """
    note = style.footnote(frame, HOW) + (remarks or [])
    fig = style.new_figure(frame, number, title, height, note=note, header=header)
    top, *axes = fig.subplots(1 + panels, 1, sharex=True, height_ratios=[0.55 if panels == 1 else 0.7, *[3.0 / panels] * panels])
    draw_surface(top, frame)
    return fig, axes


def _simulated(frame: pd.DataFrame, series: str) -> pd.DataFrame:
    return frame[is_simulated(frame) & (frame["series"] == series)]


def _speed_of(series: str) -> str:
    return series.split()[0]


def _stroke_look(series: str) -> dict:
    speed = _speed_of(series)
    return {"color": COLOURS[speed], "linestyle": LINES[speed], "lw": 1.3}


# --- 5-4 -----------------------------------------------------------------------------------------------


def frame_5_4(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Stroke distance over which the centre node touches each convexity, at every velocity."""
    parts = []
    for series, name in by_speed(FULL).items():
        lengths = contact_lengths(loaded(histories[name]))
        errors = label_errors(histories[name], coarse.get(name), contact_lengths)
        exact = [arc.curvature for arc in convexities(histories[name]).values()]
        part = {"series": series, CURVATURE: exact, RADIUS: [1e3 / k for k in exact]}
        parts.append(pd.DataFrame(part | {LENGTH: [v * 1e3 for v in lengths.values()], ERROR: list(errors.values())}))
    return assemble(
        pd.concat(parts, ignore_index=True),
        axis_rows(reference, CURVATURE, "T229"),
        axis_rows(reference, RADIUS, "T230"),
        axis_rows(reference, LENGTH, "T228"),
    )


@style.styled
def fig_5_4(frame: pd.DataFrame) -> Figure:
    """Contact length against (a) curvature and (b) radius."""
    title = "Length of each convexity in contact with the centre node"
    fig = style.new_figure(frame, "5-4", title, 6.0, note=style.footnote(frame) + ["Recorded burst widths are not available."])
    rows = frame[is_simulated(frame)]
    for ax, tag, column, name in zip(
        fig.subplots(2, 1), "ab", (CURVATURE, RADIUS), ("curvature (1/m)", "radius (mm)"), strict=True
    ):
        style.limit_axes(ax, frame, column, LENGTH)
        extent = rows.groupby(column)[LENGTH].agg(["min", "max"])
        ax.fill_between(extent.index, extent["min"], extent["max"], color=COLOURS["10"], alpha=0.25, lw=0, label="1 to 40 mm/s")
        line = _simulated(frame, "10 mm/s").sort_values(column)
        ax.plot(line[column], line[LENGTH], color=style.INK, marker="o", ms=3, label="10 mm/s")
        ax.set(xlabel=name, ylabel="contact length (mm)", title=f"({tag})")
    ax.legend(loc="lower right")
    return fig


# --- 5-5, 5-6 ------------------------------------------------------------------------------------------


def _location_rows(history: xr.Dataset, coarse: xr.Dataset | None) -> pd.DataFrame:
    """Skin and pressure within 5 mm of the middle, and the surface above it, at three stroke distances."""
    stroke = loaded(history)
    shape, heights = profile_and_height(stroke)
    parts = []
    for location in LOCATIONS:
        index = int(np.argmin(abs(distance(stroke) - location * 1e-3)))
        reached = distance(stroke)[index]
        x, p = profile(stroke, index)
        y = stroke["skin_y"].values + stroke["skin_displacement_y"].values[index]
        shown = (abs(x) <= 5e-3) & (stroke["skin_y"].values > 0)
        panel = {"panel": f"{location:g} mm"}
        skin = {"series": "skin", X: x[shown] * 1e3, Y: y[shown] * 1e3, P: p[shown]}
        over = np.linspace(-5e-3, 5e-3, 201)
        surface = {"series": SURFACE, X: over * 1e3, Y: (heights[index] + shape.outline(over + reached)) * 1e3}
        error = error_percent(history, coarse, partial(_highest_at, at=reached))
        parts += [pd.DataFrame({"source": SIMULATED} | panel | rows | {DISTANCE: reached * 1e3}) for rows in (skin, surface)]
        parts[-2][ERROR] = error
    return pd.concat(parts, ignore_index=True)


def _highest_at(history: xr.Dataset, at: float) -> float:
    """Largest pressure (Pa) of any node at the stroke distance nearest to one (m)."""
    stroke = loaded(history)
    return float(stroke[PRESSURE].values[int(np.argmin(abs(distance(stroke) - at)))].max())


def _locations_frame(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, *, scene: str, pressure: str
) -> pd.DataFrame:
    """The surface's shape, and skin and pressure at the thesis's three locations."""
    windows = {f"{location:g} mm": id_ for location, id_ in zip(LOCATIONS, ("T235", "T236", "T237"), strict=True)}
    return assemble(
        pd.concat(
            [surface_rows(histories[scene], 4, 35), _location_rows(histories[scene], coarse.get(scene))], ignore_index=True
        ),
        axis_rows(reference, DISTANCE, windows, key="panel"),
        axis_rows(reference, DISTANCE, {SURFACE: "T234"}, key="panel"),
        axis_rows(reference, HEIGHT, {SURFACE: "T233a", **dict.fromkeys(windows, "T238")}, key="panel"),
        axis_rows(reference, X, "T239"),
        axis_rows(reference, Y, "T239a"),
        axis_rows(reference, P, pressure),
    )


def _draw_locations(frame: pd.DataFrame, number: str, title: str) -> Figure:
    """The surface with a star at each location above; its window, the skin and the pressure at each below."""
    fig = style.new_figure(frame, number, title, 7.6)
    grid = fig.add_gridspec(4, 3, height_ratios=[1.0, 1.0, 1.5, 1.5])
    trace = fig.add_subplot(grid[0, :])
    shape = frame[frame["source"] == SURFACE_SOURCE]
    marks = frame[~is_simulated(frame)]
    draw_surface(trace, frame)
    trace.tick_params(labelbottom=True)
    own = marks[marks["panel"] == SURFACE]
    trace.set(xlabel="distance (mm)", ylabel="height (mm)")
    trace.set_xlim(own[DISTANCE].min() if own[DISTANCE].notna().any() else 5, shape[DISTANCE].max())
    for column, location in enumerate(LOCATIONS):
        panel = f"{location:g} mm"
        rows, axes = rows_of(frame, "panel", panel), [fig.add_subplot(grid[row, column]) for row in (1, 2, 3)]
        skin, surface = (rows[rows["series"] == series] for series in ("skin", SURFACE))
        at = skin[DISTANCE].iloc[0]
        star = {"marker": "*", "ms": 10, "color": style.COLOURS["315"], "mec": "white", "mew": 0.5, "clip_on": False}
        window = marks.loc[marks["panel"] == panel, DISTANCE]
        for ax in (trace, axes[0]):
            ax.plot(at, np.interp(at, shape[DISTANCE], shape[HEIGHT]), **star)
        axes[0].fill_between(shape[DISTANCE], shape[HEIGHT], 1.0, color="0.87", lw=0)
        axes[0].plot(shape[DISTANCE], shape[HEIGHT], color=style.INK, lw=1.0)
        low, high = (window.min(), window.max()) if len(window) else (at - 4, at + 4)
        axes[0].set(xlim=(low, high), ylim=(-0.52, 0.36), xlabel="distance (mm)", title=f"({'abc'[column]}) at {at:g} mm")
        axes[1].fill_between(surface[X], surface[Y], 6.4, color="0.87", lw=0)
        axes[1].plot(surface[X], surface[Y], color=style.GREY, lw=0.8)
        axes[1].plot(skin[X], skin[Y], color=style.INK)
        axes[1].set(xlim=(-5, 5), ylim=(4, 6), yticks=[4, 5, 6])
        style.limit_axis(axes[2], frame, P, text=column == 2)
        axes[2].plot(skin[X], skin[P], color=style.INK)
        axes[2].set(xlim=(-5, 5), xlabel="x (mm)")
        if column == 0:
            for ax, name in zip(axes, ("height (mm)", "surface and skin,\ny (mm)", "contact pressure (Pa)"), strict=True):
                ax.set_ylabel(name)
        else:
            for ax in axes:
                ax.tick_params(labelleft=False)
    return fig


@style.styled
def fig_5_5(frame: pd.DataFrame) -> Figure:
    """Stepped surface at three locations."""
    return _draw_locations(frame, "5-5", "Skin and contact pressure, surface stepped over the pad by 1 mm")


@style.styled
def fig_5_6(frame: pd.DataFrame) -> Figure:
    """Stroked surface at three locations."""
    return _draw_locations(frame, "5-6", "Skin and contact pressure, surface stroked over the pad at 10 mm/s")


# --- 5-7, 5-8, 5-9 -------------------------------------------------------------------------------------

STEPPED_SERIES = "stepped"


def frame_5_7(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Centre pressure and scaled skin curvature, stepped."""
    columns = {P_CENTRE: centre_pressure, SCALED_CURVATURE: scaled_curvature}
    rows = stroke_rows(histories, coarse, {STEPPED_SERIES: STEPPED}, columns)
    return assemble(
        pd.concat([surface_rows(histories[STEPPED], 0, 50), rows], ignore_index=True),
        axis_rows(reference, DISTANCE, "T246"),
        axis_rows(reference, P_CENTRE, "T245"),
    )


@style.styled
def fig_5_7(frame: pd.DataFrame) -> Figure:
    """Centre pressure (solid) and curvature (dashed), stepped."""
    title = "Centre pressure and scaled skin curvature, stepped by 1 mm"
    fig, (ax,) = below_surface(frame, "5-7", title, 4.6)
    rows = _simulated(frame, STEPPED_SERIES)
    _draw_scaled(ax, rows, DISTANCE)
    style.limit_axes(ax, _larger(frame), DISTANCE, P_CENTRE)
    ax.axhline(0, color=style.GREY, lw=0.5, zorder=1)
    ax.set(xlabel="distance (mm)", ylabel="contact pressure (Pa)")
    ax.legend(loc="lower right", handlelength=2.6)
    return fig


def _draw_scaled(ax: Axes, rows: pd.DataFrame, x: str) -> None:
    ax.plot(rows[x], rows[P_CENTRE], color=style.INK, label="contact pressure")
    ax.plot(rows[x], rows[SCALED_CURVATURE], color=style.COLOURS["315"], ls=(0, (4, 1.8)), lw=1.2,
            label="skin curvature, $A_1 K + A_2$")  # fmt: skip


def _larger(frame: pd.DataFrame) -> pd.DataFrame:
    """The frame twice, the second time with the scaled curvature as pressure: an axis then holds both."""
    return pd.concat([frame, frame.assign(**{P_CENTRE: frame[SCALED_CURVATURE]})[is_simulated(frame)]], ignore_index=True)


def frame_5_8(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Centre pressure, stepped and stroked at 10 mm/s."""
    names = {STEPPED_SERIES: STEPPED, "10 mm/s": SUB["10"]}
    rows = stroke_rows(histories, coarse, names, {P_CENTRE: centre_pressure})
    return assemble(
        pd.concat([surface_rows(histories[SUB["10"]], 0, 50), rows], ignore_index=True),
        axis_rows(reference, DISTANCE, "T248"),
        axis_rows(reference, P_CENTRE, "T247"),
    )


@style.styled
def fig_5_8(frame: pd.DataFrame) -> Figure:
    """Stepped (dashed) and stroked (solid)."""
    fig, (ax,) = below_surface(frame, "5-8", "Centre pressure, stepped and stroked", 4.6)
    looks = {STEPPED_SERIES: {"color": style.COLOURS["315"], "ls": (0, (4, 1.8))}, "10 mm/s": {"color": style.INK}}
    for series, look in looks.items():
        rows = _simulated(frame, series)
        name = "stepped by 1 mm" if series == STEPPED_SERIES else f"stroked, {series}"
        ax.plot(rows[DISTANCE], rows[P_CENTRE], label=name, **look)
    style.limit_axes(ax, frame, DISTANCE, P_CENTRE)
    ax.set(xlabel="distance (mm)", ylabel="contact pressure at the centre (Pa)")
    ax.legend(loc="upper right", handlelength=2.6)
    return fig


def frame_5_9(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Centre pressure at three velocities."""
    rows = stroke_rows(histories, coarse, by_speed(SUB), {P_CENTRE: centre_pressure})
    return assemble(
        pd.concat([surface_rows(histories[SUB["10"]], 0, 50), rows], ignore_index=True),
        axis_rows(reference, DISTANCE, "T248"),
        axis_rows(reference, P_CENTRE, "T250"),
    )


@style.styled
def fig_5_9(frame: pd.DataFrame) -> Figure:
    """Three velocities."""
    fig, (ax,) = below_surface(frame, "5-9", "Centre pressure at three stroking velocities", 4.6)
    _draw_speeds(ax, frame, P_CENTRE)
    style.limit_axes(ax, frame, DISTANCE, P_CENTRE)
    ax.set(xlabel="distance (mm)", ylabel="contact pressure at the centre (Pa)")
    ax.legend(loc="upper right", handlelength=2.8)
    return fig


def _draw_speeds(ax: Axes, frame: pd.DataFrame, column: str) -> None:
    for series in frame.loc[is_simulated(frame), "series"].dropna().unique():
        rows = _simulated(frame, series)
        ax.plot(rows[DISTANCE], rows[column], label=series, **_stroke_look(series))


# --- 5-10 ----------------------------------------------------------------------------------------------


def frame_5_10(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure and skin curvature over time at nine nodes, 10 mm/s."""
    history = histories[SUB["10"]]
    stroke = loaded(history)
    error = rms_error(history, coarse.get(SUB["10"]), centre_pressure)
    parts = [
        pd.DataFrame(
            {
                "panel": f"X = {place:g} mm",
                NODE: round(1e3 * float(stroke["skin_x"].values[node]), 5),
                TIME: time_of(stroke),
                P: stroke[PRESSURE].values[:, node],
                SKIN_CURVATURE: 1e-3 * skin_curvature(stroke, node),
                ERROR: error,
            }
        )
        for place, node in zip(NODES, nodes_at(stroke), strict=True)
    ]
    return assemble(
        pd.concat(parts, ignore_index=True),
        axis_rows(reference, TIME, "T255"),
        axis_rows(reference, P, "T254"),
        axis_rows(reference, SKIN_CURVATURE, "T253"),
    )


@style.styled
def fig_5_10(frame: pd.DataFrame) -> Figure:
    """Nine panels: curvature (dashed, left axis) and pressure (solid, right axis)."""
    title = "Contact pressure and skin curvature at nine nodes, 10 mm/s"
    note = style.footnote(frame, f"{HOW}, centre pressure")
    fig = style.new_figure(frame, "5-10", title, 6.6, note=note, header=0.2)
    looks = {P: {"color": style.INK}, SKIN_CURVATURE: {"color": style.COLOURS["315"], "ls": (0, (4, 1.8)), "lw": 1.1}}
    panels = [f"X = {place:g} mm" for place in NODES]
    curvature, pressure = (_both(frame, column) for column in (SKIN_CURVATURE, P))
    for number, (panel, ax) in enumerate(style.nine_panels(fig, panels, "time (s)", "skin curvature (1/mm)").items()):
        rows = frame[frame["panel"] == panel]
        right = ax.twinx()
        ax.plot(rows[TIME], rows[SKIN_CURVATURE], **looks[SKIN_CURVATURE])
        right.plot(rows[TIME], rows[P], **looks[P])
        right.spines["right"].set_visible(True)
        style.limit_axis(ax, rows_of(frame, "panel", panel), TIME, "x")
        # zero pressure a third up, as the thesis sets the two apart
        right.set(ylim=(-0.75 * pressure[1], pressure[1]), yticks=[0, 5000, 10000])
        ax.set(title=panel, ylim=(curvature[0], -2.0 * curvature[0]), yticks=[-0.2, 0, 0.2])
        if number % 3:
            ax.tick_params(labelleft=False)
        if number % 3 < 2:
            right.tick_params(labelright=False)
        if number == 5:
            right.set_ylabel("contact pressure (Pa)")
    names = {P: "contact pressure (right axis)", SKIN_CURVATURE: "skin curvature (left axis)"}
    style.header_legend(fig, [Line2D([], [], label=names[k], **look) for k, look in looks.items()])
    return fig


def _both(frame: pd.DataFrame, column: str) -> tuple[float, float]:
    """Least and largest value of a column: of the thesis's range and the simulated data together."""
    return float(frame[column].min()), float(frame[column].max())


# --- 5-11 ----------------------------------------------------------------------------------------------


def frame_5_11(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Centre pressure and scaled skin curvature over time, all convexities, 10 mm/s."""
    columns = {TIME: time_of, P_CENTRE: centre_pressure, SCALED_CURVATURE: scaled_curvature}
    rows = stroke_rows(histories, coarse, {"10 mm/s": FULL["10"]}, columns)
    return assemble(
        pd.concat([surface_rows(histories[FULL["10"]], 0, 80), rows], ignore_index=True),
        axis_rows(reference, TIME, "T257"),
        axis_rows(reference, P_CENTRE, "T256"),
    )


@style.styled
def fig_5_11(frame: pd.DataFrame) -> Figure:
    """Centre pressure (solid) and scaled curvature (dashed) against time."""
    title = "Centre pressure and scaled skin curvature, 10 mm/s"
    fig = style.new_figure(frame, "5-11", title, 4.8, note=style.footnote(frame, HOW))
    top, ax = fig.subplots(2, 1, height_ratios=[0.55, 3.0])
    draw_surface(top, frame)
    top.set_xticks([])
    _draw_scaled(ax, _simulated(frame, "10 mm/s"), TIME)
    style.limit_axes(ax, _larger(frame), TIME, P_CENTRE)
    ax.set(xlabel="time (s)", ylabel="contact pressure at the centre (Pa)")
    ax.legend(loc="upper left", handlelength=2.6)
    return fig


# --- 5-12, 5-13, 5-24, 5-15 ----------------------------------------------------------------------------


def _speeds_frame(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, *,
    column: str, trace: Trace, ids: tuple[str, str], low: float = 0.0, names: Mapping[str, str] = FULL,
) -> pd.DataFrame:  # fmt: skip
    """A trace at several velocities against distance, from `low` (mm) on; `ids` are those of the two axes."""
    rows = stroke_rows(histories, coarse, by_speed(names), {column: trace})
    if column == SED:
        rows[RECEPTOR] = SHOWN_DEPTH * 1e6 if low == 0 else SHALLOW_DEPTH * 1e6
    return assemble(
        pd.concat([surface_rows(histories[names["10"]], low, 80), rows[rows[DISTANCE] >= low - 1e-9]], ignore_index=True),
        axis_rows(reference, DISTANCE, ids[0]),
        axis_rows(reference, column, ids[1]),
    )


def _stack(frame: pd.DataFrame, number: str, title: str, column: str, ylabel: str) -> Figure:
    """A panel a velocity under the surface."""
    fig, axes = below_surface(frame, number, title, 7.0, panels=len(SPEEDS))
    for speed, ax in zip(SPEEDS, axes, strict=True):
        series = f"{speed} mm/s"
        rows = _simulated(frame, series)
        ax.plot(rows[DISTANCE], rows[column], color=COLOURS[speed])
        style.limit_axis(ax, frame, column, text=speed == SPEEDS[len(SPEEDS) // 2])
        ax.text(0.008, 0.97, f"v = {series}", transform=ax.transAxes, va="top", fontsize=8)
    style.limit_axis(axes[-1], frame, DISTANCE, "x")
    axes[len(axes) // 2].set_ylabel(ylabel)
    axes[-1].set_xlabel("distance (mm)")
    return fig


frame_5_12 = partial(_speeds_frame, column=P_CENTRE, trace=centre_pressure, ids=("T260", "T259"))
frame_5_13 = partial(_speeds_frame, column=SED, trace=energy_at(SHOWN_DEPTH), ids=("T262", "T261"))
frame_5_24 = partial(_speeds_frame, column=SED, trace=energy_at(SHALLOW_DEPTH), ids=("T308", "T307"), low=40.0)


@style.styled
def fig_5_12(frame: pd.DataFrame) -> Figure:
    """Centre pressure at five velocities."""
    return _stack(frame, "5-12", "Centre pressure at five stroking velocities", P_CENTRE, "contact pressure at the centre (Pa)")


@style.styled
def fig_5_13(frame: pd.DataFrame) -> Figure:
    """Strain energy at 915 um at five velocities."""
    title = "Strain energy density 915 µm under the centre at five stroking velocities"
    return _stack(frame, "5-13", title, SED, "strain energy density (Pa)")


@style.styled
def fig_5_24(frame: pd.DataFrame) -> Figure:
    """Strain energy at 560 um at five velocities, from 40 mm on."""
    title = "Strain energy density 560 µm under the centre at five stroking velocities"
    return _stack(frame, "5-24", title, SED, "strain energy density (Pa)")


frame_5_15 = partial(
    _speeds_frame,
    column=LATERAL,
    trace=lambda stroke: lateral(stroke) * 1e3,
    ids=("T260", "T266b"),
    names={v: FULL[v] for v in SUB},
)


@style.styled
def fig_5_15(frame: pd.DataFrame) -> Figure:
    """Lateral displacement of the centre node at three velocities."""
    fig, (ax,) = below_surface(frame, "5-15", "Lateral displacement of the centre node", 4.8)
    _draw_speeds(ax, frame, LATERAL)
    style.limit_axis(ax, frame, DISTANCE, "x")
    style.limit_axis(ax, frame[frame[LATERAL] <= TOP_OF_STRETCH], LATERAL)
    ax.set(xlabel="distance (mm)", ylabel="lateral displacement (mm)", ylim=(None, TOP_OF_STRETCH))
    ax.text(2.0, TOP_OF_STRETCH - 0.02, "from 0 at the start,\noff the axis", va="top", fontsize=7, color=style.GREY)
    ax.legend(loc="upper right", ncols=3, handlelength=2.8)
    return fig


# --- 5-18 ----------------------------------------------------------------------------------------------

_PRESSED = tuple(label for label in SURFACES[1:] if float(label) <= 400)


def frame_5_18(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Largest strain energy at 915 um for each curvature: pressed by cylinders, and stroked at 10 mm/s."""
    peak = energy_at(SHOWN_DEPTH)
    rows = []
    for name in scenes("ramp40", _PRESSED):
        error = error_percent(histories[name], coarse.get(name), lambda d: float(peak(d).max()))
        curvature = scene_of(histories[name])["stimulus"]["curvature"]
        rows.append(("ramp and hold", curvature, float(peak(histories[name]).max()), error))
    history, read = histories[FULL["10"]], lambda stroke: peaks(stroke, peak)
    found, errors = read(loaded(history)), label_errors(history, coarse.get(FULL["10"]), read)
    rows += [("10 mm/s", arc.curvature, found[k], errors[k]) for k, arc in convexities(history).items() if k in found]
    return assemble(
        pd.DataFrame(rows, columns=["series", CURVATURE, SED, ERROR]),
        axis_rows(reference, CURVATURE, "T277"),
        axis_rows(reference, SED, "T276"),
    )


@style.styled
def fig_5_18(frame: pd.DataFrame) -> Figure:
    """Ramp and hold (solid) and stroking (dashed)."""
    fig = style.new_figure(frame, "5-18", "Largest strain energy density 915 µm under the centre", 4.4)
    ax = fig.subplots()
    looks = {"ramp and hold": {"ls": "-", "marker": "o", "color": style.INK},
             "10 mm/s": {"ls": (0, (4, 1.8)), "marker": "s", "color": style.COLOURS["315"]}}  # fmt: skip
    for series, look in looks.items():
        rows = _simulated(frame, series)
        name = series if series == "ramp and hold" else f"stroked at {series}"
        ax.plot(rows[CURVATURE], rows[SED], ms=4, label=name, **look)
    style.limit_axes(ax, frame, CURVATURE, SED)
    ax.set(xlabel="curvature (1/m)", ylabel="strain energy density (Pa)")
    ax.legend(loc="upper left", handlelength=3)
    return fig


_FULL = tuple(FULL.values())
FIGURES = (
    FigureSpec("5-4", "Length of each convexity in contact", _FULL, frame_5_4, fig_5_4),
    FigureSpec("5-5", "Pressure profiles, stepped", (STEPPED,),
               partial(_locations_frame, scene=STEPPED, pressure="T240"), fig_5_5),
    FigureSpec("5-6", "Pressure profiles, stroked", (SUB["10"],),
               partial(_locations_frame, scene=SUB["10"], pressure="T241"), fig_5_6),
    FigureSpec("5-7", "Centre pressure and skin curvature, stepped", (STEPPED,), frame_5_7, fig_5_7),
    FigureSpec("5-8", "Centre pressure, stepped and stroked", (STEPPED, SUB["10"]), frame_5_8, fig_5_8),
    FigureSpec("5-9", "Centre pressure at three velocities", tuple(SUB.values()), frame_5_9, fig_5_9),
    FigureSpec("5-10", "Pressure and skin curvature at nine nodes", (SUB["10"],), frame_5_10, fig_5_10),
    FigureSpec("5-11", "Centre pressure and skin curvature, all convexities", (FULL["10"],), frame_5_11, fig_5_11),
    FigureSpec("5-12", "Centre pressure at five velocities", _FULL, frame_5_12, fig_5_12),
    FigureSpec("5-13", "Strain energy at five velocities", _FULL, frame_5_13, fig_5_13),
    FigureSpec("5-15", "Lateral displacement of the centre", tuple(FULL[v] for v in SUB), frame_5_15, fig_5_15),
    FigureSpec("5-18", "Largest strain energy, pressed and stroked",
               (*scenes("ramp40", _PRESSED), FULL["10"]), frame_5_18, fig_5_18),
    FigureSpec("5-24", "Strain energy at 560 um at five velocities", _FULL, frame_5_24, fig_5_24),
)  # fmt: skip

"""Chapter 4: ramp-and-hold indentation by nine surfaces: shape, contact, pressure and strain energy.

Each figure has a frame function (histories -> tidy data) and a draw function (data -> picture). Axes, panels
and line styles follow the thesis (Cysyk 1999), so that a picture can be laid beside the original.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fingerpad.figures.spec import FigureSpec, assemble, axis_rows, rows_of
from fingerpad.measures.features import (
    ERROR,
    PHASES,
    PRESSURE,
    PRESSURE_SCALE,
    STEADY,
    SURFACES,
    TOP,
    Feature,
    Histories,
    Meshes,
    at_ends,
    centre_node,
    centre_pressure,
    depth,
    energy,
    energy_rate,
    error_percent,
    force_gf,
    in_contact,
    is_simulated,
    peak_pressure,
    phase_indices,
    profile,
    ramp_end,
    scene_name,
    scenes,
    surface_nodes,
    width,
)
from fingerpad.measures.quantities import DEPTH, FORCE, NODE, P_CENTRE, P_PEAK, RATE, RECEPTOR, SED, TIME, WIDTH, P, X, Y
from fingerpad.measures.responses import DEPTHS
from fingerpad.publishing import style

SHOWN_DEPTH = 915e-6  # m, the receptor depth of Figs 4-21, 4-23, 4-28
PROFILE_SURFACES = ("flat", "158", "1260")
shown_energy = partial(energy, depth=SHOWN_DEPTH)

PRESSURE_AXES = dict(zip(SURFACES, [f"T{i}" for i in range(125, 134)], strict=True))
DISPLACEMENT_AXES = {
    "flat": "T138",
    "79": "T126",  # of Fig 4-11: only a tick at 5000 Pa is legible in Fig 4-13 itself (T139)
    "105": "T127",
    **{k: "T140" for k in ("158", "210", "315")},
    **{k: "T141" for k in ("420", "630")},
    "1260": "T142",
}
WIDTH_RANGES = dict(zip(SURFACES, ["T106", "T108", "T110", "T112", "T114", "T115", "T116", "T118", "T120"], strict=True))
ENERGY_AXES = {
    "flat": "T173",
    "79": "T174",
    "105": "T175",
    "210": "T176",
    "315": "T177a",
    "420": "T177b",
    "630": "T178",
    "1260": "T179",
}
DEPTH_AXES = dict(
    zip(
        (f"{d * 1e6:.0f}" for d in DEPTHS),
        ["T192", "T193", "T194", "T195", "T196", "T197", "T198a", "T198b", "T198c"],
        strict=True,
    )
)


# --- helpers -------------------------------------------------------------------------------------------


def _traces(
    histories: Histories,
    coarse: Histories,
    columns: dict[str, Callable[[xr.Dataset], np.ndarray]],
    errors: tuple[Feature, ...],
    labels: tuple[str, ...] = SURFACES,
) -> pd.DataFrame:
    """One row an output time and surface: time, the columns, and the error of the surface's trace."""
    parts = []
    for label in labels:
        name = scene_name("ramp40", label)
        history = histories[name]
        part = {"surface": label, TIME: history["time"].values}
        part |= {column: read(history) for column, read in columns.items()}
        part[ERROR] = error_percent(history, coarse.get(name), *errors)
        parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True)


def _profiles(
    histories: Histories,
    coarse: Histories,
    programme: str,
    labels: tuple[str, ...],
    half: bool = False,
) -> pd.DataFrame:
    """Pressure over the contact at the shown outputs: one row a node, at its deformed position."""
    parts = []
    for label in labels:
        name = scene_name(programme, label)
        parts.append(_profile_rows(histories[name], coarse.get(name), half).assign(surface=label))
    return pd.concat(parts, ignore_index=True)


def _profile_rows(history: xr.Dataset, coarse: xr.Dataset | None, half: bool = False) -> pd.DataFrame:
    error = error_percent(history, coarse, *at_ends(peak_pressure))
    parts = []
    for index, phase in phase_indices(history):
        x, p = profile(history, index)
        down = -history["skin_displacement_y"].values[index]
        keep = in_contact(history, index)
        if half:
            keep &= np.arange(len(x)) >= centre_node(history)
        parts.append(
            pd.DataFrame(
                {
                    "phase": phase,
                    TIME: history["time"].values[index],
                    X: x[keep] * 1e3,
                    "vertical_displacement (mm)": down[keep] * 1e3,
                    P: p[keep],
                    ERROR: error,
                }
            )
        )
    return pd.concat(parts, ignore_index=True)


def _draw_phases(ax: Axes, rows: pd.DataFrame, x: str, y: str, colour: object) -> None:
    """Curves of one panel, one a time, styled by phase (earlier ones below)."""
    rows = rows[is_simulated(rows)]
    for (phase, _), curve in sorted(rows.groupby(["phase", TIME]), key=lambda item: PHASES.index(item[0][0])):
        ax.plot(curve[x], curve[y], color=colour, **style.PHASE_LINES[phase])


def _draw_traces(ax: Axes, frame: pd.DataFrame, column: str, x_label: float | None = None, heading: str = "") -> None:
    """Nine traces against time in the colours of their surfaces, labelled at `x_label` if given."""
    ends = {}
    for label in SURFACES:
        rows = frame[(frame["surface"] == label) & is_simulated(frame)]
        ax.plot(rows[TIME], rows[column], color=style.COLOURS[label])
        ends[label] = (rows[TIME].iloc[-1], rows[column].iloc[-1])
    if x_label is not None:
        style.label_ends(ax, ends, x_label, heading)


def _one_panel(frame: pd.DataFrame, number: str, title: str, column: str, ylabel: str, x_label: float) -> Figure:
    """A figure of one panel with nine direct-labelled traces against time."""
    fig = style.new_figure(frame, number, title, height=4.6)
    ax = fig.subplots()
    style.limit_axes(ax, frame, TIME, column)
    ax.set(xlabel="time (s)", ylabel=ylabel)
    _draw_traces(ax, frame, column, x_label, "curvature (1/m)")
    return fig


# --- 4-6 -----------------------------------------------------------------------------------------------


def frame_4_6(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Deformed skin at the top of the ramp and in steady state: the upper side, one row a node."""
    parts = []
    for label in SURFACES:
        name = scene_name("ramp40", label)
        history = histories[name]
        error = error_percent(history, coarse.get(name), *at_ends(depth))
        for index, phase in phase_indices(history)[-2:]:
            x = history["skin_x"].values + history["skin_displacement_x"].values[index]
            y = history["skin_y"].values + history["skin_displacement_y"].values[index]
            keep = history["skin_y"].values > 0
            parts.append(
                pd.DataFrame(
                    {
                        "surface": label,
                        "phase": phase,
                        X: x[keep] * 1e3,
                        Y: y[keep] * 1e3,
                        ERROR: error,
                    }
                )
            )
    return assemble(
        pd.concat(parts, ignore_index=True),
        axis_rows(reference, X, "T100"),
        axis_rows(reference, Y, "T101"),
    )


@style.styled
def fig_4_6(frame: pd.DataFrame) -> Figure:
    """Surface profile, nine panels."""
    title = "Skin profile at the top of the ramp and in steady state, 20 gf"
    fig = style.new_figure(frame, "4-6", title, 6.6, header=0.2)
    axes = style.nine_panels(fig, SURFACES, "x (mm)", Y)
    for label, ax in axes.items():
        rows = rows_of(frame, "surface", label)
        for phase in (STEADY, TOP):
            curve = rows[rows["phase"] == phase]
            ax.plot(curve[X], curve[Y], color=style.COLOURS[label], **style.PHASE_LINES[phase])
        style.limit_axis(ax, rows, X, "x")
        style.limit_axis(ax, rows[~is_simulated(rows)], Y)
        ax.set(title=style.surface_name(label), xticks=[-10, 0, 10], yticks=[3, 4, 5, 6])
    style.phase_legend(fig, (TOP, STEADY))
    return fig


# --- 4-7, 4-8 ------------------------------------------------------------------------------------------


def frame_4_7(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Indentation depth against time."""
    rows = _traces(
        histories,
        coarse,
        {DEPTH: lambda d: depth(d) * 1e3},
        at_ends(depth),
    )
    return assemble(rows, axis_rows(reference, TIME, "T103"), axis_rows(reference, DEPTH, "T102"))


@style.styled
def fig_4_7(frame: pd.DataFrame) -> Figure:
    """Indentation depth, nine traces."""
    return _one_panel(
        frame,
        "4-7",
        "Indentation depth, 40 gf/s ramp to 20 gf, 2 s hold",
        DEPTH,
        "indentation depth (mm)",
        2.62,
    )


def frame_4_8(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Contact width against time, and the ranges of width that the axes of Fig 4-9 imply for the hold."""
    rows = _traces(histories, coarse, {WIDTH: lambda d: width(d) * 1e3}, at_ends(width))
    implied = axis_rows(reference, "inverse", WIDTH_RANGES)
    if not implied.empty:
        implied[WIDTH] = 1 / implied.pop("inverse")
        implied["source"] = implied["source"].str.replace("thesis axis range", "thesis range of Fig 4-9")
    return assemble(rows, axis_rows(reference, TIME, "T105"), axis_rows(reference, WIDTH, "T104"), implied)


@style.styled
def fig_4_8(frame: pd.DataFrame) -> Figure:
    """Contact width, nine traces, with the thesis's ranges for the hold as brackets on the right."""
    fig = _one_panel(frame, "4-8", "Contact width, 40 gf/s ramp to 20 gf, 2 s hold", WIDTH, "contact width (mm)", 2.54)
    ax = fig.axes[0]
    ranges = frame[frame["source"].str.startswith("thesis range of Fig 4-9")]
    for column, (label, ends) in enumerate(ranges.groupby("surface", sort=False)[WIDTH]):
        x = 2.935 + 0.025 * (column % 3)
        ax.plot(
            [x, x],
            [ends.min(), ends.max()],
            color=style.COLOURS[label],
            lw=3.5,
            alpha=0.4,
            solid_capstyle="butt",
        )
    if not ranges.empty:
        text = "bars: range of the hold on\nthe axes of thesis Fig. 4-9"
        ax.text(2.99, 5.45, text, ha="right", va="bottom", fontsize=7, color=style.GREY)
    return fig


# --- 4-10 ----------------------------------------------------------------------------------------------


def frame_4_10(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Force and pressure at the centre against time."""
    columns = {FORCE: force_gf, P_CENTRE: centre_pressure}
    return assemble(
        _traces(histories, coarse, columns, at_ends(centre_pressure)),
        axis_rows(reference, TIME, "T124"),
        axis_rows(reference, FORCE, "T122"),
        axis_rows(reference, P_CENTRE, "T123"),
    )


@style.styled
def fig_4_10(frame: pd.DataFrame) -> Figure:
    """Force trace above, centre pressure below."""
    fig = style.new_figure(frame, "4-10", "Contact pressure at the centre of the fingerpad", 6.6)
    upper, lower = fig.subplots(2, 1, sharex=True, height_ratios=[1, 3.2])
    flat = frame[frame["surface"] == "flat"]
    upper.plot(flat[TIME], flat[FORCE], color=style.INK)
    style.limit_axis(upper, frame, FORCE)
    upper.set(ylabel="force (gf)", yticks=[0, 10, 20, 30])
    style.limit_axes(lower, frame, TIME, P_CENTRE)
    lower.set(xlabel="time (s)", ylabel="contact pressure at the centre (Pa)")
    _draw_traces(lower, frame, P_CENTRE, 2.62, "curvature (1/m)")
    return fig


# --- 4-11, 4-12, 4-13, 4-14 ----------------------------------------------------------------------------


def frame_4_11(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure over the contact during the ramp, at its top and in steady state."""
    rows = _profiles(histories, coarse, "ramp40", SURFACES).drop(columns="vertical_displacement (mm)")
    return assemble(rows, axis_rows(reference, X, "T134"), axis_rows(reference, P, PRESSURE_AXES))


@style.styled
def fig_4_11(frame: pd.DataFrame) -> Figure:
    """Pressure distribution, nine panels."""
    fig = style.new_figure(frame, "4-11", "Contact pressure across the contact region", 6.8, header=0.2)
    axes = style.nine_panels(fig, SURFACES, "horizontal location (mm)", "contact pressure (Pa)")
    for label, ax in axes.items():
        rows = rows_of(frame, "surface", label)
        style.limit_axes(ax, rows, X, P)
        _draw_phases(ax, rows, X, P, style.COLOURS[label])
        ax.set_title(style.surface_name(label))
    style.phase_legend(fig)
    return fig


def frame_4_12(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure under the flat plate on the homogeneous and on the layered pad."""
    pads = {"homogeneous": "homogeneous_flat", "layered": "ramp40_flat"}
    rows = [_profile_rows(histories[name], coarse.get(name)).assign(pad=pad) for pad, name in pads.items()]
    return assemble(
        pd.concat(rows, ignore_index=True).drop(columns="vertical_displacement (mm)"),
        axis_rows(reference, X, "T137"),
        axis_rows(reference, P, {"homogeneous": "T135", "layered": "T136"}, key="pad"),
    )


@style.styled
def fig_4_12(frame: pd.DataFrame) -> Figure:
    """Flat plate, (a) homogeneous and (b) layered pad."""
    title = "Flat plate: pressure on a homogeneous and on the layered pad"
    fig = style.new_figure(frame, "4-12", title, 6.3, header=0.2)
    axes = fig.subplots(2, 1)
    for ax, tag, pad in zip(axes, "ab", ("homogeneous", "layered"), strict=True):
        rows = rows_of(frame, "pad", pad)
        style.limit_axes(ax, rows, X, P)
        _draw_phases(ax, rows, X, P, style.COLOURS["flat"])
        ax.set(xlabel="x (mm)", ylabel="contact pressure (Pa)", title=f"({tag}) {pad} pad")
    style.phase_legend(fig)
    return fig


def frame_4_13(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure against vertical displacement of the contact nodes (right half), one curve a depth."""
    rows = _profiles(histories, coarse, "ramp40", SURFACES, half=True).drop(columns=X)
    across = {k: "T143" if k in ("flat", "79", "105") else "T144" for k in SURFACES}
    return assemble(
        rows,
        axis_rows(reference, "vertical_displacement (mm)", across),
        axis_rows(reference, P, DISPLACEMENT_AXES),
    )


@style.styled
def fig_4_13(frame: pd.DataFrame) -> Figure:
    """Pressure against vertical displacement, nine panels."""
    title = "Contact pressure against vertical displacement of every contact node"
    fig = style.new_figure(frame, "4-13", title, 6.8, header=0.2)
    axes = style.nine_panels(fig, SURFACES, "vertical displacement (mm)", "contact pressure (Pa)")
    for label, ax in axes.items():
        rows = rows_of(frame, "surface", label)
        style.limit_axes(ax, rows, "vertical_displacement (mm)", P)
        _draw_phases(ax, rows, "vertical_displacement (mm)", P, style.COLOURS[label])
        ax.set(title=style.surface_name(label), xticks=np.arange(0, ax.get_xlim()[1] + 0.1, 0.5))
    style.phase_legend(fig)
    return fig


def frame_4_14(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Half of the pressure profile over time for K = 210 1/m, and the thesis's critical distance."""
    rows = _profiles(histories, coarse, "ramp40", ("210",), half=True).drop(columns="vertical_displacement (mm)")
    critical = pd.DataFrame()
    if "T147" in reference.index:
        edge = width(histories["ramp40_k210"])[-1] * 1e3 / 2
        critical = pd.DataFrame(
            {"source": "distance stated in the thesis (T147)", X: [edge - reference.loc["T147", "low"], edge]}
        )
    return assemble(rows, axis_rows(reference, X, "T146"), axis_rows(reference, P, "T145"), critical)


@style.styled
def fig_4_14(frame: pd.DataFrame) -> Figure:
    """Half profile, K = 210 1/m."""
    title = "Pressure from the centre outwards over time, K = 210 1/m"
    fig = style.new_figure(frame, "4-14", title, 4.7, header=0.2)
    ax = fig.subplots()
    style.limit_axes(ax, frame, X, P)
    _draw_phases(ax, frame, X, P, style.COLOURS["210"])
    ax.set(xlabel="distance from the centre (mm)", ylabel="contact pressure (Pa)")
    critical = frame.loc[frame["source"].str.startswith("distance stated"), X]
    if not critical.empty:
        y = 0.045 * ax.get_ylim()[1]
        ends = {"arrowstyle": "|-|,widthA=.3,widthB=.3", "color": style.GREY, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (critical.min(), y), (critical.max(), y), arrowprops=ends)
        text = f"{np.ptp(critical):.1f} mm from the edge:\ncritical distance\nstated in the thesis"
        ax.text(critical.max() + 0.02, y, text, ha="left", va="bottom", fontsize=7, color=style.GREY)
    style.phase_legend(fig)
    return fig


# --- 4-15, 4-16 ----------------------------------------------------------------------------------------


def frame_4_15(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Largest pressure and pressure at the centre for K = 210 1/m."""
    columns = {P_PEAK: peak_pressure, P_CENTRE: centre_pressure}
    errors = (*at_ends(peak_pressure), *at_ends(centre_pressure))
    return assemble(
        _traces(histories, coarse, columns, errors, ("210",)),
        axis_rows(reference, TIME, "T149"),
        axis_rows(reference, P_PEAK, "T148"),
    )


@style.styled
def fig_4_15(frame: pd.DataFrame) -> Figure:
    """Maximum (solid) and centre (dashed) pressure."""
    fig = style.new_figure(frame, "4-15", "Maximum and centre pressure, K = 210 1/m", 4.2)
    ax = fig.subplots()
    rows = frame[is_simulated(frame)]
    ax.plot(rows[TIME], rows[P_PEAK], color=style.COLOURS["210"], label="maximum")
    ax.plot(rows[TIME], rows[P_CENTRE], color=style.COLOURS["210"], label="centre node", **style.PHASE_LINES[TOP])
    style.limit_axes(ax, frame, TIME, P_PEAK)
    ax.set(xlabel="time (s)", ylabel="contact pressure (Pa)")
    ax.legend(loc="lower right", handlelength=2.6)
    return fig


def frame_4_16(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure against time at each skin node of the right half that ever touches, K = 210 1/m."""
    name = scene_name("ramp40", "210")
    history = histories[name]
    nodes = surface_nodes(history)
    rows = pd.DataFrame(
        {
            NODE: np.repeat((history["skin_x"].values[nodes] * 1e3).round(5), history.sizes["time"]),
            TIME: np.tile(history["time"].values, len(nodes)),
            P: history[PRESSURE].values[:, nodes].T.ravel(),
        }
    )
    rows[ERROR] = error_percent(history, coarse.get(name), *at_ends(centre_pressure))
    return assemble(rows, axis_rows(reference, TIME, "T151"), axis_rows(reference, P, "T150"))


@style.styled
def fig_4_16(frame: pd.DataFrame) -> Figure:
    """One trace a contact node, the centre solid."""
    fig = style.new_figure(frame, "4-16", "Pressure at each node of the contact region, K = 210 1/m", 4.6)
    ax = fig.subplots()
    rows = frame[is_simulated(frame)]
    for x, trace in rows.groupby(NODE):
        centre = abs(x) < 1e-6
        line = style.PHASE_LINES[STEADY if centre else PHASES[0]]
        ax.plot(trace[TIME], trace[P], color=style.COLOURS["210"], label="centre node" if centre else None, **line)
    style.limit_axes(ax, frame, TIME, P)
    ax.set(xlabel="time (s)", ylabel="contact pressure (Pa)")
    handles = ax.get_legend_handles_labels()[0]
    other = ax.plot([], [], color=style.COLOURS["210"], **style.PHASE_LINES[PHASES[0]])
    spacing = np.diff(np.sort(rows[NODE].unique())).mean()
    ax.legend(
        [*handles, *other],
        ["centre node", f"other nodes, about {spacing * 1e3:.0f} µm apart"],
        loc="upper right",
    )
    return fig


# --- 4-20 ----------------------------------------------------------------------------------------------


def frame_4_20(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure and strain energy profiles at the top of the 150 gf/s ramp and in steady state."""
    parts = [
        _profiles(histories, coarse, "ramp150", PROFILE_SURFACES)
        .query("phase != @PHASES[0]")
        .drop(columns="vertical_displacement (mm)")
        .assign(panel="pressure")
    ]
    for label in PROFILE_SURFACES:
        name = scene_name("ramp150", label)
        history = histories[name]
        for z in (800e-6, 915e-6):
            error = error_percent(history, coarse.get(name), *at_ends(partial(energy, depth=z)))
            row = np.flatnonzero(abs(history["receptor_depth"].values - z) < 1e-6)
            row = row[np.argsort(history["receptor_offset"].values[row])]
            for index, phase in ((ramp_end(history), TOP), (history.sizes["time"] - 1, STEADY)):
                parts.append(
                    pd.DataFrame(
                        {
                            "surface": label,
                            "panel": f"{z * 1e6:.0f} um",
                            "phase": phase,
                            TIME: history["time"].values[index],
                            X: history["receptor_offset"].values[row] * 1e3,
                            SED: history["strain_energy_density"].values[index, row],
                            ERROR: error,
                        }
                    )
                )
    marks = [
        axis_rows(reference, column, dict(zip(PROFILE_SURFACES, ids, strict=True))).assign(panel=panel)
        for panel, column, ids in (
            ("pressure", P, ("T165a", "T165b", "T165c")),
            ("800 um", SED, ("T166", "T167", "T168")),
            ("915 um", SED, ("T169", "T170", "T171")),
        )
    ]
    return assemble(pd.concat(parts, ignore_index=True), *marks)


@style.styled
def fig_4_20(frame: pd.DataFrame) -> Figure:
    """Pressure above, strain energy at two depths below, three surfaces across."""
    title = "Pressure and strain energy profiles, 150 gf/s ramp to 20 gf"
    fig = style.new_figure(frame, "4-20", title, 7.0, header=0.2)
    axes = fig.subplots(3, 3)
    ticks = {"flat": (-5, 0, 5), "158": (-4, -2, 0, 2, 4), "1260": (-2, 0, 2)}
    titles = {
        "pressure": "contact pressure (Pa)",
        "800 um": "strain energy density (Pa)\n800 µm, epidermis",
        "915 um": "strain energy density (Pa)\n915 µm, dermis",
    }
    for row, (panel, ylabel) in zip(axes, titles.items(), strict=True):
        for ax, label in zip(row, PROFILE_SURFACES, strict=True):
            rows = rows_of(rows_of(frame, "panel", panel), "surface", label)
            column = P if panel == "pressure" else SED
            style.limit_axis(ax, rows, column)
            _draw_phases(ax, rows, X, column, style.COLOURS[label])
            ax.set(xlim=(ticks[label][0], ticks[label][-1]), xticks=ticks[label])
        row[0].set_ylabel(ylabel)
    for ax, label in zip(axes[0], PROFILE_SURFACES, strict=True):
        ax.set_title(style.surface_name(label))
    for ax in axes[-1]:
        ax.set_xlabel("x (mm)")
    style.phase_legend(fig, (TOP, STEADY))
    return fig


# --- 4-21, 4-23, 4-24, 4-28 ----------------------------------------------------------------------------


def frame_4_21(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy at 915 um and centre pressure times 0.04."""
    scaled = "scaled_centre_pressure (Pa)"
    columns = {
        SED: shown_energy,
        scaled: lambda d: PRESSURE_SCALE * centre_pressure(d),
    }
    rows = _traces(histories, coarse, columns, (*at_ends(shown_energy), *at_ends(centre_pressure)))
    return assemble(rows, axis_rows(reference, SED, ENERGY_AXES))


@style.styled
def fig_4_21(frame: pd.DataFrame) -> Figure:
    """Strain energy (solid) and scaled pressure (dashed), nine panels."""
    scaled = "scaled_centre_pressure (Pa)"
    title = f"Strain energy density at 915 µm and contact pressure × {PRESSURE_SCALE}, centre"
    fig = style.new_figure(frame, "4-21", title, 6.8, header=0.2)
    axes = style.nine_panels(fig, SURFACES, "time (s)", f"strain energy density, contact pressure × {PRESSURE_SCALE} (Pa)")
    for label, ax in axes.items():
        rows = rows_of(frame, "surface", label)
        both = rows.assign(**{SED: rows[[SED, scaled]].max(axis=1)})
        style.limit_axis(ax, both, SED)
        solid, dashed = style.PHASE_LINES[STEADY], style.PHASE_LINES[TOP]
        ax.plot(rows[TIME], rows[SED], color=style.COLOURS[label], label="strain energy density", **solid)
        ax.plot(rows[TIME], rows[scaled], color=style.COLOURS[label], label="scaled pressure", **dashed)
        ax.set(title=style.surface_name(label), xlim=(0, 2.5), xticks=[0, 1, 2])
    handles = [Line2D([], [], color=style.INK, label=line.get_label(), **look)
               for line, look in zip(axes["flat"].lines, (solid, dashed), strict=True)]  # fmt: skip
    style.header_legend(fig, handles)
    return fig


def frame_4_23(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy at 915 um against time."""
    rows = _traces(histories, coarse, {SED: shown_energy}, at_ends(shown_energy))
    return assemble(rows, axis_rows(reference, TIME, "T189"), axis_rows(reference, SED, "T188"))


@style.styled
def fig_4_23(frame: pd.DataFrame) -> Figure:
    """Strain energy at 915 um, nine traces."""
    title = "Strain energy density 915 µm under the centre"
    return _one_panel(frame, "4-23", title, SED, "strain energy density (Pa)", 2.62)


def frame_4_24(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy at nine depths against time."""
    parts = [
        _traces(histories, coarse, {SED: partial(energy, depth=z)}, at_ends(partial(energy, depth=z))).assign(
            **{RECEPTOR: round(z * 1e6)}
        )
        for z in DEPTHS
    ]
    marks = axis_rows(reference, SED, DEPTH_AXES, key=RECEPTOR)
    if not marks.empty:
        marks[RECEPTOR] = marks[RECEPTOR].astype(int)
    return assemble(pd.concat(parts, ignore_index=True), marks)


@style.styled
def fig_4_24(frame: pd.DataFrame) -> Figure:
    """Strain energy at nine depths, nine traces each."""
    fig = style.new_figure(frame, "4-24", "Strain energy density at nine depths under the centre", 7.2, header=0.22)
    depths = sorted(frame[RECEPTOR].unique())
    axes = style.nine_panels(fig, depths, "time (s)", "strain energy density (Pa)")
    for z, ax in axes.items():
        rows = frame[frame[RECEPTOR] == z]
        style.limit_axis(ax, rows, SED)
        _draw_traces(ax, rows, SED)
        layer = "epidermis" if z < 850 else "dermis"
        ax.set(title=f"{z:.0f} µm ({layer})", xlim=(0, 2.5), xticks=[0, 1, 2])
    for label, line in zip(SURFACES, ax.lines, strict=False):
        line.set_label("flat plate" if label == "flat" else f"{label} 1/m")
    style.header_legend(fig, ax.lines[: len(SURFACES)], handlelength=1.0, columnspacing=1.2, fontsize=7)
    return fig


def frame_4_28(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Rate of the strain energy at 915 um against time (see `energy_rate` for the differences taken)."""
    parts = []
    for label in SURFACES:
        name = scene_name("ramp40", label)
        error = error_percent(histories[name], coarse.get(name), lambda d: float(energy_rate(d, SHOWN_DEPTH)[RATE].max()))
        parts.append(energy_rate(histories[name], SHOWN_DEPTH).assign(surface=label, **{ERROR: error}))
    return assemble(
        pd.concat(parts, ignore_index=True),
        axis_rows(reference, TIME, "T206"),
        axis_rows(reference, RATE, "T205"),
    )


@style.styled
def fig_4_28(frame: pd.DataFrame) -> Figure:
    """Strain energy rate, nine traces labelled in the ramp."""
    fig = style.new_figure(frame, "4-28", "Rate of strain energy density 915 µm under the centre", 4.8)
    ax = fig.subplots()
    style.limit_axes(ax, frame, TIME, RATE)
    ends = {}
    for label in SURFACES:
        rows = frame[(frame["surface"] == label) & is_simulated(frame)].reset_index(drop=True)
        jump = int(np.flatnonzero(np.diff(rows[TIME]) == 0)[0]) + 1
        for leg in (rows[:jump], rows[jump:]):
            ax.plot(leg[TIME], leg[RATE], color=style.COLOURS[label])
        ax.plot(
            rows.loc[jump - 1 : jump, TIME],
            rows.loc[jump - 1 : jump, RATE],
            color=style.GREY,
            lw=0.5,
            zorder=1,
        )
        ends[label] = tuple(rows.loc[jump - 1, [TIME, RATE]])
    style.label_ends(ax, ends, ends["flat"][0] * 1.3, "curvature (1/m)")
    ax.set(xlabel="time (s)", ylabel="strain energy rate (Pa/s)")
    lowest = frame.loc[is_simulated(frame), RATE].min()
    text = f"hold: rates below zero (to {lowest:.0f} Pa/s), off the axis"
    ax.text(1.75, 60, text, ha="center", fontsize=7, color=style.GREY)
    return fig


_NINE = scenes("ramp40")
FIGURES = (
    FigureSpec("4-6", "Surface profiles", _NINE, frame_4_6, fig_4_6),
    FigureSpec("4-7", "Indentation depth", _NINE, frame_4_7, fig_4_7),
    FigureSpec("4-8", "Contact width", _NINE, frame_4_8, fig_4_8),
    FigureSpec("4-10", "Centre pressure with the force trace", _NINE, frame_4_10, fig_4_10),
    FigureSpec("4-11", "Pressure distribution over time", _NINE, frame_4_11, fig_4_11),
    FigureSpec("4-12", "Homogeneous and layered pad", ("homogeneous_flat", "ramp40_flat"), frame_4_12, fig_4_12),
    FigureSpec("4-13", "Pressure against vertical displacement", _NINE, frame_4_13, fig_4_13),
    FigureSpec("4-14", "Half pressure profile, K = 210 1/m", ("ramp40_k210",), frame_4_14, fig_4_14),
    FigureSpec("4-15", "Maximum and centre pressure, K = 210 1/m", ("ramp40_k210",), frame_4_15, fig_4_15),
    FigureSpec("4-16", "Pressure at each node, K = 210 1/m", ("ramp40_k210",), frame_4_16, fig_4_16),
    FigureSpec(
        "4-20",
        "Pressure and strain energy profiles",
        scenes("ramp150", PROFILE_SURFACES),
        frame_4_20,
        fig_4_20,
    ),
    FigureSpec("4-21", "Strain energy and centre pressure", _NINE, frame_4_21, fig_4_21),
    FigureSpec("4-23", "Strain energy over time", _NINE, frame_4_23, fig_4_23),
    FigureSpec("4-24", "Strain energy at nine depths", _NINE, frame_4_24, fig_4_24),
    FigureSpec("4-28", "Strain energy rate", _NINE, frame_4_28, fig_4_28),
)

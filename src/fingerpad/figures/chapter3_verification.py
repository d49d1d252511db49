"""Chapter 3: the model's surface profiles, forces and layer boundaries, beside the measurements there are.

The thesis compares with recordings of single subjects and with MRI sections. Those are not available and nothing is drawn
in their place: Figs 3-6 and 3-7 carry published measurements of other or partly the same subjects, the others the model alone.
"""

from __future__ import annotations

import textwrap
from functools import partial

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fingerpad.figures.chapter3 import boundaries, densify, inward, stratum_corneum
from fingerpad.figures.spec import FigureSpec, assemble, axis_rows
from fingerpad.measures.features import ERROR, Histories, Meshes, error_percent, is_simulated, ramp_end, scene_of
from fingerpad.measures.steady import (
    BAR,
    DEPTH_SCENES,
    PLATE,
    PROFILES,
    SPEED_SCENES,
    force_N,
    leg_end,
    leg_of,
    pressed_depths,
    steady_force,
)
from fingerpad.publishing import style
from fingerpad.specimen.mesh import PadMesh
from fingerpad.stimuli.profiles import Bar, Cylinder

X, Y, DEFLECTION = "x (mm)", "y (mm)", "deflection (mm)"
TIME, DEPTH, FORCE = "time (s)", "indentation_depth (mm)", "force (N)"

SECTIONS = {
    "no load": (BAR, 0.0),
    "1/8 inch cylinder, 1 mm": ("steady_cylinder_1_8_inch", 1e-3),
    "1/4 inch cylinder, 1 mm": ("steady_cylinder_1_4_inch", 1e-3),
    "1 inch cylinder, 1 mm": ("steady_cylinder_1_inch", 1e-3),
    "1/16 inch bar, 1 mm": (BAR, 1e-3),
    "1/16 inch bar, 2 mm": (BAR, 2e-3),
}
"""Panels of Fig 3-11: scene and depth (m)."""

SHOWN = 7.5  # mm, half of the surface shown: beyond it the flanks are too steep for a deflection at a distance
SHADES = ("#c8553d", "#1f77a4", "#3c8d5a", "#8a4fbf")
MARKERS = "os^D"
STATE_LINES = {"undeformed": {"ls": (0, (3, 2)), "lw": 0.8, "color": style.GREY}, "deformed": {"ls": "-", "lw": 1.3}}
MODEL = "Lines: simulated in plane strain, not measured."
NOT_AVAILABLE = "The recordings of subjects that Cysyk (1999) shows here are not available: the model stands alone."


# --- helpers -------------------------------------------------------------------------------------------


def surface_deflection(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Lateral position (m) on the deformed skin and height there over the undeformed skin at that place (m)."""
    x, y = history["skin_x"].values, history["skin_y"].values
    upper = np.flatnonzero(y > 0)
    moved_x = x[upper] + history["skin_displacement_x"].values[index, upper]
    moved_y = y[upper] + history["skin_displacement_y"].values[index, upper]
    return moved_x, moved_y - np.interp(moved_x, x[upper], y[upper])


def _deflection_at(place: float):
    """Feature: deflection (m) at a lateral distance (m) at the end of the motion."""

    def feature(history: xr.Dataset) -> float:
        x, deflection = surface_deflection(history, history.sizes["time"] - 1)
        return float(np.interp(place, x, deflection))

    return feature


def _clip(frame: pd.DataFrame, column: str, limit: float) -> pd.DataFrame:
    return frame[frame[column].abs() <= limit]


def _shade(names) -> dict[str, str]:
    return dict(zip(names, SHADES, strict=False))


def measured_source(rows: pd.DataFrame) -> str:
    """One word for all: where measured rows come from."""
    return "measured (" + "; ".join(rows["source"].drop_duplicates()) + "; digitised by a third party)"


# --- 3-6 -----------------------------------------------------------------------------------------------


def frame_3_6(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, measured: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Deflection of the skin in the steady state at several depths of three indenters, and measured ones."""
    parts, points = [], []
    for panel, scene in PROFILES.items():
        history = histories[scene]
        error = error_percent(history, coarse.get(scene), *(_deflection_at(x * 1e-3) for x in (0.5, 1.0, 2.0)))
        depths = pressed_depths(history)
        for depth in depths:
            x, deflection = surface_deflection(history, leg_end(history, depth))
            curve = pd.DataFrame({"panel": panel, "series": f"{depth * 1e3:g} mm", X: x * 1e3, DEFLECTION: deflection * 1e3})
            parts.append(_clip(curve, X, SHOWN).assign(**{ERROR: error}))
        if measured is None or "cylinder" not in panel:
            continue
        diameter = float(panel.split()[1])
        rows = measured[np.isclose(measured["diameter_mm"], diameter)]
        rows = rows[[bool(np.isclose(d, np.array(depths) * 1e3).any()) for d in rows["depth_mm"]]]
        points.append(
            pd.DataFrame(
                {
                    "source": measured_source(rows),
                    "panel": panel,
                    "series": [f"{d:g} mm" for d in rows["depth_mm"]],
                    X: rows["lateral_distance_mm"],
                    DEFLECTION: -rows["deflection_mm"],
                }
            )
        )
    marks = (axis_rows(reference, X, "T059"), axis_rows(reference, DEFLECTION, "T058a"))
    return assemble(pd.concat(parts, ignore_index=True), *points, *marks)


@style.styled
def fig_3_6(frame: pd.DataFrame) -> Figure:
    """Surface deflection, three panels."""
    note = [
        f"{MODEL}{_error(frame)}. The line is a blade with a round tip of 0.1 mm radius.",
        "Points: measured under cylinders of 3.17 and 9.52 mm diameter (MIT Touch Lab, of the kind of Srinivasan 1989; mean of "
        "both sides, digitised by a third party). They stand in for the three subjects' profiles under a line load, which are "
        "not available. Grey band: axis range of Cysyk (1999) where more is shown.",
    ]
    fig = style.new_figure(frame, "3-6", "Surface deflection in the steady state", 3.6, note=_wrapped(note))
    axes = fig.subplots(1, 3, sharey=True)
    ranges = frame[frame["source"].str.startswith("thesis")]
    for ax, panel in zip(axes, PROFILES, strict=True):
        rows = frame[frame["panel"] == panel]
        simulated = rows[is_simulated(rows)]
        for k, (name, curve) in enumerate(simulated.groupby("series", sort=False)):
            ax.plot(curve[X], curve[DEFLECTION], color=SHADES[k], lw=1.2, label=name)
            points = rows[~is_simulated(rows) & (rows["series"] == name)]
            ax.plot(points[X], points[DEFLECTION], MARKERS[k], color=SHADES[k], ms=4)
        style.limit_axis(ax, pd.concat([rows, ranges]), X, "x")
        style.limit_axis(ax, pd.concat([frame[is_simulated(frame) | frame["series"].notna()], ranges]), DEFLECTION)
        ax.set(
            title=f"({'abc'[list(PROFILES).index(panel)]}) {panel}",
            xlabel="distance from the axis (mm)",
            xticks=[-10, -5, 0, 5, 10],
        )
        ax.legend(title="depth", loc="lower left", fontsize=7, title_fontsize=7, handlelength=1.2, borderaxespad=0.1)
    for ax in axes[:-1]:  # the bracket beside the last panel says it for all
        for artist in [t for t in ax.texts if t.get_text() in ("", "thesis axis range")]:
            artist.remove()
    axes[0].set_ylabel("surface deflection (mm)")
    return fig


def _error(frame: pd.DataFrame) -> str:
    worst = frame[ERROR].max()
    return f" Discretisation error ≤ {worst:.2g} %" if np.isfinite(worst) else " Discretisation error not computed"


def _wrapped(lines: list[str]) -> list[str]:
    return [part for line in lines for part in textwrap.wrap(line, style.NOTE_WIDTH - 12)]


# --- 3-7 -----------------------------------------------------------------------------------------------


def frame_3_7(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, measured: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Steady force against the depth of a flat plate, and the measured forces of each subject."""
    plate = histories[PLATE]
    ends = [lambda d, z=z: steady_force(d, z) for z in pressed_depths(plate)]
    model = pd.DataFrame({"series": "model", DEPTH: plate["indentation_depth"].values * 1e3, FORCE: force_N(plate)})
    model[ERROR] = error_percent(plate, coarse.get(PLATE), *ends)
    points = []
    if measured is not None:
        rows = measured[(measured["indenter"] == "flat plate") & (measured["speed_mm_per_s"] == 0)]
        for subject, part in rows.groupby("subject", sort=False):
            values = {"series": f"subject {subject}", DEPTH: part["depth_mm"], FORCE: part["force_N"]}
            points.append(pd.DataFrame({"source": measured_source(part), **values}))
    return assemble(model, *points, axis_rows(reference, DEPTH, "T063"), axis_rows(reference, FORCE, "T062a"))


@style.styled
def fig_3_7(frame: pd.DataFrame) -> Figure:
    """Steady force over depth."""
    others = frame[~is_simulated(frame) & frame["series"].notna()]
    note = [
        f"{MODEL.replace('Lines', 'Line')}{_error(frame)}. Moduli of the default specimen (0.15, 0.015 and 0.015 MPa), contact "
        "length 10 mm: not fitted to these subjects. Force tells modulus x contact length alone: "
        "see figures/studies/calibration_fit.",
        "Points: measured (Dandekar, Raju and Srinivasan 2003; digitised by a third party), four subjects, the same plate and "
        "depths; Cysyk (1999) shows five subjects. Grey band: axis range of Cysyk (1999) where more is shown.",
    ]
    fig = style.new_figure(frame, "3-7", "Steady force under a flat plate", 4.0, note=_wrapped(note))
    ax = fig.subplots()
    model = frame[is_simulated(frame)]
    ax.plot(model[DEPTH], model[FORCE], color=style.INK, label="model, 10 mm contact length")
    for k, (name, rows) in enumerate(others.groupby("series", sort=False)):
        ax.plot(rows[DEPTH], rows[FORCE], MARKERS[k % 4], color=SHADES[k % 4], ms=5, label=name)
    style.limit_axis(ax, frame, DEPTH, "x")
    style.limit_axis(ax, frame, FORCE)
    ax.set(xlabel="indentation depth (mm)", ylabel="force (N)")
    ax.legend(loc="upper left")
    return fig


# --- 3-8, 3-9 ------------------------------------------------------------------------------------------


def _ramp_and_hold(scenes: dict[str, str], unit: str, until: float, histories: Histories, coarse: Histories) -> pd.DataFrame:
    """Force over time of each scene up to a time, and its steady level, as two rows to the same time."""
    plate, parts = histories[PLATE], []
    for label, scene in scenes.items():
        history = histories[scene]
        time = np.append(history["time"].values[history["time"].values < until * (1 - 1e-9)], until)
        series = f"{label} {unit}"
        error = error_percent(history, coarse.get(scene), *(_at(force_N, t) for t in (ramp_end, lambda d: d.sizes["time"] - 1)))
        values = np.interp(time, history["time"].values, force_N(history))
        force = pd.DataFrame({"series": series, "phase": "ramp and hold", TIME: time, FORCE: values})
        depth = max(pressed_depths(history))
        level = steady_force(plate, depth)
        level_error = error_percent(plate, coarse.get(PLATE), partial(steady_force, depth=depth))
        steady = pd.DataFrame({"series": series, "phase": "steady state", TIME: [0.0, until], FORCE: level})
        parts += [force.assign(**{ERROR: error}), steady.assign(**{ERROR: level_error})]
    return pd.concat(parts, ignore_index=True)


def _at(trace, index):
    return lambda d: float(trace(d)[index(d)])


def _draw_ramp_and_hold(ax: Axes, frame: pd.DataFrame, at_curves: bool) -> None:
    """Curves and steady levels, each with its name and peak over steady force: at the curve's end or in a legend."""
    simulated = frame[is_simulated(frame)]
    dashes = {"lw": 0.8, "ls": (0, (2, 2))}
    for colour, (name, rows) in zip(SHADES, simulated.groupby("series", sort=False), strict=False):
        curve, steady = (rows[rows["phase"] == phase] for phase in ("ramp and hold", "steady state"))
        ax.plot(steady[TIME], steady[FORCE], color=colour, **dashes)
        label = f"{name}: peak / steady {curve[FORCE].max() / steady[FORCE].iloc[0]:.2f}"
        ax.plot(curve[TIME], curve[FORCE], color=colour, label="_" * at_curves + label)
        if at_curves:
            end = curve.iloc[-1]
            ax.annotate(label, (end[TIME], end[FORCE]), (-2, 5), textcoords="offset points", ha="right", color=colour, fontsize=8)
    style.limit_axis(ax, frame, TIME, "x")
    style.limit_axis(ax, frame, FORCE)
    ax.set(xlabel="time (s)", ylabel="force (N)")
    ax.plot([], [], color=style.INK, label="steady state, solved as such", **dashes)
    ax.legend(loc="upper right")


def _model_alone(frame: pd.DataFrame) -> list[str]:
    marks = " Grey band: axis range of Cysyk (1999) where more is shown." if (~is_simulated(frame)).any() else ""
    return _wrapped([f"{MODEL}{_error(frame)}. Contact length 10 mm.", NOT_AVAILABLE + marks])


def frame_3_8(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Force of a flat plate pressed to four depths at 2 mm/s and held."""
    frame = _ramp_and_hold(DEPTH_SCENES, "mm", 10.0, histories, coarse)
    return assemble(frame, axis_rows(reference, TIME, "T067"), axis_rows(reference, FORCE, "T066a"))


@style.styled
def fig_3_8(frame: pd.DataFrame) -> Figure:
    """Force over time, four depths."""
    fig = style.new_figure(frame, "3-8", "Force in ramp and hold, 2 mm/s to four depths", 4.0, note=_model_alone(frame))
    _draw_ramp_and_hold(fig.subplots(), frame, at_curves=True)
    return fig


def frame_3_9(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Force of a flat plate pressed to 1 mm at three speeds and held, up to 1.5 s."""
    frame = _ramp_and_hold(SPEED_SCENES, "mm/s", 1.5, histories, coarse)
    return assemble(frame, axis_rows(reference, TIME, "T071"), axis_rows(reference, FORCE, "T070a"))


@style.styled
def fig_3_9(frame: pd.DataFrame) -> Figure:
    """Force over time, three speeds."""
    fig = style.new_figure(frame, "3-9", "Force in ramp and hold to 1 mm, three speeds", 4.0, note=_model_alone(frame))
    _draw_ramp_and_hold(fig.subplots(), frame, at_curves=False)
    return fig


# --- 3-10, 3-11 ----------------------------------------------------------------------------------------


def section(history: xr.Dataset, depth: float, corneum: bool = False) -> dict[str, np.ndarray]:
    """Layer boundaries (n, 2) in m at the end of a press to `depth` (0: undeformed), and the indenter's lower side.

    Lines as in `chapter3.boundaries`, and if asked ``corneum``, the inner side of the stratum corneum: material points at its
    thickness under the skin, moved as the epidermis round them.
    """
    from scipy.interpolate import LinearNDInterpolator  # here, for it is slow to import

    points = history["node_position"].values
    cells, region = history["element_nodes"].values, history["element_region"].values
    kind = {9: "quad9", 4: "quad4", 6: "tri6", 3: "tri3"}[cells.shape[1]]
    numbered = boundaries(PadMesh(points, cells, kind, region, {}, True), as_nodes=True)
    moved = history["snapshot_displacement"].values[leg_of(history, depth)] if depth else np.zeros_like(points)
    lines = {name: points[nodes] + moved[nodes] for name, nodes in numbered.items()}
    if corneum:
        inner = inward(densify(points[numbered["skin"]], 0.1e-3), stratum_corneum(history))
        epidermis = np.unique(cells[region == 0])
        # in mm: in m its search for triangles takes many times as long
        motion = LinearNDInterpolator(points[epidermis] * 1e3, moved[epidermis])(inner * 1e3) if depth else 0.0
        lines["corneum"] = inner + motion
    x = np.linspace(-4e-3, 4e-3, 801)
    height = _indenter(history).outline(x) + points[:, 1].max() - depth
    lines["indenter"] = np.column_stack((x, height))[np.isfinite(height)]
    return lines


def _indenter(history: xr.Dataset) -> Cylinder | Bar:
    stimulus = scene_of(history)["stimulus"]
    if stimulus["shape"] == "bar":
        return Bar(stimulus["width"], stimulus["fillet"])
    return Cylinder(stimulus["curvature"])


def _lines(panel: str, state: str, lines: dict[str, np.ndarray], layers: tuple[str, ...], error: float) -> list[pd.DataFrame]:
    return [
        pd.DataFrame({"panel": panel, "phase": state, "layer": k, X: lines[k][:, 0] * 1e3, Y: lines[k][:, 1] * 1e3, ERROR: error})
        for k in layers
    ]


def _section_error(history: xr.Dataset, coarse: xr.Dataset | None) -> float:
    """Difference (%) of the vertical displacement of the layers' boundaries under the apex, at the deepest press."""

    def under_apex(layer: str):
        def feature(d: xr.Dataset) -> float:
            depth = max(pressed_depths(d))
            before, after = (section(d, z)[layer] for z in (0.0, depth))
            node = int(np.argmin(np.where(before[:, 1] > 0, abs(before[:, 0]), np.inf)))
            return float(after[node, 1] - before[node, 1])

        return feature

    return error_percent(history, coarse, under_apex("dermis"), under_apex("fat"))


def frame_3_10(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """The section, undeformed and under the 1/16 inch bar at 2 mm: closed layer boundaries, the bar's lower side."""
    history = histories[BAR]
    error = _section_error(history, coarse.get(BAR))
    parts = []
    for panel, depth in (("undeformed", 0.0), ("1/16 inch bar, 2 mm", 2e-3)):
        layers = ("skin", "dermis", "fat", "bone") + (("indenter",) if depth else ())
        parts += _lines(panel, "deformed" if depth else "undeformed", section(history, depth), layers, error)
    return assemble(pd.concat(parts, ignore_index=True))


def _section_note(frame: pd.DataFrame, extra: str) -> list[str]:
    error = _error(frame).strip()
    return _wrapped(
        [
            f"Simulated in plane strain, not measured. {error} (displacement of the layers under the indenters). {extra}",
            "The MRI sections of Cysyk (1999) are not available: nothing stands in their place.",
        ]
    )


@style.styled
def fig_3_10(frame: pd.DataFrame) -> Figure:
    """Two sections side by side."""
    note = _section_note(frame, "The stratum corneum is part of the outermost layer. The bar's edges have a radius of 0.1 mm.")
    fig = style.new_figure(frame, "3-10", "Section under a 1/16 inch rectangular bar, steady state", 3.5, note=note)
    axes = fig.subplots(1, 2, sharey=True)
    paint = {"skin": "epidermis", "dermis": "dermis", "fat": "fat", "bone": "bone"}
    for ax, panel in zip(axes, frame["panel"].unique(), strict=True):
        rows = frame[frame["panel"] == panel]
        for layer, colour in paint.items():
            loop = rows[rows["layer"] == layer]
            ax.fill(loop[X], loop[Y], facecolor=style.LAYER_COLOURS[colour], edgecolor=style.INK, lw=0.7)
        _draw_indenter(ax, rows)
        ax.set(title=panel, aspect="equal", xlim=(-10, 10), ylim=(-6.8, 7.4), xlabel=X)
        ax.set(xticks=range(-10, 11, 5), yticks=(-6, -3, 0, 3, 6))
    names = {"epidermis": (0, 5.57), "dermis": (0, 4.72), "fat": (0, 2.4), "bone": (0, -1.8)}
    for name, place in names.items():
        axes[0].text(*place, name, ha="center", va="center", fontsize=6 if name.endswith("dermis") else 7)
    axes[0].set_ylabel(Y)
    return fig


def _draw_indenter(ax: Axes, rows: pd.DataFrame) -> None:
    """The indenter from its lower side up to where the picture ends."""
    side = rows[rows["layer"] == "indenter"]
    if len(side):
        ax.fill_between(side[X], side[Y], np.maximum(side[Y], 7.4), color="0.8", lw=0)
        ax.plot(side[X], side[Y], color="0.55", lw=0.7)


def frame_3_11(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Layer boundaries without load and under five indentations; the stratum corneum is left out."""
    parts = []
    for panel, (scene, depth) in SECTIONS.items():
        history = histories[scene]
        error = _section_error(history, coarse.get(scene))
        parts += _lines(panel, "undeformed", section(history, 0.0, corneum=True), ("corneum", "dermis", "fat", "bone"), error)
        if depth:
            parts += _lines(
                panel, "deformed", section(history, depth, corneum=True), ("corneum", "dermis", "fat", "indenter"), error
            )
    return assemble(pd.concat(parts, ignore_index=True))


@style.styled
def fig_3_11(frame: pd.DataFrame) -> Figure:
    """Six sections: boundaries undeformed (dashed) and deformed."""
    extra = (
        "The outermost line is 0.35 mm under the skin (the stratum corneum is left out, as in the thesis): indenters stand off."
    )
    fig = style.new_figure(
        frame, "3-11", "Layer boundaries under five indentations, steady state", 4.3, _section_note(frame, extra), 0.2
    )
    axes = fig.subplots(2, 3, sharex=True, sharey=True)
    colours = {"corneum": SHADES[0], "dermis": SHADES[1], "fat": SHADES[2]}
    for ax, panel in zip(axes.ravel(), SECTIONS, strict=True):
        rows = frame[frame["panel"] == panel]
        bone = rows[rows["layer"] == "bone"]
        ax.fill(bone[X], bone[Y], facecolor=style.LAYER_COLOURS["bone"], edgecolor="none")
        _draw_indenter(ax, rows)
        for (state, layer), line in rows[rows["layer"].isin(colours)].groupby(["phase", "layer"], sort=False):
            ax.plot(line[X], line[Y], **{"color": colours[layer]} | STATE_LINES["deformed" if panel == "no load" else state])
        ax.set(title=panel, aspect="equal", xlim=(-8.4, 8.4), ylim=(-1.5, 6.5), xticks=(-6, -3, 0, 3, 6), yticks=(0, 3, 6))
    axes[1, 1].set_xlabel(X)
    axes[0, 0].set_ylabel(Y)
    axes[1, 0].set_ylabel(Y)
    names = {"corneum": "outside of the living epidermis", "dermis": "epidermis to dermis", "fat": "dermis to fat"}
    handles = [Line2D([], [], color=colours[k], label=v) for k, v in names.items()]
    style.header_legend(fig, [*handles, Line2D([], [], label="undeformed", **STATE_LINES["undeformed"])], columnspacing=1.4)
    return fig


FIGURES = (
    FigureSpec("3-6", "Surface deflection", tuple(PROFILES.values()), frame_3_6, fig_3_6, measured="surface_profiles"),
    FigureSpec("3-7", "Steady force over depth", (PLATE,), frame_3_7, fig_3_7, measured="force_depth"),
    FigureSpec("3-8", "Ramp and hold to four depths", (PLATE, *DEPTH_SCENES.values()), frame_3_8, fig_3_8),
    FigureSpec("3-9", "Ramp and hold at three speeds", (PLATE, *SPEED_SCENES.values()), frame_3_9, fig_3_9),
    FigureSpec("3-10", "Section under a bar", (BAR,), frame_3_10, fig_3_10),
    FigureSpec(
        "3-11",
        "Layer boundaries under five indentations",
        tuple(dict.fromkeys(scene for scene, _ in SECTIONS.values())),
        frame_3_11,
        fig_3_11,
    ),
)

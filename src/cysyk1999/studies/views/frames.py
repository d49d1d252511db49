"""Data frames of the views, each of a few histories; a picture is drawn from its frame alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import LinearNDInterpolator

from cysyk1999.figures.geometry import boundaries
from cysyk1999.measures.quantities import DISTANCE, FORCE, IMPULSE, IMPULSE_RATE, SED, TIME, P, X, Y
from cysyk1999.measures.responses import (
    RECEPTOR_DEPTH,
    SEED,
    predicted_rate,
    raster,
)
from fingerpad.measures.features import PRESSURE, energy, force_gf, profile
from fingerpad.measures.strokes import arcs, distance, loaded, place, profile_and_height
from fingerpad.results import scene_of
from fingerpad.specimen.element_kinds import kind_of
from fingerpad.specimen.pad import REGIONS, PadMesh

Histories = Mapping[str, xr.Dataset]
CORNERS = [f"corner_{k}_{axis} (mm)" for k in range(1, 5) for axis in "xy"]
STICKS, SLIPS = 1, 2  # values of the history's contact_state
LAYER_LINES = ("skin", "dermis", "fat", "bone")
SKIN_X, TRACTION, BOUND = "skin_x (mm)", "tangential_traction (Pa)", "friction_bound (Pa)"
SLIP, STATE, STICKING = "slip_speed (mm/s)", "state (1)", "sticking (%)"
TOP = 0.5
"""End of the ramp of the pressed scenes, s."""


def nearest(history: xr.Dataset, axis: str, time: float) -> int:
    """Number of the output (axis "time") or snapshot ("snapshot_time") nearest to a time (s)."""
    return int(np.argmin(abs(history[axis].values - time)))


def moved_nodes(history: xr.Dataset, snapshot: int) -> np.ndarray:
    """Deformed nodes (n, 2), mm."""
    moved = history["snapshot_displacement"].values[snapshot]
    return 1e3 * (history["node_position"].values + moved)


def elements(
    history: xr.Dataset, snapshot: int, window: tuple[float, float, float, float]
) -> pd.DataFrame:
    """Deformed elements within a window (left, right, low, high in mm): corners, layer, strain
    energy density.
    """
    corners = moved_nodes(history, snapshot)[history["element_nodes"].values[:, :4]]
    x, y = corners.mean(axis=1).T
    left, right, low, high = window
    inside = (x > left) & (x < right) & (y > low) & (y < high)
    rows = pd.DataFrame(corners[inside].reshape(-1, 8).round(4), columns=CORNERS)
    rows.insert(0, "series", "element")
    rows["layer"] = np.array(REGIONS)[history["element_region"].values[inside]]
    rows[SED] = history["snapshot_strain_energy_density"].values[snapshot, inside]
    return rows


def lines(history: xr.Dataset, snapshot: int) -> pd.DataFrame:
    """Deformed boundaries of the layers, and the underside of the stimulus."""
    points, cells = history["node_position"].values, history["element_nodes"].values
    region = history["element_region"].values
    mesh = PadMesh(points, cells, kind_of(cells.shape[1]).name, region, {}, True)
    nodes, moved = boundaries(mesh), moved_nodes(history, snapshot)
    loops = {name: moved[nodes[name]] for name in LAYER_LINES}
    outline = history["snapshot_indenter"].values[snapshot]
    loops["surface"] = 1e3 * outline[np.isfinite(outline).all(axis=1)]
    parts = [
        pd.DataFrame({"series": "line", "layer": name, X: line[:, 0], Y: line[:, 1]})
        for name, line in loops.items()
    ]
    return pd.concat(parts, ignore_index=True).round(4)


def receptors(history: xr.Dataset, snapshot: int) -> pd.DataFrame:
    """Receptors where they have gone."""
    points = 1e3 * history["node_position"].values
    moved = 1e3 * history["snapshot_displacement"].values[snapshot]
    near = (abs(points[:, 0]) < 1.0) & (points[:, 1] > 3.5)
    x, depth = 1e3 * history["receptor_offset"].values, 1e3 * history["receptor_depth"].values
    where = np.column_stack([x, points[:, 1].max() - depth])
    where = where + LinearNDInterpolator(points[near], moved[near])(where)
    output = nearest(history, "time", float(history["snapshot_time"].values[snapshot]))
    rows = {
        "series": "receptor",
        "layer": [f"{1e3 * z:.0f} um" for z in depth],
        X: where[:, 0],
        Y: where[:, 1],
        "felt (Pa)": history["strain_energy_density"].values[output],
    }
    return pd.DataFrame(rows)


def _named(parts: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    return pd.concat([rows.assign(panel=panel) for panel, rows in parts.items()], ignore_index=True)


# --- one case, from the surface to impulses ------------------------------------------------------


def force_over_time(history: xr.Dataset) -> pd.DataFrame:
    """Force, gf, over time."""
    return pd.DataFrame({"series": "force", TIME: history["time"].values, FORCE: force_gf(history)})


def overview(histories: Histories) -> pd.DataFrame:
    """A cylinder pressed and held: section, pressure and field at the top of the ramp, energy, rate
    and impulses over time.
    """
    history = histories["fields_k210"]
    snapshot = nearest(history, "snapshot_time", TOP)
    x, pressure = profile(history, nearest(history, "time", TOP))
    shown = (abs(1e3 * x) <= 2.6) & (history["skin_y"].values > 0)
    rate = predicted_rate(history)
    felt = {TIME: history["time"].values, SED: energy(history, RECEPTOR_DEPTH)}
    impulses = {"series": "impulse", IMPULSE: raster(rate, 1, SEED)[TIME]}
    return _named(
        {
            "section": pd.concat([lines(history, snapshot), receptors(history, snapshot)]),
            "pressure": pd.DataFrame({"series": "pressure", X: 1e3 * x[shown], P: pressure[shown]}),
            "field": elements(history, snapshot, (-2.8, 2.8, 3.4, 6.2)),
            "force": force_over_time(history),
            "energy": pd.DataFrame({"series": "energy"} | felt),
            "rate": rate[[TIME, IMPULSE_RATE]].assign(series="rate"),
            "impulses": pd.DataFrame(impulses),
        }
    )


def fields(histories: Histories) -> pd.DataFrame:
    """Strain energy density under a plate and two cylinders at the top of the ramp."""
    parts = {}
    for panel, scene in {"flat": "flat", "210": "k210", "1260": "k1260"}.items():
        history = histories[f"fields_{scene}"]
        k = nearest(history, "snapshot_time", TOP)
        parts[panel] = pd.concat(
            [elements(history, k, (-4.4, 4.4, 1.2, 6.2)), lines(history, k), receptors(history, k)]
        )
    return _named(parts)


# --- a stroke ------------------------------------------------------------------------------------

STROKE = "stroke_map_10"
INSTANTS = (1.0e-3, 20.0e-3)
"""Stroke distances (m) at which the contact is looked at: earlier, where most of it sticks, the
traction jumps from node to node, which mesh and steps do not resolve.
"""


def space_time(histories: Histories) -> pd.DataFrame:
    """Pressure, strain energy at 915 um and speed of slip over the place on the skin and the stroke
    distance.
    """
    stroke = loaded(histories[STROKE])
    x, along, time = stroke["receptor_offset"].values, distance(stroke), stroke["time"].values
    skin = np.flatnonzero(stroke["skin_y"].values > 0)
    skin = skin[np.argsort(stroke["skin_x"].values[skin])]
    at_rest, pressures = stroke["skin_x"].values[skin], stroke[PRESSURE].values[:, skin]
    step = np.maximum(np.diff(time, prepend=time[0]), 1e-9)
    speeds = stroke["slip"].values[:, skin] / step[:, None]
    outputs = np.flatnonzero(np.diff(along, prepend=-1.0) > 0)[:: max(1, len(along) // 180)]
    parts = []
    for k in outputs:
        pressure, speed = (np.interp(x, at_rest, values[k]) for values in (pressures, speeds))
        row = {
            DISTANCE: 1e3 * along[k],
            SKIN_X: 1e3 * x,
            P: pressure,
            SLIP: 1e3 * abs(speed) * (pressure > 0),
            SED: stroke["strain_energy_density"].values[k],
        }
        parts.append(pd.DataFrame(row))
    maps = pd.concat(parts, ignore_index=True).round(4).assign(series="map")
    s = np.linspace(along[0] - 4e-3, along[-1] + 4e-3, 801)
    heights = 1e3 * profile_and_height(stroke)[0].outline(s)
    surface = {"series": "surface", DISTANCE: 1e3 * s, "height (mm)": heights}
    marks = [
        {"series": "convexity", "curvature (1/m)": a.curvature, DISTANCE: 500 * (a.start + a.end)}
        for a in arcs(stroke)
        if a.curvature > 0
    ]
    # the point of the surface over the receptor at the centre, which the surface drags along
    over = 1e3 * place(stroke)[outputs]
    centre = {DISTANCE: 1e3 * along[outputs], "over_the_receptor (mm)": over, "series": "centre"}
    more = [pd.DataFrame(surface).dropna(), pd.DataFrame(marks), pd.DataFrame(centre)]
    return pd.concat([maps, *more], ignore_index=True)


def stick_slip(histories: Histories) -> pd.DataFrame:
    """Pressure times the coefficient of friction and the traction along the contact, where it
    sticks and where it slips.
    """
    stroke = loaded(histories[STROKE])
    friction, along, parts = scene_of(stroke).friction, distance(stroke), {}
    pressure, state = stroke[PRESSURE].values, stroke["contact_state"].values
    for instant in INSTANTS:
        k = int(np.argmin(abs(along - instant)))
        x, p = profile(stroke, k)
        rows = {
            "series": "contact",
            SKIN_X: 1e3 * x,
            P: p,
            BOUND: friction * p,
            TRACTION: stroke["tangential_traction"].values[k],
            STATE: state[k],
        }
        shown = (stroke["skin_y"].values > 0) & (abs(x) < 4e-3)
        parts[f"{1e3 * along[k]:.2f} mm"] = pd.DataFrame(rows)[shown]
    stuck = np.where(state == STICKS, pressure, 0.0).sum(axis=1)
    tangential, normal = abs(stroke["tangential_force"].values), stroke["force"].values
    whole = {
        "series": "whole",
        DISTANCE: 1e3 * along,
        STICKING: 100 * stuck / np.maximum(pressure.sum(axis=1), 1e-12),
        "ratio (1)": tangential / np.maximum(normal, 1e-12),
    }
    return _named(parts | {"whole": pd.DataFrame(whole)})

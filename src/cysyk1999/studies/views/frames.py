"""Data frames of the views, each of a few histories; a picture is drawn from its frame alone."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import LinearNDInterpolator

from cysyk1999.figures.geometry import boundaries, inward
from cysyk1999.measures.quantities import DISTANCE, FORCE, IMPULSE, IMPULSE_RATE, SED, TIME, P, X, Y
from cysyk1999.measures.responses import (
    RECEPTOR_DEPTH,
    SEED,
    predicted_rate,
    rapidly_adapting_rate,
    raster,
)
from fingerpad.measures.features import PRESSURE, energy, force_gf, profile
from fingerpad.measures.strokes import arcs, distance, loaded, place, profile_and_height
from fingerpad.receptors.rapidly_adapting import RapidlyAdapting
from fingerpad.results import scene_of
from fingerpad.specimen.element_kinds import kind_of
from fingerpad.specimen.pad import REGIONS, PadMesh

Histories = Mapping[str, xr.Dataset]
CORNERS = tuple(f"corner_{k}_{axis} (mm)" for k in range(1, 5) for axis in "xy")
STICKS, SLIPS = 1, 2  # values of the history's contact_state
LAYER_LINES = ("skin", "dermis", "fat", "bone")
SKIN_X, TRACTION, BOUND = "skin_x (mm)", "tangential_traction (Pa)", "friction_bound (Pa)"
RAPIDLY_ADAPTING = RapidlyAdapting(threshold=500.0, scale=500.0, highest=100.0)
"""Law of the rate of the skin's curvature; its constants are assumed, nothing at hand states them.
"""
SLIP, STATE, STICKING = "slip_speed (mm/s)", "state (1)", "sticking (%)"


def at(history: xr.Dataset, time: float) -> int:
    """Number of the snapshot nearest to a time (s)."""
    return int(np.argmin(abs(history["snapshot_time"].values - time)))


def output(history: xr.Dataset, time: float) -> int:
    """Number of the output nearest to a time (s)."""
    return int(np.argmin(abs(history["time"].values - time)))


def elements(
    history: xr.Dataset, snapshot: int, window: tuple[float, float, float, float]
) -> pd.DataFrame:
    """Deformed elements within a window (left, right, low, high in mm): corners, layer, and strain
    energy density if there is one.
    """
    nodes = history["element_nodes"].values[:, : kind_of(history.sizes["element_node"]).corners]
    points = 1e3 * (
        history["node_position"].values + history["snapshot_displacement"].values[snapshot]
    )
    x, y = points[nodes].mean(axis=1).T
    left, right, low, high = window
    inside = (x > left) & (x < right) & (y > low) & (y < high)
    corners = points[nodes[inside]].reshape(inside.sum(), -1)
    rows = pd.DataFrame(corners.round(4), columns=CORNERS[: corners.shape[1]])
    rows.insert(0, "series", "element")
    rows["layer"] = np.array(REGIONS)[history["element_region"].values[inside]]
    if "snapshot_strain_energy_density" in history:
        rows[SED] = history["snapshot_strain_energy_density"].values[snapshot, inside]
    return rows


def lines(history: xr.Dataset, snapshot: int | None, corneum: bool = False) -> pd.DataFrame:
    """Deformed boundaries of the layers (undeformed: snapshot None), and the underside of the
    stimulus.
    """
    points, cells = history["node_position"].values, history["element_nodes"].values
    region = history["element_region"].values
    moved = 0.0 if snapshot is None else history["snapshot_displacement"].values[snapshot]
    found = boundaries(
        PadMesh(points, cells, kind_of(cells.shape[1]).name, region, {}, True), as_nodes=True
    )
    loops = {name: (points + moved)[found[name]] for name in LAYER_LINES}
    if corneum:
        loops["corneum"] = inward(
            points[found["skin"]], scene_of(history).specimen.outline.stratum_corneum_thickness
        )
    if snapshot is not None:
        outline = history["snapshot_indenter"].values[snapshot]
        loops["surface"] = outline[np.isfinite(outline).all(axis=1)]
    parts = [
        pd.DataFrame({"series": "line", "layer": k, X: 1e3 * v[:, 0], Y: 1e3 * v[:, 1]})
        for k, v in loops.items()
    ]
    return pd.concat(parts, ignore_index=True).round(4)


def receptors(history: xr.Dataset, snapshot: int) -> pd.DataFrame:
    """Receptors where they have gone."""
    points = 1e3 * history["node_position"].values
    moved = 1e3 * history["snapshot_displacement"].values[snapshot]
    near = (abs(points[:, 0]) < 1.0) & (points[:, 1] > 3.5)
    x, depth = 1e3 * history["receptor_offset"].values, 1e3 * history["receptor_depth"].values
    top = points[:, 1].max()
    where = np.column_stack([x, top - depth])
    where = where + LinearNDInterpolator(points[near], moved[near])(where)
    felt = history["strain_energy_density"].values[
        output(history, float(history["snapshot_time"].values[snapshot]))
    ]
    rows = {
        "series": "receptor",
        "layer": [f"{1e3 * z:.0f} um" for z in depth],
        X: where[:, 0],
        Y: where[:, 1],
    }
    return pd.DataFrame(rows | {"felt (Pa)": felt})


def pressures(history: xr.Dataset, index: int, half_width: float) -> pd.DataFrame:
    """Contact pressure over the skin at an output, as far out as half_width (mm)."""
    x, p = profile(history, index)
    shown = (abs(1e3 * x) <= half_width) & (history["skin_y"].values > 0)
    return pd.DataFrame({"series": "pressure", X: 1e3 * x[shown], P: p[shown]})


def _named(parts: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    return pd.concat([rows.assign(panel=panel) for panel, rows in parts.items()], ignore_index=True)


# --- one case, from the surface to impulses ------------------------------------------------------


def overview(histories: Histories) -> pd.DataFrame:
    """A cylinder pressed and held: section, pressure and field at the top of the ramp, energy, rate
    and impulses over time.
    """
    history = histories["fields_k210"]
    snapshot, index = at(history, 0.5), output(history, 0.5)
    rate = predicted_rate(history)
    ticks = raster(rate, 1, SEED)
    return _named(
        {
            "section": pd.concat([lines(history, snapshot), receptors(history, snapshot)]),
            "pressure": pressures(history, index, 2.6),
            "field": elements(history, snapshot, (-2.8, 2.8, 3.4, 6.2)),
            "force": pd.DataFrame(
                {"series": "force", TIME: history["time"].values, FORCE: force_gf(history)}
            ),
            "energy": pd.DataFrame(
                {
                    "series": "energy",
                    TIME: history["time"].values,
                    SED: energy(history, RECEPTOR_DEPTH),
                }
            ),
            "rate": rate[[TIME, IMPULSE_RATE]].assign(series="rate"),
            "impulses": pd.DataFrame({"series": "impulse", IMPULSE: ticks[TIME]}),
        }
    )


def fields(histories: Histories) -> pd.DataFrame:
    """Strain energy density under a plate and two cylinders at the top of the ramp."""
    parts = {}
    for label in ("flat", "k210", "k1260"):
        history = histories[f"fields_{label}"]
        k = at(history, 0.5)
        parts[label.removeprefix("k")] = pd.concat(
            [elements(history, k, (-4.4, 4.4, 1.2, 6.2)), lines(history, k), receptors(history, k)]
        )
    return _named(parts)


# --- meshes --------------------------------------------------------------------------------------

LEVELS = ("draft", "thesis", "fine")


def mesh_close_up(histories: Histories) -> pd.DataFrame:
    """Deformed meshes of the three levels under the sharpest cylinder and under convexities, and
    their pressures.
    """
    parts = {}
    for surface, half, low in (("k1260", 0.75, 4.4), ("wavy", 2.6, 4.4)):
        for level in LEVELS:
            history = histories[f"close_up_{surface}_{level}"]
            k, last = history.sizes["snapshot"] - 1, history.sizes["time"] - 1
            touching = pressures(history, last, max(half, 3.2 * (surface == "wavy")))
            touching["contact (1)"] = (touching[P] > 0).astype(int)
            shown = lines(history, k)
            shown = shown[
                shown["layer"].isin(("skin", "surface"))
                & shown[X].abs().le(1.2 * half)
                & shown[Y].gt(low)
            ]
            mesh = elements(history, k, (-half, half, low, 6.2))
            mesh.insert(1, "elements (1)", len(mesh))
            parts[f"{surface} {level}"] = pd.concat([mesh, shown, touching])
    return _named(parts)


def ridges_both_ways(histories: Histories) -> pd.DataFrame:
    """Strain energy round the inner ridges with the plate pressed, and stroked to the right (to the
    left: its mirror image).
    """
    history = histories["ridged_press"]
    parts = {}
    for panel, time in (("pressed", 0.5), ("stroked to the right", 1.0)):
        k = at(history, time)
        at_skin = 1e3 * history["snapshot_displacement"].values[k][:, 0]
        apex = 1e3 * history["node_position"].values
        carried = float(at_skin[np.argmin(np.hypot(apex[:, 0], apex[:, 1] - apex[:, 1].max()))])
        rows = elements(history, k, (carried - 1.2, carried + 0.9, 4.2, 6.1))
        parts[panel] = pd.concat([rows, lines(history, k), receptors(history, k)]).assign(
            **{"carried (mm)": carried}
        )
    return _named(parts)


# --- a stroke ------------------------------------------------------------------------------------

STROKE = "stroke_map_10"
INSTANTS = (0.25e-3, 0.5e-3, 1.0e-3, 20.0e-3)
"""Stroke distances (m) at which the contact is looked at."""


def space_time(histories: Histories) -> pd.DataFrame:
    """Pressure, strain energy at 915 um and speed of slip over the place on the skin and the stroke
    distance.
    """
    stroke = loaded(histories[STROKE])
    x, along, time = stroke["receptor_offset"].values, distance(stroke), stroke["time"].values
    order = np.argsort(x)
    skin = np.flatnonzero(stroke["skin_y"].values > 0)
    skin = skin[np.argsort(stroke["skin_x"].values[skin])]
    on = np.flatnonzero(np.diff(along, prepend=-1.0) > 0)[:: max(1, len(along) // 180)]
    slipped = (
        stroke["slip"].values[:, skin] / np.maximum(np.diff(time, prepend=time[0]), 1e-9)[:, None]
    )  # of each step
    parts, at_rest = [], stroke["skin_x"].values[skin]
    for k in on:
        p = np.interp(x[order], at_rest, stroke[PRESSURE].values[k, skin])
        speed = np.interp(x[order], at_rest, slipped[k])
        row = {DISTANCE: 1e3 * along[k], SKIN_X: 1e3 * x[order], P: p}
        row |= {SLIP: 1e3 * abs(speed) * (p > 0)}
        row |= {SED: stroke["strain_energy_density"].values[k, order]}
        parts.append(pd.DataFrame(row))
    shape = profile_and_height(stroke)[0]
    s = np.linspace(along[0] - 4e-3, along[-1] + 4e-3, 801)
    surface = {"series": "surface", DISTANCE: 1e3 * s, "height (mm)": 1e3 * shape.outline(s)}
    marks = [
        {"series": "convexity", "curvature (1/m)": a.curvature, DISTANCE: 500 * (a.start + a.end)}
        for a in arcs(stroke)
        if a.curvature > 0
    ]
    # the point of the surface over the receptor at the centre, which the surface drags along
    centre = {DISTANCE: 1e3 * along[on], "over_the_receptor (mm)": 1e3 * place(stroke)[on]}
    more = [pd.DataFrame(surface).dropna(), pd.DataFrame(marks), pd.DataFrame(centre)]
    more[-1]["series"] = "centre"
    maps = pd.concat(parts, ignore_index=True).round(4).assign(series="map")
    return pd.concat([maps, *more], ignore_index=True)


def stick_slip(histories: Histories) -> pd.DataFrame:
    """Pressure times the coefficient of friction and the traction along the contact, where it
    sticks and where it slips.
    """
    stroke = loaded(histories[STROKE])
    friction, parts = scene_of(stroke).friction, {}
    for instant in INSTANTS:
        k = int(np.argmin(abs(distance(stroke) - instant)))
        x, p = profile(stroke, k)
        rows = {SKIN_X: 1e3 * x, P: p, BOUND: friction * p}
        rows |= {TRACTION: abs(stroke["tangential_traction"].values[k])}
        rows |= {STATE: stroke["contact_state"].values[k]}
        shown = (stroke["skin_y"].values > 0) & (abs(x) < 4e-3)
        panel = pd.DataFrame({"series": "contact"} | rows)[shown]
        parts[f"{1e3 * distance(stroke)[k]:.2f} mm"] = panel
    pressure = stroke[PRESSURE].values
    stuck = np.where(stroke["contact_state"].values == STICKS, pressure, 0.0).sum(axis=1)
    whole = {
        "series": "whole",
        DISTANCE: 1e3 * distance(stroke),
        STICKING: 100 * stuck / np.maximum(pressure.sum(axis=1), 1e-12),
        "ratio (1)": abs(stroke["tangential_force"].values)
        / np.maximum(stroke["force"].values, 1e-12),
    }
    return _named(parts | {"whole": pd.DataFrame(whole)})


# --- responses -----------------------------------------------------------------------------------


def adaptation(histories: Histories) -> pd.DataFrame:
    """Predicted responses of a slowly and a rapidly adapting receptor to two ramps and holds: rates
    and a few trials.
    """
    parts = {}
    for programme, words in (("ramp40", "40 gf/s"), ("ramp150", "150 gf/s")):
        history = histories[f"{programme}_k210"]
        parts[f"force {words}"] = pd.DataFrame(
            {"series": "force", TIME: history["time"].values, FORCE: force_gf(history)}
        )
        slow, fast = (
            predicted_rate(history),
            rapidly_adapting_rate(history, RAPIDLY_ADAPTING),
        )
        for kind, rate in (("slowly adapting", slow), ("rapidly adapting", fast)):
            ticks = raster(rate, 5, SEED).rename(columns={TIME: IMPULSE, "trial": "trial (1)"})
            parts[f"{kind} {words}"] = pd.concat(
                [
                    rate[[TIME, IMPULSE_RATE]].assign(series="rate"),
                    ticks[["trial (1)", IMPULSE]].assign(series="impulse"),
                ]
            )
    return _named(parts)


# --- what the model rests on ---------------------------------------------------------------------


def assumptions(histories: Histories) -> pd.DataFrame:
    """The section with every size, modulus and boundary condition by whether the thesis states it,
    it follows, or is assumed.
    """
    history = histories["fields_flat"]
    scene = scene_of(history)
    pad, layers = scene.specimen.outline, {name: scene.specimen.material(name) for name in REGIONS}
    mm = 1e3
    top, half = mm * pad.apex_height, mm * pad.half_width
    epidermis, dermis = mm * pad.epidermis_thickness, mm * pad.dermis_thickness
    bone = mm * (pad.bone_centre_height + pad.bone_half_height)
    fat, relaxed = (
        top - epidermis - dermis - bone,
        100 * sum(term.g for term in scene.specimen.prony),
    )

    def modulus(name: str) -> str:
        return f"E {1e-3 * layers[name].youngs_modulus:g} kPa, ν {layers[name].poisson_ratio:g}"

    left = (
        ("stated", "nine surfaces, 20 gf,\n40 or 150 gf/s", -1.0, top + 0.3),
        ("assumed", "strokes keep 20 gf", -1.6, top + 0.1),
        ("stated", f"epidermis {epidermis:.2f} mm\n{modulus('epidermis')}", -4.2, top - 1.15),
        ("stated", f"dermis {dermis:.2f} mm\n{modulus('dermis')}", -5.2, 3.15),
        ("stated", f"fat\n{modulus('fat')}", -5.0, 1.6),
        ("stated", f"shear modulus relaxes by {relaxed:.0f} %", -6.0, -0.2),
        ("inferred", "moduli stated are the\ninstantaneous ones", -6.6, -2.4),
    )
    right = (
        ("inferred", f"radius of the skin at the apex {mm * pad.apex_radius:g} mm", 1.5, top - 0.1),
        (
            "inferred",
            f"contact length {mm * scene.specimen.contact_length:g} mm\n(force per length)",
            2.6,
            top - 0.3,
        ),
        ("assumed", "ramp and hold without friction;\nstrokes: μ calibrated", 3.4, top - 0.5),
        (
            "inferred",
            f"width {2 * half:g} mm,\nheight {top + mm * pad.depth_below:.1f} mm",
            half * 0.86,
            3.0,
        ),
        (
            "inferred",
            f"fat under the apex {fat:.1f} mm:\nthe bone's place and size",
            1.0,
            bone + 0.4,
        ),
        ("assumed", "bone and nail do not move", 4.6, -2.3),
        ("assumed", "plane strain, layers bonded,\nnearly incompressible", 6.5, -3.0),
    )
    told = [
        {"series": origin, "words": words, X: x, Y: float(y), "to_x (mm)": to_x, "to_y (mm)": to_y}
        for x, side in ((-13.0, left), (13.0, right))
        for y, (origin, words, to_x, to_y) in zip(
            np.linspace(8.0, -6.0, len(side)), side, strict=True
        )
    ]
    rows = pd.concat([lines(history, None, corneum=True), pd.DataFrame(told)], ignore_index=True)
    nail = mm * pad.nail_half_width
    return pd.concat([rows, pd.DataFrame({"series": "held", X: [-nail, nail]})], ignore_index=True)


FRAMES = {
    "overview": (overview, ("fields_k210",)),
    "fields": (fields, ("fields_flat", "fields_k210", "fields_k1260")),
    "mesh_close_up": (
        mesh_close_up,
        tuple(f"close_up_{s}_{level}" for s in ("k1260", "wavy") for level in LEVELS),
    ),
    "ridges_both_ways": (ridges_both_ways, ("ridged_press",)),
    "space_time": (space_time, (STROKE,)),
    "stick_slip": (stick_slip, (STROKE,)),
    "adaptation": (adaptation, ("ramp40_k210", "ramp150_k210")),
    "assumptions": (assumptions, ("fields_flat",)),
}
"""View -> its frame and the scenes it is of."""

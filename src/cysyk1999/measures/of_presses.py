"""Measures of pressed pads: contact, pressure, strain energy, predicted rates. "top" is the end of
the ramp, "end" of the hold.

Numbers that strokes have too are read of their `loaded` outputs.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.direction import BESIDE, DEPTH
from cysyk1999.measures.energy_of_1999 import ELASTIC
from cysyk1999.measures.quantities import (
    IMPULSE_RATE,
    NODE,
    P_LAW,
    SED,
    SED_LAW,
    SED_SQUARE,
    TIME,
    P,
)
from cysyk1999.measures.responses import (
    DEPTHS,
    NODE_COUNT,
    NODE_SURFACE,
    RECEPTOR_DEPTH,
    SHALLOW_DEPTH,
    contact_nodes,
    energy_from_pressure,
    fit_nodes,
    is_stroke,
    law_at,
    laws_of_sum,
    peak_energy_rate,
    predicted_rate,
    pressure_by_law,
    rate_in,
    windowed,
)
from cysyk1999.measures.runs import FAST, NINE, RIDGED_NINE
from cysyk1999.measures.steady import PLATE, force_N, leg_end, pressed_depths, steady_force
from cysyk1999.receptors.fits import rms
from fingerpad.measures import features
from fingerpad.measures.features import (
    PRESSURE,
    PRESSURE_SCALE,
    Histories,
    centre_node,
    energy,
    phase_indices,
    profile,
    ramp_end,
    receptors_at,
    skin_at,
    surface_nodes,
)
from fingerpad.measures.kept import kept
from fingerpad.measures.measure import (
    Measure,
    deep,
    forced,
    held,
    measure,
    named,
    slides,
    strokes,
    wavy,
)
from fingerpad.measures.strokes import NODES, loaded, nodes_at
from fingerpad.receptors.spikes import impulses
from fingerpad.results import scene_of

UM = tuple(round(z * 1e6) for z in DEPTHS)
ENERGIES = {
    "network": "strain_energy_network",
    "recoverable": "strain_energy_recoverable",
    "long-term moduli": "strain_energy_long_term_moduli",
    "half stress x strain": "strain_energy_half_stress_strain",
    "instantaneous elastic": ELASTIC,
}
"""Other definitions of the strain energy than that of 1999 (:mod:`energy_of_1999`)."""


def shown(history: xr.Dataset) -> xr.Dataset:
    """The history, of a stroke its loaded outputs."""
    return loaded(history) if is_stroke(history) else history


def _ends(history: xr.Dataset, values: np.ndarray) -> dict[str, float]:
    return {"highest": values.max(), "top": values[ramp_end(history)], "end": values[-1]}


def pressing(scene) -> bool:
    """Presses to a force, not stroked."""
    return forced(scene) and not strokes(scene)


# --- counts ---------------------------------------------------------------------------------------


@measure("count", lambda scene: not wavy(scene))
def receptor_depths(history):
    """How many of the thesis's depths there are: of its profiles, in the epidermis and in the
    dermis.
    """
    have = (
        set(np.round(history["receptor_depth"].values * 1e6).astype(int))
        if "receptor_depth" in history
        else set()
    )
    return {
        "profiles": len(have & {800, 915}),
        "epidermis": len(have & set(UM[:6])),
        "dermis": len(have & set(UM[6:])),
    }


@measure("um", forced)
def receptor_under_centre(history):
    """Depth of the receptor nearest to 560 um."""
    depths = history["receptor_depth"].values
    return 1e6 * depths[abs(depths - 560e-6).argmin()]


@measure("um", pressing)
def node_spacing(history):
    """Of the skin nodes next to the centre."""
    centre = centre_node(history)
    return 1e6 * np.hypot(np.diff(history["skin_x"])[centre], np.diff(history["skin_y"])[centre])


@measure("count", wavy)
def nodes_present(history):
    """How many of the nine positions of Fig 5-10 have a skin node within half of the thesis's node
    spacing.
    """
    x = history["skin_x"].values[nodes_at(history)] * 1e3
    return (abs(x - np.array(NODES)) <= 34e-3).sum()


# --- depth, width, force --------------------------------------------------------------------------


@measure("1/mm", pressing)
def inverse_width(history):
    values = history["contact_width"].values
    return {"top": 1e-3 / values[ramp_end(history)], "end": 1 / (1e3 * values[-1])}


@measure("mm", pressing)
def skin_height(history):
    node = centre_node(history)
    return 1e3 * skin_at(history, -1)[1][node]


@measure("N", named([PLATE]))
def steady(history):
    """Steady force of the plate by depth."""
    return {
        f"{1e3 * z:g} mm": force_N(history)[leg_end(history, z)] for z in pressed_depths(history)
    }


@measure(
    "1", lambda scene: deep(scene) and any(leg.key == "hold" for leg in scene.motion), beside=True
)
def peak_over_steady(history, runs):
    """Largest force of a ramp and hold over the steady force of the plate at its depth."""
    return force_N(history).max() / steady_force(runs[PLATE], max(pressed_depths(history)))


# --- pressure -------------------------------------------------------------------------------------


@measure("Pa", forced)
def centre_pressure(history):
    values = features.centre_pressure(shown(history))
    return _ends(shown(history), values) | {"mean": values.mean()}


@measure("s", held)
def peak_time(history):
    """Of the largest centre pressure, refined by a parabola through its neighbours."""
    time, value = history["time"].values, features.centre_pressure(history)
    i = int(value.argmax())
    if i in (0, ramp_end(history), len(time) - 1):
        return time[i]
    a, b, _ = np.polyfit(time[i - 1 : i + 2] - time[i], value[i - 1 : i + 2], 2)
    return time[i] - b / (2 * a) if a < 0 else time[i]


def _first_peak(history: xr.Dataset) -> dict[str, int]:
    """Outputs of the first peak of the centre pressure within the ramp, of the dip after it, and of
    the ramp's end.
    """
    top = ramp_end(history)
    p = features.centre_pressure(history)[: top + 1]
    inner = [i for i in range(1, top) if p[i] > p[i - 1] and p[i] >= p[i + 1]]
    return (
        {"first": inner[0], "dip": inner[0] + int(p[inner[0] :].argmin()), "top": top}
        if inner
        else {"top": top}
    )


@measure("1", held)
def off_centre_excess(history):
    """Of the largest pressure over the centre's: at the end, and the largest at any time; 0 while
    the centre does not touch.
    """
    pressure = history[PRESSURE].values
    centre = pressure[:, centre_node(history)]
    excess = np.divide(pressure.max(axis=1), centre, out=np.ones_like(centre), where=centre > 0) - 1
    return {"end": excess[-1], "ever": excess[1:].max()}


def _off_centre(history: xr.Dataset) -> float:
    """Distance (m) of the node of the largest pressure from the centre, at the end."""
    x, p = profile(history, -1)
    return abs(x[p.argmax()])


@measure("1", held)
def asymmetry(history):
    """Largest difference of the pressure from its mirror image, over the largest pressure."""
    p = history[PRESSURE].values
    return abs(p - p[:, ::-1]).max() / p.max()


def _peak_place(history: xr.Dataset, index: int) -> float:
    """Distance (m) of the pressure peak from the centre, between nodes by a parabola through five
    of them.
    """
    x, p = profile(history, index)
    half = np.arange(centre_node(history), len(x))
    node = half[int(p[half].argmax())]
    if node == half[0]:
        return 0.0
    near = np.arange(node - 2, node + 3)
    a, b, _ = np.polyfit(x[near] - x[node], p[near], 2)
    return float(x[node] - b / (2 * a)) if a < 0 else float(x[node])


@measure("mm", held)
def peak_place(history):
    top = ramp_end(history)
    outputs = {"early": max(1, top // 4), "top": top, "end": history.sizes["time"] - 1}
    return {k: 1e3 * _peak_place(history, i) for k, i in outputs.items()}


@measure("mm", held)
def critical_distance(history):
    """Distance from the pressure peak to the contact's edge, of the profiles that Fig 4-14 shows
    and whose peak has left the centre: mean, least and most.
    """
    peaks = {i: _peak_place(history, i) for i, _ in phase_indices(history)}
    edges = history["contact_width"].values / 2
    found = [1e3 * (edges[i] - place) for i, place in peaks.items() if place > 0]
    made = {"mean": np.mean, "least": min, "most": max}
    return {k: of(found) if found else np.nan for k, of in made.items()}


# --- decay in the hold ----------------------------------------------------------------------------


def _decay(history: xr.Dataset, values: np.ndarray) -> tuple[float, float]:
    """Relative fall over the hold and time (s) to half of it."""
    top = ramp_end(history)
    held, time = values[top:], history.variables["time"].values[top:]
    fall = float(1 - held[-1] / held[0]) if held[0] else float("nan")
    if not fall > 0:
        return fall, float("nan")
    share = (held[0] - held) / (held[0] - held[-1])
    return fall, float(np.interp(0.5, np.maximum.accumulate(share), time - time[0]))


def _falls(history: xr.Dataset) -> dict[str, tuple[float, float]]:
    traces = {
        "largest": features.peak_pressure(history),
        "centre": features.centre_pressure(history),
    }
    return {k: _decay(history, v) for k, v in traces.items()}


@measure("s", held)
def half_of_fall(history):
    """Time to half of the fall of the pressure: of the largest, of the centre's, and at nodes past
    the peak.
    """
    found = [
        _decay(history, values)[1] for values in history[PRESSURE].values.T[_past_peak(history)]
    ]
    spread = (
        {"shortest": min(found), "longest": max(found), "mean": np.mean(found)} if found else {}
    )
    return {k: half for k, (_, half) in _falls(history).items()} | spread


def _past_peak(history: xr.Dataset) -> np.ndarray:
    """Skin nodes from the centre to 0.6 mm within the contact's edge at the ramp's end."""
    nodes, half_width = (
        surface_nodes(history),
        history["contact_width"].values[ramp_end(history)] / 2,
    )
    return nodes[history["skin_x"].values[nodes] < half_width - 0.6e-3]


def _late_peaks(history: xr.Dataset) -> np.ndarray:
    """Largest pressure (Pa) of each node that joins in the hold, from the centre outwards."""
    pressure = history[PRESSURE].values[:, surface_nodes(history)]
    return pressure[:, (pressure > 0).argmax(axis=0) > ramp_end(history)].max(axis=0)


@measure("count", held)
def late_nodes(history):
    """Nodes that join in the hold, and those of them that reach a higher peak than the one
    before.
    """
    peaks = _late_peaks(history)
    return {"all": len(peaks), "higher": (np.diff(peaks) > 0).sum()}


@measure("Pa", held)
def late_peak(history):
    """Peaks of the nodes that join in the hold: the first, the last and the highest."""
    peaks = _late_peaks(history)
    return {"first": peaks[0], "last": peaks[-1], "highest": peaks.max()} if len(peaks) else {}


@measure("s", held)
def late_rise(history):
    """Time from the contact to the largest pressure of the nodes that join in the hold: the first,
    the last, and the largest increase from one to the next; nothing of fewer than two nodes.
    """
    pressure = history[PRESSURE].values[:, surface_nodes(history)]
    joins, time = (pressure > 0).argmax(axis=0), history["time"].values
    rises = (time[pressure.argmax(axis=0)] - time[joins - 1])[joins > ramp_end(history)]
    if len(rises) < 2:
        return {}
    return {"first": rises[0], "last": rises[-1], "increase": np.diff(rises).max()}


@measure("1", lambda scene: scene.name == NINE[NODE_SURFACE])
def residual_of_eq_4_1(history):
    """Root mean square over the pressure's, of each node of Fig 4-17 from its peak on, by one set
    of constants.
    """
    nodes = contact_nodes(history, NODE_COUNT)
    law = pressure_by_law("4-1", nodes, fit_nodes("4-1", nodes))
    return {
        f"{x:.3f} mm": rms(rows[P] - rows[P_LAW]) / rms(rows[P]) for x, rows in law.groupby(NODE)
    }


@measure("mm", held)
def falls_up_to(history):
    """Distance from the centre beyond which the pressure rises in the hold; NaN where none does or
    where the two mingle.
    """
    nodes, top = surface_nodes(history), ramp_end(history)
    change = history[PRESSURE].values[-1, nodes] - history[PRESSURE].values[top, nodes]
    rising = np.flatnonzero(change > 0)
    parted = (
        rising.size > 0 and (change[: rising[0]] < 0).all() and (change[rising[0] :] >= 0).all()
    )
    return 1e3 * history["skin_x"].values[nodes][rising[0]] if parted else np.nan


# --- strain energy --------------------------------------------------------------------------------


def _traces(history: xr.Dataset) -> dict[str, np.ndarray]:
    """Strain energy (time) Pa at the thesis's receptors: under the centre, beside it, and by other
    definitions.
    """
    places = {f"{z} um": (z * 1e-6, 0.0, "strain_energy_density") for z in (*UM, 935)}
    places |= {
        f"915 um, {side}46 um": (DEPTH, x, "strain_energy_density")
        for side, x in (("-", -BESIDE), ("", BESIDE))
    }
    places |= {f"915 um, {k}": (DEPTH, 0.0, v) for k, v in ENERGIES.items()}
    found = {}
    for condition, (z, x, name) in places.items():
        try:
            found[condition] = energy(history, z, x, name)
        except KeyError:
            continue
    return found


@measure("1", lambda scene: held(scene) and scene.name in FAST.values())
def energy_peak_offset(history):
    """Distance of the largest energy from the centre at top and end, the larger, over the spacing
    of the receptors.
    """
    found = {}
    for depth in (800e-6, 915e-6):
        row = receptors_at(history, depth)
        offset = history["receptor_offset"].values[row]
        if len(row) < 5:
            raise KeyError("receptors beside the centre")
        values = history["strain_energy_density"].values[[ramp_end(history), -1]][:, row]
        found[f"{depth * 1e6:.0f} um"] = (
            abs(offset[values.argmax(axis=1)]).max() / np.diff(offset).max()
        )
    return found


_PLAIN = {ridged: NINE[label] for label, ridged in RIDGED_NINE.items()}


@measure("1", lambda scene: scene.name in _PLAIN, beside=True)
def correlation_with_plain(history, runs):
    """Over time, of the energy with the plain pad's, at the centre and 46 um beside."""
    plain = runs[_PLAIN[scene_of(history).name]]
    found = {}
    for place, x in (("centre", 0.0), ("46 um", BESIDE)):
        values = np.interp(plain["time"].values, history["time"].values, energy(history, DEPTH, x))
        found[place] = np.corrcoef(values, energy(plain, DEPTH))[0, 1]
    return found


# --- predicted rates ------------------------------------------------------------------------------


@measure("impulses/s", lambda scene: held(scene) or slides(scene))
def rate(history):
    """By Eq 5-1 at 915 um: the highest, means over windows, and at the ends of the hold."""
    frame = predicted_rate(shown(history))
    found = {"peak": frame[IMPULSE_RATE].max(), "end": frame[IMPULSE_RATE].iloc[-1]}
    if is_stroke(history) or ramp_end(history) == history.sizes["time"] - 1:  # nothing is held
        return found
    held = frame[frame[TIME] >= history["time"].values[ramp_end(history)]][IMPULSE_RATE].to_numpy()
    found |= {w: windowed(history, frame[TIME], frame[IMPULSE_RATE], w) for w in ("hold", "steady")}
    return found | (
        {"start of hold": held[1], "highest of hold": held[1:].max()} if len(held) > 1 else {}
    )


@measure("s", held)
def first_impulse(history):
    """Time of the first impulse, without variability; NaN without one."""
    frame = predicted_rate(history)
    train = impulses(frame[TIME], frame[IMPULSE_RATE])
    return train[0] if len(train) else np.nan


def _nine(runs: Histories) -> dict[str, xr.Dataset]:
    return {label: runs[scene] for label, scene in NINE.items()}


@measure("impulses/s", named(NINE.values()), beside=True)
def rate_at_600_um(history, runs):
    """By Eq 5-1 scaled to the mean energy of the nine surfaces (see `law_at`)."""
    law, _ = law_at(runs, SHALLOW_DEPTH)
    return {window: rate_in(history, window, SHALLOW_DEPTH, law) for window in ("peak", "hold")}


def _residuals(column: str) -> Callable[..., dict[str, float]]:
    """Root mean square of what a law leaves over the energy's, of each of the nine surfaces by one
    fit.
    """
    return lambda history, runs: {
        k: rms(f[SED] - f[column]) / rms(f[SED]) for k, f in _by_pressure(runs).items()
    }


def _falls_by(column: str) -> Callable[..., dict[str, float]]:
    """Relative fall in the hold of the energy by a law, of each of the nine surfaces."""
    return lambda history, runs: {
        k: 1 - f[column].iloc[-1] / f[column].iloc[ramp_end(runs[NINE[k]])]
        for k, f in _by_pressure(runs).items()
    }


@kept
def _by_pressure(runs: Histories) -> dict[str, pd.DataFrame]:
    laws = laws_of_sum(runs)
    return {k: energy_from_pressure(h, RECEPTOR_DEPTH, laws) for k, h in _nine(runs).items()}


BY_PRESSURE = tuple(
    Measure(f"{what}_{law}", "1", read(column), named([NINE["flat"]]), beside=True)
    for law, column in (("eq_4_4", SED_LAW), ("square", SED_SQUARE))
    for what, read in (("residual_of", _residuals), ("fall_by", _falls_by))
)


def _pressure_or_energy(history: xr.Dataset) -> float:
    """The larger of 0.04 x centre pressure and strain energy (Pa), as Fig 4-21 shows them."""
    return max(
        PRESSURE_SCALE * features.centre_pressure(history).max(), energy(history, DEPTH).max()
    )


PLAIN = (
    Measure("simulated", "count", lambda h: 1),
    Measure("ramp_end_time", "s", lambda h: h["time"].values[ramp_end(h)], pressing),
    Measure("depth", "mm", lambda h: _ends(h, 1e3 * h["indentation_depth"].values), pressing),
    Measure("width", "mm", lambda h: _ends(h, 1e3 * h["contact_width"].values), pressing),
    Measure("half_width", "mm", lambda h: 1e3 * h["contact_width"].values[-1] / 2, pressing),
    # largest downward displacement of any skin node; where a depth is prescribed, it is that, to
    # 0.1 um
    Measure("sunk", "mm", lambda h: -1e3 * h["skin_displacement_y"].values.min(), pressing),
    Measure(
        "deflection",
        "mm",
        lambda h: round(-1e3 * float(h["skin_displacement_y"].values.min()), 4),
        deep,
    ),
    Measure("largest_force", "N", lambda h: force_N(h).max(), deep),
)

PRESSURE_MEASURES = (
    Measure("highest_pressure", "Pa", lambda h: _ends(h, features.peak_pressure(h)), pressing),
    # at the first peak within the ramp, at the dip after it and at the ramp's end; without one the
    # last alone
    Measure(
        "ramp_pressure",
        "Pa",
        lambda h: {k: features.centre_pressure(h)[i] for k, i in _first_peak(h).items()},
        held,
    ),
    Measure(
        "ramp_pressure_time",
        "s",
        lambda h: {k: h["time"].values[i] for k, i in _first_peak(h).items()},
        held,
    ),
    Measure("off_centre_place", "mm", lambda h: 1e3 * _off_centre(h), held),
    Measure("fall_in_hold", "1", lambda h: {k: fall for k, (fall, _) in _falls(h).items()}, held),
    Measure("nodes_past_peak", "count", lambda h: len(_past_peak(h)), held),
)

ENERGY_MEASURES = (
    Measure(
        "highest_energy", "Pa", lambda h: {k: v.max() for k, v in _traces(shown(h)).items()}, forced
    ),
    Measure(
        "energy_at_top",
        "Pa",
        lambda h: {k: v[ramp_end(h)] for k, v in _traces(h).items()},
        pressing,
    ),
    Measure(
        "energy_at_end", "Pa", lambda h: {k: v[-1] for k, v in _traces(shown(h)).items()}, forced
    ),
    # as Fig 4-21 shows them
    Measure("pressure_or_energy", "Pa", _pressure_or_energy, pressing),
    Measure(
        "highest_energy_rate",
        "Pa/s",
        lambda h: peak_energy_rate(shown(h), RECEPTOR_DEPTH),
        lambda s: held(s) or slides(s),
    ),
    Measure(
        "rate_peak_time",
        "s",
        lambda h: predicted_rate(h).set_index(TIME)[IMPULSE_RATE].idxmax(),
        held,
    ),
)

"""Predicted impulse rates of pressed surfaces in numbers, and the numbers and trends of chapter 4 that rest on them."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from fingerpad.claims.verdicts import Trend, everywhere
from fingerpad.measures.features import SURFACES, peak_pressure, ramp_end, scene_name
from fingerpad.measures.quantities import SED, TIME
from fingerpad.measures.responses import (
    IMPULSE_RATE,
    RECEPTOR_DEPTH,
    SED_LAW,
    SHALLOW_DEPTH,
    curvature_of,
    energy_from_pressure,
    fit_sum,
    peak_energy_rate,
    predicted_rate,
    rate_in,
    shallow_law,
    straight_line,
)
from fingerpad.receptors.fits import rms
from fingerpad.receptors.spikes import impulses

if TYPE_CHECKING:
    from fingerpad.claims.numbers import Results

NODE_SURFACE, NODE_COUNT = "210", 12
"""Surface and number of nodes of Fig 4-17."""
TRIALS = 4
"""Trials of a surface in Fig 4-2."""
LINEAR = 0.9
"""Least R2 of a line to call points linear."""
DELAY = 0.02
"""s; least time to the first impulse to call it delayed: a fraction of what a raster of 2.4 s lets one see."""
AGREES = 0.1
"""Largest root-mean-square residual, relative, to call traces in agreement."""


# --- numbers ---------------------------------------------------------------------------------------------


def _held(results: Results, *labels: str, programme: str = "ramp40") -> float:
    """Mean rate of the hold, mean over surfaces."""
    return float(np.mean([rate_in(results(label, programme), "hold") for label in labels]))


def _highest(window: str, programme: str = "ramp40") -> Callable[[Results], float]:
    return lambda r: max(rate_in(r(label, programme), window) for label in SURFACES)


def _highest_shallow(window: str) -> Callable[[Results], float]:
    def number(results: Results) -> float:
        surfaces = {label: results(label) for label in SURFACES}
        law, _ = shallow_law(surfaces)
        return max(rate_in(history, window, SHALLOW_DEPTH, law) for history in surfaces.values())

    return number


HELD_RATES = {"flat": "T107", "79": "T109", "105": "T111", "158": "T113", "420": "T117", "630": "T119", "1260": "T121"}
"""Ids of the ranges of the rate in the hold of Fig 4-9, by surface."""
_PRINTED = {
    "T083": ("1260",),
    "T084": ("630",),
    "T085": ("315", "420"),
    "T086": ("210", "315"),
    "T087": ("105", "158"),
}

RESPONSE_GIVEN: dict[str, Callable[[Results], float]] = {
    "T079": lambda r: TRIALS,
    "T092": lambda r: sum(scene_name("ramp40", label) in r.histories for label in SURFACES),
    "T152": lambda r: NODE_COUNT,
}
"""Counts, which have no discretisation error."""

RESPONSE_NUMBERS: dict[str, Callable[[Results], float]] = {
    **RESPONSE_GIVEN,
    **{id_: (lambda r, k=labels: _held(r, *k, programme="ramp150")) for id_, labels in _PRINTED.items()},
    **dict.fromkeys(("T090", "T094", "T096", "T160", "T207"), _highest("peak")),
    "T095": _highest("steady"),
    **{id_: (lambda r, k=label: _held(r, k)) for label, id_ in HELD_RATES.items()},
    **dict.fromkeys(("T161", "T203"), _highest("hold")),
    "T201": _highest("hold", "ramp150"),
    "T204": _highest_shallow("hold"),
    "T207a": _highest_shallow("peak"),
}
"""Every number of chapter 4's rates that has a row, by id."""


# --- trends ----------------------------------------------------------------------------------------------


def _by_surface(results: Results, window: str, programme: str = "ramp40", **how) -> np.ndarray:
    return np.array([rate_in(results(label, programme), window, **how) for label in SURFACES])


def _grows(values: np.ndarray, what: str, silent: bool = False) -> Trend:
    """Whether rates grow from surface to surface; `silent` ones may come first."""
    first = int(np.argmax(values > 0)) if silent else 0
    wrong = [f"{SURFACES[first + i]} to {SURFACES[first + i + 1]}" for i in np.flatnonzero(np.diff(values[first:]) <= 0)]
    note = f"{what} {values[first]:.1f} ({SURFACES[first]}) to {values[-1]:.1f} (1260) impulses/s"
    note += f"; none under {', '.join(SURFACES[:first])}" if first else ""
    return Trend(values[-1] > 0 and not wrong, len(values) - first - len(wrong), "; not from ".join([note, *wrong[:1]]))


def _begins_late(results: Results) -> Trend:
    starts, delays = {}, []
    for label in SURFACES:
        frame = predicted_rate(results(label, "ramp150"))
        train = impulses(frame[TIME], frame[IMPULSE_RATE])
        if len(train):
            starts[label] = bool(train[0] >= DELAY)
            delays.append(train[0])
    note = f"first impulse {min(delays):.3f} to {max(delays):.3f} s after the start, with no variability" if delays else ""
    return everywhere(starts, note, max(len(starts), 1))


def _peaks_and_decays(results: Results) -> Trend:
    outcome = {}
    for label in SURFACES:
        history = results(label)
        frame, top = predicted_rate(history), float(history["time"].values[ramp_end(history)])
        held = frame[frame[TIME] >= top][IMPULSE_RATE].to_numpy()
        if held[1:].max() > 0:
            outcome[label] = bool(np.isclose(frame[TIME][frame[IMPULSE_RATE].idxmax()], top) and held[-1] < held[1])
    return everywhere(outcome, f"{len(outcome)} surfaces make impulses in the hold", max(len(outcome), 1))


def _linear(x: np.ndarray, y: np.ndarray, what: str) -> Trend:
    slope, _, share = straight_line(x, y)
    return Trend(bool(share >= LINEAR and slope > 0), share, what)


def _saturates(results: Results) -> Trend:
    curvature = np.array([curvature_of(results(label)) for label in SURFACES])
    outcome, notes = {}, []
    for window in ("peak", "steady"):
        rate = _by_surface(results, window)
        slope, _, share = straight_line(curvature[:-1], rate[:-1])
        last = (rate[-1] - rate[-2]) / (curvature[-1] - curvature[-2])
        outcome[window] = bool(share >= LINEAR and last < 0.5 * slope)
        notes.append(f"{window}: R2 {share:.3f} without the highest, slope to it {last / slope:.2f} of the others'")
    return everywhere(outcome, "; ".join(notes))


def _pressure_gives_energy(results: Results) -> Trend:
    surfaces = {label: results(label) for label in SURFACES}
    law = fit_sum(surfaces.values(), RECEPTOR_DEPTH)
    left, falls = {}, 0
    for label, history in surfaces.items():
        frame, top = energy_from_pressure(history, RECEPTOR_DEPTH, law), ramp_end(history)
        left[label] = rms(frame[SED] - frame[SED_LAW]) / rms(frame[SED])
        falls += bool(frame[SED_LAW].iloc[-1] < frame[SED_LAW].iloc[top])
    note = f"residual {min(left.values()):.0%} to {max(left.values()):.0%}; falls in the hold by Eq 4-4 under {falls} surfaces"
    return everywhere({label: share <= AGREES for label, share in left.items()}, note)


def _stands_out_by_depth(results: Results) -> Trend:
    law, _ = shallow_law({label: results(label) for label in SURFACES})
    shallow, deep = (
        rate_in(results("1260"), "hold", **how) / max(rate_in(results("210"), "hold", **how), 1e-9)
        for how in ({"depth": SHALLOW_DEPTH, "law": law}, {})
    )
    return Trend(bool(shallow > deep), shallow / deep, f"1260 over 210: {shallow:.1f} from 600 um, {deep:.1f} from 915 um")


RESPONSE_TRENDS: dict[str, Callable[[Results], Trend]] = {
    "TR80": lambda r: _grows(_by_surface(r, "hold", "ramp150"), "mean of the hold", silent=True),
    "TR81": _begins_late,
    "TR82": _peaks_and_decays,
    "TR83": lambda r: _grows(_by_surface(r, "peak"), "peak"),
    "TR84": lambda r: _linear(_by_surface(r, "peak"), _by_surface(r, "steady"), "predicted rates, R2 of the line"),
    "TR85": _saturates,
    "TR86": lambda r: _linear(
        np.array([float(peak_pressure(r(label)).max()) for label in SURFACES]),
        _by_surface(r, "peak"),
        "predicted rates, R2 of the line",
    ),
    "TR87": _pressure_gives_energy,
    "TR88": _stands_out_by_depth,
    "TR89": lambda r: _linear(
        np.array([peak_energy_rate(r(label), RECEPTOR_DEPTH) for label in SURFACES]),
        _by_surface(r, "peak"),
        "predicted rates, R2 of the line",
    ),
}
"""Trends of the rates that the thesis states, tested on predicted ones, by id."""

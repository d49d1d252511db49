"""Trends the thesis states in chapter 5, tested on strokes over the wavy surface: one function an id of the reference."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fingerpad.claims.stroke_numbers import PRESSED, pressure_lag, profile_shifts, stroke_of
from fingerpad.claims.verdicts import Trend, everywhere
from fingerpad.measures.features import PRESSURE, Trace, centre_pressure, scene_name
from fingerpad.measures.skin import WINDOW, skin_curvature
from fingerpad.measures.strokes import (
    FULL,
    NODES,
    STEPPED,
    SUB,
    arcs,
    centre_curvature,
    contact_lengths,
    convexities,
    distance,
    embedded,
    energy_at,
    lost_contacts,
    nodes_at,
    passing,
    peaks,
    place,
    scaled,
    touching,
)

if TYPE_CHECKING:
    from fingerpad.claims.numbers import Results

FOLLOWS = 0.9
"""Least correlation of a trace that follows another."""

HARDLY = 10.0
"""Largest spread (%) over the velocities that hardly matters: standard deviation over mean."""

ALIKE = 0.15
"""Largest relative difference of values that are about the same."""

PROMINENCE = 0.005
"""Least prominence of a peak of strain energy, relative to the largest value while the convexity passes."""

ENERGY, SHALLOW = energy_at(915e-6), energy_at(560e-6)


# --- pressure and curvature ------------------------------------------------------------------------------


def _follows(scene: str) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        stroke = stroke_of(results, scene)
        pressure, where = centre_pressure(stroke), touching(stroke)
        fit, slope, offset, likeness = scaled(centre_curvature(stroke), pressure, where)
        miss = float(np.sqrt(np.mean((fit - pressure)[where] ** 2)))
        note = f"pressure = {slope:.1f} Pa m x curvature + {offset:.0f} Pa, root mean square misfit {miss:.0f} Pa"
        return Trend(likeness >= FOLLOWS, likeness, f"correlation {likeness:.3f}; {note}")

    return check


def _follows_at_nodes(results: Results) -> Trend:
    stroke = stroke_of(results, SUB["10"])
    found = {}
    for at, node in zip(NODES, nodes_at(stroke), strict=True):
        pressure = stroke[PRESSURE].values[:, node]
        found[f"{at:g} mm"] = scaled(skin_curvature(stroke, node), pressure, pressure > 0)[3]
    note = f"correlations {min(found.values()):.3f} to {max(found.values()):.3f}"
    return everywhere({k: v >= FOLLOWS for k, v in found.items()}, note)


def _curvature_of_surface(results: Results) -> Trend:
    """On every convexity, where what the curvature is fitted through touches it, within 5 % (median)."""
    outcome, worst = {}, 0.0
    for speed, scene in FULL.items():
        stroke = stroke_of(results, scene)
        found, under = centre_curvature(stroke), place(stroke)
        for label, arc in convexities(stroke).items():
            inner = embedded(stroke) & (under > arc.start + WINDOW) & (under < arc.end - WINDOW)
            miss = abs(found[inner] / arc.curvature - 1)
            outcome[f"{label} at {speed} mm/s"] = bool(miss.size and np.median(miss) <= 0.05)
            worst = max(worst, float(np.median(miss))) if miss.size else worst
    return everywhere(outcome, f"largest median difference on a convexity {worst:.1%}")


def _peaks_grow(results: Results) -> Trend:
    outcome = {}
    for speed, scene in FULL.items():
        found = list(peaks(stroke_of(results, scene), centre_pressure).values())
        outcome[f"{speed} mm/s"] = bool((np.diff(found) > 0).all())
    found = peaks(stroke_of(results, FULL["10"]), centre_pressure)
    return everywhere(outcome, "10 mm/s: " + listed(found, "Pa"))


def listed(values: Mapping[str, float], unit: str, digits: int = 3) -> str:
    """Labelled values with their unit, to some digits."""
    return ", ".join(f"{k}: {v:.{digits}g}" for k, v in values.items()) + f" {unit}"


# --- velocity ------------------------------------------------------------------------------------------------


def spreads(values: list[dict[str, float]]) -> dict[str, float]:
    """Spread (%) of each labelled value over the velocities: standard deviation over mean."""
    return {k: 100 * float(np.std([v[k] for v in values]) / (np.mean([v[k] for v in values]) or np.nan)) for k in values[0]}


def _hardly_matters(trace: Trace) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        strokes = [stroke_of(results, name) for name in FULL.values()]
        found = [peaks(s, trace) for s in strokes]
        spread, change = spreads(found), {k: 100 * (found[-1][k] / found[0][k] - 1) for k in found[0]}
        worst = max(spread, key=spread.get)
        d = distance(strokes[0])
        traces = np.array([np.interp(d, distance(s), trace(s)) for s in strokes])
        whole = 100 * float(np.sqrt(np.mean(traces.std(axis=0) ** 2) / np.mean(traces**2)))
        note = f"peaks spread by {np.mean(list(spread.values())):.1f} % on average, at most {spread[worst]:.1f} % (K = {worst}); "
        note += f"whole traces by {whole:.1f} %; change of the peaks from 1 to 40 mm/s " + listed(change, "%", 2)
        return Trend(spread[worst] <= HARDLY, spread[worst], note)

    return check


def _length_hardly_varies(results: Results) -> Trend:
    spread = spreads([contact_lengths(stroke_of(results, FULL[v])) for v in ("5", "10", "20", "40")])
    worst = max(spread, key=spread.get)
    return Trend(spread[worst] <= HARDLY, spread[worst], "spread over velocities " + listed(spread, "%", 2))


def _length_falls(results: Results) -> Trend:
    found = {k: 1e3 * v for k, v in contact_lengths(stroke_of(results, FULL["10"])).items()}
    falls = [True, *(b < a for a, b in pairwise(found.values()))]
    return everywhere(dict(zip(found, falls, strict=True)), listed(found, "mm"))


# --- stepped and stroked ---------------------------------------------------------------------------------


def _alike(results: Results) -> Trend:
    shift, likeness = pressure_lag(results)
    stroke, stepped = (centre_pressure(stroke_of(results, name)) for name in (SUB["10"], STEPPED))
    shifts = ", ".join(f"{1e3 * s:.2f}" for s in profile_shifts(results))
    note = f"correlation {likeness:.3f} at a lag of {1e3 * shift:.2f} mm; profiles at the three locations {shifts} mm to the left"
    note += f"; mean pressure {stroke.mean():.0f} Pa stroked, {stepped.mean():.0f} Pa stepped"
    return Trend(likeness >= FOLLOWS and abs(stroke.mean() / stepped.mean() - 1) <= ALIKE, likeness, note)


def _start_peak(stroke: xr.Dataset, start: float, end: float) -> float:
    """Largest centre pressure (Pa) over the first third of an arc."""
    under = place(stroke)
    return float(centre_pressure(stroke)[(under >= start) & (under <= start + (end - start) / 3)].max())


def _peaks_higher(results: Results) -> Trend:
    stroke, stepped = stroke_of(results, SUB["10"]), stroke_of(results, STEPPED)
    outcome, shown = {}, []
    for arc in arcs(stroke):
        name = f"K = {arc.curvature:.0f}"
        high, low = (_start_peak(s, arc.start, arc.end) for s in (stroke, stepped))
        outcome[name] = high > low
        shown.append(f"{name}: {high:.0f} against {low:.0f} Pa")
    return everywhere(outcome, ", ".join(shown))


# --- contact lost --------------------------------------------------------------------------------------------


def _loss_in(stroke: xr.Dataset, low: float, high: float) -> float:
    """Length (m) of surface without contact between two points of it."""
    return sum(max(0.0, min(b, high) - max(a, low)) for a, b in lost_contacts(stroke))


def _before(stroke: xr.Dataset) -> tuple[float, float]:
    """Length (m) of surface without contact before the first and before the second convexity.

    Before the first: within 2 mm of the sharp corner; before the second: from the middle of the concavity to a quarter into it.
    """
    first, second = list(convexities(stroke).values())[:2]
    return (
        _loss_in(stroke, first.start - 2e-3, first.start + 2e-3),
        _loss_in(stroke, (first.end + second.start) / 2, second.start + (second.end - second.start) / 4),
    )


def _lost_at_corner(results: Results) -> Trend:
    stroke = stroke_of(results, STEPPED)
    corner = convexities(stroke)["26"].start
    index = int(abs(place(stroke) - corner).argmin())
    pressure, length = float(centre_pressure(stroke)[index]), 1e3 * _before(stroke)[0]
    note = f"centre pressure {pressure:.0f} Pa at the corner, zero over {length:.2f} mm"
    return Trend(pressure == 0, length, note)


def _lost_later(results: Results) -> Trend:
    found = []
    for scene in (STEPPED, SUB["10"]):
        stroke = stroke_of(results, scene)
        free = distance(stroke)[~touching(stroke)]
        corner = convexities(stroke)["26"].start
        near = free[abs(free - corner) < 4e-3]
        found.append(float(near.mean()) if near.size else float("nan"))
    delay = 1e3 * (found[1] - found[0])
    note = f"out of contact about {1e3 * found[0]:.1f} mm stepped, {1e3 * found[1]:.1f} mm stroked"
    return Trend(delay > 0, delay, note)


def _before_both(results: Results) -> Trend:
    lengths = _before(stroke_of(results, SUB["40"]))
    return Trend(min(lengths) > 0, sum(v > 0 for v in lengths), "out of contact " + _lost(lengths))


def _lost(lengths: tuple[float, float]) -> str:
    return f"over {1e3 * lengths[0]:.2f} mm at the corner and {1e3 * lengths[1]:.2f} mm before the second convexity"


def _kept_when_slow(results: Results) -> Trend:
    found = {f"{v} mm/s": _before(stroke_of(results, SUB[v])) for v in ("1", "10")}
    note = "; ".join(f"{k}: {_lost(v)}" for k, v in found.items())
    return everywhere({k: v[1] == 0 for k, v in found.items()}, note)


# --- strain energy ---------------------------------------------------------------------------------------------


def _falls_for_sharpest(results: Results) -> Trend:
    outcome = {}
    for speed, scene in FULL.items():
        *_, before, last_but_one, last = peaks(stroke_of(results, scene), ENERGY).values()
        outcome[f"{speed} mm/s"] = before > last_but_one > last
    note = "10 mm/s: " + listed(peaks(stroke_of(results, FULL["10"]), ENERGY), "Pa")
    return everywhere(outcome, note)


def _stroked_over_pressed(results: Results) -> dict[str, float]:
    """Peak strain energy stroked over that pressed, at the cylinders' curvatures (stroked: interpolated)."""
    stroke = stroke_of(results, FULL["10"])
    found, exact = peaks(stroke, ENERGY), [arc.curvature for arc in convexities(stroke).values()]
    pressed = {k: float(ENERGY(results.histories[scene_name("ramp40", k)]).max()) for k in PRESSED}
    return {k: float(np.interp(float(k), exact, list(found.values()))) / v for k, v in pressed.items()}


def _as_high(results: Results) -> Trend:
    ratio = _stroked_over_pressed(results)[PRESSED[0]]
    return Trend(abs(ratio - 1) <= ALIKE, ratio, f"stroked over pressed at K = {PRESSED[0]}: {ratio:.2f}")


def _falls_below(results: Results) -> Trend:
    ratios = _stroked_over_pressed(results)
    values = list(ratios.values())
    below = values[next((i for i, v in enumerate(values) if v < 1), len(values)) :]
    falls = len(below) > 1 and max(below) < 1 and bool((np.diff(below) < 0).all())
    return Trend(falls, values[-1], "stroked over pressed " + listed(ratios, "", 2).strip())


def double_peak(stroke: xr.Dataset, label: str) -> float:
    """Distance (m) between the two most prominent peaks of strain energy at 560 um while a convexity passes; NaN with fewer."""
    from scipy.signal import find_peaks  # here, for it is slow to import

    inside = passing(stroke, convexities(stroke)[label])
    values, d = SHALLOW(stroke)[inside], distance(stroke)[inside]
    found, properties = find_peaks(values, prominence=PROMINENCE * values.max())
    if len(found) < 2:
        return float("nan")
    first, second = sorted(found[np.argsort(properties["prominences"])[-2:]])
    return float(d[second] - d[first])


def _double(results: Results) -> Trend:
    outcome = {}
    for speed, scene in FULL.items():
        stroke = stroke_of(results, scene)
        outcome |= {f"{k} at {speed} mm/s": double_peak(stroke, k) > 0 for k in ("52", "79")}
    stroke = stroke_of(results, FULL["10"])
    apart = {k: 1e3 * double_peak(stroke, k) for k in convexities(stroke)}
    return everywhere(outcome, "apart at 10 mm/s " + listed({k: v for k, v in apart.items() if v > 0}, "mm"))


def _closer(results: Results) -> Trend:
    outcome, notes = {}, []
    for speed, scene in FULL.items():
        stroke = stroke_of(results, scene)
        apart = [double_peak(stroke, k) for k in ("52", "79", "105")]
        seen = [v for v in apart if v > 0]
        outcome[f"{speed} mm/s"] = len(seen) >= 2 and bool((np.diff(seen) < 0).all())
        notes.append(f"{speed} mm/s: " + ", ".join(f"{1e3 * v:.1f}" for v in seen))
    return everywhere(outcome, "mm apart from K = 52 on, " + "; ".join(notes))


STROKE_TRENDS: dict[str, Callable[[Results], Trend]] = {
    "T263": _falls_for_sharpest,
    "TR24": _follows(STEPPED),
    "TR25": _follows_at_nodes,
    "TR26": _follows(FULL["10"]),
    "TR27": _curvature_of_surface,
    "TR28": _peaks_grow,
    "TR29": _hardly_matters(centre_pressure),
    "TR30": _hardly_matters(ENERGY),
    "TR31": _length_hardly_varies,
    "TR32": _length_falls,
    "TR33": _alike,
    "TR34": _peaks_higher,
    "TR35": _lost_at_corner,
    "TR36": _lost_later,
    "TR37": _before_both,
    "TR38": _kept_when_slow,
    "TR39": _as_high,
    "TR40": _falls_below,
    "TR41": _double,
    "TR42": _closer,
}
"""Every trend of chapter 5 that has a row, by id."""

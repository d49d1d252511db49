"""Numbers of the thesis's chapter 5, read from strokes over the wavy surface: one function an id of the reference."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fingerpad.measures.features import PRESSURE, SURFACES, centre_pressure, energy, force_gf, profile, scene_name, scene_of
from fingerpad.measures.strokes import (
    FULL,
    LOCATIONS,
    NODES,
    STEPPED,
    SUB,
    contact_lengths,
    convexities,
    distance,
    energy_at,
    lag,
    lateral,
    loaded,
    nodes_at,
    place,
    profile_and_height,
    time_of,
)

if TYPE_CHECKING:
    from fingerpad.claims.numbers import Results

Number = Callable[["Results"], float]
PRESSED = tuple(label for label in SURFACES[1:] if float(label) <= 400)
"""Cylinders within the axis of Fig 5-18."""


def stroke_of(results: Results, scene: str) -> xr.Dataset:
    """Loaded outputs of a stroke. Raises KeyError if it was not simulated."""
    return loaded(results.histories[scene])


def _curvature_departure(results: Results) -> float:
    found = convexities(results.histories[FULL["10"]])
    listed = (26, 39, 52, 79, 105, 157, 210, 315)
    return max(100 * abs(arc.curvature / k - 1) for arc, k in zip(found.values(), listed, strict=True))


def _stimulus(scene: str, of: Callable[[dict], float]) -> Number:
    return lambda r: of(scene_of(r.histories[scene])["stimulus"])


def _count(scenes: Iterable[str]) -> Number:
    """How many of some scenes were simulated."""
    return lambda r: sum(scene in r.histories for scene in scenes)


def _height(results: Results) -> float:
    """Height (mm) of the sub-surface between the lowest point of its convexities and the highest of its concavities."""
    history = results.histories[STEPPED]
    ends = [end for arc in convexities(history).values() for end in (arc.start, arc.end)]
    return float(np.ptp(profile_and_height(history)[0].outline(np.linspace(min(ends), max(ends), 4001)))) * 1e3


def _concave(results: Results) -> float:
    shape, _ = profile_and_height(results.histories[STEPPED])
    return -min(piece.curvature for piece in shape.segments)


def _speed(scene: str) -> Number:
    """Mean stroking velocity, mm/s."""

    def number(results: Results) -> float:
        stroke = stroke_of(results, scene)
        return 1e3 * float((distance(stroke)[-1] - distance(stroke)[0]) / time_of(stroke)[-1])

    return number


def _steps(results: Results) -> float:
    return 1e3 * float(np.median(np.diff(distance(stroke_of(results, STEPPED)))))


def _receptor_depth(results: Results) -> float:
    depths = results.histories[FULL["10"]]["receptor_depth"].values
    return 1e6 * float(depths[abs(depths - 560e-6).argmin()])


def _nodes_present(results: Results) -> float:
    """How many of the nine positions of Fig 5-10 have a skin node within half of the thesis's node spacing."""
    history = results.histories[SUB["10"]]
    x = history["skin_x"].values[nodes_at(history)] * 1e3
    return int((abs(x - np.array(NODES)) <= 34e-3).sum())


def _at_location(stroke: xr.Dataset, location: float) -> int:
    return int(abs(distance(stroke) - location * 1e-3).argmin())


def highest_at_locations(stroke: xr.Dataset) -> float:
    """Largest pressure (Pa) of any node at the three locations of Figs 5-5 and 5-6."""
    return max(float(stroke[PRESSURE].values[_at_location(stroke, at)].max()) for at in LOCATIONS)


def _highest_centre(*names: str) -> Number:
    return lambda r: max(float(centre_pressure(stroke_of(r, name)).max()) for name in names)


def _highest_at_nodes(results: Results) -> float:
    stroke = stroke_of(results, SUB["10"])
    return float(stroke[PRESSURE].values[:, nodes_at(stroke)].max())


def _highest_energy(depth: float, start: float = 0.0) -> Number:
    """Largest strain energy density (Pa) of the five strokes at a depth (m), from a stroke distance (m) on."""

    def number(results: Results) -> float:
        strokes = [stroke_of(results, name) for name in FULL.values()]
        return max(float(energy(s, depth)[distance(s) >= start - 1e-9].max()) for s in strokes)

    return number


def _highest_energy_of_both(results: Results) -> float:
    peak = energy_at(915e-6)
    pressed = [float(peak(results.histories[scene_name("ramp40", k)]).max()) for k in PRESSED]
    return max(*pressed, float(peak(stroke_of(results, FULL["10"])).max()))


def profile_shifts(results: Results) -> list[float]:
    """Shift (m) to the left of the pressure profile at each location, stroked at 10 mm/s against stepped."""
    shifts = []
    for location in LOCATIONS:
        x = np.arange(-8e-3, 8e-3, 0.02e-3)
        both = []
        for scene in (SUB["10"], STEPPED):
            stroke = stroke_of(results, scene)
            index, upper = _at_location(stroke, location), stroke["skin_y"].values > 0
            at, pressure = profile(stroke, index)
            both.append(np.interp(x, at[upper], pressure[upper]))
        shifts.append(-lag(x, both[0], x, both[1])[0])
    return shifts


def pressure_lag(results: Results, scene: str = SUB["10"]) -> tuple[float, float]:
    """Lag (m) of the centre pressure of a stroke behind that of the stepped surface, and their correlation when shifted."""
    stroke, stepped = stroke_of(results, scene), stroke_of(results, STEPPED)
    return lag(distance(stroke), centre_pressure(stroke), distance(stepped), centre_pressure(stepped))


def over_convexities(stroke: xr.Dataset) -> np.ndarray:
    """Outputs (time) at which the centre node is under the arcs: from the first corner to the second."""
    arcs = list(convexities(stroke).values())
    return (place(stroke) >= arcs[0].start) & (place(stroke) <= arcs[-1].end)


def _displacement(names: Iterable[str], of: Callable[[np.ndarray], float]) -> Number:
    """A number (mm) of the lateral displacements of the centre node under the arcs, of several strokes together."""

    def number(results: Results) -> float:
        strokes = [stroke_of(results, name) for name in names]
        return 1e3 * float(of(np.concatenate([lateral(s)[over_convexities(s)] for s in strokes])))

    return number


THREE = tuple(FULL[v] for v in SUB)

STROKE_GIVEN: dict[str, Number] = {
    "T210": _curvature_departure,
    "T211": _stimulus(FULL["10"], lambda s: round(1e3 / min(s["curvatures"]), 6)),
    "T212": _count(FULL.values()),
    "T231": _steps,
    "T233": _height,
    "T242": _concave,
    "T243": _stimulus(STEPPED, lambda s: float(np.degrees(s["half_angle"]))),
    "T249": _count(SUB.values()),
    "T251": _nodes_present,
    "T252": _speed(SUB["10"]),
    "T258": _count(FULL.values()),
    "T267": _count(THREE),
    "T306": _receptor_depth,
    "T325": lambda r: scene_of(r.histories[FULL["10"]])["friction"],
    "T326": lambda r: float(force_gf(stroke_of(r, FULL["10"])).mean()),
}
"""What goes into the strokes: inputs, counts and geometry. They have no discretisation error."""

STROKE_NUMBERS: dict[str, Number] = {
    **STROKE_GIVEN,
    "T228": lambda r: 1e3 * max(contact_lengths(stroke_of(r, FULL["10"])).values()),
    "T232": lambda r: 1e3 * float(np.mean(profile_shifts(r))),
    "T232a": lambda r: 1e3 * pressure_lag(r)[0],
    "T240": lambda r: highest_at_locations(stroke_of(r, STEPPED)),
    "T241": lambda r: highest_at_locations(stroke_of(r, SUB["10"])),
    "T245": _highest_centre(STEPPED),
    "T247": _highest_centre(STEPPED, SUB["10"]),
    "T250": _highest_centre(*SUB.values()),
    "T254": _highest_at_nodes,
    "T256": _highest_centre(FULL["10"]),
    "T259": _highest_centre(*FULL.values()),
    "T261": _highest_energy(915e-6),
    "T266": _displacement((FULL["10"],), np.mean),
    "T266a": _displacement(THREE, np.min),
    "T276": _highest_energy_of_both,
    "T307": _highest_energy(560e-6, 40e-3),
}
"""Every number of chapter 5 that has a row, by id."""

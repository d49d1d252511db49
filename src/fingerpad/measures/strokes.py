"""What figures and tables read from strokes: where the surface is, its convexities, and what each
does to the skin.

A stroke is read at its `loaded` outputs, the last one at each stroke distance d: the point x = d of
the surface is then over the middle of the undeformed pad. The node of the skin that lies there at
rest, the centre node, is dragged along, so it touches the point x = d + u of the surface, u being
its lateral displacement.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

from fingerpad.contact_edge import edge_of
from fingerpad.measures.features import PRESSURE, Trace, centre_node, centre_pressure, energy
from fingerpad.measures.kept import kept
from fingerpad.measures.skin import WINDOW, skin_curvature
from fingerpad.results import scene_of
from fingerpad.stimuli.curve import Segment
from fingerpad.stimuli.profile import Profile

SPEEDS = ("1", "5", "10", "20", "40")
"""Stroking velocities, mm/s."""

FULL = {v: f"stroke_{v}" for v in SPEEDS}
"""Strokes over all eight convexities, by velocity."""

SUB = {v: f"stroke_sub_{v}" for v in ("1", "10", "40")}
"""Strokes over the first two convexities, by velocity."""

STEPPED = "step_sub"
"""The first two convexities stepped over the pad: pressed anew every millimetre."""

LOCATIONS = (8.0, 17.0, 26.0)
"""Stroke distances (mm) of Figs 5-5 and 5-6: middles of the thesis's windows at sharp corner,
convexity and concavity.
"""

NODES = (-1.0, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6, 1.0)
"""Lateral positions (mm, undeformed) of the nine nodes of Fig 5-10."""

FINE = 5e-6
"""Stroke distance (m) that the contact of the centre node is resolved to, between outputs."""

_ON_EDGE = 2
"""Of the skin's nodes on an edge of a quadratic element."""

_FAR = 8
"""Spacings by which one edge of the contact is farther than the other one for certain: it lies
within four of its last node.
"""
_BESIDE = 6
"""Spacings of nodes from the edge of the contact within which it is located between them."""


def profile_and_height(history: xr.Dataset) -> tuple[Profile, np.ndarray]:
    """The profile of a history's stimulus and the height (time) m of its origin above the pad's."""
    apex = history["skin_y"].values[centre_node(history)]
    return scene_of(history).stimulus, apex - history["indentation_depth"].values


def arcs(history: xr.Dataset) -> list[Segment]:
    """Arcs of a history's wavy surface in their order, convex (curvature above 0) and hollow
    ones.
    """
    return [piece for piece in scene_of(history).stimulus.segments if piece.curvature]


def convexities(history: xr.Dataset) -> dict[str, Segment]:
    """The convex arcs of a history's wavy surface in their order, by the thesis's name: the
    curvature in 1/m, rounded.
    """
    return {f"{piece.curvature:.0f}": piece for piece in arcs(history) if piece.curvature > 0}


@kept
def loaded(history: xr.Dataset) -> xr.Dataset:
    """The history at its last output of each stroke distance: at the end of the press, and of every
    step that follows.

    What is loaded already is as it is.
    """
    last = np.append(np.diff(distance(history)) != 0, True)
    return history if last.all() else history.isel(time=np.flatnonzero(last))


def distance(stroke: xr.Dataset) -> np.ndarray:
    """Stroke distance (time) m."""
    return stroke.variables["stroke_distance"].values


def time_of(stroke: xr.Dataset) -> np.ndarray:
    """Time (time) s since the surface began to slide."""
    return stroke["time"].values - stroke["time"].values[0]


def lateral(stroke: xr.Dataset) -> np.ndarray:
    """Lateral displacement (time) m of the centre node."""
    return stroke["centre_lateral_displacement"].values


def place(stroke: xr.Dataset) -> np.ndarray:
    """Point of the surface (time), m along it, that the centre node lies under."""
    node = centre_node(stroke)
    at_rest, moved = (
        stroke.variables[name].values[..., node] for name in ("skin_x", "skin_displacement_x")
    )
    return distance(stroke) + at_rest + moved


def touching(stroke: xr.Dataset) -> np.ndarray:
    """Whether (time) the centre node touches."""
    return stroke[PRESSURE].values[:, centre_node(stroke)] > 0


def embedded(stroke: xr.Dataset) -> np.ndarray:
    """Whether (time) every node touches that the curvature at the centre node is fitted through."""
    x, node = stroke["skin_x"].values, centre_node(stroke)
    near = (abs(x - x[node]) < WINDOW) & (stroke["skin_y"].values > 0)
    return (stroke[PRESSURE].values[:, near] > 0).all(axis=1)


def nodes_at(history: xr.Dataset, places: tuple[float, ...] = NODES) -> list[int]:
    """Indices of the upper skin nodes nearest to lateral positions (mm, undeformed)."""
    x = np.where(history["skin_y"].values > 0, history["skin_x"].values, np.inf)
    return [int(np.argmin(abs(x - place * 1e-3))) for place in places]


@kept
def centre_curvature(stroke: xr.Dataset) -> np.ndarray:
    """Curvature (time) 1/m of the skin at the centre node."""
    return skin_curvature(stroke, centre_node(stroke))


def scaled(
    values: np.ndarray, onto: np.ndarray, where: np.ndarray
) -> tuple[np.ndarray, float, float, float]:
    """A linear function A1 * values + A2 closest to `onto` at the outputs `where`: its values, A1,
    A2 and the correlation.
    """
    slope, offset = np.polyfit(values[where], onto[where], 1)
    return (
        slope * values + offset,
        float(slope),
        float(offset),
        float(np.corrcoef(values[where], onto[where])[0, 1]),
    )


def scaled_curvature(stroke: xr.Dataset) -> np.ndarray:
    """Curvature of the skin at the centre node as a linear function that fits the pressure there in
    contact (time), Pa.
    """
    return scaled(centre_curvature(stroke), centre_pressure(stroke), touching(stroke))[0]


@kept
def _finely(stroke: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Place of the centre node and whether it touches, every `FINE` of stroke distance.

    Between outputs both its place and its distance from the edge of the contact, along the
    undeformed skin and below zero outside, are interpolated: the edge passes over the node where
    that changes its sign.
    """
    upper = stroke["skin_y"].values > 0
    x, centre = stroke["skin_x"].values[upper], stroke["skin_x"].values[centre_node(stroke)]
    pressure, inside = stroke[PRESSURE].values[:, upper], touching(stroke)
    apart = abs(x - centre)
    within = np.where((pressure > 0) != inside[:, None], apart, apart.max()).min(axis=1)
    for k in np.flatnonzero((within < _BESIDE * np.sort(apart)[1]) & (pressure > 0).any(axis=1)):
        within[k] = (1 if inside[k] else -1) * _inside(x, pressure[k], centre)
    d = distance(stroke)
    fine = np.arange(d[0], d[-1], FINE)
    return np.interp(fine, d, place(stroke)), np.interp(
        fine, d, np.where(inside, within, -within)
    ) > 0


def _inside(x: np.ndarray, pressure: np.ndarray, place: float) -> float:
    """How far (m) a place is from the nearest edge of the contact, below zero outside; x, pressure
    of ascending nodes.
    """
    on, spacing, deepest = np.flatnonzero(pressure > 0), np.gradient(x), -np.inf
    for run in np.split(on, np.flatnonzero(np.diff(on) > 1) + 1):
        left, right = (
            place - x[run[0]],
            x[run[-1]] - place,
        )  # to the last nodes, from which the edges are not far
        if left < right + _FAR * spacing[run[0]]:
            left += (
                edge_of(-x[run[::-1]], pressure[run[::-1]], spacing[run[0]], _ON_EDGE) + x[run[0]]
            )
        if right < left + _FAR * spacing[run[-1]]:
            right += edge_of(x[run], pressure[run], spacing[run[-1]], _ON_EDGE) - x[run[-1]]
        deepest = max(deepest, min(left, right))
    return deepest


def contact_lengths(stroke: xr.Dataset) -> dict[str, float]:
    """Stroke distance (m) over which the centre node touches each convexity, by the convexity's
    label.
    """
    under, touches = _finely(stroke)
    return {
        k: FINE * float(np.sum(touches & (under >= a.start) & (under < a.end)))
        for k, a in convexities(stroke).items()
    }


def passage(stroke: xr.Dataset, convexity: Segment, beyond: float = 0.0) -> tuple[float, float]:
    """Stretch of the surface (m, along it) between the middles of the concavities on either side of
    a convexity.

    Where there is none it ends where the convexity does, or as far `beyond` as this part of it.
    """
    middles = [(a.start + a.end) / 2 for a in arcs(stroke) if a.curvature < 0]
    margin = beyond * (convexity.end - convexity.start)
    before = max((m for m in middles if m < convexity.start), default=convexity.start - margin)
    after = min((m for m in middles if m > convexity.start), default=convexity.end + margin)
    return before, after


def passing(stroke: xr.Dataset, convexity: Segment) -> np.ndarray:
    """Outputs (time) at which the centre node is in the `passage` of a convexity."""
    (before, after), under = passage(stroke, convexity), place(stroke)
    return (under >= before) & (under <= after)


def passages(stroke: xr.Dataset) -> dict[str, tuple[float, float]]:
    """Stretches of stroke distance (m) in which the centre node is in the `passage` of each
    convexity that it comes to, by the convexity's label; beside a flat as far again as half of the
    convexity.
    """
    under, d = np.maximum.accumulate(place(stroke)), distance(stroke)
    ends = {label: passage(stroke, arc, 0.5) for label, arc in convexities(stroke).items()}
    reached = {label: np.interp(pair, under, d) for label, pair in ends.items()}
    return {label: (float(a), float(b)) for label, (a, b) in reached.items() if b > a}


def peaks(stroke: xr.Dataset, trace: Trace) -> dict[str, float]:
    """Largest value of a trace while each convexity passes, by the convexity's label."""
    values = trace(stroke)
    found = {label: values[passing(stroke, arc)] for label, arc in convexities(stroke).items()}
    return {label: float(part.max()) for label, part in found.items() if part.size}


def lost_contacts(stroke: xr.Dataset) -> list[tuple[float, float]]:
    """Stretches of the surface, m along it, that the centre node passes under without touching; the
    ends left out.
    """
    under, touches = _finely(stroke)
    changes = np.flatnonzero(np.diff(touches.astype(int)))
    return [
        (float(under[i]), float(under[j]))
        for i, j in zip(changes, changes[1:], strict=False)
        if touches[i]
    ]


def lag(
    x: np.ndarray, later: np.ndarray, at: np.ndarray, earlier: np.ndarray, most: float = 3e-3
) -> tuple[float, float]:
    """Shift (m) along x by which one trace follows another most closely, and their correlation when
    shifted by it.

    Positive where `later` (sampled at `x`, m) lies further right: later(at + shift) ~ earlier(at).
    The earlier trace is compared at its own samples `at` (m), those farther than `most` from the
    ends; only the later one is interpolated.
    """
    inside = (at >= x[0] + most) & (at <= x[-1] - most)
    shifts = np.arange(-most, most, 0.02e-3)
    likeness = [
        np.corrcoef(np.interp(at[inside] + s, x, later), earlier[inside])[0, 1] for s in shifts
    ]
    best = int(np.argmax(likeness))
    return float(shifts[best]), float(likeness[best])


def energy_at(depth: float) -> Trace:
    """Trace of the strain energy density (Pa) under the centre at a depth (m)."""
    return lambda stroke: energy(stroke, depth)

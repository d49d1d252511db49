"""What a discretisation is wrong by: measured in the study of accuracy, read between what was measured, and goes on beyond it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

THESIS_ROWS = 7
"""Elements across the epidermis of the thesis's preset."""
COARSER = 1.5
"""Edges of a companion's mesh over those of the run's own."""
ORDER = 1.5
"""With which curves are taken to converge with the mesh: measured ones, at 1 to 2, do so on either side of it."""
REMAINS = 1 / (COARSER**ORDER - 1)
"""What a result is wrong by over what it changes by on its companion's mesh (Richardson 1911)."""
STEPS_REMAIN = 1 / (2.0**ORDER - 1)
"""The same over what it changes by with steps twice as long, of which measured orders are as large."""


@dataclass(frozen=True)
class MeasuredErrors:
    """Largest relative error of depth, width, centre and peak pressure and strain energies, as the study of accuracy found it.

    Those of the inferred pad (figures/tables/accuracy_planner.csv). Between half widths errors are interpolated in logarithms.

    Attributes:
        half_widths: m, of the contact with 1260 1/m, 210 1/m and the flat plate at the top of the ramp. edge: m, along the skin,
        where 7 elements go across the epidermis. mesh: elements across the epidermis -> error (half_widths). time: steps of a leg
        -> error (half_widths). stroke_mesh, stroke_time: those of the plate's stroke, over its way.
    """

    half_widths: tuple[float, ...] = (0.37e-3, 1.09e-3, 2.3e-3)
    edge: float = 134.4e-6
    mesh: Mapping[int, tuple[float, ...]] = field(
        default_factory=lambda: {
            1: (1.0, 0.25, 0.078),
            2: (0.17, 0.048, 0.02),
            4: (0.067, 0.0087, 0.0045),
            7: (0.02, 0.0022, 0.0024),
            10: (0.0055, 0.00061, 0.0015),
            14: (0.0043, 0.00061, 0.001),
            22: (0.0038, 0.0006, 0.00098),
        }
    )
    time: Mapping[int, tuple[float, ...]] = field(
        default_factory=lambda: {
            5: (0.0037, 0.0065, 0.0079),
            10: (0.00099, 0.002, 0.0025),
            20: (0.00024, 0.0006, 0.00083),
            40: (0.00011, 0.00013, 0.00028),
            80: (0.000059, 0.000096, 0.00012),
        }
    )
    stroke_mesh: Mapping[int, float] = field(
        default_factory=lambda: {1: 0.076, 2: 0.016, 4: 0.0067, 7: 0.0046, 10: 0.0042, 14: 0.0039, 22: 0.0037}
    )
    stroke_time: Mapping[int, float] = field(default_factory=lambda: {5: 0.012, 10: 0.0043, 20: 0.0031, 40: 0.0031, 80: 0.0031})


def estimated_error(
    edge: float,
    half_width: float,
    steps: int | None = None,
    stroked: bool = False,
    body_edge: float | None = None,
    *,
    rules: Any,
    bumpy: bool = False,
) -> float:
    """Expected relative error of depth, width, pressure and strain energy at the legs' ends, from :class:`MeasuredErrors`.

    Of a leg that strokes: the root mean square over its way, relative to the largest value on it. And at least what an edge of
    the contact between two nodes may be misplaced by.

    Args:
        edge: m, skin edge in the contact. half_width: m, of the contact: estimated before a run, found after it.
        steps: of a leg; None when neither time nor a way matters. stroked: does the pad move along the surface?
        body_edge: m, skin edge around the contact where that is coarser: no finer than the widest contact measured needs it.
        bumpy: has the surface bumps of its own within the contact, as measured ones have?
    """
    found = [_measured_error(edge, half_width, steps, stroked, rules), rules.safety * rules.edge_share * edge / half_width]
    if body_edge is not None and body_edge > edge:
        found.append(_measured_error(body_edge, rules.errors.half_widths[-1], steps, stroked, rules))
    return float(max(found)) * (rules.bumps if bumpy else 1.0)


def _measured_error(edge: float, half_width: float, steps: int | None, stroked: bool, rules: Any) -> float:
    known = rules.errors
    # narrower contacts than were measured are similar to the narrowest one on a coarser mesh
    alike = edge * max(known.half_widths[0] / half_width, 1.0)
    rows = known.edge * THESIS_ROWS / alike

    def between(count, table, order):
        columns = [_read(count, tuple(table), column, order) for column in zip(*table.values(), strict=True)]
        return float(np.exp(np.interp(np.log(half_width), np.log(known.half_widths), np.log(columns))))

    def stroke(count, table, order):
        return rules.stroked * _read(count, tuple(table), tuple(table.values()), order) if stroked else 0.0

    # a stroke's errors come on top of those of a press as narrow
    error = between(rows, known.mesh, rules.mesh_order) + stroke(rows, known.stroke_mesh, rules.mesh_order)
    if steps is not None:
        error += between(steps, known.time, rules.time_order) + stroke(steps, known.stroke_time, rules.time_order)
    return rules.safety * error


def _read(count: float, counts: tuple[int, ...], errors: tuple[float, ...], order: float) -> float:
    """Error at ``count`` between measured ones, in logarithms; beyond them it goes on with ``order``."""
    inside = np.clip(count, counts[0], counts[-1])
    error = np.exp(np.interp(np.log(inside), np.log(counts), np.log(errors)))
    return float(error * (inside / count) ** order)

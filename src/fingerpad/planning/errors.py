"""What a discretisation is wrong by: measured in the study of accuracy, read between what was
measured, and goes on beyond it.
"""

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
"""With which curves are taken to converge with the mesh: measured ones, at 1 to 2, do so on either
side of it.
"""
PROFILE_ORDER = 1.0
"""The same of pressure profiles, whose slope has no bound at the contact's edge: they are wrong in
the last element there.
"""


def remains(edges: float, order: float = ORDER) -> float:
    """What a result is wrong by over what it changes by when edges are so many times as long
    (Richardson 1911).
    """
    return 1 / abs(edges**order - 1)


REMAINS = remains(COARSER)
"""What a result is wrong by over what it changes by on its companion's mesh."""
STEPS_REMAIN = 1 / (2.0**ORDER - 1)
"""The same over what it changes by with steps twice as long, of which measured orders are as
large.
"""


PLATES, WAVES = "plates", "waves"
"""What a pad is stroked over: a surface that is alike all along, or any other."""


@dataclass(frozen=True)
class StrokeErrors:
    """Relative errors of strokes drawn at random, a press and a way: the largest, and the root of
    the mean square of all.

    Attributes
    ----------
    mesh
        Elements across the epidermis -> both.
    time
        Steps of a leg -> what both are more than with the default's steps.
    way
        m, the middle of those drawn (1 to 2.5 mm).
    """

    mesh: Mapping[int, tuple[float, float]]
    time: Mapping[int, tuple[float, float]]
    way: float = 1.75e-3

    def on(self, way: float, table: Mapping[int, tuple[float, float]]) -> Mapping[int, float]:
        """A table's errors over a way (m): as long as those drawn it may be the worst of them,
        longer it has many in it.
        """
        share = min(1.0, self.way / way)
        return {
            n: float(np.sqrt(share * largest**2 + (1 - share) * mean**2))
            for n, (largest, mean) in table.items()
        }


@dataclass(frozen=True)
class Stroke:
    """What a pad is stroked ``over``, and the shortest ``way`` m of a leg along it."""

    over: str
    way: float


def stroke_of(scene: Any, uneven: bool) -> Stroke | None:
    """The stroke of a scene along a surface that is ``uneven`` or not; None: it goes nowhere along
    it.
    """
    ways = [abs(leg.along) for leg in scene.motion if leg.along]
    return Stroke(WAVES if uneven else PLATES, min(ways)) if ways else None


@dataclass(frozen=True)
class MeasuredErrors:
    """Largest relative error of depth, width, centre and peak pressure and strain energies, as the
    study of accuracy found it.

    Those of the inferred pad (figures/tables/accuracy_planner.csv, and accuracy_strokes.csv); of
    presses those of an earlier version of that table where they were larger. Between half widths
    errors are interpolated in logarithms.

    Attributes
    ----------
    half_widths
        m, of the contact with 1260 1/m, 210 1/m and the flat plate at the top of the ramp.
    edge
        m, along the skin, where 7 elements go across the epidermis.
    mesh
        Elements across the epidermis -> error (half_widths).
    time
        Steps of a leg -> error (half_widths).
    energy
        As mesh, of the strain energies alone: what the elements under a contact that is refined for
        leave wrong; of the narrowest those of loads drawn at random where they were larger.
    strokes
        By what is stroked over.
    """

    half_widths: tuple[float, ...] = (0.37e-3, 1.09e-3, 2.3e-3)
    edge: float = 134.4e-6
    mesh: Mapping[int, tuple[float, ...]] = field(
        default_factory=lambda: {
            1: (1.0, 0.25, 0.078),
            2: (0.17, 0.048, 0.02),
            4: (0.067, 0.0087, 0.0048),
            7: (0.02, 0.0022, 0.0024),
            10: (0.0055, 0.00098, 0.0015),
            14: (0.0043, 0.00078, 0.001),
            22: (0.0038, 0.00062, 0.00098),
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
    energy: Mapping[int, tuple[float, ...]] = field(
        default_factory=lambda: {
            1: (0.29, 0.091, 0.042),
            2: (0.052, 0.024, 0.0043),
            4: (0.0065, 0.0012, 0.0039),
            7: (0.0012, 0.0006, 0.0019),
        }
    )
    strokes: Mapping[str, StrokeErrors] = field(
        default_factory=lambda: {
            PLATES: StrokeErrors(
                {
                    2: (0.059, 0.025),
                    4: (0.026, 0.014),
                    7: (0.019, 0.011),
                    10: (0.015, 0.0081),
                    14: (0.0077, 0.0038),
                },
                {10: (1e-4, 4.4e-4), 20: (1e-4, 1e-4), 40: (1e-4, 1e-4)},
            ),
            WAVES: StrokeErrors(
                {
                    2: (0.39, 0.13),
                    4: (0.16, 0.051),
                    7: (0.031, 0.016),
                    10: (0.017, 0.0096),
                    14: (0.017, 0.0062),
                },
                {10: (0.011, 0.0024), 20: (0.0033, 1.9e-4), 40: (0.0033, 1.9e-4)},
            ),
        }
    )


@dataclass(frozen=True)
class OwnErrors:
    """Largest relative errors of presses on meshes of one's own, by the element they are solved
    with and by quantity.

    Those of the inferred pad under a plate and cylinders of 20 to 630 1/m with 3.5 to 20
    gram-weight, on meshes of edges of 30 to 450 um, each against a fine run
    (figures/tables/accuracy_own.csv).

    Attributes
    ----------
    shares
        Edge of the skin over half width of the contact.
    table
        Element -> quantity -> errors (shares).
    height
        Element -> error of strain energy where the height of the elements that receptors are in is
        their depth; it goes with the power 1.5.
    """

    shares: tuple[float, ...] = (0.03, 0.06, 0.12, 0.25, 0.5, 1.0)
    table: Mapping[str, Mapping[str, tuple[float, ...]]] = field(
        default_factory=lambda: {
            "Q1P0": {
                "depth": (0.0016, 0.0031, 0.0031, 0.0031, 0.0031, 0.005),
                "width": (0.0011, 0.002, 0.0124, 0.0279, 0.0586, 0.12),
                "pressure": (0.0005, 0.001, 0.005, 0.0072, 0.0353, 0.1),
                "strain energy": (0.0007, 0.0039, 0.0095, 0.0288, 0.0646, 0.13),
            },
            "Q2P1": {
                "depth": (0.0002, 0.0004, 0.0007, 0.0008, 0.001, 0.0012),
                "width": (0.0005, 0.0008, 0.0019, 0.0141, 0.0284, 0.0651),
                "pressure": (0.0001, 0.0003, 0.001, 0.0124, 0.0211, 0.0312),
                "strain energy": (0.0003, 0.0007, 0.0021, 0.0056, 0.0171, 0.0478),
            },
            "P2B": {
                "depth": (0.002, 0.0027, 0.0045, 0.0045, 0.0045, 0.0045),
                "width": (0.0011, 0.0015, 0.0034, 0.0177, 0.0419, 0.0845),
                "pressure": (0.0005, 0.0022, 0.0051, 0.0484, 0.0634, 0.0991),
                "strain energy": (0.0013, 0.0034, 0.0071, 0.0244, 0.0308, 0.0429),
            },
        }
    )
    height: Mapping[str, float] = field(
        default_factory=lambda: {"Q1P0": 0.2, "Q2P1": 0.06, "P2B": 0.08}
    )


def own_errors(
    element: str,
    edge: float,
    half_width: float,
    at_receptors: float | None,
    steps: float | None = None,
    stroke: Stroke | None = None,
    *,
    rules: Any,
    bumpy: bool = False,
) -> dict[str, float]:
    """Expected relative error by quantity on a mesh of one's own, from :class:`OwnErrors`; of a
    stroke the law's, for all alike.

    Parameters
    ----------
    element
        Key of the element it is solved with.
    edge
        m, skin edge in the contact.
    half_width
        m, of the contact.
    at_receptors
        Largest height of the elements that receptors are in, over their depth; None: no receptors,
        whose strain energy is then not asked for.
    steps, stroke, bumpy
        As in :func:`estimated_error`.
    """
    known, share = rules.own, edge / half_width
    factor = rules.safety * (rules.bumps if bumpy else 1.0)
    time = (
        0.0
        if steps is None
        else factor * _at(half_width, rules.errors, steps, rules.errors.time, rules.time_order)
    )
    out = {}
    for quantity, errors in known.table.get(element, known.table["Q1P0"]).items():
        inside = np.clip(share, known.shares[0], known.shares[-1])
        found = float(np.exp(np.interp(np.log(inside), np.log(known.shares), np.log(errors))))
        out[quantity] = factor * found * max(share / inside, 1.0) ** rules.mesh_order + time
    if at_receptors is None:
        del out["strain energy"]
    else:
        high = factor * known.height.get(element, known.height["Q1P0"]) * at_receptors**1.5
        out["strain energy"] = max(out["strain energy"], high + time)
    if stroke is not None:
        coarser = {"Q1P0": rules.linear_quad, "P2B": rules.linear_triangle}.get(element, 1.0)
        along = estimated_error(coarser * edge, half_width, steps, stroke, rules=rules, bumpy=bumpy)
        out = {quantity: max(error, along) for quantity, error in out.items()}
    return out


def estimated_error(
    edge: float,
    half_width: float,
    steps: float | None = None,
    stroke: Stroke | None = None,
    body_edge: float | None = None,
    *,
    rules: Any,
    bumpy: bool = False,
) -> float:
    """Expected relative error of depth, width, pressure and strain energy at the legs' ends, from
    :class:`MeasuredErrors`.

    Of a leg that strokes: the root mean square over its way, relative to the largest value on it.
    Of presses at least what an edge of the contact between two nodes may be misplaced by.

    Parameters
    ----------
    edge
        m, skin edge in the contact.
    half_width
        m, of the contact: estimated before a run, found after it.
    steps
        Of a leg; None when neither time nor a way matters.
    stroke
        The pad's along the surface, if there is one.
    body_edge
        m, skin edge around the contact where that is coarser: no finer than the widest contact
        measured needs it.
    bumpy
        Whether the surface has bumps of its own within the contact, as measured ones have.
    """
    factor = rules.safety * (rules.bumps if bumpy else 1.0)
    found = [_measured_error(edge, half_width, steps, stroke, rules, factor)]
    if (
        stroke is None
    ):  # on the way along a surface edges pass over many nodes, which is in what was measured
        found.append(factor * rules.edge_share * edge / half_width)
    if body_edge is not None and body_edge > edge:
        known = rules.errors
        found.append(
            _measured_error(body_edge, known.half_widths[-1], steps, stroke, rules, factor)
        )
        found.append(
            factor
            * _at(
                half_width,
                known,
                known.edge * THESIS_ROWS / body_edge,
                known.energy,
                rules.mesh_order,
            )
        )
    return float(max(found))


def _at(
    half_width: float,
    known: MeasuredErrors,
    count: float,
    table: Mapping[int, tuple[float, ...]],
    order: float,
) -> float:
    """Relative error at a ``count`` by a ``table`` of it, for a contact of ``half_width`` m between
    those measured.
    """
    columns = [
        _read(count, tuple(table), column, order) for column in zip(*table.values(), strict=True)
    ]
    return float(np.exp(np.interp(np.log(half_width), np.log(known.half_widths), np.log(columns))))


def _measured_error(
    edge: float,
    half_width: float,
    steps: int | None,
    stroke: Stroke | None,
    rules: Any,
    factor: float,
) -> float:
    known = rules.errors
    # narrower contacts than were measured are similar to the narrowest one on a coarser mesh
    alike = edge * max(known.half_widths[0] / half_width, 1.0)
    rows = known.edge * THESIS_ROWS / alike

    error = factor * _at(half_width, known, rows, known.mesh, rules.mesh_order)
    if steps is not None:
        error += factor * _at(half_width, known, steps, known.time, rules.time_order)
    if stroke is None:
        return error
    strokes = known.strokes[stroke.over]

    def stroked(count, table, order):
        here = strokes.on(stroke.way, table)
        return rules.stroked * _read(count, tuple(here), tuple(here.values()), order)

    on_the_way = stroked(rows, strokes.mesh, rules.mesh_order)
    on_the_way += stroked(steps, strokes.time, rules.time_order) if steps is not None else 0.0
    return max(error, on_the_way)  # those of strokes are of the press before as well


def _read(count: float, counts: tuple[int, ...], errors: tuple[float, ...], order: float) -> float:
    """Error at ``count`` between measured ones, in logarithms; beyond them it goes on with
    ``order``.
    """
    inside = np.clip(count, counts[0], counts[-1])
    error = np.exp(np.interp(np.log(inside), np.log(counts), np.log(errors)))
    return float(error * (inside / count) ** order)

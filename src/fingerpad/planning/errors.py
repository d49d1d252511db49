"""What a discretisation is wrong by: measured in the study of accuracy (the tables are in
``rules.yaml``), read between what was measured, and goes on beyond it.
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

    Between half widths errors are interpolated in logarithms.

    Attributes
    ----------
    half_widths
        m, of the contact: in plane strain with 1260 1/m, 210 1/m and the flat plate at the top of
        the ramp; of bodies of revolution with spheres, a cone and plates.
    edge
        m, along the skin, where 7 elements go across the epidermis.
    mesh
        Elements across the epidermis -> error (half_widths).
    time
        Steps of a leg -> error (half_widths).
    energy
        As mesh, of the strain energies alone: what the elements under a contact that is refined for
        leave wrong.
    strokes
        By what is stroked over.
    """

    half_widths: tuple[float, ...]
    edge: float
    mesh: Mapping[int, tuple[float, ...]]
    time: Mapping[int, tuple[float, ...]]
    energy: Mapping[int, tuple[float, ...]]
    strokes: Mapping[str, StrokeErrors] = field(default_factory=dict)


@dataclass(frozen=True)
class OwnErrors:
    """Largest relative errors of presses on meshes of one's own, by the element they are solved
    with and by quantity.

    Those of the inferred pad under a plate and cylinders of 20 to 630 1/m with 3.5 to 20
    gram-weight, on meshes of edges of 30 to 450 um, each against a fine run.

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

    shares: tuple[float, ...]
    table: Mapping[str, Mapping[str, tuple[float, ...]]]
    height: Mapping[str, float]


@dataclass(frozen=True)
class ContactErrors:
    """The relative errors that are expected of one contact, at the ends of legs.

    Of a leg that strokes: the root mean square over its way, relative to the largest value on it.

    Parameters
    ----------
    rules
        With the measured errors.
    half_width
        m, of the contact: estimated before a run, found after it.
    steps
        Of a leg; None when neither time nor a way matters.
    stroke
        The pad's along the surface, if there is one.
    bumpy
        Whether the surface has bumps of its own within the contact, as measured ones have.
    turned
        Whether it is of a body of revolution.
    """

    rules: Any
    half_width: float
    steps: float | None = None
    stroke: Stroke | None = None
    bumpy: bool = False
    turned: bool = False

    @property
    def known(self) -> MeasuredErrors:
        """The measured errors that are asked."""
        return self.rules.errors_turned if self.turned else self.rules.errors

    def on_own_mesh(
        self, element: str, edge: float, at_receptors: float | None
    ) -> dict[str, float]:
        """By quantity on a mesh of one's own, from :class:`OwnErrors`; of a stroke at least what
        :meth:`on_built_mesh` says.

        Parameters
        ----------
        element
            Key of the element it is solved with.
        edge
            m, skin edge in the contact.
        at_receptors
            Largest height of the elements that receptors are in, over their depth; None: no
            receptors, whose strain energy is then not asked for.
        """
        rules, known, share = self.rules, self.rules.own, edge / self.half_width
        element = element if element in known.table else "Q1P0"
        time = self._of_steps()
        inside = np.clip(share, known.shares[0], known.shares[-1])
        beyond = max(share / inside, 1.0) ** rules.mesh_order
        out = {}
        for quantity, errors in known.table[element].items():
            found = float(np.exp(np.interp(np.log(inside), np.log(known.shares), np.log(errors))))
            out[quantity] = self._factor * found * beyond + time
        if at_receptors is None:
            del out["strain energy"]
        else:
            high = self._factor * known.height[element] * at_receptors**1.5
            out["strain energy"] = max(out["strain energy"], high + time)
        if self.stroke is not None:
            coarser = {"Q1P0": rules.linear_quad, "P2B": rules.linear_triangle}.get(element, 1.0)
            along = self.on_built_mesh(coarser * edge)
            out = {quantity: max(error, along) for quantity, error in out.items()}
        return out

    def on_built_mesh(self, edge: float, body_edge: float | None = None) -> float:
        """Of depth, width, pressure and strain energy, from :class:`MeasuredErrors`.

        Of presses at least what an edge of the contact between two nodes may be misplaced by.

        Parameters
        ----------
        edge
            m, skin edge in the contact.
        body_edge
            m, skin edge around the contact where that is coarser: no finer than the widest contact
            measured needs it.
        """
        known = self.known
        found = [self._measured(edge, self.half_width)]
        if self.stroke is None:
            # on the way along a surface edges pass over many nodes, which is in what was measured
            found.append(self._factor * self.rules.edge_share * edge / self.half_width)
        if body_edge is not None and body_edge > edge:
            found.append(self._measured(body_edge, known.half_widths[-1]))
            rows = known.edge * THESIS_ROWS / body_edge
            found.append(self._of_press(known.energy, rows, self.half_width))
        return float(max(found))

    @property
    def _factor(self) -> float:
        rules = self.rules
        bumps = rules.bumps_turned if self.turned else rules.bumps
        return rules.safety * (bumps if self.bumpy else 1.0)

    def _of_press(
        self, table: Mapping[int, tuple[float, ...]], rows: float, half_width: float
    ) -> float:
        """By a table of meshes, for a contact between those measured."""
        return self._factor * self._at(table, rows, self.rules.mesh_order, half_width)

    def _of_steps(self, half_width: float | None = None) -> float:
        if self.steps is None:
            return 0.0
        rules = self.rules
        return self._factor * self._at(
            self.known.time, self.steps, rules.time_order, half_width or self.half_width
        )

    def _at(self, table: Mapping[int, Any], count: float, order: float, half_width: float) -> float:
        """The error of a ``count`` by a table, for a contact of ``half_width`` m between those
        measured.
        """
        columns = [
            _read(dict(zip(table, column, strict=True)), count, order)
            for column in zip(*table.values(), strict=True)
        ]
        measured = self.known.half_widths
        return float(np.exp(np.interp(np.log(half_width), np.log(measured), np.log(columns))))

    def _measured(self, edge: float, half_width: float) -> float:
        rules, known = self.rules, self.known
        # narrower contacts than were measured are similar to the narrowest one on a coarser mesh
        alike = edge * max(known.half_widths[0] / half_width, 1.0)
        rows = known.edge * THESIS_ROWS / alike
        error = self._of_press(known.mesh, rows, half_width) + self._of_steps(half_width)
        if self.stroke is None:
            return error
        strokes, way = known.strokes[self.stroke.over], self.stroke.way
        along = rules.stroked * _read(strokes.on(way, strokes.mesh), rows, rules.mesh_order)
        if self.steps is not None:
            steps = _read(strokes.on(way, strokes.time), self.steps, rules.time_order)
            along += rules.stroked * steps
        return max(error, along)  # those of strokes are of the press before as well


def _read(errors: Mapping[int, float], count: float, order: float) -> float:
    """Error at ``count`` between measured ones, in logarithms; beyond them it goes on with
    ``order``.
    """
    counts = list(errors)
    inside = np.clip(count, counts[0], counts[-1])
    error = np.exp(np.interp(np.log(inside), np.log(counts), np.log(list(errors.values()))))
    return float(error * (inside / count) ** order)

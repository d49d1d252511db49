"""Where the skin may touch: points inside its edges, not its nodes, so that the contact's edge
moves through an element.

A skin edge has as many degrees of freedom as nodes. Contact at nodes makes them join one by one,
and with each one the stiffness jumps. Here an edge has twice as many points, evenly spaced, with
weights that integrate what its nodes carry under a uniform pressure. Their pressures would be more
than the edge can tell apart, so they are kept from differing from point to point by the smallest of
terms: the gap that closes is

    gap - d/ds (softness dp/ds),        softness = SMOOTHING (4 spacing)^3 / (3 shear modulus),

the method of Brezzi and Pitkaranta (1984) for the multipliers of a constraint. A uniform pressure
is not changed by it, and with the mesh it vanishes as the third power of the spacing. The contact
problem stays what it was: symmetric, with multipliers that are zero or close a gap.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fingerpad.mechanics.elements import edge_values
from fingerpad.mechanics.kinematics import PLANE_STRAIN, Kinematics

SMOOTHING = 0.01
"""A tenth leaves half of nodal contact's kinks and more alternation; ten times as much widens
contacts by a tenth of an edge.
"""
_SHARP = 0.1
"""Curvature times spacing above which there is less smoothing: a contact of a point or two must not
give way.
"""
PER_NODE = 2
_QUARTERS = (-0.75, -0.25, 0.25, 0.75)
_RULES = {
    1: ((-0.5, 0.5), (1.0, 1.0), (-2 / 3, 2 / 3)),
    2: (_QUARTERS, (13 / 24, 11 / 24, 11 / 24, 13 / 24), _QUARTERS),
}
"""Points of an edge, their weights, and where the radius of a body of revolution is taken for each,
so that a uniform pressure there is no load on its nodes but its own.
"""


@dataclass(frozen=True)
class ContactPoints:
    """Points of the skin, from left to right.

    Attributes
    ----------
    nodes
        (n, k) of the edge that each is on, among all nodes.
    along
        (n, k) the same, among the skin's.
    values, slopes
        (n, k) shape functions and their derivatives.
    weight
        (n,) of the edge's parameter from -1 to 1.
    node
        (n,) the nearest of the skin's, to which what is at a point is put down.
    spacing
        (n,) m, of the unloaded skin, which the points share.
    per_edge
        How many an edge has.
    softness
        (n,) m^3/Pa.
    mirrored
        Does the skin begin at a symmetry axis?
    radial
        (n, k) shape functions where the radius is taken.
    across
        (n,) m of what lies across the section, of the unloaded skin; ones in plane strain.
    kinematics
        What the section stands for.
    """

    nodes: np.ndarray
    along: np.ndarray
    values: np.ndarray
    slopes: np.ndarray
    weight: np.ndarray
    node: np.ndarray
    spacing: np.ndarray
    per_edge: int
    softness: np.ndarray
    mirrored: bool
    radial: np.ndarray
    across: np.ndarray
    kinematics: Kinematics

    @classmethod
    def on(
        cls,
        points: np.ndarray,
        chain: np.ndarray,
        edges: np.ndarray,
        shear: np.ndarray,
        mirrored=False,
        convexity=0.0,
        kinematics: Kinematics = PLANE_STRAIN,
    ) -> ContactPoints:
        """Those of the skin.

        Parameters
        ----------
        points
            (n, 2) m, all nodes.
        chain
            (ns,) the skin's in order.
        edges
            (m, 2 or 3) its edges (start, end[, middle]).
        shear
            (m,) Pa, long-term shear moduli of the skin at them.
        mirrored
            Does the skin begin at a symmetry axis? convexity: 1/m, largest curvature of what
            presses on it.
        """
        order = edges.shape[1] - 1
        place = np.full(len(points), -1)
        place[chain] = np.arange(len(chain))
        along = place[edges]
        first = np.argsort(along[:, 0])
        along, edges, shear = along[first], edges[first], shear[first]
        s, weight, at_radius = (np.array(each) for each in _RULES[order])
        radial = np.tile(edge_values(order, at_radius)[0], (len(edges), 1))
        x = np.einsum("qa,qa->q", radial, points[np.repeat(edges, len(s), axis=0), 0])
        values, slopes = edge_values(order, s)
        nearest = np.argmax(values, axis=1)
        count = len(edges)
        length = np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
        spacing = np.repeat(length / len(s), len(s))
        smoothing = SMOOTHING / np.maximum(convexity * spacing / _SHARP, 1.0)
        return cls(
            np.repeat(edges, len(s), axis=0),
            np.repeat(along, len(s), axis=0),
            np.tile(values, (count, 1)),
            np.tile(slopes, (count, 1)),
            np.tile(weight, count),
            along[:, nearest].ravel(),
            spacing,
            len(s),
            smoothing * (4 * spacing) ** 3 / (3 * np.repeat(shear, len(s))),
            mirrored,
            radial,
            np.broadcast_to(kinematics.measure(x), len(x)),
            kinematics,
        )

    def __len__(self) -> int:
        return len(self.nodes)

    def at(self, nodal: np.ndarray, which=slice(None)) -> np.ndarray:
        """Values (k, 2) at some points of a field (n, 2) at all nodes."""
        return np.einsum("qa,qai->qi", self.values[which], nodal[self.nodes[which]])

    def whole(self, first: int, last: int) -> slice:
        """The points of all edges that some of those from ``first`` to before ``last`` are on."""
        each = self.per_edge
        return slice(max(first // each * each, 0), min(-(-last // each) * each, len(self)))

    def shape(self, part: slice) -> tuple[np.ndarray, np.ndarray]:
        """Nodes (k,) of the edges of some points, in order of their numbers, and shape functions
        (points, k) at the points.
        """
        nodes, column = np.unique(self.nodes[part], return_inverse=True)
        out = np.zeros((len(self.nodes[part]), len(nodes)))
        np.put_along_axis(out, column.reshape(self.nodes[part].shape), self.values[part], axis=1)
        return nodes, out

    def soft(self, part: slice, odd: bool = False) -> np.ndarray:
        """(k, k) m^2/N: what forces at some points add to their gaps; positive semidefinite. odd:
        of those along the skin, which change their sign at a symmetry axis. (m/N of a ring.)
        """
        across = self.across[part]
        # of the unloaded skin
        length = self.weight[part] * self.per_edge / 2 * self.spacing[part] * across
        way = (self.spacing[part][1:] + self.spacing[part][:-1]) / 2
        soft = (self.softness[part][1:] + self.softness[part][:-1]) / 2 / way
        soft = soft * ((across[1:] + across[:-1]) / 2)
        out = np.diag(np.append(soft, 0.0) + np.append(0.0, soft))
        if odd and self.mirrored and part.start == 0:
            out[0, 0] += 2 * self.softness[0] / self.spacing[0] * across[0]
        i = np.arange(len(soft))
        out[i, i + 1] = out[i + 1, i] = -soft
        return out / length / length[:, None]

    def lengths(self, position: np.ndarray) -> np.ndarray:
        """(n,) m of the skin (m^2 of a body of revolution) that belong to each point, nodes being
        at ``position`` (all nodes, 2) m.
        """
        way = np.hypot(*np.einsum("qa,qai->iq", self.slopes, position[self.nodes])) * self.weight
        x = np.einsum("qa,qa->q", self.radial, position[self.nodes, 0])
        return way * self.kinematics.measure(x)

    def of_nodes(self, values: np.ndarray, part: slice = slice(None)) -> np.ndarray:
        """Sums (ns, ...) of what is at some points (k, ...), by the skin's nodes."""
        count = int(self.along.max()) + 1
        if values.ndim == 2:
            return np.column_stack([np.bincount(self.node[part], each, count) for each in values.T])
        return np.bincount(self.node[part], values, count)

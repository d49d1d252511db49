"""What every stimulus is to the solver: a rigid profile as a signed-distance function.

A profile lives in its own frame: the solid lies above, x is lateral, x = 0 is over the pad's middle
when a motion begins. ``evaluate`` returns, at any points, the distance (positive outside the
solid), its gradient (pointing away from the solid, towards the skin) and the curvature of the level
set through the point (the only nonzero eigenvalue of the distance's second derivative). The contact
problem needs no more.
"""

from __future__ import annotations

from typing import ClassVar, NamedTuple

import numpy as np


class Walls(NamedTuple):
    """The two sides of valleys, each as if it went on beyond the corner between them.

    ``which``: (k,) the points that are in a valley. corner: (k,) its number along the surface.
    distance: (k, 2) m from the side before and the side after, gradient: (k, 2, 2) and curvature:
    (k, 2) 1/m of the distances.
    """

    which: np.ndarray
    corner: np.ndarray
    distance: np.ndarray
    gradient: np.ndarray
    curvature: np.ndarray


class Profile:
    """Base of all profiles, and what the planner asks of them.

    Attributes
    ----------
    symmetric
        Is it its own mirror image in x = 0? uneven: does its curvature change along x, with flat or
        hollow places? edges: m, x where its own edges press; the mesh is refined there.
    edge_radius
        m, their rounding (0: sharp).
    singular
        Is there an edge at which strains are large or without bound? unbounded: a true edge, at
        which pressure has no bound? irregular: are there bumps that only a search finds? face: m,
        half width of a flat face that presses as a whole.
    steepness
        Largest slope of the surface; without bound for shapes that end beside their middle.
    convexity
        1/m, largest curvature with which it bulges at the skin.
    dip
        m, by which it reaches below its point at x = 0.
    tip, flank
        Of a body of revolution that comes to a point on its axis: m, radius over which the point is
        round, and slope of the surface beside it.
    length
        m, of the surface along x from x = 0; a motion must stay on it.
    reach
        m, first and last x where there is one.
    known
        m, first and last x of measured points; contact beyond them is with a guess.
    smoothing
        m, cut-off wavelength at which a measured surface was smoothed; 0 if it was not.
    segments
        Pieces of lines and arcs that it is made of, if it is.
    valleys
        Are there corners that point away from the skin, in which a node may lean on both sides (see
        :meth:`walls`)? notes: how its file was read where that had to be guessed, in words.
    """

    symmetric: ClassVar[bool] = True
    uneven: ClassVar[bool] = False
    edges: ClassVar[tuple[float, ...]] = ()
    edge_radius: ClassVar[float] = 0.0
    singular: ClassVar[bool] = False
    unbounded: ClassVar[bool] = False
    irregular: ClassVar[bool] = False
    face: ClassVar[float] = np.inf
    steepness: ClassVar[float] = np.inf
    convexity: ClassVar[float] = 0.0
    dip: ClassVar[float] = 0.0
    tip: ClassVar[float] = 0.0
    flank: ClassVar[float] = 0.0
    length: ClassVar[float] = np.inf
    reach: ClassVar[tuple[float, float]] = (-np.inf, np.inf)
    known: ClassVar[tuple[float, float]] = (-np.inf, np.inf)
    smoothing: ClassVar[float] = 0.0
    segments: ClassVar[tuple] = ()
    valleys: ClassVar[bool] = False
    notes: ClassVar[tuple[str, ...]] = ()

    def evaluate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Distance (n,) m, gradient (n, 2) and curvature (n,) 1/m at ``points`` (n, 2) m."""
        raise NotImplementedError

    def walls(self, points: np.ndarray, reach: float, flat: float = 0.0) -> Walls:
        """Both sides of the valleys that ``points`` (n, 2) m are in, those within ``reach`` m of
        the corner at the bottom.

        What turns by less than ``flat`` (rad) is no valley.
        """
        return Walls(
            np.zeros(0, int),
            np.zeros(0, int),
            np.zeros((0, 2)),
            np.zeros((0, 2, 2)),
            np.zeros((0, 2)),
        )

    def bend_over(self, half_width: float) -> float:
        """Curvature (1/m) of the parabola that is as high as it ``half_width`` m beside its
        middle.
        """
        return self.convexity

    def tangents(self) -> np.ndarray:
        """x (k,) m at which rounded edges begin."""
        return np.array(self.edges) - self.edge_radius * np.sign(self.edges)

    def corners(self) -> np.ndarray:
        """Corners that bulge at the skin, (k, 3): x (m), the angle by which the surface turns
        (rad), the room beside it (m).
        """
        edges = self.edges if self.unbounded else ()
        return np.array([(x, np.pi / 2, self.reach[1]) for x in edges]).reshape(-1, 3)

    def outline(self, x: np.ndarray) -> np.ndarray:
        """Height of the lower surface (n,) m over ``x`` (n,) m; NaN where the profile does not
        reach.
        """
        raise NotImplementedError

    def cutoffs(self, edge: float) -> list[float]:
        """Cut-off wavelengths (m) at which it may be smoothed for skin with nodes ``edge`` m apart,
        ascending; 0 is none.
        """
        return [0.0]

    def felt(self, edge: float) -> Profile:
        """The profile without what may be noise to skin with nodes ``edge`` m apart: after the
        longest of its cut-offs.
        """
        return self.at(self.cutoffs(edge)[-1], edge)

    def at(self, smoothing: float, edge: float) -> Profile:
        """The profile smoothed at a cut-off wavelength (m; 0: not at all), for skin with nodes
        ``edge`` m apart.
        """
        return self

    def advice(self, spacing: float) -> str | None:
        """What to try when skin with nodes ``spacing`` m apart finds no equilibrium under the
        profile; None: nothing special.
        """
        return None

"""Surfaces of straight lines and circular arcs, whose distance is exact."""

from typing import NamedTuple

import numpy as np

from fingerpad.stimuli.curve_loop import closest
from fingerpad.stimuli.profile import Profile, Walls


class Segment(NamedTuple):
    """A piece of a curve: x of its ends (m) and its curvature (1/m), above zero where it bulges at
    the skin.
    """

    start: float
    end: float
    curvature: float


class Curve(Profile):
    """A single-valued lower surface of straight lines and circular arcs; its distance is exact.

    The first and the last piece are lines and go on for ever. Nothing is rounded where pieces meet
    at an angle: the closest point may be the corner, and on the corner itself the gradient bisects
    the normals beside it. The work of a query grows with the pieces near the point, at most those
    within its vertical distance from the surface, not with the length of it.

    Parameters
    ----------
    x, y
        (m + 1,) m, ends of the pieces; x strictly increasing.
    curvature
        (m,) 1/m, above zero for arcs that bulge at the skin, below zero for hollow ones, zero for
        lines.

    Raises
    ------
    ValueError
        X is not strictly increasing, an end piece is no line, or an arc is not single-valued.
    """

    uneven = True
    #: m, by which pieces reach over their ends, lest rounding leave a point between two of them
    overlap = 1e-12
    #: m, closer than which a point is on a corner
    touch = 1e-9
    #: rad, less than which a corner turns away from the skin without making a valley: a node on it
    #: is pushed to and fro by less than the tolerance of the forces
    flat = 2e-3
    #: of a corner's turn, by which the surface beside it may turn and be straight
    straight = 0.1
    #: pieces that are the surface itself and not its continuation
    own = slice(None)

    def __init__(self, x, y, curvature):
        self.x, self.y, self.bend = (np.asarray(values, float) for values in (x, y, curvature))
        if not 2 <= len(self.x) == len(self.y) == len(self.bend) + 1 or not np.all(
            np.diff(self.x) > 0
        ):
            raise ValueError("a profile needs at least two points with strictly increasing x")
        ends = np.column_stack([self.x, self.y])
        chord = np.diff(ends, axis=0)
        length = np.hypot(*chord.T)
        slope = np.arctan2(chord[:, 1], chord[:, 0])
        turn = np.arcsin(np.clip(self.bend * length / 2, -1, 1))
        if self.bend[0] or self.bend[-1] or np.any(np.abs(slope) + np.abs(turn) >= np.pi / 2):
            raise ValueError("a profile starts and ends with lines, and its arcs are single-valued")
        slopes = np.tan(np.abs(slope) + np.abs(turn))
        self._steepest, self.steepness = float(slopes.max()), float(slopes[self.own].max())
        self._tangent = chord / length[:, None]
        self._line = self.bend == 0
        # of the skin, seen from the centre of an arc
        self._side = np.where(self.bend < 0, -1.0, 1.0)
        self._radius = np.zeros(len(length))
        self._radius[~self._line] = np.abs(1.0 / self.bend[~self._line])
        to_chord = self._side * self._radius * np.cos(turn)
        self._centre = np.where(
            self._line[:, None],
            ends[:-1],
            (ends[:-1] + ends[1:]) / 2 - to_chord[:, None] * _normal(self._tangent),
        )  # of a line: its start
        self._reach = np.where(self._line, length, np.abs(turn))
        self._directions = slope - turn, slope + turn
        after, before = self._directions[0][1:], self._directions[1][:-1]
        self._kink = np.concatenate([[0.0], after - before])  # at the start of each piece
        self._bisector = np.concatenate([[0.0], (before + after) / 2])
        self._ends = self.x, self.y, self._kink, self._bisector
        self._pieces = (
            self._centre,
            self._tangent,
            self._side,
            self._radius,
            self._line,
            self._reach,
        )
        self._valleys = np.flatnonzero(self._kink < -self.flat)
        self.valleys = len(self._valleys) > 0
        near = {"rtol": 0, "atol": 1e-9 * np.ptp(self.x)}
        self.symmetric = bool(
            np.allclose(self.x, -self.x[::-1], **near)
            and np.allclose(self.y, self.y[::-1], **near)
            and np.allclose(self.bend, self.bend[::-1])
        )

    @property
    def segments(self) -> list[Segment]:
        """The pieces from left to right; the first and the last go on beyond their ends."""
        return [
            Segment(*map(float, piece))
            for piece in zip(self.x, self.x[1:], self.bend, strict=False)
        ]

    @property
    def dip(self):
        ends = self.x[:-1], self.x[1:]
        bottom = np.where(self.bend > 0, np.clip(self._centre[:, 0], *ends), self.x[:-1])
        return float(
            self._height(np.array([0.0]))[0] - min(self._height(bottom).min(), self.y.min())
        )

    @property
    def convexity(self):
        # a corner between two lines stands for the arc that would touch both in their middles
        chord, line = np.diff(self.x)[self.own], self._line[self.own]
        corner = 2 * self._kink[self.own][1:] / (chord[:-1] + chord[1:]) * (line[:-1] & line[1:])
        return float(max(self.bend[self.own].max(), corner.max(initial=0.0)))

    def corners(self):
        chord = np.diff(self.x)
        here = 1 + np.flatnonzero(self._kink[1:] > 0)
        turn, room = self._kink.copy(), np.concatenate([[0.0], np.minimum(chord[:-1], chord[1:])])
        for first, last in self._alone():
            whole = self._kink[first : last + 1].sum()
            beside = min(
                self._straight(first - 1, -1, self.straight * whole),
                self._straight(last, 1, self.straight * whole),
            )
            if beside > room[first] and self.x[last] - self.x[first] <= self.straight * beside:
                turn[first : last + 1], room[first : last + 1] = whole, beside
        return np.column_stack([self.x[here], turn[here], room[here]])

    def _alone(self):
        """First and last of the one or two pieces at whose starts the surface bulges by far more
        than beside them.

        Two, for a corner that is between two samples is cut off by the line that joins them.
        """
        kink = np.concatenate([[0.0], self._kink, [0.0, 0.0]])
        for more in (0, 1):
            bulge = kink[1 : -2 - more or None][: len(self._kink) - more]
            if more:
                both = bulge + kink[2:-2]
                bulge = np.where(np.minimum(bulge, kink[2:-2]) > self.straight * both, both, 0.0)
            beside = np.maximum(
                np.abs(kink[: len(bulge)]), np.abs(kink[2 + more : 2 + more + len(bulge)])
            )
            for k in np.flatnonzero((bulge > 1e-4) & (beside <= self.straight * bulge)):
                yield int(k), int(k) + more

    def _straight(self, piece, step, off):
        """How far (m) from the near end of a piece, to the right (step 1) or left (-1), the surface
        turns by at most ``off``.
        """
        (near, far), (at, to) = self._directions[::step], (self.x[:-1], self.x[1:])[::step]
        k, count = piece, 8
        while 0 <= k < len(near):
            here = np.arange(k, k + step * count, step)
            here = here[(here >= 0) & (here < len(near))]
            begun, done = (np.abs(each[here] - near[piece]) for each in (near, far))
            if len(out := np.flatnonzero(np.maximum(begun, done) > off)):
                k = here[out[0]]
                share = max(off - begun[out[0]], 0.0) / max(done[out[0]] - begun[out[0]], off)
                return abs(at[k] - at[piece] + share * (to[k] - at[k]))
            k, count = here[-1] + step, 4 * count
        return abs(to[here[-1]] - at[piece])

    def outline(self, x):
        return self._height(x)

    def _height(self, x):
        piece = np.searchsorted(self.x[1:-1], x, side="right")
        (cx, cy), (tx, ty) = self._centre[piece].T, self._tangent[piece].T
        rise = self._side[piece] * np.sqrt(np.maximum(self._radius[piece] ** 2 - (x - cx) ** 2, 0))
        return np.where(self._line[piece], cy + (x - cx) * ty / tx, cy - rise)

    def _from_piece(self, points, piece):
        """Signed distance to a piece going on beyond its ends, with gradient and curvature."""
        arm, tangent = points - self._centre[piece], self._tangent[piece]
        side, line = self._side[piece], self._line[piece]
        across, length = np.einsum("ni,ni->n", arm, _normal(tangent)), np.hypot(*arm.T)
        distance = np.where(line, across, side * (length - self._radius[piece]))
        bend = side / np.maximum(length, 1e-15)
        gradient = np.where(line[:, None], _normal(tangent), bend[:, None] * arm)
        return distance, gradient, np.where(line, 0.0, bend)

    def walls(self, points, reach, flat=0.0):
        at = self._valleys[self._kink[self._valleys] < -flat]
        if not len(at):
            return super().walls(points, reach, flat)
        chord = np.diff(self.x)
        chord[[0, -1]] = np.inf  # these go on for ever
        room = np.minimum(reach, np.minimum(chord[at - 1], chord[at]))
        behind = np.clip(np.searchsorted(self.x[at], points[:, 0]), 1, max(len(at) - 1, 1))
        beside = np.minimum(np.stack([behind - 1, behind]), len(at) - 1)
        away = np.hypot(points[:, 0] - self.x[at][beside], points[:, 1] - self.y[at][beside])
        nearest = np.argmin(away, axis=0)
        valley = np.take_along_axis(beside, nearest[None], 0)[0]
        which = np.flatnonzero(away.min(axis=0) < room[valley])
        corner = at[valley[which]]
        sides = [self._from_piece(points[which], piece) for piece in (corner - 1, corner)]
        return Walls(which, corner, *(np.stack(both, axis=1) for both in zip(*sides, strict=True)))

    def _farthest(self, x, y, height):
        """Farther along x than this (m) from a point the surface cannot be closest."""
        return np.abs(y - height) * share_of_height(self._steepest)

    def evaluate(self, points):
        points = np.ascontiguousarray(points, float)
        x, y = points.T
        height = self._height(x)
        within = self._farthest(x, y, height) * (1 + 1e-9) + 2 * self.overlap
        out = np.empty(len(points)), np.empty(points.shape), np.empty(len(points))
        limits = self.overlap, self.touch
        closest(points, y > height, within, self._ends, self._pieces, limits, *out)
        return out


def share_of_height(slope: float) -> float:
    """Of the way along y to a surface of at most this slope: farther along x than that it cannot
    come near.
    """
    slope = min(slope, 1.0)
    return 2 * slope / (1 + slope**2)


def _normal(tangent: np.ndarray) -> np.ndarray:
    """Unit normals (n, 2) towards the skin of a surface that runs along ``tangent`` (n, 2)."""
    return np.column_stack([tangent[:, 1], -tangent[:, 0]])

"""Rigid profiles as signed-distance functions.

A profile lives in its own frame: the solid lies above, x is lateral, x = 0 is over the pad's middle when a motion begins.
``evaluate`` returns, at any points, the distance (positive outside the solid), its gradient (pointing away from the solid,
towards the skin) and the curvature of the level set through the point (the only nonzero eigenvalue of the distance's second
derivative). The contact problem needs no more; a new shape is one class here.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from fingerpad.stimuli.smoothing import ROUGH, WAVE, smoothed, turning


class Profile:
    """Base of all profiles: ``evaluate(points (n, 2) m) -> distance (n,) m, gradient (n, 2), curvature (n,) 1/m``."""

    symmetric = True
    #: positions along x (m) where the profile's own edges press; the mesh planner refines there
    edges: tuple[float, ...] = ()
    #: is there an edge at which strains are large or without bound?
    singular = False
    #: is there a true edge, at which pressure has no bound?
    unbounded = False
    #: largest slope of the surface; without bound for shapes that end beside their middle
    steepness = np.inf
    #: 1/m, largest curvature with which the surface bulges at the skin
    convexity = 0.0
    #: m, by which the surface reaches below its point at x = 0
    dip = 0.0
    #: m, first and last x where there is a surface
    reach: tuple[float, float] = (-np.inf, np.inf)
    #: m, first and last x of measured points; contact beyond them is with a guess
    known: tuple[float, float] = (-np.inf, np.inf)
    #: m, cut-off wavelength at which a measured surface was smoothed; 0 if it was not
    smoothing = 0.0

    def felt(self, edge: float) -> "Profile":
        """The profile as skin with nodes ``edge`` m apart can feel it."""
        return self

    def at(self, smoothing: float, edge: float) -> "Profile":
        """The profile smoothed at a cut-off wavelength (m; 0: not at all), for skin with nodes ``edge`` m apart."""
        return self

    def advice(self, spacing: float) -> str | None:
        """What to try when skin with nodes ``spacing`` m apart finds no equilibrium under the profile; None: nothing special."""
        return None

    def evaluate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        raise NotImplementedError

    def outline(self, x: np.ndarray) -> np.ndarray:
        """Height of the lower surface (n,) m over ``x`` (n,) m; NaN where the profile does not reach."""
        raise NotImplementedError


@dataclass(frozen=True)
class Flat(Profile):
    """A flat plate."""

    steepness = 0.0

    def evaluate(self, points):
        n = len(points)
        return -points[:, 1], np.tile([0.0, -1.0], (n, 1)), np.zeros(n)

    def outline(self, x):
        return np.zeros_like(x)


@dataclass(frozen=True)
class Cylinder(Profile):
    """A cylinder of ``curvature`` 1/m with its axis along the third direction."""

    curvature: float

    @property
    def convexity(self):
        return self.curvature

    @property
    def reach(self):
        return (-1 / self.curvature, 1 / self.curvature)

    def evaluate(self, points):
        radius = 1 / self.curvature
        arm = points - np.array([0.0, radius])
        length = np.maximum(np.hypot(arm[:, 0], arm[:, 1]), 1e-12 * radius)
        # length - radius would lose all digits where the cylinder is all but flat
        distance = (points[:, 0] ** 2 + points[:, 1] * (arm[:, 1] - radius)) / (length + radius)
        return distance, arm / length[:, None], 1 / length

    def outline(self, x):
        radius = 1 / self.curvature
        return x**2 / (radius + np.sqrt(np.where(np.abs(x) <= radius, radius**2 - x**2, np.nan)))


@dataclass(frozen=True)
class Bar(Profile):
    """A rectangular bar of ``width`` m whose lower edges are rounded with radius ``fillet`` m (0: sharp)."""

    width: float
    fillet: float = 0.0
    singular = True

    @property
    def edges(self):
        return (-self.width / 2, self.width / 2)

    reach = edges

    @property
    def unbounded(self):
        return self.fillet == 0

    def evaluate(self, points):
        # distance to the half-infinite box shrunk by the fillet, minus the fillet
        half = self.width / 2 - self.fillet
        x, y = np.abs(points[:, 0]), points[:, 1]
        sign = np.where(points[:, 0] < 0, -1.0, 1.0)
        dx, dy = x - half, self.fillet - y
        outside = ((dx > 0) | (half == 0)) & (dy > 0)  # a full round has no flat between its corners
        corner = np.maximum(np.hypot(dx, dy), 1e-15)
        side = ~outside & (dx > dy)
        distance = np.where(outside, corner, np.where(side, dx, dy)) - self.fillet
        gradient = np.zeros(points.shape)
        gradient[:, 0] = np.where(outside, sign * dx / corner, np.where(side, sign, 0.0))
        gradient[:, 1] = np.where(outside, -dy / corner, np.where(side, 0.0, -1.0))
        # a sharp corner has no curvature of its own to offer: its level sets are circles only away from it
        curvature = np.where(outside & (corner > 1e-9), 1 / corner, 0.0)
        return distance, gradient, curvature

    def outline(self, x):
        over = np.abs(x) - (self.width / 2 - self.fillet)
        rise = self.fillet - np.sqrt(np.maximum(self.fillet**2 - np.maximum(over, 0) ** 2, 0))
        return np.where(np.abs(x) <= self.width / 2, rise, np.nan)


class Line(Bar):
    """A line load: a blade with a round tip of ``tip_radius`` m.

    A true line would sink in without end; the tip makes the problem well posed. Beyond a few radii from the tip nothing
    depends on it, the peak pressure does.
    """

    def __init__(self, tip_radius: float = 0.1e-3):
        super().__init__(2 * tip_radius, tip_radius)

    @property
    def convexity(self):
        return 1 / self.fillet


class Segment(NamedTuple):
    """A piece of a curve: x of its ends (m) and its curvature (1/m), above zero where it bulges at the skin."""

    start: float
    end: float
    curvature: float


class Curve(Profile):
    """A single-valued lower surface of straight lines and circular arcs; its distance is exact.

    The first and the last piece are lines and go on for ever. Nothing is rounded where pieces meet at an angle: the closest
    point may be the corner, and on the corner itself the gradient bisects the normals beside it. The work of a query grows
    with the pieces near the point, at most those within its vertical distance from the surface, not with the length of it.

    Args:
        x, y: (m + 1,) m, ends of the pieces; x strictly increasing. curvature: (m,) 1/m, above zero for arcs that bulge at the
            skin, below zero for hollow ones, zero for lines.

    Raises:
        ValueError: x is not strictly increasing, an end piece is no line, or an arc is not single-valued.
    """

    #: m, by which pieces reach over their ends, lest rounding leave a point between two of them
    overlap = 1e-12
    #: m, closer than which a point is on a corner
    touch = 1e-9
    #: pieces that are the surface itself and not its continuation
    own = slice(None)

    def __init__(self, x, y, curvature):
        self.x, self.y, self.bend = (np.asarray(values, float) for values in (x, y, curvature))
        if not 2 <= len(self.x) == len(self.y) == len(self.bend) + 1 or not np.all(np.diff(self.x) > 0):
            raise ValueError("a profile needs at least two points with strictly increasing x")
        ends = np.column_stack([self.x, self.y])
        chord = np.diff(ends, axis=0)
        length = np.hypot(*chord.T)
        slope, turn = np.arctan2(chord[:, 1], chord[:, 0]), np.arcsin(np.clip(self.bend * length / 2, -1, 1))
        if self.bend[0] or self.bend[-1] or np.any(np.abs(slope) + np.abs(turn) >= np.pi / 2):
            raise ValueError("a profile starts and ends with lines, and its arcs are single-valued")
        slopes = np.tan(np.abs(slope) + np.abs(turn))
        self._steepest, self.steepness = float(slopes.max()), float(slopes[self.own].max())
        self._tangent = chord / length[:, None]
        self._side = np.where(self.bend < 0, -1.0, 1.0)  # of the skin, seen from the centre of an arc
        self._line = self.bend == 0
        self._radius = np.abs(np.divide(1.0, self.bend, out=np.zeros(len(length)), where=~self._line))
        to_chord = self._side * self._radius * np.cos(turn)
        self._centre = np.where(
            self._line[:, None], ends[:-1], (ends[:-1] + ends[1:]) / 2 - to_chord[:, None] * _normal(self._tangent)
        )  # of a line: its start
        self._reach = np.where(self._line, length, np.abs(turn))
        before, after = (slope + turn)[:-1], (slope - turn)[1:]
        self._kink = np.concatenate([[0.0], after - before])  # at the start of each piece
        self._bisector = np.concatenate([[0.0], (before + after) / 2])
        near = {"rtol": 0, "atol": 1e-9 * np.ptp(self.x)}
        self.symmetric = bool(
            np.allclose(self.x, -self.x[::-1], **near)
            and np.allclose(self.y, self.y[::-1], **near)
            and np.allclose(self.bend, self.bend[::-1])
        )

    @property
    def segments(self) -> list[Segment]:
        """The pieces from left to right; the first and the last go on beyond their ends."""
        return [Segment(*map(float, piece)) for piece in zip(self.x, self.x[1:], self.bend, strict=False)]

    @property
    def dip(self):
        ends = self.x[:-1], self.x[1:]
        bottom = np.where(self.bend > 0, np.clip(self._centre[:, 0], *ends), self.x[:-1])
        return float(self._height(np.array([0.0]))[0] - min(self._height(bottom).min(), self.y.min()))

    @property
    def convexity(self):
        # a corner between two lines stands for the arc that would touch both in their middles
        chord, line = np.diff(self.x)[self.own], self._line[self.own]
        corner = 2 * self._kink[self.own][1:] / (chord[:-1] + chord[1:]) * (line[:-1] & line[1:])
        return float(max(self.bend[self.own].max(), corner.max(initial=0.0)))

    def outline(self, x):
        return self._height(x)

    def _height(self, x):
        piece = np.searchsorted(self.x[1:-1], x, side="right")
        (cx, cy), (tx, ty) = self._centre[piece].T, self._tangent[piece].T
        rise = self._side[piece] * np.sqrt(np.maximum(self._radius[piece] ** 2 - (x - cx) ** 2, 0))
        return np.where(self._line[piece], cy + (x - cx) * ty / tx, cy - rise)

    def _to_piece(self, points, piece):
        """Signed distance to a piece going on beyond its ends, arm from its centre, and by how much its ends are overshot (m)."""
        arm, tangent, side = points - self._centre[piece], self._tangent[piece], self._side[piece]
        along, across = np.einsum("ni,ni->n", arm, tangent), np.einsum("ni,ni->n", arm, _normal(tangent))
        length, line, reach, radius = np.hypot(along, across), self._line[piece], self._reach[piece], self._radius[piece]
        past = np.where(line, along - reach, radius * (np.abs(np.arctan2(along, side * across)) - reach))
        short = np.where(line & (piece > 0), -along, -np.inf)
        past = np.where(piece < len(self.bend) - 1, past, -np.inf)
        return np.where(line, across, side * (length - radius)), arm, np.maximum(past, short)

    def _farthest(self, x, y, height):
        """Farther along x than this (m) from a point the surface cannot be closest."""
        return np.abs(y - height) * _share(self._steepest)

    def evaluate(self, points):
        x, y = points.T
        height = self._height(x)
        within = self._farthest(x, y, height) * (1 + 1e-9) + 2 * self.overlap
        first = np.searchsorted(self.x[1:-1], x - within, side="left")
        count = np.searchsorted(self.x[1:-1], x + within, side="right") + 1 - first
        begin = np.cumsum(count) - count
        row = np.repeat(np.arange(len(points)), count)
        piece = np.arange(len(row)) - begin[row] + first[row]

        def closest(distance):
            least = np.minimum.reduceat(distance, begin)
            where = np.flatnonzero(~(distance > least[row]))  # the first of equals, and anything for a point that is none
            return least, piece[where[np.searchsorted(row[where], np.arange(len(points)))]]

        distance, _, beyond = self._to_piece(points[row], piece)
        to_piece, on = closest(np.where(beyond <= self.overlap, np.abs(distance), np.inf))
        corner = np.hypot(x[row] - self.x[piece], y[row] - self.y[piece])
        to_corner, at = closest(np.where(piece > 0, corner, np.inf))

        distance, arm, _ = self._to_piece(points, on)
        tangent, side, line = self._tangent[on], self._side[on], self._line[on]
        length = np.maximum(np.hypot(*arm.T), 1e-15)
        gradient = np.where(line[:, None], _normal(tangent), (side / length)[:, None] * arm)
        curvature = np.where(line, 0.0, side / length)

        is_corner = to_corner < to_piece - self.overlap
        sign, length = np.where(y > height, -1.0, 1.0), np.maximum(to_corner, self.touch)
        distance = np.where(is_corner, sign * to_corner, distance)
        arm = points - np.column_stack([self.x[at], self.y[at]])
        gradient = np.where(is_corner[:, None], (sign / length)[:, None] * arm, gradient)
        curvature = np.where(is_corner, sign / length, curvature)

        hit = (to_corner < self.touch) & (np.abs(self._kink[at]) > 1e-9)
        angle = self._bisector[at]
        gradient = np.where(hit[:, None], np.column_stack([np.sin(angle), -np.cos(angle)]), gradient)
        return distance, gradient, np.where(hit, 0.0, curvature)


def _share(slope: float) -> float:
    """Of the way along y to a surface of at most this slope: farther along x than that it cannot come near."""
    slope = min(slope, 1.0)
    return 2 * slope / (1 + slope**2)


def _normal(tangent: np.ndarray) -> np.ndarray:
    """Unit normals (n, 2) towards the skin of a surface that runs along ``tangent`` (n, 2)."""
    return np.column_stack([tangent[:, 1], -tangent[:, 0]])


class Sampled(Curve):
    """A single-valued profile given by samples, joined by straight lines.

    Args:
        x, y: (n,) m; x strictly increasing. The lowest point is moved to height zero.
        ends: what is beyond the first and the last sample: nothing ("open"), a "level" surface at their heights, or the "slope"
            of the lines there, for ever. smooth: "auto", "none" or a cut-off wavelength, m (see :meth:`felt`).
        rounding: m, radius with which open ends turn away from the skin.

    Raises:
        ValueError: fewer than two samples or x not strictly increasing.
    """

    #: rad, slope of the sides into which open ends turn
    side = np.radians(80.0)

    def __init__(self, x, y, ends="open", smooth="auto", rounding=0.0):
        self.samples = self.measured = np.asarray(x, float), np.asarray(y, float) - np.min(y)
        self.ends, self.smooth = ends, smooth
        x, y = self.samples
        bend = np.zeros(max(len(x) - 1, 0))
        if ends != "slope" and len(x) >= 2 and np.all(np.diff(x) > 0):
            right = self._end(x[-2:], y[-2:], rounding)
            left = self._end(-x[1::-1], y[1::-1], rounding)
            self.own = slice(len(left[0]), len(left[0]) + len(bend))
            x = np.concatenate([-np.array(left[0][::-1]), x, right[0]])
            y, bend = (np.concatenate([left[k][::-1], inner, right[k]]) for k, inner in ((1, y), (2, bend)))
        super().__init__(x, y, bend)
        self.known = tuple(map(float, self.samples[0][[0, -1]]))
        if ends == "open":
            self.reach = self.known

    def _end(self, x, y, rounding):
        """x, y (k,) m and curvature (k,) 1/m of the pieces that follow the last of two samples on the right."""
        (x, last), (y, height) = x, y
        if self.ends == "level":
            return [last + (last - x)], [height], [0.0]
        slope = np.arctan2(height - y, last - x)
        turn = max(self.side - slope, 0.0) / 2
        xs, ys, bends = [], [], []
        if rounding and turn:
            chord = 2 * rounding * np.sin(turn)
            last, height = last + chord * np.cos(slope + turn), height + chord * np.sin(slope + turn)
            xs, ys, bends = [last], [height], [1 / rounding]
        length = rounding or 1e-4
        steep = slope + 2 * turn
        return [*xs, last + length * np.cos(steep)], [*ys, height + length * np.sin(steep)], [*bends, 0.0]

    def outline(self, x):
        height = self._height(x)
        return np.where((x >= self.reach[0]) & (x <= self.reach[1]), height, np.nan)

    def _farthest(self, x, y, height):
        within = super()._farthest(x, y, height)
        left = x < (self.known[0] + self.known[1]) / 2
        beyond = np.where(left, self.known[0] - x, x - self.known[1])
        # away from the steep sides the samples' own slopes count; beside them, how far their end is away
        end = np.hypot(beyond, y - np.where(left, *self.samples[1][[0, -1]]))
        inside = np.where(-beyond > within, np.abs(y - height) * _share(self.steepness), within)
        return np.where(beyond > 0, np.minimum(within, end), inside)

    def felt(self, edge):
        """The profile as skin with nodes ``edge`` m apart can feel it.

        What is finer is smoothed: as asked for, or with "auto" at two edges if the surface turns to and fro within half an edge.
        """
        if self.smooth == "none":
            return self.at(0.0, edge)
        if self.smooth != "auto":
            return self.at(self.smooth, edge)
        rough = turning(*self.samples, edge / 2).max(initial=0.0) > ROUGH
        return self.at(WAVE * edge if rough else 0.0, edge)

    def at(self, smoothing, edge):
        points = smoothed(*self.samples, smoothing) if smoothing else self.samples
        felt = Sampled(*points, self.ends, self.smooth, rounding=edge)
        felt.smoothing, felt.measured = smoothing, self.samples
        return felt

    def bulge(self, x: float, half_width: float) -> float:
        """Curvature (1/m) around the place near ``x`` m that stands out most, fitted over ``half_width`` m to either side."""
        near = np.linspace(x - half_width, x + half_width, 65)
        height = self.outline(near)
        if not np.isfinite(height).sum() > 3:
            return 0.0
        lowest = near[np.nanargmin(height)]
        near = np.linspace(lowest - half_width, lowest + half_width, 65)
        height = self.outline(near)
        there = np.isfinite(height)
        return float(2 * np.polyfit(near[there] - lowest, height[there], 2)[0])

    def moved(self, first: float, last: float) -> float:
        """Largest change (m) of the measured heights by the smoothing between two places (m), one as a whole apart."""
        x, y = self.measured
        near = (x >= first) & (x <= last)
        if not self.smoothing or not near.any():
            return 0.0
        change = self._height(x[near]) - y[near]
        return float(np.ptp(change) / 2)

    def advice(self, spacing):
        if not self.smoothing and turning(*self.samples, spacing / 2).max(initial=0.0) <= ROUGH:
            return None
        x, _ = self.measured
        apart, cutoff = float(np.median(np.diff(x))), max(2 * self.smoothing, WAVE * spacing)
        return (
            f"smoothing of the profile, whose corners are {apart * 1e6:.3g} um apart, the nodes {spacing * 1e6:.3g} um: "
            f'stimulus.smooth: "{cutoff * 1e6:.0f} um" or more'
        )


class Wavy(Curve):
    """Convex arcs of given curvatures, joined by hollow ones, between two flats at height zero.

    Every arc turns by ``half_angle`` to either side of its middle, so arcs share their tangents where they meet, all at height
    zero; between two convexities the radius is that of the second. The flats meet the first and the last arc at reentrant
    corners. x = 0 is the start of the lead-in. Inferred from the axes and the text of the thesis's chapter 5.

    Args:
        curvatures: 1/m, of the convexities. half_angle: rad. lead_in, run_out: m, the flats.
        fillet: m, radius of a hollow arc that rounds the two corners; 0 leaves them sharp.
    """

    def __init__(self, curvatures, half_angle, lead_in, run_out, fillet=0.0):
        radius = 1 / np.asarray(curvatures, float)
        # convex, then hollow and convex for each further one
        chords = 2 * np.sin(half_angle) * np.concatenate([radius[:1], np.repeat(radius[1:], 2)])
        x = np.cumsum([0.0, lead_in, *chords, run_out])
        y = np.zeros_like(x)
        bends = np.concatenate([[0.0, 1 / radius[0]], *([-1 / r, 1 / r] for r in radius[1:]), [0.0]])
        if fillet:
            (back, on, drop), (back_last, on_last, drop_last) = (_fillet(r, half_angle, fillet) for r in radius[[0, -1]])
            x = [x[0], x[1] - back, x[1] + on, *x[2:-2], x[-2] - on_last, x[-2] + back_last, x[-1]]
            y = [0.0, 0.0, -drop, *y[2:-2], -drop_last, 0.0, 0.0]
            bends = [0.0, -1 / fillet, *bends[1:-1], -1 / fillet, 0.0]
        super().__init__(x, y, bends)


def _fillet(radius: float, half_angle: float, fillet: float) -> tuple[float, float, float]:
    """Where the rounding of a corner ends: m on the flat, along x on the arc and down there, all from the corner."""
    # its centre lies below the flat, as far from the arc's centre as both radii
    across = fillet + radius * np.cos(half_angle)
    along = np.sqrt((radius + fillet) ** 2 - across**2)
    share = radius / (radius + fillet)
    return (
        along - radius * np.sin(half_angle),
        radius * np.sin(half_angle) - share * along,
        share * across - radius * np.cos(half_angle),
    )


def profile_of(stimulus) -> Profile:
    """The profile of a scene's stimulus (the validated model, SI)."""
    match stimulus.shape:
        case "flat":
            return Flat()
        case "cylinder":
            return Cylinder(stimulus.curvature)
        case "bar":
            return Bar(stimulus.width, stimulus.fillet)
        case "line":
            return Line()
        case "sampled":
            return Sampled(stimulus.x, stimulus.y, stimulus.ends, stimulus.smooth)
        case "wavy":
            return Wavy(stimulus.curvatures, stimulus.half_angle, stimulus.lead_in, stimulus.run_out, stimulus.fillet)
    raise ValueError(f"no profile called {stimulus.shape!r}")

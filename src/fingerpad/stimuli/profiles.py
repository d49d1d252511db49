"""Rigid profiles as signed-distance functions.

A profile lives in its own frame: its lowest point is the origin, the solid lies above, x is lateral. ``evaluate`` returns, at
any points, the distance (positive outside the solid), its gradient (pointing away from the solid, towards the skin) and the
curvature of the level set through the point (the only nonzero eigenvalue of the distance's second derivative). The contact
problem needs no more; a new shape is one class here.
"""

from dataclasses import dataclass

import numpy as np


class Profile:
    """Base of all profiles: ``evaluate(points (n, 2) m) -> distance (n,) m, gradient (n, 2), curvature (n,) 1/m``."""

    symmetric = True
    #: positions along x (m) where the profile's own edges press; the mesh planner refines there
    edges: tuple[float, ...] = ()
    singular = False

    def evaluate(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        raise NotImplementedError

    def outline(self, x: np.ndarray) -> np.ndarray:
        """Height of the lower surface (n,) m over ``x`` (n,) m; NaN where the profile does not reach."""
        raise NotImplementedError


@dataclass(frozen=True)
class Flat(Profile):
    """A flat plate."""

    def evaluate(self, points):
        n = len(points)
        return -points[:, 1], np.tile([0.0, -1.0], (n, 1)), np.zeros(n)

    def outline(self, x):
        return np.zeros_like(x)


@dataclass(frozen=True)
class Cylinder(Profile):
    """A cylinder of ``curvature`` 1/m with its axis along the third direction."""

    curvature: float

    def evaluate(self, points):
        radius = 1 / self.curvature
        arm = points - np.array([0.0, radius])
        length = np.maximum(np.hypot(arm[:, 0], arm[:, 1]), 1e-12 * radius)
        return length - radius, arm / length[:, None], 1 / length

    def outline(self, x):
        radius = 1 / self.curvature
        return radius - np.sqrt(np.where(np.abs(x) <= radius, radius**2 - x**2, np.nan))


@dataclass(frozen=True)
class Bar(Profile):
    """A rectangular bar of ``width`` m whose lower edges are rounded with radius ``fillet`` m (0: sharp)."""

    width: float
    fillet: float = 0.0
    singular = True

    @property
    def edges(self):
        return (-self.width / 2, self.width / 2)

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


class Sampled(Profile):
    """A single-valued profile given by samples, joined by straight lines; the distance to that polyline is exact.

    Args:
        x, y: (n,) m; x strictly increasing. The lowest point is moved to height zero.

    Raises:
        ValueError: fewer than two samples or x not strictly increasing.
    """

    def __init__(self, x, y):
        x, y = np.asarray(x, float), np.asarray(y, float)
        if len(x) < 2 or len(x) != len(y) or np.any(np.diff(x) <= 0):
            raise ValueError("a sampled profile needs at least two samples with strictly increasing x")
        self.x, self.y = x, y - y.min()
        self.symmetric = bool(
            np.allclose(x, -x[::-1], atol=1e-9 * np.ptp(x)) and np.allclose(self.y, self.y[::-1], atol=1e-9 * np.ptp(x))
        )

    def evaluate(self, points):
        start = np.column_stack([self.x[:-1], self.y[:-1]])
        along = np.column_stack([np.diff(self.x), np.diff(self.y)])
        # the first and the last segment go on for ever
        share = np.einsum("nsi,si->ns", points[:, None] - start, along) / np.sum(along**2, 1)
        low, high = np.zeros(len(along)), np.ones(len(along))
        low[0], high[-1] = -np.inf, np.inf
        inside = (share > low) & (share < high)
        share = np.clip(share, low, high)
        arm = points[:, None] - (start + share[..., None] * along)
        length = np.hypot(arm[..., 0], arm[..., 1])
        best = length.argmin(1)
        rows = np.arange(len(points))
        arm, length, on_segment = arm[rows, best], length[rows, best], inside[rows, best]
        normal = np.column_stack([along[best, 1], -along[best, 0]]) / np.hypot(*along[best].T)[:, None]
        above = points[:, 1] > np.interp(points[:, 0], self.x, self.y)
        outside_range = (points[:, 0] < self.x[0]) | (points[:, 0] > self.x[-1])
        above = np.where(outside_range, np.einsum("ni,ni->n", arm, normal) < 0, above)
        sign = np.where(above, -1.0, 1.0)
        near = length < 1e-12
        gradient = np.where((near | on_segment)[:, None], normal, sign[:, None] * arm / np.where(near, 1, length)[:, None])
        curvature = np.where(on_segment | near, 0.0, sign / np.where(near, 1, length))
        return sign * length, gradient, curvature

    def outline(self, x):
        return np.interp(x, self.x, self.y)


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
            return Sampled(stimulus.x, stimulus.y)
    raise ValueError(f"no profile called {stimulus.shape!r}")

"""The pad's outline: a smooth symmetric section, its offset layers and the bone inside it.

The right half is parametrised by the angle theta, from the apex (0) to the bottom (pi):

    x = a sin(theta) (1 + c sin(theta)^2),    y = b cos(theta),

with b the apex height above the horizontal diameter and the depth below it underneath. The scale a
is the geometric mean of apex radius and apex height, so the radius of curvature at the apex is the
one asked for; c makes the half width the one asked for. Negative angles are the left half. Lengths
in m, curvatures in 1/m.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

_GAUSS_POINTS, _GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(8)
_INTERVALS = 256  # of the arc-length table; even, so that theta = pi/2 is one of its points
_SAMPLES = 4001  # points at which an inequality along the outline is checked


class OutlineLike(Protocol):
    """What an outline says, m."""

    apex_height: float
    apex_radius: float
    half_width: float
    depth_below: float
    epidermis_thickness: float
    dermis_thickness: float
    stratum_corneum_thickness: float
    bone_centre_height: float
    bone_half_width: float
    bone_half_height: float
    nail_half_width: float


class OutlineError(ValueError):
    """The outline, its layers or its bone cannot be drawn; the message is one line."""


def _mm(length: float) -> str:
    return f"{length * 1e3:.4g} mm"


def bisect(negative_below, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Elementwise brackets (low, high), down to rounding, of the root of an increasing function.

    `negative_below(t)` tells where it is still negative. Meshes hang on the last bit of it, so no
    other root finder will do.
    """
    low, high = low.copy(), high.copy()
    for _ in range(60):
        middle = 0.5 * (low + high)
        below = negative_below(middle)
        low = np.where(below, middle, low)
        high = np.where(below, high, middle)
    return low, high


class OutlineCurve:
    """Geometry of one outline: points, normals, curvature, arc length, offset curves and bone.

    Parameters
    ----------
    outline : as `OutlineLike` (all lengths in m).

    Raises
    ------
    OutlineError
        when the section is not convex, the layers are thicker than the smallest radius of
        curvature, the layers reach the bone, or the nail is wider than the pad.
    """

    def __init__(self, outline: OutlineLike):
        self.outline = outline
        self.scale = float(np.sqrt(outline.apex_radius * outline.apex_height))
        self.widening = outline.half_width / self.scale - 1.0
        self.layer_depths = (
            outline.epidermis_thickness,
            outline.epidermis_thickness + outline.dermis_thickness,
        )
        self._check_shape()
        self._theta = np.linspace(0.0, np.pi, _INTERVALS + 1)
        self._arc = np.concatenate(
            ([0.0], np.cumsum(self._interval(self._theta[:-1], self._theta[1:])))
        )
        self._check_layers()

    # -- the skin ------------------------------------------------------------------------------

    def _height(self, theta: np.ndarray) -> np.ndarray:
        return np.where(
            np.abs(theta) <= 0.5 * np.pi, self.outline.apex_height, self.outline.depth_below
        )

    def _tangent(self, theta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        sine, cosine = np.sin(theta), np.cos(theta)
        return (
            self.scale * cosine * (1.0 + 3.0 * self.widening * sine**2),
            -self._height(theta) * sine,
        )

    def normal(self, theta: ArrayLike) -> np.ndarray:
        """Outward unit normals, shape (n, 2), at the angles theta, shape (n,)."""
        dx, dy = self._tangent(np.atleast_1d(np.asarray(theta, dtype=float)))
        speed = np.hypot(dx, dy)
        return np.column_stack((-dy / speed, dx / speed))

    def point(self, theta: ArrayLike, depth: ArrayLike = 0.0) -> np.ndarray:
        """Points (n, 2) in m at the angles theta (n,), `depth` m below the skin along the
        normal.
        """
        theta = np.atleast_1d(np.asarray(theta, dtype=float))
        sine = np.sin(theta)
        skin = np.column_stack(
            (
                self.scale * sine * (1.0 + self.widening * sine**2),
                self._height(theta) * np.cos(theta),
            )
        )
        points = skin - np.asarray(depth, dtype=float).reshape(-1, 1) * self.normal(theta)
        points[(theta == 0.0) | (np.abs(theta) == np.pi), 0] = 0.0  # exactly on the axis
        return points

    def curvature(self, theta: ArrayLike) -> np.ndarray:
        """Curvature (n,) in 1/m of the skin at the angles theta, positive for a convex skin."""
        theta = np.atleast_1d(np.asarray(theta, dtype=float))
        square = np.sin(theta) ** 2
        dx, dy = self._tangent(theta)
        turning = 1.0 + 3.0 * self.widening * square * (2.0 * square - 1.0)
        return self.scale * self._height(theta) * turning / np.hypot(dx, dy) ** 3

    def _interval(self, low: np.ndarray, high: np.ndarray) -> np.ndarray:
        """Arc length between angles inside one interval of the table, by Gauss quadrature."""
        half = 0.5 * (high - low)
        theta = 0.5 * (high + low)[:, None] + half[:, None] * _GAUSS_POINTS
        return half * (np.hypot(*self._tangent(theta)) @ _GAUSS_WEIGHTS)

    @property
    def length(self) -> float:
        """Arc length in m of the right half, apex to bottom."""
        return float(self._arc[-1])

    def arc_length(self, theta: ArrayLike) -> np.ndarray:
        """Signed arc length (n,) in m from the apex to the angles theta."""
        theta = np.atleast_1d(np.asarray(theta, dtype=float))
        size = np.abs(theta)
        index = np.minimum((size / np.pi * _INTERVALS).astype(int), _INTERVALS - 1)
        return np.sign(theta) * (self._arc[index] + self._interval(self._theta[index], size))

    def theta_at(self, arc_length: ArrayLike) -> np.ndarray:
        """Angles (n,) at a signed arc length (n,) in m from the apex; the ends are exactly 0 and
        pi.
        """
        arc_length = np.atleast_1d(np.asarray(arc_length, dtype=float))
        target = np.abs(arc_length)
        index = np.clip(np.searchsorted(self._arc, target, side="right") - 1, 0, _INTERVALS - 1)
        low, high = self._theta[index], self._theta[index + 1]
        theta = low + (high - low) * (target - self._arc[index]) / (
            self._arc[index + 1] - self._arc[index]
        )
        for _ in range(4):
            rate = np.hypot(*self._tangent(theta))
            theta = theta - (self._arc[index] + self._interval(low, theta) - target) / rate
            theta = np.clip(theta, low, high)
        theta = np.where(target >= self.length, np.pi, np.where(target == 0.0, 0.0, theta))
        return np.sign(arc_length) * theta

    def theta_at_x(self, x: ArrayLike, lower: bool = False) -> np.ndarray:
        """Angles (n,) where the upper (or lower) half of the skin passes x (n,) in m, |x| <=
        half_width.
        """
        x = np.atleast_1d(np.asarray(x, dtype=float))
        size = np.abs(x)

        def inside(theta):
            sine = np.sin(theta)
            return self.scale * sine * (1.0 + self.widening * sine**2) < size

        upper = 0.5 * sum(bisect(inside, np.zeros_like(size), np.full_like(size, 0.5 * np.pi)))
        upper = np.where(size == 0.0, 0.0, upper)
        return np.where(x < 0.0, -1.0, 1.0) * (np.pi - upper if lower else upper)

    # -- the bone ------------------------------------------------------------------------------

    def bone_point(self, phi: ArrayLike) -> np.ndarray:
        """Points (n, 2) in m of the bone's rim at the ellipse's angles phi (n,), top 0 to bottom
        pi.
        """
        phi = np.atleast_1d(np.asarray(phi, dtype=float))
        outline = self.outline
        x = np.where(np.abs(phi) == np.pi, 0.0, outline.bone_half_width * np.sin(phi))
        return np.column_stack(
            (x, outline.bone_centre_height + outline.bone_half_height * np.cos(phi))
        )

    def bone_foot(self, points: np.ndarray) -> np.ndarray:
        """Angles phi (n,) of the bone's points nearest to `points` (n, 2), x >= 0, outside the
        bone.
        """
        width, height = self.outline.bone_half_width, self.outline.bone_half_height
        x, y = points[:, 0], points[:, 1] - self.outline.bone_centre_height

        def before_foot(phi):
            along = (width * np.sin(phi) - x) * width * np.cos(phi)
            return along - (height * np.cos(phi) - y) * height * np.sin(phi) < 0.0

        start = np.where(y >= 0.0, 0.0, 0.5 * np.pi)
        phi = 0.5 * sum(bisect(before_foot, start, start + 0.5 * np.pi))
        return np.where(x == 0.0, np.where(y >= 0.0, 0.0, np.pi), phi)

    # -- what is not allowed -------------------------------------------------------------------

    def _check_shape(self) -> None:
        narrowest, widest = self.scale * 2.0 / 3.0, self.scale * 11.0 / 3.0
        if not narrowest < self.outline.half_width < widest:
            raise OutlineError(
                f"outline: half_width {_mm(self.outline.half_width)} makes the skin concave; "
                f"with this apex it must lie between {_mm(narrowest)} and {_mm(widest)}"
            )
        if not 0.0 < self.outline.nail_half_width < self.outline.half_width:
            raise OutlineError(
                f"outline: nail_half_width {_mm(self.outline.nail_half_width)} must be above 0 "
                f"and below half_width, {_mm(self.outline.half_width)}"
            )

    def _check_layers(self) -> None:
        thickness = self.layer_depths[-1]
        keys = f"outline: epidermis_thickness + dermis_thickness = {_mm(thickness)}"
        theta = np.linspace(0.0, np.pi, _SAMPLES)
        radius = 1.0 / self.curvature(theta).max()
        if not 0.0 < thickness < radius:
            raise OutlineError(
                f"{keys} must be above 0 and below the skin's smallest radius, {_mm(radius)}"
            )
        skin = self.point(theta)
        outline = self.outline
        inside = np.hypot(
            skin[:, 0] / outline.bone_half_width,
            (skin[:, 1] - outline.bone_centre_height) / outline.bone_half_height,
        )
        if (
            inside.min() <= 1.0
            or not -outline.depth_below < outline.bone_centre_height < outline.apex_height
        ):
            raise OutlineError(
                "outline: the bone (bone_centre_height, bone_half_width, bone_half_height) "
                "must lie inside the skin"
            )
        room = np.hypot(*(skin - self.bone_point(self.bone_foot(skin))).T).min()
        if thickness >= room:
            raise OutlineError(
                f"{keys} reaches the bone, which leaves room for less than {_mm(room)}"
            )


@lru_cache(maxsize=16)  # of a sweep every finger may be another one
def curve_of(outline: OutlineLike) -> OutlineCurve:
    """The curve of an outline, made and checked once. Raises OutlineError."""
    return OutlineCurve(outline)

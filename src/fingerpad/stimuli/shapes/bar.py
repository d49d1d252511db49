"""A bar with sharp or rounded edges."""

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from fingerpad.documents import Problem
from fingerpad.fields import Length, quantity
from fingerpad.stimuli.shapes.shape import Shape
from fingerpad.units import format_quantity


class Rounded(Shape):
    """A rectangle of ``width`` m whose lower edges are rounded with radius ``fillet`` m (0:
    sharp).
    """

    singular: ClassVar[bool] = True

    @property
    def edges(self):
        return (-self.width / 2, self.width / 2)

    @property
    def reach(self):
        return self.edges

    @property
    def edge_radius(self):
        return self.fillet

    @property
    def unbounded(self):
        return self.fillet == 0

    def evaluate(self, points):
        # distance to the half-infinite box shrunk by the fillet, minus the fillet
        half = self.width / 2 - self.fillet
        x, y = np.abs(points[:, 0]), points[:, 1]
        sign = np.where(points[:, 0] < 0, -1.0, 1.0)
        dx, dy = x - half, self.fillet - y
        outside = ((dx > 0) | (half == 0)) & (
            dy > 0
        )  # a full round has no flat between its corners
        corner = np.maximum(np.hypot(dx, dy), 1e-15)
        side = ~outside & (dx > dy)
        distance = np.where(outside, corner, np.where(side, dx, dy)) - self.fillet
        gradient = np.zeros(points.shape)
        gradient[:, 0] = np.where(outside, sign * dx / corner, np.where(side, sign, 0.0))
        gradient[:, 1] = np.where(outside, -dy / corner, np.where(side, 0.0, -1.0))
        # a sharp corner has no curvature of its own to offer: its level sets are circles only away
        # from it
        curvature = np.where(outside & (corner > 1e-9), 1 / corner, 0.0)
        return distance, gradient, curvature

    def outline(self, x):
        over = np.abs(x) - (self.width / 2 - self.fillet)
        rise = self.fillet - np.sqrt(np.maximum(self.fillet**2 - np.maximum(over, 0) ** 2, 0))
        return np.where(np.abs(x) <= self.width / 2, rise, np.nan)


class Bar(Rounded):
    """Rigid rectangular bar lying along the finger's axis."""

    shape: Literal["bar"] = "bar"
    width: Length
    """Width of the face."""
    fillet: quantity("length", "non-negative") = 0.0
    """Radius of the rounded edges."""

    @property
    def face(self):
        return self.width / 2

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.fillet > self.width / 2:
            raise Problem(
                "is more than half the width",
                f"0 mm to {format_quantity(self.width / 2, 'length')}",
                ("fillet",),
            )
        return self

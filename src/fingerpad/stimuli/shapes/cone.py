"""A cone with a round tip."""

from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from fingerpad.documents import Problem
from fingerpad.fields import Length, quantity
from fingerpad.stimuli.shapes.shape import Shape


class Cone(Shape):
    """Rigid cone with a round tip, on the axis of a body of revolution."""

    kinematics: ClassVar = ("axisymmetric",)
    shape: Literal["cone"] = "cone"
    half_angle: quantity("angle")
    """Angle between its axis and its flank."""
    radius: Length
    """Radius of the tip."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.half_angle >= np.radians(89.0):
            raise Problem("is outside the range", "above 0 deg and below 89 deg", ("half_angle",))
        return self

    @property
    def convexity(self):
        return 1 / self.radius

    @property
    def tip(self):
        return float(self._flank[0][0])

    @property
    def flank(self):
        return 1 / np.tan(self.half_angle)

    def bend_over(self, half_width):
        return 2 * float(self.outline(np.array([half_width]))[0]) / half_width**2

    @property
    def _flank(self):
        """Where the flank begins (2,) m, and its direction (2,)."""
        sine, cosine = np.sin(self.half_angle), np.cos(self.half_angle)
        return self.radius * np.array([cosine, 1 - sine]), np.array([sine, cosine])

    def evaluate(self, points):
        begin, along = self._flank
        sign = np.where(points[:, 0] < 0, -1.0, 1.0)
        place = np.column_stack([np.abs(points[:, 0]), points[:, 1]])
        normal, arm = np.array([along[1], -along[0]]), place - [0.0, self.radius]
        flank = (place - begin) @ along > 0
        length = np.maximum(np.hypot(*arm.T), 1e-12 * self.radius)
        distance = np.where(flank, (place - begin) @ normal, length - self.radius)
        gradient = np.where(flank[:, None], normal, arm / length[:, None])
        gradient[:, 0] *= sign
        return distance, gradient, np.where(flank, 0.0, 1 / length)

    def outline(self, x):
        begin, along = self._flank
        x = np.abs(x)
        tip = self.radius - np.sqrt(np.maximum(self.radius**2 - x**2, 0.0))
        return np.where(x < begin[0], tip, begin[1] + (x - begin[0]) * along[1] / along[0])

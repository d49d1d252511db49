"""A flat plate."""

from typing import ClassVar, Literal

import numpy as np

from fingerpad.stimuli.shapes.shape import Shape


class Flat(Shape):
    """Rigid flat plate."""

    kinematics: ClassVar = ("plane_strain", "axisymmetric")
    shape: Literal["flat"] = "flat"
    steepness: ClassVar[float] = 0.0

    def evaluate(self, points):
        n = len(points)
        return -points[:, 1], np.tile([0.0, -1.0], (n, 1)), np.zeros(n)

    def outline(self, x):
        return np.zeros_like(x)

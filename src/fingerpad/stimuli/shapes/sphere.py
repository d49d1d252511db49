"""A sphere."""

from typing import ClassVar, Literal

from fingerpad.stimuli.shapes.cylinder import Cylinder


class Sphere(Cylinder):
    """Rigid sphere over the axis of a body of revolution; its section is a cylinder's."""

    kinematics: ClassVar = ("axisymmetric",)
    shape: Literal["sphere"] = "sphere"

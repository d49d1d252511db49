"""A flat-ended circular punch: a probe."""

from typing import ClassVar, Literal, Self

from pydantic import model_validator

from fingerpad.documents import Problem
from fingerpad.fields import Length, quantity
from fingerpad.stimuli.shapes.bar import Rounded
from fingerpad.units import format_quantity


class Punch(Rounded):
    """Rigid circular cylinder that presses with its flat end, on the axis of a body of
    revolution.
    """

    kinematics: ClassVar = ("axisymmetric",)
    shape: Literal["punch"] = "punch"
    diameter: Length
    """Diameter of the punch."""
    fillet: quantity("length", "non-negative") = 0.0
    """Radius of the rounded edge."""

    @property
    def width(self):
        return self.diameter

    @property
    def face(self):
        return self.diameter / 2

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.fillet > self.diameter / 2:
            allowed = f"0 mm to {format_quantity(self.diameter / 2, 'length')}"
            raise Problem("is more than half the diameter", allowed, ("fillet",))
        return self

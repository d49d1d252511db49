"""A line load."""

from typing import ClassVar, Literal

from fingerpad.stimuli.shapes.bar import Rounded


class Line(Rounded):
    """Line load: a knife edge lying along the finger's axis."""

    # A true line would sink in without end; a round tip of 0.1 mm makes the problem well posed.
    # Beyond a few radii from the tip nothing depends on it, the peak pressure does.
    shape: Literal["line"] = "line"
    fillet: ClassVar[float] = 0.1e-3
    width: ClassVar[float] = 2 * fillet

    @property
    def convexity(self):
        return 1 / self.fillet

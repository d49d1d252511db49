"""The surface of the thesis's chapter 5: convexities and hollows between two flats."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import BeforeValidator, model_validator

from fingerpad.documents import Problem
from fingerpad.fields import Length, filled, quantity
from fingerpad.stimuli.curve import Curve
from fingerpad.stimuli.shapes.shape import CurvedShape
from fingerpad.units import format_quantity


class Wavy(CurvedShape):
    """Rigid surface of cylindrical convexities joined by concavities between two flats, after the
    thesis's chapter 5.

    x = 0, the start of the lead-in, is over the middle of the pad when the motion begins.
    """

    shape: Literal["wavy"] = "wavy"
    curvatures: Annotated[tuple[quantity("curvature"), ...], BeforeValidator(filled)] = tuple(
        1e3 / radius for radius in (38.1, 25.4, 19.05, 12.7, 9.525, 6.35, 4.7625, 3.175)
    )
    """Curvatures of the convexities, in their order; a concavity has the radius of the convexity
    after it.
    """
    half_angle: quantity("angle") = math.radians(9.0)
    """Angle by which every arc turns to either side of its middle."""
    lead_in: Length = 8e-3
    """Length of the flat before the first convexity."""
    run_out: Length = 10e-3
    """Length of the flat after the last convexity."""
    fillet: quantity("length", "non-negative") = 0.0
    """Radius of rounding of the two reentrant corners where the flats meet the arcs."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.half_angle >= math.radians(45.0):
            raise Problem("is outside the range", "above 0 deg and below 45 deg", ("half_angle",))
        # a fillet of radius r ends on the flat: (lead_in + R sin)^2 = (R + r)^2 - (R cos + r)^2 at
        # most
        sine, drop = math.sin(self.half_angle), 1 - math.cos(self.half_angle)
        ends = ((self.lead_in, 1 / self.curvatures[0]), (self.run_out, 1 / self.curvatures[-1]))
        largest = min(
            flat * (flat + 2 * radius * sine) / (2 * radius * drop) for flat, radius in ends
        )
        if self.fillet >= largest:
            allowed = f"0 mm to below {format_quantity(largest, 'length')}"
            raise Problem("does not fit the flat beside it", allowed, ("fillet",))
        return self

    @property
    def length(self) -> float:
        """Length of the surface along x, m."""
        first, *others = (1 / curvature for curvature in self.curvatures)
        return (
            self.lead_in + 2 * math.sin(self.half_angle) * (first + 2 * sum(others)) + self.run_out
        )

    @cached_property
    def curve(self) -> Curve:
        """Convex arcs, joined by hollow ones, between two flats at height zero.

        Every arc turns by ``half_angle`` to either side of its middle, so arcs share their tangents
        where they meet, all at height zero; between two convexities the radius is that of the
        second. The flats meet the first and the last arc at reentrant corners, sharp or rounded by
        a hollow arc. Inferred from the axes and the text of the thesis's chapter 5.
        """
        radius = 1 / np.asarray(self.curvatures, float)
        # convex, then hollow and convex for each further one
        chords = (
            2 * np.sin(self.half_angle) * np.concatenate([radius[:1], np.repeat(radius[1:], 2)])
        )
        x = np.cumsum([0.0, self.lead_in, *chords, self.run_out])
        y = np.zeros_like(x)
        bends = np.concatenate(
            [[0.0, 1 / radius[0]], *([-1 / r, 1 / r] for r in radius[1:]), [0.0]]
        )
        if self.fillet:
            (back, on, drop), (back_last, on_last, drop_last) = (
                _fillet(r, self.half_angle, self.fillet) for r in radius[[0, -1]]
            )
            x = [x[0], x[1] - back, x[1] + on, *x[2:-2], x[-2] - on_last, x[-2] + back_last, x[-1]]
            y = [0.0, 0.0, -drop, *y[2:-2], -drop_last, 0.0, 0.0]
            bends = [0.0, -1 / self.fillet, *bends[1:-1], -1 / self.fillet, 0.0]
        return Curve(x, y, bends)


def _fillet(radius: float, half_angle: float, fillet: float) -> tuple[float, float, float]:
    """Where the rounding of a corner ends: m on the flat, along x on the arc and down there, all
    from the corner.
    """
    # its centre lies below the flat, as far from the arc's centre as both radii
    across = fillet + radius * np.cos(half_angle)
    along = np.sqrt((radius + fillet) ** 2 - across**2)
    share = radius / (radius + fillet)
    return (
        along - radius * np.sin(half_angle),
        radius * np.sin(half_angle) - share * along,
        share * across - radius * np.cos(half_angle),
    )

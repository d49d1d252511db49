"""A cylinder."""

from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import ConfigDict, Field

from fingerpad.documents import HIDE, Problem
from fingerpad.fields import SI, Length, quantity, read
from fingerpad.stimuli.shapes.shape import Shape


def _one_size(schema: dict[str, Any]) -> None:
    schema["oneOf"] = [{"required": [key]} for key in ("curvature", "radius", "diameter")]
    del schema["required"]


class Cylinder(Shape):
    """Rigid cylinder lying along the finger's axis."""

    model_config = ConfigDict(json_schema_extra=_one_size)
    follows: ClassVar = {"radius": ("curvature",), "diameter": ("curvature",)}
    shape: Literal["cylinder"] = "cylinder"
    curvature: quantity("curvature", note=": for a curvature of zero use shape: flat")
    """Curvature, the inverse of the radius; or give `radius` or `diameter` instead."""
    radius: Length | None = Field(default=None, exclude=True)
    """Radius, in place of the curvature."""
    diameter: Length | None = Field(default=None, exclude=True)
    """Diameter, in place of the curvature."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """The curvature is that of the radius or diameter given."""
        given = [key for key in ("curvature", "radius", "diameter") if data.get(key) is not None]
        if len(given) > 1:
            raise Problem(
                f"is given beside {given[0]}",
                "one of curvature, radius and diameter",
                (given[1],),
                HIDE,
            )
        if given in (["radius"], ["diameter"]):
            length = read(Length, data[given[0]], given[0], context)
            data["curvature"] = SI((1 if given == ["radius"] else 2) / length)
            del data[given[0]]
        return data

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
        share = x / radius
        return x * share / (1 + np.sqrt(np.where(np.abs(share) <= 1, 1 - share**2, np.nan)))

"""What all shapes have in common, and their register: scenes, their schema, the planner and the
solver find them there.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from inspect import get_annotations
from operator import attrgetter
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from fingerpad.documents import HIDE, Problem, Strict, nearest
from fingerpad.fields import OneOf
from fingerpad.stimuli.curve import Curve
from fingerpad.stimuli.profile import Profile

#: name in a scene -> shape
SHAPES: dict[str, type[Shape]] = {}


class Shape(Strict, Profile):
    """A rigid shape: the keys a scene gives it, and its geometry.

    A subclass is a shape under the name that is the default of its field ``shape``.

    Attributes
    ----------
    kinematics
        In which it can touch: "plane_strain", "axisymmetric", or both.
    """

    kinematics: ClassVar[tuple[str, ...]] = ("plane_strain",)

    if TYPE_CHECKING:
        shape: str

    @classmethod
    def __pydantic_init_subclass__(cls, **_: Any) -> None:
        if "shape" in get_annotations(
            cls
        ):  # a class that only evaluates otherwise has the name of its parent, and not its place
            SHAPES[cls.model_fields["shape"].default] = cls

    def turned(self) -> Shape:
        """The shape whose right half this is, for a body of revolution.

        Raises
        ------
        Problem
            It has points on the other side of the axis.
        """
        return self

    def recorded(self) -> dict[str, Any]:
        """What provenance says of it beside its fields."""
        return {}


class CurvedShape(Shape):
    """A shape whose surface is a :class:`fingerpad.stimuli.curve.Curve`, and answers as it does."""

    @cached_property
    def curve(self) -> Curve:
        """Its surface."""
        raise NotImplementedError

    def model_copy(self, **how):
        """A copy may get other fields: it makes its own curve."""
        copied = super().model_copy(**how)
        copied.__dict__.pop("curve", None)
        return copied


for _name in (
    *("evaluate", "outline", "corners", "cutoffs", "felt", "at", "advice", "segments"),
    *("symmetric", "uneven", "irregular", "steepness", "convexity", "dip", "reach", "known"),
    *("tip", "flank"),
):
    setattr(CurvedShape, _name, property(attrgetter(f"curve.{_name}")))


def _shape_of(value: Any) -> type[Shape]:
    """The kind of a shape, or of the mapping that describes one."""
    if isinstance(value, Shape):
        return type(value)
    if not isinstance(value, Mapping):
        raise Problem(
            "is not a mapping", '{shape: flat} or {shape: cylinder, curvature: "210 1/m"}'
        )
    if "shape" not in value:
        raise Problem("is missing", ", ".join(SHAPES), ("shape",), HIDE)
    name = value["shape"]
    if not isinstance(name, str) or name not in SHAPES:
        raise Problem(f"is not a known shape{nearest(name, SHAPES)}", ", ".join(SHAPES), ("shape",))
    return SHAPES[name]


def shape_from(data: Mapping[str, Any], context: Any = None) -> Shape:
    """The shape that `data` describes: SI numbers, or with the `context` of a document text with
    units.

    Raises
    ------
    Problem, ValidationError
        It is none, or one of its values is wrong.
    """
    return _shape_of(data).model_validate(data, context=context)


Stimulus = Annotated[Shape, OneOf(_shape_of, SHAPES)]
"""Field type: what touches the pad."""

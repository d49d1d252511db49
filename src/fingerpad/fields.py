"""Types of the fields of a document: quantities, numbers and lists, checked as they are read."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationError, ValidationInfo

from fingerpad.documents import Problem
from fingerpad.units import DIMENSIONS, QUANTITY_PATTERN, QuantityError, parse_number, parse_quantity


class SI(float):
    """A number already in SI that takes the place of text in a document being filled in."""


class _Whole(int):
    """A whole number as a document says it, see :func:`as_written`."""


class _Number(float):
    """A number as a document says it, see :func:`as_written`."""


def as_written(value: Any) -> Any:
    """`value` of a document, with the numbers in it told from SI numbers: where a unit is needed, they have none."""
    if isinstance(value, (bool, SI)):
        return value
    if isinstance(value, Mapping):
        return {key: as_written(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(map(as_written, value))
    return _Whole(value) if type(value) is int else _Number(value) if type(value) is float else value


def quantity(
    dimension: str,
    sign: Literal["positive", "non-negative", "nonzero", "any"] = "positive",
    note: str = "",
    words: tuple[str, ...] = (),
) -> Any:
    """Field type: text with a unit in a document, an SI float in Python; `note` explains a wrong `sign`, `words` may stay."""

    def parse(value: Any, info: ValidationInfo) -> float | str:
        if isinstance(value, str) and value in words:
            return value
        in_python = isinstance(value, SI) or (info.context is None and not isinstance(value, (_Whole, _Number)))
        kind = DIMENSIONS[dimension]
        try:
            result = parse_number(value) if in_python and not isinstance(value, str) else parse_quantity(value, dimension)
        except QuantityError as error:
            if words:
                raise Problem(error.problem, " or ".join((*words, error.allowed))) from None
            raise
        wrong = {"positive": result <= 0, "non-negative": result < 0, "nonzero": result == 0, "any": False}[sign]
        if wrong:
            right = {"positive": "above zero", "non-negative": "of zero or more", "nonzero": "other than zero"}[sign]
            what = "is negative" if result < 0 else "is zero"
            raise Problem(f"{what}{note}", f"{kind.noun} {right} such as '{kind.example}'")
        return result

    surface = Annotated[
        str,
        Field(
            pattern=QUANTITY_PATTERN,
            description=f"{DIMENSIONS[dimension].noun} with its unit",
            examples=[DIMENSIONS[dimension].example],
        ),
    ]
    kind = float
    if words:
        kind, surface = float | Literal[words], Literal[words] | surface
    return Annotated[kind, BeforeValidator(parse, json_schema_input_type=surface)]


def number(allowed: str, low: float, high: float, *, low_included: bool = False) -> Any:
    """Field type: a number (or its text) between two bounds, the upper one excluded."""

    def parse(value: Any) -> float:
        result = parse_number(value)
        if not (low < result < high or (low_included and result == low)):
            raise Problem("is outside the range", allowed)
        return result

    bounds: dict[str, float] = {"ge" if low_included else "gt": low}
    if math.isfinite(high):
        bounds["lt"] = high
    surface = Annotated[float, Field(**bounds)] | Annotated[str, Field(pattern=r"^\s*[+-]?[0-9.]+([eE][+-]?[0-9]+)?\s*%?\s*$")]
    return Annotated[float, BeforeValidator(parse, json_schema_input_type=surface)]


def whole(low: int, high: int) -> Any:
    """Field type: a whole number between two bounds, both included."""

    def parse(value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise Problem("is not in the range", f"a whole number from {low} to {high}")
        return value

    return Annotated[int, BeforeValidator(parse, json_schema_input_type=Annotated[int, Field(ge=low, le=high)])]


def read(kind: Any, value: Any, key: str, context: Any) -> Any:
    """`value` of the field `key` read as the field type `kind`, before the model is there; `Problem` if it is wrong."""
    try:
        return TypeAdapter(kind).validate_python(value, context=context)
    except ValidationError as error:
        cause = error.errors()[0].get("ctx", {}).get("error")
        raise Problem(getattr(cause, "problem", "is not valid"), getattr(cause, "allowed", ""), (key,)) from None


def listed(value: Any) -> Any:
    """`value` if it is a list; `Problem` otherwise."""
    if not isinstance(value, (list, tuple)):
        raise Problem("is not a list", f"a list, in square brackets: [{json.dumps(value, default=str)}]")
    return value


def filled(value: Any) -> Any:
    """`value` if it is a list with something in it; `Problem` otherwise."""
    if not listed(value):
        raise Problem("is empty", "a list of one or more, in square brackets")
    return value


Length = quantity("length")
SignedLength = quantity("length", "any")
Time = quantity("time")

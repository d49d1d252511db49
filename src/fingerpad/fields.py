"""Types of the fields of a document: quantities, numbers and lists, checked as they are read."""

from __future__ import annotations

import json
import math
import operator
from collections.abc import Callable, Mapping
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, TypeAdapter, ValidationError, ValidationInfo
from pydantic_core import core_schema

from fingerpad.documents import Problem
from fingerpad.units import (
    DIMENSIONS,
    QUANTITY_PATTERN,
    QuantityError,
    parse_number,
    parse_quantity,
)


class SI(float):
    """A number already in SI that takes the place of text in a document being filled in."""


class _Whole(int):
    """A whole number as a document says it, see :func:`as_written`."""


class _Number(float):
    """A number as a document says it, see :func:`as_written`."""


def as_written(value: Any) -> Any:
    """`value` of a document, with the numbers in it told from SI numbers: where a unit is needed,
    they have none.
    """
    if isinstance(value, (bool, SI)):
        return value
    if isinstance(value, Mapping):
        return {key: as_written(each) for key, each in value.items()}
    if isinstance(value, (list, tuple)):
        return type(value)(map(as_written, value))
    return (
        _Whole(value) if type(value) is int else _Number(value) if type(value) is float else value
    )


_SIGNS = {
    "positive": (operator.gt, "above zero"),
    "non-negative": (operator.ge, "of zero or more"),
    "nonzero": (operator.ne, "other than zero"),
    "any": (lambda value, zero: True, ""),
}
"""Sign of a quantity -> the comparison with zero that must hold, and its words."""


def quantity(
    dimension: str,
    sign: Literal["positive", "non-negative", "nonzero", "any"] = "positive",
    note: str = "",
    words: tuple[str, ...] = (),
) -> Any:
    """Field type: text with a unit in a document, an SI float in Python; `note` explains a wrong
    `sign`, `words` may stay.
    """

    def parse(value: Any, info: ValidationInfo) -> float | str:
        if isinstance(value, str) and value in words:
            return value
        in_python = isinstance(value, SI) or (
            info.context is None and not isinstance(value, (_Whole, _Number))
        )
        kind = DIMENSIONS[dimension]
        number = in_python and not isinstance(value, str)
        try:
            result = parse_number(value) if number else parse_quantity(value, dimension)
        except QuantityError as error:
            if words:
                raise Problem(error.problem, " or ".join((*words, error.allowed))) from None
            raise
        holds, right = _SIGNS[sign]
        if not holds(result, 0):
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
    surface = (
        Annotated[float, Field(**bounds)]
        | Annotated[str, Field(pattern=r"^\s*[+-]?[0-9.]+([eE][+-]?[0-9]+)?\s*%?\s*$")]
    )
    return Annotated[float, BeforeValidator(parse, json_schema_input_type=surface)]


def whole(low: int, high: int) -> Any:
    """Field type: a whole number between two bounds, both included."""

    def parse(value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
            raise Problem("is not in the range", f"a whole number from {low} to {high}")
        return value

    return Annotated[
        int, BeforeValidator(parse, json_schema_input_type=Annotated[int, Field(ge=low, le=high)])
    ]


def read(kind: Any, value: Any, key: str, context: Any) -> Any:
    """`value` of the field `key` read as the field type `kind`, before the model is there;
    `Problem` if it is wrong.
    """
    try:
        return _adapter(kind).validate_python(value, context=context)
    except ValidationError as error:
        cause = error.errors()[0].get("ctx", {}).get("error")
        raise Problem(
            getattr(cause, "problem", "is not valid"), getattr(cause, "allowed", ""), (key,)
        ) from None


@cache
def _adapter(kind: Any) -> TypeAdapter:
    return TypeAdapter(kind)


class OneOf:
    """Annotation of a field that holds a value of one of several types.

    Parameters
    ----------
    choose : callable
        Value -> the type that it is of, or that it describes; raises `Problem` if it is of none.
    kinds : mapping
        Name -> type, for the schema; types that join later are read too.
    """

    def __init__(self, choose: Callable[[Any], Any], kinds: Mapping[str, Any]) -> None:
        self.choose, self.kinds = choose, kinds

    def _read(self, value: Any, info: ValidationInfo) -> Any:
        return _adapter(self.choose(value)).validate_python(value, context=info.context)

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.with_info_plain_validator_function(self._read)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: Any
    ) -> dict[str, Any]:
        kinds = [_adapter(kind).core_schema for kind in self.kinds.values()]
        return handler(core_schema.union_schema(kinds))


def published_schema(schema: dict[str, Any], title: str) -> dict[str, Any]:
    """A JSON schema as it is written to a file: without generated titles, nulls and SI defaults,
    which documents lack; a stimulus's shape is required.
    """
    dialect = "https://json-schema.org/draft/2020-12/schema"
    return {"$schema": dialect, "title": title, **_tidy(schema)}


def _tidy(schema: Any) -> Any:
    if isinstance(schema, list):
        return [_tidy(item) for item in schema if item != {"type": "null"}]
    if not isinstance(schema, dict):
        return schema
    tidy = {
        key: _tidy(value)
        for key, value in schema.items()
        if key != "title" and (key != "default" or isinstance(value, str))
    }
    if isinstance(text := tidy.get("description"), str):
        tidy["description"] = text.split("\n\nExamples\n")[0]
    if "const" in tidy.get("properties", {}).get("shape", {}):
        tidy["required"] = ["shape", *tidy.get("required", [])]
    return tidy


def listed(value: Any) -> Any:
    """`value` if it is a list; `Problem` otherwise."""
    if not isinstance(value, (list, tuple)):
        raise Problem(
            "is not a list", f"a list, in square brackets: [{json.dumps(value, default=str)}]"
        )
    return value


def filled(value: Any) -> Any:
    """`value` if it is a list with something in it; `Problem` otherwise."""
    if not listed(value):
        raise Problem("is empty", "a list of one or more, in square brackets")
    return value


Length = quantity("length")
SignedLength = quantity("length", "any")
Time = quantity("time")

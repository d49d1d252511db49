"""Units at the border: strings such as ``"20 gf"`` become SI floats, and back for messages.

Inside the package every number is SI (m, N, Pa, s). The units are those of one `pint` registry; the
field's gram-weight is the gram-force of 9.80665e-3 N (standard gravity, 3rd CGPM 1901, resolution
2), written ``gf``, ``gw``, ``g wt`` or ``gram-weight``. Only products of unit names with one-digit
powers reach pint's parser (``gf/s``, ``N/mm^2``, ``1/m``), so no user's text is ever evaluated.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import Any

import pint

from fingerpad.files import WrongInput


@dataclass(frozen=True)
class Dimension:
    """A dimension that quantities have.

    Attributes
    ----------
    name : str
        Key in `DIMENSIONS`.
    si : str
        Coherent SI unit.
    shown : str
        Unit used by `format_quantity`.
    noun : str
        Its name in a message ("a force rate").
    example : str
        A valid value.
    """

    name: str
    si: str
    shown: str
    noun: str
    example: str


DIMENSIONS: dict[str, Dimension] = {
    dimension.name: dimension
    for dimension in (
        Dimension("length", "m", "mm", "a length", "0.85 mm"),
        Dimension("curvature", "1/m", "1/m", "a curvature", "210 1/m"),
        Dimension("force", "N", "gf", "a force", "20 gf"),
        Dimension("force_rate", "N/s", "gf/s", "a force rate", "40 gf/s"),
        Dimension("pressure", "Pa", "MPa", "a modulus", "0.15 MPa"),
        Dimension("speed", "m/s", "mm/s", "a speed", "2 mm/s"),
        Dimension("time", "s", "s", "a time", "0.5 s"),
        Dimension("angle", "rad", "deg", "an angle", "9 deg"),
        Dimension("dimensionless", "1", "1", "a number", "0.02"),
    )
}

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(
    rf"(?P<number>{_NUMBER})(?:\s*/\s*(?P<divisor>[0-9]+)(?=\s))?\s*(?P<unit>.*)", re.DOTALL
)
_NAME = r"(?:1|%|[A-Za-zµμ]+(?:_[A-Za-zµμ]+)*)"
_FACTOR = rf"{_NAME}(?:(?:\^|\*\*)-?[1-9](?![0-9]))?"
_PRODUCT = re.compile(rf"{_FACTOR}(?:(?:\s*[/*·]\s*|\s+){_FACTOR})*")
_GRAM_WEIGHT = re.compile(r"\b(?:g|gram)[\s-]*(?:wt|weight)\b")
_LONGEST = 40
"""Letters of a unit."""

QUANTITY_PATTERN = rf"^\s*{_NUMBER}(\s*/\s*[0-9]+)?\s*[^0-9\s.+-].*$|^\s*{_NUMBER}\s+1\s*/.*$"
"""JSON schema pattern of a number followed by a unit; `parse_quantity` checks the dimension."""

REGISTRY = pint.UnitRegistry()
REGISTRY.define("gram_weight = gram_force = gw")


class QuantityError(WrongInput):
    """A quantity that cannot be read; ``problem`` follows the value ("has no unit")."""


def allowed(dimension: str) -> str:
    """Words for messages: what a value of `dimension` looks like."""
    kind = DIMENSIONS[dimension]
    if dimension == "dimensionless":
        return f"{kind.noun} such as {kind.example}"
    return f"{kind.noun} with its unit such as '{kind.example}'"


@cache
def _unit(text: str) -> pint.Unit:
    """Unit of a product of names such as ``gf/s``; `ValueError` when a part is not known."""
    product = _GRAM_WEIGHT.sub("gf", text.strip()).replace("²", "^2").replace("·", "*")
    if product.startswith("/"):
        product = f"1{product}"
    if not _PRODUCT.fullmatch(product):
        raise ValueError(text)
    try:
        return REGISTRY.parse_units(re.sub(_NAME, _known_name, product))
    except (pint.PintError, AssertionError, TypeError, ValueError, AttributeError) as error:
        raise ValueError(text) from error


def _known_name(match: re.Match[str]) -> str:
    """A unit's name as pint has it; words such as Newton may begin with a capital."""
    name = match[0]
    if name == "%":
        return "percent"
    word = len(name) > 3 and name not in REGISTRY and name.lower() in REGISTRY
    return name.lower() if word else name


@cache
def _factor_to_si(text: str, dimension: str) -> float:
    """Multiplier from a unit to SI; `QuantityError` when unknown or of another dimension."""
    try:
        unit, target = _unit(text), _unit(DIMENSIONS[dimension].si)
    except ValueError:
        raise QuantityError(f"has the unknown unit '{text}'", allowed(dimension)) from None
    if _root(unit) != _root(target):
        known = dimension_of(text)
        what = DIMENSIONS[known].noun if known else f"of dimension {unit.dimensionality}"
        raise QuantityError(f"has the wrong dimension: it is {what}", allowed(dimension))
    try:
        return float(REGISTRY.Quantity(1.0, unit).to(target).magnitude)
    except (pint.PintError, ArithmeticError, ValueError):
        raise QuantityError(f"has the unusable unit '{text}'", allowed(dimension)) from None


def _root(unit: pint.Unit) -> pint.Unit:
    """Product of base units that tells dimensions apart, angles from plain numbers too."""
    return REGISTRY.get_root_units(unit)[1]


def dimension_of(unit: str) -> str | None:
    """The dimension of a unit, a key of `DIMENSIONS`; None if it is unknown or of no use here."""
    try:
        root = _root(_unit(unit))
    except ValueError:
        return None
    return next((name for name, kind in DIMENSIONS.items() if _root(_unit(kind.si)) == root), None)


def parse_number(value: Any) -> float:
    """A dimensionless number given as a number or as text ("0.02", "2 %").

    Raises
    ------
    QuantityError
        It is not a number, has a unit of some dimension, or is not finite.
    """
    if isinstance(value, str):
        return parse_quantity(value, "dimensionless")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise QuantityError("is not a number", allowed("dimensionless"))
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise QuantityError("is not finite", allowed("dimensionless"))
    return number


def parse_quantity(text: Any, dimension: str) -> float:
    """SI value of a number with a unit.

    Parameters
    ----------
    text : str
        Such as ``"40 gf/s"``, ``"0.85 mm"``, ``"1260 1/m"``, ``"1/16 inch"``. A dimensionless one
        may be bare (``"0.02"``) or in per cent.
    dimension : str
        A key of `DIMENSIONS`.

    Returns
    -------
    float
        The value in the coherent SI unit of the dimension (m, 1/m, N, N/s, Pa, m/s, s, rad, 1);
        always finite.

    Raises
    ------
    QuantityError
        It is not text, has no unit, an unknown unit or another dimension, or is not finite.

    Examples
    --------
    >>> parse_quantity("0.85 mm", "length")
    0.00085
    """
    if isinstance(text, (int, float)) and not isinstance(text, bool):
        raise QuantityError("has no unit", allowed(dimension))
    if not isinstance(text, str):
        raise QuantityError(f"is not {DIMENSIONS[dimension].noun}", allowed(dimension))
    match = _match(text, allowed(dimension))
    unit = match["unit"].strip()
    if re.match(r",\d", unit):
        raise QuantityError("has a decimal comma", f"{allowed(dimension)}, with a decimal point")
    if not unit and dimension != "dimensionless":
        raise QuantityError("has no unit", allowed(dimension))
    if len(unit) > _LONGEST:
        raise QuantityError("has an unknown unit", allowed(dimension))
    factor = _factor_to_si(unit, dimension) if unit else 1.0
    if dimension == "dimensionless" and unit not in ("", "1", "%", "percent"):
        raise QuantityError(f"has the unit '{unit}'", allowed(dimension))
    try:
        number = _number(match)
        # dividing by a whole number keeps "0.85 mm" the float nearest to 0.00085
        inverse = round(1.0 / factor)
        exact = inverse > 1 and math.isclose(inverse * factor, 1.0, rel_tol=1e-15)
        value = number / inverse if exact else number * factor
    except (ZeroDivisionError, OverflowError):
        value = math.nan
    if not math.isfinite(value):
        raise QuantityError("is not finite", allowed(dimension))
    return value


def _match(text: str, allowed: str = "a number with its unit") -> re.Match[str]:
    match = _QUANTITY.fullmatch(text.strip())
    if not match:
        raise QuantityError("does not start with a finite number", allowed)
    return match


def _number(match: re.Match[str]) -> float:
    return float(match["number"]) / float(match["divisor"] or 1.0)


def unit_of(text: str) -> str:
    """The unit of a quantity as it is written: ``"gf"`` of ``"20 gf"``.

    Raises
    ------
    QuantityError
        The text does not start with a number.
    """
    return _match(text)["unit"].strip()


def number_of(text: str) -> float:
    """The number of a quantity as it is written: 20.0 of ``"20 gf"``. Raises as `unit_of`."""
    return _number(_match(text))


def format_quantity(value: float, dimension: str) -> str:
    """Text of an SI value in the unit the field uses, such as ``"20 gf"``.

    `parse_quantity` reads it back.
    """
    kind = DIMENSIONS[dimension]
    if dimension == "dimensionless":
        return f"{value:.6g}"
    return f"{value / _factor_to_si(kind.shown, dimension):.6g} {kind.shown}"

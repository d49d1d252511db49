"""Units at the border: strings such as ``"20 gf"`` become SI floats, and back for messages.

Inside the package every number is SI (m, N, Pa, s). One `pint` registry serves the whole package;
the field's gram-weight is the gram-force of 9.80665e-3 N (standard gravity, 3rd CGPM 1901,
resolution 2), written ``gf``, ``gw``, ``g wt`` or ``gram-weight``. Only products of unit names with
one-digit powers are understood (``gf/s``, ``N/mm^2``, ``1/m``), so no text of a user's is ever
evaluated.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint


@dataclass(frozen=True)
class Dimension:
    """What a quantity may be: its SI unit, the units it is shown in, and an example for messages.

    Attributes:
        name: key in `DIMENSIONS`.
        si: coherent SI unit.
        shown: unit used by `format_quantity`.
        noun: how a message calls it ("a force rate").
        example: a valid value.
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

USUAL: dict[tuple[str, str], float] = {
    (unit, dimension): factor
    for dimension, units in {
        "length": {"m": 1.0, "mm": 1e-3, "um": 1e-6},
        "curvature": {"1/m": 1.0},
        "force": {"N": 1.0, "gf": 9.80665e-3},
        "force_rate": {"N/s": 1.0, "gf/s": 9.80665e-3},
        "pressure": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6},
        "speed": {"m/s": 1.0, "mm/s": 1e-3},
        "time": {"s": 1.0},
        "dimensionless": {"1": 1.0},
    }.items()
    for unit, factor in units.items()
}
"""Factors to SI of the units that scenes are mostly written in, as pint has them; importing it
takes a third of a second.
"""

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(
    rf"(?P<number>{_NUMBER})(?:\s*/\s*(?P<divisor>[0-9]+)(?=\s))?\s*(?P<unit>.*)", re.DOTALL
)
_FACTOR = re.compile(
    r"(?P<name>1|%|[A-Za-zµμ]+(?:_[A-Za-zµμ]+)*)(?:(?:\^|\*\*)(?P<power>-?[1-9])(?![0-9]))?"
)
_SEPARATOR = re.compile(r"\s*(?P<sign>[/*·])\s*|\s+")
_GRAM_WEIGHT = re.compile(r"\b(?:g|gram)[\s-]*(?:wt|weight)\b")

QUANTITY_PATTERN = rf"^\s*{_NUMBER}(\s*/\s*[0-9]+)?\s*[^0-9\s.+-].*$|^\s*{_NUMBER}\s+1\s*/.*$"
"""JSON schema pattern of a number followed by a unit; `parse_quantity` checks the dimension."""


class QuantityError(ValueError):
    """A quantity that cannot be read.

    Attributes:
        problem: what is wrong, to follow the offending value ("has no unit").
        allowed: what would be right.
    """

    def __init__(self, problem: str, allowed: str) -> None:
        super().__init__(f"{problem}; allowed: {allowed}")
        self.problem = problem
        self.allowed = allowed


@cache
def registry() -> pint.UnitRegistry:
    """The package's one pint registry, made at first use (importing pint takes a fifth of a
    second).
    """
    import pint

    from fingerpad.files import cache_folder

    # pint keeps its parsed definitions in the user's cache folder, where there is one: a tenth of a
    # second a process
    folder = cache_folder("pint")
    try:
        ureg = pint.UnitRegistry(cache_folder=folder)
    except Exception:  # noqa: BLE001 - whatever becomes of a file that another process has not written to its end
        for file in folder.iterdir() if folder else ():
            file.unlink(missing_ok=True)
        ureg = pint.UnitRegistry()
    ureg.define("gram_weight = gram_force = gw")
    return ureg


def allowed(dimension: str) -> str:
    """Words for messages: what a value of `dimension` looks like."""
    kind = DIMENSIONS[dimension]
    if dimension == "dimensionless":
        return f"{kind.noun} such as {kind.example}"
    return f"{kind.noun} with its unit such as '{kind.example}'"


@cache
def _unit(text: str) -> pint.Unit:
    """Unit of a product of names such as ``gf/s``; `ValueError` when a part is not known."""
    ureg = registry()
    import pint

    text = _GRAM_WEIGHT.sub("gf", text.strip()).replace("²", "^2")
    unit = ureg.Unit("")
    if text.startswith("/"):
        text = "1" + text
    position, sign = 0, 1
    while True:
        factor = _FACTOR.match(text, position)
        if not factor:
            raise ValueError(text)
        name = factor["name"]
        if name != "1":
            try:
                unit *= _named(ureg, name) ** (sign * int(factor["power"] or 1))
            except (pint.PintError, AssertionError, TypeError, ValueError, AttributeError) as error:
                raise ValueError(name) from error
        position = factor.end()
        if position == len(text):
            return unit
        separator = _SEPARATOR.match(text, position)
        if not separator:
            raise ValueError(text)
        sign = -1 if separator["sign"] == "/" else 1
        position = separator.end()


def _named(ureg: pint.UnitRegistry, name: str) -> pint.Unit:
    """The unit of a name; words such as Newton may begin with a capital."""
    if name == "%":
        return ureg.parse_units("percent")
    word = len(name) > 3 and name.lower() in ureg
    return ureg.parse_units(name.lower() if word and name not in ureg else name)


def _factor_to_si(unit_text: str, dimension: str) -> float:
    """Multiplier from a unit to SI; `QuantityError` when unknown or of another dimension."""
    usual = USUAL.get((unit_text, dimension))
    return _looked_up(unit_text, dimension) if usual is None else usual


@cache
def _looked_up(unit_text: str, dimension: str) -> float:
    """`_factor_to_si` as pint has it."""
    import pint

    kind = DIMENSIONS[dimension]
    try:
        unit = _unit(unit_text)
    except ValueError:
        raise QuantityError(f"has the unknown unit '{unit_text}'", allowed(dimension)) from None
    target = _unit(kind.si)
    if _root(unit) != _root(target):
        raise QuantityError(f"has the wrong dimension: it is {_describe(unit)}", allowed(dimension))
    ureg = registry()
    try:
        return float(ureg.Quantity(1.0, unit).to(target).magnitude)
    except (pint.PintError, ArithmeticError, ValueError):
        raise QuantityError(f"has the unusable unit '{unit_text}'", allowed(dimension)) from None


def _root(unit: pint.Unit) -> pint.Unit:
    """Product of base units that tells dimensions apart, angles from plain numbers too."""
    return registry().get_root_units(unit)[1]


def _describe(unit: pint.Unit) -> str:
    for kind in DIMENSIONS.values():
        if _root(unit) == _root(_unit(kind.si)):
            return kind.noun
    return f"of dimension {unit.dimensionality}"


def parse_number(value: Any) -> float:
    """A dimensionless number given as a number or as text ("0.02", "2 %").

    Raises:
        QuantityError: not a number, a unit of some dimension, infinite or not a number.
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

    Args:
        text: such as ``"40 gf/s"``, ``"0.85 mm"``, ``"1260 1/m"``, ``"1/16 inch"``. A dimensionless
        one may
            be bare (``"0.02"``) or in per cent.
        dimension: a key of `DIMENSIONS`.

    Returns:
        The value in the coherent SI unit of the dimension (m, 1/m, N, N/s, Pa, m/s, s, 1); always
        finite.

    Raises:
        QuantityError: not text, no unit, unknown unit, another dimension, or not finite.
    """
    if isinstance(text, (int, float)) and not isinstance(text, bool):
        raise QuantityError("has no unit", allowed(dimension))
    if not isinstance(text, str):
        raise QuantityError(f"is not {DIMENSIONS[dimension].noun}", allowed(dimension))
    match = _QUANTITY.fullmatch(text.strip())
    if not match:
        raise QuantityError("does not start with a finite number", allowed(dimension))
    unit = match["unit"].strip()
    if re.match(r",\d", unit):
        raise QuantityError("has a decimal comma", f"{allowed(dimension)}, with a decimal point")
    if not unit and dimension != "dimensionless":
        raise QuantityError("has no unit", allowed(dimension))
    if len(unit) > 40:
        raise QuantityError("has an unknown unit", allowed(dimension))
    factor = _factor_to_si(unit, dimension) if unit else 1.0
    if dimension == "dimensionless" and unit not in ("", "1", "%", "percent"):
        raise QuantityError(f"has the unit '{unit}'", allowed(dimension))
    try:
        number = float(match["number"]) / float(match["divisor"] or 1.0)
        # dividing by a whole number keeps "0.85 mm" the float nearest to 0.00085
        inverse = round(1.0 / factor)
        value = (
            number / inverse
            if inverse > 1 and math.isclose(inverse * factor, 1.0, rel_tol=1e-15)
            else number * factor
        )
    except (ZeroDivisionError, OverflowError):
        value = math.nan
    if not math.isfinite(value):
        raise QuantityError("is not finite", allowed(dimension))
    return value


def unit_of(text: str) -> str:
    """The unit of a quantity as it is written: ``"gf"`` of ``"20 gf"``.

    Raises:
        QuantityError: the text does not start with a number.
    """
    match = _QUANTITY.fullmatch(text.strip())
    if not match:
        raise QuantityError("does not start with a finite number", "a number with its unit")
    return match["unit"].strip()


def number_of(text: str) -> float:
    """The number of a quantity as it is written: 20.0 of ``"20 gf"``. Raises as :func:`unit_of`."""
    match = _QUANTITY.fullmatch(text.strip())
    if not match:
        raise QuantityError("does not start with a finite number", "a number with its unit")
    return float(match["number"]) / float(match["divisor"] or 1.0)


def format_quantity(value: float, dimension: str) -> str:
    """Text of an SI value in the unit the field uses, such as ``"20 gf"``; `parse_quantity` reads
    it back.
    """
    kind = DIMENSIONS[dimension]
    if dimension == "dimensionless":
        return f"{value:.6g}"
    return f"{value / _factor_to_si(kind.shown, dimension):.6g} {kind.shown}"

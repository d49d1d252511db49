"""Quantities: the unit border of the package."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.units import (
    DIMENSIONS,
    QUANTITY_PATTERN,
    QuantityError,
    format_quantity,
    parse_number,
    parse_quantity,
)

pytestmark = pytest.mark.unit

UNITS = {
    "length": {
        "m": 1.0,
        "mm": 1e-3,
        "um": 1e-6,
        "µm": 1e-6,
        "μm": 1e-6,
        "inch": 0.0254,
        "in": 0.0254,
    },
    "curvature": {
        "1/m": 1.0,
        "/m": 1.0,
        "m^-1": 1.0,
        "m**-1": 1.0,
        "1/mm": 1e3,
        "1/inch": 1 / 0.0254,
    },
    "force": {"N": 1.0, "mN": 1e-3, "gf": 9.80665e-3, "gw": 9.80665e-3, "g wt": 9.80665e-3},
    "force_rate": {
        "N/s": 1.0,
        "gf/s": 9.80665e-3,
        "gw / s": 9.80665e-3,
        "gram-weight/s": 9.80665e-3,
    },
    "pressure": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "N/mm^2": 1e6, "N/mm²": 1e6, "kN m^-2": 1e3},
    "speed": {"m/s": 1.0, "mm/s": 1e-3, "um/ms": 1e-3},
    "time": {"s": 1.0, "ms": 1e-3, "minute": 60.0},
    "angle": {"rad": 1.0, "mrad": 1e-3, "deg": math.pi / 180, "degree": math.pi / 180},
    "dimensionless": {"": 1.0, "%": 1e-2, "percent": 1e-2},
}
EVERY_UNIT = [
    (kind, unit, factor) for kind, units in UNITS.items() for unit, factor in units.items()
]


numbers = st.floats(min_value=1e-6, max_value=1e6).map(lambda x: float(f"{x:.9g}"))


@pytest.mark.parametrize(("dimension", "unit", "factor"), EVERY_UNIT)
def test_every_unit_has_its_factor(dimension, unit, factor):
    assert parse_quantity(f"2.5 {unit}", dimension) == pytest.approx(2.5 * factor, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("0.85 mm", "length", 0.00085),
        ("915 um", "length", 0.000915),
        ("0.15 MPa", "pressure", 150000.0),
        ("20 gf", "force", 0.196133),
        ("-1.5mm", "length", -0.0015),
        ("1/16 inch", "length", 0.0015875),
        ("16/3 1/inch", "curvature", 16 / 3 / 0.0254),
        ("  2e-3   m ", "length", 0.002),
    ],
)
def test_text_gives_the_nearest_float(text, dimension, value):
    assert parse_quantity(text, dimension) == pytest.approx(value, rel=1e-15)


@given(value=numbers, case=st.sampled_from([(k, u, v) for k, u in UNITS.items() for v in u]))
def test_a_quantity_is_the_same_in_every_unit_of_its_dimension(value, case):
    dimension, units, unit = case
    expected = value * units[unit]
    for other, factor in units.items():
        assert parse_quantity(f"{expected / factor!r} {other}", dimension) == pytest.approx(
            expected, rel=1e-13
        )


@given(value=numbers, dimension=st.sampled_from(sorted(DIMENSIONS)))
def test_a_formatted_quantity_reads_back(value, dimension):
    text = format_quantity(value, dimension)
    assert parse_quantity(text, dimension) == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize(
    ("value", "dimension", "problem"),
    [
        (3, "length", "has no unit"),
        (0.5, "force_rate", "has no unit"),
        ("3", "length", "has no unit"),
        ("1e3 ", "pressure", "has no unit"),
        ("20 gf", "force_rate", "wrong dimension: it is a force"),
        ("20 g", "force", "wrong dimension"),
        ("1260 m", "curvature", "wrong dimension: it is a length"),
        ("20 degC", "length", "wrong dimension"),
        ("20 furlongz", "length", "unknown unit 'furlongz'"),
        ("1 Mpa", "pressure", "unknown unit 'Mpa'"),
        ("1 m^99", "length", "unknown unit"),
        ("20 gf/", "force", "unknown unit"),
        ("1 1/16 inch", "length", "unknown unit"),
        ("nan mm", "length", "finite number"),
        ("inf mm", "length", "finite number"),
        ("1e999 mm", "length", "not finite"),
        ("1/0 mm", "length", "not finite"),
        ("", "length", "finite number"),
        ("mm", "length", "finite number"),
        (None, "length", "is not a length"),
        (True, "length", "is not a length"),
        (["1 mm"], "length", "is not a length"),
        ("3 dB", "dimensionless", "has the unit 'dB'"),
        ("2 mm", "dimensionless", "has the wrong dimension"),
        # text that an evaluating parser would run, or never finish
        ("9**9**9**9 mm", "length", "unknown unit"),
        ("1 __import__('os')", "length", "unknown unit"),
        ("1 " + "m*" * 10_000 + "m", "length", "unknown unit"),
    ],
)
def test_wrong_quantities_say_what_is_wrong_and_what_is_allowed(value, dimension, problem):
    with pytest.raises(QuantityError, match="allowed: ") as caught:
        parse_quantity(value, dimension)
    assert problem in caught.value.problem
    assert DIMENSIONS[dimension].example in caught.value.allowed


@pytest.mark.parametrize(
    "value", [math.nan, math.inf, -math.inf, 10**400, None, True, "x", [], "nan"]
)
def test_wrong_numbers(value):
    with pytest.raises(QuantityError):
        parse_number(value)


@given(
    text=st.text(max_size=40) | st.from_regex(QUANTITY_PATTERN),
    dimension=st.sampled_from(sorted(DIMENSIONS)),
)
def test_any_text_is_a_finite_number_or_a_quantity_error(text, dimension):
    try:
        assert math.isfinite(parse_quantity(text, dimension))
    except QuantityError as error:
        assert error.problem and error.allowed

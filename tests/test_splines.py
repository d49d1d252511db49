"""Piecewise cubics against scipy's, and what makes them what they are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.interpolate import Akima1DInterpolator, CubicHermiteSpline, CubicSpline

from fingerpad.splines import akima_slopes, hermite, spline_slopes

pytestmark = pytest.mark.unit


@st.composite
def curves(draw, least=4):
    """Places, values with flat pieces, and places between."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count, more = draw(st.integers(least, 60)), draw(st.sampled_from([(), (3,), (2, 2)]))
    place = np.cumsum(rng.uniform(0.1, 1.0, count)) * draw(st.sampled_from([1e-3, 1.0, 1e3]))
    values = rng.normal(size=(count, *more))
    flat = draw(st.integers(0, count - 2))
    values[flat : flat + 3] = values[flat]
    return place, values, np.append(rng.uniform(place[0], place[-1], 100), place)


@settings(max_examples=60, deadline=None)
@given(curves())
def test_splines_are_scipys(curve):
    place, values, _ = curve
    slopes = spline_slopes(place, values)
    assert slopes == pytest.approx(
        CubicSpline(place, values)(place, 1), rel=1e-9, abs=1e-10 * np.abs(slopes).max()
    )


@settings(max_examples=60, deadline=None)
@given(curves(least=2))
def test_akimas_slopes_are_scipys(curve):
    place, values, _ = curve
    slopes, known = (
        akima_slopes(place, values),
        Akima1DInterpolator(place, values, method="makima")(place, 1),
    )
    assert slopes == pytest.approx(known, rel=1e-9, abs=1e-10 * max(np.abs(known).max(), 1e-300))


@settings(max_examples=60, deadline=None)
@given(curves(least=2))
def test_cubics_between_are_scipys(curve):
    place, values, at = curve
    slopes = np.cos(values)
    assert hermite(place, values, slopes, at) == pytest.approx(
        CubicHermiteSpline(place, values, slopes)(at), rel=1e-9, abs=1e-9
    )


def test_a_cubic_is_its_own_spline_and_nothing_is_asked_of_no_places():
    place = np.array([0.0, 0.3, 0.7, 0.9, 1.6])
    cubic = np.polynomial.Polynomial([1.0, -2.0, 0.5, 3.0])
    slopes = spline_slopes(place, cubic(place))
    assert slopes == pytest.approx(cubic.deriv()(place), abs=1e-13)
    at = np.linspace(0.0, 1.6, 100)  # more than are looked at together
    assert hermite(place, cubic(place), slopes, at) == pytest.approx(cubic(at), abs=1e-13)
    assert hermite(place, np.zeros((5, 2)), np.zeros((5, 2)), np.empty(0)).shape == (0, 2)


def test_akimas_curve_does_not_overshoot_a_step():
    place = np.arange(8.0)
    values = np.where(place < 4, 0.0, 1.0)
    curve = hermite(place, values, akima_slopes(place, values), np.linspace(0, 7, 200))
    assert curve.min() >= 0 and curve.max() <= 1
    assert not np.all(
        (bent := hermite(place, values, spline_slopes(place, values), np.linspace(0, 7, 200))) >= 0
    ), bent.min()

"""The one root finder that does not need scipy, held to scipy's."""

import math

import pytest
from scipy.optimize import brentq

from fingerpad.roots import root

pytestmark = pytest.mark.unit

CASES = {
    "rising": (lambda x: x**3 - 2, 0.0, 2.0),
    "falling": (lambda x: math.exp(-x) - 0.1, 0.0, 50.0),
    "steep": (lambda x: math.tan(x) - 1e4, 0.0, 1.57079),
    "at an end": (lambda x: x - 3.0, 3.0, 4.0),
}


@pytest.mark.parametrize("case", CASES)
def test_a_root_is_scipys(case):
    function, low, high = CASES[case]
    assert root(function, low, high) == pytest.approx(
        brentq(function, low, high, xtol=1e-14), rel=1e-12
    )
    assert root(function, low, high, 1e-3) == pytest.approx(brentq(function, low, high), abs=1e-3)


def test_without_a_change_of_sign_there_is_no_root():
    with pytest.raises(ValueError, match="no change of sign"):
        root(lambda x: x**2 + 1, -1, 1)

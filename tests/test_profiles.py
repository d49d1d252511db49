"""Rigid profiles: distance, gradient and curvature agree with each other and with geometry."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad.stimuli.profiles import Bar, Cylinder, Flat, Line, Sampled

pytestmark = pytest.mark.unit

WAVE = np.linspace(-0.02, 0.02, 41)
PROFILES = {
    "flat": Flat(),
    "cylinder": Cylinder(209.97),
    "bar": Bar(1.5875e-3, 0.1e-3),
    "sharp bar": Bar(1.5875e-3),
    "line": Line(),
    "sampled": Sampled(WAVE, -1e-3 * np.cos(300 * WAVE)),
}
point = st.tuples(st.floats(-5e-3, 5e-3), st.floats(-4e-3, 2e-3))


@pytest.mark.parametrize("name", PROFILES)
@settings(max_examples=80, deadline=None)
@given(where=point)
def test_gradient_is_the_derivative_of_the_distance(name, where):
    """Away from ridges of the distance, its finite differences are the gradient, which has length one."""
    profile, x = PROFILES[name], np.array([where])
    step = 1e-8
    distance, gradient, _ = profile.evaluate(x)
    assert np.hypot(*gradient[0]) == pytest.approx(1.0, abs=1e-9)
    around = [profile.evaluate(x + step * np.array(d))[0][0] for d in ([1, 0], [-1, 0], [0, 1], [0, -1])]
    slopes = np.array([around[0] - distance[0], distance[0] - around[1], around[2] - distance[0], distance[0] - around[3]]) / step
    if abs(slopes[0] - slopes[1]) < 1e-3 and abs(slopes[2] - slopes[3]) < 1e-3:  # not on a ridge
        np.testing.assert_allclose(gradient[0], [slopes[:2].mean(), slopes[2:].mean()], atol=2e-3)


@pytest.mark.parametrize("name", ["flat", "cylinder", "bar", "line"])
@settings(max_examples=60, deadline=None)
@given(where=point)
def test_curvature_turns_the_gradient(name, where):
    """Moving a little along the level set turns the gradient by curvature times the way."""
    profile, x = PROFILES[name], np.array([where])
    distance, gradient, curvature = profile.evaluate(x)
    tangent = np.array([-gradient[0, 1], gradient[0, 0]])
    step = 1e-8
    ahead, behind = (profile.evaluate(x + s * step * tangent)[1][0] for s in (1, -1))
    one, two = (ahead - gradient[0]) @ tangent / step, (gradient[0] - behind) @ tangent / step
    if distance[0] > 1e-6 and abs(one - two) < 1.0:
        assert one == pytest.approx(curvature[0], rel=1e-3, abs=1.0)


@pytest.mark.parametrize("name", PROFILES)
def test_lowest_point_is_the_origin(name):
    """A profile touches from above at height zero: nothing below is inside, something just above is."""
    profile = PROFILES[name]
    x = np.linspace(-6e-3, 6e-3, 601)
    below, _, _ = profile.evaluate(np.column_stack([x, np.full_like(x, -1e-9)]))
    assert below.min() > 0
    above, _, _ = profile.evaluate(np.column_stack([x, np.full_like(x, 2e-6)]))
    assert above.min() < 0


@pytest.mark.parametrize("name", ["cylinder", "bar", "sampled"])
def test_outline_lies_on_the_surface(name):
    """The drawn outline has distance zero."""
    profile = PROFILES[name]
    x = np.linspace(-0.7e-3, 0.7e-3, 57)
    distance, _, _ = profile.evaluate(np.column_stack([x, profile.outline(x)]))
    np.testing.assert_allclose(distance, 0, atol=1e-9)


def test_sharp_corner_is_kept():
    """Beyond the corner of a sharp bar the nearest point is the corner itself."""
    bar = Bar(2e-3)
    distance, gradient, _ = bar.evaluate(np.array([[1e-3 + 3e-4, -4e-4]]))
    assert distance[0] == pytest.approx(5e-4) and gradient[0] == pytest.approx([0.6, -0.8])


def test_sampled_cylinder_approaches_the_cylinder():
    """A finely sampled arc has the arc's distance up to the sagitta of its chords."""
    x = np.linspace(-3e-3, 3e-3, 1201)
    exact = Cylinder(209.97)
    sampled = Sampled(x, exact.outline(x))
    at = np.random.default_rng(0).uniform([-2e-3, -2e-3], [2e-3, 1e-3], (200, 2))
    sagitta = (x[1] - x[0]) ** 2 / 8 * 209.97 * 2
    np.testing.assert_allclose(sampled.evaluate(at)[0], exact.evaluate(at)[0], atol=2 * sagitta)


def test_symmetry_of_samples_is_seen():
    """A symmetric sampled profile may be halved, a lopsided one may not."""
    assert Sampled([-1e-3, 0, 1e-3], [1e-4, 0, 1e-4]).symmetric
    assert not Sampled([-1e-3, 0, 1e-3], [1e-4, 0, 2e-4]).symmetric


@pytest.mark.parametrize("x", [[0.0], [0.0, 0.0], [1.0, 0.0]])
def test_profile_must_be_single_valued(x):
    with pytest.raises(ValueError, match="strictly increasing"):
        Sampled(x, np.zeros(len(x)))

"""Rigid profiles: distance, gradient and curvature agree with each other and with geometry."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from fingerpad.stimuli import curve
from fingerpad.stimuli.curve import Curve
from fingerpad.stimuli.shapes import Bar, Cylinder, Flat, Line, Wavy
from fingerpad.stimuli.shapes.sampled import Points

pytestmark = pytest.mark.unit

WAVE = np.linspace(-0.02, 0.02, 41)
WAVY = {
    "curvatures": [400.0, 700.0],
    "half_angle": np.radians(30),
    "lead_in": 1e-3,
    "run_out": 1e-3,
}
PROFILES = {
    "flat": Flat(),
    "cylinder": Cylinder(curvature=209.97),
    "bar": Bar(width=1.5875e-3, fillet=0.1e-3),
    "sharp bar": Bar(width=1.5875e-3),
    "line": Line(),
    "sampled": Points(WAVE, -1e-3 * np.cos(300 * WAVE)),
    "wavy": Wavy(**WAVY),
    "wavy with fillets": Wavy(**WAVY, fillet=0.5e-3),
}
STANDARD = Wavy()
INCH_RADII = 25.4e-3 * np.array([1.5, 1, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125])
point = st.tuples(st.floats(-5e-3, 5e-3), st.floats(-4e-3, 2e-3))


@pytest.mark.parametrize("name", PROFILES)
@settings(max_examples=80, deadline=None)
@given(where=point)
def test_gradient_is_the_derivative_of_the_distance(name, where):
    """Away from ridges of the distance, its finite differences are the gradient, which has length
    one.
    """
    profile, step = PROFILES[name], 1e-8
    around = np.array(where) + step * np.array([[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]])
    distance, gradient, _ = profile.evaluate(around)
    assert np.hypot(*gradient[0]) == pytest.approx(1.0, abs=1e-9)
    ahead, behind = (distance[1:3] - distance[0]) / step, (distance[0] - distance[3:]) / step
    if np.abs(ahead - behind).max() < 1e-3:  # not on a ridge
        np.testing.assert_allclose(gradient[0], (ahead + behind) / 2, atol=2e-3)


@pytest.mark.parametrize("name", ["flat", "cylinder", "bar", "line", "wavy", "wavy with fillets"])
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


@pytest.mark.parametrize("name", ["flat", "cylinder", "bar", "sharp bar", "line", "sampled"])
def test_lowest_point_is_the_origin(name):
    """A profile touches from above at height zero: nothing below is inside, something just above
    is.
    """
    x = np.linspace(-6e-3, 6e-3, 601)
    below, above = (
        PROFILES[name].evaluate(np.column_stack([x, np.full_like(x, y)]))[0].min()
        for y in (-1e-9, 2e-6)
    )
    assert below > 0 > above


@pytest.mark.parametrize("name", ["cylinder", "bar", "sampled", "wavy", "wavy with fillets"])
def test_outline_lies_on_the_surface(name):
    """The drawn outline has distance zero."""
    profile = PROFILES[name]
    x = np.linspace(-0.7e-3, 0.7e-3, 57)
    distance, _, _ = profile.evaluate(np.column_stack([x, profile.outline(x)]))
    np.testing.assert_allclose(distance, 0, atol=1e-9)


def test_sharp_corner_is_kept():
    """Beyond the corner of a sharp bar the nearest point is the corner itself."""
    bar = Bar(width=2e-3)
    distance, gradient, _ = bar.evaluate(np.array([[1e-3 + 3e-4, -4e-4]]))
    assert distance[0] == pytest.approx(5e-4) and gradient[0] == pytest.approx([0.6, -0.8])


def test_sampled_cylinder_approaches_the_cylinder():
    """A finely sampled arc has the arc's distance up to the sagitta of its chords."""
    x = np.linspace(-3e-3, 3e-3, 1201)
    exact = Cylinder(curvature=209.97)
    sampled = Points(x, exact.outline(x))
    at = np.random.default_rng(0).uniform([-2e-3, -2e-3], [2e-3, 1e-3], (200, 2))
    sagitta = (x[1] - x[0]) ** 2 / 8 * 209.97 * 2
    np.testing.assert_allclose(sampled.evaluate(at)[0], exact.evaluate(at)[0], atol=2 * sagitta)


def test_symmetry_of_samples_is_seen():
    """A symmetric sampled profile may be halved, a lopsided one may not."""
    assert Points([-1e-3, 0, 1e-3], [1e-4, 0, 1e-4]).symmetric
    assert not Points([-1e-3, 0, 1e-3], [1e-4, 0, 2e-4]).symmetric


@pytest.mark.parametrize("x", [[0.0], [0.0, 0.0], [1.0, 0.0]])
def test_profile_must_be_single_valued(x):
    with pytest.raises(ValueError, match="strictly increasing"):
        Points(x, np.zeros(len(x)))


# -- lines and arcs ------------------------------------------------------------------------------


def drawn(radii, half_angle, lead_in, run_out, spacing=1e-6):
    """Points (n, 2) of the wavy surface, drawn as a compass would: flat, arcs, flat."""

    def flat(start, length):
        x = np.arange(start, start + length, spacing)
        return np.column_stack([x, np.zeros(len(x))])

    x, parts = lead_in, [flat(0, lead_in)]
    for radius, convex in [(radii[0], 1), *((r, sign) for r in radii[1:] for sign in (-1, 1))]:
        angle = np.arange(-half_angle, half_angle, spacing / radius)
        along = x + radius * (np.sin(half_angle) + np.sin(angle))
        parts.append(
            np.column_stack([along, -convex * radius * (np.cos(angle) - np.cos(half_angle))])
        )
        x += 2 * radius * np.sin(half_angle)
    return np.vstack([*parts, flat(x, run_out)])


def test_wavy_surface_is_the_one_drawn():
    """Every point of the drawing lies on the surface, the radii of inch tools on the thesis's
    axes.
    """
    points = drawn(INCH_RADII, np.radians(9), 8e-3, 10e-3)
    np.testing.assert_allclose(STANDARD.outline(points[:, 0]), points[:, 1], atol=1e-12)
    np.testing.assert_allclose(STANDARD.evaluate(points)[0], 0, atol=1e-12)
    y = 1e3 * points[:, 1]
    assert (y.min(), y.max()) == pytest.approx((-0.469, 0.313), abs=5e-4)
    flat = STANDARD.evaluate(np.array([[-5e-3, -1e-3], [0.2, -2e-3]]))[0]
    np.testing.assert_allclose(flat, [1e-3, 2e-3], rtol=1e-12)  # the flats go on for ever
    assert not STANDARD.symmetric


def slopes_at(profile, x, h=1e-8):
    one, middle, two = profile.outline(np.array([x - h, x, x + h]))
    return np.degrees(np.arctan2([middle - one, two - middle], h))


def test_arcs_share_their_tangents_and_only_the_flats_meet_them_sharply():
    """Slopes left and right of every join; the corners are reentrant and turn by the half angle."""
    slopes = np.array([slopes_at(STANDARD, x) for x in STANDARD.curve.x[1:-1]])
    turn = np.zeros(len(slopes))
    turn[[0, -1]] = -9
    np.testing.assert_allclose(slopes[:, 1] - slopes[:, 0], turn, atol=1e-3)
    np.testing.assert_allclose(np.abs(slopes[1:-1]), 9, atol=1e-3)


def test_fillet_is_tangent_to_flat_and_arc():
    """Rounded corners have no kink left and the radius asked for; the solid gains there, nothing
    else moves.
    """
    rounded = Wavy(fillet=2e-3)
    assert [segment.curvature for segment in rounded.segments][1::16] == pytest.approx([-500, -500])
    for x in rounded.curve.x[1:-1]:
        before, after = slopes_at(rounded, x)
        assert after == pytest.approx(before, abs=1e-3)
    x = np.linspace(0, STANDARD.curve.x[-1], 20001)
    gain = STANDARD.outline(x) - rounded.outline(x)
    near = np.min(np.abs(x[:, None] - STANDARD.curve.x[[1, -2]]), axis=1) < 0.4e-3
    assert np.all(gain[near] >= -1e-15) and np.abs(gain[~near]).max() < 1e-15
    # between tangents at 9 degrees the sharp corner stands out by r (1 / cos 4.5 - 1) at most
    assert rounded.evaluate(np.array([[STANDARD.curve.x[1], 0.0]]))[0][0] == pytest.approx(
        -2e-3 * (1 / np.cos(np.radians(4.5)) - 1), rel=0.05
    )


@settings(max_examples=25, deadline=None)
@given(
    st.lists(st.floats(50, 800), min_size=1, max_size=3),
    st.floats(0.05, 0.75),
    st.lists(st.tuples(st.floats(-0.2, 1.2), st.floats(-6e-3, 3e-3)), min_size=5, max_size=5),
)
def test_distance_to_the_wavy_surface_is_the_closest_of_all(curvatures, half_angle, places):
    """Against the nearest of densely drawn points, within what their spacing allows; below the
    surface it is positive.
    """
    spacing = 2e-6
    surface = drawn(1 / np.array(curvatures), half_angle, 8e-3, 8e-3, spacing)
    profile = Wavy(curvatures=curvatures, half_angle=half_angle, lead_in=8e-3, run_out=8e-3)
    at = np.array(places) * [profile.curve.x[-1], 1.0]
    inside = (at[:, 0] > 0) & (at[:, 0] < profile.curve.x[-1])
    distance = profile.evaluate(at)[0]
    nearest, index = cKDTree(surface).query(at)
    inside &= (index > 0) & (index < len(surface) - 1)
    assert np.all(nearest >= np.abs(distance) - 1e-12)
    assert np.all(nearest[inside] <= np.hypot(distance, 2 * spacing)[inside])
    assert np.all((distance > 0) == (at[:, 1] < profile.outline(at[:, 0])))


@settings(max_examples=60, deadline=None)
@given(
    st.lists(st.tuples(st.floats(0.02, 1.0), st.floats(-1.5, 1.5)), min_size=2, max_size=40),
    st.tuples(st.floats(-0.2, 1.2), st.floats(-4.0, 4.0)),
)
def test_distance_to_steep_lines_is_the_closest_of_all(pieces, place):
    """Against every segment one by one: leaving most of them out loses none that matters, however
    steep they are.
    """
    steps = np.array(pieces)
    profile = Points(np.cumsum(steps[:, 0]), np.cumsum(steps[:, 1]))
    at = np.array([profile.x[0] + place[0] * np.ptp(profile.x), place[1]])
    ends = np.column_stack([profile.x, profile.y])
    start, way = ends[:-1], np.diff(ends, axis=0)
    share = np.einsum("ij,ij->i", at - start, way) / np.sum(way**2, axis=1)
    first, last = share[0], share[-1]
    share = np.clip(share, 0, 1)
    share[[0, -1]] = min(first, 1), max(last, 0)  # these go on for ever
    expected = np.linalg.norm(at - start - share[:, None] * way, axis=1).min()
    assert abs(profile.evaluate(at[None])[0][0]) == pytest.approx(expected, abs=1e-9)


def test_work_does_not_grow_with_the_length_of_a_profile(monkeypatch):
    """Points near the surface look at the pieces near them, whether the profile has a thousand or a
    million.
    """
    looked_at, loop = [], curve.closest
    monkeypatch.setattr(curve, "closest", lambda *words: looked_at.append(loop(*words)))
    for count in (10**3, 10**6):
        x = 1e-5 * np.arange(count)
        at = np.column_stack([np.linspace(1e-3, 9e-3, 50), np.full(50, -0.3e-3)])
        Points(x, 1e-5 * np.sin(2e3 * x)).evaluate(at)
    assert looked_at[0] == looked_at[1] < 50 * 60


def test_reentrant_corner_has_its_fan_of_normals_in_the_solid():
    """On the corner the bisector of both normals, above it the distance to it, below it that to the
    closer of the two sides.
    """
    corner, half = np.array([STANDARD.curve.x[1], 0.0]), np.radians(4.5)
    up = np.array([np.sin(half), np.cos(half)])
    distance, gradient, curvature = STANDARD.evaluate(
        np.array([corner, corner + 10e-6 * up, corner - 10e-6 * up])
    )
    np.testing.assert_allclose(distance, [0, -10e-6, 10e-6 * np.cos(half)], atol=1e-10)
    np.testing.assert_allclose(gradient[:2], [-up, -up], atol=1e-9)
    np.testing.assert_allclose(curvature[:2], [0, -1e5], rtol=1e-6)
    sides = [[0, -1], [-np.sin(2 * half), -np.cos(2 * half)]]
    assert np.abs(gradient[2] - sides).max(axis=1).min() < 1e-3


def test_level_sets_of_arcs_and_corners():
    """Curvature 1/(R + d) under a convexity, -1/(R - d) under a hollow, 1/d under a corner that
    points at the skin.
    """
    x = [np.mean(STANDARD.curve.x[k : k + 2]) for k in (1, 2)]
    deep = np.column_stack([x, STANDARD.outline(np.array(x)) - 2e-3])
    distance, gradient, curvature = STANDARD.evaluate(deep)
    np.testing.assert_allclose(distance, 2e-3, rtol=1e-9)
    np.testing.assert_allclose(gradient, [[0, -1], [0, -1]], atol=1e-9)
    np.testing.assert_allclose(curvature, [1 / (38.1e-3 + 2e-3), -1 / (25.4e-3 - 2e-3)], rtol=1e-9)
    tip = Points([-1e-3, 0, 1e-3], [1e-3, 0, 1e-3])
    assert tip.evaluate(np.array([[0.1e-3, -0.5e-3]]))[2][0] == pytest.approx(
        1 / np.hypot(0.1e-3, 0.5e-3)
    )
    assert np.all(tip.evaluate(np.zeros((1, 2)))[1][0] == [0, -1])


def test_arcs_on_a_smooth_join_are_not_corners():
    """Straight below a join between arcs the curvature is that of one of them, at any distance down
    to none.
    """
    ways = np.array([0.0, 1e-10, 1e-7, 1e-4])
    for x in STANDARD.curve.x[2:-2]:
        foot = np.array([[x, 0.0]])
        distance, _, curvature = STANDARD.evaluate(
            foot + ways[:, None] * STANDARD.evaluate(foot)[1]
        )
        np.testing.assert_allclose(distance, ways, rtol=1e-6, atol=1e-15)
        assert np.abs(curvature).max() < 350


def test_what_planning_asks_of_a_surface():
    """Largest slope and curvature, and how far the surface reaches below its start."""
    expected = np.tan(np.radians(9)), 1 / 3.175e-3, 38.1e-3 * (1 - np.cos(np.radians(9)))
    assert (STANDARD.steepness, STANDARD.convexity, STANDARD.dip) == pytest.approx(expected)
    assert (Flat().steepness, Flat().convexity, Flat().dip) == (0, 0, 0)
    convex = [each.convexity for each in (Cylinder(curvature=210.0), Line(), Bar(width=1e-3))]
    assert convex == pytest.approx([210, 1e4, 0])
    x = np.linspace(-3e-3, 3e-3, 601)
    assert Points(x, Cylinder(curvature=210.0).outline(x)).convexity == pytest.approx(210, rel=0.5)
    groove = Points([-2e-3, -1e-3, 0, 1e-3, 2e-3], [0, 0, 1e-3, 0, 0])
    found = groove.dip, groove.steepness, groove.convexity
    assert found == pytest.approx((1e-3, 1.0, np.pi / 4 / 1e-3))


@pytest.mark.parametrize(
    "bend",
    [[100, 0, 0], [0, 0, 100], [0, 2000, 0]],
    ids=["arc at the start", "arc at the end", "arc smaller than its chord"],
)
def test_surface_must_be_single_valued_between_lines(bend):
    with pytest.raises(ValueError, match="single-valued"):
        Curve([-3e-3, -1e-3, 1e-3, 3e-3], np.zeros(4), bend)


def test_points_that_are_no_numbers_do_not_stop_a_query():
    """Newton's method may stray; its residual then says so, not the profile."""
    assert np.isnan(STANDARD.evaluate(np.array([[np.nan, 0.0], [0.0, np.nan]]))[0]).all()
    assert [len(part) for part in STANDARD.evaluate(np.zeros((0, 2)))] == [0, 0, 0]


@pytest.mark.parametrize("curvature", [1e-7, 1e-10, 1e-13])
def test_nearly_flat_cylinders_are_exact(curvature):
    """Of a flat plate their distance differs by the sagitta, k x^2 / 2, and not by what a radius of
    10^13 m rounds away.
    """
    at = np.random.default_rng(0).uniform([-5e-3, -2e-3], [5e-3, 1e-4], (200, 2))
    cylinder, sagitta = Cylinder(curvature=curvature), curvature * at[:, 0] ** 2 / 2
    distance, gradient, _ = cylinder.evaluate(at)
    np.testing.assert_allclose(distance, -at[:, 1] + sagitta, rtol=1e-9)
    np.testing.assert_allclose(gradient, np.tile([0.0, -1.0], (200, 1)), atol=1e-9)
    np.testing.assert_allclose(cylinder.outline(at[:, 0]), sagitta, rtol=1e-9)


@pytest.mark.parametrize("deep", [False, True])
def test_a_changed_copy_has_its_own_curve(deep):
    steep = STANDARD.model_copy(update={"half_angle": np.radians(12)}, deep=deep)
    assert STANDARD.curve is STANDARD.curve
    assert steep.steepness == pytest.approx(np.tan(np.radians(12)))

"""Nodes in valleys of a surface: where both sides are, how forces are told apart, and what the
contact problem makes of them.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad.healing import simulate
from fingerpad.mechanics import valleys
from fingerpad.mechanics.contact import ContactError, tangents
from fingerpad.mechanics.friction import Coulomb
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.mechanics.valleys import Valleys
from fingerpad.stimuli.curve import Curve
from fingerpad.stimuli.shapes import Flat
from test_contact import check_laws, problem, rows_of, solve, zone_of

pytestmark = pytest.mark.unit


def groove():
    """Two flanks that rise at 30 degrees to a ridge of air at x = 0, between level surfaces; also
    its height.
    """
    flank = 2e-3
    rise = flank * np.tan(np.radians(30))
    return Curve([-9e-3, -flank, 0, flank, 9e-3], [0, 0, rise, 0, 0], np.zeros(4)), rise


def test_both_sides_of_a_groove():
    """Against the distance of a point from two straight lines, beyond the corner as well, with
    opposite slants.
    """
    profile, rise = groove()
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(-2e-4, 2e-4, 40), rise + rng.uniform(-2e-4, 2e-4, 40)])
    found = profile.walls(points, 1e-3)
    flat, steep = np.cos(np.radians(30)), np.sin(np.radians(30))
    normals = np.array([[steep, -flat], [-steep, -flat]])
    assert profile.valleys and list(found.which) == list(range(40)) and set(found.corner) == {2}
    np.testing.assert_allclose(found.distance, (points - [0, rise]) @ normals.T, atol=1e-15)
    np.testing.assert_allclose(found.gradient, np.broadcast_to(normals, (40, 2, 2)), atol=1e-12)
    assert not found.curvature.any()


def test_where_there_is_no_valley():
    """Out of reach, beside a corner that points at the skin, on a bend less than matters, or on a
    plate.
    """
    profile, rise = groove()
    assert not len(profile.walls(np.array([[3e-4, rise], [2e-3, 0.0]]), 1e-4).which)
    assert not Curve([-1, 0, 1], [1e-3, 0, 1e-3], [0, 0]).valleys
    assert (
        not Curve([-1, 0, 1], [0, 5e-4, 0], [0, 0]).valleys
        and Curve([-1, 0, 1], [0, 2e-3, 0], [0, 0]).valleys
    )
    bottom = np.array([[0.0, rise]])
    assert len(profile.walls(bottom, 1e-4, flat=1.0).which) and not len(
        profile.walls(bottom, 1e-4, flat=1.1).which
    )
    assert not Flat().valleys and not len(Flat().walls(np.zeros((3, 2)), 1.0).which)


def test_a_valley_between_arcs():
    """The sides are the circles, with their curvature; reach ends where a short side does."""
    bend, half = 400.0, 1e-3
    sag = 1 / bend - np.sqrt(1 / bend**2 - half**2)
    profile = Curve([-9e-3, -2 * half, 0, 2 * half, 9e-3], [0, 0, 0, 0, 0], [0, bend, bend, 0])
    point = np.array([[1e-4, -2e-5]])
    found = profile.walls(point, 1e-3)
    centres = np.array([[-half, 1 / bend - sag], [half, 1 / bend - sag]])
    away = np.hypot(*(point - centres).T)
    np.testing.assert_allclose(found.distance[0], away - 1 / bend, atol=1e-14)
    np.testing.assert_allclose(found.gradient[0], (point - centres) / away[:, None], atol=1e-12)
    np.testing.assert_allclose(found.curvature[0], 1 / away)
    assert len(profile.walls(np.array([[0.0, 1.9e-3]]), 1.0).which) and not len(
        profile.walls(np.array([[0.0, 2.1e-3]]), 1.0).which
    )


def test_forces_of_both_sides_are_one_on_the_point():
    """Two equal pushes from the sides of a groove hold a point against f / (2 sin) of its
    weight.
    """
    slant = np.array([np.sin(0.5), -np.cos(0.5)])
    gradient = np.array([[0.0, -1.0], slant, [0.0, -1.0], slant * [-1, 1]])
    partner, gap = np.array([-1, 3, -1, 1]), np.array([3.0, 2.0, 1.0, -1.0])
    rows = rows_of(zone_of(4), gap, gradient, partner=partner)
    push = rows.of_points(np.array([1.0, 5.0, 0.0, 5.0])[:, None] * gradient)
    np.testing.assert_allclose(push, [[0, -1], [0, -10 * np.cos(0.5)], [0, 0]], atol=1e-15)
    assert rows.points == 3
    single = rows_of(zone_of(4), gap, gradient)
    np.testing.assert_array_equal(single.of_points(gradient), gradient)


def test_forces_go_with_their_side():
    """Into a valley and out of it again: what a node carried stays with the side it is nearest to;
    on the mirror both are one.
    """
    profile, rise = groove()
    equation = np.arange(10).reshape(5, 2)
    equation[0, 0] = -1
    zone, part = zone_of(5, equation - (equation > 0)), slice(0, 5)
    law, force, state = (
        Valleys(profile, 5, 1e-4),
        np.r_[1.0, 2, 3, 4, 5, np.zeros(5)],
        np.zeros(10, np.int8),
    )

    def at(*places):
        points = np.array([[x, rise - 1e-5] for x in places])
        return law.rows(zone, part, points, profile.evaluate(points), [force, state])

    rows = at(0.0, -1e-3, -5e-5, 5e-5, 1e-3)
    assert list(rows.place) == [0, 1, 2, 3, 4, 7, 8] and list(rows.partner) == [
        -1,
        -1,
        5,
        6,
        -1,
        2,
        3,
    ]
    assert list(rows.zone.shape.argmax(axis=1)) == [0, 1, 2, 3, 4, 2, 3]
    np.testing.assert_array_equal(force, [1, 2, 3, 0, 5, 0, 0, 0, 4, 0])
    state[[2, 7, 3, 8]] = 1, 1, 0, -1
    rows = at(0.0, -1e-3, -1e-3, 1e-3, 1e-3)
    np.testing.assert_array_equal(state, [0, 0, 1, -1, 0, 0, 0, 0, 0, 0])
    assert set(rows.partner) == {-1} and rows.place == part
    np.testing.assert_array_equal(force, [1, 2, 3, 4, 5, 0, 0, 0, 0, 0])


def in_valleys(seed, count=12, twice=4):
    """A random contact problem, some nodes of which lean on two sides."""
    zone, schur, right, gap, gradient = problem(seed, count)
    rng = np.random.default_rng(seed)
    which = rng.choice(count, twice, replace=False)
    angle = rng.uniform(0.05, 1.2, twice)
    normal = np.column_stack([np.sin(angle), -np.cos(angle)])
    gradient[which] = normal
    rows = zone.doubled(which)
    partner = np.full(count + twice, -1)
    partner[which], partner[count:] = count + np.arange(twice), which
    gap, gradient = np.concatenate([gap, gap[which]]), np.concatenate([gradient, normal * [-1, 1]])
    return (rows, schur, right, gap, gradient), partner


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.floats(1e-3, 1e2))
def test_every_side_is_kept(seed, force):
    """Forces push, no side is crossed, only closed ones carry, and the vertical parts are the
    load.
    """
    parts, _ = in_valleys(seed)
    check_laws(parts, solve(parts, force=force), force)


def frictional(seed, coefficient, force=2.0):
    (zone, schur, right, gap, gradient), partner = in_valleys(seed)
    zero, law = np.zeros(len(gap)), Coulomb(coefficient, len(gap))
    motion = np.random.default_rng(seed).normal(0, 1e-2, (len(gap), 2))
    motion[12:] = motion[partner[12:]]
    rows = rows_of(zone, gap, gradient, partner=partner)
    step = law.solve(rows, schur, right, zero, zero.astype(bool), motion, force=force)
    tangent = tangents(gradient)
    du, dd = step.condensed_displacement, step.depth_change
    opening = gap + zone.gather(gradient) @ du + gradient[:, 1] * dd
    slip = np.einsum("ni,ni->n", motion, tangent) + zone.gather(tangent) @ du + tangent[:, 1] * dd
    return step, partner, opening, slip


@pytest.mark.parametrize(("coefficient", "least"), [(0.1, 90), (0.4, 75)])
def test_a_node_held_by_both_sides_needs_no_friction(coefficient, least):
    """Coulomb's law holds on every side that a node leans on alone; where it leans on both, they
    hold it.

    Of random problems a few have no such solution, which is said.
    """
    solved = lodged = 0
    for seed in range(100):
        try:
            step, partner, opening, slip = frictional(seed, coefficient)
        except ContactError as error:
            assert "keep cycling" in str(error)
            continue
        both = (partner >= 0) & step.active & step.active[partner]
        alone = step.active & ~both
        solved, lodged = solved + 1, lodged + both.sum() // 2
        assert (
            opening.min() > -1e-9
            and np.abs(opening[step.active]).max() < 1e-9
            and step.force.min() >= 0
        )
        assert not step.tangential[both].any() and np.all(step.state[both] != 0)
        assert np.all(np.abs(step.tangential) <= coefficient * step.force * (1 + 1e-5) + 1e-12)
        assert np.all(step.tangential[alone] * slip[alone] <= 1e-9)
        assert np.all(np.abs(slip)[alone & (step.state == 0)] < 1e-9)
    assert solved >= least and lodged > 50


@pytest.mark.parametrize(("share", "ends"), [(None, True), (0.0, False)])
def test_a_stroke_over_a_finely_sampled_hollow_with_friction(share, ends, tmp_path, monkeypatch):
    """Each sample of a hollow is a valley, shallow against friction's angle; mutant: two
    constraints in them cycle.
    """
    if share is not None:
        monkeypatch.setattr(valleys, "SHARE", share)
    x = np.arange(-12, 20, 0.1)
    y = np.where(abs(x - 6) < 3, 0.05 * (9 - (x - 6) ** 2), 0.0)
    np.savetxt(
        tmp_path / "hollow.csv",
        np.column_stack([x, y]),
        delimiter=",",
        header="x (mm),y (mm)",
        comments="",
    )
    scene = {
        "stimulus": {"shape": "sampled", "csv": str(tmp_path / "hollow.csv"), "smooth": "none"},
        "friction": 0.35,
        "accuracy": "draft",
        "motion": [
            {"press_to_force": "20 gf", "rate": "40 gf/s"},
            {"slide": "8 mm", "speed": "10 mm/s"},
        ],
    }
    if ends:
        assert not simulate(scene)["cutbacks"].values.any()
    else:
        with pytest.raises(NonConvergence, match="stick and slip keep cycling"):
            simulate(scene | {"on_trouble": "stop"})

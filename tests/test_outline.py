"""The outline: its parameters come out as asked, layers are exact offsets, impossible ones are
refused.
"""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad.specimen import OutlineCurve, OutlineError
from synthetic import OUTLINE as THESIS

pytestmark = pytest.mark.unit


def outline(**changed):
    """A stand-in with the attributes of the scene's model, which refuses some of what is tested
    here.
    """
    return SimpleNamespace(**{**THESIS, **changed})


def test_circle_has_the_circles_curvature_length_and_offset():
    radius = 7e-3
    circle = outline(apex_height=radius, apex_radius=radius, half_width=radius, depth_below=radius)
    curve = OutlineCurve(circle)
    theta = np.linspace(0.0, np.pi, 101)
    np.testing.assert_allclose(curve.curvature(theta), 1.0 / radius, rtol=1e-12)
    np.testing.assert_allclose(curve.arc_length(theta), radius * theta, rtol=1e-12)
    assert curve.length == pytest.approx(np.pi * radius, rel=1e-13)
    np.testing.assert_allclose(np.hypot(*curve.point(theta, 1e-3).T), radius - 1e-3, rtol=1e-12)


def test_curvature_is_the_rate_of_turning():
    curve = OutlineCurve(outline())
    theta = np.linspace(0.05, 1.5, 30)
    step = 1e-5
    normals = [np.arctan2(*curve.normal(theta + side * step).T) for side in (-1, 1)]
    lengths = [curve.arc_length(theta + side * step) for side in (-1, 1)]
    rate = (normals[1] - normals[0]) / (lengths[1] - lengths[0])
    np.testing.assert_allclose(rate, curve.curvature(theta), rtol=1e-6)


def test_arc_length_and_angle_are_inverse():
    curve = OutlineCurve(outline())
    s = np.linspace(-curve.length, curve.length, 1001)
    np.testing.assert_allclose(curve.arc_length(curve.theta_at(s)), s, rtol=1e-12, atol=1e-15)
    np.testing.assert_array_equal(curve.theta_at([0.0, curve.length]), [0.0, np.pi])
    x, y = curve.point(np.linspace(0.0, np.pi, 200001)).T
    assert np.hypot(np.diff(x), np.diff(y)).sum() == pytest.approx(curve.length, rel=1e-9)


@pytest.mark.parametrize("lower", [False, True])
def test_angle_at_a_lateral_position(lower):
    curve = OutlineCurve(outline())
    x = np.array([-8e-3, -1e-3, 0.0, 1e-6, 5e-3, 8.5e-3])
    points = curve.point(curve.theta_at_x(x, lower=lower))
    np.testing.assert_allclose(points[:, 0], x, rtol=1e-12, atol=1e-17)
    assert (points[:, 1] <= 1e-12).all() if lower else (points[:, 1] >= -1e-12).all()


def test_left_half_is_the_mirror_image():
    curve = OutlineCurve(outline())
    theta = np.linspace(0.0, np.pi, 257)
    for depth in (0.0, 0.85e-3):
        np.testing.assert_array_equal(
            curve.point(-theta, depth), curve.point(theta, depth) * (-1.0, 1.0)
        )


def test_bone_foot_is_the_nearest_point():
    curve = OutlineCurve(outline())
    points = curve.point(np.linspace(0.0, np.pi, 41), curve.layer_depths[-1])
    rim = curve.bone_point(np.linspace(0.0, np.pi, 20001))
    nearest = np.hypot(*np.moveaxis(points[:, None] - rim, -1, 0)).min(axis=1)
    foot = curve.bone_point(curve.bone_foot(points))
    np.testing.assert_allclose(np.hypot(*(points - foot).T), nearest, rtol=1e-6)
    assert foot[0, 0] == 0.0 and foot[-1, 0] == 0.0


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("half_width", 4e-3, ["4 mm", "between 4.59 mm and 25.24 mm"]),
        ("half_width", 30e-3, ["between"]),
        ("nail_half_width", 8.5e-3, ["half_width"]),
        ("nail_half_width", 0.0, ["above 0"]),
        ("dermis_thickness", -1e-3, ["above 0"]),
        ("dermis_thickness", 2.3e-3, ["epidermis_thickness +", "3.15 mm", "3.069 mm"]),
        ("dermis_thickness", 1.4e-3, ["epidermis_thickness +", "bone", "2.182 mm"]),
        ("bone_centre_height", -4e-3, ["inside"]),
        ("bone_centre_height", 30e-3, ["inside"]),
        ("bone_half_width", 9e-3, ["inside"]),
        ("bone_half_height", 20e-3, ["inside"]),
    ],
)
def test_impossible_outlines_are_refused(key, value, words):
    with pytest.raises(OutlineError) as caught:
        OutlineCurve(outline(**{key: value}))
    message = str(caught.value)
    assert "\n" not in message
    for word in (key, *words):
        assert word in message


@settings(max_examples=30, deadline=None)
@given(
    scale=st.floats(0.5, 2.0),
    height=st.floats(4e-3, 9e-3),
    widening=st.floats(0.8, 1.8),
    below=st.floats(4e-3, 9e-3),
    thickness=st.floats(0.1, 0.9),
)
def test_offsets_keep_their_distance(scale, height, widening, below, thickness):
    radius = scale * height
    inside = ["epidermis_thickness", "dermis_thickness", "nail_half_width"]
    inside += ["bone_half_width", "bone_half_height"]
    shape = dict.fromkeys(inside, 1e-6) | {
        "apex_height": height,
        "apex_radius": radius,
        "depth_below": below,
        "half_width": widening * np.sqrt(radius * height),
        "bone_centre_height": 0.0,
    }
    curve = OutlineCurve(outline(**shape))
    theta = np.linspace(0.0, np.pi, 501)
    depth = thickness / curve.curvature(theta).max()
    skin, offset = curve.point(theta), curve.point(theta, depth)
    np.testing.assert_allclose(np.hypot(*(skin - offset).T), depth, rtol=1e-10)
    everywhere = np.hypot(*np.moveaxis(offset[::10, None] - skin, -1, 0)).min(axis=1)
    assert everywhere.min() > depth * (1.0 - 1e-9)

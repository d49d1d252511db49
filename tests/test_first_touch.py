"""First touch: a profile comes straight down, onto nodes or between them, on pads and meshes in any
place.
"""

from dataclasses import replace

import numpy as np
import pytest
import yaml

from fingerpad import load_scene, plan, simulate
from fingerpad.mechanics.stepping import NonConvergence, first_touch
from fingerpad.specimen import mesh_for, write_pad
from fingerpad.stimuli.shapes import Bar, Cylinder, Flat
from fingerpad.stimuli.shapes.sampled import Points

pytestmark = pytest.mark.unit
ROUND = 8e-3


def skin(spacing=1e-5, shift=0.0):
    """An arc of 8 mm radius with its apex at height zero and the node nearest to it ``shift`` m
    away.
    """
    x = np.arange(-700, 701) * spacing + shift
    return np.column_stack([x, np.sqrt(ROUND**2 - np.minimum(x**2, ROUND**2)) - ROUND])


@pytest.mark.parametrize("along", [0.0, 0.5e-3, -2e-3, 5e-3])
@pytest.mark.parametrize("curvature", [1e-13, 26.0, 90.0, 110.0, 1260.0])
def test_cylinders_touch_where_two_circles_do(curvature, along):
    """A circle of radius R over a point ``along`` m beside an arc of radius r stands (R + r) cos a
    above its centre.
    """
    radius = 1 / curvature
    off = along / (radius + ROUND)
    # R cos a - R without the cancellation
    expected = ROUND * (np.sqrt(1 - off**2) - 1) - radius * off**2 / (1 + np.sqrt(1 - off**2))
    assert first_touch(skin() + [along, 0.0], Cylinder(curvature=curvature)) == pytest.approx(
        expected, abs=2e-8
    )


def test_a_profile_touches_between_nodes_if_it_fits_there():
    """A blade narrower than the spacing touches the line between two nodes; beside the pad it
    touches nothing.
    """
    coarse = skin(0.5e-3, 0.25e-3)[2:-2]
    for profile in (
        Bar(width=0.1e-3),
        Bar(width=0.1e-3, fillet=0.05e-3),
        Points([-5e-5, 5e-5], [0.0, 0.0]),
    ):
        assert first_touch(coarse, profile) == pytest.approx(np.interp(0.0, *coarse.T), abs=1e-7)
        assert np.isnan(first_touch(coarse + [9e-3, 0.0], profile))
    assert first_touch(coarse, Flat()) == coarse[:, 1].max()


PRESS = """
stimulus: {shape: cylinder, curvature: "%s 1/m"}
motion: [{press_to_force: "20 gf"}%s]
accuracy: draft
"""


def pressed(*values, text=PRESS, **more):
    """The history of a press by a cylinder: its curvature, and more legs."""
    return simulate(yaml.safe_load(text % values) | more)


@pytest.mark.parametrize("shift", [1e-5, 3e-4])
def test_an_external_mesh_need_not_have_its_apex_in_the_middle(shift, tmp_path):
    """A pad 0.01 or 0.3 mm beside x = 0 is pressed by a sharp cylinder as one in the middle, within
    what its nodes allow.
    """
    scene = load_scene(yaml.safe_load(PRESS % (210, "")))
    built, depths = mesh_for(scene, plan(scene)), []
    for x in (0.0, shift):
        moved = replace(built, points=built.points + [x, 0.0], symmetric=False)
        write_pad(moved, tmp_path / "my.msh")
        history = pressed(120, "", specimen={"mesh": str(tmp_path / "my.msh")})
        depths.append(float(history.indentation_depth[-1]))
    assert depths[1] == pytest.approx(depths[0], rel=0.01)


@pytest.mark.parametrize("curvature", [90, 100, 210, 1260])
def test_cylinders_of_any_curvature_are_stepped(curvature):
    """Each press of a step finds the pad anew; half a millimetre beside the apex a pad is hardly
    another one.
    """
    history = pressed(curvature, ", {step: 1 mm, every: 0.5 mm}")
    before, after = history.indentation_depth.values[[-3, -1]]
    assert float(history.stroke_distance[-1]) == pytest.approx(1e-3)
    assert after == pytest.approx(before, rel=0.1)


def test_a_step_beside_the_pad_says_so():
    """A sharp cylinder stepped 12 mm away finds nothing to touch; what was solved before is
    kept.
    """
    with pytest.raises(NonConvergence, match="left the pad at 12 mm; try a shorter way") as caught:
        pressed(1260, ", {step: 12 mm, every: 12 mm}")
    assert caught.value.dataset.sizes["time"] == 2


def test_a_nearly_flat_cylinder_presses_like_a_plate():
    plate = pressed(1, "", stimulus={"shape": "flat"}).indentation_depth[-1]
    assert float(pressed(1e-13, "").indentation_depth[-1]) == pytest.approx(float(plate), rel=1e-6)


@pytest.mark.slow
@pytest.mark.stability
def test_a_cylinder_stroked_off_the_pad_says_where():
    """Where the pad's side is all that is left to push on; a shorter stroke, as advised, works."""
    stroke = """
stimulus: {shape: cylinder, curvature: "200 1/m"}
motion: [{press_to_force: "20 gf", rate: "40 gf/s"}, {slide: "%s mm", speed: "20 mm/s"}]
accuracy: {skin_edge: "400 um", steps: %s}
"""
    said = r"the stimulus left the pad at 1\d(\.\d)? mm; try a way of less than 1"
    with pytest.raises(NonConvergence, match=said) as caught:
        pressed(30, 60, text=stroke)
    left = 1e3 * caught.value.dataset.stroke_distance.values[-1]
    assert pressed(round(left - 1), 24, text=stroke).attrs["complete"]

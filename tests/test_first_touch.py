"""First touch: a profile comes straight down, onto nodes or between them, on pads and meshes in any
place.
"""

import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.mechanics.stepping import NonConvergence, first_touch
from fingerpad.specimen.files import write_pad
from fingerpad.specimen.pad import PadMesh
from fingerpad.stimuli.shapes import Bar, Cylinder, Flat
from fingerpad.stimuli.shapes.sampled import Points

ROUND = 8e-3


def skin(spacing=1e-5, shift=0.0):
    """An arc of 8 mm radius with its apex at height zero and the node nearest to it ``shift`` m
    away.
    """
    x = np.arange(-700, 701) * spacing + shift
    return np.column_stack([x, np.sqrt(ROUND**2 - np.minimum(x**2, ROUND**2)) - ROUND])


@pytest.mark.unit
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


@pytest.mark.unit
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


TEXT = """
specimen: {{mesh: my.msh}}
stimulus: {{shape: cylinder, curvature: "{curvature} 1/m"}}
motion: [{{press_to_force: "20 gf"}}]
accuracy: draft
"""


@pytest.mark.unit
@pytest.mark.parametrize("shift", [1e-5, 3e-4])
def test_an_external_mesh_need_not_have_its_apex_in_the_middle(shift, tmp_path):
    """A pad 0.01 or 0.3 mm beside x = 0 is pressed by a sharp cylinder as one in the middle, within
    what its nodes allow.
    """
    built = _draft_mesh()
    depths = []
    for x in (0.0, shift):
        moved = PadMesh(
            built.points + [x, 0.0], built.cells, built.element, built.region, built.curves, False
        )
        write_pad(moved, tmp_path / "my.msh")
        (tmp_path / "scene.yaml").write_text(TEXT.format(curvature=120))
        depths.append(float(simulate(load_scene(tmp_path / "scene.yaml")).indentation_depth[-1]))
    assert depths[1] == pytest.approx(depths[0], rel=0.01)


def _draft_mesh():
    from fingerpad.specimen import mesh_for
    from test_scene import CONFIG

    scene = load_scene(CONFIG / "scenes" / "ramp40_k210.yaml").with_accuracy("draft")
    return mesh_for(scene, plan(scene))


@pytest.mark.unit
@pytest.mark.parametrize("curvature", [90, 100, 210, 1260])
def test_cylinders_of_any_curvature_are_stepped(curvature, tmp_path):
    """Each press of a step finds the pad anew; half a millimetre beside the apex a pad is hardly
    another one.
    """
    text = f"""
stimulus: {{shape: cylinder, curvature: "{curvature} 1/m"}}
motion: [{{press_to_force: "20 gf"}}, {{step: "1 mm", every: "0.5 mm"}}]
accuracy: draft
"""
    (tmp_path / "scene.yaml").write_text(text)
    history = simulate(load_scene(tmp_path / "scene.yaml"))
    depth = history.indentation_depth.values[[-3, -1]]
    assert float(history.stroke_distance[-1]) == pytest.approx(1e-3) and depth[1] == pytest.approx(
        depth[0], rel=0.1
    )


@pytest.mark.unit
def test_a_step_beside_the_pad_says_so(tmp_path):
    """A sharp cylinder stepped 12 mm away finds nothing to touch; what was solved before is
    kept.
    """
    text = """
stimulus: {shape: cylinder, curvature: "1260 1/m"}
motion: [{press_to_force: "20 gf"}, {step: "12 mm", every: "12 mm"}]
accuracy: draft
"""
    (tmp_path / "scene.yaml").write_text(text)
    with pytest.raises(NonConvergence, match="left the pad at 12 mm; try a shorter way") as caught:
        simulate(load_scene(tmp_path / "scene.yaml"))
    assert caught.value.dataset.sizes["time"] == 2


@pytest.mark.unit
def test_a_nearly_flat_cylinder_presses_like_a_plate(tmp_path):
    depths = []
    for stimulus in ("{shape: flat}", '{shape: cylinder, curvature: "1e-13 1/m"}'):
        text = f'stimulus: {stimulus}\nmotion: [{{press_to_force: "20 gf"}}]\naccuracy: draft\n'
        (tmp_path / "scene.yaml").write_text(text)
        depths.append(float(simulate(load_scene(tmp_path / "scene.yaml")).indentation_depth[-1]))
    assert depths[1] == pytest.approx(depths[0], rel=1e-6)


@pytest.mark.slow
@pytest.mark.stability
def test_a_cylinder_stroked_off_the_pad_says_where(tmp_path):
    """Where the pad's side is all that is left to push on; a shorter stroke, as advised, works."""
    text = """
stimulus: {{shape: cylinder, curvature: "200 1/m"}}
motion: [{{press_to_force: "20 gf", rate: "40 gf/s"}}, {{slide: "{way} mm", speed: "20 mm/s"}}]
accuracy: {{skin_edge: "400 um", steps: {steps}}}
"""
    (tmp_path / "scene.yaml").write_text(text.format(way=30, steps=60))
    with pytest.raises(
        NonConvergence,
        match=r"the stimulus left the pad at 1\d(\.\d)? mm; try a way of less than 1",
    ) as caught:
        simulate(load_scene(tmp_path / "scene.yaml"))
    left = 1e3 * caught.value.dataset.stroke_distance.values[-1]
    (tmp_path / "scene.yaml").write_text(text.format(way=round(left - 1), steps=24))
    assert simulate(load_scene(tmp_path / "scene.yaml")).attrs["complete"]

"""Bodies of revolution as scenes: what they can be, and what a run says of them in newtons."""

import meshio
import numpy as np
import pytest
import yaml

from fingerpad import load_scene, plan, simulate
from fingerpad.cli import main
from fingerpad.documents import SceneError
from fingerpad.results import scene_of, summary, write_vtu
from fingerpad.specimen import MeshError
from own_meshes import slab

pytestmark = pytest.mark.unit

SHAPES = {
    "sphere": {"shape": "sphere", "radius": "5 mm"},
    "punch": {"shape": "punch", "diameter": "3 mm", "fillet": "0.3 mm"},
    "cone": {"shape": "cone", "half_angle": "60 deg", "radius": "0.5 mm"},
    "flat": {"shape": "flat"},
}
RUBBER = {"name": "rubber", "thickness": "4 mm", "youngs_modulus": "50 kPa"}
DISC = {"slab": {"width": "30 mm", "layers": [RUBBER]}}


def scene(stimulus="sphere", **changes):
    press = {"motion": [{"press_to_force": "20 gf"}], "accuracy": "draft"}
    touching = SHAPES[stimulus] if isinstance(stimulus, str) else stimulus
    return {"kinematics": "axisymmetric", "stimulus": touching} | press | changes


@pytest.mark.parametrize("shape", SHAPES)
def test_a_dome_is_pressed_in_newtons(shape):
    history = simulate(scene(shape, accuracy={"steps": 4, "skin_edge": "300 um"}))
    leg = summary(history)["legs"][-1]
    assert leg["force_N"] == pytest.approx(20 * 9.80665e-3, rel=1e-4)
    assert history.force.attrs["units"] == "N" and history.external_work.attrs["units"] == "J"
    radius = leg["contact_radius_mm"]
    assert leg["contact_width_mm"] == pytest.approx(2 * radius)
    assert leg["contact_area_mm2"] == pytest.approx(np.pi * radius**2, rel=0.02)
    assert "force_N_per_m" not in leg
    # pressure over the radius carries the force
    end = history.isel(time=-1)
    r = (end.skin_x + end.skin_displacement_x).values
    order = slice(0, int(np.argmax(r)))
    carried = np.trapezoid(2 * np.pi * (r * end.contact_pressure.values)[order], r[order])
    assert carried == pytest.approx(leg["force_N"], rel=0.03)
    assert abs(float(end.energy_balance_error)) < 0.03


def test_a_plane_scene_says_nothing_of_it():
    document = load_scene({"stimulus": {"shape": "flat"}, "motion": [{"press_to_depth": "1 mm"}]})
    assert "kinematics" not in document.canonical() and document.kinematics == "plane_strain"


def test_a_scene_comes_back_from_its_history():
    written = load_scene(scene("cone"))
    history = simulate(written)
    assert scene_of(history).canonical() == written.canonical()
    assert float(history.fingerpad.force_N[-1]) == pytest.approx(0.196133, rel=1e-4)


def test_a_plan_says_why():
    said = str(plan(scene("punch")))
    assert "a body of revolution" in said and "in N" in said


def test_a_profile_is_of_one_side(tmp_path):
    rows = [f"{x},{5 - np.sqrt(25 - x**2)}" for x in np.linspace(0, 4, 81)]
    (tmp_path / "bowl.csv").write_text("\n".join(["x (mm),y (mm)", *rows]))
    sampled = {"shape": "sampled", "csv": str(tmp_path / "bowl.csv")}
    turned, sphere = (
        summary(simulate(scene(each)))["legs"][-1]["contact_radius_mm"]
        for each in (sampled, "sphere")
    )
    assert turned == pytest.approx(sphere, rel=0.03)
    (tmp_path / "both.csv").write_text("\n".join(["x (mm),y (mm)", "-1,0.1", "0,0", "2,0.4"]))
    with pytest.raises(SceneError, match=r"stimulus.csv.*beyond the axis"):
        load_scene(scene({"shape": "sampled", "csv": str(tmp_path / "both.csv")}))


def test_fields_are_revolved_on_request(tmp_path):
    """A disc is as wide as its diameter; a node's displacement turns with it."""
    rubber = scene("sphere", specimen=DISC, motion=[{"press_to_depth": "0.2 mm"}])
    history = simulate(rubber, fields=True)
    flat, solid = (
        meshio.read(write_vtu(history, tmp_path / str(slices), slices)[0]) for slices in (0, 32)
    )
    assert {block.type for block in solid.cells} == {"hexahedron"}
    assert np.ptp(solid.points[:, 0]) == pytest.approx(30, rel=1e-6)
    assert len(solid.cells[0].data) == 32 * len(flat.cells[0].data)
    name, quarter = "displacement (mm)", np.abs(solid.points[:, 0]) < 1e-9
    assert np.abs(solid.point_data[name][quarter, 0]).max() < 1e-9
    radial = np.linalg.norm(solid.point_data[name][:, [0, 2]], axis=1).max()
    corners = np.unique(flat.cells[0].data[:, :4])
    assert radial == pytest.approx(np.abs(flat.point_data[name][corners, 0]).max(), rel=1e-6)


def test_only_a_body_of_revolution_is_revolved(tmp_path, capsys):
    plane = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_depth": "1 mm"}]}
    (tmp_path / "plane.yaml").write_text(yaml.safe_dump(plane))
    words = ["run", str(tmp_path / "plane.yaml"), "--out", str(tmp_path / "out"), "--vtu"]
    assert main([*words, "--revolved"]) == 2
    assert "allowed: beside --vtu" in capsys.readouterr().err


def test_an_own_mesh_is_the_right_half(tmp_path):
    """It gives what the disc of its sizes gives; a whole section is refused."""
    foam = {"youngs_modulus": "50 kPa"}
    slab(tmp_path / "half.msh", 0.25e-3, low=0.0, left=0.0)
    slab(tmp_path / "whole.msh", 0.5e-3)
    own, whole = (
        {"mesh": str(tmp_path / f"{name}.msh"), "layers": {"foam": foam}}
        for name in ("half", "whole")
    )
    disc = {"slab": {"width": "20 mm", "layers": [{"name": "foam", "thickness": "5 mm"} | foam]}}
    depths = [
        summary(simulate(scene(specimen=each)))["legs"][-1]["depth_mm"] for each in (own, disc)
    ]
    assert depths[0] == pytest.approx(depths[1], rel=0.01)
    with pytest.raises(MeshError, match="begins on its axis"):
        plan(scene(specimen=whole))


def test_a_disc_is_pressed_again():
    """A press, a lift and a press again to a depth, in time."""
    press = {"press_to_depth": "0.5 mm", "speed": "1 mm/s"}
    history = simulate(scene(specimen=DISC, motion=[press, {"lift": "1 mm/s"}, press]))
    first, lifted, again = summary(history)["legs"]
    assert again["force_N"] == pytest.approx(first["force_N"], rel=1e-3)
    assert abs(lifted["force_N"]) < 1e-3 * first["force_N"]

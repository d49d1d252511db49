"""Any pad: slabs, half-rounds and meshes with layers and curves of any names, of every element,
graded and off-centre.
"""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml

from fingerpad import load_scene, plan, simulate
from fingerpad.documents import SceneError
from fingerpad.planning.plan import PlanError
from fingerpad.planning.stack_estimate import StackEstimate
from fingerpad.reference_solutions import layered, layered_contact
from fingerpad.results import summary
from fingerpad.specimen import MeshError, MeshSize, quality_of, write_pad
from fingerpad.specimen.measures import below_skin, layers_below
from fingerpad.specimen.stacks import build_stack_mesh
from own_meshes import places, read_back
from test_external_scenes import linear, linear_triangles, triangles
from test_mesh import renamed, write_rings

pytestmark = pytest.mark.unit

EXAMPLES = Path(__file__).parents[1] / "config" / "scenes" / "examples"
COVER = {"name": "cover", "thickness": "1 mm", "youngs_modulus": "0.5 MPa", "poisson_ratio": 0.45}
FOAM = {"name": "foam", "thickness": "4 mm", "youngs_modulus": "50 kPa", "poisson_ratio": 0.3}
SLAB = {"slab": {"width": "20 mm", "layers": [COVER, FOAM]}, "contact_length": "10 mm"}
COARSE = {"skin_edge": "0.5 mm", "steps": 2}
PLATE, CYLINDER = {"shape": "flat"}, {"shape": "cylinder", "curvature": "30 1/m"}


def scene_of(folder, specimen, stimulus=CYLINDER, motion=({"press_to_depth": "0.2 mm"},), **keys):
    document = {"specimen": specimen, "stimulus": stimulus, "motion": list(motion)}
    (folder / "scene.yaml").write_text(yaml.safe_dump({**document, "accuracy": COARSE, **keys}))
    return load_scene(folder / "scene.yaml")


def last_leg(scene):
    return summary(simulate(scene))["legs"][-1]


def stack(**given):
    slab = {"names": ("cover", "foam"), "thicknesses": (1e-3, 4e-3), "half_width": 10e-3}
    return SimpleNamespace(**slab | {"radius": None, "solid": False} | given)


HALF_ROUND = {"radius": 8e-3, "half_width": 8e-3, "thicknesses": (1e-3, 3e-3)}
SOLID = HALF_ROUND | {"thicknesses": (1e-3, 7e-3), "solid": True}


# -- meshes of one's own -------------------------------------------------------------------------

SIZE = MeshSize(skin_edge=0.5e-3, fine_half_width=3e-3, layer_edge=0.4e-3, growth=1.5)


def own(change=None, shift=0.0, grade=0.0, **given):
    """A slab or half-round as a mesh: graded by so many m, of other elements, shifted by so many
    m.
    """
    mesh = build_stack_mesh(stack(**given), SIZE)
    x = mesh.points[:, :1]
    mesh = replace(mesh, points=mesh.points + grade * np.sin(np.pi * x / x.max()) * [1, 0])
    mesh = change(mesh) if change else mesh
    return replace(mesh, points=mesh.points + [shift, 0.0], symmetric=False)


FIVE = {"names": tuple("abcde"), "thicknesses": (0.5e-3, 0.5e-3, 1e-3, 1e-3, 2e-3)}


def partly(mesh):
    return replace(mesh, curves=mesh.curves | {"skin": mesh.curves["skin"][3:-3]})


def around(mesh):
    right, left = np.split(mesh.curves["sides"], 2)
    skin = np.concatenate((left, mesh.curves["skin"], right))
    return replace(mesh, curves={"skin": skin, "base": mesh.curves["base"]})


VARIANTS = {
    "quad9": {},
    "quad4": {"change": linear},
    "tri6": {"change": triangles},
    "tri3": {"change": linear_triangles},
    "graded quad9": {"grade": 0.8e-3},
    "graded quad4": {"change": linear, "grade": 0.8e-3},
    "graded tri6": {"change": triangles, "grade": -0.5e-3},
    "graded tri3": {"change": linear_triangles, "grade": -0.5e-3},
    "off by 0.01 mm, quad9": {"shift": 1e-5},
    "off by 0.3 mm, quad9": {"shift": 3e-4},
    "off by 0.01 mm, tri6": {"change": triangles, "shift": 1e-5},
    "off by 0.3 mm, tri3": {"change": linear_triangles, "shift": -3e-4},
    "off by 0.3 mm, quad4": {"change": linear, "shift": 3e-4},
    "one layer of one's own": {"names": ("cover",), "thicknesses": (5e-3,)},
    "five layers": FIVE,
    "five layers, tri6": {"change": triangles, **FIVE},
    "half-round, quad9": SOLID,
    "half-round, tri3": {"change": linear_triangles, **HALF_ROUND},
    "part of the top is skin": {"change": partly},
    "skin goes round the corners": {"change": around},
}


def layers_of(*names):
    keys = "youngs_modulus", "poisson_ratio"
    return {name: {key: (FOAM if name == "foam" else COVER)[key] for key in keys} for name in names}


def own_specimen(folder, mesh, fixed=("base",), **keys):
    write_pad(mesh, folder / "own.msh")
    layers = layers_of(*mesh.regions)
    return {"mesh": "own.msh", "layers": layers, "fixed": list(fixed), **keys}


@pytest.mark.parametrize("name", VARIANTS)
def test_meshes_of_one_s_own(name, tmp_path):
    """Every one is read, planned and pressed; those of the same slab agree within 3 % (frozen:
    9-node quads).
    """
    mesh = own(**VARIANTS[name])
    scene = scene_of(tmp_path, own_specimen(tmp_path, mesh, contact_length="10 mm"))
    chosen = plan(scene)
    assert scene.specimen.assumed == ("prony: none, elastic",)
    said = chosen.specimen[0]
    assert said.startswith(f"a mesh of {mesh.element.replace('tri3', 'tri6')}, ")
    assert "; held: base; free: skin" in said
    assert ("boundary edges" in said) == ("sides" in mesh.curves)
    leg = last_leg(scene)
    assert leg["depth_mm"] == pytest.approx(0.2) and leg["force_N_per_m"] > 0
    assert 0.4 < chosen.contact.half_width / (leg["contact_width_mm"] / 2e3) < 2.5
    if mesh.regions == ("cover", "foam") and "half" not in name:
        assert leg["force_N_per_m"] == pytest.approx(18.207, rel=0.03)


def test_a_mesh_without_nail_and_with_eight_node_quads(tmp_path):
    path = write_rings(tmp_path / "rings.msh", "quad8", edit=renamed(nail=None))
    scene = scene_of(tmp_path, {"mesh": path.name})
    said = plan(scene).specimen
    assert said[0].endswith("held: bone; free: skin, 12 boundary edges in none of these curves")
    assert said[2] == "not given: layers, prony, contact_length: thesis"
    assert last_leg(scene)["force_N_per_m"] > 0


BOTH = layers_of("cover", "foam")
WRONG = {
    "surface without a material": (
        {"layers": layers_of("cover")},
        "surface elements are in none of cover; each must be in one (the mesh also has foam)",
    ),
    "layer that is no surface": (
        {"layers": layers_of("cover", "gel")},
        "layer gel is no surface of the mesh; its physical surfaces are cover, foam",
    ),
    "no materials at all": (
        {},
        "no material for cover, foam; specimen.layers must name each surface",
    ),
    "nothing held": ({"layers": BOTH, "fixed": [], "free": ["base"]}, "no curve is held"),
    "no such curve": ({"layers": BOTH, "fixed": ["bas"]}, "physical curves are"),
}


@pytest.mark.parametrize("name", WRONG)
def test_names_are_checked_both_ways(name, tmp_path):
    write_pad(own(), tmp_path / "own.msh")
    specimen, words = WRONG[name]
    with pytest.raises(MeshError) as caught:
        plan(scene_of(tmp_path, {"mesh": "own.msh", "fixed": ["base"], **specimen}))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_finger_s_layer_that_the_mesh_has_not(tmp_path):
    path = write_rings(tmp_path / "rings.msh", "tri3")
    specimen = {"mesh": path.name, "layers": {"stratum_corneum": {"youngs_modulus": "1 MPa"}}}
    with pytest.raises(MeshError, match="layer stratum_corneum is no surface of the mesh"):
        plan(scene_of(tmp_path, specimen))


# -- slabs and half-rounds of a scene ------------------------------------------------------------


def test_a_slab_says_what_was_not_given(tmp_path):
    layers = [{key: value for key, value in COVER.items() if key != "poisson_ratio"}, FOAM]
    scene = scene_of(tmp_path, {"slab": {"width": "20 mm", "layers": layers}})
    assert plan(scene).specimen == (
        "a slab 20 mm wide: cover 1 mm, foam 4 mm; held: base; free: skin, sides",
        "not given: poisson_ratio of cover: 0.48",
        "not given: prony: none, elastic",
        "not given: contact_length: 11.4 mm, thesis",
    )
    assert scene.outputs.receptors.depths == pytest.approx((0.5e-3, 3e-3))
    assert scene.specimen.prony == () and scene.specimen.materials["foam"].youngs_modulus == 50e3


def slab(*layers, width="9 mm"):
    return {"slab": {"width": width, "layers": list(layers)}}


NO_SLAB = {
    "no modulus": (
        slab({"name": "a", "thickness": "1 mm"}),
        "layers[0].youngs_modulus: is missing",
    ),
    "no thickness": (
        slab({"name": "a", "youngs_modulus": "1 Pa"}),
        "layers[0].thickness: is miss",
    ),
    "twice one name": (slab(COVER, COVER), "is the name of two layers"),
    "layers beside it": ({**SLAB, "layers": "thesis"}, "specimen.layers: is given beside a slab"),
    "too thick": (
        {"half_round": {"radius": "4 mm", "layers": [COVER, FOAM]}},
        "up to the radius, 4 mm",
    ),
    "two shapes": ({**SLAB, "outline": "thesis"}, "one of outline and slab"),
    "curves of no mesh": ({**SLAB, "fixed": ["base"]}, "names curves of no mesh"),
    "ridges": ({**SLAB, "ridges": "inner"}, "specimen.ridges: is given beside a slab"),
    "no layers": (slab(), "is empty"),
    "deeper than it is thick": (slab({**COVER, "thickness": "0.2 mm"}), "presses to the base"),
}


@pytest.mark.parametrize("name", NO_SLAB)
def test_wrong_slabs_are_one_line(name, tmp_path):
    specimen, words = NO_SLAB[name]
    with pytest.raises(SceneError) as caught:
        scene_of(tmp_path, specimen)
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("given", [SOLID, HALF_ROUND])
def test_a_half_round_is_a_half_round(given):
    mesh = build_stack_mesh(stack(**given), SIZE)
    assert quality_of(mesh)["worst_scaled_jacobian"] > 0.5
    assert mesh.symmetric and mesh.fixed == ("base",)
    radius = np.hypot(*mesh.points[np.unique(mesh.curves["skin"])].T)
    np.testing.assert_allclose(radius, 8e-3, rtol=1e-12)
    base = mesh.points[np.unique(mesh.curves["base"])]
    on_base = np.isclose(base[:, 1], 0.0, atol=1e-12) | np.isclose(np.hypot(*base.T), 4e-3)
    assert on_base.all() and len(places(mesh.points)) == len(mesh.points)
    thick = [
        (name, pytest.approx(deep))
        for name, deep in zip(mesh.regions, given["thicknesses"], strict=True)
    ]
    assert layers_below(mesh) == thick


def test_receptors_below_a_steep_skin_are_as_deep_along_its_normal():
    """On a half-round their distance from its middle is known; the skin that is nearest to them is
    well aside.
    """
    mesh = build_stack_mesh(stack(**SOLID), SIZE)
    depth, offset = np.array([0.3e-3, 1e-3, 1e-3, 2e-3]), np.array([5e-3, -5e-3, 0.0, 4e-3])
    found = below_skin(mesh, depth, offset)
    np.testing.assert_array_equal(found[:, 0], offset)
    # between points of the skin
    np.testing.assert_allclose(np.hypot(*found.T), 8e-3 - depth, rtol=0, atol=4e-6)


def test_receptors_below_a_flat_and_a_partial_skin():
    mesh = own()
    depth, offset = np.array([0.3e-3, 2e-3]), np.array([4e-3, -6e-3])
    np.testing.assert_allclose(
        below_skin(mesh, depth, offset), np.column_stack((offset, -depth)), rtol=0.02, atol=1e-9
    )
    partial = replace(mesh, curves=mesh.curves | {"skin": mesh.curves["skin"][8:-8]})
    end = np.abs(partial.points[partial.curves["skin"], 0]).max()
    said = r"there is no skin over x = 9.8 mm; allowed: offsets from -.* mm to .* mm"
    with pytest.raises(MeshError, match=said):
        below_skin(partial, 1e-3, [9.8e-3])
    assert below_skin(partial, 1e-3, [0.9 * end])[0, 1] == pytest.approx(-1e-3, rel=1e-3)


def test_a_plate_on_held_ends_is_refused(tmp_path):
    held = own_specimen(tmp_path, own(), ("base", "sides"))
    said = "comes down on the end of the skin at x = .*10 mm, which is held"
    with pytest.raises(PlanError, match=said):
        simulate(scene_of(tmp_path, held, PLATE))
    assert last_leg(scene_of(tmp_path, held))["force_N_per_m"] > 0


# -- against truth -------------------------------------------------------------------------------

SMALL = {"finite_strain": "off"}
BONDED = [layered.Layer(1e-3, 0.5e6 / 2.9, 0.45), layered.Layer(4e-3, 50e3 / 2.6, 0.3)]


@pytest.mark.verification
@pytest.mark.parametrize("control", ["depth", "force"])
def test_a_plate_on_a_bonded_stack(control, tmp_path):
    """In the middle of a wide slab a plate presses as on layers that cannot move sideways: p =
    depth / sum h (1-2nu)/(2mu(1-nu)).

    Wide against the length over which a stretched cover is held by the foam, sqrt(E h_cover h_foam
    / mu) = 10 mm.
    """
    wide = slab(COVER, FOAM, width="120 mm") | {"contact_length": "10 mm"}
    motion = [{"press_to_depth": "0.1 mm"}] if control == "depth" else [{"press_to_force": "60 gf"}]
    scene = scene_of(tmp_path, wide, PLATE, motion, effects=SMALL)
    leg, confined = last_leg(scene), layered.stack_compliance(0.0, BONDED)
    assert leg["centre_pressure_Pa"] == pytest.approx(leg["depth_mm"] * 1e-3 / confined, rel=2e-3)
    assert leg["contact_width_mm"] == pytest.approx(120.0, rel=2e-3)
    if control == "force":
        assert leg["force_N_per_m"] == pytest.approx(60 * 9.80665e-3 / 0.01, rel=1e-4)
    assert plan(scene).contact.depth == pytest.approx(leg["depth_mm"] * 1e-3, rel=0.15)


@pytest.mark.verification
def test_a_cylinder_on_a_bonded_stack(tmp_path):
    """A cylinder on a slab of two layers against the Fourier solution of :mod:`layered_contact`,
    and the planner against it.
    """
    radius, force = 20e-3, 20 * 9.80665e-3 / 0.01
    truth = layered_contact.press(lambda x: x**2 / (2 * radius), BONDED, 15e-3, force, 512)
    specimen = slab(COVER, FOAM, width="30 mm") | {"contact_length": "10 mm"}
    stimulus, motion = {"shape": "cylinder", "curvature": "50 1/m"}, [{"press_to_force": "20 gf"}]
    accuracy = {"skin_edge": "0.2 mm", "steps": 2}
    scene = scene_of(tmp_path, specimen, stimulus, motion, effects=SMALL, accuracy=accuracy)
    leg, estimate = last_leg(scene), plan(scene).contact
    assert leg["depth_mm"] == pytest.approx(truth.depth * 1e3, rel=0.01)
    assert leg["centre_pressure_Pa"] == pytest.approx(truth.pressure[0], rel=0.02)
    assert leg["contact_width_mm"] == pytest.approx(2e3 * truth.half_width, rel=0.03)
    assert estimate.depth == pytest.approx(truth.depth, rel=0.05)
    assert estimate.half_width == pytest.approx(truth.half_width, rel=0.2)


def test_a_plate_slides_over_a_slab_with_friction(tmp_path):
    """Once all of it slips the lateral force is the coefficient times the normal one."""
    motion = [{"press_to_force": "20 gf"}, {"slide": "2 mm"}]
    accuracy = {"skin_edge": "1 mm", "steps": 8}
    scene = scene_of(tmp_path, SLAB, PLATE, motion, friction=0.3, accuracy=accuracy)
    history = simulate(scene).isel(time=-1)
    assert (history.contact_state.values == 2).all()
    lateral = abs(float(history.tangential_force))
    assert lateral == pytest.approx(0.3 * float(history.force), rel=1e-3)


@pytest.mark.parametrize("thicknesses", [(5e-3,), (1e-3, 4e-3), (0.2e-3, 5e-3)])
@pytest.mark.parametrize("radius", [1e-3, 50e-3])
def test_the_estimate_of_a_stack(thicknesses, radius):
    """Half widths within a third and depths within a twentieth of the Fourier solution, from knife
    to plate.
    """
    known = list(zip(thicknesses, (0.1e6, 20e3), (0.48, 0.3), strict=False))
    estimate = StackEstimate(1e3, thicknesses[0], sum(thicknesses), 1.0, 1.0, 20e-3, tuple(known))
    layers = [layered.Layer(thick, modulus / (2 * (1 + nu)), nu) for thick, modulus, nu in known]
    truth = layered_contact.press(lambda x: x**2 / (2 * radius), layers, 20e-3, 10.0, 400)
    found = estimate.pressed(10.0, 1 / radius)
    assert found.depth == pytest.approx(truth.depth, rel=0.05)
    assert found.half_width == pytest.approx(truth.half_width, rel=0.33)
    again = estimate.pressed_to(found.depth, 1 / radius)
    assert again.half_width == pytest.approx(found.half_width, rel=1e-3)
    plate = estimate.pressed(10.0, 0.0)
    assert plate.half_width == estimate.pressed_to(1e-3, 0.0).half_width == 20e-3
    assert 0 < plate.depth < found.depth


def test_the_robot_s_skin_runs():
    leg = last_leg(load_scene(EXAMPLES / "robot_skin.yaml"))
    assert leg["force_N_per_m"] == pytest.approx(50 * 9.80665e-3 / 0.01, rel=1e-4)


def test_a_written_slab_is_read_again(tmp_path):
    mesh = own()
    again = read_back(mesh, tmp_path)
    assert again.regions == mesh.regions and again.fixed == mesh.fixed and again.symmetric
    np.testing.assert_allclose(again.points, mesh.points, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(again.cells, mesh.cells)


def test_a_thin_epidermis_needs_no_stratum_corneum(tmp_path):
    """The thesis's stratum corneum is thicker, and no layer of this pad."""
    scene = scene_of(tmp_path, {"outline": {"epidermis_thickness": "0.3 mm"}})
    outline = scene.specimen.outline
    assert outline.stratum_corneum_thickness > outline.epidermis_thickness
    assert plan(scene).nodes > 0

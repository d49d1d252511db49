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
from fingerpad.specimen import MeshError, MeshSize, quality_of, read_pad_mesh, write_pad
from fingerpad.specimen.measures import below_skin, layers_below
from fingerpad.specimen.stacks import build_stack_mesh
from test_external_scenes import linear, linear_triangles, triangles
from test_mesh import write_rings

pytestmark = pytest.mark.unit

EXAMPLES = Path(__file__).parents[1] / "config" / "scenes" / "examples"
COVER = {"name": "cover", "thickness": "1 mm", "youngs_modulus": "0.5 MPa", "poisson_ratio": 0.45}
FOAM = {"name": "foam", "thickness": "4 mm", "youngs_modulus": "50 kPa", "poisson_ratio": 0.3}
SLAB = {"slab": {"width": "20 mm", "layers": [COVER, FOAM]}, "contact_length": "10 mm"}
COARSE = {"skin_edge": "0.5 mm", "steps": 2}
PLATE, CYLINDER = {"shape": "flat"}, {"shape": "cylinder", "curvature": "30 1/m"}


def scene_of(folder, specimen, stimulus=CYLINDER, motion=({"press_to_depth": "0.2 mm"},), **keys):
    document = {
        "specimen": specimen,
        "stimulus": stimulus,
        "motion": list(motion),
        "accuracy": COARSE,
        **keys,
    }
    (folder / "scene.yaml").write_text(yaml.safe_dump(document))
    return load_scene(folder / "scene.yaml")


def last_leg(scene):
    return summary(simulate(scene))["legs"][-1]


def stack(
    names=("cover", "foam"), thicknesses=(1e-3, 4e-3), half_width=10e-3, radius=None, solid=False
):
    return SimpleNamespace(
        names=names, thicknesses=thicknesses, half_width=half_width, radius=radius, solid=solid
    )


# -- meshes of one's own -------------------------------------------------------------------------

SIZE = MeshSize(skin_edge=0.5e-3, fine_half_width=3e-3, layer_edge=0.4e-3, growth=1.5)


def own(change=None, names=("cover", "foam"), shift=0.0, grade=None, **kwargs):
    mesh = build_stack_mesh(stack(names, **kwargs), SIZE)
    if grade:
        x = mesh.points[:, 0]
        mesh = replace(
            mesh,
            points=np.column_stack((x + grade * np.sin(np.pi * x / x.max()), mesh.points[:, 1])),
        )
    made = change(mesh) if change else mesh
    points = made.points + [shift, 0.0]
    return replace(made, points=points, regions=mesh.regions, fixed=mesh.fixed, symmetric=False)


def five():
    return own(names=tuple("abcde"), thicknesses=(0.5e-3, 0.5e-3, 1e-3, 1e-3, 2e-3))


VARIANTS = {
    "quad9": lambda: own(),
    "quad4": lambda: own(linear),
    "tri6": lambda: own(triangles),
    "tri3": lambda: own(linear_triangles),
    "graded quad9": lambda: own(grade=0.8e-3),
    "graded quad4": lambda: own(linear, grade=0.8e-3),
    "graded tri6": lambda: own(triangles, grade=-0.5e-3),
    "graded tri3": lambda: own(linear_triangles, grade=-0.5e-3),
    "off by 0.01 mm, quad9": lambda: own(shift=1e-5),
    "off by 0.3 mm, quad9": lambda: own(shift=3e-4),
    "off by 0.01 mm, tri6": lambda: own(triangles, shift=1e-5),
    "off by 0.3 mm, tri3": lambda: own(linear_triangles, shift=-3e-4),
    "off by 0.3 mm, quad4": lambda: own(linear, shift=3e-4),
    "one layer of one's own": lambda: own(names=("cover",), thicknesses=(5e-3,)),
    "five layers": five,
    "five layers, tri6": lambda: (
        lambda mesh: replace(triangles(mesh), regions=mesh.regions, fixed=mesh.fixed)
    )(five()),
    "half-round, quad9": lambda: own(
        radius=8e-3, half_width=8e-3, thicknesses=(1e-3, 7e-3), solid=True
    ),
    "half-round, tri3": lambda: own(
        linear_triangles, radius=8e-3, half_width=8e-3, thicknesses=(1e-3, 3e-3)
    ),
    "part of the top is skin": lambda: (
        lambda mesh: replace(mesh, curves=mesh.curves | {"skin": mesh.curves["skin"][3:-3]})
    )(own()),
    "skin goes round the corners": lambda: around(own()),
}


def around(mesh):
    right, left = np.split(mesh.curves["sides"], 2)
    skin = np.concatenate((left, mesh.curves["skin"], right))
    return replace(mesh, curves={"skin": skin, "base": mesh.curves["base"]})


def material(name):
    return {
        key: (FOAM if name == "foam" else COVER)[key] for key in ("youngs_modulus", "poisson_ratio")
    }


@pytest.mark.parametrize("name", VARIANTS)
def test_meshes_of_one_s_own(name, tmp_path):
    """Every one is read, planned and pressed; those of the same slab agree within 3 % (frozen:
    9-node quads).
    """
    mesh = VARIANTS[name]()
    write_pad(mesh, tmp_path / "own.msh")
    layers = {region: material(region) for region in mesh.regions}
    scene = scene_of(
        tmp_path,
        {"mesh": "own.msh", "layers": layers, "fixed": ["base"], "contact_length": "10 mm"},
    )
    chosen = plan(scene)
    assert scene.specimen.assumed == ("prony: none, elastic",)
    assert chosen.specimen[0].startswith(f"a mesh of {mesh.element.replace('tri3', 'tri6')}, ")
    assert "; held: base; free: skin" in chosen.specimen[0] and (
        "boundary edges" in chosen.specimen[0]
    ) == ("sides" in mesh.curves)
    leg = last_leg(scene)
    assert leg["depth_mm"] == pytest.approx(0.2) and leg["force_N_per_m"] > 0
    assert 0.4 < chosen.contact.half_width / (leg["contact_width_mm"] / 2e3) < 2.5
    if mesh.regions == ("cover", "foam") and "half" not in name:
        assert leg["force_N_per_m"] == pytest.approx(18.207, rel=0.03)


def test_a_mesh_without_nail_and_with_eight_node_quads(tmp_path):
    path = write_rings(
        tmp_path / "rings.msh",
        "quad8",
        edit=lambda groups: [group for group in groups if group[2] != "nail"],
    )
    scene = scene_of(tmp_path, {"mesh": path.name})
    assert (
        plan(scene)
        .specimen[0]
        .endswith("held: bone; free: skin, 12 boundary edges in none of these curves")
    )
    assert plan(scene).specimen[2] == "not given: layers, prony, contact_length: thesis"
    assert last_leg(scene)["force_N_per_m"] > 0


WRONG = {
    "surface without a material": (
        {"layers": {"cover": material("cover")}, "fixed": ["base"]},
        "26",
    ),
    "layer that is no surface": (
        {"layers": {"cover": material("cover"), "gel": material("foam")}, "fixed": ["base"]},
        "layer gel is no surface of the mesh; its physical surfaces are cover, foam",
    ),
    "no materials at all": (
        {"fixed": ["base"]},
        "no material for cover, foam; specimen.layers must name each surface",
    ),
    "nothing held": (
        {"layers": {"cover": material("cover"), "foam": material("foam")}, "free": ["base"]},
        "no curve is held",
    ),
    "no such curve": (
        {"layers": {"cover": material("cover"), "foam": material("foam")}, "fixed": ["bas"]},
        "physical curves are",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_names_are_checked_both_ways(name, tmp_path):
    write_pad(own(), tmp_path / "own.msh")
    specimen, words = WRONG[name]
    if name == "surface without a material":
        words = (
            "surface elements are in none of cover; each must be in one (the mesh also has foam)"
        )
    with pytest.raises(MeshError) as caught:
        plan(scene_of(tmp_path, {"mesh": "own.msh", **specimen}))
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_finger_s_layer_that_the_mesh_has_not(tmp_path):
    path = write_rings(tmp_path / "rings.msh", "tri3")
    scene = scene_of(
        tmp_path, {"mesh": path.name, "layers": {"stratum_corneum": {"youngs_modulus": "1 MPa"}}}
    )
    with pytest.raises(MeshError, match="layer stratum_corneum is no surface of the mesh"):
        plan(scene)


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


NO_SLAB = {
    "no modulus": (
        {"slab": {"width": "9 mm", "layers": [{"name": "a", "thickness": "1 mm"}]}},
        "layers[0].youngs_modulus: is missing",
    ),
    "no thickness": (
        {"slab": {"width": "9 mm", "layers": [{"name": "a", "youngs_modulus": "1 Pa"}]}},
        "layers[0].thickness: is miss",
    ),
    "twice one name": (
        {"slab": {"width": "9 mm", "layers": [COVER, COVER]}},
        "is the name of two layers",
    ),
    "layers beside it": ({**SLAB, "layers": "thesis"}, "specimen.layers: is given beside a slab"),
    "too thick": (
        {"half_round": {"radius": "4 mm", "layers": [COVER, FOAM]}},
        "up to the radius, 4 mm",
    ),
    "two shapes": ({**SLAB, "outline": "thesis"}, "one of outline and slab"),
    "curves of no mesh": ({**SLAB, "fixed": ["base"]}, "names curves of no mesh"),
    "ridges": ({**SLAB, "ridges": "inner"}, "specimen.ridges: is given beside a slab"),
    "no layers": ({"slab": {"width": "9 mm", "layers": []}}, "is empty"),
    "deeper than it is thick": (
        {"slab": {"width": "9 mm", "layers": [{**COVER, "thickness": "0.2 mm"}]}},
        "presses to the base",
    ),
}


@pytest.mark.parametrize("name", NO_SLAB)
def test_wrong_slabs_are_one_line(name, tmp_path):
    specimen, words = NO_SLAB[name]
    with pytest.raises(SceneError) as caught:
        scene_of(tmp_path, specimen)
    assert words in str(caught.value) and len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("solid", [True, False])
def test_a_half_round_is_a_half_round(solid):
    made = stack(
        radius=8e-3, half_width=8e-3, thicknesses=(1e-3, 7e-3 if solid else 3e-3), solid=solid
    )
    mesh = build_stack_mesh(made, SIZE)
    assert (
        quality_of(mesh)["worst_scaled_jacobian"] > 0.5
        and mesh.symmetric
        and mesh.fixed == ("base",)
    )
    radius = np.hypot(*mesh.points[np.unique(mesh.curves["skin"])].T)
    np.testing.assert_allclose(radius, 8e-3, rtol=1e-12)
    base = mesh.points[np.unique(mesh.curves["base"])]
    on_base = np.isclose(base[:, 1], 0.0, atol=1e-12) | np.isclose(np.hypot(*base.T), 4e-3)
    assert on_base.all() and len({tuple(point) for point in mesh.points}) == len(mesh.points)
    assert layers_below(mesh) == [
        ("cover", pytest.approx(1e-3)),
        ("foam", pytest.approx(7e-3 if solid else 3e-3)),
    ]


def test_receptors_below_a_steep_skin_are_as_deep_along_its_normal():
    """On a half-round their distance from its middle is known; the skin that is nearest to them is
    well aside.
    """
    mesh = build_stack_mesh(
        stack(radius=8e-3, half_width=8e-3, thicknesses=(1e-3, 7e-3), solid=True), SIZE
    )
    depth, offset = np.array([0.3e-3, 1e-3, 1e-3, 2e-3]), np.array([5e-3, -5e-3, 0.0, 4e-3])
    found = below_skin(mesh, depth, offset)
    np.testing.assert_array_equal(found[:, 0], offset)
    np.testing.assert_allclose(
        np.hypot(*found.T), 8e-3 - depth, rtol=0, atol=4e-6
    )  # between points of the skin


def test_receptors_below_a_flat_and_a_partial_skin():
    mesh = own()
    depth, offset = np.array([0.3e-3, 2e-3]), np.array([4e-3, -6e-3])
    np.testing.assert_allclose(
        below_skin(mesh, depth, offset), np.column_stack((offset, -depth)), rtol=0.02, atol=1e-9
    )
    partial = replace(mesh, curves=mesh.curves | {"skin": mesh.curves["skin"][8:-8]})
    end = np.abs(partial.points[partial.curves["skin"], 0]).max()
    with pytest.raises(
        MeshError, match=r"there is no skin over x = 9.8 mm; allowed: offsets from -.* mm to .* mm"
    ):
        below_skin(partial, 1e-3, [9.8e-3])
    assert below_skin(partial, 1e-3, [0.9 * end])[0, 1] == pytest.approx(-1e-3, rel=1e-3)


def test_a_plate_on_held_ends_is_refused(tmp_path):
    write_pad(own(), tmp_path / "own.msh")
    layers = {name: material(name) for name in ("cover", "foam")}
    scene = scene_of(
        tmp_path, {"mesh": "own.msh", "layers": layers, "fixed": ["base", "sides"]}, PLATE
    )
    with pytest.raises(
        PlanError, match="comes down on the end of the skin at x = .*10 mm, which is held"
    ):
        simulate(scene)
    assert (
        last_leg(
            scene_of(tmp_path, {"mesh": "own.msh", "layers": layers, "fixed": ["base", "sides"]})
        )["force_N_per_m"]
        > 0
    )


# -- against truth -------------------------------------------------------------------------------

SMALL = {"finite_strain": "off"}


@pytest.mark.verification
@pytest.mark.parametrize("control", ["depth", "force"])
def test_a_plate_on_a_bonded_stack(control, tmp_path):
    """In the middle of a wide slab a plate presses as on layers that cannot move sideways: p =
    depth / sum h (1-2nu)/(2mu(1-nu)).

    Wide against the length over which a stretched cover is held by the foam, sqrt(E h_cover h_foam
    / mu) = 10 mm.
    """
    wide = {**SLAB, "slab": {"width": "120 mm", "layers": [COVER, FOAM]}}
    motion = [{"press_to_depth": "0.1 mm"}] if control == "depth" else [{"press_to_force": "60 gf"}]
    scene = scene_of(tmp_path, wide, PLATE, motion, effects=SMALL)
    leg = last_leg(scene)
    confined = layered.stack_compliance(
        0.0, [layered.Layer(1e-3, 0.5e6 / 2.9, 0.45), layered.Layer(4e-3, 50e3 / 2.6, 0.3)]
    )
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
    layers = [layered.Layer(1e-3, 0.5e6 / 2.9, 0.45), layered.Layer(4e-3, 50e3 / 2.6, 0.3)]
    truth = layered_contact.press(lambda x: x**2 / (2 * radius), layers, 15e-3, force, 512)
    specimen = {**SLAB, "slab": {"width": "30 mm", "layers": [COVER, FOAM]}}
    stimulus, motion = {"shape": "cylinder", "curvature": "50 1/m"}, [{"press_to_force": "20 gf"}]
    scene = scene_of(
        tmp_path,
        specimen,
        stimulus,
        motion,
        effects=SMALL,
        accuracy={"skin_edge": "0.2 mm", "steps": 2},
    )
    leg, estimate = last_leg(scene), plan(scene).contact
    assert leg["depth_mm"] == pytest.approx(truth.depth * 1e3, rel=0.01)
    assert leg["centre_pressure_Pa"] == pytest.approx(truth.pressure[0], rel=0.02)
    assert leg["contact_width_mm"] == pytest.approx(2e3 * truth.half_width, rel=0.03)
    assert estimate.depth == pytest.approx(
        truth.depth, rel=0.05
    ) and estimate.half_width == pytest.approx(truth.half_width, rel=0.2)


def test_a_plate_slides_over_a_slab_with_friction(tmp_path):
    """Once all of it slips the lateral force is the coefficient times the normal one."""
    motion = [{"press_to_force": "20 gf"}, {"slide": "2 mm"}]
    history = simulate(
        scene_of(
            tmp_path, SLAB, PLATE, motion, friction=0.3, accuracy={"skin_edge": "1 mm", "steps": 8}
        )
    )
    assert (history.contact_state[-1].values == 2).all()
    assert abs(float(history.tangential_force[-1])) == pytest.approx(
        0.3 * float(history.force[-1]), rel=1e-3
    )


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
    assert estimate.pressed_to(found.depth, 1 / radius).half_width == pytest.approx(
        found.half_width, rel=1e-3
    )
    plate = estimate.pressed(10.0, 0.0)
    assert (
        plate.half_width == 20e-3
        and 0 < plate.depth < found.depth
        and estimate.pressed_to(1e-3, 0.0).half_width == 20e-3
    )


def test_the_robot_s_skin_runs():
    leg = last_leg(load_scene(EXAMPLES / "robot_skin.yaml"))
    assert leg["force_N_per_m"] == pytest.approx(50 * 9.80665e-3 / 0.01, rel=1e-4)


def test_a_written_slab_is_read_again(tmp_path):
    mesh = own()
    write_pad(mesh, tmp_path / "slab.msh")
    again = read_pad_mesh(tmp_path / "slab.msh")
    assert again.regions == mesh.regions and again.fixed == mesh.fixed and again.symmetric
    np.testing.assert_allclose(again.points, mesh.points, rtol=0, atol=1e-15)
    np.testing.assert_array_equal(again.cells, mesh.cells)


def test_a_thin_epidermis_needs_no_stratum_corneum(tmp_path):
    """The thesis's stratum corneum is thicker, and no layer of this pad."""
    scene = scene_of(tmp_path, {"outline": {"epidermis_thickness": "0.3 mm"}})
    assert (
        scene.specimen.outline.stratum_corneum_thickness
        > scene.specimen.outline.epidermis_thickness
    )
    assert plan(scene).nodes > 0

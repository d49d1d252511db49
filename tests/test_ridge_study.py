"""What a receptor feels of direction over ridges: the index, the mirror identity it rests on,
cases, frames and rows.
"""

import itertools
import json
from pathlib import Path

import numpy as np
import pytest

import synthetic
from cysyk1999.claims.comparison import TRENDS
from cysyk1999.measures.direction import BESIDE, DEPTH, KEY, both_ways, directional_index, islands
from cysyk1999.measures.table import Measures
from cysyk1999.studies.ridges import frames as ridge_frames
from cysyk1999.studies.ridges import picture
from cysyk1999.studies.ridges.run import (
    AS_DRAWN,
    FLANK,
    GRID,
    Case,
    boundary,
    case_scene,
    ridges_drawn,
)
from fingerpad import load_scene, plan, simulate
from fingerpad.measures.features import energy
from fingerpad.results import scene_of
from fingerpad.scenes.scene import Receptors, Slide
from fingerpad.scenes.specimen import Specimen
from fingerpad.specimen import RidgedPad, mesh_for, quality_of

pytestmark = pytest.mark.unit
SCENES = Path(__file__).parents[1] / "config" / "scenes"
OUTLINE = Specimen().outline


@pytest.fixture(scope="module")
def base():
    return load_scene(SCENES / "ridged_stroke_right.yaml")


@pytest.fixture(scope="module")
def made():
    return synthetic.histories()


# -- the index ------------------------------------------------------------------------------------


def test_index_is_the_contrast_of_the_two_ways(made):
    """Made up: 300 Pa one way, 100 Pa the other at 46 um; the same both ways without ridges."""
    ridged = made["ridged_stroke_right"]
    assert directional_index(ridged, DEPTH, -BESIDE) == pytest.approx(0.5)
    assert directional_index(ridged, DEPTH, BESIDE) == pytest.approx(-0.5)
    assert directional_index(ridged, DEPTH, 0.0) == 0.0
    assert directional_index(made["plate_stroke_right"], DEPTH, -BESIDE) == 0.0
    with pytest.raises(KeyError, match="no receptor at depth 800 um"):
        directional_index(ridged, 800e-6, 0.0)


LEFT_OUT = 5e-4
"""A quarter of the force that a draft stroke may leave out of balance: how energies differ by it
depends on the processor.
"""


def test_strokes_to_either_side_are_mirror_images(base):
    """The identity that lets one stroke stand for two, simulated once on a draft mesh."""
    depths, offsets = (600e-6, DEPTH, 935e-6), (-120e-6, -BESIDE, 0.0, BESIDE, 120e-6)
    draft = base.with_accuracy("draft").varied(
        {"outputs.receptors": Receptors(depths=depths, offsets=offsets)}
    )
    right, left = (
        simulate(draft.varied({"motion": (draft.motion[0], Slide(slide=x, speed=10e-3))}))
        for x in (-3e-3, 3e-3)
    )
    for depth, x in itertools.product(depths, offsets):
        mirrored = energy(left, depth, -x)
        np.testing.assert_allclose(energy(right, depth, x), mirrored, rtol=LEFT_OUT)
    found, mirrored = both_ways(right, DEPTH, -BESIDE)
    other = energy(left, DEPTH, -BESIDE)[-len(mirrored) :]
    np.testing.assert_allclose(mirrored, other, rtol=LEFT_OUT)
    assert directional_index(right, DEPTH, -BESIDE) > 0.2 and (found > 1.5 * mirrored).all()


def test_islands_are_counted(made):
    history = made["ridged_40_flat"].isel(time=[-1])
    pressure = history.contact_pressure.values
    for touching, count in (([], 0), ([5, 6], 1), ([0, 5, 6, 8], 3)):
        pressure[:] = 0
        pressure[0, touching] = 1.0
        assert islands(history)[0] == count


def bends(mesh, corners=None):
    """Nodes (n, 2) where the epidermis ends near the apex; only corners, if so many are given."""
    layers = [mesh.region == mesh.regions.index(name) for name in ("epidermis", "dermis")]
    nodes = np.intersect1d(*(mesh.cells[layer, :corners] for layer in layers))
    points = mesh.points[nodes]
    return points[(np.abs(points[:, 0]) < 0.3e-3) & (points[:, 1] > 0)]


def check_boundary(ridges, points, error):
    """Whether points lie at the depth that `boundary` says."""
    curve = RidgedPad(OUTLINE, ridges).curve
    assert len(points)
    for x, height in points:
        depth = boundary(OUTLINE, ridges, x)
        theta = curve.theta_at(x / (1 - depth / OUTLINE.apex_radius))
        assert curve.point(theta, depth)[0, 1] == pytest.approx(height, abs=error)


def test_boundary_is_where_the_mesh_has_it(base):
    check_boundary(base.specimen.ridges, bends(mesh_for(base, plan(base))), 0.5e-6)
    assert boundary(OUTLINE, None, 0.1e-3) == OUTLINE.epidermis_thickness


# -- cases ----------------------------------------------------------------------------------------


def test_cases_are_named_and_vary_what_they_say(base):
    for name in ("75_0.35_coarse", "150_1_thesis", "0_0.35_thesis"):
        assert str(Case.named(name)) == name
    higher = case_scene(base, Case(300, 0.65, "thesis"))
    assert higher.specimen.ridges.inner.height == pytest.approx(0.3e-3) and higher.friction == 0.65
    assert higher.specimen.ridges.inner.pitch == base.specimen.ridges.inner.pitch
    assert case_scene(base, Case(0, 0.65, "thesis")).specimen.ridges is None
    fine, coarse = (case_scene(base, Case(150, 0.65, mesh)) for mesh in ("fine", "coarse"))
    assert plan(fine).nodes > 4 * plan(coarse).nodes
    assert plan(fine).steps == plan(coarse).steps


@pytest.mark.parametrize("name", AS_DRAWN)
def test_ridges_drawn_on_the_thesiss_elements(base, name):
    """The plain mesh's elements with the boundary moved onto the ridges: at its corners, or all
    along it.
    """
    asked = case_scene(base, Case(*KEY, name))
    chosen, ridges = plan(asked), asked.specimen.ridges
    plain = mesh_for(asked, chosen)
    drawn = ridges_drawn(plain, asked.specimen.outline, ridges, AS_DRAWN[name][0])
    assert not chosen.effects["ridges"].on and len(drawn.points) == len(plain.points)
    assert quality_of(drawn)["worst_scaled_jacobian"] > 0.3
    skin = np.unique(plain.curves["skin"])
    np.testing.assert_array_equal(drawn.points[skin], plain.points[skin])
    check_boundary(ridges, bends(drawn, corners=4), 1e-6)
    moved = np.hypot(*(drawn.points - plain.points).T)
    assert 50e-6 < moved.max() < 80e-6


# -- frames and rows ------------------------------------------------------------------------------


def test_frames_are_drawn_from_themselves(made):
    """Made-up cases of every kind: each frame has its curves, and each picture is drawn."""
    stroke = made["ridged_stroke_right"].assign_attrs(cost=json.dumps({"nodes": 10}))
    scene = json.loads(stroke.attrs["scene"])
    depths, offsets = {*GRID[0], DEPTH}, sorted({*GRID[1], -BESIDE, BESIDE, -FLANK, FLANK})
    cases = {}
    for height, mesh in itertools.product((0, 150, 300), ("thesis", "coarse", "fine", *AS_DRAWN)):
        inner = {**synthetic.RIDGES["inner"], "height": height * 1e-6}
        ridges = "none" if not height else synthetic.RIDGES | {"inner": inner}
        own = scene | {"specimen": scene["specimen"] | {"ridges": ridges}}
        history = cases[f"{height}_0.35_{mesh}"] = stroke.assign_attrs(scene=json.dumps(own))
        depths |= {depth for depth, _ in ridge_frames.places(history).values()}

    def felt(z, x):
        return 100 * (2 - np.clip(x / BESIDE, -1, 1)) * np.ones((stroke.sizes["time"], 1))

    for name, history in cases.items():
        cases[name] = synthetic._receptors(history, sorted(depths), offsets, felt)
    assert scene_of(cases["0_0.35_thesis"]).specimen.ridges is None
    frames = {name: make(cases) for name, make in ridge_frames.FRAMES.items()}
    profile = frames["offset"].query("series == 'inner ridges' and panel == 'profile'")
    beside = profile.set_index(picture.OFFSET).loc[-46.0, picture.INDEX]
    assert beside == pytest.approx(0.5)
    thesis = frames["height"][frames["height"]["series"].str.startswith("thesis")]
    layers = thesis.set_index(picture.HEIGHT)["layer"].to_dict()
    assert layers == {0: "dermis", 150: "dermis", 300: "epidermis"}
    meshes = ["coarse", "thesis", "fine", "curved", "straight", "shifted"]
    assert list(frames["mesh"]["series"]) == meshes and set(frames) == set(picture.STUDIES)
    for name, draw in picture.STUDIES.items():
        draw(frames[name])


def test_rows_hold_for_what_was_made_up_to_show_them(made):
    m = Measures.of(made)
    for id_ in ("T321", *(f"TR{number}" for number in range(43, 52))):
        assert TRENDS[id_](m).holds, id_
    assert m("highest_of_three", "ridged_stroke_right") == pytest.approx(300)
    assert m("held_force", "ridged_stroke_right") == 20


def _times(factor):
    return lambda h: h.assign(strain_energy_density=factor * h.strain_energy_density)


def _stroke_of(name):
    return lambda h: synthetic.plate_stroke(name)


def _backwards(history):
    values = history.strain_energy_density
    return history.assign(strain_energy_density=values.copy(data=values.values[::-1]))


@pytest.mark.parametrize(
    ("id_", "scene", "mutant"),
    [
        ("TR45", "ridged_40_k1260", _times(0.5)),
        ("TR44", "ridged_40_k79", _times(9)),
        ("TR43", "ridged_40_k210", _backwards),
        ("TR47", "plate_stroke_right", _stroke_of("ridged_stroke_right")),
        ("T321", "ridged_stroke_right", _stroke_of("plate_stroke_right")),
        ("TR49", "ridged_stroke_right", _times(0.3)),
        ("TR49a", "ridged_stroke_left", _times(3)),
        ("TR50", "ridged_outer_stroke_right", _stroke_of("plate_stroke_right")),
        ("TR51", "ridged_outer_stroke_right", lambda h: h.assign(cutbacks=h.cutbacks + 1)),
    ],
)
def test_rows_fail_for_mutants(made, id_, scene, mutant):
    assert not TRENDS[id_](Measures.of(made | {scene: mutant(made[scene])})).holds

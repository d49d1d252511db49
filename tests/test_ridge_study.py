"""What a receptor feels of direction over ridges: the index, the mirror identity it rests on,
cases, frames and rows.
"""

import json
from pathlib import Path

import numpy as np
import pytest

import synthetic
from cysyk1999.claims.comparison import TRENDS
from cysyk1999.measures.direction import BESIDE, DEPTH, KEY, both_ways, directional_index, islands
from cysyk1999.measures.table import Measures
from cysyk1999.studies.ridges import frames as ridge_frames
from cysyk1999.studies.ridges import picture as ridge_study
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
    draft = base.with_accuracy("draft")
    offsets = (-120e-6, -BESIDE, 0.0, BESIDE, 120e-6)
    outputs = draft.outputs.model_copy(
        update={"receptors": Receptors(depths=(600e-6, DEPTH, 935e-6), offsets=offsets)}
    )
    right, left = (
        simulate(
            draft.model_copy(
                update={
                    "motion": (draft.motion[0], Slide(slide=x, speed=10e-3)),
                    "outputs": outputs,
                }
            )
        )
        for x in (-3e-3, 3e-3)
    )
    for depth in (600e-6, DEPTH, 935e-6):
        for x in offsets:
            np.testing.assert_allclose(
                energy(right, depth, x), energy(left, depth, -x), rtol=LEFT_OUT
            )
    found, mirrored = both_ways(right, DEPTH, -BESIDE)
    np.testing.assert_allclose(
        mirrored, energy(left, DEPTH, -BESIDE)[-len(mirrored) :], rtol=LEFT_OUT
    )
    assert directional_index(right, DEPTH, -BESIDE) > 0.3 and (found > 1.5 * mirrored).all()


def test_islands_are_counted(made):
    history = made["ridged_40_flat"].isel(time=[-1])
    pressure = history.contact_pressure.values
    for touching, count in (([], 0), ([5, 6], 1), ([0, 5, 6, 8], 3)):
        pressure[:] = 0
        pressure[0, touching] = 1.0
        assert islands(history)[0] == count


def test_boundary_is_where_the_mesh_has_it(base):
    mesh = mesh_for(base, plan(base))
    layers = [
        np.unique(mesh.cells[mesh.region == mesh.regions.index(name)])
        for name in ("epidermis", "dermis")
    ]
    x, y = mesh.points[np.intersect1d(*layers)].T
    near = np.flatnonzero((np.abs(x) < 0.3e-3) & (y > 0))
    pad = RidgedPad(OUTLINE, base.specimen.ridges)
    for at, height in zip(x[near], y[near], strict=True):
        depth = boundary(OUTLINE, base.specimen.ridges, at)
        theta = pad.curve.theta_at(at / (1 - depth / OUTLINE.apex_radius))
        assert pad.curve.point(theta, depth)[0, 1] == pytest.approx(height, abs=0.5e-6)
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
    chosen = plan(asked)
    plain = mesh_for(asked, chosen)
    straight = AS_DRAWN[name][0]
    drawn = ridges_drawn(plain, asked.specimen.outline, asked.specimen.ridges, straight)
    assert not chosen.effects["ridges"].on and len(drawn.points) == len(plain.points)
    assert quality_of(drawn)["worst_scaled_jacobian"] > 0.3
    np.testing.assert_array_equal(
        drawn.points[np.unique(drawn.curves["skin"])], plain.points[np.unique(plain.curves["skin"])]
    )
    corners = [
        np.unique(drawn.cells[drawn.region == drawn.regions.index(n), :4])
        for n in ("epidermis", "dermis")
    ]
    x, y = drawn.points[np.intersect1d(*corners)].T
    pad = RidgedPad(OUTLINE, asked.specimen.ridges)
    for at, height in zip(x, y, strict=True):
        if abs(at) < 0.4e-3 and height > 0:
            depth = boundary(OUTLINE, asked.specimen.ridges, at)
            assert pad.curve.point(
                pad.curve.theta_at(at / (1 - depth / OUTLINE.apex_radius)), depth
            )[0, 1] == pytest.approx(height, abs=1e-6)
    moved = np.hypot(*(drawn.points - plain.points).T)
    assert 50e-6 < moved.max() < 80e-6


# -- frames and rows ------------------------------------------------------------------------------


def test_frames_are_drawn_from_themselves(made):
    """Made-up cases of every kind: each frame has its curves, and each picture is drawn."""
    stroke = made["ridged_stroke_right"]
    scene = json.loads(stroke.attrs["scene"])
    cases = {}
    for height in (0, 150, 300):
        for mesh in ("thesis", "coarse", "fine", *AS_DRAWN):
            inner = {**synthetic.RIDGES["inner"], "height": height * 1e-6}
            ridges = "none" if not height else synthetic.RIDGES | {"inner": inner}
            own = scene | {"specimen": scene["specimen"] | {"ridges": ridges}}
            cases[f"{height}_0.35_{mesh}"] = stroke.assign_attrs(
                scene=json.dumps(own), cost=json.dumps({"nodes": 10})
            )
    depths = {*GRID[0], DEPTH}
    for history in cases.values():
        depths |= {depth for depth, _ in ridge_frames.places(history).values()}
    offsets = sorted({*GRID[1], -BESIDE, BESIDE, -FLANK, FLANK})

    def felt(z, x):
        return 100 * (2 - np.clip(x / BESIDE, -1, 1)) * np.ones((stroke.sizes["time"], 1))

    for name, history in cases.items():
        cases[name] = synthetic._receptors(history, sorted(depths), offsets, felt)
    assert scene_of(cases["0_0.35_thesis"]).specimen.ridges is None
    frames = ridge_frames.frames(cases, made, {})
    assert set(frames) == set(ridge_study.STUDIES)
    profile = frames["offset"][
        frames["offset"]["series"].eq("inner ridges") & frames["offset"]["panel"].eq("profile")
    ]
    beside = profile.set_index(ridge_study.OFFSET).loc[-46.0, ridge_study.INDEX]
    assert beside == pytest.approx(0.5)
    assert set(frames["height"][ridge_study.HEIGHT]) == {0, 150, 300}
    thesis = frames["height"][frames["height"]["series"].str.startswith("thesis")].set_index(
        ridge_study.HEIGHT
    )["layer"]
    assert thesis.to_dict() == {0: "dermis", 150: "dermis", 300: "epidermis"}
    assert list(frames["mesh"]["series"]) == [
        "coarse",
        "thesis",
        "fine",
        "curved",
        "straight",
        "shifted",
    ]
    for name, draw in ridge_study.STUDIES.items():
        draw(frames[name])


def test_rows_hold_for_what_was_made_up_to_show_them(made):
    m = Measures.of(made)
    for id_ in ("T321", "TR43", "TR44", "TR45", "TR46", "TR47", "TR48", "TR49", "TR50", "TR51"):
        assert TRENDS[id_](m).holds, id_
    assert (
        m("highest_of_three", "ridged_stroke_right") == pytest.approx(300)
        and m("held_force", "ridged_stroke_right") == 20
    )


def _backwards(history):
    values = history.strain_energy_density
    return history.assign(strain_energy_density=values.copy(data=values.values[::-1]))


@pytest.mark.parametrize(
    ("id_", "scene", "mutant"),
    [
        (
            "TR45",
            "ridged_40_k1260",
            lambda h: h.assign(strain_energy_density=0.5 * h.strain_energy_density),
        ),
        (
            "TR44",
            "ridged_40_k79",
            lambda h: h.assign(strain_energy_density=9 * h.strain_energy_density),
        ),
        ("TR43", "ridged_40_k210", _backwards),
        ("TR47", "plate_stroke_right", lambda h: synthetic.plate_stroke("ridged_stroke_right")),
        ("T321", "ridged_stroke_right", lambda h: synthetic.plate_stroke("plate_stroke_right")),
        (
            "TR49",
            "ridged_stroke_left",
            lambda h: h.assign(strain_energy_density=3 * h.strain_energy_density),
        ),
        (
            "TR50",
            "ridged_outer_stroke_right",
            lambda h: synthetic.plate_stroke("plate_stroke_right"),
        ),
        ("TR51", "ridged_outer_stroke_right", lambda h: h.assign(cutbacks=h.cutbacks + 1)),
    ],
)
def test_rows_fail_for_mutants(made, id_, scene, mutant):
    assert not TRENDS[id_](Measures.of(made | {scene: mutant(made[scene])})).holds

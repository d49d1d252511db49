"""The planner: effects chosen and explained, overridable, and discretisations that follow the
scene.
"""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cysyk1999.studies.stability.hard_cases import scene_of
from fingerpad.planning.estimates import PadEstimate, layer_kernel
from fingerpad.planning.plan import RULES, PlanError, plan, read_plan
from fingerpad.planning.schedule import schedule
from fingerpad.scenes.scene import (
    Bar,
    Cylinder,
    Discretisation,
    Flat,
    Hold,
    Line,
    PressToDepth,
    PressToForce,
    PronyTerm,
    Sampled,
    Slide,
    StepAndRepeat,
    load_scene,
)
from fingerpad.specimen import quality_of

pytestmark = pytest.mark.unit

SCENES = Path(__file__).parents[1] / "config" / "scenes"
GF = 9.80665e-3


@pytest.fixture(scope="module")
def ramp():
    return load_scene(SCENES / "ramp40_k210.yaml")


def changed(scene, **update):
    return scene.model_copy(update=update)


def specimen(scene, **update):
    return scene.model_copy(update={"specimen": scene.specimen.model_copy(update=update)})


def test_ramp_and_hold_calls_for_what_the_thesis_needs(ramp):
    """A loaded, timed, symmetric, frictionless press: finite strain, viscosity and half the pad; no
    friction, no ridges.
    """
    effects = plan(ramp).effects
    assert {name for name, effect in effects.items() if effect.on} == {
        "viscoelasticity",
        "finite_strain",
        "symmetry",
    }
    assert all(effect.why for effect in effects.values())
    assert "%" in effects["finite_strain"].why and "%" in effects["viscoelasticity"].why


def test_light_touch_needs_small_strain_only(ramp):
    """As the load falls, small strain becomes good enough, and the number says so."""
    light = changed(ramp, motion=(PressToForce(press_to_force=1e-2 * GF, rate=2e-2 * GF),))
    assert not plan(light).effects["finite_strain"].on
    assert plan(changed(light, accuracy=0.0005)).effects["finite_strain"].on


def test_very_fast_and_very_slow_need_no_viscosity(ramp):
    """A press over before anything relaxes has instantaneous moduli, one much slower than every
    branch long-term ones.
    """
    fast = plan(changed(ramp, motion=(PressToForce(press_to_force=2 * GF, rate=2e3 * GF),)))
    assert not fast.effects["viscoelasticity"].on and fast.state == "instantaneous"
    slow = plan(
        changed(
            ramp, motion=(PressToForce(press_to_force=20 * GF, rate=20 * GF / 1e4), Hold(hold=10.0))
        )
    )
    assert not slow.effects["viscoelasticity"].on and slow.state == "long_term"
    steady = plan(changed(ramp, motion=(PressToDepth(press_to_depth=1e-3),)))
    assert not steady.timed and steady.state == "long_term", "without a rate"
    assert plan(ramp).effects["viscoelasticity"].on


def test_no_prony_no_viscosity(ramp):
    assert not plan(specimen(ramp, prony=())).effects["viscoelasticity"].on
    weak, stronger = (specimen(ramp, prony=(PronyTerm(g=g, tau=0.4),)) for g in (0.006, 0.012))
    assert not plan(weak).effects["viscoelasticity"].on and plan(weak).state == "instantaneous"
    assert plan(stronger).effects["viscoelasticity"].on


def test_lopsided_stimulus_keeps_the_whole_pad(ramp, tmp_path):
    """Symmetry halves the unknowns only where it holds."""
    csv = tmp_path / "p.csv"
    csv.write_text("x (mm),y (mm)\n-1,1\n0,0\n1,2\n")
    lopsided = Sampled(csv=csv, x=(-1e-3, 0.0, 1e-3), y=(1e-3, 0.0, 2e-3))
    whole, half = plan(changed(ramp, stimulus=lopsided)), plan(ramp)
    assert not whole.effects["symmetry"].on and half.effects["symmetry"].on
    assert whole.nodes > 1.5 * half.nodes  # half of it is also refined where it touches


def test_friction_in_a_press_is_called_on_where_it_changes_enough(ramp):
    """Skin that sticks presses otherwise by up to a sixth; what a small coefficient changes is left
    out.
    """
    rough, slippery = (
        plan(changed(ramp, friction=coefficient)).effects["friction"]
        for coefficient in (0.6, 0.008)
    )
    assert rough.on and not slippery.on
    assert "nothing slides" in slippery.why and "1.6%" in slippery.why and "20.0%" in rough.why


@pytest.mark.parametrize(
    ("height", "accuracy", "more", "on"),
    [
        ("3 um", "draft", {}, False),
        ("3 um", 0.01, {}, True),
        ("0.15 mm", "draft", {}, True),
        ("3 um", "draft", {"outer": {"height": "1 um"}}, True),
        ("3 um", "draft", {"motion": [{"press_to_force": "20 gf"}, {"slide": "1 mm"}]}, True),
        ("3 um", "draft", {"outputs": {"receptors": {"depths": ["853 um"]}}}, True),
        ("3 um", "draft", {"stiff": "1 MPa"}, True),
        ("3 um", "draft", {"motion": [{"press_to_force": "0.01 gf"}]}, True),
        ("0.6 um", "draft", {"motion": [{"press_to_force": "0.01 gf"}]}, False),
        ("3 um", "draft", {"effects": {"ridges": "on"}}, True),
        ("0.15 mm", "draft", {"effects": {"ridges": "off"}}, False),
    ],
)
def test_low_inner_ridges_are_left_out_of_presses(height, accuracy, more, on):
    """What they change grows with height over pitch; whatever else they could do they are carried
    for.
    """
    more = dict(more)
    specimen = {
        "ridges": {"inner": {"height": height}}
        | ({"outer": more.pop("outer")} if "outer" in more else {})
    }
    if "stiff" in more:
        specimen["layers"] = {"epidermis": {"youngs_modulus": more.pop("stiff")}}
    document = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_force": "20 gf"}]}
    chosen = plan(
        scene_of(document | {"specimen": specimen, "accuracy": accuracy} | more, "ridged")
    )
    assert chosen.effects["ridges"].on == on
    if not on and not more:
        assert "1.9% of a press, 6.0% is allowed" in chosen.effects["ridges"].why
        assert chosen.nodes < plan(scene_of(document | {"accuracy": accuracy}, "plain")).nodes + 1


@pytest.fixture(scope="module")
def stroke():
    return load_scene(SCENES / "stroke_10.yaml")


def slid(scene, **slide):
    return changed(scene, motion=(scene.motion[0], Slide(slide=80e-3, **slide)))


def test_stroke_calls_for_friction_and_the_whole_pad(stroke):
    """Sliding with a coefficient is frictional, without one or only step by step it is not; neither
    is symmetric.
    """
    full = plan(stroke).effects
    assert {name for name, effect in full.items() if effect.on} == {
        "friction",
        "viscoelasticity",
        "finite_strain",
    }
    assert f"stroked with a coefficient of {stroke.friction:g}" in full["friction"].why
    smooth = plan(changed(stroke, friction=0.0)).effects
    assert (
        not smooth["friction"].on
        and not smooth["symmetry"].on
        and "motion" in plan(changed(stroke, stimulus=Flat())).effects["symmetry"].why
    )
    lifted = changed(
        stroke,
        friction=0.008,
        stimulus=Flat(),
        motion=(stroke.motion[0], StepAndRepeat(step=3e-3, every=1e-3)),
    )
    effects = plan(lifted).effects
    assert (
        not effects["friction"].on
        and not effects["symmetry"].on
        and "nothing slides" in effects["friction"].why
    )


def test_friction_may_be_asked_for_where_there_is_a_coefficient(ramp, stroke):
    """Pressing with friction is a choice, and switching it off in a stroke too."""
    assert plan(changed(ramp, friction=0.6, effects={"friction": True})).effects["friction"].on
    assert not plan(changed(stroke, effects={"friction": False})).effects["friction"].on


@pytest.mark.parametrize("effect", ["friction", "ridges", "viscoelasticity"])
def test_effects_that_a_scene_cannot_have_cannot_be_switched_on(ramp, effect):
    bare = changed(specimen(ramp, prony=()), friction=0.0)
    with pytest.raises(PlanError, match=f"effects.{effect}: on, but .*; allowed: off or auto"):
        plan(changed(bare, effects={effect: True}))


@pytest.mark.parametrize(
    ("accuracy", "slide_step"), [("draft", 0.5e-3), ("thesis", 0.25e-3), ("fine", 0.125e-3)]
)
def test_stroke_has_steps_of_a_length(stroke, accuracy, slide_step):
    """Outputs of a slide follow the preset and the surface, not the speed; the cost follows the
    states that are expected.
    """
    chosen = plan(
        changed(
            slid(stroke, speed=40e-3),
            accuracy=accuracy,
            outputs=stroke.outputs.model_copy(update={"snapshots": ()}),
        )
    )
    ramp, outputs = {"draft": (10, 888), "thesis": (20, 1626), "fine": (40, 3200)}[accuracy]
    assert chosen.slide_step == slide_step and chosen.outputs == ramp + outputs
    assert 2 < (chosen.steps - ramp) / (80e-3 / slide_step) < 2.5
    ends = np.array([step.distance for step in schedule(stroke, *chosen.stepping) if step.leg == 1])
    assert (
        np.diff(ends).max() <= slide_step / 5 * (1 + 1e-9)
        and np.isin(np.arange(1, 161), np.round(ends / 0.5e-3, 9)).all()
    )
    for arc in stroke.stimulus.segments:
        if arc.curvature > 0:  # dragged along, the skin meets an arc later than its place says
            passing = np.count_nonzero((ends > arc.start + 0.5e-3) & (ends < arc.end + 0.5e-3))
            assert passing >= (16 if accuracy == "draft" else 23)
    half = plan(
        changed(
            stroke, accuracy=accuracy, motion=(stroke.motion[0], Slide(slide=40e-3, speed=10e-3))
        )
    )
    cost, half_cost = (p.predicted_cost_s - RULES.seconds_start for p in (chosen, half))
    assert half_cost / cost == pytest.approx(half.steps / chosen.steps)


def test_steps_of_a_stroke_follow_preset_or_hand(stroke):
    """Those of a tolerance are as long as the thesis preset's: friction remembers longer ones, and
    shorter ones buy nothing.
    """
    assert {
        plan(changed(stroke, accuracy=accuracy)).slide_step for accuracy in (0.1, 0.02, "thesis")
    } == {0.25e-3}
    assert (
        plan(changed(stroke, accuracy="draft")).slide_step
        == 2 * plan(changed(stroke, accuracy="thesis")).slide_step
    )
    own = plan(changed(slid(stroke, speed=10e-3), accuracy=Discretisation(steps=100)))
    assert own.slide_step is None and own.steps == pytest.approx(100, abs=85)
    assert plan(changed(stroke, accuracy=Discretisation(skin_edge=0.2e-3))).slide_step == 0.25e-3


def test_mesh_is_fine_wherever_a_stroke_takes_the_contact(stroke, ramp):
    """To where the pad is as steep as the surface, and by the skin's stretch more; a plate does not
    wander.
    """

    def extent(scene):
        return plan(scene).mesh_size.fine_half_width

    still = extent(changed(stroke, stimulus=Flat(), friction=0.0))
    assert still == extent(changed(ramp, stimulus=Flat()))
    smooth = extent(changed(stroke, friction=0.0))
    assert smooth > still
    assert extent(stroke) == pytest.approx(smooth + RULES.skin_stretch)
    steeper = stroke.varied({"friction": 0.0, "stimulus.half_angle": math.radians(12)})
    rise = (
        math.tan(math.radians(12)) - math.tan(math.radians(9))
    ) * stroke.specimen.outline.apex_radius
    assert extent(steeper) == pytest.approx(smooth + rise, abs=0.15e-3)
    few = changed(stroke, friction=0.0, motion=(stroke.motion[0], Slide(slide=0.1e-3, speed=10e-3)))
    assert extent(few) < smooth - 0.4e-3


def test_stroke_is_planned_for_its_sharpest_convexity(stroke):
    """The narrowest contact on the way decides on strain and error; pressed in place the surface is
    flat.
    """
    there = plan(stroke).contact
    assert there == plan(changed(stroke, stimulus=Cylinder(curvature=1 / 3.175e-3))).contact
    pressed = plan(
        changed(
            stroke,
            motion=stroke.motion[:1],
            outputs=stroke.outputs.model_copy(update={"snapshots": ()}),
        )
    )
    assert pressed.contact == plan(changed(stroke, stimulus=Flat())).contact
    assert pressed.estimated_error < plan(stroke).estimated_error
    deep = changed(
        stroke,
        motion=(
            PressToDepth(press_to_depth=0.5e-3, speed=1e-3),
            Slide(slide=80e-3, speed=10e-3, keep="depth"),
        ),
    )
    assert plan(deep).contact.depth == pytest.approx(0.5e-3 + 0.469e-3, abs=2e-6)


def test_viscosity_follows_how_fast_the_contact_passes(stroke):
    """Minutes of stroking are still fast for a contact of a millimetre; a creeping or an untimed
    stroke is not.
    """
    pressed = PressToForce(press_to_force=20 * GF)

    def effect(scene, **slide):
        return plan(
            changed(scene, motion=(pressed, Slide(slide=80e-3, **slide)), outputs=bare)
        ).effects["viscoelasticity"]

    bare = stroke.outputs.model_copy(update={"snapshots": ()})
    assert effect(stroke, speed=0.4e-3).on
    assert not effect(stroke, speed=1e-7).on and not effect(stroke).on
    assert effect(changed(stroke, stimulus=Flat()), speed=10e-3).on
    assert not effect(changed(stroke, stimulus=Flat(), friction=0.0), speed=10e-3).on


def test_motion_so_fast_that_inertia_matters_is_refused(ramp, stroke):
    """The leg is named where rho v^2 / mu is not small; ten times the thesis's speeds are not
    refused.
    """
    bare = changed(stroke, outputs=stroke.outputs.model_copy(update={"snapshots": ()}))
    with pytest.raises(PlanError, match=r"motion\[1\]: so fast that inertia matters"):
        plan(slid(bare, speed=1.0))
    with pytest.raises(PlanError, match=r"motion\[0\]: so fast that inertia matters"):
        plan(changed(ramp, motion=(PressToDepth(press_to_depth=1e-3, speed=2.0),)))
    press = changed(ramp, motion=(PressToDepth(press_to_depth=1e-3, speed=0.04),))
    assert plan(slid(bare, speed=0.4)).inertia_ratio < 0.05 and plan(press).inertia_ratio < 1e-3


def test_overrides_are_obeyed_and_said(ramp):
    """The user may switch effects; the reason then names the user."""
    off = plan(
        changed(ramp, effects={"finite_strain": False, "viscoelasticity": False, "symmetry": False})
    )
    assert not any(
        off.effects[name].on for name in ("finite_strain", "viscoelasticity", "symmetry")
    )
    assert "asked for" in off.effects["finite_strain"].why


def test_presets_and_tolerances_order_cost_and_error(ramp):
    """Finer asks for more nodes, steps and time and promises less error; a tolerance gets the
    cheapest that meets it.
    """
    draft, thesis, fine = (
        plan(changed(ramp, accuracy=level)) for level in ("draft", "thesis", "fine")
    )
    assert (
        draft.nodes < thesis.nodes < fine.nodes
        and draft.predicted_cost_s < thesis.predicted_cost_s < fine.predicted_cost_s
    )
    assert draft.estimated_error > thesis.estimated_error > fine.estimated_error
    for tolerance in (0.05, 0.02, 0.005):
        assert plan(changed(ramp, accuracy=tolerance)).estimated_error <= tolerance * 1.01
    assert plan(changed(ramp, accuracy=0.05)).nodes < plan(changed(ramp, accuracy=0.005)).nodes


def test_mesh_follows_edges_and_needles(ramp):
    """Edges of the profile and contacts narrower than the mesh get finer skin there; broad ones do
    not.
    """
    flat = plan(changed(ramp, stimulus=Flat()))
    assert flat.mesh_size.focus == () and flat.contact.half_width < 20 * flat.contact_edge, (
        "they would hardly be finer"
    )
    sharp = plan(changed(ramp, stimulus=Cylinder(curvature=1259.84)))
    assert (
        2**-0.25 <= 20 * sharp.contact_edge / sharp.contact.half_width <= 1
        and sharp.estimated_error < 0.03
    )
    deep = 3 * sharp.mesh_size.skin_radial_edge / sharp.contact.half_width
    assert 2**-0.25 <= deep <= 1, "into the skin a seventh as fine as along it"
    rough = plan(changed(ramp, stimulus=Cylinder(curvature=1259.84), accuracy="draft"))
    assert rough.mesh_size.skin_radial_edge == rough.contact_edge, (
        "a draft's grow so fast that it needs as many rows as columns"
    )
    bar = plan(changed(ramp, stimulus=Bar(width=1.5875e-3, fillet=0.1e-3))).mesh_size
    assert bar.focus[0][0] == pytest.approx(0.79375e-3) and bar.focus[0][1] <= 0.05e-3
    assert plan(changed(ramp, stimulus=Line())).mesh_size.focus
    needle = plan(changed(ramp, stimulus=Cylinder(curvature=1e4))).mesh_size
    assert needle.focus and needle.focus[0][1] < 0.1e-3


def test_a_presets_stroke_is_finer_in_the_middle_and_coarser_away_from_it(ramp):
    """Its curves are those of the mesh along its way; what was measured with some growth, and what
    is given by hand, keeps it.
    """
    slide = (
        PressToForce(press_to_force=0.2, rate=0.4),
        Slide(slide=5e-3, speed=10e-3, keep="force"),
    )
    press, stroke = (plan(changed(ramp, motion=motion)).mesh_size for motion in (slide[:1], slide))
    assert stroke.growth == pytest.approx(press.growth**2) and stroke.skin_edge == press.skin_edge
    places, edges = zip(*stroke.focus, strict=True)
    assert set(edges) == {0.6 * stroke.skin_edge} and places[0] == 0
    assert places[-1] > 1.5e-3, "two convexities press there at once"
    moved = plan(changed(ramp, motion=slide))
    assert moved.contact_edge == stroke.skin_edge, "the contact leaves the middle"
    for accuracy in (0.02, Discretisation(element="Q2P1", skin_edge=134.4e-6, steps=30)):
        one, other = (
            plan(changed(ramp, motion=motion, accuracy=accuracy)).mesh_size
            for motion in (slide[:1], slide)
        )
        assert other.growth <= max(one.growth, press.growth) and other.focus == ()


def test_discretisation_by_hand(ramp):
    """Those who want the wheel get it."""
    own = plan(changed(ramp, accuracy=Discretisation(element="Q2P1", skin_edge=0.2e-3, steps=30)))
    assert own.mesh_size.skin_edge == 0.2e-3 and own.steps == 30
    with pytest.raises(PlanError, match="element"):
        plan(changed(ramp, accuracy=Discretisation(element="P2B", skin_edge=None, steps=None)))


@pytest.mark.parametrize("name", ["ramp40_k210", "stroke_40", "step_sub", "steady_bar_1_16_inch"])
def test_plan_survives_its_file(name, tmp_path):
    """A plan read back is the plan written."""
    written = plan(load_scene(SCENES / f"{name}.yaml"))
    written.write(tmp_path / "plan.json")
    read = read_plan(tmp_path / "plan.json")
    assert (
        replace(read, predicted_cost_s=written.predicted_cost_s) == written
        and read.to_dict() == written.to_dict()
    )
    keys = json.loads((tmp_path / "plan.json").read_text())
    assert set(keys["effects"]) == {
        "friction",
        "viscoelasticity",
        "finite_strain",
        "symmetry",
        "ridges",
    }
    assert {"element", "nodes", "smallest_edge_um", "steps"} <= set(
        keys["discretisation"]
    ) and keys["predicted_cost_s"] > 0


# -- the estimates behind the choices --------------------------------------------------------------


@pytest.mark.parametrize(
    ("wavenumber", "kernel"), [(0.1, 9.9673), (0.5, 8.0556), (1.0, 4.1124), (2.0, 1.5328)]
)
def test_layer_kernel(wavenumber, kernel):
    """Surface compliance of an incompressible layer on a ten times softer half-plane."""
    assert layer_kernel(0.1, wavenumber) == pytest.approx(kernel, rel=1e-4)


@pytest.mark.parametrize(
    ("curvature", "width", "depth"),
    [(0, 4.96, 0.560), (78.74, 3.3, 0.67), (209.97, 2.2, 0.75), (1259.84, 0.73, 0.881)],
)
def test_estimates_are_good_enough_to_plan_with(curvature, width, depth):
    """Estimated widths within 20 % and depths within 25 % of simulated long-term values (mm) at 20
    gram-weight.
    """
    plane = 1 - 0.48**2
    pad = PadEstimate(11e-3, 0.85e-3, 5.5e-3, 0.15e6 / plane, 0.015e6 / plane)
    found = pad.pressed(19.6133, curvature)
    assert 2e3 * found.half_width == pytest.approx(width, rel=0.2)
    assert 1e3 * found.depth == pytest.approx(depth, rel=0.25)
    assert pad.pressed_to(found.depth, curvature).half_width == pytest.approx(
        found.half_width, rel=1e-6
    )


@pytest.mark.parametrize("accuracy", ["draft", "thesis"])
def test_plan_foretells_the_mesh(ramp, accuracy):
    """Nodes and smallest edge are those of the mesh that is then built."""
    from fingerpad.specimen import mesh_for

    whole = changed(ramp, accuracy=accuracy, effects={"symmetry": False})
    chosen = plan(whole)
    built = quality_of(mesh_for(whole, chosen))
    assert chosen.nodes == built["nodes"]
    assert chosen.smallest_edge == pytest.approx(built["smallest_edge_m"], rel=0.01)

"""The planner: effects chosen and explained, overridable, and discretisations that follow the
scene.
"""

import json
import math
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml

from cysyk1999.studies.common.documents import FLAT, scene_of
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
from fingerpad.specimen import mesh_for, quality_of

pytestmark = pytest.mark.unit

SCENES = Path(__file__).parents[1] / "config" / "scenes"
GF = 9.80665e-3


@pytest.fixture(scope="module")
def ramp():
    return load_scene(SCENES / "ramp40_k210.yaml")


def changed(scene, **update):
    return scene.model_copy(update=update)


def planned(scene, **update):
    return plan(changed(scene, **update))


def on(chosen):
    """Names of the effects that are on."""
    return {name for name, effect in chosen.effects.items() if effect.on}


def force(gram_weight, seconds=None):
    rate = seconds and gram_weight * GF / seconds
    return PressToForce(press_to_force=gram_weight * GF, rate=rate)


def without_snapshots(scene):
    return changed(scene, outputs=scene.outputs.model_copy(update={"snapshots": ()}))


def relaxing(scene, *terms):
    """A scene with a Prony series of its own."""
    return changed(scene, specimen=scene.specimen.model_copy(update={"prony": terms}))


def test_ramp_and_hold_calls_for_what_the_thesis_needs(ramp):
    """A loaded, timed, symmetric, frictionless press: finite strain, viscosity and half the pad; no
    friction, no ridges.
    """
    chosen = plan(ramp)
    assert on(chosen) == {"viscoelasticity", "finite_strain", "symmetry"}
    assert all(effect.why for effect in chosen.effects.values())
    assert all("%" in chosen.effects[name].why for name in ("finite_strain", "viscoelasticity"))


def test_light_touch_needs_small_strain_only(ramp):
    """As the load falls, small strain becomes good enough, and the number says so."""
    light = changed(ramp, motion=(force(1e-2, 0.5),))
    assert "finite_strain" not in on(plan(light))
    assert "finite_strain" in on(planned(light, accuracy=0.0005))


def test_very_fast_and_very_slow_need_no_viscosity(ramp):
    """A press over before anything relaxes has instantaneous moduli, one much slower than every
    branch long-term ones, and so has one without a rate.
    """
    for motion, state in (
        ((force(2, 1e-3),), "instantaneous"),
        ((force(20, 1e4), Hold(hold=10.0)), "long_term"),
        ((PressToDepth(press_to_depth=1e-3),), "long_term"),
    ):
        chosen = planned(ramp, motion=motion)
        assert not chosen.timed and "viscoelasticity" not in on(chosen) and chosen.state == state


def test_no_prony_no_viscosity(ramp):
    weak, stronger = (plan(relaxing(ramp, PronyTerm(g=g, tau=0.4))) for g in (0.006, 0.012))
    assert "viscoelasticity" not in on(weak) | on(plan(relaxing(ramp)))
    assert weak.state == "instantaneous" and "viscoelasticity" in on(stronger)


def test_lopsided_stimulus_keeps_the_whole_pad(ramp):
    """Symmetry halves the unknowns only where it holds."""
    lopsided = Sampled(x=(-1e-3, 0.0, 1e-3), y=(1e-3, 0.0, 2e-3))
    whole, half = planned(ramp, stimulus=lopsided), plan(ramp)
    assert "symmetry" not in on(whole) and "symmetry" in on(half)
    assert whole.nodes > 1.5 * half.nodes  # half of it is also refined where it touches


def test_friction_in_a_press_is_called_on_where_it_changes_enough(ramp):
    """Skin that sticks presses otherwise by up to a sixth; what a small coefficient changes is left
    out.
    """
    rough, slippery = (planned(ramp, friction=mu).effects["friction"] for mu in (0.6, 0.008))
    assert rough.on and not slippery.on
    assert "nothing slides" in slippery.why and "1.6%" in slippery.why and "20.0%" in rough.why


LOW_RIDGES = """
- {height: 3 um, on: false}
- {height: 3 um, accuracy: 0.01, on: true}
- {height: 0.15 mm, on: true}
- {height: 3 um, outer: {height: 1 um}, on: true}
- {height: 3 um, motion: [{press_to_force: 20 gf}, {slide: 1 mm}], on: true}
- {height: 3 um, outputs: {receptors: {depths: [853 um]}}, on: true}
- {height: 3 um, stiff: 1 MPa, on: true}
- {height: 3 um, motion: [{press_to_force: 0.01 gf}], on: true}
- {height: 0.6 um, motion: [{press_to_force: 0.01 gf}], on: false}
- {height: 3 um, effects: {ridges: "on"}, on: true}
- {height: 0.15 mm, effects: {ridges: "off"}, on: false}
"""


@pytest.mark.parametrize("case", yaml.load(LOW_RIDGES, yaml.BaseLoader))
def test_low_inner_ridges_are_left_out_of_presses(case):
    """What they change grows with height over pitch; whatever else they could do they are carried
    for.
    """
    case = dict(case)
    plain = {"stimulus": FLAT, "motion": [{"press_to_force": "20 gf"}], "accuracy": "draft"}
    specimen = {"ridges": {"inner": {"height": case.pop("height")}}}
    if "outer" in case:
        specimen["ridges"]["outer"] = case.pop("outer")
    if "stiff" in case:
        specimen["layers"] = {"epidermis": {"youngs_modulus": case.pop("stiff")}}
    expected = case.pop("on") == "true"
    chosen = plan(scene_of(plain | {"specimen": specimen} | case, "ridged"))
    assert chosen.effects["ridges"].on == expected
    if not expected and not case:
        assert "1.9% of a press, 6.0% is allowed" in chosen.effects["ridges"].why
        assert chosen.nodes <= plan(scene_of(plain, "plain")).nodes


@pytest.fixture(scope="module")
def stroke():
    return load_scene(SCENES / "stroke_10.yaml")


def slid(scene, press=None, way=80e-3, **slide):
    return changed(scene, motion=(press or scene.motion[0], Slide(slide=way, **slide)))


def test_stroke_calls_for_friction_and_the_whole_pad(stroke):
    """Sliding with a coefficient is frictional, without one or only step by step it is not; neither
    is symmetric.
    """
    full = plan(stroke)
    assert on(full) == {"friction", "viscoelasticity", "finite_strain"}
    assert f"stroked with a coefficient of {stroke.friction:g}" in full.effects["friction"].why
    assert not {"friction", "symmetry"} & on(planned(stroke, friction=0.0))
    assert "motion" in planned(stroke, stimulus=Flat()).effects["symmetry"].why
    steps = (stroke.motion[0], StepAndRepeat(step=3e-3, every=1e-3))
    lifted = planned(stroke, friction=0.008, stimulus=Flat(), motion=steps)
    assert not {"friction", "symmetry"} & on(lifted)
    assert "nothing slides" in lifted.effects["friction"].why


@pytest.mark.parametrize("effect", ["friction", "ridges", "viscoelasticity"])
def test_effects_that_a_scene_cannot_have_cannot_be_switched_on(ramp, effect):
    with pytest.raises(PlanError, match=f"effects.{effect}: on, but .*; allowed: off or auto"):
        planned(relaxing(ramp), friction=0.0, effects={effect: True})


@pytest.mark.parametrize(
    ("accuracy", "slide_step"), [("draft", 0.5e-3), ("thesis", 0.25e-3), ("fine", 0.125e-3)]
)
def test_stroke_has_steps_of_a_length(stroke, accuracy, slide_step):
    """Outputs of a slide follow the preset and the surface, not the speed; the cost follows the
    states that are expected.
    """
    chosen = plan(changed(without_snapshots(slid(stroke, speed=40e-3)), accuracy=accuracy))
    ramp, outputs = {"draft": (10, 888), "thesis": (20, 1626), "fine": (40, 3200)}[accuracy]
    assert chosen.slide_step == slide_step and chosen.outputs == ramp + outputs
    assert 2 < (chosen.steps - ramp) / (80e-3 / slide_step) < 2.5
    ends = np.array([step.distance for step in schedule(stroke, *chosen.stepping) if step.leg == 1])
    assert np.diff(ends).max() <= slide_step / 5 * (1 + 1e-9)
    assert np.isin(np.arange(1, 161), np.round(ends / 0.5e-3, 9)).all()
    for arc in stroke.stimulus.segments:
        if arc.curvature > 0:  # dragged along, the skin meets an arc later than its place says
            passing = np.count_nonzero((ends > arc.start + 0.5e-3) & (ends < arc.end + 0.5e-3))
            assert passing >= (16 if accuracy == "draft" else 23)
    half = plan(changed(slid(stroke, way=40e-3, speed=10e-3), accuracy=accuracy))
    cost, half_cost = (p.predicted_cost_s - RULES.seconds_start for p in (chosen, half))
    assert half_cost / cost == pytest.approx(half.steps / chosen.steps)


def test_steps_of_a_stroke_follow_preset_or_hand(stroke):
    """Those of a tolerance are as long as the thesis preset's: friction remembers longer ones, and
    shorter ones buy nothing.
    """
    for accuracy in (0.1, 0.02, "thesis", Discretisation(skin_edge=0.2e-3)):
        assert planned(stroke, accuracy=accuracy).slide_step == 0.25e-3
    own = planned(slid(stroke, speed=10e-3), accuracy=Discretisation(steps=100))
    assert own.slide_step is None and own.steps == pytest.approx(100, abs=85)


def test_mesh_is_fine_wherever_a_stroke_takes_the_contact(stroke, ramp):
    """To where the pad is as steep as the surface, and by the skin's stretch more; a plate does not
    wander.
    """

    def extent(scene, **update):
        return planned(scene, **update).mesh_size.fine_half_width

    still, smooth = extent(stroke, stimulus=Flat(), friction=0.0), extent(stroke, friction=0.0)
    as_hard = ramp.varied({"motion[0].press_to_force": stroke.motion[0].force})
    assert still == pytest.approx(extent(as_hard, stimulus=Flat())) and smooth > still
    assert extent(stroke) == pytest.approx(smooth + RULES.skin_stretch)
    steep, usual = (math.tan(math.radians(angle)) for angle in (12, 9))
    steeper = extent(stroke.varied({"friction": 0.0, "stimulus.half_angle": math.radians(12)}))
    rise = (steep - usual) * stroke.specimen.outline.apex_radius
    assert steeper == pytest.approx(smooth + rise, abs=0.15e-3)
    assert extent(slid(stroke, way=0.1e-3, speed=10e-3), friction=0.0) < smooth - 0.3e-3


def test_stroke_is_planned_for_its_sharpest_convexity(stroke):
    """The narrowest contact on the way decides on strain and error; pressed in place the surface is
    flat.
    """
    there = plan(stroke)
    assert there.contact == planned(stroke, stimulus=Cylinder(curvature=1 / 3.175e-3)).contact
    pressed = planned(without_snapshots(stroke), motion=stroke.motion[:1])
    assert pressed.contact == planned(stroke, stimulus=Flat()).contact
    assert pressed.estimated_error < there.estimated_error
    press = PressToDepth(press_to_depth=0.5e-3, speed=1e-3)
    deep = plan(slid(stroke, press, speed=10e-3, keep="depth"))
    assert deep.contact.depth == pytest.approx(0.5e-3 + 0.469e-3, abs=2e-6)


def test_viscosity_follows_how_fast_the_contact_passes(stroke):
    """Minutes of stroking are still fast for a contact of a millimetre; a creeping or an untimed
    stroke is not.
    """
    bare = without_snapshots(stroke)
    plate = {"stimulus": Flat()}
    for speed, changes, expected in (
        (0.4e-3, {}, True),
        (1e-7, {}, False),
        (None, {}, False),
        (10e-3, plate, True),
        (10e-3, plate | {"friction": 0.0}, False),
    ):
        chosen = planned(slid(bare, force(20), speed=speed), **changes)
        assert ("viscoelasticity" in on(chosen)) == expected


def test_motion_so_fast_that_inertia_matters_is_refused(ramp, stroke):
    """The leg is named where rho v^2 / mu is not small; ten times the thesis's speeds are not
    refused.
    """
    bare = without_snapshots(stroke)

    def press(speed):
        return changed(ramp, motion=(PressToDepth(press_to_depth=1e-3, speed=speed),))

    for leg, fast in enumerate((press(2.0), slid(bare, speed=1.0))):
        with pytest.raises(PlanError, match=rf"motion\[{leg}\]: so fast that inertia matters"):
            plan(fast)
    assert plan(slid(bare, speed=0.4)).inertia_ratio < 0.05
    assert plan(press(0.04)).inertia_ratio < 1e-3


def test_overrides_are_obeyed_and_said(ramp):
    """The user may switch effects; the reason then names the user."""
    switched = ("finite_strain", "viscoelasticity", "symmetry")
    off = planned(ramp, effects=dict.fromkeys(switched, False))
    assert not on(off) and "asked for" in off.effects["finite_strain"].why


def test_presets_and_tolerances_order_cost_and_error(ramp):
    """Finer asks for more nodes, steps and time and promises less error; a tolerance gets the
    cheapest that meets it.
    """
    presets = [planned(ramp, accuracy=level) for level in ("draft", "thesis", "fine")]
    for rough, good in pairwise(presets):
        assert rough.nodes < good.nodes and rough.predicted_cost_s < good.predicted_cost_s
        assert rough.estimated_error > good.estimated_error
    asked = {tolerance: planned(ramp, accuracy=tolerance) for tolerance in (0.05, 0.02, 0.005)}
    assert all(chosen.estimated_error <= 1.01 * error for error, chosen in asked.items())
    assert asked[0.05].nodes < asked[0.005].nodes


def test_mesh_follows_edges_and_needles(ramp):
    """Edges of the profile and contacts narrower than the mesh get finer skin there; broad ones do
    not.
    """
    flat = planned(ramp, stimulus=Flat())
    assert flat.mesh_size.focus == () and flat.contact.half_width < 20 * flat.contact_edge, (
        "they would hardly be finer"
    )
    narrow = Cylinder(curvature=1259.84)
    sharp, rough = (planned(ramp, stimulus=narrow, accuracy=a) for a in ("thesis", "draft"))
    along = 20 * sharp.contact_edge / sharp.contact.half_width
    assert 2**-0.25 <= along <= 1 and sharp.estimated_error < 0.03
    deep = 3 * sharp.mesh_size.skin_radial_edge / sharp.contact.half_width
    assert 2**-0.25 <= deep <= 1, "into the skin a seventh as fine as along it"
    assert rough.mesh_size.skin_radial_edge == rough.contact_edge, (
        "a draft's grow so fast that it needs as many rows as columns"
    )
    bar, line, needle = (
        planned(ramp, stimulus=stimulus).mesh_size.focus
        for stimulus in (Bar(width=1.5875e-3, fillet=0.1e-3), Line(), Cylinder(curvature=1e4))
    )
    assert bar[0][0] == pytest.approx(0.79375e-3) and bar[0][1] <= 0.05e-3
    assert line and needle and needle[0][1] < 0.1e-3


def test_a_presets_stroke_is_finer_in_the_middle_and_coarser_away_from_it(ramp):
    """Its curves are those of the mesh along its way; what was measured with some growth, and what
    is given by hand, keeps it.
    """
    slide = (PressToForce(press_to_force=0.2, rate=0.4), Slide(slide=5e-3, speed=10e-3))
    press, moved = (planned(ramp, motion=motion) for motion in (slide[:1], slide))
    growth, stroke = press.mesh_size.growth, moved.mesh_size
    assert stroke.growth == pytest.approx(growth**2)
    assert stroke.skin_edge == press.mesh_size.skin_edge
    places, edges = zip(*stroke.focus, strict=True)
    assert set(edges) == {0.6 * stroke.skin_edge} and places[0] == 0
    assert places[-1] > 1.5e-3, "two convexities press there at once"
    assert moved.contact_edge == stroke.skin_edge, "the contact leaves the middle"
    for accuracy in (0.02, Discretisation(element="Q2P1", skin_edge=134.4e-6, steps=30)):
        one, other = (
            planned(ramp, motion=motion, accuracy=accuracy).mesh_size
            for motion in (slide[:1], slide)
        )
        assert other.growth <= max(one.growth, growth) and other.focus == ()


def test_discretisation_by_hand(ramp):
    """Those who want the wheel get it."""
    own = planned(ramp, accuracy=Discretisation(element="Q2P1", skin_edge=0.2e-3, steps=30))
    assert own.mesh_size.skin_edge == 0.2e-3 and own.steps == 30
    with pytest.raises(PlanError, match="element"):
        planned(ramp, accuracy=Discretisation(element="P2B"))


@pytest.mark.parametrize("name", ["ramp40_k210", "stroke_40", "step_sub", "steady_bar_1_16_inch"])
def test_plan_survives_its_file(name, tmp_path):
    """A plan read back is the plan written."""
    written = plan(load_scene(SCENES / f"{name}.yaml"))
    written.write(tmp_path / "plan.json")
    read = read_plan(tmp_path / "plan.json")
    assert replace(read, predicted_cost_s=written.predicted_cost_s) == written
    keys = json.loads((tmp_path / "plan.json").read_text())
    assert read.to_dict() == written.to_dict() and keys["predicted_cost_s"] > 0
    assert {"element", "nodes", "smallest_edge_um", "steps"} <= set(keys["discretisation"])


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
    whole = changed(ramp, accuracy=accuracy, effects={"symmetry": False})
    chosen = plan(whole)
    built = quality_of(mesh_for(whole, chosen))
    assert chosen.nodes == built["nodes"]
    assert chosen.smallest_edge == pytest.approx(built["smallest_edge_m"], rel=0.01)

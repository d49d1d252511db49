"""The study of effects, and that what a plan leaves out is not executed."""

import sys
from dataclasses import fields, replace
from itertools import islice
from pathlib import Path

import matplotlib
import numpy as np
import pandas as pd
import pytest

from cysyk1999.studies.common.documents import (
    FLAT,
    cylinder,
    depth,
    force,
    hold,
    scene_of,
    slide,
)
from cysyk1999.studies.effects.picture import LEAST, WARNING, assemble, effects, looks
from cysyk1999.studies.effects.run import (
    alternatives,
    changes,
    drawn,
    evidence,
    pairs,
    planned,
    rules_table,
    study,
    verdict,
)
from fingerpad import plan, simulate
from fingerpad.planning.plan import Rules

pytestmark = pytest.mark.unit
TABLES = Path(__file__).parents[1] / "figures" / "tables"
COARSE = {"skin_edge": "0.6 mm", "steps": 4}


def made(*motion, stimulus=FLAT, **more):
    return scene_of(
        {"stimulus": stimulus, "motion": list(motion), "accuracy": COARSE} | more, "made"
    )


# -- what is left out costs nothing ---


def executed(scene):
    """Functions of the package that are called while a scene is planned and simulated: {(module,
    name)}. Its loops are compiled before: under a profile that takes minutes.
    """
    simulate(scene, plan(scene))
    called = set()

    def note(frame, event, _):
        code = frame.f_code
        path = Path(code.co_filename)
        ours = "fingerpad" in path.parts and "planning" not in path.parts
        if event == "call" and ours and code.co_name != "<module>":
            called.add((path.stem, code.co_name))

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        simulate(scene, plan(scene))
    finally:
        sys.setprofile(before)
    return called


#: Effect -> modules and functions that only it needs.
OWN = {
    "friction": [("friction", None)],
    "viscoelasticity": [("viscoelasticity", None)],
    "finite_strain": [("finite_strain", "linearise"), ("finite_strain", "begin_step")],
    "small_strain": [("small_strain", None)],
    "ridges": [("ridges", None)],
    "symmetry": [("pad", "right_half")],
    "full-field output": [("simulation", "_element_pressure"), ("results", "add_snapshots")],
}
ON = {"finite_strain": "on", "viscoelasticity": "off"}
SCENES = {
    "plain press": (made(force(2), effects=ON), {"finite_strain", "symmetry"}),
    "small strain": (
        made(force(2), effects={"finite_strain": "off"}),
        {"small_strain", "symmetry"},
    ),
    "ramp": (
        made(force(2, 4), hold(1), effects={"finite_strain": "off", "viscoelasticity": "on"}),
        {"small_strain", "symmetry", "viscoelasticity"},
    ),
    "stroke": (made(force(2), slide(0.5), friction=0.5, effects=ON), {"finite_strain", "friction"}),
    "smooth stroke": (made(force(2), slide(0.5), effects=ON), {"finite_strain"}),
    "full fields": (
        made(force(2, 4), effects=ON, outputs={"snapshots": ["0.25 s"]}),
        {"finite_strain", "symmetry", "full-field output"},
    ),
    "ridges": (
        made(force(2), effects=ON, specimen={"ridges": "inner"}, accuracy="draft"),
        {"finite_strain", "symmetry", "ridges"},
    ),
}


@pytest.mark.parametrize("name", SCENES)
def test_code_of_what_is_left_out_is_not_executed(name):
    """Of each effect that is on something of its own is called, of each that is off nothing."""
    scene, on = SCENES[name]
    called = executed(scene)
    modules = {module for module, _ in called}
    ran = {
        effect
        for effect, own in OWN.items()
        if any(part in called or (part[1] is None and part[0] in modules) for part in own)
    }
    assert ran == on


def test_steady_scene_does_no_time_stepping():
    """Load increments, at most eight, all at time zero; a hold of a steady scene is one step,
    whatever its length.
    """
    scene = made(force(2), accuracy="fine")
    chosen = plan(scene)
    assert not chosen.timed and chosen.steps <= 8
    history = simulate(scene, replace(chosen, steps_per_leg=3))
    assert history.time.values.max() < 1e-9 and not history.dissipated_energy.values.any()
    press, held = (
        made(force(2), *more, accuracy="draft", effects={"viscoelasticity": "off"})
        for more in ((), (hold(1e3),))
    )
    assert plan(held).steps == plan(press).steps + 1


# -- the study ---


def test_changes_are_nothing_between_alike_and_something_between_others():
    scene = made(force(2), slide(0.5), stimulus=cylinder(100), friction=0.5)
    history = simulate(scene)
    assert max(changes(history, history).values()) == 0
    other = history.copy(deep=True)
    other["tangential_force"] = other.tangential_force * 0.9
    found = changes(history, other)
    assert found["tangential force"] == pytest.approx(
        0.1 * float(np.abs(history.tangential_force).max() / history.force.max())
    )
    assert sum(value > 0 for value in found.values()) == 1


def test_legs_of_other_numbers_of_steps_are_compared_at_their_ends():
    scene = made(depth(0.1), effects={"viscoelasticity": "off"})
    chosen = plan(scene)
    found = changes(*(simulate(scene, replace(chosen, steps_per_leg=steps)) for steps in (2, 3)))
    assert max(found.values()) < 1e-3


@pytest.mark.parametrize(
    ("dropped", "share", "said"),
    [
        (True, 0.9, "rightly left out"),
        (True, 1.1, "wrongly left out"),
        (False, 0.2, "rightly carried"),
        (False, 0.05, "carried for nothing"),
    ],
)
def test_verdicts(dropped, share, said):
    assert verdict(dropped, share) == said


def test_drawn_scenes_can_be_planned_and_are_those_of_the_published_choices():
    choices = pd.read_csv(TABLES / "planner_choices.csv")
    scenes = {(seed, scene.name) for seed, scene in drawn()}
    assert scenes == set(zip(choices["seed"], choices["scene"], strict=True))
    assert all(plan(scene).estimated_error > 0 for _, scene in islice(drawn(), 0, None, 10))


def test_alternatives_flip_one_effect_each():
    scene = made(force(2, 4), friction=0.5)
    draft = plan(scene)
    for effect, ways in alternatives(scene, draft).items():
        for way in ways:
            flipped = [
                name for name in draft.effects if way.effects[name].on != draft.effects[name].on
            ]
            assert flipped == [effect]
            assert way.timed == way.effects["viscoelasticity"].on
    assert len(alternatives(scene, draft)["viscoelasticity"]) == 2


def test_pairs_cover_every_effect_where_it_matters_or_not():
    assert {pair.effect for pair in pairs()} == set(looks())
    for pair in pairs():
        scene = scene_of({"accuracy": "draft", **pair.document}, pair.label)
        ways = [pair.switch(scene, on) for on in (True, False)]
        assert ways[0] != ways[1]
        if pair.matters:  # half the pad matters where it must not be planned
            assert planned(pair.effect, scene) != (pair.effect == "symmetry")


def test_every_rule_says_what_it_decides():
    assert all(field.metadata["decides"] for field in fields(Rules))


def test_a_small_study_is_drawn_and_tabulated():
    """Symmetry alone, and made-up choices: markers right and left, a wrong choice in red, rules
    with evidence.
    """
    one = study(pairs()[1:2], repeats=1)
    assert one["cost ratio"].item() == pytest.approx(
        one["with (s)"].item() / one["without (s)"].item()
    )  # of one turn
    assert one["change"].item() < 1e-3
    halved = one["unknowns with"].item() / one["unknowns without"].item()
    assert halved == pytest.approx(0.5, abs=0.02)
    choices = {"planned": ["on", "off"], "verdict": ["rightly carried", "wrongly left out"]}
    choices |= {"seed": 1, "scene": "s", "effect": "finite_strain", "share": 5.0}
    found = pd.DataFrame(choices | {"worth": 0.1, "of": "depth"})
    table = evidence(one, found)
    assert table["wrongly left out"].sum() == 1 and len(table) == 3
    rules = rules_table(one, found).set_index("rule")
    assert "left out in 1 scenes, worth up to 5" in rules.loc["small_strain_error", "evidence"]
    fig = effects(assemble(one, found))
    left, right = fig.axes
    assert sum(matplotlib.colors.same_color(line.get_color(), WARNING) for line in right.lines) == 1
    assert left.get_ylim()[0] < LEAST

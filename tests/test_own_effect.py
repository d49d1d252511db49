"""A new effect of the planner is one object: scenes switch it, plans decide on it, runs carry it
out, wrong switches name it.
"""

import runpy
from pathlib import Path

import pandas as pd
import pytest

from cysyk1999.studies.common.documents import FLAT, scene_of
from cysyk1999.studies.effects.picture import assemble, looks
from cysyk1999.studies.effects.picture import effects as picture
from cysyk1999.studies.effects.run import pairs, rules_table, study
from fingerpad.healing import simulate
from fingerpad.planning import effects
from fingerpad.planning.effects import EFFECTS, in_order, registered
from fingerpad.planning.plan import RULES, Plan, PlanError, plan
from fingerpad.scenes.effects import EFFECTS as NAMES

pytestmark = pytest.mark.unit
FIGURES = Path(__file__).parents[1] / "figures"


FILE = """
from dataclasses import replace

from fingerpad.planning.effect import Effect, PlannedEffect, Shown

PLATE = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_force": "1 gf"}]}


def decide(case):
    depth = case.contact.depth
    on = depth < 0.3e-3 and not case.decided["ridges"].on
    return Effect(on, f"the finger sinks in by {depth * 1e3:.2g} mm")


def stiffer(parts):
    key = "specimen.layers.dermis.youngs_modulus"
    return replace(parts, scene=parts.scene.varied({key: "150 kPa"}))


EFFECT = PlannedEffect(
    name="cold",
    question="is the finger cold?",
    decide=decide,
    turn_on=stiffer,
    possible=lambda case: case.scene.specimen.ridges is None,
    after=("ridges",),
    dearer=lambda rules: 3.0,
    shown=(Shown("light", True, PLATE),),
    title="cold fingers",
)
"""
"""All that a user writes."""


@pytest.fixture(scope="module")
def effect(tmp_path_factory):
    path = tmp_path_factory.mktemp("own") / "cold.py"
    path.write_text(FILE)
    return runpy.run_path(str(path))["EFFECT"]


def scene(force="1 gf", **more):
    return scene_of(
        {"stimulus": FLAT, "motion": [{"press_to_force": force}], "accuracy": "draft", **more},
        "own",
    )


def test_an_own_effect_goes_from_scene_to_run(effect):
    """One file: decided with its reason, switched by a scene, paid for in the cost, carried out in
    the run and told by its history.
    """
    plain = plan(scene())
    with registered(effect):
        light, deep = plan(scene()), plan(scene("20 gf"))
        assert light.effects["cold"].on and not deep.effects["cold"].on
        assert "the finger sinks in by" in light.effects["cold"].why
        assert light.predicted_cost_s - RULES.seconds_start == pytest.approx(
            3 * (plain.predicted_cost_s - RULES.seconds_start)
        )
        switched = plan(scene(effects={"cold": "off"})).effects["cold"]
        assert not switched.on and "asked for in the scene (the planner: on" in switched.why
        with pytest.raises(PlanError, match="effects.cold: on, but .*; allowed: off or auto"):
            plan(scene("20 gf", specimen={"ridges": "inner"}, effects={"cold": "on"}))
        cold, warm = simulate(scene()), simulate(scene(effects={"cold": "off"}))
        assert float(cold.indentation_depth[-1]) < 0.9 * float(warm.indentation_depth[-1])
        assert cold.fingerpad.plan.effects["cold"].on and cold.fingerpad.scene == scene()
        assert Plan.from_dict(light.to_dict()).effects == light.effects
    with pytest.raises(ValueError, match="is not a known effect"):
        scene(effects={"cold": "on"})
    assert "cold" not in EFFECTS and "cold" not in NAMES


def test_an_own_effect_goes_into_the_picture_of_the_study(effect):
    """Its scene is run with and without it, and a point with its name stands beside those of the
    choices published.
    """
    choices = pd.read_csv(FIGURES / "studies" / "effects.csv").query("panel == 'planner'")
    with registered(effect):
        frame = assemble(
            study([pair for pair in pairs() if pair.effect == "cold"], repeats=1), choices
        )
        figure = picture(frame)
        assert looks()["cold"][0] == "cold fingers"
    assert frame["change"].iloc[0] > 0.1, "it stiffens the dermis"
    left, _ = figure.axes[:2]
    assert "cold fingers: light" in [text.get_text() for text in left.texts]
    assert "cold" not in looks() and not any(pair.effect == "cold" for pair in pairs())


def test_the_register_is_the_files_and_the_scene_language():
    files = {path.stem for path in Path(effects.__file__).parent.glob("*.py")} - {"__init__"}
    assert files == set(EFFECTS) == set(NAMES) == set(plan(scene()).effects)
    assert all(effect.name == name and effect.question for name, effect in EFFECTS.items())
    order = [effect.name for effect in in_order()]
    assert all(
        order.index(first) < order.index(name)
        for name, effect in EFFECTS.items()
        for first in effect.after
    )
    assert {pair.effect for pair in pairs()} >= {name for name in EFFECTS if EFFECTS[name].shown}


def test_a_tolerance_has_room_for_one_error_only():
    """Small strain that would eat the tolerance beside the mesh's error is not used; where there is
    room, or by hand, it is.
    """
    chosen = plan(scene("0.07 gf", accuracy=0.1))
    assert chosen.effects["finite_strain"].on == (chosen.small_strain_error == 0)
    assert chosen.estimated_error <= 0.1
    by_hand = plan(scene("0.07 gf", accuracy=0.1, effects={"finite_strain": "off"}))
    assert by_hand.small_strain_error > 0


def test_committed_rules_are_those_of_the_planner():
    """Values, decisions and evidence, from the committed data of the study."""
    data = pd.read_csv(FIGURES / "studies" / "effects.csv")
    changes, choices = (data[data["panel"] == panel] for panel in ("changes", "planner"))
    committed = pd.read_csv(
        FIGURES / "tables" / "planner_rules.csv", dtype=str, keep_default_na=False
    )
    assert rules_table(changes, choices).astype(str).to_dict("records") == committed.to_dict(
        "records"
    )

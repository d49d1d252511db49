"""A new effect of the planner is one object: scenes switch it, plans decide on it, runs carry it
out, wrong switches name it.
"""

from pathlib import Path

import pandas as pd
import pytest

from cysyk1999.studies.common.documents import FLAT, scene_of
from cysyk1999.studies.effects.picture import assemble, looks
from cysyk1999.studies.effects.picture import effects as picture
from cysyk1999.studies.effects.run import pairs, study
from fingerpad.planning import effects
from fingerpad.planning.effect import Case, Effect, PlannedEffect, Shown
from fingerpad.planning.effects import EFFECTS, in_order, registered
from fingerpad.planning.plan import RULES, Plan, PlanError, plan
from fingerpad.scenes.effects import EFFECTS as NAMES
from fingerpad.simulation import simulate

pytestmark = pytest.mark.unit
FIGURES = Path(__file__).parents[1] / "figures"


def decide(case: Case) -> Effect:
    light = case.contact.depth < 0.3e-3
    return Effect(
        light and not case.decided["ridges"].on,
        f"the finger sinks in by {case.contact.depth * 1e3:.2g} mm",
    )


EFFECT = PlannedEffect(
    name="cold",
    question="is the finger cold?",
    decide=decide,
    possible=lambda case: case.scene.specimen.ridges is None,
    after=("ridges",),
    dearer=lambda rules: 3.0,
    shown=(Shown("light", True, {"stimulus": FLAT, "motion": [{"press_to_force": "1 gf"}]}),),
    title="cold fingers",
)


def scene(force="1 gf", **more):
    return scene_of(
        {"stimulus": FLAT, "motion": [{"press_to_force": force}], "accuracy": "draft", **more},
        "own",
    )


def test_an_own_effect_goes_from_scene_to_run(monkeypatch):
    """Decided with its reason, switched by a scene, paid for in the cost, carried out in the run
    and told by its history.
    """
    done = []
    effect = PlannedEffect(
        **{**EFFECT.__dict__, "compose": lambda simulation: done.append(simulation.scene.name)}
    )
    plain = plan(scene())
    with registered(effect):
        light, deep = plan(scene()), plan(scene("20 gf"))
        assert (
            light.effects["cold"].on
            and "the finger sinks in by" in light.effects["cold"].why
            and not deep.effects["cold"].on
        )
        assert light.predicted_cost_s - RULES.seconds_start == pytest.approx(
            3 * (plain.predicted_cost_s - RULES.seconds_start)
        )
        off = plan(scene(effects={"cold": "off"}))
        assert (
            not off.effects["cold"].on
            and "asked for in the scene (the planner: on" in off.effects["cold"].why
        )
        with pytest.raises(PlanError, match="effects.cold: on, but .*; allowed: off or auto"):
            plan(scene("20 gf", specimen={"ridges": "inner"}, effects={"cold": "on"}))
        history = simulate(scene())
        assert done == ["own"] and '"cold": {"on": true' in history.attrs["plan"]
        simulate(scene(effects={"cold": "off"}))
        assert done == ["own"]
        assert Plan.from_dict(light.to_dict()).effects == light.effects
    with pytest.raises(ValueError, match="is not a known effect"):
        scene(effects={"cold": "on"})
    assert "cold" not in EFFECTS and "cold" not in NAMES


def test_an_own_effect_goes_into_the_picture_of_the_study():
    """Its scene is run with and without it, and a point with its name stands beside those of the
    choices published.
    """
    choices = pd.read_csv(FIGURES / "studies" / "effects.csv").query("panel == 'planner'")
    with registered(EFFECT):
        frame = assemble(
            study([pair for pair in pairs() if pair.effect == "cold"], repeats=1), choices
        )
        figure = picture(frame)
        assert looks()["cold"][0] == "cold fingers"
    assert frame["change"].iloc[0] == 0, "nothing in a run knows of it"
    left, _ = figure.axes[:2]
    assert "cold fingers: light" in [text.get_text() for text in left.texts]
    assert "cold" not in looks() and not any(pair.effect == "cold" for pair in pairs())


def test_the_register_is_the_files_and_the_scene_language():
    files = {path.stem for path in Path(effects.__file__).parent.glob("*.py")} - {"__init__"}
    assert files == set(EFFECTS) == set(NAMES) == set(plan(scene()).effects)
    assert all(
        effect.name == name and effect.question and effect.shown and effect.title
        for name, effect in EFFECTS.items()
    )
    order = [effect.name for effect in in_order()]
    assert all(
        order.index(first) < order.index(name)
        for name, effect in EFFECTS.items()
        for first in effect.after
    )
    assert {pair.effect for pair in pairs()} >= set(EFFECTS)


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
    from cysyk1999.studies.effects.run import rules_table

    data = pd.read_csv(FIGURES / "studies" / "effects.csv")
    changes, choices = (data[data["panel"] == panel] for panel in ("changes", "planner"))
    committed = pd.read_csv(
        FIGURES / "tables" / "planner_rules.csv", dtype=str, keep_default_na=False
    )
    assert rules_table(changes, choices).astype(str).to_dict("records") == committed.to_dict(
        "records"
    )

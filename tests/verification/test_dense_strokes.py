"""A stroke whose states are chosen, against the same stroke with a state at every output."""

from pathlib import Path

import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.mechanics.contact import Flexibility
from fingerpad.mechanics.stepping import QuasiStatic
from fingerpad.mechanics.strides import Passage
from fingerpad.planning.plan import Plan
from fingerpad.results import states_found
from fingerpad.simulation import Simulation

pytestmark = [pytest.mark.verification, pytest.mark.slow]

SCENES = Path(__file__).parents[2] / "config" / "scenes"


@pytest.fixture(scope="module")
def scene():
    """Corner, convexity and hollow of the thesis's surface, at draft."""
    return load_scene(SCENES / "stroke_sub_10.yaml").varied(
        {"accuracy": "draft", "outputs.snapshots": (), "motion[1].slide": 22e-3}
    )


@pytest.fixture(scope="module")
def every(scene):
    """With a state at every output, and as exact as presses are."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Plan, "between", None)
        patch.setattr(Plan, "newton_tolerance", None)
        return simulate(scene)


@pytest.fixture(scope="module")
def chosen(scene):
    return simulate(scene)


def off(found, truth):
    """Root mean square of a difference over that of the truth."""
    return float(np.sqrt(np.mean((found - truth) ** 2) / np.mean(truth**2)))


def test_fewer_states_say_the_same(every, chosen):
    """At common outputs: what the body does to half a per cent, what the contact does to three,
    with fewer states.
    """
    assert np.array_equal(every.stroke_distance, chosen.stroke_distance) and np.allclose(
        every.time, chosen.time
    )
    assert states_found(every) == every.sizes["time"] - 1 and states_found(
        chosen
    ) < 0.8 * states_found(every)
    for name in (
        "indentation_depth",
        "strain_energy_density",
        "tangential_force",
        "skin_displacement_x",
    ):
        assert off(chosen[name].values, every[name].values) < 0.005, name
    for name, most in (
        ("centre_pressure", 0.02),
        ("contact_pressure", 0.03),
        ("tangential_traction", 0.03),
    ):
        assert off(chosen[name].values, every[name].values) < most, name
    assert off(chosen.contact_width.values, every.contact_width.values) < 0.03
    assert float(chosen.slip.sum()) == pytest.approx(float(every.slip.sum()), rel=0.03)


def test_states_are_found_where_something_happens(chosen):
    """Where the stroke begins and the skin comes to slip, and where the corner at 8 mm arrives and
    leaves.
    """
    found = chosen.stroke_distance.values[chosen.interpolated.values == 0] * 1e3
    ways = np.diff(found[found > 0])
    assert ways.max() <= 0.5 + 1e-9
    quiet = ways[(found[found > 0][1:] > 14) & (found[found > 0][1:] < 18)]
    assert ways[:3].mean() < 0.5 * quiet.mean()


def test_node_by_node_would_be_worse(scene, every, monkeypatch):
    """The mutant: pressures that do not go along with the surface need more states, or say less
    with as many.
    """
    at = Passage.at.__func__

    def straight(cls, *given):
        passage = at(cls, *given)
        return Passage(passage.first, passage.last, passage.share, passage.window, None)

    monkeypatch.setattr(Passage, "at", classmethod(straight))
    monkeypatch.setattr("fingerpad.mechanics.strides.missed", lambda *_: 0.0)
    worse = simulate(scene)
    assert off(worse.contact_pressure.values, every.contact_pressure.values) > 0.035


def test_factors_in_single_precision_will_do(scene):
    """The same states as with factors in double precision, within what is left out of balance."""
    short = scene.varied({"motion[1].slide": 3e-3})
    how = plan(short)
    histories = []
    for single in (True, False):
        run = Simulation(short, how, None)
        assert run.stepper.settings.single
        run.stepper._single = single
        run.stepper._set_zone(run.stepper._range.start, run.stepper._range.stop)
        histories.append(run.run(None))
    one, two = histories
    assert int(one.newton_iterations.sum()) <= 1.1 * int(two.newton_iterations.sum())
    assert off(one.contact_pressure.values, two.contact_pressure.values) < 2e-3
    assert off(one.strain_energy_density.values, two.strain_energy_density.values) < 2e-4
    assert not np.array_equal(one.contact_pressure.values, two.contact_pressure.values)


def test_what_the_skin_yields_to_is_inverted_as_often_as_factors_change(scene, monkeypatch):
    """Not in every iteration: the geometric term of the contact is kept with the factors. Answers
    are as if it was not.
    """
    short, made = scene.varied({"motion[1].slide": 3e-3}), []
    of = Flexibility.of.__func__
    monkeypatch.setattr(
        Flexibility, "of", classmethod(lambda cls, *given: made.append(1) or of(cls, *given))
    )
    run = Simulation(short, plan(short), None)
    kept, inverted, iterations = run.run(None), len(made), run.stepper.total_iterations
    assert run.stepper.factorisations <= inverted < 0.5 * iterations
    iterate = QuasiStatic.iterate

    def forgetting(stepper, *given, **named):
        stepper._flexible = None
        return iterate(stepper, *given, **named)

    monkeypatch.setattr(QuasiStatic, "iterate", forgetting)
    anew = Simulation(short, plan(short), None).run(None)
    assert int(kept.newton_iterations.sum()) <= 1.1 * int(anew.newton_iterations.sum())
    assert off(kept.strain_energy_density.values, anew.strain_energy_density.values) < 2e-4
    assert off(kept.contact_pressure.values, anew.contact_pressure.values) < 2e-3


def test_a_press_is_condensed_once():
    """Onto what the plan says will touch, however little of it touches at first; a stroke follows
    its contact.
    """
    scene = load_scene(SCENES / "ramp40_k210.yaml")
    run = Simulation(scene, plan(scene), None)
    wide = run.stepper._wide
    run.run(None)
    assert run.stepper._wide is wide

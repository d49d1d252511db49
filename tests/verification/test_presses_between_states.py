"""Outputs of a press and hold between the states that its accuracy needs, beside a run that finds a
state at every one.
"""

from dataclasses import replace

import numpy as np
import pytest

from cysyk1999.studies.accuracy.edges import kinks
from fingerpad import load_scene, plan, simulate
from fingerpad.results import leg_ends, states_found

pytestmark = pytest.mark.verification

CLOSE = {
    "indentation_depth": 5e-4,
    "force": 1e-6,
    "contact_width": 3e-3,
    "centre_pressure": 5e-4,
    "strain_energy_density": 5e-4,
    "stored_energy": 1e-3,
}
"""What may be between the two, over the largest value: steps twice as long, and of a width what
nodes make of it.
"""


@pytest.mark.parametrize("surface", ["flat", "k315"])
def test_outputs_between_states_are_those_that_are_solved_for(surface):
    """Mutants: splines over numbers of outputs instead of time; nodes that stay, or those that
    come, carried with the edge.
    """
    scene = load_scene(f"config/scenes/ramp40_{surface}.yaml")
    own = plan(scene)
    assert (own.every, own.outputs, own.steps) == (2, 80, 45) and own.states_per_leg == 20
    found, solved = simulate(scene, own), simulate(scene, replace(own, every=1))
    between = found["interpolated"].values > 0
    assert between.sum() == 35 and states_found(found) == 45 and states_found(solved) == 80
    np.testing.assert_allclose(found.time, solved.time)
    for name, least in CLOSE.items():
        scale = np.abs(solved[name].values).max()
        assert np.abs(found[name].values - solved[name].values).max() < least * scale, name
    apart = np.linalg.norm(
        found["contact_pressure"].values - solved["contact_pressure"].values, axis=1
    )
    assert (apart < 0.03 * np.linalg.norm(solved["contact_pressure"].values, axis=1) + 1e-9).all()
    assert found.newton_iterations.sum() < 0.8 * solved.newton_iterations.sum()
    assert (leg_ends(found)["interpolated"] == 0).all()
    assert max(kinks(found).values()) < 3e-3
    pressure, hold = (
        found["contact_pressure"].values,
        np.flatnonzero(between & (found["leg"].values == 1)),
    )
    sides = pressure[hold - 1], pressure[hold + 1]
    out = np.maximum(np.minimum(*sides) - pressure[hold], pressure[hold] - np.maximum(*sides))
    assert (
        out.max() < 1e-3 * pressure.max()
    )  # nodes at the edge of a contact that hardly grows neither jump nor bounce


def test_no_more_states_than_the_accuracy_needs_unless_steps_are_given():
    scene = load_scene("config/scenes/ramp40_k210.yaml")
    each = scene.varied({"accuracy": {"steps": 80}})
    assert plan(each).every == 1 and plan(scene.varied({"outputs.per_leg": None})).every == 1
    fine = scene.with_accuracy("fine").varied({"outputs.per_leg": 160})
    assert plan(fine).every == 4 and plan(fine).outputs == 320
    assert plan(scene.with_accuracy("fine").varied({"outputs.per_leg": 79})).every == 1

"""The dense frictional problem: Coulomb's and Signorini's conditions, limits, and what it costs to
leave it out.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fingerpad import load_scene, simulate
from fingerpad.mechanics.contact import ContactError, tangents
from fingerpad.mechanics.friction import Coulomb
from fingerpad.results import FRICTION_VARIABLES
from test_contact import check_laws, problem, rows_of, zone_of
from test_contact import solve as frictionless

pytestmark = pytest.mark.unit

COUNT = 12


def solve(parts, coefficient, motion=0.0, state=None, law=None, **control):
    """Solution of the whole zone, from no contact unless a law with states is given."""
    zone, schur, right, gap, gradient = parts
    law = law or Coulomb(coefficient, len(gap))
    if state is not None:
        law.state[:] = state
    rows, zero = rows_of(zone, gap, gradient), np.zeros(len(gap))
    active, motion = np.full(len(gap), state is not None), zero[:, None] + motion
    return law.solve(rows, schur, right, zero, active, motion, **control)


def tilted(parts, seed):
    """The same problem under a profile whose normals vary from node to node."""
    angle = np.random.default_rng(seed).uniform(-0.4, 0.4, len(parts[3]))
    return (*parts[:4], np.column_stack([np.sin(angle), -np.cos(angle)]))


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 1.0), st.floats(-1.0, 1.0), st.floats(0.01, 100))
def test_stiffness_is_that_of_the_force_while_all_nodes_stay_as_they_are(
    seed, coefficient, shift, force
):
    """Against two solutions a little higher and lower, where no node changes its state."""
    parts = tilted(problem(seed, COUNT), seed)
    motion = [shift, 0.0]
    step, gradient = solve(parts, coefficient, motion, force=force), parts[4]
    h = 1e-7 * max(abs(step.depth_change), 1e-6)
    sides = [
        solve(parts, coefficient, motion, depth_change=step.depth_change + way) for way in (-h, h)
    ]
    if all(
        (side.active == step.active).all() and (side.state == step.state).all() for side in sides
    ):
        low, high = (
            -np.sum(s.force * gradient[:, 1] + s.tangential * tangents(gradient)[:, 1])
            for s in sides
        )
        assert step.stiffness == pytest.approx((high - low) / (2 * h), rel=1e-4)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 1.5), st.floats(-1.0, 1.0), st.floats(0.01, 100))
def test_every_condition_holds(seed, coefficient, shift, force):
    """Equilibrium, no pull, no penetration, |tau| <= mu f, slip only at the limit and against
    friction, the load carried.
    """
    parts = tilted(problem(seed, COUNT), seed)
    motion = [shift, 0.0]
    step = solve(parts, coefficient, motion, force=force)
    check_laws(parts, step, force, coefficient, motion)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.integers(0, 3**COUNT - 1), st.floats(0.05, 0.6))
def test_solution_does_not_depend_on_the_first_guess(seed, guess, coefficient):
    """For small coefficients there is one solution, whatever states the exchange starts from."""
    parts = problem(seed, COUNT)
    motion = [1e-2, 0.0]
    state = np.array([guess // 3**i % 3 - 1 for i in range(COUNT)], np.int8)
    reference, other = (
        solve(parts, coefficient, motion, state=start, force=1.0) for start in (None, state)
    )
    np.testing.assert_allclose(other.force, reference.force, atol=1e-8)
    np.testing.assert_allclose(other.tangential, reference.tangential, atol=1e-8)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(["force", "depth_change"]))
def test_without_friction_it_is_the_frictionless_problem(seed, control):
    """A coefficient of zero gives what the frictionless solver gives, under force and depth
    control.
    """
    parts = tilted(problem(seed, COUNT), seed)
    value = 1.3 if control == "force" else 5e-3
    step = solve(parts, 0.0, 0.1, **{control: value})
    plain = frictionless(parts, **{control: value})
    np.testing.assert_allclose(step.force, plain.force, atol=1e-9)
    np.testing.assert_allclose(step.condensed_displacement, plain.condensed_displacement, atol=1e-9)
    assert not step.tangential.any() and step.depth_change == pytest.approx(plain.depth_change)


def test_a_small_shift_sticks_and_a_large_one_slides():
    """Friction grows with the shift, up to mu times the normal force at every node, and turns with
    it.
    """
    parts, grown = problem(3, COUNT), []
    for shift in (-1e-6, 1e-6, 1e-3, 10.0, -10.0):
        motion = [shift, 0.0]
        step = solve(parts, 0.4, motion, force=2.0)
        f, tau, _ = check_laws(parts, step, 2.0, 0.4, motion)
        grown.append(-tau.sum() / f.sum())
    assert grown[3] == pytest.approx(0.4) and grown[4] == pytest.approx(-0.4)
    assert grown[0] < grown[1] < grown[2] < grown[3] and grown[1] < 0.4


@pytest.mark.parametrize("seed", [0, 2, 3])
def test_large_coefficients_stick(seed):
    """Where nothing can slip the touching nodes go with the profile."""
    parts = problem(seed, COUNT)
    motion = [1e-5, 0.0]
    step = solve(parts, 5.0, motion, depth_change=8e-3)
    f, _, slip = check_laws(parts, step, float(step.force.sum()), 5.0, motion)
    assert np.all(np.abs(slip[f > 0]) < 1e-10) and np.all(step.state[f > 0] == 0)


def test_a_wall_carries_the_friction_of_a_held_node():
    """A node that cannot move sideways presses without moving; the problem stays regular."""
    equation = np.arange(2 * COUNT).reshape(COUNT, 2)
    equation[0, 0] = -1
    equation[equation >= 0] = np.arange(2 * COUNT - 1)
    _, schur, _, gap, gradient = problem(6, COUNT)
    keep = np.arange(1, 2 * COUNT)
    zone = zone_of(COUNT, equation)
    parts = zone, schur[np.ix_(keep, keep)], np.zeros(2 * COUNT - 1), gap, gradient
    step = solve(parts, 0.8, force=5.0)
    check_laws(parts, step, 5.0, 0.8)
    assert step.force[0] > 0 and step.tangential[0] == 0


def test_nothing_can_carry_a_force_sideways():
    """Without friction a profile met edge-on takes no vertical force, and says so."""
    zone, schur, right, gap, _ = problem(7, COUNT)
    with pytest.raises(ContactError):
        solve((zone, schur, right, gap, np.tile([1.0, 0.0], (COUNT, 1))), 0.0, force=1.0)


def test_states_and_forces_come_back():
    """A saved law comes back after another solution was taken over, and released it holds
    nothing.
    """
    parts = problem(8, COUNT)
    law = Coulomb(0.5, COUNT)
    everything = slice(0, COUNT)
    motion = np.tile([0.1, 0.0], (COUNT, 1))
    step = solve(parts, 0.5, motion, law=law, force=1.0)
    law.accept(everything, step)
    saved, before = law.save(), (law.tangential.copy(), law.state.copy(), law.dissipated)
    law.commit(everything, law.pull(everything, parts[4]), motion)
    assert law.dissipated > 0
    law.accept(everything, solve(parts, 0.5, -motion, law=law, force=3.0))
    assert not np.allclose(law.tangential, before[0])
    law.restore(saved)
    np.testing.assert_array_equal(law.tangential, before[0])
    np.testing.assert_array_equal(law.state, before[1])
    assert law.dissipated == before[2]
    law.release()
    assert not law.tangential.any() and not law.state.any()


# -- what is not wanted costs nothing --------------------------------------------------------------

PRESS, SLIDE = {"press_to_force": "5 gf"}, {"slide": "0.5 mm", "speed": "10 mm/s"}


@pytest.mark.parametrize(
    "motion, friction, wanted",
    [([PRESS], 0.02, False), ([PRESS, SLIDE], 0.0, False), ([PRESS, SLIDE], 0.5, True)],
    ids=["too little for a press", "no friction", "friction"],
)
def test_a_history_without_friction_has_none_of_its_arrays(motion, friction, wanted):
    """That its code is not executed either is seen in test_effects_study."""
    accuracy = {"skin_edge": "0.5 mm", "steps": 4}
    history = simulate(
        load_scene(
            {
                "stimulus": {"shape": "flat"},
                "motion": motion,
                "friction": friction,
                "accuracy": accuracy,
            }
        )
    )
    assert {"tangential_traction", "slip", "contact_state"} & set(history) == (
        set(FRICTION_VARIABLES) if wanted else set()
    )

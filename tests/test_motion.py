"""Motion programmes become steps that end where and when they should."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.scene import Hold, PressToDepth, PressToForce
from fingerpad.stimuli.motion import STEADY, geometric, programme

pytestmark = pytest.mark.unit

GF = 9.80665e-3
RAMP_AND_HOLD = (PressToForce(press_to_force=20 * GF, rate=40 * GF), Hold(hold=2.0))


def test_ramp_and_hold():
    """20 gram-weight at 40 gram-weight per second takes half a second; the hold keeps the force for two."""
    steps = list(programme(RAMP_AND_HOLD, steps=20, contact_length=10e-3))
    assert len(steps) == 40 and steps[19].time == pytest.approx(0.5) and steps[-1].time == pytest.approx(2.5)
    assert steps[19].force == pytest.approx(19.6133) and steps[9].force == pytest.approx(19.6133 / 2)
    assert {step.force for step in steps[20:]} == {steps[19].force} and {step.leg for step in steps[20:]} == {1}
    sizes = np.array([step.dt for step in steps[20:]])
    assert sizes[0] == pytest.approx(steps[0].dt, rel=1e-6) and np.all(np.diff(sizes) > 0)
    np.testing.assert_allclose(sizes[1:] / sizes[:-1], sizes[1] / sizes[0], rtol=1e-9)


@given(st.floats(1e-3, 1e3), st.integers(1, 200), st.floats(1e-6, 1e3))
def test_geometric_steps_sum_to_their_duration(duration, count, first):
    """Whatever the first step, the sizes are positive, never shrink and sum to the duration."""
    sizes = geometric(duration, count, min(first, duration / count))
    assert len(sizes) == count and sizes.sum() == pytest.approx(duration) and sizes.min() > 0
    assert np.all(np.diff(sizes) >= -1e-9 * duration)


def test_steps_are_split_at_snapshots():
    """A step ends at each wanted time, and the load there is on the programme's line."""
    steps = list(programme(RAMP_AND_HOLD, steps=4, contact_length=10e-3, snapshots=(0.3, 1.0)))
    assert any(step.time == 0.3 for step in steps) and any(step.time == 1.0 for step in steps)
    at = next(step for step in steps if step.time == 0.3)
    assert at.force == pytest.approx(0.6 * 19.6133)
    times = np.array([0.0] + [step.time for step in steps])
    np.testing.assert_allclose(np.diff(times), [step.dt for step in steps], atol=1e-12)


def test_press_without_a_rate_takes_no_time():
    """A steady press is load increments to the relaxed state."""
    steps = list(programme((PressToDepth(press_to_depth=1e-3),), steps=20, contact_length=1.0))
    assert {step.dt for step in steps} == {STEADY} and {step.time for step in steps} == {0.0}
    assert steps[-1].depth == 1e-3 and len(steps) == 8


def test_changing_control_starts_from_where_the_pad_is():
    """After a force-controlled leg a depth-controlled one goes on from the depth that was reached."""
    legs = (PressToForce(press_to_force=1.0, rate=2.0), PressToDepth(press_to_depth=1e-3, speed=1e-3))
    steps = list(programme(legs, steps=2, contact_length=1.0, present=lambda: (1.0, 0.6e-3)))
    assert [step.depth for step in steps[2:]] == pytest.approx([0.8e-3, 1e-3])
    assert steps[-1].time - steps[1].time == pytest.approx(0.4)


def test_untimed_hold_is_one_step():
    """Where time does not matter a hold adds one step, not twenty."""
    steps = list(programme(RAMP_AND_HOLD, steps=20, contact_length=1.0, timed=False))
    assert [step.leg for step in steps].count(1) == 1

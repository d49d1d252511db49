"""Motion programmes become steps that end where and when they should."""

from typing import ClassVar

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fingerpad.documents import Problem
from fingerpad.fields import number
from fingerpad.scenes.scene import Hold, PressToDepth, PressToForce, Slide, StepAndRepeat
from fingerpad.stimuli import motion
from fingerpad.stimuli.motion import STEADY, geometric, programme

pytestmark = pytest.mark.unit

GF = 9.80665e-3
RAMP_AND_HOLD = (PressToForce(press_to_force=20 * GF, rate=40 * GF), Hold(hold=2.0))


def test_ramp_and_hold():
    """20 gram-weight at 40 gram-weight per second takes half a second; the hold keeps the force for
    two.
    """
    steps = list(programme(RAMP_AND_HOLD, steps=20, contact_length=10e-3))
    assert (
        len(steps) == 40
        and steps[19].time == pytest.approx(0.5)
        and steps[-1].time == pytest.approx(2.5)
    )
    assert steps[19].force == pytest.approx(19.6133) and steps[9].force == pytest.approx(
        19.6133 / 2
    )
    assert {step.force for step in steps[20:]} == {steps[19].force} and {
        step.leg for step in steps[20:]
    } == {1}
    sizes = np.array([step.dt for step in steps[20:]])
    assert sizes[0] == pytest.approx(steps[0].dt, rel=1e-6) and np.all(np.diff(sizes) > 0)
    np.testing.assert_allclose(sizes[1:] / sizes[:-1], sizes[1] / sizes[0], rtol=1e-9)


@given(st.floats(1e-3, 1e3), st.integers(1, 200) | st.integers(200, 20000), st.floats(1e-6, 1e3))
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
    """A steady press is one step to the relaxed state, or the load increments asked for."""
    for increments in (1, 8):
        steps = list(
            programme(
                (PressToDepth(press_to_depth=1e-3),),
                steps=20,
                contact_length=1.0,
                increments=increments,
            )
        )
        assert {step.dt for step in steps} == {STEADY} and {step.time for step in steps} == {0.0}
        assert steps[-1].depth == 1e-3 and len(steps) == increments


def test_changing_control_starts_from_where_the_pad_is():
    """After a force-controlled leg a depth-controlled one goes on from the depth that was
    reached.
    """
    legs = (
        PressToForce(press_to_force=1.0, rate=2.0),
        PressToDepth(press_to_depth=1e-3, speed=1e-3),
    )
    steps = list(programme(legs, steps=2, contact_length=1.0, present=lambda: (1.0, 0.6e-3)))
    assert [step.depth for step in steps[2:]] == pytest.approx([0.8e-3, 1e-3])
    assert steps[-1].time - steps[1].time == pytest.approx(0.4)


def test_untimed_hold_is_one_step():
    """Where time does not matter a hold adds one step, not twenty."""
    steps = list(programme(RAMP_AND_HOLD, steps=20, contact_length=1.0, timed=False))
    assert [step.leg for step in steps].count(1) == 1


STROKE = (
    PressToForce(press_to_force=0.2, rate=0.4),
    Slide(slide=-8e-3, speed=10e-3),
    Hold(hold=1.0),
)


def test_slide_goes_its_way_at_its_speed_and_keeps_the_force():
    """Equal steps of at most the longest, the distance as time goes; the hold after it stays
    there.
    """
    steps = list(programme(STROKE, steps=4, contact_length=1.0, slide_step=0.3e-3))
    press, slide, hold = ([step for step in steps if step.leg == leg] for leg in range(3))
    assert (len(slide), len(hold)) == (27, 4) and {step.distance for step in press} == {0.0}
    along = np.array([step.distance for step in slide])
    np.testing.assert_allclose(along, -8e-3 / 27 * np.arange(1, 28), rtol=1e-12)
    np.testing.assert_allclose([step.time - 0.5 for step in slide], -along / 10e-3, rtol=1e-9)
    assert {(step.force, step.depth) for step in slide + hold} == {(0.2, None)} and {
        step.distance for step in hold
    } == {-8e-3}
    assert hold[0].dt == pytest.approx(slide[0].dt) and not any(step.fresh for step in steps)
    assert len(list(programme(STROKE, steps=4, contact_length=1.0))) == 12
    assert (
        len(
            [
                s
                for s in programme(STROKE, steps=4, contact_length=1.0, slide_step=0.25e-3)
                if s.leg == 1
            ]
        )
        == 32
    )


def test_snapshots_in_a_slide_stand_where_the_way_is_then():
    """Two cuts of one step: distances on the straight line of the way, the force kept."""
    steps = list(programme(STROKE, steps=1, contact_length=1.0, snapshots=(0.6, 0.9)))
    at = {round(step.time, 9): step for step in steps}
    assert at[0.6].distance == pytest.approx(-1e-3) and at[0.9].distance == pytest.approx(-4e-3)
    assert {at[0.6].force, at[0.9].force, at[1.3].force} == {0.2} and at[1.3].distance == -8e-3
    assert [step.dt for step in steps[1:4]] == pytest.approx([0.1, 0.3, 0.4])


@pytest.mark.parametrize(("keep", "kept"), [("force", (1.5, None)), ("depth", (None, 0.7e-3))])
def test_slide_keeps_what_is_there_when_control_changes(keep, kept):
    """What the leg before did not prescribe is kept at the value that it reached."""
    pressed = {
        "force": PressToDepth(press_to_depth=0.7e-3, speed=1.0),
        "depth": PressToForce(press_to_force=1.5, rate=1.0),
    }
    legs = (pressed[keep], Slide(slide=1e-3, keep=keep))
    steps = list(programme(legs, steps=3, contact_length=1.0, present=lambda: (1.5, 0.7e-3)))
    assert {(step.force, step.depth) for step in steps[3:]} == {kept}
    other = {"force": "depth", "depth": "force"}[keep]  # what was prescribed is kept as prescribed
    same = list(
        programme(
            (pressed[other], Slide(slide=1e-3, keep=keep)),
            steps=3,
            contact_length=1.0,
            present=lambda: (9.0, 9.0),
        )
    )
    assert {(step.force, step.depth) for step in same[3:]} == {kept}


def test_slow_slide_takes_no_time():
    """Without a speed every step of a slide ends relaxed."""
    steps = list(
        programme(
            (PressToForce(press_to_force=1.0), Slide(slide=1e-3)),
            steps=9,
            contact_length=1.0,
            slide_step=1e-4,
        )
    )
    assert (
        {step.dt for step in steps} == {STEADY}
        and {step.time for step in steps} == {0.0}
        and len(steps) == 11
    )


def test_step_and_repeat_presses_afresh_at_every_place():
    """Four fresh steady indentations to the same force, one every millimetre from where the slide
    ended.
    """
    legs = (*STROKE[:2], StepAndRepeat(step=4e-3, every=1e-3), Hold(hold=1.0))
    steps = list(programme(legs, steps=2, contact_length=1.0))
    fresh = [step for step in steps if step.fresh]
    assert [step.leg for step in fresh] == [2] * 4 and {step.dt for step in fresh} == {STEADY}
    assert [step.distance for step in fresh] == pytest.approx(
        [-7e-3, -6e-3, -5e-3, -4e-3], abs=1e-15
    )
    assert {(step.force, step.depth, step.time) for step in fresh} == {(0.2, None, steps[3].time)}
    assert steps[-1].distance == fresh[-1].distance and steps[-1].time == pytest.approx(2.3)
    deep = list(
        programme((PressToDepth(press_to_depth=1e-3), legs[2]), steps=2, contact_length=1.0)
    )
    assert {step.depth for step in deep if step.fresh} == {1e-3}


def test_a_leg_is_one_class(monkeypatch):
    """A leg that only this test knows: its key registers it, its path makes the steps, checks and
    outlook ask its attributes.
    """
    monkeypatch.setattr(motion, "LEGS", dict(motion.LEGS))

    class Tap(motion.Leg):
        """Touch once more, by a share of the depth, and come back."""

        needs_contact = True
        tap: number("a share", 0.0, 1.0)
        speed: ClassVar[None] = None

        def path(self, at, last, reached, how):
            goals = [
                motion.Goal(None, reached.depth * (1 + share), at.distance)
                for share in (self.tap, 0.0)
            ]
            return np.full(2, STEADY), goals, None

        def ahead(self, outlook):
            return outlook

    legs = (PressToDepth(press_to_depth=1e-3), Tap(tap=0.25))
    assert motion.LEGS["tap"] is Tap
    motion.check_programme(legs)
    with pytest.raises(Problem, match="before anything is pressed"):
        motion.check_programme(legs[1:])
    steps = list(programme(legs, steps=4, contact_length=1.0, present=lambda: (1.0, 1e-3)))
    assert [step.depth for step in steps if step.leg == 1] == pytest.approx([1.25e-3, 1e-3])
    assert motion.end_time(legs) == 0.0

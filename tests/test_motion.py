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


def stepped(*legs, steps=4, contact_length=1.0, **how):
    return list(programme(legs, steps=steps, contact_length=contact_length, **how))


def test_ramp_and_hold():
    """20 gram-weight at 40 gram-weight per second takes half a second; the hold keeps the force for
    two.
    """
    steps = stepped(*RAMP_AND_HOLD, steps=20, contact_length=10e-3)
    press, hold = steps[:20], steps[20:]
    assert (press[-1].time, hold[-1].time) == pytest.approx((0.5, 2.5)) and len(hold) == 20
    assert (press[9].force, press[19].force) == pytest.approx((19.6133 / 2, 19.6133))
    assert {(step.leg, step.force) for step in hold} == {(1, press[19].force)}
    sizes = np.array([step.dt for step in hold])
    assert sizes[0] == pytest.approx(press[0].dt, rel=1e-6) and np.all(np.diff(sizes) > 0)
    np.testing.assert_allclose(sizes[1:] / sizes[:-1], sizes[1] / sizes[0], rtol=1e-9)


@given(st.floats(1e-3, 1e3), st.integers(1, 200) | st.integers(200, 20000), st.floats(1e-6, 1e3))
def test_geometric_steps_sum_to_their_duration(duration, count, first):
    """Whatever the first step, the sizes are positive, never shrink and sum to the duration."""
    sizes = geometric(duration, count, min(first, duration / count))
    assert len(sizes) == count and sizes.sum() == pytest.approx(duration) and sizes.min() > 0
    assert np.all(np.diff(sizes) >= -1e-9 * duration)


def test_steps_are_split_at_snapshots():
    """A step ends at each wanted time, and the load there is on the programme's line."""
    steps = stepped(*RAMP_AND_HOLD, contact_length=10e-3, snapshots=(0.3, 1.0))
    times = [step.time for step in steps]
    assert 1.0 in times and steps[times.index(0.3)].force == pytest.approx(0.6 * 19.6133)
    np.testing.assert_allclose(np.diff([0.0, *times]), [step.dt for step in steps], atol=1e-12)


def test_press_without_a_rate_takes_no_time():
    """A steady press is one step to the relaxed state, or the load increments asked for."""
    for increments in (1, 8):
        steps = stepped(PressToDepth(press_to_depth=1e-3), increments=increments)
        assert {(step.dt, step.time) for step in steps} == {(STEADY, 0.0)}
        assert steps[-1].depth == 1e-3 and len(steps) == increments


def test_changing_control_starts_from_where_the_pad_is():
    """After a force-controlled leg a depth-controlled one goes on from the depth that was
    reached.
    """
    force, depth = (
        PressToForce(press_to_force=1.0, rate=2.0),
        PressToDepth(press_to_depth=1e-3, speed=1e-3),
    )
    steps = stepped(force, depth, steps=2, present=lambda: (1.0, 0.6e-3))
    assert [step.depth for step in steps[2:]] == pytest.approx([0.8e-3, 1e-3])
    assert steps[-1].time - steps[1].time == pytest.approx(0.4)


def test_untimed_hold_is_one_step():
    """Where time does not matter a hold adds one step, not twenty."""
    assert [step.leg for step in stepped(*RAMP_AND_HOLD, timed=False)] == [0, 0, 0, 0, 1]


STROKE = (
    PressToForce(press_to_force=0.2, rate=0.4),
    Slide(slide=-8e-3, speed=10e-3),
    Hold(hold=1.0),
)


def test_slide_goes_its_way_at_its_speed_and_keeps_the_force():
    """Equal steps of at most the longest, the distance as time goes; the hold after it stays
    there.
    """
    steps = stepped(*STROKE, slide_step=0.3e-3)
    press, slide, hold = ([step for step in steps if step.leg == leg] for leg in range(3))
    assert (len(slide), len(hold)) == (27, 4) and {step.distance for step in press} == {0.0}
    along = np.array([step.distance for step in slide])
    np.testing.assert_allclose(along, -8e-3 / 27 * np.arange(1, 28), rtol=1e-12)
    np.testing.assert_allclose([step.time - 0.5 for step in slide], -along / 10e-3, rtol=1e-9)
    assert {(step.force, step.depth) for step in slide + hold} == {(0.2, None)}
    assert {step.distance for step in hold} == {-8e-3}
    assert hold[0].dt == pytest.approx(slide[0].dt) and not any(step.fresh for step in steps)
    assert len(stepped(*STROKE)) == 12 and len(stepped(*STROKE, slide_step=0.25e-3)) == 8 + 32


def test_snapshots_in_a_slide_stand_where_the_way_is_then():
    """Two cuts of one step: distances on the straight line of the way, the force kept."""
    steps = stepped(*STROKE, steps=1, snapshots=(0.6, 0.9))
    found = {round(step.time, 9): (step.distance, step.force) for step in steps}
    for time, distance in ((0.6, -1e-3), (0.9, -4e-3), (1.3, -8e-3)):
        assert found[time] == (pytest.approx(distance), 0.2)
    assert [step.dt for step in steps[1:4]] == pytest.approx([0.1, 0.3, 0.4])


@pytest.mark.parametrize(("keep", "kept"), [("force", (1.5, None)), ("depth", (None, 0.7e-3))])
def test_slide_keeps_what_is_there_when_control_changes(keep, kept):
    """What the leg before did not prescribe is kept at the value that it reached; what it did, as
    prescribed.
    """
    by_depth = PressToDepth(press_to_depth=0.7e-3, speed=1.0)
    by_force = PressToForce(press_to_force=1.5, rate=1.0)
    other, same = (by_depth, by_force) if keep == "force" else (by_force, by_depth)
    for press, present in ((other, (1.5, 0.7e-3)), (same, (9.0, 9.0))):
        slide = Slide(slide=1e-3, keep=keep)
        steps = stepped(press, slide, steps=3, present=lambda at=present: at)
        assert {(step.force, step.depth) for step in steps[3:]} == {kept}


def test_slow_slide_takes_no_time():
    """Without a speed every step of a slide ends relaxed."""
    steps = stepped(PressToForce(press_to_force=1.0), Slide(slide=1e-3), slide_step=1e-4)
    assert {(step.dt, step.time) for step in steps} == {(STEADY, 0.0)} and len(steps) == 11


def test_step_and_repeat_presses_afresh_at_every_place():
    """Four fresh steady indentations to the same force, one every millimetre from where the slide
    ended.
    """
    again = StepAndRepeat(step=4e-3, every=1e-3)
    steps = stepped(*STROKE[:2], again, Hold(hold=1.0), steps=2)
    fresh, places = [step for step in steps if step.fresh], [-7e-3, -6e-3, -5e-3, -4e-3]
    assert [step.distance for step in fresh] == pytest.approx(places, abs=1e-15)
    start = steps[3].time
    assert {(step.leg, step.dt, step.time, step.force, step.depth) for step in fresh} == {
        (2, STEADY, start, 0.2, None)
    }
    assert steps[-1].distance == fresh[-1].distance and steps[-1].time == pytest.approx(2.3)
    deep = stepped(PressToDepth(press_to_depth=1e-3), again)
    assert {step.depth for step in deep if step.fresh} == {1e-3}


def test_a_leg_is_one_class(monkeypatch):
    """A leg that only this test knows: its key registers it, its path makes the steps, checks ask
    its attributes.
    """
    monkeypatch.setattr(motion, "LEGS", dict(motion.LEGS))

    class Tap(motion.Leg):
        """Touch once more, by a share of the depth, and come back."""

        needs_contact = True
        tap: number("a share", 0.0, 1.0)
        speed: ClassVar[None] = None

        def path(self, at, last, reached, how):
            depths = reached.depth * (1 + self.tap), reached.depth
            goals = [motion.Goal(None, depth, at.distance) for depth in depths]
            return np.full(2, STEADY), goals

    legs = (PressToDepth(press_to_depth=1e-3), Tap(tap=0.25))
    assert motion.LEGS["tap"] is Tap
    motion.check_programme(legs)
    with pytest.raises(Problem, match="before anything is pressed"):
        motion.check_programme(legs[1:])
    steps = stepped(*legs, present=lambda: (1.0, 1e-3))
    assert [step.depth for step in steps if step.leg == 1] == pytest.approx([1.25e-3, 1e-3])
    assert motion.end_time(legs) == 0.0

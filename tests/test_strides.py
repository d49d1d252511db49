"""How far a stroke goes in one step, and what is said of the contact between the states that are
found.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from fingerpad import simulate
from fingerpad.dense_output import at_outputs
from fingerpad.mechanics.strides import Between, Passage, Strides, Touch, missed
from fingerpad.stimuli.motion import STEADY, Hold, Lift, PressToForce, Step, programme

pytestmark = pytest.mark.unit

X = np.arange(-60, 61) * 67e-6
"""Nodes of the skin, m."""


def hertz(middle=0.0, half_width=0.5e-3, peak=1e4):
    """Pressure (Pa) at the nodes of a smooth contact, (121,)."""
    return peak * np.sqrt(np.maximum(1 - ((X - middle) / half_width) ** 2, 0))


def touch(pressure, distance=0.0, edges=(np.nan, np.nan), drag=0.0):
    return Touch(X, pressure, edges, distance, drag)


def off(found, truth):
    return np.abs(found - truth).sum() / truth.sum()


def passed(first, last, share=0.5):
    """Pressure at a share of the way."""
    return Passage.at(first, last, share, X).pressure(first.pressure, last.pressure)


# --- between two states ---------------------------------------------------------------------------


def test_a_bump_passes_under_the_skin():
    """It goes along with the surface; node by node it would be two halves of a bump."""
    first, last = (
        touch(hertz(0.2e-3), 0.0, (-0.3e-3, 0.7e-3)),
        touch(hertz(-0.2e-3), 0.4e-3, (-0.7e-3, 0.3e-3)),
    )
    for share in (0.25, 0.5, 0.8):
        truth = hertz(0.2e-3 - 0.4e-3 * share)
        found = passed(first, last, share)
        straight = (1 - share) * first.pressure + share * last.pressure
        assert off(found, truth) < 0.012 < 0.1 < off(straight, truth)


def test_a_plate_passes_and_the_contact_stays():
    """Its edges stay where the pad's shape has them, whatever goes by."""
    plate = touch(hertz(half_width=2e-3), 0.0, (-2e-3, 2e-3))
    gone = touch(hertz(half_width=2e-3), 0.25e-3, (-2e-3, 2e-3))
    found = passed(plate, gone)
    assert off(found, plate.pressure) < 0.006
    assert np.array_equal(found > 0, plate.pressure > 0)


def test_a_ripple_inside_goes_along_with_the_surface():
    """Between the edges that stay, what stands out of the surface moves."""

    def rippled(distance):
        return hertz(half_width=3e-3) * (
            1 + 0.3 * np.sin(2 * np.pi * (X + distance) / 0.8e-3) * (np.abs(X) < 1.5e-3)
        )

    first, last = (touch(rippled(d), d, (-3e-3, 3e-3)) for d in (0.0, 0.25e-3))
    found = passed(first, last)
    inside = np.abs(X) < 1.2e-3
    assert off(found[inside], rippled(0.125e-3)[inside]) < 0.03
    assert off((0.5 * (first.pressure + last.pressure))[inside], rippled(0.125e-3)[inside]) > 0.08


def test_a_piece_that_comes_fades_in():
    """A second bump that has come has half its pressure half-way; the first one goes on as if there
    were none.
    """
    alone, both = hertz(-1e-3), hertz(-1e-3) + hertz(2e-3, 0.3e-3, 4e3)
    first, last = touch(alone, 0.0), touch(both, 1e-6)
    found = passed(first, last)
    assert off(found[X < 0], alone[X < 0]) < 0.01
    assert found[X > 0].sum() == pytest.approx(0.5 * both[X > 0].sum(), rel=0.02)


def test_ends_are_the_states():
    first, last = touch(hertz(0.1e-3), 0.0), touch(hertz(-0.1e-3), 0.25e-3)
    for share, state in ((0.0, first), (1.0, last)):
        assert np.allclose(passed(first, last, share), state.pressure, atol=1e-9)
    nowhere = touch(np.zeros(len(X)))
    assert not passed(nowhere, nowhere).any()


# --- the estimate ---------------------------------------------------------------------------------


@pytest.mark.parametrize("ways", [(1e-4, 1e-4), (1e-4, 2e-4), (2e-4, 0.5e-4)])
def test_what_is_missed_is_what_a_parabola_leaves_over_a_line(ways):
    """A pressure that grows as 1 + c s^2 lies c h^2 / 4 off the line through the ends of a way h,
    at most.
    """
    bend = 4e6
    places = np.cumsum([0.0, *ways])
    states = [
        touch(hertz(half_width=2e-3) * (1 + bend * s**2), s * 1e-9, (-2e-3, 2e-3)) for s in places
    ]
    truth = bend * ways[1] ** 2 / 4 / (1 + bend * places[1] ** 2)
    assert missed(*states) == pytest.approx(truth, rel=0.02)


def test_friction_that_sets_in_is_missed_too():
    """Under a plate the pressure tells nothing of the skin that begins to slip."""
    states = [touch(hertz(), s * 1e-4, drag=drag) for s, drag in ((0, 0.0), (1, 0.3), (2, 0.35))]
    still = [touch(hertz(), s * 1e-4, drag=0.35) for s in range(3)]
    assert missed(*states) > 0.08 and missed(*still) < missed(*states) / 2


# --- strides --------------------------------------------------------------------------------------


def outputs(count, way=0.05e-3, leg=1, dt=0.01):
    """Outputs of a slide, of which the last alone must be found."""
    return [
        Step(leg, dt * k, dt, force=1.0, distance=way * k, solved=k == count)
        for k in range(1, count + 1)
    ]


def contact_at(step):
    return touch(hertz(), step.distance)


USUAL = Between(0.25e-3, 0.01)


def walk(steps, error=None, between=USUAL, contact=contact_at):
    """Numbers of outputs passed and found, and the steps, of a walk where ``error(way)`` is what is
    missed over a way (m); None: what is really missed.
    """
    strides, found, last = Strides(iter(steps), between), [], []
    states = 2 * [contact(Step(0, 0.0, 0.0))]
    while (following := strides.next()) is not None:
        step, skipped = following
        now = contact(step)
        way = now.distance - states[-1].distance
        with pytest.MonkeyPatch.context() as patch:
            if error is not None:
                off = error(way)
                patch.setattr("fingerpad.mechanics.strides.missed", lambda *_, off=off: off)
            good = strides.judge(*states, now)
        if not good:
            assert strides.shorten()
            continue
        strides.found(step)
        states = [states[-1], now]
        found.append(len(skipped) + 1)
        last.append(step)
    return found, last


def nothing(way):
    return 0.0


def test_strides_grow_to_the_longest_where_nothing_is_missed():
    found, _ = walk(outputs(200), nothing)
    assert sum(found) == 200 and found[:4] == [1, 2, 4, 5] and set(found[4:-1]) == {5}


def test_strides_are_as_long_as_the_tolerance_allows():
    """What is missed grows with the square of the way: the way settles where it is the
    tolerance.
    """

    def error(way):
        return 0.01 * (way / 0.31e-3) ** 2

    found, _ = walk(outputs(300), error, Between(1e-3, 0.01))
    assert sum(found) == 300 and set(found[6:-1]) == {6}


def test_a_stride_over_an_event_is_taken_back():
    """Where a state is far from what was expected the stride is halved until it is not, or passes
    nothing.
    """
    seen = []

    def error(way):
        seen.append(way)
        return 1.0 if len(seen) > 8 and way > 0.06e-3 else 0.0

    found, _ = walk(outputs(60), error)
    assert sum(found) == 60 and found[:4] == [1, 2, 4, 5] and set(found[8:-1]) == {1}


def test_every_output_is_found_while_stick_turns_to_slip():
    """A touch that sticks in part follows its predecessor by one output; a long stride to it is
    taken back.
    """
    plate = hertz(half_width=2e-3)

    def contact(step):  # from 1 to 2 mm ever less of it sticks
        sticks = float(np.clip((2e-3 - step.distance) / 1e-3, 0, 1))
        return Touch(X, plate, (np.nan, np.nan), step.distance, 0.3, sticks)

    found, steps = walk(outputs(60), None, Between(0.25e-3, 0.05), contact)
    turning = [n for n, step in zip(found, steps, strict=True) if 1.05e-3 < step.distance < 1.95e-3]
    assert set(turning) == {1} and len(turning) >= 17 and max(found) == 5


def test_what_must_be_found_is_found():
    """Ends of legs, snapshots, steps of presses; and every step where nothing is said of what lies
    between.
    """
    pressed = [Step(0, 0.1 * k, 0.1, force=float(k)) for k in (1, 2, 3)]
    slide = outputs(40)
    slide[13] = Step(1, slide[13].time, 0.01, force=1.0, distance=slide[13].distance)
    found, _ = walk(pressed + slide, nothing)
    assert (
        found[:3] == [1, 1, 1] and 17 in np.cumsum(found) and max(found) == 5 and sum(found) == 43
    )
    assert walk(pressed + slide, nothing, None)[0] == [1] * 43


def test_a_leg_begins_with_short_strides():
    """Skin that is stroked back sticks first, however smoothly it has slipped before."""
    back = [
        Step(2, s.time + 0.4, s.dt, force=1.0, distance=2e-3 - s.distance, solved=s.solved)
        for s in outputs(40)
    ]
    found, _ = walk(outputs(40) + back, nothing)
    start = int(np.flatnonzero(np.cumsum(found) == 40)[0]) + 1
    assert found[start - 2] == 5 and found[start : start + 4] == [1, 2, 4, 5]


def test_a_stride_takes_the_time_of_what_it_passes():
    strides = Strides(iter(outputs(10)), USUAL)
    strides._leg, strides._wanted = 1, 0.25e-3
    step, passed = strides.next()
    assert (
        step.dt == pytest.approx(0.05)
        and step.distance == pytest.approx(0.25e-3)
        and [s.time for s in passed] == pytest.approx([0.01, 0.02, 0.03, 0.04])
    )
    steady = Strides(iter(outputs(10, dt=STEADY)), USUAL)
    steady._leg, steady._wanted = 1, 0.25e-3
    assert steady.next()[0].dt == STEADY


# --- histories at all outputs ---------------------------------------------------------------------


def made(count, each=5):
    """Arrays at ``count`` states of a slide, their times and records, with ``each`` outputs to a
    state: a bump that goes along with the surface.
    """
    places, zero = np.arange(1, count + 1) * 0.25e-3, np.zeros(count + 1)
    found = {
        "stroke_distance": np.array([0.0, *places]),
        "leg": np.array([0, *[1] * count]),
        "newton_iterations": np.array([0, *range(3, 3 + count)]),
        "cutbacks": zero.astype(int),
        "min_detF": np.ones(count + 1),
    }
    found |= {
        name: zero.copy()
        for name in (
            "residual",
            "complementarity_error",
            "energy_balance_error",
            "peak_pressure",
            "centre_pressure",
        )
    }
    s = found["stroke_distance"]
    found["indentation_depth"] = 1e-3 + np.sin(2 * np.pi * s / 4e-3) * 1e-4
    found["skin_displacement_x"] = np.zeros((len(s), len(X)))
    found["contact_pressure"] = np.array([hertz(0.5e-3 - d) for d in s])
    found["contact_pressure_smoothed"] = found["contact_pressure"].copy()
    found["tangential_traction"] = 0.35 * found["contact_pressure"]
    found["contact_state"] = np.where(found["contact_pressure"] > 0, 2, 0).astype(np.int8)
    found["slip"] = np.where(found["contact_state"] == 2, np.diff(s, prepend=0.0)[:, None], 0.0)
    records = []
    for place in places:
        between = place - 0.25e-3 * np.arange(each - 1, 0, -1) / each
        steps = tuple(Step(1, 100 * d, 0.0, distance=d, solved=False) for d in between)
        records.append(SimpleNamespace(passed=steps, edges=(0.0 - place, 1e-3 - place)))
    return found, np.append(0.0, 100 * np.array(places)), records


def test_between_states_curves_are_smooth_and_the_contact_goes_along():
    every = np.arange(1, 41) * 0.05e-3
    found, time, records = made(8)
    out, times = at_outputs(found, time, records, X, len(X) // 2)
    assert np.allclose(times, np.append(0, 100 * every)) and np.allclose(
        out["stroke_distance"], np.append(0, every)
    )
    assert (out["interpolated"] == 0).sum() == 9 and out["newton_iterations"].sum() == found[
        "newton_iterations"
    ].sum()
    truth = 1e-3 + np.sin(2 * np.pi * out["stroke_distance"] / 4e-3) * 1e-4
    assert (
        np.abs(out["indentation_depth"] - truth).max() < 5e-8
    )  # straight lines: 1.9e-6, Akima's curves: 4e-7
    bump = np.array([hertz(0.5e-3 - d) for d in out["stroke_distance"]])
    assert np.abs(out["contact_pressure"] - bump).sum() < 0.015 * bump.sum()
    assert out["peak_pressure"] == pytest.approx(out["contact_pressure"].max(axis=1))
    assert np.allclose(out["tangential_traction"], 0.35 * out["contact_pressure"])
    assert np.array_equal(out["contact_state"] > 0, out["contact_pressure"] > 0)
    on = (out["contact_pressure"] > 0) & (np.arange(len(every) + 1) > 0)[:, None]
    assert out["slip"][on].mean() == pytest.approx(0.05e-3)


def test_a_curve_has_a_kink_where_contact_is_lost_and_comes_back():
    """One spline through all states would swing to either side of it, and a force below zero."""
    found, time, records = made(16)
    s = found["stroke_distance"]
    found["force"] = 3.0 * np.maximum(np.abs(s - 2.1e-3) - 0.58e-3, 0.0)
    found["contact_pressure"][found["force"] == 0] = 0.0
    out, _ = at_outputs(found, time, records, X, len(X) // 2)
    place = out["stroke_distance"]
    lost = (place >= s[found["force"] == 0].min()) & (place <= s[found["force"] == 0].max())
    assert lost.any() and (out["force"][lost] == 0).all() and (out["force"] >= 0).all()
    touches = (place <= s[s < 1.52e-3].max()) | (place >= s[s > 2.68e-3].min())
    truth = 3.0 * np.maximum(np.abs(place - 2.1e-3) - 0.58e-3, 0.0)
    np.testing.assert_allclose(out["force"][touches], truth[touches], atol=1e-12)


def test_a_piece_of_contact_in_one_state_alone_leaves_no_wiggle():
    found, time, records = made(8)
    found["contact_pressure"][6, 3] = 1.0
    out, _ = at_outputs(found, time, records, X, len(X) // 2)
    truth = 1e-3 + np.sin(2 * np.pi * out["stroke_distance"] / 4e-3) * 1e-4
    assert np.abs(out["indentation_depth"] - truth).max() < 1e-6


def pressed(times, passed):
    """Arrays at states of a press whose contact grows as Hertz's does under a force that rises
    evenly, and their records.
    """
    time = np.array([0.0, *times])
    width = 4e-3 * np.sqrt(time)
    contact = np.array([hertz(half_width=max(w / 2, 1e-9), peak=1e7 * w) * (w > 0) for w in width])
    kept = {
        name: np.zeros(len(time))
        for name in ("stroke_distance", "residual", "newton_iterations", "cutbacks")
    }
    found = kept | {
        "leg": np.zeros(len(time), int),
        "skin_displacement_x": np.zeros(contact.shape),
        "force": 10 * time,
    }
    found |= {
        "contact_width": width,
        "contact_pressure": contact,
        "contact_pressure_smoothed": contact.copy(),
    }
    found |= {"peak_pressure": 1e7 * width, "centre_pressure": contact[:, len(X) // 2].copy()}
    records = []
    for k, end in enumerate(times):
        steps = tuple(
            Step(0, t, 0.0, force=10 * t, solved=False) for t in passed if time[k] < t < end
        )
        records.append(SimpleNamespace(passed=steps, edges=(0.0, width[k + 1] / 2)))
    return found, time, records


def test_a_press_goes_from_state_to_state_as_its_width_does():
    """Mutants: the contact goes evenly in time; its edges are not told apart from nodes that come
    in; the right half for all.
    """
    every = np.arange(1, 41) / 40
    solved = np.append(every[:10], every[11::2])
    out, times = at_outputs(
        *pressed(solved, np.setdiff1d(every, solved)), X, len(X) // 2, half=True
    )
    assert np.allclose(times, np.append(0, every)) and out["interpolated"].sum() == 15
    width = 4e-3 * np.sqrt(times)
    assert np.abs(out["contact_width"] - width).max() < 1e-4 * width[-1] and np.allclose(
        out["force"], 10 * times
    )
    assert np.abs(out["centre_pressure"] - 1e7 * width).max() < 1e-4 * 1e7 * width[-1]
    for k in np.flatnonzero(out["interpolated"]):
        truth = hertz(half_width=width[k] / 2, peak=1e7 * width[k])
        assert off(out["contact_pressure"][k], truth) < 0.002
        assert np.array_equal(out["contact_pressure"][k] > 0, truth > 0)
        assert out["contact_pressure"][k, len(X) // 2] == pytest.approx(
            out["centre_pressure"][k], rel=1e-12
        )


def test_states_of_a_press_are_found_where_its_accuracy_needs_them():
    """Of 40 outputs of a press the first ten, then every fourth and snapshots, of a hold every
    fourth; of a lift all.
    """
    press, hold = PressToForce(press_to_force=1.0, rate=2.0), Hold(hold=2.0)
    legs = press, hold, Lift(lift=1e-3)
    steps = list(programme(legs, steps=40, contact_length=0.01, snapshots=[0.4125], every=4))
    found = [
        [k for k, step in enumerate((s for s in steps if s.leg == leg), start=1) if step.solved]
        for leg in range(3)
    ]
    assert found == [
        [*range(1, 11), 12, 16, 20, 24, 28, 32, 33, 36, 40],
        [*range(4, 41, 4)],
        [*range(1, 41)],
    ]
    assert all(step.solved for step in programme(legs, steps=40, contact_length=0.01))
    steady = programme(
        [PressToForce(press_to_force=1.0)], steps=40, contact_length=0.01, increments=8, every=4
    )
    assert all(
        step.solved is True for step in steady
    )  # they take no time that anything could lie between


def test_strides_pass_what_need_not_be_found_of_a_press():
    """However far apart states of a stroke may be; what goes wrong is tried again with half as many
    outputs, then with none.
    """
    steps = [Step(0, 0.1 * k, 0.1, force=float(k), solved=k in (1, 8)) for k in range(1, 9)]
    for between in (None, USUAL):
        strides = Strides(iter(steps), between)
        strides.found(strides.next()[0])
        step, passed = strides.next()
        assert (step.force, len(passed)) == (8.0, 6) and step.dt == pytest.approx(0.7)
        sizes = []
        while strides.shorten():
            sizes.append(len(strides.next()[1]) + 1)
        assert sizes == [3, 1]
        strides.found(strides.next()[0])
        assert len(strides.next()[1]) == 5


def test_there_is_no_more_friction_than_there_is_between_states():
    """All of a plate slips from the first state of a stroke on: a spline through the kink there
    swings by 1 % beyond it.
    """
    plate = {
        "stimulus": {"shape": "flat"},
        "friction": 8.78,
        "motion": [{"press_to_force": "0.029 gf"}, {"slide": "2.02 mm"}],
        "accuracy": "draft",
    }
    stroke = simulate(plate).isel(time=slice(10, None))
    assert stroke.interpolated.any() and (stroke.contact_state == 2).any()
    over = np.abs(stroke.tangential_force) / stroke.force - 8.78
    assert abs(float(over.max())) < 1e-6


def test_nothing_changes_where_every_output_was_found():
    found, time, records = made(4, each=1)
    out, times = at_outputs(found, time, records, X, len(X) // 2)
    assert np.array_equal(times, time) and not out["interpolated"].any()
    assert all(np.array_equal(out[name], values) for name, values in found.items())

"""One definition of a burst: on trains made by hand, and the same in every figure and number."""

import doctest

import numpy as np
import pytest

import synthetic
from cysyk1999.measures import responses
from cysyk1999.measures.of_strokes import peaks_apart
from cysyk1999.measures.quantities import (
    BURST_RATE,
    BURST_TIME,
    BURST_WIDTH,
    DISTANCE,
    IMPULSE_RATE,
    TIME,
    TIME_ABOVE,
)
from fingerpad.measures import bursts
from fingerpad.measures.bursts import burst, is_double
from fingerpad.measures.strokes import convexities, passages, place

pytestmark = pytest.mark.unit
MM = 1e-3


def strokes(*trains):
    return [MM * np.array(train, float) for train in trains]


def test_the_example_is_true():
    assert doctest.testmod(bursts).failed == 0


def test_rate_is_that_between_the_first_and_the_last_impulse():
    """Of a regular train it is its rate, wherever the train begins and whatever is silent around
    it.
    """
    for first in (2.0, 2.3):
        train = first + np.arange(5) * 0.8
        assert burst(strokes(train), 20 * MM, 0.0, 50 * MM).rate == pytest.approx(25.0)


def test_strokes_without_a_burst_count_in_the_mean():
    """Two impulses in one stroke of four are no rate of all."""
    found = burst(strokes([1, 2], [1, 1.5, 2, 2.5, 3], [2], []), 10 * MM)
    assert found.rate == pytest.approx((10 + 20 + 0 + 0) / 4) and found.strokes == 2
    assert (found.width, found.impulses) == pytest.approx(((3 + 5 + 1) / 4 * 0.5 * MM, 8 / 4))
    single = burst(strokes([3.2], [3.4], []), 10 * MM)
    assert single == pytest.approx((2 * 0.5 * MM / 3, 0.0, 2 / 3, 0))
    assert burst(strokes([], []), 10 * MM) == (0.0, 0.0, 0.0, 0)
    assert burst(strokes([3.2, 3.2]), 10 * MM).rate == 0.0  # read to 0.1 mm, no time between them


def test_width_counts_the_bins_from_the_first_to_the_last_with_an_impulse():
    """Bins in between that are empty belong to it."""
    for train, bins in (([0.1, 0.4], 1), ([0.4, 0.6], 2), ([0.1, 2.9], 6), ([0.5, 1.0], 2)):
        assert burst(strokes(train), 10 * MM).width == pytest.approx(bins * 0.5 * MM), train
    for begins in (21.5, 43.5):  # where a bin begins, whatever round-off says
        train = np.array([0.0, 10 * begins / 1e4])
        assert burst([train], 10 * MM).width == pytest.approx(begins * MM + 0.5 * MM)
    assert burst(strokes([0.1, 2.9]), 10 * MM, bin_width=MM).width == pytest.approx(3 * MM)
    assert burst(strokes([0.1, 2.9], [0.1]), 10 * MM).width == pytest.approx(1.75 * MM)


def test_impulses_beside_the_stretch_are_of_another_burst():
    found = burst(strokes([1.0, 4.0, 5.0, 7.0]), 10 * MM, 4.0 * MM, 7.0 * MM)
    assert (found.impulses, found.rate) == pytest.approx((2, 10.0))


@pytest.mark.parametrize("wrong", [{"trains": []}, {"speed": 0.0}, {"bin_width": 0.0}])
def test_what_is_no_stroke_is_refused(wrong):
    with pytest.raises(ValueError, match="above 0"):
        burst(**{"trains": strokes([1.0]), "speed": 10 * MM} | wrong)


def test_a_silence_parts_two_bursts():
    assert is_double([0, 1, 2, 6, 7]) and is_double([0, 1, 3, 4])
    assert not is_double([0, 1, 2, 3, 4])  # none
    assert not is_double([0, 1, 2.9, 3.9])  # hardly longer than the others
    assert not is_double([0, 1, 4, 5, 8, 9])  # three bursts
    assert not is_double([0, 1, 5]) and not is_double([0, 4, 5, 6])  # one impulse is no burst
    assert not is_double([]) and not is_double([3.0])


def test_peaks_of_a_histogram_are_more_than_chance():
    d, least = np.arange(9) * 0.5, 2.0
    for counts, apart in (
        ([0, 4, 16, 4, 2, 5, 16, 4, 0], 2.0),
        ([0, 4, 16, 12, 10, 12, 16, 4, 0], np.nan),  # falls by 6, less than twice the root of 16
        ([0, 1, 0, 0, 1, 0, 1, 0, 0], np.nan),  # three impulses
    ):
        n = np.array(counts, float)
        assert peaks_apart(d, n, least * np.sqrt(n)) == pytest.approx(apart, nan_ok=True), counts


# -- in a stroke -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def stroke():
    """Energy of 600 Pa over a known half-width about every convexity's middle, and no other."""
    made = synthetic.stroke("stroke_10")
    under, values = place(made), np.full(made.sizes["time"], 100.0)
    for arc in convexities(made).values():
        near = abs(under - (arc.start + arc.end) / 2) < 0.35 * (arc.end - arc.start)
        values = np.where(near, 600.0, values)
    columns = np.repeat(values[:, None], made.sizes["receptor"], axis=1)
    return made.assign(strain_energy_density=(("time", "receptor"), columns))


def test_bursts_of_a_stroke_are_those_of_its_impulses(stroke):
    """Counted anew, from the impulses that the figures show."""
    _, impulses = responses.impulses_of(stroke)
    assert sorted(impulses["trial"].unique()) == list(range(1, 13))
    found = responses.bursts(stroke).set_index("convexity")
    assert list(found.index) == list(convexities(stroke))
    for label, (start, end) in passages(stroke).items():
        near = impulses[impulses[DISTANCE].between(1e3 * start, 1e3 * end)]
        by_stroke = near.groupby("trial")
        lasted = by_stroke[TIME].max() - by_stroke[TIME].min()
        rates = ((by_stroke.size() - 1) / lasted)[lasted > 0]
        bins = (2 * near[DISTANCE]).astype(int).groupby(near["trial"])
        row = found.loc[label]
        assert row[BURST_RATE] == pytest.approx(rates.sum() / 12)
        assert row[BURST_WIDTH] == pytest.approx(((bins.max() - bins.min() + 1) / 2).sum() / 12)
        assert row[BURST_TIME] == pytest.approx(row[BURST_WIDTH] / 10)


def test_rate_of_a_burst_is_that_of_what_evokes_it(stroke):
    """The level of an energy that neither grows nor falls: what is steep at its ends adds an
    impulse of 30.
    """
    law = responses.ImpulseRate(0.081, 0.0, 150.0, 0.0)
    found, arc = responses.bursts(stroke, law=law).set_index("convexity"), convexities(stroke)["26"]
    assert found.loc["26", BURST_RATE] == pytest.approx(law(600.0, 0.0), rel=0.1)
    lasts = 0.7 * (arc.end - arc.start) / 10e-3
    assert found.loc["26", TIME_ABOVE] == pytest.approx(lasts, abs=0.06)
    assert found.loc["26", BURST_TIME] == pytest.approx(lasts, abs=0.1)


def test_energies_of_another_depth_reach_the_law_by_one_rule(stroke):
    law = responses.ImpulseRate(2 * 0.081, 2 * 0.0182, 150 / 2, 100 / 2)
    half = stroke.assign(strain_energy_density=stroke["strain_energy_density"] / 2)
    for whole, scaled in zip(
        responses.impulses_of(stroke), responses.impulses_of(half, law=law), strict=True
    ):
        columns = [c for c in (TIME, DISTANCE, IMPULSE_RATE) if c in whole]
        assert np.allclose(whole[columns], scaled[columns])

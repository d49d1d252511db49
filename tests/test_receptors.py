"""The laws from skin to impulses: integrals and constants given back, impulses that count right,
sensors, rates, facts.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

import synthetic
from cysyk1999.measures import responses
from cysyk1999.measures.quantities import DISTANCE, SED, TIME
from cysyk1999.receptors import fits
from cysyk1999.receptors.recordings import RATES, read_rates
from cysyk1999.receptors.sensor import TactileSensor, taxel_pressure
from cysyk1999.reference_data import ReferenceDataError
from cysyk1999.studies.receptors import candidate_stimuli as candidates
from cysyk1999.studies.receptors import impulse_rates, sensing
from cysyk1999.studies.receptors import run as study
from fingerpad import load_scene, simulate
from fingerpad.measures.features import energy, ramp_end
from fingerpad.receptors import laws, spikes
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate, SpatialSum, kernel_weights
from fingerpad.receptors.rapidly_adapting import RapidlyAdapting
from fingerpad.reference_solutions import phillips_johnson as half_plane
from fingerpad.scenes.scene import Discretisation

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
PUBLISHED = ROOT / "config" / "reference" / "impulse_rates"
LAW = SpatialSum(r=0.48e-3, per_depth=3.4e4, constant=9.8)


# -- Eq 4-4 ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("reference", [0.0, 0.13e-3, -1.5e-3, 4e-3])
@pytest.mark.parametrize("r", [0.05e-3, 0.5e-3, 20e-3])
def test_kernel_weights_integrate_a_broken_line_exactly(reference, r):
    random = np.random.default_rng(1)
    x = np.sort(random.uniform(-2e-3, 2e-3, 17))
    pressure = random.uniform(0, 1e4, 17)
    points = [p for p in (*x, reference) if x[0] < p < x[-1]]
    exact = quad(
        lambda s: np.interp(s, x, pressure) * np.exp(-abs(s - reference) / r),
        x[0],
        x[-1],
        points=points,
        limit=200,
    )[0]
    assert kernel_weights(x, reference, r) @ pressure == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(
    "touched", [slice(0, 0), slice(0, 1), slice(4, 5), slice(3, 9), slice(16, 17), slice(0, 17)]
)
def test_pressure_is_weighed_where_there_is_some_as_it_is_on_all_of_the_skin(touched):
    random = np.random.default_rng(3)
    x, reference = np.sort(random.uniform(-2e-3, 2e-3, (5, 17))), random.uniform(-1e-3, 1e-3, 5)
    pressure = np.zeros((5, 17))
    pressure[:, touched] = random.uniform(0, 1e4, pressure[:, touched].shape)
    whole = np.sum(kernel_weights(x, reference, LAW.r) * pressure, axis=1)
    assert LAW.weighted_pressure(x, pressure, reference) == pytest.approx(whole, rel=1e-12, abs=0)


def pressure_field(seed, frames=25, nodes=90):
    """Places, pressures and indentations of a contact that grows, its middle wandering."""
    random = np.random.default_rng(seed)
    x = np.linspace(-4e-3, 4e-3, nodes) + np.zeros((frames, 1))
    half = np.linspace(0.3e-3, random.uniform(0.8e-3, 2.5e-3), frames)[:, None]
    middle = np.cumsum(random.normal(0, 5e-5, frames))[:, None]
    pressure = random.uniform(5e3, 2e4) * np.sqrt(np.maximum(1 - ((x - middle) / half) ** 2, 0))
    return x, pressure, np.linspace(1e-4, random.uniform(5e-4, 1e-3), frames)


def samples(law, reference=0.0, count=5):
    fields = [pressure_field(seed) for seed in range(count)]
    return [fits.SkinSample(*field, law.strain_energy(*field, reference), 0.0) for field in fields]


@pytest.mark.parametrize("law", [LAW, SpatialSum(0.17e-3, 1.9e5, 4.9), SpatialSum(3e-3, -2e3, 5.0)])
def test_spatial_constant_and_depth_scaling_are_given_back(law):
    found = fits.spatial_sum(samples(law))
    assert found.r == pytest.approx(law.r, rel=1e-4)
    assert found.per_depth == pytest.approx(law.per_depth, rel=1e-3)
    assert found.constant == pytest.approx(law.constant, rel=1e-3)


def test_without_the_depth_scaling_its_energy_is_not_reproduced():
    made = samples(LAW)
    found = fits.spatial_sum(made, fits.PRESSURE_ONLY)
    assert found.per_depth == 0.0
    left = [
        fits.r_squared(s.energy, found.strain_energy(s.x, s.pressure, s.indentation)) for s in made
    ]
    assert min(left) < 0.98
    misfit = [
        sum(
            (
                (
                    s.energy
                    - SpatialSum(found.r, 0.0, k * found.constant).strain_energy(s.x, s.pressure)
                )
                ** 2
            ).sum()
            for s in made
        )
        for k in (0.98, 1.0, 1.02)
    ]
    assert misfit[1] == min(misfit)
    plain = samples(SpatialSum(LAW.r, 0.0, 30.0))
    assert fits.spatial_sum(plain, fits.PRESSURE_ONLY).r == pytest.approx(LAW.r, rel=1e-4)


def test_the_square_of_the_sum_is_given_back():
    law = SpatialSum(0.8e-3, square=3.0)
    found = fits.spatial_sum(samples(law), fits.SQUARE)
    assert (found.r, found.square) == pytest.approx((law.r, law.square), rel=1e-3)
    assert (found.per_depth, found.constant) == (0.0, 0.0)


def hertzian(half, peaks, depth=915e-6, poisson=0.435, bulk=5e4):
    """A half-plane under Hertz's pressure: energy of volume (Johnson 1985, section 4.2)."""
    x = np.linspace(-3e-3, 3e-3, 601)
    shape = np.sqrt(np.maximum(1 - (x / half) ** 2, 0))
    edges = (x[1:] + x[:-1]) / 2
    along, down, _ = half_plane.strip_stresses(0.0, depth, edges, shape[1:-1])
    mean = peaks * (1 + poisson) * (along + down) / 3
    fields = np.tile(x, (len(peaks), 1)), peaks[:, None] * shape, np.full(len(peaks), 5e-4)
    return fits.SkinSample(*fields, mean**2 / (2 * bulk))


def test_energy_of_volume_in_a_half_plane_follows_the_square_and_not_eq_4_4():
    peaks, halves = np.linspace(1e3, 8e3, 12), (0.3e-3, 0.6e-3, 1.2e-3, 2.4e-3)
    contacts = [hertzian(half, peaks) for half in halves]
    eq_4_4, square = (fits.spatial_sum(contacts, law) for law in (fits.EQ_4_4, fits.SQUARE))
    left = np.array(
        [
            [fits.rms(s.by(law) - s.energy) / fits.rms(s.energy) for s in contacts]
            for law in (eq_4_4, square)
        ]
    )
    assert (left[0] > 0.2).all() and (left[1, 1:] < 0.03).all() and left[1, 0] < 0.13
    for contact in contacts:  # pressed twice as hard: four times the energy
        twice = fits.SkinSample(
            contact.x, 2 * contact.pressure, contact.indentation, contact.energy
        )
        assert twice.by(square) == pytest.approx(4 * contact.by(square))


@pytest.mark.parametrize("shift", [-0.43e-3, 0.0, 1.1e-3])
def test_a_constant_shift_is_given_back(shift):
    sample = samples(LAW, reference=shift, count=1)[0]
    assert fits.constant_shift(LAW, sample) == pytest.approx(shift, abs=2e-6)


# -- Eqs 4-1 to 4-3 --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("law", "constants", "pressure"),
    [
        ("4-1", (2.0, 1e7, 500.0), 4000 + 2000 + 500),
        ("4-1 read without an exponent", (1e6, 1e7, 500.0), 500 + 2000 + 500),
        ("4-2", (1e7, 1e6, 20.0, 500.0), 2000 + 1000 + 4200 + 500),
        ("4-3", (2.0, 1e7, 20.0, 500.0), 4000 + 2000 + 4200 + 500),
    ],
)
def test_pressure_terms_are_what_the_constants_multiply(law, constants, pressure):
    at = {"edge_distance": 0.5e-3, "displacement": 0.2e-3, "speed": 1e-3, "curvature": 210.0}
    assert laws.pressure_terms(law, **at) @ constants == pytest.approx(pressure)


@pytest.mark.parametrize("law", laws.NODE_TERMS)
def test_constants_of_nodal_pressure_are_given_back(law):
    random = np.random.default_rng(2)
    at = {
        "edge_distance": random.uniform(1e-4, 2e-3, 200),
        "displacement": random.uniform(0, 5e-4, 200),
        "speed": random.uniform(0, 2e-3, 200),
        "curvature": random.choice([0.0, 79.0, 210.0, 1260.0], 200),
    }
    terms = laws.pressure_terms(law, **at)
    true = 1000.0 / np.abs(terms).mean(axis=0) * random.choice([-1, 1], terms.shape[1])
    np.testing.assert_allclose(fits.linear(terms, terms @ true), true, rtol=1e-6)


def test_jackknife_of_a_mean_is_the_standard_error_of_the_mean():
    values = np.array([3.0, 5.0, 4.0, 8.0, 6.0])
    (found,) = fits.jackknife(lambda chosen: [np.mean(chosen)], list(values))
    half = 2.7764 * values.std(ddof=1) / np.sqrt(5)
    assert found == pytest.approx([5.2, 5.2 - half, 5.2 + half], rel=1e-4)
    assert np.isnan(fits.jackknife(lambda chosen: [np.mean(chosen)], [1.0, 2.0])[0, 1:]).all()


# -- Eqs 4-5 and 5-1 -------------------------------------------------------------------------------


def test_rate_law_has_the_thesis_constants_and_rectifies_each_term():
    assert THESIS_RATE(250.0, 600.0) == pytest.approx(0.081 * 100 + 0.0182 * 500)
    assert THESIS_RATE(100.0, 600.0) == pytest.approx(0.0182 * 500), (
        "energy below its threshold takes nothing away"
    )
    assert THESIS_RATE(250.0, -5000.0) == pytest.approx(0.081 * 100), "nor does a falling energy"
    assert THESIS_RATE([0.0, 150.0], [0.0, 100.0]).tolist() == [0.0, 0.0]
    assert ImpulseRate(0.081, 0.0182, 150.0, 100.0, spontaneous=3.0)(0.0, 0.0) == 3.0
    assert THESIS_RATE.without_rate()(250.0, 600.0) == pytest.approx(8.1)


def test_a_kink_between_legs_stays_a_jump_of_the_rate():
    time = np.array([0.0, 0.25, 0.5, 0.6, 1.0, 2.5])
    values = np.where(time <= 0.5, 400 * time, 200 - 20 * (time - 0.5))
    t, v, rate = laws.rate_by_leg(time, values, [0, 0, 0, 1, 1, 1])
    assert t.tolist() == [0.0, 0.25, 0.5, 0.5, 0.6, 1.0, 2.5]
    np.testing.assert_allclose(rate, [400, 400, 400, -20, -20, -20, -20])
    assert spikes.integrated(t, rate)[-1] == pytest.approx(values[-1] - values[0])
    blurred = np.gradient(values, time)
    assert blurred[2] != pytest.approx(400) and blurred[2] != pytest.approx(-20)


def test_time_above_a_threshold_is_found_between_samples():
    triangle = ([0.0, 1.0, 3.0], [0.0, 300.0, 0.0])
    assert laws.time_above(*triangle, 150.0) == pytest.approx(1.5)
    assert laws.time_above(*triangle, 0.0) == pytest.approx(3.0)
    assert laws.time_above(*triangle, 300.0) == 0.0
    assert laws.time_above([0, 1, 1, 2], [0, 0, 5, 5], 1.0) == pytest.approx(1.0), (
        "a jump takes no time"
    )


# -- impulses --------------------------------------------------------------------------------------


@given(
    st.lists(st.tuples(st.floats(0.001, 1.0), st.floats(0, 200.0)), min_size=2, max_size=20),
    st.floats(0, 100.0),
)
def test_impulses_number_the_integral_of_the_rate(steps, first):
    time = np.concatenate([[0.0], np.cumsum([dt for dt, _ in steps])])
    rate = np.array([first, *(value for _, value in steps)])
    train = spikes.impulses(time, rate)
    total = spikes.integrated(time, rate)[-1]
    assert abs(len(train) - total) < 1 + 1e-6 and len(train) <= total * (1 + 1e-9)
    assert (np.diff(train) >= 0).all() and (
        len(train) == 0 or time[0] <= train[0] <= train[-1] <= time[-1]
    )
    at = np.searchsorted(time, train, side="right").clip(1, len(time) - 1) - 1
    dt = train - time[at]
    slope = (rate[at + 1] - rate[at]) / np.diff(time)[at]
    grown = spikes.integrated(time, rate)[at] + rate[at] * dt + slope * dt**2 / 2
    np.testing.assert_allclose(grown, np.arange(1, len(train) + 1), atol=1e-6)


def test_variability_is_seeded_and_has_the_variation_asked_for():
    time, rate = [0.0, 400.0], [20.0, 20.0]
    one, again, other = (spikes.impulses(time, rate, 0.3, seed) for seed in (5, 5, 6))
    assert np.array_equal(one, again) and not np.array_equal(one[:50], other[:50])
    intervals = np.diff(one)
    assert intervals.std() / intervals.mean() == pytest.approx(0.3, rel=0.05)
    assert len(one) == pytest.approx(8000, rel=0.02)
    assert np.allclose(np.diff(spikes.impulses(time, rate)), 0.05), (
        "without it the intervals are equal"
    )
    with pytest.raises(ValueError, match="seed"):
        spikes.impulses(time, rate, 0.3)


def test_repetitions_differ_and_the_first_ones_do_not_depend_on_how_many():
    time, rate = np.linspace(0, 8, 200), 20 + 15 * np.sin(np.linspace(0, 20, 200))
    four, twelve = spikes.trains(time, rate, 4, seed=1), spikes.trains(time, rate, 12, seed=1)
    assert all(np.array_equal(a, b) for a, b in zip(four, twelve, strict=False))
    assert len({train.tobytes() for train in twelve}) == 12
    many = spikes.trains(time, rate, 200, seed=2)
    assert np.mean([len(train) for train in many]) == pytest.approx(
        spikes.integrated(time, rate)[-1], abs=0.6
    )
    histogram = spikes.binned_rate(many, np.linspace(0, 8, 41))
    middle = (np.arange(40) + 0.5) * 0.2
    assert abs(histogram - np.interp(middle, time, rate)).max() < 5
    assert histogram.sum() * 0.2 == pytest.approx(np.mean([len(train) for train in many]))


def test_trials_start_anywhere_in_an_interval():
    starts = np.array([train[0] for train in spikes.trains([0.0, 1.0], [20.0, 20.0], 1000, seed=7)])
    assert np.mean((starts > 0.0125) & (starts < 0.0375)) == pytest.approx(0.5, abs=0.06)
    assert np.mean(starts < 0.0125) == pytest.approx(0.25, abs=0.05)


def test_instantaneous_frequency_is_one_over_the_interval():
    train = np.array([0.1, 0.2, 0.6])
    np.testing.assert_allclose(spikes.instantaneous_frequency(train), [10.0, 2.5])
    at = spikes.instantaneous_frequency(train, [0.0, 0.1, 0.15, 0.2, 0.59, 0.6, 1.0])
    np.testing.assert_allclose(at, [0, 10, 10, 2.5, 2.5, 0, 0])
    assert spikes.instantaneous_frequency([0.3], [0.1, 0.4]).tolist() == [0, 0]


@pytest.mark.parametrize("rate, message", [([1, -1], "negative"), ([1, np.nan], "finite")])
def test_impulses_refuse_rates_that_are_none(rate, message):
    with pytest.raises(ValueError, match=message):
        spikes.impulses([0, 1], rate)


def test_rapidly_adapting_law_feels_change_only_in_either_direction_and_saturates():
    law = RapidlyAdapting(threshold=500.0, scale=500.0, highest=100.0)
    assert law([0.0, 500.0, -500.0]).tolist() == [0, 0, 0]
    assert law(2000.0) == law(-2000.0) == pytest.approx(100 * (1 - np.exp(-3)))
    assert law(1e6) == pytest.approx(100.0)


# -- the sensor ------------------------------------------------------------------------------------


def test_sensor_step_by_step_is_the_whole_recording_at_once():
    x, pressure, depth = pressure_field(4)
    time = np.cumsum(np.random.default_rng(0).uniform(0.01, 0.05, len(x)))
    for receptors in (0.0, [-1e-3, 0.0, 0.7e-3]):
        sensor = TactileSensor(x[0], LAW, receptors=receptors)
        stepped = np.array(
            [sensor.step(t, p, d) for t, p, d in zip(time, pressure, depth, strict=True)]
        )
        np.testing.assert_allclose(stepped, sensor.rates(time, pressure, depth))
        sensor.reset()
        assert np.array_equal(sensor.step(time[0], pressure[0], depth[0]), stepped[0])
    value = LAW.strain_energy(x[0], pressure, depth)
    expected = THESIS_RATE(value, np.concatenate([[0], np.diff(value) / np.diff(time)]))
    np.testing.assert_allclose(TactileSensor(x[0], LAW).rates(time, pressure, depth), expected)
    assert expected.max() > 10


def test_constants_hold_for_arrays_of_other_spacing():
    x, pressure, depth = pressure_field(5, nodes=401)
    time, fine = np.linspace(0, 1, len(x)), LAW.strain_energy(x[0], pressure, depth)
    for pitch in (0.1e-3, 0.3e-3):
        edges = np.arange(-4e-3, 4e-3 + pitch / 2, pitch)
        faces = taxel_pressure(x, pressure, edges)
        np.testing.assert_allclose(
            (faces * np.diff(edges)).sum(1), np.trapezoid(pressure, x, axis=1), rtol=5e-3
        )
        centres = (edges[1:] + edges[:-1]) / 2
        np.testing.assert_allclose(
            LAW.strain_energy(centres, faces, depth), fine, rtol=0.03, atol=0.01 * fine.max()
        )
        assert TactileSensor(centres, LAW).rates(time, faces, depth).max() > 0


@pytest.mark.parametrize("x", [[0.0], [0.0, 0.0], [1e-3, 0.0], [[0.0, 1e-3]]])
def test_sensor_refuses_places_that_do_not_increase(x):
    with pytest.raises(ValueError, match="increase"):
        TactileSensor(x, LAW)


# -- gain and threshold ----------------------------------------------------------------------------


@pytest.mark.parametrize("threshold", [-40.0, 5.0, 33.0])
def test_gain_and_threshold_are_given_back_whatever_is_below(threshold):
    stimulus = np.array([60.0, 10.0, 20.0, 40.0, 30.0, 50.0])
    rate = np.maximum(0.4 * (stimulus - threshold), 0)
    found = fits.gain_and_threshold(stimulus, rate)
    assert (found.gain, found.threshold) == pytest.approx((0.4, threshold))
    assert fits.r_squared(rate, found(stimulus)) == pytest.approx(1.0)


def test_leaving_one_out_does_not_see_what_it_predicts():
    stimulus, rate = np.array([1.0, 2.0, 3.0, 4.0]), np.array([2.0, 4.0, 6.0, 8.0])
    spoiled = rate.copy()
    spoiled[2] = 100.0
    groups = np.arange(4)
    assert fits.leave_one_out(stimulus, spoiled, groups)[2] == pytest.approx(6.0)
    assert fits.leave_one_out(stimulus, rate, groups) == pytest.approx(rate)
    together = fits.leave_one_out(
        np.repeat(stimulus, 2), np.repeat(spoiled, 2), np.repeat(groups, 2)
    )
    assert together[4:6] == pytest.approx([6.0, 6.0]), (
        "all rates of a curvature are left out together"
    )


def test_mean_over_time_respects_jumps_and_uneven_samples():
    time, values = [0.0, 0.5, 0.5, 0.6, 2.5], [0.0, 10.0, 4.0, 4.0, 4.0]
    assert responses.time_mean(time, values, 0.5, 2.5) == pytest.approx(4.0)
    assert responses.time_mean(time, values, 0.0, 0.5) == pytest.approx(5.0)
    assert responses.time_mean(time, values, 0.0, 1.0) == pytest.approx((2.5 + 2.0) / 1.0)
    assert responses.time_mean(time, values) == pytest.approx((2.5 + 8.0) / 2.5)


# -- published and recorded rates ------------------------------------------------------------------


ROW = "mine,SA-I,monkey,cylinder,210,,20,40,0,hold,12.5,1.1,,my notebook,microneurography"
HEADER = ",".join(RATES)


def test_a_users_recording_joins(tmp_path):
    (tmp_path / "mine.csv").write_text(f"{HEADER}\n{ROW}\n")
    both = read_rates(PUBLISHED, tmp_path)
    assert len(both) == len(read_rates(PUBLISHED)) + 1
    assert both.iloc[-1]["recording"] == "mine" and both.iloc[-1]["file"] == "mine.csv"
    (tmp_path / "none").mkdir()
    assert read_rates(tmp_path / "none").empty and list(read_rates(tmp_path / "none")) == [
        *RATES,
        "file",
    ]


WRONG = {
    "no unit of window": (
        ROW.replace(",hold,", ",whole,"),
        "column window: 'whole'; allowed: peak, hold, ",
    ),
    "negative rate": (
        ROW.replace("12.5", "-1"),
        "column rate_per_s: '-1'; allowed: a number from 0",
    ),
    "no source": (ROW.replace("my notebook", ""), "column source: ''; allowed: text"),
    "burst of a press": (
        ROW.replace(",hold,", ",burst,"),
        "column window: 'burst'; allowed: peak, hold",
    ),
    "hold of a stroke": (ROW.replace(",40,0,", ",,10,"), "column window: 'hold'; allowed: burst"),
    "twice": (
        f"{ROW}\n{ROW}",
        "the hold of mine at 210 1/m, 20 gf is given twice; allowed: each once",
    ),
}


@pytest.mark.parametrize("row, message", WRONG.values(), ids=WRONG)
def test_a_wrong_recording_is_refused_in_one_line(tmp_path, row, message):
    (tmp_path / "mine.csv").write_text(f"{HEADER}\n{row}\n")
    with pytest.raises(ReferenceDataError) as error:
        read_rates(tmp_path)
    assert (
        message in str(error.value)
        and "\n" not in str(error.value)
        and "mine.csv" in str(error.value)
    )


# -- histories -------------------------------------------------------------------------------------

PRESSED = ("ramp40_flat", "ramp40_k210", "ramp40_k1260", "ramp150_k630", "ramp150_k1260")


@pytest.fixture(scope="module")
def histories():
    scenes = {name: load_scene(ROOT / "config" / "scenes" / f"{name}.yaml") for name in PRESSED}
    finely = {"accuracy": Discretisation(skin_edge=134.4e-6, steps=24)}
    return {name: simulate(scene.model_copy(update=finely)) for name, scene in scenes.items()}


def test_a_kernel_without_decay_sums_the_pressure_to_the_force(histories):
    for name, history in histories.items():
        sample = responses.skin_sample(history, 915e-6)
        total = SpatialSum(1e3, 0.0, 1.0).weighted_pressure(sample.x, sample.pressure)
        late = (
            history.force.values > 0.3 * history.force.values.max()
        )  # contact wider than a few nodes
        np.testing.assert_allclose(total[late], history.force.values[late], rtol=0.05, err_msg=name)


def test_pressure_predicts_the_energy_under_it(histories):
    chosen = [responses.skin_sample(histories[name], 915e-6) for name in PRESSED[:3]]
    law = fits.spatial_sum(chosen)
    assert 0.3e-3 < law.r < 0.7e-3 and law.constant > 0
    for sample in chosen:
        assert (
            fits.r_squared(
                sample.energy, law.strain_energy(sample.x, sample.pressure, sample.indentation)
            )
            > 0.75
        )
    shallow = fits.spatial_sum(
        [responses.skin_sample(histories[name], 600e-6) for name in PRESSED[:3]]
    )
    assert shallow.r < 0.7 * law.r, "the deeper, the wider"
    laws = {responses.SED_LAW: law}
    frame = responses.energy_from_pressure(histories["ramp40_k210"], 915e-6, laws)
    assert fits.r_squared(frame[SED], frame[responses.SED_LAW]) > 0.8
    far = responses.energy_from_pressure(histories["ramp40_k210"], 915e-6, laws, shift=2e-3)
    assert far[responses.SED_LAW].max() < 0.2 * frame[SED].max(), (
        "a receptor that moved away is left alone"
    )


def test_thesis_constants_predict_the_legible_rates(histories):
    """Thesis Fig 4-2: 23.7 and 25.3 impulses/s in the hold after a fast ramp, one monkey receptor,
    nothing fitted here.
    """
    for name, recorded in (("ramp150_k630", 23.7), ("ramp150_k1260", 25.3)):
        assert responses.rate_in(histories[name], "hold") == pytest.approx(recorded, abs=10)


def test_rates_peak_at_the_top_of_the_ramp_and_rise_with_curvature(histories):
    peaks, holds = [], []
    for name in PRESSED[:3]:
        frame = responses.predicted_rate(histories[name])
        top = float(histories[name].time[ramp_end(histories[name])])
        peak, hold, first = (
            responses.rate_in(histories[name], window)
            for window in ("peak", "hold", "first second")
        )
        if name != "ramp40_flat":
            assert frame[TIME][frame[responses.IMPULSE_RATE].idxmax()] == pytest.approx(
                top, abs=0.05
            )
            assert peak > hold > frame[responses.IMPULSE_RATE].iloc[-1] > 0, "it adapts"
        early = spikes.impulses(frame[TIME], frame[responses.IMPULSE_RATE])
        assert (early <= 1.0).sum() == pytest.approx(first, abs=1)
        assert (frame[responses.STATIC] + frame[responses.DYNAMIC]).equals(
            frame[responses.IMPULSE_RATE]
        )
        peaks.append(peak)
        holds.append(hold)
    assert peaks == sorted(peaks) and holds == sorted(holds)


def test_sensor_knows_less_from_pressure_alone(histories):
    table = sensing.sensor_accuracy({name: histories[name] for name in PRESSED[:3]})
    at_nodes = table[table["spacing (mm)"] < 0.3].set_index(["knows", "scene"])[
        "rms_error (impulses/s)"
    ]
    assert (
        len(at_nodes) == 9 and (at_nodes["pressure and indentation"] < at_nodes["pressure"]).all()
    )
    assert (at_nodes["pressure, its sum squared"] < at_nodes["pressure"]).all()
    assert at_nodes["pressure and indentation"].max() < 6
    assert set(table["spacing (mm)"]) >= {0.5, 1.0}


# -- strokes (made up) -----------------------------------------------------------------------------


@pytest.fixture(scope="module")
def stroke():
    return synthetic.stroke("stroke_10")


def test_histogram_of_a_stroke_counts_the_impulses_of_its_raster(stroke):
    frame = responses.predicted_rate(stroke, law=ImpulseRate(0.3, 0.0, 0.0, 0.0))
    impulses = responses.raster(frame, repetitions=12, seed=3)
    histogram = responses.stroke_histogram(frame, impulses, 12)
    assert np.allclose(np.diff(histogram[DISTANCE]), 0.5)
    counted = histogram[responses.IMPULSE_RATE].sum() * 0.05 * 12
    assert counted == pytest.approx((impulses[DISTANCE] > 0).sum(), rel=0.02)


# -- the study on made-up histories ----------------------------------------------------------------


@pytest.fixture(scope="module")
def made_up():
    return synthetic.histories()


def test_the_law_behind_the_energies_is_what_the_study_finds(made_up):
    """Strain energies replaced by what Eq 4-4 makes of the pressure, deeper ones wider."""
    made = {}
    for name, history in made_up.items():
        if not name.startswith("ramp40_"):
            continue
        columns = []
        for depth in history.receptor_depth.values:
            sample = responses.skin_sample(history, depth)
            law = SpatialSum(0.5 * depth, 3e4, 10.0)
            columns.append(law.strain_energy(sample.x, sample.pressure, sample.indentation))
        made[name] = history.assign(
            strain_energy_density=(("time", "receptor"), np.column_stack(columns))
        )
    table = study.receptor_fits(made, {}, read_rates(PUBLISHED))
    assert list(table.columns) == list(study.FIT_COLUMNS)
    r = table[(table["law"] == "4-4") & (table["quantity"] == "r")]
    np.testing.assert_allclose(r["estimate"], 0.5e-3 * r["receptor_depth (um)"], rtol=1e-3)
    assert (
        (r["r_squared"] > 0.999999).all()
        and (r["low_95"] <= r["estimate"]).all()
        and (r["estimate"] <= r["high_95"]).all()
    )
    assert (table.loc[table["law"] == "4-1, a set for each node", "low_95"].notna()).all()
    assert "not compared" not in set(table.loc[table["scenes"].str.contains("20 gf"), "quantity"])


def test_a_candidate_that_made_the_rates_wins(made_up):
    histories = {name: h for name, h in made_up.items() if name.startswith("ramp40_")}
    for name, history in histories.items():
        worse = 0.5 * history["strain_energy_density"] ** 0.5
        deep = {variable for variable, _, at_depth in responses.CANDIDATES.values() if at_depth} - {
            "strain_energy_density"
        }
        histories[name] = history.assign(dict.fromkeys(deep, worse))
    rows = []
    for label in ("79", "158", "315", "630", "1260"):
        history = histories[f"ramp40_k{label}"]
        mean = impulse_rates.windowed(history, history.time.values, energy(history, 915e-6), "hold")
        k = responses.curvature_of(history)
        rows.append(
            f"made up,SA-I,monkey,cylinder,{k},,20,40,0,hold,"
            f"{max(0.1 * (mean - 50), 0)},,,none,none"
        )
    table = candidates.candidate_stimuli(histories, _read(rows))
    best = table.iloc[0]
    assert best["candidate"] == "strain energy, formula of plane stress" and best["rank"] == 1
    assert best["gain (impulses/s per unit)"] == pytest.approx(0.1, rel=1e-3) and best[
        "threshold"
    ] == pytest.approx(50, abs=1)
    assert (
        best["left_out_rms (impulses/s)"]
        < 0.05 * table.loc[table["candidate"] == "curvature", "left_out_rms (impulses/s)"].iloc[0]
    )


def _read(rows):
    import io

    return pd.read_csv(io.StringIO("\n".join([HEADER, *rows])), keep_default_na=True)


def test_uncertain_surfaces_are_read_in_every_way_that_rises():
    rates = read_rates(PUBLISHED / "cysyk_1999.csv")
    ways = impulse_rates.assignments(rates)
    assert len(ways) == 6
    for curvature in ways:
        order = np.argsort(rates["rate_per_s"])
        assert (np.diff(curvature[order]) > 0).all()
    certain = impulse_rates.assignments(rates[rates["or_curvature_per_m"].isna()])
    assert len(certain) == 1 and set(certain[0]) == {1259.84, 629.92}


def test_without_pressed_surfaces_nothing_is_made_up(stroke):
    rates = read_rates(PUBLISHED)
    table = study.receptor_fits({"stroke_10": stroke}, {}, rates)
    assert set(table["quantity"]) <= {
        "A1",
        "A2",
        "threshold of the energy",
        "threshold of the rate",
        "not compared",
    }
    assert candidates.candidate_stimuli({"stroke_10": stroke}, rates).empty
    with pytest.raises(ValueError, match="ramp40_"):
        sensing.sensor_accuracy({"stroke_10": stroke})

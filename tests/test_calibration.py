"""Calibration: what the elastic curve is, what force tells and what it does not, and parameters
given back.
"""

import json
from math import gamma, pi, sqrt
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cysyk1999.publishing.write import read_frame, write_frame, write_picture
from cysyk1999.reference_data import read_force_depth, read_relaxation
from cysyk1999.studies.calibration.force import (
    LENGTHS,
    ElasticCurve,
    calibrate,
    elliptical_patch,
    fit_constant,
    fit_constant_and_length,
    fit_length,
    plane_sections,
    plate_forces,
    ridge_correlation,
    specimen_names,
    write_specimens,
)
from cysyk1999.studies.calibration.least_squares import fit, group_interval
from cysyk1999.studies.calibration.picture import STUDIES
from cysyk1999.studies.calibration.relaxation import (
    WRONG_START,
    RampForce,
    amplitude_design,
    fit_series,
    force_terms,
    relaxing_part,
    series_estimates,
    series_of,
    study,
    volume_share,
    with_series,
)
from fingerpad import load_scene, plan, simulate
from fingerpad.scenes.scene import Discretisation, Hold, Layer, Layers, PressToDepth
from fingerpad.specimen.materials import Prony
from fingerpad.stimuli.motion import geometric

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT / "config" / "reference"
DEPTHS = np.array([0.5, 1.0, 1.5, 2.0]) * 1e-3
LENGTH = 0.0114
THESIS = Prony((0.055, 0.3691), (3.25, 0.3414))


def scene(name):
    return load_scene(ROOT / "config" / "scenes" / f"{name}.yaml")


def drafted(name, **changes):
    rough = scene(name).model_copy(
        update={"accuracy": Discretisation(skin_edge=268.8e-6, steps=40), **changes}
    )
    return simulate(rough)


@pytest.fixture(scope="module")
def plate():
    return drafted("calibration_plate")


@pytest.fixture(scope="module")
def long_term():
    return drafted("calibration_long_term")


@pytest.fixture(scope="module")
def ramp():
    return drafted("calibration_ramp_hold")


@pytest.fixture(scope="module")
def curve(plate):
    return ElasticCurve.from_history(plate)


@pytest.fixture(scope="module")
def data():
    return read_force_depth(REFERENCE / "force_depth")


# -- the elastic curve ---------------------------------------------------------------------------------------------------


def scaled(factors):
    base = scene("calibration_plate")
    layers = base.specimen.layers
    changed = Layers(
        **{
            name: Layer(
                youngs_modulus=factor * (old := getattr(layers, name)).youngs_modulus,
                poisson_ratio=old.poisson_ratio,
            )
            for name, factor in factors.items()
        }
    )
    return drafted(
        "calibration_plate", specimen=base.specimen.model_copy(update={"layers": changed})
    )


def test_force_is_proportional_to_a_factor_common_to_all_moduli_at_finite_strain(plate):
    assert json.loads(plate.attrs["plan"])["effects"]["finite_strain"]["on"]
    softer = scaled({"epidermis": 0.4, "dermis": 0.4, "fat": 0.4})
    np.testing.assert_allclose(softer.force, 0.4 * plate.force, rtol=1e-6)
    np.testing.assert_allclose(softer.contact_width, plate.contact_width, rtol=1e-6)
    one_layer = scaled(
        {"epidermis": 1.0, "dermis": 0.4, "fat": 0.4}
    )  # the ratio not kept: another curve, not only lower
    assert np.ptp((one_layer.force / plate.force).values[1:]) > 0.005
    assert abs(one_layer.contact_width / plate.contact_width - 1).values[1:].max() > 0.01


def test_a_steady_scene_needs_no_time_and_equals_a_long_hold():
    steady = scene("calibration_plate").model_copy(
        update={"motion": (PressToDepth(press_to_depth=1e-3),), "accuracy": "draft"}
    )
    decided = plan(steady)
    assert (
        not decided.timed
        and not decided.effects["viscoelasticity"].on
        and decided.state == "long_term"
    )
    assert "steady" in decided.effects["viscoelasticity"].why
    press = PressToDepth(press_to_depth=1e-3, speed=2e-3)
    held = steady.model_copy(update={"motion": (press, Hold(hold=1000.0))})
    assert plan(held).timed and plan(held).effects["viscoelasticity"].on
    relaxed, at_once = simulate(held).isel(time=-1), simulate(steady).isel(time=-1)
    for name in ("force", "contact_width", "centre_pressure", "peak_pressure"):
        assert float(relaxed[name]) == pytest.approx(float(at_once[name]), rel=1e-3), name
    np.testing.assert_allclose(relaxed.skin_displacement_y, at_once.skin_displacement_y, atol=1e-6)
    hasty = simulate(steady.model_copy(update={"motion": (press, Hold(hold=1.0))}))
    assert float(hasty.force[-1]) > 1.02 * float(at_once.force)


def test_curve_passes_through_its_points_and_ends_where_the_simulation_ends(curve):
    np.testing.assert_allclose(curve.force_at(curve.depth), curve.force)
    assert (np.diff(curve.force_at(np.linspace(0, 2.5e-3, 400))) > 0).all()
    with pytest.raises(
        ValueError, match="a depth of 3 mm is beyond the elastic curve, 0 to 2.5 mm"
    ):
        curve.force_at(3e-3)


# -- the constant --------------------------------------------------------------------------------------------------------


def synthetic(curve, s, seed, noise=0.01):
    clean = s * LENGTH * curve.force_at(DEPTHS)
    sigma = noise * clean.max()
    return clean + np.random.default_rng(seed).normal(0, sigma, len(clean)), sigma


@pytest.mark.parametrize("start", [1.0, 0.01, 50.0])
def test_constant_is_given_back_inside_its_interval_from_any_start(curve, start):
    force, sigma = synthetic(curve, 0.4, seed=3)
    found = fit_constant(curve, DEPTHS, force, LENGTH, start=start, sigma=sigma)
    low, high = found.intervals()[0]
    assert low < 0.4 < high and high / low < 1.05
    stiffer = ElasticCurve(curve.depth, 1.2 * curve.force, curve.width)
    low, high = fit_constant(stiffer, DEPTHS, force, LENGTH, start=start, sigma=sigma).intervals()[
        0
    ]
    assert not low < 0.4 < high


@pytest.mark.parametrize("known", [True, False])
def test_intervals_of_the_constant_cover_what_they_promise(curve, known):
    hits = 0
    for seed in range(300):
        force, sigma = synthetic(curve, 0.4, seed)
        low, high = fit_constant(
            curve, DEPTHS, force, LENGTH, sigma=sigma if known else None
        ).intervals()[0]
        hits += low < 0.4 < high
    assert 0.92 <= hits / 300 <= 0.98


def test_force_tells_the_product_of_constant_and_length_and_nothing_of_either(curve):
    force, sigma = synthetic(curve, 0.4, seed=5)
    fits = [
        fit_constant_and_length(curve, DEPTHS, force, {"s": s, "length": length}, sigma)
        for s, length in ((1, 0.01), (0.1, 0.2))
    ]
    products = [float(np.prod(found.values)) for found in fits]
    assert (
        products[0] == pytest.approx(products[1], rel=1e-6) == pytest.approx(0.4 * LENGTH, rel=0.05)
    )
    assert abs(np.log(fits[0].values[0] / fits[1].values[0])) > 0.5, (
        "the start decides where on the ridge a fit ends"
    )
    for found in fits:
        assert ridge_correlation(found) < -0.999
        assert np.linalg.matrix_rank(found.jacobian, tol=1e-9 * abs(found.jacobian).max()) == 1

    def with_width(
        p,
    ):  # were the length known to grow with the width by a part of its own, the two would part
        constant, patch = curve.force_at(DEPTHS), curve.force_at(DEPTHS) * curve.width_at(DEPTHS)
        return p[0] * constant + p[1] * patch, np.column_stack([constant, patch])

    other = fit(with_width, force, {"a": 0.4 * LENGTH, "b": 0.1}, sigma=sigma)
    assert np.linalg.matrix_rank(other.jacobian, tol=1e-9 * abs(other.jacobian).max()) == 2


def test_lengths_have_their_closed_forms():
    depth, n, radius = np.linspace(0, 2.5e-3, 26), 1.6, 0.008
    power = ElasticCurve(depth, 1e6 * depth**n, 2.0 * depth)
    exact = sqrt(2 * radius * 1e-3) * sqrt(pi) * gamma(n + 1) / gamma(n + 1.5)
    assert plane_sections(power, 1e-3, radius) == pytest.approx(exact, rel=2e-3)
    assert elliptical_patch(power, 1e-3, 1.5) == pytest.approx(pi / 4 * 1.5 * 2e-3, rel=1e-3)


def test_measured_force_asks_for_a_length_that_grows(curve, data):
    group = plate_forces(data)["mean"]
    depth, force = group["depth_mm"].to_numpy() * 1e-3, group["force_N"].to_numpy()
    fits = {model: fit_length(curve, depth, force, model) for model in LENGTHS}
    assert (np.diff(force / curve.force_at(depth)) > 0).all()
    assert (np.sign(fits["constant length"].residual) == [-1, -1, -1, 1]).all()
    assert fits["elliptical patch"].rss < 0.5 * fits["constant length"].rss
    assert fits["elliptical patch"].aicc < fits["constant length"].aicc - 3
    assert fits["plane sections"].aicc < fits["elliptical patch"].aicc


def test_group_interval_is_students():
    assert group_interval([2.0, 2.0, 2.0]) == pytest.approx((2.0, 2.0, 2.0))
    middle, low, high = group_interval([1.0, np.e**2])
    assert np.log([middle, low, high]) == pytest.approx([1.0, 1 - 12.706, 1 + 12.706], rel=1e-3)


def test_fits_refuse_what_they_cannot_answer(curve):
    with pytest.raises(ValueError, match="1 data cannot give 1 parameters"):
        fit_constant(curve, DEPTHS[:1], [0.1], LENGTH)
    with pytest.raises(ValueError, match="positive"):
        fit_constant(curve, DEPTHS, [0.1, 0.2, 0.3, 0.4], LENGTH, start=0.0)


# -- the whole study -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def result(plate, long_term, data):
    return calibrate({"calibration_plate": plate, "calibration_long_term": long_term}, {}, data)


def estimate(result, study_name, quantity, subject="mean"):
    table = result.estimates
    rows = table[
        (table["study"] == study_name)
        & (table["quantity"] == quantity)
        & (table["subject"] == subject)
    ]
    assert len(rows) == 1
    return float(rows["estimate"].iloc[0])


def test_study_fits_every_subject_and_the_mean(result):
    assert list(result.constants) == ["1", "2", "3", "4", "mean"]
    assert all(0.4 < found.values[0] < 1.3 for found in result.constants.values())
    assert estimate(result, "stated in the thesis", "modulus constant") == 1.0
    assert (
        estimate(result, "cost", "finite element simulations for all fits of the constant", "") == 1
    )
    assert max(found.evaluations for found in result.constants.values()) <= 60


def test_moduli_read_as_long_term_are_smaller_by_less_than_all_that_relaxes(result):
    ratio = estimate(
        result, "moduli read as long-term", "constant over that of the instantaneous reading"
    )
    assert THESIS.g_infinity < ratio < 1 / 1.4


def test_a_further_subject_joins(plate, data, tmp_path):
    forces = 0.5 * LENGTH * ElasticCurve.from_history(plate).force_at(DEPTHS)
    rows = "\n".join(
        f"me,flat plate,{1e3 * d:g},0,{f},x,y" for d, f in zip(DEPTHS, forces, strict=True)
    )
    (tmp_path / "mine.csv").write_text(
        f"subject,indenter,depth_mm,speed_mm_per_s,force_N,source,how_obtained\n{rows}\n"
    )
    mine = calibrate({"calibration_plate": plate}, {}, read_force_depth(tmp_path))
    assert mine.constants["me"].values[0] == pytest.approx(0.5, rel=1e-6)
    for name in ("fit", "identifiability", "residuals"):  # one subject, no mean
        assert STUDIES[f"calibration_{name}"](getattr(mine, name)).axes
    assert (
        "me"
        in calibrate(
            {"calibration_plate": plate}, {}, pd.concat([data, read_force_depth(tmp_path)])
        ).constants
    )


def test_data_without_plate_forces_are_refused(data):
    with pytest.raises(ValueError, match="no steady force"):
        plate_forces(data[data["indenter"] != "flat plate"])
    with pytest.raises(ValueError, match="subject '1' has one steady force"):
        plate_forces(data[data["indenter"] == "flat plate"].groupby("subject").head(1))


@pytest.mark.parametrize("name", STUDIES)
def test_pictures_are_functions_of_the_saved_data_and_say_where_they_are_from(name, tmp_path):
    frame = read_frame(ROOT / "figures" / "studies" / f"{name}.csv")
    assert frame["source"].str.match("simulated|measured|stated|assumed").all()
    drawn = STUDIES[name](frame)
    words = " ".join(text.get_text() for text in drawn.texts).lower()
    assert "simulated" in words
    assert ("measured" in words) == (
        name != "calibration_prony"
    ) or "no measured time courses" in words
    write_picture(drawn, tmp_path / "a.png", dpi=60)
    write_frame(frame, tmp_path / "b.csv")
    write_picture(STUDIES[name](read_frame(tmp_path / "b.csv")), tmp_path / "b.png", dpi=60)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


# -- specimens -----------------------------------------------------------------------------------------------------------


def test_a_scene_names_a_calibrated_specimen(result, plate, data, tmp_path):
    folder = tmp_path / "config" / "specimens"
    specimen = json.loads(plate.attrs["scene"])["specimen"]
    paths = write_specimens(folder, result, specimen, data)
    assert [path.stem for path in paths] == [
        *(f"calibrated_subject_{n}" for n in "1234"),
        "calibrated_mean",
    ]
    (tmp_path / "mine.yaml").write_text(
        "specimen: {layers: calibrated_subject_2}\nstimulus: {shape: flat}\nmotion: [{press_to_depth: '1 mm'}]\n"
    )
    named = load_scene(tmp_path / "mine.yaml").specimen
    s = result.constants["2"].values[0]
    assert named.layers.epidermis.youngs_modulus == pytest.approx(150e3 * s, rel=1e-5)
    assert named.layers.fat.youngs_modulus == pytest.approx(15e3 * s, rel=1e-5)
    assert named.moduli == "instantaneous" and named.contact_length == LENGTH
    assert "force alone tells only their product" in paths[0].read_text()


def test_committed_specimens_are_those_of_the_committed_table(tmp_path):
    table = pd.read_csv(ROOT / "figures" / "tables" / "calibration.csv", dtype={"subject": str})
    chosen = table[
        (table["study"] == "constant") & (table["quantity"] == "Young's modulus of the epidermis")
    ]
    assert len(chosen) == 5
    for row, name in zip(
        chosen.itertuples(), specimen_names(chosen["subject"]).values(), strict=True
    ):
        (tmp_path / "mine.yaml").write_text(
            f"specimen: {{layers: {name}}}\nstimulus: {{shape: flat}}\nmotion: [{{press_to_depth: '1 mm'}}]\n"
        )
        layers = load_scene(tmp_path / "mine.yaml").specimen.layers
        assert layers.epidermis.youngs_modulus == pytest.approx(1e6 * row.estimate, rel=2e-5)
        assert layers.epidermis.youngs_modulus == pytest.approx(
            10 * layers.dermis.youngs_modulus, rel=1e-5
        )


def test_names_of_subjects_stay_readable_and_apart():
    names = specimen_names(["1", "1 (mine)", "Anna Müller", "anna/müller", "?", "mean"])
    assert list(names.values()) == [
        "calibrated_subject_1",
        "calibrated_subject_1_mine",
        "calibrated_subject_Anna_Müller",
        "calibrated_subject_anna_müller_2",
        "calibrated_subject__",
        "calibrated_mean",
    ]


def test_counts_that_differ_by_machine_are_not_published(result):
    assert not any(
        "evaluation" in text for text in (*result.estimates.columns, *result.estimates["quantity"])
    )
    committed = (ROOT / "figures" / "tables" / "calibration.csv").read_text()
    assert "evaluation" not in committed


def test_the_default_specimen_stays_the_thesis():
    specimen = scene("calibration_plate").specimen
    layers = specimen.layers
    assert [layer.youngs_modulus for layer in (layers.epidermis, layers.dermis, layers.fat)] == [
        150e3,
        15e3,
        15e3,
    ]
    assert specimen.contact_length == LENGTH


# -- relaxation ----------------------------------------------------------------------------------------------------------


def test_relaxing_part_is_exact_for_a_steady_rise_and_knows_its_derivative():
    time, tau = np.array([0.0, 0.1, 0.15, 0.6, 2.0]), 0.3
    value, change = relaxing_part(time, 5 * time, tau)
    np.testing.assert_allclose(value, 5 * tau * -np.expm1(-time / tau), rtol=1e-12)
    step = 1e-6
    slope = (
        relaxing_part(time, 5 * time**2, tau + step)[0]
        - relaxing_part(time, 5 * time**2, tau - step)[0]
    ) / (2 * step)
    np.testing.assert_allclose(relaxing_part(time, 5 * time**2, tau)[1], slope, rtol=1e-6)


@pytest.mark.parametrize("share", [0.0, 0.2, 3.0])
def test_terms_of_the_force_are_those_of_shear_in_series_with_volume(share):
    beta, tau = THESIS.beta, np.array(THESIS.tau)
    b, theta = force_terms(beta, tau, share)
    for p in (0.01, 1.0, 30.0, 1e6):
        shear = 1 + np.sum(beta * p / (p + 1 / tau))
        assert 1 + np.sum(b * p / (p + 1 / theta)) == pytest.approx(
            (1 + share) * shear / (1 + share * shear), rel=1e-9
        )
    if share == 0:
        assert sorted(b) == pytest.approx(sorted(beta)) and sorted(theta) == pytest.approx(
            sorted(tau)
        )
    else:
        assert sum(b) < sum(beta) and (np.sort(theta) > np.sort(tau)).all()


@pytest.fixture(scope="module")
def hereditary(curve, long_term, ramp):
    share = volume_share(curve, ElasticCurve.from_history(long_term), 1e-3, 1 / THESIS.g_infinity)
    return RampForce(curve, ramp.time.values, ramp.indentation_depth.values, LENGTH, share)


def test_hereditary_force_is_within_four_per_cent_of_the_simulation(hereditary, ramp, curve):
    full = ramp.force.values * LENGTH
    assert abs(hereditary.force(THESIS) - full).max() < 0.02 * full.max()
    without = RampForce(curve, hereditary.time, hereditary.depth, LENGTH)  # volume change left out
    assert abs(without.force(THESIS) - full).max() > 0.04 * full.max()


def test_sensitivities_are_the_derivatives(hereditary):
    p = np.array([0.8, 0.1, 3.0, 0.6, 0.3])
    slope = np.column_stack(
        [
            (hereditary.model(p + h)[0] - hereditary.model(p - h)[0]) / (2 * h.sum())
            for h in 1e-5 * np.diag(p)
        ]
    )
    np.testing.assert_allclose(hereditary.model(p)[1], slope, rtol=1e-4, atol=1e-8)


def noisy(force, seed, noise=0.005):
    sigma = noise * force.max()
    return force + np.concatenate(
        [[0.0], np.random.default_rng(seed).normal(0, sigma, len(force) - 1)]
    ), sigma


def inside(found):
    truth = {"modulus constant": 1.0, "g_1": 0.055, "tau_1": 3.25, "g_2": 0.3691, "tau_2": 0.3414}
    return {
        name: low < truth[name] < high for name, (_, low, high) in series_estimates(found).items()
    }


def test_series_is_given_back_from_a_wrong_start_by_one_simulation(hereditary, ramp):
    rough, calls = (
        scene("calibration_ramp_hold").with_accuracy(Discretisation(skin_edge=268.8e-6, steps=40)),
        [],
    )

    def full(prony):
        calls.append(prony)
        return simulate(with_series(rough, prony)).force.values * LENGTH

    force, sigma = noisy(ramp.force.values * LENGTH, seed=7)
    found = fit_series(hereditary, force, full, sigma=sigma)
    assert len(calls) == found.simulations == 1
    assert all(inside(found.corrected).values())
    series = series_of(found.corrected)
    assert series.g[1] == pytest.approx(0.3691, rel=0.1) and series.tau[1] == pytest.approx(
        0.3414, rel=0.15
    )
    clean = ramp.force.values * LENGTH
    errors = [
        abs(model.model(part.values)[0] - clean).max()
        for model, part in ((hereditary, found.hereditary), (found.model, found.corrected))
    ]
    assert errors[1] < errors[0], (
        "the correction brings the fitted force nearer to the simulated one"
    )


def test_intervals_of_the_series_cover_what_they_promise(hereditary):
    """Started at the truth, which is quicker; every tenth also far from it, and the same is
    found.
    """
    clean, hits = hereditary.force(THESIS), []
    truth = dict(
        zip(WRONG_START, (1.0, *np.column_stack([THESIS.beta, THESIS.tau]).ravel()), strict=True)
    )
    for seed in range(60):
        force, sigma = noisy(clean, seed, noise=0.002)
        found = fit_series(hereditary, force, hereditary.force, start=truth, sigma=sigma)
        hits.append(inside(found.corrected))
        if seed % 10 == 0:
            far = fit_series(hereditary, force, hereditary.force, start=WRONG_START, sigma=sigma)
            assert series_estimates(far.corrected)["g_1"] == pytest.approx(
                series_estimates(found.corrected)["g_1"], rel=1e-4
            )
            assert inside(far.corrected) == hits[-1]
    for name, share in pd.DataFrame(hits).mean().items():
        assert 0.86 <= share <= 1.0, name


def test_fast_ramps_tell_fast_amplitudes_and_slow_ones_do_not(curve):
    taus = (
        read_relaxation(REFERENCE / "relaxation.csv")
        .query("series == 'pawluk_howe'")["tau_s"]
        .tolist()
    )

    def half_widths(speed):
        design = amplitude_design(curve, 1e-3, speed, taus)
        return 1.96 * 0.005 * np.sqrt(np.diag(np.linalg.inv(design.T @ design)))[1:]

    slow, fast = half_widths(2e-3), half_widths(32e-3)
    assert slow[0] > 0.3 > 0.1 > fast[0]
    assert slow[0] > slow[1] > slow[2]


def test_amplitude_design_is_the_derivative_of_the_force_by_amplitude(curve):
    time = np.concatenate([np.linspace(0, 0.5, 31), 0.5 + np.cumsum(geometric(9.5, 30, 0.5 / 30))])
    model = RampForce(curve, time, np.minimum(2e-3 * time, 1e-3), LENGTH)
    design = amplitude_design(curve, 1e-3, 2e-3, [0.07])
    rise = (
        model.model(np.array([1.0, 0.2, 0.07]))[0] - model.model(np.array([1.0, 0.1, 0.07]))[0]
    ) / 0.1
    np.testing.assert_allclose(design[:, 1], rise[1:] / model.base()[-1], rtol=1e-4, atol=1e-12)


def test_study_states_no_amplitudes_of_pawluk_and_howe(plate, long_term, ramp):
    constants = read_relaxation(REFERENCE / "relaxation.csv")
    found = study(plate, long_term, ramp, constants, lambda prony: ramp.force.values * LENGTH)
    rows = found.estimates[found.estimates["quantity"].str.startswith("amplitude at 0.004 s")]
    assert "not an amplitude of Pawluk and Howe" in rows["note"].iloc[0]
    assert STUDIES["calibration_prony"](found.prony).axes

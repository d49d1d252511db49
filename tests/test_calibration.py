"""Calibration: what the elastic curve is, what force tells and what it does not, and parameters
given back.
"""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from cysyk1999.publishing.tables import read_frame, write_frame
from cysyk1999.publishing.write import write_picture
from cysyk1999.reference_data import read_force_depth
from cysyk1999.studies.calibration.force import (
    Calibration,
    ElasticCurve,
    fit_constant,
    group_interval,
    length_correlation,
    plate_forces,
    specimen_names,
    write_specimens,
)
from cysyk1999.studies.calibration.picture import STUDIES
from fingerpad import load_scene, plan, simulate
from fingerpad.scenes.scene import Discretisation, Hold, PressToDepth

pytestmark = pytest.mark.unit

ROOT = Path(__file__).parents[1]
REFERENCE = ROOT / "config" / "reference"
DEPTHS = np.array([0.5, 1.0, 1.5, 2.0]) * 1e-3
LENGTH = 0.0114


def scene(name):
    return load_scene(ROOT / "config" / "scenes" / f"{name}.yaml")


def drafted(name, **changes):
    rough = {"accuracy": Discretisation(skin_edge=268.8e-6, steps=40)}
    return simulate(scene(name).varied(rough | changes))


@pytest.fixture(scope="module")
def plate():
    return drafted("calibration_plate")


@pytest.fixture(scope="module")
def curve(plate):
    return ElasticCurve.from_history(plate)


@pytest.fixture(scope="module")
def data():
    return read_force_depth(REFERENCE / "force_depth")


# -- the elastic curve ----------------------------------------------------------------------------


def scaled(**factors):
    layers = scene("calibration_plate").specimen.layers
    changes = {
        f"specimen.layers.{name}.youngs_modulus": factor * getattr(layers, name).youngs_modulus
        for name, factor in factors.items()
    }
    return drafted("calibration_plate", **changes)


def test_force_is_proportional_to_a_factor_common_to_all_moduli_at_finite_strain(plate):
    assert json.loads(plate.attrs["plan"])["effects"]["finite_strain"]["on"]
    softer = scaled(epidermis=0.4, dermis=0.4, fat=0.4)
    np.testing.assert_allclose(softer.force, 0.4 * plate.force, rtol=1e-6)
    np.testing.assert_allclose(softer.contact_width, plate.contact_width, rtol=1e-6)
    # the ratio not kept: another curve, not only lower
    one_layer = scaled(dermis=0.4, fat=0.4)
    assert np.ptp((one_layer.force / plate.force).values[1:]) > 0.005
    assert abs(one_layer.contact_width / plate.contact_width - 1).values[1:].max() > 0.01


def test_a_steady_scene_needs_no_time_and_equals_a_long_hold():
    def moved(*motion):
        return scene("calibration_plate").varied({"motion": motion, "accuracy": "draft"})

    steady = moved(PressToDepth(press_to_depth=1e-3))
    decided, viscous = plan(steady), plan(steady).effects["viscoelasticity"]
    assert not decided.timed and not viscous.on and decided.state == "long_term"
    assert "steady" in viscous.why
    press = PressToDepth(press_to_depth=1e-3, speed=2e-3)
    held = moved(press, Hold(hold=1000.0))
    assert plan(held).timed and plan(held).effects["viscoelasticity"].on
    relaxed, at_once = (simulate(one).isel(time=-1) for one in (held, steady))
    for name in ("force", "contact_width", "centre_pressure", "peak_pressure"):
        assert float(relaxed[name]) == pytest.approx(float(at_once[name]), rel=1e-3), name
    np.testing.assert_allclose(relaxed.skin_displacement_y, at_once.skin_displacement_y, atol=1e-6)
    hasty = simulate(moved(press, Hold(hold=1.0)))
    assert float(hasty.force[-1]) > 1.02 * float(at_once.force)


def test_curve_passes_through_its_points_and_ends_where_the_simulation_ends(curve):
    np.testing.assert_allclose(curve.force_at(curve.depth), curve.force)
    assert (np.diff(curve.force_at(np.linspace(0, 2.5e-3, 400))) > 0).all()
    with pytest.raises(
        ValueError, match="a depth of 3 mm is beyond the elastic curve, 0 to 2.5 mm"
    ):
        curve.force_at(3e-3)


# -- the constant ---------------------------------------------------------------------------------


def synthetic(curve, seed, noise=0.01):
    clean = 0.4 * LENGTH * curve.force_at(DEPTHS)
    return clean + np.random.default_rng(seed).normal(0, noise * clean.max(), len(clean))


def test_intervals_of_the_constant_cover_what_they_promise(curve):
    fits = [fit_constant(curve, DEPTHS, synthetic(curve, seed), LENGTH) for seed in range(300)]
    assert 0.92 <= np.mean([found.low < 0.4 < found.high for found in fits]) <= 0.98
    stiffer = ElasticCurve(curve.depth, 1.2 * curve.force)
    other = fit_constant(stiffer, DEPTHS, synthetic(curve, 3), LENGTH)
    assert not other.low < 0.4 < other.high
    assert other.value == pytest.approx(0.4 / 1.2, rel=0.02)


def test_force_tells_the_product_of_constant_and_length_and_nothing_of_either(curve):
    force = synthetic(curve, 5)
    found, other = (fit_constant(curve, DEPTHS, force, length) for length in (LENGTH, 2 * LENGTH))
    assert found.value == pytest.approx(2 * other.value) and found.rss == pytest.approx(other.rss)
    assert length_correlation(found) < -0.999
    model = found.value * LENGTH * curve.force_at(DEPTHS)
    variance = ((force - model) ** 2).sum() / (len(force) - 1)
    sensitivities = np.outer(model, [1.0, 1.0])
    information = sensitivities.T @ sensitivities / variance + np.eye(2) / np.log(10) ** 2
    covariance = np.linalg.inv(information)
    assert length_correlation(found) == pytest.approx(covariance[0, 1] / covariance[0, 0], rel=1e-6)


def test_the_misfit_rises_by_the_square_of_the_share(curve):
    force, model = synthetic(curve, 5), LENGTH * curve.force_at(DEPTHS)
    found = fit_constant(curve, DEPTHS, force, LENGTH)
    misfit = ((force - 1.3 * found.value * model) ** 2).sum()
    rise = (misfit - found.rss) / (found.rss / (len(force) - 1))
    assert found.rise([1.3, 1.0]) == pytest.approx([rise, 0.0])


def test_measured_force_asks_for_a_length_that_grows(curve, data):
    group = plate_forces(data)["mean"]
    needed = group["force_N"] / curve.force_at(group["depth_mm"] * 1e-3)
    assert (np.diff(needed) > 0).all()


def test_group_interval_is_students():
    assert group_interval([2.0, 2.0, 2.0]) == pytest.approx((2.0, 2.0, 2.0))
    middle, low, high = group_interval([1.0, np.e**2])
    assert np.log([middle, low, high]) == pytest.approx([1.0, 1 - 12.706, 1 + 12.706], rel=1e-3)


def test_one_force_gives_no_interval(curve):
    with pytest.raises(ValueError, match="1 data cannot give 1 parameters"):
        fit_constant(curve, DEPTHS[:1], [0.1], LENGTH)


# -- the whole study ------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def result(plate, data):
    long_term = drafted("calibration_long_term")
    scenes = {"calibration_plate": plate, "calibration_long_term": long_term}
    return Calibration(scenes, {}, data)


def estimate(result, study, quantity, subject="mean"):
    rows = result.estimates().set_index(["study", "quantity", "subject"])
    return float(rows["estimate"].loc[(study, quantity, subject)])


def test_study_fits_every_subject_and_the_mean(result):
    assert list(result.constants) == ["1", "2", "3", "4", "mean"]
    assert all(0.4 < found.value < 1.3 for found in result.constants.values())
    assert estimate(result, "stated in the thesis", "modulus constant") == 1.0
    # moduli read as long-term are smaller by less than all that relaxes
    quantity = "constant over that of the instantaneous reading"
    assert 0.5759 < estimate(result, "moduli read as long-term", quantity) < 1 / 1.4


def test_a_further_subject_joins(plate, curve, data, tmp_path):
    pairs = zip(DEPTHS, 0.5 * LENGTH * curve.force_at(DEPTHS), strict=True)
    rows = "\n".join(f"me,flat plate,{1e3 * depth:g},0,{force},x,y" for depth, force in pairs)
    head = "subject,indenter,depth_mm,speed_mm_per_s,force_N,source,how_obtained"
    (tmp_path / "mine.csv").write_text(f"{head}\n{rows}\n")
    own = read_force_depth(tmp_path)
    mine = Calibration({"calibration_plate": plate}, {}, own)
    assert mine.constants["me"].value == pytest.approx(0.5, rel=1e-6)
    for name in ("fit", "identifiability"):  # one subject, no mean
        assert STUDIES[f"calibration_{name}"](getattr(mine, name)()).axes
    both = Calibration({"calibration_plate": plate}, {}, pd.concat([data, own]))
    assert "me" in both.constants


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
    assert "measured" in words
    write_picture(drawn, tmp_path / "a.png", dpi=60)
    write_frame(frame, tmp_path / "b.csv")
    write_picture(STUDIES[name](read_frame(tmp_path / "b.csv")), tmp_path / "b.png", dpi=60)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


# -- specimens ------------------------------------------------------------------------------------


def with_layers(folder, name):
    """The specimen of a scene that names calibrated layers."""
    path = folder / "mine.yaml"
    path.write_text(
        f"specimen: {{layers: {name}}}\nstimulus: {{shape: flat}}\n"
        "motion: [{press_to_depth: '1 mm'}]\n"
    )
    return load_scene(path).specimen


def test_a_scene_names_a_calibrated_specimen(result, tmp_path):
    paths = write_specimens(tmp_path / "config" / "specimens", result)
    subjects = [f"calibrated_subject_{n}" for n in "1234"]
    assert [path.stem for path in paths] == [*subjects, "calibrated_mean"]
    named, s = with_layers(tmp_path, "calibrated_subject_2"), result.constants["2"].value
    assert named.layers.epidermis.youngs_modulus == pytest.approx(150e3 * s, rel=1e-5)
    assert named.layers.fat.youngs_modulus == pytest.approx(15e3 * s, rel=1e-5)
    assert named.moduli == "instantaneous" and named.contact_length == LENGTH
    assert "force alone tells only their product" in paths[0].read_text()


def test_committed_specimens_are_those_of_the_committed_table(tmp_path):
    table = pd.read_csv(ROOT / "figures" / "tables" / "calibration.csv", dtype={"subject": str})
    chosen = table[table["quantity"] == "Young's modulus of the epidermis"].set_index("subject")
    assert len(chosen) == 5
    for subject, name in specimen_names(chosen.index).items():
        layers = with_layers(tmp_path, name).layers
        stiff = layers.epidermis.youngs_modulus
        assert stiff == pytest.approx(1e6 * chosen["estimate"][subject], rel=5e-5)
        assert stiff == pytest.approx(10 * layers.dermis.youngs_modulus, rel=1e-5)


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

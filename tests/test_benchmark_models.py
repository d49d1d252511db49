"""The benchmark's models: the half-space by closed forms, transduction by made-up receptors, and
this model by what it must do to a number.
"""

import math
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from cysyk1999.studies.benchmark.picture import draw_parity, within_factor_2
from fingerpad.benchmark import half_space, predict
from fingerpad.benchmark.rows import datasets, titles
from fingerpad.benchmark.score import read_predictions, score
from fingerpad.benchmark.transduction import Transduction, fitted
from fingerpad.cli import main

E, NU = half_space.YOUNGS_MODULUS, half_space.POISSON
unit = pytest.mark.unit
verification = pytest.mark.verification


@verification
@pytest.mark.parametrize("curvature", [0.0, 340.0, 694.0])
@pytest.mark.parametrize("depth", [0.3e-3, 0.915e-3, 3e-3])
def test_under_the_middle_of_a_sphere_is_hertz(curvature, depth):
    """Johnson, Contact Mechanics, Eqs 3.45."""
    load, radius = 0.196, 1 / (curvature + 1 / half_space.PAD_RADIUS)
    a = (3 * load * radius * (1 - NU**2) / (4 * E)) ** (1 / 3)
    p, s = 1.5 * load / (np.pi * a**2), depth / a
    down = -p / (1 + s**2)
    side = -p * ((1 + NU) * (1 - s * np.arctan(1 / s)) - 0.5 / (1 + s**2))
    energy = (down**2 + 2 * side**2 - 2 * NU * (2 * down * side + side**2)) / (2 * E)
    strain = -(down - 2 * NU * side) / E
    found = half_space.under_sphere(load, curvature, np.zeros(1), depth)
    assert np.ravel(found) == pytest.approx([energy, strain], rel=2e-3)


@verification
def test_far_from_a_sphere_is_a_point_force():
    """Boussinesq's stress on a ray: what is left of a contact far away."""
    load, r, z = 0.1, 8e-3, 6e-3
    rho = math.hypot(r, z)
    scale, near = load / (2 * np.pi), (1 - 2 * NU) / (rho * (rho + z))
    stress = np.zeros((3, 3))
    stress[0, 0] = scale * (near - 3 * z * r**2 / rho**5)
    stress[1, 1] = -scale * (near - (1 - 2 * NU) * z / rho**3)
    stress[2, 2] = -3 * scale * z**3 / rho**5
    stress[0, 2] = stress[2, 0] = -3 * scale * r * z**2 / rho**5
    energy = ((1 + NU) * (stress**2).sum() - NU * np.trace(stress) ** 2) / (2 * E)
    found = half_space.under_sphere(load, 1e4, np.array([r]), z)[0]
    assert found == pytest.approx(energy, rel=2e-3)


@verification
def test_far_under_a_bar_is_a_line_load():
    """Flamant: one stress, 2 P / (pi z), along the ray."""
    stress = 2 * 1000 * 1e-3 / (np.pi * 60e-3)
    energy, strain = half_space.under_bars([(-0.5e-3, 0.5e-3)], np.zeros(1), 60e-3)
    assert energy == pytest.approx((1 - NU**2) * stress**2 / (2 * E), rel=1e-3)
    assert strain == pytest.approx((1 - NU**2) * stress / E, rel=1e-3)


@verification
def test_a_bar_presses_as_a_punch_does():
    """P / (pi sqrt(a^2 - x^2)) under a rigid flat (Johnson, Eq 2.64), by stresses below it."""
    a, x, z = 1.5e-3, np.linspace(-2e-3, 2e-3, 9), 0.5e-3
    edge = a * np.sin(np.linspace(-np.pi / 2, np.pi / 2, 2001))
    load = np.full(2000, 3.0 / 2000) / np.diff(edge)
    stress = half_space.strip_stresses(x, z, edge, load)
    shear, bulk = E / (2 * (1 + NU)), E / (3 * (1 - 2 * NU))
    exact = half_space.strain_energy_density(*stress, shear, bulk, NU)
    assert half_space.under_bars([(-a, a)], x, z)[0] == pytest.approx(exact, rel=0.03)


@verification
def test_skin_beside_a_cylinder_is_hertz():
    """At the edge of contact the skin meets the cylinder, with its slope; deep in, it is the
    cylinder.
    """
    diameter, depth = 3.17e-3, 1e-3
    x = np.linspace(0, 2e-3, 4001)
    w = half_space.deflection(diameter, depth, x)
    radius = 1 / (2 / diameter + 1 / half_space.PAD_RADIUS)
    lifted = w - (depth - x**2 / (2 * radius))
    assert lifted[0] == 0 and lifted.min() == 0 and (np.diff(lifted) >= 0).all()
    a = x[np.argmax(lifted > 1e-12)]  # far from it the skin falls as under a line load
    near, far = half_space.deflection(diameter, depth, np.array([15 * a, 30 * a]))
    assert near - far == pytest.approx(a**2 / (2 * radius) * np.log(2), rel=0.01)
    assert np.isnan(half_space.deflection(diameter, 20e-3, x)).all()


@verification
def test_forces_are_those_of_sneddon_and_hertz():
    depth, modulus = np.array([1e-3]), E / (1 - NU**2)
    punch = {"shape": "punch", "diameter": 6e-3}
    cone = {"shape": "cone", "half_angle": np.radians(45)}
    assert half_space.force(punch, depth) == pytest.approx(modulus * 6e-6)
    assert half_space.force(cone, depth) == pytest.approx(2 / np.pi * modulus * 1e-6)
    ratio = half_space.force({"shape": "flat"}, 2 * depth) / half_space.force(
        {"shape": "flat"}, depth
    )
    assert ratio == pytest.approx(2**1.5)


@unit
def test_a_made_up_receptor_is_found_again():
    stimulus = np.linspace(0, 10, 21)
    law = Transduction(3.0, 4.2)
    found = fitted(stimulus, law(stimulus))
    assert (found.gain, found.threshold) == pytest.approx((3.0, 4.2))
    falling = fitted(stimulus, -stimulus)
    assert falling.gain == 0


@unit
def test_fit_rows_choose_what_is_felt():
    """Of two candidates the one that made the rates."""
    rng = np.random.default_rng(3)
    stimuli = rng.uniform(1, 2, (12, 2))
    which, law = predict.chosen_receptor(stimuli, 5 * (stimuli[:, 1] - 0.5))
    assert which == 1 and law.gain == pytest.approx(5)


@unit
def test_held_out_rows_do_not_move_a_constant(monkeypatch):
    """The half-space again, every held-out rate spoiled: the same predictions."""
    measured = datasets(["sa1_spheres"])
    before = predict.half_space_model(measured)
    spoiled = {
        "sa1_spheres": [
            row.model_copy(update={"value": 0.0}) if row.role == "test" else row
            for row in measured["sa1_spheres"]
        ]
    }
    monkeypatch.setattr(predict, "datasets", lambda names: spoiled)
    assert predict.half_space_model(spoiled) == before


@unit
def test_the_mesh_error_is_what_a_coarser_mesh_changes(monkeypatch):
    """Of made-up runs that a coarser mesh makes a tenth too large: a tenth of the largest."""
    measured = {"profile_cylinder_3mm": datasets(["profile_cylinder_3mm"])["profile_cylinder_3mm"]}
    monkeypatch.setattr(
        predict,
        "_simulated",
        lambda name, rows: [(np.array([-row.row]), np.array([-1.1 * row.row])) for row in rows],
    )
    found = predict.this_model(measured)
    most = max(row.row for row in measured["profile_cylinder_3mm"])
    for (_, row), each in found.items():
        assert (each.value, each.mesh_error) == pytest.approx((-row, 0.1 * row / most))


@unit
def test_every_dataset_is_predicted_or_says_why():
    for name in titles():
        assert name.startswith(tuple(predict.CONSTANTS)) != (name in predict.NOT_PREDICTED)


@pytest.mark.slow
@verification
def test_this_model_presses_a_plate():
    """A factor a subject: its own rows at 2 mm are met, and forces rise with depth."""
    measured = datasets(["force_plate"])
    found = predict.this_model(measured)
    for row in measured["force_plate"]:
        if row.role == "fit":
            assert found["force_plate", row.row].value == pytest.approx(row.value)
    values = [found["force_plate", row.row].value for row in measured["force_plate"]]
    assert (np.diff(np.reshape(values, (4, 4))) > 0).all()
    assert score(found, measured)[0].within_factor_2 == 1


@unit
def test_the_command_scores_a_model_and_refuses_in_one_line(tmp_path, capsys):
    assert main(["benchmark", "--template", "--dataset", "force_plate"]) == 0
    lines = capsys.readouterr().out.splitlines()
    rows = [line.replace(",,,", f",{0.1 * k},,", 1) for k, line in enumerate(lines)]
    path = tmp_path / "mine.csv"
    path.write_text("\n".join(rows) + "\n")
    assert main(["benchmark", "score", str(path), "--out", str(tmp_path / "out")]) == 0
    assert "force_plate" in capsys.readouterr().out
    (row,) = pd.read_csv(tmp_path / "out/scores.csv").to_dict("records")
    assert row["rows"] == row["predicted"] == 12
    assert read_predictions(tmp_path / "out/mine.csv")["force_plate", 3].value == 0.3
    path.write_text("dataset,row,predicted\nforce_plate,1,much\n")
    for words in (["score", str(path)], ["scores"], ["--dataset", "none"]):
        assert main(["benchmark", *words]) == 2
        assert len(capsys.readouterr().err.splitlines()) == 1


@unit
def test_the_picture_shows_held_out_rows_only(tmp_path):
    measured = datasets()
    names = [name for name in measured if name.startswith(tuple(predict.CONSTANTS))]
    frame = pd.DataFrame(
        {"dataset": name, "row": row.row, "predicted": row.value}
        | {key: getattr(row, key) for key in ("quantity", "unit", "at", "role", "value")}
        for name in names
        for row in measured[name]
    )
    frame.to_csv(tmp_path / "here.csv", index=False)
    scores = pd.DataFrame(
        vars(found) | {"model": model}
        for model in ("fingerpad", "half-space")
        for found in score(
            read_predictions(tmp_path / "here.csv"), {name: measured[name] for name in names}
        )
    )
    scores.to_csv(tmp_path / "scores.csv", index=False)
    here = str(tmp_path / "here.csv")
    made = {"picture": [tmp_path / "parity.png"], "table": [tmp_path / "benchmark.csv"]}
    draw_parity(SimpleNamespace(predictions=[here, here], scores=[tmp_path / "scores.csv"], **made))
    drawn = pd.read_csv(tmp_path / "parity.csv")
    assert len(drawn) == (frame["role"] == "test").sum() == 200
    table = pd.read_csv(tmp_path / "benchmark.csv")
    assert set(table["dataset"]) == set(titles())
    assert table["verdict"].str.endswith(".").all()


@unit
def test_a_factor_of_two_has_ends():
    measured = pd.Series([1.0, 1.0, 1.0, 1.0, -1.0])
    predicted = pd.Series([0.5, 2.0, 0.49, 2.01, 1.0])
    assert list(within_factor_2(measured, predicted)) == [True, True, False, False, False]

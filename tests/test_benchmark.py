"""Measured touch: the data, its schema, and scores of predictions."""

import csv
import io
import math

import numpy as np
import pytest

from fingerpad.benchmark.rows import (
    INDEX,
    MEASURED,
    BenchmarkError,
    datasets,
    read_dataset,
    titles,
)
from fingerpad.benchmark.score import (
    Prediction,
    read_predictions,
    score,
    write_predictions,
)
from fingerpad.scenes.scene import load_scene

pytestmark = pytest.mark.unit


def test_there_are_enough_measurements_and_every_file_has_its_line():
    measured = datasets()
    assert len(measured) >= 12
    assert sum(row.role != "repeat" for rows in measured.values() for row in rows) >= 300
    files = {path.stem for path in MEASURED.glob("*.csv")} - {INDEX.stem}
    assert files == set(titles()) == set(measured)


def test_values_are_those_published():
    """Numbers of the sources, written down here once more."""
    measured = datasets()
    plate = [row.value for row in measured["force_plate"] if row.at == "depth 2 mm"]
    assert plate == [1.0391, 0.504, 0.8476, 0.6835]
    assert np.std(plate, ddof=1) == pytest.approx(0.2285, abs=2e-4)
    assert all(
        row.deviation == pytest.approx(0.2285, abs=2e-4)
        for row in measured["force_plate"]
        if row.at == "depth 2 mm"
    )
    for name, depth, mean in (("force_probe", 3, 0.9572), ("force_point", 3, 0.3362)):
        rows = [row.value for row in measured[name] if row.place("depth", "length") == depth / 1e3]
        assert len(rows) == 4 and np.mean(rows) == pytest.approx(mean, abs=2e-4)
    assert measured["sa1_spheres"][-1].value == 131.6


def test_stimuli_are_scenes():
    seen = []
    for rows in datasets().values():
        for row in rows:
            if row.scene and row.scene not in seen and "csv" not in row.scene["stimulus"]:
                seen.append(row.scene)
                scene = load_scene(row.scene | {"motion": [{"press_to_depth": "1 mm"}]})
                assert scene.axisymmetric == (row.scene.get("kinematics") == "axisymmetric")
    assert len(seen) > 8


@pytest.fixture
def dataset(tmp_path):
    """Write a dataset with one cell changed."""
    with (MEASURED / "force_plate.csv").open() as file:
        rows = list(csv.DictReader(file))[:3]

    def write(**cells):
        path = tmp_path / "mine.csv"
        rows[1] |= cells
        with path.open("w", newline="") as file:
            table = csv.DictWriter(file, rows[0])
            table.writeheader()
            table.writerows(rows)
        return path

    return write


@pytest.mark.parametrize(
    ("cells", "told"),
    [
        ({"value": "0,2x"}, ("row 3", "'value'", "0,2x")),
        ({"value": ""}, ("row 3", "'value'")),
        ({"value": "nan"}, ("row 3", "'value'", "nan")),
        ({"unit": "mm"}, ("row 3", "unit", "'mm'", "N")),
        ({"quantity": "forse"}, ("row 3", "quantity", "forse", "force")),
        ({"role": "tested"}, ("row 3", "'role'", "tested", "repeat")),
        ({"species": "cat"}, ("row 3", "'species'", "cat", "monkey")),
        ({"scene": "{flat"}, ("row 3", "'scene'", "JSON")),
        ({"scene": '{"motion": []}'}, ("row 3", "'scene'")),
        ({"low": "1"}, ("row 3", "low, high")),
        ({"high": ""}, ("row 3", "low, high", "both or none")),
        ({"source": ""}, ("row 3", "source")),
        ({"row": "1"}, ("row 3", "'row'", "twice")),
    ],
)
def test_a_wrong_cell_is_refused_in_one_line(dataset, cells, told):
    assert len(read_dataset(dataset())) == 3
    with pytest.raises(BenchmarkError) as refused:
        read_dataset(dataset(**cells))
    text = str(refused.value)
    assert "\n" not in text and "mine.csv" in text
    assert all(each in text for each in told), text


def test_a_missing_column_is_refused(tmp_path):
    (tmp_path / "mine.csv").write_text("row,quantity\n1,force\n")
    with pytest.raises(BenchmarkError, match="no column 'unit'"):
        read_dataset(tmp_path / "mine.csv")


def _all(measured, change):
    return {
        (name, row.row): Prediction(change(row)) for name, rows in measured.items() for row in rows
    }


def test_scores_are_those_of_errors_that_are_known():
    """Every plate off by half a standard deviation, upwards and downwards by turns."""
    measured = datasets(["force_plate"])
    signs = {row.row: (-1) ** row.row for row in measured["force_plate"]}
    half = score(_all(measured, lambda r: r.value + signs[r.row] * r.deviation / 2), measured)[0]
    rows = [row for row in measured["force_plate"] if row.role == "test"]
    assert half.rms_in_deviations == pytest.approx(0.5)
    assert half.within_scatter == 1
    assert half.bias == pytest.approx(np.mean([signs[r.row] * r.deviation / 2 for r in rows]))
    assert half.rms == pytest.approx(np.sqrt(np.mean([(r.deviation / 2) ** 2 for r in rows])))
    twice = score(_all(measured, lambda r: r.value + 2 * r.deviation), measured)[0]
    assert twice.within_scatter == 0 and twice.rms_in_deviations == pytest.approx(2)


def test_the_mean_explains_nothing_and_the_data_everything():
    measured = datasets(["sa1_sphere_profiles"])
    mean = np.mean([row.value for row in measured["sa1_sphere_profiles"]])
    assert score(_all(measured, lambda r: mean), measured)[0].r_squared == pytest.approx(0)
    assert score(_all(measured, lambda r: r.value), measured)[0].r_squared == 1


def test_rows_fitted_to_and_repeats_are_not_counted():
    """Held-out rows right, all others far off: nothing is seen of it."""
    measured = datasets(["sa1_bar_held", "anatomy"])
    off = score(_all(measured, lambda r: r.value if r.role == "test" else 1e6), measured)
    (found,) = off  # anatomy is what models are built from
    assert found.rms == 0 and found.rows == found.predicted == 9


def test_a_wrong_sign_is_not_within_a_factor_of_two():
    measured = datasets(["force_plate"])
    assert score(_all(measured, lambda r: -r.value), measured)[0].within_factor_2 == 0


def test_a_table_comes_back_as_it_was_written(tmp_path):
    measured = datasets(["force_plate", "sa1_spheres"])
    predictions = _all(measured, lambda r: 1.25 * r.value)
    path = tmp_path / "mine.csv"
    with path.open("w") as file:
        write_predictions(predictions, file, measured)
    read = read_predictions(path)
    assert read.keys() == predictions.keys()
    assert all(math.isclose(read[k].value, predictions[k].value, rel_tol=1e-3) for k in read)
    template = io.StringIO()
    write_predictions({}, template, measured)
    path.write_text(template.getvalue())
    assert read_predictions(path) == {}


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("force_plat,1,2", ("'dataset'", "force_plat", "force_plate")),
        ("force_plate,99,2", ("'row'", "99")),
        ("force_plate,1,x", ("row 2", "'predicted'", "x")),
        ("force_plate,1,2\nforce_plate,1,2", ("row 3", "twice")),
        ("force_plate,1,2,mN", ("row 2", "'unit'", "mN", "allowed: N")),
        ("force_plate,1,2,,train", ("'role'", "train")),
        ("force_plate,1,2,,,,-0.1", ("'mesh_error'", "-0.1")),
    ],
)
def test_a_wrong_prediction_is_refused_in_one_line(tmp_path, text, told):
    path = tmp_path / "mine.csv"
    header = "dataset,row,predicted,unit,role,value,mesh_error"
    lines = [line + "," * (6 - line.count(",")) for line in text.splitlines()]
    path.write_text("\n".join([header, *lines]) + "\n")
    with pytest.raises(BenchmarkError) as refused:
        read_predictions(path)
    assert all(each in str(refused.value) for each in (*told, "mine.csv"))
    assert "\n" not in str(refused.value)


def test_an_unknown_dataset_is_refused():
    with pytest.raises(BenchmarkError, match="force_plate"):
        datasets(["force_plates"])


def test_too_few_rows_have_no_verdict():
    measured = datasets(["force_plate"])
    held_out = [row for row in measured["force_plate"] if row.role == "test"]
    for count, said in ((5, "Too few rows to judge"), (6, "To be trusted here")):
        same = {("force_plate", row.row): Prediction(row.value) for row in held_out[:count]}
        assert score(same, measured)[0].verdict.startswith(said)

"""The recipes of CONTRIBUTING.md for a law, an effect, a claim and a trend, followed."""

import io
import re
import runpy
from pathlib import Path

import pandas as pd
import pytest

import synthetic
from cysyk1999.claims import trends
from cysyk1999.claims.rows import judged
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.reference_data import read_reference
from fingerpad import load_scene, plan, simulate
from fingerpad.laws import LAWS
from fingerpad.planning.effects import registered
from test_laws import check_derivatives

pytestmark = pytest.mark.unit
ROOT = Path(__file__).parents[1]
SCENE = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf"}],
    "accuracy": {"skin_edge": "0.8 mm", "steps": 4},
}


def block(name: str) -> str:
    """A block of code of CONTRIBUTING.md, by its first line."""
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    (code,) = re.findall(rf"```[a-z]+\n# {re.escape(name)}\n(.*?)```", text, re.S)
    return code


def run(name: str, folder: Path) -> dict:
    (folder / name).write_text(block(name))
    return runpy.run_path(str(folder / name))


def test_a_law_is_one_file(tmp_path, monkeypatch):
    law = run("gent.py", tmp_path)["LAW"]
    check_derivatives(law, (6.0,))
    monkeypatch.setitem(LAWS, law.name, law)
    stiff = {layer: {"law": {"name": "gent", "limit": 5.0}} for layer in ("dermis", "fat")}
    depth = [
        float(simulate(load_scene(SCENE | {"specimen": {"layers": layers}})).indentation_depth[-1])
        for layers in ({}, stiff)
    ]
    assert 0.9 * depth[0] < depth[1] < 0.999 * depth[0], "a limit stiffens, a little"


def test_the_laws_of_the_package_are_its_files():
    files = {path.stem for path in (ROOT / "src/fingerpad/laws").glob("[a-z]*.py")} - {"law"}
    assert set(LAWS) == files


def test_an_effect_is_one_file(tmp_path):
    effect = run("light_touch.py", tmp_path)["EFFECT"]
    light = SCENE | {"motion": [{"press_to_force": "0.5 gf"}]}
    with registered(effect):
        assert plan(light).effects["light_touch"].on and not plan(SCENE).effects["light_touch"].on


@pytest.fixture(scope="module")
def measures():
    histories = synthetic.histories()
    fine = Measures.of(histories, synthetic.meshes(histories))
    return fine, Instead.of(histories, synthetic.companions(1.0125, 1.01), fine)


def test_a_claim_is_one_row(measures, tmp_path):
    known = pd.read_csv(ROOT / "config/reference/thesis_numbers.csv", dtype=str)
    row = pd.read_csv(io.StringIO(block("thesis_numbers.csv")), dtype=str)
    assert set(row) <= set(known)
    for name, changed in {"right": row, "wrong": row.assign(low="20", high="30")}.items():
        pd.concat([known.head(1), changed]).to_csv(tmp_path / f"{name}.csv", index=False)
    verdicts = [
        judged(read_reference(tmp_path / f"{name}.csv").loc["T999"], *measures)[3]
        for name in ("right", "wrong")
    ]
    assert verdicts == ["inside", "outside"]


def test_a_trend_is_one_function(measures, tmp_path, monkeypatch):
    monkeypatch.setattr(trends, "TRENDS", dict(trends.TRENDS))
    run("trends.py", tmp_path)
    outcome = trends.TRENDS["TR99"](measures[0])
    assert outcome.holds and outcome.shown > 0 and "mm" in outcome.note

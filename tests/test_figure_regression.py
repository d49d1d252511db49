"""Figure regression: data and pictures of every figure against the committed baselines.

The figures of chapters 3 and 4 are made from simulations on coarse meshes, run here, and compared with
tests/baselines; the strokes of chapter 5 take too long for that. The published ones in figures/thesis are
compared with a summary of their curves, with their own pictures, and with the cached results where there are
any. A deliberate change is accepted by ``make regression-update``.
"""

import os
from pathlib import Path

import pandas as pd
import pytest

from fingerpad.figures.registry import FIGURES
from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import read_frame, write_frame, write_picture
from fingerpad.reference_data import read_reference
from regression import (
    BASELINE_DPI,
    SIMILARITY,
    differences,
    similarity,
    summary,
    summary_differences,
)

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
BASELINES = Path(__file__).parent / "baselines"
PUBLISHED = ROOT / "figures" / "thesis"
RESULTS = ROOT / "results" / "thesis"
MEASURED = ROOT / "config" / "reference"
UPDATE = os.environ.get("FINGERPAD_UPDATE_BASELINES") == "1"
AFRESH = [number for number in FIGURES if not number.startswith("5-")]
ACCEPT = "; if this is meant, run make regression-update and commit"


@pytest.fixture(scope="module")
def simulated():
    """Coarse simulations of every scene that a figure needs: histories and meshes."""
    from fingerpad import load_scene, plan, simulate
    from fingerpad.specimen import mesh_for

    histories, meshes = {}, {}
    for name in sorted({scene for number in AFRESH for scene in FIGURES[number].needs}):
        scene = load_scene(ROOT / "config" / "scenes" / f"{name}.yaml").with_accuracy("draft")
        chosen = plan(scene)
        meshes[name] = mesh_for(scene, chosen)
        histories[name] = simulate(scene, chosen, mesh=meshes[name])
    return histories, meshes


@pytest.fixture(scope="module")
def cached():
    """The cached results at thesis resolution, each opened when first needed."""
    patterns = ("simulations/*/history.nc", "simulations/*/mesh.msh", "coarse/*/history.nc")
    return read_results(path for pattern in patterns for path in RESULTS.glob(pattern))


@pytest.fixture(scope="module")
def reference():
    return read_reference(ROOT / "config" / "reference" / "thesis_numbers.csv")


@pytest.mark.parametrize("number", AFRESH)
def test_data_of_a_coarse_simulation_are_those_of_the_baseline(simulated, reference, number, tmp_path):
    path = BASELINES / f"fig_{number}.csv"
    frame = FIGURES[number].frame(*simulated, {}, reference, *FIGURES[number].measurements(MEASURED))
    write_frame(frame, path if UPDATE else tmp_path / "new.csv")
    changed = differences(read_frame(path if UPDATE else tmp_path / "new.csv"), read_frame(path))
    assert not changed, f"{changed}{ACCEPT}"


@pytest.mark.parametrize("number", AFRESH)
def test_picture_of_the_baseline_data_is_the_baseline_picture(number, tmp_path):
    path = BASELINES / f"fig_{number}.png"
    fig = FIGURES[number].draw(read_frame(path.with_suffix(".csv")))
    write_picture(fig, path if UPDATE else tmp_path / "new.png", BASELINE_DPI)
    alike = 1.0 if UPDATE else similarity(tmp_path / "new.png", path)
    assert alike >= SIMILARITY, f"similarity {alike:.3f}{ACCEPT}"


def test_published_data_are_those_of_the_summary():
    path = BASELINES / "thesis.csv"
    frames = {n: read_frame(PUBLISHED / f"fig_{n}.csv") for n in FIGURES}
    new = summary(frames)
    if UPDATE:
        write_frame(new, path)
    text = {c: str for c in ("figure", "curve", "column")}
    changed = summary_differences(new, pd.read_csv(path, dtype=text, keep_default_na=False))
    assert not changed, f"{changed}{ACCEPT}"


@pytest.mark.parametrize("number", FIGURES)
def test_published_picture_shows_its_data(number, tmp_path):
    write_picture(FIGURES[number].draw(read_frame(PUBLISHED / f"fig_{number}.csv")), tmp_path / "new.png")
    alike = similarity(tmp_path / "new.png", PUBLISHED / f"fig_{number}.png", shrink=3)
    assert alike >= SIMILARITY, f"similarity {alike:.3f}; run make figures"


@pytest.mark.skipif(not RESULTS.is_dir(), reason="no results/thesis here: make figures has not been run")
@pytest.mark.parametrize("number", FIGURES)
def test_published_data_are_those_of_the_cached_results(cached, reference, number, tmp_path):
    write_frame(FIGURES[number].frame(*cached, reference, *FIGURES[number].measurements(MEASURED)), tmp_path / "new.csv")
    changed = differences(read_frame(tmp_path / "new.csv"), read_frame(PUBLISHED / f"fig_{number}.csv"))
    assert not changed, f"{changed}; run make figures"

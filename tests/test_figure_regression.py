"""Figure regression: data of every figure against the committed baselines, pictures against their
data.

The figures of chapters 3 and 4 are made from simulations on coarse meshes, run here, and compared
with tests/baselines; those of the strokes of chapter 5 from a few shorter ones, for what they read.
The published ones in figures/thesis are compared with a summary of their curves, with their own
pictures, and with the cached results where there are any. A deliberate change is accepted by ``make
regression-update``.
"""

import json
import os
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.errors import PARTS
from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import read_frame, write_frame, write_picture
from cysyk1999.reference_data import empty_reference, read_reference
from drawn import frame as made_up
from fingerpad import plan, simulate
from fingerpad.results import scene_of
from fingerpad.scenes.scene import load_scene
from fingerpad.specimen import mesh_for
from regression import SIMILARITY, differences, similarity, summary, summary_differences

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
BASELINES = Path(__file__).parent / "baselines"
PUBLISHED = ROOT / "figures" / "thesis"
RESULTS = ROOT / "results" / "thesis"
MEASURED = ROOT / "config" / "reference"
UPDATE = os.environ.get("FINGERPAD_UPDATE_BASELINES") == "1"
AFRESH = [number for number in FIGURES if not number.startswith("5-")]
ACCEPT = "; if this is meant, run make regression-update and commit"


def the_scene(name):
    return load_scene(ROOT / "config" / "scenes" / f"{name}.yaml")


@cache
def coarse(name):
    """A scene simulated on a coarse mesh, once for all figures: history and mesh."""
    scene = the_scene(name).with_accuracy("draft")
    chosen = plan(scene)
    mesh = mesh_for(scene, chosen)
    return simulate(scene, chosen, mesh=mesh), mesh


@pytest.fixture(scope="module")
def cached():
    """The cached results at thesis resolution, each opened when first needed."""
    patterns = (
        "simulations/*/history.nc",
        "simulations/*/mesh.msh",
        "coarse/*/history.nc",
        "coarse_mesh/*/history.nc",
    )
    return read_results(path for pattern in patterns for path in RESULTS.glob(pattern))


@pytest.fixture(scope="module")
def reference():
    return read_reference(ROOT / "config" / "reference" / "thesis_numbers.csv")


@pytest.mark.parametrize("number", AFRESH)
def test_data_of_a_coarse_simulation_are_those_of_the_baseline(reference, number, tmp_path):
    path, spec = BASELINES / f"fig_{number}.csv", FIGURES[number]
    histories, meshes = ({name: coarse(name)[k] for name in spec.needs} for k in (0, 1))
    frame = spec.frame(histories, meshes, {}, reference, *spec.measurements(MEASURED))
    write_frame(frame, path if UPDATE else tmp_path / "new.csv")
    changed = differences(read_frame(path if UPDATE else tmp_path / "new.csv"), read_frame(path))
    assert not changed, f"{changed}{ACCEPT}"


# --- strokes --------------------------------------------------------------------------------------

STROKED = [
    number for number in FIGURES if number.startswith("5-") and number not in ("5-25", "5-26")
]  # pads pressed only


def stands_for(history, name):
    """The history of a stroke under another scene's name: passed at that scene's speed, mirrored if
    it goes the other way.
    """
    scene, done = the_scene(name), scene_of(history)
    slow, fast = (each.motion[1].speed or 1.0 for each in (done, scene))
    start = float(history["time"][history["leg"] == 0][-1])
    time = history["time"].where(
        history["time"] <= start, start + (history["time"] - start) * slow / fast
    )
    kept = scene.varied({"accuracy": done.accuracy}).canonical()
    told = history.assign_coords(time=("time", time.values, history["time"].attrs)).assign_attrs(
        scene=json.dumps(kept)
    )
    if np.sign(scene.motion[1].slide) == np.sign(done.motion[1].slide):
        return told
    told["stroke_distance"] = -told["stroke_distance"]
    return told.assign_coords(receptor_offset=-told["receptor_offset"])


#: name -> steps of all its legs, and keys changed, of one stroke over each surface and one of each
#: plate
SHORT = {
    "stroke_10": (140, {"outputs.snapshots": (2.0,)}),
    "stroke_sub_10": (60, {}),
    "step_sub": (1, {}),
    "plate_stroke_right": (12, {}),
    "ridged_stroke_right": (12, {}),
}
#: which of these stands for the other speeds and ways
FOR = {f"stroke_{v}": "stroke_10" for v in (1, 5, 20, 40)} | {
    f"stroke_sub_{v}": "stroke_sub_10" for v in (1, 40)
}
FOR |= {f"{pad}_stroke_left": f"{pad}_stroke_right" for pad in ("plate", "ridged")}


@cache
def real(name):
    """A history that was simulated: strokes on a mesh of few elements, the rest as above."""
    if name in FOR:
        return stands_for(real(FOR[name]), name)
    if name not in SHORT:
        return coarse(name)[0]
    steps, changes = SHORT[name]
    return simulate(
        the_scene(name).varied({"accuracy": {"skin_edge": 1e-3, "steps": steps}, **changes})
    )


@pytest.mark.parametrize("number", STROKED)
def test_figure_of_strokes_can_be_drawn_from_simulated_ones(reference, number):
    """What it reads is there, and every column has values where the made-up data's has."""
    spec = FIGURES[number]
    frame = spec.frame(
        {name: real(name) for name in spec.needs}, {}, {}, reference, *spec.measurements(MEASURED)
    )
    ours, theirs = (
        rows[rows["source"].str.startswith("simulated")] for rows in (frame, made_up(number))
    )
    assert list(frame) == list(made_up(number))
    valued = {column for column in theirs if theirs[column].notna().any() and column not in PARTS}
    assert valued <= {column for column in ours if ours[column].notna().any()}
    assert spec.draw(frame).axes


def test_strokes_keep_their_force_and_pass_every_convexity():
    """So that what the figures above read is a stroke."""
    for name in (
        "stroke_10",
        "stroke_40",
        "stroke_sub_10",
        "plate_stroke_left",
        "ridged_stroke_right",
    ):
        slid = real(name).isel(time=np.flatnonzero(real(name)["leg"] > 0))
        np.testing.assert_allclose(
            slid["force"], 20 * 9.80665e-3 / scene_of(real(name)).specimen.contact_length, rtol=1e-3
        )
    lengths = FIGURES["5-4"].frame(
        {name: real(name) for name in FIGURES["5-4"].needs}, {}, {}, empty_reference()
    )
    assert (lengths["contact_length (mm)"] > 0).all() and len(lengths) == 40


MADE = {
    "stroke_10": synthetic.stroke,
    "step_sub": synthetic.stroke,
    "ridged_stroke_right": synthetic.plate_stroke,
    "ramp40_flat": synthetic.history,
    "steady_cylinder_1_8_inch": synthetic.pressed,
}


@pytest.mark.parametrize("name", MADE)
def test_made_up_histories_have_what_simulated_ones_have(name):
    """Variables and coordinates on the same dimensions, in the same units."""
    one, other = real(name), MADE[name](name)
    assert set(one.variables) == set(other.variables) and set(one.coords) == set(other.coords)
    assert {v: one[v].dims for v in one.variables} == {v: other[v].dims for v in one.variables}
    assert {v: one[v].attrs.get("units") for v in one.variables} == {
        v: other[v].attrs.get("units") for v in one.variables
    }
    assert set(scene_of(one).canonical()) == set(scene_of(other).canonical()) and np.all(
        np.diff(other.skin_arc) > 0
    )


# --- what is published ----------------------------------------------------------------------------


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
    write_picture(
        FIGURES[number].draw(read_frame(PUBLISHED / f"fig_{number}.csv")), tmp_path / "new.png"
    )
    alike = similarity(tmp_path / "new.png", PUBLISHED / f"fig_{number}.png", shrink=3)
    assert alike >= SIMILARITY, f"similarity {alike:.3f}; run make figures"


@pytest.mark.skipif(
    not RESULTS.is_dir(), reason="no results/thesis here: make figures has not been run"
)
def test_published_data_are_those_of_the_cached_results(cached, reference, tmp_path):
    made = {number: spec for number, spec in FIGURES.items() if set(spec.needs) <= set(cached[0])}
    if not made:
        pytest.skip("results/thesis holds all scenes of no figure")
    for number, spec in made.items():
        write_frame(
            spec.frame(*cached, reference, *spec.measurements(MEASURED)), tmp_path / "new.csv"
        )
        changed = differences(
            read_frame(tmp_path / "new.csv"), read_frame(PUBLISHED / f"fig_{number}.csv")
        )
        assert not changed, f"Fig. {number}: {changed}; run make figures"

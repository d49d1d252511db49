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
import re
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.figures.axes import simulated
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.energy_of_1999 import as_of_1999
from cysyk1999.measures.errors import PARTS
from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.tables import read_frame, write_frame, write_published
from cysyk1999.publishing.write import write_picture
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
    return read_results((p for pattern in patterns for p in RESULTS.glob(pattern)), of_1999=True)


@pytest.fixture(scope="module")
def reference():
    return read_reference(ROOT / "config" / "reference" / "thesis_numbers.csv")


@pytest.mark.parametrize("number", AFRESH)
def test_data_of_a_coarse_simulation_are_those_of_the_baseline(reference, number, tmp_path):
    baseline, spec = BASELINES / f"fig_{number}.csv", FIGURES[number]
    new = baseline if UPDATE else tmp_path / "new.csv"
    histories = {name: as_of_1999(coarse(name)[0]) for name in spec.needs}
    meshes = {name: coarse(name)[1] for name in spec.needs}
    write_frame(spec.frame(histories, meshes, {}, reference, *spec.measurements(MEASURED)), new)
    changed = differences(read_frame(new), read_frame(baseline))
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
    time, start = history["time"], history["time"][history["leg"] == 0][-1]
    kept = scene.varied({"accuracy": done.accuracy}).canonical()
    told = history.assign_attrs(scene=json.dumps(kept))
    told["time"] = time.copy(data=time.where(time <= start, start + (time - start) * slow / fast))
    if np.sign(scene.motion[1].slide) != np.sign(done.motion[1].slide):
        told["stroke_distance"] = -told["stroke_distance"]
        told["receptor_offset"] = -told["receptor_offset"]
    return told


#: name -> steps of all its legs, of one stroke over each surface and one of each plate
SHORT = {
    "stroke_10": 140,
    "stroke_sub_10": 60,
    "step_sub": 1,
    "plate_stroke_right": 12,
    "ridged_stroke_right": 12,
}


@cache
def real(name):
    """A history that was simulated: strokes on a mesh of few elements, the rest as above. One of
    them stands for those at other speeds and the other way.
    """
    other = re.sub(r"_\d+$", "_10", name).replace("left", "right")
    if other in SHORT and other != name:
        return stands_for(real(other), name)
    if name not in SHORT:
        return coarse(name)[0]
    changes = {"accuracy": {"skin_edge": 1e-3, "steps": SHORT[name]}}
    changes |= {"outputs.snapshots": (2.0,)} if name == "stroke_10" else {}
    return simulate(the_scene(name).varied(changes))


@pytest.mark.parametrize("number", STROKED)
def test_figure_of_strokes_can_be_drawn_from_simulated_ones(reference, number):
    """What it reads is there, and every column has values where the made-up data's has."""
    spec = FIGURES[number]
    histories = {name: real(name) for name in spec.needs}
    frame = spec.frame(histories, {}, {}, reference, *spec.measurements(MEASURED))
    assert list(frame) == list(made_up(number))
    ours, theirs = (
        set(simulated(rows).dropna(axis=1, how="all")) for rows in (frame, made_up(number))
    )
    assert theirs - set(PARTS) <= ours
    assert spec.draw(frame).axes


def test_strokes_keep_their_force_and_pass_every_convexity():
    """So that what the figures above read is a stroke."""
    for name in (*SHORT, "stroke_40", "plate_stroke_left"):
        history = real(name)
        scene = scene_of(history)
        force = history["force"][history["leg"] > 0] * scene.specimen.contact_length
        np.testing.assert_allclose(force, scene.motion[0].force, rtol=1e-3)
    histories = {name: real(name) for name in FIGURES["5-4"].needs}
    frame = FIGURES["5-4"].frame(histories, {}, {}, empty_reference())
    lengths = frame["contact_length (mm)"].dropna()
    assert (lengths > 0).all() and len(lengths) == 40


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
    histories = one, other = real(name), MADE[name](name)
    told, made_told = (
        {name: (v.dims, v.attrs.get("units")) for name, v in each.variables.items()}
        for each in histories
    )
    assert told == made_told and set(one.coords) == set(other.coords)
    assert set(scene_of(one).canonical()) == set(scene_of(other).canonical())
    assert (other.skin_arc.diff("skin_node") > 0).all()


# --- what is published ----------------------------------------------------------------------------


def test_published_data_are_those_of_the_summary():
    path = BASELINES / "thesis.csv"
    new = summary({n: read_frame(PUBLISHED / f"fig_{n}.csv") for n in FIGURES})
    if UPDATE:
        write_frame(new, path)
    text = dict.fromkeys(("figure", "curve", "column"), str)
    changed = summary_differences(new, pd.read_csv(path, dtype=text, keep_default_na=False))
    assert not changed, f"{changed}{ACCEPT}"


@pytest.mark.parametrize("number", FIGURES)
def test_published_picture_shows_its_data(number, tmp_path):
    published, new = PUBLISHED / f"fig_{number}.png", tmp_path / "new.png"
    write_picture(FIGURES[number].draw(read_frame(published.with_suffix(".csv"))), new)
    alike = similarity(new, published, shrink=3)
    assert alike >= SIMILARITY, f"similarity {alike:.3f}; run make figures"


@pytest.mark.skipif(
    not RESULTS.is_dir(), reason="no results/thesis here: make figures has not been run"
)
def test_published_data_are_those_of_the_cached_results(cached, reference, tmp_path):
    new, there = tmp_path / "new.csv", set(cached[0])
    made = {number: spec for number, spec in FIGURES.items() if there.issuperset(spec.needs)}
    if not made:
        pytest.skip("results/thesis holds all scenes of no figure")
    for number, spec in made.items():
        write_published(spec.frame(*cached, reference, *spec.measurements(MEASURED)), new)
        changed = differences(read_frame(new), read_frame(PUBLISHED / f"fig_{number}.csv"))
        assert not changed, f"Fig. {number}: {changed}; run make figures"

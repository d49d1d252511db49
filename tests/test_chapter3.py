"""Chapter 3's checks: steady states solved as such, the line and the bar at thesis resolution, and
their figures and numbers.
"""

from pathlib import Path

import numpy as np
import pytest

import synthetic
from cysyk1999.claims.comparison import thesis_comparison
from cysyk1999.claims.rows import numbers
from cysyk1999.figures.axes import from_source
from cysyk1999.figures.chapter3 import LINED
from cysyk1999.figures.geometry import section, surface_deflection
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.steady import DEPTH_SCENES, leg_end, pressed_depths, steady_force
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.reference_data import empty_reference, read_reference
from fingerpad import load_scene, plan, simulate
from fingerpad.results import VARIABLES, summary
from fingerpad.scenes.families import read_family
from fingerpad.scenes.scene import Bar, Line

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "config" / "scenes"
REFERENCE = ROOT / "config" / "reference"
NUMBERS = numbers(read_reference(REFERENCE / "thesis_numbers.csv"))
STEADY = sorted(name for path in SCENES.glob("steady_*.yaml") for name in read_family(path))
MM = 1e-3


@pytest.fixture(scope="module")
def made():
    """Made-up histories and their meshes."""
    histories = synthetic.histories()
    return histories, synthetic.meshes(histories)


# --- steady states and edges ----------------------------------------------------------------------


@pytest.mark.unit
@pytest.mark.parametrize("name", [*STEADY, "calibration_plate"])
def test_plan_of_a_steady_scene_has_no_time_steps_and_the_relaxed_moduli(name):
    chosen = plan(load_scene(SCENES / f"{name}.yaml"))
    creep = chosen.effects["viscoelasticity"]
    assert not chosen.timed and chosen.state == "long_term"
    assert not creep.on and "steady" in creep.why


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, stimulus",
    [
        ("steady_line", Line()),
        ("steady_bar_1_16_inch", Bar(width=1.5875 * MM, fillet=0.1 * MM)),
        ("steady_bar_1_16_inch", Bar(width=1.5875 * MM)),
    ],
    ids=["line", "bar with fillet", "sharp bar"],
)
def test_edges_reach_two_millimetres_leg_by_leg_without_cuts_and_true_peaks_are_marked_singular(
    name, stimulus
):
    scene = load_scene(SCENES / f"{name}.yaml")
    assert scene.accuracy == "thesis" and scene.stimulus.shape == stimulus.shape
    history = simulate(scene.model_copy(update={"stimulus": stimulus}))
    legs, run = summary(history)["legs"], summary(history)["run"]
    assert legs[-1]["depth_mm"] == pytest.approx(2.0) and run["cutbacks"] == 0
    assert run["peak_pressure_singular"] == (getattr(stimulus, "fillet", None) == 0)
    assert run["complementarity_error"] < 1e-3 and run["min_detF"] > 0.1
    assert history.contact_pressure.min() >= 0
    assert all(np.isfinite(history[name]).all() for name in VARIABLES if name in history)
    forces = [leg["force_N_per_m"] for leg in legs]
    assert (np.diff([0.0, *forces]) > 0).all()


@pytest.mark.slow
def test_full_fields_of_a_steady_scene_are_those_of_the_ends_of_its_legs():
    history = simulate(load_scene(SCENES / "steady_cylinder_1_8_inch.yaml").with_accuracy("draft"))
    apex = history.node_position.values[:, 1].argmax()
    sunk = -1e3 * history.snapshot_displacement.values[:, apex, 1]
    assert sunk == pytest.approx([0.5, 1.0, 1.6, 2.5], abs=2e-3)


# --- figures --------------------------------------------------------------------------------------


@pytest.mark.unit
def test_legs_are_found_by_their_depth(made):
    history = made[0]["steady_cylinder_1_8_inch"]
    depths = pressed_depths(history)
    assert depths == pytest.approx([0.5 * MM, 1.0 * MM, 1.6 * MM, 2.5 * MM])
    ends = [leg_end(history, depth) for depth in depths]
    assert history["indentation_depth"].values[ends] == pytest.approx(depths)
    with pytest.raises(KeyError, match="no press to 3 mm"):
        leg_end(history, 3 * MM)


@pytest.mark.unit
def test_deflection_is_taken_at_the_place_where_the_skin_has_gone(made):
    """A skin that slid along itself is the same surface."""
    history = made[0]["steady_line"].copy(deep=True)
    x, y = history["skin_x"].values, history["skin_y"].values
    upper = y > 0
    history["skin_displacement_x"][:] = 0.2 * MM
    slid = np.interp(x[upper] + 0.2 * MM, x[upper], y[upper])
    history["skin_displacement_y"][:, upper] = slid - y[upper]
    assert np.allclose(surface_deflection(history, 0)[1], 0.0, atol=1e-9)


@pytest.mark.unit
def test_section_moves_each_boundary_with_its_material_and_places_the_indenter(made):
    history = made[0]["steady_cylinder_1_4_inch"]
    before, after = (section(history, depth) for depth in (0.0, 1 * MM))
    tops = [before[name][:, 1].max() for name in LINED[:4]]
    assert tops[0] - tops[1] == pytest.approx(0.35 * MM, abs=2e-6) and (np.diff(tops) < 0).all()
    for name, top in zip(LINED[:4], tops, strict=True):
        sunk = top - after[name][before[name][:, 1].argmax(), 1]
        assert sunk == pytest.approx((top - 1 * MM) / 5, rel=0.03)
    assert after["indenter"][:, 1].min() == pytest.approx(5 * MM)
    assert np.allclose(before["bone"], after["bone"])


@pytest.mark.unit
def test_measured_points_are_those_of_the_files_and_keep_their_origin(made):
    profiles, forces = (
        FIGURES[n].frame(*made, {}, empty_reference(), *FIGURES[n].measurements(REFERENCE))
        for n in ("3-6", "3-7")
    )
    points = from_source(profiles, "measured")
    assert set(points["panel"]) == {"cylinder 3.17 mm", "cylinder 9.52 mm"}
    assert "line load" in set(profiles["panel"])
    deepest = points[(points["panel"] == "cylinder 3.17 mm") & (points["series"] == "2.5 mm")]
    assert deepest["deflection (mm)"].tolist() == [-2.38, -1.72, -1.25, -0.97, -0.57]
    assert set(points["series"]) <= set(profiles.loc[profiles["source"] == "simulated", "series"])
    points = from_source(forces, "measured")
    assert len(points) == 16 and points["source"].str.contains("Dandekar").all()
    second = points.loc[points["series"] == "subject 2", "force (N)"]
    assert second.tolist() == [0.0228, 0.1097, 0.2246, 0.504]


@pytest.mark.unit
def test_force_figures_show_the_steady_level_of_the_same_depth(made):
    slow, fast = (FIGURES[n].frame(*made, {}, empty_reference()) for n in ("3-8", "3-9"))
    levels = slow[slow["phase"] == "steady state"].groupby("series", sort=False)["force (N)"]
    squares = [0.2 * float(depth) ** 2 for depth in DEPTH_SCENES]
    assert levels.min().tolist() == levels.max().tolist() == pytest.approx(squares)
    assert slow["time (s)"].max() == pytest.approx(10)
    assert fast.groupby("series")["time (s)"].max().tolist() == pytest.approx([1.5] * 3)


@pytest.mark.unit
def test_a_subject_added_to_the_folder_is_drawn(made, tmp_path):
    spec, mine = FIGURES["3-7"], tmp_path / "force_depth/mine.csv"
    mine.parent.mkdir()
    text = spec.measured_files(REFERENCE)[0].read_text()
    mine.write_text(text.replace("\n1,", "\nmine,"))
    frame = spec.frame(*made, {}, empty_reference(), *spec.measurements(tmp_path))
    assert "subject mine" in [line.get_label() for line in spec.draw(frame).axes[0].lines]


# --- numbers --------------------------------------------------------------------------------------


@pytest.mark.unit
def test_peak_over_steady_force_is_compared_with_its_estimate_and_never_judged(made):
    m = Measures.of(*made)
    assert NUMBERS["E048c"](m) == pytest.approx(1.5)
    assert steady_force(made[0]["calibration_plate"], 1 * MM) == pytest.approx(0.2)
    rows = thesis_comparison(m, Instead.of({}, {}), REFERENCE / "thesis_numbers.csv")
    rows = rows.set_index("id")
    estimates = rows[rows.index.str.startswith("E04")]
    assert len(estimates) == 7 and set(estimates["verdict"]) == {"not_comparable"}
    assert estimates["note"].str.contains("an estimate to compare with, not a truth").all()
    assert "four are at hand" in rows.loc["T061", "note"]


@pytest.mark.unit
def test_no_figure_or_row_needs_a_peak_pressure_of_the_bar_or_the_line(made):
    """Without one, every figure and number of theirs is made all the same."""
    edges = ("steady_line", "steady_bar_1_16_inch")
    without = made[0] | {name: made[0][name].drop_vars("peak_pressure") for name in edges}
    measures = Measures.of(without, made[1])
    ids = ("T029", "T030a", "T057", "T058", "T072")
    assert np.isfinite([NUMBERS[id_](measures) for id_ in ids]).all()
    for number in ("3-6", "3-10", "3-11"):
        assert len(FIGURES[number].frame(without, made[1], {}, empty_reference()))

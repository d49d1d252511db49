"""Chapter 3's checks: steady states solved as such, the line and the bar at thesis resolution, and
their figures and numbers.
"""

from pathlib import Path

import numpy as np
import pytest

import synthetic
from cysyk1999.claims.comparison import thesis_comparison
from cysyk1999.claims.rows import numbers
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
    assert (
        not chosen.timed
        and chosen.state == "long_term"
        and not chosen.effects["viscoelasticity"].on
    )
    assert "steady" in chosen.effects["viscoelasticity"].why


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
    totals = summary(history)
    assert totals["legs"][-1]["depth_mm"] == pytest.approx(2.0) and totals["run"]["cutbacks"] == 0
    sharp = isinstance(stimulus, Bar) and stimulus.fillet == 0
    assert totals["run"]["peak_pressure_singular"] == sharp and totals["run"]["min_detF"] > 0.1
    assert totals["run"]["complementarity_error"] < 1e-3 and history.contact_pressure.min() >= 0
    assert all(np.isfinite(history[name]).all() for name in VARIABLES if name in history)
    forces = [leg["force_N_per_m"] for leg in totals["legs"]]
    assert (np.diff([0.0, *forces]) > 0).all()


@pytest.mark.slow
def test_full_fields_of_a_steady_scene_are_those_of_the_ends_of_its_legs():
    history = simulate(load_scene(SCENES / "steady_cylinder_1_8_inch.yaml").with_accuracy("draft"))
    assert history.sizes["snapshot"] == 4
    apex = int(
        np.argmin(
            np.hypot(
                *(history.node_position.values - [0, history.node_position.values[:, 1].max()]).T
            )
        )
    )
    sunk = -history.snapshot_displacement.values[:, apex, 1]
    assert sunk == pytest.approx([0.5 * MM, 1.0 * MM, 1.6 * MM, 2.5 * MM], abs=2e-6)


# --- figures --------------------------------------------------------------------------------------


@pytest.mark.unit
def test_legs_are_found_by_their_depth(made):
    history = made[0]["steady_cylinder_1_8_inch"]
    assert pressed_depths(history) == pytest.approx([0.5 * MM, 1.0 * MM, 1.6 * MM, 2.5 * MM])
    assert history["indentation_depth"].values[leg_end(history, 1.6 * MM)] == pytest.approx(
        1.6 * MM
    )
    with pytest.raises(KeyError, match="no press to 3 mm"):
        leg_end(history, 3 * MM)


@pytest.mark.unit
def test_deflection_is_taken_at_the_place_where_the_skin_has_gone(made):
    history = made[0]["steady_line"].copy(deep=True)
    history["skin_displacement_y"][:] = 0.0
    end = history.sizes["time"] - 1
    assert np.allclose(surface_deflection(history, end)[1], 0.0)
    x, y = history["skin_x"].values, history["skin_y"].values
    upper = y > 0
    history["skin_displacement_x"][end] = 0.2 * MM
    history["skin_displacement_y"][end, upper] = (
        np.interp(x[upper] + 0.2 * MM, x[upper], y[upper]) - y[upper]
    )
    assert np.allclose(
        surface_deflection(history, end)[1], 0.0, atol=1e-9
    )  # slid along itself: the same surface


@pytest.mark.unit
def test_section_moves_each_boundary_with_its_material_and_places_the_indenter(made):
    history = made[0]["steady_cylinder_1_4_inch"]
    before, after = (section(history, depth, corneum=True) for depth in (0.0, 1 * MM))
    top = {
        name: line[:, 1].max() for name, line in before.items() if name not in ("bone", "indenter")
    }
    assert top["skin"] - top["corneum"] == pytest.approx(0.35 * MM, abs=2e-6)
    assert list(sorted(top, key=top.get, reverse=True)) == ["skin", "corneum", "dermis", "fat"]
    for name in top:
        node = int(np.argmin(np.where(before[name][:, 1] > 0, abs(before[name][:, 0]), np.inf)))
        sunk = before[name][node, 1] - after[name][node, 1]
        assert sunk == pytest.approx(1 * MM * (before[name][node, 1] - 1 * MM) / (5 * MM), rel=0.03)
    assert after["indenter"][:, 1].min() == pytest.approx(5 * MM) and np.allclose(
        before["bone"], after["bone"]
    )


@pytest.mark.unit
def test_measured_points_are_those_of_the_files_and_keep_their_origin(made):
    profiles, forces = (
        FIGURES[n].frame(*made, {}, empty_reference(), *FIGURES[n].measurements(REFERENCE))
        for n in ("3-6", "3-7")
    )
    points = profiles[profiles["source"].str.startswith("measured")]
    assert set(points["panel"]) == {"cylinder 3.17 mm", "cylinder 9.52 mm"} and "line load" in set(
        profiles["panel"]
    )
    deepest = points[(points["panel"] == "cylinder 3.17 mm") & (points["series"] == "2.5 mm")]
    assert deepest["deflection (mm)"].tolist() == [-2.38, -1.72, -1.25, -0.97, -0.57]
    assert set(points["series"]) <= set(profiles.loc[profiles["source"] == "simulated", "series"])
    points = forces[forces["source"].str.startswith("measured")]
    assert len(points) == 16 and points["source"].str.contains("Dandekar").all()
    assert points.loc[points["series"] == "subject 2", "force (N)"].tolist() == [
        0.0228,
        0.1097,
        0.2246,
        0.504,
    ]


@pytest.mark.unit
def test_force_figures_show_the_steady_level_of_the_same_depth(made):
    frame = FIGURES["3-8"].frame(*made, {}, empty_reference())
    for label in DEPTH_SCENES:
        level = frame.loc[
            (frame["series"] == f"{label} mm") & (frame["phase"] == "steady state"), "force (N)"
        ]
        assert level.tolist() == pytest.approx([0.2 * float(label) ** 2] * 2)
    assert frame["time (s)"].max() == pytest.approx(10)
    ends = FIGURES["3-9"].frame(*made, {}, empty_reference()).groupby("series")["time (s)"].max()
    assert ends.tolist() == pytest.approx([1.5] * 3)


@pytest.mark.unit
def test_a_subject_added_to_the_folder_is_drawn(made, tmp_path):
    (tmp_path / "force_depth").mkdir()
    (source,) = FIGURES["3-7"].measured_files(REFERENCE)[:1]
    header, row = source.read_text().splitlines()[:2]
    (tmp_path / "force_depth" / "mine.csv").write_text(
        f"{header}\n{row.replace('1,flat', 'mine,flat', 1)}\n"
    )
    frame = FIGURES["3-7"].frame(
        *made, {}, empty_reference(), *FIGURES["3-7"].measurements(tmp_path)
    )
    FIGURES["3-7"].draw(frame)
    assert "subject mine" in set(frame["series"].dropna())


# --- numbers --------------------------------------------------------------------------------------


@pytest.mark.unit
def test_peak_over_steady_force_is_compared_with_its_estimate_and_never_judged(made):
    m = Measures.of(*made)
    assert NUMBERS["E048c"](m) == pytest.approx(1.5)
    assert steady_force(made[0]["calibration_plate"], 1 * MM) == pytest.approx(0.2)
    rows = thesis_comparison(m, Instead.of({}, {}), REFERENCE / "thesis_numbers.csv").set_index(
        "id"
    )
    estimates = rows[rows.index.str.startswith("E04")]
    assert len(estimates) == 7 and set(estimates["verdict"]) == {"not_comparable"}
    assert estimates["note"].str.contains("an estimate to compare with, not a truth").all()
    assert "four are at hand" in rows.loc["T061", "note"]


@pytest.mark.unit
def test_no_figure_or_row_needs_a_peak_pressure_of_the_bar_or_the_line(made):
    """Without one, every figure and number of theirs is made all the same."""
    edges = ("steady_line", "steady_bar_1_16_inch")
    made = [
        {n: h.drop_vars("peak_pressure") if n in edges else h for n, h in made[0].items()},
        *made[1:],
    ]
    assert np.isfinite(
        [NUMBERS[i](Measures.of(*made)) for i in ("T029", "T030a", "T057", "T058", "T072")]
    ).all()
    for number in ("3-6", "3-10", "3-11"):
        assert not any(
            "pressure" in column for column in FIGURES[number].frame(*made, {}, empty_reference())
        )

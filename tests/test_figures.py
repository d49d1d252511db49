"""Figures: data frames with units and marks, pictures drawn from the frame alone, files written
whole.
"""

import os
import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.figures.geometry import boundaries, inward
from cysyk1999.figures.grammar import edged_profile, upper_profile
from cysyk1999.figures.registry import CHAPTERS, FIGURES
from cysyk1999.measures.errors import MESH, PARTS, STEPS
from cysyk1999.measures.quantities import CURVATURE, RADIUS
from cysyk1999.publishing.style import spread
from cysyk1999.publishing.tables import without_round_off, write_frame
from cysyk1999.publishing.write import publish, write_picture
from cysyk1999.reference_data import empty_reference, read_reference
from drawn import RATES, REFERENCE, frame, picture, results, saved
from fingerpad.measures import features as ft
from fingerpad.planning.errors import COARSER, PROFILE_ORDER, REMAINS, STEPS_REMAIN, remains
from regression import (
    BASELINE_DPI,
    SIMILARITY,
    differences,
    similarity,
    summary,
    summary_differences,
    tolerance,
)

pytestmark = pytest.mark.unit
TABLE = Path(__file__).parent / "baselines" / "figures.csv"
UPDATE = os.environ.get("FINGERPAD_UPDATE_BASELINES") == "1"
MODULE_OF = {
    spec.number: name.rpartition(".")[2] for name, specs in CHAPTERS.items() for spec in specs
}
WITHOUT_ERROR = ("5-4", "5-25")  # the surface's own lengths; the specimen itself
EDGED = ("4-11", "4-12", "4-13", "4-14", "4-20")
"""Figures of profiles up to the edge of the contact, which is a per cent further away as well: up
to three times the error.
"""
FIRST = ("4-11", "4-12", "4-13", "4-14", "4-16", "4-17", "5-5", "5-6")
"""Of pressures alone over which the edge of the contact passes: of first order."""
CHECKED = [
    number for number in FIGURES if number[0] in "45" and number not in (*WITHOUT_ERROR, *RATES)
]


def _row(number):
    spec, made = FIGURES[number], frame(number)
    row = {"figure": number, "module": MODULE_OF[number], "scenes": " ".join(spec.needs)}
    row |= {"companions": len(spec.read_companions), "measured": spec.measured, "rows": len(made)}
    return row | {"columns": "; ".join(made.columns)}


def test_figures_have_their_scenes_rows_and_columns():
    rows = list(map(_row, FIGURES))
    if UPDATE:
        write_frame(pd.DataFrame(rows), TABLE)
    assert rows == pd.read_csv(TABLE, keep_default_na=False).to_dict("records")


@pytest.mark.parametrize("number", FIGURES)
def test_frame_has_units_an_error_and_a_source_for_every_row(number):
    made, spec = frame(number), FIGURES[number]
    numeric = [c for c in made.select_dtypes("number").columns if c not in ("element", "value")]
    assert set(PARTS) <= set(made) and all(re.search(r" \(.+\)$", c) for c in numeric), numeric
    assert all(map(tolerance, made.select_dtypes("number")))
    measured = made["source"].str.startswith(("measured (", "other model ("))
    if spec.measured != "impulse_rates":  # none may be recorded under a figure's protocol
        assert measured.any() == bool(spec.measured)
    thesis = made[~ft.is_simulated(made) & ~measured]
    assert thesis["source"].str.contains(r"^thesis|stated in the thesis").all()
    assert thesis["source"].str.contains(r"\(T\d+[a-z]?").all()


@pytest.mark.parametrize("number", FIGURES)
def test_frame_needs_only_the_scenes_it_names_and_neither_companions_nor_the_reference(number):
    histories, meshes, coarse, reference = results()
    spec = FIGURES[number]
    companions = {name: coarse[name] for name in spec.read_companions}
    assert set(companions) <= set(spec.needs)
    only = [{name: of[name] for name in spec.needs} for of in (histories, meshes)]
    spec.frame(*only, companions, reference)
    bare = spec.frame(*only, {}, empty_reference())
    assert ft.is_simulated(bare).all() and bare[[MESH, STEPS]].isna().all(axis=None)
    assert spec.draw(bare).axes


def left_on_meshes(number: str) -> float:
    return remains(COARSER, PROFILE_ORDER) if number in FIRST else REMAINS


@pytest.mark.parametrize("number", CHECKED)
def test_errors_are_the_differences_to_the_companions(number):
    """Of which one is a per cent away, and the other a quarter of one further; and so are their
    edges, if the curves have any.

    What of them remains.
    """
    errors, most = frame(number)[[MESH, STEPS]].dropna(), 3 if number in EDGED else 1
    least = left_on_meshes(number)
    largest = 3 * remains(COARSER, PROFILE_ORDER) if number in EDGED else least
    assert errors[MESH].between(0.98 * least, 1.02 * largest).all() and len(errors)
    assert (errors[STEPS] / STEPS_REMAIN).between(0.24, 0.26 * most).all()


@pytest.mark.parametrize("half_width", np.linspace(1.0e-3, 1.067e-3, 6))
def test_profile_ends_at_the_edge_like_that_of_hertz(half_width):
    """Against the ellipse, wherever the edge lies between two nodes; mutant: straight lines from
    node to node have a foot.
    """
    history = results()[0]["ramp40_k210"].isel(time=[-1]).copy(deep=True)
    x = history["skin_x"].values

    def ellipse(at):
        return 8e3 * np.sqrt(np.maximum(1 - (at / half_width) ** 2, 0))

    history["skin_displacement_x"][:] = 0
    history["contact_pressure"][0] = ellipse(x) * (history["skin_y"].values > 0)
    history["contact_width"][:] = 2 * half_width
    found, pressure = edged_profile(history, 0)
    np.testing.assert_allclose(found[[0, -1]], [-half_width, half_width], rtol=1e-12)
    np.testing.assert_allclose([found, pressure], [-found[::-1], pressure[::-1]])
    assert not pressure[[0, -1]].any() and np.abs(pressure - ellipse(found)).max() < 0.03 * 8e3
    mutant = np.interp(found, *upper_profile(history, 0))
    assert np.abs(mutant - ellipse(found)).max() > 0.06 * 8e3


@pytest.mark.parametrize("number", FIGURES)
def test_saved_data_are_those_of_the_frame(number):
    assert not differences(saved(number), frame(number))


@pytest.mark.parametrize("number", FIGURES)
def test_picture_says_what_it_is_and_no_text_leaves_it(number):
    fig = picture(number)
    notes = " ".join(t.get_text() for t in fig.texts).replace("\n", " ")
    assert f"after Cysyk 1999, Fig. {number}: {FIGURES[number].title}" in notes
    assert "not measured" in notes
    if number in RATES:
        assert "Predicted" in notes and "error" in notes.lower()
    elif number in CHECKED:
        most = r"[1-6]\.\d" if number in EDGED else f"{left_on_meshes(number):.1f}"
        assert re.search(rf"Simulated.*mesh {most} %.*sampling", notes)
    ticks = {
        label
        for ax in fig.axes
        for axis in ax._axis_map.values()
        for label in axis.get_ticklabels()
    }
    for text in set(fig.findobj(mpl.text.Text)) - ticks:
        if text.get_visible() and text.get_text():
            box = text.get_window_extent()
            assert fig.bbox.containsx(box.x0) and fig.bbox.containsx(box.x1), text
            assert fig.bbox.containsy(box.y0) and fig.bbox.containsy(box.y1), text


def test_picture_does_not_depend_on_the_callers_matplotlib_settings(tmp_path):
    draw = FIGURES["4-7"].draw
    publish(draw(saved("4-7")), saved("4-7"), tmp_path / "a.png")
    with mpl.rc_context({"font.size": 20, "lines.linewidth": 9}):
        publish(draw(saved("4-7")), saved("4-7"), tmp_path / "b.png")
        assert mpl.rcParams["font.size"] == 20
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_axes_are_the_thesiss_where_the_data_fit():
    upper, lower = picture("4-10").axes
    assert upper.get_ylim() == (0, 30) and lower.get_xlim() == (0, 3)
    assert picture("4-7").axes[0].get_ylim() == (0, 1.5)
    assert picture("4-28").axes[0].get_ylim() == (0, 2500)
    assert {ax.axis() for ax in picture("4-6").axes} == {(-10, 10, 3, 6)}


def test_surface_is_drawn_above_with_the_curvatures_of_its_convexities():
    top, *panels = picture("5-12").axes
    named = [text.get_text() for text in top.texts if text.get_text()[:1].isdigit()]
    assert ",".join(named) == "26 1/m,39,52,79,105,157,210,315"
    assert len(panels) == 2 and {ax.get_xlim() for ax in (top, *panels)} == {(0, 80)}


def test_velocities_lie_over_each_other_and_what_sets_them_apart_lies_below():
    made, q = saved("5-12"), "centre_pressure (Pa)"
    _, whole, more = picture("5-12").axes
    drawn = {line.get_label(): line for line in whole.lines if "mm/s" in line.get_label()}
    assert set(drawn) == {f"{v} mm/s" for v in (1, 5, 10, 20, 40)}
    own = {name: made[made["series"] == name] for name in drawn}
    ten, forty = own["10 mm/s"], own["40 mm/s"]
    x, at = "stroke_distance (mm)", forty["stroke_distance (mm)"].to_numpy()
    expected = forty[q].to_numpy() - np.interp(at, ten[x], ten[q])
    shown = [line.get_ydata() for line in more.lines if len(line.get_ydata()) == len(expected)]
    assert any(np.allclose(each, expected) for each in shown)


@pytest.mark.parametrize("number", ["4-4", "4-18"])
def test_a_finding_says_of_points_what_their_line_says(number):
    made = saved(number)
    (line,) = made["source"][made["source"].str.contains("least-squares line")].unique()
    told = re.search(r"R² ([\d.]+)", FIGURES[number].finding(made))[1]
    assert float(told) == pytest.approx(float(line.rpartition("R2 ")[2]), abs=0.006)


def test_axis_is_extended_and_marked_where_the_data_leave_the_thesiss():
    highest = frame("4-15")["peak_pressure (Pa)"].max()
    ax = picture("4-15").axes[0]
    assert highest > 10000 and ax.get_ylim()[1] > highest
    assert "thesis axis range" in [t.get_text().replace("\n", " ") for t in ax.texts]


@pytest.mark.parametrize("values", [[1.0, 1.01, 1.02, 5.0], [0.0, 0.0, 0.0], [9.9, 9.95, 10.0]])
def test_labels_keep_their_order_and_distance(values):
    placed = spread(values, 0.5, 0, 10)
    assert (np.diff(placed) >= 0.5 - 1e-12).all() and 0 <= placed[0] and placed[-1] <= 10 + 1e-12


# --- geometry -------------------------------------------------------------------------------------


def test_boundaries_are_closed_and_offset_by_the_layers_thickness():
    mesh = synthetic.mesh()
    lines = boundaries(mesh)
    assert all(line[0] == line[-1] for line in lines.values())
    points = {name: mesh.points[line] for name, line in lines.items()}
    points["moved"] = inward(points["skin"], 0.35e-3)
    top = {name: line[:, 1].max() * 1e3 for name, line in points.items()}
    expected = {"skin": 6, "dermis": 5.15, "fat": 4.3, "bone": 1, "moved": 5.65}
    assert top == pytest.approx(expected, abs=1e-3)
    with pytest.raises(ValueError, match="half"):
        boundaries(mesh.right_half())


# --- specs, files and tables ----------------------------------------------------------------------


def test_a_failed_write_leaves_the_old_files(tmp_path, monkeypatch):
    def fails(*args, **kwargs):
        raise OSError("disk full")

    png = tmp_path / "f.png"
    publish(picture("4-15"), frame("4-15"), png)
    before = png.read_bytes()
    monkeypatch.setattr("PIL.Image.Image.save", fails)
    with pytest.raises(OSError):
        publish(picture("4-15"), frame("4-15"), png)
    assert png.read_bytes() == before and len(list(tmp_path.iterdir())) == 2


def test_reference_table_is_checked(tmp_path):
    table = pd.read_csv(REFERENCE, dtype=str)
    path = tmp_path / "numbers.csv"
    pd.concat([table, table[:1]]).to_csv(path, index=False)
    with pytest.raises(ValueError, match="repeated id T026"):
        read_reference(path)
    table.assign(kind="guess").to_csv(path, index=False)
    with pytest.raises(ValueError, match="unknown kind"):
        read_reference(path)


# --- what the regression tests notice -------------------------------------------------------------


SHOWN = r"\(Pa|\(impulses/s\)|^burst_duration|^y |_(?:depth|width|displacement|length) \((?:1/)?mm"
"""Columns whose change is to be noticed, where a figure has one; else the distance's."""


@pytest.mark.parametrize("number", [n for n in FIGURES if n[0] in "45"])
def test_a_change_of_two_per_cent_in_one_curve_is_noticed(number):
    made = frame(number)
    column = ["stroke_distance (mm)", *made.columns[made.columns.str.contains(SHOWN)]][-1]
    labels = ("surface", "node_x (mm)", "pad", "phase", "series", "source")
    label = next(filter(made.columns.__contains__, labels))
    rows = ft.is_simulated(made) & (made[column].gt(0) if number in RATES else made[column].notna())
    rows &= made[label] == made.loc[rows, label].dropna().iloc[0]
    changed = made.copy()
    changed.loc[rows, column] *= 1.02
    assert differences(changed, made)
    assert summary_differences(summary({number: changed}), summary({number: made}))


def test_a_missing_curve_or_column_is_noticed():
    made = frame("4-23")
    fewer = made[made["surface"] != "210"]
    assert any("210" in d for d in differences(fewer, made))
    assert differences(made.drop(columns=MESH), made)
    assert summary_differences(summary({"4-23": fewer}), summary({"4-23": made}))


@pytest.mark.parametrize("number", ["4-7", "4-11", "4-20", "4-24", "5-9", "5-12", "5-18"])
def test_a_missing_curve_or_a_changed_axis_is_noticed_in_the_picture(number, tmp_path):
    made, one, other = saved(number), tmp_path / "a.png", tmp_path / "b.png"
    write_picture(picture(number), one, BASELINE_DPI)
    without = made.copy()
    if number == "4-7":
        without.loc[made["source"].str.contains("T102"), "indentation_depth (mm)"] *= 1.07
    else:
        curve = made["surface"] == "158" if number[0] == "4" else made["series"] == "10 mm/s"
        values = without.columns.str.contains(r"\(Pa\)")
        without.loc[curve & ft.is_simulated(made), values] = np.nan
    write_picture(FIGURES[number].draw(without), other, BASELINE_DPI)
    assert similarity(one, other) < SIMILARITY


def test_panels_of_pairs_have_axes_of_their_own():
    axes = picture("5-4").axes
    assert [ax.get_xlabel() for ax in axes] == [CURVATURE.label, RADIUS.label]
    bends, radii = (
        next(x for x in (line.get_xdata() for line in ax.lines) if len(x) > 2) for ax in axes
    )
    np.testing.assert_allclose(np.sort(1e3 / bends), radii, rtol=1e-4)


def test_round_off_is_published_as_zero():
    """What is 1e-11 of a column's largest differs between machines; what is more, and text,
    stays.
    """
    frame = pd.DataFrame(
        {"of": list("abc"), "x": [2.0, -1e-12, 3e-11], "y": [np.nan, 1e-30, 1e-42]}
    )
    expected = frame.assign(x=[2.0, 0.0, 3e-11], y=[np.nan, 1e-30, 0.0])
    pd.testing.assert_frame_equal(without_round_off(frame), expected, rtol=0, atol=0)


def test_a_picture_does_not_depend_on_the_last_digits_of_its_layout(tmp_path):
    fig = picture("4-8")
    write_picture(fig, tmp_path / "a.png", BASELINE_DPI)
    edges = np.array([ax.get_position(which).extents for ax in fig.axes for which in (True, False)])
    assert edges.size and (edges == edges.round(12)).all()

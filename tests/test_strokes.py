"""Strokes: what is read from them, and the moving picture."""

import numpy as np
import pytest
from PIL import Image

import synthetic
from cysyk1999.figures.animation import animate, drawn
from fingerpad.measures import strokes as st
from fingerpad.measures.features import centre_node, centre_pressure
from fingerpad.measures.kept import LazyMapping
from test_stroke_trends import changed

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def made():
    return {name: synthetic.stroke(name) for name in synthetic.STROKES}


@pytest.fixture(scope="module")
def slow(made):
    return st.loaded(made["stroke_1"])


# --- what is read ---------------------------------------------------------------------------------


def test_loaded_outputs_are_the_last_of_each_stroke_distance(made):
    stepped = st.loaded(made["step_sub"])
    assert st.distance(stepped) * 1e3 == pytest.approx(np.arange(51))
    assert stepped["force"].values == pytest.approx(synthetic.LOAD)
    stroke = st.loaded(made["stroke_10"])
    assert (
        stroke.sizes["time"] == 321
        and st.distance(stroke)[0] == 0
        and st.time_of(stroke)[[0, -1]].tolist() == [0, 8]
    )


def test_what_is_loaded_already_is_not_made_again(made, slow):
    assert st.loaded(slow) is slow
    assert st.loaded(made["stroke_10"]) is st.loaded(made["stroke_10"])


def test_to_ask_whether_there_is_a_result_does_not_open_it():
    opened = LazyMapping(lambda name: pytest.fail(f"{name} was opened"), ["stroke_10"])
    assert "stroke_10" in opened and "stroke_20" not in opened


def test_centre_node_is_under_the_point_that_it_is_dragged_back_to(slow):
    assert st.place(slow)[0] == 0
    assert st.place(slow)[-1] == pytest.approx(79e-3, abs=1e-5)  # dragged by 1 mm


def test_contact_lengths_are_the_chords_less_what_the_corner_takes(slow):
    found = st.contact_lengths(slow)
    chords = {k: arc.end - arc.start for k, arc in st.convexities(slow).items()}
    assert found["26"] == pytest.approx(chords["26"] - 0.4e-3, abs=0.15e-3)
    assert [found[k] for k in chords if k != "26"] == pytest.approx(
        [v for k, v in chords.items() if k != "26"], abs=2 * st.FINE
    )


def _passed_by_hertz(stroke, half_width):
    """The stroke with Hertz's pressure under a contact that goes over the centre node half way, one
    stroke distance one place.
    """
    x, d = stroke["skin_x"].values, st.distance(stroke)
    away = (x - x[centre_node(stroke)])[None] - (d - d.mean())[:, None]
    pressure = (
        5e3 * np.sqrt(np.maximum(1 - (away / half_width) ** 2, 0)) * (stroke["skin_y"].values > 0)
    )
    return changed(stroke, contact_pressure=pressure)


def _spacing(stroke):
    """m, of the nodes beside the centre node."""
    x = stroke["skin_x"].values
    return np.sort(abs(x - x[centre_node(stroke)])[stroke["skin_y"].values > 0])[1]


def _contact_of_centre(stroke):
    return st.FINE * np.count_nonzero(st._finely(stroke)[1])


@pytest.mark.parametrize("spacings", [4.3, 6.1, 9.85])
def test_contact_of_the_centre_begins_and_ends_between_nodes_and_outputs(slow, spacings):
    """Half a node off at either end is what counting nodes is wrong by, and so is another law of
    the pressure at the edge.
    """
    half_width = spacings * _spacing(slow)
    assert _contact_of_centre(_passed_by_hertz(slow, half_width)) == pytest.approx(
        2 * half_width, abs=2 * st.FINE
    )


def test_mutant_that_takes_the_last_node_for_the_edge(slow, monkeypatch):
    half_width = 6.1 * _spacing(slow)
    monkeypatch.setattr(st, "edge_of", lambda x, pressure, spacing, on_edge: x[-1])
    assert (
        abs(_contact_of_centre(_passed_by_hertz(slow, half_width)) - 2 * half_width) > 10 * st.FINE
    )


def test_contact_is_lost_at_the_corner_only(slow):
    ((left, back),) = st.lost_contacts(slow)
    assert left < 8e-3 < back and back - left == pytest.approx(0.8e-3, abs=0.5e-3)


def test_passing_ends_half_way_into_the_neighbours(slow):
    arc = st.convexities(slow)["52"]
    under = st.place(slow)[st.passing(slow, arc)]
    before, after = (a for a in st.arcs(slow) if a.end == arc.start or a.start == arc.end)
    assert under.min() == pytest.approx((before.start + before.end) / 2, abs=0.25e-3)
    assert under.max() == pytest.approx((after.start + after.end) / 2, abs=0.25e-3)


def test_curvature_is_scaled_to_the_pressure_in_contact(slow):
    fit, slope, offset, likeness = st.scaled(
        st.centre_curvature(slow), centre_pressure(slow), st.touching(slow)
    )
    x = np.linspace(0, 1, 50)
    straight = st.scaled(x, 3 * x - 1 + 100 * (x > 0.5), x <= 0.5)
    assert straight[1:] == pytest.approx((3, -1, 1)) and straight[0][-1] == pytest.approx(2)
    assert fit.shape == st.distance(slow).shape and slope > 0 and offset > 0 and likeness > 0.4


@pytest.mark.parametrize("shift", [1.2e-3, -0.4e-3, 0.0])
def test_lag_recovers_a_shift(shift):
    x = np.arange(0, 50e-3, 0.25e-3)

    def bumps(at):
        return np.exp(-(((at - 20e-3) / 2e-3) ** 2)) + np.exp(-(((at - 31e-3) / 1e-3) ** 2))

    found, likeness = st.lag(x, bumps(x - shift), x[::4], bumps(x[::4]))
    assert found == pytest.approx(shift, abs=0.03e-3) and likeness > 0.99


# --- the moving picture ---------------------------------------------------------------------------


def test_animation_has_a_frame_a_snapshot_and_the_same_bytes_again(made, tmp_path):
    history = made["stroke_10"].isel(snapshot=[0, 3, 7])
    animate(history, tmp_path / "a.gif")
    animate(history, tmp_path / "b.gif")
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
    with Image.open(tmp_path / "a.gif") as picture:
        frames = []
        for k in range(picture.n_frames):
            picture.seek(k)
            frames.append(np.asarray(picture.convert("RGB"), int))
    assert len(frames) == 3
    assert all(
        abs(a - b).max() > 100 for a, b in zip(frames, frames[1:], strict=False)
    )  # the surface has moved on
    yellow = frames[1][..., 0] - frames[1][..., 2] > 60
    assert yellow.mean() > 0.005  # stress in colours of the map


def test_a_frame_shows_nothing_of_the_frame_before(made):
    (_, *two), (_, *turned) = (
        drawn(made["stroke_10"].isel(snapshot=list(order))) for order in ((0, 3, 7), (0, 7, 3))
    )
    assert all(np.array_equal(a, b) for a, b in zip(two, reversed(turned), strict=True))


def test_animation_needs_snapshots(made, tmp_path):
    with pytest.raises(ValueError, match="no snapshots"):
        animate(made["stroke_5"], tmp_path / "a.gif")

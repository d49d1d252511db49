"""Strokes: what is read from them, the trends of chapter 5 and a mutant of each, the moving
picture.
"""

import numpy as np
import pytest
from PIL import Image

import synthetic
from cysyk1999.claims.comparison import TRENDS
from cysyk1999.figures.animation import animate, drawn
from cysyk1999.measures.table import MEASURES, Measures
from fingerpad.measures import strokes as st
from fingerpad.measures.features import (
    centre_node,
    centre_pressure,
    energy,
)
from fingerpad.measures.kept import LazyMapping

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module")
def made():
    return {name: synthetic.stroke(name) for name in synthetic.STROKES}


@pytest.fixture(scope="module")
def slow(made):
    return st.loaded(made["stroke_1"])


def _holds(made, id_, **changed):
    return TRENDS[id_](Measures.of(made | changed))


def _with(history, **values):
    """The history with other values of some variables."""
    return history.assign(
        {name: (history[name].dims, v, history[name].attrs) for name, v in values.items()}
    )


def _with_centre(history, values):
    """The history with another pressure at the centre node, which its strain energy follows."""
    pressure = history["contact_pressure"].values.copy()
    pressure[:, centre_node(history)] = values
    energy = np.outer(values, (0.02, 0.04))
    return _with(
        history, contact_pressure=pressure, centre_pressure=values, strain_energy_density=energy
    )


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
    return _with(stroke, contact_pressure=pressure)


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


# --- trends: each holds in what is made for it, and fails in a mutant -----------------------------


def _follower(history, of):
    """Centre pressure that is a function of the surface's curvature over the centre node."""
    pieces = st.profile_and_height(history)[0].segments
    under = st.place(history)
    touches = st.touching(history) & (
        abs(st.centre_curvature(history)) < 350
    )  # the made-up skin has kinks at its edges
    bend = sum(np.where((under >= p.start) & (under < p.end), p.curvature, 0.0) for p in pieces)
    return _with_centre(history, touches * of(bend))


@pytest.fixture(scope="module")
def following(made):
    """Strokes without the made-up profile's width: centre pressure linear in curvature, above zero
    in contact.
    """
    return {name: _follower(history, lambda k: 12000 + 30 * k) for name, history in made.items()}


def test_pressure_follows_curvature(following):
    for id_ in ("TR24", "TR26"):
        assert _holds(following, id_).holds
        scene = {"TR24": "step_sub", "TR26": "stroke_10"}[id_]
        other = _follower(following[scene], lambda k: 12000 - 30 * k)
        assert not _holds(following, id_, **{scene: other}).holds


def test_skin_in_contact_has_the_surfaces_curvature(made):
    assert _holds(made, "TR27").holds
    history = made["stroke_20"]
    flattened = _with(history, skin_displacement_y=0.5 * history["skin_displacement_y"].values)
    assert not _holds(made, "TR27", stroke_20=flattened).holds


def test_peaks_grow_with_curvature(following):
    assert _holds(following, "TR28").holds
    assert not _holds(
        following, "TR28", stroke_5=_follower(following["stroke_5"], lambda k: 12000 - 30 * k)
    ).holds


def test_peaks_change_little_with_velocity(following):
    for id_ in ("TR29", "TR30"):
        assert _holds(following, id_).holds
        faster = _with_centre(following["stroke_40"], 1.5 * centre_pressure(following["stroke_40"]))
        outcome = _holds(following, id_, stroke_40=faster)
        assert not outcome.holds and outcome.shown == pytest.approx(50, rel=0.01)
        slower = _with_centre(following["stroke_40"], 0.8 * centre_pressure(following["stroke_40"]))
        assert not _holds(following, id_, stroke_40=slower).holds
        between = _with_centre(
            following["stroke_10"], 1.1 * centre_pressure(following["stroke_10"])
        )  # the ends tell
        assert _holds(following, id_, stroke_10=between).holds


def test_length_in_contact_falls_with_curvature_and_not_with_velocity(made):
    assert _holds(made, "TR32").holds
    history = made["stroke_10"]
    without = centre_pressure(history) * (abs(st.place(history) - 32e-3) > 3e-3)  # most of K = 39
    broken = _with_centre(history, without)
    assert not _holds(made, "TR32", stroke_10=broken).holds
    assert not _holds(made, "TR31", stroke_10=broken).holds


def test_stepped_and_stroked_are_alike(following):
    assert _holds(following, "TR33").holds
    half = _with_centre(
        following["stroke_sub_10"], 0.5 * centre_pressure(following["stroke_sub_10"])
    )
    assert not _holds(following, "TR33", stroke_sub_10=half).holds


def test_peaks_are_higher_stroked(following):
    higher = _with_centre(
        following["stroke_sub_10"], 1.1 * centre_pressure(following["stroke_sub_10"])
    )
    assert _holds(following, "TR34", stroke_sub_10=higher).holds
    assert not _holds(
        following,
        "TR34",
        step_sub=_with_centre(following["step_sub"], 1.2 * centre_pressure(following["step_sub"])),
    ).holds


def test_contact_is_lost_at_the_corner_and_later_when_stroked(made):
    assert _holds(made, "TR35").holds and _holds(made, "TR36").holds
    kept = _with_centre(made["step_sub"], np.full(made["step_sub"].sizes["time"], 2500.0))
    assert not _holds(made, "TR35", step_sub=kept).holds
    assert not _holds(made, "TR36", step_sub=made["stroke_sub_10"]).holds


def test_contact_is_lost_before_both_convexities_at_40_mm_per_s_only(made):
    def losing(name):
        history = made[name]
        return _with_centre(
            history, centre_pressure(history) * (abs(st.place(history) - 28e-3) > 0.6e-3)
        )

    assert not _holds(made, "TR37").holds and _holds(made, "TR38").holds
    assert _holds(made, "TR37", stroke_sub_40=losing("stroke_sub_40")).holds
    assert not _holds(made, "TR38", stroke_sub_10=losing("stroke_sub_10")).holds


def _felt(history, peak):
    """Strain energy with one bump over each convexity, of heights `peak` (curvature label ->
    Pa).
    """
    under, arcs = st.place(history), st.convexities(history)
    middles = {k: (a.start + a.end) / 2 for k, a in arcs.items()}
    bumps = sum(
        peak(k) * np.exp(-(((under - m) / (0.3 * (arcs[k].end - arcs[k].start))) ** 2))
        for k, m in middles.items()
    )
    return _with(history, strain_energy_density=np.column_stack([bumps, bumps]))


def test_strain_energy_falls_for_the_two_sharpest(made):
    falling = {
        "26": 170,
        "39": 190,
        "52": 210,
        "79": 250,
        "105": 290,
        "157": 300,
        "210": 240,
        "315": 180,
    }
    strokes = {f"stroke_{v}": _felt(made[f"stroke_{v}"], falling.get) for v in st.SPEEDS}
    assert _holds(made, "T263", **strokes).holds
    last_rises = _felt(made["stroke_40"], (falling | {"315": 260}).get)
    assert not _holds(made, "T263", **(strokes | {"stroke_40": last_rises})).holds


def test_strain_energy_stroked_against_pressed(made):
    pressed = {
        f"ramp40_k{k}": synthetic.history(f"ramp40_k{k}")
        for k in ("79", "105", "158", "210", "315")
    }
    peaks = [float(energy(h, 915e-6).max()) for h in pressed.values()]
    labels = ("79", "105", "157", "210", "315")
    level = dict(zip(labels, np.array(peaks) * (1.0, 0.9, 0.8, 0.7, 0.6), strict=True))
    below = _felt(made["stroke_10"], lambda k: level.get(k, 150))
    assert all(_holds(made, id_, stroke_10=below, **pressed).holds for id_ in ("TR39", "TR40"))
    higher = _felt(made["stroke_10"], lambda k: 1.3 * level.get(k, 150) * (1 + float(k) / 315))
    assert not any(_holds(made, id_, stroke_10=higher, **pressed).holds for id_ in ("TR39", "TR40"))


def _twin(history, apart):
    """Strain energy with two bumps over each convexity, `apart` (chord -> m) from one another."""
    under = st.place(history)
    values = np.full(under.shape, 20.0)
    for arc in st.convexities(history).values():
        chord, middle = arc.end - arc.start, (arc.start + arc.end) / 2
        for side in (-0.5, 0.5):
            values += 80 * np.exp(-(((under - middle - side * apart(chord)) / (0.15 * chord)) ** 2))
    return _with(history, strain_energy_density=np.column_stack([values, values]))


def test_double_peaks_and_their_distance(made):
    twins = {
        f"stroke_{v}": _twin(made[f"stroke_{v}"], lambda chord: 0.8 * chord) for v in st.SPEEDS
    }
    assert _holds(made, "TR41", **twins).holds and _holds(made, "TR42", **twins).holds
    arc = st.convexities(made["stroke_1"])["52"]
    assert MEASURES["energy_peaks_apart"](twins["stroke_1"])["52"] == pytest.approx(
        0.8e3 * (arc.end - arc.start), abs=0.5
    )
    wider = _twin(made["stroke_5"], lambda chord: 3e-3 * 6e-3 / chord)
    assert not _holds(made, "TR42", **(twins | {"stroke_5": wider})).holds
    single = _felt(made["stroke_5"], lambda k: 100)
    assert not _holds(made, "TR41", **(twins | {"stroke_5": single})).holds


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

"""Pictures of what happens inside: frames of a few coarse simulations, with what must be so in
them, and pictures of these.
"""

import itertools
from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from PIL import Image

from cysyk1999.claims.comparison import KINDS, scores
from cysyk1999.config import read_config
from cysyk1999.figures.animation import MOST_FRAMES, animate
from cysyk1999.measures.quantities import DISTANCE, IMPULSE_RATE, SED, P, X, Y
from cysyk1999.publishing import style
from cysyk1999.publishing.tables import read_frame, write_frame
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.views import tables
from cysyk1999.studies.views.frames import BOUND, SKIN_X, STATE, STICKING, TRACTION
from cysyk1999.studies.views.run import FRAMES, VIEWS
from fingerpad import load_scene, simulate
from fingerpad.documents import read_yaml

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[1]
SCENES = ROOT / "config" / "scenes"
COARSE = {"skin_edge": 0.6e-3, "steps": 6}
CHANGED = {
    "fields_k210": {"outputs.snapshots": (0.25, 0.5, 1.5)},
    "stroke_map_10": {
        "accuracy": {"skin_edge": 0.6e-3, "steps": 60},
        "outputs.receptors.offsets": (-3e-3, 0.0, 1e-3, 3e-3),
    },
}


@cache
def history(name):
    scene = load_scene(SCENES / f"{name}.yaml")
    scene = scene.varied({"accuracy": COARSE} | CHANGED.get(name, {}))
    return simulate(scene, fields=bool(scene.outputs.snapshots))


@cache
def frame(view):
    make, scenes = FRAMES[view]
    return make({name: history(name) for name in scenes})


def part(view, panel, series=""):
    rows = frame(view)[frame(view)["panel"] == panel]
    return rows[rows["series"] == series] if series else rows


@pytest.mark.parametrize("view", FRAMES)
def test_picture_is_drawn_from_what_is_published_and_fits_a_page(view, tmp_path):
    write_frame(frame(view), tmp_path / "frame.csv")
    fig = VIEWS[view](read_frame(tmp_path / "frame.csv"))
    with style.theme():
        fig.draw_without_rendering()
    width, height = fig.get_size_inches() * 25.4
    assert width == pytest.approx(183) and height <= 170.01
    assert len(fig.texts[-1].get_text().split("\n")) <= 2  # the note
    numeric = frame(view).select_dtypes("number").columns
    assert all(c.endswith(")") and " (" in c for c in numeric)
    edge = fig.get_size_inches() * fig.dpi
    ticks = ([*ax.get_xticklabels(), *ax.get_yticklabels()] for ax in fig.axes)
    for text in set(fig.findobj(mpl.text.Text)) - set(itertools.chain(*ticks)):
        if text.get_visible() and text.get_text():
            box = text.get_window_extent()
            assert (box.min >= -1).all() and (box.max <= edge + 1).all(), text.get_text()


def test_every_scene_of_the_views_is_simulated_by_the_default_configuration():
    config = read_config(read_yaml(ROOT / "config/thesis.yaml"), "config/thesis.yaml")
    needed = {scene for _, scenes in FRAMES.values() for scene in scenes}
    assert needed <= {*config.every_scene, *config.field_scenes}
    assert set(config.field_scenes) <= needed


def test_overview_shows_one_moment_and_the_rate_that_follows_from_it():
    done = history("fields_k210")
    at = int(np.argmin(abs(done["time"].values - 0.5)))
    felt = done["strain_energy_density"].values[at, 1]
    assert part("overview", "energy")[SED].iloc[at] == pytest.approx(felt)
    assert part("overview", "pressure")[P].max() == pytest.approx(done["peak_pressure"].values[at])
    assert part("overview", "rate")[IMPULSE_RATE].max() > 0 and len(part("overview", "impulses"))
    receptors = part("overview", "section", "receptor")
    rest = 1e3 * (done["node_position"].values[:, 1].max() - done["receptor_depth"].values)
    assert (receptors[Y] < rest).all() and np.allclose(receptors[X], 0, atol=1e-6)


def test_sharper_surfaces_load_the_epidermis_more():
    most = {
        label: part("fields", label, "element").groupby("layer")[SED].max()
        for label in ("flat", "210", "1260")
    }
    assert most["flat"]["epidermis"] < most["210"]["epidermis"] < most["1260"]["epidermis"]
    assert all(energies["epidermis"] > energies["dermis"] for energies in most.values())


def test_traction_is_bounded_and_slip_reaches_the_bound():
    rows = frame("stick_slip")
    contact = rows[rows["series"] == "contact"]
    size = contact[TRACTION].abs()
    assert (size <= contact[BOUND] * (1 + 1e-6) + 1e-6).all()
    slips = contact[contact[STATE] == 2]
    assert len(slips) and np.allclose(size[slips.index], slips[BOUND], rtol=1e-6)
    sticking = rows[rows["series"] == "whole"][STICKING]
    assert sticking.between(0, 100 + 1e-9).all() and sticking.iloc[0] > sticking.iloc[-1]


def test_map_of_a_stroke_has_every_place_at_every_distance():
    rows = frame("space_time")
    grid = rows[rows["series"] == "map"].pivot(index=DISTANCE, columns=SKIN_X, values=SED)
    assert not grid.isna().any(axis=None)
    curvatures = rows.loc[rows["series"] == "convexity", "curvature (1/m)"]
    assert curvatures.round().tolist() == [52, 79, 105, 157, 210, 315]


def test_in_a_storyboard_receptors_are_dragged_along_and_met_one_after_the_other():
    rows = frame("stroke_storyboard")
    sections = rows[rows["panel"].str.startswith("section")]
    assert sections["panel"].nunique() == 5
    assert np.allclose(
        sections["stroke_distance (mm)"].unique(), [14.92, 16.42, 17.92, 19.42, 20.92]
    )
    rest, moved = (
        sections[sections["series"] == name].set_index(["panel", "offset (mm)"])[[X, Y]]
        for name in ("at rest", "receptor")
    )
    assert (moved[X] < rest[X]).all()  # the surface goes to the left
    middle = moved.index.get_level_values(1) == 0
    assert (moved[Y] < rest[Y])[middle].all()  # and presses
    met = {
        offset: rows.loc[own.loc[own["panel"] == "traces", SED].idxmax(), DISTANCE]
        for offset, own in rows[rows[DISTANCE].between(15.5, 20)].groupby("offset (mm)")
    }
    assert met[1.0] < met[0.0]
    passes = rows.groupby("offset (mm)")["passes (mm)"].max()
    assert passes[0.0] - passes[1.0] == pytest.approx(1.0)


# --- of tables -----------------------------------------------------------------------------------


def test_scorecard_counts_numbers_ranges_and_axes_apart_as_the_comparison_does():
    table = pd.read_csv(ROOT / "figures/tables/thesis_comparison.csv")
    reference = read_reference(ROOT / "config/reference/thesis_numbers.csv")
    rows = tables.scorecard_rows(table, reference)
    counted = scores(table, reference).set_index(["kind", "score"])
    title, *notes = (text.get_text() for text in tables.scorecard(rows).texts)
    note = " ".join(notes)
    for kind, names in KINDS.items():
        if kind != "trend":
            for words, score in ((title, "all"), (note.replace("\n", " "), "held out")):
                agree, judged = counted.loc[(kind, score)]
                assert f"{agree} of {judged} {names}" in words


def test_scorecard_shows_what_is_judged_right():
    """A dot lies on its bar where it agrees, give or take what a bound is helped by."""
    ids = ["T147", "T106", "T123", "T066", "T104", "TR01", "T058", "T026"]
    reference = read_reference(ROOT / "config/reference/thesis_numbers.csv")
    table = reference.loc[ids].reset_index().assign(thesis_kind="stated")
    value = {"T147": 0.52, "T106": 0.187, "T123": 34000.0, "T066": 0.2, "T104": 5.5}
    rows = tables.scorecard_rows(
        table.assign(simulated=table["id"].map(value), verdict="inside"), reference
    ).set_index("id")
    assert list(rows.index) == ["T106", "T147", "T066", "T104", "T123"]  # axes last
    right = rows["relative (1)"].between(rows["low (1)"], rows["high (1)"])
    assert right.to_dict() == dict.fromkeys(value, True) | {"T123": False}
    assert rows.loc["T147", ["low (1)", "high (1)"]].tolist() == pytest.approx([0.9, 1.1])


def test_candidates_are_ranked_by_the_median_of_recorded_sets():
    rows = tables.candidate_rows(pd.read_csv(ROOT / "figures/tables/candidate_stimuli.csv"))
    assert not rows["rates"].str.startswith("TouchSim").any()
    assert rows.groupby("rates")["candidate"].nunique().min() >= 10
    names = [t.get_text() for t in tables.candidate_stimuli(rows).axes[0].get_yticklabels()]
    medians = rows.groupby("candidate")["r_squared (1)"].median()
    assert [medians[name.replace(" × ", " x ")] for name in names] == sorted(medians, reverse=True)


# --- moving pictures -----------------------------------------------------------------------------


def test_a_press_moves_and_no_singular_point_owns_the_colours(tmp_path):
    done = history("fields_k210")
    hot = done["snapshot_strain_energy_density"].copy()
    middle = done["node_position"].values[done["element_nodes"].values].mean(1)
    hot[:, int(np.argmin(middle[:, 1]))] *= 1e6
    animate(done, tmp_path / "a.gif")
    animate(done.assign(snapshot_strain_energy_density=hot), tmp_path / "b.gif")
    with Image.open(tmp_path / "a.gif") as one, Image.open(tmp_path / "b.gif") as other:
        assert one.n_frames == done.sizes["snapshot"] <= MOST_FRAMES
        apart = np.asarray(one.convert("RGB"), int) - np.asarray(other.convert("RGB"), int)
    assert (abs(apart) < 16).mean() > 0.99  # but for the hot element itself

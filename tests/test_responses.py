"""Predicted rates of pressed surfaces: figures beside what is recorded, and the trends of chapter 4
with a mutant of each.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.claims.comparison import TRENDS
from cysyk1999.figures.chapter4_receptors import AVERAGED, PRINTED
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.errors import MESH, Companion
from cysyk1999.measures.quantities import GIVEN_RATE, IMPULSE, NODE, SED, TIME, P
from cysyk1999.measures.responses import (
    IMPULSE_RATE,
    P_LAW,
    SED_LAW,
    SED_SQUARE,
    SHALLOW_DEPTH,
    TRIALS,
    law_at,
    predicted_rate,
    rate_in,
    skin_sample,
    time_mean,
    windowed,
)
from cysyk1999.measures.runs import FAST, NINE
from cysyk1999.measures.table import Measures
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.strain_energy_meanings import (
    CHANGE,
    MEANINGS,
    fig_meanings,
    frame_meanings,
    titled,
)
from fingerpad.measures import features
from fingerpad.planning.errors import REMAINS
from fingerpad.receptors.laws import SpatialSum

pytestmark = pytest.mark.unit
CONFIG = Path(__file__).parents[1] / "config/reference"
LAW = SpatialSum(r=0.48e-3, per_depth=3.4e4, constant=9.8)


@pytest.fixture(scope="module")
def made():
    return {name: synthetic.history(name) for name in synthetic.all_scenes()}


@pytest.fixture(scope="module")
def reference():
    return read_reference(CONFIG / "thesis_numbers.csv")


@pytest.fixture(scope="module")
def rates():
    return read_rates(CONFIG / "impulse_rates")


def _frame(number, made, reference, rates=None, coarse=None):
    spec = FIGURES[number]
    return spec.frame(made, {}, coarse or {}, reference, *([rates] if spec.measured else []))


def _with(history, **values):
    return history.assign(
        {name: (history[name].dims, v, history[name].attrs) for name, v in values.items()}
    )


def _scaled(history, factor, depth=None):
    """The history with its strain energy times a factor, a number or one a time."""
    values = history["strain_energy_density"].values * np.reshape(factor, (-1, 1))
    if depth is not None:
        keep = abs(history["receptor_depth"].values - depth) > 1e-9
        values[:, keep] = history["strain_energy_density"].values[:, keep]
    return _with(history, strain_energy_density=values)


# --- figures --------------------------------------------------------------------------------------


def test_impulses_of_the_raster_are_as_many_as_the_rate_says_and_the_same_again(made, reference):
    frame, again = (_frame("4-2", made, reference) for _ in range(2))
    pd.testing.assert_frame_equal(frame, again)
    counts = frame[frame[IMPULSE].notna()].groupby(["surface", "series"]).size()
    for label, history in FAST.histories(made).items():
        rate = predicted_rate(history)
        due = time_mean(rate[TIME], rate[IMPULSE_RATE]) * np.ptp(rate[TIME])
        if due > 5:
            assert len(counts[label]) == TRIALS and counts[label].nunique() > 1
            assert counts[label].mean() == pytest.approx(due, abs=2 + 0.25 * np.sqrt(due))


def test_mean_frequency_of_many_trains_follows_the_rate(made, reference):
    frame = _frame("4-3", made, reference).query("surface == '1260'")
    rate, frequency = frame[frame["series"] == "rate"], frame[frame["series"] != "rate"]
    held = frequency[frequency[TIME] > 1]
    expected = np.interp(held[TIME], rate[TIME], rate[IMPULSE_RATE])
    values = held["predicted_frequency (impulses/s)"]
    assert values.mean() == pytest.approx(expected.mean(), rel=0.05)
    assert values.std() < 3 * 0.3 * expected.mean() / np.sqrt(AVERAGED)


@pytest.mark.parametrize(
    "number",
    [n for n in FIGURES if n in ("4-2", "4-3", "4-4", "4-5", "4-18", "4-19", "4-25", "4-29")],
)
def test_pictures_say_predicted_inside_the_axes(made, reference, rates, number):
    own = rates if FIGURES[number].measured == "impulse_rates" else None
    fig = FIGURES[number].draw(_frame(number, made, reference, own))
    words = [t.get_text() for ax in fig.axes for t in ax.texts] + [
        ax.get_ylabel() for ax in fig.axes
    ]
    words += [
        t.get_text() for ax in fig.axes if ax.get_legend() for t in ax.get_legend().get_texts()
    ]
    assert any("predicted" in text for text in words)


def test_error_is_relative_to_the_largest_rate(made, reference):
    rough = {name: _scaled(history, 1.01) for name, history in made.items()}
    coarse = {
        name: Companion(rough[name], _scaled(history, 1.02)) for name, history in made.items()
    }
    frame = _frame("4-25", made, reference, coarse=coarse).set_index("surface")
    fine, rough = (
        {k: rate_in(h, "hold") for k, h in FAST.histories(histories).items()}
        for histories in (made, rough)
    )
    for label in ("flat", "210", "1260"):
        expected = REMAINS * 100 * abs(rough[label] - fine[label]) / max(fine.values())
        assert frame.loc[label, MESH] == pytest.approx(expected, nan_ok=True)


def _recording(**other):
    entry = {
        "recording": "mine",
        "receptor": "SA-I",
        "species": "monkey",
        "stimulus": "cylinder",
        "curvature_per_m": 315.0,
        "or_curvature_per_m": np.nan,
        "force_gf": 20.0,
        "ramp_gf_per_s": 40.0,
        "speed_mm_per_s": 0.0,
        "window": "hold",
        "rate_per_s": 12.0,
        "sd_per_s": np.nan,
        "burst_width_mm": np.nan,
        "source": "a laboratory",
        "how_obtained": "measured",
        "file": "mine.csv",
    }
    return pd.DataFrame([entry | other])


@pytest.mark.parametrize(
    "number, other",
    [
        ("4-26", {}),
        ("4-27", {}),
        ("4-19", {}),
        ("4-25", {"ramp_gf_per_s": 150.0}),
        ("4-5", {"window": "peak"}),
        ("4-18", {"window": "peak"}),
        ("4-29", {"window": "peak"}),
    ],
)
def test_a_recording_of_the_users_is_laid_over_where_its_protocol_is_the_figures(
    made, reference, rates, number, other
):
    def found(**change):
        frame = _frame(number, made, reference, pd.concat([rates, _recording(**other | change)]))
        return frame, frame["source"].str.contains("mine; a laboratory")

    frame, mine = found()
    assert (frame.loc[mine, GIVEN_RATE] == 12).all() and mine.any()
    fig = FIGURES[number].draw(frame)
    labels = [
        t.get_text() for ax in fig.axes if ax.get_legend() for t in ax.get_legend().get_texts()
    ]
    drawn = [
        line
        for ax in fig.axes
        for line in ax.lines
        if line.get_marker() == "D" and 12 in line.get_ydata()
    ]
    assert drawn and (number == "4-29" or "recorded" in labels)
    for change in (
        {"receptor": "RA"},
        {"ramp_gf_per_s": 80.0},
        {"force_gf": 10.0},
        {"stimulus": "sphere"},
    ):
        assert not found(**change)[1].any()


def test_printed_rates_are_marked_as_read_from_a_scan_over_both_surfaces(made, reference, rates):
    frame = _frame("4-25", made, reference, rates)
    printed = frame[frame["source"].str.startswith("stated in the thesis")]
    assert len(printed) == len(PRINTED) and printed["source"].str.contains("uncertain").all()
    assert printed["surface_may_be (1/m)"].notna().sum() == 3
    assert not _frame("4-26", made, reference, rates)["source"].str.startswith("stated").any()


def test_published_and_other_models_rates_have_panels_of_their_own(made, reference, rates):
    frame = _frame("4-26", made, reference, rates)
    goodwin, touchsim = (
        frame[frame["source"].str.contains("Goodwin")],
        frame[frame["source"].str.startswith("other model")],
    )
    assert set(goodwin["panel"]) == {"published"} and len(goodwin) == 21
    assert set(touchsim["panel"]) == {"TouchSim"} and len(touchsim) == 9
    titles = [ax.get_title(loc="left") for ax in FIGURES["4-26"].draw(frame).axes]
    assert any("monkey, spheres; ours: cylinders" in title for title in titles)


def test_a_law_for_each_node_is_closer_than_one_for_all(made, reference):
    frame = _frame("4-17", made, reference)
    simulated = frame[frame["series"] == "simulated"].set_index([NODE, TIME])[P]
    left = {}
    for series, rows in frame[frame[P_LAW].notna()].groupby("series"):
        law = rows.set_index([NODE, TIME])[P_LAW]
        left[series] = float(((law - simulated.loc[law.index]) ** 2).sum())
    assert simulated.index.get_level_values(NODE).nunique() == 12
    assert left["Eq 4-1, a set for each"] < left["Eq 4-1, one set"]


def _obeying(history, law=LAW):
    """The history with the strain energy at 915 um that a law makes of its pressure."""
    sample = skin_sample(history, 915e-6)
    row = abs(history["receptor_depth"].values - 915e-6) < 1e-9
    values = history["strain_energy_density"].values.copy()
    values[:, row] = law.strain_energy(sample.x, sample.pressure, sample.indentation)[:, None]
    return _with(history, strain_energy_density=values)


@pytest.mark.parametrize(
    ("law", "column", "other"),
    [(LAW, SED_LAW, SED_SQUARE), (SpatialSum(0.8e-3, square=3.0), SED_SQUARE, SED_LAW)],
)
def test_the_line_of_a_law_goes_through_the_points_of_a_pad_that_obeys_it(
    made, reference, law, column, other
):
    obeying = {name: _obeying(h, law) for name, h in made.items() if name.startswith("ramp40")}
    frame = _frame("4-22", obeying, reference)
    rows = frame[features.is_simulated(frame)]
    assert rows[column].to_numpy() == pytest.approx(rows[SED].to_numpy(), rel=1e-3, abs=1e-3)
    assert abs(rows[other] - rows[SED]).max() > 5
    words = [text.get_text() for ax in FIGURES["4-22"].draw(frame).axes for text in ax.texts]
    assert sum(" 0% off" in text for text in words) == len(NINE)


def test_energies_at_600_um_are_scaled_to_the_mean_of_those_at_915_um(made):
    surfaces = NINE.histories(made)
    law, factor = law_at(made, SHALLOW_DEPTH)

    def mean(depth):
        return np.mean(
            [
                windowed(h, h["time"].values, features.energy(h, depth), "hold")
                for h in surfaces.values()
            ]
        )

    assert factor * mean(SHALLOW_DEPTH) == pytest.approx(mean(915e-6))
    assert law(1000.0, 500.0) == pytest.approx(
        0.081 * (1000 * factor - 150) + 0.0182 * max(500 * factor - 100, 0)
    )


def test_meanings_of_strain_energy_are_told_apart_by_their_change_in_the_hold(made):
    frame = frame_meanings(
        made, {name: Companion(_scaled(h, 1.01), _scaled(h, 1.01)) for name, h in made.items()}
    )
    change = frame.groupby(["panel", "series", "surface"])[CHANGE].last()
    assert (change["instantaneous elastic"] < 0).all() and (change["long-term network"] > 0).all()
    assert frame.groupby("panel")[MESH].max()["instantaneous elastic"] == pytest.approx(REMAINS)
    assert [ax.get_title(loc="left") for ax in fig_meanings(frame).axes[:5]] == [
        titled(name) for name in MEANINGS
    ]


# --- trends ---------------------------------------------------------------------------------------


def _holds(made, id_, **changed):
    return TRENDS[id_](Measures.of(made | changed)).holds


def _exchanged(made, programme):
    names = f"{programme}_k158", f"{programme}_k630"
    return {names[0]: made[names[1]], names[1]: made[names[0]]}


@pytest.mark.parametrize("id_, programme", [("TR80", "ramp150"), ("TR83", "ramp40")])
def test_rates_grow_with_curvature(made, id_, programme):
    assert _holds(made, id_) and not _holds(made, id_, **_exchanged(made, programme))


def test_silence_under_every_surface_is_no_growth(made):
    assert not _holds(
        made, "TR80", **{name: _scaled(h, 0.0) for name, h in made.items() if "ramp150" in name}
    )


def test_impulses_begin_late(made):
    history = made["ramp150_k630"]
    at_once = history["strain_energy_density"].values + 3e3 * (history["time"].values > 0)[:, None]
    assert _holds(made, "TR81")
    assert not _holds(made, "TR81", ramp150_k630=_with(history, strain_energy_density=at_once))


def test_rate_peaks_at_the_top_of_the_ramp_and_decays(made):
    history = made["ramp40_k420"]
    assert _holds(made, "TR82")
    assert not _holds(
        made,
        "TR82",
        ramp40_k420=_with(history, strain_energy_density=history["strain_energy_network"].values),
    )


def test_steady_rate_is_linear_in_the_peak_rate(made):
    history = made["ramp40_k1260"]
    falls = np.where(history["time"].values > 0.6, 0.1, 1.0)
    assert _holds(made, "TR84") and not _holds(made, "TR84", ramp40_k1260=_scaled(history, falls))


def test_rates_saturate_at_the_highest_curvature(made):
    assert not _holds(made, "TR85", ramp40_k1260=_scaled(made["ramp40_k1260"], 3.0))
    level = {k: 160 + 0.6 * v for k, v in synthetic.CURVATURE.items()} | {"1260": 160 + 0.6 * 660}
    straight = {}
    for label, history in NINE.histories(made).items():
        name = features.scene_name("ramp40", label)
        straight[name] = _scaled(history, level[label] / features.energy(history, 915e-6).max())
    assert _holds(made, "TR85", **straight)


@pytest.mark.parametrize("id_", ["TR86", "TR89"])
def test_peak_rate_is_linear_in_peak_pressure_and_energy_rate(made, id_):
    surfaces = {features.scene_name("ramp40", k): h for k, h in NINE.histories(made).items()}
    follow, stray = {}, {}
    for name, history in surfaces.items():
        peak = rate_in(history, "peak")
        pressure = history["peak_pressure"].values
        follow[name] = _with(history, peak_pressure=pressure / pressure.max() * (500 * peak + 100))
    odd, flat = follow["ramp40_k1260"], follow["ramp40_flat"]
    if id_ == "TR86":
        stray["ramp40_k1260"] = _with(odd, peak_pressure=0.05 * odd["peak_pressure"].values)
    else:
        stray["ramp40_flat"] = _with(
            flat, strain_energy_density=flat["strain_energy_density"].values + 500
        )
    assert _holds(made, id_, **follow) and not _holds(made, id_, **follow | stray)


def test_energy_from_pressure_agrees(made):
    obeying = {name: _obeying(h) for name, h in made.items() if name.startswith("ramp40")}
    assert _holds(made, "TR87", **obeying)
    astray = {name: _scaled(obeying[name], 1.5) for name in ("ramp40_k158", "ramp40_k420")}
    assert not _holds(made, "TR87", **obeying | astray)


@pytest.mark.parametrize("fall, parted", [(0.2, ""), (-0.1, "holds for flat; fails for 79")])
def test_energy_from_pressure_falls_in_the_hold(fall, parted):
    found = TRENDS["TR87a"](Measures(lambda quantity, scene: {"flat": 0.1, "79": fall}))
    assert (found.holds, found.parted) == (fall > 0, parted)


def test_sharp_surfaces_stand_out_more_at_600_um(made):
    assert _holds(made, "TR88")
    blunt = _scaled(made["ramp40_k1260"], 0.4, SHALLOW_DEPTH)
    assert not _holds(made, "TR88", ramp40_k1260=blunt)

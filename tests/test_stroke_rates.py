"""Rates predicted of strokes: figures and numbers of chapter 5 on made-up histories."""

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.claims.comparison import TRENDS
from cysyk1999.figures.axes import scaling
from cysyk1999.figures.chapter5 import PREDICTED
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.quantities import SED_LAW, TRIAL
from cysyk1999.measures.responses import (
    BURST_RATE,
    BURST_WIDTH,
    IMPULSE_RATE,
    STROKES_SHOWN,
    burst_values,
    law_at,
    predicted_rate,
    stroke_laws,
)
from cysyk1999.measures.table import Measures
from cysyk1999.receptors.recordings import RATES
from cysyk1999.reference_data import empty_reference
from fingerpad.measures import strokes as st
from fingerpad.measures.features import SURFACES, is_simulated
from test_stroke_trends import (
    LAW,
    NUMBERS,
    SHIFT,
    every,
    felt,
    lawful,
    made,
    with_changes,
    with_energy,
)

__all__ = ["lawful", "made"]  # fixtures

pytestmark = pytest.mark.unit


def _felt(made, height):
    """All strokes with bumps of strain energy."""
    return with_changes(made, every(felt(height)))


def _number(histories, id_):
    return NUMBERS[id_](Measures.of(histories))


# --- figures -------------------------------------------------------------------------------------


def _frame(made, number, *more):
    return FIGURES[number].frame(made, {}, {}, empty_reference(), *more)


@pytest.mark.parametrize("number, low, high", [("5-1", 0, 70), ("5-22", 40, 80)])
def test_raster_is_seeded_and_counts_the_integral_of_the_rate(made, number, low, high):
    felt = _felt(made, lambda k: 400)
    frame = _frame(felt, number)
    ticks = frame[frame[TRIAL].notna()]
    assert (
        set(ticks["source"]) == {PREDICTED}
        and ticks["stroke_distance (mm)"].between(low, high).all()
    )
    assert sorted(ticks[TRIAL].unique()) == list(range(1, STROKES_SHOWN[number] + 1))
    pd.testing.assert_frame_equal(frame, _frame(felt, number))
    depth = 560e-6 if number == "5-22" else 915e-6
    law, factor = law_at(felt, depth)
    assert (factor != 1) == (number == "5-22") == (f"× {factor:.3g}" in scaling(frame))
    rate = predicted_rate(st.loaded(felt["stroke_10"]), depth, law)
    inside = rate["stroke_distance (mm)"].between(low, high)
    expected = np.trapezoid(rate[IMPULSE_RATE][inside], rate["time (s)"][inside])
    assert len(ticks) / STROKES_SHOWN[number] == pytest.approx(expected, rel=0.1)


def test_recorded_bursts_of_a_user_are_laid_over(made):
    row = dict.fromkeys(RATES, "x") | {"receptor": "SA-I", "window": "burst", "recording": "mine"}
    row |= {
        "curvature_per_m": 79.0,
        "speed_mm_per_s": 10.0,
        "rate_per_s": 21.0,
        "burst_width_mm": 4.0,
    }
    rates = pd.DataFrame(
        [row, row | {"window": "hold", "speed_mm_per_s": 0.0}, row | {"receptor": "RA"}]
    )
    felt = _felt(made, lambda k: 400)
    for number, column, value in (
        ("5-2", BURST_RATE, 21),
        ("5-3", BURST_WIDTH, 4),
        ("5-16", "burst_duration (s)", 0.4),
    ):
        frame = _frame(felt, number, rates)
        assert frame.loc[frame["source"] == "measured (mine)", column].tolist() == [value]
        FIGURES[number].draw(frame)
    frame = _frame(felt, "5-17", rates)
    assert frame.loc[frame["source"] == "measured (mine)", IMPULSE_RATE].tolist() == [21]


def test_rate_of_ramp_and_hold_keeps_the_jump_at_the_top(made):
    frame = _frame(made, "5-21")
    for label in SURFACES[1:]:
        rows = frame[frame["surface"] == label]
        at_top = rows[np.isclose(rows["time (s)"], 0.5)][IMPULSE_RATE].tolist()
        assert len(at_top) == 2 and at_top[0] > at_top[1]
    assert "flat" not in set(frame["surface"])


# --- Eq 4-4 in strokes ---------------------------------------------------------------------------


def test_constants_and_shift_are_given_back_and_the_figure_shows_them(lawful):
    law, shift = stroke_laws(lawful)[SED_LAW]
    assert (law.r, law.per_depth, law.constant) == pytest.approx(
        (LAW.r, LAW.per_depth, LAW.constant), rel=1e-2
    )
    assert shift == pytest.approx(SHIFT, abs=1e-5) and _number(lawful, "T265") == pytest.approx(
        -0.4, abs=0.01
    )
    frame = _frame(lawful, "5-14")
    energy = {
        s: rows["strain_energy_density (Pa)"].dropna().to_numpy()
        for s, rows in frame[is_simulated(frame)].groupby("source")
    }
    assert energy["simulated: Eq 4-4 and a constant shift"] == pytest.approx(
        energy["simulated"], rel=0.02, abs=0.5
    )
    assert (
        abs(energy["simulated: Eq 4-4 and the shift of the skin"] - energy["simulated"]).max() > 5
    )
    assert _number(lawful, "T264") == pytest.approx(energy["simulated"].max(), rel=0.02)


# --- the plate -----------------------------------------------------------------------------------


def test_plate_answered_at_the_beginning_one_way_and_throughout_the_other():
    plates = {
        name: synthetic.plate_stroke(name) for name in ("ridged_stroke_left", "ridged_stroke_right")
    }
    d = abs(plates["ridged_stroke_right"]["stroke_distance"].values)

    def sent(left, right):
        traces = {"ridged_stroke_left": left, "ridged_stroke_right": right}
        return {name: with_energy(history, traces[name]) for name, history in plates.items()}

    def holds(left, right, rows=("TR74", "TR74a")):
        measures = Measures.of(sent(left, right))
        return all(TRENDS[row](measures).holds for row in rows)

    steady, onset = np.full(len(d), 250.0), np.where(d < 3e-3, 250.0, 100.0)
    assert holds(steady, onset) and holds(onset, steady)
    assert not holds(steady, steady)
    assert holds(steady, onset, ["TR74"]) and not holds(steady, steady, ["TR74a"])
    none = np.full(len(d), 100.0)
    assert not holds(steady, none, ["TR74"]) and holds(steady, none, ["TR74a"])
    assert not holds(onset, none, ["TR74a"])
    frame = _frame(sent(steady, onset), "5-27")
    ticks = frame[frame["panel"] == "raster"]
    assert ticks.loc[ticks["series"] == "right", "stroke_distance (mm)"].max() < 5
    assert ticks.loc[ticks["series"] == "left", "stroke_distance (mm)"].max() > 45
    FIGURES["5-27"].draw(frame)


# --- numbers -------------------------------------------------------------------------------------


def test_numbers_are_those_of_the_figures(made):
    felt = _felt(made, lambda k: 250 + float(k))
    bursts = _frame(felt, "5-3")
    assert _number(felt, "T223") == pytest.approx(bursts[BURST_WIDTH].max())
    assert _number(felt, "T224") == pytest.approx(bursts[BURST_RATE].max())
    ten = burst_values(st.loaded(felt["stroke_10"]), BURST_RATE)
    assert (_number(felt, "T221"), _number(felt, "T221a")) == pytest.approx(
        (max(ten.values()), min(ten.values()))
    )
    assert _number(felt, "T280") == pytest.approx(_frame(felt, "5-19")[IMPULSE_RATE].max())
    assert _number(felt, "T287") == pytest.approx(_frame(felt, "5-20")[IMPULSE_RATE].max())
    bars = _frame(felt, "5-23")
    fast = bars[bars["series"].isin(["20 mm/s", "40 mm/s"])]
    assert _number(felt, "T304") == pytest.approx(fast[IMPULSE_RATE].max())
    peaks = _frame(felt, "5-17")
    assert _number(felt, "T274") == pytest.approx(peaks[IMPULSE_RATE].max())
    assert _number(felt, "T219") == pytest.approx(10)
    for k, speed in enumerate(("5", "10", "20", "40")):
        widest = burst_values(st.loaded(felt[f"stroke_{speed}"]), BURST_WIDTH)
        assert _number(felt, f"T{269 + k}") == pytest.approx(
            max(widest.values()) / float(speed), rel=1e-3
        )


def test_number_of_impulses_is_that_of_the_sharpest_convexity(made):
    only = _felt(made, lambda k: 1000 * (k == "315"))
    whole = predicted_rate(st.loaded(only["stroke_40"]), 560e-6)
    expected = np.trapezoid(whole[IMPULSE_RATE], whole["time (s)"])
    assert _number(only, "T305") == pytest.approx(expected, rel=0.25) and expected > 0.5
    assert _number(_felt(made, lambda k: 0), "T305") == 0

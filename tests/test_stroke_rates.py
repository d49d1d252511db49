"""Rates predicted of strokes: figures, numbers and claims of chapter 5 on made-up histories, and a
mutant of each claim.
"""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.claims.comparison import TRENDS
from cysyk1999.claims.rows import numbers
from cysyk1999.figures.chapter5_receptors import PREDICTED
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.quantities import TRIAL
from cysyk1999.measures.responses import (
    BURST_RATE,
    BURST_WIDTH,
    IMPULSE_RATE,
    STROKES_SHOWN,
    burst_values,
    predicted_rate,
    shallow_law,
    skin_sample,
    stroke_law,
)
from cysyk1999.measures.runs import NINE, WITHIN_350
from cysyk1999.measures.table import Measures
from cysyk1999.receptors.recordings import RATES
from cysyk1999.reference_data import empty_reference, read_reference
from fingerpad.measures import strokes as st
from fingerpad.measures.features import SURFACES, is_simulated, scene_name
from fingerpad.receptors.laws import THESIS_RATE, SpatialSum

pytestmark = pytest.mark.unit
NUMBERS = numbers(read_reference(Path(__file__).parents[1] / "config/reference/thesis_numbers.csv"))
CURVATURES = ("26", "39", "52", "79", "105", "157", "210", "315")


@pytest.fixture(scope="module")
def made():
    full = {name: synthetic.stroke(name) for name in st.FULL.values()}
    return full | {
        scene_name("ramp40", k): synthetic.history(scene_name("ramp40", k)) for k in SURFACES
    }


def _with_energy(history, deep, shallow=None):
    values = np.column_stack([deep if shallow is None else shallow, deep])
    return history.assign(strain_energy_density=(history["strain_energy_density"].dims, values))


def _bumps(history, height, width=0.3, at=st.place):
    """Strain energy (Pa) with a bump over each convexity: heights by label, widths as a share of
    the chord.
    """
    d, arcs = at(history), st.convexities(history)
    middle, chord = (
        {k: f(a) for k, a in arcs.items()}
        for f in (lambda a: (a.start + a.end) / 2, lambda a: a.end - a.start)
    )
    return 20.0 + sum(
        height(k) * np.exp(-(((d - middle[k]) / (width * chord[k])) ** 2)) for k in arcs
    )


def _felt(made, height, width=0.3, at=st.place):
    """All strokes with bumps of strain energy."""
    return made | {
        name: _with_energy(made[name], _bumps(made[name], height, width, at))
        for name in st.FULL.values()
    }


def _holds(histories, id_):
    return TRENDS[id_](Measures.of(histories))


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
    nine = {label: felt[scene] for label, scene in NINE.scenes.items()}
    depth, law = (
        (560e-6, shallow_law(nine, 560e-6)[0]) if number == "5-22" else (915e-6, THESIS_RATE)
    )
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

LAW, SHIFT = SpatialSum(r=0.5e-3, per_depth=3e4, constant=9.0), -0.4e-3


@pytest.fixture(scope="module")
def lawful(made):
    """Histories whose strain energy is Eq 4-4, shifted by 0.4 mm when stroked."""
    out = {}
    for name, history in made.items():
        sample = skin_sample(history, 915e-6)
        energy = LAW.strain_energy(
            sample.x, sample.pressure, sample.indentation, SHIFT if "stroke" in name else 0.0
        )
        values = np.repeat(energy[:, None], history.sizes["receptor"], axis=1)
        out[name] = history.assign(
            strain_energy_density=(history["strain_energy_density"].dims, values)
        )
    return out


def test_constants_and_shift_are_given_back_and_the_figure_shows_them(lawful):
    law, shift = stroke_law(lawful)
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


def test_agreement_and_deviation_over_velocity(lawful):
    assert _holds(lawful, "TR60").holds
    assert _holds(lawful | {"stroke_40": _scaled(lawful["stroke_40"], 1.5)}, "TR60").shown == 4
    assert not _holds(lawful | {"stroke_40": _scaled(lawful["stroke_40"], 1.5)}, "TR60").holds
    # constants and shift come from the ramps and the stroke at 10 mm/s, whose scale does not move
    # its shift
    growing = {name: _scaled(lawful[name], 1 + 0.05 * k) for k, name in enumerate(st.FULL.values())}
    assert _holds(lawful | growing, "TR61").holds
    assert not _holds(lawful | growing | {"stroke_20": lawful["stroke_20"]}, "TR61").holds


def _scaled(history, factor):
    return history.assign(strain_energy_density=history["strain_energy_density"] * factor)


# --- claims: each holds in what is made for it, and fails in a mutant ----------------------------


def test_impulses_under_concavities_are_noticed(made):
    assert _holds(_felt(made, lambda k: 300, 0.2, st.distance), "TR62").holds
    everywhere = _felt(made, lambda k: 300, 0.2, st.distance)
    level = _with_energy(
        everywhere["stroke_10"], np.full(everywhere["stroke_10"].sizes["time"], 300.0)
    )
    assert not _holds(everywhere | {"stroke_10": level}, "TR62").holds


def test_burst_rate_and_width_over_curvature(made):
    rising = _felt(made, lambda k: 250 + float(k))
    assert _holds(rising, "TR63").holds and _holds(rising, "TR64").holds
    turned = rising | {
        "stroke_10": _felt(made, lambda k: 250 + (k != "315") * float(k))["stroke_10"]
    }
    assert not _holds(turned, "TR63").holds
    high = _felt(made, lambda k: 140 if k == "26" else 400)
    assert not _holds(high, "TR64").holds  # the first bump is hardly above the threshold


def test_burst_rate_grows_with_velocity_and_width_does_not(made):
    alike = _felt(made, lambda k: 300)
    assert _holds(alike, "TR65").holds and _holds(alike, "TR66").holds
    assert not _holds(alike | {"stroke_40": _felt(made, lambda k: 140)["stroke_40"]}, "TR65").holds
    outcome = _holds(alike | {"stroke_40": _felt(made, lambda k: 300, 0.5)["stroke_40"]}, "TR66")
    assert not outcome.holds and outcome.shown == 0


def test_stroked_rates_against_pressed_ones(made):
    peaks = [NUMBERS[f"T{289 + k}"](Measures.of(made)) for k in range(8)]
    assert (np.diff(peaks) > 0).all() and _number(made, "T274") >= peaks[
        WITHIN_350.index("315") - 1
    ]
    low, high = _felt(made, lambda k: 131), _felt(made, lambda k: 1500)
    assert _holds(high, "TR68").holds and not _holds(low, "TR68").holds
    between = next(
        h for h in range(120, 1500, 10) if _holds(_felt(made, lambda k, h=h: h), "TR67").holds
    )
    assert between and not _holds(high, "TR67").holds


def test_energy_rate_proportional_to_velocity(made):
    alike = _felt(made, lambda k: 300)
    assert _holds(alike, "TR69").holds
    assert not _holds(alike | {"stroke_40": _felt(made, lambda k: 120)["stroke_40"]}, "TR69").holds


def test_rate_peaks_with_the_energy_rate_and_comes_mostly_from_it(made):
    sharp = _felt(made, lambda k: 135)
    assert _holds(sharp, "TR70").holds and _holds(sharp, "TR71").holds
    slow = sharp | {
        "stroke_10": _felt(made, lambda k: 1000)["stroke_1"]
    }  # so slow a stroke is answered for its energy
    assert not _holds(slow, "TR71").holds
    late = _with_energy(
        made["stroke_10"], _bumps(made["stroke_10"], lambda k: 1500, 0.45)
    )  # far above the threshold
    assert not _holds(sharp | {"stroke_10": late}, "TR70").holds


def _twin(history, apart):
    """Energy with two bumps over each convexity at both depths."""
    d, values = st.place(history), 0.0
    for arc in st.convexities(history).values():
        chord, middle = arc.end - arc.start, (arc.start + arc.end) / 2
        for side in (-0.5, 0.5):
            values = values + 400 * np.exp(
                -(((d - middle - side * apart(chord)) / (0.15 * chord)) ** 2)
            )
    return _with_energy(history, values)


def test_two_peaks_of_the_rate_and_their_distance(made):
    twins = made | {name: _twin(made[name], lambda chord: 0.8 * chord) for name in st.FULL.values()}
    assert all(_holds(twins, id_).holds for id_ in ("T301", "TR72", "TR73"))
    arc = st.convexities(made["stroke_10"])["52"]
    assert Measures.of(twins)("rate_peaks_apart", "stroke_10", "52") == pytest.approx(
        0.8e3 * (arc.end - arc.start), abs=0.5
    )
    single = _with_energy(made["stroke_10"], _bumps(made["stroke_10"], lambda k: 400))
    assert not any(_holds(twins | {"stroke_10": single}, id_).holds for id_ in ("T301", "TR72"))
    wider = _twin(made["stroke_5"], lambda chord: 3e-3 * 6e-3 / chord)
    assert not _holds(twins | {"stroke_5": wider}, "TR73").holds


def test_plate_answered_at_the_beginning_one_way_and_throughout_the_other():
    plates = {
        name: synthetic.plate_stroke(name) for name in ("ridged_stroke_left", "ridged_stroke_right")
    }
    d = abs(plates["ridged_stroke_right"]["stroke_distance"].values)

    def felt(left, right):
        levels = {"ridged_stroke_left": left, "ridged_stroke_right": right}
        return {k: _scaled_to(h, levels[k]) for k, h in plates.items()}

    def _scaled_to(history, trace):
        values = np.repeat(trace[:, None], history.sizes["receptor"], axis=1)
        return history.assign(strain_energy_density=(("time", "receptor"), values))

    steady, onset = np.full(len(d), 250.0), np.where(d < 3e-3, 250.0, 100.0)
    assert _holds(felt(steady, onset), "TR74").holds and _holds(felt(onset, steady), "TR74").holds
    assert not _holds(felt(steady, steady), "TR74").holds
    assert not _holds(felt(steady, np.full(len(d), 100.0)), "TR74").holds  # no response at all
    frame = _frame(felt(steady, onset), "5-27")
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
    frequency = _frame(felt, "5-23")
    fast = frequency[frequency["panel"].isin(["20 mm/s", "40 mm/s"])]
    assert _number(felt, "T304") == pytest.approx(fast["predicted_frequency (impulses/s)"].max())
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
    assert _number(only, "T305") == pytest.approx(expected, rel=0.15) and expected > 0.5
    assert _number(_felt(made, lambda k: 0), "T305") == 0

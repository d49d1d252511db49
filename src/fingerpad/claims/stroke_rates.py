"""Numbers and claims of the thesis's chapter 5 on impulse rates, read from what Eqs 4-4 and 5-1 predict of strokes.

The thesis reads most of them from recordings; here they are of predictions with its constants, as figures 5-1 to 5-23 show them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fingerpad.claims.stroke_trends import ALIKE, HARDLY, PROMINENCE, listed, spreads
from fingerpad.claims.verdicts import Trend, everywhere
from fingerpad.measures.features import scene_of
from fingerpad.measures.quantities import DISTANCE, RATE, SED, TIME
from fingerpad.measures.responses import (
    BIN,
    BURST_RATE,
    BURST_TIME,
    BURST_WIDTH,
    DYNAMIC,
    FREQUENCY,
    IMPULSE_RATE,
    RECEPTOR_DEPTH,
    STROKES_SHOWN,
    burst_values,
    impulses_of,
    mean_frequency,
    plate_rate,
    predicted_rate,
    ramp_and_hold_rates,
    skin_sample,
    stroke_histogram,
)
from fingerpad.measures.runs import CYLINDERS, RIDGED, WITHIN_350
from fingerpad.measures.strokes import FULL, arcs, convexities, distance, loaded, passing, place
from fingerpad.receptors.fits import r_squared, rms
from fingerpad.receptors.laws import THESIS_RATE
from fingerpad.receptors.spikes import integrated

if TYPE_CHECKING:
    from fingerpad.claims.numbers import Results

Number = Callable[["Results"], float]
SHALLOW_DEPTH = 560e-6  # m, of Figs 5-22 to 5-24
NONE_LEFT = 0.5
"""Mean number of impulses below which a stroke has, as a rule, none."""

PROPORTIONAL = 0.1
"""Largest departure from 1 of the exponent of a quantity that is proportional to another."""


def _stroke(results: Results, speed: str) -> xr.Dataset:
    return loaded(results.histories[FULL[speed]])


# --- numbers -------------------------------------------------------------------------------------------


def _bursts(column: str, speeds: Iterable[str], of: Callable[[list[float]], float]) -> Number:
    """A number of the bursts of all convexities at some velocities."""
    return lambda r: of([v for speed in speeds for v in burst_values(_stroke(r, speed), column).values()])


def _largest(column: str) -> Number:
    """Largest value of a column of the predicted rate at 10 mm/s."""
    return lambda r: float(predicted_rate(_stroke(r, "10"))[column].max())


def _pressed_peak(label: str) -> Number:
    return lambda r: ramp_and_hold_rates(r(label))["peak"]


def _highest_of_three(results: Results) -> float:
    pressed = [ramp_and_hold_rates(results(label))["peak"] for label in WITHIN_350]
    return max(*pressed, *burst_values(_stroke(results, "10"), BURST_RATE).values())


def _highest_bin(results: Results) -> float:
    count = STROKES_SHOWN["5-19"]
    return float(stroke_histogram(*impulses_of(results.histories[FULL["10"]], count), count)[IMPULSE_RATE].max())


def _highest_frequency(speeds: Iterable[str]) -> Number:
    """Largest mean frequency at 560 um from 40 mm on, as Fig 5-23 shows it."""

    def number(results: Results) -> float:
        found, count = [], STROKES_SHOWN["5-23"]
        for speed in speeds:
            rate, impulses = impulses_of(results.histories[FULL[speed]], count, SHALLOW_DEPTH)
            at = np.interp(np.arange(40, 80.01, 0.1), rate[DISTANCE], rate[TIME])
            found.append(float(mean_frequency(impulses, count, at)[FREQUENCY].max()))
        return max(found)

    return number


def _mean_number(stroke: xr.Dataset, where: np.ndarray, column: str = IMPULSE_RATE, depth: float = RECEPTOR_DEPTH) -> float:
    """Mean number of impulses while a condition (time) holds at both ends of a step."""
    frame = predicted_rate(stroke, depth)
    steps = np.diff(integrated(frame[TIME], frame[column]))
    return float(steps[where[1:] & where[:-1]].sum())


def _impulses_of_sharpest(results: Results) -> float:
    stroke = _stroke(results, "40")
    return _mean_number(stroke, passing(stroke, convexities(stroke)["315"]), depth=SHALLOW_DEPTH)


def _highest_by_pressure(results: Results) -> float:
    law, shift = results.stroke_law
    samples = [skin_sample(_stroke(results, speed), RECEPTOR_DEPTH) for speed in FULL]
    return max(float(law.strain_energy(s.x, s.pressure, s.indentation, shift).max()) for s in samples)


def _speed(results: Results) -> float:
    return 1e3 * next(leg["speed"] for leg in scene_of(results.histories[FULL["10"]])["motion"] if "slide" in leg)


RATE_GIVEN: dict[str, Number] = {
    "T219": _speed,
    "T268": lambda r: THESIS_RATE.threshold,
    "T283": lambda r: THESIS_RATE.per_energy,
    "T284": lambda r: THESIS_RATE.per_rate,
    "T285": lambda r: THESIS_RATE.threshold,
    "T286": lambda r: THESIS_RATE.rate_threshold,
}
"""What goes into the predictions. It has no discretisation error."""

STROKE_RATE_NUMBERS: dict[str, Number] = {
    **RATE_GIVEN,
    "T220": _bursts(BURST_WIDTH, ("10",), max),
    "T221": _bursts(BURST_RATE, ("10",), max),
    "T221a": _bursts(BURST_RATE, ("10",), min),
    "T223": _bursts(BURST_WIDTH, FULL, max),
    "T224": _bursts(BURST_RATE, FULL, max),
    "T264": _highest_by_pressure,
    "T265": lambda r: 1e3 * r.stroke_law[1],
    **{f"T{269 + k}": _bursts(BURST_TIME, (speed,), max) for k, speed in enumerate(("5", "10", "20", "40"))},
    "T274": _highest_of_three,
    "T278": _largest(SED),
    "T279": _largest(RATE),
    "T280": _highest_bin,
    "T287": _largest(IMPULSE_RATE),
    "T304": _highest_frequency(("20", "40")),
    "T304a": _highest_frequency(("1", "5", "10")),
    "T305": _impulses_of_sharpest,
}
"""Numbers that strokes, and for some pressed surfaces too, are needed for."""

RATE_NUMBERS: dict[str, Number] = {
    **STROKE_RATE_NUMBERS,
    **{f"T{289 + k}": _pressed_peak(label) for k, label in enumerate(CYLINDERS)},
}
"""Every number of predicted rates that has a row, by id."""


# --- trends --------------------------------------------------------------------------------------------


def _deviations(results: Results) -> dict[str, tuple[float, float]]:
    """Residual of Eq 4-4 over the strain energy, and the share of variance it explains, by velocity."""
    law, shift = results.stroke_law
    found = {}
    for speed, scene in FULL.items():
        s = skin_sample(results.histories[scene], RECEPTOR_DEPTH)
        by_law = law.strain_energy(s.x, s.pressure, s.indentation, shift)
        found[f"{speed} mm/s"] = rms(by_law - s.energy) / rms(s.energy), r_squared(s.energy, by_law)
    return found


def _agrees(results: Results) -> Trend:
    found = _deviations(results)
    note = "residual over the energy " + listed({k: 100 * v for k, (v, _) in found.items()}, "%")
    note += "; R2 " + listed({k: v for k, (_, v) in found.items()}, "", 2).strip()
    return everywhere({k: v <= ALIKE for k, (v, _) in found.items()}, note)


def _deviation_grows(results: Results) -> Trend:
    return _grows({k: 100 * v for k, (v, _) in _deviations(results).items()}, "%")


def _grows(values: dict[str, float], unit: str, sign: int = 1) -> Trend:
    """Whether each value is larger (sign 1) or smaller (-1) than the one before."""
    outcome = [True, *(sign * (b - a) > 0 for a, b in pairwise(values.values()))]
    return everywhere(dict(zip(values, outcome, strict=True)), listed(values, unit))


def _under_convexities_only(results: Results) -> Trend:
    stroke = _stroke(results, "10")
    labels, hollows = list(convexities(stroke)), [arc for arc in arcs(stroke) if arc.curvature < 0]
    found, dragged = (
        {
            f"{before} to {after}": _mean_number(stroke, (under >= arc.start) & (under <= arc.end))
            for before, after, arc in zip(labels, labels[1:], hollows, strict=False)
        }
        for under in (distance(stroke), place(stroke))
    )
    note = "mean number of impulses at the distances of a concavity " + listed(found, "", 2).strip()
    note += f"; under the centre of the skin, which is dragged back, up to {max(dragged.values()):.2g}"
    return everywhere({k: v < NONE_LEFT for k, v in found.items()}, note)


def _rate_grows(results: Results) -> Trend:
    stroke = _stroke(results, "10")
    trend = _grows(burst_values(stroke, BURST_RATE), "impulses/s")
    highest = burst_values(stroke, f"largest {IMPULSE_RATE}")
    return Trend(trend.holds, trend.shown, f"{trend.note}; largest rates " + listed(highest, "impulses/s"))


def _rate_grows_with_velocity(results: Results) -> Trend:
    found = [burst_values(_stroke(results, speed), BURST_RATE) for speed in FULL]
    outcome = {k: all(b[k] > a[k] for a, b in pairwise(found)) for k in found[0]}
    return everywhere(
        outcome, "from 1 to 40 mm/s " + ", ".join(f"{k}: {found[0][k]:.3g} to {v:.3g}" for k, v in found[-1].items())
    )


def _width_hardly_varies(results: Results) -> Trend:
    spread = spreads([burst_values(_stroke(results, speed), BURST_WIDTH) for speed in FULL])
    return everywhere({k: v <= HARDLY for k, v in spread.items()}, "spread over velocities " + listed(spread, "%", 2))


def _between(results: Results) -> Trend:
    rate = burst_values(_stroke(results, "10"), BURST_RATE)["79"]
    pressed = ramp_and_hold_rates(results("79"))
    low, high = pressed["end of the hold"], pressed["peak"]
    return Trend(low < rate < high, rate, f"K = 79 1/m: steady state {low:.3g}, stroked {rate:.3g}, peak {high:.3g} impulses/s")


def _above_the_peak(results: Results) -> Trend:
    rate, peak = (
        burst_values(_stroke(results, "10"), BURST_RATE),
        {k: ramp_and_hold_rates(results(k))["peak"] for k in WITHIN_350},
    )
    pairs = {k: rate["157" if k == "158" else k] / peak[k] for k in WITHIN_350 if k != "flat"}
    return Trend(pairs["315"] > 1, pairs["315"], "stroked over peak pressed " + listed(pairs, "", 2).strip())


def _proportional(results: Results) -> Trend:
    found = [burst_values(_stroke(results, speed), f"largest {RATE}") for speed in FULL]
    velocity = np.log([float(speed) for speed in FULL])
    exponents = {k: float(np.polyfit(velocity, np.log([f[k] for f in found]), 1)[0]) for k in found[0]}
    return everywhere({k: abs(v - 1) <= PROPORTIONAL for k, v in exponents.items()}, "exponents " + listed(exponents, "").strip())


def _peaks_together(results: Results) -> Trend:
    stroke = _stroke(results, "10")
    frame, apart = predicted_rate(stroke), {}
    for label, arc in convexities(stroke).items():
        part = frame[passing(stroke, arc)]
        first, second = (part[DISTANCE].loc[part[column].idxmax()] for column in (RATE, IMPULSE_RATE))
        apart[label] = second - first
    return everywhere({k: abs(v) <= 1e3 * BIN + 1e-9 for k, v in apart.items()}, "apart " + listed(apart, "mm", 2))


def _mostly_rate(results: Results) -> Trend:
    stroke, found = _stroke(results, "10"), {}
    for label, arc in convexities(stroke).items():
        where = passing(stroke, arc)
        found[label] = 100 * _mean_number(stroke, where, DYNAMIC) / max(_mean_number(stroke, where), 1e-12)
    note = "share of the impulses that comes from the rate " + listed(found, "%", 2)
    return everywhere({k: found[k] > 50 for k in ("210", "315")}, note)


def rate_peaks_apart(stroke: xr.Dataset, label: str) -> float:
    """Distance (m) between the two most prominent peaks of the rate at 560 um while a convexity passes; NaN with fewer."""
    from scipy.signal import find_peaks  # here, for it is slow to import

    inside = passing(stroke, convexities(stroke)[label])
    values, d = predicted_rate(stroke, SHALLOW_DEPTH)[IMPULSE_RATE].to_numpy()[inside], distance(stroke)[inside]
    found, properties = find_peaks(values, prominence=max(PROMINENCE * values.max(), 1e-9))
    if len(found) < 2:
        return float("nan")
    first, second = sorted(found[np.argsort(properties["prominences"])[-2:]])
    return float(d[second] - d[first])


def _two_peaks(speeds: Iterable[str]) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        apart = {f"{k} at {v} mm/s": 1e3 * rate_peaks_apart(_stroke(results, v), k) for v in speeds for k in ("52", "79")}
        return everywhere(
            {k: v > 0 for k, v in apart.items()}, "apart " + listed({k: v for k, v in apart.items() if v > 0}, "mm", 2)
        )

    return check


def _closer(results: Results) -> Trend:
    outcome, notes = {}, []
    for speed in FULL:
        apart = [rate_peaks_apart(_stroke(results, speed), k) for k in ("52", "79", "105")]
        seen = [v for v in apart if v > 0]
        outcome[f"{speed} mm/s"] = len(seen) >= 2 and bool((np.diff(seen) < 0).all())
        notes.append(f"{speed} mm/s: " + ", ".join(f"{1e3 * v:.1f}" for v in seen))
    return everywhere(outcome, "mm apart from K = 52 on, " + "; ".join(notes))


BEGINNING = 5.0
"""Stroke distance (mm) that is the beginning of a plate's stroke."""


def _one_way(results: Results) -> Trend:
    """One way mostly at the beginning, the other throughout; a receptor beside the centre of a pad with inner ridges."""
    found = {}
    for way, name in RIDGED.scenes.items():
        rate = plate_rate(results.histories[name])
        grown = integrated(rate[TIME], rate[IMPULSE_RATE])
        found[way] = float(grown[-1]), float(np.interp(BEGINNING, rate[DISTANCE], grown))
    (few, early), (many, first) = sorted(found.values())
    holds = few >= NONE_LEFT and early > few / 2 and many > 2 * few and first < many / 2
    note = "; ".join(f"to the {way}: {n:.2g} impulses, {b:.2g} of them in the first 5 mm" for way, (n, b) in found.items())
    return Trend(holds, many / max(few, 1e-9), f"{note}; mean numbers of a stroke, receptor 46 um to the right")


RATE_TRENDS: dict[str, Callable[[Results], Trend]] = {
    "T301": _two_peaks(("10",)),
    "TR60": _agrees,
    "TR61": _deviation_grows,
    "TR62": _under_convexities_only,
    "TR63": _rate_grows,
    "TR64": lambda r: _grows(burst_values(_stroke(r, "10"), BURST_WIDTH), "mm", -1),
    "TR65": _rate_grows_with_velocity,
    "TR66": _width_hardly_varies,
    "TR67": _between,
    "TR68": _above_the_peak,
    "TR69": _proportional,
    "TR70": _peaks_together,
    "TR71": _mostly_rate,
    "TR72": _two_peaks(FULL),
    "TR73": _closer,
    "TR74": _one_way,
}
"""Every trend of predicted rates that has a row, by id."""

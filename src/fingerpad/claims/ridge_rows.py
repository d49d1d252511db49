"""Numbers and trends of the thesis's section 5.5, read from pressed and stroked pads with ridges: one function an id."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fingerpad.claims.verdicts import Trend, everywhere
from fingerpad.measures.direction import BESIDE, DEPTH, OFFSETS, UNDER_TIP, directional_index, islands
from fingerpad.measures.features import SURFACES, energy, force_gf, ramp_end, receptor_index, scene_name
from fingerpad.measures.runs import PLAIN, RIDGED
from fingerpad.measures.strokes import distance, loaded, time_of

if TYPE_CHECKING:
    from fingerpad.claims.numbers import Results

Number = Callable[["Results"], float]
OUTER = {"right": "ridged_outer_stroke_right", "left": "ridged_outer_stroke_left"}
ALIKE = 0.99
"""Least correlation of traces over time that rise and fall alike."""
FELT = 1 / 3
"""Least directional index of a receptor that feels direction: twice the energy one way."""
UNFELT = 0.05
"""Largest directional index of a receptor that does not."""
THRESHOLD = 150.0
"""Strain energy density (Pa) above which receptors respond, the thesis's Eq 5-1."""
SETTLED = 2e-3
"""Stroke (m) after which a stroke's start is over."""


def _stroke(results: Results, name: str) -> xr.Dataset:
    return loaded(results.histories[name])


def _speed(name: str) -> Number:
    """Mean stroking velocity, mm/s."""

    def number(results: Results) -> float:
        stroke = _stroke(results, name)
        return round(1e3 * float(abs(distance(stroke)[-1]) / time_of(stroke)[-1]), 9)

    return number


def _receptors(name: str) -> Number:
    """How many of the three receptors there are."""

    def number(results: Results) -> float:
        history = results.histories[name]
        return sum(receptor_index(history, DEPTH, x) >= 0 for x in OFFSETS.values())

    return number


def _highest(name: str) -> Number:
    """Largest strain energy (Pa) of the three receptors during a stroke."""
    return lambda r: max(float(energy(_stroke(r, name), DEPTH, x).max()) for x in OFFSETS.values())


def _ridged(results: Results, label: str) -> xr.Dataset:
    return results.histories[scene_name("ridged_40", label)]


RIDGE_GIVEN: dict[str, Number] = {
    "T313": _speed(RIDGED["right"]),
    "T314": lambda r: float(force_gf(_stroke(r, RIDGED["right"])).mean()),
    "T316": _receptors(PLAIN["right"]),
    "T320": _receptors(RIDGED["right"]),
}
"""What goes into the strokes."""

RIDGE_NUMBERS: dict[str, Number] = {
    **RIDGE_GIVEN,
    "T311": lambda r: max(float(energy(_ridged(r, k), DEPTH).max()) for k in SURFACES),
    "T317": _highest(PLAIN["right"]),
    "T319": _highest(RIDGED["right"]),
}
"""Every number of section 5.5 that has a row, by id."""


# --- indentation -----------------------------------------------------------------------------------------------


def _same_rise_and_fall(results: Results) -> Trend:
    """Correlation over time with the plain pad's trace, at the centre and beside it."""
    found = {}
    for label in SURFACES:
        plain, ridged = results(label), _ridged(results, label)
        for place, x in (("centre", 0.0), ("46 um", BESIDE)):
            values = np.interp(plain["time"].values, ridged["time"].values, energy(ridged, DEPTH, x))
            found[f"{label} at {place}"] = float(np.corrcoef(values, energy(plain, DEPTH))[0, 1])
    worst = min(found, key=found.get)
    outcome = {k: min(found[f"{k} at centre"], found[f"{k} at 46 um"]) >= ALIKE for k in SURFACES}
    return everywhere(outcome, f"correlation over time with the plain pad at least {found[worst]:.4f} ({worst})")


def _same_order(results: Results) -> Trend:
    """Whether the energy at the ramp's end grows with every curvature, at both places."""
    outcome, notes = {}, []
    for place, x in (("centre", 0.0), ("46 um", BESIDE)):
        values = [float(energy(_ridged(results, k), DEPTH, x)[ramp_end(_ridged(results, k))]) for k in SURFACES]
        outcome |= {f"{k} at {place}": bool(b > a) for k, a, b in zip(SURFACES[1:], values, values[1:], strict=False)}
        notes.append(f"{place} {values[0]:.0f} (flat) to {values[-1]:.0f} Pa (1260)")
    return everywhere(outcome, ", ".join(notes))


def _separation(history: Callable[[str], xr.Dataset], x: float) -> float:
    """Largest energy under the sharpest surface over that under the next."""
    high, low = (float(energy(history(k), DEPTH, x).max()) for k in ("1260", "630"))
    return high / low


def _stands_out(results: Results) -> Trend:
    plain = _separation(results, 0.0)
    centre, beside = (_separation(lambda k: _ridged(results, k), x) for x in (0.0, BESIDE))
    note = f"1260 over 630 1/m: {plain:.3f} without ridges, with ridges {centre:.3f} at the centre, {beside:.3f} at 46 um"
    return Trend(min(centre, beside) > plain, centre / plain, note)


def _magnitudes(results: Results) -> Trend:
    outcome, ratios = {}, {"centre": [], "46 um": []}
    for label in SURFACES:
        plain = float(energy(results(label), DEPTH).max())
        for (place, found), x in zip(ratios.items(), (0.0, BESIDE), strict=True):
            found.append(float(energy(_ridged(results, label), DEPTH, x).max()) / plain)
            outcome[f"{label} at {place}"] = abs(found[-1] - 1) > 0.1
    note = ", ".join(f"{min(v):.2f} to {max(v):.2f} at {k}" for k, v in ratios.items())
    return everywhere(outcome, f"largest energy over the plain pad's {note}; the centre lies in the epidermis of the ridge's tip")


# --- stroking --------------------------------------------------------------------------------------------------


def _index_at(results: Results, strokes: dict[str, str]) -> float:
    return directional_index(results.histories[strokes["right"]], DEPTH, -BESIDE)


def _unfelt(results: Results) -> Trend:
    index = _index_at(results, PLAIN.scenes)
    stroke = _stroke(results, PLAIN["right"])
    late = abs(distance(stroke)) >= SETTLED
    values = [energy(stroke, DEPTH, x)[late] for x in OFFSETS.values()]
    spread = 100 * float(np.max(np.ptp(values, axis=0) / np.mean(values, axis=0)))
    return Trend(
        abs(index) <= UNFELT, index, f"directional index at -46 um; the three receptors differ by {spread:.1f} % at most"
    )


def _differ(results: Results) -> Trend:
    """Spread of the three receptors over their mean, largest over smallest, and at equal material."""
    stroke = _stroke(results, RIDGED["right"])
    values = {k: float(energy(stroke, DEPTH, x)[-1]) for k, x in OFFSETS.items()}
    tip = float(energy(stroke, UNDER_TIP)[-1])
    ratio = max(values.values()) / min(values.values())
    note = ", ".join(f"{v:.0f} Pa at {k.replace('−', '-').replace('µ', 'u')}" for k, v in values.items())
    note += f" at the end; the centre lies in the epidermis of the tip, 20 um deeper, in the dermis, it is {tip:.0f} Pa"
    beside = values["x = −46 µm"] / values["x = 46 µm"]
    return Trend(beside >= 2, ratio, f"{note}; of the two in the dermis one has {beside:.1f} times the other's")


def _felt(strokes: dict[str, str]) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        index = _index_at(results, strokes)
        right = _stroke(results, strokes["right"])
        try:
            left = _stroke(results, strokes["left"])
            ways = [float(energy(s, DEPTH, -BESIDE)[-1]) for s in (right, left)]
            note = f"at -46 um {ways[0]:.0f} Pa at the end of the stroke to the right, {ways[1]:.0f} Pa to the left"
        except KeyError:
            note = "stroke to the left by mirror image"
        return Trend(abs(index) >= FELT, index, f"directional index; {note}")

    return check


def _one_way_only(results: Results) -> Trend:
    """Whether a receptor at -46 um responds throughout one way and only at the start the other way."""
    start, late = {}, {}
    for way, name in RIDGED.scenes.items():
        stroke = _stroke(results, name)
        settled = abs(distance(stroke)) >= SETTLED
        values = energy(stroke, DEPTH, -BESIDE)
        start[way], late[way] = float(values[~settled].max()), values[settled]
    through, ceases = late["right"].min() > THRESHOLD, start["left"] > THRESHOLD and late["left"].max() < THRESHOLD
    note = (
        f"at -46 um to the right {late['right'].min():.0f} Pa at least after 2 mm; to the left {start['left']:.0f} Pa at "
        f"the start, {late['left'].max():.0f} Pa at most after 2 mm; threshold {THRESHOLD:.0f} Pa (Eq 5-1)"
    )
    return Trend(bool(through and ceases), float(through) + float(ceases), note)


def _islands(results: Results) -> Trend:
    """Islands of contact under outer ridges, steps cut and how far the skin is compressed."""
    counts, cuts, volume = [], 0, []
    for name in OUTER.values():
        history = results.histories[name]
        late = abs(history["stroke_distance"].values) >= SETTLED
        counts.append(islands(history)[late])
        cuts += int(history["cutbacks"].sum())
        volume.append(float(history["min_detF"].min()))
    found = np.concatenate(counts)
    plain = int(islands(results.histories[RIDGED["right"]])[-1])
    note = (
        f"{found.min()} to {found.max()} islands in the strokes ({plain} without outer ridges), "
        f"{cuts} steps cut, smallest det F {min(volume):.3f}"
    )
    return Trend(bool(found.min() > plain and cuts == 0), float(np.median(found)), note)


RIDGE_TRENDS: dict[str, Callable[[Results], Trend]] = {
    "T321": _felt(RIDGED.scenes),
    "TR43": _same_rise_and_fall,
    "TR44": _same_order,
    "TR45": _stands_out,
    "TR46": _magnitudes,
    "TR47": _unfelt,
    "TR48": _differ,
    "TR49": _one_way_only,
    "TR50": _felt(OUTER),
    "TR51": _islands,
}
"""Every trend of section 5.5 that has a row, by id."""

"""Trends that the thesis states of stroked pads: its chapter 5."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from cysyk1999.claims.trends import (
    ALIKE,
    FOLLOWS,
    HARDLY,
    NEGLIGIBLE,
    Trend,
    everywhere,
    listed,
    of_each,
    spreads,
    stepwise,
    trend,
)
from cysyk1999.claims.verdicts import digits
from cysyk1999.measures.responses import STROKES, STROKES_SHOWN
from cysyk1999.measures.runs import NINE, PLAIN, RIDGED, SPEEDS, SUB_SPEEDS, WITHIN_350, WITHIN_400
from fingerpad.measures.bursts import BIN
from fingerpad.measures.strokes import FULL, STEPPED, SUB

TEN = FULL["10"]
NONE_LEFT = 0.5
"""Mean number of impulses below which a stroke has, as a rule, none."""
PROPORTIONAL = 0.1
"""Largest departure from 1 of the exponent of a quantity that is proportional to another."""
FELT, UNFELT = 1 / 3, 0.05
"""Least directional index of a receptor that feels direction (twice the energy one way), largest of
one that does not.
"""
OUTER = {"right": "ridged_outer_stroke_right", "left": "ridged_outer_stroke_left"}


def by_speed(m, quantity, speeds=tuple(SPEEDS)):
    """A measure of each convexity in the strokes at several velocities: velocity -> convexity ->
    value.
    """
    return {speed: m.find(quantity, SPEEDS[speed]) for speed in speeds}


# --- pressure and curvature -----------------------------------------------------------------------


@trend("TR24", scene=STEPPED)
@trend("TR26", scene=TEN)
def pressure_follows_curvature(m, scene):
    likeness, slope = m("curvature_correlation", scene, "centre"), m("curvature_factor", scene)
    offset, misfit = (m("curvature_fit", scene, k) for k in ("offset", "misfit"))
    note = (
        f"pressure = {slope:.1f} Pa m x curvature + {offset:.0f} Pa; root mean square misfit "
        f"{misfit:.0f} Pa"
    )
    return Trend(likeness >= FOLLOWS, likeness, f"correlation {likeness:.3f}, {note}")


@trend("TR25")
def pressure_follows_curvature_at_nodes(m):
    found = {k: v for k, v in m.find("curvature_correlation", SUB["10"]).items() if k != "centre"}
    note = f"correlations {min(found.values()):.3f} to {max(found.values()):.3f}"
    return everywhere({k: v >= FOLLOWS for k, v in found.items()}, note)


@trend("TR27")
def skin_has_the_curvature_of_the_surface(m):
    """On every convexity, where what the curvature is fitted through touches it, within 5 %
    (median).
    """
    found = {
        f"{k} at {v}": miss
        for v, each in by_speed(m, "curvature_miss").items()
        for k, miss in each.items()
    }
    note = f"largest median difference on a convexity {np.nanmax(list(found.values())):.1%}"
    return everywhere({k: miss <= 0.05 for k, miss in found.items()}, note)


@trend("TR28")
def pressure_peaks_grow(m):
    found = by_speed(m, "convexity_pressure")
    return everywhere(
        {v: _grow(each) for v, each in found.items()}, "10 mm/s: " + listed(found["10 mm/s"], "Pa")
    )


def _grow(values) -> bool:
    return all(b > a for a, b in pairwise(values.values()))


# --- velocity -------------------------------------------------------------------------------------


@trend("TR29", quantity="convexity_pressure", trace="pressure")
@trend("TR30", quantity="convexity_energy", trace="energy")
def velocity_hardly_matters(m, quantity, trace):
    found = list(by_speed(m, quantity).values())
    spread, change = spreads(found), {k: 100 * (found[-1][k] / found[0][k] - 1) for k in found[0]}
    worst, whole = max(spread, key=spread.get), m("spread_of_traces", FULL["1"], trace)
    largest = max(change.values(), key=abs)
    note = (
        f"peaks change by up to {abs(largest):.0f} %; they spread by "
        f"{np.mean(list(spread.values())):.1f} % on average, at most {spread[worst]:.1f} % "
        f"(K = {worst}); whole traces by {whole:.1f} %; change of the peaks from 1 to 40 mm/s "
        f"{listed(change, '%', 2)}"
    )
    return Trend(abs(largest) <= NEGLIGIBLE, largest, note)


@trend("TR31")
def velocity_hardly_matters_for_contact(m):
    spread = spreads([m.find("contact_length", FULL[v]) for v in ("5", "10", "20", "40")])
    worst = max(spread, key=spread.get)
    note = f"spread at most {spread[worst]:.1f} %; over velocities " + listed(spread, "%", 2)
    return Trend(spread[worst] <= HARDLY, spread[worst], note)


@trend("TR32", quantity="contact_length")
@trend("TR64", quantity="burst_width")
def falls_from_convexity_to_convexity(m, quantity):
    return stepwise(m.find(quantity, TEN), "mm", -1)


@trend("TR69")
def energy_rate_is_proportional(m):
    found = list(by_speed(m, "convexity_energy_rate").values())
    velocity = np.log([m("stroke_speed", scene) for scene in FULL.values()])
    exponents = {
        k: float(np.polyfit(velocity, np.log([f[k] for f in found]), 1)[0]) for k in found[0]
    }
    return everywhere(
        {k: abs(v - 1) <= PROPORTIONAL for k, v in exponents.items()},
        "exponents " + listed(exponents, ""),
    )


# --- stepped and stroked --------------------------------------------------------------------------


@trend("TR33")
def alike_stepped_and_stroked(m):
    shift, likeness = m("lag_of_stepped", SUB["10"]), m("likeness_of_stepped", SUB["10"])
    stroked, stepped = (m("centre_pressure", scene, "mean") for scene in (SUB["10"], STEPPED))
    shifts = ", ".join(f"{s:.2f}" for s in m.find("profile_shift", SUB["10"]).values())
    note = (
        f"correlation {likeness:.3f} at a lag of {shift:.2f} mm; profiles at the three "
        f"locations {shifts} mm to the left"
    )
    note += f"; mean pressure {stroked:.0f} Pa stroked, {stepped:.0f} Pa stepped"
    return Trend(likeness >= FOLLOWS and abs(stroked / stepped - 1) <= ALIKE, likeness, note)


@trend("TR33a")
def profiles_are_alike_once_shifted(m):
    found, shifts = (m.find(f"profile_{k}", SUB["10"]) for k in ("likeness", "shift"))
    note = f"correlation {listed(found, '', 3)}; shifted to the left by {listed(shifts, 'mm', 2)}"
    return everywhere({k: v >= FOLLOWS for k, v in found.items()}, note)


@trend("TR34")
def peaks_higher_stroked(m):
    stroked, stepped = (m.find("start_pressure", scene) for scene in (SUB["10"], STEPPED))
    note = ", ".join(
        f"K = {k}: {high:.0f} against {stepped[k]:.0f} Pa" for k, high in stroked.items()
    )
    return everywhere({f"K = {k}": high > stepped[k] for k, high in stroked.items()}, note)


@trend("TR35")
def contact_lost_at_the_corner(m):
    pressure, length = m("corner_pressure", STEPPED), m("lost_contact", STEPPED, "corner")
    return Trend(
        pressure == 0,
        length,
        f"centre pressure {pressure:.0f} Pa at the corner, zero over {length:.2f} mm",
    )


@trend("TR36")
def contact_lost_later_stroked(m):
    stepped, stroked = (m("lost_contact", scene, "at") for scene in (STEPPED, SUB["10"]))
    return Trend(
        stroked > stepped,
        stroked - stepped,
        f"out of contact about {stepped:.1f} mm stepped, {stroked:.1f} mm stroked",
    )


def _lost(m, scene) -> tuple[tuple[float, float], str]:
    corner, second = (m("lost_contact", scene, k) for k in ("corner", "second"))
    note = f"over {corner:.2f} mm at the corner and {second:.2f} mm before the second convexity"
    return (corner, second), note


@trend("TR37", convexity=0)
@trend("TR37a", convexity=1)
def contact_lost_before(m, convexity):
    lengths, note = _lost(m, SUB["40"])
    return Trend(lengths[convexity] > 0, lengths[convexity], "out of contact " + note)


@trend("TR38")
def contact_kept_when_slow(m):
    found = {v: _lost(m, SUB_SPEEDS[v]) for v in ("1 mm/s", "10 mm/s")}
    return everywhere(
        {k: v[0][1] == 0 for k, v in found.items()},
        "; ".join(f"{k}: {v[1]}" for k, v in found.items()),
    )


# --- strain energy --------------------------------------------------------------------------------


@trend("T263")
def energy_falls_at_the_sharpest(m):
    found = by_speed(m, "convexity_energy")
    last = {v: [*each.values()][-3:] for v, each in found.items()}
    outcome = {v: before > sharp > sharpest for v, (before, sharp, sharpest) in last.items()}
    return everywhere(outcome, "10 mm/s: " + listed(found["10 mm/s"], "Pa"))


def _stroked_over_pressed(m) -> dict[str, float]:
    """Peak strain energy stroked over that pressed, at the cylinders' curvatures (stroked:
    interpolated).
    """
    measures = ("convexity_energy", "convexity_curvature")
    found, exact = (list(m.find(q, TEN).values()) for q in measures)
    pressed = {k: m("highest_energy", NINE[k], "915 um") for k in WITHIN_400 if k != "flat"}
    return {k: float(np.interp(float(k), exact, found)) / v for k, v in pressed.items()}


@trend("TR39")
def as_high_stroked_as_pressed(m):
    label, ratio = next(iter(_stroked_over_pressed(m).items()))
    return Trend(
        abs(ratio - 1) <= ALIKE, ratio, f"stroked over pressed at K = {label}: {ratio:.2f}"
    )


@trend("TR40")
def falls_below_pressed(m):
    ratios = _stroked_over_pressed(m)
    values = list(ratios.values())
    below = values[next((i for i, v in enumerate(values) if v < 1), len(values)) :]
    falls = len(below) > 1 and max(below) < 1 and (np.diff(below) < 0).all()
    return Trend(falls, values[-1], "stroked over pressed " + listed(ratios, "", 2))


@trend("TR41", quantity="energy_peaks_apart", shown="10 mm/s")
@trend("TR72", quantity="rate_peaks_apart")
def two_peaks_a_convexity(m, quantity, shown=""):
    """Under 52 and 79 1/m at every velocity; the distances shown are of these two, or of all
    convexities at one velocity.
    """
    found = by_speed(m, quantity)
    apart = {f"{k} at {v}": found[v][k] for v in SPEEDS for k in ("52", "79")}
    given = {k: v for k, v in (found[shown] if shown else apart).items() if v > 0}
    note = f"apart {f'at {shown} ' if shown else ''}" + listed(given, "mm", 3 if shown else 2)
    return everywhere({k: v > 0 for k, v in apart.items()}, note * bool(given))


@trend("T301")
def two_bursts_a_convexity(m):
    """Under 52 and 79 1/m, in more than half of the strokes that are shown."""
    double, strokes = m.find("double_bursts", TEN), STROKES_SHOWN["5-22"]
    impulses = m.find("impulses_at_560_um", TEN)
    note = f"strokes of {strokes} with two bursts {listed(double, '')}; impulses of a stroke "
    outcome = {k: double[k] > strokes / 2 for k in ("52", "79")}
    return everywhere(outcome, note + listed(impulses, "", 2))


@trend("TR42", quantity="energy_peaks_apart")
@trend("TR73", quantity="rate_peaks_apart")
def peaks_closer_when_sharp(m, quantity):
    outcome, notes = {}, []
    for speed, found in by_speed(m, quantity).items():
        seen = [found[k] for k in ("52", "79", "105") if found[k] > 0]
        outcome[speed] = len(seen) >= 2 and (np.diff(seen) < 0).all()
        notes.append(f"{speed}: " + (", ".join(f"{v:.1f}" for v in seen) or "none"))
    return everywhere(outcome, "mm apart from K = 52 on, " + "; ".join(notes))


@trend("TR60")
def eq_4_4_agrees(m):
    residual, share = (of_each(m, "departure_of_eq_4_4", SPEEDS, k) for k in ("residual", "R2"))
    shown = listed({k: 100 * v for k, v in residual.items()}, "%")
    note = f"residual over the energy {shown}; R2 {listed(share, '', 2)}"
    return everywhere({k: v <= ALIKE for k, v in residual.items()}, note)


@trend("TR61")
def eq_4_4_departs_with_velocity(m):
    residual = of_each(m, "departure_of_eq_4_4", SPEEDS, "residual")
    return stepwise({k: 100 * v for k, v in residual.items()}, "%")


# --- predicted impulses ---------------------------------------------------------------------------


@trend("TR62")
def impulses_under_convexities_only(m):
    found, dragged = m.find("impulses_in_hollows", TEN), m.find("impulses_under_hollows", TEN)
    note = f"impulses of a stroke at a concavity {listed(found, '', 2)}; while it is over the "
    note += f"centre of the skin, which is dragged back, up to {max(dragged.values()):.2g}"
    return everywhere({k: v < NONE_LEFT for k, v in found.items()}, note)


@trend("TR63")
def burst_rate_grows(m):
    found = stepwise(m.find("burst_rate", TEN), "impulses/s")
    strokes = listed(m.find("burst_strokes", TEN), "")
    return replace(found, note=f"{found.note}; strokes of {STROKES} with a burst {strokes}")


@trend("TR65")
def burst_rate_grows_with_velocity(m):
    found = list(by_speed(m, "burst_rate").values())
    note = "from 1 to 40 mm/s " + ", ".join(
        f"{k}: {digits(found[0][k])} to {digits(v)}" for k, v in found[-1].items()
    )
    return everywhere({k: all(b[k] > a[k] for a, b in pairwise(found)) for k in found[0]}, note)


@trend("TR66")
def burst_width_hardly_varies(m):
    spread = spreads(list(by_speed(m, "burst_width").values()))
    return everywhere(
        {k: v <= HARDLY for k, v in spread.items()},
        "spread over velocities " + listed(spread, "%", 2),
    )


@trend("TR110", quantity="energy_time", of="burst_time", first=1)
@trend("TR111", quantity="contact_length", of="burst_width")
def as_long_as_the_burst(m, quantity, of, first=0):
    """Within 15 % or a bin at either end, at the velocities of Figs 5-4 and 5-16, from the `first`
    convexity on.
    """
    outcome, ratios = {}, {}
    for speed in ("5", "10", "20", "40"):
        burst, found = m.find(of, FULL[speed]), m.find(quantity, FULL[speed])
        bins = 2e3 * BIN / (float(speed) if of == "burst_time" else 1.0)
        for k in list(burst)[first:]:
            near = abs(found[k] - burst[k]) <= max(ALIKE * burst[k], bins)
            outcome[f"{k} at {speed} mm/s"] = near and min(found[k], burst[k]) > 0
        ratios[speed] = {k: found[k] / (v or np.nan) for k, v in burst.items()}
    return everywhere(outcome, "over the burst at 10 mm/s " + listed(ratios["10"], "", 2))


@trend("TR67")
def stroked_rate_between_those_pressed(m):
    """A mean beside a mean, a peak beside a peak."""
    steady, peak = (m("rate", NINE["79"], at) for at in ("end", "peak"))
    burst, highest = (m(quantity, TEN, "79") for quantity in ("burst_rate", "convexity_rate"))
    note = f"mean stroked {digits(burst)}, steady pressed {digits(steady)}; peak stroked "
    note += f"{digits(highest)}, pressed {digits(peak)} impulses/s; K = 79 1/m"
    return Trend(burst > steady and highest < peak, burst, note)


@trend("TR68")
def stroked_rate_above_the_peak_pressed(m):
    """A peak beside a peak."""
    rate = dict(m.find("convexity_rate", TEN))
    rate["158"] = rate["157"]
    ratios = {k: rate[k] / m("rate", NINE[k], "peak") for k in WITHIN_350 if k != "flat"}
    note = "peak stroked over peak pressed " + listed(ratios, "", 2)
    return Trend(ratios["315"] > 1, ratios["315"], note)


@trend("TR70")
def rate_peaks_with_the_energy_rate(m):
    """In the same bin or the next."""
    apart = m.find("rate_after_energy_rate", TEN)
    note = "highest bin after that of the energy's rate " + listed(apart, "mm", 2)
    return everywhere({k: abs(v) <= 1e3 * BIN + 1e-9 for k, v in apart.items()}, note)


@trend("TR71")
def sharpest_answered_to_the_rate(m):
    found = m.find("dynamic_share", TEN)
    note = "share of the impulses that comes from the rate " + listed(found, "%", 2)
    return everywhere({k: found[k] > 50 for k in ("210", "315")}, note)


# --- a plate, and ridges --------------------------------------------------------------------------


@trend("TR47")
def no_direction_without_ridges(m):
    index, spread = m("direction", PLAIN["right"]), m("spread_of_three", PLAIN["right"])
    note = (
        f"directional index {index:.2g} at -46 um; the three receptors differ by {spread:.1f} "
        "% at most"
    )
    return Trend(abs(index) <= UNFELT, index, note)


@trend("TR48")
def receptors_differ(m):
    """Largest over smallest of the three receptors; and at equal material."""
    left, centre, right, tip = (
        m("energy_at_end", RIDGED["right"], at)
        for at in ("915 um, -46 um", "915 um", "915 um, 46 um", "935 um")
    )
    values = {"x = -46 um": left, "centre": centre, "x = 46 um": right}
    note = ", ".join(f"{v:.0f} Pa at {k}" for k, v in values.items())
    note += (
        " at the end; the centre lies in the epidermis of the tip, 20 um deeper, in the "
        f"dermis, it is {tip:.0f} Pa"
    )
    note += f"; of the two in the dermis one has {left / right:.1f} times the other's"
    return Trend(left / right >= 2, max(values.values()) / min(values.values()), note)


@trend("T321", strokes=RIDGED)
@trend("TR50", strokes=OUTER)
def direction_is_felt(m, strokes):
    index = m("direction", strokes["right"])
    try:
        right, left = (
            m("energy_at_end", strokes[way], "915 um, -46 um") for way in ("right", "left")
        )
        note = (
            f"at -46 um {right:.0f} Pa at the end of the stroke to the right, {left:.0f} Pa to "
            "the left"
        )
    except KeyError:
        note = "stroke to the left by mirror image"
    return Trend(abs(index) >= FELT, index, f"directional index {index:.2f}; {note}")


@trend("TR49")
def responds_throughout(m):
    """A receptor at -46 um, one way."""
    threshold = m("energy_threshold", RIDGED["right"])
    least = m("energy_beside", RIDGED["right"], "least late")
    note = (
        f"at -46 um to the right {least:.0f} Pa at least after 2 mm; threshold {threshold:.0f} Pa"
    )
    return Trend(least > threshold, least, note)


@trend("TR49a")
def responds_at_the_start(m):
    """The same receptor, the other way."""
    threshold = m("energy_threshold", RIDGED["right"])
    start, late = (m("energy_beside", RIDGED["left"], k) for k in ("start", "highest late"))
    note = (
        f"at -46 um to the left {start:.0f} Pa at the start, {late:.0f} Pa at most after 2 mm; "
        f"threshold {threshold:.0f} Pa"
    )
    return Trend(start > threshold > late, start, note)


@trend("TR51")
def islands_under_outer_ridges(m):
    found = [m.find("islands_of_contact", scene) for scene in OUTER.values()]
    fewest, most = min(f["fewest"] for f in found), max(f["most"] for f in found)
    cuts = sum(m("steps_cut", scene) for scene in OUTER.values())
    volume = min(m("smallest_volume", scene) for scene in OUTER.values())
    plain = m("islands_of_contact", RIDGED["right"], "end")
    note = (
        f"{fewest:.0f} to {most:.0f} islands in the strokes ({plain:.0f} without outer ridges), "
        f"{cuts:.0f} steps cut, smallest det F {volume:.3f}"
    )
    return Trend(fewest > plain and cuts == 0, float(np.mean([f["median"] for f in found])), note)


@trend("TR74", fewer=True)
@trend("TR74a", fewer=False)
def one_way_at_the_beginning(m, fewer):
    """One way mostly at the beginning, the other throughout, with more impulses than twice as many;
    a receptor beside the centre of a pad with inner ridges.
    """
    found = {way: tuple(m.find("plate_impulses", RIDGED[way]).values()) for way in RIDGED}
    (few, early), (many, first) = sorted(found.values())
    holds = few >= NONE_LEFT and early > few / 2 if fewer else many > 2 * few and first < many / 2
    note = "mean numbers of a stroke, 46 um to the right: " + ", ".join(
        f"to the {way} {n:.2g}, {b:.2g} of them in the first 5 mm" for way, (n, b) in found.items()
    )
    return Trend(holds, few if fewer else many, note)

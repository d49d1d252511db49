"""Trends that the thesis states of pressed pads: its chapter 4, and the presses of section 5.5."""

from __future__ import annotations

from itertools import pairwise, product

import numpy as np

from cysyk1999.claims.trends import ALIKE, Trend, everywhere, of_each, ordered, trend
from cysyk1999.measures.of_presses import ENERGIES
from cysyk1999.measures.responses import straight_line
from cysyk1999.measures.runs import CYLINDERS, FAST, NINE, PADS, RIDGED_NINE
from fingerpad.measures.features import PRESSURE_SCALE

TWIN = 0.01
"""Least excess of an off-centre pressure peak over the centre's, relative, to count as one."""
BROAD = ("flat", "79", "105", "158", "210", "315", "420")
"""Surfaces whose pressure peak has left the centre: all "except for the two highest curvatures"
(section 4.4).
"""
LINEAR = 0.9
"""Least R2 of a line to call points linear."""
DELAY = 0.02
"""s; least time to the first impulse to call it delayed: a fraction of what a raster of 2.4 s lets
one see.
"""
AGREES, PANELS = 0.1, 8
"""Largest root-mean-square residual, relative, to call traces in agreement; of how many of the nine
for all to be.
"""
CORRELATED = 0.98
"""Least correlation of traces over time that rise and fall alike."""

PLATE, SHARPEST, K210 = NINE["flat"], NINE["1260"], NINE["210"]
BEFORE = {label: NINE[label] for label in CYLINDERS[:-2]}
"""The cylinders but the two sharpest."""


# --- order of the nine surfaces -------------------------------------------------------------------


@trend("TR01", quantity="depth", at="end", what="depth, mm")
@trend("TR02", quantity="width", at="end", what="width, mm", growing=False)
@trend("TR03", quantity="centre_pressure", at="end", what="pressure, Pa")
@trend("TR04", quantity="energy_at_top", at="915 um", what="energy at 915 um, Pa")
@trend("TR05", quantity="highest_energy_rate", at="", what="rate, Pa/s")
def order_of_surfaces(m, quantity, at, what, growing=True):
    return ordered(of_each(m, quantity, NINE, at), what, growing)


@trend("TR22")
def pressure_exceeds_energy_by_more(m):
    pressure = of_each(m, "centre_pressure", NINE, "end")
    energy = of_each(m, "energy_at_end", NINE, "915 um")
    left = {k: PRESSURE_SCALE * pressure[k] - energy[k] for k in NINE}
    return ordered(left, "0.04 x pressure less energy, Pa")


# --- ramp and hold --------------------------------------------------------------------------------


@trend("TR06", quantity="depth", sign=1)
@trend("TR07", quantity="width", sign=1)
@trend("TR09", quantity="centre_pressure", sign=-1)
def changes_in_the_hold(m, quantity, sign):
    top, end = (of_each(m, quantity, NINE, at) for at in ("top", "end"))
    return everywhere({k: sign * (end[k] - top[k]) > 0 for k in NINE})


@trend("TR08")
def contact_grows_faster_in_the_ramp(m):
    top, end = (of_each(m, "width", NINE, at) for at in ("top", "end"))
    ramp, hold = (of_each(m, q, NINE) for q in ("ramp_time", "hold_time"))
    return everywhere({k: top[k] / ramp[k] > (end[k] - top[k]) / hold[k] for k in NINE})


@trend("T327")
def double_peak_of_the_plate(m):
    pressure, time = m.find("ramp_pressure", PLATE), m.find("ramp_pressure_time", PLATE)
    if "first" not in pressure:
        note = f"rises to {pressure['top']:.0f} Pa at the ramp's end with no peak before"
        return Trend(False, 0, note)
    holds = time["dip"] < time["top"] and pressure["top"] > pressure["dip"]
    note = ", ".join(f"{pressure[k]:.0f} Pa at {time[k]:.2f} s" for k in ("first", "dip", "top"))
    return Trend(holds, 1 + holds, note)


@trend("T328")
def peaks_before_the_top(m):
    times, tops = of_each(m, "peak_time", BEFORE), of_each(m, "ramp_end_time", BEFORE)
    return everywhere(
        {k: t < tops[k] for k, t in times.items()},
        "peak times " + ", ".join(f"{k}: {t:.2f} s" for k, t in times.items()),
    )


@trend("T328a")
def peaks_sooner_when_broad(m):
    times = list(of_each(m, "peak_time", BEFORE).values())
    sooner = [True, *(b >= a for a, b in pairwise(times))]
    note = f"{times[0]:.2f} s (79) to {times[-1]:.2f} s (420)"
    return everywhere(dict(zip(BEFORE, sooner, strict=True)), note)


@trend("T328b", label="630")
@trend("T329", label="1260")
def peaks_at_the_top(m, label):
    time, top = m("peak_time", NINE[label]), m("ramp_end_time", NINE[label])
    return Trend(
        abs(time - top) <= 0.04 * top, time, f"peak at {time:.3f} s, ramp ends at {top:.3f} s"
    )


@trend("TR15", quantity="half_of_fall", what="half of the fall after {:.2f} and {:.2f} s")
@trend("TR15a", quantity="fall_in_hold", what="fall {:.1%} and {:.1%}")
def largest_and_centre_decay_alike(m, quantity, what):
    largest, centre = (m(quantity, K210, k) for k in ("largest", "centre"))
    alike = min(largest, centre) > 0 and abs(largest / centre - 1) <= ALIKE
    return Trend(alike, largest / centre, what.format(largest, centre))


@trend("TR16")
def same_time_constant_at_every_node(m):
    short, long, mean = (m("half_of_fall", K210, k) for k in ("shortest", "longest", "mean"))
    times = " to ".join(dict.fromkeys((f"{short:.2f}", f"{long:.2f}")))
    note = (
        f"half of the fall after {times} s at {m('nodes_past_peak', K210):.0f} nodes past the peak"
    )
    return Trend((long - short) / mean <= 0.3, (long - short) / mean, note)


@trend("TR16a")
def eq_4_1_gives_the_decay(m):
    left = m.find("residual_of_eq_4_1", K210)
    note = f"residual over the pressure {min(left.values()):.0%} to {max(left.values()):.0%}"
    return everywhere({k: v <= AGREES for k, v in left.items()}, note)


@trend("TR17")
def later_nodes_peak_lower(m):
    count = m("late_nodes", K210, "all")
    if not count:
        return Trend(False, 0, "no node joins in the hold")
    first, last, highest = (m("late_peak", K210, k) for k in ("first", "last", "highest"))
    before = m("highest_pressure", K210, "highest")
    note = f"peaks {first:.0f} to {last:.0f} Pa at {count:.0f} nodes, {before:.0f} Pa before"
    return Trend(m("late_nodes", K210, "higher") == 0 and highest < before, count, note)


@trend("TR17a")
def later_nodes_rise_sooner(m):
    found = m.find("late_rise", K210)
    if not found:
        return Trend(False, 0, "no two nodes join in the hold")
    first, last, more = (found[k] for k in ("first", "last", "increase"))
    note = f"{first:.2f} to {last:.2f} s; from one to the next at most {more:+.2f} s"
    return Trend(more <= 0, last / first, note)


@trend("TR18")
def falls_but_at_the_edge(m):
    turn, edge = m("falls_up_to", K210), m("width", K210, "end") / 2
    note = f"falls up to {turn:.2f} mm from the centre, rises beyond; edge at {edge:.2f} mm"
    return Trend(np.isfinite(turn), turn, note)


# --- shape of the pressure ------------------------------------------------------------------------


@trend("TR10")
def pressure_peaks_off_the_centre(m):
    excess, at = of_each(m, "off_centre_excess", NINE, "end"), of_each(m, "off_centre_place", NINE)
    twins = {k: e for k, e in excess.items() if e > TWIN}
    where = ", ".join(f"{k} at ±{at[k]:.2f} mm ({e:+.0%})" for k, e in twins.items())
    return everywhere({k: k in twins for k in BROAD}, f"end of hold: {where or 'none'}")


@trend("TR11")
def pressure_is_symmetric(m):
    found = of_each(m, "asymmetry", NINE)
    return everywhere(
        {k: v <= 1e-3 for k, v in found.items()}, "mirror images within 0.1 % of the peak"
    )


@trend("TR12", scene=SHARPEST, name="K = 1260 1/m")
@trend("TR13", scene=PADS["homogeneous"], name="homogeneous pad")
def never_off_the_centre(m, scene, name):
    worst = m("off_centre_excess", scene, "ever")
    return Trend(
        worst <= TWIN, worst, f"{name}: largest excess over the centre {worst:.1%} at any time"
    )


@trend("TR13a")
def same_width_without_layers(m):
    plain, layered = (m("width", PADS[k], "end") for k in ("homogeneous", "layered"))
    note = f"homogeneous {plain:.2f} mm, layered {layered:.2f} mm; "
    note += "a stiff skin bends, so the same depth goes with a narrower contact"
    return Trend(abs(plain / layered - 1) <= 0.1, plain / layered - 1, note)


@trend("TR14", of=("early", "top"), what="early in the ramp, {:.2f} mm at its top")
@trend("TR14a", of=("top", "end"), what="at the top of the ramp, {:.2f} mm at the end of the hold")
def peak_moves_out(m, of, what):
    before, after = (m("peak_place", K210, k) for k in of)
    return Trend(after > before, after, f"peak at {before:.2f} mm " + what.format(after))


@trend("TR14b")
def critical_distance_is_the_same(m):
    mean, least, most = (m("critical_distance", K210, k) for k in ("mean", "least", "most"))
    note = f"{least:.2f} to {most:.2f} mm from the edge"
    return Trend(max(mean - least, most - mean) <= ALIKE * mean, (most - least) / mean, note)


# --- strain energy --------------------------------------------------------------------------------


@trend("TR19")
def energy_peaks_at_the_centre(m):
    places = product(("flat", "158", "1260"), ("800 um", "915 um"))
    return everywhere(
        {f"{k} at {z}": m("energy_peak_offset", FAST[k], z) <= 1.01 for k, z in places}
    )


def _definitions(function):
    """The trend of each of the six definitions of the strain energy: a is that of 1999."""
    for number, peak in (("20", True), ("21", False)):
        for tag, name in zip("abcdef", ("", *(f", {k}" for k in ENERGIES)), strict=True):
            trend(f"TR{number}{tag}", at=f"915 um{name}", peak=peak)(function)
    return function


@_definitions
def energy_peaks_and_decays(m, at, peak):
    high, top, end = (
        of_each(m, q, NINE, at) for q in ("highest_energy", "energy_at_top", "energy_at_end")
    )
    note = ", ".join(f"{k}: {end[k] / top[k] - 1:+.0%}" for k in ("flat", "210", "1260"))
    outcome = {k: top[k] == high[k] if peak else end[k] < top[k] for k in NINE}
    return everywhere(outcome, f"change in the hold at 915 um {note}")


@trend("TR23")
def stands_out_less_when_deep(m):
    shallow, deep = (
        m("energy_at_end", SHARPEST, z) / m("energy_at_end", PLATE, z) for z in ("600 um", "915 um")
    )
    return Trend(
        deep < shallow,
        deep / shallow,
        f"1260 over flat: {shallow:.1f} at 600 um, {deep:.1f} at 915 um",
    )


@trend("TR87")
def pressure_gives_energy(m):
    left = m.find("residual_of_eq_4_4", PLATE)
    notes = []
    for law, name in (("eq_4_4", "Eq 4-4"), ("square", "the square of its sum")):
        off = m.find(f"residual_of_{law}", PLATE).values()
        falls = sum(fall > 0 for fall in m.find(f"fall_by_{law}", PLATE).values())
        spread = f"{min(off):.0%} to {max(off):.0%}"
        notes.append(f"residual by {name} {spread}, falls in the hold under {falls} surfaces")
    note = "; ".join(notes)
    return everywhere({label: share <= AGREES for label, share in left.items()}, note, PANELS)


@trend("TR87a")
def energy_from_pressure_falls_in_the_hold(m):
    return everywhere({k: fall > 0 for k, fall in m.find("fall_by_eq_4_4", PLATE).items()})


# --- predicted rates ------------------------------------------------------------------------------


@trend("TR80", runs=FAST, window="hold", what="mean of the hold", silent=True)
@trend("TR83", runs=NINE, window="peak", what="peak", silent=False)
def rate_grows(m, runs, window, what, silent):
    """From surface to surface; `silent` ones may come first."""
    found = of_each(m, "rate", runs, window)
    first = next((i for i, v in enumerate(found.values()) if v > 0), 0) if silent else 0
    names, values = list(found)[first:], list(found.values())[first:]
    steps = zip(pairwise(names), pairwise(values), strict=True)
    grows = {f"{a} to {b}": y > x for (a, b), (x, y) in steps}
    note = f"{what} {values[0]:.1f} ({names[0]}) to {values[-1]:.1f} (1260) impulses/s"
    note += f"; none under {', '.join(list(found)[:first])}" if first else ""
    count = len(values) - len(grows) + sum(grows.values())
    return Trend(values[-1] > 0 and all(grows.values()), count, note, grows)


@trend("TR81")
def impulses_begin_late(m):
    starts = {k: v for k, v in of_each(m, "first_impulse", FAST).items() if np.isfinite(v)}
    span = f"{min(starts.values()):.3f} to {max(starts.values()):.3f} s" if starts else ""
    note = f"first impulse {span} after the start, with no variability" if starts else ""
    return everywhere({k: v >= DELAY for k, v in starts.items()}, note, max(len(starts), 1))


@trend("TR82")
def rate_peaks_and_decays(m):
    outcome = {}
    for label, scene in NINE.items():
        if m("rate", scene, "highest of hold") > 0:
            at_top = np.isclose(m("rate_peak_time", scene), m("ramp_end_time", scene))
            outcome[label] = at_top and m("rate", scene, "end") < m("rate", scene, "start of hold")
    return everywhere(
        outcome, f"{len(outcome)} surfaces make impulses in the hold", max(len(outcome), 1)
    )


@trend("TR84", x=("rate", "peak"), y=("rate", "steady"))
@trend("TR86", x=("highest_pressure", "highest"), y=("rate", "peak"))
@trend("TR89", x=("highest_energy_rate", ""), y=("rate", "peak"))
def linear(m, x, y):
    points = (list(of_each(m, q, NINE, at).values()) for q, at in (x, y))
    slope, _, share = straight_line(*points)
    note = f"R2 {share:.3f} of the line through predicted rates"
    return Trend(share >= LINEAR and slope > 0, share, note)


@trend("TR85")
def rates_saturate(m):
    curvature = [0.0, *(2e3 / m("diameter", NINE[k]) for k in CYLINDERS)]
    outcome, notes = {}, []
    for window in ("peak", "steady"):
        rate = list(of_each(m, "rate", NINE, window).values())
        slope, _, share = straight_line(curvature[:-1], rate[:-1])
        last = (rate[-1] - rate[-2]) / (curvature[-1] - curvature[-2])
        outcome[window] = share >= LINEAR and last < 0.5 * slope
        notes.append(
            f"{window}: R2 {share:.3f} below the highest, then {last / slope:.2f} as steep"
        )
    return everywhere(outcome, "; ".join(notes))


@trend("TR88")
def saturates_less_when_shallow(m):
    shallow, deep = (
        m(q, SHARPEST, "hold") / max(m(q, K210, "hold"), 1e-9) for q in ("rate_at_600_um", "rate")
    )
    note = f"1260 over 210: {shallow:.1f} from 600 um, {deep:.1f} from 915 um"
    return Trend(shallow > deep, shallow / deep, note)


# --- a pad with inner ridges ----------------------------------------------------------------------

PLACES = {"centre": "915 um", "46 um": "915 um, 46 um"}
"""Receptors at the ridge's tip and beside it."""


@trend("TR43")
def rises_and_falls_as_without_ridges(m):
    found = {
        f"{k} at {p}": m("correlation_with_plain", s, p)
        for k, s in RIDGED_NINE.items()
        for p in PLACES
    }
    worst = min(found, key=found.get)
    outcome = {k: all(found[f"{k} at {p}"] >= CORRELATED for p in PLACES) for k in RIDGED_NINE}
    return everywhere(
        outcome, f"correlation over time with the plain pad at least {found[worst]:.4f} ({worst})"
    )


@trend("TR44")
def same_order_with_ridges(m):
    outcome, notes = {}, []
    for place, at in PLACES.items():
        values = list(of_each(m, "energy_at_top", RIDGED_NINE, at).values())
        steps = zip(CYLINDERS, pairwise(values), strict=True)
        outcome |= {f"{k} at {place}": b > a for k, (a, b) in steps}
        notes.append(f"{place} {values[0]:.0f} (flat) to {values[-1]:.0f} Pa (1260)")
    return everywhere(outcome, ", ".join(notes))


@trend("TR45")
def ridges_set_the_sharpest_apart(m):
    def apart(runs, at):
        return m("highest_energy", runs["1260"], at) / m("highest_energy", runs["630"], at)

    plain = apart(NINE, "915 um")
    centre, beside = (apart(RIDGED_NINE, at) for at in PLACES.values())
    note = (
        f"1260 over 630 1/m: {plain:.3f} without ridges, with ridges {centre:.3f} at the "
        f"centre, {beside:.3f} at 46 um"
    )
    return everywhere({"the centre": centre > plain, "46 um beside": beside > plain}, note)


@trend("TR46")
def ridges_change_the_magnitude(m):
    plain, ratios = of_each(m, "highest_energy", NINE, "915 um"), {}
    for place, at in PLACES.items():
        ridged = of_each(m, "highest_energy", RIDGED_NINE, at)
        ratios[place] = {k: ridged[k] / plain[k] for k in NINE}
    outcome = {f"{k} at {place}": abs(ratios[place][k] - 1) > 0.1 for k in NINE for place in PLACES}
    note = ", ".join(
        f"{min(v.values()):.2f} to {max(v.values()):.2f} at {k}" for k, v in ratios.items()
    )
    return everywhere(
        outcome,
        f"largest energy over the plain pad's {note}; the centre lies in the epidermis of the "
        "ridge's tip",
    )

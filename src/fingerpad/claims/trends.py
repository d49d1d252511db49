"""Trends the thesis states, tested on simulated histories: one function an id of the reference table."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import xarray as xr

from fingerpad.claims.numbers import CYLINDERS, Results, end_of, hold_time, ramp_time, top_of, width_mm
from fingerpad.claims.response_numbers import RESPONSE_TRENDS
from fingerpad.claims.ridge_rows import RIDGE_TRENDS
from fingerpad.claims.stroke_rates import RATE_TRENDS
from fingerpad.claims.stroke_trends import STROKE_TRENDS
from fingerpad.claims.verdicts import Trend, everywhere
from fingerpad.measures.features import (
    PRESSURE,
    PRESSURE_SCALE,
    SURFACES,
    centre_node,
    centre_pressure,
    energy,
    energy_rate,
    peak_pressure,
    profile,
    ramp_end,
    surface_nodes,
)

TWIN = 0.01
"""Least excess of an off-centre pressure peak over the centre's, relative, to count as one."""


ENERGIES = {
    "a": "strain_energy_density",
    "b": "strain_energy_network",
    "c": "strain_energy_recoverable",
    "d": "strain_energy_long_term_moduli",
    "e": "strain_energy_half_stress_strain",
}
BROAD = ("flat", "79", "105", "158", "210")
"""Surfaces whose contact is wider than twice the critical distance of 0.5 mm by half as much again."""


def _ordered(values: list[float], growing: bool, what: str) -> Trend:
    """Whether values of the nine surfaces, broad to sharp, only grow (or only fall)."""
    steps = np.diff(values) if growing else -np.diff(values)
    wrong = [f"{SURFACES[i]} to {SURFACES[i + 1]}" for i in np.flatnonzero(steps <= 0)]
    note = f"{what}: {values[0]:.3g} (flat) to {values[-1]:.3g} (1260)"
    return Trend(not wrong, len(values) - len(wrong), note + (f"; not from {', '.join(wrong)}" if wrong else ""))


def _all(check: Callable[[xr.Dataset], bool], results: Results, what: str = "") -> Trend:
    return everywhere({k: check(results(k)) for k in SURFACES}, what)


def _decays(history: xr.Dataset, values: np.ndarray) -> bool:
    return bool(values[-1] < values[ramp_end(history)])


def _peak_time(history: xr.Dataset) -> float:
    """Time (s) of the largest centre pressure, refined by a parabola through its neighbours."""
    time, value = history["time"].values, centre_pressure(history)
    i = int(value.argmax())
    if i in (0, ramp_end(history), len(time) - 1):
        return float(time[i])
    a, b, _ = np.polyfit(time[i - 1 : i + 2] - time[i], value[i - 1 : i + 2], 2)
    return float(time[i] - b / (2 * a)) if a < 0 else float(time[i])


def _plate_double_peak(results: Results) -> Trend:
    history = results("flat")
    top = ramp_end(history)
    time, p = history["time"].values[: top + 1], centre_pressure(history)[: top + 1]
    inner = [i for i in range(1, top) if p[i] > p[i - 1] and p[i] >= p[i + 1]]
    if not inner:
        return Trend(False, 0, f"rises to {p[top]:.0f} Pa at the ramp's end with no peak before")
    first = inner[0]
    dip = first + int(p[first:].argmin())
    holds = dip < top and p[top] > p[dip]
    note = ", ".join(f"{p[i]:.0f} Pa at {time[i]:.2f} s" for i in (first, dip, top))
    return Trend(bool(holds), 1 + holds, note)


def _peaks_before_top(results: Results) -> Trend:
    labels = CYLINDERS[:-2]
    times = {k: _peak_time(results(k)) for k in labels}
    note = "peak times " + ", ".join(f"{k}: {t:.2f} s" for k, t in times.items())
    return everywhere({k: t < ramp_time(results(k)) for k, t in times.items()}, note)


def _peaks_sooner(results: Results) -> Trend:
    labels = CYLINDERS[:-2]
    times = [_peak_time(results(k)) for k in labels]
    ordered = [True, *(b >= a for a, b in zip(times, times[1:], strict=False))]
    return everywhere(dict(zip(labels, ordered, strict=True)), f"{times[0]:.2f} s (79) to {times[-1]:.2f} s (420)")


def _peaks_at_top(label: str) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        time, top = _peak_time(results(label)), ramp_time(results(label))
        return Trend(abs(time - top) <= 0.04 * top, time, f"peak at {time:.3f} s, ramp ends at {top:.3f} s")

    return check


def _twin_peak(history: xr.Dataset, index: int) -> tuple[float, float]:
    """Excess of the largest pressure over the centre's (relative) and its distance from the centre (m)."""
    x, p = profile(history, index)
    node = int(p.argmax())
    centre = p[centre_node(history)]
    return (float(p[node] / centre - 1) if centre > 0 else 0.0), abs(float(x[node]))


def _peak_place(history: xr.Dataset, index: int) -> float:
    """Distance (m) of the pressure peak from the centre, between nodes by a parabola through five of them."""
    x, p = profile(history, index)
    half = np.arange(centre_node(history), len(x))
    node = half[int(p[half].argmax())]
    if node == half[0]:
        return 0.0
    near = np.arange(node - 2, node + 3)
    a, b, _ = np.polyfit(x[near] - x[node], p[near], 2)
    return float(x[node] - b / (2 * a)) if a < 0 else float(x[node])


def _off_centre(results: Results) -> Trend:
    found = {k: _twin_peak(results(k), results(k).sizes["time"] - 1) for k in SURFACES}
    twins = {k: (e, x) for k, (e, x) in found.items() if e > TWIN}
    where = ", ".join(f"{k} at ±{x * 1e3:.2f} mm ({e:+.0%})" for k, (e, x) in twins.items())
    return Trend(set(BROAD) <= set(twins), len(twins), f"end of hold: {where or 'none'}")


def _never_off_centre(history: xr.Dataset, name: str) -> Trend:
    worst = max(_twin_peak(history, i)[0] for i in range(1, history.sizes["time"]))
    return Trend(worst <= TWIN, worst, f"{name}: largest excess over the centre {worst:.1%} at any time")


def _symmetric(history: xr.Dataset) -> bool:
    p = history["contact_pressure"].values
    return bool(np.allclose(p, p[:, ::-1], atol=1e-3 * p.max()))


def _same_width(results: Results) -> Trend:
    plain, layered = (end_of(results.histories[n], "contact_width") for n in ("homogeneous_flat", "ramp40_flat"))
    difference = plain / layered - 1
    note = f"homogeneous {plain * 1e3:.2f} mm, layered {layered * 1e3:.2f} mm; "
    note += "a stiff skin bends, so the same depth goes with a narrower contact"
    return Trend(
        abs(difference) <= 0.1,
        difference,
        note,
    )


def _peak_moves_out(results: Results) -> Trend:
    history = results("210")
    top = ramp_end(history)
    places = [_peak_place(history, i) * 1e3 for i in (max(1, top // 4), top, history.sizes["time"] - 1)]
    note = "peak at {:.2f} mm early in the ramp, {:.2f} mm at its top, {:.2f} mm at the end".format(*places)
    return Trend(places[0] < places[1] <= places[2] and places[2] > places[0], places[2], note)


def _decay_time(time: np.ndarray, value: np.ndarray) -> float:
    """Time (s) from the start of a decay until half of its whole fall."""
    fall = (value[0] - value) / (value[0] - value[-1])
    return float(np.interp(0.5, np.maximum.accumulate(fall), time - time[0]))


def _hold_decay(history: xr.Dataset, values: np.ndarray) -> tuple[float, float]:
    """Relative fall over the hold and time to half of it."""
    top = ramp_end(history)
    held = values[top:]
    fall = float(1 - held[-1] / held[0])
    return fall, _decay_time(history["time"].values[top:], held) if fall > 0 else float("nan")


def _same_decay(results: Results) -> Trend:
    history = results("210")
    (largest, half), (centre, half_centre) = (_hold_decay(history, trace(history)) for trace in (peak_pressure, centre_pressure))
    note = f"fall {largest:.1%} and {centre:.1%}, half of it after {half:.2f} and {half_centre:.2f} s"
    return Trend(largest > 0 and centre > 0 and abs(half - half_centre) <= 0.3 * half_centre, half / half_centre, note)


def _same_time_constant(results: Results) -> Trend:
    history = results("210")
    half_width = top_of(history, "contact_width") / 2
    nodes = [n for n in surface_nodes(history) if history["skin_x"].values[n] < half_width - 0.6e-3]
    halves = [_hold_decay(history, history[PRESSURE].values[:, n])[1] for n in nodes]
    spread = (max(halves) - min(halves)) / float(np.mean(halves))
    note = f"half of the fall after {min(halves):.2f} to {max(halves):.2f} s at {len(nodes)} nodes past the peak"
    return Trend(bool(spread <= 0.3), spread, note)


def _later_nodes_lower(results: Results) -> Trend:
    history = results("210")
    touched = history["contact_pressure"].values > 0
    late = [n for n in surface_nodes(history) if touched[:, n].argmax() > ramp_end(history)]
    if not late:
        return Trend(False, 0, "no node joins in the hold")
    peaks = history[PRESSURE].values[:, late].max(axis=0)
    before = float(peak_pressure(history).max())
    note = f"peaks {peaks[0]:.0f} to {peaks[-1]:.0f} Pa at {len(late)} nodes, {before:.0f} Pa before"
    return Trend(bool((np.diff(peaks) <= 0).all() and peaks.max() < before), len(late), note)


def _falls_but_at_edge(results: Results) -> Trend:
    history = results("210")
    nodes, top = surface_nodes(history), ramp_end(history)
    change = history[PRESSURE].values[-1, nodes] - history[PRESSURE].values[top, nodes]
    x = history["skin_x"].values[nodes] * 1e3
    rising = np.flatnonzero(change > 0)
    holds = rising.size > 0 and bool((change[: rising[0]] < 0).all() and (change[rising[0] :] >= 0).all())
    turn = float(x[rising[0]]) if rising.size else float("nan")
    edge = end_of(history, "contact_width") * 1e3 / 2
    return Trend(
        holds,
        turn,
        f"falls up to {turn:.2f} mm from the centre, rises beyond; edge at {edge:.2f} mm",
    )


def _smooth_profiles(results: Results) -> Trend:
    outcome = {}
    for label in ("flat", "158", "1260"):
        history = results(label, "ramp150")
        for depth in (800e-6, 915e-6):
            row = np.flatnonzero(abs(history["receptor_depth"].values - depth) < 1e-6)
            row = row[np.argsort(history["receptor_offset"].values[row])]
            offset = history["receptor_offset"].values[row]
            if len(row) < 5:
                raise KeyError("receptors beside the centre")
            values = history["strain_energy_density"].values[[ramp_end(history), -1]][:, row]
            central = abs(offset[values.argmax(axis=1)]).max() <= np.diff(offset).max() * 1.01
            outcome[f"{label} at {depth * 1e6:.0f} um"] = bool(central)
    return everywhere(outcome)


def _energy_trend(name: str, kind: str) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        outcome, change = {}, {}
        for label in SURFACES:
            history = results(label)
            values = energy(history, 915e-6, name=name)
            top = ramp_end(history)
            change[label] = values[-1] / values[top] - 1
            outcome[label] = bool(values.argmax() == top) if kind == "peak" else _decays(history, values)
        note = ", ".join(f"{k}: {change[k]:+.0%}" for k in ("flat", "210", "1260"))
        return everywhere(outcome, f"change in the hold at 915 um {note}")

    return check


def _difference_grows(results: Results) -> Trend:
    gaps = [PRESSURE_SCALE * float(centre_pressure(results(k))[-1]) - energy(results(k), 915e-6)[-1] for k in SURFACES]
    return _ordered(gaps, True, "0.04 x pressure less energy, Pa")


def _stands_out_less(results: Results) -> Trend:
    ratio = [energy(results("1260"), z)[-1] / energy(results("flat"), z)[-1] for z in (600e-6, 915e-6)]
    return Trend(bool(ratio[1] < ratio[0]), float(ratio[1] / ratio[0]),
                 f"1260 over flat: {ratio[0]:.1f} at 600 um, {ratio[1]:.1f} at 915 um")  # fmt: skip


def _faster_in_ramp(history: xr.Dataset) -> bool:
    top = top_of(history, "contact_width")
    return top / ramp_time(history) > (end_of(history, "contact_width") - top) / hold_time(history)


TRENDS: dict[str, Callable[[Results], Trend]] = {
    "T327": _plate_double_peak,
    "T328": _peaks_before_top,
    "T328a": _peaks_sooner,
    "T328b": _peaks_at_top("630"),
    "T329": _peaks_at_top("1260"),
    "TR01": lambda r: _ordered([end_of(r(k), "indentation_depth") * 1e3 for k in SURFACES], True, "depth, mm"),
    "TR02": lambda r: _ordered([width_mm(r, k) for k in SURFACES], False, "width, mm"),
    "TR03": lambda r: _ordered([float(centre_pressure(r(k))[-1]) for k in SURFACES], True, "pressure, Pa"),
    "TR04": lambda r: _ordered([float(energy(r(k), 915e-6)[ramp_end(r(k))]) for k in SURFACES], True, "energy at 915 um, Pa"),
    "TR05": lambda r: _ordered(
        [float(energy_rate(r(k), 915e-6)["strain_energy_rate (Pa/s)"].max()) for k in SURFACES],
        True,
        "rate, Pa/s",
    ),
    "TR06": lambda r: _all(lambda d: end_of(d, "indentation_depth") > top_of(d, "indentation_depth"), r),
    "TR07": lambda r: _all(lambda d: end_of(d, "contact_width") > top_of(d, "contact_width"), r),
    "TR08": lambda r: _all(_faster_in_ramp, r),
    "TR09": lambda r: _all(lambda d: _decays(d, centre_pressure(d)), r),
    "TR10": _off_centre,
    "TR11": lambda r: _all(_symmetric, r, "mirror images within 0.1 % of the peak"),
    "TR12": lambda r: _never_off_centre(r("1260"), "K = 1260 1/m"),
    "TR13": lambda r: _never_off_centre(r.histories["homogeneous_flat"], "homogeneous pad"),
    "TR13a": _same_width,
    "TR14": _peak_moves_out,
    "TR15": _same_decay,
    "TR16": _same_time_constant,
    "TR17": _later_nodes_lower,
    "TR18": _falls_but_at_edge,
    "TR19": _smooth_profiles,
    **{f"TR20{tag}": _energy_trend(name, "peak") for tag, name in ENERGIES.items()},
    **{f"TR21{tag}": _energy_trend(name, "decay") for tag, name in ENERGIES.items()},
    "TR22": _difference_grows,
    "TR23": _stands_out_less,
    **STROKE_TRENDS,
    **RATE_TRENDS,
    **RESPONSE_TRENDS,
    **RIDGE_TRENDS,
}

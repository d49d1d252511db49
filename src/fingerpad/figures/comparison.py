"""The thesis against this model, number by number: ``figures/tables/thesis_comparison``.

Every row starts from a row of the reference table (what the thesis prints, id by id) and a function below
that reads the same quantity from the simulated histories. How the two are judged follows from the row's `form`:

value
    inside if within the row's relative tolerance (0: equal to six digits) or the discretisation error.
range
    inside if between low and high, give or take the discretisation error.
axis
    the thesis shows only an axis. Inside if the largest plotted value stays below its end and fills at least
    `FILL` of it, since a plot is drawn to be filled.
trend
    trend_holds or trend_fails.

`layout` rows only set axes of figures and have no row here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad.figures.features import (
    PRESSURE,
    PRESSURE_SCALE,
    SURFACES,
    Histories,
    centre_node,
    energy,
    energy_rate,
    force_gf,
    profile,
    ramp_end,
    scene_name,
    scene_of,
    surface_nodes,
)
from fingerpad.figures.spec import Meshes, read_reference

FILL = 0.5
"""Least share of a thesis axis that its largest curve should fill."""
TWIN = 0.01
"""Least excess of an off-centre pressure peak over the centre's, relative, to count as one."""

COLUMNS = (
    "id", "figure", "quantity", "condition", "thesis_low", "thesis_high", "thesis_kind", "simulated",
    "discretisation_error", "units", "verdict", "note",
)  # fmt: skip

ENERGIES = {"a": "strain_energy_density", "b": "strain_energy_network", "c": "strain_energy_recoverable"}
CYLINDERS = SURFACES[1:]
BROAD = ("flat", "79", "105", "158", "210")
"""Surfaces whose contact is wider than twice the critical distance of 0.5 mm by half as much again."""


@dataclass(frozen=True)
class Results:
    """Simulated histories and meshes, by scene name."""

    histories: Histories
    meshes: Meshes

    def __call__(self, label: str, programme: str = "ramp40") -> xr.Dataset:
        """History of one surface in one force programme. Raises KeyError if it was not simulated."""
        return self.histories[scene_name(programme, label)]

    @property
    def specimen(self) -> dict:
        """The specimen (SI) of the flat plate's scene."""
        return scene_of(self("flat"))["specimen"]

    def quality(self) -> dict:
        """Quality of the flat plate's mesh."""
        return self.meshes["ramp40_flat"].quality()


@dataclass(frozen=True)
class Trend:
    """Outcome of a trend: whether it holds, the number shown, and a remark."""

    holds: bool
    shown: float
    note: str = ""


Number = Callable[[Results], float]


# --- numbers -------------------------------------------------------------------------------------------


def _top(history: xr.Dataset, name: str) -> float:
    return float(history[name].values[ramp_end(history)])


def _end(history: xr.Dataset, name: str) -> float:
    return float(history[name].values[-1])


def _peak(history: xr.Dataset) -> float:
    """Largest pressure (Pa) of the whole history, at any node."""
    return float(history["peak_pressure"].values.max())


def _energy_peak(results: Results, depth: float, label: str = "1260", programme: str = "ramp40") -> float:
    return float(energy(results(label, programme), depth).max())


def _rate_gf(history: xr.Dataset) -> float:
    """Mean force rate of the ramp, gf/s."""
    top = ramp_end(history)
    return float(force_gf(history)[top] / history["time"].values[top])


def _ramp_time(history: xr.Dataset) -> float:
    return float(history["time"].values[ramp_end(history)])


def _hold_time(history: xr.Dataset) -> float:
    return float(history["time"].values[-1]) - _ramp_time(history)


def _curvature_departure(results: Results) -> float:
    exact = [scene_of(results(k))["stimulus"]["curvature"] for k in CYLINDERS]
    return max(100 * abs(k - float(label)) / k for k, label in zip(exact, CYLINDERS, strict=True))


def _relaxed(results: Results) -> float:
    return 1 - sum(term["g"] for term in results.specimen["prony"])


def _instantaneous(results: Results, layer: str) -> float:
    """Instantaneous Young's modulus (MPa): the long-term one over the long-time relaxation."""
    modulus = results.specimen["layers"][layer]["youngs_modulus"] * 1e-6
    return modulus if results.specimen["moduli"] == "instantaneous" else modulus / _relaxed(results)


def _modulus(layer: str) -> Number:
    return lambda r: r.specimen["layers"][layer]["youngs_modulus"] * 1e-6


def _outline(key: str, scale: float) -> Number:
    return lambda r: r.specimen["outline"][key] * scale


def _extent(axis: int) -> Number:
    return lambda r: float(np.ptp(r.meshes["ramp40_flat"].points[:, axis])) * 1e3


def _node_spacing(results: Results) -> float:
    """Spacing (um) of the skin nodes next to the centre."""
    history = results("flat")
    centre = centre_node(history)
    return float(np.hypot(np.diff(history["skin_x"])[centre], np.diff(history["skin_y"])[centre])) * 1e6


def _depths_present(results: Results, depths: tuple[int, ...]) -> float:
    have = set(np.round(results("flat")["receptor_depth"].values * 1e6).astype(int))
    return len(have & set(depths))


def _critical_distance(results: Results, label: str = "210") -> float:
    """Mean distance (mm) from a node to the contact edge when its pressure peaks, on the deformed skin.

    Over the nodes that reach their largest pressure before the ramp ends.
    """
    history = results(label)
    distances = []
    for node in surface_nodes(history):
        pressure = history[PRESSURE].values[:, node]
        index = int(pressure.argmax())
        if 0 < index < ramp_end(history):
            x = float(history["skin_x"].values[node] + history["skin_displacement_x"].values[index, node])
            distances.append(float(history["contact_width"].values[index]) / 2 - x)
    return float(np.mean(distances)) * 1e3 if distances else float("nan")


def _larger_of_scaled(results: Results, label: str) -> float:
    history = results(label)
    return max(
        PRESSURE_SCALE * float(history["centre_pressure"].values.max()), _energy_peak(results, 915e-6, label)
    )


def _widest(results: Results, label: str) -> float:
    return _end(results(label), "contact_width") * 1e3


def _sunk(results: Results, label: str) -> float:
    """Largest downward displacement (mm) of any skin node."""
    return float(-results(label)["skin_displacement_y"].values.min()) * 1e3


def _skin_height(results: Results, label: str) -> float:
    history = results(label)
    node = centre_node(history)
    return float(history["skin_y"].values[node] + history["skin_displacement_y"].values[-1, node]) * 1e3


NUMBERS: dict[str, Number] = {
    "T031": _outline("stratum_corneum_thickness", 1e6),
    "T033": _outline("epidermis_thickness", 1e6),
    "T034": _outline("epidermis_thickness", 1e6),
    "T035": _outline("epidermis_thickness", 1e6),
    "T036": _outline("dermis_thickness", 1e6),
    "T037": lambda r: r.quality()["nodes"],
    "T037a": lambda r: r.quality()["elements"],
    "T038": lambda r: r.quality()["smallest_edge_m"] * 1e6,
    "T039": _extent(0),
    "T040": _extent(1),
    "T041": lambda r: len(r.meshes["ramp40_flat"].regions) + 2,
    "T042": lambda r: r.specimen["layers"]["dermis"]["poisson_ratio"],
    "T044": lambda r: _modulus("epidermis")(r) / _modulus("dermis")(r),
    "T044a": lambda r: _modulus("dermis")(r) / _modulus("fat")(r),
    "T045": _modulus("epidermis"),
    "T046": _modulus("dermis"),
    "T047": _modulus("fat"),
    "T049": lambda r: r.specimen["prony"][0]["g"],
    "T050": lambda r: r.specimen["prony"][1]["g"],
    "T051": lambda r: r.specimen["prony"][0]["tau"],
    "T052": lambda r: r.specimen["prony"][1]["tau"],
    "T053": lambda r: _relaxed(r) + sum(term["g"] for term in r.specimen["prony"]),
    "T054": _relaxed,
    "T055": lambda r: _instantaneous(r, "epidermis"),
    "T056": lambda r: _instantaneous(r, "dermis"),
    "T073": lambda r: float(force_gf(r("flat"))[-1]),
    "T074": lambda r: _ramp_time(r("flat")),
    "T075": lambda r: _hold_time(r("flat")),
    "T076": lambda r: sum(scene_name("ramp40", k) in r.histories for k in SURFACES),
    "T077": lambda r: _rate_gf(r("flat", "ramp150")),
    "T078": lambda r: _hold_time(r("flat", "ramp150")),
    "T097": lambda r: _rate_gf(r("flat")),
    "T098": _curvature_departure,
    "T101": lambda r: _skin_height(r, "1260"),
    "T102": lambda r: max(_end(r(k), "indentation_depth") for k in SURFACES) * 1e3,
    "T102a": lambda r: _end(r("1260"), "indentation_depth") * 1e3,
    "T104": lambda r: max(_widest(r, k) for k in SURFACES),
    **{
        id_: (lambda r, k=label: 1 / _widest(r, k))
        for id_, label in zip(
            ("T106", "T108", "T110", "T112", "T114", "T115", "T116", "T118", "T120"), SURFACES, strict=True
        )
    },
    "T122": lambda r: float(force_gf(r("flat")).max()),
    "T123": lambda r: max(float(r(k)["centre_pressure"].values.max()) for k in SURFACES),
    **{f"T{125 + i}": (lambda r, k=label: _peak(r(k))) for i, label in enumerate(SURFACES)},
    "T134a": lambda r: max(_widest(r, k) for k in CYLINDERS) / 2,
    "T135": lambda r: _peak(r.histories["homogeneous_flat"]),
    "T136": lambda r: _peak(r("flat")),
    "T137a": lambda r: _widest(r, "flat") / 2,
    "T138": lambda r: _peak(r("flat")),
    "T139": lambda r: max(_peak(r(k)) for k in ("79", "105")),
    "T140": lambda r: max(_peak(r(k)) for k in ("158", "210", "315")),
    "T141": lambda r: max(_peak(r(k)) for k in ("420", "630")),
    "T142": lambda r: _peak(r("1260")),
    "T143": lambda r: _sunk(r, "flat"),
    "T144": lambda r: _sunk(r, "1260"),
    "T145": lambda r: _peak(r("210")),
    "T146": lambda r: _widest(r, "210") / 2,
    "T147": _critical_distance,
    "T148": lambda r: _peak(r("210")),
    "T150": lambda r: _peak(r("210")),
    "T153": _node_spacing,
    "T154": lambda r: _peak(r("210")),
    "T159": lambda r: max(_peak(r(k)) for k in SURFACES),
    "T163": lambda r: _depths_present(r, (800, 915)),
    "T164": lambda r: _rate_gf(r("flat", "ramp150")),
    **{
        f"T165{tag}": (lambda r, k=label: _peak(r(k, "ramp150")))
        for tag, label in zip("abc", ("flat", "158", "1260"), strict=True)
    },
    **{
        id_: (lambda r, z=depth, k=label: _energy_peak(r, z, k, "ramp150"))
        for id_, depth, label in (
            ("T166", 800e-6, "flat"),
            ("T167", 800e-6, "158"),
            ("T168", 800e-6, "1260"),
            ("T169", 915e-6, "flat"),
            ("T170", 915e-6, "158"),
            ("T171", 915e-6, "1260"),
        )
    },
    **{
        id_: (lambda r, k=label: _larger_of_scaled(r, k))
        for id_, label in (
            ("T173", "flat"),
            ("T174", "79"),
            ("T175", "105"),
            ("T176", "210"),
            ("T177a", "315"),
            ("T177b", "420"),
            ("T178", "630"),
            ("T179", "1260"),
        )
    },
    **{
        id_: (lambda r, k=label: _energy_peak(r, 915e-6, k))
        for id_, label in zip(
            ("T181", "T182", "T183", "T184", "T185", "T186", "T187a", "T187b", "T187c"), SURFACES, strict=True
        )
    },
    "T188": lambda r: max(_energy_peak(r, 915e-6, k) for k in SURFACES),
    "T190": lambda r: _depths_present(r, (560, 600, 640, 765, 800, 845)),
    "T191": lambda r: _depths_present(r, (870, 915, 960)),
    **{
        id_: (lambda r, z=depth: max(_energy_peak(r, z, k) for k in SURFACES))
        for id_, depth in (
            ("T192", 560e-6),
            ("T193", 600e-6),
            ("T194", 640e-6),
            ("T195", 765e-6),
            ("T196", 800e-6),
            ("T197", 845e-6),
            ("T198a", 870e-6),
            ("T198b", 915e-6),
            ("T198c", 960e-6),
        )
    },
    "T205": lambda r: max(
        float(energy_rate(r(k), 915e-6)["strain_energy_rate (Pa/s)"].max()) for k in SURFACES
    ),
    "T323": _outline("apex_radius", 1e3),
    "T324": lambda r: _end(r("flat"), "force"),
}


# --- trends --------------------------------------------------------------------------------------------


def _ordered(values: list[float], growing: bool, what: str) -> Trend:
    """Whether values of the nine surfaces, broad to sharp, only grow (or only fall)."""
    steps = np.diff(values) if growing else -np.diff(values)
    wrong = [f"{SURFACES[i]} to {SURFACES[i + 1]}" for i in np.flatnonzero(steps <= 0)]
    note = f"{what}: {values[0]:.3g} (flat) to {values[-1]:.3g} (1260)"
    return Trend(
        not wrong, len(values) - len(wrong), note + (f"; not from {', '.join(wrong)}" if wrong else "")
    )


def _everywhere(outcome: dict[str, bool], what: str = "", needed: int | None = None) -> Trend:
    """Whether something holds for every surface; the number shown counts those for which it does."""
    failing = [label for label, holds in outcome.items() if not holds]
    count = len(outcome) - len(failing)
    note = "; ".join(filter(None, (what, f"not for {', '.join(failing)}" if failing else "")))
    return Trend(count >= (needed or len(outcome)), count, note)


def _all(check: Callable[[xr.Dataset], bool], results: Results, what: str = "") -> Trend:
    return _everywhere({k: check(results(k)) for k in SURFACES}, what)


def _decays(history: xr.Dataset, values: np.ndarray) -> bool:
    return bool(values[-1] < values[ramp_end(history)])


def _peak_time(history: xr.Dataset, name: str = "centre_pressure") -> float:
    """Time (s) of the largest value of a scalar history, refined by a parabola through its neighbours."""
    time, value = history["time"].values, history[name].values
    i = int(value.argmax())
    if i in (0, ramp_end(history), len(time) - 1):
        return float(time[i])
    a, b, _ = np.polyfit(time[i - 1 : i + 2] - time[i], value[i - 1 : i + 2], 2)
    return float(time[i] - b / (2 * a)) if a < 0 else float(time[i])


def _plate_double_peak(results: Results) -> Trend:
    history = results("flat")
    top = ramp_end(history)
    time, p = history["time"].values[: top + 1], history["centre_pressure"].values[: top + 1]
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
    return _everywhere({k: t < _ramp_time(results(k)) for k, t in times.items()}, note)


def _peaks_sooner(results: Results) -> Trend:
    labels = CYLINDERS[:-2]
    times = [_peak_time(results(k)) for k in labels]
    ordered = [True, *(b >= a for a, b in zip(times, times[1:], strict=False))]
    return _everywhere(
        dict(zip(labels, ordered, strict=True)), f"{times[0]:.2f} s (79) to {times[-1]:.2f} s (420)"
    )


def _peaks_at_top(label: str) -> Callable[[Results], Trend]:
    def check(results: Results) -> Trend:
        time, top = _peak_time(results(label)), _ramp_time(results(label))
        return Trend(abs(time - top) <= 0.04 * top, time, f"peak at {time:.3f} s, ramp ends at {top:.3f} s")

    return check


def _twin_peak(history: xr.Dataset, index: int) -> tuple[float, float]:
    """Excess of the largest pressure over the centre's (relative) and its distance from the centre (m)."""
    x, p = profile(history, index)
    node = int(p.argmax())
    centre = p[centre_node(history)]
    return (float(p[node] / centre - 1) if centre > 0 else 0.0), abs(float(x[node]))


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
    plain, layered = (
        _end(results.histories[n], "contact_width") for n in ("homogeneous_flat", "ramp40_flat")
    )
    difference = plain / layered - 1
    note = f"homogeneous {plain * 1e3:.2f} mm, layered {layered * 1e3:.2f} mm"
    return Trend(abs(difference) <= 0.1, difference, note + "; the same within 10 %")


def _peak_moves_out(results: Results) -> Trend:
    history = results("210")
    top = ramp_end(history)
    places = [_twin_peak(history, i)[1] * 1e3 for i in (max(1, top // 4), top, history.sizes["time"] - 1)]
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
    (largest, half), (centre, half_centre) = (
        _hold_decay(history, history[name].values) for name in ("peak_pressure", "centre_pressure")
    )
    note = f"fall {largest:.1%} and {centre:.1%}, half of it after {half:.2f} and {half_centre:.2f} s"
    return Trend(
        largest > 0 and centre > 0 and abs(half - half_centre) <= 0.3 * half_centre, half / half_centre, note
    )


def _same_time_constant(results: Results) -> Trend:
    history = results("210")
    half_width = _top(history, "contact_width") / 2
    nodes = [n for n in surface_nodes(history) if history["skin_x"].values[n] < half_width - 0.6e-3]
    halves = [_hold_decay(history, history[PRESSURE].values[:, n])[1] for n in nodes]
    spread = (max(halves) - min(halves)) / float(np.mean(halves))
    note = (
        f"half of the fall after {min(halves):.2f} to {max(halves):.2f} s at {len(nodes)} nodes past the peak"
    )
    return Trend(bool(spread <= 0.3), spread, note)


def _later_nodes_lower(results: Results) -> Trend:
    history = results("210")
    pressure = history[PRESSURE].values
    touched = history["contact_pressure"].values > 0
    late = [n for n in surface_nodes(history) if touched[:, n].argmax() > ramp_end(history)]
    peaks = pressure[:, late].max(axis=0)
    holds = len(late) > 0 and bool((np.diff(peaks) <= 0).all()) and peaks.max() < pressure.max() / 2
    return Trend(
        holds, len(late), f"{len(late)} nodes join in the hold" if late else "no node joins in the hold"
    )


def _falls_but_at_edge(results: Results) -> Trend:
    history = results("210")
    nodes, top = surface_nodes(history), ramp_end(history)
    change = history[PRESSURE].values[-1, nodes] - history[PRESSURE].values[top, nodes]
    x = history["skin_x"].values[nodes] * 1e3
    rising = np.flatnonzero(change > 0)
    holds = rising.size > 0 and bool((change[: rising[0]] < 0).all() and (change[rising[0] :] >= 0).all())
    turn = float(x[rising[0]]) if rising.size else float("nan")
    edge = _end(history, "contact_width") * 1e3 / 2
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
    return _everywhere(outcome)


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
        return _everywhere(outcome, f"change in the hold at 915 um {note}")

    return check


def _difference_grows(results: Results) -> Trend:
    gaps = [
        PRESSURE_SCALE * _end(results(k), "centre_pressure") - energy(results(k), 915e-6)[-1]
        for k in SURFACES
    ]
    return _ordered(gaps, True, "0.04 x pressure less energy, Pa")


def _stands_out_less(results: Results) -> Trend:
    ratio = [energy(results("1260"), z)[-1] / energy(results("flat"), z)[-1] for z in (600e-6, 915e-6)]
    return Trend(bool(ratio[1] < ratio[0]), float(ratio[1] / ratio[0]),
                 f"1260 over flat: {ratio[0]:.1f} at 600 um, {ratio[1]:.1f} at 915 um")  # fmt: skip


def _faster_in_ramp(history: xr.Dataset) -> bool:
    top = _top(history, "contact_width")
    return top / _ramp_time(history) > (_end(history, "contact_width") - top) / _hold_time(history)


TRENDS: dict[str, Callable[[Results], Trend]] = {
    "T048": lambda r: Trend(True, float("nan"), "bone rim clamped: rigid rather than 10^8 times stiffer"),
    "T327": _plate_double_peak,
    "T328": _peaks_before_top,
    "T328a": _peaks_sooner,
    "T328b": _peaks_at_top("630"),
    "T329": _peaks_at_top("1260"),
    "TR01": lambda r: _ordered([_end(r(k), "indentation_depth") * 1e3 for k in SURFACES], True, "depth, mm"),
    "TR02": lambda r: _ordered([_widest(r, k) for k in SURFACES], False, "width, mm"),
    "TR03": lambda r: _ordered([_end(r(k), "centre_pressure") for k in SURFACES], True, "pressure, Pa"),
    "TR04": lambda r: _ordered(
        [float(energy(r(k), 915e-6)[ramp_end(r(k))]) for k in SURFACES], True, "energy at 915 um, Pa"
    ),
    "TR05": lambda r: _ordered(
        [float(energy_rate(r(k), 915e-6)["strain_energy_rate (Pa/s)"].max()) for k in SURFACES],
        True,
        "rate, Pa/s",
    ),
    "TR06": lambda r: _all(lambda d: _end(d, "indentation_depth") > _top(d, "indentation_depth"), r),
    "TR07": lambda r: _all(lambda d: _end(d, "contact_width") > _top(d, "contact_width"), r),
    "TR08": lambda r: _all(_faster_in_ramp, r),
    "TR09": lambda r: _all(lambda d: _decays(d, d["centre_pressure"].values), r),
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
}


# --- reasons -------------------------------------------------------------------------------------------

REASONS: dict[str, str] = {
    "T037a": "quadratic elements carry four nodes each; linear ones would number as the nodes do",
    "T102a": "likeliest: three-dimensional contact and a bone whose place is not stated; thicker fat: deeper",
}
"""Likeliest reason of a known difference, by id; used when the row is outside."""


def _sensitivity(id_: str, results: Results) -> str:
    """What a sensitivity run, if simulated, says about a difference."""
    scene = results.histories.get("sensitivity_fat_k1260")
    if id_ != "T102a" or scene is None:
        return ""
    outline = scene_of(scene)["specimen"]["outline"]
    fat = outline["apex_height"] - outline["bone_centre_height"] - outline["bone_half_height"]
    fat -= outline["epidermis_thickness"] + outline["dermis_thickness"]
    return f"with {fat * 1e3:.1f} mm of fat the depth is {_end(scene, 'indentation_depth') * 1e3:.2f} mm"


# --- the table -----------------------------------------------------------------------------------------


def thesis_comparison(
    histories: Histories, coarse: Histories, meshes: Meshes, reference_csv: str | PathLike
) -> pd.DataFrame:
    """Compare the thesis's numbers and trends of chapters 3 and 4 with the simulated ones.

    Parameters
    ----------
    histories, coarse : scene name -> history, and its companion on a mesh of twice the edge (may be empty).
    meshes : scene name -> mesh.
    reference_csv : the table of printed numbers (see `read_reference`).

    Returns
    -------
    One row an id, columns `COLUMNS`; numbers in the row's `units`. The discretisation error is the difference
    of the row's number between mesh and companion, in the same units. Scenes that were not simulated give
    ``not_comparable``.
    """
    reference = read_reference(reference_csv)
    fine, rough = Results(histories, meshes), Results(coarse, meshes)
    rows = [_row(id_, entry, fine, rough) for id_, entry in reference.iterrows() if entry["form"] != "layout"]
    return pd.DataFrame(rows, columns=COLUMNS)


def _row(id_: str, entry: Mapping, fine: Results, rough: Results) -> dict:
    row = {
        "id": id_,
        "figure": entry["figure"],
        "quantity": entry["quantity"],
        "condition": entry["condition"],
        "thesis_low": entry["low"],
        "thesis_high": entry["high"],
        "thesis_kind": entry["kind"],
        "simulated": float("nan"),
        "discretisation_error": float("nan"),
        "units": entry["units"],
    }
    try:
        if entry["form"] == "trend":
            trend = TRENDS[id_](fine)
            verdict = "trend_holds" if trend.holds else "trend_fails"
            return row | {"simulated": trend.shown, "verdict": verdict, "note": trend.note}
        value = float(NUMBERS[id_](fine))
    except KeyError as missing:
        return row | {"verdict": "not_comparable", "note": f"not simulated: {missing.args[0]}"}
    try:
        error = abs(value - float(NUMBERS[id_](rough)))
    except KeyError:
        error = float("nan")
    verdict, note = judge(value, np.nan_to_num(error), entry)
    if verdict == "outside":
        note = "; ".join(filter(None, (note, REASONS.get(id_), _sensitivity(id_, fine))))
    if entry["kind"] == "garbled":
        note = "; ".join(filter(None, (note, "thesis reading uncertain")))
    return row | {"simulated": value, "discretisation_error": error, "verdict": verdict, "note": note}


def judge(value: float, error: float, entry: Mapping) -> tuple[str, str]:
    """Verdict and how far outside, of a number against a reference row (rules in the module's text)."""
    low, high = float(entry["low"]), float(entry["high"])
    if not np.isfinite(value):
        return "not_comparable", "the simulation does not show it"
    if entry["form"] == "value":
        allowed = max(float(entry["tolerance"]) * abs(low), error, 1e-6 * abs(low))
        if abs(value - low) <= allowed:
            return "inside", ""
        return "outside", f"by {value - low:+.3g} ({value / low - 1:+.0%})"
    if entry["form"] == "axis":
        if value > high + error:
            return "outside", f"{value / high - 1:.0%} above the axis's end"
        if value < FILL * high - error:
            return "outside", f"fills only {value / high:.0%} of the axis"
        return "inside", f"fills {value / high:.0%} of the axis"
    if low - error <= value <= high + error:
        return "inside", ""
    near = low if value < low else high
    return "outside", f"by {value - near:+.3g} ({value / near - 1:+.0%})"

"""Measures of strokes, of the wavy surface and of a plate, read of their `loaded` outputs. "26"
names the convexity of 26 1/m.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import xarray as xr

from cysyk1999.measures.direction import BESIDE, DEPTH, OFFSETS, directional_index, islands
from cysyk1999.measures.quantities import (
    BURST_IMPULSES,
    BURST_RATE,
    BURST_STROKES,
    BURST_TIME,
    BURST_WIDTH,
    COUNT,
    DISTANCE,
    DOUBLE,
    DYNAMIC,
    IMPULSE_RATE,
    RATE,
    SED_LAW,
    TIME,
    TIME_ABOVE,
)
from cysyk1999.measures.responses import (
    RECEPTOR_DEPTH,
    STROKES_SHOWN,
    burst_values,
    impulses_of,
    law_at,
    plate_rate,
    predicted_rate,
    skin_sample,
    stroke_histogram,
    stroke_laws,
)
from cysyk1999.receptors.fits import r_squared, rms
from fingerpad.measures import features
from fingerpad.measures.features import PRESSURE, Histories, energy, profile
from fingerpad.measures.kept import kept
from fingerpad.measures.measure import Measure, measure, named, plates, waves, wavy
from fingerpad.measures.skin import WINDOW, skin_curvatures
from fingerpad.measures.strokes import (
    FULL,
    LOCATIONS,
    NODES,
    STEPPED,
    SUB,
    arcs,
    centre_curvature,
    contact_lengths,
    convexities,
    distance,
    embedded,
    energy_at,
    lag,
    lateral,
    loaded,
    lost_contacts,
    nodes_at,
    passages,
    passing,
    peaks,
    place,
    scaled,
    touching,
)
from fingerpad.receptors.spikes import integrated

SHALLOW = 560e-6
"""Depth (m) of the double peaks of Figs 5-22 to 5-24."""
PROMINENCE = 0.05
"""Least prominence of a peak of strain energy that one sees, relative to the largest value while
the convexity passes.
"""
CHANCE = 2.0
"""Least prominence of a peak of a histogram, over the root of its number of impulses."""
SETTLED, BEGINNING = 2e-3, 5.0
"""Stroke of a plate (m) after which its start is over, and the part of it (mm) that is its
beginning.
"""

stroked, Stroke = partial(measure, of="stroke"), partial(Measure, of="stroke")
in_full, in_part, only_ten = (
    named(FULL.values()),
    named([*SUB.values(), STEPPED]),
    named([SUB["10"]]),
)


# --- contact and pressure -------------------------------------------------------------------------


def _at_location(stroke: xr.Dataset, location: float) -> int:
    return int(abs(distance(stroke) - location * 1e-3).argmin())


@stroked("Pa", in_part)
def location_pressure(stroke):
    """Largest pressure of any node at the three locations of Figs 5-5 and 5-6."""
    return {
        f"{at:g} mm": stroke[PRESSURE].values[_at_location(stroke, at)].max() for at in LOCATIONS
    }


@stroked("Pa", in_part)
def node_pressure(stroke):
    """Largest pressure of the nine nodes of Fig 5-10."""
    return {
        f"{at:g} mm": stroke[PRESSURE].values[:, n].max()
        for at, n in zip(NODES, nodes_at(stroke), strict=True)
    }


@stroked("Pa", wavy)
def start_pressure(stroke):
    """Largest centre pressure over the first third of each arc, hollows with a negative sign."""
    found = {}
    under, pressure = place(stroke), features.centre_pressure(stroke)
    for arc in arcs(stroke):
        values = pressure[(under >= arc.start) & (under <= arc.start + (arc.end - arc.start) / 3)]
        if values.size:
            found[f"{arc.curvature:.0f}"] = values.max()
    return found


@stroked("Pa", in_part)
def corner_pressure(stroke):
    """Centre pressure at the sharp corner, where the first convexity begins."""
    corner = next(iter(convexities(stroke).values())).start
    return features.centre_pressure(stroke)[int(abs(place(stroke) - corner).argmin())]


@stroked("mm", in_part)
def lost_contact(stroke):
    """Length of surface without contact: before the first convexity and before the second, and
    where the first loss is.

    Before the first: within 2 mm of the sharp corner; before the second: from the middle of the
    hollow to a quarter into it.
    """
    first, second = list(convexities(stroke).values())[:2]
    free = distance(stroke)[~touching(stroke)]
    near = free[abs(free - first.start) < 4e-3]
    return {
        "corner": 1e3 * _lost(stroke, first.start - 2e-3, first.start + 2e-3),
        "second": 1e3
        * _lost(
            stroke, (first.end + second.start) / 2, second.start + (second.end - second.start) / 4
        ),
        "at": 1e3 * near.mean() if near.size else np.nan,
    }


def _lost(stroke: xr.Dataset, low: float, high: float) -> float:
    return sum(max(0.0, min(b, high) - max(a, low)) for a, b in lost_contacts(stroke))


@stroked("mm", wavy)
def skin_drag(stroke):
    """Lateral displacement of the centre node under the arcs, from the first corner to the second:
    mean and least.
    """
    ends, under = list(convexities(stroke).values()), place(stroke)
    over = 1e3 * lateral(stroke)[(under >= ends[0].start) & (under <= ends[-1].end)]
    return {"mean": over.mean(), "least": over.min()}


# --- pressure and curvature -----------------------------------------------------------------------


@stroked("1", wavy)
def curvature_correlation(stroke):
    """Of pressure with the curvature of the skin while it touches: at the centre, and at the nine
    nodes of Fig 5-10.
    """
    found, pressures = {"centre": _scaled_curvature(stroke)[3]}, stroke[PRESSURE].values
    touched = {
        at: n
        for at, n in zip(NODES, nodes_at(stroke), strict=True)
        if (pressures[:, n] > 0).sum() > 2
    }
    for (at, n), curvature in zip(
        touched.items(), skin_curvatures(stroke, touched.values()), strict=True
    ):
        found[f"{at:g} mm"] = scaled(curvature, pressures[:, n], pressures[:, n] > 0)[3]
    return found


def _scaled_curvature(stroke: xr.Dataset) -> tuple[np.ndarray, float, float, float]:
    return scaled(centre_curvature(stroke), features.centre_pressure(stroke), touching(stroke))


@stroked("Pa", wavy)
def curvature_fit(stroke):
    """Pressure at no curvature, and the root mean square misfit."""
    fit, _, offset, _ = _scaled_curvature(stroke)
    misfit = (fit - features.centre_pressure(stroke))[touching(stroke)]
    return {"offset": offset, "misfit": np.sqrt(np.mean(misfit**2))}


@stroked("1", wavy)
def curvature_miss(stroke):
    """Median difference of the skin's curvature from each convexity's, where what it is fitted
    through touches it.
    """
    found, under, all_touch = centre_curvature(stroke), place(stroke), embedded(stroke)
    out = {}
    for label, arc in convexities(stroke).items():
        inner = all_touch & (under > arc.start + WINDOW) & (under < arc.end - WINDOW)
        out[label] = np.median(abs(found[inner] / arc.curvature - 1)) if inner.any() else np.nan
    return out


# --- stepped and stroked, and the velocities ------------------------------------------------------


def _shifted_profiles(history: xr.Dataset, runs: Histories) -> dict[str, tuple[float, float]]:
    """Shift (m) of the pressure profile at each location against the stepped surface, and their
    correlation when shifted.
    """
    found, x = {}, np.arange(-8e-3, 8e-3, 0.02e-3)
    for location in LOCATIONS:
        both = []
        for stroke in (history, loaded(runs[STEPPED])):
            index, upper = _at_location(stroke, location), stroke["skin_y"].values > 0
            at, pressure = profile(stroke, index)
            both.append(np.interp(x, at[upper], pressure[upper]))
        found[f"{location:g} mm"] = lag(x, both[0], x, both[1])
    return found


def _lag(stroke: xr.Dataset, runs: Histories) -> tuple[float, float]:
    """Lag (m) of the centre pressure of a stroke behind that of the stepped surface, and their
    correlation when shifted.
    """
    stepped = loaded(runs[STEPPED])
    return lag(
        distance(stroke),
        features.centre_pressure(stroke),
        distance(stepped),
        features.centre_pressure(stepped),
    )


@stroked("%", named([FULL["1"]]), beside=True)
def spread_of_traces(history, runs):
    """Standard deviation of whole traces over the velocities, root mean square, over the mean
    square root of the traces.
    """
    strokes, found = [loaded(runs[name]) for name in FULL.values()], {}
    for label, trace in (
        ("pressure", features.centre_pressure),
        ("energy", energy_at(RECEPTOR_DEPTH)),
    ):
        d = distance(strokes[0])
        traces = np.array([np.interp(d, distance(s), trace(s)) for s in strokes])
        found[label] = 100 * np.sqrt(np.mean(traces.std(axis=0) ** 2) / np.mean(traces**2))
    return found


# --- strain energy --------------------------------------------------------------------------------


@stroked("Pa", in_full)
def late_energy(stroke):
    """Largest strain energy at 560 um from 40 mm on."""
    return energy(stroke, SHALLOW)[distance(stroke) >= 40e-3 - 1e-9].max()


def peaks_apart(d: np.ndarray, values: np.ndarray, least: np.ndarray | float) -> float:
    """Distance between the two most prominent peaks of a trace, each at least as prominent as the
    `least` at its place; NaN with fewer.
    """
    from scipy.signal import find_peaks  # here, for it is slow to import

    # of two as high as each other the first would not end at the second
    tilted = values + 1e-6 * np.arange(len(values))
    found, properties = find_peaks(tilted, prominence=1e-3)
    prominences = properties["prominences"]
    stands_out = prominences >= np.broadcast_to(least, values.shape)[found]
    found, prominences = found[stands_out], prominences[stands_out]
    if len(found) < 2:
        return float("nan")
    first, second = sorted(found[np.argsort(prominences)[-2:]])
    return float(d[second] - d[first])


@stroked("mm", in_full)
def energy_peaks_apart(stroke):
    """From one of the two peaks of the strain energy at 560 um to the other, as Fig 5-24 draws it;
    NaN where there are not two.
    """
    values, d = energy(stroke, SHALLOW), 1e3 * distance(stroke)
    return {
        k: peaks_apart(d[where], values[where], PROMINENCE * values[where].max())
        for k, where in _passages(stroke).items()
        if where.any()
    }


@stroked("mm", in_full, beside=True)
def rate_peaks_apart(stroke, runs):
    """From one of the two peaks of the histogram of Fig 5-23 to the other; NaN where there are not
    two that are more than chance.
    """
    rate, impulses = impulses_of(stroke, SHALLOW, law_at(runs, SHALLOW)[0])
    bars = stroke_histogram(rate, impulses)
    middles, counts = bars[DISTANCE].to_numpy(), bars[COUNT].to_numpy()
    found = {}
    for label, (start, end) in passages(stroke).items():
        inside = (middles >= 1e3 * start) & (middles < 1e3 * end)
        n = counts[inside]
        found[label] = peaks_apart(middles[inside], n, CHANCE * np.sqrt(n))
    return found


_stroke_laws = kept(stroke_laws)


def _by_eq_4_4(history: xr.Dataset, runs: Histories) -> tuple[np.ndarray, np.ndarray]:
    """Strain energy (time) Pa at 915 um as simulated and by Eq 4-4 with a constant shift of the
    receptor.
    """
    law, shift = _stroke_laws(runs)[SED_LAW]
    s = skin_sample(history, RECEPTOR_DEPTH)
    return s.energy, s.by(law, shift)


@measure("1", in_full, beside=True)
def departure_of_eq_4_4(history, runs):
    """Residual of Eq 4-4 over the strain energy, and the share of variance it explains, at all
    outputs.
    """
    felt, by_law = _by_eq_4_4(history, runs)
    return {"residual": rms(by_law - felt) / rms(felt), "R2": r_squared(felt, by_law)}


# --- predicted rates ------------------------------------------------------------------------------


@stroked("impulses/s", named([FULL["10"]]))
def histogram_bin(history):
    """Highest bin of the histogram of 12 strokes, Fig 5-19."""
    return stroke_histogram(*impulses_of(history))[IMPULSE_RATE].max()


@stroked("impulses/s", in_full, beside=True)
def highest_frequency(history, runs):
    """Highest bin of the histogram of a receptor at 560 um from 40 mm on, Fig 5-23."""
    bars = stroke_histogram(*impulses_of(history, SHALLOW, law_at(runs, SHALLOW)[0]))
    return bars.loc[bars[DISTANCE] >= 40, IMPULSE_RATE].max()


def _impulses(
    stroke: xr.Dataset, where: Mapping[str, np.ndarray], column: str = IMPULSE_RATE
) -> dict[str, float]:
    """Mean numbers of impulses while conditions (time) hold at both ends of a step."""
    frame = predicted_rate(stroke)
    steps = np.diff(integrated(frame[TIME], frame[column]))
    return {k: float(steps[w[1:] & w[:-1]].sum()) for k, w in where.items()}


def _passages(stroke: xr.Dataset) -> dict[str, np.ndarray]:
    return {k: passing(stroke, arc) for k, arc in convexities(stroke).items()}


def _at_560_um(column: str) -> Callable[..., dict[str, float]]:
    return lambda h, runs: burst_values(h, column, SHALLOW, law_at(runs, SHALLOW)[0])


def _in_hollows(stroke: xr.Dataset, under: Callable[[xr.Dataset], np.ndarray]) -> dict[str, float]:
    """Mean number of impulses of the strokes that Fig 5-1 shows while each hollow is over the
    receptor, which is `under` (time) m of the surface.
    """
    _, impulses = impulses_of(stroke)
    shown = impulses.loc[impulses["trial"] <= STROKES_SHOWN["5-1"], DISTANCE].to_numpy() * 1e-3
    at = np.interp(shown, distance(stroke), under(stroke))
    labels, hollows = list(convexities(stroke)), [a for a in arcs(stroke) if a.curvature < 0]
    return {
        f"{a} to {b}": np.sum((at >= arc.start) & (at < arc.end)) / STROKES_SHOWN["5-1"]
        for a, b, arc in zip(labels, labels[1:], hollows, strict=False)
    }


@stroked("%", in_full)
def dynamic_share(stroke):
    """Share of the impulses of each convexity that comes from the rate of the strain energy."""
    where = _passages(stroke)
    whole, part = _impulses(stroke, where), _impulses(stroke, where, DYNAMIC)
    return {k: 100 * part[k] / max(whole[k], 1e-12) for k in where}


@stroked("mm", in_full)
def rate_after_energy_rate(stroke):
    """Stroke distance from the bin that holds the peak of the energy's rate to the highest bin of
    the histogram of Fig 5-19, while each convexity passes; NaN without an impulse.
    """
    frame, impulses = impulses_of(stroke)
    bars, apart = stroke_histogram(frame, impulses), {}
    for label, (start, end) in passages(stroke).items():
        part, inside = (
            each[each[DISTANCE].between(1e3 * start, 1e3 * end)] for each in (frame, bars)
        )
        felt = part[DISTANCE].loc[part[RATE].idxmax()]
        answered = inside[DISTANCE].loc[inside[COUNT].idxmax()] if inside[COUNT].any() else np.nan
        apart[label] = answered - bars[DISTANCE].iloc[int(abs(bars[DISTANCE] - felt).argmin())]
    return apart


# --- strokes of a plate, and ridges ---------------------------------------------------------------


def _settled(stroke: xr.Dataset) -> np.ndarray:
    """Outputs (time) at which the start of a plate's stroke is over. Raises KeyError for a shorter
    one.
    """
    late = abs(distance(stroke)) >= SETTLED
    if not late.any():
        raise KeyError(f"stroke of {SETTLED * 1e3:g} mm")
    return late


def _three(stroke: xr.Dataset) -> dict[str, np.ndarray]:
    """Strain energy (time) Pa at the thesis's three receptors."""
    return {k: energy(stroke, DEPTH, x) for k, x in OFFSETS.items()}


@stroked("%", plates)
def spread_of_three(stroke):
    """Largest range of the three receptors over their mean, once the stroke is settled."""
    late = _settled(stroke)
    values = [v[late] for v in _three(stroke).values()]
    return 100 * np.max(np.ptp(values, axis=0) / np.mean(values, axis=0))


@stroked("Pa", plates)
def energy_beside(stroke):
    """Strain energy at -46 um: the highest at the start of the stroke, the highest and the least
    once it is settled.
    """
    settled, values = _settled(stroke), energy(stroke, DEPTH, -BESIDE)
    return {
        "start": values[~settled].max(),
        "highest late": values[settled].max(),
        "least late": values[settled].min(),
    }


@measure("count", plates)
def islands_of_contact(history):
    """Once the stroke is settled: the fewest, the most, and the most at the end."""
    found = islands(history)
    late = found[_settled(history)]
    return {"fewest": late.min(), "most": late.max(), "median": np.median(late), "end": found[-1]}


@stroked("impulses", plates)
def plate_impulses(history):
    """Mean number of impulses of a receptor 46 um to the right, in the whole stroke and at its
    beginning.
    """
    rate = plate_rate(history)
    grown = integrated(rate[TIME], rate[IMPULSE_RATE])
    return {"whole": grown[-1], "beginning": np.interp(BEGINNING, rate[DISTANCE], grown)}


CONVEXITIES = (
    # stroke distance over which the centre node touches
    Stroke(
        "contact_length", "mm", lambda h: {k: 1e3 * v for k, v in contact_lengths(h).items()}, wavy
    ),
    # largest value at the centre, and 915 um under it, while the convexity passes
    Stroke("convexity_pressure", "Pa", lambda h: peaks(h, features.centre_pressure), wavy),
    Stroke("convexity_energy", "Pa", lambda h: peaks(h, energy_at(RECEPTOR_DEPTH)), wavy),
    *(
        Stroke(name, unit, lambda h, column=column: burst_values(h, column), waves)
        for name, unit, column in (
            ("burst_width", "mm", BURST_WIDTH),
            ("burst_time", "s", BURST_TIME),
            ("burst_rate", "impulses/s", BURST_RATE),
            ("burst_strokes", "count", BURST_STROKES),
            ("energy_time", "s", TIME_ABOVE),
            ("convexity_rate", "impulses/s", f"largest {IMPULSE_RATE}"),
            ("convexity_energy_rate", "Pa/s", f"largest {RATE}"),
        )
    ),
    # 560 um deep: impulses of a stroke, and how many strokes of Fig 5-22 are two bursts
    Stroke("impulses_at_560_um", "impulses", _at_560_um(BURST_IMPULSES), in_full, beside=True),
    Stroke("double_bursts", "count", _at_560_um(DOUBLE), in_full, beside=True),
    # impulses of a stroke at the distances of each hollow, and while it is over the centre of the
    # skin, which is dragged back
    Stroke("impulses_in_hollows", "impulses", lambda h: _in_hollows(h, distance), in_full),
    Stroke("impulses_under_hollows", "impulses", lambda h: _in_hollows(h, place), in_full),
)

TRACES = (
    Stroke("curvature_factor", "Pa m", lambda h: _scaled_curvature(h)[1], wavy),
    # of the centre pressure behind that of the stepped surface, and their correlation when shifted
    Stroke(
        "profile_shift",
        "mm",
        lambda h, runs: {k: -1e3 * s for k, (s, _) in _shifted_profiles(h, runs).items()},
        only_ten,
        beside=True,
    ),
    Stroke(
        "profile_likeness",
        "1",
        lambda h, runs: {k: r for k, (_, r) in _shifted_profiles(h, runs).items()},
        only_ten,
        beside=True,
    ),
    Stroke("lag_of_stepped", "mm", lambda h, runs: 1e3 * _lag(h, runs)[0], only_ten, beside=True),
    Stroke("likeness_of_stepped", "1", lambda h, runs: _lag(h, runs)[1], only_ten, beside=True),
    Stroke(
        "energy_by_eq_4_4", "Pa", lambda h, runs: _by_eq_4_4(h, runs)[1].max(), in_full, beside=True
    ),
    # the constant shift with which Eq 4-4 comes closest to the stroke at 10 mm/s
    Stroke(
        "receptor_shift",
        "mm",
        lambda h, runs: 1e3 * _stroke_laws(runs)[SED_LAW][1],
        named([FULL["10"]]),
        beside=True,
    ),
)

PLATES = (
    Stroke("receptors_in_three_places", "count", lambda h: len(_three(h)), plates),
    Measure("direction", "1", lambda h: directional_index(h, DEPTH, -BESIDE), plates),
    Stroke("highest_of_three", "Pa", lambda h: max(v.max() for v in _three(h).values()), plates),
    Measure("steps_cut", "count", lambda h: h["cutbacks"].sum(), plates),
    Measure("smallest_volume", "1", lambda h: h["min_detF"].min(), plates),
)

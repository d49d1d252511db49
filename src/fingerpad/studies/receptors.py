"""The thesis's laws from skin to impulses: fitted to simulated histories, carried over to others, compared with rates.

Everything is read from cached histories. Three tables: the constants of the laws with intervals and what they leave over,
candidate stimuli as predictors of the rates at hand, and a tactile sensor that knows the contact pressure only against the full
model.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import PchipInterpolator

from fingerpad.figures.columns import NODE, TIME, P
from fingerpad.figures.features import SURFACES, energy, force_gf, ramp_end, scene_name
from fingerpad.figures.responses import (
    CANDIDATES,
    IMPULSE_RATE,
    LAW_ROWS,
    RECEPTOR_DEPTH,
    contact_nodes,
    curvature_of,
    is_stroke,
    predicted_rate,
    rapidly_adapting_rate,
    skin_sample,
    skin_shift,
    stimulus,
    terms_of,
    time_mean,
)
from fingerpad.receptors.fits import (
    GainAndThreshold,
    constant_shift,
    gain_and_threshold,
    jackknife,
    leave_one_out,
    linear,
    r_squared,
    spatial_sum,
)
from fingerpad.receptors.laws import NODE_TERMS, TERM_UNITS, THESIS_RATE, ImpulseRate, SpatialSum
from fingerpad.receptors.rapidly_adapting import RapidlyAdapting
from fingerpad.receptors.sensor import TactileSensor, taxel_pressure
from fingerpad.receptors.spikes import integrated

Histories = Mapping[str, xr.Dataset]

DEPTHS = tuple(d * 1e-6 for d in (560, 600, 640, 765, 800, 845, 870, 915, 960))
"""m; receptor depths of Fig 4-24."""

NODE_SURFACE, NODE_COUNT = "210", 12
"""Surface and number of nodes that Fig 4-17 shows."""

FIT_COLUMNS = (
    "law", "scenes", "receptor_depth (um)", "quantity", "estimate", "low_95", "high_95", "units", "residual_rms",
    "residual_units", "r_squared", "samples", "discretisation (%)", "note",
)  # fmt: skip

BEST_DEPTH = "best of those simulated"

PITCHES = (0.5e-3, 1.0e-3)
"""m; spacings of sensor arrays."""


def rms(values) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def pressed(histories: Histories, programme: str = "ramp40") -> dict[str, xr.Dataset]:
    """Histories of the nine surfaces in a force programme, by label, as far as they are there."""
    names = {label: scene_name(programme, label) for label in SURFACES}
    return {label: histories[name] for label, name in names.items() if name in histories}


def strokes(histories: Histories) -> dict[str, xr.Dataset]:
    """Histories of strokes over the wavy surface, by scene, slowest first."""
    found = {name: histories[name] for name in histories if name.startswith("stroke_") and name.split("_")[-1].isdigit()}
    return dict(sorted(found.items(), key=lambda item: (item[0].count("_"), int(item[0].split("_")[-1]))))


# -- constants of the laws -----------------------------------------------------------------------------------------------


def receptor_fits(histories: Histories, coarse: Histories, rates: pd.DataFrame) -> pd.DataFrame:
    """Every constant of Eqs 4-1 to 5-1, its interval, what the law leaves over, and where it breaks.

    Args:
        histories, coarse: scenes and their companions, of which those of the nine surfaces, of strokes and of lower forces are
        read. rates: of `fingerpad.receptors.recordings.read_rates`.

    Returns:
        Columns `FIT_COLUMNS`. Intervals are jackknife intervals over surfaces (Eq 4-1: over nodes, rates: over rates);
        "discretisation" is by how much the estimate differs when fitted to the companions.
    """
    table = pd.DataFrame([*_simulated_laws(histories, intervals=True), *_rate_law(histories, rates)], columns=FIT_COLUMNS)
    if len(pressed(coarse)) == len(pressed(histories)) > 1:
        rough = pd.DataFrame(_simulated_laws(coarse, intervals=False))
        key = ["law", "scenes", "receptor_depth (um)", "quantity"]
        matched = table[key].merge(rough.drop_duplicates(key)[[*key, "estimate"]], on=key, how="left")["estimate"].to_numpy(float)
        off = 100 * np.abs(matched / table["estimate"].to_numpy(float) - 1)
        table["discretisation (%)"] = np.where(table["units"] == "%", np.nan, off)
    return table


def _simulated_laws(histories: Histories, intervals: bool) -> Iterator[dict]:
    surfaces = pressed(histories)
    yield from _node_laws(surfaces, intervals)
    yield from _sums(histories, surfaces, intervals)


def _rows(law, scenes, names, units, found, data, predicted, residual_units, note="", depth=np.nan) -> Iterator[dict]:
    """One row a constant; what the law leaves over and the note stand in the first."""
    for k, (name, unit) in enumerate(zip(names, units, strict=True)):
        row = {"law": law, "scenes": scenes, "receptor_depth (um)": depth, "quantity": name, "units": unit}
        row |= dict(zip(("estimate", "low_95", "high_95"), found[k], strict=True))
        if k == 0:
            left = {"residual_rms": rms(data - predicted), "residual_units": residual_units, "samples": len(data)}
            row |= left | {"r_squared": r_squared(data, predicted), "note": note}
        yield row


def _number(law, scenes, quantity, value, units, note="", depth=np.nan, low=np.nan, high=np.nan) -> dict:
    return {
        "law": law, "scenes": scenes, "receptor_depth (um)": depth, "quantity": quantity, "estimate": value, "low_95": low,
        "high_95": high, "units": units, "note": note,
    }  # fmt: skip


def fit_nodes(law: str, nodes: pd.DataFrame) -> np.ndarray:
    """Constants of Eq 4-1, 4-2 or 4-3 closest to the pressures of the rows of `contact_nodes` that it speaks of."""
    spoken_of = nodes[LAW_ROWS[law](nodes)]
    return linear(terms_of(law, spoken_of), spoken_of[P].to_numpy())


def _fit_groups(law: str, groups: Sequence[pd.DataFrame], intervals: bool) -> np.ndarray:
    """Estimates (p, 3) with low and high, which are not a number without intervals."""

    def fitted(chosen):
        return fit_nodes(law, pd.concat(chosen))

    return jackknife(fitted, groups) if intervals else np.column_stack([fitted(groups), *[[np.nan] * len(NODE_TERMS[law])] * 2])


def _node_laws(surfaces: dict[str, xr.Dataset], intervals: bool) -> Iterator[dict]:
    names = {law: [f"A{k + 1}, {term}" for k, term in enumerate(terms)] for law, terms in NODE_TERMS.items()}
    units = {law: [TERM_UNITS[term] for term in terms] for law, terms in NODE_TERMS.items()}
    if NODE_SURFACE in surfaces:
        nodes = contact_nodes(surfaces[NODE_SURFACE], NODE_COUNT)
        groups = [group for _, group in nodes.groupby(NODE)]
        where = f"{scene_name('ramp40', NODE_SURFACE)}, {len(groups)} nodes"
        for law in ("4-1", "4-1 read without an exponent"):
            found = _fit_groups(law, groups, intervals)
            used = nodes[LAW_ROWS[law](nodes)]
            note = "one set for all nodes, each from its peak on; intervals over nodes"
            yield from _rows(law, where, names[law], units[law], found, used[P], terms_of(law, used) @ found[:, 0], "Pa", note)
            alone = np.array([fit_nodes(law, group) for group in groups])
            shares = [
                r_squared(u[P], terms_of(law, u) @ c) for u, c in zip((g[LAW_ROWS[law](g)] for g in groups), alone, strict=True)
            ]
            for k, name in enumerate(names[law]):
                note = f"median and range over nodes, not an interval; R2 of the nodes {min(shares):.3f} to {max(shares):.3f}"
                low, high = alone[:, k].min(), alone[:, k].max()
                middle = float(np.median(alone[:, k]))
                yield _number(
                    f"{law}, a set for each node", where, name, middle, units[law][k], note * (k == 0), low=low, high=high
                )
    if len(surfaces) < 2:
        return
    by_surface = {label: contact_nodes(history) for label, history in surfaces.items()}
    where = f"ramp40, {len(surfaces)} surfaces"
    for law in ("4-2", "4-3"):
        found = _fit_groups(law, list(by_surface.values()), intervals)
        used = {label: nodes[LAW_ROWS[law](nodes)] for label, nodes in by_surface.items()}
        together = pd.concat(used.values())
        note = "intervals over surfaces; " + (
            "all nodes in contact up to the top of the ramp" if law == "4-2" else "each node from its peak on"
        )
        yield from _rows(
            law, where, names[law], units[law], found, together[P], terms_of(law, together) @ found[:, 0], "Pa", note
        )
        for label, rows in used.items():
            inside = rms(rows[P] - terms_of(law, rows) @ found[:, 0]) / rms(rows[P])
            others = fit_nodes(law, pd.concat([nodes for other, nodes in by_surface.items() if other != label]))
            outside = rms(rows[P] - terms_of(law, rows) @ others) / rms(rows[P])
            note = f"{100 * outside:.1f} % when fitted to the other surfaces"
            yield _number(law, where, f"residual over the pressure, K = {label}", 100 * inside, "%", note)


def fit_sum(histories: Iterable[xr.Dataset], depth: float, with_depth: bool = True) -> SpatialSum:
    """Eq 4-4 closest to the strain energy at a depth (m) under the centre of pressed surfaces."""
    return spatial_sum([skin_sample(history, depth) for history in histories], with_depth)


def _sum_values(law: SpatialSum, with_depth: bool) -> np.ndarray:
    return np.array([law.r * 1e3, law.per_depth, law.constant] if with_depth else [law.r * 1e3, law.constant])


def _sums(histories: Histories, surfaces: dict[str, xr.Dataset], intervals: bool) -> Iterator[dict]:
    if len(surfaces) < 2:
        return
    where = f"ramp40, {len(surfaces)} surfaces"
    for depth, with_depth in [*((z, True) for z in DEPTHS), (RECEPTOR_DEPTH, False)]:
        samples = [skin_sample(history, depth) for history in surfaces.values()]

        def fitted(chosen, with_depth=with_depth):
            return _sum_values(spatial_sum(chosen, with_depth), with_depth)

        law = spatial_sum(samples, with_depth)
        found = _sum_values(law, with_depth)
        found = jackknife(fitted, samples) if intervals else np.column_stack([found, *[[np.nan] * len(found)] * 2])
        parts = [(s.energy, law.strain_energy(s.x, s.pressure, s.indentation)) for s in samples]
        data, predicted = (np.concatenate(side) for side in zip(*parts, strict=True))
        title = "4-4" if with_depth else "4-4 without depth of indentation"
        names, units = ["r", "A1", "A2"], ["mm", "1/m2", "1/m"]
        if not with_depth:
            names, units = ["r", "A2"], ["mm", "1/m"]
        yield from _rows(title, where, names, units, found, data, predicted, "Pa", "intervals over surfaces", depth * 1e6)
        if abs(depth - RECEPTOR_DEPTH) > 1e-9:
            continue
        for label, (own, other) in zip(surfaces, parts, strict=True):
            yield _number(
                title, where, f"residual over the energy, K = {label}", 100 * rms(own - other) / rms(own), "%", depth=depth * 1e6
            )
        if with_depth:
            yield from _transferred(law, histories, depth)


def _transferred(law: SpatialSum, histories: Histories, depth: float) -> Iterator[dict]:
    """How the sum fitted to the slow ramps does on what it was not fitted to: fast ramps, and strokes with four shifts."""
    um, title = depth * 1e6, "4-4, constants of ramp40"
    fast = [skin_sample(history, depth) for history in pressed(histories, "ramp150").values()]
    if fast:
        own = np.concatenate([s.energy for s in fast])
        other = np.concatenate([law.strain_energy(s.x, s.pressure, s.indentation) for s in fast])
        row = _number(
            title, f"ramp150, {len(fast)} surfaces", "residual over the energy", 100 * rms(own - other) / rms(own), "%", depth=um
        )
        yield row | {
            "r_squared": r_squared(own, other),
            "samples": len(own),
            "residual_rms": rms(own - other),
            "residual_units": "Pa",
        }
    moving = {name: history for name, history in strokes(histories).items() if "sub" not in name}
    if not moving:
        return
    chosen = "stroke_10" if "stroke_10" in moving else next(iter(moving))
    shift = constant_shift(law, skin_sample(moving[chosen], depth))
    yield _number(
        title, chosen, "constant lateral shift", shift * 1e3, "mm", "closest to this stroke, then kept for every velocity", um
    )
    yield _refitted(histories[chosen], chosen, depth)
    for name, history in moving.items():
        sample, skin = skin_sample(history, depth), skin_shift(history)
        shifts = {"no shift": 0.0, "constant shift": shift, "the skin's shift": skin}
        share = _share_of_skin(law, sample, skin)
        shifts[f"{share:.2f} of the skin's shift"] = share * skin
        for how, value in shifts.items():
            predicted = law.strain_energy(sample.x, sample.pressure, sample.indentation, value)
            left = rms(sample.energy - predicted)
            quantity = f"residual over the energy, {how}"
            if "of the skin" in how and how != "the skin's shift":
                quantity = "residual over the energy, a share of the skin's shift"
            row = _number(title, name, quantity, 100 * left / rms(sample.energy), "%", how if how not in quantity else "", um)
            row |= {"residual_rms": left, "residual_units": "Pa", "samples": len(predicted)}
            yield row | {"r_squared": r_squared(sample.energy, predicted)}


def _refitted(history: xr.Dataset, scene: str, depth: float) -> dict:
    """What is left when all constants of Eq 4-4 and a constant shift are fitted to a stroke itself: what its form cannot do."""
    best = None
    for shift in np.arange(-1.2e-3, 0.5e-3, 0.1e-3):
        sample = skin_sample(history, depth, shift)
        law = spatial_sum([sample])
        predicted = law.strain_energy(sample.x, sample.pressure, sample.indentation, shift)
        if best is None or rms(predicted - sample.energy) < rms(best[0] - sample.energy):
            best = predicted, law, shift
    predicted, law, shift = best
    note = f"r {law.r * 1e3:.3g} mm, A1 {law.per_depth:.3g} 1/m2, A2 {law.constant:.3g} 1/m, shift {shift * 1e3:.2g} mm"
    left = rms(predicted - sample.energy)
    row = _number(
        "4-4, fitted to the stroke", scene, "residual over the energy", 100 * left / rms(sample.energy), "%", note, depth * 1e6
    )
    return row | {
        "residual_rms": left,
        "residual_units": "Pa",
        "samples": len(predicted),
        "r_squared": r_squared(sample.energy, predicted),
    }


def _share_of_skin(law: SpatialSum, sample, skin: np.ndarray) -> float:
    """The share of the skin's lateral displacement with which the law comes closest to a stroke, to a hundredth."""
    shares = np.arange(0, 1.505, 0.01)
    left = [
        rms(law.strain_energy(sample.x, sample.pressure, sample.indentation, share * skin) - sample.energy) for share in shares
    ]
    return float(shares[int(np.argmin(left))])


# -- impulse rates -------------------------------------------------------------------------------------------------------


def _rate_law(histories: Histories, rates: pd.DataFrame) -> Iterator[dict]:
    """Eq 5-1 with the thesis's constants against the rates at hand, and what its constants become when fitted to them."""
    stated = ((THESIS_RATE.per_energy, "A1", "(impulses/s)/Pa"), (THESIS_RATE.per_rate, "A2", "impulses/Pa"))
    stated += (
        (THESIS_RATE.threshold, "threshold of the energy", "Pa"),
        (THESIS_RATE.rate_threshold, "threshold of the rate", "Pa/s"),
    )
    for value, name, unit in stated:
        yield _number(
            "5-1, thesis's constants",
            "pressed and stroked",
            name,
            value,
            unit,
            "stated, Figs 5-20 and 5-21",
            RECEPTOR_DEPTH * 1e6,
        )
    for title, group in rate_sets(rates[rates["receptor"] == "SA-I"]):
        matched = matched_histories(histories, group)
        if matched is None:
            yield _number("5-1, thesis's constants", title, "not compared", np.nan, "", "fewer than four surfaces at its force")
            continue
        readings = [rate_fit(matched, group, curvature) for curvature in assignments(group)]
        data = group["rate_per_s"].to_numpy(float)
        about = f"{len(data)} rates; {_kind(group)}"
        for law, names in RATE_FITS.items():
            constants, predicted = readings[0][law]
            shares = [r_squared(data, reading[law][1]) for reading in readings]
            note = about
            if len(readings) > 1:
                note += (
                    f"; R2 {min(shares):.2f} to {max(shares):.2f} over {len(readings)} ways to read which surface a rate is of"
                )
            for k, (name, unit) in enumerate(names.items()):
                value, low, high = constants[k]
                row = _number(law, title, name, value, unit, note * (k == 0), RECEPTOR_DEPTH * 1e6, low, high)
                left = {"residual_rms": rms(data - predicted), "residual_units": "impulses/s", "samples": len(data)}
                yield row | left | {"r_squared": shares[0]} if k == 0 else row


RATE_FITS = {
    "5-1, thesis's constants": {"mean of predicted less given": "impulses/s"},
    "5-1, A1 and threshold fitted": {"A1": "(impulses/s)/Pa", "threshold of the energy": "Pa"},
    "5-1, times a factor, plus A3 of Eq 4-5": {"factor": "1", "A3": "impulses/s"},
}
"""Ways to ask rates of Eq 5-1 -> what each tells, and units."""


def rate_sets(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Rates that one set of constants may be asked to predict: of one recording, then of all recordings of one source.

    Pressed surfaces only; a window at a time; three rates at least.
    """
    still = rates[rates["speed_mm_per_s"] == 0]
    for (source, window), group in still.groupby(["source", "window"], sort=False):
        recordings = list(group.groupby("recording", sort=False))
        for recording, part in recordings:
            if len(part) >= 3:
                yield f"{recording}, {window}", part
        if len(recordings) > 1 and group["species"].iloc[0] != "model":
            yield f"{source.split(',')[0]} and others, {group['force_gf'].nunique()} forces, {window}", group


def assignments(group: pd.DataFrame) -> list[np.ndarray]:
    """Curvatures (n,) 1/m in every reading of rates whose surface is one of two; a surface has one rate, and rates rise with
    curvature."""
    first, other = group["curvature_per_m"].to_numpy(float), group["or_curvature_per_m"].to_numpy(float)
    if np.isnan(other).all():
        return [first]
    options = [(a,) if np.isnan(b) else (a, b) for a, b in zip(first, other, strict=True)]
    order = np.argsort(group["rate_per_s"].to_numpy(), kind="stable")
    read = [np.array(choice) for choice in itertools.product(*options)]
    return [choice for choice in read if (np.diff(choice[order]) > 0).all()]


def matched_histories(histories: Histories, group: pd.DataFrame) -> dict[float, list[xr.Dataset]] | None:
    """Histories of pressed surfaces for every force (gf) of a set of rates, by rising curvature; None if a force has fewer than
    four.

    Of several force rates the recording's is taken, else 40 gf/s.
    """
    found = {}
    for force, rows in group.groupby("force_gf"):
        ramp = rows["ramp_gf_per_s"].iloc[0]
        programmes = [f"ramp{ramp:g}", f"press{force:g}"] if ramp == ramp else ["ramp40", f"press{force:g}"]
        for programme in programmes:
            chosen = [h for h in pressed(histories, programme).values() if abs(float(force_gf(h)[-1]) / force - 1) < 0.01]
            if len(chosen) >= 4:
                found[force] = sorted(chosen, key=curvature_of)
                break
        else:
            return None
    return found


def windowed(history: xr.Dataset, time, values, window: str) -> float:
    """A trace's number for a window of `fingerpad.receptors.recordings.WINDOWS`; "steady" is the last half of the hold."""
    time, values = np.asarray(time), np.asarray(values)
    top, end = float(history["time"].values[ramp_end(history)]), float(history["time"].values[-1])
    if window == "peak":
        return float(values.max())
    start, stop = {"hold": (top, end), "steady": ((top + end) / 2, end), "first second": (0.0, 1.0), "first 200 ms": (0.0, 0.2)}[
        window
    ]
    return time_mean(time, values, start, min(stop, end))


def across(matched: Mapping[float, Sequence[xr.Dataset]], group: pd.DataFrame, curvature: np.ndarray, number) -> np.ndarray:
    """Numbers (n,) at the forces and curvatures of some rates: between simulated surfaces by a monotone cubic over curvature.

    number: history, window -> value.
    """
    out = np.empty(len(group))
    force, windows = group["force_gf"].to_numpy(), group["window"].to_numpy()
    for f, window in dict.fromkeys(zip(force, windows, strict=True)):
        curve = PchipInterpolator([curvature_of(h) for h in matched[f]], [number(h, window) for h in matched[f]])
        rows = (force == f) & (windows == window)
        out[rows] = curve(np.minimum(curvature[rows], curve.x[-1]))
    return out


def rate_fit(matched, group: pd.DataFrame, curvature: np.ndarray) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Every way of :data:`RATE_FITS` -> what it tells, with intervals over rates (k, 3), and the rates (n,) it predicts.

    curvature: (n,) 1/m, one reading of which surface each rate is of.
    """
    data = group["rate_per_s"].to_numpy(float)

    def by(law: ImpulseRate) -> np.ndarray:
        def number(history, window):
            frame = predicted_rate(history, RECEPTOR_DEPTH, law)
            return windowed(history, frame[TIME], frame[IMPULSE_RATE], window)

        return across(matched, group, curvature, number)

    def mean_energy(history, window):
        return windowed(history, history["time"].values, energy(history, RECEPTOR_DEPTH), window)

    thesis, held = by(THESIS_RATE), across(matched, group, curvature, mean_energy)
    dynamic = thesis - by(THESIS_RATE.without_rate())

    def factor(rows):
        return linear(np.column_stack([thesis[rows], np.ones(len(rows))]), data[rows])

    def static(rows):  # of the energy's mean: as good as the mean of the law while the energy does not cross the threshold
        law = gain_and_threshold(held[rows], (data - dynamic)[rows])
        return np.array([law.gain, law.threshold])

    rows = list(range(len(data)))
    constants = [jackknife(of, rows) for of in (lambda rows: [np.mean((thesis - data)[rows])], static, factor)]
    predicted = thesis, GainAndThreshold(*constants[1][:, 0])(held) + dynamic, constants[2][:, 0] @ [thesis, np.ones(len(data))]
    return dict(zip(RATE_FITS, zip(constants, predicted, strict=True), strict=True))


# -- candidate stimuli ---------------------------------------------------------------------------------------------------


def candidate_stimuli(histories: Histories, rates: pd.DataFrame) -> pd.DataFrame:
    """Candidate stimuli as predictors of the rates at hand, each with a gain and a threshold, best first within a set of rates.

    Every candidate is averaged over the window the rates are of. Those under the skin are taken at 915 um, where the thesis
    predicts from, and then at the best of the simulated depths, which is a third constant. "curvature" and "inverse contact
    width" need no receptor and show what little a good R2 takes.

    Returns:
        One row a set of rates, candidate and depth: gain, threshold, R2, root-mean-square error of the curvatures left out one by
        one, and the rank by that error among candidates at 915 um. Where a surface is uncertain R2 has the range of all readings.
        The last columns need no rates: what is left at the end of the hold of what was there at its beginning, least and most
        of the nine surfaces at 40 gf/s. The recorded rates fall.
    """
    rows, surfaces = [], pressed(histories)
    for title, group in rate_sets(rates[rates["receptor"] == "SA-I"]):
        matched = matched_histories(histories, group)
        if matched is None:
            continue
        choices = assignments(group)
        of_set = [
            {"rates": title, "kind": _kind(group), "candidate": name} | row | _held(surfaces, name, row["receptor_depth (um)"])
            for name, unit, depths, number in _candidates()
            for row in _judged(matched, group, choices, unit, depths and _common_depths(matched), number)
        ]
        frame = pd.DataFrame(of_set)
        error, third = frame["left_out_rms (impulses/s)"], frame["depth"] == BEST_DEPTH
        frame["rank"] = error[~third].rank(method="min")
        rows.append(frame.iloc[np.lexsort((error, third))])
    return pd.concat(rows, ignore_index=True) if rows else pd.DataFrame()


def _held(surfaces: Mapping[str, xr.Dataset], name: str, depth: float) -> dict[str, float]:
    """Least and largest share of a candidate, over surfaces, that is left at the end of the hold; depth: um."""
    if name not in CANDIDATES or not surfaces:
        return {}
    left = [values[-1] / values[ramp_end(h)] for h in surfaces.values() for values in [stimulus(h, name, depth * 1e-6)]]
    return {"end of hold over its beginning, least": min(left), "end of hold over its beginning, most": max(left)}


def _kind(group: pd.DataFrame) -> str:
    stimuli = "/".join(dict.fromkeys(group["stimulus"]))
    return f"{'/'.join(dict.fromkeys(group['species']))}, {stimuli}; simulated: cylinders on a human pad"


def _candidates():
    """Name, unit, whether it is taken at a depth, and number of every candidate."""
    for name, (_, unit, deep) in CANDIDATES.items():

        def number(history, window, depth, name=name):
            return windowed(history, history["time"].values, stimulus(history, name, depth), window)

        yield name, unit, deep, number
    yield "curvature", "1/m", False, lambda history, window, depth: curvature_of(history)
    yield "inverse contact width", "1/m", False, _inverse_width


def _common_depths(matched: Mapping[float, Sequence[xr.Dataset]]) -> list[float]:
    """Receptor depths (m) under the centre that all histories have."""

    def depths(history):
        return {
            round(float(z), 7)
            for z, x in zip(history["receptor_depth"], history["receptor_offset"], strict=True)
            if abs(x) < 1e-7
        }

    return sorted(set.intersection(*(depths(history) for histories in matched.values() for history in histories)))


def _inverse_width(history, window, depth):
    """Inverse contact width, 1/m: over the hold, as in thesis Fig 4-9, since it has no bound at first touch; or the largest."""
    width = history["contact_width"].values
    touching = width > 0
    return windowed(history, history["time"].values[touching], 1 / width[touching], "hold" if window != "peak" else window)


def _judged(matched, group, choices, unit, depths, number) -> list[dict]:
    """Rows of one candidate; depths (m) to try, none if it is on the skin."""
    data = group["rate_per_s"].to_numpy(float)

    def judge(depth):
        out = []
        for curvature in choices:
            value = across(matched, group, curvature, _at(number, depth))
            law = gain_and_threshold(value, data)
            left_out = rms(data - leave_one_out(value, data, np.round(curvature)))
            out.append((left_out, r_squared(data, law(value)), law))
        return out

    tried = {depth: judge(depth) for depth in depths or [None]}
    chosen = [("at 915 um", min(depths, key=lambda z: abs(z - RECEPTOR_DEPTH)))] if depths else [("on the skin", None)]
    if len(tried) > 1:
        chosen.append((BEST_DEPTH, min(tried, key=lambda z: tried[z][0][0])))
    rows = []
    for how, depth in chosen:
        left_out, share, law = tried[depth][0]
        shares = [s for _, s, _ in tried[depth]]
        rows.append(
            {
                "depth": how,
                "receptor_depth (um)": np.nan if depth is None else depth * 1e6,
                "gain (impulses/s per unit)": law.gain,
                "threshold": law.threshold,
                "unit": unit,
                "r_squared": share,
                "r_squared_low": min(shares),
                "r_squared_high": max(shares),
                "left_out_rms (impulses/s)": left_out,
                "left_out_rms (% of the mean)": 100 * left_out / data.mean(),
                "rates used": len(data),
            }
        )
    return rows


def _at(number, depth):
    return lambda history, window: number(history, window, depth)


# -- a sensor that knows the pressure only ---------------------------------------------------------------------------------


def sensor_accuracy(histories: Histories) -> pd.DataFrame:
    """Impulse rates of the tactile sensor against those of the full model, Eq 5-1 on the simulated strain energy, scene by scene.

    The sensor's sum is fitted to the nine surfaces at 40 gf/s; all else is new to it. It is given the pressure at the pad's
    nodes where they are, with and without the depth of indentation, and the mean pressure on the faces of coarser arrays that
    stay in place.

    Returns:
        One row a scene and array: what the sensor knows, spacing, root-mean-square and largest error of the rate, both in
        impulses/s, the same over the full model's, and impulses of either over the scene.

    Raises:
        ValueError: no surface was pressed at 40 gf/s, so there is nothing to fit the sum to.
    """
    surfaces = pressed(histories)
    if not surfaces:
        raise ValueError("the sensor's constants are fitted to scenes ramp40_*; there is none among the histories")
    laws = {True: fit_sum(surfaces.values(), RECEPTOR_DEPTH), False: fit_sum(surfaces.values(), RECEPTOR_DEPTH, with_depth=False)}
    programmes = dict.fromkeys(name.split("_")[0] for name in histories if name.startswith(("ramp", "press")))
    chosen = {scene_name(p, label): history for p in programmes for label, history in pressed(histories, p).items()}
    chosen |= strokes(histories)
    shift = None
    if "stroke_10" in chosen:
        shift = constant_shift(laws[True], skin_sample(chosen["stroke_10"], RECEPTOR_DEPTH))
    rows = []
    for name, history in chosen.items():
        sample, time = skin_sample(history, RECEPTOR_DEPTH), history["time"].values
        full = predicted_rate(history)
        true = np.interp(time, full[TIME], full[IMPULSE_RATE])
        count = float(integrated(full[TIME], full[IMPULSE_RATE])[-1])
        arrays = [("pressure and indentation", None), ("pressure", None), *(("pressure", pitch) for pitch in PITCHES)]
        if is_stroke(history) and shift is not None:
            arrays.insert(0, ("pressure, indentation and shift", None))
        for knows, pitch in arrays:
            where = shift if "shift" in knows else 0.0
            rate = _sensed(sample, time, laws["indentation" in knows], "indentation" in knows, pitch, where)
            # the sensor's rate is that of the interval behind it
            middle = (time[1:] + time[:-1]) / 2
            own = np.interp(middle, full[TIME], full[IMPULSE_RATE])
            off = rate[1:] - own
            rows.append(
                {
                    "scene": name,
                    "knows": knows,
                    "spacing (mm)": 1e3 * (pitch or float(np.median(np.diff(sample.x[0])))),
                    "fitted to": "this and eight more" if name.startswith("ramp40") else "ramp40",
                    "rms_error (impulses/s)": _weighted_rms(off, time),
                    "rms_error (% of the rms rate)": 100 * _weighted_rms(off, time) / max(_weighted_rms(own, time), 1e-12),
                    "largest_error (impulses/s)": float(np.abs(off).max()),
                    "largest rate (impulses/s)": float(true.max()),
                    "impulses": float((rate[1:] * np.diff(time)).sum()),
                    "impulses of the full model": count,
                }
            )
    return pd.DataFrame(rows)


def _weighted_rms(values, time) -> float:
    """Root mean square over time of values (n - 1,) of the intervals between times (n,)."""
    return float(np.sqrt((values**2 * np.diff(time)).sum() / (time[-1] - time[0])))


def _sensed(sample, time, law: SpatialSum, with_depth: bool, pitch: float | None, shift: float) -> np.ndarray:
    """Rates (time) of a sensor at the pad's nodes (they move: a new sensor a frame would be one), or of an array of a pitch
    (m)."""
    if pitch is None:
        energy = law.strain_energy(sample.x, sample.pressure, sample.indentation if with_depth else 0.0, shift)
        change = np.concatenate([[0.0], np.diff(energy) / np.diff(time)])
        return THESIS_RATE(energy, change)
    reach = pitch * (np.ceil(np.abs(sample.x).max() / pitch) + 0.5)
    edges = np.arange(-reach, reach + pitch / 2, pitch)
    sensor = TactileSensor((edges[1:] + edges[:-1]) / 2, law)
    return sensor.rates(time, taxel_pressure(sample.x, sample.pressure, edges), sample.indentation if with_depth else 0.0)


# -- rapidly adapting receptors ----------------------------------------------------------------------------------------------

RAPIDLY_ADAPTING = {
    "curvature of the skin": ("curvature", RapidlyAdapting(threshold=500.0, scale=500.0, highest=100.0)),
    "strain energy at 600 um": ("energy", RapidlyAdapting(threshold=100.0, scale=500.0, highest=100.0)),
}
"""Stimulus whose rate drives the receptor -> its key and law; thresholds, scales and the highest rate are assumed, nothing at
hand states them."""


def rapidly_adapting(histories: Histories) -> pd.DataFrame:
    """What the thesis reports of rapidly adapting receptors, asked of two laws: only at the ramp's beginning? whatever the
    curvature?

    Returns:
        One row a law and surface: impulses during the ramp and the hold, when the response ends as a share of the ramp (the end
        of the last output interval with a rate, so to within an output step), the largest rate.
    """
    rows = []
    for name, (key, law) in RAPIDLY_ADAPTING.items():
        for label, history in pressed(histories).items():
            frame = rapidly_adapting_rate(history, law, key)
            time, rate = frame[TIME].to_numpy(), frame[IMPULSE_RATE].to_numpy()
            top = float(history["time"].values[ramp_end(history)])
            split = int(np.flatnonzero(time == top)[0]) + 1
            counts = [float(integrated(time[part], rate[part])[-1]) for part in (slice(0, split), slice(split, None))]
            last = np.flatnonzero(rate > 1e-6)
            ends = time[min(last[-1] + 1, len(time) - 1)] / top if len(last) else 0.0
            row = {
                "responds to the rate of": name,
                "surface": label,
                "impulses in the ramp": counts[0],
                "impulses in the hold": counts[1],
            }
            rows.append(row | {"response ends (share of the ramp)": ends, "largest rate (impulses/s)": float(rate.max())})
    return pd.DataFrame(rows)

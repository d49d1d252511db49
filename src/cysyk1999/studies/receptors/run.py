"""The thesis's laws from skin to impulses: fitted to simulated histories, carried over to others,
compared with rates.

Everything is read from cached histories: the constants of the laws with intervals, what they leave
over, and where they break.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.measures.quantities import NODE, P
from cysyk1999.measures.responses import (
    DEPTHS,
    NODE_COUNT,
    NODE_SURFACE,
    P_LAW,
    RECEPTOR_DEPTH,
    contact_nodes,
    fit_nodes,
    pressure_by_law,
    skin_sample,
    skin_shift,
    strokes,
)
from cysyk1999.measures.runs import FAST, NINE
from cysyk1999.publishing.tables import publish_table
from cysyk1999.receptors.fits import (
    EQ_4_4,
    PRESSURE_ONLY,
    SQUARE,
    SkinSample,
    constant_shift,
    jackknife,
    r_squared,
    rms,
    spatial_sum,
)
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.studies.receptors.candidate_stimuli import candidate_stimuli
from cysyk1999.studies.receptors.impulse_rates import (
    RATE_FITS,
    assignments,
    kind,
    matched_histories,
    rate_fit,
    rate_sets,
)
from cysyk1999.studies.receptors.sensing import sensor_accuracy
from fingerpad.measures.features import Histories, ramp_end, scene_name
from fingerpad.measures.strokes import SUB
from fingerpad.receptors.laws import NODE_TERMS, TERM_UNITS, THESIS_RATE, SpatialSum

KEY = ["law", "scenes", "receptor_depth (um)", "quantity"]
FIT_COLUMNS = [*KEY, "estimate", "low_95", "high_95", "units", "residual_rms", "residual_units"]
FIT_COLUMNS += ["r_squared", "samples", "discretisation (%)", "note"]


def receptor_fits(histories: Histories, coarse: Histories, rates: pd.DataFrame) -> pd.DataFrame:
    """Every constant of Eqs 4-1 to 5-1, its interval, what the law leaves over, and where it
    breaks.

    Parameters
    ----------
    histories, coarse : scenes and their companions
        Those of the nine surfaces, of strokes and of lower forces are read.
    rates : DataFrame
        Of `cysyk1999.receptors.recordings.read_rates`.

    Returns
    -------
    DataFrame
        Columns `FIT_COLUMNS`. Intervals are jackknife intervals over surfaces (Eq 4-1: over nodes,
        rates: over rates); "discretisation" is by how much the estimate differs when fitted to the
        companions.
    """
    rows = [*_simulated_laws(histories), *_rate_law(histories, rates)]
    table = pd.DataFrame(rows, columns=FIT_COLUMNS)
    if len(NINE.histories(coarse)) == len(NINE.histories(histories)) > 1:
        rough = pd.DataFrame(_simulated_laws(coarse)).drop_duplicates(KEY)[[*KEY, "estimate"]]
        other = table[KEY].merge(rough, on=KEY, how="left")["estimate"].to_numpy(float)
        off = 100 * np.abs(other / table["estimate"].to_numpy(float) - 1)
        table["discretisation (%)"] = np.where(table["units"] == "%", np.nan, off)
    return table


def _simulated_laws(histories: Histories) -> Iterator[dict]:
    surfaces = NINE.histories(histories)
    if NODE_SURFACE in surfaces:
        yield from _laws_of_one_surface(surfaces[NODE_SURFACE])
    if len(surfaces) > 1:
        yield from _node_laws(surfaces)
        yield from _sums(histories, surfaces)


def _row(
    law, scenes, quantity, values, units, note="", depth=np.nan, left=None, left_units="Pa"
) -> dict:
    """A row of the table.

    Parameters
    ----------
    values : a number, or one with its interval.
    depth : m, of the receptor.
    left : data and what the law predicts of them.
    """
    estimate, low, high = np.append(values, [np.nan] * 2)[:3]
    said = (law, scenes, depth * 1e6, quantity, estimate, low, high, units)
    if left is not None:
        data, predicted = left
        said += rms(data - predicted), left_units, r_squared(data, predicted), len(data)
    return dict(zip(FIT_COLUMNS, said, strict=False)) | {"note": note}


def _relative(law, scenes, quantity, left, note="", depth=np.nan) -> dict:
    """Row of a residual relative to the data themselves, %."""
    return _row(law, scenes, quantity, _share(left), "%", note, depth, left)


def _share(left: tuple[np.ndarray, np.ndarray]) -> float:
    """Size of a residual over that of the data, %."""
    return 100 * rms(left[0] - left[1]) / rms(left[0])


def _constants(
    law, scenes, units, found, left, note, depth=np.nan, left_units="Pa"
) -> Iterator[dict]:
    """A row a constant; what the law leaves over and the note stand in the first."""
    for (name, unit), values in zip(units.items(), found, strict=True):
        yield _row(law, scenes, name, values, unit, note, depth, left, left_units)
        left, note = None, ""


def _terms(law: str) -> dict[str, str]:
    """Constants of Eq 4-1, 4-2 or 4-3 and their units."""
    return {f"A{k}, {term}": TERM_UNITS[term] for k, term in enumerate(NODE_TERMS[law], start=1)}


def _pressures(law: str, nodes: pd.DataFrame, constants: np.ndarray) -> tuple[np.ndarray, ...]:
    """Pressures of nodes, and what a law makes of them."""
    used = pressure_by_law(law, nodes, constants)
    return used[P], used[P_LAW]


def _fit_groups(law: str, groups: Sequence[pd.DataFrame]) -> np.ndarray:
    """Constants (p, 3) of a law of nodes, with intervals over groups."""
    return jackknife(lambda chosen: fit_nodes(law, pd.concat(chosen)), groups)


def _laws_of_one_surface(history: xr.Dataset) -> Iterator[dict]:
    nodes = contact_nodes(history, NODE_COUNT)
    groups = [group for _, group in nodes.groupby(NODE)]
    where = f"{scene_name('ramp40', NODE_SURFACE)}, {len(groups)} nodes"
    for law in ("4-1", "4-1 read without an exponent"):
        found, units = _fit_groups(law, groups), _terms(law)
        note = "one set for all nodes, each from its peak on; intervals over nodes"
        left = _pressures(law, nodes, found[:, 0])
        yield from _constants(law, where, units, found, left, note)
        alone = np.array([fit_nodes(law, group) for group in groups])
        pairs = zip(groups, alone, strict=True)
        shares = [r_squared(*_pressures(law, *pair)) for pair in pairs]
        note = (
            "median and range over nodes, not an interval; "
            f"R2 of the nodes {min(shares):.3f} to {max(shares):.3f}"
        )
        spread = np.quantile(alone, [0.5, 0, 1], axis=0).T
        yield from _constants(f"{law}, a set for each node", where, units, spread, None, note)


def _node_laws(surfaces: dict[str, xr.Dataset]) -> Iterator[dict]:
    nodes = {label: contact_nodes(history) for label, history in surfaces.items()}
    where = f"ramp40, {len(surfaces)} surfaces"
    for law, which in (
        ("4-2", "all nodes in contact up to the top of the ramp"),
        ("4-3", "each node from its peak on"),
    ):
        found, note = _fit_groups(law, [*nodes.values()]), f"intervals over surfaces; {which}"
        left = _pressures(law, pd.concat(nodes.values()), found[:, 0])
        yield from _constants(law, where, _terms(law), found, left, note)
        for label, own in nodes.items():
            rest = pd.concat([other for name, other in nodes.items() if name != label])
            share = _share(_pressures(law, own, fit_nodes(law, rest)))
            note = f"{share:.1f} % when fitted to the other surfaces"
            name = f"residual over the pressure, K = {label}"
            yield _relative(law, where, name, _pressures(law, own, found[:, 0]), note)


WHAT = "residual over the energy"
WITHOUT, OF_SQUARE = "4-4 without depth of indentation", "square of the weighted pressure"
SYMBOLS = {"constant": ("A2", "1/m"), "per_depth": ("A1", "1/m2"), "square": ("A", "1/(Pa m2)")}


def _sums(histories: Histories, surfaces: dict[str, xr.Dataset]) -> Iterator[dict]:
    where, note = f"ramp40, {len(surfaces)} surfaces", "intervals over surfaces"
    cases = [("4-4", EQ_4_4, z) for z in DEPTHS] + [(WITHOUT, PRESSURE_ONLY, RECEPTOR_DEPTH)]
    for title, names, depth in [*cases, *((OF_SQUARE, SQUARE, z) for z in DEPTHS)]:
        samples = [skin_sample(history, depth) for history in surfaces.values()]
        units = {"r": "mm"} | {SYMBOLS[name][0]: SYMBOLS[name][1] for name in names}

        def constants(chosen, names=names):
            law = spatial_sum(chosen, names)
            return [law.r * 1e3, *(getattr(law, name) for name in names)]

        found = jackknife(constants, samples)
        r, *values = found[:, 0].tolist()
        law = SpatialSum(r * 1e-3, **dict(zip(names, values, strict=True)))
        left = _energies(law, samples)
        yield from _constants(title, where, units, found, left, note, depth)
        if abs(depth - RECEPTOR_DEPTH) > 1e-9:
            continue
        for (label, history), sample in zip(surfaces.items(), samples, strict=True):
            of = _energies(law, [sample])
            simulated, fall = (100 * (1 - e[-1] / e[ramp_end(history)]) for e in of)
            yield _relative(title, where, f"{WHAT}, K = {label}", of, depth=depth)
            told = f"simulated: {simulated:.1f} %"
            yield _row(title, where, f"fall in the hold, K = {label}", fall, "%", told, depth)
        if title == "4-4":
            yield from _transferred(law, histories, depth)


def _energies(law: SpatialSum, samples: Sequence[SkinSample], shift=0.0) -> tuple[np.ndarray, ...]:
    """Strain energies of samples, and what a law makes of them."""
    simulated, predicted = ([s.energy for s in samples], [s.by(law, shift) for s in samples])
    return np.concatenate(simulated), np.concatenate(predicted)


def _transferred(law: SpatialSum, histories: Histories, depth: float) -> Iterator[dict]:
    """How the sum fitted to the slow ramps does on what it was not fitted to: fast ramps, and
    strokes with four shifts.
    """
    title = "4-4, constants of ramp40"
    fast = [skin_sample(history, depth) for history in FAST.histories(histories).values()]
    if fast:
        where = f"ramp150, {len(fast)} surfaces"
        yield _relative(title, where, WHAT, _energies(law, fast), depth=depth)
    moving = {k: history for k, history in strokes(histories).items() if k not in SUB.values()}
    if not moving:
        return
    chosen = "stroke_10" if "stroke_10" in moving else next(iter(moving))
    shift = constant_shift(law, skin_sample(moving[chosen], depth))
    note = "closest to this stroke, then kept for every velocity"
    yield _row(title, chosen, "constant lateral shift", shift * 1e3, "mm", note, depth)
    yield _refitted(moving[chosen], chosen, depth)
    for name, history in moving.items():
        sample, skin = skin_sample(history, depth), skin_shift(history)
        share = _share_of_skin(law, sample, skin)
        for how, value, note in (
            ("no shift", 0.0, ""),
            ("constant shift", shift, ""),
            ("the skin's shift", skin, ""),
            ("a share of the skin's shift", share * skin, f"{share:.2f} of it"),
        ):
            left = _energies(law, [sample], value)
            yield _relative(title, name, f"{WHAT}, {how}", left, note, depth)


def _refitted(history: xr.Dataset, scene: str, depth: float) -> dict:
    """What is left when all constants of Eq 4-4 and a constant shift are fitted to a stroke itself:
    what its form cannot do.
    """
    fits = []
    for shift in np.arange(-1.2e-3, 0.5e-3, 0.1e-3):
        sample = skin_sample(history, depth, shift)
        law = spatial_sum([sample])
        fits.append((_energies(law, [sample], shift), law, shift))
    left, law, shift = min(fits, key=lambda fit: _share(fit[0]))
    note = (
        f"r {law.r * 1e3:.3g} mm, A1 {law.per_depth:.3g} 1/m2, A2 {law.constant:.3g} 1/m, "
        f"shift {shift * 1e3:.2g} mm"
    )
    return _relative("4-4, fitted to the stroke", scene, WHAT, left, note, depth)


def _share_of_skin(law: SpatialSum, sample: SkinSample, skin: np.ndarray) -> float:
    """The share of the skin's lateral displacement with which the law comes closest to a stroke, to
    a hundredth.
    """

    def misfit(share: float) -> float:
        return rms(sample.by(law, share * skin) - sample.energy)

    return float(min(np.arange(0, 1.505, 0.01), key=misfit))


def _rate_law(histories: Histories, rates: pd.DataFrame) -> Iterator[dict]:
    """Eq 5-1 with the thesis's constants against the rates at hand, and what its constants become
    when fitted to them.
    """
    units = {
        "A1": "(impulses/s)/Pa",
        "A2": "impulses/Pa",
        "threshold of the energy": "Pa",
        "threshold of the rate": "Pa/s",
    }
    law, stated = THESIS_RATE, "5-1, thesis's constants"
    values = (law.per_energy, law.per_rate, law.threshold, law.rate_threshold)
    note = "stated, Figs 5-20 and 5-21"
    for (name, unit), value in zip(units.items(), values, strict=True):
        yield _row(stated, "pressed and stroked", name, value, unit, note, RECEPTOR_DEPTH)
    for title, group in rate_sets(rates[rates["receptor"] == "SA-I"]):
        matched = matched_histories(histories, group)
        if matched is None:
            note = "fewer than four surfaces at its force"
            yield _row(stated, title, "not compared", np.nan, "", note)
            continue
        readings = [rate_fit(matched, group, curvature) for curvature in assignments(group)]
        data = group["rate_per_s"].to_numpy(float)
        for way, units in RATE_FITS.items():
            found, predicted = readings[0][way]
            note = f"{len(data)} rates; {kind(group, matched)}"
            if len(readings) > 1:
                shares = [r_squared(data, reading[way][1]) for reading in readings]
                note += (
                    f"; R2 {min(shares):.2f} to {max(shares):.2f} over {len(readings)} ways "
                    "to read which surface a rate is of"
                )
            left = data, predicted
            yield from _constants(
                way, title, units, found, left, note, RECEPTOR_DEPTH, "impulses/s"
            )


TABLES = ("receptor_fits", "candidate_stimuli", "sensor_accuracy")


def receptor_tables(job: SimpleNamespace) -> None:
    """Job: `rates`, `histories`, `coarse` -> `tables`."""
    rates = read_rates(*job.rates)
    histories = read_results(job.histories, True)[0]
    coarse = read_coarse(job.coarse, True)
    tables = {
        "receptor_fits": lambda: receptor_fits(histories, coarse, rates),
        "candidate_stimuli": lambda: candidate_stimuli(histories, rates),
        "sensor_accuracy": lambda: sensor_accuracy(histories),
    }
    for table in map(Path, job.tables):
        publish_table(tables[table.stem](), table)

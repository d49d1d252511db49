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
from cysyk1999.publishing.write import publish_table
from cysyk1999.receptors.fits import constant_shift, jackknife, r_squared, rms, spatial_sum
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
from cysyk1999.studies.receptors.sensing import rapidly_adapting, sensor_accuracy
from fingerpad.measures.features import Histories, scene_name
from fingerpad.measures.strokes import SUB
from fingerpad.receptors.laws import NODE_TERMS, TERM_UNITS, THESIS_RATE, SpatialSum

FIT_COLUMNS = (
    "law",
    "scenes",
    "receptor_depth (um)",
    "quantity",
    "estimate",
    "low_95",
    "high_95",
    "units",
    "residual_rms",
    "residual_units",
    "r_squared",
    "samples",
    "discretisation (%)",
    "note",
)


def receptor_fits(histories: Histories, coarse: Histories, rates: pd.DataFrame) -> pd.DataFrame:
    """Every constant of Eqs 4-1 to 5-1, its interval, what the law leaves over, and where it
    breaks.

    Args:
        histories, coarse: scenes and their companions, of which those of the nine surfaces, of
        strokes and of lower forces are read. rates: of `cysyk1999.receptors.recordings.read_rates`.

    Returns:
        Columns `FIT_COLUMNS`. Intervals are jackknife intervals over surfaces (Eq 4-1: over nodes,
        rates: over rates); "discretisation" is by how much the estimate differs when fitted to the
        companions.
    """
    table = pd.DataFrame(
        [*_simulated_laws(histories, intervals=True), *_rate_law(histories, rates)],
        columns=FIT_COLUMNS,
    )
    if len(NINE.histories(coarse)) == len(NINE.histories(histories)) > 1:
        rough = pd.DataFrame(_simulated_laws(coarse, intervals=False))
        key = ["law", "scenes", "receptor_depth (um)", "quantity"]
        matched = (
            table[key]
            .merge(rough.drop_duplicates(key)[[*key, "estimate"]], on=key, how="left")["estimate"]
            .to_numpy(float)
        )
        off = 100 * np.abs(matched / table["estimate"].to_numpy(float) - 1)
        table["discretisation (%)"] = np.where(table["units"] == "%", np.nan, off)
    return table


def _simulated_laws(histories: Histories, intervals: bool) -> Iterator[dict]:
    surfaces = NINE.histories(histories)
    yield from _node_laws(surfaces, intervals)
    yield from _sums(histories, surfaces, intervals)


def _rows(
    law, scenes, names, units, found, data, predicted, note="", depth=np.nan
) -> Iterator[dict]:
    """One row a constant; what the law leaves over and the note stand in the first."""
    for k, (name, unit) in enumerate(zip(names, units, strict=True)):
        row = {
            "law": law,
            "scenes": scenes,
            "receptor_depth (um)": depth,
            "quantity": name,
            "units": unit,
        }
        row |= dict(zip(("estimate", "low_95", "high_95"), found[k], strict=True))
        yield row | _left_over(data, predicted) | {"note": note} if k == 0 else row


def _number(
    law, scenes, quantity, value, units, note="", depth=np.nan, low=np.nan, high=np.nan
) -> dict:
    return {
        "law": law,
        "scenes": scenes,
        "receptor_depth (um)": depth,
        "quantity": quantity,
        "estimate": value,
        "low_95": low,
        "high_95": high,
        "units": units,
        "note": note,
    }


def _left_over(data, predicted, units: str = "Pa") -> dict:
    """What a prediction leaves over."""
    left = {"residual_rms": rms(data - predicted), "residual_units": units}
    return left | {"r_squared": r_squared(data, predicted), "samples": len(data)}


def _relative(law, scenes, quantity, data, predicted, note="", depth=np.nan) -> dict:
    """Row of a residual relative to the data themselves, %."""
    return _number(
        law, scenes, quantity, 100 * rms(data - predicted) / rms(data), "%", note, depth
    ) | _left_over(data, predicted)


def _with_intervals(fitted, groups: Sequence, intervals: bool) -> np.ndarray:
    """Estimates (p, 3) of what is fitted to groups, low and high last; these are not a number
    without intervals.
    """
    if intervals:
        return jackknife(fitted, groups)
    found = np.asarray(fitted(groups))
    return np.column_stack([found, np.full((len(found), 2), np.nan)])


def _node_laws(surfaces: dict[str, xr.Dataset], intervals: bool) -> Iterator[dict]:
    names = {
        law: [f"A{k + 1}, {term}" for k, term in enumerate(terms)]
        for law, terms in NODE_TERMS.items()
    }
    units = {law: [TERM_UNITS[term] for term in terms] for law, terms in NODE_TERMS.items()}

    def fitted(law, groups, where, note):
        found = _with_intervals(lambda chosen: fit_nodes(law, pd.concat(chosen)), groups, intervals)
        used = pressure_by_law(law, pd.concat(groups), found[:, 0])
        return found, _rows(law, where, names[law], units[law], found, used[P], used[P_LAW], note)

    if NODE_SURFACE in surfaces:
        nodes = contact_nodes(surfaces[NODE_SURFACE], NODE_COUNT)
        groups = [group for _, group in nodes.groupby(NODE)]
        where = f"{scene_name('ramp40', NODE_SURFACE)}, {len(groups)} nodes"
        for law in ("4-1", "4-1 read without an exponent"):
            yield from fitted(
                law,
                groups,
                where,
                "one set for all nodes, each from its peak on; intervals over nodes",
            )[1]
            alone = np.array([fit_nodes(law, group) for group in groups])
            each = [pressure_by_law(law, *pair) for pair in zip(groups, alone, strict=True)]
            shares = [r_squared(node[P], node[P_LAW]) for node in each]
            note = (
                "median and range over nodes, not an interval; R2 of the nodes "
                f"{min(shares):.3f} to {max(shares):.3f}"
            )
            for name, unit, values in zip(names[law], units[law], alone.T, strict=True):
                ends = {"low": values.min(), "high": values.max()}
                yield _number(
                    f"{law}, a set for each node",
                    where,
                    name,
                    float(np.median(values)),
                    unit,
                    note,
                    **ends,
                )
                note = ""
    if len(surfaces) < 2:
        return
    nodes = {label: contact_nodes(history) for label, history in surfaces.items()}
    where = f"ramp40, {len(surfaces)} surfaces"
    for law, which in (
        ("4-2", "all nodes in contact up to the top of the ramp"),
        ("4-3", "each node from its peak on"),
    ):
        found, rows = fitted(law, list(nodes.values()), where, f"intervals over surfaces; {which}")
        yield from rows
        for label in surfaces:
            others = fit_nodes(
                law, pd.concat([rows for other, rows in nodes.items() if other != label])
            )
            own, strange = (
                pressure_by_law(law, nodes[label], constants) for constants in (found[:, 0], others)
            )
            note = (
                f"{100 * rms(strange[P] - strange[P_LAW]) / rms(strange[P]):.1f} % when fitted "
                "to the other surfaces"
            )
            yield _relative(
                law, where, f"residual over the pressure, K = {label}", own[P], own[P_LAW], note
            )


def _sums(histories: Histories, surfaces: dict[str, xr.Dataset], intervals: bool) -> Iterator[dict]:
    if len(surfaces) < 2:
        return
    where = f"ramp40, {len(surfaces)} surfaces"
    for depth, with_depth in [*((z, True) for z in DEPTHS), (RECEPTOR_DEPTH, False)]:
        samples = [skin_sample(history, depth) for history in surfaces.values()]

        def constants(chosen, with_depth=with_depth):
            law = spatial_sum(chosen, with_depth)
            return [law.r * 1e3, law.constant, law.per_depth][: 2 + with_depth]

        found = _with_intervals(constants, samples, intervals)
        law = SpatialSum(found[0, 0] * 1e-3, found[2, 0] if with_depth else 0.0, found[1, 0])
        energies = [(s.energy, s.by(law)) for s in samples]
        both = [np.concatenate(side) for side in zip(*energies, strict=True)]
        title = "4-4" if with_depth else "4-4 without depth of indentation"
        names, units = ["r", "A2", "A1"][: 2 + with_depth], ["mm", "1/m", "1/m2"][: 2 + with_depth]
        yield from _rows(
            title, where, names, units, found, *both, "intervals over surfaces", depth * 1e6
        )
        if abs(depth - RECEPTOR_DEPTH) > 1e-9:
            continue
        for label, (own, predicted) in zip(surfaces, energies, strict=True):
            yield _relative(
                title,
                where,
                f"residual over the energy, K = {label}",
                own,
                predicted,
                depth=depth * 1e6,
            )
        if with_depth:
            yield from _transferred(law, histories, depth)


def _transferred(law: SpatialSum, histories: Histories, depth: float) -> Iterator[dict]:
    """How the sum fitted to the slow ramps does on what it was not fitted to: fast ramps, and
    strokes with four shifts.
    """
    um, title, what = depth * 1e6, "4-4, constants of ramp40", "residual over the energy"
    fast = [skin_sample(history, depth) for history in FAST.histories(histories).values()]
    if fast:
        own = np.concatenate([s.energy for s in fast])
        predicted = np.concatenate([s.by(law) for s in fast])
        yield _relative(title, f"ramp150, {len(fast)} surfaces", what, own, predicted, depth=um)
    moving = {
        name: history for name, history in strokes(histories).items() if name not in SUB.values()
    }
    if not moving:
        return
    chosen = "stroke_10" if "stroke_10" in moving else next(iter(moving))
    shift = constant_shift(law, skin_sample(moving[chosen], depth))
    note = "closest to this stroke, then kept for every velocity"
    yield _number(title, chosen, "constant lateral shift", shift * 1e3, "mm", note, um)
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
            yield _relative(
                title, name, f"{what}, {how}", sample.energy, sample.by(law, value), note, um
            )


def _refitted(history: xr.Dataset, scene: str, depth: float) -> dict:
    """What is left when all constants of Eq 4-4 and a constant shift are fitted to a stroke itself:
    what its form cannot do.
    """
    best = None
    for shift in np.arange(-1.2e-3, 0.5e-3, 0.1e-3):
        sample = skin_sample(history, depth, shift)
        law = spatial_sum([sample])
        predicted = sample.by(law, shift)
        if best is None or rms(predicted - sample.energy) < rms(best[0] - sample.energy):
            best = predicted, law, shift
    predicted, law, shift = best
    note = (
        f"r {law.r * 1e3:.3g} mm, A1 {law.per_depth:.3g} 1/m2, A2 {law.constant:.3g} 1/m, "
        f"shift {shift * 1e3:.2g} mm"
    )
    return _relative(
        "4-4, fitted to the stroke",
        scene,
        "residual over the energy",
        sample.energy,
        predicted,
        note,
        depth * 1e6,
    )


def _share_of_skin(law: SpatialSum, sample, skin: np.ndarray) -> float:
    """The share of the skin's lateral displacement with which the law comes closest to a stroke, to
    a hundredth.
    """

    def left(share: float) -> float:
        return rms(sample.by(law, share * skin) - sample.energy)

    shares = np.arange(0, 1.505, 0.01)
    near = 10 * int(np.argmin([left(share) for share in shares[::10]]))
    return float(min(shares[max(near - 10, 0) : near + 11], key=left))


def _rate_law(histories: Histories, rates: pd.DataFrame) -> Iterator[dict]:
    """Eq 5-1 with the thesis's constants against the rates at hand, and what its constants become
    when fitted to them.
    """
    um, stated = RECEPTOR_DEPTH * 1e6, "5-1, thesis's constants"
    for name, value, unit in (
        ("A1", THESIS_RATE.per_energy, "(impulses/s)/Pa"),
        ("A2", THESIS_RATE.per_rate, "impulses/Pa"),
        ("threshold of the energy", THESIS_RATE.threshold, "Pa"),
        ("threshold of the rate", THESIS_RATE.rate_threshold, "Pa/s"),
    ):
        yield _number(
            stated, "pressed and stroked", name, value, unit, "stated, Figs 5-20 and 5-21", um
        )
    for title, group in rate_sets(rates[rates["receptor"] == "SA-I"]):
        matched = matched_histories(histories, group)
        if matched is None:
            yield _number(
                stated, title, "not compared", np.nan, "", "fewer than four surfaces at its force"
            )
            continue
        readings = [rate_fit(matched, group, curvature) for curvature in assignments(group)]
        data = group["rate_per_s"].to_numpy(float)
        about = f"{len(data)} rates; {kind(group)}"
        for law, names in RATE_FITS.items():
            constants, predicted = readings[0][law]
            shares = [r_squared(data, reading[law][1]) for reading in readings]
            note = about
            if len(readings) > 1:
                note += (
                    f"; R2 {min(shares):.2f} to {max(shares):.2f} over {len(readings)} ways "
                    "to read which surface a rate is of"
                )
            for k, (name, unit) in enumerate(names.items()):
                value, low, high = constants[k]
                row = _number(law, title, name, value, unit, note * (k == 0), um, low, high)
                yield row | _left_over(data, predicted, "impulses/s") if k == 0 else row


TABLES = ("receptor_fits", "candidate_stimuli", "sensor_accuracy", "rapidly_adapting")


def receptor_tables(job: SimpleNamespace) -> None:
    """Job: `rates`, `histories`, `coarse` -> `tables`."""
    rates = read_rates(*job.rates)
    histories, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    made = {
        "receptor_fits": lambda: receptor_fits(histories, coarse, rates),
        "candidate_stimuli": lambda: candidate_stimuli(histories, rates),
        "sensor_accuracy": lambda: sensor_accuracy(histories),
        "rapidly_adapting": lambda: rapidly_adapting(histories),
    }
    for table in map(Path, job.tables):
        publish_table(made[table.stem](), table)

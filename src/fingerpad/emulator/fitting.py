"""From the histories of a sweep to an emulator.

Every quantity is brought to the same moments: shares of the press, times of the hold. Pressures are
brought to shares of the half width of the contact, so a moving edge does not smear. The
principal components of each quantity are Gaussian processes in the knobs, about a parabola of them.
The error is that of scenes left out, one at a time, of the whole way from knobs to quantity.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import (
    SOONEST,
    basis,
    cubic_weights,
    exponents,
    held,
    kernel,
)
from fingerpad.emulator.model import (
    ENERGY,
    LOGARITHMIC,
    PLACES,
    SCALARS,
    Emulator,
    Group,
    Moments,
)
from fingerpad.emulator.question import Knob, scaled
from fingerpad.results import read_history
from fingerpad.stimuli.motion import NO_TIME
from fingerpad.units import dimension_of, parse_quantity

HOLDS = 12
"""Moments of a hold."""
ARCS = 41
"""Places on the right half of the skin."""
COVERED = 0.95
"""Share of scenes left out that the band holds."""
TRUNCATED = 5e-4
"""Root mean square of what principal components may leave of a quantity (of its logarithm, or of
its scale).
"""
MOST_PARTS = 14
DEGREE = 2
"""Of the trend."""
FREE = 100.0
"""Variance of a coefficient of the trend, over that of the Gaussian process."""
LENGTHS = (0.1, 100.0)
"""Least and largest length of the Gaussian process; a knob's range is 2."""
NOISES = (1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1)
"""Variance of what no Gaussian process explains, over that of the process."""
SEARCHED, LEADING = 384, 2
"""Scenes by which lengths and noise are chosen, and principal components for lengths."""
SMOOTH = (*SCALARS, "pressure_shape", "skin_displacement_x", "skin_displacement_y")
"""Quantities whose lengths are the same."""


@dataclass(frozen=True)
class Samples:
    """What a sweep's histories show.

    Attributes
    ----------
    points : (n, knobs) SI.
    values : name -> (n, ...) values at all moments.
    """

    points: np.ndarray
    values: dict[str, np.ndarray]

    def only(self, rows: np.ndarray) -> Samples:
        """Some of the scenes."""
        return Samples(self.points[rows], {name: v[rows] for name, v in self.values.items()})


def emulate(sweep: str | Path, unseen: str | Path | None = None) -> Emulator:
    """Fit an emulator to the histories of a sweep.

    Parameters
    ----------
    sweep
        Folder of a finished sweep of presses, with or without a hold, whose file says
        ``histories: true``.
    unseen
        Folder of another sweep of the same scene over the same keys, by which the emulator is
        judged; without, a tenth of the scenes is left out of a first fit for that.

    Returns
    -------
    Emulator
        It answers scenes like the sweep's: see `Emulator.predict`.

    Raises
    ------
    SceneError
        The folder holds no such sweep; one line.

    Examples
    --------
    >>> import fingerpad, tempfile
    >>> press = {"stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    ...          "motion": [{"press_to_force": "20 gf"}], "accuracy": "draft"}
    >>> over = {"motion[0].press_to_force": {"range": ["10 gf", "40 gf"]}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = fingerpad.sweep(press, over, out=folder, design="sobol", samples=16,
    ...                         histories=True)
    ...     pad = fingerpad.emulate(folder)
    >>> bool(1e-3 < pad.predict(press).indentation_depth[-1] < 1.3e-3)
    True
    """
    folder = Path(sweep)
    design = _design(folder)
    knobs = _knobs(folder, design)
    base = json.loads(design["about"]["base_scene"])
    moments = _moments(folder, base)
    histories = list(_histories(folder, design, len(knobs)))
    grids = _grids(histories[0][1])
    samples, lost = _samples(histories, moments, grids)
    if len(samples.points) < _least(knobs):
        raise SceneError(
            f"{folder}: has {len(samples.points)} scenes that can be emulated; "
            f"allowed: {_least(knobs)} or more"
        )
    about = design["about"] | {"scenes": len(samples.points), "scenes_left_out": lost}
    knobs = _warped(knobs, samples)
    if unseen:
        made = _fit(samples, knobs, base, moments, grids, about)
        made.about["held_out"] = judge(made, _unseen(Path(unseen), made))
        return made
    every = np.arange(len(samples.points))
    tenth = every % 10 == min(9, len(every) - 1)
    trial = _fit(samples.only(every[~tenth]), knobs, base, moments, grids, about)
    judged = judge(trial, samples.only(every[tenth]))
    return _fit(samples, knobs, base, moments, grids, about | {"held_out": judged})


def _unseen(folder: Path, made: Emulator) -> Samples:
    """What another sweep of the same scene over the same keys shows. Raises SceneError."""
    design = _design(folder)
    base = json.loads(design["about"]["base_scene"])
    keys = [p["key"] for p in design["parameters"]]
    own = [knob.key for knob in made.knobs]
    if keys != own:
        raise SceneError(f"{folder}: is over {', '.join(keys)}; allowed: {', '.join(own)}")
    if any(base[k] != made.base[k] for k in base.keys() - {"name", "tags", "accuracy"}):
        raise SceneError(f"{folder}: has another scene; allowed: that of the sweep")
    histories = list(_histories(folder, design, len(keys)))
    return _samples(histories, made.moments, made.grids)[0]


# --- the sweep ------------------------------------------------------------------------------------


def _design(folder: Path) -> dict[str, Any]:
    try:
        return json.loads((folder / "design.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise SceneError(f"{folder}: holds no sweep; allowed: the folder of a sweep") from None


def _knobs(folder: Path, design: Mapping[str, Any]) -> list[Knob]:
    """The axes of a sweep; their box is what was drawn from, or from the least to the largest
    value.
    """
    over, knobs = json.loads(design["about"]["sweep"])["over"], []
    for p in design["parameters"]:
        if not p["unit"]:
            raise SceneError(f"{folder}: over.{p['key']}: is not a number; allowed: numbers")
        per = 1.0 if p["unit"] == "1" else _si(p["unit"])
        axis = over.get(p["key"], {})
        ends = axis.get("range") or axis.get("uniform")
        ends = [_number(e, per) for e in ends] if ends else [per * v for v in p["values"]]
        even = axis.get("spacing") != "logarithmic" and "lognormal" not in axis
        warp = "linear" if even or min(ends) <= 0 else "logarithm"
        knobs.append(Knob(p["key"], p["name"], p["unit"], per, min(ends), max(ends), warp))
    return knobs


def _si(unit: str) -> float:
    return parse_quantity(f"1 {unit}", dimension_of(unit))


def _number(value: Any, per: float) -> float:
    if isinstance(value, str):
        return parse_quantity(value, dimension_of(value.partition(" ")[2]))
    return per * float(value)


def _histories(folder: Path, design: Mapping[str, Any], knobs: int) -> Iterator[tuple]:
    """Point and history of each scene that could be simulated."""
    sizes = tuple(design["dimensions"].values())
    names, found = list(design["dimensions"]), 0
    for number, key in enumerate(design["keys"]):
        place = dict(zip(names, np.unravel_index(number, sizes), strict=True))
        file = folder / "histories" / f"{key}.nc"
        if not file.exists():
            continue
        found += 1
        point = [p["values"][place[p["dimension"]]] for p in design["parameters"]]
        scale = [1.0 if p["unit"] == "1" else _si(p["unit"]) for p in design["parameters"]]
        yield np.array(point, float) * scale, read_history(file)
    if not found:
        raise SceneError(f"{folder}: keeps no histories; allowed: a sweep with histories: true")


def _moments(folder: Path, base: Mapping[str, Any]) -> Moments:
    """The moments of the sweep's motion: a press, with or without a hold."""
    legs = base["motion"]
    kinds = [next(iter(leg.keys() & {"press_to_force", "hold"}), "") for leg in legs]
    if kinds not in (["press_to_force"], ["press_to_force", "hold"]):
        allowed = "a press to a force, with or without a hold"
        raise SceneError(f"{folder}: its scenes move otherwise; allowed: {allowed}")
    rises = legs[0].get("rate") is not None
    press = np.linspace(0.1, 1.0, 10) if rises else np.ones(1)
    longest = legs[1]["hold"] if len(legs) > 1 else 0.0
    holds = np.expm1(np.linspace(0, held(longest), HOLDS + 1))[1:] * SOONEST
    return Moments(press, holds if longest else np.zeros(0))


def _grids(first: xr.Dataset) -> dict[str, np.ndarray]:
    """What a sweep's histories share: places of the skin and of receptors."""
    grids = {
        "arc": np.linspace(0, float(np.abs(first.skin_arc.values).max()) * 0.98, ARCS),
        "receptor_depth": first.receptor_depth.values,
        "receptor_offset": first.receptor_offset.values,
    }
    right = first.skin_arc.values >= 0
    for name in ("skin_x", "skin_y"):
        of = first[name].values
        grids[name] = np.interp(grids["arc"], first.skin_arc.values[right], of[right])
    return grids


def _samples(histories: list[tuple], moments: Moments, grids: Mapping[str, np.ndarray]):
    """Samples, and how many histories had nothing to emulate."""
    points, rows, lost = [], [], 0
    for point, history in histories:
        row = _row(history, moments, grids)
        if all(np.isfinite(value).all() for value in row.values()):
            points.append(point)
            rows.append(row)
        else:
            lost += 1
    values = {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}
    return Samples(np.array(points).reshape(len(points), -1), values), lost


@np.errstate(divide="ignore", invalid="ignore")
def _row(history: xr.Dataset, moments: Moments, grids: Mapping[str, np.ndarray]):
    """Quantities of a history at all moments, as they are emulated."""
    weights, own = _at_moments(history, moments)

    def at(values: np.ndarray) -> np.ndarray:
        return np.tensordot(weights, values[own], 1)

    row = {}
    for name in SCALARS:
        row[name] = np.exp(at(np.log(history[name].values)))
    load = history.force.values
    row[ENERGY] = at(np.sqrt(history.strain_energy_density.values) / load[:, None])
    shape = _pressure_shapes(history, load)
    row["pressure_shape"] = at(shape)
    depth = history.indentation_depth.values
    right = history.skin_arc.values >= 0
    arc = history.skin_arc.values[right]
    for name in ("skin_displacement_x", "skin_displacement_y"):
        moved = history[name].values[:, right] / depth[:, None]
        row[name] = at(np.array([np.interp(grids["arc"], arc, r) for r in moved]))
    row["estimated_error"] = np.array([float(history.attrs["estimated_error"])])
    return row


def _at_moments(history: xr.Dataset, moments: Moments) -> tuple[np.ndarray, np.ndarray]:
    """Weights (moments, outputs) that give a history's values at all moments, and which outputs."""
    time, leg = history.time.values, history.leg.values
    touching = np.flatnonzero(history.force.values > 0)
    own = touching[leg[touching] == 0]
    top = own[-1]
    press = own[np.concatenate([np.diff(time[own]) > NO_TIME, [True]])]
    if len(moments.press) == 1:
        press = press[-1:]
    grid = np.log(history.force.values[press] / history.force.values[top])
    first = cubic_weights(grid, np.log(moments.press))
    later = np.concatenate([[top], np.flatnonzero(leg == 1)])
    rest = cubic_weights(held(time[later] - time[top]), held(moments.hold))
    weights = np.zeros((len(moments), len(press) + len(later)))
    weights[: len(first), : len(press)] = first
    if len(moments.hold):
        weights[len(first) :, len(press) :] = rest
    return weights, np.concatenate([press, later])


def _pressure_shapes(history: xr.Dataset, load: np.ndarray) -> np.ndarray:
    """Pressure (time, places) over the mean pressure, at shares of the contact's half width."""
    place = history.skin_x.values + history.skin_displacement_x.values
    half = history.contact_width.values / 2
    upper = (history.skin_y.values > 0) & (history.skin_arc.values >= 0)
    found = np.zeros((len(load), len(PLACES)))
    for k in np.flatnonzero((half > 0) & (load > 0)):
        x, p = place[k, upper] / half[k], history.contact_pressure.values[k, upper]
        found[k] = np.interp(PLACES, x, p) * 2 * half[k] / load[k]
    return found


# --- the fit --------------------------------------------------------------------------------------


def _warped(knobs: list[Knob], samples: Samples) -> list[Knob]:
    """Each knob that is drawn evenly on the scale that leaves the least of depth, width and
    pressure unexplained.
    """
    some = samples.only(np.arange(min(len(samples.points), SEARCHED)))
    target = np.log(np.stack([some.values[name][:, -1] for name in SCALARS[:3]], axis=1))
    target -= target.mean(axis=0)

    def left(of: list[Knob]) -> float:
        at = scaled(of, some.points)
        return _missed(_terms(at, at, np.full(len(of), 2.0)), 1e-4, target)

    for k, knob in enumerate(knobs):
        ways = ("linear", "bent") if knob.warp == "linear" else (knob.warp,)
        tried = [[*knobs[:k], replace(knob, warp=w), *knobs[k + 1 :]] for w in ways]
        knobs = min(tried, key=left)
    return knobs


def _terms(points: np.ndarray, centres: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """What `Emulator.terms` gives."""
    trend = basis(points, exponents(points.shape[1], DEGREE))
    return np.hstack([trend, kernel(points, centres, scales)])


def _regressed(terms: np.ndarray, noise: float, target: np.ndarray):
    """What predictions of scenes left out one at a time miss (n, parts), and the coefficients
    (terms, parts) of a Gaussian process about a trend (Rasmussen and Williams 2006, sections 2.7
    and 5.4.2).
    """
    trend, covariance = np.split(terms, [terms.shape[1] - len(terms)], axis=1)
    total = covariance + FREE * trend @ trend.T
    total[np.diag_indices(len(total))] += noise
    inverse = np.linalg.inv(total)
    weights = inverse @ target
    missed = weights / np.diag(inverse)[:, None]
    return missed, np.vstack([FREE * trend.T @ weights, weights])


def _missed(terms: np.ndarray, noise: float, target: np.ndarray) -> float:
    """The root mean square of what scenes left out are missed by."""
    return float(np.sqrt((_regressed(terms, noise, target)[0] ** 2).mean()))


def _scales(points: np.ndarray, scores: list[np.ndarray]) -> np.ndarray:
    """Lengths (knobs,) of the Gaussian process that make the scores (n, parts) of the first
    components of some quantities most likely.
    """
    from sklearn.exceptions import ConvergenceWarning  # takes a second
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

    points = points[:SEARCHED]
    trend = basis(points, exponents(points.shape[1], DEGREE))
    rest = np.hstack([score[:SEARCHED, :LEADING] for score in scores])
    rest = rest - trend @ np.linalg.lstsq(trend, rest, rcond=None)[0]
    varies = rest.std(axis=0) > 1e-9
    if not varies.any():
        return np.full(points.shape[1], LENGTHS[1])
    lengths = Matern(np.full(points.shape[1], 2.0), LENGTHS, nu=2.5)
    process = GaussianProcessRegressor(
        ConstantKernel(1.0, (1e-2, 1e4)) * lengths + WhiteKernel(1e-3, (1e-8, 1.0))
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)  # a knob that hardly matters
        found = process.fit(points, rest[:, varies] / rest[:, varies].std(axis=0)).kernel_
    return np.broadcast_to(found.k1.k2.length_scale, points.shape[1]).copy()


def _fit(samples: Samples, knobs, base, moments, grids, about) -> Emulator:
    """An emulator of samples, with the errors of scenes left out."""
    at = scaled(knobs, samples.points)
    powers = exponents(len(knobs), DEGREE)
    made = Emulator(knobs, base, moments, grids, powers, at, {}, about)
    parts = {name: Parts.of(samples.values[name], name) for name in samples.values}
    del parts[ENERGY]
    scales = _scales(at, [parts[name].scores for name in SMOOTH])
    every, terms = np.arange(len(at)), _terms(at, at, scales)
    groups = {name: _group(terms, every, p, scales) for name, p in parts.items()}
    layers, of = made.layers(samples.points), grids["receptor_depth"]
    for k, depth in enumerate(np.unique(of)):
        kept = {layer: np.flatnonzero(layers[:, k] == layer) for layer in np.unique(layers[:, k])}
        values = samples.values[ENERGY][..., of == depth]
        parts = {layer: Parts.of(values[rows], ENERGY) for layer, rows in kept.items()}
        most = max(kept, key=lambda layer: len(kept[layer]))
        scales = _scales(at[kept[most]], [parts[most].scores])
        terms = _terms(at, at, scales)
        for layer, rows in kept.items():
            if len(rows) > len(knobs) + 1:
                groups[f"{ENERGY}_{k}_{layer}"] = _group(terms, rows, parts[layer], scales)
    return replace(made, groups=groups)


def _least(knobs: list[Knob]) -> int:
    """Scenes that a fit needs."""
    return 4 * len(knobs) + 4


@dataclass(frozen=True)
class Parts:
    """A quantity's mean, its principal components and their scores; what is left is small.

    Attributes
    ----------
    shape : (...) of the quantity, moments first.
    target : (n, outputs) values, or their logarithms.
    mean, rows, scores : (outputs,), (parts, outputs), (n, parts).
    """

    shape: tuple[int, ...]
    target: np.ndarray
    mean: np.ndarray
    rows: np.ndarray
    scores: np.ndarray

    @classmethod
    def of(cls, values: np.ndarray, name: str) -> Parts:
        """Of values (n, ...)."""
        flat = values.reshape(len(values), -1)
        target = np.log(flat) if name in LOGARITHMIC else flat
        mean = target.mean(axis=0)
        own, sizes, rows = np.linalg.svd(target - mean, full_matrices=False)
        rest = np.sqrt(np.append(np.cumsum(sizes[::-1] ** 2)[::-1][1:], 0.0) / target.size)
        count = min(int(np.argmax(rest <= TRUNCATED)) + 1, MOST_PARTS, len(sizes))
        return cls(values.shape[1:], target, mean, rows[:count], own[:, :count] * sizes[:count])


def _group(terms: np.ndarray, rows: np.ndarray, parts: Parts, scales: np.ndarray) -> Group:
    """A quantity that some of the scenes have, at the terms (n, terms) of all."""
    trend = terms.shape[1] - len(terms)
    kept = np.concatenate([np.arange(trend), trend + rows])
    own, some = terms[np.ix_(rows, kept)], rows[:SEARCHED]
    few = terms[np.ix_(some, np.concatenate([np.arange(trend), trend + some]))]
    noise = min(NOISES, key=lambda n: _missed(few, n, parts.scores[:SEARCHED]))
    missed, found = _regressed(own, noise, parts.scores)
    coefficients = np.zeros((terms.shape[1], found.shape[1]))
    coefficients[kept] = found
    miss = parts.target - parts.mean - (parts.scores - missed) @ parts.rows
    rank = min(int(np.ceil((len(miss) + 1) * COVERED)), len(miss)) - 1
    band = np.sort(np.abs(miss), axis=0)[rank]
    return Group(parts.shape, parts.mean, parts.rows, coefficients, band, scales)


def judge(emulator: Emulator, unseen: Samples) -> list[dict[str, Any]]:
    """How far an emulator is off for scenes that it was not fitted to, a row a quantity.

    Relative errors from the end of the press on; of energies under the middle. ``covered`` is the
    share within the emulator's own band, at all moments and receptors.
    """
    found, rows = emulator.values(unseen.points), []
    top, grids = len(emulator.moments.press) - 1, emulator.grids

    def add(name: str, ratio: np.ndarray, inside: np.ndarray) -> None:
        off = np.abs(ratio[np.isfinite(ratio)] - 1)
        row = {"quantity": name, "scenes": len(unseen.points), "median": float(np.median(off))}
        row |= {"within_95": float(np.quantile(off, 0.95)), "covered": float(inside.mean())}
        rows.append(row)

    for name in LOGARITHMIC:
        ratio = found[name] / unseen.values[name]
        inside = np.abs(np.log(ratio)) <= emulator.groups[name].band.reshape(ratio.shape[1:])
        add(name, ratio[:, top:] if name != "estimated_error" else ratio, inside)
    inside = np.abs(found[ENERGY] - unseen.values[ENERGY]) <= emulator.energy_band(unseen.points)
    for depth in np.unique(grids["receptor_depth"]):
        at = grids["receptor_depth"] == depth
        middle = at & (grids["receptor_offset"] == 0)
        ratio = found[ENERGY][:, top:, middle] / unseen.values[ENERGY][:, top:, middle]
        add(f"strain_energy_{1e6 * depth:.4g}_um", ratio**2, inside[..., at])
    return rows

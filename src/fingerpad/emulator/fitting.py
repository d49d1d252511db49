"""From the histories of a sweep to an emulator.

Every quantity is brought to the same moments: shares of the press, times of the hold. Pressures are
brought to shares of the half width of the contact, so a moving edge does not smear. Of each
quantity the principal components are polynomials in the knobs. The error is that of scenes left
out, one at a time, of the whole way from knobs to quantity.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import SOONEST, WARPS, basis, cubic_weights, exponents, held
from fingerpad.emulator.model import (
    ENERGY,
    LOGARITHMIC,
    PLACES,
    SCALARS,
    Emulator,
    Group,
    Moments,
)
from fingerpad.emulator.question import Knob
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
MOST_PARTS, MOST_DEGREE, MOST_TERMS = 14, 12, 800
DECAYS = (0.15, 0.25, 0.35, 0.45, 0.55, 0.65, 0.75, 0.85)
"""How much smaller a coefficient is expected to be for each degree more along a knob."""
NOISES = (1e-10, 1e-8, 1e-6, 1e-4, 1e-2)
"""Variance of what no polynomial explains, over that of the constant term."""
SEARCHED = 300
"""Scenes by which decays and noise are chosen."""


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


def emulate(sweep: str | Path) -> Emulator:
    """Fit an emulator to the histories of a sweep.

    Parameters
    ----------
    sweep
        Folder of a finished sweep of presses, with or without a hold, whose file says
        ``histories: true``.

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
    samples, grids, lost = _samples(histories, base, moments)
    if len(samples.points) < _least(knobs):
        raise SceneError(
            f"{folder}: has {len(samples.points)} scenes that can be emulated; "
            f"allowed: {_least(knobs)} or more"
        )
    about = design["about"] | {"scenes": len(samples.points), "scenes_left_out": lost}
    knobs = _warped(knobs, samples)
    every = np.arange(len(samples.points))
    tenth = every % 10 == min(9, len(every) - 1)
    trial = _fit(samples.only(every[~tenth]), knobs, base, moments, grids, about)
    judged = judge(trial, samples.only(every[tenth]))
    return _fit(samples, knobs, base, moments, grids, about | {"held_out": judged})


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
        knobs.append(Knob(p["key"], p["name"], p["unit"], per, min(ends), max(ends)))
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


def _samples(histories: list[tuple], base: Mapping[str, Any], moments: Moments):
    """Samples, the grids that they share, and how many histories had nothing to emulate."""
    first = histories[0][1]
    grids = {
        "arc": np.linspace(0, float(np.abs(first.skin_arc.values).max()) * 0.98, ARCS),
        "receptor_depth": first.receptor_depth.values,
        "receptor_offset": first.receptor_offset.values,
    }
    right = first.skin_arc.values >= 0
    for name in ("skin_x", "skin_y"):
        of = first[name].values
        grids[name] = np.interp(grids["arc"], first.skin_arc.values[right], of[right])
    points, rows, lost = [], [], 0
    for point, history in histories:
        row = _row(history, moments, grids)
        if all(np.isfinite(value).all() for value in row.values()):
            points.append(point)
            rows.append(row)
        else:
            lost += 1
    values = {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}
    return Samples(np.array(points).reshape(len(points), -1), values), grids, lost


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
    """Each knob on the scale that leaves the least of depth, width and pressure unexplained."""
    some = samples.only(np.arange(min(len(samples.points), SEARCHED)))
    powers = exponents(len(knobs), 6)
    target = np.log(np.stack([some.values[name][:, -1] for name in SCALARS[:3]], axis=1))
    target -= target.mean(axis=0)

    def left(of: list[Knob]) -> float:
        terms = basis(scaled(of, some.points), powers)
        return min(_missed(terms, powers, (d,) * len(knobs), 1e-6, target) for d in (0.35, 0.55))

    for k, knob in enumerate(knobs):
        ways = [w for w in WARPS if knob.low > 0 or (w == "square root" and knob.low == 0)]
        ways = ways or ["linear"]
        tried = [[*knobs[:k], replace(knob, warp=w), *knobs[k + 1 :]] for w in ways]
        knobs = min(tried, key=left)
    return knobs


def scaled(knobs: list[Knob], points: np.ndarray) -> np.ndarray:
    """Points (n, knobs) of the box from -1 to 1."""
    return np.stack([k.scaled(c) for k, c in zip(knobs, points.T, strict=True)], axis=1)


def _powers(knobs: int) -> np.ndarray:
    """Exponents up to the largest total degree whose terms are not too many."""
    fits = (d for d in range(MOST_DEGREE, 1, -1) if len(exponents(knobs, d)) <= MOST_TERMS)
    return exponents(knobs, next(fits, 1))


def _regressed(terms, powers, decays, noise, target) -> tuple[np.ndarray, np.ndarray]:
    """What predictions of scenes left out one at a time miss (n, parts), and the coefficients
    (terms, parts): a ridge whose penalty grows with the degree (a Gaussian process with a kernel of
    polynomials; Rasmussen and Williams 2006, eq 5.12).
    """
    expected = np.prod(np.asarray(decays) ** (2 * powers), axis=1)
    kernel = (terms * expected) @ terms.T
    kernel[np.diag_indices(len(kernel))] += noise + 1e-12 * np.trace(kernel) / len(kernel)
    inverse = np.linalg.inv(kernel)
    weights = inverse @ target
    return weights / np.diag(inverse)[:, None], expected[:, None] * (terms.T @ weights)


def _missed(terms, powers, decays, noise, target) -> float:
    """The root mean square of what scenes left out are missed by."""
    return float(np.sqrt((_regressed(terms, powers, decays, noise, target)[0] ** 2).mean()))


def _chosen(terms, powers, target) -> tuple[tuple[float, ...], float]:
    """Decay along each knob and noise that miss least, one after the other, twice."""
    decays, noise = [0.45] * powers.shape[1], 1e-6

    def missed(d: list[float], n: float) -> float:
        return _missed(terms, powers, d, n, target)

    for _ in range(2):
        for k in range(len(decays)):
            ways = [[*decays[:k], d, *decays[k + 1 :]] for d in DECAYS]
            decays = min(ways, key=lambda way: missed(way, noise))
        noise = min(NOISES, key=lambda n: missed(decays, n))
    return tuple(decays), noise


def _fit(samples: Samples, knobs, base, moments, grids, about) -> Emulator:
    """An emulator of samples, with the errors of scenes left out."""
    powers = _powers(len(knobs))
    terms = basis(scaled(knobs, samples.points), powers)
    made = Emulator(knobs, base, moments, grids, powers, {}, about)
    groups = {
        name: _group(terms, powers, values, name in LOGARITHMIC)
        for name, values in samples.values.items()
        if name != ENERGY
    }
    layers, of = made.layers(samples.points), grids["receptor_depth"]
    for k, depth in enumerate(np.unique(of)):
        for layer in np.unique(layers[:, k]):
            rows = layers[:, k] == layer
            if rows.sum() > len(knobs) + 1:
                values = samples.values[ENERGY][rows][..., of == depth]
                groups[f"{ENERGY}_{k}_{layer}"] = _group(terms[rows], powers, values, False)
    return replace(made, groups=groups)


def _least(knobs: list[Knob]) -> int:
    """Scenes that a fit needs."""
    return 4 * len(knobs) + 4


def _group(terms: np.ndarray, powers: np.ndarray, values: np.ndarray, logarithmic: bool) -> Group:
    """Polynomials of the principal components of a quantity, (n, ...) values at (n, terms)."""
    flat = values.reshape(len(values), -1)
    target = np.log(flat) if logarithmic else flat
    mean = target.mean(axis=0)
    parts, sizes, rows = np.linalg.svd(target - mean, full_matrices=False)
    rest = np.sqrt(np.append(np.cumsum(sizes[::-1] ** 2)[::-1][1:], 0.0) / target.size)
    count = min(int(np.argmax(rest <= TRUNCATED)) + 1, MOST_PARTS, len(sizes))
    scores = parts[:, :count] * sizes[:count]
    how = _chosen(terms[:SEARCHED], powers, scores[:SEARCHED])
    missed, found = _regressed(terms, powers, *how, scores)
    miss = target - mean - (scores - missed) @ rows[:count]
    rank = min(int(np.ceil((len(miss) + 1) * COVERED)), len(miss)) - 1
    band = np.sort(np.abs(miss), axis=0)[rank]
    return Group(values.shape[1:], mean, rows[:count], found, band)


def judge(emulator: Emulator, unseen: Samples) -> list[dict[str, Any]]:
    """How far an emulator is off for scenes that it was not fitted to, a row a quantity.

    Relative errors at the last moment; of energies under the middle, at all depths together.
    ``covered`` is the share within the emulator's own band, at all moments and receptors.
    """
    found, rows = emulator.values(unseen.points), []
    middle = emulator.grids["receptor_offset"] == 0
    for name in (*LOGARITHMIC, ENERGY):
        ratio, miss = found[name] / unseen.values[name], found[name] - unseen.values[name]
        if name in LOGARITHMIC:
            miss = np.log(ratio)
        last = ratio[:, -1]
        if name == ENERGY:
            band, last = emulator.energy_band(unseen.points), last[:, middle] ** 2
            name = "strain_energy_density"
        else:
            band = emulator.groups[name].band.reshape(miss.shape[1:])
        inside = np.abs(miss) <= band
        off = np.abs(last[np.isfinite(last)] - 1)
        row = {"quantity": name, "scenes": len(miss), "median": float(np.median(off))}
        row |= {"within_95": float(np.quantile(off, 0.95)), "covered": float(inside.mean())}
        rows.append(row)
    return rows

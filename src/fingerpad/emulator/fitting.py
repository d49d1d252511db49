"""From the histories of a sweep to an emulator.

The principal components of each quantity are Gaussian processes in the knobs, about a parabola of
them. The error is that of scenes left out, one at a time, of the whole way from knobs to quantity.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import exponents, local_size, nearby
from fingerpad.emulator.model import ENERGY, SCALARS, SLID, Emulator, Group, in_logarithm
from fingerpad.emulator.process import (
    DEGREE,
    SEARCHED,
    chosen_noise,
    lengths_of,
    missed,
    regressed,
    root_mean_square,
    terms_of,
)
from fingerpad.emulator.question import Knob, scaled
from fingerpad.emulator.samples import Samples, Swept

COVERED = 0.95
"""Share of scenes left out that the band holds."""
TRUNCATED = 5e-4
"""Root mean square of what principal components may leave of a quantity (of its logarithm, or of
its scale).
"""
MOST_PARTS = 14
SMOOTH = (*SCALARS, *SLID, "pressure_shape", "skin_displacement_x", "skin_displacement_y")
"""Quantities whose lengths are the same."""


def emulate(sweep: str | Path, unseen: str | Path | None = None) -> Emulator:
    """Fit an emulator to the histories of a sweep.

    Parameters
    ----------
    sweep
        Folder of a finished sweep of presses, alone or before a hold or a slide, whose file says
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
    swept = Swept.read(Path(sweep))
    return fitted(swept, judge_by(swept, unseen) if unseen else None)


def judge_by(swept: Swept, unseen: str | Path) -> Samples:
    """What another sweep of the same scene over the same keys shows. Raises SceneError: also where
    it shares a scene with this one.
    """
    both = swept.with_more(Path(unseen)).samples
    found = both.only(np.arange(len(swept.samples.points), len(both.points)))
    if not len(found.points):
        raise SceneError(f"{unseen}: has no scene that can be judged; allowed: one or more")
    if {*map(tuple, found.points)} & {*map(tuple, swept.samples.points)}:
        raise SceneError(f"{unseen}: has scenes of the sweep itself; allowed: another seed")
    return found


def fitted(swept: Swept, unseen: Samples | None = None) -> Emulator:
    """The emulator of a sweep, judged by unseen scenes or by a tenth of its own. Raises
    SceneError.
    """
    samples = swept.samples
    enough(swept)
    swept = replace(swept, knobs=warped(swept.knobs, samples))
    made = _fit(swept)
    if unseen is None:
        every = np.arange(len(samples.points))
        tenth = every % 10 == min(9, len(every) - 1)
        trial = _fit(replace(swept, samples=samples.only(every[~tenth])))
        judged = judge(trial, samples.only(every[tenth]))
    else:
        judged = judge(made, unseen)
    return replace(made, about={**made.about, "held_out": judged})


# --- the fit --------------------------------------------------------------------------------------


def warped(knobs: list[Knob], samples: Samples) -> list[Knob]:
    """Each knob that is drawn evenly on the scale that leaves the least of depth, width and
    pressure unexplained, and of the lateral force of a stroke.
    """
    some = samples.only(np.arange(min(len(samples.points), SEARCHED))).values
    shown = [np.log(some[name][:, -1]) for name in SCALARS[:3]]
    shown += [some[SLID[1]][:, -1]] if SLID[1] in some else []
    target = np.stack(shown, axis=1)
    target -= target.mean(axis=0)

    def left(of: list[Knob]) -> float:
        at = scaled(of, samples.points[: len(target)])
        return root_mean_square(missed(terms_of(at, at, np.full(len(of), 2.0)), 1e-4, target))

    for k, knob in enumerate(knobs):
        ways = ("linear", "bent") if knob.warp == "linear" else (knob.warp,)
        tried = [[*knobs[:k], replace(knob, warp=w), *knobs[k + 1 :]] for w in ways]
        knobs = min(tried, key=left)
    return knobs


def lengths(swept: Swept) -> np.ndarray:
    """Lengths (knobs,) of the Gaussian processes of all but energies."""
    values = swept.samples.values
    parts = [Parts.of(values[name], name).scores for name in SMOOTH if name in values]
    return lengths_of(scaled(swept.knobs, swept.samples.points), parts)


def _fit(swept: Swept) -> Emulator:
    """An emulator of a sweep, with the errors of scenes left out."""
    knobs, grids, samples = swept.knobs, swept.grids, swept.samples
    about = {**swept.about, "scenes": len(samples.points), "scenes_left_out": swept.lost}
    at = scaled(knobs, samples.points)
    powers = exponents(len(knobs), DEGREE)
    made = Emulator(knobs, swept.base, swept.moments, grids, powers, at, {}, about)
    parts = {name: Parts.of(v, name) for name, v in samples.values.items() if name != ENERGY}
    scales = lengths(swept)
    every, terms = np.arange(len(at)), terms_of(at, at, scales)
    groups = {name: _group(terms, at, every, p, scales) for name, p in parts.items()}
    layers, of = made.layers(samples.points), grids["receptor_depth"]
    for k, depth in enumerate(np.unique(of)):
        kept = {layer: np.flatnonzero(layers[:, k] == layer) for layer in np.unique(layers[:, k])}
        values = samples.values[ENERGY][..., of == depth]
        parts = {layer: Parts.of(values[r], ENERGY, made.turned) for layer, r in kept.items()}
        main = max(kept, key=lambda layer: len(kept[layer]))
        scales = lengths_of(at[kept[main]], [parts[main].scores])
        terms = terms_of(at, at, scales)
        for layer, rows in kept.items():
            if len(rows) > len(knobs) + 1:
                groups[f"{ENERGY}_{k}_{layer}"] = _group(terms, at, rows, parts[layer], scales)
    return replace(made, groups=groups)


def enough(swept: Swept) -> None:
    """Raises SceneError where a sweep has too few scenes."""
    count, least = len(swept.samples.points), 4 * len(swept.knobs) + 4
    if count < least:
        raise SceneError(
            f"{swept.folder}: has {count} scenes that can be emulated; allowed: {least} or more"
        )


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
    def of(cls, values: np.ndarray, name: str, turned: bool = False) -> Parts:
        """Of values (n, ...)."""
        flat = values.reshape(len(values), -1)
        target = np.log(flat) if in_logarithm(name, turned) else flat
        mean = target.mean(axis=0)
        own, sizes, rows = np.linalg.svd(target - mean, full_matrices=False)
        rest = np.sqrt(np.append(np.cumsum(sizes[::-1] ** 2)[::-1][1:], 0.0) / target.size)
        count = min(int(np.argmax(rest <= TRUNCATED)) + 1, MOST_PARTS, len(sizes))
        return cls(values.shape[1:], target, mean, rows[:count], own[:, :count] * sizes[:count])


def _group(
    terms: np.ndarray, at: np.ndarray, rows: np.ndarray, parts: Parts, scales: np.ndarray
) -> Group:
    """A quantity that some of the scenes have, at the terms (n, terms) of all, which are at (n,
    knobs).
    """
    trend = terms.shape[1] - len(terms)
    kept = np.concatenate([np.arange(trend), trend + rows])
    own, some = terms[np.ix_(rows, kept)], rows[:SEARCHED]
    few = terms[np.ix_(some, np.concatenate([np.arange(trend), trend + some]))]
    noise = chosen_noise(few, parts.scores[:SEARCHED])
    off, found = regressed(own, noise, parts.scores)
    coefficients = np.zeros((terms.shape[1], found.shape[1]))
    coefficients[kept] = found
    miss = parts.target - parts.mean - (parts.scores - off) @ parts.rows
    usual = np.sqrt((miss**2).mean(axis=0))
    usual = np.maximum(usual, max(1e-9 * usual.max(), 1e-300))
    missed_by = np.full(len(terms), np.nan)
    missed_by[rows] = np.sqrt(((miss / usual) ** 2).mean(axis=1))
    near = nearby(at[rows], at)
    near[np.arange(len(rows)), rows] = 0.0  # a scene says nothing of itself
    around = local_size(near, missed_by)
    rank = min(int(np.ceil((len(miss) + 1) * COVERED)), len(miss)) - 1
    band = np.sort(np.abs(miss) / np.maximum(around, 1e-300)[:, None], axis=0)[rank]
    return Group(parts.shape, parts.mean, parts.rows, coefficients, band, scales, missed_by)


def judge(emulator: Emulator, unseen: Samples) -> list[dict[str, Any]]:
    """How far an emulator is off for scenes that it was not fitted to, a row a quantity.

    Relative errors from the end of the press on; of energies nearest to the middle. Under a stroke,
    which may leave the middle, these are over the largest of the way, and lateral forces are over
    the normal force. ``covered`` is the share within the emulator's own band, at all moments and
    receptors.
    """
    found, rows = emulator.values(unseen.points), []
    top, grids = len(emulator.moments.press) - 1, emulator.grids

    def add(name: str, ratio: np.ndarray, inside: np.ndarray) -> None:
        off = np.abs(ratio[np.isfinite(ratio)] - 1)
        row = {"quantity": name, "scenes": len(unseen.points), "median": float(np.median(off))}
        row |= {"within_95": float(np.quantile(off, 0.95)), "covered": float(inside.mean())}
        rows.append(row)

    for name in (*emulator.moments.scalars, "estimated_error"):
        ratio = found[name] / unseen.values[name]
        inside = np.abs(np.log(ratio)) <= emulator.band(name, unseen.points)
        add(name, ratio[:, top:] if name != "estimated_error" else ratio, inside)
    slid = emulator.moments.slid
    if slid:
        off = found[SLID[1]] - unseen.values[SLID[1]]
        band = emulator.band(SLID[1], unseen.points)
        add("tangential_force", 1 + off[:, top:], np.abs(off) <= band)
    roots = found[ENERGY], unseen.values[ENERGY]
    if in_logarithm(ENERGY, emulator.turned):
        roots = np.log(roots[0]), np.log(roots[1])
    inside = np.abs(roots[0] - roots[1]) <= emulator.band(ENERGY, unseen.points)
    for depth in np.unique(grids["receptor_depth"]):
        at = grids["receptor_depth"] == depth
        aside = np.abs(grids["receptor_offset"])
        middle = at & (aside == aside[at].min())
        shown, true = (of[ENERGY][:, top:, middle] ** 2 for of in (found, unseen.values))
        size = true.max(axis=1, keepdims=True) if slid else true
        add(f"strain_energy_{1e6 * depth:.4g}_um", 1 + (shown - true) / size, inside[..., at])
    return rows

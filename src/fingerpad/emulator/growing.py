"""More scenes for an emulator, where it knows least.

A scene is worth most where the Gaussian process is least sure (its variance; Rasmussen and Williams
2006, eq 2.26) and where scenes nearby, left out, are missed by most. After each choice the variance
is that of the process which knows this scene too, so the scenes of a batch keep apart.
"""

from __future__ import annotations

import csv
import time
from collections.abc import Callable
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import basis, exponents, kernel, nearby
from fingerpad.emulator.fitting import COVERED, enough, fitted, judge_by, lengths, warped
from fingerpad.emulator.model import Emulator
from fingerpad.emulator.process import DEGREE, FREE, chosen_noise, missed, terms_of
from fingerpad.emulator.question import scaled
from fingerpad.emulator.samples import GROWN, Swept
from fingerpad.scenes.scene import recorded_scene
from fingerpad.sweeps.engine import sweep as run_sweep

BATCH = 32
"""Scenes between two looks."""
CANDIDATES = 1024
"""Places that are looked at for a batch; a power of two."""
TO_ENDS = 1.06
"""They are spread over so many times the box and brought back to its ends, which need scenes."""
MOST_CORNERED = 6
"""Knobs of a box whose corners are looked at too: an emulator knows least there."""
NOISE = 1e-5
"""Variance of what the process does not explain."""


def grow(
    sweep: str | Path,
    tolerance: float,
    scenes: int = 500,
    seconds: float = np.inf,
    cores: int = 1,
    unseen: str | Path | None = None,
    progress: Callable[[int, float], object] | None = None,
) -> Emulator:
    """Fit an emulator, and add scenes to its sweep until it is good enough.

    Parameters
    ----------
    sweep
        As `fingerpad.emulate` takes it. The scenes that are added are kept in its folder: they
        belong to it from then on.
    tolerance
        Relative error of depth, width and pressures at the last moment, within which 95 % of the
        sweep's own scenes must be, left out one at a time. Those that are added lie where it is
        hard, and say nothing of the others.
    scenes, seconds
        The budget: no more scenes are added, and none is begun later.
    cores
        Processes at a time.
    unseen
        See `fingerpad.emulate`.
    progress
        Called with how many scenes were added and with the error after each batch.

    Returns
    -------
    Emulator
        Its ``about["grown"]`` tells ``added``, ``error``, ``tolerance`` and whether it is ``met``.

    Raises
    ------
    SceneError
        The folder holds no sweep that can be emulated; one line.

    Examples
    --------
    >>> import fingerpad, tempfile
    >>> press = {"stimulus": {"shape": "flat"}, "motion": [{"press_to_force": "20 gf"}],
    ...          "accuracy": "draft"}
    >>> over = {"motion[0].press_to_force": {"range": ["10 gf", "40 gf"]}}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = fingerpad.sweep(press, over, out=folder, design="sobol", samples=16,
    ...                         histories=True)
    ...     pad = fingerpad.grow(folder, 0.05, scenes=4)
    >>> pad.about["grown"]["met"], pad.about["grown"]["added"]
    (True, 0)
    """
    for name, value in (("tolerance", tolerance), ("scenes", scenes), ("seconds", seconds)):
        if not value > 0:
            raise SceneError(f"{sweep}: {name}: {value:g} is no limit; allowed: above zero")
    swept, began, added = Swept.read(Path(sweep)), time.monotonic(), 0
    enough(swept)
    while True:
        swept = replace(swept, knobs=warped(swept.knobs, swept.samples))
        scales, at = lengths(swept), scaled(swept.knobs, swept.samples.points)
        off = _off(swept, terms_of(at, at, scales))
        error = float(np.quantile(off[: swept.drawn], COVERED))
        if progress:
            progress(added, error)
        wanted = min(BATCH, scenes - added)
        if error <= tolerance or wanted < 1 or time.monotonic() - began > seconds:
            break
        places = _next(at, scales, off, wanted)
        columns = [k.unscaled(x) for k, x in zip(swept.knobs, places.T, strict=True)]
        swept = swept.with_more(_run(swept, np.stack(columns, axis=1), cores))
        added += wanted
    made = fitted(swept, judge_by(swept, unseen) if unseen else None)
    grown = {"added": added, "error": error, "tolerance": tolerance, "met": error <= tolerance}
    return replace(made, about={**made.about, "grown": grown})


def _off(swept: Swept, terms: np.ndarray) -> np.ndarray:
    """By how much each scene (n,) is missed by the others: the worst of its scalars, relative."""
    names = swept.moments.scalars
    target = np.log(np.stack([swept.samples.values[n][:, -1] for n in names], axis=1))
    target -= target.mean(axis=0)
    return np.abs(np.expm1(missed(terms, chosen_noise(terms, target), target))).max(axis=1)


def _next(known: np.ndarray, scales: np.ndarray, off: np.ndarray, count: int) -> np.ndarray:
    """Places (count, knobs), from -1 to 1, of the scenes that are worth most beside known ones (n,
    knobs) that are missed by ``off`` (n,).
    """
    from scipy.stats import qmc  # takes a second

    drawn = qmc.Sobol(len(scales), seed=len(known)).random(CANDIDATES)
    places = np.clip(TO_ENDS * (2 * drawn - 1), -1, 1)
    if len(scales) <= MOST_CORNERED:
        places = np.vstack([places, list(product((-1.0, 1.0), repeat=len(scales)))])
    near = nearby(places, known)
    errors = near @ off**2 / near.sum(axis=1)
    powers = exponents(len(scales), DEGREE)

    def covariance(a: np.ndarray, b: np.ndarray) -> np.ndarray:
        return kernel(a, b, scales) + FREE * basis(a, powers) @ basis(b, powers).T

    own = covariance(known, known) + NOISE * np.eye(len(known))
    cross = covariance(known, places)
    left = covariance(places, places) - cross.T @ np.linalg.solve(own, cross)
    chosen = []
    for _ in range(count):
        best = int(np.argmax(np.diag(left) * errors))
        chosen.append(best)
        left -= np.outer(left[best], left[best]) / (left[best, best] + NOISE)
    return places[chosen]


def _run(swept: Swept, points: np.ndarray, cores: int) -> Path:
    """Simulate scenes in a folder of their own below the sweep's."""
    number = len(list((swept.folder / GROWN).glob("*.csv"))) + 1
    folder = swept.folder / GROWN / f"{number:03d}"
    folder.parent.mkdir(exist_ok=True)
    table = folder.with_suffix(".csv")
    with table.open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file)
        units = (f" ({knob.unit})" if knob.unit != "1" else "" for knob in swept.knobs)
        rows.writerow(k.key + unit for k, unit in zip(swept.knobs, units, strict=True))
        for point in points:
            parts = zip(swept.knobs, point, strict=True)
            rows.writerow(f"{value / knob.per_unit:.9g}" for knob, value in parts)
    over = {"table": str(table.resolve())}
    run_sweep(recorded_scene(swept.base), over, out=folder, cores=cores, histories=True)
    return folder

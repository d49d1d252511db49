"""Constants of the laws of :mod:`fingerpad.receptors.laws`, fitted to samples, with intervals that
know how the samples group.

Samples along one history follow one another closely and what a law leaves over is its own error,
not noise: intervals from the scatter of samples would be far too narrow. They come from leaving out
one group (a surface, a node) after the other instead (jackknife; Efron and Tibshirani 1993, chapter
11).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.linalg import lstsq
from scipy.optimize import minimize_scalar
from scipy.special import stdtrit

from fingerpad.receptors.laws import SpatialSum, rectified


@dataclass(frozen=True)
class SkinSample:
    """Contact pressure on the skin and the strain energy under it, through one history.

    Attributes
    ----------
    x : (nt, n) m, deformed.
    pressure : (nt, n) Pa.
    indentation : (nt,) m.
    energy : (nt,) Pa.
    reference : (nt,) m, or a number.
    """

    x: np.ndarray
    pressure: np.ndarray
    indentation: np.ndarray
    energy: np.ndarray
    reference: np.ndarray | float = 0.0
    _weighted: dict[float, np.ndarray] = field(default_factory=dict, init=False, repr=False)

    def weighted(self, r: float) -> np.ndarray:
        """Integral (time) Pa m of Eq 4-4 with a spatial constant r (m); kept, for fits that leave
        groups out ask for it again.
        """
        if r not in self._weighted:
            self._weighted[r] = SpatialSum(r).weighted_pressure(
                self.x, self.pressure, self.reference
            )
        return self._weighted[r]

    def by(self, law: SpatialSum, shift: np.ndarray | float = 0.0) -> np.ndarray:
        """Strain energy (time) Pa by a law, of a receptor that is a shift (m) to the side."""
        return law.strain_energy(self.x, self.pressure, self.indentation, shift)


def linear(terms: np.ndarray, data: np.ndarray) -> np.ndarray:
    """Constants (p,) of ``data = terms @ constants`` by least squares; terms (n, p) of any
    scales.
    """
    scale = np.maximum(np.abs(terms).max(axis=0), 1e-300)
    return lstsq(terms / scale, data)[0] / scale


EQ_4_4, PRESSURE_ONLY, SQUARE = ("constant", "per_depth"), ("constant",), ("square",)
"""Constants of `SpatialSum` that a law has: the thesis's; those of a device that does not know the
depth; of the square of the sum alone.
"""


def spatial_sum(
    samples: Sequence[SkinSample],
    constants: Sequence[str] = EQ_4_4,
    bounds: tuple[float, float] = (2e-5, 2e-2),
) -> SpatialSum:
    """The law of pressure closest to the strain energies of several histories: r by search, the
    constants exactly at every r.

    Parameters
    ----------
    constants : such as `EQ_4_4`, `PRESSURE_ONLY` or `SQUARE`; the others are 0.
    bounds : m, of r.
    """
    data, depth = (
        np.concatenate([getattr(sample, name) for sample in samples])
        for name in ("energy", "indentation")
    )

    def at(log_r: float) -> tuple[np.ndarray, np.ndarray]:
        weighted = np.concatenate([sample.weighted(float(np.exp(log_r))) for sample in samples])
        laws = (SpatialSum(1.0, **{name: 1.0}) for name in constants)
        terms = np.column_stack([law.of_sum(weighted, depth) for law in laws])
        return terms, linear(terms, data)

    def misfit(log_r: float) -> float:
        terms, constants = at(log_r)
        return float(((data - terms @ constants) ** 2).sum())

    log_r = _least(misfit, np.linspace(*np.log(bounds), 15), 1e-5)
    found = dict(zip(constants, at(log_r)[1].tolist(), strict=True))
    return SpatialSum(float(np.exp(log_r)), **found)


def constant_shift(
    law: SpatialSum, sample: SkinSample, bounds: tuple[float, float] = (-3e-3, 3e-3)
) -> float:
    """The one lateral shift (m) of a receptor with which a law comes closest to the strain energy
    of a stroke.
    """

    def misfit(shift: float) -> float:
        return float(((sample.by(law, shift) - sample.energy) ** 2).sum())

    return _least(misfit, np.linspace(*bounds, 25), 1e-7)


def _least(misfit: Callable[[float], float], grid: np.ndarray, tolerance: float) -> float:
    """Where a misfit is least, searched for around the best point of a grid: it may have more than
    one dip.
    """
    best = int(np.argmin([misfit(place) for place in grid]))
    around = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]
    return float(minimize_scalar(misfit, bounds=around, options={"xatol": tolerance}).x)


def jackknife(
    fit: Callable[[Sequence[Any]], np.ndarray], groups: Sequence[Any], level: float = 0.95
) -> np.ndarray:
    """Estimates and confidence intervals (p, 3), low and high last, from fits that leave out one
    group each.

    Parameters
    ----------
    fit : groups -> parameters (p,).
    groups : three at least, else the intervals are not a number.
    """
    whole, n, half = np.asarray(fit(groups), float), len(groups), np.nan
    if n >= 3:
        without = np.array([fit([*groups[:k], *groups[k + 1 :]]) for k in range(n)])
        half = stdtrit(n - 1, 0.5 + level / 2) * np.sqrt(n - 1) * without.std(axis=0)
    return np.column_stack([whole, whole - half, whole + half])


def rms(values) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(np.square(values))))


def r_squared(data: np.ndarray, predicted: np.ndarray) -> float:
    """Share of the variance that a prediction explains; negative where the mean does better."""
    data = np.asarray(data, float)
    spread = float(((data - data.mean()) ** 2).sum())
    return 1 - float(((data - predicted) ** 2).sum()) / spread if spread else float("nan")


@dataclass(frozen=True)
class GainAndThreshold:
    """Impulse rate ``gain * [stimulus - threshold]+``: the same two constants for every stimulus.

    Attributes
    ----------
    gain : (impulses/s) by unit of the stimulus, not negative.
    threshold : in the stimulus's unit; below the least stimulus it stands for a discharge that
        needs none.
    """

    gain: float
    threshold: float

    def __call__(self, stimulus) -> np.ndarray:
        """Impulse rate, impulses/s."""
        return rectified(self.gain * (np.asarray(stimulus, float) - self.threshold))


def gain_and_threshold(stimulus: np.ndarray, rate: np.ndarray) -> GainAndThreshold:
    """The gain and threshold closest to rates by least squares, the rectified law fitted exactly.

    With the k weakest stimuli below the threshold the rest is a straight line, so every k is tried.
    A stimulus that falls where the rate rises predicts the mean rate: gain 0 is not a law, so the
    smallest gain that a float carries stands for it. A threshold below zero says that these rates
    do not fall to nothing with the stimulus.
    """
    stimulus, rate = np.asarray(stimulus, float), np.asarray(rate, float)
    scale = max(float(np.ptp(stimulus)), float(np.abs(stimulus).max()) * 1e-12, 1e-300)
    tiny = 1e-9 * max(float(np.abs(rate).max()), 1e-300) / scale
    best = GainAndThreshold(tiny, float(stimulus.mean() - rate.mean() / tiny))
    least = float(((rate - best(stimulus)) ** 2).sum())
    for law in _rising_lines(stimulus, rate, 1e-12 * scale, tiny):
        misfit = float(((rate - law(stimulus)) ** 2).sum())
        if misfit < least * (1 - 1e-12):
            best, least = law, misfit
    return best


def _rising_lines(
    stimulus: np.ndarray, rate: np.ndarray, least_range: float, least_gain: float
) -> list[GainAndThreshold]:
    """Lines through all stimuli, all but the weakest, and so on, by least squares; those that rise,
    of stimuli that differ.
    """
    order = np.argsort(stimulus, kind="stable")
    s, y = stimulus[order] - stimulus.mean(), rate[order]
    first = np.flatnonzero(s[-1] - s > least_range)
    used = np.arange(len(s)) >= first[:, None]
    middle, mean = (used @ values / used.sum(axis=1) for values in (s, y))
    apart = used * (s - middle[:, None])
    gains = apart @ y / (apart**2).sum(axis=1)
    rising = gains > least_gain
    thresholds = stimulus.mean() + middle[rising] - mean[rising] / gains[rising]
    return [
        GainAndThreshold(*each)
        for each in zip(gains[rising].tolist(), thresholds.tolist(), strict=True)
    ]


def leave_one_out(stimulus: np.ndarray, rate: np.ndarray, groups: np.ndarray) -> np.ndarray:
    """Rates (n,) predicted by the gain and threshold that the other groups give. groups: (n,)
    labels, such as curvatures.
    """
    stimulus, rate, groups = map(np.asarray, (stimulus, rate, groups))
    predicted = np.empty(len(rate))
    for label in np.unique(groups):
        out = groups == label
        predicted[out] = gain_and_threshold(stimulus[~out], rate[~out])(stimulus[out])
    return predicted

"""From an impulse rate to impulses, and back: an integrate-and-fire receptor, rasters, histograms
and instantaneous frequency.

The receptor integrates its rate and fires whenever the integral has grown by a threshold: 1 without
variability, so that the number of impulses is the integral of the rate. With variability the
thresholds are drawn anew for every interval from a gamma distribution with mean 1; its coefficient
of variation is that of the intervals at a steady rate.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.integrate import cumulative_trapezoid

VARIATION = 0.25
"""Coefficient of variation of the intervals at a steady rate: assumed, the thesis states none.
Numbers of impulses then vary by ``VARIATION * sqrt(number)``, by less than one up to 16; those of
repeated trials of SA-I receptors of monkeys do (standard deviation; Vega-Bermudez and Johnson 1999,
J Neurophysiol 81:2701, abstract).
"""


def integrated(time, rate) -> np.ndarray:
    """Integral (n,) of a rate (n,) from the first time (n,) s on; the rate is linear in between, a
    repeated time is a jump.
    """
    return cumulative_trapezoid(rate, time, initial=0.0)


def impulses(
    time,
    rate,
    variation: float = 0.0,
    seed: int | np.random.Generator | np.random.SeedSequence | None = None,
) -> np.ndarray:
    """Times (m,) s of impulses at an instantaneous rate.

    Parameters
    ----------
    time
        (n,) s, not falling; a repeated time is a jump of the rate.
    rate
        (n,) impulses/s, not negative, linear in between.
    variation
        Coefficient of variation of the threshold. 0 is deterministic: an impulse whenever the
        integral of the rate passes a whole number. Otherwise a trial also starts anywhere in an
        interval (length-biased, so that the mean number of impulses is the integral of the rate).
    seed
        Of the variability; needed if there is any.

    Raises
    ------
    ValueError
        A rate is negative or not finite, times fall, or there is variability without a seed.
    """
    time, rate = np.asarray(time, float), np.asarray(rate, float)
    if not np.isfinite(rate).all() or (rate < 0).any():
        raise ValueError("impulse rates must be finite and not negative")
    if (np.diff(time) < 0).any():
        raise ValueError("times must not fall")
    grown = integrated(time, rate)
    due = _thresholds(grown[-1], variation, seed)
    after = np.minimum(np.searchsorted(grown, due, side="left"), len(grown) - 1)
    before = np.maximum(after - 1, 0)
    # the integral is a parabola between samples; this form of its root holds for constant, rising
    # and falling rates
    dt, need, a = time[after] - time[before], due - grown[before], rate[before]
    slope = np.divide(rate[after] - a, dt, out=np.zeros_like(dt), where=dt > 0)
    root = a + np.sqrt(np.maximum(a**2 + 2 * slope * need, 0))
    return time[before] + np.minimum(
        np.divide(2 * need, root, out=np.zeros_like(need), where=root > 0), dt
    )


def _thresholds(total: float, variation: float, seed) -> np.ndarray:
    """Integrals of the rate at which impulses are due, up to `total`."""
    if not variation:
        return np.arange(1, int(total * (1 + 1e-12)) + 1, dtype=float)
    if seed is None:
        raise ValueError("variability needs a seed, so that the impulses can be made again")
    random, shape = np.random.default_rng(seed), variation**-2
    # a place in the interval that is under way
    due = np.array([random.uniform() * random.gamma(shape + 1, 1 / shape)])
    while due[-1] <= total:
        more = random.gamma(shape, 1 / shape, size=int(1.2 * total) + 16)
        due = np.concatenate([due, due[-1] + np.cumsum(more)])
    return due[due <= total]


def trains(
    time, rate, repetitions: int, seed: int, variation: float = VARIATION
) -> list[np.ndarray]:
    """Impulse times (s) of several repetitions, each with a variability of its own; the first ones
    do not depend on how many.
    """
    seeds = np.random.SeedSequence(seed).spawn(repetitions)
    return [impulses(time, rate, variation, own) for own in seeds]


def binned_rate(trains: Sequence[np.ndarray], edges) -> np.ndarray:
    """Mean impulse rate (n - 1,) impulses/s of several trains in bins between edges (n,) s.

    For bins of 0.5 mm of a stroke at v m/s the edges are ``np.arange(0, length, 0.5e-3) / v``.
    """
    edges = np.asarray(edges, float)
    counts = np.histogram(np.concatenate([np.asarray(train, float) for train in trains]), edges)[0]
    return counts / np.diff(edges) / len(trains)


def instantaneous_frequency(train, at=None) -> np.ndarray:
    """Inverse of the interval between impulses, 1/s.

    Parameters
    ----------
    train
        (m,) s, increasing.
    at
        (...) s; left out, one frequency an interval, (m - 1,).

    Returns
    -------
    np.ndarray
        At the times `at` that of the interval they fall into, 0 before the first impulse and from
        the last one on.
    """
    train = np.asarray(train, float)
    frequency = 1 / np.diff(train)
    if at is None:
        return frequency
    interval = np.searchsorted(train, np.asarray(at, float), side="right")
    return np.concatenate([[0.0], frequency, [0.0]])[np.minimum(interval, len(frequency) + 1)]

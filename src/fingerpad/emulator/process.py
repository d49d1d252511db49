"""A Gaussian process in the knobs about a parabola of them: its fit, and by how much scenes that
were left out are missed.
"""

from __future__ import annotations

import warnings

import numpy as np

from fingerpad.emulator.basis import basis, exponents, kernel

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


def terms_of(points: np.ndarray, centres: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Values (n, terms) at points (n, knobs): the parabola, then covariances with centres (m,
    knobs); scales: (knobs,) lengths.
    """
    trend = basis(points, exponents(points.shape[1], DEGREE))
    return np.hstack([trend, kernel(points, centres, scales)])


def regressed(
    terms: np.ndarray, noise: float, target: np.ndarray, free: float = FREE
) -> tuple[np.ndarray, np.ndarray]:
    """What predictions of scenes left out one at a time miss (n, parts), and the coefficients
    (terms, parts) of a Gaussian process about a trend (Rasmussen and Williams 2006, sections 2.7
    and 5.4.2).

    Parameters
    ----------
    terms
        (n, terms) of the scenes at their own places, as `terms_of` gives them.
    noise, free
        Variances of what nothing explains and of a coefficient of the trend, over that of the
        process.
    target
        (n, parts).
    """
    trend, covariance = np.split(terms, [terms.shape[1] - len(terms)], axis=1)
    total = covariance + free * trend @ trend.T
    total[np.diag_indices(len(total))] += noise
    inverse = np.linalg.inv(total)
    weights = inverse @ target
    return weights / np.diag(inverse)[:, None], np.vstack([free * trend.T @ weights, weights])


def missed(terms: np.ndarray, noise: float, target: np.ndarray) -> np.ndarray:
    """What predictions (n, parts) of scenes left out one at a time miss."""
    return regressed(terms, noise, target)[0]


def chosen_noise(terms: np.ndarray, target: np.ndarray) -> float:
    """The noise with which scenes left out are missed by least."""
    return min(NOISES, key=lambda noise: root_mean_square(missed(terms, noise, target)))


def root_mean_square(values: np.ndarray) -> float:
    """Of all values (...)."""
    return float(np.sqrt((values**2).mean()))


def lengths_of(points: np.ndarray, scores: list[np.ndarray]) -> np.ndarray:
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

"""An emulator of the design: what a pad that was not simulated would show, and how far off that may
be.

A quadratic polynomial in all unknowns for the large, a Gaussian process for what it leaves
(universal kriging in two steps; Sacks and others 1989, Stat. Sci. 4:409), one set of length scales
for all measures, so that a prediction of all of them costs one kernel. Measures above zero are
emulated in their logarithm. The error stated is that of pads left out: everything but the length
scales is fitted anew without them.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
import pandas as pd
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel
from sklearn.linear_model import LinearRegression

FOLDS = 10
LENGTHS = (0.3, 30.0)
"""Least and largest length scale, of the range of an unknown."""


@dataclass
class Emulator:
    """Predicts measures at shares of the design's ranges.

    Attributes:
        names: (m,) measures. logarithmic: (m,) which are emulated in their logarithm. error: (m,)
        root mean square error of pads left out, of the logarithm where that is emulated. q2: (m,)
        share of the variance explained of pads left out. pads: how many it rests on.
    """

    names: list[str]
    logarithmic: np.ndarray
    error: np.ndarray
    q2: np.ndarray
    pads: int
    _trend: LinearRegression
    _lengths: np.ndarray
    _points: np.ndarray
    _weights: np.ndarray

    @classmethod
    def fit(cls, shares: np.ndarray, values: pd.DataFrame, seed: int = 0) -> Emulator:
        """Fit to pads.

        Args:
            shares: (n, d) of the design's ranges. values: (n, m) measures by name; without gaps.
        """
        y = values.to_numpy(float)
        logarithmic = (y > 0).all(axis=0)
        target = np.where(logarithmic, np.log(np.where(logarithmic, y, 1.0)), y)
        x = 2 * np.asarray(shares, float) - 1
        trend, rest, scale = _polynomial(x, target)
        kernel = RBF(np.full(x.shape[1], 3.0), tuple(2 * v for v in LENGTHS)) + WhiteKernel(
            0.1, (1e-4, 1.0)
        )
        chosen = np.random.default_rng(seed).permutation(len(x))[:400]
        process = GaussianProcessRegressor(kernel, random_state=seed)
        with (
            warnings.catch_warnings()
        ):  # of length scales at their bounds: an unknown that hardly matters
            warnings.simplefilter("ignore", ConvergenceWarning)
            process.fit(x[chosen], rest[chosen] / scale)
        lengths, noise = process.kernel_.k1.length_scale, process.kernel_.k2.noise_level
        left_out = np.empty_like(target)
        fold = np.arange(len(x)) % FOLDS
        for k in range(FOLDS):
            out = fold == k
            left_out[out] = cls._made([], logarithmic, x[~out], target[~out], lengths, noise)._raw(
                x[out]
            )
        made = cls._made(list(values.columns), logarithmic, x, target, lengths, noise)
        missed = left_out - target
        made.error = np.sqrt((missed**2).mean(axis=0))
        made.q2 = 1 - (missed**2).sum(axis=0) / ((target - target.mean(axis=0)) ** 2).sum(axis=0)
        return made

    @classmethod
    def _made(cls, names, logarithmic, x, target, lengths, noise) -> Emulator:
        trend, rest, scale = _polynomial(x, target)
        matrix = _kernel(x, x, lengths) + noise * np.eye(len(x))
        weights = np.linalg.solve(matrix, rest / scale) * scale
        return cls(names, logarithmic, np.zeros(0), np.zeros(0), len(x), trend, lengths, x, weights)

    def _raw(self, x: np.ndarray) -> np.ndarray:
        trend = (
            _quadratic(x) @ self._trend.coef_.T + self._trend.intercept_
        )  # a prediction of one pad is not to be checked twice
        return trend + _kernel(x, self._points, self._lengths) @ self._weights

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        """Measures (n, m) at shares (n, d)."""
        found = self._raw(2 * np.atleast_2d(shares) - 1)
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found, 0.0)), found)

    def only(self, names: list[str]) -> Emulator:
        """The same for some measures, in this order. Raises ValueError for one that it does not
        know.
        """
        k = [self.names.index(name) for name in names]
        trend = LinearRegression()
        trend.coef_, trend.intercept_ = self._trend.coef_[k], self._trend.intercept_[k]
        parts = (
            self.logarithmic[k],
            self.error[k],
            self.q2[k],
            self.pads,
            trend,
            self._lengths,
            self._points,
            self._weights[:, k],
        )
        return Emulator(list(names), *parts)

    def summary(self) -> pd.DataFrame:
        """A row a measure: its error of pads left out and the share of the variance explained."""
        surface, measure = zip(*(name.split(": ") for name in self.names), strict=True)
        error = np.where(self.logarithmic, 100 * self.error, np.nan)
        absolute = np.where(self.logarithmic, np.nan, self.error)
        return pd.DataFrame(
            {
                "surface": surface,
                "measure": measure,
                "error of pads left out (%)": error,
                "error of pads left out (own unit)": absolute,
                "q2 (1)": self.q2,
                "pads": self.pads,
            }
        )


def _polynomial(x: np.ndarray, target: np.ndarray):
    """The quadratic, what it leaves, and the size of that by measure."""
    terms = _quadratic(x)
    trend = LinearRegression().fit(terms, target)
    rest = target - trend.predict(terms)
    return trend, rest, np.maximum(rest.std(axis=0), 1e-12)


def _quadratic(x: np.ndarray) -> np.ndarray:
    """Terms (n, d (d + 3) / 2) of a quadratic in x (n, d), but for the constant."""
    i, j = np.triu_indices(x.shape[1])
    return np.concatenate([x, x[:, i] * x[:, j]], axis=1)


def _kernel(a: np.ndarray, b: np.ndarray, lengths: np.ndarray) -> np.ndarray:
    a, b = a / lengths, b / lengths
    square = (a**2).sum(1)[:, None] + (b**2).sum(1)[None] - 2 * a @ b.T
    return np.exp(-0.5 * np.maximum(square, 0.0))

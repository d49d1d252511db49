"""An emulator of the design: what a pad that was not simulated would show, and how far off that may
be.

It is the Gaussian process about a parabola of :mod:`fingerpad.emulator`, one a measure; those above
zero are emulated in their logarithm. The stated error is that of pads left out one at a time, by
which its length, its noise and how free the parabola is are chosen.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import pandas as pd

from fingerpad.emulator.basis import basis, exponents, kernel
from fingerpad.emulator.process import DEGREE, FREE, NOISES, regressed, terms_of

LENGTHS = (2.0, 4.0, 8.0)
"""Of the Gaussian process, in all unknowns alike; the range of an unknown is 2."""
FREEDOMS = (FREE, FREE / 100, FREE / 10_000)
"""Variances of the parabola's coefficients: of these there are nearly as many as pads."""
PER_MEASURE = ("logarithmic", "error", "q2", "lengths", "mean")


@dataclass(frozen=True)
class Emulator:
    """Predicts measures at shares of the design's ranges.

    Attributes
    ----------
    names : (m,) measures, "surface: measure".
    logarithmic : (m,) which are emulated in their logarithm.
    error : (m,) root mean square error of pads left out, of the logarithm where that is emulated.
    q2 : (m,) share of the variance explained of pads left out.
    points : (n, d) the pads fitted to, from -1 to 1.
    powers : (polynomials, d) degrees of the trend.
    lengths : (m,) of the Gaussian processes.
    mean, coefficients : (m,), (terms, m).
    """

    names: list[str]
    logarithmic: np.ndarray
    error: np.ndarray
    q2: np.ndarray
    points: np.ndarray
    powers: np.ndarray
    lengths: np.ndarray
    mean: np.ndarray
    coefficients: np.ndarray

    @classmethod
    def fit(cls, shares: np.ndarray, values: pd.DataFrame) -> Emulator:
        """Fit to pads.

        Parameters
        ----------
        shares : (n, d) of the design's ranges.
        values : (n, m) measures by name, without gaps.
        """
        y, points = values.to_numpy(float), 2 * np.asarray(shares, float) - 1
        logarithmic = (y > 0).all(axis=0)
        target = np.where(logarithmic, np.log(np.where(logarithmic, y, 1.0)), y)
        mean, spread = target.mean(axis=0), np.maximum(target.std(axis=0), 1e-300)
        target = (target - mean) / spread
        powers = exponents(points.shape[1], DEGREE)
        error, lengths = np.full((2, target.shape[1]), np.inf)
        coefficients = np.empty((len(powers) + len(points), target.shape[1]))
        for length in LENGTHS:
            terms = terms_of(points, points, np.full(points.shape[1], length))
            for noise, free in product(NOISES, FREEDOMS):
                missed, found = regressed(terms, noise, target, free)
                size = np.sqrt((missed**2).mean(axis=0))
                better = size < error
                error[better], lengths[better] = size[better], length
                coefficients[:, better] = found[:, better]
        return cls(
            list(values.columns),
            logarithmic,
            spread * error,
            1 - error**2,
            points,
            powers,
            lengths,
            mean,
            spread * coefficients,
        )

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        """Measures (n, m) at shares (n, d)."""
        x = 2 * np.atleast_2d(np.asarray(shares, float)) - 1
        trend, found = basis(x, self.powers), np.empty((len(x), len(self.names)))
        for length in np.unique(self.lengths):
            own = self.lengths == length
            terms = np.hstack([trend, kernel(x, self.points, np.full(x.shape[1], length))])
            found[:, own] = terms @ self.coefficients[:, own]
        found += self.mean
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found, 0.0)), found)

    def only(self, names: list[str]) -> Emulator:
        """The same for some measures, in this order; ValueError for an unknown one."""
        k = [self.names.index(name) for name in names]
        own = {name: getattr(self, name)[k] for name in PER_MEASURE}
        return replace(self, names=names, coefficients=self.coefficients[:, k], **own)

    def deviation(self, shown: np.ndarray) -> np.ndarray:
        """Standard deviation (..., m) of predictions: the error of pads left out."""
        return np.where(self.logarithmic, np.abs(shown) * self.error, self.error)

    def summary(self) -> pd.DataFrame:
        """A row a measure: its error of pads left out and the share of the variance explained."""
        surface, measure = zip(*(name.split(": ") for name in self.names), strict=True)
        return pd.DataFrame(
            {
                "surface": surface,
                "measure": measure,
                "error of pads left out (%)": np.where(self.logarithmic, 100 * self.error, np.nan),
                "error of pads left out (own unit)": np.where(self.logarithmic, np.nan, self.error),
                "q2 (1)": self.q2,
                "pads": len(self.points),
            }
        )

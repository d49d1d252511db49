"""An emulator of the design: what a pad that was not simulated would show, and how far off that may
be.

It is the Gaussian process about a parabola of :mod:`fingerpad.emulator`. Measures of a surface
share its lengths; those above zero are emulated in their logarithm. The stated error is that of
pads left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from fingerpad.emulator.basis import basis, exponents, kernel
from fingerpad.emulator.process import DEGREE, chosen_noise, lengths_of, regressed, terms_of


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
    lengths : by surface, (d,) of the Gaussian process.
    mean, coefficients : (m,), (terms, m).
    """

    names: list[str]
    logarithmic: np.ndarray
    error: np.ndarray
    q2: np.ndarray
    points: np.ndarray
    lengths: dict[str, np.ndarray]
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
        names, lengths = list(values.columns), {}
        missed, found = np.empty_like(target), []
        for surface, columns in _by_surface(names).items():
            lengths[surface] = lengths_of(points, [target[:, [k]] for k in columns])
            terms = terms_of(points, points, lengths[surface])
            for k in columns:
                noise = chosen_noise(terms, target[:, k : k + 1])
                off, coefficients = regressed(terms, noise, target[:, k : k + 1])
                missed[:, k], found = off[:, 0], [*found, coefficients[:, 0]]
        error = np.sqrt((missed**2).mean(axis=0))
        order = np.argsort(np.concatenate(list(_by_surface(names).values())))
        coefficients = spread * np.stack(found, axis=1)[:, order]
        return cls(
            names, logarithmic, spread * error, 1 - error**2, points, lengths, mean, coefficients
        )

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        """Measures (n, m) at shares (n, d)."""
        x = 2 * np.atleast_2d(np.asarray(shares, float)) - 1
        trend, found = basis(x, exponents(x.shape[1], DEGREE)), np.empty((len(x), len(self.names)))
        for surface, columns in _by_surface(self.names).items():
            terms = np.hstack([trend, kernel(x, self.points, self.lengths[surface])])
            found[:, columns] = terms @ self.coefficients[:, columns]
        found += self.mean
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found, 0.0)), found)

    def only(self, names: list[str]) -> Emulator:
        """The same for some measures, in this order; ValueError for an unknown one."""
        k = [self.names.index(name) for name in names]
        own = {name: getattr(self, name)[k] for name in ("logarithmic", "error", "q2", "mean")}
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


def _by_surface(names: list[str]) -> dict[str, list[int]]:
    """Which columns belong to each surface."""
    found: dict[str, list[int]] = {}
    for k, name in enumerate(names):
        found.setdefault(name.partition(":")[0], []).append(k)
    return found

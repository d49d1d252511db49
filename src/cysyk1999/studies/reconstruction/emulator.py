"""An emulator of the design: what a pad that was not simulated would show, and how far off that may
be.

A quadratic polynomial in all unknowns, and a Gaussian process for what it leaves (universal kriging
in two steps; Sacks and others 1989, Stat. Sci. 4:409), with one set of length scales for all
measures. Measures above zero are emulated in their logarithm. The stated error is that of pads left
out: everything but the length scales is fitted anew without them.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from sklearn.base import BaseEstimator, RegressorMixin
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, WhiteKernel
from sklearn.linear_model import LinearRegression
from sklearn.model_selection import PredefinedSplit, cross_val_predict
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures

FOLDS = 10
LENGTHS = (0.6, 60.0)
"""Least and largest length scale; the range of an unknown is 2."""
CHOSEN = 400
"""Most pads that the length scales are fitted to."""


class Kriging(RegressorMixin, BaseEstimator):
    """A quadratic trend and a Gaussian process for its residuals.

    Parameters
    ----------
    kernel : kernel of scikit-learn
    optimizer : str or None
        How its parameters are fitted; None keeps them.
    """

    def __init__(self, kernel, optimizer: str | None = None):
        self.kernel, self.optimizer = kernel, optimizer

    def fit(self, x: np.ndarray, y: np.ndarray) -> Kriging:
        """Fit to points (n, d) and values (n, m)."""
        quadratic = PolynomialFeatures(2, include_bias=False)
        self.trend_ = make_pipeline(quadratic, LinearRegression()).fit(x, y)
        process = GaussianProcessRegressor(
            self.kernel, optimizer=self.optimizer, normalize_y=True, random_state=0
        )
        self.process_ = process.fit(x, y - self.trend_.predict(x))
        return self

    def predict(self, x: np.ndarray) -> np.ndarray:
        """Values (n, m) at points (n, d)."""
        rest = self.process_.predict(x)
        return self.trend_.predict(x) + rest.reshape(len(x), -1)


@dataclass(frozen=True)
class Emulator:
    """Predicts measures at shares of the design's ranges.

    Attributes
    ----------
    names : (m,) measures.
    logarithmic : (m,) which are emulated in their logarithm.
    error : (m,) root mean square error of pads left out, of the logarithm where that is emulated.
    q2 : (m,) share of the variance explained of pads left out.
    pads : number of pads fitted to.
    model, columns : the fit of all measures, and which of them are these.
    """

    names: list[str]
    logarithmic: np.ndarray
    error: np.ndarray
    q2: np.ndarray
    pads: int
    model: Kriging
    columns: np.ndarray

    @classmethod
    def fit(cls, shares: np.ndarray, values: pd.DataFrame, seed: int = 0) -> Emulator:
        """Fit to pads.

        Parameters
        ----------
        shares : (n, d) of the design's ranges.
        values : (n, m) measures by name, without gaps.
        """
        y, x = values.to_numpy(float), 2 * np.asarray(shares, float) - 1
        logarithmic = (y > 0).all(axis=0)
        target = np.where(logarithmic, np.log(np.where(logarithmic, y, 1.0)), y)
        kernel = RBF(np.full(x.shape[1], 3.0), LENGTHS) + WhiteKernel(0.1, (1e-4, 1.0))
        chosen = np.random.default_rng(seed).permutation(len(x))[:CHOSEN]
        with warnings.catch_warnings():
            # length scales at their bounds: an unknown that hardly matters
            warnings.simplefilter("ignore", ConvergenceWarning)
            lengths = Kriging(kernel, "fmin_l_bfgs_b").fit(x[chosen], target[chosen])
        model = Kriging(lengths.process_.kernel_)
        folds = PredefinedSplit(np.arange(len(x)) % FOLDS)
        missed = (cross_val_predict(model, x, target, cv=folds) - target) ** 2
        q2 = 1 - missed.sum(axis=0) / ((target - target.mean(axis=0)) ** 2).sum(axis=0)
        error, names = np.sqrt(missed.mean(axis=0)), list(values.columns)
        columns = np.arange(len(names))
        return cls(names, logarithmic, error, q2, len(x), model.fit(x, target), columns)

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        """Measures (n, m) at shares (n, d)."""
        found = self.model.predict(2 * np.atleast_2d(shares) - 1)[:, self.columns]
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found, 0.0)), found)

    def only(self, names: list[str]) -> Emulator:
        """The same for some measures, in this order; ValueError for an unknown one."""
        k = [self.names.index(name) for name in names]
        parts = {p: getattr(self, p)[k] for p in ("logarithmic", "error", "q2", "columns")}
        return replace(self, names=names, **parts)

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
                "pads": self.pads,
            }
        )

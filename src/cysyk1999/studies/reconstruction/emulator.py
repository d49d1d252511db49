"""An emulator of the design: what a pad that was not simulated would show, and how far off that may
be.

For each measure a polynomial in the unknowns, and a Gaussian process of its own for what that
leaves (universal kriging in two steps; Sacks and others 1989, Stat. Sci. 4:409). Measures above
zero are emulated in their logarithm. The stated error is that of pads left out: everything but the
length scales is fitted anew without them.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numba
import numpy as np
import pandas as pd
from scipy.optimize import minimize
from sklearn.base import clone
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, Kernel, WhiteKernel
from sklearn.linear_model import RidgeCV
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures

FOLDS = 10
LENGTHS = (0.6, 60.0)
"""Least and largest length scale; the range of an unknown is 2."""
STEPS = 25
"""Of the search for length scales."""
SHRINKING = np.logspace(-4, 2, 13)
"""Penalties on the polynomial's coefficients, of which the best is taken."""


@numba.njit(cache=True, fastmath=True, nogil=True)
def _kriged(x, points, scales, weights, coefficients, out):  # pragma: no cover - compiled
    """Values (n, m) at points x (n, d): quadratic trends plus sums over the pads; points (d, n)."""
    n, d = x.shape
    m, pads = weights.shape
    far = np.empty(pads)
    for i in range(n):
        for k in range(m):
            value = coefficients[k, 0]
            at = 1 + d
            far[:] = 0.0
            for a in range(d):
                value += coefficients[k, 1 + a] * x[i, a]
                for b in range(a, d):
                    value += coefficients[k, at] * x[i, a] * x[i, b]
                    at += 1
                own, scale = x[i, a], scales[k, a]
                for j in range(pads):
                    step = (own - points[a, j]) * scale
                    far[j] += step * step
            for j in range(pads):
                value += weights[k, j] * np.exp(-0.5 * far[j])
            out[i, k] = value


@dataclass(frozen=True)
class Emulator:
    """Predicts measures at shares of the design's ranges.

    Attributes
    ----------
    names : (m,) measures.
    logarithmic : (m,) which are emulated in their logarithm.
    error : (m,) root mean square error of pads left out, of the logarithm where that is emulated.
    q2 : (m,) share of the variance explained of pads left out.
    points : (d, n) the pads fitted to, from -1 to 1.
    scales, weights, coefficients : (m, d), (m, n), (m, terms) of the Gaussian processes and trends.
    """

    names: list[str]
    logarithmic: np.ndarray
    error: np.ndarray
    q2: np.ndarray
    points: np.ndarray
    scales: np.ndarray
    weights: np.ndarray
    coefficients: np.ndarray

    @classmethod
    def fit(
        cls, shares: np.ndarray, values: pd.DataFrame, like: Callable[[str], str] = str
    ) -> Emulator:
        """Fit to pads.

        Parameters
        ----------
        shares : (n, d) of the design's ranges.
        values : (n, m) measures by name, without gaps.
        like : of a name, the kind that shares its length scales; those of the first are fitted.
        """
        y, x = values.to_numpy(float), 2 * np.asarray(shares, float) - 1
        logarithmic = (y > 0).all(axis=0)
        target = np.where(logarithmic, np.log(np.where(logarithmic, y, 1.0)), y)
        parts, known = [], {}
        for name, column in zip(values.columns, target.T, strict=True):
            kernel = known.setdefault(like(name), _kernel(x, column, known.get(like(name))))
            parts.append(_fitted(kernel, x, column))
        error, q2, scales, weights, coefficients = map(np.array, zip(*parts, strict=True))
        names, points = list(values.columns), np.ascontiguousarray(x.T)
        return cls(names, logarithmic, error, q2, points, scales, weights, coefficients)

    def __call__(self, shares: np.ndarray) -> np.ndarray:
        """Measures (n, m) at shares (n, d)."""
        x = 2 * np.ascontiguousarray(np.atleast_2d(shares), float) - 1
        found = np.empty((len(x), len(self.names)))
        _kriged(x, self.points, self.scales, self.weights, self.coefficients, found)
        return np.where(self.logarithmic, np.exp(np.where(self.logarithmic, found, 0.0)), found)

    def only(self, names: list[str]) -> Emulator:
        """The same for some measures, in this order; ValueError for an unknown one."""
        k = [self.names.index(name) for name in names]
        own = {f.name: getattr(self, f.name)[k] for f in fields(self)[1:] if f.name != "points"}
        return replace(self, names=names, **own)

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
                "pads": self.points.shape[1],
            }
        )


def _kernel(x: np.ndarray, y: np.ndarray, known: Kernel | None) -> Kernel:
    """The kernel of a measure, fitted unless it is known."""
    if known is not None:
        return known
    start = RBF(np.full(x.shape[1], 3.0), LENGTHS) + WhiteKernel(0.1, (1e-4, 1.0))
    with warnings.catch_warnings():
        # length scales at their bounds: an unknown that hardly matters
        warnings.simplefilter("ignore", ConvergenceWarning)
        return _kriging(GaussianProcessRegressor(start, optimizer=_soon), x, y)[1].kernel_


def _soon(cost, start, bounds):
    """Parameters near those of the least cost: more steps gain nothing that pads left out show."""
    found = minimize(
        cost, start, jac=True, bounds=bounds, method="L-BFGS-B", options={"maxiter": STEPS}
    )
    return found.x, found.fun


def _fitted(kernel: Kernel, x: np.ndarray, y: np.ndarray) -> tuple[object, ...]:
    """Error of pads left out, q2, and scales, weights and coefficients of one measure."""
    fixed = GaussianProcessRegressor(kernel, optimizer=None)
    trend, process, size = _kriging(fixed, x, y)
    missed, fold = np.zeros(len(y)), np.arange(len(y)) % FOLDS
    for k in range(FOLDS):
        out, kept = fold == k, fold != k
        left, rest, scale = _kriging(fixed, x[kept], y[kept])
        missed[out] = y[out] - left.predict(x[out]) - scale * rest.predict(x[out])
    square = np.mean(missed**2)
    return (
        float(np.sqrt(square)),
        float(1 - square / max(y.var(), 1e-300)),
        1 / kernel.k1.length_scale,
        size * process.alpha_,
        np.concatenate([[float(trend[-1].intercept_)], trend[-1].coef_]),
    )


def _kriging(process: GaussianProcessRegressor, x: np.ndarray, y: np.ndarray):
    """A trend, a process fitted to what it leaves, and the size of that."""
    trend = make_pipeline(PolynomialFeatures(2, include_bias=False), RidgeCV(SHRINKING)).fit(x, y)
    rest = y - trend.predict(x)
    size = max(float(rest.std()), 1e-12)
    return trend, clone(process).fit(x, rest / size), size

"""Nonlinear least squares for positive parameters, with what the data say about them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import norm, t

_FAR = np.log(
    1e4
    # how many times more or less than at the start a parameter may be: beyond, a search has lost its
    # way
)


@dataclass(frozen=True)
class Fit:
    """A fit, linearised in the logarithms of its parameters.

    Attributes:
        names, values: (p,) parameters. jacobian: (n, p) derivative of the weighted residual by log
        parameters. residual: (n,) data less model, in the data's unit. rss: weighted sum of
        squares. sigma: standard deviation of the weighted residual, known or from the scatter.
        known: was it known? evaluations: of the model, sensitivities with them.
    """

    names: tuple[str, ...]
    values: np.ndarray
    jacobian: np.ndarray
    residual: np.ndarray
    rss: float
    sigma: float
    known: bool
    evaluations: int

    @property
    def count(self) -> int:
        """Number of data."""
        return len(self.residual)

    @property
    def covariance(self) -> np.ndarray:
        """(p, p) covariance of the log parameters; entries grow without bound where the data do not
        tell parameters apart.
        """
        return self.sigma**2 * np.linalg.pinv(
            self.jacobian.T @ self.jacobian, rcond=1e-13, hermitian=True
        )

    @property
    def correlation(self) -> np.ndarray:
        """(p, p) correlation of the log parameters."""
        spread = np.sqrt(np.diag(self.covariance))
        return self.covariance / np.outer(spread, spread)

    def quantile(self, level: float = 0.95) -> float:
        """Half-width of the two-sided interval in standard deviations: normal if sigma is known,
        else Student's t.
        """
        p = 0.5 + level / 2
        return float(norm.ppf(p) if self.known else t.ppf(p, self.count - len(self.values)))

    def intervals(self, level: float = 0.95) -> np.ndarray:
        """(p, 2) confidence intervals of the parameters, symmetric in their logarithms."""
        half = self.quantile(level) * np.sqrt(np.diag(self.covariance))
        return self.values[:, None] * np.exp(np.column_stack([-half, half]))

    def derived(
        self, function: Callable[[np.ndarray], float], level: float = 0.95
    ) -> tuple[float, float, float]:
        """Value and confidence interval of a positive function of the parameters (first order, in
        logarithms).
        """
        value, step = function(self.values), 1e-6
        shift = np.exp(step * np.eye(len(self.values)))
        slope = np.array(
            [
                np.log(function(self.values * k) / function(self.values / k)) / (2 * step)
                for k in shift
            ]
        )
        half = self.quantile(level) * float(np.sqrt(slope @ self.covariance @ slope))
        return value, value * float(np.exp(-half)), value * float(np.exp(half))

    @property
    def aicc(self) -> float:
        """Akaike's information criterion for small samples, the scatter counted as a parameter
        (Hurvich and Tsai 1989).
        """
        n, k = self.count, len(self.values) + 1
        return (
            float(n * np.log(max(self.rss, 1e-300) / n) + 2 * k + 2 * k * (k + 1) / (n - k - 1))
            if n > k + 1
            else float("nan")
        )


def fit(
    model: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]],
    data: np.ndarray,
    start: dict[str, float],
    *,
    weight: np.ndarray | float = 1.0,
    sigma: float | None = None,
) -> Fit:
    """Fit positive parameters by least squares on weight * (data - model).

    Args:
        model: parameters (p,) -> values (n,) and their derivatives (n, p) by the parameters, in one
        evaluation. data: (n,). start: parameter -> positive value to start from. weight: of the
        residuals. sigma: standard deviation of the weighted residual; None takes it from the
        scatter.

    Raises:
        ValueError: no more data than parameters and sigma is not known, a start is not positive, or
        the search failed.
    """
    data, names = np.asarray(data, float), tuple(start)
    first = np.array([start[name] for name in names], float)
    if not (first > 0).all():
        raise ValueError("parameters must start from positive values")
    if sigma is None and len(data) <= len(names):
        raise ValueError(
            f"{len(data)} data cannot give {len(names)} parameters and their intervals"
        )
    weight = np.broadcast_to(weight, data.shape)
    last: dict[str, np.ndarray] = {}
    count = 0

    def evaluate(log):
        nonlocal count
        if not last or not np.array_equal(last["log"], log):
            value, slope = model(np.exp(log))
            last.update(
                log=log.copy(),
                residual=weight * (value - data),
                jacobian=weight[:, None] * slope * np.exp(log),
            )
            count += 1
        return last

    scale = max(float(np.abs(weight * data).max()), 1e-300)
    found = least_squares(
        lambda log: evaluate(log)["residual"] / scale,
        np.log(first),
        lambda log: evaluate(log)["jacobian"] / scale,
        method="trf",
        x_scale="jac" if len(names) > 2 else 1.0,
        xtol=1e-9,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=400,
        bounds=(np.log(first) - _FAR, np.log(first) + _FAR),
    )
    if not found.success:
        raise ValueError(f"the fit of {', '.join(names)} did not converge: {found.message}")
    end = evaluate(found.x)
    rss = float(end["residual"] @ end["residual"])
    # data without scatter would claim exactness; no force is known to a millionth
    spread = (
        max(float(np.sqrt(rss / (len(data) - len(names)))), 1e-6 * scale)
        if sigma is None
        else sigma
    )
    # the same order as in `start`, data less model
    return Fit(
        names,
        np.exp(found.x),
        end["jacobian"],
        -end["residual"] / weight,
        rss,
        spread,
        sigma is not None,
        count,
    )


def group_interval(values: Sequence[float], level: float = 0.95) -> tuple[float, float, float]:
    """Geometric mean of several subjects' positive values and its Student interval, from the
    scatter between them.
    """
    log = np.log(np.asarray(values, float))
    half = t.ppf(0.5 + level / 2, len(log) - 1) * log.std(ddof=1) / np.sqrt(len(log))
    centre = log.mean()
    return float(np.exp(centre)), float(np.exp(centre - half)), float(np.exp(centre + half))

"""Orders of convergence, extrapolation to the limit, and the grid convergence index.

Sources: L. F. Richardson, Phil. Trans. R. Soc. A 210, 307 (1911); P. J. Roache, J. Fluids Eng. 116,
405 (1994).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

SAFETY, SAFETY_UNOBSERVED = 1.25, 3.0
"""Roache's factors on the extrapolated difference: with a believable order observed on three sizes,
and with one assumed.
"""
LOWEST, HIGHEST = 1.0, 2.0
"""Orders between which differences are extrapolated; what is seen outside is not believed."""


class Limit(NamedTuple):
    """The value at size zero, its uncertainty in the same unit, and the order seen on the three
    finest sizes (nan: none); numbers, or an array of each.
    """

    value: float | np.ndarray
    uncertainty: float | np.ndarray
    order: float | np.ndarray


def observed_order(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Order p of values f + c h^p at the three finest of falling ``sizes``; nan where they do not
    approach monotonically.
    """
    coarse, middle, fine = np.asarray(sizes, float)[-3:]
    first, second = np.diff(np.asarray(values, float)[-3:])
    if first * second <= 0:
        return np.nan

    def excess(p):
        return np.log((coarse**p - middle**p) / (middle**p - fine**p)) - np.log(first / second)

    return float(brentq(excess, 1e-6, 12)) if excess(1e-6) < 0 < excess(12) else np.nan


def fitted_order(sizes: Sequence[float], errors: Sequence[float]) -> float:
    """Slope of log error over log size, by least squares over all that are not zero; nan for fewer
    than two.
    """
    sizes, errors = np.asarray(sizes, float), np.abs(np.asarray(errors, float))
    known = np.isfinite(errors) & (errors > 0)
    return (
        float(np.polyfit(np.log(sizes[known]), np.log(errors[known]), 1)[0])
        if known.sum() > 1
        else np.nan
    )


def limit(sizes: Sequence[float], values: Sequence[float]) -> Limit:
    """Richardson's limit from the two finest of at least three falling sizes, and its grid
    convergence index.

    An order above :data:`HIGHEST` is replaced by it, and by more than a tenth the index has the
    larger factor. Where an order below :data:`LOWEST` is seen, or none, the limit is the finest
    value, as uncertain as the last three are apart; where these swing, it is taken to lie somewhere
    between them.
    """
    order, (middle, fine) = observed_order(sizes, values), np.asarray(sizes, float)[-2:]
    last = np.asarray(values, float)[-3:]
    if (last[2] - last[1]) * (last[1] - last[0]) <= 0:
        return Limit(float(last.min() + last.max()) / 2, float(np.ptp(last)) / 2, order)
    if not order >= 0.9 * LOWEST:
        return Limit(float(last[2]), float(np.ptp(last)), order)
    correction = (last[2] - last[1]) / ((middle / fine) ** np.clip(order, LOWEST, HIGHEST) - 1)
    safety = SAFETY if order <= 1.1 * HIGHEST else SAFETY_UNOBSERVED
    return Limit(float(last[2] + correction), float(safety * abs(correction)), order)


def limits(sizes: Sequence[float], series: np.ndarray) -> Limit:
    """The limits (moments,) of a series (sizes, moments)."""
    return Limit(*np.transpose([limit(sizes, column) for column in series.T]))

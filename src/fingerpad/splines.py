"""Piecewise cubics through values at places: to import scipy's takes half a second, a third of a
short simulation.

Values are (n, ...) at rising places (n,); their slopes, per unit of place, have the same shape.
"""

from __future__ import annotations

import numpy as np

_BLOCK = 32
"""Places that are looked at together, for what is read of their values to stay near."""


def hermite(
    place: np.ndarray, values: np.ndarray, slopes: np.ndarray, at: np.ndarray
) -> np.ndarray:
    """Values (k, ...) at places (k,) between the first and the last of the cubics that have the
    values and slopes.
    """
    first = np.clip(np.searchsorted(place, at, side="right") - 1, 0, len(place) - 2)
    step = np.diff(place)[first]
    share = (at - place[first]) / step
    rest = 1 - share
    weights = (
        rest**2 * (1 + 2 * share),
        share**2 * (3 - 2 * share),
        share * rest**2 * step,
        -(share**2) * rest * step,
    )
    out = np.zeros((len(at), *values.shape[1:]))
    for start in range(0, len(at), _BLOCK):
        some = slice(start, start + _BLOCK)
        one, other = first[some], first[some] + 1
        for weight, what in zip(
            weights, (values[one], values[other], slopes[one], slopes[other]), strict=True
        ):
            what *= weight[some].reshape((-1,) + (1,) * (values.ndim - 1))
            out[some] += what
    return out


def spline_slopes(place: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes of the spline, twice continuously differentiable, whose first two cubics are one, and
    whose last two (de Boor 1978, chapter IV, "not-a-knot"); of four values and more.
    """
    step = np.diff(place)
    wide = step.reshape((-1,) + (1,) * (values.ndim - 1))
    secant = np.diff(values, axis=0) / wide
    slopes = np.empty((len(place), *values.shape[1:]))
    slopes[1:-1] = 3 * (wide[1:] * secant[:-1] + wide[:-1] * secant[1:])
    one, two = place[2] - place[0], place[-1] - place[-3]
    slopes[0] = ((step[0] + 2 * one) * step[1] * secant[0] + step[0] ** 2 * secant[1]) / one
    slopes[-1] = (step[-1] ** 2 * secant[-2] + (2 * two + step[-1]) * step[-2] * secant[-1]) / two
    below = [0.0, *step[1:], two]
    here = [step[1], *(2 * (step[:-1] + step[1:])), step[-2]]
    above = [one, *step[:-1]]
    for i in range(1, len(place)):
        share = below[i] / here[i - 1]
        here[i] -= share * above[i - 1]
        slopes[i] -= share * slopes[i - 1]
    slopes[-1] /= here[-1]
    for i in range(len(place) - 2, -1, -1):
        slopes[i] = (slopes[i] - above[i] * slopes[i + 1]) / here[i]
    return slopes


def akima_slopes(place: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Slopes that no value more than two places away changes (Akima 1970), weighted as MATLAB's
    makima does, so that a flat piece does not overshoot; of two values and more.
    """
    secant = np.diff(values, axis=0) / np.diff(place).reshape((-1,) + (1,) * (values.ndim - 1))
    if len(place) == 2:
        return np.concatenate([secant, secant])
    before, after = 2 * secant[0] - secant[1], 2 * secant[-1] - secant[-2]
    secant = np.stack([2 * before - secant[0], before, *secant, after, 2 * after - secant[-1]])
    weight = np.abs(np.diff(secant, axis=0)) + 0.5 * np.abs(secant[1:] + secant[:-1])
    left, right = weight[2:], weight[:-2]
    both = left + right
    known = both > 1e-9 * both.max(initial=0.0)
    mean = 0.5 * (secant[3:] + secant[:-3])
    return np.where(
        known, (left * secant[1:-2] + right * secant[2:-1]) / np.where(known, both, 1.0), mean
    )

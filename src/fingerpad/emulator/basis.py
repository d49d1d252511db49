"""The mathematics of an answer, which a page repeats in a few lines: a Gaussian process in the
knobs about a parabola of them, and cubics in time.
"""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.polynomial import legendre

BENT = 10.0
"""How steep the bent scale is at the low end, over its steepness at the high end, less 1."""
SOONEST = 0.05
"""s; holds are interpolated in log(1 + time / SOONEST)."""


NEARBY = 0.3
"""Lengths over which the errors of scenes tell of a place; a knob's range is 2."""
FROM_ALL = 0.1
"""Share that scenes everywhere have in what is said of a place."""
_AT_ONCE = 128
"""Points at a time, so that what is between stays in the cache."""


def _bent(value, low, high):
    share = (value - low) / (high - low)
    return np.log1p(BENT * np.maximum(share, 0)) + BENT * np.minimum(share, 0)


WARPS = {
    "linear": lambda value, low, high: value,
    "logarithm": lambda value, low, high: np.log(value),
    "bent": _bent,
}
"""What an emulator sees of a knob's values, in a box from low to high. ``bent`` is even at the low
end and logarithmic beyond a tenth of the box.
"""


def exponents(knobs: int, degree: int) -> np.ndarray:
    """Degrees (terms, knobs) of all products of polynomials up to a total degree, lowest first.

    >>> exponents(2, 1).tolist()
    [[0, 0], [0, 1], [1, 0]]
    """
    found = [
        tuple(np.bincount(chosen, minlength=knobs))
        for total in range(degree + 1)
        for chosen in combinations_with_replacement(range(knobs), total)
    ]
    return np.array(sorted(found, key=lambda p: (sum(p), p)), int).reshape(-1, knobs)


def basis(points: np.ndarray, powers: np.ndarray) -> np.ndarray:
    """Values (n, terms) of products of Legendre polynomials.

    Parameters
    ----------
    points
        (n, knobs), from -1 to 1.
    powers
        (terms, knobs), as `exponents` gives them.
    """
    found = np.ones((len(points), len(powers)))
    known = legendre.legvander(points, int(powers.max(initial=0)))
    for k, degrees in enumerate(powers.T):
        found *= known[:, k, degrees]
    return found


def kernel(points: np.ndarray, centres: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Matern's covariance (n, m) of smoothness 5/2 (Rasmussen and Williams 2006, eq 4.17).

    Parameters
    ----------
    points
        (n, knobs), from -1 to 1.
    centres
        (m, knobs), likewise.
    scales
        (knobs,) lengths over which it falls.
    """
    found = np.empty((len(points), len(centres)))
    ends = points / scales * np.sqrt(5), centres / scales * np.sqrt(5)
    sizes = tuple((end**2).sum(axis=1) for end in ends)
    for start in range(0, len(points), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        far = found[some]
        np.matmul(ends[0][some], -2 * ends[1].T, out=far)
        far += sizes[0][some, None]
        far += sizes[1]
        np.maximum(far, 0, out=far)
        falls = far / 3
        np.sqrt(far, out=far)
        falls += far
        falls += 1
        np.negative(far, out=far)
        np.exp(far, out=far)
        far *= falls
    return found


def nearby(points: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """How much (n, m) scenes at centres (m, knobs) tell of their errors at points (n, knobs)."""
    return kernel(points, centres, np.full(points.shape[1], NEARBY))


def local_size(near: np.ndarray, sizes: np.ndarray) -> np.ndarray:
    """Root mean square of the sizes (m,) of scenes around points: (n,).

    Scenes count by how near (n, m) they are; a tenth is that of all scenes. A size that is NaN is
    that of no scene.
    """
    known = np.isfinite(sizes)
    squares = np.where(known, sizes, 0.0) ** 2
    around = near @ squares / np.maximum(near @ known, 1e-300)
    return np.sqrt((1 - FROM_ALL) * around + FROM_ALL * squares.sum() / known.sum())


def cubic_weights(grid: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Weights (m, n) of values on a grid that give the values at other places.

    Between two points of the grid it is the cubic through the four around them; at the ends, and
    beyond, through the last four. A grid of fewer points has a parabola, a line or a constant.

    Parameters
    ----------
    grid
        (n,), rising.
    at
        (m,).

    Examples
    --------
    >>> weights = cubic_weights(np.array([0.0, 1.0, 2.0, 4.0]), np.array([3.0]))
    >>> float(weights[0] @ np.array([0.0, 1.0, 8.0, 64.0]))
    27.0
    """
    grid, at = np.asarray(grid, float), np.atleast_1d(np.asarray(at, float))
    count = min(4, len(grid))
    first = np.clip(np.searchsorted(grid, at, side="right") - 2, 0, len(grid) - count)
    near = first[:, None] + np.arange(count)
    weights, rows = np.zeros((len(at), len(grid))), np.arange(len(at))
    for k in range(count):
        own, value = grid[near[:, k]], np.ones(len(at))
        for j in range(count):
            if j != k:
                other = grid[near[:, j]]
                value *= (at - other) / (own - other)
        weights[rows, near[:, k]] = value
    return weights


def spread(half: np.ndarray, turned: bool) -> np.ndarray:
    """What the mean pressure of a contact is the force over: its width, or the area of a disc.

    Parameters
    ----------
    half
        m, half the width of the contact.
    turned
        The contact is of a body of revolution.
    """
    return np.pi * half**2 if turned else 2 * half


def held(time: np.ndarray | float) -> np.ndarray:
    """The scale in which a hold is interpolated. time: s since it began."""
    return np.log1p(np.asarray(time, float) / SOONEST)

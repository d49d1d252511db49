"""Points in the plane that lie at the same place, and those nearest to others; few without a tree,
which is slow to import.
"""

from __future__ import annotations

from itertools import count

import numpy as np

_ASKEW = np.array([0.8241323123, 0.5663941371])  # a direction that no row of a mesh is across
_MOST = 2**24  # distances at once


def twins(points: np.ndarray, tolerance: float) -> np.ndarray:
    """Pairs (m, 2) of points (n, 2), the lower index first, that are no further apart than
    ``tolerance``.
    """
    along = points @ _ASKEW
    order = np.argsort(along, kind="stable")
    found = []
    for step in count(1):  # points at one place are near each other along any line
        close = np.flatnonzero(along[order[step:]] - along[order[:-step]] <= tolerance)
        if not len(close):
            break
        pairs = np.column_stack([order[close], order[close + step]])
        found.append(pairs[np.hypot(*(points[pairs[:, 0]] - points[pairs[:, 1]]).T) <= tolerance])
    return np.sort(np.concatenate(found), axis=1) if found else np.zeros((0, 2), dtype=np.int64)


def same_place(points: np.ndarray, others: np.ndarray, tolerance: float) -> np.ndarray:
    """Index (n,) of one of ``others`` (k, 2) that lies where each of the points (n, 2) does; -1
    where none does.
    """
    n = len(points)
    first, second = twins(np.concatenate([points, others]), tolerance).T
    across = (first < n) & (second >= n)
    out = np.full(n, -1)
    out[first[across]] = second[across] - n
    return out


def nearest(points: np.ndarray, others: np.ndarray, number: int) -> np.ndarray:
    """Indices (n, number) of those of ``others`` (k, 2) that are nearest to each of the points (n,
    2), the nearest first.
    """
    number = min(number, len(others))
    if len(points) * len(others) > _MOST:
        from scipy.spatial import cKDTree  # here, for it is slow to import

        return cKDTree(others).query(points, k=np.arange(1, number + 1))[1]
    x, y = points[:, :1] - others[:, 0], points[:, 1:] - others[:, 1]
    distance = x * x + y * y
    few = np.argpartition(distance, number - 1, axis=1)[:, :number]
    return np.take_along_axis(
        few, np.argsort(np.take_along_axis(distance, few, axis=1), axis=1, kind="stable"), axis=1
    )

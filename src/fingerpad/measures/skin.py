"""Local curvature of the deformed skin, from the positions of its nodes alone.

The curvature at a node is that of a parabola through its neighbours: x and y are fitted as
quadratic functions of the arc length along the skin, by weighted least squares over a window of
`WINDOW` to either side. In contact, where the nodes lie on the profile, it equals the profile's
curvature; a noise of e in the nodes becomes one of about 4 e / WINDOW**2.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr

from fingerpad.measures.features import skin_at

WINDOW = 0.25e-3
"""Half of the arc length (m) that a curvature is fitted over: three to four nodes to either side at
the thesis's resolution.
"""

LEAST_NODES = 2
"""Nodes to either side that are fitted at least, whatever their spacing."""


def local_curvature(x: np.ndarray, y: np.ndarray, node: int, window: float = WINDOW) -> np.ndarray:
    """Curvature of a line at one of its nodes, signed: positive where it is hollow, as skin is
    under a convexity.

    Parameters
    ----------
    x, y
        (..., nodes) m; positions along the line, from left to right over the upper side of the pad.
    node
        Index of the node, at least `LEAST_NODES` away from both ends.
    window
        m; half of the arc length fitted over, widened where it holds fewer than `LEAST_NODES` to
        either side.

    Returns
    -------
    np.ndarray
        (...,) 1/m. The weights fall off as (1 - (s / window)**2)**2 with the arc length s from the
        node.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    return _curvature(x, y, _way(x, y), node, window)


def _way(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Arc length (..., nodes) m along a line, from its first node."""
    steps = np.hypot(np.diff(x), np.diff(y))
    return np.concatenate([np.zeros((*steps.shape[:-1], 1)), np.cumsum(steps, axis=-1)], axis=-1)


def _curvature(
    x: np.ndarray, y: np.ndarray, way: np.ndarray, node: int, window: float
) -> np.ndarray:
    """`local_curvature` of a line with its arc length."""
    arc = way - way[..., node, None]
    needed = np.maximum(-arc[..., node - LEAST_NODES], arc[..., node + LEAST_NODES])
    half = np.maximum(window, 1.25 * needed)[..., None]
    near = (np.abs(arc) < half).any(axis=tuple(range(arc.ndim - 1)))
    s = arc[..., near] / half
    weight = np.clip(1 - s**2, 0, None) ** 2
    basis = np.stack([np.ones_like(s), s, s**2], axis=-1)
    weighted = np.moveaxis(weight[..., None] * basis, -1, -2)
    middle = np.stack([x[..., node], y[..., node]], axis=-1)[..., None, :]
    positions = np.stack([x[..., near], y[..., near]], axis=-1) - middle
    fit = np.linalg.solve(weighted @ basis, weighted @ positions)
    slope, bend = fit[..., 1, :] / half, 2 * fit[..., 2, :] / half**2
    turn = slope[..., 0] * bend[..., 1] - slope[..., 1] * bend[..., 0]
    return turn / np.hypot(slope[..., 0], slope[..., 1]) ** 3


def skin_curvature(history: xr.Dataset, node: int) -> np.ndarray:
    """Curvature (time) 1/m of the deformed skin at a skin node, as `local_curvature` defines it."""
    return local_curvature(*skin_at(history), node)


def skin_curvatures(history: xr.Dataset, nodes: Iterable[int]) -> list[np.ndarray]:
    """Curvatures (time) 1/m of the deformed skin at several nodes; its arc length is found once."""
    x, y = skin_at(history)
    way = _way(x, y)
    return [_curvature(x, y, way, node, WINDOW) for node in nodes]

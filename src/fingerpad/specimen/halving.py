"""A mesh with edges half as long, inside the geometry that it has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import KDTree

from fingerpad.specimen.element_kinds import KINDS, Kind
from fingerpad.specimen.pad import PadMesh

_SAME = 1e-6  # of the shortest distance of two nodes of a cell, within which two are one


def halved(mesh: PadMesh) -> PadMesh:
    """Divide every element into four, and every facet of a curve into two.

    New nodes lie on the elements as they are bent, so that the outline stays what it was.

    Parameters
    ----------
    mesh : PadMesh
        Mesh of any element kind that pads have (m).

    Returns
    -------
    PadMesh
        Four times as many elements of the same kind, in the same regions and curves.
    """
    kind = KINDS[mesh.element]
    order = 2 if kind.quadratic else 1
    at, cells = _children(kind, order)
    values, _ = kind.shapes(at / (2 * order))
    inside = np.einsum("mn,enx->emx", values, mesh.points[mesh.cells])
    lines = {name: _halves(mesh.points[facets]) for name, facets in mesh.curves.items()}
    flat = inside.reshape(-1, 2)
    corners = mesh.points[mesh.cells[:, : kind.corners]]
    side = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).min()
    first = _first_of(flat, _SAME * side)
    kept, number = np.unique(first, return_inverse=True)
    points = flat[kept]
    known = KDTree(points)
    return replace(
        mesh,
        points=points,
        cells=number.reshape(len(mesh.cells), -1)[:, cells]
        .reshape(-1, kind.nodes)
        .astype(np.int32),
        region=np.repeat(mesh.region, len(cells)),
        curves={name: known.query(line)[1].astype(np.int32) for name, line in lines.items()},
    )


def _children(kind: Kind, order: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (m, 2) of a lattice over the reference cell, in steps, and the nodes (4, nodes) of its
    four parts.
    """
    n = 2 * order
    grid = np.array([(i, j) for j in range(n + 1) for i in range(n + 1)])
    if kind.corners == 3:
        grid = grid[grid.sum(axis=1) <= n]
        corners = np.array([(0, 0), (order, 0), (0, order)])
        parts = [corners + shift for shift in ((0, 0), (order, 0), (0, order))]
        parts.append(np.array([(order, 0), (order, order), (0, order)]))
    else:
        corners = order * np.array([(0, 0), (1, 0), (1, 1), (0, 1)])
        parts = [corners + (order * i, order * j) for j in (0, 1) for i in (0, 1)]
    where = {tuple(place): k for k, place in enumerate(grid.tolist())}
    cells = []
    for part in parts:
        places = list(part)
        if order == 2:
            places += [(a + b) // 2 for a, b in zip(part, np.roll(part, -1, axis=0), strict=True)]
        if kind.nodes == 9:
            places.append(part.sum(axis=0) // 4)
        cells.append([where[tuple(map(int, place))] for place in places])
    return grid, np.array(cells)


def _halves(ends: np.ndarray) -> np.ndarray:
    """Points (2 facets, 2 or 3, 2) of the halves of facets (facets, 2 or 3, 2)."""
    start, end = ends[:, 0], ends[:, 1]
    if ends.shape[1] == 2:
        middle = (start + end) / 2
        halves = np.stack([np.stack([start, middle], 1), np.stack([middle, end], 1)], 1)
        return halves.reshape(-1, 2, 2)
    middle = ends[:, 2]
    left = (3 * start - end + 6 * middle) / 8
    right = (3 * end - start + 6 * middle) / 8
    halves = np.stack([np.stack([start, middle, left], 1), np.stack([middle, end, right], 1)], 1)
    return halves.reshape(-1, 3, 2)


def _first_of(points: np.ndarray, near: float) -> np.ndarray:
    """(n,) number of the first of the points (n, 2) that lie together."""
    first = np.arange(len(points))
    pairs = KDTree(points).query_pairs(near, output_type="ndarray")
    np.minimum.at(first, pairs.max(axis=1), pairs.min(axis=1))
    return first

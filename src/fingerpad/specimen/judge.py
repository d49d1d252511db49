"""Is a mesh that somebody brings one body with its skin up? What is wrong is refused before
anything is solved.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from fingerpad.specimen.pad import SKIN, MeshError, PadMesh, edge_keys, element_edges

_SLIT = np.radians(5.0)
"""Angle of a gap between two boundary edges at a node, below which it is a slit between layers that
were not joined.
"""
_ON = 1e-3
"""Of an edge's length: nearer to it than this, a node of another element lies on it."""
_JOIN = "allowed: layers that share their nodes (one curve for both, or gmsh's fragment)"


def check_joined(mesh: PadMesh) -> None:
    """Refuse a mesh that is not one piece, or whose elements lie beside each other without sharing
    their nodes.

    Raises
    ------
    MeshError : names the layers and the place in mm, and the likely cause.
    """
    edges = element_edges(mesh.cells, mesh.element)
    owner = np.tile(np.arange(len(mesh.cells)), len(edges) // len(mesh.cells))
    _, number, uses = np.unique(edge_keys(edges), return_inverse=True, return_counts=True)
    order = np.argsort(number, kind="stable")
    shared = order[uses[number[order]] == 2].reshape(-1, 2)
    _check_pieces(mesh, owner[shared])
    once = uses[number] == 1
    _check_boundary(mesh, edges[once], owner[once])


def _check_pieces(mesh: PadMesh, neighbours: np.ndarray) -> None:
    count = len(mesh.cells)
    links = coo_array((np.ones(len(neighbours)), neighbours.T), shape=(count, count))
    pieces, piece = connected_components(links, directed=False)
    if pieces == 1:
        return
    least = np.argmin(np.bincount(piece))
    cells = mesh.cells[piece == least]
    layers = ", ".join(mesh.regions[k] for k in np.unique(mesh.region[piece == least]))
    x, y = np.round(mesh.points[cells].mean(axis=(0, 1)) * 1e3, 3) + 0.0
    by_nodes = np.intersect1d(cells, mesh.cells[piece != least])
    how = (
        f"hangs on the rest by {len(by_nodes)} single nodes"
        if len(by_nodes)
        else "shares no node with the rest"
    )
    raise MeshError(
        f"is in {pieces} pieces: the one around ({x:.3f}, {y:.3f}) mm, "
        f"{len(cells)} elements of layer {layers}, {how}; {_JOIN}"
    )


def _check_boundary(mesh: PadMesh, edges: np.ndarray, owner: np.ndarray) -> None:
    """Boundary edges must not cross or touch each other but at common nodes, nor part by less than
    a slit there.
    """
    if edges.shape[1] == 3:  # along their middles
        edges, owner = np.concatenate([edges[:, [0, 2]], edges[:, [2, 1]]]), np.tile(owner, 2)
    ends = mesh.points[edges]
    # each with those that are shorter and near enough to touch it
    middles, length = ends.mean(axis=1), np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    near = KDTree(middles).query_ball_point(middles, 1.01 * length)
    first = np.repeat(np.arange(len(near)), [len(others) for others in near])
    second, rank = np.concatenate(near).astype(int), np.argsort(np.argsort(length))
    shorter = rank[second] < rank[first]
    first, second = first[shorter], second[shorter]
    a, b = edges[first], edges[second]
    apart = ~(a[:, :, None] == b[:, None, :]).any(axis=(1, 2))
    wrong = np.empty(len(first), bool)
    wrong[apart] = _touch(ends[first[apart]], ends[second[apart]])
    wrong[~apart] = _slit(mesh.points, a[~apart], b[~apart])
    if wrong.any():
        pair = [first[wrong][0], second[wrong][0]]
        x, y = ends[pair].mean(axis=(0, 1)) * 1e3
        layers = dict.fromkeys(mesh.regions[k] for k in mesh.region[owner[pair]])
        raise MeshError(
            f"boundary edges of layer {' and '.join(layers)} lie on each other at "
            f"({x:.3f}, {y:.3f}) mm ({wrong.sum()} such pairs): "
            f"a node of one element is on an edge of another; {_JOIN}"
        )


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _touch(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether segments (n, 2, 2) without a common node cross, or one's end lies on the other."""
    crossed, touching = np.ones(len(a), bool), np.zeros(len(a), bool)
    for one, other in ((a, b), (b, a)):
        start, way = one[:, 0], one[:, 1] - one[:, 0]
        square, beside = (way**2).sum(axis=1), []
        for k in (0, 1):
            arm = other[:, k] - start
            beside.append(_cross(way, arm))
            share = np.clip((arm * way).sum(axis=1) / square, 0, 1)
            touching |= np.hypot(*(arm - share[:, None] * way).T) < _ON * np.sqrt(square)
        crossed &= beside[0] * beside[1] < 0
    return crossed | touching


def _slit(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Whether edges (n, 2) with one common node, their elements to the left, part there by less
    than a slit.
    """
    same = (a[:, :, None] == b[:, None, :]).reshape(-1, 4)
    i, j = np.divmod(np.argmax(same, axis=1), 2)  # which end of each is the common node
    rows = np.arange(len(a))
    start = points[a[rows, i]]
    u, v = points[a[rows, 1 - i]] - start, points[b[rows, 1 - j]] - start
    turn = np.arctan2(_cross(u, v), (u * v).sum(axis=1))
    # between u and v, turned to the left of u, is material where u leaves the node and v comes to
    # it
    material = np.where(turn > 0, (i == 0) & (j == 1), (j == 0) & (i == 1))
    return (np.abs(turn) < _SLIT) & ~(material & (turn != 0))


def check_skin(mesh: PadMesh) -> None:
    """Refuse a skin that does not face up over x = 0, where the indenter comes down.

    Raises
    ------
    MeshError : gives the extent of the skin and what would put it right.
    """
    ends = mesh.points[mesh.curves[SKIN][:, :2]]
    low, high = ends.min(axis=(0, 1)) * 1e3, ends.max(axis=(0, 1)) * 1e3
    where = (
        f"curve {SKIN}, from x = {low[0]:.4g} to {high[0]:.4g} mm "
        f"and y = {low[1]:.4g} to {high[1]:.4g} mm,"
    )
    meets = meeting_place(mesh)
    if meets is None:
        way = ends[-1, 1] - ends[0, 0]
        if way[0] < abs(way[1]):
            raise MeshError(f"{where} {_facing(way)}")
        shift = -0.5 * (low[0] + high[0])
        raise MeshError(
            f"{where} does not lie over x = 0, where the indenter comes down; "
            f"allowed: a skin over x = 0, this mesh shifted by {shift:.4g} mm for example"
        )
    height, facet = meets
    way = ends[facet, 1] - ends[facet, 0]
    if way[0] <= abs(way[1]) / 10:
        raise MeshError(f"{where} {_facing(way)}")
    near = 1e-6 * np.ptp(mesh.points, axis=0)
    for curve, facets in mesh.curves.items():
        above = _heights(mesh.points[facets[:, :2]], near[0]).max(initial=-np.inf)
        if curve != SKIN and above > height + near[1]:
            raise MeshError(
                f"{where} is covered at x = 0 by curve {curve} at y = {above * 1e3:.4g} mm; "
                "allowed: nothing above the skin, from where the indenter comes"
            )


def meeting_place(mesh: PadMesh) -> tuple[float, int] | None:
    """Height (m) of the skin over x = 0, where the indenter comes down, and the facet there; None
    where there is no skin.
    """
    ends = mesh.points[mesh.curves[SKIN][:, :2]]
    near = 1e-6 * np.ptp(mesh.points[:, 0])
    over = np.flatnonzero((ends[..., 0].min(axis=1) <= near) & (ends[..., 0].max(axis=1) >= -near))
    if not len(over):
        return None
    heights = np.array([_heights(ends[[k]], near).max() for k in over])
    best = int(np.argmax(heights))
    return float(heights[best]), int(over[best])


def _heights(ends: np.ndarray, near: float) -> np.ndarray:
    """Heights (k,) at which segments (n, 2, 2) pass x = 0; of one that runs along it, its upper
    end.
    """
    over = (ends[..., 0].min(axis=1) <= near) & (ends[..., 0].max(axis=1) >= -near)
    (x0, y0), (x1, y1) = ends[over, 0].T, ends[over, 1].T
    upright = np.abs(x1 - x0) <= near
    share = np.clip(-x0 / np.where(upright, 1.0, x1 - x0), 0, 1)
    return np.where(upright, np.maximum(y0, y1), y0 + share * (y1 - y0))


def _facing(way: np.ndarray) -> str:
    """What is wrong with a skin that runs along ``way``, its material to the right."""
    if abs(way[0]) >= abs(way[1]):
        faces, turn = "down", 180
    else:
        faces, turn = ("left", -90) if way[1] > 0 else ("right", 90)
    return (
        f"faces {faces}, away from the indenter; "
        f"allowed: a skin that faces up, this mesh turned by {turn} degrees for example"
    )

"""Stacks of bonded layers on a fixed base: flat slabs (robot skin, phantoms) and half-rounds
(fingertips of hands and robots).

A slab lies under y = 0, -width / 2 <= x <= width / 2; its sides are free. A half-round is the half
of a cylinder over y = 0, its layers are shells; what the layers leave of it is a rigid core. Both
are mapped meshes of second-order quads, the left half the mirror image of the right one, bit for
bit: rows follow the surface, columns are normal to it. The solid core of a half-round is a block
with a corner on the ring's 45 degrees.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.grid import divide, limit_growth, with_middles
from fingerpad.specimen.pad import MeshError, MeshSize, PadMesh
from fingerpad.specimen.quality import check_orientation

_COARSEST = 8.0  # largest edge along the surface and across the layers, in those under the contact
_ROWS = 2  # rows in a layer, at least
_MOST = 64  # edges to either side of the middle and across the stack, at most, before they grow
# radius of a solid core's block, in that of the ring round it; and of that ring, in the innermost
# layer's
_RING = 0.62
_TURN = 0.2  # largest angle in radians that an edge along a half-round may turn by


def _graded(length: float, ends: list[float], wanted, focus, growth: float) -> np.ndarray:
    """Division points of [0, length] with the edges ``wanted(s)``, smaller at ``focus``, and
    ``ends`` among them.
    """
    grid = np.union1d(np.linspace(0.0, length, 8001), [*ends, *(s for s, _ in focus)])
    edge = wanted(grid)
    for low, high in pairwise(ends):
        edge = np.where((grid >= low) & (grid <= high), np.minimum(edge, high - low), edge)
    for s, near in focus:
        edge = np.where(grid == s, np.minimum(edge, near), edge)
    edge = limit_growth(grid, edge, growth)
    parts = [divide(grid, edge, low, high, np.ceil) for low, high in pairwise(ends)]
    return np.concatenate([part[:-1] for part in parts] + [[length]])


def _columns(stack, size: MeshSize) -> np.ndarray:
    """Arc lengths of the column boundaries from the middle to the rim of the surface."""
    length = stack.half_width if stack.radius is None else 0.5 * np.pi * stack.radius
    skin_edge = max(size.skin_edge, size.fine_half_width / _MOST)
    fine = min(np.ceil(size.fine_half_width / skin_edge - 1e-6) * skin_edge, length)
    fine = length if length - fine < skin_edge else fine
    largest = size.coarse_edge or _COARSEST * skin_edge
    if stack.radius is not None:
        largest = min(largest, _TURN * stack.radius)

    def arc(x):
        return (
            abs(x)
            if stack.radius is None
            else stack.radius * np.arcsin(min(abs(x) / stack.radius, 1.0))
        )

    focus = [(float(arc(x)), edge) for x, edge in size.focus if arc(x) < length]
    ends = [0.0, length] if fine == length else [0.0, fine, length]
    return _graded(
        length,
        ends,
        lambda s: np.where(s <= fine, min(skin_edge, largest), largest),
        focus,
        size.growth,
    )


def _rows(stack, size: MeshSize, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths of the row boundaries from the surface to ``depth``, and the layer of each row."""
    bounds = np.cumsum(stack.thicknesses)
    layer_edge = max(size.layer_edge, depth / _MOST)
    first, slope, fine = (
        min(size.skin_radial_edge or layer_edge, layer_edge),
        np.log(size.growth),
        0.5 * size.fine_half_width,
    )
    ends = [0.0, *(float(bound) for bound in bounds if bound < depth * (1 - 1e-9)), depth]

    def wanted(d):
        edge = np.minimum(first + slope * d, layer_edge) + np.clip(
            slope * (d - fine), 0.0, _COARSEST * layer_edge
        )
        for low, high in pairwise(ends):
            edge = np.where((d >= low) & (d <= high), np.minimum(edge, (high - low) / _ROWS), edge)
        return edge

    rows = _graded(depth, ends, wanted, (), size.growth)
    middle = 0.5 * (rows[1:] + rows[:-1])
    return rows, np.minimum(np.searchsorted(bounds, middle), len(bounds) - 1)


def _quads(columns: int, rows: int) -> np.ndarray:
    """Half steps (elements, 9, 2) of column and row, row after row; rows count downwards, nodes run
    counter-clockwise.
    """
    shape = np.array([(0, 2), (2, 2), (2, 0), (0, 0), (1, 2), (2, 1), (1, 0), (0, 1), (1, 1)])
    start = np.stack(
        np.meshgrid(np.arange(columns), np.arange(rows), indexing="xy"), axis=-1
    ).reshape(-1, 1, 2)
    return 2 * start + shape


def _chain(nodes: np.ndarray) -> np.ndarray:
    """Facets (start, end, middle) of a line of nodes, mid-side nodes included."""
    return np.column_stack((nodes[:-2:2], nodes[2::2], nodes[1:-1:2]))


def _slab(stack, size: MeshSize):
    """Points, cells, layer of each cell and curves of a slab's right half."""
    x, (depth, layer) = (
        with_middles(_columns(stack, size)),
        _rows(stack, size, sum(stack.thicknesses)),
    )
    y = -with_middles(depth)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(points)).reshape(len(x), len(y))
    steps = _quads(len(x) // 2, len(y) // 2)
    curves = {"skin": number[:, 0], "base": number[::-1, -1], "sides": number[-1, :]}
    return points, number[steps[..., 0], steps[..., 1]], np.repeat(layer, len(x) // 2), curves


def _half_round(stack, size: MeshSize):
    """The same of a half-round."""
    radius, above = stack.radius, sum(stack.thicknesses[:-1])
    solid = stack.solid
    ring = above + (1.0 - _RING) * (radius - above) if solid else sum(stack.thicknesses)
    s, (depth, layer) = _columns(stack, size), _rows(stack, size, ring)
    angle = with_middles(s) / radius
    sine, cosine = np.sin(angle), np.cos(angle)
    sine[0], cosine[-1] = 0.0, 0.0  # exactly on the axis and on the base
    way = np.stack((sine, cosine), axis=-1)
    points = (radius - with_middles(depth))[None, :, None] * way[:, None, :]
    wide = len(s) - 1
    if not solid:
        number = np.arange(points[..., 0].size).reshape(points.shape[:2])
        steps = _quads(wide, len(depth) - 1)
        base = np.concatenate((number[-1, :-1], number[::-1, -1]))
        curves = {"skin": number[:, 0], "base": base}
        return (
            points.reshape(-1, 2),
            number[steps[..., 0], steps[..., 1]],
            np.repeat(layer, wide),
            curves,
        )

    # between the innermost circle and a block whose corner lies on the column nearest to 45 degrees
    inner = radius - ring
    corner = int(np.clip(np.argmin(np.abs(s / radius - 0.25 * np.pi)), 1, wide - 1))
    cx, cy = _RING * inner * way[2 * corner]
    along = with_middles(s)
    top = np.clip(along / s[corner], 0.0, 1.0)
    side = np.clip((along - s[corner]) / (s[-1] - s[corner]), 0.0, 1.0)
    block = np.stack((cx * top, cy * (1.0 - side)), axis=-1)
    room = np.hypot(*(points[:, -1] - block).T).mean()
    rings = max(
        2, int(np.ceil(room / max(depth[-1] - depth[-2], inner * np.diff(s).min() / radius)))
    )
    rings = min(rings, max(4, wide // 2))
    share = np.linspace(0.0, 1.0, 2 * rings + 1)[1:, None]
    between = (1.0 - share) * points[:, -1][:, None, :] + share * block[:, None, :]
    points = np.concatenate((points, between), axis=1)
    deep = points.shape[1]
    number = np.arange(points[..., 0].size).reshape(points.shape[:2])
    steps = _quads(wide, (deep - 1) // 2)
    cells, last = [number[steps[..., 0], steps[..., 1]]], len(stack.thicknesses) - 1
    layer = [np.repeat(np.concatenate((layer, np.full(rings, last))), wide)]
    # the block itself: its top and its right side are the ring's innermost nodes
    across, down = 2 * corner + 1, 2 * (wide - corner) + 1
    grid = np.empty((across, down), dtype=int)
    grid[:, 0], grid[-1, :] = number[:across, -1], number[2 * corner :, -1]
    grid[:-1, 1:] = number.size + np.arange((across - 1) * (down - 1)).reshape(across - 1, down - 1)
    inside = np.stack(
        np.meshgrid(block[: across - 1, 0], block[2 * corner + 1 :, 1], indexing="ij"), axis=-1
    )
    steps = _quads(corner, wide - corner)
    cells.append(grid[steps[..., 0], steps[..., 1]])
    layer.append(np.full(len(steps), last))
    base = np.concatenate((number[-1, :-1], grid[::-1, -1]))
    points = np.concatenate((points.reshape(-1, 2), inside.reshape(-1, 2)))
    return (
        points,
        np.concatenate(cells),
        np.concatenate(layer),
        {"skin": number[:, 0], "base": base},
    )


def build_stack_mesh(stack, size: MeshSize) -> PadMesh:
    """Mesh a slab or a half-round with second-order quads (quad9), mirror-symmetric to the last
    bit.

    Parameters
    ---------- stack : has `names` and `thicknesses` (m) of the layers, outside to inside,
    `half_width` (m), `radius` (m; None for a slab)
        and, for a half-round, `solid`: whether the innermost layer fills it.
    size : edge lengths; `layer_edge` holds to a depth of half of `fine_half_width`, below it rows
    grow.

    Returns
    -------
    PadMesh with the curves "skin", "base" (fixed) and, of a slab, "sides" (free).

    Raises
    ------
    MeshError : when an element would be inverted.
    """
    points, cells, region, curves = (
        _slab(stack, size) if stack.radius is None else _half_round(stack, size)
    )
    on_axis = points[:, 0] == 0.0
    mirror = np.arange(len(points))
    mirror[~on_axis] = len(points) + np.arange(np.count_nonzero(~on_axis))
    by_layer = np.argsort(np.concatenate((region, region)), kind="stable")

    def whole(name, line):
        right = _chain(line)
        left = mirror[right][::-1][:, [1, 0, 2]]
        if name == "skin":
            return np.concatenate((left, right)).astype(np.int32)
        return np.concatenate((right, left)).astype(np.int32)

    mesh = PadMesh(
        points=np.concatenate((points, points[~on_axis] * (-1.0, 1.0))),
        cells=np.concatenate((cells, mirror[cells][:, KINDS["quad9"].mirrored]))[by_layer].astype(
            np.int32
        ),
        element="quad9",
        region=np.concatenate((region, region))[by_layer].astype(np.int8),
        curves={name: whole(name, line) for name, line in curves.items()},
        symmetric=True,
        regions=tuple(stack.names),
        fixed=("base",),
    )
    try:
        check_orientation(mesh, "specimen")
    except MeshError as error:
        raise MeshError(f"{error}; thicker layers or a smaller skin_edge are allowed") from None
    return mesh

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
from typing import Any

import numpy as np

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.grid import graded, with_middles
from fingerpad.specimen.pad import MeshSize, PadMesh
from fingerpad.specimen.quality import check_orientation

_COARSEST = 8.0  # largest edge along the surface and across the layers, in those under the contact
_ROWS = 2  # rows in a layer, at least
_MOST = 64  # edges to either side of the middle and across the stack, at most, before they grow
# radius of a solid core's block, in that of the ring round it; and of that ring, in the innermost
# layer's
_RING = 0.62
_TURN = 0.2  # largest angle in radians that an edge along a half-round may turn by
_GRID = 8001  # places at which edges are asked for
_QUAD = ((0, 2), (2, 2), (2, 0), (0, 0), (1, 2), (2, 1), (1, 0), (0, 1), (1, 1))


def _columns(stack: Any, size: MeshSize) -> np.ndarray:
    """Arc lengths of the column boundaries from the middle to the rim of the surface."""
    skin_edge = max(size.skin_edge, size.fine_half_width / _MOST)
    largest = size.coarse_edge or _COARSEST * skin_edge
    length = stack.half_width
    places = np.abs([x for x, _ in size.focus])
    if stack.radius is not None:
        length = 0.5 * np.pi * stack.radius
        largest = min(largest, _TURN * stack.radius)
        places = stack.radius * np.arcsin(np.minimum(places / stack.radius, 1.0))
    fine = min(np.ceil(size.fine_half_width / skin_edge - 1e-6) * skin_edge, length)
    ends = [0.0, length] if length - fine < skin_edge else [0.0, fine, length]
    edges = [edge for _, edge in size.focus]
    return graded(
        np.linspace(0.0, length, _GRID),
        lambda s: np.where(s <= ends[1], min(skin_edge, largest), largest),
        ends,
        [(s, edge) for s, edge in zip(places.tolist(), edges, strict=True) if s < length],
        size.growth,
    )


def _rows(stack: Any, size: MeshSize, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Depths of the row boundaries from the surface to ``depth``, and the layer of each row."""
    bounds = np.cumsum(stack.thicknesses)
    layer_edge = max(size.layer_edge, depth / _MOST)
    first = min(size.skin_radial_edge or layer_edge, layer_edge)
    slope, fine = np.log(size.growth), 0.5 * size.fine_half_width
    ends = [0.0, *bounds[bounds < depth * (1 - 1e-9)].tolist(), depth]

    def wanted(d):
        edge = np.minimum(first + slope * d, layer_edge)
        edge += np.clip(slope * (d - fine), 0.0, _COARSEST * layer_edge)
        for low, high in pairwise(ends):
            edge = np.where((d >= low) & (d <= high), np.minimum(edge, (high - low) / _ROWS), edge)
        return edge

    rows = graded(np.linspace(0.0, depth, _GRID), wanted, ends, (), size.growth)
    middle = 0.5 * (rows[1:] + rows[:-1])
    return rows, np.minimum(np.searchsorted(bounds, middle), len(bounds) - 1)


def _quads(nodes: np.ndarray) -> np.ndarray:
    """Elements (n, 9) of a grid of node numbers (columns, rows), row after row; rows count
    downwards.
    """
    wide, deep = nodes.shape
    parts = [nodes[i : wide - 2 + i : 2, j : deep - 2 + j : 2] for i, j in _QUAD]
    return np.stack(parts, axis=-1).swapaxes(0, 1).reshape(-1, 9)


def _slab(stack: Any, size: MeshSize):
    """Points, cells, layer of each cell and curves of a slab's right half."""
    depth, layer = _rows(stack, size, sum(stack.thicknesses))
    x, y = with_middles(_columns(stack, size)), -with_middles(depth)
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(points)).reshape(len(x), len(y))
    curves = {"skin": number[:, 0], "base": number[::-1, -1], "sides": number[-1, :]}
    return points, _quads(number), np.repeat(layer, len(x) // 2), curves


def _half_round(stack: Any, size: MeshSize):
    """The same of a half-round."""
    radius, above, last = stack.radius, sum(stack.thicknesses[:-1]), len(stack.thicknesses) - 1
    shells = above + (1.0 - _RING) * (radius - above) if stack.solid else sum(stack.thicknesses)
    s, (depth, layer) = _columns(stack, size), _rows(stack, size, shells)
    angle, wide = with_middles(s) / radius, len(s) - 1
    way = np.column_stack((np.sin(angle), np.cos(angle)))
    way[0, 0], way[-1, 1] = 0.0, 0.0  # exactly on the axis and on the base
    points = (radius - with_middles(depth))[None, :, None] * way[:, None, :]
    if stack.solid:
        # a block whose corner lies on the column nearest to 45 degrees, and rings round it
        inner = radius - shells
        corner = int(np.clip(np.argmin(np.abs(s / radius - 0.25 * np.pi)), 1, wide - 1))
        along, side = with_middles(s), _RING * inner * way[2 * corner]
        share = (along / s[corner], (along - s[corner]) / (s[-1] - s[corner]))
        across, up = np.clip(share, 0.0, 1.0)
        block = side * np.column_stack((across, 1.0 - up))
        room = np.hypot(*(points[:, -1] - block).T).mean()
        edge = max(depth[-1] - depth[-2], inner * np.diff(s).min() / radius)
        rings = min(max(2, int(np.ceil(room / edge))), max(4, wide // 2))
        share = np.linspace(0.0, 1.0, 2 * rings + 1)[1:, None]
        between = (1.0 - share) * points[:, -1:] + share * block[:, None]
        points = np.concatenate((points, between), axis=1)
        layer = np.append(layer, np.full(rings, last))
    number = np.arange(points[..., 0].size).reshape(points.shape[:2])
    points, innermost = points.reshape(-1, 2), number
    cells, region = _quads(number), np.repeat(layer, wide)
    if stack.solid:
        # the block: its top and its right side are the innermost ring's nodes
        inside = np.meshgrid(block[: 2 * corner, 0], block[2 * corner + 1 :, 1], indexing="ij")
        innermost = np.empty((2 * corner + 1, 2 * (wide - corner) + 1), dtype=int)
        innermost[:, 0], innermost[-1] = number[: 2 * corner + 1, -1], number[2 * corner :, -1]
        innermost[:-1, 1:] = number.size + np.arange(inside[0].size).reshape(inside[0].shape)
        points = np.concatenate((points, np.stack(inside, axis=-1).reshape(-1, 2)))
        cells = np.concatenate((cells, _quads(innermost)))
        region = np.append(region, np.full(len(cells) - len(region), last))
    base = np.concatenate((number[-1, :-1], innermost[::-1, -1]))
    return points, cells, region, {"skin": number[:, 0], "base": base}


def build_stack_mesh(stack: Any, size: MeshSize) -> PadMesh:
    """Mesh a slab or a half-round with second-order quads (quad9), mirror-symmetric to the last
    bit.

    Parameters
    ----------
    stack : fingerpad.scenes.specimen.Slab or HalfRound
        Has `names` and `thicknesses` (m) of the layers, outside to inside, `half_width` (m),
        `radius` (m; None for a slab) and, for a half-round, `solid`: whether the innermost layer
        fills it.
    size : MeshSize
        Edge lengths; `layer_edge` holds to a depth of half of `fine_half_width`, below it rows
        grow.

    Returns
    -------
    PadMesh
        With the curves "skin", "base" (fixed) and, of a slab, "sides" (free).

    Raises
    ------
    MeshError
        An element would be inverted.
    """
    shape = _slab if stack.radius is None else _half_round
    points, cells, region, curves = shape(stack, size)
    left = np.flatnonzero(points[:, 0] != 0.0)
    mirror = np.arange(len(points))
    mirror[left] = len(points) + np.arange(len(left))
    region = np.tile(region, 2)
    by_layer = np.argsort(region, kind="stable")

    def whole(name: str, line: np.ndarray) -> np.ndarray:
        right = np.column_stack((line[:-2:2], line[2::2], line[1:-1:2]))  # start, end, middle
        halves = [right, mirror[right][::-1][:, [1, 0, 2]]]
        return np.concatenate(halves[::-1] if name == "skin" else halves).astype(np.int32)

    cells = np.concatenate((cells, mirror[cells][:, KINDS["quad9"].mirrored]))
    mesh = PadMesh(
        points=np.concatenate((points, points[left] * (-1.0, 1.0))),
        cells=cells[by_layer].astype(np.int32),
        element="quad9",
        region=region[by_layer].astype(np.int8),
        curves={name: whole(name, line) for name, line in curves.items()},
        symmetric=True,
        regions=tuple(stack.names),
        fixed=("base",),
    )
    check_orientation(mesh, "specimen", "thicker layers or a smaller skin_edge")
    return mesh

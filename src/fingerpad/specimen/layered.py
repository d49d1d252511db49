"""How the mesh of a pad is laid out: columns along the skin, rows below it, and which of them are
refined for ridges.

Nodes are named on a lattice of sixths of a column and eighths of a row, and then placed. Ridges
need columns three times as fine as the plain mesh's, but only where they are: between two rows of
3:1 templates (four quads each), one in the epidermis and one in the dermis, within the zone that
has ridges. Outer ridges need them up to the skin. Below and beside stays the plain mesh.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fingerpad.specimen.grid import (
    columns_of,
    divide,
    fat_rows_of,
    limit_growth,
    node_positions,
    plain_rows,
)
from fingerpad.specimen.outline import OutlineCurve, OutlineLike, curve_of
from fingerpad.specimen.pad import MeshError, MeshSize
from fingerpad.specimen.ridges import RidgedPad, wave_of

PER_PITCH = 8  # elements from one ridge to the next, at least
# rows within a ridge's height of the interface, unless the ridges are low (see `_interface_edge`)
PER_HEIGHT = 4
_GROWTH = 1.25  # largest ratio of one row to the next between the templates
_TEMPLATE = 0.9  # height of a row of templates, in columns of the plain mesh
COLUMN, ROW = 6, 8  # lattice steps of a column and of a row
# kinds of rows; a row of templates narrows or widens the columns above it
COARSE, FINE, NARROWS, WIDENS = range(4)


def _quad(*corners: tuple[int, int]) -> np.ndarray:
    """Lattice steps (9, 2) of a second-order quad with straight sides."""
    ends = np.array(corners)
    middles = (ends + np.roll(ends, -1, axis=0)) // 2
    return np.concatenate((ends, middles, ends.sum(axis=0, keepdims=True) // 4))


_WIDENING = [  # three edges above, one below; rows count downwards, corners run counter-clockwise
    _quad((0, 8), (2, 4), (2, 0), (0, 0)),
    _quad((2, 4), (4, 4), (4, 0), (2, 0)),
    _quad((4, 4), (6, 8), (6, 0), (4, 0)),
    _quad((0, 8), (6, 8), (4, 4), (2, 4)),
]
_CELLS = {
    COARSE: np.array([_quad((0, 8), (6, 8), (6, 0), (0, 0))]),
    FINE: np.array([_quad((x, 8), (x + 2, 8), (x + 2, 0), (x, 0)) for x in (0, 2, 4)]),
    WIDENS: np.array(_WIDENING),
    NARROWS: np.array(
        [(cell * (1, -1) + (0, 8))[[3, 2, 1, 0, 6, 5, 4, 7, 8]] for cell in _WIDENING]
    ),
}


@dataclass(frozen=True)
class Layout:
    """Columns and rows of the right half of a pad's mesh.

    Parameters
    ----------
    curve, ridged
        The pad's outline, and its ridges or None.
    columns : (n + 1,) array
        Arc lengths (m) of their boundaries from the apex.
    nail : int
        Column at which the nail begins.
    zone : int
        Columns from the apex in which rows are of their kind; elsewhere they are coarse.
    rows : (k + 1,) array
        Depths (m) of the boundaries of the rows above the fat.
    kinds, region : (r,) arrays
        Kind of each row, those in the fat included, and the number of its layer.
    fat_edge : float
        First edge (m) in the fat.
    """

    curve: OutlineCurve
    ridged: RidgedPad | None
    columns: np.ndarray
    nail: int
    zone: int
    rows: np.ndarray
    kinds: np.ndarray
    region: np.ndarray
    fat_edge: float

    @property
    def half(self) -> int:
        """Lattice steps from the apex to the bottom of the section."""
        return COLUMN * (len(self.columns) - 1)

    def cells(self) -> np.ndarray:
        """Lattice steps (elements, 9, 2) of the nodes of the right half's elements, row by row."""
        blocks = []
        for row, kind in enumerate(self.kinds):
            for low, high, cells in (
                (0, self.zone, _CELLS[int(kind)]),
                (self.zone, len(self.columns) - 1, _CELLS[COARSE]),
            ):
                start = np.column_stack((np.arange(low, high) * COLUMN, np.full(high - low, row)))
                blocks.append((start[:, None, None] * (1, ROW) + cells).reshape(-1, 9, 2))
        return np.concatenate(blocks)

    def points(self, column: np.ndarray, row: np.ndarray) -> np.ndarray:
        """Positions (n, 2) in m of lattice points; columns left of the apex are negative."""
        s = np.interp(np.abs(column), COLUMN * np.arange(len(self.columns)), self.columns)
        border = ROW * (len(self.rows) - 1)
        skin = row < border
        depth = np.interp(row[skin], ROW * np.arange(len(self.rows)), self.rows)
        if self.ridged is not None:
            depth = self.ridged.depth(np.where(column[skin] < 0, -1.0, 1.0) * s[skin], depth)
        unique, back = np.unique(s[skin], return_inverse=True)
        points = np.empty((len(column), 2))
        points[skin] = self.curve.point(self.curve.theta_at(unique)[back], depth)
        fat_rows = len(self.kinds) - len(self.rows) + 1
        fat = node_positions(self.curve, self.columns, self.rows[-1], fat_rows, self.fat_edge)
        points[~skin] = fat[2 * np.abs(column[~skin]) // COLUMN, 2 * (row[~skin] - border) // ROW]
        points[column < 0, 0] *= -1.0
        return points


def ridge_column(size: MeshSize, ridges: Any) -> float:
    """Edge (m) along the skin of the columns from which the ridges' are made."""
    return min(size.skin_edge, 3.0 * wave_of(ridges.inner) / PER_PITCH)


def apex_column(size: MeshSize, ridges: Any) -> float:
    """Edge (m) along the skin of the columns at the apex from which the ridges' are made: these are
    a third as wide.
    """
    focus = [edge for x, edge in size.focus if x == 0]
    return min([ridge_column(size, ridges), *focus])


def skin_edge(size: MeshSize, ridges: Any, edge: float) -> float:
    """Edge (m) along the skin under the apex that would be `edge` in the plain mesh."""
    edge = min(edge, ridge_column(size, ridges))
    return edge / 3 if ridges.outer is not None else edge


def _interface_edge(fine: float, growth: float, ridged: RidgedPad) -> float:
    """Edge (m) across the interface; `fine` is the edge along it.

    Not below a fortieth of the distance between ridges, which matters for ridges lower than a
    quarter of it: strains about them fade over that distance, not over their height.
    """
    inner, slope = ridged.inner, np.log(growth)
    room = min(ridged.interface - ridged.above, ridged.below - ridged.interface)
    stretched = 1.0 + max(ridged.mean, 1.0 - ridged.mean) * inner.height / room
    wanted = inner.height / stretched * slope / (growth**PER_HEIGHT - 1.0)
    return float(np.clip(wanted, min(fine / 3, ridged.wave / 40), fine / 2))


def _skin_rows(curve: OutlineCurve, size: MeshSize, ridged: RidgedPad | None, corneum: float):
    """Depths of row boundaries down to the fat, and the kind of each row."""
    interface, bottom = curve.layer_depths
    first = min(size.skin_radial_edge or size.layer_edge, size.layer_edge)
    ends, kinds, growth = [interface, bottom], [COARSE, COARSE], min(size.growth, _GROWTH)
    fixed = {0.0: first}
    if ridged is not None:
        column = ridge_column(size, ridged)
        template = _TEMPLATE * column
        below = min(ridged.below, bottom - template)
        rest = bottom - below - template
        ends, kinds = [interface, below, below + template, bottom], [FINE, FINE, WIDENS, COARSE]
        if rest < 0.3 * size.layer_edge:
            below = bottom - template
            ends, kinds = [interface, below, bottom], [FINE, FINE, WIDENS]
        if (
            below < ridged.below - 1e-9
            and below - interface < 1.5 * (1.0 - ridged.mean) * ridged.inner.height
        ):
            raise MeshError(
                "ridges: the dermis is too thin to mesh them; "
                "a thicker dermis or lower ridges are allowed"
            )
        if ridged.outer is None and ridged.above - template - corneum > 0.5 * size.layer_edge:
            ends, kinds = (
                [ridged.above - template, ridged.above, *ends],
                [COARSE, NARROWS, *kinds],
            )
        fixed[interface] = _interface_edge(column / 3, growth, ridged)
        if ridged.outer is not None:
            fixed[0.0] = min(first, column / 6)
    if corneum:
        place = int(np.searchsorted(ends, corneum))
        if abs(ends[place] - corneum) > 1e-9:
            ends.insert(place, corneum)
            kinds.insert(place, kinds[place])
    grid = np.union1d(np.linspace(0.0, bottom, 8001), [*ends, *fixed])
    edge = np.full_like(grid, size.layer_edge)
    for depth, wanted in fixed.items():
        edge[grid == depth] = np.minimum(edge[grid == depth], wanted)
    edges = {FINE: limit_growth(grid, edge, growth)}
    edge[grid >= ends[0]] = size.layer_edge  # templates part coarse rows from fine ones
    edges[COARSE] = limit_growth(grid, edge, size.growth)
    rows, row_kinds = [0.0], []
    for low, high, kind in zip([0.0, *ends[:-1]], ends, kinds, strict=True):
        if kind in edges:
            rounding = np.ceil if kind == FINE else np.round
            part = divide(grid, edges[kind], low, high, rounding)
        else:
            part = np.array([low, high])
        rows.extend(part[1:])
        row_kinds.extend([kind] * (len(part) - 1))
    return np.array(rows), np.array(row_kinds)


def layout_of(outline: OutlineLike, size: MeshSize, ridges: Any, corneum: bool) -> Layout:
    """The layout of a pad's mesh; arguments and errors as of
    :func:`fingerpad.specimen.build.build_pad_mesh`.
    """
    curve = curve_of(outline)
    thickness = outline.stratum_corneum_thickness if corneum else 0.0
    if thickness >= outline.epidermis_thickness:
        raise MeshError(
            "outline: the stratum corneum leaves no epidermis below it; "
            "less than epidermis_thickness is allowed"
        )
    ridged = RidgedPad(outline, ridges, thickness) if ridges else None
    if ridged is not None:
        if ridged.extent > float(curve.arc_length(0.5 * np.pi)[0]):
            raise MeshError(
                "ridges: half_width and a pitch reach beyond the pad's widest place; "
                "less is allowed"
            )
        size = replace(
            size,
            skin_edge=ridge_column(size, ridged),
            fine_half_width=max(size.fine_half_width, ridged.extent),
        )
    columns, nail = columns_of(curve, size)
    zone = int(np.searchsorted(columns, ridged.extent - 1e-9)) if ridged else 0
    if ridged or corneum:
        rows, kinds = _skin_rows(curve, size, ridged, thickness)
    else:
        rows = plain_rows(curve, size)
        kinds = np.full(len(rows) - 1, COARSE)
    fat, fat_edge = fat_rows_of(curve, size, rows[-1] - rows[-2])
    bounds = [*([thickness] if corneum else []), *curve.layer_depths]
    region = np.searchsorted(bounds, 0.5 * (rows[1:] + rows[:-1]))
    region = np.append(region, np.full(fat, len(bounds))).astype(np.int8)
    kinds = np.append(kinds, np.full(fat, COARSE))
    return Layout(curve, ridged, columns, nail, zone, rows, kinds, region, fat_edge)


def ridge_resolution(
    outline: OutlineLike, size: MeshSize, ridges: Any, corneum: bool = False
) -> tuple[float, int]:
    """Elements from one inner ridge to the next, and rows within a ridge's height of the interface,
    the fewest of each.

    The rows are counted above and below the tip and the valley nearest to x = 0.
    """
    layout = layout_of(outline, size, ridges, corneum)
    ridged, rows = layout.ridged, layout.rows
    widest = np.diff(layout.columns[: layout.zone + 1]).max() / 3
    at = int(np.argmin(np.abs(rows - ridged.interface)))
    counts = []
    for s in (ridged.tip, ridged.tip + ridged.wave / 2):
        depth = ridged.depth(np.full_like(rows, s), rows)
        near = np.abs(depth - depth[at]) <= ridged.inner.height * (1.0 + 1e-9)
        counts += [np.count_nonzero(near[:at]), np.count_nonzero(near[at + 1 :])]
    return float(ridged.wave / widest), int(min(counts))

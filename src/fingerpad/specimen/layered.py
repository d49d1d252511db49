"""Meshes of pads with ridges, or with a stratum corneum of its own.

Ridges need columns three times as fine as the plain mesh's, but only where they are: between two
rows of 3:1 templates (four quads each), one in the epidermis and one in the dermis, within the zone
that has ridges. Outer ridges need them up to the skin. Below and beside stays the plain mesh. Nodes
are named on a lattice of sixths of a column and eighths of a row, and then placed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.grid import columns_of, divide, fat_rows_of, limit_growth, node_positions
from fingerpad.specimen.outline import OutlineCurve, OutlineLike, curve_of
from fingerpad.specimen.pad import OPTIONAL, REGIONS, MeshError, MeshSize, PadMesh
from fingerpad.specimen.quality import check_orientation
from fingerpad.specimen.ridges import RidgedPad, RidgesLike

PER_PITCH = 8  # elements from one ridge to the next, at least
# rows within a ridge's height of the interface, unless the ridges are low (see `_interface_edge`)
PER_HEIGHT = 4
_GROWTH = 1.25  # largest ratio of one row to the next between the templates
_TEMPLATE = 0.9  # height of a row of templates, in columns of the plain mesh
_C, _R = 6, 8  # lattice steps of a column and of a row
_COARSE, _FINE, _NARROWS, _WIDENS = range(
    4
)  # kinds of rows; a row of templates narrows or widens the columns above it


def _quad(*corners: tuple[int, int]) -> np.ndarray:
    """Lattice steps (9, 2) of a second-order quad with straight sides."""
    ends = np.array(corners)
    nodes = np.concatenate((ends, (ends + np.roll(ends, -1, axis=0)) / 2, ends.mean(axis=0)[None]))
    assert (nodes == np.rint(nodes)).all(), "not on the lattice"
    return nodes.astype(int)


_WIDENING = [  # three edges above, one below; rows count downwards, corners run counter-clockwise
    _quad((0, 8), (2, 4), (2, 0), (0, 0)),
    _quad((2, 4), (4, 4), (4, 0), (2, 0)),
    _quad((4, 4), (6, 8), (6, 0), (4, 0)),
    _quad((0, 8), (6, 8), (4, 4), (2, 4)),
]
_CELLS = {
    _COARSE: np.array([_quad((0, 8), (6, 8), (6, 0), (0, 0))]),
    _FINE: np.array([_quad((x, 8), (x + 2, 8), (x + 2, 0), (x, 0)) for x in (0, 2, 4)]),
    _WIDENS: np.array(_WIDENING),
    _NARROWS: np.array(
        [(cell * (1, -1) + (0, 8))[[3, 2, 1, 0, 6, 5, 4, 7, 8]] for cell in _WIDENING]
    ),
}


@dataclass(frozen=True)
class _Grid:
    """Columns (arc lengths m) and rows (depths m) of the skin's layers, and which of them are
    refined.
    """

    columns: np.ndarray
    nail: int
    zone: (
        int  # columns from the apex within which rows are of their kind; elsewhere they are coarse
    )
    rows: np.ndarray
    kinds: np.ndarray
    region: np.ndarray  # of each row of skin and fat
    fat: int
    fat_edge: float


def ridge_column(size: MeshSize, ridged: RidgedPad) -> float:
    """Edge (m) along the skin of the columns from which the ridges' are made."""
    return min(size.skin_edge, 3.0 * ridged.wave / PER_PITCH)


def apex_column(outline: OutlineLike, size: MeshSize, ridges: RidgesLike) -> float:
    """Edge (m) along the skin of the columns at the apex from which the ridges' are made: these are
    a third as wide.
    """
    return min(
        [
            ridge_column(size, RidgedPad(outline, ridges)),
            *(edge for x, edge in size.focus if x == 0),
        ]
    )


def skin_edge(outline: OutlineLike, size: MeshSize, ridges: RidgesLike, edge: float) -> float:
    """Edge (m) along the skin under the apex that would be `edge` in the plain mesh."""
    edge = min(edge, ridge_column(size, RidgedPad(outline, ridges)))
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
    ends, kinds, growth = [interface, bottom], [_COARSE, _COARSE], min(size.growth, _GROWTH)
    fixed = {0.0: first}
    if ridged is not None:
        column = ridge_column(size, ridged)
        template = _TEMPLATE * column
        below = min(ridged.below, bottom - template)
        rest = bottom - below - template
        ends, kinds = [interface, below, below + template, bottom], [_FINE, _FINE, _WIDENS, _COARSE]
        if rest < 0.3 * size.layer_edge:
            below = bottom - template
            ends, kinds = [interface, below, bottom], [_FINE, _FINE, _WIDENS]
        if (
            below < ridged.below - 1e-9
            and below - interface < 1.5 * (1.0 - ridged.mean) * ridged.inner.height
        ):
            raise MeshError(
                "ridges: the dermis is too thin to mesh them; a thicker dermis or lower ridges are allowed"
            )
        if ridged.outer is None and ridged.above - template - corneum > 0.5 * size.layer_edge:
            ends, kinds = (
                [ridged.above - template, ridged.above, *ends],
                [_COARSE, _NARROWS, *kinds],
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
    edges = {_FINE: limit_growth(grid, edge, growth)}
    edge[grid >= ends[0]] = size.layer_edge  # templates part coarse rows from fine ones
    edges[_COARSE] = limit_growth(grid, edge, size.growth)
    rows, kind = [0.0], []
    for low, high, each in zip([0.0, *ends[:-1]], ends, kinds, strict=True):
        if each in (_NARROWS, _WIDENS):
            part = np.array([low, high])
        else:
            part = divide(grid, edges[each], low, high, np.ceil if each == _FINE else np.round)
        rows.extend(part[1:].tolist())
        kind.extend([each] * (len(part) - 1))
    return np.array(rows), np.array(kind)


def _grid(outline: OutlineLike, size: MeshSize, ridges: RidgesLike | None, corneum: bool):
    """The grid, the pad's curve and its ridges."""
    curve = curve_of(outline)
    thick = outline.stratum_corneum_thickness if corneum else 0.0
    if thick >= outline.epidermis_thickness:
        raise MeshError(
            "outline: the stratum corneum leaves no epidermis below it; less than epidermis_thickness is allowed"
        )
    ridged = RidgedPad(outline, ridges, thick) if ridges else None
    if ridged is not None:
        if ridged.extent > float(curve.arc_length(0.5 * np.pi)[0]):
            raise MeshError(
                "ridges: half_width and a pitch reach beyond the pad's widest place; less is allowed"
            )
        edge = ridge_column(size, ridged)
        size = replace(
            size, skin_edge=edge, fine_half_width=max(size.fine_half_width, ridged.extent)
        )
    columns, nail = columns_of(curve, size)
    zone = int(np.searchsorted(columns, ridged.extent - 1e-9)) if ridged else 0
    rows, kinds = _skin_rows(curve, size, ridged, thick)
    fat, fat_edge = fat_rows_of(curve, size, rows[-1] - rows[-2])
    middle = 0.5 * (rows[1:] + rows[:-1])
    bounds = [*([thick] if corneum else []), *curve.layer_depths]
    region = np.concatenate((np.searchsorted(bounds, middle), np.full(fat, len(bounds))))
    return (
        _Grid(
            columns,
            nail,
            zone,
            rows,
            np.concatenate((kinds, np.full(fat, _COARSE))),
            region,
            fat,
            fat_edge,
        ),
        curve,
        ridged,
    )


def _right_cells(grid: _Grid) -> tuple[np.ndarray, np.ndarray]:
    """Lattice steps (elements, 9, 2) of the right half's elements, and their region."""
    cells, region = [], []
    for row, (kind, layer) in enumerate(zip(grid.kinds, grid.region, strict=True)):
        for low, high, each in ((0, grid.zone, kind), (grid.zone, len(grid.columns) - 1, _COARSE)):
            start = np.stack((np.arange(low, high) * _C, np.full(high - low, row * _R)), axis=1)
            block = (start[:, None, None, :] + _CELLS[int(each)]).reshape(-1, 9, 2)
            cells.append(block)
            region.append(np.full(len(block), layer, dtype=np.int8))
    return np.concatenate(cells), np.concatenate(region)


def _places(
    grid: _Grid, curve: OutlineCurve, ridged: RidgedPad | None, column: np.ndarray, row: np.ndarray
) -> np.ndarray:
    """Positions (n, 2) in m of lattice points; columns left of the apex are negative."""
    index = np.arange(len(grid.columns)) * float(_C)
    s = np.interp(np.abs(column), index, grid.columns)
    points = np.empty((len(column), 2))
    deep = row >= _R * (len(grid.rows) - 1)
    skin = ~deep
    depth = np.interp(row[skin], np.arange(len(grid.rows)) * float(_R), grid.rows)
    if ridged is not None:
        depth = ridged.depth(np.where(column[skin] < 0, -1.0, 1.0) * s[skin], depth)
    unique, back = np.unique(s[skin], return_inverse=True)
    points[skin] = curve.point(curve.theta_at(unique)[back], depth)
    fat = node_positions(curve, grid.columns, grid.rows[-1:], grid.fat, grid.fat_edge)
    points[deep] = fat[
        2 * np.abs(column[deep]) // _C, 2 * (row[deep] - _R * (len(grid.rows) - 1)) // _R
    ]
    points[column < 0, 0] *= -1.0
    return points


def build_layered_mesh(
    outline: OutlineLike, size: MeshSize, ridges: RidgesLike | None, corneum: bool
) -> PadMesh:
    """The pad with ridges or a layer ``stratum_corneum``; see
    :func:`fingerpad.specimen.build.build_pad_mesh`.
    """
    grid, curve, ridged = _grid(outline, size, ridges, corneum)
    steps, region = _right_cells(grid)
    half = _C * (len(grid.columns) - 1)
    ring, deep = 2 * half, _R * len(grid.kinds) + 1
    steps = np.concatenate((steps, (steps * (-1, 1))[:, KINDS["quad9"].mirrored]))
    key = steps[..., 0] % ring * deep + steps[..., 1]
    known, cells = np.unique(key, return_inverse=True)
    column = known // deep
    points = _places(
        grid, curve, ridged, np.where(column > half, column - ring, column), known % deep
    )

    def chain(marks: np.ndarray, row: int) -> np.ndarray:
        ends = np.column_stack((marks[:-1], marks[1:], (marks[:-1] + marks[1:]) // 2))
        return np.searchsorted(known, ends % ring * deep + row).astype(np.int32)

    nail, zone = _C * grid.nail, _C * grid.zone if grid.kinds[0] == _FINE else 0
    right = np.concatenate((np.arange(0, zone, 2), np.arange(zone, nail + 1, _C)))
    cells = cells.reshape(-1, 9).astype(np.int32)
    region = np.concatenate((region, region))
    by_layer = np.argsort(region, kind="stable")
    mesh = PadMesh(
        points=points,
        cells=cells[by_layer],
        element="quad9",
        region=region[by_layer],
        curves={
            "skin": chain(np.concatenate((-right[:0:-1], right)), 0),
            "bone": chain(np.arange(half, -half - 1, -_C), deep - 1),
            "nail": chain(np.arange(nail, ring - nail + 1, _C), 0),
        },
        symmetric=ridged is None or ridged.symmetric,
        regions=(*OPTIONAL, *REGIONS) if corneum else REGIONS,
    )
    try:
        check_orientation(mesh, "outline")
    except MeshError as error:
        raise MeshError(
            f"{error}; lower ridges, thicker layers or a smaller skin_edge are allowed"
        ) from None
    return mesh


def count_layered_nodes(
    outline: OutlineLike, size: MeshSize, ridges: RidgesLike | None, corneum: bool
) -> int:
    """Number of nodes of :func:`build_layered_mesh`, from its lattice alone."""
    grid = _grid(outline, size, ridges, corneum)[0]
    steps = _right_cells(grid)[0]
    half, deep = _C * (len(grid.columns) - 1), _R * len(grid.kinds) + 1
    column = np.unique(steps[..., 0] * deep + steps[..., 1]) // deep
    return 2 * len(column) - int(np.count_nonzero((column == 0) | (column == half)))


def ridge_resolution(
    outline: OutlineLike, size: MeshSize, ridges: RidgesLike, corneum: bool = False
) -> tuple[float, int]:
    """Elements from one inner ridge to the next, and rows within a ridge's height of the interface,
    the fewest of each.

    The rows are counted above and below the tip and the valley nearest to x = 0.
    """
    grid, _, ridged = _grid(outline, size, ridges, corneum)
    widest = np.diff(grid.columns[: grid.zone + 1]).max() / 3
    tip = ridged.tip
    rows = []
    for s in (tip, tip + ridged.wave / 2):
        depth = ridged.depth(np.full_like(grid.rows, s), grid.rows)
        at = int(np.argmin(np.abs(grid.rows - ridged.interface)))
        away = np.abs(depth - depth[at]) <= ridged.inner.height * (1.0 + 1e-9)
        rows += [np.count_nonzero(away[:at]), np.count_nonzero(away[at + 1 :])]
    return float(ridged.wave / widest), int(min(rows))

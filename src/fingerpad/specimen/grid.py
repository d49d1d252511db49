"""Where the nodes of the built meshes go: graded divisions, columns along the skin, rows below it,
positions on the section.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from fingerpad.specimen.outline import OutlineCurve, bisect
from fingerpad.specimen.pad import MeshSize

_COARSEST = 8.0  # largest edge along the skin, in skin edges
_LARGEST_GRID = 100_000  # places along the skin at which edges are asked for, evenly spaced
_LARGEST_TURN = 0.5  # largest angle in radians that one edge along the skin may turn by


def divide(grid: np.ndarray, edge: np.ndarray, low: float, high: float, rounding) -> np.ndarray:
    """Division points of [low, high] such that edges follow the wanted `edge` given on `grid`."""
    part = (grid >= low) & (grid <= high)
    s, density = grid[part], 1.0 / edge[part]
    number = np.concatenate(([0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))))
    count = max(1, int(rounding(number[-1] - 1e-6)))
    points = np.interp(np.linspace(0.0, number[-1], count + 1), number, s)
    points[0], points[-1] = low, high
    return points


def limit_growth(s: np.ndarray, edge: np.ndarray, growth: float) -> np.ndarray:
    """The largest edge lengths up to `edge` that grow by at most the factor `growth` from one to
    the next.
    """
    slope = np.log(growth)  # edges of a linearly growing length form a geometric series
    rising = np.minimum.accumulate(edge - slope * s) + slope * s
    return (np.minimum.accumulate((rising + slope * s)[::-1]))[::-1] - slope * s


def _grid_along(length: float, smallest: float, focus: list[float]) -> np.ndarray:
    """Arc lengths at which edges are asked for: four to the smallest edge; of tiny edges, only from
    focus to focus and near.
    """
    count = max(4000, int(np.ceil(4.0 * length / smallest)))
    if count <= _LARGEST_GRID:
        return np.linspace(0.0, length, count + 1)
    away = np.geomspace(smallest / 4, length, 2000)
    low, high = min(focus, default=0.0), max(focus, default=0.0)
    between = np.linspace(low, high, min(int(4 * (high - low) / smallest) + 2, _LARGEST_GRID))
    grid = np.concatenate([np.linspace(0.0, length, 4001), between, low - away, high + away])
    return np.unique(np.clip(grid, 0.0, length))


@lru_cache(maxsize=16)
def columns_of(curve: OutlineCurve, size: MeshSize) -> tuple[np.ndarray, int]:
    """Arc lengths of the column boundaries from apex to bottom, and the index of the nail's rim.

    The end of the fine zone, the widest place (where the curvature jumps) and the nail's rim are
    boundaries.
    """
    breaks = [
        0.0,
        float(curve.arc_length(0.5 * np.pi)[0]),
        float(curve.arc_length(curve.theta_at_x(curve.outline.nail_half_width, lower=True))[0]),
        curve.length,
    ]
    nail = breaks[2]
    fine = min(np.ceil(size.fine_half_width / size.skin_edge - 1e-6) * size.skin_edge, curve.length)
    nearest = min(breaks, key=lambda s: abs(s - fine))
    if abs(nearest - fine) < size.skin_edge:
        fine = nearest
    else:
        breaks = sorted([*breaks, fine])
    half_width = curve.outline.half_width
    focus = [
        (float(curve.arc_length(curve.theta_at_x(min(abs(x), half_width)))[0]), edge)
        for x, edge in size.focus
    ]

    smallest = min([size.skin_edge, *(edge for _, edge in focus)])
    grid = _grid_along(curve.length, smallest, [s for s, _ in focus])
    grid = np.union1d(grid, [*breaks, *(s for s, _ in focus)])
    radius = 1.0 / curve.curvature(curve.theta_at(grid))
    edge = np.minimum(_LARGEST_TURN * radius, radius - curve.layer_depths[-1])
    edge = np.minimum(edge, size.coarse_edge or _COARSEST * size.skin_edge)
    edge = np.where(grid <= fine, np.minimum(edge, size.skin_edge), edge)
    for low, high in pairwise(breaks):
        edge = np.where((grid >= low) & (grid <= high), np.minimum(edge, high - low), edge)
    for s, wanted in focus:
        edge = np.where(grid == s, np.minimum(edge, wanted), edge)
    edge = limit_growth(grid, edge, size.growth)

    parts = [
        divide(grid, edge, low, high, np.ceil if low <= fine else np.round)
        for low, high in pairwise(breaks)
    ]
    columns = np.concatenate([part[:-1] for part in parts] + [[curve.length]])
    return columns, int(np.searchsorted(columns, nail))


def _layer_rows(low: float, high: float, first: float, size: MeshSize) -> np.ndarray:
    """Depths of the row boundaries of one layer between the depths low and high."""
    if first >= size.layer_edge:
        return np.linspace(low, high, max(1, int(np.round((high - low) / size.layer_edge))) + 1)
    depth = np.linspace(low, high, 4001)
    edge = np.minimum(first + np.log(size.growth) * (depth - low), size.layer_edge)
    return divide(depth, edge, low, high, np.round)


def rows_of(curve: OutlineCurve, size: MeshSize) -> tuple[np.ndarray, tuple[int, int], int, float]:
    """Depths of the skin's row boundaries, rows above its interfaces, rows in the fat, first fat
    edge.
    """
    middle, inner = curve.layer_depths
    first = min(size.skin_radial_edge or size.layer_edge, size.layer_edge)
    epidermis = _layer_rows(0.0, middle, first, size)
    reached = min(first + np.log(size.growth) * middle, size.layer_edge)
    dermis = _layer_rows(middle, inner, reached, size)
    rows = np.concatenate((epidermis[:-1], dermis))
    return (
        rows,
        (len(epidermis) - 1, len(rows) - 1),
        *fat_rows_of(curve, size, dermis[-1] - dermis[-2]),
    )


def fat_rows_of(curve: OutlineCurve, size: MeshSize, above: float) -> tuple[int, float]:
    """Rows in the fat under the apex and their first edge, next to an edge `above` it."""
    fat = curve.outline.apex_height - curve.layer_depths[-1] - curve.bone_point(0.0)[0, 1]
    edge = size.growth * above
    count = np.log1p((size.growth - 1.0) * fat / edge) / np.log(size.growth)
    return max(1, int(np.ceil(count - 1e-6))), edge


def _fat_fractions(thickness: np.ndarray, count: int, edge: float) -> np.ndarray:
    """Row boundaries in the fat as fractions of its thickness (n,), shape (n, count + 1).

    Edges form a geometric series starting with `edge` where the fat is thick enough; elsewhere all
    are equal.
    """
    powers = np.arange(count)

    def short(ratio):
        return edge * (ratio[:, None] ** powers).sum(axis=1) < thickness

    low, _ = bisect(short, np.ones_like(thickness), np.full_like(thickness, 10.0))
    steps = low[:, None] ** powers
    fractions = np.concatenate((np.zeros((len(thickness), 1)), np.cumsum(steps, axis=1)), axis=1)
    fractions /= fractions[:, -1:]
    return fractions


def with_middles(values: np.ndarray) -> np.ndarray:
    """The values with the mean of each neighbouring pair inserted between them, along the last
    axis.
    """
    refined = np.empty((*values.shape[:-1], 2 * values.shape[-1] - 1))
    refined[..., ::2] = values
    refined[..., 1::2] = 0.5 * (values[..., 1:] + values[..., :-1])
    return refined


def node_positions(
    curve: OutlineCurve, columns: np.ndarray, rows: np.ndarray, fat_rows: int, fat_edge: float
):
    """Positions of the right half's nodes, shape (2 columns + 1, 2 rows + 1, 2), in m."""
    theta = curve.theta_at(with_middles(columns))
    skin = [curve.point(theta, depth) for depth in with_middles(rows)]
    inner = skin[-1]
    bone = curve.bone_point(curve.bone_foot(inner))
    fraction = _fat_fractions(np.hypot(*(bone - inner).T), fat_rows, fat_edge)
    fraction = with_middles(fraction)[:, 1:, None]
    fat = (1.0 - fraction) * inner[:, None, :] + fraction * bone[:, None, :]
    fat[:, -1] = bone
    return np.concatenate((np.stack(skin, axis=1), fat), axis=1)

"""Where the nodes of the built meshes go: graded divisions, columns along the skin, rows below it,
positions on the section.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.integrate import cumulative_trapezoid

from fingerpad.specimen.outline import OutlineCurve, bisect
from fingerpad.specimen.pad import MeshSize

_COARSEST = 8.0  # largest edge along the skin, in skin edges
_LARGEST_GRID = 100_000  # places along the skin at which edges are asked for, evenly spaced
_LARGEST_TURN = 0.5  # largest angle in radians that one edge along the skin may turn by


def divide(grid: np.ndarray, edge: np.ndarray, low: float, high: float, rounding) -> np.ndarray:
    """Division points of [low, high] such that edges follow the wanted `edge` given on `grid`."""
    part = (grid >= low) & (grid <= high)
    s, density = grid[part], 1.0 / edge[part]
    number = cumulative_trapezoid(density, s, initial=0.0)
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


def graded(
    grid: np.ndarray, wanted, ends, focus, growth: float, rounding=lambda low: np.ceil
) -> np.ndarray:
    """Division points of the range between the first and the last of ``ends``, with those among
    them.

    Parameters
    ----------
    grid : (n,) array
        Places (m) at which edges are asked for.
    wanted : callable
        Places -> largest edges (m) there. Each part between two ends has at least one edge.
    ends : sequence of float
        Places (m) of boundaries, ascending.
    focus : sequence of (float, float)
        Places (m) and the edge (m) there.
    growth : float
        Largest ratio of neighbouring edges.
    rounding : callable
        Start of a part -> how its number of edges is made whole.
    """
    grid = np.union1d(grid, [*ends, *(s for s, _ in focus)])
    edge = wanted(grid)
    for low, high in pairwise(ends):
        edge = np.where((grid >= low) & (grid <= high), np.minimum(edge, high - low), edge)
    for s, near in focus:
        edge = np.where(grid == s, np.minimum(edge, near), edge)
    edge = limit_growth(grid, edge, growth)
    parts = [divide(grid, edge, low, high, rounding(low)) for low, high in pairwise(ends)]
    return np.concatenate([part[:-1] for part in parts] + [ends[-1:]])


def columns_of(curve: OutlineCurve, size: MeshSize) -> tuple[np.ndarray, int]:
    """Arc lengths of the column boundaries from apex to bottom, and the index of the nail's rim.

    The end of the fine zone, the widest place (where the curvature jumps) and the nail's rim are
    boundaries.
    """
    outline = curve.outline
    nail = float(curve.arc_length(curve.theta_at_x(outline.nail_half_width, lower=True))[0])
    breaks = [0.0, float(curve.arc_length(0.5 * np.pi)[0]), nail, curve.length]
    fine = min(np.ceil(size.fine_half_width / size.skin_edge - 1e-6) * size.skin_edge, curve.length)
    nearest = min(breaks, key=lambda s: abs(s - fine))
    if abs(nearest - fine) < size.skin_edge:
        fine = nearest
    else:
        breaks = sorted([*breaks, fine])
    x = np.minimum(np.abs([x for x, _ in size.focus]), outline.half_width)
    places = curve.arc_length(curve.theta_at_x(x)).tolist()
    focus = [(s, edge) for s, (_, edge) in zip(places, size.focus, strict=True)]

    def wanted(s):
        radius = 1.0 / curve.curvature(curve.theta_at(s))
        edge = np.minimum(_LARGEST_TURN * radius, radius - curve.layer_depths[-1])
        edge = np.minimum(edge, size.coarse_edge or _COARSEST * size.skin_edge)
        return np.where(s <= fine, np.minimum(edge, size.skin_edge), edge)

    smallest = min([size.skin_edge, *(edge for _, edge in focus)])
    columns = graded(
        _grid_along(curve.length, smallest, places),
        wanted,
        breaks,
        focus,
        size.growth,
        lambda low: np.ceil if low <= fine else np.round,
    )
    return columns, int(np.searchsorted(columns, nail))


def _layer_rows(low: float, high: float, first: float, size: MeshSize) -> np.ndarray:
    """Depths of the row boundaries of one layer between the depths low and high."""
    if first >= size.layer_edge:
        return np.linspace(low, high, max(1, int(np.round((high - low) / size.layer_edge))) + 1)
    depth = np.linspace(low, high, 4001)
    edge = np.minimum(first + np.log(size.growth) * (depth - low), size.layer_edge)
    return divide(depth, edge, low, high, np.round)


def plain_rows(curve: OutlineCurve, size: MeshSize) -> np.ndarray:
    """Depths of the row boundaries above the fat, where there are no ridges."""
    middle, inner = curve.layer_depths
    first = min(size.skin_radial_edge or size.layer_edge, size.layer_edge)
    reached = min(first + np.log(size.growth) * middle, size.layer_edge)
    epidermis = _layer_rows(0.0, middle, first, size)
    return np.append(epidermis[:-1], _layer_rows(middle, inner, reached, size))


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
    curve: OutlineCurve, columns: np.ndarray, depth: float, rows: int, edge: float
) -> np.ndarray:
    """Positions (2 columns + 1, 2 rows + 1, 2) in m of the nodes in the fat of the right half.

    The fat begins ``depth`` m below the skin; its first edge is ``edge`` m.
    """
    inner = curve.point(curve.theta_at(with_middles(columns)), depth)
    bone = curve.bone_point(curve.bone_foot(inner))
    fraction = with_middles(_fat_fractions(np.hypot(*(bone - inner).T), rows, edge))[..., None]
    fat = (1.0 - fraction) * inner[:, None, :] + fraction * bone[:, None, :]
    fat[:, 0], fat[:, -1] = inner, bone
    return fat

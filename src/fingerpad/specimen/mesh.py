"""The pad's mesh: what a mesh is (`PadMesh`), how fine it shall be (`MeshSize`) and how it is built.

The built mesh of a plain pad is a mapped mesh: gmsh (through pygmsh) recombines three transfinite bands into second-order
quads on the reference rectangle (column along the skin, row below it), and every node is then placed on the
section. Rows in epidermis and dermis are exact offset curves of the skin; columns in the fat are normals of
the bone. The left half is the mirror image of the right one, bit for bit. Ridges and a stratum corneum are
meshed by `fingerpad.specimen.layered`.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fingerpad.specimen.outline import OutlineCurve, curve_of

if TYPE_CHECKING:
    from fingerpad.scenes.specimen import Outline, Ridges

REGIONS = ("epidermis", "dermis", "fat")
OPTIONAL = ("stratum_corneum",)  # regions that a mesh may have besides, outside the others
SKIN = "skin"  # the curve that may be touched
FIXED = ("bone", "nail")  # curves that hold the pad unless a scene names others
UNNAMED = "unnamed"  # boundary edges in no curve that a scene or a finger names: free
CURVES = (SKIN, *FIXED)

_MIRRORED = {  # node order of an element's mirror image that is again counter-clockwise
    "tri3": (1, 0, 2),
    "tri6": (1, 0, 2, 3, 5, 4),
    "quad4": (1, 0, 3, 2),
    "quad9": (1, 0, 3, 2, 4, 7, 6, 5, 8),
}
_COARSEST = 8.0  # largest edge along the skin, in skin edges
_LARGEST_GRID = 100_000  # places along the skin at which edges are asked for, evenly spaced
_LARGEST_TURN = 0.5  # largest angle in radians that one edge along the skin may turn by


class MeshError(ValueError):
    """A mesh or mesh size cannot be used; the message is one line."""


@dataclass(frozen=True)
class MeshSize:
    """How fine the built mesh shall be; all lengths in m.

    Parameters
    ----------
    skin_edge : edge along the skin where contact is expected (two node spacings).
    fine_half_width : arc length from the apex within which `skin_edge` holds.
    layer_edge : edge across epidermis and dermis.
    growth : largest ratio of one edge to the next finer one, along the skin and into the fat under the apex.
    focus : pairs (x, edge): near the skin points at x and -x the edge along the skin shrinks to `edge`.
    skin_radial_edge : first edge below the skin, growing to `layer_edge`; None means `layer_edge` at once.
    coarse_edge : largest edge along the skin; None means eight times `skin_edge`.
    """

    skin_edge: float
    fine_half_width: float
    layer_edge: float
    growth: float = 1.2
    focus: tuple[tuple[float, float], ...] = ()
    skin_radial_edge: float | None = None
    coarse_edge: float | None = None

    def __post_init__(self):
        lengths = {
            "skin_edge": self.skin_edge,
            "layer_edge": self.layer_edge,
            "skin_radial_edge": self.skin_radial_edge,
            "coarse_edge": self.coarse_edge,
            **{f"focus edge at x = {x * 1e3:g} mm": edge for x, edge in self.focus},
        }
        for key, length in lengths.items():
            if length is not None and not 0.0 < length < np.inf:
                raise MeshError(f"mesh size: {key} is {length!r} m; it must be above 0")
        if not 0.0 <= self.fine_half_width < np.inf:
            raise MeshError(f"mesh size: fine_half_width is {self.fine_half_width!r} m; it must be 0 or more")
        if not 1.0 < self.growth <= 3.0:
            raise MeshError(f"mesh size: growth is {self.growth!r}; it must be above 1 and at most 3")


@dataclass(frozen=True)
class PadMesh:
    """A plane mesh of the pad with named regions and curves.

    Parameters
    ----------
    points : (n, 2) float64, node positions in m.
    cells : (elements, nodes per element) int32: corners counter-clockwise, mid-side nodes (0-1, 1-2, ...),
        centre node; the order of gmsh and meshio.
    element : "quad9", "quad4", "tri6" or "tri3".
    region : (elements,) int8, index into `regions`.
    curves : name -> (facets, 2 or 3) int32 node numbers (start, end[, middle]), the material on the right of
        the way from start to end. "skin" runs from left to right, facet after facet; a finger's others are "bone"
        and "nail"; in a half mesh there is "symmetry".
    symmetric : whether the mesh is its own mirror image in x = 0 (for a half mesh: was cut from such a mesh).
    half : whether this is the right half only.
    regions : names of the layers, outside to inside.
    fixed : names of the curves that are held; the others, the skin among them, are free.
    """

    points: np.ndarray
    cells: np.ndarray
    element: str
    region: np.ndarray
    curves: dict[str, np.ndarray]
    symmetric: bool
    half: bool = False
    regions: tuple[str, ...] = REGIONS
    fixed: tuple[str, ...] = FIXED

    def right_half(self) -> PadMesh:
        """The half x >= 0 of a symmetric mesh, with the further curve "symmetry" (x = 0 exactly).

        Raises
        ------
        MeshError : when the mesh is not symmetric.
        """
        if self.half:
            return self
        if not self.symmetric:
            raise MeshError("mesh: no right half, for the mesh is not its own mirror image in x = 0")
        kept = self.points[self.cells[:, : corner_count(self.element)], 0].mean(axis=1) > 0.0
        nodes = np.unique(self.cells[kept])
        number = np.full(len(self.points), -1, dtype=np.int32)
        number[nodes] = np.arange(len(nodes), dtype=np.int32)
        points = self.points[nodes].copy()
        on_axis = np.abs(points[:, 0]) <= 1e-6 * np.ptp(self.points[:, 0])
        points[on_axis, 0] = 0.0
        cells = number[self.cells[kept]]
        curves = {}
        for name, facets in self.curves.items():
            facets = number[facets]
            curves[name] = facets[(facets >= 0).all(axis=1)]
        rim = element_edges(cells, self.element)
        curves["symmetry"] = rim[on_axis[rim[:, :2]].all(axis=1)][:, [1, 0, *range(2, rim.shape[1])]]
        return replace(self, points=points, cells=cells, region=self.region[kept], curves=curves, half=True)

    def elevated(self) -> PadMesh:
        """The same mesh with mid-side nodes if it is made of linear triangles (tri3 -> tri6); else itself."""
        if self.element != "tri3":
            return self
        edges = element_edges(self.cells, "tri3")
        pairs, index = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
        first, count = len(self.points), len(self.cells)
        middle = first + index.reshape(-1).astype(np.int32)
        points = np.concatenate((self.points, self.points[pairs].mean(axis=1)))
        cells = np.column_stack((self.cells, middle.reshape(3, count).T)).astype(np.int32)
        known = dict(zip(map(tuple, pairs.tolist()), range(first, len(points)), strict=True))
        curves = {
            name: np.array([(a, b, known[min(a, b), max(a, b)]) for a, b in facets.tolist()], dtype=np.int32).reshape(-1, 3)
            for name, facets in self.curves.items()
        }
        return replace(self, points=points, cells=cells, element="tri6", curves=curves)

    def write(self, path: str | Path) -> None:
        """Write a gmsh .msh file (4.1, mm, physical groups named as here); whole or not at all."""
        from fingerpad.specimen.external import write_pad_mesh

        write_pad_mesh(self, path)

    def quality(self) -> dict[str, float]:
        """nodes, elements, smallest_edge_m, worst_scaled_jacobian (see `fingerpad.specimen.quality`)."""
        from fingerpad.specimen.quality import quality

        return quality(self)


def corner_count(element: str) -> int:
    """Number of corners of an element."""
    return 3 if element.startswith("tri") else 4


def element_edges(cells: np.ndarray, element: str) -> np.ndarray:
    """All element edges, counter-clockwise, shape (corners * elements, 2 or 3): start, end[, middle]."""
    corners = corner_count(element)
    quadratic = cells.shape[1] > corners
    edges = []
    for side in range(corners):
        nodes = [side, (side + 1) % corners] + ([corners + side] if quadratic else [])
        edges.append(cells[:, nodes])
    return np.concatenate(edges)


def skin_chain(mesh: PadMesh) -> np.ndarray:
    """Node numbers (ns,) along the skin of `mesh` from left to right, mid-side nodes included."""
    skin = mesh.curves["skin"]
    order = skin[:, [0, 2]] if skin.shape[1] == 3 else skin[:, :1]
    return np.append(order.ravel(), skin[-1, 1])


# -- where the nodes go --------------------------------------------------------------------------------------


def _divide(grid: np.ndarray, edge: np.ndarray, low: float, high: float, rounding) -> np.ndarray:
    """Division points of [low, high] such that edges follow the wanted `edge` given on `grid`."""
    part = (grid >= low) & (grid <= high)
    s, density = grid[part], 1.0 / edge[part]
    number = np.concatenate(([0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(s))))
    count = max(1, int(rounding(number[-1] - 1e-6)))
    points = np.interp(np.linspace(0.0, number[-1], count + 1), number, s)
    points[0], points[-1] = low, high
    return points


def _limit_growth(s: np.ndarray, edge: np.ndarray, growth: float) -> np.ndarray:
    """The largest edge lengths up to `edge` that grow by at most the factor `growth` from one to the next."""
    slope = np.log(growth)  # edges of a linearly growing length form a geometric series
    rising = np.minimum.accumulate(edge - slope * s) + slope * s
    return (np.minimum.accumulate((rising + slope * s)[::-1]))[::-1] - slope * s


def _grid_along(length: float, smallest: float, focus: list[float]) -> np.ndarray:
    """Arc lengths at which edges are asked for: four to the smallest edge; of tiny edges, only from focus to focus and near."""
    count = max(4000, int(np.ceil(4.0 * length / smallest)))
    if count <= _LARGEST_GRID:
        return np.linspace(0.0, length, count + 1)
    away = np.geomspace(smallest / 4, length, 2000)
    low, high = min(focus, default=0.0), max(focus, default=0.0)
    between = np.linspace(low, high, min(int(4 * (high - low) / smallest) + 2, _LARGEST_GRID))
    grid = np.concatenate([np.linspace(0.0, length, 4001), between, low - away, high + away])
    return np.unique(np.clip(grid, 0.0, length))


def _columns(curve: OutlineCurve, size: MeshSize) -> tuple[np.ndarray, int]:
    """Arc lengths of the column boundaries from apex to bottom, and the index of the nail's rim.

    The end of the fine zone, the widest place (where the curvature jumps) and the nail's rim are boundaries.
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
    focus = [(float(curve.arc_length(curve.theta_at_x(min(abs(x), half_width)))[0]), edge) for x, edge in size.focus]

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
    edge = _limit_growth(grid, edge, size.growth)

    parts = [_divide(grid, edge, low, high, np.ceil if low <= fine else np.round) for low, high in pairwise(breaks)]
    columns = np.concatenate([part[:-1] for part in parts] + [[curve.length]])
    return columns, int(np.searchsorted(columns, nail))


def _layer_rows(low: float, high: float, first: float, size: MeshSize) -> np.ndarray:
    """Depths of the row boundaries of one layer between the depths low and high."""
    if first >= size.layer_edge:
        return np.linspace(low, high, max(1, int(np.round((high - low) / size.layer_edge))) + 1)
    depth = np.linspace(low, high, 4001)
    edge = np.minimum(first + np.log(size.growth) * (depth - low), size.layer_edge)
    return _divide(depth, edge, low, high, np.round)


def _rows(curve: OutlineCurve, size: MeshSize) -> tuple[np.ndarray, tuple[int, int], int, float]:
    """Depths of the skin's row boundaries, rows above its interfaces, rows in the fat, first fat edge."""
    middle, inner = curve.layer_depths
    first = min(size.skin_radial_edge or size.layer_edge, size.layer_edge)
    epidermis = _layer_rows(0.0, middle, first, size)
    reached = min(first + np.log(size.growth) * middle, size.layer_edge)
    dermis = _layer_rows(middle, inner, reached, size)
    rows = np.concatenate((epidermis[:-1], dermis))
    return rows, (len(epidermis) - 1, len(rows) - 1), *_fat_rows(curve, size, dermis[-1] - dermis[-2])


def _fat_rows(curve: OutlineCurve, size: MeshSize, above: float) -> tuple[int, float]:
    """Rows in the fat under the apex and their first edge, next to an edge `above` it."""
    fat = curve.outline.apex_height - curve.layer_depths[-1] - curve.bone_point(0.0)[0, 1]
    edge = size.growth * above
    count = np.log1p((size.growth - 1.0) * fat / edge) / np.log(size.growth)
    return max(1, int(np.ceil(count - 1e-6))), edge


def _fat_fractions(thickness: np.ndarray, count: int, edge: float) -> np.ndarray:
    """Row boundaries in the fat as fractions of its thickness (n,), shape (n, count + 1).

    Edges form a geometric series starting with `edge` where the fat is thick enough; elsewhere all are equal.
    """
    low, high = np.ones_like(thickness), np.full_like(thickness, 10.0)
    powers = np.arange(count)
    for _ in range(60):
        ratio = 0.5 * (low + high)
        short = edge * (ratio[:, None] ** powers).sum(axis=1) < thickness
        low, high = np.where(short, ratio, low), np.where(short, high, ratio)
    steps = low[:, None] ** powers
    fractions = np.concatenate((np.zeros((len(thickness), 1)), np.cumsum(steps, axis=1)), axis=1)
    fractions /= fractions[:, -1:]
    return fractions


def _with_middles(values: np.ndarray) -> np.ndarray:
    """The values with the mean of each neighbouring pair inserted between them, along the last axis."""
    refined = np.empty((*values.shape[:-1], 2 * values.shape[-1] - 1))
    refined[..., ::2] = values
    refined[..., 1::2] = 0.5 * (values[..., 1:] + values[..., :-1])
    return refined


def count_nodes(outline: Outline, size: MeshSize, ridges: Ridges | None = None, corneum: bool = False) -> int:
    """Number of nodes of `build_pad_mesh` with these arguments, without building it (and without gmsh)."""
    if ridges or corneum:
        from fingerpad.specimen.layered import count_layered_nodes

        return count_layered_nodes(outline, size, ridges, corneum)
    curve = curve_of(outline)
    columns, _ = _columns(curve, size)
    _, (_, skin_rows), fat_rows, _ = _rows(curve, size)
    return 4 * (len(columns) - 1) * (2 * (skin_rows + fat_rows) + 1)


def smallest_edge(outline: Outline, size: MeshSize, ridges: Ridges | None = None, corneum: bool = False) -> float:
    """Shortest element edge (m, corner to corner) of `build_pad_mesh` with these arguments (without gmsh)."""
    if ridges or corneum:
        return build_pad_mesh(outline, size, ridges, corneum).quality()["smallest_edge_m"]
    curve = curve_of(outline)
    columns, _ = _columns(curve, size)
    rows, _, fat_rows, fat_edge = _rows(curve, size)
    corners = _node_positions(curve, columns, rows, fat_rows, fat_edge)[::2, ::2]
    return float(min(np.hypot(*np.moveaxis(np.diff(corners, axis=axis), -1, 0)).min() for axis in (0, 1)))


def _node_positions(curve: OutlineCurve, columns: np.ndarray, rows: np.ndarray, fat_rows: int, fat_edge: float):
    """Positions of the right half's nodes, shape (2 columns + 1, 2 rows + 1, 2), in m."""
    theta = curve.theta_at(_with_middles(columns))
    skin = [curve.point(theta, depth) for depth in _with_middles(rows)]
    inner = skin[-1]
    bone = curve.bone_point(curve.bone_foot(inner))
    fraction = _fat_fractions(np.hypot(*(bone - inner).T), fat_rows, fat_edge)
    fraction = _with_middles(fraction)[:, 1:, None]
    fat = (1.0 - fraction) * inner[:, None, :] + fraction * bone[:, None, :]
    fat[:, -1] = bone
    return np.concatenate((np.stack(skin, axis=1), fat), axis=1)


# -- building ------------------------------------------------------------------------------------------------


@contextmanager
def gmsh_session() -> Iterator[object]:
    """A quiet pygmsh geometry (built-in kernel); gmsh is always finalised, and Ctrl-C handled as before."""
    import gmsh
    import pygmsh

    try:
        handler = signal.getsignal(signal.SIGINT)
        with pygmsh.geo.Geometry(init_argv=["fingerpad", "-v", "0"]) as geometry:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)
            yield geometry
    finally:
        signal.signal(signal.SIGINT, handler)


def _reference_quads(columns: int, bands: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Second-order quads on the reference rectangle, of which x counts columns and -y counts rows.

    Returns the elements' nodes as (elements, 9, 2) integer half steps (column, row), and bands (elements,).
    """
    with gmsh_session() as geometry:
        ends = np.concatenate(([0], np.cumsum(bands)))
        corners = [(geometry.add_point((0.0, -float(y))), geometry.add_point((float(columns), -float(y)))) for y in ends]
        across = [geometry.add_line(left, right) for left, right in corners]
        for line in across:
            geometry.set_transfinite_curve(line, columns + 1, "Progression", 1.0)
        for band, count in enumerate(bands):
            upper, lower = corners[band], corners[band + 1]
            left, right = geometry.add_line(upper[0], lower[0]), geometry.add_line(lower[1], upper[1])
            for line in (left, right):
                geometry.set_transfinite_curve(line, count + 1, "Progression", 1.0)
            surface = geometry.add_plane_surface(geometry.add_curve_loop([left, across[band + 1], right, -across[band]]))
            geometry.set_transfinite_surface(surface, "Left", [upper[0], lower[0], lower[1], upper[1]])
            geometry.set_recombined_surfaces([surface])
            geometry.add_physical(surface, REGIONS[band])
        grid = geometry.generate_mesh(dim=2, order=2)
    (quads,) = [block.data for block in grid.cells if block.type == "quad9"]
    steps = np.rint(2.0 * grid.points[:, :2] * (1.0, -1.0)).astype(np.int64)[quads]
    row = steps[:, 8, 1] / 2.0
    return steps, (np.searchsorted(ends, row, side="right") - 1).astype(np.int8)


def build_pad_mesh(outline: Outline, size: MeshSize, ridges: Ridges | None = None, corneum: bool = False) -> PadMesh:
    """Mesh the pad with second-order quads (quad9), mirror-symmetric to the last bit where the pad is symmetric.

    Parameters
    ----------
    outline : the scene's outline, lengths in m.
    size : edge lengths; ridges make them smaller where they are.
    ridges : the scene's ridges.
    corneum : whether the stratum corneum is a region of its own.

    Returns
    -------
    PadMesh, with nodes exactly at x = 0, mid-side nodes on the skin and the layers' true boundaries.

    Raises
    ------
    OutlineError : when the outline cannot be drawn.
    MeshError : when an element would be inverted, or the pad has no room for the ridges.
    """
    if ridges or corneum:
        from fingerpad.specimen.layered import build_layered_mesh

        return build_layered_mesh(outline, size, ridges, corneum)
    curve = curve_of(outline)
    columns, nail = _columns(curve, size)
    rows, (epidermis_rows, skin_rows), fat_rows, fat_edge = _rows(curve, size)
    right = _node_positions(curve, columns, rows, fat_rows, fat_edge)
    wide, deep = right.shape[:2]
    steps, region = _reference_quads(len(columns) - 1, (epidermis_rows, skin_rows - epidermis_rows, fat_rows))

    # columns of the whole ring, clockwise from the apex; the right half's come first, bottom included
    ring = 2 * (wide - 1)
    mirrored = right[-2:0:-1] * (-1.0, 1.0)
    points = np.concatenate((right, mirrored)).reshape(-1, 2)

    def number(column: np.ndarray, row: np.ndarray) -> np.ndarray:
        return (column % ring * deep + row).astype(np.int32)

    cells = number(steps[..., 0], steps[..., 1])
    mirror = number(-steps[..., 0], steps[..., 1])[:, _MIRRORED["quad9"]]

    by_layer = np.argsort(np.concatenate((region, region)), kind="stable")  # as a .msh file keeps them

    def chain(first: int, last: int, row: int, step: int = 2) -> np.ndarray:
        start = np.arange(first, last, step)
        return number(np.column_stack((start, start + step, start + step // 2)), np.array(row))

    nail, bottom = 2 * nail, wide - 1
    mesh = PadMesh(
        points=points,
        cells=np.concatenate((cells, mirror))[by_layer],
        element="quad9",
        region=np.concatenate((region, region))[by_layer],
        curves={
            "skin": chain(-nail, nail, 0),
            "bone": chain(bottom, -bottom, deep - 1, step=-2),
            "nail": chain(nail, 2 * bottom - nail, 0),
        },
        symmetric=True,
    )
    from fingerpad.specimen.quality import check_orientation

    try:
        check_orientation(mesh, "outline")
    except MeshError as error:
        raise MeshError(f"{error}; thicker fat beside the bone or a smaller skin_edge is allowed") from None
    return mesh

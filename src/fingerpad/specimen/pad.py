"""The pad's mesh as data: what a mesh is (`PadMesh`), how fine it shall be (`MeshSize`), its edges
and its skin.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fingerpad.specimen.element_kinds import KINDS

REGIONS = ("epidermis", "dermis", "fat")
OPTIONAL = ("stratum_corneum",)  # regions that a mesh may have besides, outside the others
SKIN = "skin"  # the curve that may be touched
FIXED = ("bone", "nail")  # curves that hold a finger
HELD = (*FIXED, "base")  # curves of a mesh that are held unless a scene says that they are free
UNNAMED = "unnamed"  # boundary edges in no curve that a scene or a finger names: free
CURVES = (SKIN, *FIXED)


class MeshError(ValueError):
    """A mesh or mesh size cannot be used; the message is one line."""


def all_over(reach: float, edge: float) -> tuple[tuple[float, float], ...]:
    """A mesh size's ``focus`` with that ``edge`` (m) from the apex to so far (m) to either side of
    it.
    """
    return tuple(
        (float(x), edge) for x in np.linspace(0.0, reach, max(2, round(reach / edge / 2) + 1))
    )


@dataclass(frozen=True)
class MeshSize:
    """How fine the built mesh shall be; all lengths in m.

    Parameters
    ----------
    skin_edge : float
        Edge along the skin where contact is expected (two node spacings).
    fine_half_width : float
        Arc length from the apex within which `skin_edge` holds.
    layer_edge : float
        Edge across epidermis and dermis.
    growth : float
        Largest ratio of one edge to the next finer one, along the skin and into the fat under the
        apex.
    focus : tuple of (float, float)
        Pairs (x, edge): near the skin points at x and -x the edge along the skin shrinks to `edge`.
    skin_radial_edge : float or None
        First edge below the skin, growing to `layer_edge`; None means `layer_edge` at once.
    coarse_edge : float or None
        Largest edge along the skin; None means eight times `skin_edge`.
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
            raise MeshError(
                f"mesh size: fine_half_width is {self.fine_half_width!r} m; it must be 0 or more"
            )
        if not 1.0 < self.growth <= 3.0:
            raise MeshError(
                f"mesh size: growth is {self.growth!r}; it must be above 1 and at most 3"
            )

    def coarser(self, ratio: float) -> MeshSize:
        """The size of a mesh whose edges are so many times as long everywhere, as nearly as growth
        up to 3 has it.
        """
        return MeshSize(
            ratio * self.skin_edge,
            self.fine_half_width,
            ratio * self.layer_edge,
            min(self.growth**ratio, 3.0),
            tuple((x, ratio * edge) for x, edge in self.focus),
            self.skin_radial_edge and ratio * self.skin_radial_edge,
            self.coarse_edge and ratio * self.coarse_edge,
        )


@dataclass(frozen=True)
class PadMesh:
    """A plane mesh of the pad with named regions and curves.

    Parameters
    ----------
    points : (n, 2) float64
        Positions of the nodes in m.
    cells : (elements, nodes per element) int32
        Corners counter-clockwise, mid-side nodes (0-1, 1-2, ...), centre node; the order of gmsh
        and meshio.
    element : str
        "quad9", "quad4", "tri6" or "tri3".
    region : (elements,) int8
        Index into `regions`.
    curves : dict of str to (facets, 2 or 3) int32
        Node numbers (start, end[, middle]), the material on the right of the way from start to
        end. "skin" runs from left to right, facet after facet; a finger's others are "bone" and
        "nail"; in a half mesh there is "symmetry".
    symmetric : bool
        Whether the mesh is its own mirror image in x = 0 (for a half mesh: was cut from such a
        mesh).
    half : bool
        Whether this is the right half only.
    regions : tuple of str
        Names of the layers, outside to inside.
    fixed : tuple of str
        Names of the curves that are held; the others, the skin among them, are free.
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
            raise MeshError(
                "mesh: no right half, for the mesh is not its own mirror image in x = 0"
            )
        kept = self.points[self.cells[:, : KINDS[self.element].corners], 0].mean(axis=1) > 0.0
        nodes = np.unique(self.cells[kept])
        number = np.full(len(self.points), -1, dtype=np.int32)
        number[nodes] = np.arange(len(nodes), dtype=np.int32)
        points = self.points[nodes].copy()
        on_axis = np.abs(points[:, 0]) <= 1e-6 * np.ptp(self.points[:, 0])
        points[on_axis, 0] = 0.0
        cells = number[self.cells[kept]]
        curves = {name: number[facets] for name, facets in self.curves.items()}
        curves = {name: facets[(facets >= 0).all(axis=1)] for name, facets in curves.items()}
        rim = element_edges(cells, self.element)
        curves["symmetry"] = rim[on_axis[rim[:, :2]].all(axis=1)][
            :, [1, 0, *range(2, rim.shape[1])]
        ]
        return replace(
            self, points=points, cells=cells, region=self.region[kept], curves=curves, half=True
        )

    def turned(self) -> PadMesh:
        """The mesh as the half x >= 0 of one that is turned about x = 0, where its edges are the
        further curve "symmetry".

        Raises
        ------
        MeshError : when it reaches beyond x = 0, or does not touch it.
        """
        if self.half:
            return self
        near, first = 1e-6 * np.ptp(self.points[:, 0]), float(self.points[:, 0].min())
        if abs(first) > near:
            raise MeshError(
                f"begins at x = {first * 1e3:.4g} mm; a body of revolution needs a mesh of its "
                "right half, which begins on its axis, x = 0"
            )
        points = self.points.copy()
        points[np.abs(points[:, 0]) <= near, 0] = 0.0
        on_axis, axis, curves = points[:, 0] == 0.0, [], {}
        for name, facets in self.curves.items():
            there = on_axis[facets[:, :2]].all(axis=1) & (name not in self.fixed)
            axis.append(facets[there])
            if len(facets[~there]):
                curves[name] = facets[~there]
        curves["symmetry"] = np.concatenate(axis)
        return replace(self, points=points, curves=curves, half=True, symmetric=True)

    def elevated(self, solved: str | None = None) -> PadMesh:
        """The mesh with mid-side nodes where it needs some: of linear triangles always, of quads
        for the element "Q2P1".
        """
        needed = self.element == "tri3" or (self.element == "quad4" and solved == "Q2P1")
        return self.raised() if needed else self

    def raised(self) -> PadMesh:
        """The same elements with mid-side nodes (tri3 -> tri6), and quads with a centre node (quad4
        -> quad9).

        Sides stay straight but for the skin's, which bend as it does: on a polygon pressure would
        jump from node to node. A mesh that has these nodes is itself.
        """
        if KINDS[self.element].quadratic:
            return self
        edges, count = element_edges(self.cells, self.element), len(self.cells)
        ends = np.concatenate([edges, *self.curves.values()])
        _, first, number = np.unique(edge_keys(ends), return_index=True, return_inverse=True)
        middles = self.points[ends[first]].mean(axis=1)
        lengths = [len(edges), *map(len, self.curves.values())]
        of_cells, *of_curves = np.split(number, np.cumsum(lengths)[:-1])
        owner = np.empty(len(middles), dtype=np.int64)
        owner[of_cells] = np.arange(len(edges)) % count
        sides = dict(zip(self.curves, of_curves, strict=True))
        skin = sides[SKIN]
        areas = _areas(self.points[self.cells[owner[skin]]])
        middles[skin] += _bulge(self.points[self.curves[SKIN]], areas)
        points = [self.points, middles]
        cells = [self.cells, len(self.points) + of_cells.reshape(-1, count).T]
        if self.element == "quad4":
            points.append(self.points[self.cells].mean(axis=1))
            cells.append(len(self.points) + len(middles) + np.arange(count)[:, None])
        curves = {
            name: np.column_stack((facets, len(self.points) + sides[name])).astype(np.int32)
            for name, facets in self.curves.items()
        }
        return replace(
            self,
            points=np.concatenate(points),
            cells=np.column_stack(cells).astype(np.int32),
            element="tri6" if self.element == "tri3" else "quad9",
            curves=curves,
        )


def _areas(corners: np.ndarray) -> np.ndarray:
    """Areas (n,) of polygons with corners (n, m, 2) counter-clockwise."""
    x, y = np.moveaxis(corners, -1, 0)
    return 0.5 * (x * np.roll(y, -1, 1) - np.roll(x, -1, 1) * y).sum(1)


def _bulge(ends: np.ndarray, areas: np.ndarray) -> np.ndarray:
    """How far (n, 2) m the middles of a line's sides lie beside their chords, if it turns evenly
    from side to side.

    ``ends`` (n, 2, 2) m, one side after the other; ``areas`` (n,) of their elements, of whose depth
    it is a quarter at most. Turns by more than 30 degrees are corners.
    """
    chord = ends[:, 1] - ends[:, 0]
    length = np.hypot(*chord.T)
    turn = np.diff(np.unwrap(np.arctan2(chord[:, 1], chord[:, 0])))
    bend = np.where(
        np.abs(turn) <= np.radians(30), turn / (0.5 * (length[1:] + length[:-1])), np.nan
    )
    both = np.stack([np.append(np.nan, bend), np.append(bend, np.nan)])
    bend = np.where(np.isnan(both), 0.0, both).sum(0) / np.maximum(np.isfinite(both).sum(0), 1)
    rise = np.clip(-bend * length**2 / 8, -areas / length / 4, areas / length / 4)
    return rise[:, None] * np.column_stack([-chord[:, 1], chord[:, 0]]) / length[:, None]


def element_edges(cells: np.ndarray, element: str) -> np.ndarray:
    """All element edges, counter-clockwise, shape (corners * elements, 2 or 3): start, end[,
    middle].
    """
    corners = KINDS[element].corners
    start = np.arange(corners)
    columns = [start, (start + 1) % corners, start + corners]
    columns = np.stack(columns[: 3 if cells.shape[1] > corners else 2])
    return cells[:, columns].transpose(2, 0, 1).reshape(-1, len(columns))


def edge_keys(ends: np.ndarray) -> np.ndarray:
    """A number (n,) for the two end nodes of edges (n, 2 or more), in whichever order; they rise as
    the pairs do.
    """
    low, high = np.sort(ends[:, :2], axis=1).astype(np.int64).T
    return (low << 32) + high


def skin_chain(mesh: PadMesh) -> np.ndarray:
    """Node numbers (ns,) along the skin of `mesh` from left to right, mid-side nodes included."""
    skin = mesh.curves["skin"]
    order = skin[:, [0, 2]] if skin.shape[1] == 3 else skin[:, :1]
    return np.append(order.ravel(), skin[-1, 1])

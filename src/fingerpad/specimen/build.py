"""Building the pad's mesh from its outline, as fine as a `MeshSize` says.

The mesh of a plain pad is a mapped mesh: gmsh (through pygmsh) recombines three transfinite bands
into second-order quads on a rectangle of columns and rows, and every node is then placed on the
section. Rows in epidermis and dermis are exact offset curves of the skin; columns in the fat are
normals of the bone. Where there are ridges or a stratum corneum, the quads of
`fingerpad.specimen.layered` take the place of gmsh's. The left half is the mirror image of the
right one, bit for bit where the pad is symmetric.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.gmsh_worker import ask
from fingerpad.specimen.layered import COLUMN, FINE, ROW, Layout, layout_of
from fingerpad.specimen.outline import OutlineLike
from fingerpad.specimen.pad import OPTIONAL, REGIONS, MeshSize, PadMesh
from fingerpad.specimen.quality import check_orientation, shortest_edge


@lru_cache(maxsize=64)
def _rectangle(columns: int, bands: tuple[int, ...]) -> np.ndarray:
    """Half steps (elements, 9, 2) of column and row of gmsh's quads on a rectangle."""
    return ask("rectangle", columns, bands)


def build_pad_mesh(
    outline: OutlineLike, size: MeshSize, ridges: Any = None, corneum: bool = False
) -> PadMesh:
    """Mesh the pad with second-order quads (quad9), mirror-symmetric to the last bit where the pad
    is symmetric.

    Parameters
    ----------
    outline : OutlineLike
        The scene's outline, lengths in m.
    size : MeshSize
        Edge lengths; ridges make them smaller where they are.
    ridges : fingerpad.scenes.specimen.Ridges, optional
        The scene's ridges.
    corneum : bool
        Whether the stratum corneum is a region of its own.

    Returns
    -------
    PadMesh
        With nodes exactly at x = 0, mid-side nodes on the skin and on the borders of the layers.

    Raises
    ------
    OutlineError
        The outline cannot be drawn.
    MeshError
        An element would be inverted, or the pad has no room for the ridges.
    """
    layout = layout_of(outline, size, ridges, corneum)
    if ridges or corneum:
        steps = layout.cells()
    else:
        bands = tuple(np.bincount(layout.region).tolist())
        steps = _rectangle(len(layout.columns) - 1, bands) * (COLUMN // 2, ROW // 2)
    return _whole(layout, steps)


def _whole(layout: Layout, steps: np.ndarray) -> PadMesh:
    """The mesh of a layout, of the cells (elements, 9, 2) of its right half.

    Columns of the whole ring count clockwise from the apex, those of the right half come first.
    """
    half, nail = layout.half, COLUMN * layout.nail
    ring, deep = 2 * half, ROW * len(layout.kinds) + 1
    region = np.tile(layout.region[steps[:, 8, 1] // ROW], 2)
    steps = np.concatenate((steps, (steps * (-1, 1))[:, KINDS["quad9"].mirrored]))
    known, cells = np.unique(steps[..., 0] % ring * deep + steps[..., 1], return_inverse=True)
    column, row = np.divmod(known, deep)
    by_layer = np.argsort(region, kind="stable")  # as a .msh file keeps them

    def chain(marks: np.ndarray, row: int) -> np.ndarray:
        ends = np.column_stack((marks[:-1], marks[1:], (marks[:-1] + marks[1:]) // 2))
        return np.searchsorted(known, ends % ring * deep + row).astype(np.int32)

    zone = COLUMN * layout.zone if layout.kinds[0] == FINE else 0
    right = np.concatenate((np.arange(0, zone, 2), np.arange(zone, nail + 1, COLUMN)))
    mesh = PadMesh(
        points=layout.points(np.where(column > half, column - ring, column), row),
        cells=cells.reshape(-1, 9).astype(np.int32)[by_layer],
        element="quad9",
        region=region[by_layer],
        curves={
            "skin": chain(np.concatenate((-right[:0:-1], right)), 0),
            "bone": chain(np.arange(half, -half - 1, -COLUMN), deep - 1),
            "nail": chain(np.arange(nail, ring - nail + 1, COLUMN), 0),
        },
        symmetric=layout.ridged is None or layout.ridged.symmetric,
        regions=(*OPTIONAL, *REGIONS)[-1 - layout.region[-1] :],
    )
    advice = "lower ridges, thicker layers, thicker fat beside the bone or a smaller skin_edge"
    check_orientation(mesh, "outline", advice)
    return mesh


@lru_cache(maxsize=64)  # of a sweep many scenes may have the same mesh
def size_of(
    outline: OutlineLike, size: MeshSize, ridges: Any = None, corneum: bool = False
) -> tuple[int, float]:
    """Number of nodes and shortest edge (m) of `build_pad_mesh` with these arguments, without
    gmsh.
    """
    layout = layout_of(outline, size, ridges, corneum)
    mesh = _whole(layout, layout.cells())
    return len(mesh.points), shortest_edge(mesh)


def count_nodes(
    outline: OutlineLike, size: MeshSize, ridges: Any = None, corneum: bool = False
) -> int:
    """Number of nodes of `build_pad_mesh` with these arguments, without gmsh."""
    return size_of(outline, size, ridges, corneum)[0]

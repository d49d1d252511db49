"""Building the pad's mesh from its outline, or the mesh of a slab or a half-round, as fine as a
`MeshSize` says.

The built mesh of a plain pad is a mapped mesh: gmsh (through pygmsh) recombines three transfinite
bands into second-order quads on the reference rectangle (column along the skin, row below it), and
every node is then placed on the section. Rows in epidermis and dermis are exact offset curves of
the skin; columns in the fat are normals of the bone. The left half is the mirror image of the right
one, bit for bit. Ridges and a stratum corneum are meshed by `fingerpad.specimen.layered`.
"""

from __future__ import annotations

import zlib
from contextlib import suppress
from importlib.metadata import version
from typing import TYPE_CHECKING
from zipfile import BadZipFile

import numpy as np

from fingerpad.files import cache_folder, write_atomically
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.gmsh_worker import ask
from fingerpad.specimen.grid import columns_of, node_positions, rows_of
from fingerpad.specimen.outline import OutlineLike, curve_of
from fingerpad.specimen.pad import MeshError, MeshSize, PadMesh
from fingerpad.specimen.quality import check_orientation, shortest_edge

if TYPE_CHECKING:
    from fingerpad.specimen.ridges import RidgesLike


def _reference_quads(columns: int, bands: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Second-order quads on the reference rectangle, of which x counts columns and -y counts rows.

    Returns the elements' nodes as (elements, 9, 2) integer half steps (column, row), and bands
    (elements,).
    """
    steps = _kept_quads(columns, bands)
    ends = np.concatenate(([0], np.cumsum(bands)))
    return steps, (np.searchsorted(ends, steps[:, 8, 1] / 2.0, side="right") - 1).astype(np.int8)


def _kept_quads(columns: int, bands: tuple[int, ...]) -> np.ndarray:
    """Nodes of the quads from the user's cache; else gmsh makes them, for which it takes a third of
    a second to be ready.
    """
    folder = cache_folder("quads")
    if folder is None:
        return ask("rectangle", columns, bands)
    kept = folder / f"gmsh{version('gmsh')}-{columns}-{'-'.join(map(str, bands))}.npz"
    with suppress(
        OSError, ValueError, LookupError, EOFError, BadZipFile, zlib.error
    ):  # cut short, or somebody else's
        with np.load(kept) as file:
            steps = file["steps"].astype(np.int64)
        if steps.shape == (columns * sum(bands), 9, 2) and steps.max(axis=(0, 1)).tolist() == [
            2 * columns,
            2 * sum(bands),
        ]:
            return steps
    steps = ask("rectangle", columns, bands)
    with suppress(OSError):
        write_atomically(
            kept, lambda partial: np.savez_compressed(partial, steps=steps.astype(np.int32))
        )
    return steps


def build_pad_mesh(
    outline: OutlineLike, size: MeshSize, ridges: RidgesLike | None = None, corneum: bool = False
) -> PadMesh:
    """Mesh the pad with second-order quads (quad9), mirror-symmetric to the last bit where the pad
    is symmetric.

    Parameters
    ----------
    outline : the scene's outline, lengths in m.
    size : edge lengths; ridges make them smaller where they are.
    ridges : the scene's ridges.
    corneum : whether the stratum corneum is a region of its own.

    Returns
    ------- PadMesh, with nodes exactly at x = 0, mid-side nodes on the skin and the layers' true
    boundaries.

    Raises
    ------
    OutlineError : when the outline cannot be drawn.
    MeshError : when an element would be inverted, or the pad has no room for the ridges.
    """
    if ridges or corneum:
        from fingerpad.specimen.layered import build_layered_mesh

        return build_layered_mesh(outline, size, ridges, corneum)
    curve = curve_of(outline)
    columns, nail = columns_of(curve, size)
    rows, (epidermis_rows, skin_rows), fat_rows, fat_edge = rows_of(curve, size)
    right = node_positions(curve, columns, rows, fat_rows, fat_edge)
    wide, deep = right.shape[:2]
    steps, region = _reference_quads(
        len(columns) - 1, (epidermis_rows, skin_rows - epidermis_rows, fat_rows)
    )

    # columns of the whole ring, clockwise from the apex; the right half's come first, bottom
    # included
    ring = 2 * (wide - 1)
    mirrored = right[-2:0:-1] * (-1.0, 1.0)
    points = np.concatenate((right, mirrored)).reshape(-1, 2)

    def number(column: np.ndarray, row: np.ndarray) -> np.ndarray:
        return (column % ring * deep + row).astype(np.int32)

    cells = number(steps[..., 0], steps[..., 1])
    mirror = number(-steps[..., 0], steps[..., 1])[:, KINDS["quad9"].mirrored]

    by_layer = np.argsort(
        np.concatenate((region, region)), kind="stable"
    )  # as a .msh file keeps them

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
    try:
        check_orientation(mesh, "outline")
    except MeshError as error:
        raise MeshError(
            f"{error}; thicker fat beside the bone or a smaller skin_edge is allowed"
        ) from None
    return mesh


def count_nodes(
    outline: OutlineLike, size: MeshSize, ridges: RidgesLike | None = None, corneum: bool = False
) -> int:
    """Number of nodes of `build_pad_mesh` with these arguments, without building it (and without
    gmsh).
    """
    if ridges or corneum:
        from fingerpad.specimen.layered import count_layered_nodes

        return count_layered_nodes(outline, size, ridges, corneum)
    curve = curve_of(outline)
    columns, _ = columns_of(curve, size)
    _, (_, skin_rows), fat_rows, _ = rows_of(curve, size)
    return 4 * (len(columns) - 1) * (2 * (skin_rows + fat_rows) + 1)


def smallest_edge(
    outline: OutlineLike, size: MeshSize, ridges: RidgesLike | None = None, corneum: bool = False
) -> float:
    """Shortest element edge (m, corner to corner) of `build_pad_mesh` with these arguments (without
    gmsh).
    """
    if ridges or corneum:
        return shortest_edge(build_pad_mesh(outline, size, ridges, corneum))
    curve = curve_of(outline)
    columns, _ = columns_of(curve, size)
    rows, _, fat_rows, fat_edge = rows_of(curve, size)
    corners = node_positions(curve, columns, rows, fat_rows, fat_edge)[::2, ::2]
    return float(
        min(np.hypot(*np.moveaxis(np.diff(corners, axis=axis), -1, 0)).min() for axis in (0, 1))
    )

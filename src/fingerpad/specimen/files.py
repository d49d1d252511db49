"""Meshes as gmsh .msh files: the built mesh is written to one, a user's own mesh is read from one.

Coordinates are in mm. Physical surfaces are the layers, under any names; a mesh with epidermis,
dermis and fat (and stratum_corneum, if it has it) is a finger. A physical curve skin is what may be
touched; at least one more is held: bone, nail, base, or what the scene says. Boundary edges in none
of them are free. Linear and quadratic triangles and quads are read (format 2.2 or 4.1); an 8-node
quad is given the centre node where its own (serendipity) map puts the centre.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.spatial import KDTree

from fingerpad.files import is_file, read_input, write_atomically
from fingerpad.specimen.element_kinds import KINDS, LINES
from fingerpad.specimen.gmsh_worker import GmshError, ask
from fingerpad.specimen.judge import check_joined, check_skin
from fingerpad.specimen.pad import (
    HELD,
    OPTIONAL,
    REGIONS,
    SKIN,
    UNNAMED,
    MeshError,
    PadMesh,
    edge_keys,
    element_edges,
)
from fingerpad.specimen.quality import check_orientation, counter_clockwise

_ELEMENTS = {KINDS[name].gmsh: name for name in ("tri3", "tri6", "quad4", "quad8", "quad9")}
_SAME_PLACE = 1e-6  # of the pad's width: two nodes closer than this are mirror images of each other
MOST = {"Nodes": 1_000_000, "Elements": 500_000}
"""Of a file, lines and points included."""
_WIDTHS = (0.1, 1000.0)  # mm, between which the width of a pad is believed


def write_pad(mesh: PadMesh, path: str | Path) -> None:
    """Write `mesh` to a gmsh .msh file (version 4.1, mm), whole or not at all.

    Raises
    ------
    OSError
        The file cannot be written, or not to its end (gmsh itself does not say that a disk is
        full).
    """
    write_atomically(path, lambda partial: _write(mesh, partial, path))


def _write(mesh: PadMesh, partial: Path, path: str | Path) -> None:
    curves = [
        (name, LINES[facets.shape[1]], facets.ravel() + 1) for name, facets in mesh.curves.items()
    ]
    surfaces = [
        (name, KINDS[mesh.element].gmsh, mesh.cells[mesh.region == layer].ravel() + 1)
        for layer, name in enumerate(mesh.regions)
    ]
    try:
        ask("write", str(partial.absolute()), mesh.points * 1e3, curves, surfaces)
    except GmshError as error:
        raise OSError(errno.EIO, f"gmsh cannot write it ({error})", str(path)) from None
    if not partial.read_bytes().rstrip().endswith(b"$EndElements"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def _check_file(path: Path) -> None:
    """`MeshError` for what is no mesh, or is too large, before gmsh sees it."""
    try:
        content = read_input(path, "mesh")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise MeshError(f"cannot be read: {reason}") from None
    if not content.startswith(b"$MeshFormat"):
        raise MeshError("is not a gmsh mesh; a .msh file of version 2.2 or 4.1 is allowed")
    for section, most in MOST.items():
        count = _count(content, section)
        if count > most:
            raise MeshError(f"has {count} {section.lower()}; up to {most} are allowed")


def _count(content: bytes, section: str) -> int:
    """How many nodes or elements a .msh file says that it has; 0 where it says nothing that can be
    read.
    """
    _, found, rest = content.partition(f"\n${section}".encode())
    line = rest[:200].lstrip(b"\r").removeprefix(b"\n") if found else b""
    try:
        numbers = [int(word) for word in line.split(b"\n", 1)[0].split()]
    except ValueError:  # binary, 4.1
        numbers = np.frombuffer(line[:32], "<u8").tolist() if len(line) >= 32 else []
    return max(numbers[:2], default=0)


def _listed(names) -> str:
    return ", ".join(names) or "none"


def _check_names(names: Iterable[str], known: Iterable[str], what: str, kind: str) -> None:
    """`MeshError` for the first name (of ``what``) that is none of the ``kind`` the mesh has."""
    for name in names:
        if name not in known:
            raise MeshError(
                f"{what}{name} is no {kind} of the mesh; its physical {kind}s are {_listed(known)}"
            )


def _layers(surfaces: dict, wanted: Sequence[str]) -> tuple[str, ...]:
    """Names of the layers: the wanted ones, or else a finger's, or else all there are."""
    _check_names(wanted, surfaces, "layer ", "surface")
    if not surfaces:
        raise MeshError("no surface is named; each layer must be a physical surface")
    finger = tuple(name for name in (*OPTIONAL, *REGIONS) if name in surfaces)
    return tuple(wanted or (finger if {*REGIONS} <= {*surfaces} else surfaces))


def _held(curves: dict, fixed: Sequence[str], free: Sequence[str]) -> tuple[str, ...]:
    """Names of the curves that are held."""
    if SKIN not in curves:
        raise MeshError(
            f"curve {SKIN} is missing; a physical curve {SKIN} must be there, "
            f"among {_listed(curves)}"
        )
    _check_names(fixed, curves, "fixed: ", "curve")
    _check_names(free, curves, "free: ", "curve")
    held = [name for name in HELD if name in curves and name not in free]
    if not held and not fixed:
        others = _listed(name for name in curves if name != SKIN)
        raise MeshError(
            f"no curve is held; a physical curve {', '.join(HELD)}, "
            f"or one named by specimen.fixed, must be there, among {others}"
        )
    return tuple(dict.fromkeys([*held, *fixed]))


def _gather_cells(
    surfaces: dict, regions: tuple[str, ...], count: int
) -> tuple[str, np.ndarray, np.ndarray]:
    """Element kind, node tags (elements, nodes) and region (elements,) of all layers."""
    region, kinds, tags, nodes = [], set(), [], []
    for index, name in enumerate(regions):
        for kind, block_tags, block_nodes in surfaces[name]:
            if kind not in _ELEMENTS:
                raise MeshError(
                    f"surface {name} has elements of gmsh's type {kind}; "
                    "allowed are triangles of 3 or 6 nodes and quads of 4, 8 or 9"
                )
            kinds.add(_ELEMENTS[kind])
            region += [index] * len(block_tags)
            tags.append(block_tags)
            nodes.append(block_nodes)
    if not kinds:
        raise MeshError(
            f"no element is in {_listed(regions)}; "
            "each layer must be a physical surface with elements"
        )
    if len(kinds) > 1:
        raise MeshError(f"mixes {' and '.join(sorted(kinds))}; one kind of element is allowed")
    number = len(np.unique(np.concatenate(tags)))
    if number < len(region):
        raise MeshError(f"an element is in two of {', '.join(regions)}; one layer each is allowed")
    if number < count:
        others = [name for name in surfaces if name not in regions]
        more = f" (the mesh also has {', '.join(others)})" if others else ""
        raise MeshError(
            f"{count - number} surface elements are in none of {', '.join(regions)}; "
            f"each must be in one{more}"
        )
    cells = np.concatenate(nodes).reshape(number, -1)
    return kinds.pop(), cells, np.array(region, np.int8)


def _with_centre(points: np.ndarray, cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """8-node quads as 9-node quads of the same shape."""
    nodes = points[cells]
    centre = 0.5 * nodes[:, 4:].sum(axis=1) - 0.25 * nodes[:, :4].sum(axis=1)
    number = len(points) + np.arange(len(cells), dtype=cells.dtype)
    return np.concatenate((points, centre)), np.column_stack((cells, number))


def _facets(mesh: PadMesh, lines: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The named boundary facets, material on the right, from the end nodes of the file's line
    elements.
    """
    edges = element_edges(mesh.cells, mesh.element)
    keys, first, uses = np.unique(edge_keys(edges), return_index=True, return_counts=True)
    boundary = edges[first[uses == 1]][:, [1, 0, *range(2, edges.shape[1])]]
    number, free = pd.Index(keys[uses == 1]), np.ones(len(boundary), dtype=bool)

    def place(ends: np.ndarray) -> str:
        x, y = mesh.points[ends[:2]].mean(axis=0) * 1e3
        return f"({x:.3f}, {y:.3f}) mm"

    curves = {}
    for name, ends in lines.items():
        wanted, first = np.unique(edge_keys(ends), return_index=True)
        chosen = number.get_indexer(wanted)
        there = (chosen >= 0) & free[chosen]
        if not there.all():
            raise MeshError(
                f"curve {name} has an edge at {place(ends[first[np.argmin(there)]])} "
                "that is not on the boundary, or in two curves; "
                f"{', '.join(lines)} must be boundary edges, each in one curve"
            )
        free[chosen] = False
        curves[name] = boundary[chosen]
    unnamed = boundary[free]
    if len(unnamed):
        # two edges at one place are a gap between elements that do not share their nodes
        middles = mesh.points[unnamed[:, :2]].mean(axis=1)
        double = KDTree(middles).query_pairs(_SAME_PLACE * np.ptp(mesh.points[:, 0]))
        if double:
            raise MeshError(
                f"{2 * len(double)} edges, the first at {place(unnamed[min(double)[0]])}, "
                "lie twice at the same place; "
                "elements must share their nodes (are the layers joined?)"
            )
        curves[UNNAMED] = unnamed
    return curves


def _in_order(skin: np.ndarray) -> np.ndarray:
    """The skin's facets from left to right, end to start."""
    after = {facet[0]: facet for facet in skin.tolist()}
    first = set(after) - set(skin[:, 1].tolist())
    order, node = [], next(iter(first), None)
    while node in after:
        order.append(after.pop(node))
        node = order[-1][1]
    if len(first) != 1 or after:
        raise MeshError("curve skin must be one line with two ends")
    return np.array(order, skin.dtype)


def _is_symmetric(mesh: PadMesh) -> bool:
    """Whether the mesh is its own mirror image in x = 0, with no element astride the axis."""
    near = _SAME_PLACE * np.ptp(mesh.points[:, 0])
    x = mesh.points[mesh.cells, 0]
    if ((x.min(axis=1) < -near) & (x.max(axis=1) > near)).any():
        return False
    distance, image = KDTree(mesh.points).query(mesh.points * (-1.0, 1.0))
    if distance.max() > near or len(np.unique(image)) < len(image):
        return False

    def rows(nodes: np.ndarray, *labels: np.ndarray) -> np.ndarray:
        return np.unique(np.column_stack((np.sort(nodes, axis=1), *labels)), axis=0)

    return all(
        np.array_equal(rows(nodes, *labels), rows(image[nodes], *labels))
        for nodes, *labels in ((mesh.cells, mesh.region), *zip(mesh.curves.values()))
    )


def read_specimen_mesh(specimen, turned: bool = False) -> PadMesh:
    """The mesh a scene's specimen names, its surfaces checked against the layers' names, both ways.

    Parameters
    ----------
    specimen : fingerpad.scenes.specimen.Specimen
        Has `mesh`, `materials` (by name), `stated` (names of the layers the scene gives), `fixed`
        and `free`.
    turned : bool
        Whether it is turned about x = 0.

    Raises
    ------
    MeshError
        See `read_pad_mesh`, or a surface has no material, or a layer is no surface.
    """
    names = tuple(specimen.materials)
    own = () if set(names) <= {*OPTIONAL, *REGIONS} else names
    mesh = read_pad_mesh(specimen.mesh, own, specimen.fixed, specimen.free)
    bare = [name for name in mesh.regions if name not in (*names, *OPTIONAL)]
    if bare:
        raise MeshError(
            f"{specimen.mesh}: no material for {', '.join(bare)}; "
            "specimen.layers must name each surface of the mesh"
        )
    _check_names(specimen.stated, mesh.regions, f"{specimen.mesh}: layer ", "surface")
    try:
        return mesh.turned() if turned else mesh
    except MeshError as error:
        raise MeshError(f"{specimen.mesh}: {error}") from None


def read_pad_mesh(
    path: str | Path,
    layers: Sequence[str] = (),
    fixed: Sequence[str] = (),
    free: Sequence[str] = (),
) -> PadMesh:
    """Read a pad from a gmsh .msh file (mm).

    Parameters
    ----------
    path : path
        The file.
    layers : sequence of str
        Names of its physical surfaces, outside to inside. Left out they are stratum_corneum (if it
        is there), epidermis, dermis and fat where the mesh has these three, else whatever surfaces
        it has.
    fixed : sequence of str
        Names of the physical curves that are held, beside bone, nail and base.
    free : sequence of str
        Names of those that are not (bone, nail and base may be among them). Boundary edges in none
        of these and not in the skin are free, as the curve "unnamed".

    Returns
    -------
    PadMesh
        In m, with the elements of the file (quad8 becomes quad9), and `symmetric` found out.

    Raises
    ------
    MeshError
        One line naming the file, what is wrong and what is allowed: the file is missing or
        unreadable, it has no skin or nothing that is held, a name is none of its own, an element is
        of another kind, in no layer, in two, or not counter-clockwise, the mesh is not plane, a
        curve is not on the boundary, or coordinates cannot be mm.
    """
    path = Path(path)
    if not is_file(path):
        raise MeshError(f"{path}: there is no such mesh file; a gmsh .msh file is allowed")
    state = path.stat()
    state = state.st_mtime_ns, state.st_size, state.st_ino
    return _read(path, state, tuple(layers), tuple(fixed), tuple(free))


@lru_cache(maxsize=1)  # a plan looks at the mesh before it is solved on
def _read(path: Path, state: tuple[int, ...], *names: tuple[str, ...]) -> PadMesh:
    """`read_pad_mesh` of a file in a `state`."""
    try:
        _check_file(path)
        return _mesh_of(*ask("read", str(path)), *names)
    except GmshError as error:
        raise MeshError(f"{path}: gmsh cannot read it ({error})") from None
    except MeshError as error:
        raise MeshError(f"{path}: {error}") from None


def _mesh_of(
    tags: np.ndarray,
    places: np.ndarray,
    surfaces: dict,
    lines: dict,
    count: int,
    layers: tuple[str, ...],
    fixed: tuple[str, ...],
    free: tuple[str, ...],
) -> PadMesh:
    """The mesh of what gmsh has read (see :func:`fingerpad.specimen.gmsh_worker.read`)."""
    regions = _layers(surfaces, layers)
    held = _held(lines, fixed, free)
    element, cell_tags, region = _gather_cells(surfaces, regions, count)

    used = np.unique(cell_tags)
    order = np.argsort(tags)
    places = places[order[np.searchsorted(tags, used, sorter=order)]]
    size = np.ptp(places, axis=0).max()
    if not np.isfinite(places).all() or np.ptp(places[:, 2]) > _SAME_PLACE * size:
        raise MeshError("nodes must be finite and lie in one plane, z = constant")
    width, (low, high) = float(np.ptp(places[:, 0])), _WIDTHS
    if not low <= width <= high:
        guess = "metres?" if width < low else "micrometres?"
        raise MeshError(f"the pad is {width:.3g} mm wide: coordinates must be mm; {guess}")
    # gmsh marks the order of bytes, of which netCDF4 would warn
    points = places[:, :2].astype(float) / 1e3
    cells = np.searchsorted(used, cell_tags).astype(np.int32)
    if element == "quad8":
        points, cells = _with_centre(points, cells)
        element = "quad9"

    mesh = PadMesh(points, cells, element, region, {}, False, regions=regions, fixed=held)
    mesh = counter_clockwise(mesh)
    check_orientation(mesh)
    pairs = {}
    for name in dict.fromkeys((SKIN, *held, *free)):
        ends = [nodes.reshape(len(facets), -1)[:, :2] for _, facets, nodes in lines[name]]
        if not ends:
            raise MeshError(
                f"curve {name} has no edges; a curve along the elements' edges must be there"
            )
        ends = np.concatenate(ends)
        if not np.isin(ends, used).all():
            raise MeshError(
                f"curve {name} has an edge of no element; curves follow the elements' edges"
            )
        pairs[name] = np.searchsorted(used, ends)
    curves = _facets(mesh, pairs)
    curves[SKIN] = _in_order(curves[SKIN])
    mesh = replace(mesh, curves=curves)
    check_joined(mesh)
    check_skin(mesh)
    return replace(mesh, symmetric=_is_symmetric(mesh))

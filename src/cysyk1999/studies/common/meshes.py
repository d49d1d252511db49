"""Meshes made of a built one on its nodes: other elements, and worse shapes, as users have."""

from dataclasses import replace
from typing import Any

import numpy as np

from fingerpad.planning.plan import plan
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.build import build_pad_mesh
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.pad import PadMesh

QUARTERS = np.array([(0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)])
RISING = np.array([(0, 1, 2, 4, 5, 8), (0, 2, 3, 8, 6, 7)])
FALLING = np.array([(0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 6, 8)])


def split(mesh: PadMesh, kind: str) -> PadMesh:
    """Split a mesh of 9-node quads into other elements with the same nodes.

    Parameters
    ----------
    mesh : PadMesh
        Mesh of "quad9" elements.
    kind : str
        "quad4" for four quads of each, "tri6" for two triangles of each, or "quad9" for the mesh
        itself. A symmetric mesh stays symmetric.

    Returns
    -------
    PadMesh

    Raises
    ------
    ValueError
        If `kind` is another one.
    """
    cells, curves = mesh.cells, mesh.curves
    if kind == "quad9":
        return mesh
    if kind == "quad4":
        parts = [cells[:, part] for part in QUARTERS]
        curves = {name: line[:, [0, 2, 2, 1]].reshape(-1, 2) for name, line in curves.items()}
    elif kind == "tri6":
        left = (mesh.points[cells[:, 8], 0] < 0)[:, None]
        parts = [
            np.where(left, cells[:, falling], cells[:, rising])
            for rising, falling in zip(RISING, FALLING, strict=True)
        ]
    else:
        raise ValueError(f"quad9 cannot be split into {kind}; allowed: quad4, tri6, quad9")
    region = np.tile(mesh.region, len(parts))
    return replace(mesh, cells=np.concatenate(parts), element=kind, region=region, curves=curves)


def pad_of(scene: Scene, kind: str, **edges: Any) -> PadMesh:
    """The thesis's mesh of a scene's pad with some edges changed, split into elements of a kind."""
    size = replace(plan(scene.with_accuracy("thesis")).mesh_size, **edges)
    return split(build_pad_mesh(scene.specimen.outline, size), kind)


def distorted(mesh: PadMesh, share: float = 0.3) -> PadMesh:
    """Move inner corners of 9-node quads at random by up to `share` of their shortest edge."""
    corners = mesh.cells[:, :4]
    side = np.linalg.norm(mesh.points[corners] - mesh.points[np.roll(corners, -1, 1)], axis=2)
    shortest = np.full(len(mesh.points), np.inf)
    np.minimum.at(shortest, corners, np.minimum(side, np.roll(side, 1, 1)))
    boundary = np.unique(np.concatenate([curve.ravel() for curve in mesh.curves.values()]))
    inner = np.setdiff1d(np.unique(corners), boundary)
    way = np.random.default_rng(7).uniform(-1, 1, (len(inner), 2))
    moved = np.zeros_like(mesh.points)
    moved[inner] = share * shortest[inner, None] * way
    moved[mesh.cells[:, 4:8]] = (moved[corners] + moved[np.roll(corners, -1, 1)]) / 2
    moved[mesh.cells[:, 8]] = moved[corners].mean(1)
    moved[boundary] = 0
    return replace(mesh, points=mesh.points + moved, symmetric=False)


def corners_only(mesh: PadMesh) -> PadMesh:
    """Drop mid-side and centre nodes, as most mesh generators write meshes."""
    count = KINDS[mesh.element].corners
    used, cells = np.unique(mesh.cells[:, :count], return_inverse=True)
    curves = {name: np.searchsorted(used, line[:, :2]) for name, line in mesh.curves.items()}
    return replace(
        mesh,
        points=mesh.points[used],
        cells=cells.reshape(-1, count).astype(np.int32),
        element={3: "tri3", 4: "quad4"}[count],
        curves={name: line.astype(np.int32) for name, line in curves.items()},
    )


def shuffled(mesh: PadMesh, seed: int) -> PadMesh:
    """The same mesh with its nodes and elements numbered in another order, drawn by a seed."""
    draw = np.random.default_rng(seed)
    number = draw.permutation(len(mesh.points)).astype(np.int32)
    order = draw.permutation(len(mesh.cells))
    return replace(
        mesh,
        points=mesh.points[np.argsort(number)],
        cells=number[mesh.cells][order],
        region=mesh.region[order],
        curves={name: number[facets] for name, facets in mesh.curves.items()},
    )

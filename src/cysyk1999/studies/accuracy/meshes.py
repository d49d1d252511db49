"""Meshes made of the built one, of its nodes: other elements, and worse shapes, as meshes from
elsewhere have.
"""

from dataclasses import replace

import numpy as np

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.pad import PadMesh


def distorted(mesh: PadMesh, share: float = 0.3) -> PadMesh:
    """Inner corners of 9-node quads moved at random by up to ``share`` of their shortest edge."""
    corners = mesh.cells[:, :4]
    side = np.linalg.norm(mesh.points[corners] - mesh.points[np.roll(corners, -1, 1)], axis=2)
    shortest = np.full(len(mesh.points), np.inf)
    for k in range(4):
        np.minimum.at(shortest, corners[:, k], np.minimum(side[:, k], side[:, k - 1]))
    held = np.unique(np.concatenate([curve.ravel() for curve in mesh.curves.values()]))
    inner = np.setdiff1d(np.unique(corners), held)
    moved = np.zeros_like(mesh.points)
    moved[inner] = (
        share * shortest[inner, None] * np.random.default_rng(7).uniform(-1, 1, (len(inner), 2))
    )
    for k in range(4):
        moved[mesh.cells[:, 4 + k]] = moved[corners[:, [k, (k + 1) % 4]]].mean(1)
    moved[mesh.cells[:, 8]] = moved[corners].mean(1)
    moved[held] = 0
    points = mesh.points + moved
    return replace(mesh, points=points, symmetric=False)


def triangles(mesh: PadMesh) -> PadMesh:
    """Each 9-node quad as two 6-node triangles on the same nodes, a symmetric mesh staying
    symmetric.
    """
    right = mesh.points[mesh.cells[:, 8], 0] > 0
    halves = [([0, 1, 2, 4, 5, 8], [0, 1, 3, 4, 8, 7]), ([0, 2, 3, 8, 6, 7], [1, 2, 3, 5, 6, 8])]
    cells = np.concatenate(
        [np.where(right[:, None], mesh.cells[:, a], mesh.cells[:, b]) for a, b in halves]
    )
    return replace(mesh, cells=cells, element="tri6", region=np.tile(mesh.region, 2))


def quarters(mesh: PadMesh) -> PadMesh:
    """Each 9-node quad as four 4-node quads on the same nodes."""
    parts = [[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]]
    cells = np.concatenate([mesh.cells[:, part] for part in parts])
    curves = {name: facets[:, [0, 2, 2, 1]].reshape(-1, 2) for name, facets in mesh.curves.items()}
    return replace(
        mesh, cells=cells, element="quad4", region=np.tile(mesh.region, 4), curves=curves
    )


def corners_only(mesh: PadMesh) -> PadMesh:
    """Triangles and quads without their mid-side and centre nodes: what most mesh generators
    write.
    """
    count = KINDS[mesh.element].corners
    used = np.unique(mesh.cells[:, :count])
    number = np.full(len(mesh.points), -1, np.int32)
    number[used] = np.arange(len(used))
    curves = {name: number[facets[:, :2]] for name, facets in mesh.curves.items()}
    element = {3: "tri3", 4: "quad4"}[count]
    return replace(
        mesh,
        points=mesh.points[used],
        cells=number[mesh.cells[:, :count]],
        element=element,
        curves=curves,
    )

"""Quality of a mesh: size, smallest edge, and how near its elements are to rectangles or even
triangles.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pandas as pd

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.pad import MeshError, PadMesh, element_edges


def _sample_points(mesh: PadMesh) -> np.ndarray:
    """Gauss points (m, 2) of the reference element: 3 in triangles, 3 x 3 in quads."""
    kind = KINDS[mesh.element]
    return kind.rule(2 if kind.corners == 3 else 5)[0]


def jacobians(mesh: PadMesh, at: np.ndarray) -> np.ndarray:
    """Jacobian matrices (elements, m, 2, 2) in m at reference points (m, 2); [..., k, :] is tangent
    k.
    """
    gradients = KINDS[mesh.element].shapes(at)[1]
    return np.einsum("eai,mak->emki", mesh.points[mesh.cells], gradients)


def counter_clockwise(mesh: PadMesh) -> PadMesh:
    """The same mesh with the nodes of elements that run clockwise in the other order."""
    clockwise = np.linalg.det(jacobians(mesh, _sample_points(mesh))).max(axis=1) <= 0.0
    if not clockwise.any():
        return mesh
    cells = mesh.cells.copy()
    cells[clockwise] = cells[clockwise][:, KINDS[mesh.element].mirrored]
    return replace(mesh, cells=cells)


def check_orientation(mesh: PadMesh, name: str = "", advice: str = "") -> None:
    """Raise `MeshError` naming the first element whose Jacobian is not positive at every Gauss
    point, and what would help.
    """
    points = np.concatenate([_sample_points(mesh), KINDS[mesh.element].rule(5)[0]])
    determinant = np.linalg.det(jacobians(mesh, points))
    bad = np.flatnonzero(determinant.min(axis=1) <= 0.0)
    if len(bad):
        what = "runs clockwise" if determinant[bad[0]].max() <= 0.0 else "is folded"
        x, y = mesh.points[mesh.cells[bad[0]]].mean(axis=0) * 1e3
        name, advice = name and f"{name}: ", advice and f"; {advice} are allowed"
        raise MeshError(
            f"{name}element {bad[0]} at ({x:.3f}, {y:.3f}) mm {what} "
            f"({len(bad)} of {len(mesh.cells)}); elements must be counter-clockwise with a "
            f"positive Jacobian{advice}"
        )


def scaled_jacobian(mesh: PadMesh) -> np.ndarray:
    """Smallest scaled Jacobian (elements,) over corners and Gauss points; 1 is a rectangle or even
    triangle.

    The determinant of the curved element's tangents over the product of their lengths; in a
    triangle over the largest product of two sides' lengths, times 2 / sqrt(3) (P. M. Knupp, 2003).
    """
    corners = KINDS[mesh.element].element.refdom.p.T
    tangents = jacobians(mesh, np.concatenate([corners, _sample_points(mesh)]))
    lengths = np.hypot(tangents[..., 0], tangents[..., 1])
    scale = lengths[..., 0] * lengths[..., 1]
    if mesh.element.startswith("tri"):
        third = np.hypot(*np.moveaxis(tangents[..., 1, :] - tangents[..., 0, :], -1, 0))
        scale = np.maximum(scale, third * lengths.max(axis=-1)) * np.sqrt(0.75)
    return (np.linalg.det(tangents) / scale).min(axis=1)


def shortest_edge(mesh: PadMesh) -> float:
    """Shortest edge of an element (m), corner to corner."""
    start, end = element_edges(mesh.cells[:, : KINDS[mesh.element].corners], mesh.element).T
    return float(np.hypot(*(mesh.points[end] - mesh.points[start]).T).min())


def quality_of(mesh: PadMesh) -> dict[str, float]:
    """nodes, elements, smallest_edge_m (corner to corner) and worst_scaled_jacobian of a mesh."""
    return {
        "nodes": len(mesh.points),
        "elements": len(mesh.cells),
        "smallest_edge_m": shortest_edge(mesh),
        "worst_scaled_jacobian": float(scaled_jacobian(mesh).min()),
    }


def quality_table(meshes: Mapping[str, PadMesh]) -> pd.DataFrame:
    """One row per mesh: mesh, element, nodes, elements, smallest edge (um), worst scaled Jacobian
    (1).
    """
    table = pd.DataFrame(
        {"mesh": name, "element": mesh.element, **quality_of(mesh)} for name, mesh in meshes.items()
    )
    table["smallest_edge_m"] *= 1e6
    names = {
        "smallest_edge_m": "smallest edge (um)",
        "worst_scaled_jacobian": "worst scaled Jacobian (1)",
    }
    return table.rename(columns=names)

"""The one table of element kinds: their names in gmsh and meshio, their element in scikit-fem, and
the element the solver uses by default.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import (
    Element,
    ElementQuad1,
    ElementQuad2,
    ElementQuadS2,
    ElementTriP1,
    ElementTriP2,
    ElementTriP2B,
)
from skfem.quadrature import get_quadrature


@dataclass(frozen=True)
class Kind:
    """One kind of element.

    Nodes are corners counter-clockwise, middles of sides (0-1, 1-2, ...), centre: the order of
    gmsh, of meshio and of scikit-fem. The reference cells are scikit-fem's too: the unit square and
    the triangle (0, 0), (1, 0), (0, 1).

    Parameters
    ----------
    name : str
        As in `PadMesh.element`.
    corners, nodes : int
        Their numbers.
    gmsh : int
        Element type in gmsh.
    meshio : str
        Name in meshio and VTK.
    solved : str or None
        Key of the mixed element it is solved with (:mod:`fingerpad.mechanics.elements`); None for a
        kind that is raised or completed first.
    mirrored : tuple of int
        Order of the nodes that makes the mirror image counter-clockwise again.
    element : skfem.Element
        Shape functions; scikit-fem's bubble is a mode, here it is the centre node's.
    """

    name: str
    corners: int
    nodes: int
    gmsh: int
    meshio: str
    solved: str | None
    mirrored: tuple[int, ...]
    element: Element

    @property
    def quadratic(self) -> bool:
        """Whether there are mid-side nodes."""
        return self.nodes > self.corners

    def shapes(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shape functions at points of the reference cell.

        Parameters
        ----------
        at : (m, 2) array
            Reference coordinates.

        Returns
        -------
        values : (m, nodes) array
        gradients : (m, nodes, 2) array
            Derivatives by the reference coordinates.
        """
        basis = [self.element.lbasis(at.T, node) for node in range(self.nodes)]
        values = np.stack([np.broadcast_to(value, len(at)) for value, _ in basis], axis=1)
        gradients = np.stack([np.broadcast_to(slope, at.T.shape).T for _, slope in basis], axis=1)
        if self.name == "tri7":
            centroid = np.array([-1 / 9] * 3 + [4 / 9] * 3)
            values[:, :6] -= values[:, 6:] * centroid
            gradients[:, :6] -= gradients[:, 6:] * centroid[:, None]
        return values, gradients

    def rule(self, degree: int) -> tuple[np.ndarray, np.ndarray]:
        """Quadrature points (m, 2) of the reference cell and weights (m,), exact to a degree."""
        points, weights = get_quadrature(self.element.refdom, degree)
        return points.T.copy(), weights


KINDS = {
    kind.name: kind
    for kind in (
        Kind("tri3", 3, 3, 2, "triangle", None, (1, 0, 2), ElementTriP1()),
        Kind("tri6", 3, 6, 9, "triangle6", "P2B", (1, 0, 2, 3, 5, 4), ElementTriP2()),
        Kind("quad4", 4, 4, 3, "quad", "Q1P0", (1, 0, 3, 2), ElementQuad1()),
        Kind("quad8", 4, 8, 16, "quad8", None, (1, 0, 3, 2, 4, 7, 6, 5), ElementQuadS2()),
        Kind("quad9", 4, 9, 10, "quad9", "Q2P1", (1, 0, 3, 2, 4, 7, 6, 5, 8), ElementQuad2()),
        Kind("tri7", 3, 7, 42, "triangle7", "P2B", (1, 0, 2, 3, 5, 4, 6), ElementTriP2B()),
    )
}
LINES = {2: 1, 3: 8}  # gmsh's type of a line, by its number of nodes


def kind_of(nodes: int) -> Kind:
    """The kind with that many nodes; raises KeyError when there is none."""
    return {kind.nodes: kind for kind in KINDS.values()}[nodes]

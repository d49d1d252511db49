"""Reference elements: shape functions, quadrature and the pressure space each displacement element
is paired with.

Every element is a mixed one. The dilatation ``J - 1`` is projected, element by element, on a small
pressure space; the number of its modes is all that tells a locking element from a sound one:

=========  ==================  ==============================  ===================================
name       displacement        pressure modes                  use
=========  ==================  ==============================  ===================================
``Q2P1``   9-node quad         3 (linear, discontinuous)       default
``Q1P0``   4-node quad         1 (mean dilatation)             external linear quads
``P2B``    6-node triangle     3                               external triangles (bubble node)
``Q2``     9-node quad         9 (= pointwise)                 teaching case: oscillates
``Q1``     4-node quad         4 (= pointwise)                 teaching case: locks
``Q2R``    9-node quad, 2 x 2  4 (pointwise, reduced points)   teaching case: may hourglass
``P2``     6-node triangle     6 (= pointwise)                 teaching case: oscillates
=========  ==================  ==============================  ===================================

Sources: Simo, Taylor and Pister (1985) for the three-field form; Sussman and Bathe (1987) for Q2
with linear pressure; Crouzeix and Raviart (1973) for the triangle with a bubble.
"""

from dataclasses import dataclass

import numpy as np

from fingerpad.specimen.element_kinds import KINDS


@dataclass(frozen=True)
class ReferenceElement:
    """One element on its reference cell.

    Attributes
    ----------
    name
        Key in :data:`ELEMENTS`.
    kind
        Of its displacement, key in :data:`fingerpad.specimen.element_kinds.KINDS`.
    points
        (nq, 2) quadrature points; ``weights``: (nq,).
    values
        (nq, nen) shape functions; ``gradients``: (nq, nen, 2) with respect to the reference
        coordinates.
    pressure_modes
        1, 3, or nq (pointwise).
    nodes
        (nen, 2) reference coordinates of the nodes.
    """

    name: str
    kind: str
    points: np.ndarray
    weights: np.ndarray
    values: np.ndarray
    gradients: np.ndarray
    pressure_modes: int
    nodes: np.ndarray

    @property
    def triangle(self) -> bool:
        """Whether its cell is one."""
        return self.kind.startswith("tri")

    @property
    def nodes_per_element(self) -> int:
        return self.nodes.shape[0]

    def shape(self, xi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Shape functions (n, nen) and reference gradients (n, nen, 2) at reference points ``xi``
        (n, 2).
        """
        return KINDS[self.kind].shapes(np.asarray(xi, dtype=float))


_QUAD4 = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
_QUAD9 = np.vstack([_QUAD4, [[0.5, 0], [1, 0.5], [0.5, 1], [0, 0.5], [0.5, 0.5]]])
_TRI7 = np.array([[0, 0], [1, 0], [0, 1], [0.5, 0], [0.5, 0.5], [0, 0.5], [1 / 3, 1 / 3]])


def _build(
    name: str, kind: str, degree: int, modes: int | None, nodes: np.ndarray
) -> ReferenceElement:
    points, weights = KINDS[kind].rule(degree)
    values, gradients = KINDS[kind].shapes(points)
    return ReferenceElement(
        name, kind, points, weights, values, gradients, modes or len(weights), nodes
    )


ELEMENTS = {
    element.name: element
    for element in (
        _build("Q2P1", "quad9", 5, 3, _QUAD9),
        _build("Q1P0", "quad4", 3, 1, _QUAD4),
        _build("P2B", "tri7", 5, 3, _TRI7),
        _build("Q2", "quad9", 5, None, _QUAD9),
        _build("Q1", "quad4", 3, None, _QUAD4),
        _build("Q2R", "quad9", 3, None, _QUAD9),
        _build("P2", "tri6", 4, None, _TRI7[:6]),
    )
}

#: Weights of a uniform line load on one edge: 1/2, 1/2 (linear) and the basis of quadratic edges
#: (start, end, middle).
EDGE_POINTS, EDGE_WEIGHTS = np.polynomial.legendre.leggauss(4)


def edge_values(order: int, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Shape functions and derivatives (n, order + 1) of an edge (start, end[, middle]) at points
    ``s`` (n,) on [-1, 1].
    """
    if order == 1:
        return np.stack([(1 - s) / 2, (1 + s) / 2], 1), np.stack([-0.5 + 0 * s, 0.5 + 0 * s], 1)
    values = np.stack([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s * s], 1)
    return values, np.stack([s - 0.5, s + 0.5, -2 * s], 1)

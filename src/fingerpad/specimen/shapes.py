"""Shape functions and quadrature of the reference elements: the square and the triangle with
corners 0 and 1.

Written out here because a library of elements takes longer to import than a press takes to solve;
tests compare them with scikit-fem's.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Shape = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Values (m, nodes) and derivatives (m, nodes, 2) of shape functions at points (m, 2) of the
reference element.
"""

_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))
_QUAD9 = (*_CORNERS, (2, 0), (1, 2), (2, 1), (0, 2), (2, 2))  # node 2 of a line is its middle
_SIDES = ((0, 1), (1, 2), (0, 2))  # of a triangle, in the order of their middle nodes


def _line(order: int, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lagrange polynomials of the line with nodes 0, 1 and, of order 2, its middle; and their
    derivatives.
    """
    if order == 1:
        return np.stack([1 - t, t]), np.stack([0 * t - 1, 0 * t + 1])
    values = np.stack([(1 - t) * (1 - 2 * t), t * (2 * t - 1), 4 * t * (1 - t)])
    return values, np.stack([4 * t - 3, 4 * t - 1, 4 - 8 * t])


def _quad(order: int, nodes: tuple[tuple[int, int], ...]) -> Shape:
    i, j = np.array(nodes).T

    def shape(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        (x, dx), (y, dy) = _line(order, at[:, 0]), _line(order, at[:, 1])
        return (x[i] * y[j]).T, np.stack([(dx[i] * y[j]).T, (x[i] * dy[j]).T], axis=-1)

    return shape


def _serendipity(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Those of nine nodes, the centre's shared out: -1/4 to each corner, 1/2 to each middle of a
    side.
    """
    values, gradients = _quad(2, _QUAD9)(at)
    share = np.array([-0.25] * 4 + [0.5] * 4)
    return values[:, :8] + values[:, 8:] * share, gradients[:, :8] + gradients[:, 8:] * share[
        :, None
    ]


_TOWARDS = np.array(
    [(-1.0, -1.0), (1.0, 0.0), (0.0, 1.0)]
)  # derivatives of a triangle's areal coordinates


def _areal(at: np.ndarray) -> np.ndarray:
    return np.column_stack([1 - at.sum(axis=1), at])


def _triangle(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    areal = _areal(at)
    return areal, np.broadcast_to(_TOWARDS, (len(at), 3, 2))


def _triangle6(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    areal = _areal(at)
    a, b = np.array(_SIDES).T
    values = np.hstack([areal * (2 * areal - 1), 4 * areal[:, a] * areal[:, b]])
    sides = 4 * (areal[:, a, None] * _TOWARDS[b] + areal[:, b, None] * _TOWARDS[a])
    return values, np.concatenate([(4 * areal - 1)[:, :, None] * _TOWARDS, sides], axis=1)


def _triangle7(at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Those of six nodes and a cubic bubble, made nodal at the centroid."""
    values, gradients = _triangle6(at)
    areal = _areal(at)
    others = np.stack(
        [areal[:, 1] * areal[:, 2], areal[:, 0] * areal[:, 2], areal[:, 0] * areal[:, 1]], axis=1
    )
    bubble, slope = 27 * areal.prod(axis=1, keepdims=True), 27 * others @ _TOWARDS
    centroid = np.array([-1 / 9] * 3 + [4 / 9] * 3)
    values = np.hstack([values - bubble * centroid, bubble])
    return values, np.concatenate(
        [gradients - slope[:, None] * centroid[:, None], slope[:, None]], axis=1
    )


SHAPES: dict[str, Shape] = {
    "tri3": _triangle,
    "tri6": _triangle6,
    "tri7": _triangle7,
    "quad4": _quad(1, _CORNERS),
    "quad8": _serendipity,
    "quad9": _quad(2, _QUAD9),
}
"""By kind of element (:data:`fingerpad.specimen.element_kinds.KINDS`), nodes in its order."""


def square_rule(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss points (count^2, 2) of the reference square and weights, exact for degree 2 count - 1
    in each coordinate.
    """
    t, w = np.polynomial.legendre.leggauss(count)
    x, y = np.meshgrid((t + 1) / 2, (t + 1) / 2, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel()]), np.outer(w, w).ravel() / 4


def triangle_rule(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Points (6 or 7, 2) of the reference triangle and weights, exact for polynomials of degree 4
    or 5 (Dunavant 1985).
    """
    if degree == 4:
        a, share = (
            np.array([0.445948490915965, 0.091576213509771]),
            np.array([0.223381589678011, 0.109951743655322]),
        )
        centre = np.zeros((0, 3))
    else:
        root = np.sqrt(15.0) * np.array([1.0, -1.0])
        a, share = (6 + root) / 21, (155 + root) / 1200
        centre = np.array([(1 / 3, 1 / 3, 9 / 40)])
    turned = (np.column_stack([x, y, share]) for x, y in ((a, 1 - 2 * a), (1 - 2 * a, a), (a, a)))
    found = np.concatenate([centre, *turned])
    return found[:, :2].copy(), found[:, 2] / 2

"""Shape functions and quadrature of the reference elements, against scikit-fem's and against exact
integrals.
"""

import math

import numpy as np
import pytest
import skfem

from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.shapes import SHAPES, square_rule, triangle_rule

pytestmark = pytest.mark.unit

LIBRARY = {
    "tri3": "ElementTriP1",
    "tri6": "ElementTriP2",
    "quad4": "ElementQuad1",
    "quad8": "ElementQuadS2",
    "quad9": "ElementQuad2",
}
NODES = {
    "tri": [(0, 0), (1, 0), (0, 1), (0.5, 0), (0.5, 0.5), (0, 0.5), (1 / 3, 1 / 3)],
    "quad": [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0), (1, 0.5), (0.5, 1), (0, 0.5), (0.5, 0.5)],
}


@pytest.mark.parametrize("kind", LIBRARY)
def test_shape_functions_are_those_of_scikit_fem(kind):
    at = np.random.default_rng(1).uniform(0, 0.5, (20, 2))
    values, gradients = SHAPES[kind](at)
    assert values.shape == (20, KINDS[kind].nodes) and gradients.shape == (20, KINDS[kind].nodes, 2)
    for node in range(KINDS[kind].nodes):
        truth, slope = getattr(skfem, LIBRARY[kind])().lbasis(at.T, node)
        np.testing.assert_allclose(values[:, node], truth, atol=1e-14)
        np.testing.assert_allclose(
            gradients[:, node], np.broadcast_to(slope.T, (20, 2)), atol=1e-14
        )


@pytest.mark.parametrize("kind", KINDS)
def test_each_is_one_at_its_node_and_none_at_the_others_and_has_its_own_slope(kind):
    nodes = np.array(NODES[kind[:-1]][: KINDS[kind].nodes])
    np.testing.assert_allclose(SHAPES[kind](nodes)[0], np.eye(len(nodes)), atol=1e-14)
    at, step = np.random.default_rng(2).uniform(0.1, 0.4, (20, 2)), 1e-6
    for axis in range(2):
        on, back = (SHAPES[kind](at + sign * step * np.eye(2)[axis])[0] for sign in (1, -1))
        np.testing.assert_allclose(
            SHAPES[kind](at)[1][..., axis], (on - back) / (2 * step), atol=1e-8
        )


@pytest.mark.parametrize("count", [1, 2, 3])
def test_gauss_points_of_the_square_are_exact_up_to_their_degree_and_no_further(count):
    (x, y), weights = square_rule(count)[0].T, square_rule(count)[1]
    for p in range(2 * count):
        for q in range(2 * count):
            assert weights @ (x**p * y**q) == pytest.approx(1 / (p + 1) / (q + 1), rel=1e-13)
    assert weights @ x ** (2 * count) != pytest.approx(1 / (2 * count + 1), rel=1e-4)


@pytest.mark.parametrize("degree", [4, 5])
def test_points_of_the_triangle_are_exact_up_to_their_degree_and_no_further(degree):
    (x, y), weights = triangle_rule(degree)[0].T, triangle_rule(degree)[1]

    def off(p, q):
        return abs(
            weights
            @ (x**p * y**q)
            * math.factorial(p + q + 2)
            / math.factorial(p)
            / math.factorial(q)
            - 1
        )

    assert max(off(p, q) for p in range(degree + 1) for q in range(degree + 1 - p)) < 1e-12
    assert max(off(degree + 1 - q, q) for q in range(degree + 2)) > 1e-3

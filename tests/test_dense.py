"""Dense factorisations by both libraries, against numpy's inverse and eigenvalues."""

import numpy as np
import pytest

from fingerpad.mechanics import dense

pytestmark = pytest.mark.unit

SIZES = (1, 2, 7, 60)


@pytest.fixture(params=["pardiso", "superlu"], autouse=True)
def library(request, monkeypatch):
    monkeypatch.setenv("FINGERPAD_LINEAR_SOLVER", request.param)
    if request.param == "pardiso" and dense.mkl() is None:
        pytest.skip("MKL is not installed here")
    assert (dense.mkl() is None) == (request.param == "superlu")


def symmetric(size, seed=3):
    made = np.random.default_rng(seed).normal(size=(size, size))
    return made + made.T


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("size", SIZES)
def test_cholesky_solves_and_inverts_and_leaves_its_matrix_alone(size, order):
    matrix = np.asarray(symmetric(size) @ symmetric(size) + np.eye(size), order=order)
    kept = matrix.copy()
    factor = dense.cholesky(matrix)
    right = np.random.default_rng(4).normal(size=(size, 3))
    np.testing.assert_allclose(
        dense.solved(factor, right), np.linalg.solve(matrix, right), rtol=1e-6, atol=1e-9
    )
    np.testing.assert_allclose(
        dense.solved(factor, right[:, 0]),
        np.linalg.solve(matrix, right[:, 0]),
        rtol=1e-6,
        atol=1e-9,
    )
    np.testing.assert_allclose(
        np.tril(dense.inverse(factor)), np.tril(np.linalg.inv(matrix)), rtol=1e-6, atol=1e-9
    )
    np.testing.assert_array_equal(matrix, kept)


def test_what_is_not_positive_definite_has_no_factor():
    assert dense.cholesky(np.diag([1.0, -1e-9, 2.0])) is None
    assert dense.cholesky(np.zeros((0, 0))) is not None


@pytest.mark.parametrize("size", SIZES)
def test_negative_eigenvalues_are_counted(size):
    matrix = symmetric(size)
    matrix[0, 0] = 0.0  # pivots of two
    assert dense.negative_eigenvalues(matrix) == np.sum(np.linalg.eigvalsh(matrix) < 0)
    assert dense.negative_eigenvalues(np.zeros((0, 0))) == 0

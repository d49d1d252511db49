"""Factorisations of small dense symmetric matrices: by the library that PARDISO is of, by scipy's
LAPACK where that is not.

Importing scipy's linear algebra takes as long as a press takes to solve, and that library is loaded
anyway.
"""

from __future__ import annotations

import ctypes
import glob
import os
import sys
from functools import cache
from typing import Protocol

import numpy as np

from fingerpad.processes import threads

_COLUMNS = 102  # LAPACK's layout: column by column


@cache
def _loaded() -> ctypes.CDLL | None:
    found = sorted(glob.glob(os.path.join(sys.prefix, "lib", "libmkl_rt.so*")), key=len)
    if not found:
        return None
    library = ctypes.CDLL(found[0])
    # numpy's thread limits do not reach a library that is loaded later, and two threads on one
    # matrix take twice the time
    library.MKL_Set_Num_Threads(ctypes.c_int(threads()))
    return library


def mkl() -> ctypes.CDLL | None:
    """Intel's Math Kernel Library, with as many threads as this process may use; None where it is
    not installed or not wanted.
    """
    return _loaded() if os.environ.get("FINGERPAD_LINEAR_SOLVER", "pardiso") == "pardiso" else None


class _Lapack(Protocol):
    """What is asked of a library. Arrays (n, n) are contiguous and changed in place; of a factor
    its lower triangle counts.
    """

    def potrf(self, matrix: np.ndarray) -> bool: ...
    def potri(self, factor: np.ndarray) -> None: ...
    def potrs(self, factor: np.ndarray, right: np.ndarray) -> np.ndarray: ...
    def sytrf(self, matrix: np.ndarray) -> np.ndarray: ...


def _pointer(array: np.ndarray) -> ctypes.c_void_p:
    return ctypes.c_void_p(array.ctypes.data)


class _OfMkl:
    """Rows are its columns, so that its upper triangle is our lower one."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library

    def potrf(self, matrix: np.ndarray) -> bool:
        return (
            self._library.LAPACKE_dpotrf(
                _COLUMNS, ctypes.c_char(b"U"), len(matrix), _pointer(matrix), len(matrix)
            )
            == 0
        )

    def potri(self, factor: np.ndarray) -> None:
        self._library.LAPACKE_dpotri(
            _COLUMNS, ctypes.c_char(b"U"), len(factor), _pointer(factor), len(factor)
        )

    def potrs(self, factor: np.ndarray, right: np.ndarray) -> np.ndarray:
        out, n = np.array(right, float, order="F"), len(factor)
        columns = out.size // n
        self._library.LAPACKE_dpotrs(
            _COLUMNS, ctypes.c_char(b"U"), n, columns, _pointer(factor), n, _pointer(out), n
        )
        return out

    def sytrf(self, matrix: np.ndarray) -> np.ndarray:
        pivots = np.zeros(len(matrix), np.int32)
        given = (
            _COLUMNS,
            ctypes.c_char(b"U"),
            len(matrix),
            _pointer(matrix),
            len(matrix),
            _pointer(pivots),
        )
        self._library.LAPACKE_dsytrf(*given)
        return pivots


class _OfScipy:
    def __init__(self) -> None:
        from scipy.linalg import lapack  # here, for it is slow to import

        self._lapack = lapack

    def potrf(self, matrix: np.ndarray) -> bool:
        return self._lapack.dpotrf(matrix.T, lower=0, overwrite_a=1)[1] == 0

    def potri(self, factor: np.ndarray) -> None:
        self._lapack.dpotri(factor.T, lower=0, overwrite_c=1)

    def potrs(self, factor: np.ndarray, right: np.ndarray) -> np.ndarray:
        return self._lapack.dpotrs(factor.T, right, lower=0)[0]

    def sytrf(self, matrix: np.ndarray) -> np.ndarray:
        return self._lapack.dsytrf(matrix.T, lower=0, lwork=64 * len(matrix), overwrite_a=1)[1]


@cache
def _chosen(library: ctypes.CDLL | None) -> _Lapack:
    return _OfScipy() if library is None else _OfMkl(library)


def _lapack() -> _Lapack:
    return _chosen(mkl())


def cholesky(matrix: np.ndarray) -> np.ndarray | None:
    """Factor of a symmetric matrix (n, n) for :func:`solved` and :func:`inverse`; None where it is
    not positive definite.
    """
    factor = np.array(matrix, float, order="C")
    return factor if not len(factor) or _lapack().potrf(factor) else None


def solved(factor: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solution for right-hand sides (n,) or (n, k) by a Cholesky factor."""
    return _lapack().potrs(factor, right) if right.size else right


def inverse(factor: np.ndarray) -> np.ndarray:
    """Lower triangle (n, n) of the inverse of the matrix that a Cholesky factor is of, in the
    factor's place.
    """
    if len(factor):
        _lapack().potri(factor)
    return factor


def negative_eigenvalues(matrix: np.ndarray) -> int:
    """Their number, of a symmetric matrix, by Sylvester's law: the negative pivots of L D L^T, one
    in each block of two.
    """
    if not len(matrix):
        return 0
    factors = np.array(matrix, float, order="C")
    pivots = _lapack().sytrf(factors)
    return int(np.sum(np.diag(factors)[pivots > 0] < 0) + np.sum(pivots < 0) // 2)

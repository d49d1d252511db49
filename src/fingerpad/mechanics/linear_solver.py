"""Symmetric sparse factorisation that condenses the system onto a few degrees of freedom (the
possible contact zone).

``K x = b`` is split in the condensed degrees of freedom ``c`` and the rest ``i``. One factorisation
gives the dense Schur complement ``S = K_cc - K_ci K_ii^-1 K_ic``; a forward sweep gives the reduced
right-hand side, and after the small dense problem has been solved by whoever owns it, a backward
sweep gives the rest. PARDISO does all of it inside its own factorisation; where it is not available
SuperLU gives the same answers, slower.
"""

from __future__ import annotations

import ctypes
import os
import sys
from functools import cache
from pathlib import Path
from typing import cast

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_matrix, triu
from scipy.sparse.linalg import splu

from fingerpad.processes import threads

#: SuperLU pivots on the diagonal while that is at least this share of the largest entry of its
#: column. Other pivots spoil the order of the columns, which keeps the factors of a symmetric
#: matrix sparse.
DIAGONAL = 1e-3


class FactorisationError(RuntimeError):
    """The matrix is singular to working precision."""


class SymmetricPattern:
    """Upper-triangular CSR pattern of the free degrees of freedom and where each element entry
    goes.

    Parameters
    ----------
    cells : (ne, nen) int array
        Nodes of the elements, whose entries are in the order of components, then nodes.
    equation : (n, nc) int array
        Equation number of each component of a node, ascending; -1 where prescribed.

    Attributes
    ----------
    indptr, indices : int32 arrays
        The pattern, of ``size`` equations and ``nonzeros`` entries.
    scatter : (ne, nd (nd + 1) / 2) int32 array
        Where the upper triangle of each element's matrix goes; ``nonzeros`` if prescribed.

    Raises
    ------
    FactorisationError
        A free node belongs to no element.
    """

    def __init__(self, cells: np.ndarray, equation: np.ndarray):
        self.size = int(np.count_nonzero(equation >= 0))
        at = np.concatenate(list(np.moveaxis(equation[cells], -1, 0)), axis=1).astype(np.int32)
        i, j = (at[:, side] for side in np.triu_indices(at.shape[1]))
        row, col = np.minimum(i, j), np.maximum(i, j)
        free = row >= 0
        row, col = row[free], col[free]
        entries = np.ones(len(row), np.int8), (row, col)
        pattern = csr_matrix(entries, shape=(self.size, self.size))
        self.indptr, self.indices, self.nonzeros = pattern.indptr, pattern.indices, pattern.nnz
        if not np.diff(self.indptr).all():
            raise FactorisationError("some nodes belong to no element")
        pattern.data = np.arange(self.nonzeros, dtype=np.int32)
        self.scatter = np.full(free.shape, self.nonzeros, np.int32)
        self.scatter[free] = np.asarray(pattern[row, col]).ravel()

    def new_data(self) -> np.ndarray:
        """Zeroed coefficient storage (nonzeros + 1,); the last entry is the discard slot."""
        return np.zeros(self.nonzeros + 1)

    def matrix(self, data: np.ndarray) -> csr_matrix:
        """The full symmetric matrix (both triangles) as CSR."""
        upper = csr_matrix((data[:-1], self.indices, self.indptr), shape=(self.size, self.size))
        return (upper + triu(upper, 1).T).tocsr()


@cache
def _mkl() -> ctypes.CDLL | None:
    """Intel's Math Kernel Library with as many threads as this process may use, if installed."""
    libraries = sorted(Path(sys.prefix, "lib").glob("libmkl_rt.so*"))
    if not libraries:
        return None
    os.environ.setdefault("MKL_THREADING_LAYER", "GNU")  # of libgomp, which gmsh needs anyway
    library = ctypes.CDLL(str(libraries[0]))
    library.MKL_Set_Num_Threads(ctypes.c_int(threads()))
    return library


def pardiso_available() -> bool:
    """Whether PARDISO is installed and FINGERPAD_LINEAR_SOLVER does not name another solver."""
    wanted = os.environ.get("FINGERPAD_LINEAR_SOLVER", "pardiso") == "pardiso"
    return wanted and _mkl() is not None


_NO_MEMORY = -2  # of PARDISO's errors, the only one that is not the matrix's fault


def _pointer(value: int | np.ndarray):
    """How a number or an array is given to a library in C."""
    if isinstance(value, np.ndarray):
        return ctypes.c_void_p(value.ctypes.data)
    return ctypes.byref(ctypes.c_int32(value))


class PardisoCondensation:
    """Intel MKL PARDISO as LDL^T; ``single``: in single precision, half as much to read and write.

    Its Cholesky is a quarter faster, but with a Schur complement it crashes the process, instead of
    reporting, when the tangent is indefinite; LDL^T takes definite and indefinite tangents alike.
    """

    name = "pardiso"

    def __init__(self, pattern: SymmetricPattern, condensed: np.ndarray, single: bool = False):
        self._library = cast(ctypes.CDLL, _mkl())
        self._pattern, self.condensed = pattern, np.asarray(condensed, dtype=np.int64)
        if np.any(np.diff(self.condensed) <= 0):
            raise ValueError("condensed equations must be ascending")
        self._real = np.dtype(np.float32 if single else np.float64)
        self._data = self._dummy = np.zeros(max(pattern.size, pattern.nonzeros), self._real)
        self._ia, self._ja = pattern.indptr + 1, pattern.indices + 1
        self._perm = np.zeros(pattern.size, dtype=np.int32)
        self._perm[self.condensed] = 1
        self._handle, self._parameters = np.zeros(64, np.int64), np.zeros(64, np.int32)
        # own settings; METIS; pivot perturbation; Bunch-Kaufman; two levels; precision; Schur
        # complement with factors
        self._parameters[[0, 1, 9, 20, 23]] = 1, 2, 8, 1, 1
        self._parameters[[27, 35]] = single, 2 * bool(len(self.condensed))
        self._call(11, self._dummy, np.zeros(pattern.size, self._real))

    def _call(self, phase: int, right: np.ndarray, out: np.ndarray) -> int:
        """One phase of PARDISO, of one real symmetric indefinite matrix (-2) and one right-hand
        side, without a report.
        """
        error, size = ctypes.c_int32(0), self._pattern.size
        matrix = size, self._data, self._ia, self._ja, self._perm
        given = self._handle, 1, 1, -2, phase, *matrix, 1, self._parameters, 0, right, out
        self._library.pardiso(*map(_pointer, given), ctypes.byref(error))
        if error.value == _NO_MEMORY:
            raise MemoryError(f"{size} equations are too many for PARDISO")
        return error.value

    def factor(self, data: np.ndarray) -> np.ndarray:
        """Factorise coefficients of the pattern (nonzeros + 1,); returns the Schur complement (nc,
        nc).

        Raises
        ------
        FactorisationError
            Singular to working precision.
        """
        self._data = data.astype(self._real, copy=False)
        nc = len(self.condensed)
        schur = np.zeros((nc, nc), self._real) if nc else self._dummy
        if self._call(22, self._dummy, schur) != 0 or not np.isfinite(schur).all():
            raise FactorisationError("the tangent is singular")
        return schur.astype(float, copy=False) if nc else np.zeros((0, 0))

    def forward(self, right: np.ndarray) -> np.ndarray:
        """Reduced right-hand side (nc,) for the condensed degrees of freedom; keeps the rest for
        :meth:`backward`.
        """
        self._reduced = np.zeros(self._pattern.size, self._real)
        phase = 331 if len(self.condensed) else 33
        self._call(phase, np.array(right, dtype=self._real), self._reduced)
        return self._reduced[self.condensed].astype(float)

    def backward(self, condensed_values: np.ndarray) -> np.ndarray:
        """Full solution (n,) from the condensed part (nc,)."""
        if not len(self.condensed):
            return self._reduced.astype(float)
        reduced = self._reduced.copy()
        reduced[self.condensed] = condensed_values
        out = np.zeros_like(reduced)
        self._call(333, reduced, out)
        return out.astype(float)

    def __del__(self):
        if hasattr(self, "_handle") and not sys.is_finalizing():
            self._call(-1, self._dummy, np.zeros(1, self._real))


class SuperLUCondensation:
    """The same three verbs with scipy's SuperLU, for machines without PARDISO."""

    name = "superlu"

    def __init__(self, pattern: SymmetricPattern, condensed: np.ndarray):
        self._pattern, self.condensed = pattern, np.asarray(condensed, dtype=np.int64)
        self._interior = np.setdiff1d(np.arange(pattern.size), self.condensed)

    def factor(self, data: np.ndarray) -> np.ndarray:
        matrix = self._pattern.matrix(data).tocsc()
        i, c = self._interior, self.condensed
        try:
            self._lu = splu(
                matrix[i][:, i],
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=DIAGONAL,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            raise FactorisationError("the tangent is singular") from error
        self._coupling = matrix[c][:, i]
        schur = matrix[c][:, c].toarray() - self._coupling @ self._lu.solve(
            self._coupling.T.toarray()
        )
        return (schur + schur.T) / 2

    def forward(self, right: np.ndarray) -> np.ndarray:
        self._interior_solution = self._lu.solve(right[self._interior])
        return right[self.condensed] - self._coupling @ self._interior_solution

    def backward(self, condensed_values: np.ndarray) -> np.ndarray:
        out = np.empty(self._pattern.size)
        out[self.condensed] = condensed_values
        out[self._interior] = self._interior_solution - self._lu.solve(
            self._coupling.T @ condensed_values
        )
        return out


class Narrowed:
    """A condensation taken further, onto some of the degrees of freedom (k,) that it condenses
    onto.

    What is done again in every iteration grows with the third power of their number; which ones
    they are may change as often as the contact does, for nothing is factored for it but a dense
    block.
    """

    def __init__(self, solver, condensed: np.ndarray):
        self._solver, self._kept = solver, np.isin(solver.condensed, condensed, assume_unique=True)
        self.schur = np.zeros((0, 0))

    def take(self, schur: np.ndarray) -> bool:
        """Eliminate what is not wanted of the solver's Schur complement (nc, nc), of which
        ``schur`` (k, k) is left.

        False, with nothing done, where that block is not positive definite: then who solves for
        contact must see all of it.
        """
        kept, rest = self._kept, ~self._kept
        if kept.all():
            self.schur = schur
            return True
        try:
            self._factor = cho_factor(schur[np.ix_(rest, rest)], check_finite=False)
        except LinAlgError:
            return False
        coupling = schur[np.ix_(rest, kept)]
        self._answer = cho_solve(self._factor, coupling)
        self.schur = schur[np.ix_(kept, kept)] - coupling.T @ self._answer
        return True

    def forward(self, right: np.ndarray) -> np.ndarray:
        """Reduced right-hand side (k,)."""
        reduced = self._solver.forward(right)
        if self._kept.all():
            return reduced
        rest = reduced[~self._kept]
        self._alone = cho_solve(self._factor, rest)
        return reduced[self._kept] - self._answer.T @ rest

    def backward(self, values: np.ndarray) -> np.ndarray:
        """Full solution (n,) from that of the degrees of freedom kept (k,)."""
        if self._kept.all():
            return self._solver.backward(values)
        condensed = np.empty(len(self._kept))
        condensed[self._kept], condensed[~self._kept] = values, self._alone - self._answer @ values
        return self._solver.backward(condensed)


def condensation(pattern: SymmetricPattern, condensed: np.ndarray, single: bool = False):
    """The best available solver for this pattern, condensing onto the given equations (nc,);
    ``single``: precision will do.
    """
    if pardiso_available():
        return PardisoCondensation(pattern, condensed, single)
    return SuperLUCondensation(pattern, condensed)

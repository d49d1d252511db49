"""A mesh turned into arrays the element loops read: gradients, weights, pressure modes, equations,
pattern.
"""

from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.sparse import csr_matrix

from fingerpad.mechanics.elements import EDGE_POINTS, EDGE_WEIGHTS, ELEMENTS, edge_values
from fingerpad.mechanics.kinematics import PLANE_STRAIN, Kinematics
from fingerpad.mechanics.linear_solver import SymmetricPattern
from fingerpad.specimen.element_kinds import KINDS

DEFAULT_ELEMENT = {name: kind.solved for name, kind in KINDS.items() if kind.solved}


TOGETHER = 32
"""Elements of a block, which go through the element loops side by side: what is worked out of them
fits the nearest memory.
"""


def blocked(values: np.ndarray) -> np.ndarray:
    """Values of elements (ne, ...) in blocks of elements side by side: (blocks, ..., TOGETHER),
    filled up with zeros.
    """
    count = -(-len(values) // TOGETHER)
    filled = np.zeros((count * TOGETHER, *values.shape[1:]))
    filled[: len(values)] = values
    return np.ascontiguousarray(
        np.moveaxis(filled.reshape(count, TOGETHER, *values.shape[1:]), 1, -1)
    )


class Space:
    """Displacement and pressure spaces on one mesh.

    Parameters
    ----------
    points
        (n, 2) m.
    cells
        (ne, nen) in the order of gmsh (6-node triangles are given their bubble node here).
    kind
        "quad9", "quad4" or "tri6".
    element
        Key of ELEMENTS; None = the default for the kind.
    fixed
        (n, 2) bool, prescribed degrees of freedom.
    kinematics
        What the section stands for.

    Attributes
    ----------
    points, cells
        As used (with bubble nodes). weight (ne, nq) m^2 (m^3 of a body of revolution); centres (ne,
        2) m, means of the elements' nodes; psi (ne, nq, nm) pressure modes, orthonormal in the
        weight; equation (n, 2) equation number or -1; size. mesh: what the element loops read, as
        tuple: cells; gradients on the
        reference cell (nen, 2 nq), all along its first coordinate before all along the second; and,
        in blocks of elements (:func:`blocked`), what makes gradients of them (4, nq), 1/m, with 11,
        12, 21, 22 of the inverse Jacobian; of a body of revolution the shape functions after the
        gradients, and 1/R after the Jacobian; weight (nq); pressure modes (nm, nq). sizes: nen, nq,
        nm.

    Raises
    ------
    ValueError
        An element is inverted, beyond the axis of revolution, or the element does not fit the mesh.
    """

    def __init__(
        self, points, cells, kind, fixed, element=None, kinematics: Kinematics = PLANE_STRAIN
    ):
        points, cells = np.asarray(points, float), np.asarray(cells, np.int32)
        fixed = np.asarray(fixed, bool)
        self.element = ELEMENTS[element or DEFAULT_ELEMENT[kind]]
        if kind == "tri6" and self.element.nodes_per_element == 7:
            centroid = -points[cells[:, :3]].sum(1) / 9 + 4 / 9 * points[cells[:, 3:]].sum(1)
            cells = np.column_stack([cells, len(points) + np.arange(len(cells), dtype=np.int32)])
            points = np.vstack([points, centroid])
            fixed = np.vstack([fixed, np.zeros((len(cells), 2), bool)])
        if cells.shape[1] != self.element.nodes_per_element:
            raise ValueError(f"element {self.element.name} does not fit a mesh of {kind}")
        self.points, self.cells, self.fixed = points, cells, fixed
        self.kinematics = kinematics
        x = points[cells]
        (a, b), (c, d) = (
            [along @ x[..., i].T for i in (0, 1)]
            for along in np.moveaxis(self.element.gradients, -1, 0)
        )
        det = (a * d - b * c).T  # of the Jacobian, each of whose components is (nq, ne)
        if det.min() <= 0:
            raise ValueError(f"element {int(det.min(1).argmin())} is inverted")
        self._inverse = np.stack([d.T, -b.T, -c.T, a.T], axis=-1) / det[..., None]
        position = np.stack([x[..., i] @ self.element.values.T for i in (0, 1)], axis=-1)
        area = np.ascontiguousarray(det * self.element.weights)
        self.weight = area * kinematics.measure(position[..., 0])
        if self.weight.min() <= 0:
            raise ValueError(f"element {int(self.weight.min(1).argmin())} is beyond the axis x = 0")
        self.centres = x.mean(1)
        self._span = np.sqrt(area.sum(1))
        modes = self._raw_modes(position)
        gram = (self.weight[..., None] * modes).swapaxes(1, 2) @ modes
        self._orthonormal = np.linalg.inv(np.linalg.cholesky(gram))
        self.psi = np.ascontiguousarray(modes @ self._orthonormal.swapaxes(1, 2))
        reference, inverse = [*np.moveaxis(self.element.gradients, -1, 0)], self._inverse
        if kinematics.round:
            reference.append(self.element.values)
            inverse = np.concatenate([inverse, 1 / position[..., :1]], axis=2)
        columns = np.ascontiguousarray(np.concatenate(reference).T)
        parts = (inverse.swapaxes(1, 2), self.weight, self.psi.swapaxes(1, 2))
        self.mesh = (cells, columns, *map(blocked, parts))
        self.sizes = (cells.shape[1], *self.psi.shape[1:])
        self.equation = np.full(points.shape, -1, dtype=np.int64)
        self.equation[~fixed] = np.arange(np.count_nonzero(~fixed))
        self.size = int(self.equation.max()) + 1

    def _raw_modes(self, position, elements=slice(None)):
        """Pressure modes before orthonormalisation at points (ne, nq, 2) of elements: 1, x, y about
        the centre, or one per point.
        """
        count = self.element.pressure_modes
        if count not in (1, 3):
            return np.broadcast_to(np.eye(count), (len(position), count, count))
        local = (position - self.centres[elements, None]) / self._span[elements, None, None]
        return np.concatenate([np.ones((*local.shape[:2], 1)), local], axis=2)[:, :, :count]

    @cached_property
    def grad(self) -> np.ndarray:
        """Gradients (ne, nq, nen, 2), 1/m, of the shape functions at the quadrature points."""
        inverse = self._inverse.reshape(*self.weight.shape, 2, 2)
        return np.ascontiguousarray(np.einsum("eqij,qaj->eqai", inverse, self.element.gradients))

    @cached_property
    def pattern(self) -> SymmetricPattern:
        return SymmetricPattern(self.cells, self.equation)

    def pressure_modes(self, elements: np.ndarray, points: np.ndarray) -> np.ndarray:
        """Orthonormal pressure modes (n, nm) of ``elements`` (n,) at physical ``points`` (n, 2).

        A pointwise pressure has at a point the value of the nearest quadrature point.
        """
        count = self.element.pressure_modes
        if count not in (1, 3):
            corners = self.points[self.cells[elements]]
            places = np.einsum("qa,nai->nqi", self.element.values, corners)
            nearest = np.sum((places - points[:, None]) ** 2, axis=2).argmin(1)
            own = np.arange(count) == nearest[:, None]
            return np.where(own, self.psi[elements, nearest], 0.0)
        raw = self._raw_modes(points[:, None], elements)[:, 0]
        return np.einsum("na,nba->nb", raw, self._orthonormal[elements])

    def blocks(self, which: np.ndarray) -> np.ndarray:
        """(k, 3): of each block with elements of ``which`` (ne,) bool, its number and the first and
        last + 1 of a run of them.

        Unsigned, which the element loops are compiled for.
        """
        change = np.flatnonzero(np.diff(which, prepend=False, append=False))
        runs = [
            (begin // TOGETHER, begin % TOGETHER, begin % TOGETHER + end - begin)
            for start, stop in change.reshape(-1, 2)
            for begin, end in pairwise(
                sorted({start, stop, *range(-(-start // TOGETHER) * TOGETHER, stop, TOGETHER)})
            )
        ]
        return np.array(runs, dtype=np.uint64).reshape(-1, 3)

    @cached_property
    def all_blocks(self) -> np.ndarray:
        """:meth:`blocks` of all elements."""
        return self.blocks(np.ones(len(self.cells), bool))

    def volume_rates(self) -> csr_matrix:
        """Room for the derivative of the elements' dilatation modes (ne nm) by all displacements (2
        n): nm rows an element, in each all x before all y.
        """
        count, nodes, modes = len(self.cells), self.sizes[0], self.sizes[2]
        columns = 2 * self.cells[:, None, None] + np.arange(2)[:, None]
        columns = np.broadcast_to(columns, (count, modes, 2, nodes)).ravel()
        starts = 2 * nodes * np.arange(count * modes + 1)
        return csr_matrix(
            (np.zeros(columns.size), columns, starts), shape=(count * modes, self.points.size)
        )

    def to_equations(self, field: np.ndarray) -> np.ndarray:
        """Values of a nodal field (n, 2) at the free equations (size,)."""
        return field[~self.fixed]

    def to_nodes(self, vector: np.ndarray) -> np.ndarray:
        """Nodal field (n, 2) with ``vector`` (size,) at the free degrees of freedom and zero
        elsewhere.
        """
        out = np.zeros(self.points.shape)
        out[~self.fixed] = vector
        return out


def edge_load_vectors(
    points: np.ndarray, edges: np.ndarray, kinematics: Kinematics = PLANE_STRAIN
) -> np.ndarray:
    """Nodal vectors (n, 2) of ``int N_a n ds`` over edges (m, 2 or 3; start, end[, middle]) with
    unit outward pressure, times what lies across: all of a ring, of a body of revolution.

    The body lies on the right of start -> end; the vector points out of it. This is the consistent
    nodal load of a uniform pressure of one on the curve as it lies now, so force over it is
    pressure on straight and curved edges alike.
    """
    values, slopes = edge_values(edges.shape[1] - 1, EDGE_POINTS)
    tangent = np.einsum("qa,mai->mqi", slopes, points[edges])
    normal = np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1)
    across = kinematics.measure(np.einsum("qa,ma->mq", values, points[edges, 0]))
    normal = normal * np.broadcast_to(across, normal.shape[:2])[..., None]
    nodal = np.einsum("q,qa,mqi->mai", EDGE_WEIGHTS, values, normal)
    out = np.zeros(points.shape)
    np.add.at(out, edges, nodal)
    return out

"""Exact unilateral contact of points of the skin with a rigid profile, in the condensed (Schur)
system.

No penalty: normal forces at the points are multipliers of ``gap >= 0``. At each Newton iteration
the gap is linearised where the skin and the profile stood before, the profile's own movement is
part of the linear solve, and the resulting mixed linear complementarity problem

    S' du - N^T f + b dd = r,      0 <= f  perpendicular to  gap + N du + n_y dd >= 0,
    sum(-n_y f) = F or dd given

is solved to the end by block principal pivoting (Portugal, Judice and Vicente 1994). ``S'`` is the
Schur complement less the multipliers times the second derivative of the gap. Under force control
the profile's depth is one more unknown.

Friction, when a plan calls for it, has a module of its own on the same condensed quantities;
nothing of it is here.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field, replace
from typing import cast

import numpy as np
from scipy.linalg import eigvalsh_tridiagonal, ldl
from scipy.linalg.lapack import dpotrf, dpotri

from fingerpad.mechanics import kernels


class ContactError(RuntimeError):
    """The complementarity problem has no solution the pivoting could find."""


@dataclass
class Zone:
    """Points of the skin that may touch, and where the degrees of freedom of its nodes sit in the
    condensed system.

    Attributes
    ----------
    nodes
        (nn,) node numbers.
    equation
        (n, 2) equations of all nodes.
    shape
        (nz, nn) values of the nodes' shape functions at the points.
    softness
        (nz, nz) m^2/N, what forces add to the gaps beside what the body yields, and softness_along
        what tangential ones add to the slips.
    condensed
        (nc,) ascending equation numbers.
    """

    nodes: np.ndarray
    equation: np.ndarray
    shape: np.ndarray
    softness: np.ndarray
    softness_along: np.ndarray
    condensed: np.ndarray = field(init=False)

    def __post_init__(self):
        equation = self.equation[self.nodes]
        self.condensed = np.unique(equation[equation >= 0])
        # of each point the columns of its nodes' degrees of freedom, x before y, and the shape
        # functions; none where prescribed
        used = max(int((self.shape != 0).sum(axis=1).max(initial=1)), 1)
        of = np.argsort(self.shape == 0, axis=1, kind="stable")[:, :used]
        free = equation[of] >= 0
        values = np.take_along_axis(self.shape, of, axis=1)
        self._columns = np.where(
            free, np.searchsorted(self.condensed, np.maximum(equation[of], 0)), 0
        )
        self._values = np.where(free, values[:, :, None], 0.0)

    def __len__(self) -> int:
        return len(self.shape)

    def gather(self, directions: np.ndarray) -> np.ndarray:
        """Components along ``directions`` (nz, 2) at the points as a condensed matrix (nz, nc)."""
        return self.along([directions], np.eye(len(self.condensed)))

    def along(self, directions: list[np.ndarray], matrix: np.ndarray) -> np.ndarray:
        """Components along each of the directions (nz, 2) at the points, of the columns (nc, n) of
        a matrix: (nd nz, n).
        """
        out = np.empty((len(directions) * len(self), matrix.shape[1]))
        kernels.at_points(
            self._columns, self._values, np.stack(directions), np.ascontiguousarray(matrix), out
        )
        return out

    def spread(self, forces: np.ndarray) -> np.ndarray:
        """What forces (nz, 2) at the points are on the condensed degrees of freedom (nc,)."""
        return np.bincount(
            self._columns.ravel(),
            (self._values * forces[:, None]).ravel(),
            minlength=len(self.condensed),
        )

    @property
    def movable(self) -> np.ndarray:
        """(nz,) bool: can the point move either way?"""
        return (self._values != 0).any(axis=1).all(axis=1)

    def _chosen(self, rows: np.ndarray) -> Zone:
        """The zone with some of its points (k,), or with some of them twice."""
        out, square = copy(self), np.ix_(rows, rows)
        out.shape, out._columns, out._values = (
            each[rows] for each in (self.shape, self._columns, self._values)
        )
        out.softness, out.softness_along = self.softness[square], self.softness_along[square]
        return out

    def part(self, rows: slice) -> Zone:
        """Some of its points, with the degrees of freedom of their nodes."""
        if rows == slice(0, len(self)):
            return self
        out = self._chosen(np.arange(len(self))[rows])
        used = np.unique(out._columns[out._values != 0])
        out.condensed = self.condensed[used]
        out._columns = np.where(out._values != 0, np.searchsorted(used, out._columns), 0)
        nodes = (out.shape != 0).any(axis=0)
        out.nodes, out.shape = self.nodes[nodes], out.shape[:, nodes]
        return out

    def doubled(self, which: np.ndarray) -> Zone:
        """The zone with a second row for some of its points (k,), after all others."""
        return self._chosen(np.concatenate([np.arange(len(self)), which]))


@dataclass
class Rows:
    """The constraints of a contact problem.

    Attributes
    ----------
    zone
        Whose points are those of the rows.
    place
        (nr,) or slice, where the stepper keeps what belongs to them: by the number of the skin's
        point, and for a second side that many points further on.
    partner
        (nr,) the row of the same point's other side or -1.
    gap
        (nr,) m.
    gradient
        (nr, 2).
    curvature
        (nr,) 1/m.
    """

    zone: Zone
    place: slice | np.ndarray
    partner: np.ndarray
    gap: np.ndarray
    gradient: np.ndarray
    curvature: np.ndarray

    @property
    def points(self) -> int:
        """How many points of the zone they are of."""
        return len(self.gap) - int(np.sum(self.partner >= 0)) // 2

    def of_points(self, values: np.ndarray) -> np.ndarray:
        """Sum (nz, ...) over the rows (nr, ...) of each point."""
        out, second = values[: self.points].copy(), slice(self.points, None)
        out[self.partner[second]] += values[second]
        return out

    def closing(self, force: np.ndarray) -> np.ndarray:
        """(nr,) m, the gaps that forces (nr,) N/m close: with what the zone's softness adds to
        them.
        """
        return self.gap + self.zone.softness @ force


@dataclass
class ContactStep:
    """Solution of one linearised contact problem.

    Attributes
    ----------
    condensed_displacement : (nc,) array
        m.
    depth_change : float
        m, of the profile.
    force : (nr,) array
        N/m, >= 0, along the gap's gradient.
    active : (nr,) bool array
        Which gaps are closed.
    flexible : Flexibility
        What it was found with.
    stiffness : float or None
        N/m^2, of the force against the depth while the same points touch; None if unknown.
    softened : bool
        Part of the gaps' second derivative was left out: the state was not stable with it.
    tangential, state : (nr,) arrays or None
        With friction: forces along the tangents, N/m, and states (-1, 0, 1).
    """

    condensed_displacement: np.ndarray
    depth_change: float
    force: np.ndarray
    active: np.ndarray
    flexible: Flexibility
    stiffness: float | None = None
    softened: bool = False
    tangential: np.ndarray | None = None
    state: np.ndarray | None = None


def _inverse(matrix: np.ndarray) -> tuple[np.ndarray, bool]:
    """The inverse of a symmetric matrix, and whether it is positive definite: by Cholesky if it is,
    LU otherwise.
    """
    if not len(matrix):
        return matrix, True
    # LAPACK reads columns: its upper triangle is the lower one of our rows
    factor, failed = dpotrf(np.ascontiguousarray(matrix).T, lower=0)
    if failed:
        return np.linalg.inv(matrix), False
    lower = np.tril(dpotri(factor, lower=0, overwrite_c=1)[0].T)
    return lower + np.tril(lower, -1).T, True


@dataclass
class Flexibility:
    """How a zone yields once the body has been condensed away.

    Attributes
    ----------
    matrix
        (nc, nc) Schur complement with the geometric term of the gaps.
    inverse
        Of it.
    definite
        Is it positive definite?
    bent
        Is there a geometric term?
    border, corner
        (nc,) and a number: what that term adds where the profile's depth comes in.
    """

    matrix: np.ndarray
    inverse: np.ndarray
    definite: bool
    bent: bool
    border: np.ndarray
    corner: float

    @classmethod
    def of(cls, rows: Rows, schur, previous_force) -> Flexibility:
        """Arguments as in :func:`solve_contact`."""
        bent = previous_force * rows.curvature
        on = bent != 0
        tangent, weight = tangents(rows.gradient), bent[on]
        along = rows.zone.gather(tangent)[on]
        matrix = schur - along.T @ (weight[:, None] * along)
        border, corner = -along.T @ (weight * tangent[on, 1]), -weight @ tangent[on, 1] ** 2
        return cls(matrix, *_inverse(matrix), bool(on.any()), border, float(corner))


@dataclass
class Response:
    """How constraint rows answer to multipliers on them once the body has been condensed away.

    With multipliers ``m`` (nr,) and a change ``dd`` of the profile's depth the rows move by ``free
    + compliance @ m + lever * dd``, what the zone's softness adds included, and the condensed
    degrees of freedom by
    :meth:`displacement`.

    Attributes
    ----------
    compliance
        (nr, nr).
    free, lever
        (nr,).
    corner, load_shift
        The depth's own equation ``load = load_shift - lever @ m + corner * dd``.
    """

    compliance: np.ndarray
    free: np.ndarray
    lever: np.ndarray
    corner: float
    load_shift: float
    _zone: Zone
    _directions: list[np.ndarray]
    _inverse: np.ndarray
    _unloaded: np.ndarray
    _bend: np.ndarray

    def displacement(self, multipliers: np.ndarray, depth_change: float) -> np.ndarray:
        """(nc,) condensed displacement."""
        each = multipliers.reshape(len(self._directions), -1, 1)
        forces = self._zone.spread(np.sum(each * self._directions, axis=0))
        return self._unloaded + self._inverse @ forces - self._bend * depth_change


def respond(
    zone: Zone, flexible: Flexibility, right: np.ndarray, directions: list[np.ndarray]
) -> Response:
    """Response of the zone to forces on its points.

    Parameters
    ----------
    right
        As in :func:`solve_contact`.
    directions
        Of (nz, 2) unit vectors, each giving nz rows: the normals, and the tangents where there is
        friction.
    """
    inverse, border = flexible.inverse, flexible.border
    unloaded, bend, each = inverse @ right, inverse @ border, len(zone)
    compliance = zone.along(directions, zone.along(directions, inverse).T)
    compliance[:each, :each] += zone.softness
    if len(directions) > 1:
        compliance[each:, each:] += zone.softness_along
    free, bent = zone.along(directions, np.column_stack([unloaded, bend])).T
    lever = np.concatenate([direction[:, 1] for direction in directions]) - bent
    corner, load_shift = flexible.corner - float(border @ bend), float(border @ unloaded)
    return Response(
        compliance, free, lever, corner, load_shift, zone, directions, inverse, unloaded, bend
    )


def controlled(
    answer: Response, offset: np.ndarray, force: float | None, depth_change: float | None
) -> tuple[np.ndarray, float | None]:
    """Offsets (nr,) m of the rows without forces, and the load of the depth's own equation; None if
    the depth is given.
    """
    if depth_change is None:
        return offset, cast(float, force) - answer.load_shift
    return offset + answer.lever * depth_change, None


def until_stable(
    attempt: Callable[[Flexibility], ContactStep],
    rows: Rows,
    schur,
    previous_force,
    flexible: Flexibility | None,
) -> ContactStep:
    """What ``attempt`` finds with the ``flexible`` of before if there is one, or else with that of
    now; and as long as that has no stable solution, with less and less of what makes it unstable.
    Arguments as in :func:`solve_contact`.

    Raises
    ------
    ContactError
        Of the attempt, when there is nothing to soften.
    """
    before, softened = flexible, False
    while True:
        flexible = flexible or Flexibility.of(rows, schur, previous_force)
        try:
            step = attempt(flexible)
        except ContactError as error:
            if flexible is not before:
                schur, curvature = _soften(
                    error, schur, rows.curvature, previous_force, flexible.bent
                )
                rows, softened = replace(rows, curvature=curvature), True
            flexible = None
            continue
        step.softened = softened
        return step


def _soften(error, schur, curvature, previous_force, bent) -> tuple[np.ndarray, np.ndarray]:
    """The Schur complement and the curvature to try next when a linearised problem has no stable
    solution.

    ``bent``: did the geometric term take part? Raises ``error`` when there is nothing to soften.
    """
    if not bent:
        lowest = float(np.linalg.eigvalsh(schur)[0])
        if lowest > 0:
            raise error
        # the body itself is not stable here (an element folding under an edge): stiffen it just
        # enough to descend
        return schur - 2 * lowest * np.eye(len(schur)), curvature
    if np.abs(curvature).max() * previous_force.max() > 1e-6 * np.abs(schur).max():
        # too curved for its own load at this linearisation: half of the geometric term is safer and
        # still converges
        return schur, 0.5 * curvature
    return schur, 0 * curvature


def solve_contact(
    rows: Rows,
    schur: np.ndarray,
    right: np.ndarray,
    previous_force: np.ndarray,
    active: np.ndarray,
    *,
    force: float | None = None,
    depth_change: float | None = None,
    flexible: Flexibility | None = None,
) -> ContactStep:
    """Solve the linearised unilateral problem exactly.

    Parameters
    ----------
    rows : Rows
        The constraints.
    schur : (nc, nc) array
        Schur complement, N/m^2.
    right : (nc,) array
        Reduced residual without contact forces, N/m.
    previous_force : (nr,) array
        Forces that weigh the gaps' second derivatives, N/m.
    active : (nr,) bool array
        First guess of the closed gaps.
    force, depth_change : float
        Sum of the vertical forces, N/m, or change of the depth, m: exactly one of them.
    flexible : Flexibility, optional
        Of an iteration before, to be used as long as it leads to a solution.

    Raises
    ------
    ContactError
        Pivoting does not end.
    """

    def attempt(flexible):
        answer = respond(rows.zone, flexible, right, [rows.gradient])
        offset, load = controlled(answer, rows.gap + answer.free, force, depth_change)
        f, found, on = _pivot(answer, offset, load, active)
        dd = found if depth_change is None else depth_change
        require_stable(flexible, answer.compliance, on)
        yields = pressing_stiffness(answer, answer.compliance[np.ix_(on, on)], np.flatnonzero(on))
        return ContactStep(answer.displacement(f, dd), dd, f, on, flexible, yields)

    return until_stable(attempt, rows, schur, previous_force, flexible)


def tangents(gradient: np.ndarray) -> np.ndarray:
    """(n, 2) tangents belonging to gap gradients (n, 2)."""
    return np.column_stack([-gradient[:, 1], gradient[:, 0]])


def pressing_stiffness(
    answer: Response, system: np.ndarray, rows: np.ndarray, share: np.ndarray | None = None
) -> float | None:
    """N/m^2, of the force against the depth while all nodes stay as they are; None where one yields
    to no force.

    Parameters
    ----------
    system
        (k, k) m^2/N compliance of the ``rows`` (k,) that have multipliers of their own.
    share
        (nz,) of the normal ones that the tangential ones, in the second half of the rows, are; None
        where there are no tangential ones.
    """
    if not len(rows):
        return 0.0
    multipliers = np.zeros(len(answer.lever))
    try:
        multipliers[rows] = -np.linalg.solve(system, answer.lever[rows])
    except np.linalg.LinAlgError:
        return None
    if share is not None:
        multipliers[len(share) :] += share * multipliers[: len(share)]
    return float(answer.corner - answer.lever @ multipliers)


def require_stable(flexible: Flexibility, compliance: np.ndarray, active: np.ndarray) -> None:
    """ContactError where gaps bend the matrix so much that it is not :func:`stable`."""
    if flexible.bent and not (flexible.definite or stable(flexible.matrix, compliance, active)):
        raise ContactError("the curved contact is not stable")


def stable(matrix, compliance, active):
    """Is ``matrix`` positive definite on the displacements that keep the active gaps closed?

    By the inertia of the bordered matrix: the active compliance must have as many negative
    eigenvalues as ``matrix``.
    """
    inside = compliance[np.ix_(active, active)]
    return _negative_eigenvalues(matrix) == _negative_eigenvalues((inside + inside.T) / 2)


def _negative_eigenvalues(matrix: np.ndarray) -> int:
    """Their number, of a symmetric matrix: that of D in L D L^T, by Sylvester's law of inertia."""
    if not len(matrix):
        return 0
    d = ldl(matrix)[1]
    return int(np.sum(eigvalsh_tridiagonal(np.diag(d), np.diag(d, 1)) < 0))


def _pivot(answer: Response, offset, load: float | None, active):
    """Forces (nr,), change of the depth and closed gaps (nr,) of the complementarity problem.

    All infeasible points are exchanged at once; if that stops helping, one at a time, which ends if
    the compliance is positive definite, and else may come back to where it was. ``offset``: (nr,)
    m, gaps without forces. ``load``: N/m, of the depth's own equation; None if the depth is given.
    """
    active, compliance, lever = active.copy(), answer.compliance, answer.lever
    by_force = load is not None
    if by_force and not active.any():
        active[np.argmin(offset)] = True
    best, patience = len(active) + 1, 8
    seen: set[bytes] = set()
    scale = max(np.abs(offset).max(), 1e-12)
    for _ in range(40 + 4 * len(active)):
        on = np.flatnonzero(active)
        system, right = np.empty((len(on) + by_force,) * 2), -offset[on]
        system[: len(on), : len(on)] = compliance[np.ix_(on, on)]
        if load is not None:
            system[:-1, -1], system[-1, :-1] = lever[on], -lever[on]
            system[-1, -1], right = answer.corner, np.append(right, load)
        try:
            solution = np.linalg.solve(system, right)
        except np.linalg.LinAlgError as error:
            raise ContactError("the contact compliance is singular") from error
        f, dd = np.zeros(len(offset)), solution[-1] if by_force else 0.0
        f[on] = solution[: len(on)]
        gap = offset + compliance @ f + lever * dd
        wrong = np.where(active, f < -1e-12 * np.abs(f).max(), gap < -1e-11 * scale)
        count = int(wrong.sum())
        if not count:
            f[~active] = 0
            return np.maximum(f, 0), dd, active
        if count < best:
            best, patience = count, 8
            seen.clear()
        elif patience:
            patience -= 1
        elif active.tobytes() in seen:
            break
        else:
            seen.add(active.tobytes())
            wrong[np.flatnonzero(wrong)[:-1]] = False
        flipped = active ^ wrong
        if by_force and not flipped.any():
            flipped[np.argmax(np.where(active, f, -np.inf))] = True
        active = flipped
    raise ContactError("the active set keeps cycling")

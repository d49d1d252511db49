"""Compiled loops: over the elements of the finite-strain body, and in the dense system of contact.

Local degrees of freedom are ordered (all x, all y). With ``c = cof F``, ``C0`` the constant
operator ``d(cof F) = C0 : dF`` of two dimensions, and the law's ``m, t`` and ``f, g, h``
(:class:`fingerpad.laws.Law`), the first Piola-Kirchhoff stress and its derivative are

    P  = m (F - t/(3 J) c) + p c + F H
    dP = (m I + H) dF - (m t/(3 J) - p_lag) C0 : dF
         + f F (F : dF) + g (F (c : dF) + c (F : dF)) + h c (c : dF)                 [isochoric]
         + kappa sum_a psi_a int psi_a c : dF               [dilatation, rank = pressure modes]

so no 4 x 4 tangent is ever formed: a Laplacian, a cross product and a rank-two update do. All of it
is drawn back to the reference cell, whose gradients are the same for all elements, and the loops
are compiled for the sizes of the element they are of. ``H`` is the (symmetric) history stress of
the Prony branches, zero without: one loop, compiled once, serves both. ``p_lag`` is the
pressure the last linear step predicted (mixed integration point; Magisano, Leonetti and Garcea
2017), while the residual keeps the true one.

Elements go through the loops side by side, a block at a time: what is known of a block is stored
with its elements as the last axis, and the innermost loops are over them, as wide as the
processor's vectors are. Only the tangent's matrices are multiplied element by element: there they
are over rows.

Numba keeps what it compiles as long as this file stays as it is. A loop that a law or the sizes of
an element are compiled into has a file of its own, named after them and the law's source.
"""

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace

import numpy as np
from llvmlite import ir
from numba import njit, types
from numba.extending import intrinsic, overload, register_jitable

from fingerpad.compiled import JIT
from fingerpad.laws import Law
from fingerpad.laws.law import isochoric

_JIT = JIT | {"fastmath": {"contract", "nsz", "reassoc", "arcp"}}
_HELPER = _JIT | {"cache": False}
INLINE = _HELPER | {"inline": "always"}
"""For what is short or called element by element: the loops are up to three times as fast."""

_LANES = 8
"""Numbers that a processor's vector may hold: rows are filled up with zeros to a multiple of it."""


@intrinsic
def _bits(context, number):
    """A double's bits as an integer."""
    return types.int64(types.float64), lambda context, builder, signature, given: builder.bitcast(
        given[0], ir.IntType(64)
    )


@intrinsic
def _from_bits(context, number):
    """The double of these bits."""
    return types.float64(types.int64), lambda context, builder, signature, given: builder.bitcast(
        given[0], ir.DoubleType()
    )


_THIRDS = 4.0 / 3.0 * 2.0**52 * (1023.0 - 0.051)
"""Less a third of a number's bits: the bits of its -1/3rd power, which is wrong by 3.4 % at
most.
"""


@overload(isochoric, jit_options=_HELPER, inline="always")
def _isochoric_factor(jac):
    """J^(-2/3) from its exponent, by two steps of fourth order: to two units in the last place, at
    a tenth of a power's cost.
    """

    def factor(jac):
        root = _from_bits(np.int64(_THIRDS - _bits(jac) / 3.0))
        for _ in range(2):
            left = 1.0 - jac * root * root * root
            root += root * left * (1.0 / 3.0 + left * (2.0 / 9.0 + left * (14.0 / 81.0)))
        return root * root

    return factor


@register_jitable(**INLINE)
def four(values, q, k):
    """Components 11, 12, 21, 22 at a point of an element."""
    return values[0, q, k], values[1, q, k], values[2, q, k], values[3, q, k]


@njit(**_JIT)
def at_points(columns, values, directions, matrix, out):
    """Components along ``directions`` (nd, nz, 2) at the points of each column of ``matrix`` (nc,
    n), into ``out`` (nd nz, n).

    ``columns``, ``values`` (nz, nodes, 2): of each point the degrees of freedom of its nodes and
    the shape functions.
    """
    points, wide = len(columns), matrix.shape[1]
    along = np.empty((2, wide))
    for k in range(points):
        for i in range(2):
            for c in range(wide):
                along[i, c] = 0.0
            for a in range(columns.shape[1]):
                value, row = values[k, a, i], matrix[columns[k, a, i]]
                for c in range(wide):
                    along[i, c] += value * row[c]
        for d in range(len(directions)):
            x, y = directions[d, k, 0], directions[d, k, 1]
            for c in range(wide):
                out[d * points + k, c] = x * along[0, c] + y * along[1, c]


@njit(**_JIT)
def exchanged(compliance, share, on, stick, out):
    """How points answer to multipliers of their own: (no + ns, no + ns) into ``out``, a row for
    each multiplier.

    ``compliance`` (2 nz, 2 nz), symmetric, of normal and tangential multipliers; ``on`` (no,)
    points with normal ones, each of which brings a ``share`` (nz,) of it along the tangent;
    ``stick`` (ns,) points with tangential ones.
    """
    points, touching = len(share), len(on)
    for c in range(touching):
        normal, tangential, part = compliance[on[c]], compliance[points + on[c]], share[on[c]]
        for r in range(touching):
            out[c, r] = normal[on[r]] + part * tangential[on[r]]
        for r in range(len(stick)):
            out[c, touching + r] = normal[points + stick[r]] + part * tangential[points + stick[r]]
    for c in range(len(stick)):
        tangential = compliance[points + stick[c]]
        for r in range(touching):
            out[touching + c, r] = tangential[on[r]]
        for r in range(len(stick)):
            out[touching + c, touching + r] = tangential[points + stick[r]]


@njit(**INLINE)
def _add_rows(rows, columns, depth, left, right, row, places, n, data):
    """Add the upper triangle of the product left right to ``data``, from its ``n``-th place on.

    Returns the number of the place after the last.
    """
    for a in range(rows):
        for b in range(right.shape[1]):
            total = 0.0
            for c in range(depth):
                total += left[a, c] * right[c, b]
            row[b] = total
        for b in range(a, columns):
            data[places[n]] += row[b]
            n += 1
    return n


def _named(function: Callable, *parts) -> Callable:
    """The function, with its name followed by what is compiled into it.

    Numba names cache files and symbols after it: loops of another law or element, compiled by
    another process, must not be taken for these.
    """
    function.__qualname__ += "".join(f"_{part}" for part in parts)
    return function


@cache
def loops(law: Law, kinematics, nodes: int, points: int, modes: int) -> SimpleNamespace:
    """The element loops of a law and a :class:`~fingerpad.mechanics.kinematics.Kinematics` for
    elements with so many nodes, quadrature points and pressure modes.

    The formulas of both are compiled into them: assemble_tangent, internal_force, commit and
    energies. In all of them ``mesh`` is
    :attr:`Space.mesh`, ``constants`` (number of constants, ne) are the law's, and ``blocks`` (k, 3)
    says which elements follow it: those of a block, from the first to before the last
    (:meth:`Space.blocks`).
    """
    law_energy, law_stress, law_tangent = law.energy, law.stress, law.tangent
    for formula in (law_energy, law_stress, law_tangent):
        register_jitable(**INLINE)(formula)
    deformed, invariant, stressed = kinematics.deformed, kinematics.invariant, kinematics.stressed
    green, isochoric_stress = kinematics.green, kinematics.isochoric
    spring, answered, fill_rows = kinematics.spring, kinematics.answered, kinematics.rows
    columns, parts = kinematics.columns, 3 + kinematics.columns
    numbers = kinematics.moduli
    wide_x, wide_y = (-(-width // _LANES) * _LANES for width in (2 * nodes, nodes))

    def helper(function):
        return register_jitable(**_HELPER)(_named(function, kinematics.name, nodes, points, modes))

    @helper
    def deform(u, mesh, block, first, last, local, drawn, f):
        """Deformation gradient 11, 12, 21, 22, its determinant and, in a body of revolution, 33
        at the points of elements of a block, into ``f`` (5 or 6, nq, ...). Returns the smallest
        determinant.
        """
        cells, reference, inverses = mesh[0], mesh[1], mesh[2]
        start, inverse = block * np.uint64(f.shape[2]), inverses[block]
        for k in range(first, last):
            for a in range(nodes):
                local[0, a, k] = u[cells[start + k, a], 0]
                local[1, a, k] = u[cells[start + k, a], 1]
        for i in range(2):
            for c in range(columns * points):
                for k in range(first, last):
                    total = 0.0
                    for a in range(nodes):
                        total += local[i, a, k] * reference[a, c]
                    drawn[i, c, k] = total
        smallest = np.inf
        for q in range(points):
            low = np.inf
            for k in range(first, last):
                low = min(low, deformed(inverse, drawn, points, q, k, f))
            smallest = min(smallest, low)
        return smallest

    @helper
    def project(mesh, block, first, last, f, volume, dilatation, theta, lag):
        """Dilatation modes of ``f`` into ``theta`` (nm, ...) and ``volume`` (ne, nm); those of
        ``dilatation`` (ne, nm), which may be the same array, into ``lag`` (nm, ...).
        """
        weight, psi, start = mesh[3][block], mesh[4][block], block * np.uint64(f.shape[2])
        for m in range(modes):
            for k in range(first, last):
                total = 0.0
                for q in range(points):
                    total += weight[q, k] * psi[m, q, k] * (f[4, q, k] - 1.0)
                theta[m, k] = total
        for m in range(modes):
            for k in range(first, last):
                volume[start + k, m] = theta[m, k]
            for k in range(first, last):
                lag[m, k] = dilatation[start + k, m]

    @helper
    def to_nodes(reference, first, last, drawn, local):
        """What stresses ``drawn`` (2, 2 or 3 nq, ...) back to the reference cell are worth at its
        nodes: ``local`` (2, nen, ...).
        """
        for i in range(2):
            for a in range(nodes):
                for k in range(first, last):
                    total = 0.0
                    for c in range(columns * points):
                        total += drawn[i, c, k] * reference[a, c]
                    local[i, a, k] = total

    @helper
    def add(cells, start, first, last, local, force):
        """Add forces ``local`` (2, nen, ...) on their nodes to the nodal ``force`` (n, 2)."""
        for k in range(first, last):
            for a in range(nodes):
                force[cells[start + k, a], 0] += local[0, a, k]
                force[cells[start + k, a], 1] += local[1, a, k]

    def assemble_tangent(
        u,
        mesh,
        mu,
        kappa,
        constants,
        blocks,
        dilatation,
        volume,
        history,
        factor,
        pointwise,
        force,
        scatter,
        data,
        rates,
    ):
        """Tangent (scattered into CSR ``data``) and internal force at displacement ``u``, its
        pressures being of its volume.

        Shapes: u (n, 2); mu, kappa (ne,); dilatation (ne, nm) of the pressures in the geometric
        part; volume (ne, nm), filled with the dilatation of ``u``, which may be the same array;
        history (blocks, 4, nq, together) second Piola-Kirchhoff 11, 22, 12, 33; factor: share of
        the isochoric stress that answers at once; pointwise (ne,): extra volumetric modulus that is
        not projected; force (n, 2), accumulated; scatter (ne, nd(nd+1)/2) positions in ``data``
        (last one: discarded); rates (ne, nm, 2, nen), filled with the derivative of ``volume``.
        Returns the smallest det F.
        """
        cells, reference, inverses, weights, all_psi = mesh
        together = weights.shape[2]
        turned = np.ascontiguousarray(reference.T)
        # of every point the stress, cof F and the moduli, all drawn back to the reference cell
        both = 2 * columns
        local = np.empty((2, nodes, together))
        found = np.empty((2 * both + numbers, points, together))
        drawn = found[:both].reshape(2, columns * points, together)
        cofactor, moduli = found[both : 2 * both], found[2 * both :]
        f, theta = np.empty((parts, points, together)), np.empty((modes, together))
        lag, answer, part = (
            np.empty((modes, together)),
            np.empty((6, together)),
            np.empty((2, columns * points, together)),
        )
        modal, own = np.empty((modes, 2, nodes, together)), np.empty((numbers, points))
        # K = left^T right: the gradients of the virtual displacements, x and y, below them their
        # dilatation modes, and along x what lies across; and how stresses answer to all degrees of
        # freedom, the second time only to those along y
        left = np.empty((2, nodes, columns * points + modes))
        for a in range(nodes):  # by loops: numba takes seconds to compile a broadcast
            for q in range(2 * points):
                left[0, a, q] = left[1, a, q] = reference[a, q]
            for q in range(2 * points, columns * points):
                left[0, a, modes + q] = reference[a, q]
        right_x, right_y = (
            np.zeros((columns * points + modes, wide_x)),
            np.zeros((2 * points + modes, wide_y)),
        )
        row = np.empty(wide_x)
        smallest = np.inf
        for block, first, last in blocks:
            start = block * np.uint64(together)
            inverse, weight, psi = inverses[block], weights[block], all_psi[block]
            past = history[block]
            smallest = min(smallest, deform(u, mesh, block, first, last, local, drawn, f))
            if smallest <= 0.0:
                return smallest
            project(mesh, block, first, last, f, volume, dilatation, theta, lag)
            for q in range(points):
                for k in range(first, last):
                    e, jac = start + k, f[4, q, k]
                    p = plag = 0.0
                    for m in range(modes):
                        p += psi[m, q, k] * theta[m, k]
                        plag += psi[m, q, k] * lag[m, k]
                    mod, t, fold, alpha, beta = law_tangent(
                        invariant(f, q, k), jac, factor * mu[e], constants[:, e]
                    )
                    s = mod * t / (3.0 * jac)
                    p = kappa[e] * p - s
                    cross = kappa[e] * plag - s
                    extra = pointwise[e] * (jac - 1.0)
                    p += extra
                    cross += extra
                    beta += pointwise[e]
                    answer[0, k], answer[1, k], answer[2, k] = mod, p, cross
                    answer[3, k], answer[4, k], answer[5, k] = fold, alpha, beta
                for k in range(first, last):
                    answered(f, inverse, weight[q, k], past, answer, q, k, found)
            to_nodes(reference, first, last, drawn, local)
            add(cells, start, first, last, local, force)
            for m in range(modes):
                for i in range(2):
                    for c in range(columns):
                        for q in range(points):
                            for k in range(first, last):
                                part[i, c * points + q, k] = (
                                    psi[m, q, k] * cofactor[i * columns + c, q, k]
                                )
                to_nodes(reference, first, last, part, modal[m])
            for k in range(first, last):
                e = start + k
                for d in range(numbers):
                    for q in range(points):
                        own[d, q] = moduli[d, q, k]
                for q in range(points):
                    fill_rows(own, turned, q, points, modes, right_x, right_y)
                for m in range(modes):
                    for a in range(nodes):
                        x, y = modal[m, 0, a, k], modal[m, 1, a, k]
                        left[0, a, 2 * points + m] = x
                        left[1, a, 2 * points + m] = y
                        right_x[2 * points + m, a] = kappa[e] * x
                        right_x[2 * points + m, nodes + a] = kappa[e] * y
                        right_y[2 * points + m, a] = kappa[e] * y
                        rates[e, m, 0, a], rates[e, m, 1, a] = x, y
                rows, depth, places = cells.shape[1], 2 * points + modes, scatter[e]
                deep = columns * points + modes
                n = _add_rows(rows, 2 * nodes, deep, left[0], right_x, row, places, 0, data)
                _add_rows(rows, nodes, depth, left[1], right_y, row, places, n, data)
        return smallest

    def internal_force(
        u, mesh, mu, kappa, constants, blocks, dilatation, volume, history, factor, pointwise, force
    ):
        """Internal force (n, 2) of the pressures kappa times ``dilatation`` (ne, nm), accumulated
        in ``force``.

        Fills ``volume`` (ne, nm), the dilatation of ``u``; it may be the same array, then pressures
        are of it. Returns the smallest det F.
        """
        cells, reference, inverses, weights, all_psi = mesh
        together = weights.shape[2]
        local, drawn = np.empty((2, nodes, together)), np.empty((2, columns * points, together))
        f, theta = np.empty((parts, points, together)), np.empty((modes, together))
        smallest = np.inf
        for block, first, last in blocks:
            start = block * np.uint64(together)
            inverse, weight, psi = inverses[block], weights[block], all_psi[block]
            past = history[block]
            smallest = min(smallest, deform(u, mesh, block, first, last, local, drawn, f))
            if smallest <= 0.0:
                return smallest
            project(mesh, block, first, last, f, volume, dilatation, theta, theta)
            for q in range(points):
                for k in range(first, last):
                    e, jac = start + k, f[4, q, k]
                    p = 0.0
                    for m in range(modes):
                        p += psi[m, q, k] * theta[m, k]
                    i1 = invariant(f, q, k)
                    mod, t = law_stress(i1, jac, factor * mu[e], constants[:, e])
                    p = kappa[e] * p - mod * t / (3.0 * jac) + pointwise[e] * (jac - 1.0)
                    stressed(f, inverse, weight[q, k], past, mod, p, q, k, points, drawn)
            to_nodes(reference, first, last, drawn, local)
            add(cells, start, first, last, local, force)
        return smallest

    def commit(
        u,
        mesh,
        mu,
        constants,
        blocks,
        decay,
        gain,
        branches,
        stress,
        stretch,
        new_branches,
        new_stress,
        new_stretch,
    ):
        """Branch stresses, isochoric stress and C (11, 22, 12, 33) after a step, into the new.

        Shapes: branches (nb, blocks, 4, nq, together); stress and stretch (blocks, 4, nq,
        together). ``decay``, ``gain`` (nb,) of the step; ``mu`` (ne,) long-term moduli. Returns the
        work done on the branches, by the trapezoidal rule, J/m.
        """
        weights = mesh[3]
        together = weights.shape[2]
        local, drawn = np.empty((2, nodes, together)), np.empty((2, columns * points, together))
        f, now = np.empty((parts, points, together)), np.empty((8, together))
        work = 0.0
        for block, first, last in blocks:
            start, weight = block * np.uint64(together), weights[block]
            deform(u, mesh, block, first, last, local, drawn, f)
            for q in range(points):
                for k in range(first, last):
                    e, i1 = start + k, green(f, q, k, now)
                    mod, t = law_stress(i1, f[4, q, k], mu[e], constants[:, e])
                    isochoric_stress(f, q, k, i1, mod, t, now)
                for c in range(4):
                    # the mean of a branch's stress before and after, times the way: 12 counts
                    # twice, and C is twice E
                    share = 0.5 if c == 2 else 0.25
                    for b in range(len(decay)):
                        for k in range(first, last):
                            new_branches[b, block, c, q, k] = decay[b] * branches[
                                b, block, c, q, k
                            ] + gain[b] * (now[c, k] - stress[block, c, q, k])
                        for k in range(first, last):
                            way = share * weight[q, k] * (now[4 + c, k] - stretch[block, c, q, k])
                            work += (
                                branches[b, block, c, q, k] + new_branches[b, block, c, q, k]
                            ) * way
                    for k in range(first, last):
                        new_stress[block, c, q, k] = now[c, k]
                        new_stretch[block, c, q, k] = now[4 + c, k]
        return work

    def energies(u, mesh, mu, constants, blocks, pointwise, beta, branches):
        """Energy of the network's change of shape and that of the Maxwell springs, tau_i : tau_i /
        (4 beta_i mu), J/m.

        ``beta`` (nb,) and ``branches`` (nb, blocks, 4, nq, together): none without viscoelasticity.
        """
        weights = mesh[3]
        together = weights.shape[2]
        local, drawn = np.empty((2, nodes, together)), np.empty((2, columns * points, together))
        f = np.empty((parts, points, together))
        network = springs = 0.0
        for block, first, last in blocks:
            start, weight = block * np.uint64(together), weights[block]
            deform(u, mesh, block, first, last, local, drawn, f)
            for q in range(points):
                for k in range(first, last):
                    e, jac, w = start + k, f[4, q, k], weight[q, k]
                    i1 = invariant(f, q, k)
                    network += w * law_energy(i1, jac, mu[e], constants[:, e])
                    network += 0.5 * w * pointwise[e] * (jac - 1.0) ** 2
                for b in range(len(beta)):
                    for k in range(first, last):
                        square = spring(f, q, k, branches[b, block])
                        springs += weight[q, k] * square / (4.0 * beta[b] * mu[start + k])
        return network, springs

    every = (assemble_tangent, internal_force, commit, energies)
    # A law of this package is kept, named after its source, so that an edited one is compiled
    # again. A law from outside is not kept: what its functions call is not in the name.
    kept = _JIT["cache"] and law.stress.__module__.startswith("fingerpad.")
    compiled = njit(**_JIT | {"cache": kept})
    of_formulas = law.name, law.source[:16], kinematics.name, kinematics.source[:16]
    sizes = *of_formulas, nodes, points, modes
    return SimpleNamespace(**{loop.__name__: compiled(_named(loop, *sizes)) for loop in every})

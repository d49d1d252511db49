"""Compiled loops: over the elements of the finite-strain body, and in the dense system of contact.

Local degrees of freedom are ordered (all x, all y). With ``c = cof F``, ``C0`` the constant operator ``d(cof F) = C0 : dF`` of
two dimensions, and the law's ``m, t`` and ``f, g, h`` (:class:`fingerpad.laws.Law`), the first Piola-Kirchhoff stress and its
derivative are

    P  = m (F - t/(3 J) c) + p c + F H
    dP = (m I + H) dF - (m t/(3 J) - p_lag) C0 : dF
         + f F (F : dF) + g (F (c : dF) + c (F : dF)) + h c (c : dF)                 [isochoric]
         + kappa sum_a psi_a int psi_a c : dF                                        [dilatation, rank = pressure modes]

so no 4 x 4 tangent is ever formed: a Laplacian, a cross product and a rank-two update do. All of it is drawn back to the
reference cell, whose gradients are the same for all elements, and the loops are compiled for the sizes of the element they are
of, so that their innermost ones are vectors of the processor. ``H`` is the (symmetric) history stress of the Prony branches;
passing ``None`` compiles a kernel in which it does not exist. ``p_lag`` is the pressure the last linear step predicted (mixed
integration point; Magisano, Leonetti and Garcea 2017), while the residual keeps the true one.

All functions live in this one module, for what is kept of them on disk (:mod:`compiled`, through which they are called) knows of
changes of this file and of the laws' alone.
"""

from functools import cache
from types import SimpleNamespace

import numpy as np
from numba import njit
from numba.extending import register_jitable

from fingerpad.laws import Law

_JIT = {"fastmath": {"contract", "nsz", "reassoc", "arcp"}, "error_model": "numpy", "boundscheck": False}
_INLINE = _JIT | {"inline": "always"}

_LANES = 8
"""Numbers that a processor's vector may hold: rows are filled up with zeros to a multiple of it."""


@njit(**_INLINE)
def _deform(u, cell, reference, inverse, local, drawn, f):
    """Deformation gradient 11, 12, 21, 22 and its determinant at the points of one element, into ``f`` (5, nq).

    ``cell`` (nen,), ``reference`` (nen, 2 nq) and ``inverse`` (4, nq) as in :attr:`Space.mesh`; ``local`` (2, nen) and ``drawn``
    (2, 2 nq) are for the displacements and their gradients on the reference cell. Returns the smallest determinant.
    """
    nodes, points = local.shape[1], f.shape[1]
    for a in range(nodes):
        local[0, a] = u[cell[a], 0]
        local[1, a] = u[cell[a], 1]
    for c in range(drawn.shape[1]):
        x = y = 0.0
        for a in range(nodes):
            x += local[0, a] * reference[a, c]
            y += local[1, a] * reference[a, c]
        drawn[0, c] = x
        drawn[1, c] = y
    smallest = np.inf
    for q in range(points):
        f[0, q] = 1.0 + inverse[0, q] * drawn[0, q] + inverse[1, q] * drawn[0, points + q]
        f[1, q] = inverse[2, q] * drawn[0, q] + inverse[3, q] * drawn[0, points + q]
        f[2, q] = inverse[0, q] * drawn[1, q] + inverse[1, q] * drawn[1, points + q]
        f[3, q] = 1.0 + inverse[2, q] * drawn[1, q] + inverse[3, q] * drawn[1, points + q]
        f[4, q] = f[0, q] * f[3, q] - f[1, q] * f[2, q]
        smallest = min(smallest, f[4, q])
    return smallest


@njit(**_INLINE)
def _rest(force, cell, reference, drawn):
    """Add to the nodal ``force`` (n, 2) what stresses ``drawn`` (2, 2 nq) back to the reference cell are worth there."""
    for a in range(len(cell)):
        x = y = 0.0
        for c in range(drawn.shape[1]):
            x += drawn[0, c] * reference[a, c]
            y += drawn[1, c] * reference[a, c]
        force[cell[a], 0] += x
        force[cell[a], 1] += y


@njit(**_INLINE)
def _project(weight, modes, f, theta):
    """Dilatation modes ``theta`` (nm,) of one element with weight (nq,), modes (nm, nq) and ``f`` (5, nq)."""
    for m in range(len(theta)):
        total = 0.0
        for q in range(f.shape[1]):
            total += weight[q] * modes[m, q] * (f[4, q] - 1.0)
        theta[m] = total


@njit(**_INLINE)
def _isochoric(mod, t, i1, c11, c22, c12, jac):
    """Isochoric second Piola-Kirchhoff stress m (I - t/3 C^-1), free of mean: 11, 22, 12, 33."""
    s = t / (3.0 * jac * jac)
    return mod * (1.0 - s * c22), mod * (1.0 - s * c11), mod * s * c12, mod * ((1.0 - t / 3.0) + (t - i1))


@njit(**_INLINE)
def _spring(f11, f12, f21, f22, s11, s22, s12, t33):
    """tau : tau of the pushed-forward deviatoric stress of a branch."""
    a11 = f11 * s11 + f12 * s12
    a12 = f11 * s12 + f12 * s22
    a21 = f21 * s11 + f22 * s12
    a22 = f21 * s12 + f22 * s22
    t11 = a11 * f11 + a12 * f12
    t22 = a21 * f21 + a22 * f22
    t12 = a11 * f21 + a12 * f22
    mean = (t11 + t22 + t33) / 3.0
    return (t11 - mean) ** 2 + (t22 - mean) ** 2 + (t33 - mean) ** 2 + 2.0 * t12 * t12


@njit(**_JIT)
def bend(matrix, columns, values, direction, weight):
    """Take ``weight`` (nz,) times the square of the points' displacement along ``direction`` (nz, 2) off a matrix (nc, nc).

    ``columns``, ``values`` (nz, nodes, 2): of each point the degrees of freedom of its nodes and the shape functions.
    """
    for k in range(len(weight)):
        if weight[k] == 0.0:
            continue
        for a in range(columns.shape[1]):
            for i in range(2):
                here = weight[k] * values[k, a, i] * direction[k, i]
                for b in range(columns.shape[1]):
                    for j in range(2):
                        matrix[columns[k, a, i], columns[k, b, j]] -= here * values[k, b, j] * direction[k, j]


@njit(**_JIT)
def mirror(matrix):
    """Fill the upper triangle with the lower one."""
    for i in range(len(matrix)):
        for j in range(i):
            matrix[j, i] = matrix[i, j]


@njit(**_JIT)
def at_points(columns, values, directions, matrix, out):
    """Components along ``directions`` (nd, nz, 2) at the points of each column of ``matrix`` (nc, n), into ``out`` (nd nz, n).

    ``columns`` and ``values`` as of :func:`bend`.
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
    """How points answer to multipliers of their own: (no + ns, no + ns), column by column into ``out``.

    ``compliance`` (2 nz, 2 nz), symmetric, of normal and tangential multipliers; ``on`` (no,) points with normal ones, each of
    which brings a ``share`` (nz,) of it along the tangent; ``stick`` (ns,) points with tangential ones.
    """
    points, touching = len(share), len(on)
    for c in range(touching):
        normal, tangential, part = compliance[on[c]], compliance[points + on[c]], share[on[c]]
        for r in range(touching):
            out[r, c] = normal[on[r]] + part * tangential[on[r]]
        for r in range(len(stick)):
            out[touching + r, c] = normal[points + stick[r]] + part * tangential[points + stick[r]]
    for c in range(len(stick)):
        tangential = compliance[points + stick[c]]
        for r in range(touching):
            out[r, touching + c] = tangential[on[r]]
        for r in range(len(stick)):
            out[touching + r, touching + c] = tangential[points + stick[r]]


@cache
def dilatation_loop(nodes: int, points: int, modes: int):
    """The loop that predicts dilatations, for elements of these sizes."""

    @njit(**_JIT)
    def predict_dilatation(u, du, mesh, out):
        """Linear prediction ``int psi_a (J - 1 + cof F : grad du)`` of the dilatation modes, into ``out`` (ne, nm)."""
        cells, reference, inverse, weight, psi = mesh
        local, drawn, f, d = np.empty((2, nodes)), np.empty((2, 2 * points)), np.empty((5, points)), np.empty((5, points))
        for e in range(len(cells)):
            _deform(u, cells[e], reference, inverse[e], local, drawn, f)
            _deform(du, cells[e], reference, inverse[e], local, drawn, d)
            for q in range(points):
                d11, d22 = d[0, q] - 1.0, d[3, q] - 1.0
                f[4, q] += f[3, q] * d11 - f[2, q] * d[1, q] - f[1, q] * d[2, q] + f[0, q] * d22
            _project(weight[e], psi[e], f, out[e])

    return predict_dilatation


@cache
def loops(law: Law, nodes: int, points: int, modes: int) -> SimpleNamespace:
    """The element loops of a law for elements with so many nodes, quadrature points and pressure modes.

    The law's formulas are compiled into them: assemble_tangent, internal_force, commit and energies. In all of them ``mesh`` is
    :attr:`Space.mesh`, ``constants`` (ne, number of constants) are the law's, and ``only`` (ne,) bool says which elements follow
    it.
    """
    law_energy, law_stress, law_tangent = law.energy, law.stress, law.tangent
    for formula in (law_energy, law_stress, law_tangent):
        register_jitable(inline="always")(formula)
    wide_x, wide_y = (-(-width // _LANES) * _LANES for width in (2 * nodes, nodes))

    @njit(**_JIT)
    def assemble_tangent(u, mesh, mu, kappa, constants, only, dilatation_lag, history, factor, pointwise, scatter, data, force):
        """Tangent (scattered into CSR ``data``) and internal force at displacement ``u``.

        Shapes: u (n, 2); mu, kappa (ne,); dilatation_lag (ne, nm); history (ne, nq, 3) second Piola-Kirchhoff 11, 22, 12, or
        None; factor: share of the isochoric stress that answers at once; pointwise (ne,): extra volumetric modulus that is not
        projected, or None; scatter (ne, nd(nd+1)/2) positions in ``data`` (last one: discarded); force (n, 2), accumulated.
        Returns the smallest det F.
        """
        cells, reference, inverse, weight, psi = mesh
        turned = np.ascontiguousarray(reference.T)
        local, drawn, f, theta = np.empty((2, nodes)), np.empty((2, 2 * points)), np.empty((5, points)), np.empty(modes)
        cofactor, moduli, part = np.empty((2, 2 * points)), np.empty((10, points)), np.empty((2, 2 * points))
        # K = left^T right: the gradients of the virtual displacements, x and y, and below them their dilatation modes; and how
        # stresses answer to all degrees of freedom, the second time only to those along y
        left = np.empty((2, nodes, 2 * points + modes))
        left[:, :, : 2 * points] = reference
        right_x, right_y = np.zeros((2 * points + modes, wide_x)), np.zeros((2 * points + modes, wide_y))
        row = np.empty(wide_x)
        smallest = np.inf
        for e in range(len(cells)):
            if not only[e]:
                continue
            smallest = min(smallest, _deform(u, cells[e], reference, inverse[e], local, drawn, f))
            if smallest <= 0.0:
                return smallest
            _project(weight[e], psi[e], f, theta)
            for q in range(points):
                w = weight[e, q]
                f11, f12, f21, f22, jac = f[0, q], f[1, q], f[2, q], f[3, q], f[4, q]
                p = plag = 0.0
                for m in range(modes):
                    p += psi[e, m, q] * theta[m]
                    plag += psi[e, m, q] * dilatation_lag[e, m]
                i1 = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0
                mod, t, fold, alpha, beta = law_tangent(i1, jac, factor * mu[e], constants[e])
                s = mod * t / (3.0 * jac)
                p = kappa[e] * p - s
                cross = kappa[e] * plag - s
                if pointwise is not None:
                    extra = pointwise[e] * (jac - 1.0)
                    p += extra
                    cross += extra
                    beta += pointwise[e]
                l11 = l22 = mod
                l12 = 0.0
                if history is not None:
                    l11 += history[e, q, 0]
                    l22 += history[e, q, 1]
                    l12 += history[e, q, 2]
                i11, i12, i21, i22 = inverse[e, 0, q], inverse[e, 1, q], inverse[e, 2, q], inverse[e, 3, q]
                # rows of F, its cofactor and (m I + H) J^-T on the reference cell
                fx1, fx2 = f11 * i11 + f12 * i21, f11 * i12 + f12 * i22
                fy1, fy2 = f21 * i11 + f22 * i21, f21 * i12 + f22 * i22
                cx1, cx2 = f22 * i11 - f21 * i21, f22 * i12 - f21 * i22
                cy1, cy2 = f11 * i21 - f12 * i11, f11 * i22 - f12 * i12
                n11, n12 = w * (l11 * i11 + l12 * i21), w * (l11 * i12 + l12 * i22)
                n21, n22 = w * (l12 * i11 + l22 * i21), w * (l12 * i12 + l22 * i22)
                drawn[0, q] = f11 * n11 + f12 * n21 + w * p * cx1
                drawn[0, points + q] = f11 * n12 + f12 * n22 + w * p * cx2
                drawn[1, q] = f21 * n11 + f22 * n21 + w * p * cy1
                drawn[1, points + q] = f21 * n12 + f22 * n22 + w * p * cy2
                cofactor[0, q] = w * cx1
                cofactor[0, points + q] = w * cx2
                cofactor[1, q] = w * cy1
                cofactor[1, points + q] = w * cy2
                fold *= w
                alpha *= w
                beta *= w
                cross *= w * (i11 * i22 - i12 * i21)
                ax1, ax2 = alpha * cx1 + fold * fx1, alpha * cx2 + fold * fx2
                ay1, ay2 = alpha * cy1 + fold * fy1, alpha * cy2 + fold * fy2
                bx1, bx2 = alpha * fx1 + beta * cx1, alpha * fx2 + beta * cx2
                by1, by2 = alpha * fy1 + beta * cy1, alpha * fy2 + beta * cy2
                lap11, lap12, lap22 = i11 * n11 + i21 * n21, i11 * n12 + i21 * n22, i12 * n12 + i22 * n22
                moduli[0, q] = lap11 + fx1 * ax1 + cx1 * bx1
                moduli[1, q] = lap12 + fx1 * ax2 + cx1 * bx2
                moduli[2, q] = lap22 + fx2 * ax2 + cx2 * bx2
                moduli[3, q] = fx1 * ay1 + cx1 * by1
                moduli[4, q] = fx1 * ay2 + cx1 * by2 + cross
                moduli[5, q] = fx2 * ay1 + cx2 * by1 - cross
                moduli[6, q] = fx2 * ay2 + cx2 * by2
                moduli[7, q] = lap11 + fy1 * ay1 + cy1 * by1
                moduli[8, q] = lap12 + fy1 * ay2 + cy1 * by2
                moduli[9, q] = lap22 + fy2 * ay2 + cy2 * by2
            for q in range(points):
                for b in range(cells.shape[1]):
                    d1, d2 = turned[q, b], turned[points + q, b]
                    right_x[q, b] = moduli[0, q] * d1 + moduli[1, q] * d2
                    right_x[points + q, b] = moduli[1, q] * d1 + moduli[2, q] * d2
                    right_x[q, nodes + b] = moduli[3, q] * d1 + moduli[4, q] * d2
                    right_x[points + q, nodes + b] = moduli[5, q] * d1 + moduli[6, q] * d2
                    right_y[q, b] = moduli[7, q] * d1 + moduli[8, q] * d2
                    right_y[points + q, b] = moduli[8, q] * d1 + moduli[9, q] * d2
            for m in range(modes):
                for q in range(points):
                    part[0, q] = psi[e, m, q] * cofactor[0, q]
                    part[0, points + q] = psi[e, m, q] * cofactor[0, points + q]
                    part[1, q] = psi[e, m, q] * cofactor[1, q]
                    part[1, points + q] = psi[e, m, q] * cofactor[1, points + q]
                for a in range(cells.shape[1]):
                    x = y = 0.0
                    for c in range(2 * points):
                        x += part[0, c] * reference[a, c]
                        y += part[1, c] * reference[a, c]
                    left[0, a, 2 * points + m] = x
                    left[1, a, 2 * points + m] = y
                    right_x[2 * points + m, a] = kappa[e] * x
                    right_x[2 * points + m, nodes + a] = kappa[e] * y
                    right_y[2 * points + m, a] = kappa[e] * y
            n = 0
            for a in range(cells.shape[1]):
                for b in range(right_x.shape[1]):
                    total = 0.0
                    for c in range(2 * points + modes):
                        total += left[0, a, c] * right_x[c, b]
                    row[b] = total
                for b in range(a, 2 * nodes):
                    data[scatter[e, n]] += row[b]
                    n += 1
            for a in range(cells.shape[1]):
                for b in range(right_y.shape[1]):
                    total = 0.0
                    for c in range(2 * points + modes):
                        total += left[1, a, c] * right_y[c, b]
                    row[b] = total
                for b in range(a, nodes):
                    data[scatter[e, n]] += row[b]
                    n += 1
            _rest(force, cells[e], reference, drawn)
        return smallest

    @njit(**_JIT)
    def internal_force(u, mesh, mu, kappa, constants, only, history, factor, pointwise, force, dilatation):
        """Internal force (n, 2), accumulated in ``force``; fills ``dilatation`` (ne, nm). Returns the smallest det F."""
        cells, reference, inverse, weight, psi = mesh
        local, drawn, f = np.empty((2, nodes)), np.empty((2, 2 * points)), np.empty((5, points))
        smallest = np.inf
        for e in range(len(cells)):
            if not only[e]:
                continue
            smallest = min(smallest, _deform(u, cells[e], reference, inverse[e], local, drawn, f))
            if smallest <= 0.0:
                return smallest
            _project(weight[e], psi[e], f, dilatation[e])
            for q in range(points):
                f11, f12, f21, f22, jac = f[0, q], f[1, q], f[2, q], f[3, q], f[4, q]
                p = 0.0
                for m in range(modes):
                    p += psi[e, m, q] * dilatation[e, m]
                i1 = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0
                mod, t = law_stress(i1, jac, factor * mu[e], constants[e])
                p = kappa[e] * p - mod * t / (3.0 * jac)
                if pointwise is not None:
                    p += pointwise[e] * (jac - 1.0)
                l11 = l22 = mod
                l12 = 0.0
                if history is not None:
                    l11 += history[e, q, 0]
                    l22 += history[e, q, 1]
                    l12 += history[e, q, 2]
                p11, p12 = f11 * l11 + f12 * l12 + p * f22, f11 * l12 + f12 * l22 - p * f21
                p21, p22 = f21 * l11 + f22 * l12 - p * f12, f21 * l12 + f22 * l22 + p * f11
                w = weight[e, q]
                i11, i12, i21, i22 = w * inverse[e, 0, q], w * inverse[e, 1, q], w * inverse[e, 2, q], w * inverse[e, 3, q]
                drawn[0, q] = p11 * i11 + p12 * i21
                drawn[0, points + q] = p11 * i12 + p12 * i22
                drawn[1, q] = p21 * i11 + p22 * i21
                drawn[1, points + q] = p21 * i12 + p22 * i22
            _rest(force, cells[e], reference, drawn)
        return smallest

    @njit(**_JIT)
    def commit(u, mesh, mu, constants, only, decay, gain, branches, stress, stretch, new_branches, new_stress, new_stretch):
        """Branch stresses (nb, ne, nq, 4), isochoric stress (ne, nq, 4) and C 11, 22, 12 (ne, nq, 3) after a step, into the new.

        ``decay``, ``gain`` (nb,) of the step; ``mu`` (ne,) long-term moduli. Returns the work done on the branches, by the
        trapezoidal rule, J/m.
        """
        cells, reference, inverse, weight, _ = mesh
        local, drawn, f = np.empty((2, nodes)), np.empty((2, 2 * points)), np.empty((5, points))
        change = np.empty(4)
        work = 0.0
        for e in range(len(cells)):
            if not only[e]:
                continue
            _deform(u, cells[e], reference, inverse[e], local, drawn, f)
            for q in range(points):
                f11, f12, f21, f22, jac = f[0, q], f[1, q], f[2, q], f[3, q], f[4, q]
                c11, c22, c12 = f11 * f11 + f21 * f21, f12 * f12 + f22 * f22, f11 * f12 + f21 * f22
                i1 = c11 + c22 + 1.0
                mod, t = law_stress(i1, jac, mu[e], constants[e])
                s11, s22, s12, s33 = _isochoric(mod, t, i1, c11, c22, c12, jac)
                change[0], change[1] = s11 - stress[e, q, 0], s22 - stress[e, q, 1]
                change[2], change[3] = s12 - stress[e, q, 2], s33 - stress[e, q, 3]
                new_stress[e, q, 0], new_stress[e, q, 1], new_stress[e, q, 2], new_stress[e, q, 3] = s11, s22, s12, s33
                m11 = m22 = m12 = 0.0
                for b in range(len(decay)):
                    for c in range(4):
                        new_branches[b, e, q, c] = decay[b] * branches[b, e, q, c] + gain[b] * change[c]
                    m11 += branches[b, e, q, 0] + new_branches[b, e, q, 0]
                    m22 += branches[b, e, q, 1] + new_branches[b, e, q, 1]
                    m12 += branches[b, e, q, 2] + new_branches[b, e, q, 2]
                done = m11 * (c11 - stretch[e, q, 0]) + m22 * (c22 - stretch[e, q, 1]) + 2.0 * m12 * (c12 - stretch[e, q, 2])
                work += 0.25 * weight[e, q] * done
                new_stretch[e, q, 0], new_stretch[e, q, 1], new_stretch[e, q, 2] = c11, c22, c12
        return work

    @njit(**_JIT)
    def energies(u, mesh, mu, kappa, constants, only, pointwise, dilatation, beta, branches):
        """Energy of the network and that of the Maxwell springs, tau_i : tau_i / (4 beta_i mu), J/m.

        ``dilatation`` (ne, nm) modes; ``beta`` (nb,) and ``branches`` (nb, ne, nq, 4), None without.
        """
        cells, reference, inverse, weight, _ = mesh
        local, drawn, f = np.empty((2, nodes)), np.empty((2, 2 * points)), np.empty((5, points))
        network = springs = 0.0
        for e in range(len(cells)):
            if not only[e]:
                continue
            _deform(u, cells[e], reference, inverse[e], local, drawn, f)
            for m in range(modes):
                network += 0.5 * kappa[e] * dilatation[e, m] ** 2
            for q in range(points):
                f11, f12, f21, f22, jac = f[0, q], f[1, q], f[2, q], f[3, q], f[4, q]
                i1 = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0
                network += weight[e, q] * law_energy(i1, jac, mu[e], constants[e])
                if pointwise is not None:
                    network += 0.5 * weight[e, q] * pointwise[e] * (jac - 1.0) ** 2
                if branches is not None:
                    for b in range(len(beta)):
                        s11, s22, s12, s33 = (
                            branches[b, e, q, 0],
                            branches[b, e, q, 1],
                            branches[b, e, q, 2],
                            branches[b, e, q, 3],
                        )
                        springs += weight[e, q] * _spring(f11, f12, f21, f22, s11, s22, s12, s33) / (4.0 * beta[b] * mu[e])
        return network, springs

    return SimpleNamespace(assemble_tangent=assemble_tangent, internal_force=internal_force, commit=commit, energies=energies)


@cache
def stress_loop(law: Law):
    """The loop that gives a law's stress at points with gradients of their own."""
    law_stress = law.stress
    register_jitable(inline="always")(law_stress)

    @njit(**_JIT)
    def isochoric_stress(u, cells, grad, mu, constants, only, out):
        """Isochoric second Piola-Kirchhoff stress 11, 22, 12, 33 into ``out`` (np, 4) where only (np,) says so.

        Shapes: u (n, 2); cells (np, nen); grad (np, nen, 2); mu (np,).
        """
        for e in range(len(cells)):
            if not only[e]:
                continue
            f11 = f22 = 1.0
            f12 = f21 = 0.0
            for a in range(cells.shape[1]):
                x, y = u[cells[e, a], 0], u[cells[e, a], 1]
                f11 += x * grad[e, a, 0]
                f12 += x * grad[e, a, 1]
                f21 += y * grad[e, a, 0]
                f22 += y * grad[e, a, 1]
            c11, c22, c12 = f11 * f11 + f21 * f21, f12 * f12 + f22 * f22, f11 * f12 + f21 * f22
            i1, jac = c11 + c22 + 1.0, f11 * f22 - f12 * f21
            mod, t = law_stress(i1, jac, mu[e], constants[e])
            out[e, 0], out[e, 1], out[e, 2], out[e, 3] = _isochoric(mod, t, i1, c11, c22, c12, jac)

    return isochoric_stress

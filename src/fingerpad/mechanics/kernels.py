"""Compiled element loops of the finite-strain body.

Local degrees of freedom are ordered (all x, all y). With ``c = cof F``, ``C0`` the constant operator ``d(cof F) = C0 : dF`` of
two dimensions, and the law's ``m, t`` and ``f, g, h`` (:class:`fingerpad.laws.Law`), the first Piola-Kirchhoff stress and its
derivative are

    P  = m (F - t/(3 J) c) + p c + F H
    dP = (m I + H) dF - (m t/(3 J) - p_lag) C0 : dF
         + f F (F : dF) + g (F (c : dF) + c (F : dF)) + h c (c : dF)                 [isochoric]
         + kappa sum_a psi_a int psi_a c : dF                                        [dilatation, rank = pressure modes]

so no 4 x 4 tangent is ever formed: a Laplacian, a cross product and a rank-two update do. ``H`` is the (symmetric) history
stress of the Prony branches; passing ``None`` compiles a kernel in which it does not exist. ``p_lag`` is the pressure the last
linear step predicted (mixed integration point; Magisano, Leonetti and Garcea 2017), while the residual keeps the true one.

All functions live in this one module because the on-disk cache of compiled code notices only changes of its own file; what it
must know of the laws' files is in the loops' closures.
"""

from functools import cache
from types import SimpleNamespace

import numpy as np
from numba import njit
from numba.extending import register_jitable

from fingerpad.laws import Law

_JIT = {"cache": True, "fastmath": {"contract", "nsz", "reassoc", "arcp"}, "error_model": "numpy", "boundscheck": False}


@njit(**_JIT)
def _gradient(field, nodes, slopes):
    """Gradient (11, 12, 21, 22) of a nodal field (n, 2) at one quadrature point with slopes (nen, 2)."""
    g11 = g12 = g21 = g22 = 0.0
    for a in range(len(nodes)):
        x = field[nodes[a], 0]
        y = field[nodes[a], 1]
        g11 += x * slopes[a, 0]
        g12 += x * slopes[a, 1]
        g21 += y * slopes[a, 0]
        g22 += y * slopes[a, 1]
    return g11, g12, g21, g22


@njit(**_JIT)
def _dilatation(u, nodes, slopes, weight, psi, f, theta):
    """Deformation gradients ``f`` (nq, 4) and dilatation modes ``theta`` (nm,) of one element; returns its smallest det F."""
    smallest = np.inf
    for m in range(len(theta)):
        theta[m] = 0.0
    for q in range(len(weight)):
        g11, g12, g21, g22 = _gradient(u, nodes, slopes[q])
        f[q, 0] = 1.0 + g11
        f[q, 1] = g12
        f[q, 2] = g21
        f[q, 3] = 1.0 + g22
        jac = f[q, 0] * f[q, 3] - g12 * g21
        smallest = min(smallest, jac)
        for m in range(len(theta)):
            theta[m] += weight[q] * psi[q, m] * (jac - 1.0)
    return smallest


@njit(**_JIT)
def predict_dilatation(u, du, conn, grad, weight, psi, out):
    """Linear prediction ``int psi_a (J - 1 + cof F : grad du)`` of the dilatation modes, into ``out`` (ne, nm)."""
    ne, nen = conn.shape
    nq = weight.shape[1]
    nm = psi.shape[2]
    for e in range(ne):
        for m in range(nm):
            out[e, m] = 0.0
        for q in range(nq):
            f11, f12, f21, f22 = _gradient(u, conn[e], grad[e, q])
            f11 += 1.0
            f22 += 1.0
            d11, d12, d21, d22 = _gradient(du, conn[e], grad[e, q])
            value = f11 * f22 - f12 * f21 - 1.0 + f22 * d11 - f21 * d12 - f12 * d21 + f11 * d22
            for m in range(nm):
                out[e, m] += weight[e, q] * psi[e, q, m] * value


@njit(**_JIT)
def deformation_gradient(u, conn, grad, out):
    """F into ``out`` (ne, nq, 2, 2)."""
    ne, nen = conn.shape
    nq = grad.shape[1]
    for e in range(ne):
        for q in range(nq):
            f11, f12, f21, f22 = _gradient(u, conn[e], grad[e, q])
            out[e, q, 0, 0] = 1.0 + f11
            out[e, q, 0, 1] = f12
            out[e, q, 1, 0] = f21
            out[e, q, 1, 1] = 1.0 + f22


@njit(**_JIT)
def commit_branches(u, conn, grad, weight, decay, gain, stress, before, last, stretch, q, now):
    """Branch stresses ``q`` (nb, ne, nq, 4) after a step to ``stress`` (ne, nq, 4), from those ``before`` it.

    ``decay``, ``gain`` (nb,) of the step; ``last`` (ne, nq, 4) stress and ``stretch`` (ne, nq, 3) C 11, 22, 12 before it, those
    after it into ``now``. Returns the work done on the branches, by the trapezoidal rule, J/m.
    """
    work = 0.0
    for e in range(len(conn)):
        for p in range(weight.shape[1]):
            g11, g12, g21, g22 = _gradient(u, conn[e], grad[e, p])
            g11 += 1.0
            g22 += 1.0
            now[e, p, 0] = g11 * g11 + g21 * g21
            now[e, p, 1] = g12 * g12 + g22 * g22
            now[e, p, 2] = g11 * g12 + g21 * g22
            m11 = m22 = m12 = 0.0
            for b in range(len(decay)):
                for c in range(4):
                    q[b, e, p, c] = decay[b] * before[b, e, p, c] + gain[b] * (stress[e, p, c] - last[e, p, c])
                m11 += before[b, e, p, 0] + q[b, e, p, 0]
                m22 += before[b, e, p, 1] + q[b, e, p, 1]
                m12 += before[b, e, p, 2] + q[b, e, p, 2]
            change = m11 * (now[e, p, 0] - stretch[e, p, 0]) + m22 * (now[e, p, 1] - stretch[e, p, 1])
            work += 0.25 * weight[e, p] * (change + 2.0 * m12 * (now[e, p, 2] - stretch[e, p, 2]))
    return work


@njit(**_JIT)
def spring_energy(u, conn, grad, weight, mu, beta, q):
    """Energy of the Maxwell springs, tau_i : tau_i / (4 beta_i mu) of the pushed-forward deviatoric branch stress, J/m."""
    energy = 0.0
    for e in range(len(conn)):
        for p in range(weight.shape[1]):
            f11, f12, f21, f22 = _gradient(u, conn[e], grad[e, p])
            f11 += 1.0
            f22 += 1.0
            for b in range(len(beta)):
                s11, s22, s12, t33 = q[b, e, p, 0], q[b, e, p, 1], q[b, e, p, 2], q[b, e, p, 3]
                a11 = f11 * s11 + f12 * s12
                a12 = f11 * s12 + f12 * s22
                a21 = f21 * s11 + f22 * s12
                a22 = f21 * s12 + f22 * s22
                t11 = a11 * f11 + a12 * f12
                t22 = a21 * f21 + a22 * f22
                t12 = a11 * f21 + a12 * f22
                mean = (t11 + t22 + t33) / 3.0
                square = (t11 - mean) ** 2 + (t22 - mean) ** 2 + (t33 - mean) ** 2 + 2.0 * t12 * t12
                energy += weight[e, p] * square / (4.0 * beta[b] * mu[e])
    return energy


@cache
def loops(law: Law) -> SimpleNamespace:
    """The element loops of a law, its formulas compiled into them: assemble_tangent, internal_force and isochoric_stress.

    In all of them ``constants`` (ne, number of constants) are the law's, and ``only`` (ne,) bool says which elements follow it.
    """
    law_stress, law_tangent, curved, law_source = law.stress, law.tangent, not law.bilinear, law.source
    for formula in (law_stress, law_tangent):
        register_jitable(inline="always")(formula)
    jit = _JIT | {"cache": law.stress.__module__.startswith("fingerpad.")}

    @njit(**jit)
    def assemble_tangent(
        u, conn, grad, weight, psi, mu, kappa, constants, only, dilatation_lag, history, factor, pointwise, scatter, data, force
    ):
        """Tangent (scattered into CSR ``data``) and internal force at displacement ``u``.

        Shapes: u (n, 2); conn (ne, nen); grad (ne, nq, nen, 2); weight (ne, nq); psi (ne, nq, nm), orthonormal pressure modes;
        mu, kappa (ne,); dilatation_lag (ne, nm); history (ne, nq, 3) second Piola-Kirchhoff 11, 22, 12, or None; factor: share
        of the isochoric stress that answers at once; pointwise (ne,): extra volumetric modulus that is not projected, or None;
        scatter (ne, nd(nd+1)/2) positions in ``data`` (last one: discarded); force (n, 2), accumulated. Returns the smallest
        det F.
        """
        law_source  # noqa: B018 - only in the closure: it is what tells the cache on disk that a law has been edited
        ne, nen = conn.shape
        nq = weight.shape[1]
        nm = psi.shape[2]
        nd = 2 * nen
        smallest = np.inf
        k = np.empty((nd, nd))
        fv = np.empty(nd)
        cv = np.empty(nd)
        av = np.empty(nd)
        bv = np.empty(nd)
        g = np.empty((nm, nd))
        re = np.empty(nd)
        ff = np.empty((nq, 4))
        theta = np.empty(nm)
        for e in range(ne):
            if not only[e]:
                continue
            for i in range(nd):
                re[i] = 0.0
                for j in range(nd):
                    k[i, j] = 0.0
            for m in range(nm):
                for i in range(nd):
                    g[m, i] = 0.0
            smallest = min(smallest, _dilatation(u, conn[e], grad[e], weight[e], psi[e], ff, theta))
            if smallest <= 0.0:
                return smallest
            for q in range(nq):
                w = weight[e, q]
                f11 = ff[q, 0]
                f12 = ff[q, 1]
                f21 = ff[q, 2]
                f22 = ff[q, 3]
                jac = f11 * f22 - f12 * f21
                p = 0.0
                plag = 0.0
                for m in range(nm):
                    p += psi[e, q, m] * theta[m]
                    plag += psi[e, q, m] * dilatation_lag[e, m]
                p *= kappa[e]
                plag *= kappa[e]
                i1 = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0
                mod, t, fold, alpha, beta = law_tangent(i1, jac, factor * mu[e], constants[e])
                s = mod * t / (3.0 * jac)
                l11 = mod
                l22 = mod
                l12 = 0.0
                p11 = mod * f11 + (p - s) * f22
                p12 = mod * f12 - (p - s) * f21
                p21 = mod * f21 - (p - s) * f12
                p22 = mod * f22 + (p - s) * f11
                if history is not None:
                    h11 = history[e, q, 0]
                    h22 = history[e, q, 1]
                    h12 = history[e, q, 2]
                    l11 += h11
                    l22 += h22
                    l12 += h12
                    p11 += f11 * h11 + f12 * h12
                    p12 += f11 * h12 + f12 * h22
                    p21 += f21 * h11 + f22 * h12
                    p22 += f21 * h12 + f22 * h22
                fold *= w
                alpha *= w
                beta *= w
                cross = (plag - s) * w
                if pointwise is not None:
                    extra = pointwise[e] * (jac - 1.0)
                    p11 += extra * f22
                    p12 -= extra * f21
                    p21 -= extra * f12
                    p22 += extra * f11
                    beta += pointwise[e] * w
                    cross += extra * w
                for a in range(nen):
                    gx = grad[e, q, a, 0]
                    gy = grad[e, q, a, 1]
                    fv[a] = f11 * gx + f12 * gy
                    fv[nen + a] = f21 * gx + f22 * gy
                    cv[a] = f22 * gx - f21 * gy
                    cv[nen + a] = f11 * gy - f12 * gx
                    re[a] += w * (p11 * gx + p12 * gy)
                    re[nen + a] += w * (p21 * gx + p22 * gy)
                for i in range(nd):
                    av[i] = alpha * cv[i]
                    bv[i] = alpha * fv[i] + beta * cv[i]
                if curved:
                    for i in range(nd):
                        av[i] += fold * fv[i]
                for m in range(nm):
                    wm = w * psi[e, q, m]
                    for i in range(nd):
                        g[m, i] += wm * cv[i]
                for i in range(nd):
                    ci = cv[i]
                    fi = fv[i]
                    for j in range(i, nd):
                        k[i, j] += ci * bv[j] + fi * av[j]
                for a in range(nen):
                    gx = grad[e, q, a, 0]
                    gy = grad[e, q, a, 1]
                    lx = w * (l11 * gx + l12 * gy)
                    ly = w * (l12 * gx + l22 * gy)
                    gx *= cross
                    gy *= cross
                    for b in range(a, nen):
                        lap = lx * grad[e, q, b, 0] + ly * grad[e, q, b, 1]
                        k[a, b] += lap
                        k[nen + a, nen + b] += lap
                    for b in range(nen):
                        k[a, nen + b] += gx * grad[e, q, b, 1] - gy * grad[e, q, b, 0]
            for m in range(nm):
                for i in range(nd):
                    ci = kappa[e] * g[m, i]
                    for j in range(i, nd):
                        k[i, j] += ci * g[m, j]
            n = 0
            for i in range(nd):
                for j in range(i, nd):
                    data[scatter[e, n]] += k[i, j]
                    n += 1
            for a in range(nen):
                force[conn[e, a], 0] += re[a]
                force[conn[e, a], 1] += re[nen + a]
        return smallest

    @njit(**jit)
    def internal_force(u, conn, grad, weight, psi, mu, kappa, constants, only, history, factor, pointwise, force, dilatation):
        """Internal force (n, 2), accumulated in ``force``; fills ``dilatation`` (ne, nm). Returns the smallest det F."""
        law_source  # noqa: B018 - only in the closure: it is what tells the cache on disk that a law has been edited
        ne, nen = conn.shape
        nq = weight.shape[1]
        nm = psi.shape[2]
        smallest = np.inf
        ff = np.empty((nq, 4))
        rx = np.empty(nen)
        ry = np.empty(nen)
        for e in range(ne):
            if not only[e]:
                continue
            for a in range(nen):
                rx[a] = 0.0
                ry[a] = 0.0
            smallest = min(smallest, _dilatation(u, conn[e], grad[e], weight[e], psi[e], ff, dilatation[e]))
            if smallest <= 0.0:
                return smallest
            for q in range(nq):
                w = weight[e, q]
                f11 = ff[q, 0]
                f12 = ff[q, 1]
                f21 = ff[q, 2]
                f22 = ff[q, 3]
                jac = f11 * f22 - f12 * f21
                p = 0.0
                for m in range(nm):
                    p += psi[e, q, m] * dilatation[e, m]
                i1 = f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0
                mod, t = law_stress(i1, jac, factor * mu[e], constants[e])
                s = kappa[e] * p - mod * t / (3.0 * jac)
                if pointwise is not None:
                    s += pointwise[e] * (jac - 1.0)
                p11 = mod * f11 + s * f22
                p12 = mod * f12 - s * f21
                p21 = mod * f21 - s * f12
                p22 = mod * f22 + s * f11
                if history is not None:
                    h11 = history[e, q, 0]
                    h22 = history[e, q, 1]
                    h12 = history[e, q, 2]
                    p11 += f11 * h11 + f12 * h12
                    p12 += f11 * h12 + f12 * h22
                    p21 += f21 * h11 + f22 * h12
                    p22 += f21 * h12 + f22 * h22
                p11 *= w
                p12 *= w
                p21 *= w
                p22 *= w
                for a in range(nen):
                    gx = grad[e, q, a, 0]
                    gy = grad[e, q, a, 1]
                    rx[a] += p11 * gx + p12 * gy
                    ry[a] += p21 * gx + p22 * gy
            for a in range(nen):
                force[conn[e, a], 0] += rx[a]
                force[conn[e, a], 1] += ry[a]
        return smallest

    @njit(**jit)
    def isochoric_stress(u, conn, grad, mu, constants, only, out):
        """Isochoric second Piola-Kirchhoff stress m (I - t/3 C^-1), free of mean: 11, 22, 12, 33 into ``out`` (ne, nq, 4)."""
        law_source  # noqa: B018 - only in the closure: it is what tells the cache on disk that a law has been edited
        ne, nen = conn.shape
        nq = grad.shape[1]
        for e in range(ne):
            if not only[e]:
                continue
            for q in range(nq):
                f11, f12, f21, f22 = _gradient(u, conn[e], grad[e, q])
                f11 += 1.0
                f22 += 1.0
                jac = f11 * f22 - f12 * f21
                c11 = f11 * f11 + f21 * f21
                c22 = f12 * f12 + f22 * f22
                c12 = f11 * f12 + f21 * f22
                i1 = c11 + c22 + 1.0
                mod, t = law_stress(i1, jac, mu[e], constants[e])
                s = t / (3.0 * jac * jac)
                out[e, q, 0] = mod * (1.0 - s * c22)
                out[e, q, 1] = mod * (1.0 - s * c11)
                out[e, q, 2] = mod * s * c12
                out[e, q, 3] = mod * ((1.0 - t / 3.0) + (t - i1))

    return SimpleNamespace(assemble_tangent=assemble_tangent, internal_force=internal_force, isochoric_stress=isochoric_stress)

"""What a meshed section stands for: a body that goes on for ever across it, or one of revolution.

Everything in which the two differ is here: the measure of volume (a length of one across, or 2 pi
R), the stretch across the section, and what it adds to the formulas at a point that are compiled
into the element loops (:mod:`fingerpad.mechanics.kernels`). In a body of revolution about x = 0

    F33 = 1 + u_r / R,        J = F33 det F2,        c = cof F:  c2 = F33 cof F2,  c33 = det F2

with R and u_r at the points themselves: near incompressibility a radius from elsewhere diverges.
On the axis u_r / R is its limit, du_r/dR; quadrature points lie beside it. Forces are of the whole
ring, N, where those of plane strain are N/m; energies J, not J/m.

A formula takes the arrays of a block of elements and the place (q, k) of a point in them; ``f`` (5
or 6, nq, ...) is F 11, 12, 21, 22, J and F33. Of a force on the reference cell ``found`` has along
x, then along y: by the gradient's two components, and in a body of revolution by the value.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numba.extending import register_jitable

from fingerpad.mechanics.kernels import INLINE, four


@dataclass(frozen=True)
class Kinematics:
    """Of a section.

    Attributes
    ----------
    name
        "plane_strain" or "axisymmetric".
    columns
        Of the reference matrix, for each point: the gradient's two and, where there is a hoop
        stretch, the value.
    deformed, invariant, green, isochoric, spring, stressed, answered, rows
        The formulas of the element loops.
    force_unit, energy_unit
        Of forces and energies.
    """

    name: str
    columns: int
    deformed: Callable
    invariant: Callable
    green: Callable
    isochoric: Callable
    spring: Callable
    stressed: Callable
    answered: Callable
    rows: Callable
    force_unit: str
    energy_unit: str

    @property
    def round(self) -> bool:
        """Whether the section is turned about x = 0."""
        return self.columns > 2

    @property
    def moduli(self) -> int:
        """Numbers that tie a stress at a point to the displacement."""
        return 15 if self.round else 10

    @cached_property
    def source(self) -> str:
        """Digest of the formulas: compiled loops are kept for as long as it stays."""
        return hashlib.sha256(Path(__file__).read_bytes()).hexdigest()

    def measure(self, x: np.ndarray) -> np.ndarray | float:
        """Length (...) m of what lies across the section at ``x`` (...) m; of plane strain one."""
        return 2 * np.pi * x if self.round else 1.0

    def hoop(self, lateral: np.ndarray, x: np.ndarray, slope: np.ndarray) -> np.ndarray:
        """F33 - 1 (n,) at points at ``x`` (n,) m that move by ``lateral`` (n,) m, with its
        ``slope`` (n,) along x.
        """
        if not self.round:
            return np.zeros(len(x))
        on_axis = np.abs(x) < 1e-9 * np.abs(x).max(initial=1e-300)
        return np.where(on_axis, slope, lateral / np.where(on_axis, 1.0, x))


@register_jitable(**INLINE)
def _plane_deformed(inverse, drawn, points, q, k, f):
    i11, i12, i21, i22 = four(inverse, q, k)
    x1, x2 = drawn[0, q, k], drawn[0, points + q, k]
    y1, y2 = drawn[1, q, k], drawn[1, points + q, k]
    f11, f12 = 1.0 + i11 * x1 + i12 * x2, i21 * x1 + i22 * x2
    f21, f22 = i11 * y1 + i12 * y2, 1.0 + i21 * y1 + i22 * y2
    jac = f11 * f22 - f12 * f21
    f[0, q, k], f[1, q, k], f[2, q, k], f[3, q, k], f[4, q, k] = f11, f12, f21, f22, jac
    return jac


@register_jitable(**INLINE)
def _plane_invariant(f, q, k):
    f11, f12, f21, f22 = four(f, q, k)
    return f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + 1.0


@register_jitable(**INLINE)
def _plane_green(f, q, k, now):
    """C 11, 22, 12, 33 into ``now[4:]``; returns its trace."""
    f11, f12, f21, f22 = four(f, q, k)
    c11, c22 = f11 * f11 + f21 * f21, f12 * f12 + f22 * f22
    c12 = f11 * f12 + f21 * f22
    now[4, k], now[5, k], now[6, k], now[7, k] = c11, c22, c12, 1.0
    return c11 + c22 + 1.0


@register_jitable(**INLINE)
def _plane_isochoric(f, q, k, i1, mod, t, now):
    """The law's second Piola-Kirchhoff stress 11, 22, 12, 33 into ``now[:4]``, beside its C."""
    jac, c11, c22, c12 = f[4, q, k], now[4, k], now[5, k], now[6, k]
    s = t / (3.0 * jac * jac)
    now[0, k], now[1, k] = mod * (1.0 - s * c22), mod * (1.0 - s * c11)
    now[2, k], now[3, k] = mod * s * c12, mod * ((1.0 - t / 3.0) + (t - i1))


@register_jitable(**INLINE)
def _turned(f, q, k, stress):
    """F S F^T 11, 22, 12 in the section, and S33."""
    f11, f12, f21, f22 = four(f, q, k)
    s11, s22, s12, s33 = four(stress, q, k)
    a11 = f11 * s11 + f12 * s12
    a12 = f11 * s12 + f12 * s22
    a21 = f21 * s11 + f22 * s12
    a22 = f21 * s12 + f22 * s22
    return a11 * f11 + a12 * f12, a21 * f21 + a22 * f22, a11 * f21 + a12 * f22, s33


@register_jitable(**INLINE)
def _square(t11, t22, t12, t33):
    mean = (t11 + t22 + t33) / 3.0
    return (t11 - mean) ** 2 + (t22 - mean) ** 2 + (t33 - mean) ** 2 + 2.0 * t12 * t12


@register_jitable(**INLINE)
def _plane_spring(f, q, k, stress):
    """tau : tau of the pushed-forward deviatoric stress (4, nq, ...) of a branch."""
    t11, t22, t12, t33 = _turned(f, q, k, stress)
    return _square(t11, t22, t12, t33)


@register_jitable(**INLINE)
def _plane_stressed(f, inverse, w, past, mod, p, q, k, points, drawn):
    """The stress m F + p cof F + F H, with its weight and drawn back, into ``drawn``."""
    f11, f12, f21, f22 = four(f, q, k)
    l11, l22, l12 = mod + past[0, q, k], mod + past[1, q, k], past[2, q, k]
    p11, p12 = f11 * l11 + f12 * l12 + p * f22, f11 * l12 + f12 * l22 - p * f21
    p21, p22 = f21 * l11 + f22 * l12 - p * f12, f21 * l12 + f22 * l22 + p * f11
    i11, i12, i21, i22 = four(inverse, q, k)
    drawn[0, q, k] = w * (p11 * i11 + p12 * i21)
    drawn[0, points + q, k] = w * (p11 * i12 + p12 * i22)
    drawn[1, q, k] = w * (p21 * i11 + p22 * i21)
    drawn[1, points + q, k] = w * (p21 * i12 + p22 * i22)


@register_jitable(**INLINE)
def _plane_answered(f, inverse, w, past, answer, q, k, found):
    """The stress, cof F and the moduli, with their weights and drawn back, into ``found``."""
    f11, f12, f21, f22 = four(f, q, k)
    mod, p, cross = answer[0, k], answer[1, k], answer[2, k]
    fold, alpha, beta = answer[3, k], answer[4, k], answer[5, k]
    l11, l22, l12 = mod + past[0, q, k], mod + past[1, q, k], past[2, q, k]
    i11, i12, i21, i22 = four(inverse, q, k)
    # rows of F, its cofactor and (m I + H) J^-T on the reference cell
    fx1, fx2 = f11 * i11 + f12 * i21, f11 * i12 + f12 * i22
    fy1, fy2 = f21 * i11 + f22 * i21, f21 * i12 + f22 * i22
    cx1, cx2 = f22 * i11 - f21 * i21, f22 * i12 - f21 * i22
    cy1, cy2 = f11 * i21 - f12 * i11, f11 * i22 - f12 * i12
    n11, n12 = w * (l11 * i11 + l12 * i21), w * (l11 * i12 + l12 * i22)
    n21, n22 = w * (l12 * i11 + l22 * i21), w * (l12 * i12 + l22 * i22)
    found[0, q, k] = f11 * n11 + f12 * n21 + w * p * cx1
    found[1, q, k] = f11 * n12 + f12 * n22 + w * p * cx2
    found[2, q, k] = f21 * n11 + f22 * n21 + w * p * cy1
    found[3, q, k] = f21 * n12 + f22 * n22 + w * p * cy2
    found[4, q, k], found[5, q, k] = w * cx1, w * cx2
    found[6, q, k], found[7, q, k] = w * cy1, w * cy2
    fold *= w
    alpha *= w
    beta *= w
    cross *= w * (i11 * i22 - i12 * i21)
    ax1, ax2 = alpha * cx1 + fold * fx1, alpha * cx2 + fold * fx2
    ay1, ay2 = alpha * cy1 + fold * fy1, alpha * cy2 + fold * fy2
    bx1, bx2 = alpha * fx1 + beta * cx1, alpha * fx2 + beta * cx2
    by1, by2 = alpha * fy1 + beta * cy1, alpha * fy2 + beta * cy2
    lap11 = i11 * n11 + i21 * n21
    lap12 = i11 * n12 + i21 * n22
    lap22 = i12 * n12 + i22 * n22
    found[8, q, k] = lap11 + fx1 * ax1 + cx1 * bx1
    found[9, q, k] = lap12 + fx1 * ax2 + cx1 * bx2
    found[10, q, k] = lap22 + fx2 * ax2 + cx2 * bx2
    found[11, q, k] = fx1 * ay1 + cx1 * by1
    found[12, q, k] = fx1 * ay2 + cx1 * by2 + cross
    found[13, q, k] = fx2 * ay1 + cx2 * by1 - cross
    found[14, q, k] = fx2 * ay2 + cx2 * by2
    found[15, q, k] = lap11 + fy1 * ay1 + cy1 * by1
    found[16, q, k] = lap12 + fy1 * ay2 + cy1 * by2
    found[17, q, k] = lap22 + fy2 * ay2 + cy2 * by2


@register_jitable(**INLINE)
def _plane_rows(own, turned, q, points, modes, right_x, right_y):
    """How the stress of an element's point answers to its nodes, of moduli ``own`` (10, nq)."""
    nodes = turned.shape[1]
    for b in range(nodes):
        d1, d2 = turned[q, b], turned[points + q, b]
        right_x[q, b] = own[0, q] * d1 + own[1, q] * d2
        right_x[points + q, b] = own[1, q] * d1 + own[2, q] * d2
        right_x[q, nodes + b] = own[3, q] * d1 + own[4, q] * d2
        right_x[points + q, nodes + b] = own[5, q] * d1 + own[6, q] * d2
        right_y[q, b] = own[7, q] * d1 + own[8, q] * d2
        right_y[points + q, b] = own[8, q] * d1 + own[9, q] * d2


@register_jitable(**INLINE)
def _round_deformed(inverse, drawn, points, q, k, f):
    flat = _plane_deformed(inverse, drawn, points, q, k, f)
    hoop = 1.0 + inverse[4, q, k] * drawn[0, 2 * points + q, k]
    f[4, q, k], f[5, q, k] = flat * hoop, hoop
    # turned inside out by either
    return min(flat, flat * hoop)


@register_jitable(**INLINE)
def _round_invariant(f, q, k):
    f11, f12, f21, f22 = four(f, q, k)
    return f11 * f11 + f12 * f12 + f21 * f21 + f22 * f22 + f[5, q, k] * f[5, q, k]


@register_jitable(**INLINE)
def _round_green(f, q, k, now):
    flat = _plane_green(f, q, k, now)
    now[7, k] = f[5, q, k] * f[5, q, k]
    return (flat - 1.0) + now[7, k]


@register_jitable(**INLINE)
def _round_isochoric(f, q, k, i1, mod, t, now):
    flat, c11, c22, c12 = f[4, q, k] / f[5, q, k], now[4, k], now[5, k], now[6, k]
    s = t / (3.0 * flat * flat)
    now[0, k], now[1, k] = mod * (1.0 - s * c22), mod * (1.0 - s * c11)
    now[2, k], now[3, k] = mod * s * c12, mod * (1.0 - t / (3.0 * now[7, k]))


@register_jitable(**INLINE)
def _round_spring(f, q, k, stress):
    t11, t22, t12, s33 = _turned(f, q, k, stress)
    return _square(t11, t22, t12, s33 * f[5, q, k] * f[5, q, k])


@register_jitable(**INLINE)
def _round_stressed(f, inverse, w, past, mod, p, q, k, points, drawn):
    hoop = f[5, q, k]
    _plane_stressed(f, inverse, w, past, mod, p * hoop, q, k, points, drawn)
    across = (mod + past[3, q, k]) * hoop + p * (f[4, q, k] / hoop)
    drawn[0, 2 * points + q, k] = w * across * inverse[4, q, k]
    drawn[1, 2 * points + q, k] = 0.0


@register_jitable(**INLINE)
def _round_answered(f, inverse, w, past, answer, q, k, found):
    f11, f12, f21, f22 = four(f, q, k)
    hoop = f[5, q, k]
    mod, p, cross = answer[0, k], answer[1, k], answer[2, k]
    fold, alpha, beta = answer[3, k], answer[4, k], answer[5, k]
    l11, l22, l12 = mod + past[0, q, k], mod + past[1, q, k], past[2, q, k]
    l33, ih = mod + past[3, q, k], inverse[4, q, k]
    i11, i12, i21, i22 = four(inverse, q, k)
    fx1, fx2 = f11 * i11 + f12 * i21, f11 * i12 + f12 * i22
    fy1, fy2 = f21 * i11 + f22 * i21, f21 * i12 + f22 * i22
    # the cofactor in the section, and that of space
    gx1, gx2 = f22 * i11 - f21 * i21, f22 * i12 - f21 * i22
    gy1, gy2 = f11 * i21 - f12 * i11, f11 * i22 - f12 * i12
    cx1, cx2, cy1, cy2 = hoop * gx1, hoop * gx2, hoop * gy1, hoop * gy2
    fh, ch = hoop * ih, f[4, q, k] / hoop * ih
    n11, n12 = w * (l11 * i11 + l12 * i21), w * (l11 * i12 + l12 * i22)
    n21, n22 = w * (l12 * i11 + l22 * i21), w * (l12 * i12 + l22 * i22)
    found[0, q, k] = f11 * n11 + f12 * n21 + w * p * cx1
    found[1, q, k] = f11 * n12 + f12 * n22 + w * p * cx2
    found[2, q, k] = w * (l33 * fh + p * ch)
    found[3, q, k] = f21 * n11 + f22 * n21 + w * p * cy1
    found[4, q, k] = f21 * n12 + f22 * n22 + w * p * cy2
    found[6, q, k], found[7, q, k], found[8, q, k] = w * cx1, w * cx2, w * ch
    found[9, q, k], found[10, q, k] = w * cy1, w * cy2
    found[5, q, k] = found[11, q, k] = 0.0
    fold *= w
    alpha *= w
    beta *= w
    bend = cross * w * ih
    cross *= w * hoop * (i11 * i22 - i12 * i21)
    ax1, ax2 = alpha * cx1 + fold * fx1, alpha * cx2 + fold * fx2
    ay1, ay2 = alpha * cy1 + fold * fy1, alpha * cy2 + fold * fy2
    bx1, bx2 = alpha * fx1 + beta * cx1, alpha * fx2 + beta * cx2
    by1, by2 = alpha * fy1 + beta * cy1, alpha * fy2 + beta * cy2
    ah, bh = alpha * ch + fold * fh, alpha * fh + beta * ch
    lap11 = i11 * n11 + i21 * n21
    lap12 = i11 * n12 + i21 * n22
    lap22 = i12 * n12 + i22 * n22
    found[12, q, k] = lap11 + fx1 * ax1 + cx1 * bx1
    found[13, q, k] = lap12 + fx1 * ax2 + cx1 * bx2
    found[14, q, k] = lap22 + fx2 * ax2 + cx2 * bx2
    found[15, q, k] = fx1 * ay1 + cx1 * by1
    found[16, q, k] = fx1 * ay2 + cx1 * by2 + cross
    found[17, q, k] = fx2 * ay1 + cx2 * by1 - cross
    found[18, q, k] = fx2 * ay2 + cx2 * by2
    found[19, q, k] = lap11 + fy1 * ay1 + cy1 * by1
    found[20, q, k] = lap12 + fy1 * ay2 + cy1 * by2
    found[21, q, k] = lap22 + fy2 * ay2 + cy2 * by2
    found[22, q, k] = fx1 * ah + cx1 * bh + bend * gx1
    found[23, q, k] = fx2 * ah + cx2 * bh + bend * gx2
    found[24, q, k] = fy1 * ah + cy1 * bh + bend * gy1
    found[25, q, k] = fy2 * ah + cy2 * bh + bend * gy2
    found[26, q, k] = w * l33 * ih * ih + fh * ah + ch * bh


@register_jitable(**INLINE)
def _round_rows(own, turned, q, points, modes, right_x, right_y):
    """As of a plane, and after the modes the rows of what lies across, which has no y."""
    _plane_rows(own, turned, q, points, modes, right_x, right_y)
    nodes, across = turned.shape[1], 2 * points + modes + q
    for b in range(nodes):
        d1, d2, value = turned[q, b], turned[points + q, b], turned[2 * points + q, b]
        right_x[q, b] += own[10, q] * value
        right_x[points + q, b] += own[11, q] * value
        right_x[across, b] = own[10, q] * d1 + own[11, q] * d2 + own[14, q] * value
        right_x[across, nodes + b] = own[12, q] * d1 + own[13, q] * d2


PLANE_STRAIN = Kinematics(
    "plane_strain",
    2,
    _plane_deformed,
    _plane_invariant,
    _plane_green,
    _plane_isochoric,
    _plane_spring,
    _plane_stressed,
    _plane_answered,
    _plane_rows,
    "N/m",
    "J/m",
)
AXISYMMETRIC = Kinematics(
    "axisymmetric",
    3,
    _round_deformed,
    _round_invariant,
    _round_green,
    _round_isochoric,
    _round_spring,
    _round_stressed,
    _round_answered,
    _round_rows,
    "N",
    "J",
)
#: By their names in the language of scenes.
KINEMATICS = {each.name: each for each in (PLANE_STRAIN, AXISYMMETRIC)}

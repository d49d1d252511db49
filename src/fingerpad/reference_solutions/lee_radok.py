"""Viscoelastic line contact: a rigid cylinder on an incompressible half-plane, valid while the
contact grows.

P(t) = (pi/R) int G(t - s) d(a^2)/ds ds, from the elastic P = pi G a^2/R (E* = 4 G when nu = 0.5).
Sources: E. H. Lee & J. R. M. Radok (1960); K. L. Johnson, *Contact Mechanics* (1985), section 6.5.
Not valid once the contact recedes: T. C. T. Ting (1966).
"""

import numpy as np

from . import prony_point


def _growing(half_width):
    squared = np.asarray(half_width, dtype=float) ** 2
    if np.any(np.diff(squared) < 0):
        raise ValueError("the contact must not shrink")
    return squared


def force_from_width(times, half_widths, radius, shear_modulus, g, tau):
    """Force at ``times`` for a contact whose a^2 is linear between the samples, N/m, shape
    ``(n,)``.

    ``shear_modulus`` is G_0, Pa. The width jumps to its first value at ``times[0]``. Raises
    ``ValueError`` when the contact shrinks, or for bad series.
    """
    squared = _growing(half_widths)
    return np.pi / radius * prony_point.stress_from_strain(times, squared, g, tau, shear_modulus)


def width_from_force(times, forces, radius, shear_modulus, g, tau):
    """Half width at ``times`` for a force that is linear between the samples, m, shape ``(n,)``.

    a^2 = (R/pi) int J(t - s) dP. Raises ``ValueError`` when the resulting contact shrinks.
    """
    squared = radius / np.pi * prony_point.strain_from_stress(times, forces, g, tau, shear_modulus)
    if np.any(np.diff(squared) < -1e-12 * np.max(np.abs(squared))):
        raise ValueError("the contact must not shrink")
    return np.sqrt(np.maximum(squared, 0))


def step_creep_width(t, radius, force, shear_modulus, g, tau):
    """Half width under a force applied at once and held, sqrt(P R J(t)/pi), m, of the shape of
    ``t``.
    """
    return np.sqrt(force * radius / (np.pi * shear_modulus) * prony_point.creep(t, g, tau))


def held_width_force(t, half_width, radius, shear_modulus, g, tau):
    """Force while a contact made at once is held, P(t) = pi a^2 G(t)/R, N/m, of the shape of
    ``t``.
    """
    return np.pi * half_width**2 / radius * shear_modulus * prony_point.relaxation(t, g, tau)

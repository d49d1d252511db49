"""Viscoelastic line contact: a rigid cylinder on an incompressible half-plane, valid while the
contact grows.

a^2 = (R/pi) int J(t - s) dP, from the elastic P = pi G a^2/R (E* = 4 G when nu = 0.5). Sources: E.
H. Lee & J. R. M. Radok (1960); K. L. Johnson, *Contact Mechanics* (1985), section 6.5.
Not valid once the contact recedes: T. C. T. Ting (1966).
"""

import numpy as np

from . import prony_point, ting


def width_from_force(times, forces, radius, shear_modulus, g, tau):
    """Half width at ``times`` for a force that is linear between the samples, m, shape ``(n,)``.

    a^2 = (R/pi) int J(t - s) dP. Raises ``ValueError`` when the resulting contact shrinks.
    """
    elastic = ting.elastic_force_under_force_control(times, forces, g, tau)
    return np.sqrt(np.maximum(radius / (np.pi * shear_modulus) * elastic, 0))


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

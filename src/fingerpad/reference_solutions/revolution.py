"""Bodies of revolution: a thick sphere under pressure; sphere, punch and cone on a half-space
without friction, elastic or, a sphere, viscoelastic.

Sources: G. Lame (1852) for the sphere; H. Hertz (1881) and K. L. Johnson (1985), Eqs 4.22-4.24; I.
N. Sneddon (1965) for punch and cone; E. H. Lee and J. R. M. Radok (1960). ``modulus`` is E/(1 -
nu^2), Pa; r is measured from the axis.
"""

import numpy as np


def thick_sphere(r, inner, outer, youngs_modulus, poisson, internal):
    """Radial displacement (m) at ``r`` (m) of a hollow sphere under an ``internal`` pressure (Pa).

    u = p a^3/(E (b^3 - a^3)) [(1 - 2 nu) r + (1 + nu) b^3/(2 r^2)]. Raises ``ValueError`` for radii
    out of order.
    """
    if not outer > inner:
        raise ValueError("the outer radius must be greater than the inner one")
    share = internal * inner**3 / (youngs_modulus * (outer**3 - inner**3))
    r = np.asarray(r, dtype=float)
    return share * ((1 - 2 * poisson) * r + (1 + poisson) * outer**3 / (2 * r**2))


def sphere_force(depth, radius, modulus):
    """Hertz: F = 4/3 E* sqrt(R) d^1.5, N, of a rigid sphere of ``radius`` m, ``depth`` m deep; the
    contact's radius is sqrt(R d).
    """
    return 4 / 3 * modulus * np.sqrt(radius) * np.asarray(depth) ** 1.5


def sphere_pressure(r, force, contact_radius):
    """Hertz: p = 3 F/(2 pi a^2) sqrt(1 - r^2/a^2), Pa; zero outside."""
    share = np.maximum(1 - (np.asarray(r, dtype=float) / contact_radius) ** 2, 0.0)
    return 1.5 * force / (np.pi * contact_radius**2) * np.sqrt(share)


def punch_force(depth, punch_radius, modulus):
    """Sneddon: F = 2 E* a d, N, of a flat-ended circular punch; pressure has no bound at its
    edge.
    """
    return 2 * modulus * punch_radius * np.asarray(depth)


def punch_pressure(r, force, punch_radius):
    """Sneddon: p = F/(2 pi a^2)/sqrt(1 - r^2/a^2), Pa, inside the edge."""
    share = 1 - (np.asarray(r, dtype=float) / punch_radius) ** 2
    return force / (2 * np.pi * punch_radius**2) / np.sqrt(share)


def cone_force(depth, half_angle, modulus):
    """Sneddon: F = 2/pi E* tan(t) d^2, N, of a cone whose ``half_angle`` (rad) is from its axis;
    the contact's radius is 2/pi d tan(t).
    """
    return 2 / np.pi * modulus * np.tan(half_angle) * np.asarray(depth) ** 2


def sphere_creep(time, force, radius, shear_instantaneous, prony_g, prony_tau, duration):
    """Contact radius (k,) m under a force that grows evenly for ``duration`` s and then stays, on
    an incompressible half-space, at times (k,) s while the contact grows.

    a^3 = 3 R/16 int J(t - s) dF: Hertz with E* = 4 G, of which 1/G becomes the creep compliance J
    (Lee and Radok 1960), for one Prony term with share ``prony_g`` of G_0 and ``prony_tau`` s.
    """
    time = np.asarray(time, dtype=float)
    late, retarded = shear_instantaneous * (1 - prony_g), prony_tau / (1 - prony_g)

    def response(t):  # int_0^t J(s) ds
        t = np.maximum(t, 0.0)
        slow = retarded * -np.expm1(-t / retarded)
        return t / late - (1 / late - 1 / shear_instantaneous) * slow

    applied = force / duration * (response(time) - response(time - duration))
    return (3 * radius / 16 * applied) ** (1 / 3)

"""Flat rigid punch with sharp edges on a half-plane.

Source: K. L. Johnson, *Contact Mechanics* (1985), section 2.8 (with stick: N. I. Muskhelishvili
1949).
"""

import numpy as np


def pressure(x, half_width, force):
    """Pressure P / (pi sqrt(a^2 - x^2)), Pa; infinite at the edges, zero outside (Johnson 1985, Eq.
    2.64).
    """
    square = half_width**2 - np.asarray(x, dtype=float) ** 2
    with np.errstate(divide="ignore"):
        return np.where(square >= 0, force / (np.pi * np.sqrt(np.maximum(square, 0))), 0.0)


def stick_exponent(poisson):
    """Exponent eta = ln(3 - 4 nu)/(2 pi) of the edge field under full stick.

    Zero for nu = 0.5: then stick and slip give the same pressure.
    """
    return np.log(3 - 4 * poisson) / (2 * np.pi)


def sticking_tractions(x, half_width, force, tangential_force, poisson):
    """Pressure and shear traction (on the half-plane, along +x) under a punch that sticks
    everywhere, Pa, |x| < a.

    p + i q = 2 (1 - nu)/sqrt(3 - 4 nu) (P + i Q)/(pi sqrt(a^2 - x^2)) exp(i eta ln((a + x)/(a -
    x))), eta of
    :func:`stick_exponent` (Johnson 1985, Eq. 2.69). Raises ``ValueError`` outside the punch.
    """
    x = np.asarray(x, dtype=float)
    if np.any(np.abs(x) >= half_width):
        raise ValueError("x must lie inside the punch")
    turn = stick_exponent(poisson) * np.log((half_width + x) / (half_width - x))
    share = 2 * (1 - poisson) / np.sqrt(3 - 4 * poisson) / (np.pi * np.sqrt(half_width**2 - x**2))
    both = share * (force + 1j * tangential_force) * np.exp(1j * turn)
    return both.real, both.imag

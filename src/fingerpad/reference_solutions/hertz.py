"""Hertz line contact: two parallel cylinders, or a cylinder and a half-plane, without friction.

Sources: H. Hertz (1881); K. L. Johnson, *Contact Mechanics* (1985), section 4.2(c), Eqs 4.43-4.49,
and section 5.6 for the approach. x is measured along the surface from the centre of the contact, z
into the body.
"""

import numpy as np


def composite_modulus(youngs_modulus, poisson, other_modulus=np.inf, other_poisson=0.0):
    """Plane-strain contact modulus E*, 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2, in Pa.

    The other body is rigid unless given.
    """
    return 1 / ((1 - poisson**2) / youngs_modulus + (1 - other_poisson**2) / other_modulus)


def half_width(force, radius, modulus):
    """Half width of the contact a = sqrt(4 P R / (pi E*)), m (Johnson 1985, Eq. 4.43).

    ``force`` P, N/m; ``radius`` R = 1/(1/R1 + 1/R2), m; ``modulus`` E*, Pa; scalars or arrays that
    broadcast.
    """
    return np.sqrt(4 * np.asarray(force) * radius / (np.pi * modulus))


def force(half_width, radius, modulus):
    """Force that makes a contact of the given half width, P = pi E* a^2 / (4 R), N/m."""
    return np.pi * modulus * np.asarray(half_width) ** 2 / (4 * radius)


def peak_pressure(force, half_width):
    """Largest pressure p0 = 2 P / (pi a), Pa (Johnson 1985, Eq. 4.45)."""
    return 2 * np.asarray(force) / (np.pi * np.asarray(half_width))


def pressure(x, half_width, peak_pressure):
    """Contact pressure p0 sqrt(1 - x^2/a^2), zero outside, Pa, shape of ``x`` (Johnson 1985, Eq.
    4.44).
    """
    return peak_pressure * np.sqrt(
        np.maximum(0.0, 1 - (np.asarray(x, dtype=float) / half_width) ** 2)
    )


def stresses(x, z, half_width, peak_pressure):
    """Stresses ``(sigma_x, sigma_z, tau_xz)`` below the contact, Pa (McEwen 1949; Johnson 1985, Eq.
    4.49).

    ``x`` and ``z`` (>= 0, into the body), m, broadcast together. Raises ``ValueError`` for z < 0.
    """
    x, z = np.broadcast_arrays(np.asarray(x, dtype=float), np.asarray(z, dtype=float))
    if np.any(z < 0):
        raise ValueError("z must not be negative")
    a = half_width
    real = a**2 - x**2 + z**2
    root = np.hypot(real, 2 * x * z)
    m = np.sqrt((root + real) / 2)
    n = np.sign(x) * np.sqrt((root - real) / 2)
    square = m**2 + n**2
    ratio = np.divide(z**2 + n**2, square, out=np.ones_like(square), where=square > 0)
    shear_ratio = np.divide(m**2 - z**2, square, out=np.zeros_like(square), where=square > 0)
    scale = peak_pressure / a
    return -scale * (m * (1 + ratio) - 2 * z), -scale * m * (1 - ratio), -scale * n * shear_ratio


def axis_stresses(z, half_width, peak_pressure, poisson):
    """Stresses on the axis x = 0, a dict of arrays of the shape of ``z``, Pa (Johnson 1985, Eqs
    4.46-4.47).

    Keys ``sigma_x``, ``sigma_z``, ``sigma_y`` (out of plane, plane strain), ``max_shear`` (in
    plane) and ``von_mises``.
    """
    sigma_x, sigma_z, _ = stresses(
        np.zeros_like(np.asarray(z, dtype=float)), z, half_width, peak_pressure
    )
    sigma_y = poisson * (sigma_x + sigma_z)
    von_mises = np.sqrt(
        ((sigma_x - sigma_z) ** 2 + (sigma_z - sigma_y) ** 2 + (sigma_y - sigma_x) ** 2) / 2
    )
    return {
        "sigma_x": sigma_x,
        "sigma_z": sigma_z,
        "sigma_y": sigma_y,
        "max_shear": np.abs(sigma_x - sigma_z) / 2,
        "von_mises": von_mises,
    }


def approach_to_depth(force, half_width, modulus, poisson, depth):
    """Sinking of the contact's centre relative to the point of the half-plane at ``depth`` below
    it, m.

    delta = P (1 - nu^2)/(pi E) [2 ln(2 d/a) - nu/(1 - nu)] for d >> a (Johnson 1985, section 5.6);
    ``modulus`` is E/(1 - nu^2). The sinking relative to infinity does not exist. Raises
    ``ValueError`` unless depth > a.
    """
    if not np.all(np.asarray(depth) > half_width):
        raise ValueError("depth must be greater than the half width")
    return (
        force / (np.pi * modulus) * (2 * np.log(2 * depth / half_width) - poisson / (1 - poisson))
    )

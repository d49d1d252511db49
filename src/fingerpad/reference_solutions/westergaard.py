"""A rigid sinusoidal surface pressed on a half-plane, without friction (partial contact).

The surface is 2 h sin^2(pi x / lambda) away from the flat at first touch, crests at x = 0, lambda,
... Sources: H. M. Westergaard (1939); K. L. Johnson, *Contact Mechanics* (1985), section 13.2. The
problem is periodic, so the field dies out as exp(-2 pi z/lambda) and no log-divergent approach
spoils it.
"""

import numpy as np


def full_contact_pressure(amplitude, wavelength, modulus):
    """Mean pressure p* = pi E* h / lambda at which the contact is complete, Pa."""
    return np.pi * modulus * amplitude / wavelength


def mean_pressure(half_width, amplitude, wavelength, modulus):
    """Mean pressure over a period for contacts of half width a <= lambda/2, p* sin^2(pi a/lambda),
    Pa.

    Raises ``ValueError`` for a half width outside [0, lambda/2].
    """
    half_width = np.asarray(half_width, dtype=float)
    if np.any((half_width < 0) | (half_width > wavelength / 2)):
        raise ValueError("half_width must lie between 0 and half the wavelength")
    return (
        full_contact_pressure(amplitude, wavelength, modulus)
        * np.sin(np.pi * half_width / wavelength) ** 2
    )


def pressure(x, half_width, amplitude, wavelength, modulus):
    """Contact pressure at ``x``, Pa, of the shape of ``x``; zero outside the contacts.

    p = 2 pbar cos(psi)/sin^2(psi_a) sqrt(sin^2(psi_a) - sin^2(psi)), psi = pi x/lambda.
    """
    mean = mean_pressure(half_width, amplitude, wavelength, modulus)
    edge = np.sin(np.pi * half_width / wavelength) ** 2
    psi = np.pi * np.asarray(x, dtype=float) / wavelength
    return 2 * mean * np.abs(np.cos(psi)) / edge * np.sqrt(np.maximum(0.0, edge - np.sin(psi) ** 2))

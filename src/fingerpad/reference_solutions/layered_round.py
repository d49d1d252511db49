"""Bonded layers under a body of revolution without friction: the dual integral equations, by
collocation in Sonine's functions.

A pressure c (1 - r^2/a^2)^nu has the Hankel transform c a^2 2^nu Gamma(nu + 1) J_(nu+1)(s)/s^(nu+1)
with s = k a (Sonine), and a pressure J0(kr) sinks by the compliance C(k) that cos(kx) has in plane
strain (:func:`fingerpad.reference_solutions.layered.stack_compliance`). Of a half-space, C = A/k,
the sinking is a polynomial (Weber and Schafheitlin's integral); what the layers add to C falls off
as exp(-2 k h) and is integrated. Where contact ends smoothly nu = 1/2, 3/2, ...; at the edge of a
punch -1/2 joins them. Sources: I. N. Sneddon (1966), *Mixed Boundary Value Problems in Potential
Theory*; G. M. L. Gladwell (1980).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import gamma, hyp2f1, j0, jv

from fingerpad.reference_solutions.layered import Layer, stack_compliance

_TERMS, _PLACES, _WAVES = 8, 40, 400


@dataclass(frozen=True)
class Contact:
    """A pressed body: force N, depth m, and the pressure Pa at radii (n,) m."""

    force: float
    depth: float
    pressure: Callable[[np.ndarray], np.ndarray]


def press(
    layers: Sequence[Layer],
    contact_radius: float,
    height: Callable[[np.ndarray], np.ndarray],
    depth: float | None = None,
) -> Contact:
    """The contact of a given radius.

    Parameters
    ----------
    layers
        From the surface down; a last one of infinite thickness is a half-space, otherwise there is
        a rigid base.
    contact_radius
        m.
    height
        Of the body (n,) m at radii (n,) m, zero on the axis.
    depth
        m, of a punch, whose radius is the contact's; left out, contact ends smoothly, and says how
        deep it is.
    """
    a, (wave, weight) = contact_radius, np.polynomial.legendre.leggauss(_WAVES)
    most = 20 / layers[0].thickness if np.isfinite(layers[0].thickness) else 1 / a
    k, weight = most * (wave + 1) / 2, most * weight / 2
    half_space = (1 - layers[0].poisson_ratio) / layers[0].shear_modulus
    added = np.array([stack_compliance(each, layers) for each in k]) - half_space / k
    x = np.cos(np.pi * (np.arange(_PLACES) + 0.5) / (2 * _PLACES))
    nu = np.arange(_TERMS) + (0.5 if depth is None else -0.5)
    scale = 2**nu * gamma(nu + 1)
    transforms = a**2 * scale * jv(nu + 1, (k * a)[:, None]) / (k * a)[:, None] ** (nu + 1)
    sinking = (j0(np.outer(x * a, k)) * (added * k * weight)) @ transforms
    alone = half_space * a * scale * gamma(0.5) / (2 ** (nu + 1) * gamma(nu + 1.5))
    sinking += alone * hyp2f1(0.5, -nu - 0.5, 1.0, (x**2)[:, None])
    wanted = -height(x * a)
    if depth is None:  # one more unknown
        table = np.column_stack([sinking, -np.ones(_PLACES)])
        *terms, depth = np.linalg.lstsq(table, wanted)[0]
    else:
        terms = np.linalg.lstsq(sinking, wanted + depth)[0]
    terms = np.array(terms)

    def pressure(r):
        share = np.maximum(1 - (np.asarray(r, dtype=float) / a) ** 2, 0.0)
        return (share[:, None] ** nu) @ terms

    return Contact(float(np.pi * a**2 * np.sum(terms / (nu + 1))), float(depth), pressure)

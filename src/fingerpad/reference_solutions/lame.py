"""Thick cylinder under internal and external pressure, plane strain.

Sources: G. Lame (1852); R. H. MacNeal & R. L. Harder (1985) for the usual numbers.
"""

import numpy as np


def _constants(inner, outer, internal, external):
    if not outer > inner:
        raise ValueError("the outer radius must be greater than the inner one")
    area = outer**2 - inner**2
    mean = (internal * inner**2 - external * outer**2) / area
    return mean, (internal - external) * inner**2 * outer**2 / area


def radial_displacement(
    r, inner_radius, outer_radius, youngs_modulus, poisson, internal=0.0, external=0.0
):
    """Radial displacement u_r(r) = (1 + nu)/E [(1 - 2 nu) A r + B/r], m, of the shape of ``r``.

    A = (p_i a^2 - p_o b^2)/(b^2 - a^2), B = (p_i - p_o) a^2 b^2/(b^2 - a^2). Pressures in Pa, nu up
    to and including 0.5. Raises ``ValueError`` for radii out of order.
    """
    mean, shear = _constants(inner_radius, outer_radius, internal, external)
    r = np.asarray(r, dtype=float)
    return (1 + poisson) / youngs_modulus * ((1 - 2 * poisson) * mean * r + shear / r)

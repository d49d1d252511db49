"""The skin as an elastic half-plane: the continuum model of Phillips and Johnson (1981).

One homogeneous, isotropic, linear elastic half-plane in plane strain: no layers, no bone, no time,
small strain. The pad's curved skin enters through the gap alone, so a plate or cylinder presses it
as Hertz's line contact does; below, stresses add up from strips of uniform pressure, for any
pressure that was found. Sources: J. R. Phillips and K. O. Johnson, J. Neurophysiol. 46, 1204
(1981); K. L. Johnson, *Contact Mechanics* (1985), sections
2.5 (strip), 4.2 and 5.6 (contact). x along the surface, z into the body.
"""

import numpy as np

from . import hertz


def strip_stresses(x, z, edges, pressures):
    """Stresses ``(sigma_x, sigma_z, tau_xz)`` below strips of uniform pressure, Pa, of the shape of
    ``x`` and ``z`` together.

    Parameters
    ----------
    x, z
        m, z > 0.
    edges
        (n + 1,) m, ascending ends of the strips.
    pressures
        (n,) Pa, compression positive.

    Raises
    ------
    ValueError
        A point does not lie inside the body, or the edges do not ascend.
    """
    x, z = np.broadcast_arrays(np.asarray(x, float), np.asarray(z, float))
    edges, pressures = np.asarray(edges, float), np.asarray(pressures, float)
    if len(edges) != len(pressures) + 1 or not (np.diff(edges) > 0).all():
        raise ValueError("edges must ascend and be one more than pressures")
    if not (z > 0).all():
        raise ValueError("points must lie inside the body, z > 0")
    angle = np.arctan2(z[..., None], x[..., None] - edges)
    opened, sine, cosine = (
        np.diff(values, axis=-1) for values in (angle, np.sin(2 * angle), np.cos(2 * angle))
    )
    scale = -pressures / (2 * np.pi)
    return (
        (scale * (2 * opened + sine)).sum(-1),
        (scale * (2 * opened - sine)).sum(-1),
        (-scale * cosine).sum(-1),
    )


def strains(sigma_x, sigma_z, tau_xz, youngs_modulus, poisson):
    """Principal strains in the plane ``(tensile, compressive)``, both signed, of a plane-strain
    state of stress (Pa).
    """
    plane, contraction = (1 - poisson**2) / youngs_modulus, poisson * (1 + poisson) / youngs_modulus
    along, down = plane * sigma_x - contraction * sigma_z, plane * sigma_z - contraction * sigma_x
    radius = np.hypot((along - down) / 2, tau_xz * (1 + poisson) / youngs_modulus)
    return (along + down) / 2 + radius, (along + down) / 2 - radius


def strain_energy_density(sigma_x, sigma_z, tau_xz, shear, bulk, poisson):
    """Strain energy density, Pa: stress deviator on ``shear``, mean stress on ``bulk`` (Pa).

    ``shear`` may be that of another time than the one the stresses (of ``poisson``) were found
    with.
    """
    sigma_y = poisson * (sigma_x + sigma_z)
    mean = (sigma_x + sigma_y + sigma_z) / 3
    square = sigma_x**2 + sigma_y**2 + sigma_z**2 - 3 * mean**2 + 2 * tau_xz**2
    return square / (4 * shear) + mean**2 / (2 * bulk)


def press(force, radius, youngs_modulus, poisson, thickness):
    """A rigid plate or cylinder on the half-plane: ``(depth m, half width m, peak pressure Pa)``.

    Parameters
    ----------
    force
        N/m.
    radius
        m, 1/(1/pad + curvature).
    thickness
        m, the depth of the point that the sinking refers to (the bone's): a half-plane has no
        other.
    """
    modulus = hertz.composite_modulus(youngs_modulus, poisson)
    half_width = hertz.half_width(force, radius, modulus)
    depth = hertz.approach_to_depth(force, half_width, modulus, poisson, thickness)
    return depth, half_width, hertz.peak_pressure(force, half_width)

"""Bonded elastic layers in plane strain under a frictionless normal load.

Sources: K. L. Johnson, *Contact Mechanics* (1985), section 5.8 for the thin incompressible layer
(re-derived here from the lubrication argument); J. Meijers (1968); G. M. L. Gladwell (1980),
chapter on layers, for the transfer of Fourier modes, solved here as one small linear system a mode.
"""

from dataclasses import dataclass

import numpy as np

from ._check import poisson_ratio, positive


def thin_layer_half_width(force, radius, thickness, youngs_modulus):
    """Half width of a rigid cylinder on a thin bonded incompressible layer, a = (45 P R b^3/(2
    E))^(1/5), m.

    ``thickness`` b, m; valid for a >> b. Johnson (1985), section 5.8: P = 2 E a^5/(45 R b^3).
    """
    positive(force=force, radius=radius, thickness=thickness, youngs_modulus=youngs_modulus)
    return (45 * force * radius * thickness**3 / (2 * youngs_modulus)) ** 0.2


def thin_layer_force(half_width, radius, thickness, youngs_modulus):
    """Force P = 2 E a^5/(45 R b^3), N/m."""
    positive(
        half_width=half_width, radius=radius, thickness=thickness, youngs_modulus=youngs_modulus
    )
    return 2 * youngs_modulus * half_width**5 / (45 * radius * thickness**3)


def thin_layer_pressure(x, half_width, radius, thickness, youngs_modulus):
    """Pressure p = E (a^2 - x^2)^2/(24 R b^3), zero outside, Pa, of the shape of ``x``."""
    positive(
        half_width=half_width, radius=radius, thickness=thickness, youngs_modulus=youngs_modulus
    )
    square = np.maximum(0.0, half_width**2 - np.asarray(x, dtype=float) ** 2)
    return youngs_modulus * square**2 / (24 * radius * thickness**3)


def thin_layer_depth(half_width, radius):
    """Indentation depth delta = a^2/(6 R), m: a third of what the cylinder alone would cut off."""
    positive(half_width=half_width, radius=radius)
    return half_width**2 / (6 * radius)


def incompressible_kernel(wavenumber_times_thickness, ratio):
    """Kernel K(kh) of an incompressible layer (mu1, h) bonded to an incompressible half-plane
    (mu2).

    ``ratio`` is mu2/mu1. Under p cos(kx) without shear the surface sinks by p/(2 mu1 k) K cos(kx).
    K -> 1 for kh -> infinity and mu1/mu2 for kh -> 0. Of the shape of
    ``wavenumber_times_thickness``; raises ``ValueError`` unless both are positive.
    """
    positive(wavenumber_times_thickness=wavenumber_times_thickness, ratio=ratio)
    xi = np.asarray(wavenumber_times_thickness, dtype=float)
    alpha = (1 - ratio) / (1 + ratio)
    decay = np.exp(-2 * xi)
    above = 1 + 4 * alpha * xi * decay - alpha**2 * decay**2
    return above / (1 - 2 * alpha * (1 + 2 * xi**2) * decay + alpha**2 * decay**2)


@dataclass(frozen=True)
class Layer:
    """One layer of a stack, from the loaded surface down: thickness (m, ``inf`` for a half-plane),
    moduli.
    """

    thickness: float
    shear_modulus: float
    poisson_ratio: float


def _mode(layer, wavenumber, depth):
    """Rows (u_x, u_y, sigma_yy, sigma_xy), columns the Airy constants, at ``depth`` below the
    layer's top.

    Airy function f(d) cos(kx) with f = exp(-kd), kd exp(-kd), exp(k(d - h)), k(d - h) exp(k(d -
    h)); d points down, y up. Displacements are multiplied by 2 k and the stresses divided by k^2,
    all amplitudes.
    """
    h, nu = layer.thickness, layer.poisson_ratio
    s = wavenumber * depth
    e = np.exp(-s)
    columns = [(e, -e, e, -e), (s * e, (1 - s) * e, (s - 2) * e, (3 - s) * e)]
    if np.isfinite(h):
        r = wavenumber * (depth - h)
        e = np.exp(r)
        columns += [(e, e, e, e), (r * e, (1 + r) * e, (2 + r) * e, (3 + r) * e)]
    f, f1, f2, f3 = np.array(columns).T  # derivatives with respect to k d
    f1, f3 = -f1, -f3  # with respect to k y
    return np.array(
        [
            ((1 - nu) * f2 + nu * f) / layer.shear_modulus,
            ((nu - 2) * f1 + (1 - nu) * f3) / layer.shear_modulus,
            -f,
            f1,
        ]
    )


def stack_compliance(wavenumber, layers):
    """Sinking of the surface over the pressure, for p cos(kx) on a stack of bonded layers, m/Pa; a
    float.

    ``layers`` from the top down; a last layer of infinite thickness is a half-plane, otherwise the
    stack is bonded to a rigid base. ``wavenumber`` k, 1/m; zero gives the uniform pressure with
    sides that cannot move, the sum of h (1 - 2 nu)/(2 mu (1 - nu)). Exact for each k. Raises
    ``ValueError`` for an empty stack, an infinite layer that is not the last, bad moduli or a
    negative wavenumber.
    """
    if not layers:
        raise ValueError("a stack needs at least one layer")
    for layer in layers:
        positive(shear_modulus=layer.shear_modulus)
        poisson_ratio(poisson_ratio=layer.poisson_ratio)
        if not layer.thickness > 0:
            raise ValueError(f"thickness must be positive, got {layer.thickness}")
    if any(np.isinf(layer.thickness) for layer in layers[:-1]):
        raise ValueError("only the last layer may be infinitely thick")
    if wavenumber < 0:
        raise ValueError("wavenumber must not be negative")
    if wavenumber == 0:
        return sum(
            layer.thickness
            * (1 - 2 * layer.poisson_ratio)
            / (2 * layer.shear_modulus * (1 - layer.poisson_ratio))
            for layer in layers
        )
    tops = [_mode(layer, wavenumber, 0.0) for layer in layers]
    bottoms = [
        _mode(layer, wavenumber, layer.thickness)
        for layer in layers
        if np.isfinite(layer.thickness)
    ]
    starts = np.cumsum([0] + [top.shape[1] for top in tops])
    matrix = np.zeros((starts[-1], starts[-1]))
    load = np.zeros(starts[-1])
    matrix[:2, : starts[1]] = tops[0][2:]
    load[0] = -1.0  # sigma_yy = -p
    row = 2
    for i, bottom in enumerate(bottoms):
        if i + 1 < len(layers):
            matrix[row : row + 4, starts[i] : starts[i + 1]] = bottom
            matrix[row : row + 4, starts[i + 1] : starts[i + 2]] = -tops[i + 1]
            row += 4
        else:
            matrix[row : row + 2, starts[i] : starts[i + 1]] = bottom[:2]
    # Rows of displacements carry 1/mu: bring them to the size of the stress rows.
    scale = np.abs(matrix).max(1)
    constants = np.linalg.solve(matrix / scale[:, None], load / scale)
    return float(-tops[0][1] @ constants[: starts[1]]) / (2 * wavenumber)

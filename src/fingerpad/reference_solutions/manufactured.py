"""Manufactured plane-strain displacement fields and the stresses that they stand for.

A :class:`Field` gives u and grad u in closed form; :func:`small_strain_stress` and
:func:`first_piola_stress` turn them into the stress P. Its virtual work ``int P : grad v`` is that
of the body force b = -Div P that makes the field a solution, for every v that is zero on the rim.
Finite strain: psi = mu/2 (J^(-2/3) I1 - 3) + kappa/2 (J - 1)^2 with the plane-strain I1 = tr C + 1.
Shapes: points (..., 2), u (..., 2), grad u (..., 2, 2) with [i, J] = du_i/dX_J. Sources: P. J.
Roache (2002) for the method; G. A. Holzapfel (2000), chapter 6, for the material.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Field:
    """Displacement field: two callables of points (..., 2), m; shapes as in the module's
    docstring.
    """

    displacement: Callable
    gradient: Callable

    def plus(self, other, factor):
        """The field plus ``factor`` times another."""
        return Field(
            lambda x: self.displacement(x) + factor * other.displacement(x),
            lambda x: self.gradient(x) + factor * other.gradient(x),
        )


def affine(matrix, offset=(0.0, 0.0)):
    """Field u = matrix X + offset: a patch test, no body force. ``matrix`` (2, 2), ``offset`` (2,)
    m.
    """
    matrix, offset = np.array(matrix, dtype=float), np.array(offset, dtype=float)
    return Field(
        lambda x: np.asarray(x) @ matrix.T + offset,
        lambda x: np.broadcast_to(matrix, (*np.shape(x)[:-1], 2, 2)),
    )


def _matrix(xx, xy, yx, yy):
    """(..., 2, 2) of components (...)."""
    return np.stack([np.stack([xx, xy], -1), np.stack([yx, yy], -1)], -2)


def gradient_of_potential(amplitude, wavenumber):
    """Field u = grad phi, phi = amplitude/wavenumber sin(kx + 0.3) cos(ky - 0.2): no rotation.

    ``amplitude`` m, ``wavenumber`` k 1/m. Its divergence is -2 k amplitude sin(kx + 0.3) cos(ky -
    0.2).
    """

    def displacement(points):
        a, b = _angles(points, wavenumber)
        return amplitude * np.stack([np.cos(a) * np.cos(b), -np.sin(a) * np.sin(b)], -1)

    def gradient(points):
        a, b = _angles(points, wavenumber)
        along, across = np.sin(a) * np.cos(b), np.cos(a) * np.sin(b)
        return -amplitude * wavenumber * _matrix(along, across, across, along)

    return Field(displacement, gradient)


def divergence_free(amplitude, wavenumber):
    """Field u = curl of amplitude/wavenumber sin(kx + 0.3) cos(ky - 0.2): div u = 0 at every point.

    ``amplitude`` m, ``wavenumber`` k 1/m. The body force does not depend on kappa, so nu -> 0.5
    makes sense.
    """

    def displacement(points):
        a, b = _angles(points, wavenumber)
        return -amplitude * np.stack([np.sin(a) * np.sin(b), np.cos(a) * np.cos(b)], -1)

    def gradient(points):
        a, b = _angles(points, wavenumber)
        along, across = np.cos(a) * np.sin(b), np.sin(a) * np.cos(b)
        return -amplitude * wavenumber * _matrix(along, across, -across, -along)

    return Field(displacement, gradient)


def _angles(points, wavenumber):
    points = np.asarray(points, dtype=float)
    return wavenumber * points[..., 0] + 0.3, wavenumber * points[..., 1] - 0.2


def isochoric_shears(amplitude, wavenumber):
    """Field of two shears: x = X + a sin(kY), then y = Y + a sin(k x + 0.5); det F = 1 at every
    point.

    ``amplitude`` a m, ``wavenumber`` k 1/m. Finite strain without change of volume.
    """
    a, k = amplitude, wavenumber

    def displacement(points):
        first = a * np.sin(k * points[..., 1])
        return np.stack([first, a * np.sin(k * (points[..., 0] + first) + 0.5)], -1)

    def gradient(points):
        slope = a * k * np.cos(k * points[..., 1])
        moved = points[..., 0] + a * np.sin(k * points[..., 1])
        second = a * k * np.cos(k * moved + 0.5)
        return _matrix(0 * slope, slope, second, second * slope)

    return Field(displacement, gradient)


def small_strain_stress(field, points, shear_modulus, bulk_modulus):
    """In-plane stress (..., 2, 2), Pa: 2 mu dev(eps) + kappa tr(eps) 1, the deviator
    three-dimensional.
    """
    grad = field.gradient(points)
    strain = (grad + np.swapaxes(grad, -1, -2)) / 2
    trace = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(2)
    return 2 * shear_modulus * (strain - trace / 3) + bulk_modulus * trace


def first_piola_stress(field, points, shear_modulus, bulk_modulus):
    """First Piola-Kirchhoff stress P = d psi/dF (..., 2, 2), Pa. Raises ``ValueError`` where det F
    <= 0.
    """
    deformation = field.gradient(points) + np.eye(2)
    volume = np.linalg.det(deformation)[..., None, None]
    if np.any(volume <= 0):
        raise ValueError("the field turns the material inside out: det F <= 0")
    inverse = np.swapaxes(np.linalg.inv(deformation), -1, -2)
    invariant = ((deformation**2).sum((-1, -2)) + 1)[..., None, None]
    isochoric = shear_modulus * volume ** (-2 / 3) * (deformation - invariant / 3 * inverse)
    return isochoric + bulk_modulus * (volume - 1) * volume * inverse


def nearly_incompressible(isochoric, dilatant, bulk_modulus, pressure_modulus):
    """Field isochoric + (pressure_modulus/bulk_modulus) dilatant: pressure bounded as kappa ->
    infinity.

    Small strain: pressure = pressure_modulus x div of ``dilatant`` when ``isochoric`` is free of
    divergence.
    """
    return isochoric.plus(dilatant, pressure_modulus / bulk_modulus)

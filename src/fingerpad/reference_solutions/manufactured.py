"""Manufactured plane-strain displacement fields and the body forces that make them solutions.

A :class:`Field` gives u, grad u and the second gradient in closed form;
:func:`small_strain_body_force` and
:func:`finite_strain_body_force` turn it into b = -div sigma or b = -Div P without any numerical
differentiation (b_i = -A_iJkL u_k,JL, A the tangent of P). Finite strain: psi = mu/2 (J^(-2/3) I1 -
3) + kappa/2 (J - 1)^2 with the plane-strain I1 = tr C + 1. Shapes: points (..., 2), u (..., 2),
grad u (..., 2, 2) with [i, J] = du_i/dX_J, second gradient (..., 2, 2, 2) with [i, J, K]. Sources:
P. J. Roache (2002) for the method; G. A. Holzapfel (2000), chapter 6, for the material.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Field:
    """Displacement field: three callables of points (..., 2), m; shapes as in the module's
    docstring.
    """

    displacement: Callable
    gradient: Callable
    second_gradient: Callable

    def __add__(self, other):
        """Sum of two fields."""
        return Field(
            lambda x: self.displacement(x) + other.displacement(x),
            lambda x: self.gradient(x) + other.gradient(x),
            lambda x: self.second_gradient(x) + other.second_gradient(x),
        )

    def __rmul__(self, factor):
        """The field times a number."""
        return Field(
            lambda x: factor * self.displacement(x),
            lambda x: factor * self.gradient(x),
            lambda x: factor * self.second_gradient(x),
        )


def _split(points):
    points = np.asarray(points, dtype=float)
    return points[..., 0], points[..., 1]


def affine(matrix, offset=(0.0, 0.0)):
    """Field u = matrix X + offset: a patch test, no body force. ``matrix`` (2, 2), ``offset`` (2,)
    m.
    """
    matrix, offset = np.array(matrix, dtype=float), np.array(offset, dtype=float)
    return Field(
        lambda x: np.asarray(x) @ matrix.T + offset,
        lambda x: np.broadcast_to(matrix, (*np.shape(x)[:-1], 2, 2)).copy(),
        lambda x: np.zeros((*np.shape(x)[:-1], 2, 2, 2)),
    )


def gradient_of_potential(amplitude, wavenumber):
    """Field u = grad phi, phi = amplitude/wavenumber sin(kx + 0.3) cos(ky - 0.2): no rotation.

    ``amplitude`` m, ``wavenumber`` k 1/m. Its divergence is -2 k amplitude sin(kx + 0.3) cos(ky -
    0.2).
    """
    return _trigonometric(amplitude, wavenumber, curl=False)


def divergence_free(amplitude, wavenumber):
    """Field u = curl of amplitude/wavenumber sin(kx + 0.3) cos(ky - 0.2): div u = 0 at every point.

    ``amplitude`` m, ``wavenumber`` k 1/m. The body force does not depend on kappa, so nu -> 0.5
    makes sense.
    """
    return _trigonometric(amplitude, wavenumber, curl=True)


def _trigonometric(amplitude, k, curl):
    def derivative(points, nx, ny):
        """d^nx/dx^nx d^ny/dy^ny of the potential."""
        x, y = _split(points)
        sine = np.sin(k * x + 0.3 + nx * np.pi / 2)
        cosine = np.cos(k * y - 0.2 + ny * np.pi / 2)
        return amplitude * k ** (nx + ny - 1) * sine * cosine

    def component(points, i, nx, ny):
        if not curl:
            return derivative(points, nx + (i == 0), ny + (i == 1))
        return derivative(points, nx, ny + 1) if i == 0 else -derivative(points, nx + 1, ny)

    orders = ((1, 0), (0, 1))

    def displacement(p):
        return np.stack([component(p, i, 0, 0) for i in range(2)], -1)

    def gradient(p):
        return np.stack(
            [np.stack([component(p, i, *orders[j]) for j in range(2)], -1) for i in range(2)], -2
        )

    def second(p):
        return np.stack(
            [
                np.stack(
                    [
                        np.stack(
                            [component(p, i, *np.add(orders[j], orders[m])) for m in range(2)], -1
                        )
                        for j in range(2)
                    ],
                    -2,
                )
                for i in range(2)
            ],
            -3,
        )

    return Field(displacement, gradient, second)


def isochoric_shears(amplitude, wavenumber):
    """Field of two shears: x = X + a sin(kY), then y = Y + a sin(k x + 0.5); det F = 1 at every
    point.

    ``amplitude`` a m, ``wavenumber`` k 1/m. Finite strain without change of volume.
    """
    a, k = amplitude, wavenumber

    def parts(points):
        x, y = _split(points)
        first = a * np.sin(k * y)
        moved = k * (x + first) + 0.5
        return first, a * k * np.cos(k * y), -(k**2) * first, moved

    def displacement(p):
        first, _, _, moved = parts(p)
        return np.stack([first, a * np.sin(moved)], -1)

    def gradient(p):
        _, slope, _, moved = parts(p)
        second = a * k * np.cos(moved)
        zero = np.zeros_like(slope)
        return np.stack([np.stack([zero, slope], -1), np.stack([second, second * slope], -1)], -2)

    def second_gradient(p):
        _, slope, bend, moved = parts(p)
        second, curve = a * k * np.cos(moved), -a * k**2 * np.sin(moved)
        result = np.zeros((*np.shape(slope), 2, 2, 2))
        result[..., 0, 1, 1] = bend
        result[..., 1, 0, 0] = curve
        result[..., 1, 0, 1] = result[..., 1, 1, 0] = curve * slope
        result[..., 1, 1, 1] = curve * slope**2 + second * bend
        return result

    return Field(displacement, gradient, second_gradient)


def small_strain_stress(field, points, shear_modulus, bulk_modulus):
    """In-plane stress (..., 2, 2), Pa: 2 mu dev(eps) + kappa tr(eps) 1, the deviator
    three-dimensional.
    """
    grad = field.gradient(points)
    strain = (grad + np.swapaxes(grad, -1, -2)) / 2
    trace = np.trace(strain, axis1=-2, axis2=-1)[..., None, None] * np.eye(2)
    return 2 * shear_modulus * (strain - trace / 3) + bulk_modulus * trace


def small_strain_body_force(field, points, shear_modulus, bulk_modulus):
    """Body force b = -[mu lap u + (kappa + mu/3) grad div u] (..., 2), N/m^3."""
    second = field.second_gradient(points)
    laplacian = np.einsum("...ijj->...i", second)
    grad_div = np.einsum("...jji->...i", second)
    return -(shear_modulus * laplacian + (bulk_modulus + shear_modulus / 3) * grad_div)


def _kinematics(field, points):
    deformation = field.gradient(points) + np.eye(2)
    volume = np.linalg.det(deformation)
    if np.any(volume <= 0):
        raise ValueError("the field turns the material inside out: det F <= 0")
    return deformation, volume, np.swapaxes(np.linalg.inv(deformation), -1, -2)


def finite_strain_energy(field, points, shear_modulus, bulk_modulus):
    """Energy psi (...), J/m^3. Raises ``ValueError`` where det F <= 0, as all finite-strain
    ones.
    """
    deformation, volume, _ = _kinematics(field, points)
    invariant = (deformation**2).sum((-1, -2)) + 1
    return (
        shear_modulus / 2 * (volume ** (-2 / 3) * invariant - 3)
        + bulk_modulus / 2 * (volume - 1) ** 2
    )


def first_piola_stress(field, points, shear_modulus, bulk_modulus):
    """First Piola-Kirchhoff stress P = d psi/dF (..., 2, 2), Pa."""
    deformation, volume, inverse = _kinematics(field, points)
    invariant = ((deformation**2).sum((-1, -2)) + 1)[..., None, None]
    volume = volume[..., None, None]
    isochoric = shear_modulus * volume ** (-2 / 3) * (deformation - invariant / 3 * inverse)
    return isochoric + bulk_modulus * (volume - 1) * volume * inverse


def finite_strain_body_force(field, points, shear_modulus, bulk_modulus):
    """Body force per undeformed volume b_i = -A_iJkL u_k,JL (..., 2), N/m^3, A = dP/dF in closed
    form.
    """
    deformation, volume, inverse = _kinematics(field, points)
    second = field.second_gradient(points)
    invariant = (deformation**2).sum((-1, -2)) + 1
    # Contractions of the second gradient with the five parts of A.
    laplacian = np.einsum("...iJJ->...i", second)
    volume_rate = np.einsum("...kL,...kLJ->...J", inverse, second)  # (ln J),J
    invariant_rate = 2 * np.einsum("...kL,...kLJ->...J", deformation, second)
    inverse_divergence = -np.einsum(
        "...iL,...kJ,...kLJ->...i", inverse, inverse, second
    )  # (F^-T)_iJ,J

    def rows(matrix, vector):
        return np.einsum("...iJ,...J->...i", matrix, vector)

    v, i1 = volume[..., None], invariant[..., None]
    isochoric = (
        laplacian
        - 2 / 3 * rows(deformation, volume_rate)
        - 1 / 3 * rows(inverse, invariant_rate)
        + 2 / 9 * i1 * rows(inverse, volume_rate)
        - i1 / 3 * inverse_divergence
    )
    # J F^-T has no divergence (Piola), so only the pressure's gradient is left.
    volumetric = v * rows(inverse, v * volume_rate)
    return -(shear_modulus * v ** (-2 / 3) * isochoric + bulk_modulus * volumetric)


def nearly_incompressible(isochoric, dilatant, bulk_modulus, pressure_modulus):
    """Field isochoric + (pressure_modulus/bulk_modulus) dilatant: pressure bounded as kappa ->
    infinity.

    Small strain: pressure = pressure_modulus x div of ``dilatant`` when ``isochoric`` is free of
    divergence.
    """
    return isochoric + (pressure_modulus / bulk_modulus) * dilatant

"""Mechanical state at chosen material points, with their own Prony history.

Receptor depths fall where they fall, not on quadrature points. What is sampled is treated like one
more quadrature point (of zero weight): displacement gradient and pressure are evaluated there
exactly as the element interpolates them, and the branch stresses follow the same recurrence as in
the body. Receptors have what is fitted to them (:mod:`fingerpad.receptors.recovery`).

What is sampled are the stimuli that receptors have been said to respond to (Phillips and Johnson
1981; Srinivasan and Dandekar 1996). Five meanings of strain energy density (per undeformed volume)
are kept apart, because under constant force they disagree even in trend (see
:func:`strain_energies`).
"""

import numpy as np
import pandas as pd

from fingerpad.mechanics.finite_strain import (
    deviator_square,
    isochoric_energy,
    isochoric_stress,
    push_forward,
)
from fingerpad.mechanics.viscoelasticity import Branches
from fingerpad.receptors.recovery import Location, recovery


def _layers(body):
    """(ne,) number of the material that each element is of: its shear modulus and its law."""
    laws = [
        part.elements[:, None] * np.column_stack([np.ones(len(part.constants)), part.constants])
        for part in body.laws
    ]
    materials = pd.DataFrame(np.column_stack([body.shear, *laws]))
    return materials.groupby(list(materials)).ngroup().to_numpy()


class MaterialPoints:
    """Receptors in a body; an observer of the stepper.

    Parameters
    ----------
    body
        The body they belong to.
    points
        (nr, 2) undeformed positions, m.
    shear_instantaneous
        (ne,) Pa, the moduli the headline strain energy is measured with; None for a purely elastic
        solid, whose strain energy has one meaning only.
    mirrored
        The body is half of one that is symmetric in x = 0.

    Raises
    ------
    ReceptorError
        A point lies outside the mesh.
    """

    def __init__(
        self,
        body,
        points: np.ndarray,
        shear_instantaneous: np.ndarray | None,
        mirrored: bool = False,
    ):
        recovered = recovery(body.space, _layers(body), np.atleast_2d(points), mirrored)
        self._place(body, *recovered, shear_instantaneous)

    @classmethod
    def centres(cls, body, shear_instantaneous: np.ndarray | None) -> "MaterialPoints":
        """A point in the middle of every element, in their order: the fields of a body as its
        receptors see them.
        """
        made, count = cls.__new__(cls), len(body.space.cells)
        middle = np.full((count, 2), 1 / 3 if body.space.element.triangle else 0.5)
        made._place(body, Location(np.arange(count), middle), None, shear_instantaneous)
        return made

    def _place(self, body, location, recovery, shear_instantaneous):
        space, element = body.space, location.element
        self.location, self.recovery = location, recovery
        values, slopes = space.element.shape(self.location.xi)
        self.cells = space.cells[element]
        nodes = space.points[self.cells]
        jacobian = np.einsum("nai,naj->nij", slopes, nodes)
        self.grad = np.ascontiguousarray(np.einsum("nij,naj->nai", np.linalg.inv(jacobian), slopes))
        place = np.einsum("na,nai->ni", values, nodes)
        self.psi = space.pressure_modes(element, place)
        self.values, self.x, self.kinematics = values, place[:, 0], space.kinematics
        self.shear, self.bulk = body.shear[element], body.bulk[element]
        self.laws = tuple(part.at(element) for part in body.laws)
        self.shear_instantaneous = (
            None if shear_instantaneous is None else np.asarray(shear_instantaneous)[element]
        )
        self._linear = body.geometrically_linear
        prony = body.prony if self._linear else body.branches and body.branches.prony
        self.branches = Branches(prony, (len(element), 4)) if prony else None

    def _deformation(self, body):
        """Deformation gradient in the section (nr, 2, 2) and across it (nr,), its determinant
        (nr,), strain in the section (nr, 2, 2) and across it (nr,), and principal stretches (nr,
        2) of the section, rising; the linear theory has no more than the strain.
        """
        u = body.u[self.cells]
        gradient = np.einsum("nai,naj->nij", u, self.grad)
        lateral = np.einsum("na,na->n", self.values, u[..., 0])
        across = self.kinematics.hoop(lateral, self.x, gradient[:, 0, 0])
        if self._linear:
            strain = 0.5 * (gradient + gradient.swapaxes(1, 2))
            f, one = np.broadcast_to(np.eye(2), gradient.shape), np.ones(len(gradient))
            return f, one, one, strain, across, 1 + np.linalg.eigvalsh(strain)
        f, hoop = np.eye(2) + gradient, 1 + across
        jac = (f[:, 0, 0] * f[:, 1, 1] - f[:, 0, 1] * f[:, 1, 0]) * hoop
        stretch = np.linalg.svd(f, compute_uv=False)[:, ::-1]
        return f, hoop, jac, logarithmic_strain(f), np.log(hoop), stretch

    def _isochoric(self, body):
        f, hoop, _, strain, across, _ = self._deformation(body)
        if not self._linear:
            return isochoric_stress(self.laws, f, hoop, self.shear)
        mean = (np.trace(strain, axis1=1, axis2=2) + across) / 3
        parts = [strain[:, 0, 0] - mean, strain[:, 1, 1] - mean, strain[:, 0, 1], across - mean]
        return 2 * self.shear[:, None] * np.stack(parts, axis=1)

    def _total(self, body):
        """Long-term isochoric stress (nr, 4) and, with the branches', the total one, Pa."""
        stress = self._isochoric(body)
        return stress, stress if self.branches is None else stress + self.branches.q.sum(0)

    def __call__(self, body, dt: float) -> None:
        """Follow one converged substep of ``dt`` seconds."""
        if self.branches is not None:
            self.branches.begin(dt)
            self.branches.commit(self._isochoric(body))

    def sample(self, body) -> dict[str, np.ndarray]:
        """What a receptor could respond to, (nr,) each, at the body's present state.

        The five strain energy densities (Pa, see :func:`strain_energies`), the principal strains
        (``compressive_strain`` and ``tensile_strain``: stretch less one, positive in
        compression and in tension; zero if there is none), ``von_mises_stress`` and
        ``hydrostatic_pressure`` (Cauchy, Pa, compression positive) and ``dilatation`` (J - 1 as the
        element projects it).
        """
        dilatation, (stress, total) = self._dilatation(body), self._total(body)
        f, hoop, jac, *strain, stretch = self._deformation(body)
        branches = []
        if self.branches is not None:
            branches = list(zip(self.branches.prony.beta, self.branches.q, strict=True))
        if self._linear:
            network = deviator_square(stress) / (4 * self.shear)
        else:
            network = isochoric_energy(self.laws, f, hoop, self.shear)
        volumetric = 0.5 * self.bulk * dilatation**2
        moduli = self.shear, self.shear_instantaneous
        deformed = f, hoop, *strain
        found = strain_energies(*deformed, stress, branches, network, *moduli, volumetric)
        stretch_across = 1 + strain[1] if self._linear else hoop
        tau = push_forward(f, hoop, total)
        found |= {
            "compressive_strain": np.maximum(1 - np.minimum(stretch[:, 0], stretch_across), 0),
            "tensile_strain": np.maximum(np.maximum(stretch[:, 1], stretch_across) - 1, 0),
            "von_mises_stress": np.sqrt(1.5 * deviator_square(tau)) / jac,
            "hydrostatic_pressure": -self.bulk * dilatation,
            "dilatation": dilatation,
        }
        if self.recovery is None:
            return found
        fitted = {name: self.recovery @ values for name, values in found.items()}
        for name in fitted.keys() - {"hydrostatic_pressure", "dilatation"}:
            fitted[name] = np.maximum(fitted[name], 0.0)  # a size, which a fit near zero may miss
        return fitted

    def stress_and_strain(self, body) -> dict[str, np.ndarray]:
        """``cauchy_stress`` (samples, 4: xx, yy, xy, zz) Pa, ``principal_strains`` (samples, 2:
        stretches less one, rising).
        """
        f, hoop, jac, *_, stretch = self._deformation(body)
        pressure = (self.bulk * self._dilatation(body))[:, None] * [1, 1, 0, 1]
        stress = push_forward(f, hoop, self._total(body)[1]) / jac[:, None] + pressure
        return {"cauchy_stress": stress, "principal_strains": stretch - 1}

    def _dilatation(self, body):
        return np.einsum("nb,nb->n", body.dilatation()[self.location.element], self.psi)


def logarithmic_strain(f: np.ndarray) -> np.ndarray:
    """Spatial logarithmic (Hencky) strain ``log(F F^T) / 2`` in the plane, (nr, 2, 2), of
    deformation gradients (nr, 2, 2).
    """
    squares, axes = np.linalg.eigh(f @ f.swapaxes(1, 2))
    return (axes * (0.5 * np.log(squares))[:, None, :]) @ axes.swapaxes(1, 2)


def strain_energies(
    f, hoop, strain, across, stress, branches, network, shear, shear_instantaneous, volumetric
):
    """Strain energy densities of a finite linear viscoelastic solid, Pa (J per undeformed m^3).

    Of shape only; ``volumetric``, kappa/2 (J - 1)^2, which does not relax, is added to each. With
    tau the Kirchhoff stress:

    * ``strain_energy_density`` (headline): the elastic energy that the total stress stands for on
      the instantaneous moduli,
      ``tau_dev : tau_dev / (4 G_0)``.
    * ``strain_energy_long_term_moduli``: the same on the long-term moduli, ``tau_dev : tau_dev / (4
      G_inf)``.
    * ``strain_energy_half_stress_strain``: ``tau_dev : h / 2`` with the total stress and the
      logarithmic strain h.
    * ``strain_energy_recoverable``: network plus the Maxwell springs, ``tau_i : tau_i / (4 G_i)``
      each.
    * ``strain_energy_network``: psi(C) of the long-term network alone.

    Without instantaneous moduli (None: no viscosity at all) there is one energy, psi(C), and all
    five are it.

    Parameters
    ----------
    f, hoop, strain, across
        Deformation gradient and strain in the section, (nr, 2, 2), and across it, (nr,).
    stress
        (nr, 4) long-term isochoric second Piola-Kirchhoff stress.
    branches
        Pairs (beta, (nr, 4) stress).
    network, volumetric
        (nr,) Pa, of shape and of volume.
    shear, shear_instantaneous
        (nr,) Pa.
    """
    total, springs = stress, 0.0
    for beta, q in branches:
        total = total + q
        springs = springs + deviator_square(push_forward(f, hoop, q)) / (4 * beta * shear)
    instantaneous = long_term = half = network
    if shear_instantaneous is not None:
        tau = push_forward(f, hoop, total)
        square, mean = deviator_square(tau), (tau[:, 0] + tau[:, 1] + tau[:, 3]) / 3
        instantaneous, long_term = square / (4 * shear_instantaneous), square / (4 * shear)
        half = (
            0.5 * ((tau[:, 0] - mean) * strain[:, 0, 0] + (tau[:, 1] - mean) * strain[:, 1, 1])
            + tau[:, 2] * strain[:, 0, 1]
            + 0.5 * (tau[:, 3] - mean) * across
        )
    energies = {
        "strain_energy_density": instantaneous,
        "strain_energy_long_term_moduli": long_term,
        "strain_energy_half_stress_strain": half,
        "strain_energy_recoverable": network + springs,
        "strain_energy_network": network,
    }
    return {name: energy + volumetric for name, energy in energies.items()}

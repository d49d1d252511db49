"""Mechanical state at chosen material points, with their own Prony history.

Receptor depths fall where they fall, not on quadrature points. What is sampled is treated like one more quadrature point (of zero
weight): displacement gradient and pressure are evaluated there exactly as the element interpolates them, and the branch stresses
follow the same recurrence as in the body. Receptors have what is fitted to samples round them (see :func:`_recovery`).

What is sampled are the stimuli that receptors have been said to respond to (Phillips and Johnson 1981; Srinivasan and Dandekar
1996). Five meanings of strain energy density (per undeformed volume) are kept apart, because under constant force they
disagree even in trend (see :func:`strain_energies`).
"""

from dataclasses import dataclass
from functools import cache

import numpy as np

from fingerpad.mechanics.finite_strain import deviator_square, isochoric_energy, isochoric_stress, push_forward
from fingerpad.mechanics.viscoelasticity import Branches
from fingerpad.specimen.near import nearest
from fingerpad.specimen.shapes import square_rule, triangle_rule


class ReceptorError(ValueError):
    """A receptor lies outside the meshed tissue."""


@dataclass(frozen=True)
class Location:
    """Where material points sit in a mesh: element (nr,), reference coordinates (nr, 2)."""

    element: np.ndarray
    xi: np.ndarray


@dataclass(frozen=True)
class Sums:
    """Weighted sums, one a receptor, of what is sampled: a matrix (nr, samples) by its rows.

    Attributes:
        weights, index: (m,) of all rows after each other, and of which sample. starts: (nr,) where each row begins.
    """

    weights: np.ndarray
    index: np.ndarray
    starts: np.ndarray

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Sums (nr, ...) of values (samples, ...)."""
        return np.add.reduceat((self.weights * values[self.index].T).T, self.starts, axis=0)


def containing(space, points, tolerance=1e-6):
    """Every element that each physical point (n, 2), m, lies in, borders included.

    Scikit-fem has no finder for curved elements, and its inverse of a curved map takes no point outside.

    Returns:
        The points' indices (m,), ascending and for each the element with the nearest centre first; their :class:`Location` (m,).

    Raises:
        ReceptorError: a point lies in no element.
    """
    centres = space.centres
    near = nearest(points, centres, 24)
    parts = [_among(space, points, near, tolerance)]
    for k in np.setdiff1d(np.arange(len(points)), parts[0][0]):  # beside a row of many narrow elements a long one is farther off
        every = np.argsort(np.hypot(*(centres - points[k]).T), kind="stable")[None]
        owner, element, xi = _among(space, points[[k]], every, tolerance)
        if not len(owner):
            x, y = points[k] * 1e3
            raise ReceptorError(f"receptor at x = {x:.3f} mm, y = {y:.3f} mm lies outside the soft tissue")
        parts.append((owner + k, element, xi))
    owner, element, xi = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = np.argsort(owner, kind="stable")
    return owner[order], Location(element[order], xi[order])


def _among(space, points, candidates, tolerance):
    """Which points (n, 2) lie in which of their candidates (n, k): indices (m,), elements (m,), reference coordinates (m, 2)."""
    nodes = space.points[space.cells[candidates]]
    low, high = nodes.min(2), nodes.max(2)
    # a quadratic side bulges beyond the box round its nodes by an eighth of it at most
    owner, column = np.nonzero((np.abs(points[:, None] - (low + high) / 2) <= 0.65 * (high - low)).all(2))
    element = candidates[owner, column]
    xi = _inverse_map(space.element, nodes[owner, column], points[owner])
    inside = (xi >= -tolerance).all(1)
    inside &= xi.sum(1) <= 1 + tolerance if space.element.triangle else (xi <= 1 + tolerance).all(1)
    return owner[inside], element[inside], xi[inside]


def _inverse_map(element, nodes, points):
    """Reference coordinates (m, 2) of points in elements of nodes (m, nen, 2) by Newton's method; nan where it fails."""
    xi = np.full((len(points), 2), 1 / 3 if element.triangle else 0.5)
    moving = np.arange(len(points))
    for _ in range(12):
        values, gradients = element.shape(xi[moving])
        residual = points[moving] - np.einsum("na,nai->ni", values, nodes[moving])
        (a, b), (c, d) = np.einsum("nai,naj->ijn", nodes[moving], gradients)
        with np.errstate(all="ignore"):
            step = np.stack([d * residual[:, 0] - b * residual[:, 1], a * residual[:, 1] - c * residual[:, 0]]) / (a * d - b * c)
        before = xi[moving]
        xi[moving] = np.clip(np.nan_to_num(before + step.T), -2.0, 3.0)
        moving = moving[np.abs(xi[moving] - before).max(1) > 1e-12]
    xi[moving] = np.nan
    return xi


def _layers(body):
    """(ne,) number of the material that each element is of: its shear modulus and its law."""
    laws = [part.elements[:, None] * np.column_stack([np.ones(len(part.constants)), part.constants]) for part in body.laws]
    layer = np.zeros(len(body.shear), int)
    for each in np.column_stack([body.shear, *laws]).T:  # one by one, for that is faster than whole rows
        values, number = np.unique(each, return_inverse=True)
        layer = np.unique(layer * len(values) + number, return_inverse=True)[1]
    return layer


def _mean_of_neighbours(space, layers, points):
    """Where points are sampled (:class:`Location`), (m,) whose each sample is, and its share in the mean.

    Strain jumps from element to element; a value from one side would tell left from right. So a point on a border takes the mean
    over the elements there that are of one layer with the nearest.
    """
    owner, found = containing(space, points)
    layer = layers[found.element]
    same = layer == layer[np.unique(owner, return_index=True)[1]][owner]
    owner, found = owner[same], Location(found.element[same], found.xi[same])
    return found, owner, 1 / np.bincount(owner)[owner]


class MaterialPoints:
    """Receptors in a body; an observer of the stepper.

    Args:
        body: the body they belong to. points: (nr, 2) undeformed positions, m.
        shear_instantaneous: (ne,) Pa, the moduli the headline strain energy is measured with; None for a purely elastic
            solid, whose strain energy has one meaning only. mirrored: the body is half of one that is symmetric in x = 0.

    Raises:
        ReceptorError: a point lies outside the mesh.
    """

    def __init__(self, body, points: np.ndarray, shear_instantaneous: np.ndarray, mirrored: bool = False):
        recovered = _recovery(body.space, _layers(body), np.atleast_2d(points), mirrored)
        self._place(body, *recovered, shear_instantaneous)

    @classmethod
    def centres(cls, body, shear_instantaneous: np.ndarray) -> "MaterialPoints":
        """A point in the middle of every element, in their order: the fields of a body as its receptors see them."""
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
        self.psi = space.pressure_modes(element, np.einsum("na,nai->ni", values, nodes))
        self.shear, self.bulk = body.shear[element], body.bulk[element]
        self.laws = tuple(part.at(element) for part in body.laws)
        self.shear_instantaneous = None if shear_instantaneous is None else np.asarray(shear_instantaneous)[element]
        self._linear = body.geometrically_linear
        prony = body.prony if self._linear else body.branches and body.branches.prony
        self.branches = Branches(prony, (len(element), 4)) if prony else None

    def _gradient(self, body):
        return np.einsum("nai,naj->nij", body.u[self.cells], self.grad)

    def _isochoric(self, body):
        if self._linear:
            gradient = self._gradient(body)
            strain = 0.5 * (gradient + gradient.swapaxes(1, 2))
            mean = np.trace(strain, axis1=1, axis2=2) / 3
            return (
                2
                * self.shear[:, None]
                * np.stack([strain[:, 0, 0] - mean, strain[:, 1, 1] - mean, strain[:, 0, 1], -mean], axis=1)
            )
        return isochoric_stress(self.laws, body.u, self.cells, self.grad, self.shear)

    def __call__(self, body, dt: float) -> None:
        """Follow one converged substep of ``dt`` seconds."""
        if self.branches is not None:
            self.branches.begin(dt)
            self.branches.commit(self._isochoric(body))

    def sample(self, body) -> dict[str, np.ndarray]:
        """What a receptor could respond to, (nr,) each, at the body's present state.

        The five strain energy densities (Pa, see :func:`strain_energies`), the principal strains in the plane
        (``compressive_strain`` and ``tensile_strain``: stretch less one, positive in compression and in tension; zero if
        there is none), ``von_mises_stress`` and ``hydrostatic_pressure`` (Cauchy, Pa, compression positive) and ``dilatation``
        (J - 1 as the element projects it).
        """
        gradient, dilatation = self._gradient(body), self._dilatation(body)
        stress = self._isochoric(body)
        branch = [] if self.branches is None else list(zip(self.branches.prony.beta, self.branches.q, strict=True))
        if self._linear:
            f, jac, strain = np.broadcast_to(np.eye(2), gradient.shape), 1.0, 0.5 * (gradient + gradient.swapaxes(1, 2))
            network = deviator_square(stress) / (4 * self.shear)
            stretch = 1 + np.linalg.eigvalsh(strain)
        else:
            f = np.eye(2) + gradient
            jac = f[:, 0, 0] * f[:, 1, 1] - f[:, 0, 1] * f[:, 1, 0]
            network = isochoric_energy(self.laws, f, self.shear)
            stretch, strain = np.linalg.svd(f, compute_uv=False)[:, ::-1], logarithmic_strain(f)
        volumetric = 0.5 * self.bulk * dilatation**2
        found = strain_energies(f, strain, stress, branch, network, self.shear, self.shear_instantaneous, volumetric)
        total = stress + sum((q for _, q in branch), np.zeros_like(stress))
        found |= {
            "compressive_strain": np.maximum(1 - stretch[:, 0], 0),
            "tensile_strain": np.maximum(stretch[:, 1] - 1, 0),
            "von_mises_stress": np.sqrt(1.5 * deviator_square(push_forward(f, total))) / jac,
            "hydrostatic_pressure": -self.bulk * dilatation,
            "dilatation": dilatation,
        }
        if self.recovery is None:
            return found
        least = {"hydrostatic_pressure": -np.inf, "dilatation": -np.inf}  # all others are sizes, which a fit near zero may miss
        return {name: np.maximum(self.recovery(values), least.get(name, 0.0)) for name, values in found.items()}

    def stress_and_strain(self, body) -> dict[str, np.ndarray]:
        """``cauchy_stress`` (samples, 4: xx, yy, xy, zz) Pa, ``principal_strains`` (samples, 2: stretches less one, rising)."""
        gradient = self._gradient(body)
        if self._linear:
            f, jac = np.broadcast_to(np.eye(2), gradient.shape), np.ones(len(gradient))
            strains = np.linalg.eigvalsh(0.5 * (gradient + gradient.swapaxes(1, 2)))
        else:
            f = np.eye(2) + gradient
            jac, strains = np.linalg.det(f), np.linalg.svd(f, compute_uv=False)[:, ::-1] - 1
        total = self._isochoric(body) + (0.0 if self.branches is None else self.branches.q.sum(0))
        stress = push_forward(f, total) / jac[:, None] + (self.bulk * self._dilatation(body))[:, None] * [1, 1, 0, 1]
        return {"cauchy_stress": stress, "principal_strains": strains}

    def _dilatation(self, body):
        return np.einsum("nb,nb->n", body.dilatation()[self.location.element], self.psi)


_EXACT = 1e-7
"""What polynomials may be off by in their own fit."""
FITTED = {"Q2P1": (square_rule(2)[0], 3), "Q1P0": (square_rule(1)[0], 2), "P2B": (triangle_rule(5)[0], 3)}
"""By element, the points of the reference cell that are sampled, and the degree of the polynomial fitted to what is there."""
_RADII = (1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 2.8)
"""Of the patch it is fitted on, in lengths of the element in the middle: the first that will do."""
_MOST = 5.0
"""Sum of the sizes of a fit's weights; one of more makes errors larger than they are beside the receptor."""


def _recovery(space, layers, points, mirrored):
    """Where to sample (:class:`Location`), and the sums (nr,) of samples that make values at points; None: samples are values.

    Strain is right to a power of the edges more at some points of an element: in the middle of a linear quad, at the 2 x 2 Gauss
    points of a quadratic one (Barlow 1976); a triangle's quadrature points are off either way. To what is there round a receptor,
    in elements of its layer that hang together, a polynomial is fitted (Zienkiewicz and Zhu 1992). Where there are too few, as in
    a layer of one row, and in elements of the teaching cases, values are those of the elements that the receptor lies in.
    """
    found, owner, share = _mean_of_neighbours(space, layers, points)
    fits = _fits(space, layers, points, owner, found, mirrored) if space.element.name in FITTED else {}
    if not fits and len(owner) == len(points):
        return found, None
    plain = ~np.isin(owner, list(fits))
    rule = FITTED[space.element.name][0] if fits else np.zeros((1, 2))
    used = np.unique(np.concatenate([sample for sample, _ in fits.values()] or [np.zeros(0, int)]))
    location = Location(
        np.concatenate([used // len(rule), found.element[plain]]), np.concatenate([rule[used % len(rule)], found.xi[plain]])
    )
    index = [np.searchsorted(used, sample) for sample, _ in fits.values()] + [len(used) + np.arange(np.count_nonzero(plain))]
    weights = [weight for _, weight in fits.values()] + [share[plain]]
    whose = [np.full(len(sample), k) for k, (sample, _) in fits.items()] + [owner[plain]]
    index, weights, whose = (np.concatenate(each) for each in (index, weights, whose))
    order = np.argsort(whose, kind="stable")
    return location, Sums(weights[order], index[order], np.unique(whose[order], return_index=True)[1])


def _fits(space, layers, points, owner, found, mirrored):
    """{point: (samples (m,), weights (m,))}, samples numbered element by element; only of points where a fit is good.

    Args:
        owner, found: of :func:`_mean_of_neighbours`.
    """
    nodes = space.points[space.cells[found.element]]
    inverse = np.linalg.inv(np.einsum("nai,naj->nij", space.element.shape(found.xi)[1], nodes))
    best, degree = FITTED[space.element.name]
    values = space.element.shape(best)[0]
    fits = {}
    for k, (own, elements) in enumerate(_patches(space, layers, owner, found.element)):
        place = np.einsum("qa,eai->eqi", values, space.points[space.cells[elements]]).reshape(-1, 2)
        sample = (len(values) * elements[:, None] + np.arange(len(values))).ravel()
        if mirrored:
            place, sample = np.concatenate([place, place * [-1, 1]]), np.tile(sample, 2)
        away = (place - points[k]) @ inverse[own]  # in lengths of each of the elements that the point lies in
        square = (away**2).sum(axis=2).mean(axis=0)
        for radius in _RADII:
            on = square < radius**2
            weights = _fitted(away[0, on] / radius, 1 - square[on] / radius**2, degree)
            if weights is not None:
                fits[k] = sample[on], weights
                break
    return fits


def _fitted(at, weight, degree):
    """Weights (m,) of values at points (m, 2) in their best polynomial's value at the origin; None where they are too few."""
    powers = [(i, j) for i in range(degree + 1) for j in range(degree + 1 - i)]
    if len(at) < len(powers):
        return None
    terms = weight[:, None] * np.stack([at[:, 0] ** i * at[:, 1] ** j for i, j in powers], axis=1)
    one = np.eye(len(powers))[0]
    try:
        out = terms @ np.linalg.solve(terms.T @ terms, one) * weight
    except np.linalg.LinAlgError:
        return None
    exact = np.abs((terms / weight[:, None]).T @ out - one).max() < _EXACT
    return out if exact and np.abs(out).sum() <= _MOST else None


def _patches(space, layers, owner, element):
    """Of every point which of some elements (m,) it lies in, and all of its layer that share a node with these, or the next."""
    corners = space.cells[:, : 3 if space.element.triangle else 4]
    order = np.argsort(corners.ravel(), kind="stable")
    ends = np.searchsorted(corners.ravel()[order], np.arange(len(space.points) + 1))
    owners = order // corners.shape[1]

    @cache
    def around(elements):
        near = np.concatenate([owners[ends[node] : ends[node + 1]] for node in np.unique(corners[list(elements)])])
        return tuple(np.unique(near[layers[near] == layers[elements[0]]]))

    for own in np.split(np.arange(len(owner)), np.flatnonzero(np.diff(owner)) + 1):
        yield own, np.array(around(around(tuple(element[own]))))


def logarithmic_strain(f: np.ndarray) -> np.ndarray:
    """Spatial logarithmic (Hencky) strain ``log(F F^T) / 2`` in the plane, (nr, 2, 2), of deformation gradients (nr, 2, 2)."""
    b = f @ f.swapaxes(1, 2)
    mean = 0.5 * np.trace(b, axis1=1, axis2=2)
    share = np.hypot(0.5 * (b[:, 0, 0] - b[:, 1, 1]), b[:, 0, 1]) / mean
    factor = np.where(share > 1e-6, np.arctanh(share) / np.maximum(share, 1e-6), 1.0) / (2 * mean)
    swelling = 0.5 * np.log(np.linalg.det(f)) - factor * mean
    return factor[:, None, None] * b + swelling[:, None, None] * np.eye(2)


def strain_energies(f, strain, stress, branches, network, shear, shear_instantaneous, volumetric):
    """Strain energy densities of a finite linear viscoelastic solid, Pa (J per undeformed m^3).

    Of shape only; ``volumetric``, kappa/2 (J - 1)^2, which does not relax, is added to each. With tau the Kirchhoff stress:

    * ``strain_energy_density`` (headline): the elastic energy that the total stress stands for on the instantaneous moduli,
      ``tau_dev : tau_dev / (4 G_0)``.
    * ``strain_energy_long_term_moduli``: the same on the long-term moduli, ``tau_dev : tau_dev / (4 G_inf)``.
    * ``strain_energy_half_stress_strain``: ``tau_dev : h / 2`` with the total stress and the logarithmic strain h.
    * ``strain_energy_recoverable``: network plus the Maxwell springs, ``tau_i : tau_i / (4 G_i)`` each.
    * ``strain_energy_network``: psi(C) of the long-term network alone.

    Without instantaneous moduli (None: no viscosity at all) there is one energy, psi(C), and all five are it.

    Args:
        f, strain: (nr, 2, 2), in the plane. stress: (nr, 4) long-term isochoric second Piola-Kirchhoff stress. branches: pairs
            (beta, (nr, 4) stress). network, volumetric: (nr,) Pa, of shape and of volume. shear, shear_instantaneous: (nr,) Pa.
    """
    total, springs = stress, 0.0
    for beta, q in branches:
        total = total + q
        springs = springs + deviator_square(push_forward(f, q)) / (4 * beta * shear)
    instantaneous = long_term = half = network
    if shear_instantaneous is not None:
        tau = push_forward(f, total)
        square, mean = deviator_square(tau), (tau[:, 0] + tau[:, 1] + tau[:, 3]) / 3
        instantaneous, long_term = square / (4 * shear_instantaneous), square / (4 * shear)
        half = 0.5 * ((tau[:, 0] - mean) * strain[:, 0, 0] + (tau[:, 1] - mean) * strain[:, 1, 1]) + tau[:, 2] * strain[:, 0, 1]
    energies = {
        "strain_energy_density": instantaneous,
        "strain_energy_long_term_moduli": long_term,
        "strain_energy_half_stress_strain": half,
        "strain_energy_recoverable": network + springs,
        "strain_energy_network": network,
    }
    return {name: energy + volumetric for name, energy in energies.items()}

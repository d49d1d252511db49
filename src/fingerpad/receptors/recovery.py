"""Where receptors are in a mesh, and what they read of it: fits to the points round them at which
an element's strain is best.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import KDTree

from fingerpad.specimen.element_kinds import KINDS

_EXACT = 1e-7
"""What polynomials may be off by in their own fit."""
FITTED = {
    "Q2P1": (KINDS["quad9"].rule(3)[0], 3),
    "Q1P0": (np.array([[0.5, 0.5]]), 2),
    "P2B": (KINDS["tri7"].rule(5)[0], 3),
}
"""By element, the points of the reference cell that are sampled, and the degree of the polynomial
fitted to what is there.
"""
_BORDER = 1e-6
"""Reference coordinates that a point may lie outside an element."""
_RADII = (1.2, 1.3, 1.4, 1.5, 1.6, 1.8, 2.0, 2.2, 2.5, 2.8)
"""Of the patch it is fitted on, in lengths of the element in the middle: the first that will do."""
_MOST = 5.0
"""Sum of the sizes of a fit's weights; one of more makes errors larger than they are beside the
receptor.
"""


class ReceptorError(ValueError):
    """A receptor lies outside the meshed tissue."""


@dataclass(frozen=True)
class Location:
    """Where material points sit in a mesh: element (nr,), reference coordinates (nr, 2)."""

    element: np.ndarray
    xi: np.ndarray


def containing(space, points):
    """Every element that each physical point (n, 2), m, lies in, borders included.

    Scikit-fem has no finder for curved elements, and its inverse of a curved map takes no point
    outside.

    Returns
    -------
    result
        The points' indices (m,), ascending and for each the element with the nearest centre first;
        their :class:`Location` (m,).

    Raises
    ------
    ReceptorError
        A point lies in no element.
    """
    centres = space.centres
    near = KDTree(centres).query(points, np.arange(1, min(24, len(centres)) + 1))[1]
    parts = [_among(space, points, near)]
    # beside a row of many narrow elements a long one is farther off
    for k in np.setdiff1d(np.arange(len(points)), parts[0][0]):
        every = np.argsort(np.hypot(*(centres - points[k]).T), kind="stable")[None]
        owner, element, xi = _among(space, points[[k]], every)
        if not len(owner):
            x, y = points[k] * 1e3
            raise ReceptorError(
                f"receptor at x = {x:.3f} mm, y = {y:.3f} mm lies outside the soft tissue"
            )
        parts.append((owner + k, element, xi))
    owner, element, xi = (np.concatenate(part) for part in zip(*parts, strict=True))
    order = np.argsort(owner, kind="stable")
    return owner[order], Location(element[order], xi[order])


def _among(space, points, candidates):
    """Which points (n, 2) lie in which of their candidates (n, k): indices (m,), elements (m,),
    reference coordinates (m, 2).
    """
    nodes = space.points[space.cells[candidates]]
    low, high = nodes.min(2), nodes.max(2)
    # a quadratic side bulges beyond the box round its nodes by an eighth of it at most
    owner, column = np.nonzero(
        (np.abs(points[:, None] - (low + high) / 2) <= 0.65 * (high - low)).all(2)
    )
    element = candidates[owner, column]
    xi = _inverse_map(space.element, nodes[owner, column], points[owner])
    most = xi.sum(1) if space.element.triangle else xi.max(1)
    inside = (xi.min(1) >= -_BORDER) & (most <= 1 + _BORDER)
    return owner[inside], element[inside], xi[inside]


def _inverse_map(element, nodes, points):
    """Reference coordinates (m, 2) of points in elements of nodes (m, nen, 2) by Newton's method;
    nan where it fails.
    """
    xi = np.full((len(points), 2), 1 / 3 if element.triangle else 0.5)
    moving = np.arange(len(points))
    for _ in range(12):
        values, gradients = element.shape(xi[moving])
        residual = points[moving] - np.einsum("na,nai->ni", values, nodes[moving])
        (a, b), (c, d) = np.einsum("nai,naj->ijn", nodes[moving], gradients)
        with np.errstate(all="ignore"):
            step = np.stack(
                [d * residual[:, 0] - b * residual[:, 1], a * residual[:, 1] - c * residual[:, 0]]
            ) / (a * d - b * c)
        before = xi[moving]
        xi[moving] = np.clip(np.nan_to_num(before + step.T), -2.0, 3.0)
        moving = moving[np.abs(xi[moving] - before).max(1) > 1e-12]
    xi[moving] = np.nan
    return xi


def _mean_of_neighbours(space, layers, points):
    """Where points are sampled (:class:`Location`), (m,) whose each sample is, and its share in the
    mean.

    Strain jumps from element to element; a value from one side would tell left from right. So a
    point on a border takes the mean over the elements there that are of one layer with the nearest.
    """
    owner, found = containing(space, points)
    layer = layers[found.element]
    same = layer == layer[np.unique(owner, return_index=True)[1]][owner]
    owner, found = owner[same], Location(found.element[same], found.xi[same])
    return found, owner, 1 / np.bincount(owner)[owner]


def recovery(space, layers, points, mirrored):
    """Where to sample (:class:`Location`), and the matrix (nr, samples) that makes values at points
    of samples; None: samples are values.

    Strain is right to a power of the edges more at some points of an element: in the middle of a
    linear quad, at the 2 x 2 Gauss points of a quadratic one (Barlow 1976); a triangle's quadrature
    points are off either way. To what is there round a receptor, in elements of its layer that hang
    together, a polynomial is fitted (Zienkiewicz and Zhu 1992). Where there are too few, as in a
    layer of one row, and in elements of the teaching cases, values are those of the elements that
    the receptor lies in.

    Parameters
    ----------
    space
        :class:`fingerpad.mechanics.space.Space`.
    layers
        (ne,) number of each element's material.
    points
        (nr, 2) m.
    mirrored
        The mesh is half of one that is symmetric in x = 0; what is fitted goes over the axis.

    Raises
    ------
    ReceptorError
        A point lies in no element.
    """
    if not len(points):
        return Location(np.zeros(0, int), np.zeros((0, 2))), None
    found, owner, share = _mean_of_neighbours(space, layers, points)
    best, degree = FITTED.get(space.element.name, (np.zeros((1, 2)), None))
    row, sample, weight = _fits(space, layers, points, owner, found, mirrored, best, degree)
    if not len(row) and len(owner) == len(points):
        return found, None
    plain = ~np.isin(owner, row)
    used, column = np.unique(sample, return_inverse=True)
    element, of_best = np.divmod(used, len(best))
    location = Location(
        np.append(element, found.element[plain]), np.concatenate([best[of_best], found.xi[plain]])
    )
    column = np.append(column, len(used) + np.arange(np.count_nonzero(plain)))
    places = np.append(row, owner[plain]), column
    return location, csr_array((np.append(weight, share[plain]), places))


def _fits(space, layers, points, owner, found, mirrored, best, degree):
    """Point, sample and weight (m,) of all that is summed for points where a fit is good; samples
    are numbered element by element.

    Parameters
    ----------
    owner, found
        Of :func:`_mean_of_neighbours`.
    best, degree
        Of :data:`FITTED`; the degree is None where nothing is fitted.
    """
    fits = [(np.zeros(0, int), np.zeros(0, int), np.zeros(0))]
    if degree is None:
        return fits[0]
    nodes = space.points[space.cells[found.element]]
    inverse = np.linalg.inv(np.einsum("nai,naj->nij", space.element.shape(found.xi)[1], nodes))
    values = space.element.shape(best)[0]
    for k, (own, elements) in enumerate(_patches(space, layers, owner, found.element)):
        place = np.einsum("qa,eai->eqi", values, space.points[space.cells[elements]]).reshape(-1, 2)
        sample = (len(values) * elements[:, None] + np.arange(len(values))).ravel()
        if mirrored:
            place, sample = np.concatenate([place, place * [-1, 1]]), np.tile(sample, 2)
        # in lengths of each of the elements that the point lies in
        away = (place - points[k]) @ inverse[own]
        square = (away**2).sum(axis=2).mean(axis=0)
        for radius in _RADII:
            on = square < radius**2
            weights = _fitted(away[0, on] / radius, 1 - square[on] / radius**2, degree)
            if weights is not None:
                fits.append((np.full(len(weights), k), sample[on], weights))
                break
    return [np.concatenate(parts) for parts in zip(*fits, strict=True)]


def _fitted(at, weight, degree):
    """Weights (m,) of values at points (m, 2) in their best polynomial's value at the origin; None
    where they are too few.
    """
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
    """Of every point which of some elements (m,) it lies in, and all of its layer that share a node
    with these, or the next.
    """
    corners = space.cells[:, : 3 if space.element.triangle else 4]
    number = np.repeat(np.arange(len(corners)), corners.shape[1])
    has_node = csr_array((np.ones(corners.size), (number, corners.ravel())))
    neighbours = has_node @ has_node.T
    for own in np.split(np.arange(len(owner)), np.flatnonzero(np.diff(owner)) + 1):
        near = element[own]
        for _ in range(2):
            around = np.unique(neighbours[near].indices)
            near = around[layers[around] == layers[near[0]]]
        yield own, near

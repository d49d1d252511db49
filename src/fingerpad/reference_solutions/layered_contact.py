"""A rigid profile pressed without friction on a stack of bonded layers, plane strain, small strain.

Numerical but independent of finite elements: pressures on a regular grid, one Fourier kernel
(:func:`layered.stack_compliance`), and an exact active set. The problem is periodic and even, which
is the same as a strip whose two sides slide on smooth walls. Error of first order in the grid
spacing at the contact's edge. Source of the approach: K. L. Johnson, *Contact Mechanics* (1985),
section 5.9; I. A. Polonsky & L. M. Keer (1999).
"""

from dataclasses import dataclass

import numpy as np

from . import layered


@dataclass(frozen=True)
class StripContact:
    """Solution on the half strip 0 <= x <= L: ``x`` (n,) m, ``pressure`` (n,) Pa, ``depth`` m.

    ``force`` is that of both halves, N/m. ``half_width`` lies midway between the last grid point in
    contact and the first one out of it.
    """

    x: np.ndarray
    pressure: np.ndarray
    force: float
    depth: float
    half_width: float


def press(profile, layers, half_length, force, points=512):
    """Press a rigid even profile on a strip of the given half length; returns a
    :class:`StripContact`.

    ``profile``: callable x -> height of the rigid surface above its lowest point, m (at x = 0 ..
    half_length); ``force`` N/m over the whole width. ``depth`` is how far the lowest point went
    below the undeformed surface.
    Raises ``ValueError`` for a force <= 0 or a contact that covers the whole strip,
    ``RuntimeError`` when the active set does not settle.
    """
    if not force > 0:
        raise ValueError("force must be positive")
    spacing = half_length / points
    x = (np.arange(points) + 0.5) * spacing
    modes = np.arange(points)
    wavenumbers = modes * np.pi / half_length
    compliance = np.array([layered.stack_compliance(k, layers) for k in wavenumbers])
    shape = np.cos(np.outer(x, wavenumbers))
    weight = np.where(modes == 0, 1.0, 2.0) / points
    influence = (shape * (compliance * weight)) @ shape.T
    gap = np.asarray(profile(x), dtype=float)

    contact = np.ones(points, dtype=bool)
    for _ in range(200):
        size = contact.sum()
        system = np.zeros((size + 1, size + 1))
        system[:size, :size] = influence[np.ix_(contact, contact)]
        system[:size, size] = -1.0
        system[size, :size] = 2 * spacing
        solution = np.linalg.solve(system, np.append(-gap[contact], force))
        depth, pressure = solution[-1], np.zeros(points)
        pressure[contact] = solution[:-1]
        overlap = depth - gap - influence @ pressure
        updated = np.where(contact, pressure > 0, overlap > 0)
        if np.array_equal(updated, contact):
            break
        contact = updated
    else:
        raise RuntimeError("the active set did not settle")
    if contact.all():
        raise ValueError("the contact covers the whole strip")
    return StripContact(x, pressure, force, depth, x[contact].max() + spacing / 2)

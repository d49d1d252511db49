"""The strain energy that the thesis's figures show: most likely that of a formula of plane stress.

The thesis prints nu = 0.48 and plane strain. Its energies, of presses and strokes, in the epidermis
and in the dermis, are those that the formula of plane stress gives the stresses in the plane,
``(sigma_1^2 + sigma_2^2 - 2 nu sigma_1 sigma_2) / 2 E``, times one factor (`snakemake
reconstruction`, tables reconstruction_ways and reconstruction_readings). The stress across the
plane is left out there. The energy of shape is then the right one, and the energy of volume counts
`plane_stress_share` times.
"""

from __future__ import annotations

import numpy as np
import xarray as xr

NU = 0.48
"""Poisson's ratio, printed in section 3.4."""
FACTOR = 0.4
"""On all energies, so that they are on the thesis's axes; fitted to the evidence of
``config/reference/reconstruction_evidence.csv``, whose rows therefore count as fitted.
"""
ELASTIC = "strain_energy_elastic"
"""What the strain energy density of a history is called once that of 1999 has its name."""


def plane_stress_share(nu: float = NU) -> float:
    """How many times a formula of plane stress counts the energy of volume of plane strain.

    In the plane the mean stress s has ``s^2 / E = 3 V / (2 (1 - 2 nu) (1 + nu)^2)``, V being the
    energy of volume, and the formula counts ``s^2 / E`` by ``1 - nu`` where ``(1 + nu) (1 - 2 nu)^2
    / 3`` is of shape.

    Examples
    --------
    >>> round(plane_stress_share(0.48), 2)
    8.89
    """
    square = 1.5 / ((1 - 2 * nu) * (1 + nu) ** 2)
    return square * (1 - nu - (1 + nu) * (1 - 2 * nu) ** 2 / 3)


def volume_energy(history: xr.Dataset) -> np.ndarray:
    """The part (time, receptor) Pa of the strain energy that is of volume, kappa/2 (J - 1)^2."""
    return -0.5 * history["hydrostatic_pressure"].values * history["dilatation"].values


def as_of_1999(history: xr.Dataset) -> xr.Dataset:
    """The history with the strain energy density of 1999; the elastic one is kept as `ELASTIC`.

    A history without receptors is as it was.
    """
    if "dilatation" not in history or "strain_energy_density" not in history:
        return history
    elastic = history["strain_energy_density"]
    shown = FACTOR * (elastic + (plane_stress_share() - 1) * volume_energy(history))
    shown.attrs = elastic.attrs | {"long_name": "strain energy density, formula of plane stress"}
    return history.assign({ELASTIC: elastic, "strain_energy_density": shown})

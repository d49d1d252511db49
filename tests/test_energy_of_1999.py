"""The energy that the thesis's figures show, against stresses and energies in closed form."""

import numpy as np
import pytest
import xarray as xr

from cysyk1999.measures.energy_of_1999 import ELASTIC, FACTOR, as_of_1999, plane_stress_share

pytestmark = pytest.mark.unit


def _state(a, b, nu, young):
    """Energies of shape and of volume of principal stresses in plane strain, pressure, dilatation,
    and the energy by the formula of plane stress.
    """
    stress = np.array([a, b, nu * (a + b)])
    mean, shear, kappa = stress.mean(), young / (2 * (1 + nu)), young / (3 * (1 - 2 * nu))
    shape, volume = ((stress - mean) ** 2).sum() / (4 * shear), mean**2 / (2 * kappa)
    return shape, volume, -mean, mean / kappa, (a**2 + b**2 - 2 * nu * a * b) / (2 * young)


@pytest.mark.parametrize("nu", [0.3, 0.48])
def test_a_formula_of_plane_stress_counts_the_energy_of_volume_more_often(nu):
    rng = np.random.default_rng(4)
    for a, b in rng.normal(size=(20, 2)):
        shape, volume, _, _, formula = _state(a, b, nu, 3.0)
        assert formula == pytest.approx(shape + plane_stress_share(nu) * volume)


def test_a_history_gets_that_energy_and_keeps_the_elastic_one():
    states = np.array([_state(a, -500.0, 0.48, 15e3) for a in (-4000.0, -100.0, 300.0)])
    shape, volume, pressure, dilatation, formula = states.T[..., None]
    names = ("strain_energy_density", "hydrostatic_pressure", "dilatation")
    values = zip(names, (shape + volume, pressure, dilatation), strict=True)
    history = xr.Dataset({name: (("time", "receptor"), v) for name, v in values})
    found = as_of_1999(history)
    assert found["strain_energy_density"].values == pytest.approx(FACTOR * formula)
    assert found[ELASTIC].values == pytest.approx(shape + volume)
    bare = xr.Dataset({"force": ("time", np.zeros(3))})
    assert as_of_1999(bare) is bare

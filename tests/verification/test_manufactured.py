"""Convergence to manufactured solutions (Roache 2002): small, finite, compressible, nearly not."""

import numpy as np
import pytest
from meshes import KIND, rectangle
from problems import (
    SIDES,
    boundary,
    l2_error,
    lame_constants,
    load_of_stress,
    make_body,
    solve,
    two_numbers,
)

from fingerpad.reference_solutions import manufactured

RATE = {"Q1P0": 2.0, "Q2P1": 3.0, "P2B": 3.0}
#: Relative L2 error of the displacement on the finest mesh, as it was when these tests were
#: written.
POISSON = (0.3, 0.4999)
FROZEN = {
    ("Q1P0", "small"): (2.597432e-03, 2.808367e-03),
    ("Q1P0", "finite"): (2.455453e-03, 2.384044e-03),
    ("Q2P1", "small"): (1.915304e-05, 1.972683e-05),
    ("Q2P1", "finite"): (2.243552e-05, 2.059587e-05),
    ("P2B", "small"): (4.585105e-05, 8.782767e-05),
    ("P2B", "finite"): (2.976046e-05, 2.613801e-05),
}
PRESSURE_MODULUS = 0.5  # Pa; the field's pressure, whatever the bulk modulus


def errors(element, strain, poisson, ran_as=None, force_poisson=None):
    """Relative L2 errors of the displacement on distorted meshes of 4, 8 and 16 elements a side."""
    shear, bulk = lame_constants(1.0, poisson)
    if strain == "small":
        isochoric, stress = manufactured.divergence_free(0.1, 2.0), manufactured.small_strain_stress
    else:
        isochoric, stress = (
            manufactured.isochoric_shears(0.08, 2.5),
            manufactured.first_piola_stress,
        )
    field = manufactured.nearly_incompressible(
        isochoric, manufactured.gradient_of_potential(0.1, 2.0), bulk, PRESSURE_MODULUS
    )
    loaded = lame_constants(1.0, force_poisson or poisson)
    found = []
    for count in (4, 8, 16):
        mesh = rectangle(count, count, kind=KIND[element], distortion=0.15)
        body = make_body(mesh, boundary(mesh, *SIDES), shear, bulk, ran_as or element, strain)
        load = load_of_stress(body.space, lambda x: stress(field, x, *loaded))
        solve(body, load, field.displacement(body.space.points))
        found.append(l2_error(body.space, body.u, field.displacement))
    return np.array(found)


def check_rates(element, strain, poisson, **mutant):
    found = errors(element, strain, poisson, **mutant)
    rates = np.log2(found[:-1] / found[1:])
    assert rates[-1] > RATE[element] - 0.1, f"truth: rates {rates} instead of {RATE[element]}"
    assert found[-1] < (4e-3 if element == "Q1P0" else 1e-4), f"truth: the error is {found[-1]:.2e}"
    frozen = FROZEN[element, strain][POISSON.index(poisson)]
    two_numbers(found[-1], truth=frozen, within=0.1, frozen=frozen, tight=1e-4)


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize(("element", "strain"), FROZEN)
def test_rates(element, strain, poisson, must_fail):
    """Displacements converge in L2 at the order of the element, 2 or 3, at nu = 0.3 and 0.4999
    alike.
    """
    check_rates(element, strain, poisson)
    if poisson == 0.3:
        must_fail(check_rates, element, strain, poisson, force_poisson=0.31)
    elif element == "Q1P0":
        must_fail(check_rates, element, strain, poisson, ran_as="Q1")  # locks
    elif element == "Q2P1":
        must_fail(check_rates, element, strain, poisson, ran_as="Q2")  # converges late

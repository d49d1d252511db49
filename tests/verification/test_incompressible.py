"""Nearly incompressible bodies do not lock: thick cylinder and Cook's membrane up to nu =
0.4999.
"""

import numpy as np
import pytest
from meshes import KIND, cook_membrane, nodes_of, quarter_annulus
from problems import boundary, lame_constants, make_body, solve, two_numbers

from fingerpad.mechanics.space import edge_load_vectors
from fingerpad.reference_solutions import cook, lame

INNER, OUTER, YOUNG = 3.0, 9.0, 1000.0  # MacNeal and Harder (1985)


def pressurised_cylinder(element, strain, poisson, pressure=1.0):
    """Radial displacement of the bore."""
    mesh = quarter_annulus(6, 8, INNER, OUTER, KIND[element])
    fixed = np.zeros(mesh.points.shape, bool)
    fixed[nodes_of(mesh, "bottom"), 1] = True
    fixed[nodes_of(mesh, "top"), 0] = True
    body = make_body(mesh, fixed, *lame_constants(YOUNG, poisson), element, strain)
    load = np.zeros_like(body.u)
    load[: len(mesh.points)] = -pressure * edge_load_vectors(mesh.points, mesh.curves["left"])
    solve(body, load, tolerance=1e-9)
    bore = nodes_of(mesh, "left")
    return np.hypot(*(mesh.points[bore] + body.u[bore]).T).mean() - INNER


def check_cylinder(element, poisson, ran_as=None, solved_poisson=None):
    value = pressurised_cylinder(ran_as or element, "small", solved_poisson or poisson)
    truth = float(lame.radial_displacement(INNER, INNER, OUTER, YOUNG, poisson, internal=1.0))
    within = 1.5e-2 if element == "Q1P0" else 5e-4
    frozen = CYLINDER[element][POISSON.index(poisson)]
    two_numbers(value, truth=truth, within=within, frozen=frozen)


POISSON = (0.3, 0.49, 0.499, 0.4999)
CYLINDER = {
    "Q1P0": (4.55218583e-03, 5.00518029e-03, 5.02529468e-03, 5.02729943e-03),
    "Q2P1": (4.58249557e-03, 5.03991992e-03, 5.06024414e-03, 5.06226988e-03),
    "P2B": (4.58248202e-03, 5.03990496e-03, 5.06022916e-03, 5.06225489e-03),
}


@pytest.mark.parametrize("poisson", POISSON)
@pytest.mark.parametrize("element", CYLINDER)
def test_thick_cylinder(element, poisson, must_fail):
    """A pressurised thick cylinder widens as Lame's solution says, at any nu (MacNeal and Harder
    1985).
    """
    check_cylinder(element, poisson)
    must_fail(check_cylinder, element, poisson, solved_poisson=0.2)
    if poisson >= 0.499:
        must_fail(check_cylinder, element, poisson, ran_as="Q1")


def check_finite_cylinder(pressure=0.1, poisson=0.4999):
    value = pressurised_cylinder("Q2P1", "finite", poisson, pressure) / pressure
    truth = float(lame.radial_displacement(INNER, INNER, OUTER, YOUNG, 0.4999, internal=1.0))
    two_numbers(value, truth=truth, within=5e-4, frozen=FINITE_CYLINDER)


FINITE_CYLINDER = 5.06241228e-03


def test_thick_cylinder_at_finite_strain(must_fail):
    """The finite-strain body meets Lame's solution at small pressure, and leaves it under a large
    one.
    """
    check_finite_cylinder()
    must_fail(check_finite_cylinder, pressure=50.0)
    must_fail(check_finite_cylinder, poisson=0.3)


def tip_deflection(element, case, count, poisson=None):
    """Vertical displacement at the middle of the right edge and at its upper corner."""
    case = cook.CASES[case]
    mesh = cook_membrane(count, KIND[element])
    fixed = boundary(mesh, "left")
    shear, bulk = lame_constants(case.youngs_modulus, poisson or case.poisson_ratio)
    body = make_body(mesh, fixed, shear, bulk, element)
    load = np.zeros_like(body.u)
    outward = edge_load_vectors(mesh.points, mesh.curves["right"])[:, 0]
    load[: len(outward), 1] = case.total_load / 16.0 * outward
    solve(body, load, tolerance=1e-9)
    at = [np.hypot(*(mesh.points - point).T).argmin() for point in (cook.MID_EDGE, cook.CORNER)]
    return body.u[at, 1]


def check_cook(element, case, count, within, ran_as=None, poisson=None):
    mid, corner = tip_deflection(ran_as or element, case, count, poisson)
    truth, frozen = cook.CASES[case], COOK[element, case]
    if truth.mid_edge:
        two_numbers(mid, truth=truth.mid_edge, within=within, frozen=frozen[0])
    if truth.corner:  # converges slowly
        two_numbers(corner, truth=truth.corner, within=2 * within, frozen=frozen[1])


COOK = {  # middle and upper corner
    ("Q1P0", "plane_strain_compressible"): (30.6311421, 32.0135366),
    ("Q1P0", "nearly_incompressible"): (7.6476445, 7.9963811),
    ("Q1P0", "kasper_taylor"): (7.3590224, 7.6945977),
    ("Q2P1", "plane_strain_compressible"): (30.7373810, 32.2025922),
    ("Q2P1", "nearly_incompressible"): (7.6844931, 8.0475392),
    ("Q2P1", "kasper_taylor"): (7.3944804, 7.7438251),
    ("P2B", "plane_strain_compressible"): (30.7083288, 32.1000611),
    ("P2B", "nearly_incompressible"): (7.6531562, 7.9828036),
    ("P2B", "kasper_taylor"): (7.3643261, 7.6815326),
}


@pytest.mark.parametrize(
    "case", ["plane_strain_compressible", "nearly_incompressible", "kasper_taylor"]
)
@pytest.mark.parametrize(
    "element, count, within", [("Q1P0", 32, 1e-2), ("Q2P1", 16, 6e-3), ("P2B", 16, 6e-3)]
)
def test_cook_membrane(element, case, count, within, must_fail):
    """Cook's membrane bends as far as published, for nu = 1/3 and nu = 0.4999."""
    check_cook(element, case, count, within)
    must_fail(check_cook, element, case, count, within, poisson=0.2)
    if case != "plane_strain_compressible":
        must_fail(check_cook, element, case, count, within, ran_as="Q1")


def test_plain_quads_lock_as_published():
    """The locking witness: plain four-node quads on 16 x 16 give 2.41 instead of 7.695."""
    mid, _ = tip_deflection("Q1", "nearly_incompressible", 16)
    two_numbers(mid, truth=cook.LOCKED_Q1[16], within=3e-3, frozen=LOCKED, tight=1e-6)


LOCKED = 2.4073290

"""What the verification problems share: bodies, consistent loads, Newton's method, norms, the two
numbers.
"""

import numpy as np
from skfem import ElementQuad2, ElementTriP2
from skfem.quadrature import get_quadrature

from fingerpad.mechanics.finite_strain import FiniteStrainBody
from fingerpad.mechanics.linear_solver import condensation
from fingerpad.mechanics.small_strain import SmallStrainBody
from fingerpad.mechanics.space import Space
from fingerpad.specimen.materials import Prony, moduli

SIDES = ("left", "right", "bottom", "top")
BODIES = {"small": SmallStrainBody, "finite": FiniteStrainBody}


def two_numbers(value, *, truth, within, frozen, tight=1e-6):
    """Assert ``value`` is near the truth and (tighter) what this code gave when the test was
    written.
    """
    assert abs(value - truth) <= within * abs(truth), (
        f"truth: {value!r} is not {truth!r} within {within:g}"
    )
    assert abs(value - frozen) <= tight * abs(frozen), (
        f"frozen: {value!r} is not {frozen!r} within {tight:g}"
    )


def close(value, truth, what="", **tolerance):
    """Assert arrays are near the truth, as ``np.testing.assert_allclose`` does."""
    np.testing.assert_allclose(value, truth, err_msg=f"truth: {what}", **tolerance)


def boundary(mesh, *curves):
    """(n, 2) bool, true at the nodes of some curves."""
    fixed = np.zeros(mesh.points.shape, bool)
    for name in curves:
        fixed[mesh.curves[name]] = True
    return fixed


def lame_constants(youngs_modulus, poisson):
    """Shear and bulk modulus, as the package converts them."""
    known = moduli(youngs_modulus, poisson, Prony())
    return float(known.shear_long_term), float(known.bulk)


def make_body(mesh, fixed, shear, bulk, element=None, strain="small", prony=None):
    """Body with one material, or one a region; ``fixed`` (n, 2) bool; with Prony, long-term
    moduli.
    """
    space = Space(mesh.points, mesh.cells, mesh.element, fixed, element)
    shear, bulk = np.broadcast_to(shear, 3), np.broadcast_to(bulk, 3)
    return BODIES[strain](space, shear[mesh.region], bulk[mesh.region], prony)


def solve(body, external, start=None, tolerance=1e-11, most=30):
    """Equilibrium under nodal forces (n, 2) from the displacement ``start`` (its fixed values
    stay).

    Plain full Newton steps to round-off, without the solver's own stepping or tolerances. The start
    may be far from volume-preserving, so its dilatation is not taken for a pressure.

    Returns the number of Newton iterations. Raises ``RuntimeError`` when they do not converge.
    """
    if start is not None:
        body.displace(start, np.zeros_like(body.dilatation()))
    space = body.space
    solver = condensation(space.pattern, np.empty(0, dtype=np.int64))
    for iteration in range(most):
        _, internal = body.linearise(solver)
        solver.forward(space.to_equations(external - internal))
        step = space.to_nodes(solver.backward(np.empty(0)))
        body.advance(step)
        if np.abs(step).max() <= tolerance * max(np.abs(body.u).max(), 1e-30):
            return iteration + 1
    raise RuntimeError("Newton's method did not converge")


def _fine_quadrature(space, degree=8):
    """Of a rule of high degree: positions (ne, nq, 2), weights (ne, nq), shape functions (nq, nen)
    and their gradients (ne, nq, nen, 2).
    """
    kind = ElementTriP2 if space.element.triangle else ElementQuad2
    xi, weights = get_quadrature(kind, degree)
    values, slopes = space.element.shape(xi.T)
    x = space.points[space.cells]
    jacobian = np.einsum("qai,eaj->eqij", slopes, x)
    gradients = np.einsum("eqij,qaj->eqai", np.linalg.inv(jacobian), slopes)
    weights = np.linalg.det(jacobian) * weights
    return np.einsum("qa,eai->eqi", values, x), weights, values, gradients


def load_of_stress(space, stress):
    """Nodal forces (n, 2) that keep a stress in balance inside, a function of points (..., 2) ->
    (..., 2, 2).
    """
    position, weight, _, gradients = _fine_quadrature(space)
    nodal = np.einsum("eq,eqij,eqaj->eai", weight, stress(position), gradients)
    out = np.zeros(space.points.shape)
    np.add.at(out, space.cells, nodal)
    return out


def l2_error(space, u, exact):
    """L2 norm of u - exact over that of exact."""
    position, weight, values, _ = _fine_quadrature(space)
    truth = exact(position)
    error = np.einsum("qa,eai->eqi", values, u[space.cells]) - truth
    return float(
        np.sqrt(np.einsum("eq,eqi->", weight, error**2) / np.einsum("eq,eqi->", weight, truth**2))
    )

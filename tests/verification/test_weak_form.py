"""The compiled element loops against the weak form in scikit-fem's form language: every element,
law and kinematics.
"""

import numpy as np
import pytest
from meshes import KIND, mapped
from problems import BODIES, boundary, close

from fingerpad.laws import LAWS, NEO_HOOKE, assign
from fingerpad.mechanics.kinematics import AXISYMMETRIC, PLANE_STRAIN
from fingerpad.mechanics.linear_solver import condensation
from fingerpad.mechanics.space import Space
from fingerpad.reference_solutions.weak_form import WeakForm, isochoric_stress
from fingerpad.specimen.materials import Prony

THESIS = Prony((0.055, 0.3691), (3.25, 0.3414))
ELEMENTS = pytest.mark.parametrize("element", KIND)
SHEAR, BULK = np.array([1.5, 4.0]), np.array([60.0, 25.0])  # of two layers


def neo_hooke(mu):
    return lambda i1, i2: (mu / 2, 0.0)


def yeoh(mu, second=0.6, third=0.2):
    return lambda i1, i2: (mu / 2 * (1 + 2 * second * (i1 - 3) + 3 * third * (i1 - 3) ** 2), 0.0)


#: The laws' energies once more: derivatives of W along its invariants, and the constants the solver
#: is given.
SLOPES = {"neo_hooke": (neo_hooke, ()), "yeoh": (yeoh, (0.6, 0.2))}


def test_every_law_is_held_to_the_form():
    assert set(SLOPES) == set(LAWS)


def bent(s):
    """A quarter of a ring, an element's sides curved, its nodes not in the middle."""
    r, angle = 1 + s[:, 0] ** 1.2, 0.4 + 1.1 * s[:, 1]
    return np.stack([r * np.cos(angle), r * np.sin(angle)], 1)


def parts(element, strain, law="neo_hooke", prony=None, kinematics=PLANE_STRAIN, **more):
    """Body of two layers (of finite strain: the inner one neo-Hooke), and the weak form on its
    mesh.
    """
    mesh = mapped(2, 2, bent, KIND[element], region=lambda centre: (centre[:, 0] > 0.5).astype(int))
    fixed = boundary(mesh, "bottom")
    space = Space(mesh.points, mesh.cells, mesh.element, fixed, element, kinematics)
    laws = assign([(NEO_HOOKE, ()), (LAWS[law], SLOPES[law][1])], mesh.region)
    body = BODIES[strain](space, SHEAR[mesh.region], BULK[mesh.region], prony, laws=laws, **more)
    mu = SHEAR[mesh.region][:, None]
    inner, outer = neo_hooke(mu), SLOPES[law][0](mu)

    def slopes(i1, i2):
        chosen = zip(inner(i1, i2), outer(i1, i2), strict=True)
        return tuple(np.where(mesh.region[:, None] == 0, *pair) for pair in chosen)

    extra = more.get("pointwise", 0.0) * mu[:, 0]
    form = WeakForm(
        space.points, space.cells, element, BULK[mesh.region], extra, kinematics is AXISYMMETRIC
    )
    return body, form, slopes, mu


def displacement(points, size=0.15):
    x, y = points.T
    return size * np.stack([np.sin(2 * x) * y + 0.3 * y**2, x * y - 0.5 * np.cos(x)], 1)


def matrix(body, data):
    return body.space.pattern.matrix(data).toarray()


def equal(found, truth):
    close(found, truth, atol=1e-10 * np.abs(truth).max(), rtol=0)


def second_step(body, prony):
    """Begin a second step after one elsewhere; returns that displacement, the share of the elastic
    stress that answers at once, and how much of that of elsewhere is left.
    """
    early, factor, left = displacement(body.space.points, -0.1), 1.0, 0.0
    if prony is None:
        return early, factor, left
    first, second = 0.3, 0.7
    body.begin_step(first)
    body.displace(early)
    body.commit()
    body.begin_step(second)
    for beta, tau in zip(prony.beta, prony.tau, strict=True):
        then, now = ((1 - np.exp(-dt / tau)) / (dt / tau) for dt in (first, second))
        left += np.exp(-second / tau) * beta * then - beta * now
        factor += beta * now
    return early, factor, left


def check_finite(element, law="neo_hooke", prony=None, kinematics=PLANE_STRAIN, change=1.0, **more):
    """Force and tangent at a large displacement with another pressure in the tangent; with
    branches, in a second step.
    """
    body, form, slopes, mu = parts(element, "finite", law, prony, kinematics, **more)
    points, space = body.space.points, body.space
    early, factor, left = second_step(body, prony)
    f = form.deformation(early)
    elastic = np.einsum("ij...,jk...->ik...", np.linalg.inv(f.T).T, isochoric_stress(f, slopes))
    history = left * elastic
    u = displacement(points)
    random = np.random.default_rng(5)
    lag = 0.05 * random.normal(size=body.dilatation().shape)
    body.displace(u, lag)
    data, force = body.tangent()
    equal(force, form.force(u, slopes, change * factor, history))
    equal(body.against(body.internal_force()), force)
    at_points = np.einsum("eqa,ea->eq", space.psi, lag)
    stiffness = form.stiffness(u, slopes, at_points, change * factor, history)
    free = ~space.fixed.ravel()
    equal(matrix(body, data), stiffness[np.ix_(free, free)])


@pytest.mark.parametrize(
    ("element", "law"),
    [(e, law) for e in KIND for law in LAWS if law == "neo_hooke" or e in ("Q2P1", "Q1P0", "P2B")],
)
def test_finite_strain(element, law, must_fail):
    """Every element with one law, and every law with the elements that are solved with: each pair
    is compiled on its own.
    """
    check_finite(element, law)
    must_fail(check_finite, element, law, change=1 + 1e-8)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("element", ["Q2P1", "Q1P0", "P2B"])
def test_finite_strain_with_branches(element, law, must_fail):
    check_finite(element, law, THESIS)
    must_fail(check_finite, element, law, THESIS, change=1 + 1e-8)


@pytest.mark.parametrize("element", ["Q2P1", "P2B"])
def test_finite_strain_with_unprojected_stiffness(element, must_fail):
    """As under the edge of a bar."""
    check_finite(element, pointwise=5.0)
    must_fail(check_finite, element, pointwise=5.0, change=1 + 1e-8)


def check_small(element, law="neo_hooke", prony=None, kinematics=PLANE_STRAIN, change=1.0):
    """Small strain: force and tangent, whatever the law; with branches, in a second step."""
    body, form, _, mu = parts(element, "small", law, prony, kinematics)
    early, factor, left = second_step(body, prony)
    shape = form.linear_stiffness(mu[:, 0]) - form.linear_stiffness(0 * mu[:, 0])
    history = left * (shape @ early.ravel()).reshape(early.shape)
    u = displacement(body.space.points)
    body.displace(u)
    stiffness = form.linear_stiffness(mu[:, 0], change * factor)
    equal(body.internal_force(), (stiffness @ u.ravel()).reshape(u.shape) + history)
    body.linearise(condensation(body.space.pattern, np.empty(0, dtype=np.int64)))
    free = ~body.space.fixed.ravel()
    equal(matrix(body, body.stiffness()), stiffness[np.ix_(free, free)])


@ELEMENTS
@pytest.mark.parametrize("law", LAWS)
def test_small_strain(element, law, must_fail):
    check_small(element, law)
    must_fail(check_small, element, law, change=1 + 1e-8)


@pytest.mark.parametrize("element", ["Q2P1", "Q1P0", "P2B"])
def test_small_strain_with_branches(element, must_fail):
    check_small(element, prony=THESIS)
    must_fail(check_small, element, prony=THESIS, change=1 + 1e-8)


@pytest.mark.parametrize(
    ("element", "law"), [("Q2P1", "neo_hooke"), ("P2B", "neo_hooke"), ("Q1P0", "yeoh")]
)
def test_a_body_of_revolution(element, law, must_fail):
    """With R at the points themselves, in a second step with branches."""
    check_finite(element, law, THESIS, AXISYMMETRIC, pointwise=5.0)
    must_fail(check_finite, element, law, THESIS, AXISYMMETRIC, pointwise=5.0, change=1 + 1e-8)
    check_small(element, prony=THESIS, kinematics=AXISYMMETRIC)
    must_fail(check_small, element, prony=THESIS, kinematics=AXISYMMETRIC, change=1 + 1e-8)

"""Every element alone: patch test, tangent, energy, uniform pressure on its edges."""

from decimal import Decimal, getcontext

import numpy as np
import pytest
from meshes import KIND, mapped, nodes_of, rectangle
from numba import njit
from pressing import press
from problems import SIDES, boundary, close, lame_constants, make_body, solve

from fingerpad.laws import LAWS, NEO_HOOKE, assign
from fingerpad.laws.law import isochoric
from fingerpad.mechanics import kernels
from fingerpad.mechanics.contact_points import ContactPoints
from fingerpad.mechanics.finite_strain import FiniteStrainBody
from fingerpad.mechanics.pressure import smoothed_pressure
from fingerpad.mechanics.space import TOGETHER, Space, edge_load_vectors
from fingerpad.reference_solutions import manufactured
from fingerpad.specimen.materials import Prony

ELEMENTS = ("Q1P0", "Q2P1", "P2B")
AFFINE = manufactured.affine([[0.08, 0.15], [-0.1, -0.06]], [0.02, -0.03])
YEOH = LAWS["yeoh"]
PRONY = Prony((0.055, 0.3691), (3.25, 0.3414))


# -- patch test ------------------------------------------------------------------------------------


def check_patch(element, strain, poisson, soft_element=1.0):
    """Affine boundary values give the affine field inside and the uniform stress on the rim."""
    mesh = rectangle(4, 3, 2.0, 1.0, KIND[element], distortion=0.3)
    shear, bulk = lame_constants(3.0, poisson)
    body = make_body(mesh, boundary(mesh, *SIDES), shear, bulk, element, strain)
    body.shear[5] *= soft_element
    if strain == "small" and soft_element != 1:
        body = type(body)(body.space, body.shear, body.bulk)
    space = body.space
    start = AFFINE.displacement(space.points)
    start[~space.fixed] = 0.8 * start[~space.fixed]
    solve(body, np.zeros_like(start), start)
    error = np.abs(body.u - AFFINE.displacement(space.points)).max()
    assert error < 1e-11, f"truth: the field is affine, but off by {error:.2e}"

    stress = {"small": manufactured.small_strain_stress, "finite": manufactured.first_piola_stress}[
        strain
    ]
    piola = stress(AFFINE, np.zeros(2), shear, bulk)
    traction = np.zeros_like(body.u)
    for name, normal in {
        "left": (-1, 0),
        "right": (1, 0),
        "bottom": (0, -1),
        "top": (0, 1),
    }.items():
        load = edge_load_vectors(mesh.points, mesh.curves[name])
        length = np.hypot(load[:, 0], load[:, 1])
        traction[: len(length)] += length[:, None] * (piola @ normal)
    close(body.internal_force(), traction, atol=1e-9 * np.abs(traction).max())


@pytest.mark.parametrize("poisson", [0.3, 0.4999])
@pytest.mark.parametrize("strain", ["small", "finite"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_patch(element, strain, poisson, must_fail):
    """A distorted patch reproduces a uniform strain and its stress to round-off (Irons and Razzaque
    1972).
    """
    check_patch(element, strain, poisson)
    must_fail(check_patch, element, strain, poisson, soft_element=0.99)


# -- tangent and energy ----------------------------------------------------------------------------


def deformed_body(element, prony=None, poisson=0.45, shake=0.003):
    """A finite-strain body in some state, with a history if viscoelastic; no lag in its
    pressure.
    """
    mesh = rectangle(3, 2, 1.0, 0.8, KIND[element], distortion=0.2)
    shear, bulk = lame_constants(3.0, poisson)
    body = make_body(mesh, boundary(mesh, "bottom"), shear, bulk, element, "finite", prony)
    random = np.random.default_rng(5)
    for dt in (0.1, 0.3):
        body.begin_step(dt)
        u = 0.4 * AFFINE.displacement(body.space.points) + random.normal(0, shake, body.u.shape)
        u[body.space.fixed] = 0
        body.displace(u)
        body.commit()
    body.begin_step(0.2)
    u = 1.3 * body.u + random.normal(0, shake / 2, body.u.shape)
    u[body.space.fixed] = 0
    body.displace(u)
    assert body.smallest_jacobian > 0.1, "a folded element ends the loops before all are counted"
    return body


def check_kept_tangent(element, off=0.0):
    """What a tangent of somewhere else makes of volume that the pressure does not stand for, and of
    a step's dilatation.
    """
    body = deformed_body(element)
    random, h = np.random.default_rng(7), 1e-6
    begin, way, other = body.u.copy(), *random.normal(0, 1, (2, *body.u.shape))
    body.tangent()
    slopes = {}
    for name, direction in (("way", way), ("other", other)):
        volumes = []
        for sign in (1, -1):
            body.displace(begin + sign * h * direction)
            volumes.append(body.dilatation())
        slopes[name] = (volumes[0] - volumes[1]) / (2 * h)
    body.displace(there := 1.05 * begin)
    volume = body.dilatation().copy()
    own = 0.9 * volume + random.normal(0, 0.01 * np.abs(volume).max(), volume.shape)
    force = body.displace(there, own)
    gained = np.sum((body.against(force) - force) * other)
    truth = np.sum(body.bulk[:, None] * (volume - own) * slopes["other"]) * (1 + off)
    assert abs(gained - truth) < 1e-8 * abs(truth), f"truth: {truth!r} of work and not {gained!r}"
    body.advance(way, 1e-3)
    found, truth = body.dilatation(), volume + 1e-3 * slopes["way"] * (1 + off)
    assert np.abs(found - truth).max() < 1e-8 * np.abs(truth).max(), (
        "truth: the dilatation that the step leads to"
    )


@pytest.mark.parametrize("element", ELEMENTS)
def test_a_tangent_of_somewhere_else_knows_its_own_volumes(element, must_fail):
    """Its terms in volume are derivatives where it was made, and not where the body is by now."""
    check_kept_tangent(element)
    must_fail(check_kept_tangent, element, off=1e-6)


def answers(body, steps=(0.1, 0.3)):
    """Force, tangent, dilatation, energies and Jacobian of a body whose nodes have been moved at
    random, after each step.
    """
    random, out = np.random.default_rng(1), []
    for dt in steps:
        body.begin_step(dt)
        body.displace(body.u + random.normal(0, 0.002, body.u.shape))
        body.internal_force()
        dilatation = body.dilatation().copy()
        data, force = body.tangent()
        out += [body.internal_force(), force, data[:-1].copy(), dilatation]
        body.commit()
        out += [np.array(body.energies()), np.array(body.smallest_jacobian)]
    return out


def check_mixed_laws(element, prony, moved=0):
    """Elements of two laws that say the same, in no order, are those of one law; ``moved``: whose
    blocks begin too late.
    """
    mesh = rectangle(11, 7, 1.0, 0.8, KIND[element], distortion=0.2)
    space = Space(mesh.points, mesh.cells, mesh.element, boundary(mesh, "bottom"), element)
    shear, bulk = (np.full(len(mesh.cells), value) for value in lame_constants(3.0, 0.45))
    alone = FiniteStrainBody(space, shear, bulk, prony, pointwise=2.0)
    yeoh = np.random.default_rng(0).random(len(mesh.cells)) < 0.6
    mixed = FiniteStrainBody(
        space,
        shear,
        bulk,
        prony,
        pointwise=2.0,
        laws=assign([(NEO_HOOKE, ()), (YEOH, (0, 0))], 1 * yeoh),
    )
    for *_, blocks in mixed._loops:
        blocks[:1, 1] += np.uint64(moved)
    for one, both in zip(answers(alone), answers(mixed), strict=True):
        error = np.abs(both - one).max() / np.abs(one).max()
        assert error < 1e-12, f"truth: laws in parts are off by {error:.2e}"
    # what is left over of the last block stays empty: garbage there would be multiplied in every
    # step
    if prony:
        assert not mixed.branches.q[..., -1, :, :, len(mesh.cells) % TOGETHER :].any()


@pytest.mark.parametrize(("element", "prony"), [("Q2P1", PRONY), ("Q1P0", None)])
def test_elements_of_several_laws_are_all_counted_once(element, prony, must_fail):
    check_mixed_laws(element, prony)
    must_fail(check_mixed_laws, element, prony, moved=1)


@pytest.mark.parametrize("count", [1, 31, 32, 33, 100])
def test_blocks_hold_every_element_that_is_asked_for(count):
    mesh = rectangle(count, 1, 1.0, 0.8, "quad4")
    space = Space(mesh.points, mesh.cells, "quad4", boundary(mesh, "bottom"))
    for which in (
        np.ones(count, bool),
        np.zeros(count, bool),
        np.random.default_rng(count).random(count) < 0.5,
    ):
        found = [
            TOGETHER * block + k
            for block, first, last in space.blocks(which).tolist()
            for k in range(first, last)
        ]
        assert found == np.flatnonzero(which).tolist()
        assert all(first < last <= TOGETHER for _, first, last in space.blocks(which).tolist())


def check_factor(step=0.0):
    found = compiled_factor(
        spread := np.concatenate(
            [np.exp(np.linspace(-30, 30, 1001)), 1 + np.linspace(-0.1, 0.1, 1001)]
        )
    )
    getcontext().prec = 40
    truth = np.array([float(Decimal(jac) ** (Decimal(-2) / 3)) for jac in spread.tolist()])
    error = np.abs(found * (1 + step) / truth - 1).max()
    assert error < 6e-16, f"truth: J^(-2/3) is off by {error:.1e}"
    np.testing.assert_allclose(found, isochoric(spread), rtol=2e-14)


def compiled_factor(values):
    @njit(**kernels._JIT | {"cache": False})
    def each(values, out):
        for k in range(len(values)):
            out[k] = isochoric(values[k])

    each(values, out := np.empty_like(values))
    return out


def test_the_isochoric_factor_is_right_to_rounding(must_fail):
    check_factor()
    must_fail(check_factor, step=1e-15)


def check_force_is_gradient(element, strain, wrong_bulk=1.0, own=1.0):
    if strain == "finite":
        body = deformed_body(element)
    else:
        mesh = rectangle(3, 2, 1.0, 0.8, KIND[element], distortion=0.2)
        body = make_body(mesh, boundary(mesh, "bottom"), *lame_constants(3.0, 0.45), element)
    u = np.random.default_rng(2).normal(0, 0.004, body.u.shape)
    direction = np.random.default_rng(3).normal(0, 1, body.u.shape)
    body.displace(u)
    dilatation = own * body.dilatation()
    work = np.sum(body.displace(u, dilatation) * direction)
    h, energy = 1e-6, []
    body.bulk = wrong_bulk * body.bulk
    for sign in (1, -1):
        body.displace(u + sign * h * direction, dilatation)
        energy.append(body.energies()[0])
    numerical = (energy[0] - energy[1]) / (2 * h)
    assert abs(work - numerical) < 1e-7 * abs(work), (
        f"truth: the energy's slope {numerical!r} is not the work {work!r}"
    )


@pytest.mark.parametrize("element", ELEMENTS)
@pytest.mark.parametrize("strain", ["finite", "small"])
def test_force_is_the_gradient_of_the_energy(element, strain, must_fail):
    """Elastic internal forces derive from the recorded network energy, also where pressure stands
    for another volume.
    """
    check_force_is_gradient(element, strain)
    if strain == "finite":
        check_force_is_gradient(element, strain, own=0.5)
        must_fail(check_force_is_gradient, element, strain, wrong_bulk=1.01)


# -- pressure on edges -----------------------------------------------------------------------------


def check_uniform_pressure(element, curved, weight=1.0):
    """Forces at the points of skin under a uniform pressure are that of a consistent load, and that
    pressure at every node.
    """
    bend = 0.3 if curved else 0.0
    mesh = mapped(
        5,
        2,
        lambda s: np.stack([s[:, 0], 0.5 * s[:, 1] - bend * s[:, 1] * s[:, 0] ** 2], 1),
        KIND[element],
    )
    edges = mesh.curves["top"]
    chain = np.unique(edges)
    chain = chain[np.argsort(mesh.points[chain, 0])]
    places = ContactPoints.on(mesh.points, chain, edges, np.ones(len(edges)))
    tangent = (
        np.einsum("qa,qai->qi", places.slopes, mesh.points[places.nodes])
        * (places.weight * weight)[:, None]
    )
    force = 1250.0 * np.stack([tangent[:, 1], -tangent[:, 0]], 1)
    found = np.zeros(mesh.points.shape)
    np.add.at(found, places.nodes, places.values[:, :, None] * force[:, None])
    load = -1250.0 * edge_load_vectors(mesh.points, edges)
    close(found, load, "load", atol=(5e-3 if curved else 1e-12) * np.abs(load).max())
    pressure = places.of_nodes(np.hypot(*force.T)) / places.of_nodes(places.lengths(mesh.points))
    close(pressure, 1250.0, "uniform pressure", rtol=1e-12)
    ends = mesh.points[chain[-1]] - mesh.points[chain[0]]
    resultant = 1250.0 * np.array([ends[1], -ends[0]])
    for total in (found.sum(0), load.sum(0)):
        close(total, resultant, "resultant", atol=1e-12 * np.hypot(*resultant))


@pytest.mark.parametrize("curved", [False, True], ids=["straight", "curved"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_uniform_pressure_patch(element, curved, must_fail):
    """Contact forces of a uniform pressure give that pressure at corner and mid-side nodes alike,
    and its load to all nodes.
    """
    check_uniform_pressure(element, curved)
    must_fail(check_uniform_pressure, element, curved, weight=1.01)


def check_smoothing(mirrored, weights=(1, 2, 3, 2, 1)):
    force, length = np.random.default_rng(4).uniform(1, 2, (2, 12))
    whole = [
        np.concatenate([v[:0:-1], [2 * v[0]], v[1:]]) if mirrored else v for v in (force, length)
    ]
    sums = [np.convolve(v, weights, mode="same") for v in whole]
    expected = (sums[0] / sums[1])[-12:]
    found = smoothed_pressure(force, length, mirrored)
    close(found, expected, "weights 1, 2, 3, 2, 1", rtol=1e-12)


@pytest.mark.parametrize("mirrored", [False, True], ids=["whole", "half"])
def test_smoothed_pressure(mirrored, must_fail):
    """Smoothed pressure is force over length, both averaged with weights 1, 2, 3, 2, 1
    (mirrored).
    """
    check_smoothing(mirrored)
    must_fail(check_smoothing, mirrored, weights=(1, 2, 2, 2, 1))


def check_contact_patch(element, strain, depth, poisson=0.0):
    mesh = rectangle(6, 4, 2.0, 2.0, KIND[element], distortion=0.2)
    fixed = np.zeros(mesh.points.shape, bool)
    fixed[nodes_of(mesh, "bottom"), 1] = True
    fixed[nodes_of(mesh, "left", "right"), 0] = True
    body = make_body(mesh, fixed, *lame_constants(2e6, poisson), element, strain)
    result = press(body, mesh, depth=depth)
    expected = 2e6 * depth / 2.0
    within = 1e-9 if strain == "small" else 2 * depth
    close(result.pressure, expected, "pressure", rtol=within)
    close(result.pressure, result.pressure[0], "uniform pressure", rtol=1e-7)
    assert abs(result.force - 2.0 * result.pressure[0]) < 1e-7 * result.force, "truth: resultant"


@pytest.mark.parametrize("strain", ["small", "finite"])
@pytest.mark.parametrize("element", ELEMENTS)
def test_contact_patch(element, strain, must_fail):
    """A block under a plate carries E delta/h: 1e5 Pa for nu = 0 (El-Abbasi and Bathe 2001,
    SSNP121).
    """
    check_contact_patch(element, strain, depth=0.1 if strain == "small" else 1e-3)
    must_fail(check_contact_patch, element, strain, depth=1e-3, poisson=0.3)

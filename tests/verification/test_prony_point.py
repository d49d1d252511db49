"""One element in simple shear is a material point: relaxation, ramps, creep and cycles of a Prony
series.
"""

import numpy as np
import pytest
from meshes import nodes_of, rectangle
from problems import boundary, close, make_body, solve, two_numbers

from fingerpad.mechanics.space import edge_load_vectors
from fingerpad.reference_solutions import manufactured, prony_point
from fingerpad.specimen.materials import Prony

THESIS = Prony((0.055, 0.3691), (3.25, 0.3414))
ONE_TERM = Prony((0.8,), (1.0,))
SHEAR, BULK = 2.0, 40.0  # long-term
STRAINS = pytest.mark.parametrize("strain", ["small", "finite"])


def sheared_element(strain, prony):
    """Body free to shear along x only, clamped at the bottom, and its unit shear displacement."""
    mesh = rectangle(1, 1)
    fixed = np.zeros(mesh.points.shape, bool)
    fixed[:, 1] = True
    fixed[nodes_of(mesh, "bottom")] = True
    body = make_body(mesh, fixed, SHEAR, BULK, "Q2P1", strain, prony)
    return mesh, body, np.column_stack([mesh.points[:, 1], 0 * mesh.points[:, 1]])


def shear_stress(mesh, body):
    return -body.internal_force()[nodes_of(mesh, "bottom"), 0].sum()


def drive(strain, prony, times, shears):
    """Shear stress after each step of a prescribed shear history (first entry: a jump at once)."""
    mesh, body, unit = sheared_element(strain, prony)
    stresses = []
    for dt, shear in zip(np.diff(times, prepend=times[0]), shears, strict=True):
        body.begin_step(dt)
        body.displace(shear * unit)
        stresses.append(shear_stress(mesh, body))
        body.commit()
    return np.array(stresses)


def check_relaxation(strain, held, series=THESIS):
    """``held``: times of the steps after a jump to a shear of 0.4."""
    times = np.concatenate([[0.0], held])
    stress = drive(strain, series, times, np.full(len(times), 0.4))
    close(stress, 0.4 * SHEAR * THESIS.relaxation(times) / THESIS.g_infinity, rtol=1e-11)
    two_numbers(stress[-1], truth=0.4 * SHEAR, within=0.02, frozen=0.8007562572)


@STRAINS
def test_relaxation_is_exact_for_any_step(strain, must_fail):
    """After a jump the stress follows G(t) to round-off, in one step or in many (Christensen
    1982).
    """
    check_relaxation(strain, [15.0])
    check_relaxation(strain, np.linspace(0.1, 15.0, 40))
    must_fail(check_relaxation, strain, [15.0], series=None)
    must_fail(check_relaxation, strain, [15.0], series=ONE_TERM)


def check_large_relaxation(held, series=THESIS, rotation=0.0):
    """A large strain applied at once, then held: the relaxed network carries the stress of G(t)."""
    cosine, sine = np.cos(rotation), np.sin(rotation)
    strained = np.array([[1.2, 0.3], [-0.2, 0.9]])
    field = manufactured.affine(np.array([[cosine, -sine], [sine, cosine]]) @ strained - np.eye(2))
    mesh = rectangle(1, 1)
    body = make_body(mesh, boundary(mesh), SHEAR, BULK, "Q2P1", "finite", series)
    for dt in (0.0, held):
        body.begin_step(dt)
        body.displace(field.displacement(mesh.points))
        force = body.internal_force()
        body.commit()
    shear = SHEAR * float(THESIS.relaxation(held)) / THESIS.g_infinity
    piola = manufactured.first_piola_stress(field, np.zeros(2), shear, BULK)
    reaction = np.zeros_like(force)
    for curve in ("left", "right", "bottom", "top"):
        load = edge_load_vectors(mesh.points, mesh.curves[curve])
        reaction += load @ piola.T
    close(force, reaction, atol=1e-10 * np.abs(reaction).max())


@pytest.mark.parametrize("rotation", [0.0, 0.7])
def test_relaxation_at_large_strain_and_rotation(rotation, must_fail):
    """Held at any F the stress is that of a neo-Hookean solid of modulus G(t), rotated or not (Simo
    1987).
    """
    check_large_relaxation(0.8, rotation=rotation)
    must_fail(check_large_relaxation, 0.8, series=None, rotation=rotation)
    must_fail(check_large_relaxation, 0.8, series=ONE_TERM, rotation=rotation)


def check_ramp(series, count, ran_as="same"):
    """Small strain: a ramp of 0.5 s and a hold of 2 s, the ramp in ``count`` steps."""
    times = np.concatenate([np.linspace(0, 0.5, count + 1), np.linspace(0.5, 2.5, count + 1)[1:]])
    shears = np.interp(times, [0, 0.5, 2.5], [0, 0.3, 0.3])
    stress = drive("small", series if ran_as == "same" else ran_as, times, shears)
    g, tau = series.g, series.tau
    truth = prony_point.stress_from_strain(times, shears, g, tau, SHEAR / series.g_infinity)
    close(stress, truth, rtol=1e-11, atol=1e-14)


@pytest.mark.parametrize("series", [ONE_TERM, THESIS], ids=["one term", "thesis"])
@pytest.mark.parametrize("count", [1, 7])
def test_linear_strain_ramps_are_exact(series, count, must_fail):
    """The recurrence is exact for a strain linear in each step, at any step (Taylor et al.
    1970).
    """
    check_ramp(series, count)
    must_fail(check_ramp, series, count, ran_as=None)
    must_fail(check_ramp, series, count, ran_as=Prony(series.g, tuple(2 * t for t in series.tau)))


def creep(strain, series, count, stress=0.02):
    """Shear at t = 2 s under a shear stress applied at once and held."""
    mesh, body, _ = sheared_element(strain, series)
    load = np.zeros_like(body.u)
    load[:, 0] = stress * edge_load_vectors(mesh.points, mesh.curves["top"])[:, 1]
    for dt in [0.0, *np.full(count, 2.0 / count)]:
        body.begin_step(dt)
        solve(body, load, body.u, tolerance=1e-12)
        body.commit()
    return body.u[nodes_of(mesh, "top"), 0].mean()


def check_creep(strain, frozen, count=16, series=THESIS, within=1e-3):
    truth = 0.02 / SHEAR * THESIS.g_infinity * prony_point.creep(2.0, THESIS.g, THESIS.tau)
    two_numbers(creep(strain, series, count), truth=truth, within=within, frozen=frozen)


@pytest.mark.parametrize("strain, frozen", [("small", 9.35421398e-3), ("finite", 9.35421796e-3)])
def test_creep(strain, frozen, must_fail):
    """Under constant stress the shear follows the creep compliance, to second order in the step."""
    check_creep(strain, frozen)
    must_fail(check_creep, strain, frozen, series=None)
    must_fail(check_creep, strain, frozen, count=1)
    truth = 0.02 / SHEAR * THESIS.g_infinity * prony_point.creep(2.0, THESIS.g, THESIS.tau)
    if strain == "small":
        coarse, fine = (abs(creep(strain, THESIS, count) - truth) for count in (32, 64))
        assert np.log2(coarse / fine) == pytest.approx(2, abs=0.1)


def check_cycle(strain, frozen, series=THESIS, amplitude=0.02, frequency=2.5):
    """Energy dissipated in the last of five cycles of 96 steps, and the work lost in it."""
    mesh, body, unit = sheared_element(strain, series)
    times = np.linspace(0, 5, 5 * 96 + 1) * 2 * np.pi / frequency
    shears, stresses, lost = amplitude * np.sin(frequency * times), [0.0], [0.0]
    for dt, shear in zip(np.diff(times), shears[1:], strict=True):
        body.begin_step(dt)
        body.displace(shear * unit)
        stresses.append(shear_stress(mesh, body))
        body.commit()
        lost.append(body.energies()[2] - body.energies()[1])
    truth = prony_point.dissipation_per_cycle(
        amplitude, frequency, THESIS.g, THESIS.tau, SHEAR / THESIS.g_infinity
    )
    last = slice(-97, None)
    two_numbers(
        np.trapezoid(stresses[last], shears[last]), truth=truth, within=5e-3, frozen=frozen[0]
    )
    two_numbers(lost[-1] - lost[-97], truth=truth, within=5e-3, frozen=frozen[1])


@pytest.mark.parametrize(
    "strain, frozen",
    [("small", (8.23581110e-4, 8.23554609e-4)), ("finite", (8.23639581e-4, 8.23613066e-4))],
)
def test_dissipation_of_a_cycle(strain, frozen, must_fail):
    """A steady cycle loses pi amplitude^2 G'', as work and as recorded dissipation (Christensen
    1982).
    """
    check_cycle(strain, frozen)
    must_fail(check_cycle, strain, frozen, series=None)

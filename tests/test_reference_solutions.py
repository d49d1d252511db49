"""The analytic solutions agree with themselves: loads, limits, equilibrium, and published
numbers.
"""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from fingerpad.reference_solutions import (
    cattaneo_mindlin,
    hertz,
    incline,
    lame,
    layered,
    layered_contact,
    lee_radok,
    manufactured,
    prony_point,
    punch,
    ting,
    westergaard,
)

pytestmark = pytest.mark.unit

PRONY = ([0.055, 0.3691], [3.25, 0.3414])
ONE_TERM = ([0.8], [1.0])


# --- Hertz ----------------------------------------------------------------------------------------
def test_hertz_gives_the_numbers_of_the_nafems_roller():
    """NAFEMS R0094: E* = 57 692.3 N/mm2, a = 6.2146 mm, p0 = 3585.36 N/mm2."""
    modulus = hertz.composite_modulus(210e3, 0.3, 70e3, 0.3)
    assert modulus == pytest.approx(57692.3, abs=0.05)
    a = hertz.half_width(35e3, 50, modulus)
    assert a == pytest.approx(6.2146, abs=5e-5)
    assert hertz.peak_pressure(35e3, a) == pytest.approx(3585.36, abs=5e-3)


def test_hertz_load_is_the_integral_of_the_pressure():
    a, p0 = 0.7, 3.0
    load, _ = quad(lambda x: hertz.pressure(x, a, p0), -a, a)
    assert load == pytest.approx(np.pi * a * p0 / 2, rel=1e-8)
    assert hertz.force(hertz.half_width(5.0, 2.0, 7.0), 2.0, 7.0) == pytest.approx(5.0)
    assert hertz.pressure(np.array([-1.0, 1.0]), a, p0).tolist() == [0, 0]


@pytest.mark.parametrize(
    "poisson, shear, shear_depth, mises, mises_depth",
    [(0.3, 0.3003, 0.786, 0.5575, 0.704), (0.5, 0.3003, 0.786, 0.5201, 0.786)],
)
def test_hertz_largest_stresses_below_the_surface(poisson, shear, shear_depth, mises, mises_depth):
    z = np.linspace(0, 3, 6001)
    stress = hertz.axis_stresses(z, 1.0, 1.0, poisson)
    assert stress["max_shear"].max() == pytest.approx(shear, abs=5e-5)
    assert z[stress["max_shear"].argmax()] == pytest.approx(shear_depth, abs=1e-3)
    assert stress["von_mises"].max() == pytest.approx(mises, abs=5e-5)
    assert z[stress["von_mises"].argmax()] == pytest.approx(mises_depth, abs=1e-3)


def test_hertz_stresses_are_in_equilibrium_and_meet_the_surface():
    h = 1e-5
    x, z = np.meshgrid([-1.7, -0.4, 0.3, 1.0, 2.2], [0.2, 0.9, 3.0])

    def slope(component, axis):
        shift = (h, 0) if axis == "x" else (0, h)
        ahead = hertz.stresses(x + shift[0], z + shift[1], 1.0, 1.0)[component]
        return (ahead - hertz.stresses(x - shift[0], z - shift[1], 1.0, 1.0)[component]) / (2 * h)

    np.testing.assert_allclose(slope(0, "x") + slope(2, "z"), 0, atol=1e-8)
    np.testing.assert_allclose(slope(2, "x") + slope(1, "z"), 0, atol=1e-8)
    surface = np.array([-2.0, -0.6, 0.0, 0.5, 1.5])
    _, sigma_z, tau = hertz.stresses(surface, 0.0, 1.0, 1.0)
    np.testing.assert_allclose(sigma_z, -hertz.pressure(surface, 1.0, 1.0), atol=1e-12)
    np.testing.assert_allclose(tau, 0, atol=1e-12)


def test_hertz_approach_is_the_integral_of_the_strain_on_the_axis():
    a, poisson, shear, depth = 0.5, 0.4, 1.0, 60.0
    modulus = 2 * shear / (1 - poisson)
    force = hertz.force(a, 10.0, modulus)
    p0 = hertz.peak_pressure(force, a)

    def strain(z):
        s = hertz.axis_stresses(z, a, p0, poisson)
        return -((1 - poisson) * s["sigma_z"] - poisson * s["sigma_x"]) / (2 * shear)

    sinking, _ = quad(strain, 0, depth, points=[a, 5 * a], limit=200)
    assert hertz.approach_to_depth(force, a, modulus, poisson, depth) == pytest.approx(
        sinking, rel=1e-4
    )


# --- Westergaard, Cattaneo-Mindlin, punch ---------------------------------------------------------
@pytest.mark.parametrize(
    "ratio, share", [(0.05, 0.02447), (0.1, 0.09549), (0.25, 0.5), (0.4, 0.9045)]
)
def test_westergaard_mean_pressures(ratio, share):
    h, wavelength, modulus = 0.01, 2.0, 5.0
    full = westergaard.full_contact_pressure(h, wavelength, modulus)
    mean = westergaard.mean_pressure(ratio * wavelength, h, wavelength, modulus)
    assert mean / full == pytest.approx(share, abs=5e-5)
    load, _ = quad(
        lambda x: westergaard.pressure(x, ratio * wavelength, h, wavelength, modulus),
        -wavelength / 2,
        wavelength / 2,
        points=[-ratio * wavelength, ratio * wavelength],
        limit=200,
    )
    assert load == pytest.approx(mean * wavelength, rel=1e-7)


def test_westergaard_small_contacts_are_hertzian():
    h, wavelength, modulus, a = 0.01, 2.0, 5.0, 0.004
    radius = wavelength**2 / (4 * np.pi**2 * h)
    load = westergaard.mean_pressure(a, h, wavelength, modulus) * wavelength
    assert hertz.half_width(load, radius, modulus) == pytest.approx(a, rel=1e-4)


@pytest.mark.parametrize(
    "load, ratio, peak, centre",
    [
        (0.25, 0.8660, 0.5, 0.1340),
        (0.5, 0.7071, 0.7071, 0.2929),
        (0.75, 0.5, 0.8660, 0.5),
        (0.9, 0.3162, 0.9487, 0.6838),
    ],
)
def test_cattaneo_mindlin_table(load, ratio, peak, centre):
    c = cattaneo_mindlin.stick_ratio(load, 2.0, 0.5)
    assert c == pytest.approx(ratio, abs=5e-5)

    def q(x):
        return cattaneo_mindlin.traction(x, 1.0, 1.0, 0.5, c) / 0.5

    assert q(c) == pytest.approx(peak, abs=5e-5)
    assert q(0.0) == pytest.approx(centre, abs=5e-5)
    total, _ = quad(q, -1, 1, points=[-c, c])
    assert total / (np.pi / 2) == pytest.approx(load, rel=1e-7)


def test_cattaneo_mindlin_return():
    """On the way back the traction carries the force, never exceeds mu p, and at -Q1 is that of Q1
    mirrored.
    """
    turn, mu, load = 0.8 * 0.5 * np.pi / 2, 0.5, np.pi / 2
    x = np.linspace(-1, 1, 401)
    for force in (turn, 0.3, 0.0, -0.2, -turn):

        def q(x, force=force):
            return cattaneo_mindlin.returned_traction(x, 1.0, 1.0, mu, turn, force, load)

        kinks = np.sqrt(1 - np.array([turn, (turn - force) / 2]) / (mu * load))
        total, _ = quad(q, -1, 1, points=[*-kinks, *kinks], limit=200)
        assert total == pytest.approx(force, abs=1e-7)
        assert np.all(np.abs(q(x)) <= mu * hertz.pressure(x, 1.0, 1.0) + 1e-12)
    np.testing.assert_allclose(
        q(x), -cattaneo_mindlin.returned_traction(x, 1.0, 1.0, mu, turn, turn, load), atol=1e-12
    )
    with pytest.raises(ValueError, match="opposite"):
        cattaneo_mindlin.returned_traction(x, 1.0, 1.0, mu, turn, -1.1 * turn, load)


def test_punch_pressure_load_and_exponent():
    assert punch.pressure(0.0, 2.0, 10.0) * 2 / 10 == pytest.approx(0.3183, abs=5e-5)
    assert punch.stick_exponent(0.5) == 0
    assert punch.stick_exponent(0.3) > 0
    assert np.isinf(punch.pressure(2.0, 2.0, 1.0))


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_sticking_punch(poisson):
    """The tractions carry both forces; at nu = 0.5 they are the frictionless pressure, scaled;
    shear points outwards before.
    """
    normal, sideways = (
        quad(
            lambda s, k=k: (
                punch.sticking_tractions(np.sin(s), 1.0, 3.0, 2.0, poisson)[k] * np.cos(s)
            ),
            -1.5707,
            1.5707,
        )[0]
        for k in (0, 1)
    )
    assert (normal, sideways) == (pytest.approx(3, rel=2e-3), pytest.approx(2, rel=2e-3))
    x = np.array([0.0, 0.5])
    p, q = punch.sticking_tractions(x, 1.0, 3.0, 0.0, poisson)
    if poisson == 0.5:
        np.testing.assert_allclose(p, punch.pressure(x, 1.0, 3.0))
        np.testing.assert_allclose(q, 0)
    else:
        assert q[0] == 0 and q[1] > 0 and p[0] > punch.pressure(0.0, 1.0, 3.0)
    with pytest.raises(ValueError, match="inside"):
        punch.sticking_tractions(1.0, 1.0, 3.0, 0.0, poisson)


# --- layers ---------------------------------------------------------------------------------------
KERNEL = {
    0.1: (9.9673, 8.0556, 4.1124, 1.5328),
    0.5: (1.9985, 1.9010, 1.6113, 1.1782),
    5.0: (0.2006, 0.2502, 0.4072, 0.7395),
}


@pytest.mark.parametrize("ratio", KERNEL)
def test_layered_kernel_table_and_the_linear_system_agree(ratio):
    xi = np.array([0.1, 0.5, 1.0, 2.0])
    kernel = layered.incompressible_kernel(xi, ratio)
    np.testing.assert_allclose(kernel, KERNEL[ratio], atol=1e-4)  # 5 -> 0.20061
    stack = [layered.Layer(1.0, 3.0, 0.5), layered.Layer(np.inf, 3.0 * ratio, 0.5)]
    solved = [layered.stack_compliance(k, stack) * 2 * 3.0 * k for k in xi]
    np.testing.assert_allclose(kernel, solved, rtol=1e-12)


def test_stack_limits():
    mu, nu, k = 2.0, 0.3, 5.0
    half_plane = layered.stack_compliance(k, [layered.Layer(np.inf, mu, nu)])
    assert half_plane == pytest.approx((1 - nu) / (mu * k), rel=1e-13)
    split = [layered.Layer(0.1, mu, nu), layered.Layer(0.2, mu, nu), layered.Layer(np.inf, mu, nu)]
    assert layered.stack_compliance(k, split) == pytest.approx(half_plane, rel=1e-12)
    thick = layered.stack_compliance(k, [layered.Layer(8.0, mu, nu)])
    assert thick == pytest.approx(half_plane, rel=1e-12)
    thin = [layered.Layer(0.01, mu, nu), layered.Layer(0.02, 3 * mu, 0.45)]
    assert layered.stack_compliance(1e-3, thin) == pytest.approx(
        layered.stack_compliance(0, thin), rel=1e-6
    )
    incompressible = [layered.Layer(1.0, mu, 0.5)]
    assert layered.stack_compliance(0, incompressible) == 0
    lubrication = (1e-2) ** 2 * 1.0 / (3 * mu)  # p'' h^3/(3 mu): Johnson 5.8
    assert layered.stack_compliance(1e-2, incompressible) == pytest.approx(lubrication, rel=1e-3)


def test_thin_layer_laws_fit_together():
    a, radius, thickness, modulus = 12.0, 400.0, 1.0, 3.0
    load, _ = quad(lambda x: layered.thin_layer_pressure(x, a, radius, thickness, modulus), -a, a)
    assert layered.thin_layer_force(a, radius, thickness, modulus) == pytest.approx(load, rel=1e-10)
    assert layered.thin_layer_depth(a, radius) == pytest.approx(a**2 / (6 * radius))


def test_layered_contact_reaches_hertz_and_the_thin_layer():
    shear, radius, load = 1.0, 20.0, 0.05
    a = hertz.half_width(load, radius, 4 * shear)
    thick = layered_contact.press(
        lambda x: x**2 / (2 * radius), [layered.Layer(20.0, shear, 0.5)], 20.0, load, 1024
    )
    assert thick.pressure[0] == pytest.approx(hertz.peak_pressure(load, a), rel=2e-3)
    assert thick.half_width == pytest.approx(a, rel=0.02)
    assert thick.pressure.sum() * 2 * 20.0 / 1024 == pytest.approx(load, rel=1e-12)

    radius, a = 1000.0, 20.0
    load = layered.thin_layer_force(a, radius, 1.0, 3 * shear)
    thin = layered_contact.press(
        lambda x: x**2 / (2 * radius), [layered.Layer(1.0, shear, 0.5)], 80.0, load, 1024
    )
    assert thin.depth == pytest.approx(layered.thin_layer_depth(a, radius), rel=0.15)
    assert thin.pressure[0] == pytest.approx(
        layered.thin_layer_pressure(0.0, a, radius, 1.0, 3 * shear), rel=0.02
    )


def test_layered_contact_reproduces_westergaard():
    h, shear, nu, half = 0.01, 1.0, 0.4, 1.0
    modulus = 2 * shear / (1 - nu)
    load = westergaard.mean_pressure(0.5, h, 2.0, modulus) * 2.0
    solution = layered_contact.press(
        lambda x: 2 * h * np.sin(np.pi * x / 2) ** 2,
        [layered.Layer(6.0, shear, nu)],
        half,
        load,
        512,
    )
    expected = westergaard.pressure(solution.x, 0.5, h, 2.0, modulus)
    inside = solution.x < 0.45
    np.testing.assert_allclose(solution.pressure[inside], expected[inside], rtol=5e-3)


# --- thick cylinder, Cook -------------------------------------------------------------------------
@pytest.mark.parametrize(
    "poisson, displacement",
    [
        (0.3, 4.5825e-3),
        (0.49, 5.03993e-3),
        (0.499, 5.06025e-3),
        (0.4999, 5.06227e-3),
        (0.5, 5.0625e-3),
    ],
)
def test_thick_cylinder_of_macneal_and_harder(poisson, displacement):
    assert lame.radial_displacement(3.0, 3, 9, 1000, poisson, internal=1) == pytest.approx(
        displacement, rel=2e-6
    )


def test_thick_cylinder_of_ssnv130():
    """code_aster: u_r 6e-5/3e-5 m."""
    r = np.array([0.1, 0.2])
    u = lame.radial_displacement(r, 0.1, 0.2, 2e11, 0.5, internal=60e6)
    np.testing.assert_allclose(u, [6e-5, 3e-5], rtol=1e-9)
    uniform = lame.radial_displacement(0.15, 0.1, 0.2, 2e11, 0.3, internal=1e6, external=1e6)
    assert uniform == pytest.approx(-(1.3 * 0.4) / 2e11 * 1e6 * 0.15)


# --- viscoelasticity ------------------------------------------------------------------------------
def test_relaxation_and_creep_limits():
    assert prony_point.relaxation(0.0, *PRONY) == 1
    assert prony_point.relaxation(1e3, *PRONY) == pytest.approx(0.5759)
    assert prony_point.creep(0.0, *PRONY) == 1
    assert prony_point.creep(1e4, *PRONY) == pytest.approx(1 / 0.5759)
    j, theta = prony_point.creep_terms(*ONE_TERM)
    assert (j[0], theta[0]) == (pytest.approx(4), pytest.approx(5))
    none, _ = prony_point.creep_terms([0.0], [1.0])
    assert none[0] == 0


def test_relaxation_and_creep_are_inverse():
    """int G(t - s) dJ(s) = 1 at every time."""
    j, theta = prony_point.creep_terms(*PRONY)
    for t in (0.1, 1.0, 7.0):

        def integrand(s, t=t):
            return prony_point.relaxation(t - s, *PRONY) * (j / theta * np.exp(-s / theta)).sum()

        memory, _ = quad(integrand, 0, t)
        assert prony_point.relaxation(t, *PRONY) + memory == pytest.approx(1, abs=1e-10)


def test_point_histories_do_not_depend_on_the_step_and_invert():
    coarse_t, coarse = np.array([0.0, 0.0, 0.5, 2.5]), np.array([0.0, 0.1, 0.6, 0.6])
    fine_t = np.concatenate([[0.0], np.linspace(0, 0.5, 41), np.linspace(0.5, 2.5, 31)])
    fine = np.concatenate([[0.0], np.interp(fine_t[1:], [0, 0.5, 2.5], [0.1, 0.6, 0.6])])
    for function in (prony_point.stress_from_strain, prony_point.strain_from_stress):
        assert function(fine_t, fine, *PRONY)[-1] == pytest.approx(
            function(coarse_t, coarse, *PRONY)[-1], rel=1e-12
        )
    fine_t = np.linspace(0, 2, 4001)
    strain = np.sin(fine_t)
    back = prony_point.strain_from_stress(
        fine_t, prony_point.stress_from_strain(fine_t, strain, *PRONY, 3.0), *PRONY, 3.0
    )
    np.testing.assert_allclose(back, strain, atol=1e-6)


def test_point_ramp_agrees_with_the_maxwell_equations():
    """Independent route: matrix exponential of the branches' equations."""
    g, tau = np.array(PRONY[0]), np.array(PRONY[1])
    rate, t = 0.3, 1.7
    system = np.zeros((3, 3))  # branch stresses q_i' = g_i rate - q_i/tau_i, and a constant one
    system[:2, :2] = -np.diag(1 / tau)
    system[:2, 2] = g * rate
    branches = expm(system * t)[:2, 2]
    stress = prony_point.stress_from_strain([0, t], [0, rate * t], *PRONY)[-1]
    assert stress == pytest.approx((1 - g.sum()) * rate * t + branches.sum(), rel=1e-12)


def test_dissipation_is_the_area_of_the_loop():
    omega, amplitude = 2.5, 0.2
    t = np.linspace(0, 2 * np.pi / omega * 12, 24001)
    strain = amplitude * np.sin(omega * t)
    stress = prony_point.stress_from_strain(t, strain, *PRONY)
    last = t >= t[-1] - 2 * np.pi / omega - 1e-9
    area = np.trapezoid(stress[last], strain[last])
    assert area == pytest.approx(
        prony_point.dissipation_per_cycle(amplitude, omega, *PRONY), rel=1e-3
    )


def test_lee_radok_routes_agree():
    t, radius, shear = np.linspace(0, 3, 301), 5.0, 2.0
    ramp = np.pi / radius * prony_point.stress_from_strain(t, 0.2 * t, *PRONY, shear)
    back = lee_radok.width_from_force(t, ramp, radius, shear, *PRONY)
    np.testing.assert_allclose(back, np.sqrt(0.2 * t), atol=1e-4)
    held = np.pi / radius * prony_point.stress_from_strain([0, 2], [0.09] * 2, *PRONY, shear)
    assert held[-1] == pytest.approx(lee_radok.held_width_force(2.0, 0.3, radius, shear, *PRONY))
    step = lee_radok.width_from_force([0, 0, 2], [0, 0.3, 0.3], radius, shear, *PRONY)
    assert step[-1] == pytest.approx(lee_radok.step_creep_width(2.0, radius, 0.3, shear, *PRONY))


# --- manufactured fields --------------------------------------------------------------------------
FIELDS = {
    "affine": manufactured.affine([[0.1, 0.2], [-0.05, 0.15]], [0.3, 0.1]),
    "potential": manufactured.gradient_of_potential(0.05, 2.0),
    "divergence_free": manufactured.divergence_free(0.05, 2.0),
    "shears": manufactured.isochoric_shears(0.08, 2.5),
    "pressurised": manufactured.nearly_incompressible(
        manufactured.isochoric_shears(0.08, 2.5),
        manufactured.gradient_of_potential(0.05, 2.0),
        50.0,
        2.0,
    ),
}
POINTS = np.random.default_rng(3).uniform(-1, 1, (5, 2))


def _numerical(function, points, h=1e-5):
    """Central differences along the last axis."""
    steps = h * np.eye(2)
    return np.stack([(function(points + s) - function(points - s)) / (2 * h) for s in steps], -1)


@pytest.mark.parametrize("name", FIELDS)
def test_gradients_of_the_fields(name):
    field = FIELDS[name]
    np.testing.assert_allclose(
        field.gradient(POINTS), _numerical(field.displacement, POINTS), atol=1e-9
    )


def test_piola_stress_is_the_derivative_of_the_energy():
    base, h = np.array([[0.1, 0.2], [-0.05, 0.15]]), 1e-6

    def energy(gradient):
        f = gradient + np.eye(2)
        volume = np.linalg.det(f)
        invariant = (f**2).sum() + 1
        return 1.3 / 2 * (volume ** (-2 / 3) * invariant - 3) + 20.0 / 2 * (volume - 1) ** 2

    stress = manufactured.first_piola_stress(manufactured.affine(base), POINTS[0], 1.3, 20.0)
    for i, j in np.ndindex(2, 2):
        step = np.zeros((2, 2))
        step[i, j] = h
        slope = (energy(base + step) - energy(base - step)) / (2 * h)
        assert stress[i, j] == pytest.approx(slope, abs=1e-7)


def test_isochoric_fields_are_isochoric():
    gradient = FIELDS["shears"].gradient(POINTS) + np.eye(2)
    np.testing.assert_allclose(np.linalg.det(gradient), 1, atol=1e-14)
    trace = np.trace(FIELDS["divergence_free"].gradient(POINTS), axis1=-2, axis2=-1)
    np.testing.assert_allclose(trace, 0, atol=1e-15)


# --- refused input --------------------------------------------------------------------------------
@pytest.mark.parametrize(
    "call",
    [
        lambda: hertz.stresses(0.0, -1.0, 1, 1),
        lambda: hertz.approach_to_depth(1, 1, 1, 0.3, 0.5),
        lambda: westergaard.mean_pressure(2.0, 1, 1, 1),
        lambda: cattaneo_mindlin.stick_ratio(2, 1, 0.5),
        lambda: lame.radial_displacement(1, 2, 1, 1, 0.3),
        lambda: layered.stack_compliance(1, []),
        lambda: layered.stack_compliance(1, [layered.Layer(np.inf, 1, 0.3)] * 2),
        lambda: layered_contact.press(lambda x: x**2, [layered.Layer(1, 1, 0.3)], 1.0, -1.0),
        lambda: layered_contact.press(lambda x: 1e-9 * x**2, [layered.Layer(1, 1, 0.3)], 1.0, 1.0),
        lambda: prony_point.relaxation(1, [0.6, 0.5], [1, 1]),
        lambda: prony_point.stress_from_strain([1, 0], [0, 1], [0.1], [1]),
        lambda: incline.limit_ratio(0.1, -0.1),
        lambda: incline.limit_ratio(2.0, 0.5),
        lambda: lee_radok.width_from_force([0, 1], [1, 0.0], 1, 1, [0.1], [1]),
        lambda: ting.force_under_depth_control([0, 1], [1, 0], [0.1], [1]),
        lambda: ting.elastic_force_under_force_control([0, 1], [1, 0], [0.1], [1]),
        lambda: manufactured.first_piola_stress(
            manufactured.affine([[-2, 0], [0, 0]]), POINTS, 1, 1
        ),
    ],
)
def test_impossible_arguments_are_refused(call):
    with pytest.raises(ValueError):
        call()

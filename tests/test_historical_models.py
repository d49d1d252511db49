"""The elastic half-plane and the water bed against their closed forms."""

import numpy as np
import pytest

from fingerpad.reference_solutions import hertz, phillips_johnson, waterbed

pytestmark = pytest.mark.unit


def strips(half_width, peak, count=4000):
    edges = half_width * np.sin(np.linspace(-np.pi / 2, np.pi / 2, count + 1))
    return edges, hertz.pressure((edges[1:] + edges[:-1]) / 2, half_width, peak)


def test_strips_add_up_to_hertz():
    """Stresses below strips that carry Hertz's pressure are McEwen's."""
    x, z = np.array([0.0, 0.3, 1.0, 2.5]) * 1e-3, np.array([0.2, 0.6, 1.0, 1.5]) * 1e-3
    found = phillips_johnson.strip_stresses(x, z, *strips(1e-3, 1e4))
    for value, expected in zip(found, hertz.stresses(x, z, 1e-3, 1e4), strict=True):
        np.testing.assert_allclose(value, expected, atol=1.0)


def test_narrow_strip_is_a_line_load():
    """Far from a strip only its force counts: Flamant's radial stress 2 P cos(theta) / (pi r)."""
    x, z, force = 3e-3, 4e-3, 2.0
    sigma_x, sigma_z, tau = phillips_johnson.strip_stresses(x, z, [-1e-6, 1e-6], [force / 2e-6])
    radial = -2 * force * z / (np.pi * (x * x + z * z))
    np.testing.assert_allclose(
        [sigma_x, sigma_z, tau], radial * np.array([0.36, 0.64, 0.48]), rtol=1e-5
    )


def test_strain_energy_and_strains_are_those_of_a_known_state():
    """Pure shear has no volume change; energy is half stress times strain."""
    modulus, poisson = 0.1e6, 0.4
    shear, bulk = modulus / 2 / (1 + poisson), modulus / 3 / (1 - 2 * poisson)
    tensile, compressive = phillips_johnson.strains(0.0, 0.0, 300.0, modulus, poisson)
    assert tensile == pytest.approx(300 / 2 / shear) and compressive == pytest.approx(-tensile)
    energy = phillips_johnson.strain_energy_density(0.0, 0.0, 300.0, shear, bulk, poisson)
    assert energy == pytest.approx(300**2 / 2 / shear)
    sx, sz = -200.0, -900.0
    e1, e2 = phillips_johnson.strains(sx, sz, 0.0, modulus, poisson)
    energy = phillips_johnson.strain_energy_density(sx, sz, 0.0, shear, bulk, poisson)
    assert energy == pytest.approx((sx * e1 + sz * e2) / 2)


def test_strips_and_arguments_are_checked():
    with pytest.raises(ValueError, match="edges"):
        phillips_johnson.strip_stresses(0.0, 1.0, [0.0, 1.0], [1.0, 1.0])
    with pytest.raises(ValueError, match="inside the body"):
        phillips_johnson.strip_stresses(0.0, 0.0, [0.0, 1.0], [1.0])
    with pytest.raises(ValueError, match="no equilibrium"):
        waterbed.press(1e6, 1.0, 11e-3, 9.5e-3, 1e4)


@pytest.mark.parametrize("curvature", [0.0, 79.0, 1260.0, 1e5])
def test_membrane_work_is_its_new_length(curvature):
    """At constant tension and area all work goes into length: F = T dL/d(depth)."""
    states = [waterbed.press(f, 30.0, 11e-3, 9.5e-3, curvature) for f in (19.9, 20.0, 20.1)]
    slope = (states[2].length - states[0].length) / (states[2].depth - states[0].depth)
    assert 30.0 * slope == pytest.approx(20.0, rel=1e-5)


def test_plate_carries_the_fluids_pressure():
    """Under a plate the membrane is flat: force is pressure times width, and pressure exceeds that
    at rest.
    """
    state = waterbed.press(20.0, 30.0, 11e-3, 9.5e-3)
    assert state.force == pytest.approx(
        20.0
    ) and state.pressure * 2 * state.half_width == pytest.approx(20.0)
    assert state.pressure > 30.0 / 11e-3


def test_shallow_membrane_under_a_line_load_is_parabolic():
    """F = 8 T depth / L, and the fluid's area stays."""
    length, tension, force = 10e-3, 30.0, 1e-3
    state = waterbed.press(force, tension, 200 * length, length, 1e7)
    assert state.depth == pytest.approx(force * length / 8 / tension, rel=0.01)
    x = np.linspace(-length, length, 20001)
    profile = waterbed.line_load_profile(x, 1.0, length)
    assert np.trapezoid(profile, x) == pytest.approx(
        0, abs=1e-10
    ) and profile.min() == pytest.approx(-1 / 3)

"""Strain energy at receptors: against Hertz's field below the contact, and term by term in simple shear."""

from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from meshes import nodes_of, quarter_annulus, rectangle
from pressing import press
from problems import make_body, two_numbers
from scipy.linalg import logm
from skfem import ElementQuad1, ElementQuad2, ElementTriP2, MappingIsoparametric
from strips import Layer, half_strip

from fingerpad.receptors.material_points import MaterialPoints, ReceptorError, locate, logarithmic_strain
from fingerpad.reference_solutions import hertz, prony_point
from fingerpad.specimen.materials import Prony
from fingerpad.stimuli.shapes import Cylinder

THESIS = Prony((0.055, 0.3691), (3.25, 0.3414))
ENERGIES = {f"strain_energy_{name}" for name in ("density", "long_term_moduli", "half_stress_strain", "recoverable", "network")}
DEPTHS = (0.3, 0.786, 1.5, 2.5)  # half widths

#: network energy over p0^2/G at DEPTHS
HERTZ = {
    ("Q1P0", "small"): (0.023002664, 0.0455057, 0.031891462, 0.016088439),
    ("Q1P0", "finite"): (0.022954405, 0.045558557, 0.03193184, 0.016108097),
    ("Q2P1", "small"): (0.023135821, 0.045386796, 0.031929302, 0.016100295),
    ("Q2P1", "finite"): (0.023088925, 0.045439371, 0.031970157, 0.016120208),
    ("P2B", "small"): (0.02270613, 0.044743162, 0.032016029, 0.016121184),
    ("P2B", "finite"): (0.022657436, 0.04479305, 0.032057424, 0.016141203),
}


@cache
def hertz_contact(element, strain):
    """The load on an incompressible half-plane of shear modulus one, and its body, pressed."""
    radius, depth, poisson = 200.0, 150.0, 0.4999
    load = hertz.force(1.0, radius, 2 / (1 - poisson))
    mesh, body = half_strip([Layer(depth, 1.0, poisson)], depth, element, strain, fine=3 / depth, columns=(24, 18))
    press(body, mesh, Cylinder(curvature=1 / radius), force=load / 2)
    return load, body


def check_hertz_energy(element, strain="small", off_axis=0.0):
    """Incompressible half-plane: the density below the contact is (largest shear stress)^2 / 2 G."""
    shear, (load, body) = 1.0, hertz_contact(element, strain)
    p0 = hertz.peak_pressure(load, 1.0)
    points = np.column_stack([np.full(len(DEPTHS), off_axis), -np.array(DEPTHS)])
    energies = MaterialPoints(body, points, body.shear).sample(body)
    truth = hertz.axis_stresses(np.array(DEPTHS), 1.0, p0, 0.5)["max_shear"] ** 2 / (2 * shear)
    for found, expected, frozen in zip(energies["strain_energy_network"], truth, HERTZ[element, strain], strict=True):
        two_numbers(found / p0**2, truth=expected / p0**2, within=0.02, frozen=frozen, tight=1e-5)
    # incompressible and in the plane: von Mises stress is sqrt(3) times the largest shear stress
    stresses = hertz.axis_stresses(np.array(DEPTHS), 1.0, p0, 0.5)
    np.testing.assert_allclose(energies["von_mises_stress"], 3**0.5 * stresses["max_shear"], rtol=0.02, err_msg="truth")
    np.testing.assert_allclose(energies["compressive_strain"], stresses["max_shear"] / (2 * shear), rtol=0.04, err_msg="truth")
    for name in ENERGIES:
        np.testing.assert_allclose(energies[name], energies["strain_energy_network"], rtol=2e-3, err_msg="truth")


@pytest.mark.parametrize("strain", ["small", "finite"])
@pytest.mark.parametrize("element", ["Q1P0", "Q2P1", "P2B"])
def test_energy_below_hertz_contact(element, strain, must_fail):
    """Strain energy on the axis below a cylinder is that of Hertz's stresses (Johnson 1985, section 4.2)."""
    check_hertz_energy(element, strain)
    must_fail(check_hertz_energy, element, strain, off_axis=0.9)


def check_shear_energies(strain, series=THESIS):
    """The energies at the end of a shear ramp of 0.5 s and after a hold of 2 s."""
    mesh = rectangle(1, 1)
    fixed = np.zeros(mesh.points.shape, bool)
    fixed[nodes_of(mesh, "bottom")] = True
    long_term, shear = 2.0, 1e-3
    instantaneous = long_term / THESIS.g_infinity
    body = make_body(mesh, fixed, long_term, 50.0, "Q2P1", strain, series)
    receptors = MaterialPoints(body, np.array([[0.31, 0.77]]), np.array([instantaneous]))
    unit = np.column_stack([mesh.points[:, 1], 0 * mesh.points[:, 1]])
    for dt, now in ((0.5, shear), (2.0, shear)):
        body.begin_step(dt)
        body.displace(now * unit)
        receptors(body, dt)
        body.commit()
        time = 0.5 if dt == 0.5 else 2.5
        history = [0, 0.5, 2.5], [0, shear, shear]
        total = prony_point.stress_from_strain(*history, THESIS.g, THESIS.tau, instantaneous)
        springs = 0.0
        for g, tau in zip(THESIS.g, THESIS.tau, strict=True):
            held = prony_point.stress_from_strain(*history, [g], [tau], instantaneous)
            branch = held - instantaneous * (1 - g) * np.array(history[1])
            springs += branch**2 / (2 * g * instantaneous)
        k = history[0].index(time)
        truth = {
            "strain_energy_density": total[k] ** 2 / (2 * instantaneous),
            "strain_energy_long_term_moduli": total[k] ** 2 / (2 * long_term),
            "strain_energy_half_stress_strain": total[k] * shear / 2,
            "strain_energy_network": long_term * shear**2 / 2,
            "strain_energy_recoverable": long_term * shear**2 / 2 + springs[k],
        }
        bend = 0.0 if strain == "small" else (1 + shear**2 / 4) ** 0.5 - 1
        truth |= {"compressive_strain": shear / 2 - bend, "tensile_strain": shear / 2 + bend}
        truth["von_mises_stress"] = 3**0.5 * abs(total[k])
        found = receptors.sample(body)
        for name in truth:
            np.testing.assert_allclose(found[name], truth[name], rtol=1e-5, err_msg=f"truth: {name} at {time} s")


@pytest.mark.parametrize("strain", ["small", "finite"])
def test_five_strain_energies_in_shear(strain, must_fail):
    """A sheared point's headline energy is s^2/2G_0, with long-term moduli s^2/2G, half stress times strain s y/2, its network's
    G y^2/2, recoverable with the springs'."""
    check_shear_energies(strain)
    must_fail(check_shear_energies, strain, series=None)


def test_logarithmic_strain_is_half_the_logarithm_of_b():
    """Of a rotation none, of a stretch its logarithm, of any deformation that of F F^T by scipy."""
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    f = np.array([turn, turn @ np.diag([1.5, 0.8]), [[1.2, 0.4], [-0.1, 0.9]], np.eye(2) + 1e-9 * turn])
    truth = np.array([np.real(logm(one @ one.T)) / 2 for one in f])
    np.testing.assert_allclose(truth[1], turn @ np.diag(np.log([1.5, 0.8])) @ turn.T, atol=1e-14, err_msg="truth")
    np.testing.assert_allclose(logarithmic_strain(f), truth, atol=1e-15, rtol=1e-12, err_msg="truth")


def test_between_elements_no_side_is_preferred():
    """On the border of elements a receptor reads the mean of both sides, which differ."""
    mesh = rectangle(2, 2)
    fixed = np.zeros(mesh.points.shape, bool)
    fixed[nodes_of(mesh, "bottom")] = True
    body = make_body(mesh, fixed, 2.0, 50.0, "Q2P1", "finite")
    x, y = mesh.points.T
    body.displace(0.02 * np.column_stack([y * np.maximum(x - 0.5, 0), y * np.sin(4 * x)]))
    side = 1e-5
    points = np.array([[0.5, 0.3], [0.5 - side, 0.3], [0.5 + side, 0.3], [0.3, 0.3]])
    receptors = MaterialPoints(body, points, None)
    for name, (between, left, right, _) in receptors.sample(body).items():
        np.testing.assert_allclose(between, (left + right) / 2, rtol=1e-3, err_msg=name)
        assert name == "dilatation" or abs(left - right) > 0.05 * max(abs(left), abs(right)), name


CURVED = {"quad9": ("Q2P1", ElementQuad2), "tri6": ("P2B", ElementTriP2), "quad4": ("Q1P0", ElementQuad1)}


@pytest.mark.parametrize("bent", [False, True], ids=["irregular", "curved"])
@pytest.mark.parametrize("kind", CURVED)
def test_points_are_found_where_scikit_fem_maps_them(kind, bent):
    """Places in elements of curved sides or irregular shape, mapped by scikit-fem, are found again, and in no second element."""
    element, shape = CURVED[kind]
    mesh = quarter_annulus(5, 6, 1.0, 2.0, kind) if bent else rectangle(9, 8, kind=kind, distortion=0.3)
    body = make_body(mesh, np.zeros(mesh.points.shape, bool), 2.0, 50.0, element, "finite")
    random = np.random.default_rng(3)
    host, xi = random.integers(len(mesh.cells), size=2000), random.uniform(1e-3, 1 - 1e-3, (2000, 2))
    if kind == "tri6":
        xi = np.where(xi.sum(1, keepdims=True) < 1, xi, 1 - xi)
    numbered = SimpleNamespace(element_dofs=mesh.cells.T)  # gmsh and scikit-fem number the nodes of these elements alike
    mapping = MappingIsoparametric(SimpleNamespace(doflocs=mesh.points.T, dofs=numbered, dim=lambda: 2), shape())
    mapped = mapping.F(xi.T[:, :, None], tind=host)[:, :, 0].T
    found = locate(body.space, mapped)
    np.testing.assert_array_equal(found.element, host)
    np.testing.assert_allclose(found.xi, xi, atol=1e-11)
    if kind != "quad4":
        assert MaterialPoints(body, mapped, None).recovery is None
    with pytest.raises(ReceptorError, match="outside"):
        locate(body.space, np.concatenate([mapped[:3], [[3.0, 3.0]]]))


@pytest.mark.parametrize("kind", ["quad9", "tri6"])
def test_points_are_found_in_long_elements_beside_many_narrow_ones(kind):
    """Under a refined contact: the centre of the element is farther off than those of a hundred in the row below."""
    mesh = rectangle(200, 2, kind=kind)
    mesh.points[:, 1] = np.interp(mesh.points[:, 1], [0, 0.5, 1], [0, 0.1, 1])
    body = make_body(mesh, np.zeros(mesh.points.shape, bool), 2.0, 50.0, CURVED[kind][0], "finite")
    points = np.array([[0.5025, 0.15], [0.3025, 0.05], [0.5, 0.15], [0.7025, 0.12]])
    found = locate(body.space, points)
    values = body.space.element.shape(found.xi)[0]
    np.testing.assert_allclose(np.einsum("na,nai->ni", values, body.space.points[body.space.cells[found.element]]), points)
    receptors = MaterialPoints(body, points, None)
    assert receptors.recovery is not None and len(receptors.recovery.starts) == len(points)
    with pytest.raises(ReceptorError, match="outside"):
        locate(body.space, np.array([[0.5, 0.15], [0.5, 1.2]]))

"""Strain energy at receptors: against Hertz's field below the contact, and term by term in simple
shear.
"""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest
from meshes import quarter_annulus, rectangle
from pressing import press
from problems import boundary, close, make_body, two_numbers
from scipy.linalg import logm
from skfem import ElementQuad1, ElementQuad2, ElementTriP2, MappingIsoparametric
from strips import Layer, half_strip

from fingerpad.receptors.material_points import MaterialPoints, logarithmic_strain
from fingerpad.receptors.recovery import Location, ReceptorError, containing
from fingerpad.reference_solutions import hertz, prony_point
from fingerpad.specimen.materials import Prony
from fingerpad.stimuli.shapes import Cylinder

THESIS = Prony((0.055, 0.3691), (3.25, 0.3414))
ENERGIES = {
    f"strain_energy_{name}"
    for name in ("density", "long_term_moduli", "half_stress_strain", "recoverable", "network")
}
DEPTHS = (0.3, 0.786, 1.5, 2.5)  # half widths

#: network energy over p0^2/G at DEPTHS
HERTZ = {
    ("Q1P0", "small"): (0.023056722, 0.045522129, 0.031858017, 0.016060113),
    ("Q1P0", "finite"): (0.023010349, 0.045574635, 0.031898264, 0.016079734),
    ("Q2P1", "small"): (0.023190293, 0.045283798, 0.031873478, 0.016088385),
    ("Q2P1", "finite"): (0.023143669, 0.045335635, 0.031914095, 0.016108251),
    ("P2B", "small"): (0.023166846, 0.045277769, 0.031902887, 0.016097238),
    ("P2B", "finite"): (0.023120073, 0.04532991, 0.031943788, 0.016117163),
}


@cache
def hertz_contact(element, strain):
    """The load on an incompressible half-plane of shear modulus one, and its body, pressed."""
    radius, depth, poisson = 200.0, 150.0, 0.4999
    load = hertz.force(1.0, radius, 2 / (1 - poisson))
    mesh, body = half_strip(
        [Layer(depth, 1.0, poisson)], depth, element, strain, fine=3 / depth, columns=(24, 18)
    )
    press(body, mesh, Cylinder(curvature=1 / radius), force=load / 2)
    return load, body


def check_hertz_energy(element, strain="small", off_axis=0.0):
    """Incompressible half-plane: the density below the contact is (largest shear stress)^2 / 2
    G.
    """
    shear, (load, body) = 1.0, hertz_contact(element, strain)
    p0 = hertz.peak_pressure(load, 1.0)
    points = np.column_stack([np.full(len(DEPTHS), off_axis), -np.array(DEPTHS)])
    energies = MaterialPoints(body, points, body.shear, mirrored=True).sample(body)
    truth = hertz.axis_stresses(np.array(DEPTHS), 1.0, p0, 0.5)["max_shear"] ** 2 / (2 * shear)
    for found, expected, frozen in zip(
        energies["strain_energy_network"], truth, HERTZ[element, strain], strict=True
    ):
        two_numbers(found / p0**2, truth=expected / p0**2, within=0.02, frozen=frozen, tight=1e-5)
    # incompressible and in the plane: von Mises stress is sqrt(3) times the largest shear stress
    stresses = hertz.axis_stresses(np.array(DEPTHS), 1.0, p0, 0.5)
    close(energies["von_mises_stress"], 3**0.5 * stresses["max_shear"], rtol=0.02)
    close(energies["compressive_strain"], stresses["max_shear"] / (2 * shear), rtol=0.04)
    for name in ENERGIES:
        close(energies[name], energies["strain_energy_network"], rtol=2e-3)


@pytest.mark.parametrize("strain", ["small", "finite"])
@pytest.mark.parametrize("element", ["Q1P0", "Q2P1", "P2B"])
def test_energy_below_hertz_contact(element, strain, must_fail):
    """Strain energy on the axis below a cylinder is that of Hertz's stresses (Johnson 1985, section
    4.2).
    """
    check_hertz_energy(element, strain)
    must_fail(check_hertz_energy, element, strain, off_axis=0.9)


def check_shear_energies(strain, series=THESIS):
    """The energies at the end of a shear ramp of 0.5 s and after a hold of 2 s."""
    mesh = rectangle(1, 1)
    fixed = boundary(mesh, "bottom")
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
            close(found[name], truth[name], f"{name} at {time} s", rtol=1e-5)


@pytest.mark.parametrize("strain", ["small", "finite"])
def test_five_strain_energies_in_shear(strain, must_fail):
    """A sheared point's headline energy is s^2/2G_0, with long-term moduli s^2/2G, half stress
    times strain s y/2, its network's G y^2/2, recoverable with the springs'.
    """
    check_shear_energies(strain)
    must_fail(check_shear_energies, strain, series=None)


def test_logarithmic_strain_is_half_the_logarithm_of_b():
    """Of a rotation none, of a stretch its logarithm, of any deformation that of F F^T by scipy."""
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    f = np.array(
        [turn, turn @ np.diag([1.5, 0.8]), [[1.2, 0.4], [-0.1, 0.9]], np.eye(2) + 1e-9 * turn]
    )
    truth = np.array([np.real(logm(one @ one.T)) / 2 for one in f])
    close(truth[1], turn @ np.diag(np.log([1.5, 0.8])) @ turn.T, atol=1e-14)
    close(logarithmic_strain(f), truth, atol=1e-15, rtol=1e-12)


def test_between_elements_no_side_is_preferred(monkeypatch):
    """On the border of elements a receptor reads the mean of both sides, which differ, where
    nothing is fitted.
    """
    monkeypatch.setattr("fingerpad.receptors.recovery.FITTED", {})
    mesh = rectangle(2, 2)
    fixed = boundary(mesh, "bottom")
    body = make_body(mesh, fixed, 2.0, 50.0, "Q2P1", "finite")
    x, y = mesh.points.T
    body.displace(0.02 * np.column_stack([y * np.maximum(x - 0.5, 0), y * np.sin(4 * x)]))
    side = 1e-5
    points = np.array([[0.5, 0.3], [0.5 - side, 0.3], [0.5 + side, 0.3], [0.3, 0.3]])
    receptors = MaterialPoints(body, points, None)
    for name, (between, left, right, _) in receptors.sample(body).items():
        np.testing.assert_allclose(between, (left + right) / 2, rtol=1e-3, err_msg=name)
        assert name == "dilatation" or abs(left - right) > 0.05 * max(abs(left), abs(right)), name


WAVES = np.array([[2.1, 1.3], [-1.7, 2.4]])


def energy_errors(element, divisions, distortion):
    """Of receptors anywhere in a body, whose nodes are where a smooth field puts them: root mean
    square over the energy's.
    """
    kind = {"Q1P0": "quad4", "Q2P1": "quad9", "P2B": "tri6"}[element]
    mesh = rectangle(divisions, divisions, kind=kind, distortion=distortion)
    body = make_body(mesh, boundary(mesh), 2.0, 5.0, element, "small")
    body.displace(1e-3 * np.sin(body.space.points @ WAVES.T))
    points = np.random.default_rng(5).uniform(0.02, 0.98, (200, 2))
    slope = 1e-3 * np.cos(points @ WAVES.T)[:, :, None] * WAVES
    strain = 0.5 * (slope + slope.swapaxes(1, 2))
    square = (strain**2).sum(axis=(1, 2)) - np.trace(strain, axis1=1, axis2=2) ** 2 / 3
    truth = 2.0 * square + 2.5 * np.trace(slope, axis1=1, axis2=2) ** 2
    found = MaterialPoints(body, points, None).sample(body)["strain_energy_network"]
    return np.linalg.norm(found - truth) / np.linalg.norm(truth)


def check_fit(element, within):
    coarse, fine, irregular = (
        energy_errors(element, *mesh) for mesh in ((12, 0.0), (24, 0.0), (24, 0.15))
    )
    assert fine < within and irregular < 2.2 * within, "truth"
    assert np.log2(coarse / fine) > 1.95, "truth"


@pytest.mark.parametrize(("element", "within"), [("Q1P0", 2e-3), ("Q2P1", 4.1e-5), ("P2B", 1.7e-4)])
def test_energy_at_receptors_is_better_than_in_elements(element, within, monkeypatch):
    """What is fitted to the best points of elements round a receptor beats the element that it lies
    in (Barlow 1976), by a factor of 16, 18 and 5 on regular meshes; of linear quads it converges
    with one order more.
    """
    check_fit(element, within)
    monkeypatch.setattr("fingerpad.receptors.recovery.FITTED", {})
    with pytest.raises(AssertionError, match="truth"):
        check_fit(element, 4 * within)


def test_nothing_is_fitted_across_layers_or_gaps():
    """Where energy jumps, between two layers and between two pieces of one that touch nowhere near,
    either side keeps its own.
    """
    mesh = rectangle(17, 16)
    centre = mesh.points[mesh.cells].mean(axis=1)
    stiff = centre[:, 1] > 0.5
    gap = (np.abs(centre[:, 0] - 0.5) < 0.01) & (centre[:, 1] < 0.5) & (centre[:, 1] > 0.125)
    mesh = replace(mesh, cells=mesh.cells[~gap], region=stiff[~gap].astype(int))
    alone = ~np.isin(np.arange(len(mesh.points)), mesh.cells)
    body = make_body(
        mesh, np.column_stack([alone, alone]), np.array([2.0, 20.0, 0.0]), 50.0, "Q2P1", "small"
    )
    left = mesh.points[:, 0] < 0.5
    body.displace(1e-3 * np.column_stack([np.where(left, 1, 3) * mesh.points[:, 1], 0 * left]))
    points = np.array([[0.3, 0.49], [0.3, 0.51], [0.469, 0.3], [0.531, 0.3]])
    found = MaterialPoints(body, points, None).sample(body)["strain_energy_network"]
    close(found, 0.5 * 1e-6 * np.array([2, 20, 2, 18]), rtol=1e-6)


def test_the_half_of_a_symmetric_body_reads_what_the_whole_does():
    """Near the axis what is fitted goes over it, as in a mirror."""
    found = []
    for low in (-1, 0):
        mesh = rectangle(
            np.linspace(0, 1, 8 * (1 - low) + 1), 8, 1.0 - low, 1.0, origin=(float(low), 0.0)
        )
        body = make_body(mesh, boundary(mesh), 2.0, 50.0, "Q2P1", "finite")
        x, y = mesh.points.T
        body.displace(0.02 * np.column_stack([np.sin(2 * x) * y, np.cos(3 * x) * y * y]))
        points = np.array([[0.0, 0.47], [0.03, 0.61], [0.2, 0.3]])
        found.append(MaterialPoints(body, points, None, mirrored=low == 0).sample(body))
    for name, whole in found[0].items():
        np.testing.assert_allclose(found[1][name], whole, rtol=1e-9, atol=1e-15, err_msg=name)


def test_no_energy_is_negative():
    """Where it hardly rises from nothing a fit to it goes below."""
    mesh = rectangle(8, 8, origin=(-0.5, 0.0))
    body = make_body(mesh, boundary(mesh), 2.0, 50.0, "Q2P1", "small")
    body.displace(0.01 * np.column_stack([mesh.points[:, 0] ** 3, 0 * mesh.points[:, 0]]))
    found = MaterialPoints(
        body, np.column_stack([np.zeros(9), np.linspace(0.3, 0.7, 9)]), None
    ).sample(body)
    for name in ENERGIES:
        assert (found[name] >= 0).all(), name
    assert (found["hydrostatic_pressure"] < 0).any() or (found["dilatation"] < 0).any()


def test_in_a_layer_of_one_row_the_element_has_its_say():
    """There are too few places across it to fit anything."""
    mesh = rectangle(np.linspace(0, 1, 13), 1, 1.0, 0.05)
    body = make_body(mesh, boundary(mesh), 2.0, 50.0, "Q2P1", "finite")
    body.displace(0.01 * np.sin(5 * mesh.points))
    assert MaterialPoints(body, np.array([[0.51, 0.02]]), None).recovery is None


def located(space, points):
    """The nearest element that each point lies in."""
    owner, found = containing(space, points)
    first = np.unique(owner, return_index=True)[1]
    np.testing.assert_array_equal(owner[first], np.arange(len(points)))
    return Location(found.element[first], found.xi[first])


CURVED = {
    "quad9": ("Q2P1", ElementQuad2),
    "tri6": ("P2B", ElementTriP2),
    "quad4": ("Q1P0", ElementQuad1),
}


@pytest.mark.parametrize("bent", [False, True], ids=["irregular", "curved"])
@pytest.mark.parametrize("kind", CURVED)
def test_points_are_found_where_scikit_fem_maps_them(kind, bent):
    """Places in elements of curved sides or irregular shape, mapped by scikit-fem, are found again,
    and in no second element.
    """
    element, shape = CURVED[kind]
    mesh = (
        quarter_annulus(5, 6, 1.0, 2.0, kind)
        if bent
        else rectangle(9, 8, kind=kind, distortion=0.3)
    )
    body = make_body(mesh, boundary(mesh), 2.0, 50.0, element, "finite")
    random = np.random.default_rng(3)
    host, xi = (
        random.integers(len(mesh.cells), size=2000),
        random.uniform(1e-3, 1 - 1e-3, (2000, 2)),
    )
    if kind == "tri6":
        xi = np.where(xi.sum(1, keepdims=True) < 1, xi, 1 - xi)
    numbered = SimpleNamespace(
        element_dofs=mesh.cells.T
    )  # gmsh and scikit-fem number the nodes of these elements alike
    mapping = MappingIsoparametric(
        SimpleNamespace(doflocs=mesh.points.T, dofs=numbered, dim=lambda: 2), shape()
    )
    mapped = mapping.F(xi.T[:, :, None], tind=host)[:, :, 0].T
    found = located(body.space, mapped)
    np.testing.assert_array_equal(found.element, host)
    np.testing.assert_allclose(found.xi, xi, atol=1e-11)
    assert len(containing(body.space, mapped)[0]) == len(mapped)
    with pytest.raises(ReceptorError, match="outside"):
        located(body.space, np.concatenate([mapped[:3], [[3.0, 3.0]]]))


@pytest.mark.parametrize("kind", ["quad9", "tri6"])
def test_points_are_found_in_long_elements_beside_many_narrow_ones(kind):
    """Under a refined contact: the centre of the element is farther off than those of a hundred in
    the row below.
    """
    mesh = rectangle(200, 2, kind=kind)
    mesh.points[:, 1] = np.interp(mesh.points[:, 1], [0, 0.5, 1], [0, 0.1, 1])
    body = make_body(mesh, boundary(mesh), 2.0, 50.0, CURVED[kind][0], "finite")
    points = np.array([[0.5025, 0.15], [0.3025, 0.05], [0.5, 0.15], [0.7025, 0.12]])
    found = located(body.space, points)
    values = body.space.element.shape(found.xi)[0]
    np.testing.assert_allclose(
        np.einsum("na,nai->ni", values, body.space.points[body.space.cells[found.element]]), points
    )
    assert (
        len(np.unique(containing(body.space, points)[0]))
        == len(points)
        < len(containing(body.space, points)[0])
    )
    with pytest.raises(ReceptorError, match="outside"):
        located(body.space, np.array([[0.5, 0.15], [0.5, 1.2]]))

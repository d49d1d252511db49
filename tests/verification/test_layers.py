"""Layers: a thin bonded incompressible one, a stiff one on a soft one, and their contact with a
cylinder.
"""

from functools import cache

import numpy as np
import pytest
from pressing import press
from problems import solve, two_numbers
from skfem import ElementLineP2
from skfem.quadrature import get_quadrature
from strips import Layer, half_strip

from fingerpad.reference_solutions import layered, layered_contact
from fingerpad.stimuli.shapes import Cylinder

# -- thin layer ------------------------------------------------------------------------------------

HALF_WIDTH, THIN_RADIUS, SHEAR, POISSON = 15.0, 2e4, 1.0, 0.49999
#: half width, centre pressure and depth
THIN = {
    "Q1P0": (0.3213214, 0.0018420974),
    "Q2P1": (0.32110099, 0.001845894),
    "P2B": (0.32104154, 0.0018457883),
}


@cache
def fourier(layers, radius, half_length, load):
    """What an independent solution says, once for all elements and mutants."""
    return layered_contact.press(
        lambda x: x**2 / (2 * radius), list(layers), half_length, load, 1024
    )


def check_thin_layer(element, poisson=POISSON, ran_as=None):
    """A layer of thickness one under a contact fifteen thicknesses to each side."""
    load = layered.thin_layer_force(HALF_WIDTH, THIN_RADIUS, 1.0, 3 * SHEAR)
    mesh, body = half_strip(
        [Layer(1.0, SHEAR, poisson)],
        4 * HALF_WIDTH,
        ran_as or element,
        fine=0.3,
        columns=(36, 16),
        rows=[4],
    )
    result = press(body, mesh, Cylinder(curvature=1 / THIN_RADIUS), force=load / 2)
    truth = fourier((Layer(1.0, SHEAR, POISSON),), THIN_RADIUS, 4 * HALF_WIDTH, load)
    law = layered.thin_layer_pressure(result.x, HALF_WIDTH, THIN_RADIUS, 1.0, 3 * SHEAR)
    inside = result.x < 0.9 * HALF_WIDTH
    error = np.abs(result.pressure - law)[inside].max() / law[0]
    assert error < 0.03, f"truth: the pressure is off by {error:.4f} of its peak"
    frozen = THIN[element]
    two_numbers(result.pressure[0], truth=truth.pressure[0], within=0.01, frozen=frozen[0])
    two_numbers(result.depth, truth=truth.depth, within=0.015, frozen=frozen[1])


@pytest.mark.parametrize("element", ["Q1P0", "Q2P1", "P2B"])
def test_thin_bonded_incompressible_layer(element, must_fail):
    """On a thin bonded incompressible layer p = E (a^2 - x^2)^2/(24 R b^3) (Johnson 1985, 5.8)."""
    check_thin_layer(element)
    must_fail(check_thin_layer, element, poisson=0.48)
    must_fail(check_thin_layer, element, ran_as="Q1")


# -- cosine load on two layers ---------------------------------------------------------------------

WAVENUMBER, PRESSURE = 2.0, 0.01
#: sinking under the crest
PAIRS = (0.1, 0.25), (0.1, 0.5), (0.5, 0.5), (5.0, 0.5)  # ratio of moduli, thickness
KERNEL = {
    "Q1P0": (0.020145466, 0.010270529, 0.0040238766, 0.0010184593),
    "Q2P1": (0.020117993, 0.010274054, 0.004024003, 0.0010178698),
    "P2B": (0.020112506, 0.010274079, 0.0040242222, 0.0010182122),
}


def cosine_load(mesh):
    """Nodal forces (n, 2) of the pressure PRESSURE cos(k x) on the top, by a fine Gauss rule."""
    edges = mesh.curves["top"]
    position, weight = get_quadrature(ElementLineP2, 9)
    s = 2 * position[0] - 1
    if edges.shape[1] == 3:
        values = np.stack([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s**2], 1)
    else:
        values = np.stack([(1 - s) / 2, (1 + s) / 2], 1)
    x = mesh.points[edges, 0]
    length = x[:, 1] - x[:, 0]
    nodal = np.einsum("q,qa,mq,m->ma", weight, values, np.cos(WAVENUMBER * x @ values.T), length)
    load = np.zeros(mesh.points.shape)
    np.add.at(load[:, 1], edges, -PRESSURE * nodal)
    return load


def check_kernel(element, ratio, thickness, run_ratio=None, poisson=0.4999):
    """Layer of shear modulus one on ``ratio``, half a period wide, six over k deep."""
    layers = [
        Layer(thickness, 1.0, poisson),
        Layer(6 / WAVENUMBER - thickness, run_ratio or ratio, poisson),
    ]
    rows = [max(4, round(16 * thickness)), 14]
    mesh, body = half_strip(
        layers, np.pi / WAVENUMBER, element, fine=0.98, columns=(20, 1), rows=rows
    )
    load = np.zeros_like(body.u)
    load[: len(mesh.points)] = cosine_load(mesh)
    solve(body, load, tolerance=1e-9)
    crest = np.flatnonzero((mesh.points == (0.0, 0.0)).all(1))[0]
    sinking = -body.u[crest, 1]
    half_plane = (
        PRESSURE / (2 * WAVENUMBER) * layered.incompressible_kernel(WAVENUMBER * thickness, ratio)
    )
    assert abs(sinking - half_plane) < 0.03 * half_plane, (
        f"truth: {sinking!r} is not {half_plane!r}"
    )
    stack = [Layer(thickness, 1.0, 0.4999), Layer(6 / WAVENUMBER - thickness, ratio, 0.4999)]
    truth = PRESSURE * layered.stack_compliance(WAVENUMBER, stack)
    within = 0.02 if element == "Q1P0" else 2e-3
    frozen = KERNEL[element][PAIRS.index((ratio, thickness))]
    two_numbers(sinking, truth=truth, within=within, frozen=frozen)


@pytest.mark.parametrize("ratio, thickness", PAIRS)
@pytest.mark.parametrize("element", KERNEL)
def test_layered_half_plane_kernel(element, ratio, thickness, must_fail):
    """A layer on another sinks under a cosine load as the bonded incompressible pair does (Gladwell
    1980).
    """
    check_kernel(element, ratio, thickness)
    must_fail(check_kernel, element, ratio, thickness, run_ratio=1.0)
    must_fail(check_kernel, element, ratio, thickness, poisson=0.4)


# -- contact of a layered strip --------------------------------------------------------------------

SKIN = [Layer(0.85, 10.0, 0.48), Layer(0.85, 1.0, 0.48), Layer(3.3, 1.0, 0.48)]
#: depth, centre pressure and half width
STRIP = {
    ("Q1P0", 0.04): (0.0073395707, 0.028829166, 0.80605476),
    ("Q1P0", 0.4): (0.035284392, 0.067357709, 3.2367113),
    ("Q2P1", 0.04): (0.007343818, 0.028845904, 0.80851361),
    ("Q2P1", 0.4): (0.03535808, 0.067363051, 3.239468),
    ("P2B", 0.04): (0.0073436397, 0.028819244, 0.8071404),
    ("P2B", 0.4): (0.035357061, 0.067364309, 3.2386073),
}


def check_strip(element, load, layers=SKIN):
    radius, half_length = 200.0, 12.0
    mesh, body = half_strip(
        layers, half_length, element, fine=0.3, columns=(48, 16), rows=[7, 4, 9]
    )
    result = press(body, mesh, Cylinder(curvature=1 / radius), force=load / 2)
    truth = fourier(tuple(SKIN), radius, half_length, load)
    within, frozen = (0.03 if element == "Q1P0" else 0.01), STRIP[element, load]
    two_numbers(result.depth, truth=truth.depth, within=within, frozen=frozen[0])
    two_numbers(result.pressure[0], truth=truth.pressure[0], within=within, frozen=frozen[1])
    two_numbers(result.half_width, truth=truth.half_width, within=0.03, frozen=frozen[2])


@pytest.mark.parametrize("load", [0.04, 0.4])
@pytest.mark.parametrize("element", ["Q1P0", "Q2P1", "P2B"])
def test_contact_of_a_layered_strip(element, load, must_fail):
    """Three layers in the pad's proportions meet a cylinder as an independent Fourier solution
    says.
    """
    check_strip(element, load)
    must_fail(check_strip, element, load, layers=[Layer(0.85, 1.0, 0.48), *SKIN[1:]])
    must_fail(check_strip, element, load, layers=[*SKIN[:2], Layer(3.3, 10.0, 0.48)])

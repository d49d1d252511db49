"""Contact of a half-plane without friction: Hertz (1881) and Westergaard (1939)."""

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from pressing import press
from problems import two_numbers
from strips import Layer, half_strip

from fingerpad.reference_solutions import hertz, layered_contact, westergaard
from fingerpad.stimuli.profile import Profile
from fingerpad.stimuli.shapes import Cylinder

DEPTH, RADIUS, SHEAR = 20.0, 200.0, 1.0  # in units of the half width of the contact, 1
POISSON = 0.4999
WITHIN = {"Q1P0": 0.03, "Q2P1": 0.005, "P2B": 0.015}

#: half width, centre pressure over p0 and depth
HERTZ = {
    "Q1P0": (0.98951396, 1.0015806, 0.0073596403),
    "Q2P1": (0.99736459, 1.0012484, 0.0073814133),
    "P2B": (0.99728556, 1.0002421, 0.0073755303),
}


def hertz_contact(element, poisson=POISSON, radius=RADIUS, load_share=1.0):
    """Strip twenty half widths deep under the force that makes a half width of one."""
    load = hertz.force(1.0, RADIUS, 2 * SHEAR / (1 - POISSON))
    mesh, body = half_strip([Layer(DEPTH, SHEAR, poisson)], DEPTH, element)
    return load, press(body, mesh, Cylinder(curvature=1 / radius), force=load_share * load / 2)


@cache
def strip_depth(load):
    """What an independent solution of the strip says, once for all elements."""
    strip = [Layer(DEPTH, SHEAR, POISSON)]
    return layered_contact.press(lambda x: x**2 / (2 * RADIUS), strip, DEPTH, load, 1024).depth


def check_hertz(element, **mutant):
    load, result = hertz_contact(element, **mutant)
    p0, within, frozen = hertz.peak_pressure(load, 1.0), WITHIN[element], HERTZ[element]
    inside = result.x < 0.85  # the last element before the edge has its pressure smoothed
    assert inside.sum() > 6
    error = np.abs(result.pressure - hertz.pressure(result.x, 1.0, p0))[inside].max() / p0
    assert error < within, f"truth: the pressure is off by {error:.4f} of its peak"
    two_numbers(result.half_width, truth=1.0, within=within, frozen=frozen[0])
    two_numbers(result.pressure[0] / p0, truth=1.0, within=within, frozen=frozen[1])
    two_numbers(2 * result.force, truth=load, within=1e-7, frozen=load, tight=1e-7)
    two_numbers(result.depth, truth=strip_depth(load), within=within / 3, frozen=frozen[2])


@pytest.mark.parametrize("element", WITHIN)
def test_hertz_line_contact(element, must_fail):
    """A rigid cylinder makes Hertz's pressure inside 0.85 a, his width, and the depth of a
    strip.
    """
    check_hertz(element)
    must_fail(check_hertz, element, poisson=0.3)
    must_fail(check_hertz, element, radius=0.8 * RADIUS)
    must_fail(check_hertz, element, load_share=0.9)


@dataclass(frozen=True)
class Sinusoid(Profile):
    """Rigid wave 2 h sin^2(pi x/lambda) of small slope, lowest at x = 0."""

    amplitude: float
    wavelength: float

    def outline(self, x):
        return self.amplitude * (1 - np.cos(2 * np.pi * x / self.wavelength))

    def evaluate(self, points):
        k = 2 * np.pi / self.wavelength
        phase = k * points[:, 0]
        height = self.amplitude * (1 - np.cos(phase))
        slope = self.amplitude * k * np.sin(phase)
        cosine = 1 / np.sqrt(1 + slope**2)
        gradient = np.column_stack([slope, -np.ones_like(slope)]) * cosine[:, None]
        return (
            (height - points[:, 1]) * cosine,
            gradient,
            self.amplitude * k**2 * np.cos(phase) * cosine**3,
        )


WAVE, WAVELENGTH = 1e-3, 2.0
#: half width over the wavelength and peak pressure over the full-contact pressure
WESTERGAARD = {
    ("Q1P0", 0.1): (0.098820632, 0.61893656),
    ("Q1P0", 0.25): (0.24862259, 1.4150667),
    ("Q1P0", 0.4): (0.40066878, 1.9035328),
    ("Q2P1", 0.1): (0.099996546, 0.61787786),
    ("Q2P1", 0.25): (0.24958546, 1.4143621),
    ("Q2P1", 0.4): (0.39937955, 1.9027055),
    ("P2B", 0.1): (0.099694072, 0.6175548),
    ("P2B", 0.25): (0.24945527, 1.4142467),
    ("P2B", 0.4): (0.39955267, 1.9025999),
}


def check_westergaard(element, ratio, poisson=0.4, amplitude=WAVE):
    modulus = 2 * SHEAR / (1 - 0.4)
    half = ratio * WAVELENGTH
    full = westergaard.full_contact_pressure(WAVE, WAVELENGTH, modulus)
    load = westergaard.mean_pressure(half, WAVE, WAVELENGTH, modulus) * WAVELENGTH
    mesh, body = half_strip(
        [Layer(WAVELENGTH, SHEAR, poisson)],
        WAVELENGTH / 2,
        element,
        fine=0.98,
        columns=(40, 1),
        rows=(20, 10),
    )
    result = press(body, mesh, Sinusoid(amplitude, WAVELENGTH), force=load / 2)
    truth = westergaard.pressure(result.x, half, WAVE, WAVELENGTH, modulus)
    inside, within = result.x < 0.85 * half, 1.6 * WITHIN[element]
    error = np.abs(result.pressure - truth)[inside].max() / truth[0]
    assert error < within, f"truth: the pressure is off by {error:.4f} of its peak"
    frozen = WESTERGAARD[element, ratio]
    two_numbers(result.half_width / WAVELENGTH, truth=ratio, within=within, frozen=frozen[0])
    two_numbers(result.pressure[0] / full, truth=truth[0] / full, within=within, frozen=frozen[1])


@pytest.mark.parametrize("ratio", [0.1, 0.25, 0.4])
@pytest.mark.parametrize("element", WITHIN)
def test_westergaard_wave(element, ratio, must_fail):
    """A wavy surface touches with the width and the pressure of Westergaard's periodic solution."""
    check_westergaard(element, ratio)
    must_fail(check_westergaard, element, ratio, poisson=0.1)
    must_fail(check_westergaard, element, ratio, amplitude=1.3 * WAVE)

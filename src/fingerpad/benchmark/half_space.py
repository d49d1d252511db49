"""The skin as an elastic half-space: closed forms and sums of them, the least that a model of a
finger has to beat.

The finger's roundness enters through the gap alone. Layers, bone and large strains are not there.
Sources: K. L. Johnson, *Contact Mechanics* (1985), sections 2.6 (line loads), 3.2 (point force),
3.4 and 4.2 (Hertz); I. N. Sneddon (1965), Int J Eng Sci 3:47 (cone and punch).
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from fingerpad.reference_solutions import hertz
from fingerpad.reference_solutions.phillips_johnson import (
    strain_energy_density,
    strains,
    strip_stresses,
)

PAD_RADIUS = 9.5e-3
"""m, of a finger seen end on: a drop of 0.24 mm at 2.25 mm and of 0.94 mm at 4.25 mm."""
YOUNGS_MODULUS, POISSON = 50e3, 0.4
"""Pa, 1: those of TouchSim (Saal and others 2017). Every fitted constant absorbs the modulus."""
BONE_DEPTH = 6e-3
"""m, what the sinking of a half-plane refers to."""
_RINGS, _SPOKES, _STRIP = 64, 96, 0.05e-3


def force(stimulus: dict, depth: np.ndarray) -> np.ndarray:
    """Forces (n,) N of a plate (flat), a punch or a cone at depths (n,) m; lengths of it in m, the
    half angle in rad.
    """
    modulus = hertz.composite_modulus(YOUNGS_MODULUS, POISSON)
    if stimulus["shape"] == "flat":
        return 4 / 3 * modulus * np.sqrt(PAD_RADIUS) * depth**1.5
    if stimulus["shape"] == "punch":
        return modulus * stimulus["diameter"] * depth
    return 2 / np.pi * modulus * np.tan(stimulus["half_angle"]) * depth**2


def deflection(diameter: float, depth: float, x: np.ndarray) -> np.ndarray:
    """How far (n,) m the incompressible skin is down at places (n,) m beside a cylinder's middle.

    Not a number where the cylinder is deeper, against a point :data:`BONE_DEPTH` below, than any
    force brings it: the logarithm of the approach has a largest value.
    """
    radius = 1 / (2 / diameter + 1 / PAD_RADIUS)

    def too_deep(a):
        reached = hertz.approach_to_depth(hertz.force(a, radius, 1.0), a, 1.0, 0.5, BONE_DEPTH)
        return reached - depth

    widest = 2 / np.e * BONE_DEPTH
    if too_deep(widest) < 0:
        return np.full(np.shape(x), np.nan)
    a = brentq(too_deep, 1e-6, widest)
    over = np.maximum(np.abs(np.asarray(x)) / a, 1.0)
    risen = a**2 / (2 * radius) * (over * np.sqrt(over**2 - 1) - np.arccosh(over))
    return depth - np.asarray(x) ** 2 / (2 * radius) + risen


def under_sphere(
    force: float, curvature: float, x: np.ndarray, z: float
) -> tuple[np.ndarray, np.ndarray]:
    """Strain energy density Pa and largest compressive strain, (n,) each, at places (n,) m beside
    the axis of a sphere, z m deep.
    """
    radius = 1 / (curvature + 1 / PAD_RADIUS)
    modulus = hertz.composite_modulus(YOUNGS_MODULUS, POISSON)
    a = (3 * force * radius / (4 * modulus)) ** (1 / 3)
    # Gauss's points in the square of the radius carry equal areas
    nodes, weights = np.polynomial.legendre.leggauss(_RINGS)
    ring, share = a * np.sqrt((nodes + 1) / 2), weights / 2
    load = 1.5 * force * share * np.sqrt(1 - (ring / a) ** 2) / _SPOKES
    angle = 2 * np.pi * (np.arange(_SPOKES) + 0.5) / _SPOKES
    place = ring[:, None] * np.exp(1j * angle)
    away = np.asarray(x, float)[:, None, None] - place
    stress = _point_force(away, z, load[:, None]).sum(axis=(-2, -1))
    trace = stress[0, 0] + stress[1, 1] + stress[2, 2]
    square = (stress**2).sum(axis=(0, 1))
    energy = ((1 + POISSON) * square - POISSON * trace**2) / (2 * YOUNGS_MODULUS)
    least = np.linalg.eigvalsh(np.moveaxis(stress, -1, 0))[:, 0]
    return energy, -((1 + POISSON) * least - POISSON * trace) / YOUNGS_MODULUS


def _point_force(away: np.ndarray, z: float, load: np.ndarray) -> np.ndarray:
    """Stresses (3, 3, ...) Pa by forces at distances (complex, m) on the surface."""
    r, angle = np.abs(away), np.angle(away)
    rho, c, s = np.hypot(r, z), np.cos(angle), np.sin(angle)
    near = (1 - 2 * POISSON) / (rho * (rho + z))
    scale = load / (2 * np.pi)
    radial = scale * (near - 3 * z * r**2 / rho**5)
    around = scale * ((1 - 2 * POISSON) * z / rho**3 - near)
    down, shear = -3 * scale * z**3 / rho**5, -3 * scale * r * z**2 / rho**5
    xx, yy, xy = (
        radial * c**2 + around * s**2,
        radial * s**2 + around * c**2,
        (radial - around) * s * c,
    )
    return np.array([[xx, xy, shear * c], [xy, yy, shear * s], [shear * c, shear * s, down]])


def under_bars(
    bars: list[tuple[float, float]], x: np.ndarray, z: float
) -> tuple[np.ndarray, np.ndarray]:
    """Strain energy density Pa and largest compressive strain, (n,) each, at places (n,) m under
    flat bars (from, to) m at one height, by 1 N/m for every millimetre of bar.
    """
    edges = [np.linspace(a, b, max(int(round((b - a) / _STRIP)), 2) + 1) for a, b in bars]
    left, right = (np.concatenate([each[part] for each in edges]) for part in (_START, _END))
    middle, width = (left + right) / 2, right - left

    def whole(t):  # integral of ln |t|
        return t * (np.log(np.maximum(np.abs(t), 1e-12)) - 1)

    sinking = whole(right - middle[:, None]) - whole(left - middle[:, None])
    system = np.block([[sinking, np.ones((len(middle), 1))], [width, np.zeros((1, 1))]])
    total = 1e3 * width.sum()
    pressure = np.linalg.solve(system, np.append(np.zeros(len(middle)), total))[:-1]
    stress = np.sum(
        [
            strip_stresses(x, z, np.array([a, b]), np.array([p]))
            for a, b, p in zip(left, right, pressure, strict=True)
        ],
        axis=0,
    )
    shear = YOUNGS_MODULUS / (2 * (1 + POISSON))
    bulk = YOUNGS_MODULUS / (3 * (1 - 2 * POISSON))
    energy = strain_energy_density(*stress, shear, bulk, POISSON)
    return energy, -strains(*stress, YOUNGS_MODULUS, POISSON)[1]


_START, _END = slice(None, -1), slice(1, None)

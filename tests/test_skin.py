"""Local skin curvature: exact on arcs, robust to noise, the profile's own in contact of a simulated
press.
"""

from pathlib import Path

import numpy as np
import pytest

from fingerpad import load_scene, simulate
from fingerpad.measures.features import centre_node
from fingerpad.measures.skin import WINDOW, local_curvature, skin_curvature

SCENES = Path(__file__).parents[1] / "config" / "scenes"
SPACINGS = (67e-6, 134e-6)  # m, nodes of the thesis's resolution and of a draft


def arc(curvature, spacing, tilt=0.0, count=60):
    """Nodes on an arc through the origin, tangent tilted by an angle (rad); positive curvature is
    hollow from above.
    """
    angle = np.arange(-count, count + 1) * spacing * curvature
    points = np.array([np.sin(angle), 1 - np.cos(angle)]) / curvature
    turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
    return turn @ points


@pytest.mark.unit
@pytest.mark.parametrize("spacing", SPACINGS)
@pytest.mark.parametrize("curvature", [26.25, 105.0, 315.0, 1260.0, -39.37, -127.0])
@pytest.mark.parametrize("tilt", [0.0, -0.7, 2.0])
def test_an_arc_has_its_own_curvature_whatever_its_direction(curvature, spacing, tilt):
    x, y = arc(curvature, spacing, tilt)
    assert local_curvature(x, y, 60) == pytest.approx(curvature, rel=0.02)


@pytest.mark.unit
def test_uneven_nodes_do_not_matter():
    x, y = arc(210.0, 30e-6, 0.3, 200)
    keep = np.union1d(np.random.default_rng(1).choice(401, 200, replace=False), [200])
    middle = int(np.searchsorted(keep, 200))
    assert local_curvature(x[keep], y[keep], middle) == pytest.approx(210, rel=5e-3)


@pytest.mark.unit
@pytest.mark.parametrize("spacing", SPACINGS)
def test_noise_is_damped_as_documented(spacing):
    noise, random = 10e-9, np.random.default_rng(0)
    line = np.tile(arc(26.25, spacing)[:, None], (1, 400, 1))
    x, y = line + random.normal(0, noise, line.shape)
    found = local_curvature(x, y, 60)
    assert found.mean() == pytest.approx(26.25, rel=0.01)
    assert found.std() < 4.5 * noise / WINDOW**2


@pytest.mark.slow
@pytest.mark.parametrize("surface", [315, 79])
def test_in_contact_the_skin_has_the_surfaces_curvature(surface):
    scene = load_scene(SCENES / f"ramp40_k{surface}.yaml")
    history = simulate(scene.with_accuracy("draft"))
    centre, last = centre_node(history), history.isel(time=[-1])
    touching = np.flatnonzero(last["contact_pressure"].values[0] > 0)
    x = last["skin_x"].values + last["skin_displacement_x"].values[0]
    inside = np.minimum(x - x[touching[0]], x[touching[-1]] - x)[touching] > 1.1 * WINDOW
    inner = touching[inside]
    found = [float(skin_curvature(last, n)[0]) for n in inner]
    assert centre in inner and len(inner) >= 5
    assert found == pytest.approx([surface] * len(inner), rel=0.011)
    free = skin_curvature(history, centre)[0]
    radius = scene.specimen.outline.apex_radius
    assert free == pytest.approx(-1 / radius, rel=0.02)  # the unloaded apex bulges

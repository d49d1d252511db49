"""Laws: stress and tangent are the energy's derivatives, all start from one modulus, and adding one
takes a file.
"""

from dataclasses import replace

import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.laws import LAWS, NEO_HOOKE, Constant, Law, assign
from fingerpad.results import scene_of
from wrong_scenes import write

pytestmark = pytest.mark.unit


def _energy(i1, jac, mu, constants):
    j, i2 = jac ** (-2.0 / 3.0), i1 - 1.0 + jac * jac
    return 0.5 * mu * ((1.0 - constants[0]) * (j * i1 - 3.0) + constants[0] * (j * j * i2 - 3.0))


def _stress(i1, jac, mu, constants):
    s, j, i2 = constants[0], jac ** (-2.0 / 3.0), i1 - 1.0 + jac * jac
    shape = (1.0 - s) * j + s * j * j
    return mu * shape, ((1.0 - s) * j * i1 + s * j * j * (2.0 * i2 - 3.0 * jac * jac)) / shape


def _tangent(i1, jac, mu, constants):
    s, j, i2 = constants[0], jac ** (-2.0 / 3.0), i1 - 1.0 + jac * jac
    m, t = _stress(i1, jac, mu, constants)
    mixed = -mu * (2.0 * (1.0 - s) * j + 4.0 * s * j * j) / (3.0 * jac)
    bent = 5.0 * (1.0 - s) * j * i1 + s * j * j * (14.0 * i2 - 15.0 * jac * jac)
    return m, t, 0.0, mixed, mu * bent / (9.0 * jac * jac)


#: A law that only this test knows, of both invariants (Mooney 1940; Rivlin 1948).
MOONEY_RIVLIN = Law(
    "mooney_rivlin",
    _energy,
    _stress,
    _tangent,
    {"share": Constant("Of the second invariant", 0.3, high=1.0)},
    bilinear=True,
)
CASES = [
    (NEO_HOOKE, ()),
    (LAWS["yeoh"], (0.4, 0.15)),
    (LAWS["yeoh"], (0.0, 0.0)),
    (MOONEY_RIVLIN, (0.35,)),
]
EACH = pytest.mark.parametrize(
    "law, constants", CASES, ids=lambda value: getattr(value, "name", None)
)


def test_every_law_is_checked_here():
    assert set(LAWS.values()) <= {law for law, _ in CASES}


def check_derivatives(law, constants, step=1e-30):
    """Complex steps: exact to round-off, without a difference of near numbers."""
    i1, jac = (grid.ravel() for grid in np.meshgrid([2.7, 3.0, 3.3, 4.5], [0.85, 1.0, 1.1]))
    mu = np.full(i1.shape, 2.5)
    m, t, f, g, h = np.broadcast_arrays(*law.tangent(i1, jac, mu, constants))
    to_i1, to_jac = (i1 + 1j * step, jac, mu, constants), (i1, jac + 1j * step, mu, constants)
    truth = {"rtol": 1e-13, "atol": 1e-13, "err_msg": "truth"}
    np.testing.assert_allclose(law.stress(i1, jac, mu, constants), (m, t), **truth)
    np.testing.assert_allclose(2 * np.imag(law.energy(*to_i1)) / step, m, **truth)
    np.testing.assert_allclose(-3 * jac * np.imag(law.energy(*to_jac)) / step, m * t, **truth)
    np.testing.assert_allclose(2 * np.imag(law.stress(*to_i1)[0]) / step, f, **truth)
    np.testing.assert_allclose(np.imag(law.stress(*to_jac)[0]) / step, g, **truth)

    def to_volume(i1, jac):
        m, t = law.stress(i1, jac, mu, constants)
        return -m * t / (3 * jac)

    np.testing.assert_allclose(np.imag(to_volume(i1, jac + 1j * step)) / step, h, **truth)
    assert law.bilinear == (not f.any()) or not any(constants)


@EACH
def test_stress_and_tangent_are_derivatives_of_the_energy(law, constants):
    check_derivatives(law, constants)


@EACH
@pytest.mark.parametrize("formula", ["energy", "stress", "tangent"])
def test_a_wrong_formula_is_seen(law, constants, formula):
    """Each formula of each law, its answers a thousandth too large."""

    def wrong(*args):
        found = getattr(law, formula)(*args)
        return (
            1.001 * found if formula == "energy" else tuple(1.001 * part + 1e-3 for part in found)
        )

    with pytest.raises(AssertionError, match="truth"):
        check_derivatives(replace(law, **{formula: wrong}), constants)


@EACH
def test_undeformed_every_law_is_the_linear_solid(law, constants):
    """Without stress at rest, with energy mu dev(e):dev(e) for small strains in the plane, and
    proportional to mu.
    """
    m, t = law.stress(3.0, 1.0, 2.5, constants)
    assert (m, t) == pytest.approx((2.5, 3.0))
    for xx, yy, xy in 1e-4 * np.array([[1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 0, 1], [2, -1, 0.5]]):
        f = np.array([[1 + xx, xy], [xy, 1 + yy]])
        energy = law.energy(np.sum(f * f) + 1, np.linalg.det(f), 2.5, constants)
        mean = (xx + yy) / 3
        linear = 2.5 * ((xx - mean) ** 2 + (yy - mean) ** 2 + mean**2 + 2 * xy**2)
        assert energy == pytest.approx(linear, rel=2e-3)
    twice = 2 * law.energy(4.0, 0.9, 2.5, constants)
    assert law.energy(4.0, 0.9, 5.0, constants) == pytest.approx(twice)


def test_laws_without_their_constants_are_neo_hooke():
    for law in (LAWS["yeoh"], MOONEY_RIVLIN):
        tangent = law.tangent(3.7, 0.95, 2.0, (0.0, 0.0))
        np.testing.assert_allclose(tangent, NEO_HOOKE.tangent(3.7, 0.95, 2.0, ()), rtol=1e-14)


def test_elements_are_given_to_the_laws_of_their_regions():
    yeoh = LAWS["yeoh"]
    region = np.array([0, 2, 1, 1, 0])
    first, second = assign([(yeoh, (0.1, 0.2)), (NEO_HOOKE, ()), (yeoh, (0.3, 0.4))], region)
    assert (first.law, second.law) == (yeoh, NEO_HOOKE)
    assert first.elements.tolist() == [True, True, False, False, True]
    assert second.elements.tolist() == (~first.elements).tolist()
    assert first.constants[first.elements].tolist() == [[0.1, 0.2], [0.3, 0.4], [0.1, 0.2]]
    (only,) = assign([(NEO_HOOKE, ()), (yeoh, (0.0, 0.0))], np.zeros(4, int))
    assert only.law == NEO_HOOKE


LIGHT = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf"}],
    "accuracy": {"skin_edge": "0.8 mm", "steps": 2},
}


def scene_with(tmp_path, law):
    layers = {"fat": {"law": law}, "dermis": {"law": law}}
    return load_scene(write(tmp_path, LIGHT | {"specimen": {"layers": layers}}))


@pytest.mark.slow  # its element loops are compiled for this test only
def test_a_law_defined_here_goes_from_the_scene_to_the_answer(tmp_path, monkeypatch):
    """In plane strain without change of volume Mooney-Rivlin is neo-Hooke, and these layers change
    theirs by little.
    """
    monkeypatch.setitem(LAWS, MOONEY_RIVLIN.name, MOONEY_RIVLIN)
    scene = scene_with(tmp_path, {"name": "mooney_rivlin", "share": "60 %"})
    fat = scene.specimen.layers.fat.law
    assert (fat.law, fat.constants) == (MOONEY_RIVLIN, (0.6,))
    history, plain = simulate(scene, plan(scene)), simulate(scene_with(tmp_path, "neo_hooke"))
    assert scene_of(history) == scene and "law" not in plain.attrs["scene"]
    ends = [float(run["indentation_depth"][-1]) for run in (history, plain)]
    assert 1e-5 < abs(ends[0] / ends[1] - 1) < 0.02
    energies = [run["strain_energy_network"].values[-1] for run in (history, plain)]
    np.testing.assert_allclose(*energies, rtol=0.05)


def test_planner_counts_a_law_in_what_small_strain_would_cost(tmp_path):
    reasons = [
        plan(scene_with(tmp_path, law)).effects["finite_strain"].why
        for law in ("neo_hooke", {"name": "yeoh", "second": 2})
    ]
    assert "laws" not in reasons[0] and "laws" in reasons[1]

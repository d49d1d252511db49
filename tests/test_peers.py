"""The same press by FElupe and by this package."""

import numpy as np
import pytest

from fingerpad.studies.peers import converged, ours, press

pytestmark = pytest.mark.verification
felupe = pytest.importorskip("felupe", reason="an optional dependency: pip install -e .[peers]")


def test_both_packages_solve_the_same_press():
    """Force, largest displacement and strain energy agree to the tolerance of the solver, and nothing is pulled."""
    scene, chosen, mesh = press(0.3)
    answer, simulation = ours(scene, chosen, mesh)
    other, pushes = converged(scene, mesh, simulation)
    assert other.force == pytest.approx(answer.force, rel=1e-4)
    assert other.displacement == pytest.approx(answer.displacement, rel=1e-4)
    assert other.energy == pytest.approx(answer.energy, rel=1e-5)
    assert np.all(pushes > 0)

"""The edge of the contact moves continuously: curves of a ramp and hold have no kinks where more of
the skin begins to touch.
"""

import numpy as np
import pytest

from cysyk1999.studies.accuracy import edges
from fingerpad import load_scene
from fingerpad.scenes.scene import Cylinder

SCENE = {
    "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}],
}
LEAST = 3e-3
FROZEN = {
    105.0: (0.00195, 0.0006, 0.0007, 0.00101, 0.00105),
    210.0: (0.0024, 0.00036, 0.0004, 0.00201, 0.00145),
    1260.0: (0.00112, 0.00011, 0.00011, 0.00084, 0.00093),
}
"""1/m -> kinks of contact width, peak pressure, centre pressure, and rates of strain energy at 600
and 915 um.
"""


def check_kinks(curvature=210.0, share=1.0):
    scene = load_scene(SCENE).varied({"stimulus": Cylinder(curvature=curvature)})
    found = edges.kinks(edges.pressed(scene, share))
    assert max(found.values()) < LEAST, f"truth: no kink, not {found}"
    assert list(found.values()) == pytest.approx(FROZEN[curvature], rel=0.1)


@pytest.mark.parametrize("curvature", FROZEN)
def test_curves_have_no_kinks(curvature, must_fail):
    """At the thesis's accuracy no kink is above 0.3 % of a curve's range; with a tenth of the
    smoothing, several are.
    """
    check_kinks(curvature)
    if curvature == 210:
        must_fail(check_kinks, curvature, share=0.1)
        must_fail(check_kinks, curvature, share=0.001)


def test_pressures_of_corners_and_mid_sides_do_not_alternate(must_fail):
    """By half a per cent of the peak at most."""

    def check_alternation(share=1.0):
        assert edges.alternation(edges.pressed(load_scene(SCENE), share)) < 5e-3, (
            "truth: a smooth pressure"
        )

    check_alternation()
    must_fail(check_alternation, share=0.001)


def test_a_kink_is_measured():
    """Of |x| the parabola through 1 and 4 of its squares begins at 2/3; a parabola has none."""
    time = np.linspace(0, 10, 11)
    assert edges.kink(time, 3 + time**2) == pytest.approx(0.0, abs=1e-12)
    assert edges.kink(time, np.abs(time - 5)) == pytest.approx(2 / 3)

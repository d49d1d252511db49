"""Strokes over ridged pads under hard conditions: high tips of ten times the modulus, friction 1,
ridges of the skin.

Sharp tips are stroked in the catalogue of hard cases.
"""

import numpy as np
import pytest
from test_hard_cases import MM, SCENES, force, scene
from test_hard_strokes import LOAD, slide, sound_stroke

from cysyk1999.measures.direction import islands
from fingerpad import load_scene, simulate
from fingerpad.scenes.scene import Cylinder, Flat
from fingerpad.scenes.specimen import Specimen

pytestmark = pytest.mark.stability
PRESS = force(20, 40)


@pytest.fixture(scope="module")
def base():
    return load_scene(SCENES / "ramp40_flat.yaml").with_accuracy("draft")


CASES = {
    "as the scenes": ({"inner": {}}, 0.65),
    "high, full friction": ({"inner": {"height": 0.3 * MM}}, 1.0),
    "high, aside, limiting": (
        {"inner": {"height": 0.3 * MM, "phase": 0.1 * MM, "limiting": 0.5}},
        1.0,
    ),
    "outer, full friction": ({"inner": {"height": 0.3 * MM}, "outer": {"height": 0.06 * MM}}, 1.0),
}


@pytest.mark.parametrize("case", CASES)
def test_plate_over_ridges(base, case):
    """No step is cut, no point is compressed by more than a third, and full slip is reached; there
    and 1 mm back.
    """
    ridges, friction = CASES[case]
    specimen = Specimen(ridges=ridges)
    layers = specimen.layers
    assert layers.epidermis.youngs_modulus == pytest.approx(10 * layers.dermis.youngs_modulus)
    asked = scene(base, Flat(), (PRESS, slide(3.5), slide(-1))).model_copy(
        update={"specimen": specimen, "friction": friction}
    )
    history = simulate(asked)
    sound_stroke(history, friction)
    assert history.cutbacks.sum() == 0
    assert history.min_detF.min() > 0.67, f"det F {float(history.min_detF.min()):.3f}"
    there = history.isel(time=np.flatnonzero(history.leg == 1))
    assert float(there.tangential_force[-1]) == pytest.approx(friction * LOAD, rel=1e-3)
    if "outer" in ridges:
        assert islands(history)[-1] >= 5


def test_sharpest_surface_pressed_into_ridges(base):
    asked = scene(base, Cylinder(curvature=1259.84), (PRESS,)).model_copy(
        update={"specimen": Specimen(ridges={"inner": {"height": 0.3 * MM, "shape": "sharp"}})}
    )
    history = simulate(asked)
    assert history.cutbacks.sum() == 0 and history.min_detF.min() > 0.5

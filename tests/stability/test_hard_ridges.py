"""Strokes over ridged pads under hard conditions: high tips of ten times the modulus, friction 1,
ridges of the skin.

Sharp tips are stroked in the catalogue of hard cases.
"""

import numpy as np
import pytest
from test_hard_cases import scene
from test_hard_strokes import LOAD, PRESS, sound_stroke

from cysyk1999.measures.direction import islands
from cysyk1999.studies.common.documents import FLAT, cylinder, slide
from fingerpad import simulate

pytestmark = pytest.mark.stability

HIGH = {"height": "0.3 mm"}
CASES = {
    "as the scenes": ({"inner": {}}, 0.65),
    "high, full friction": ({"inner": HIGH}, 1.0),
    "high, aside, limiting": ({"inner": HIGH | {"phase": "0.1 mm", "limiting": 0.5}}, 1.0),
    "outer, full friction": ({"inner": HIGH, "outer": {"height": "0.06 mm"}}, 1.0),
}


@pytest.mark.parametrize("case", CASES)
def test_plate_over_ridges(case):
    """No step is cut, no point is compressed by more than a third, and full slip is reached; there
    and 1 mm back.
    """
    ridges, friction = CASES[case]
    motion = PRESS, slide(3.5), slide(-1)
    asked = scene(FLAT, motion, specimen={"ridges": ridges}, friction=friction)
    layers = asked.specimen.layers
    assert layers.epidermis.youngs_modulus == pytest.approx(10 * layers.dermis.youngs_modulus)
    history = simulate(asked)
    sound_stroke(history, friction)
    assert history.cutbacks.sum() == 0
    assert history.min_detF.min() > 0.67, f"det F {float(history.min_detF.min()):.3f}"
    there = history.isel(time=np.flatnonzero(history.leg == 1))
    assert float(there.tangential_force[-1]) == pytest.approx(friction * LOAD, rel=1e-3)
    if "outer" in ridges:
        assert islands(history)[-1] >= 5


def test_sharpest_surface_pressed_into_ridges():
    ridges = {"inner": HIGH | {"shape": "sharp"}}
    history = simulate(scene(cylinder(1259.84), [PRESS], specimen={"ridges": ridges}))
    assert history.cutbacks.sum() == 0 and history.min_detF.min() > 0.5

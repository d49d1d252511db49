"""A shape defined here only goes the whole way: scene language, schema, plan, run, results, as
CONTRIBUTING shows.
"""

import json
from typing import Literal

import numpy as np
import pytest

from fingerpad import load_scene, plan, simulate
from fingerpad.documents import SceneError
from fingerpad.fields import Length, SignedLength
from fingerpad.scenes.scene import recorded_scene, scene_json_schema
from fingerpad.stimuli.shapes import SHAPES, Cylinder, Shape
from test_scene import changed, write

pytestmark = pytest.mark.unit


@pytest.fixture(scope="module", autouse=True)
def roller():
    class Roller(Shape):
        """Rigid cylinder beside the middle."""

        shape: Literal["roller"] = "roller"
        radius: Length
        """Radius."""
        beside: SignedLength = 0.0
        """Place of its axis."""

        @property
        def symmetric(self):
            return self.beside == 0

        @property
        def convexity(self):
            return 1 / self.radius

        def evaluate(self, points):
            arm = points - [self.beside, self.radius]
            length = np.hypot(*arm.T)
            return length - self.radius, arm / length[:, None], 1 / length

        def outline(self, x):
            inside = np.abs(x - self.beside) <= self.radius
            return self.radius - np.sqrt(
                np.where(inside, self.radius**2 - (x - self.beside) ** 2, np.nan)
            )

    yield Roller
    del SHAPES["roller"]


def scene(folder, **stimulus):
    document = changed(
        stimulus={"shape": "roller", **stimulus},
        motion=[{"press_to_force": "20 gf"}],
        accuracy="draft",
    )
    return load_scene(write(folder, document))


def test_it_is_read_checked_and_recorded(tmp_path, roller):
    read = scene(tmp_path, radius="5 mm", beside="-0.5 mm")
    assert read.stimulus == roller(radius=5e-3, beside=-5e-4)
    assert recorded_scene(json.loads(json.dumps(read.canonical()))).stimulus == read.stimulus
    assert "Roller" in scene_json_schema()["$defs"]
    for wrong, words in (
        ({"radius": "-1 mm"}, "stimulus.radius: '-1 mm' is negative"),
        ({}, "stimulus.radius: is missing"),
    ):
        with pytest.raises(SceneError, match=words):
            scene(tmp_path, **wrong)


def test_it_is_planned_and_run(tmp_path):
    """Over the middle it is the cylinder, in the plan and to rounding in the run; beside it the pad
    is no mirror image.
    """
    middle = scene(tmp_path, radius="5 mm")
    cylinder = middle.varied({"stimulus": Cylinder(radius=5e-3)})
    assert plan(middle) == plan(cylinder)
    depth, exact = (float(simulate(each).indentation_depth[-1]) for each in (middle, cylinder))
    assert depth == pytest.approx(exact, rel=1e-9)
    beside = scene(tmp_path, radius="5 mm", beside="0.5 mm")
    assert not plan(beside).effects["symmetry"].on
    assert float(simulate(beside).indentation_depth[-1]) == pytest.approx(exact, rel=0.03)


def test_a_class_that_only_evaluates_otherwise_does_not_take_its_parents_place():
    class Flattened(Cylinder):
        """A cylinder that hides its curvature."""

        def evaluate(self, points):
            distance, gradient, curvature = super().evaluate(points)
            return distance, gradient, 0 * curvature

    assert SHAPES["cylinder"] is Cylinder and Flattened(curvature=1.0).shape == "cylinder"

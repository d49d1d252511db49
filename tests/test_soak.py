"""A small part of the random scenes of ``make soak``, always the same."""

import pytest

from random_scenes import Drawn
from soak import soak
from soak_files import soak_files

pytestmark = [pytest.mark.stability, pytest.mark.slow]


def test_random_scenes_are_refused_or_balance():
    found = soak(count=60, start=19, seconds=300)
    drawn, why = found.failure or (None, "")
    assert drawn is None, f"{why}\n{drawn.text}"
    sums = found.table().set_index("what").loc["all"]
    assert sums["drawn"] == 60 and sums["completed"] >= 2 and sums["refused in one line"] >= 8


def test_a_failure_is_shrunk_to_its_smallest_scene(monkeypatch):
    """With a command that trips over every hold: the scene that is left has little else in it."""

    def trips(drawn: Drawn, folder):
        legs = (drawn.document.get("motion") or ()) if isinstance(drawn.document, dict) else ()
        assert not any("hold" in leg for leg in legs if isinstance(leg, dict)), "held"
        return "planned"

    monkeypatch.setattr("soak.tried", trips)
    drawn, why = soak(count=300, start=1, seconds=60).failure
    assert (
        "held" in why
        and set(drawn.document) == {"stimulus", "motion"}
        and len(drawn.document["motion"]) == 2
    )


def test_damaged_files_are_refused_in_one_line_or_right():
    outcomes, failure = soak_files(count=150, start=7, seconds=120)
    assert not failure, failure
    assert (
        sum(outcomes.values()) > 100
        and sum(n for what, n in outcomes.items() if what.endswith("refused")) > 50
    )

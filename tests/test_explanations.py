"""Readings of what the thesis leaves open: what they change in the scenes, and what counts as
explained by one.
"""

import pandas as pd
import pytest

from cysyk1999.studies.explanations.run import (
    CONTROL,
    PUBLISHED,
    READ_ONLY,
    READINGS,
    explanations,
    turned,
)
from fingerpad import load_scene

pytestmark = pytest.mark.unit
REFERENCE, SCENES = "config/reference/thesis_numbers.csv", "config/scenes"


@pytest.mark.parametrize("name", READINGS)
def test_a_reading_changes_what_it_says(name):
    """The control nothing but the accuracy, a reading of the wavy surface no press, the others what
    they name, everywhere.
    """
    reading = READINGS[name]
    scenes = [
        load_scene(f"{SCENES}/{scene}.yaml") for scene in ("ramp40_k210", "stroke_10", "step_sub")
    ]
    read = [reading.of(scene, k > 0) for k, scene in enumerate(scenes)]
    same = [
        now.varied({"accuracy": was.accuracy}) == was for now, was in zip(read, scenes, strict=True)
    ]
    wanted = [not reading.everywhere, False, False]
    if name in (CONTROL, *READ_ONLY):
        wanted = [True, True, True]
    elif reading.deeper:
        wanted = [False, False, False]
    elif name in ("depth kept", "no friction"):
        wanted = [True, False, True]
    assert same == wanted
    press, slide = read[1].motion[:2]
    assert press.force == pytest.approx(reading.share * scenes[1].motion[0].force)
    assert slide.keep == reading.keeps


def reading(**verdicts):
    rows = [(k, 2.0, verdict) for k, verdict in verdicts.items()]
    return pd.DataFrame(rows, columns=["id", "simulated", "verdict"])


def published(**verdicts):
    return reading(**verdicts).assign(figure="5-12", quantity="", condition="", simulated=1.0)


HOLDS, FAILS = "trend_holds", "trend_fails"


@pytest.mark.parametrize(
    "name, verdicts, explained, counts",
    [
        # TR28 holds without the reading already, TR30 fails with it as well
        (
            "no friction",
            {
                "TR28": (FAILS, HOLDS, HOLDS),
                "TR29": (FAILS, FAILS, HOLDS),
                "TR30": (FAILS, FAILS, FAILS),
                "TR37": (HOLDS, HOLDS, FAILS),
            },
            {"TR28": False, "TR29": True, "TR30": False},
            [1, 1],
        ),
        # a reading explains nothing by what it was given
        (
            "smaller radius",
            {"T323": ("outside", "outside", "inside"), "T101": ("outside", "outside", "inside")},
            {"T323": False, "T101": True},
            [1, 0],
        ),
        # another energy is held against the published runs, not against those at draft accuracy
        (
            "energy: network",
            {"TR74": (FAILS, HOLDS, HOLDS, FAILS), "TR82": (FAILS, FAILS, HOLDS, HOLDS)},
            {"TR74": True, "TR82": False},
            [1, 0],
        ),
    ],
)
def test_explained_is_what_holds_with_a_reading_and_not_without(name, verdicts, explained, counts):
    """Verdicts: of the published table, of the control, of the reading, of the published runs."""
    columns = [
        dict(zip(verdicts, column, strict=True)) for column in zip(*verdicts.values(), strict=True)
    ]
    comparison = published(**columns[0])
    names = (CONTROL, name, PUBLISHED)
    found = {name: reading(**column) for name, column in zip(names, columns[1:], strict=False)}
    table = explanations(comparison, found, REFERENCE).set_index("id")
    assert dict(table["explained_by"] == name) == explained
    rows = turned(comparison, found, REFERENCE)
    assert rows[["reading", "makes_hold", "makes_fail"]].to_numpy().tolist() == [[name, *counts]]


def test_summary_counts_what_is_right_and_what_is_explained():
    found = {CONTROL: reading(TR29=FAILS), "no friction": reading(TR29=HOLDS)}
    table = explanations(published(TR29=FAILS, TR37=HOLDS), found, REFERENCE)
    assert "trends: 1 of 2 right, 1 more explained by a run" in table.attrs["summary"]

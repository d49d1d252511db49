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
REFERENCE = "config/reference/thesis_numbers.csv"


@pytest.mark.parametrize("name", READINGS)
def test_a_reading_changes_what_it_says(name):
    """The control nothing but the accuracy, a reading of the wavy surface no press, the others what
    they name, everywhere.
    """
    reading = READINGS[name]
    press, stroke, steps = (
        load_scene(f"config/scenes/{scene}.yaml")
        for scene in ("ramp40_k210", "stroke_10", "step_sub")
    )
    read = [reading.of(press, False), reading.of(stroke, True), reading.of(steps, True)]
    same = [
        now.varied({"accuracy": was.accuracy}) == was
        for now, was in zip(read, (press, stroke, steps), strict=True)
    ]
    wanted = {
        CONTROL: [True, True, True],
        "depth kept": [True, False, True],
        "no friction": [True, False, True],
    }
    wanted |= {name: [True, True, True] for name in READ_ONLY}
    wanted |= {name: [False, False, False] for name in READINGS if READINGS[name].deeper}
    about_strokes = [True, False, False]
    assert same == wanted.get(name, about_strokes if not reading.everywhere else [False] * 3)
    assert read[1].motion[0].force == pytest.approx(reading.share * stroke.motion[0].force)
    assert read[1].motion[1].keep == reading.keeps


def published(**verdicts):
    columns = ["id", "figure", "quantity", "condition", "simulated", "verdict"]
    rows = [(k, "5-12", k, "", 1.0, verdict) for k, verdict in verdicts.items()]
    return pd.DataFrame(rows, columns=columns)


def reading(**verdicts):
    rows = [(k, 2.0, verdict) for k, verdict in verdicts.items()]
    return pd.DataFrame(rows, columns=["id", "simulated", "verdict"])


HOLDS, FAILS = "trend_holds", "trend_fails"


@pytest.mark.parametrize(
    "comparison, found, explained, counts",
    [
        # TR28 holds without the reading already, TR30 fails with it as well
        (
            {"TR28": FAILS, "TR29": FAILS, "TR30": FAILS, "TR37": HOLDS},
            {
                CONTROL: {"TR28": HOLDS, "TR29": FAILS, "TR30": FAILS, "TR37": HOLDS},
                "no friction": {"TR28": HOLDS, "TR29": HOLDS, "TR30": FAILS, "TR37": FAILS},
            },
            {"TR28": "", "TR29": "no friction", "TR30": ""},
            ["no friction", 1, 1],
        ),
        # a reading explains nothing by what it was given
        (
            {"T323": "outside", "T108": "outside"},
            {
                CONTROL: {"T323": "outside", "T108": "outside"},
                "smaller radius": {"T323": "inside", "T108": "inside"},
            },
            {"T323": "", "T108": "smaller radius"},
            ["smaller radius", 1, 0],
        ),
        # another energy is held against the published runs, not against those at draft accuracy
        (
            {"TR74": FAILS, "TR82": FAILS},
            {
                CONTROL: {"TR74": HOLDS, "TR82": FAILS},
                PUBLISHED: {"TR74": FAILS, "TR82": HOLDS},
                "energy: network": {"TR74": HOLDS, "TR82": HOLDS},
            },
            {"TR74": "energy: network", "TR82": ""},
            ["energy: network", 1, 0],
        ),
    ],
)
def test_explained_is_what_holds_with_a_reading_and_not_without(
    comparison, found, explained, counts
):
    found = {name: reading(**verdicts) for name, verdicts in found.items()}
    table = explanations(published(**comparison), found, REFERENCE)
    assert dict(table.set_index("id")["explained_by"]) == explained
    rows = turned(published(**comparison), found, REFERENCE)
    assert rows[["reading", "makes_hold", "makes_fail"]].to_numpy().tolist() == [counts]


def test_summary_counts_what_is_right_and_what_is_explained():
    found = {CONTROL: reading(TR29=FAILS), "no friction": reading(TR29=HOLDS)}
    table = explanations(published(TR29=FAILS, TR37=HOLDS), found, REFERENCE)
    assert "trends: 1 of 2 right, 1 more explained by a run" in table.attrs["summary"]

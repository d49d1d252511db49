"""Verdicts: of two possible readings the harder, of a figure one; and which rows were fitted."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import synthetic
from cysyk1999.claims.comparison import thesis_comparison
from cysyk1999.claims.rows import judged
from cysyk1999.claims.said import figure_verdicts, said
from cysyk1999.claims.trends import everywhere, ordered
from cysyk1999.claims.verdicts import hardest
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.reference_data import EVIDENCE, read_reference

pytestmark = pytest.mark.unit
REFERENCE = Path(__file__).parents[1] / "config/reference/thesis_numbers.csv"
NOTHING = Instead(*[Measures.of({})] * 4)


@pytest.fixture(scope="module")
def reference():
    return read_reference(REFERENCE)


# --- two readings ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "values, other, verdict, which",
    [
        ([1400], 2000, "plausible", 0),
        ([1700], 2000, "outside", 0),  # within the longer axis alone
        ([1700], np.nan, "outside", 0),
        ([1400], 1300, "outside", 0),  # within the first reading alone
        ([1400, 1700], np.nan, "outside", 1),  # one of two scenes that may be meant
        ([900, 1400], np.nan, "outside", 0),
        ([1200, 1400], 2000, "plausible", 0),
        ([1400, np.nan], np.nan, "not_comparable", 1),
    ],
)
def test_of_two_readings_the_harder_is_judged(values, other, verdict, which):
    entry = {"form": "axis", "low": 0, "high": 1500, "or_high": other, "tick": 1000}
    assert hardest(values, [0.0] * len(values), entry)[:2] == (which, verdict)


def test_an_axis_that_another_trace_shares_bounds_from_above_only():
    entry = {"form": "axis", "low": 0, "high": 100, "tick": 0}
    found = [hardest([value], [0.0], entry)[1] for value in (20, 99, 110)]
    assert found == ["plausible", "plausible", "outside"]


@pytest.mark.parametrize("of, verdict", [("each of a b", "outside"), ("mean of a b", "inside")])
def test_scenes_that_may_be_meant_are_judged_one_by_one(of, verdict):
    """Their mean meets the number that neither has."""
    m = Measures(lambda quantity, scene: {"end": {"a": 2.0, "b": 4.0}[scene]})
    entry = {"measure": "width", "at": "end", "of": of, "units": "mm", "role": "result"}
    entry |= {"form": "value", "low": 3.0, "high": np.nan, "or_high": np.nan, "tolerance": 0.1}
    number, value, _, found, _ = judged(pd.Series(entry, name="T1"), m, NOTHING)
    assert found == verdict and value == number(m)


# --- fitted and held out --------------------------------------------------------------------------


def test_a_row_is_fitted_where_the_evidence_names_it(tmp_path):
    rows = pd.read_csv(REFERENCE, dtype=str).set_index("id").loc[["T101", "T106", "TR11"]]
    rows.to_csv(tmp_path / "numbers.csv")
    for named, fitted in (
        (None, []),
        (["T106", ""], ["T106"]),
        (["T999 T101", "T106 TR11"], ["T101", "T106"]),  # TR11 holds by construction
    ):
        if named is not None:
            pd.DataFrame({"thesis_ids": named}).to_csv(tmp_path / EVIDENCE, index=False)
        score = read_reference(tmp_path / "numbers.csv")["score"]
        assert list(score.index[score == "fitted"]) == fitted and score["TR11"] == "none"


# --- cases ----------------------------------------------------------------------------------------


def test_a_trend_says_of_which_cases_it_holds():
    found = {"flat": True, "79": False, "105": True}
    assert everywhere(found).parted == "holds for flat, 105; fails for 79"
    many = {str(k): k == 3 for k in range(6)}
    assert everywhere(many).parted == "holds for 3; fails for the other 5"
    most = {k: not v for k, v in many.items()}
    assert everywhere(most).parted == "holds for the other 5; fails for 3"
    for alike in (True, False):
        assert everywhere(dict.fromkeys("ab", alike)).parted == ""
    steps = ordered({"a": 1, "b": 3, "c": 2}, "")
    assert (steps.holds, steps.shown) == (False, 2)
    assert steps.parted == "holds for a to b; fails for b to c"


# --- figures --------------------------------------------------------------------------------------


def verdict(*rows):
    """The verdict on a figure of rows: quantity, condition, form, role, score, reason, verdict,
    note.
    """
    keys = ["quantity", "condition", "form", "role", "score", "reason", "verdict", "note"]
    table = pd.DataFrame(rows, columns=keys).assign(id=list("abcdef"[: len(rows)]), figure="4-1")
    return figure_verdicts(table, table.set_index("id").assign(same_as="")).get("4-1")


HIGH = ["highest pressure", "K = 79 1/m", "axis", "result", "", "", "plausible", ""]
LOW = ["highest pressure", "flat plate; x", "axis", "result", "fitted", "", "outside", "5% above"]
GROWS = ["it grows", "", "trend", "trend", "", "", "trend_holds", ""]
BUILT = ["it is even", "", "trend", "trend", "none", "by_construction", "trend_holds", ""]
PARTLY = "8 of 9; holds for a; fails for b, c"


def test_a_figure_has_the_verdict_of_all_that_is_said_of_it():
    assert verdict(HIGH, GROWS).verdict == "holds"
    assert verdict(LOW).verdict == "fails" and verdict(HIGH, LOW).verdict == "partly"
    assert verdict(GROWS, [*GROWS[:6], "trend_fails", ""]).verdict == "partly"
    assert verdict([*HIGH[:6], "not_comparable", ""]) is None


def test_what_holds_by_construction_or_chose_a_parameter_does_not_speak():
    assert verdict(BUILT).verdict == "not judged" and verdict(BUILT).judged == 0
    assert verdict(BUILT, LOW) == verdict(LOW)
    chosen = [*HIGH[:3], "calibrated", *HIGH[4:]]
    assert verdict(chosen) is None and verdict(chosen, LOW).verdict == "fails"
    other = [*BUILT[:5], "definition", *BUILT[6:]]
    assert verdict(other) is None


def test_the_parts_are_named():
    found = verdict(HIGH, LOW, [*GROWS[:6], "trend_fails", PARTLY])
    assert found.holds == ("axis of highest pressure: 79",)
    assert found.fails == (
        "axis of highest pressure: flat plate",
        "it grows (holds for a; fails for b, c)",
    )
    assert found.texts[0] == (
        "Thesis: holds here in part, 1 of 3. Fails: axis of highest pressure: flat plate; it grows "
        "(holds for a; fails for b, c). Holds: axis of highest pressure: 79. The pad was fitted to "
        "1 of them."
    )
    assert found.texts[-2:] == (
        "Thesis: holds here in part, 1 of 3. Fails: axis of highest pressure: flat plate; it "
        "grows.",
        "Thesis: holds here in part, 1 of 3.",
    )
    assert verdict(LOW).texts[0] == (
        "Thesis: fails here: axis of highest pressure (5% above). The pad was fitted to it."
    )


def test_every_picture_is_judged_by_all_that_the_comparison_knows_of_it(reference):
    """From its own scenes, and those it names besides."""
    histories = synthetic.histories()
    meshes = synthetic.meshes(histories)
    whole = figure_verdicts(
        thesis_comparison(Measures.of(histories, meshes), NOTHING, REFERENCE), reference
    )
    assert len(whole) > 50
    for number, spec in FIGURES.items():
        few = (
            {name: each[name] for name in spec.judged_by if name in each}
            for each in (histories, meshes)
        )
        assert said(number, Measures.of(*few), NOTHING, reference) == whole.get(number), number

"""The list of the thesis's figures: complete, with something in place of what cannot be drawn, and
as committed.
"""

from pathlib import Path

import pandas as pd
import pytest

from cysyk1999.claims.said import figure_verdicts
from cysyk1999.figures.axes import STATEMENT, statement_row
from cysyk1999.figures.catalogue import read_catalogue, readme
from cysyk1999.figures.registry import FIGURES
from cysyk1999.reference_data import ReferenceDataError, read_reference

pytestmark = pytest.mark.unit
ROOT = Path(__file__).parents[1]
LIST = ROOT / "config/reference/figures.csv"
MADE = {number: spec.title for number, spec in FIGURES.items()}
COUNTS = {2: 4, 3: 11, 4: 29, 5: 29}
"""Figures of the thesis, by chapter."""
TABLE = pd.read_csv(ROOT / "figures/tables/thesis_comparison.csv")
JUDGED = figure_verdicts(TABLE, read_reference(LIST.with_name("thesis_numbers.csv")))


@pytest.fixture(scope="module")
def catalogue():
    return read_catalogue(LIST)


def test_every_figure_of_the_thesis_is_listed_in_order(catalogue):
    assert catalogue["number"].tolist() == [
        f"{c}-{k}" for c, count in COUNTS.items() for k in range(1, count + 1)
    ]


def test_every_figure_drawn_is_one_of_the_thesiss_and_listed_once_in_order():
    order = [tuple(map(int, number.split("-"))) for number in MADE]
    assert order == sorted(set(order)) and set(MADE) <= set(read_catalogue(LIST)["number"])


def test_committed_list_is_what_the_workflow_writes(catalogue):
    committed = (ROOT / "figures/README.md").read_text(encoding="utf-8")
    assert committed == readme(catalogue, MADE, JUDGED), (
        "run `snakemake catalogue` and commit figures/README.md"
    )


def test_every_figure_is_in_one_list(catalogue):
    text = readme(catalogue, MADE, JUDGED)
    drawn, rest = text.split("## Not drawn, and")
    for number in catalogue["number"]:
        assert (f"| [{number}](thesis/fig_{number}.png) |" in drawn) == (number in MADE)
        assert (f"| {number} |" in rest) == (number not in MADE)


def test_a_figure_taken_out_is_named_as_missing(catalogue):
    assert "## Not drawn yet" in readme(
        catalogue, {n: title for n, title in MADE.items() if n != "5-12"}, JUDGED
    )
    without = readme(catalogue, {n: title for n, title in MADE.items() if n != "5-1"}, JUDGED)
    assert (
        "| 5-1 | impulses of ten strokes and their histogram | recording |\n"
        in without.split("## Not drawn yet")[1]
    )


def test_every_picture_says_the_verdict_that_the_list_does():
    """As committed: the row that a picture is drawn from, and its line of the list."""
    text = (ROOT / "figures/README.md").read_text(encoding="utf-8")
    lines, other = text.splitlines(), []
    for number in MADE:
        source = pd.read_csv(ROOT / f"figures/thesis/fig_{number}.csv")["source"].astype(str)
        rows = source[source.str.startswith(STATEMENT)].tolist()
        (line,) = (line for line in lines if f"(thesis/fig_{number}.png)" in line)
        if said := JUDGED.get(number):
            right = rows == [statement_row(said.verdict, *said.texts)["source"]]
            right &= f"[{said.verdict}](" in line and said.texts[0] in line
        else:
            right = not rows and "Thesis:" not in line
        other += [] if right else [number]
    assert not other, "make figures anew"


@pytest.mark.parametrize(
    "line, message",
    [
        ("5-1,recording,impulses,", "figure 5-1 is a recording and nothing stands in for it"),
        ("5-1,painting,impulses,x", "column kind"),
        ("5-1,simulation,,", "column thesis_shows"),
        ("5-1,simulation,a,\n5-1,simulation,a,", "figure 5-1 is given twice"),
    ],
)
def test_a_wrong_list_is_refused(tmp_path, line, message):
    path = tmp_path / "figures.csv"
    path.write_text("number,kind,thesis_shows,stand_in\n" + line + "\n")
    with pytest.raises((ValueError, ReferenceDataError), match=message):
        read_catalogue(path)

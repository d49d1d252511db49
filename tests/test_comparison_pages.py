"""The comparison with the thesis as it is read: every row once, in five columns, and as
committed.
"""

import re
from pathlib import Path

import pandas as pd
import pytest

from cysyk1999.claims.pages import CHAPTERS, chapter_of, pages
from cysyk1999.reference_data import read_reference

pytestmark = pytest.mark.unit
ROOT = Path(__file__).parents[1]
PUBLISHED = ROOT / "figures/tables/thesis_comparison.csv"


@pytest.fixture(scope="module")
def reference():
    return read_reference(ROOT / "config/reference/thesis_numbers.csv")


@pytest.fixture(scope="module")
def made(reference):
    return pages(PUBLISHED, reference)


def test_every_row_stands_once_in_five_columns_on_the_page_of_its_chapter(made):
    table = pd.read_csv(PUBLISHED)
    for chapter in CHAPTERS:
        rows = [
            line for line in made[chapter].splitlines() if re.match(r"\| (?!quantity|---)", line)
        ]
        assert all(line.count("|") == 6 for line in rows)
        ids = [re.search(r"\((\w+)\) \|", line)[1] for line in rows]
        assert sorted(ids) == sorted(table["id"][table["figure"].map(chapter_of) == chapter])


def test_committed_pages_are_those_of_the_committed_table(made):
    for chapter, text in made.items():
        name = f"thesis_comparison_chapter{chapter}.md" if chapter else "thesis_comparison.md"
        assert (PUBLISHED.with_name(name)).read_text(encoding="utf-8") == text, (
            f"make {name} anew: snakemake tables"
        )


@pytest.mark.parametrize(
    "figure, chapter",
    [("3-1", "3"), ("sec 4.2", "4"), ("Eq 3-1", "3"), ("5-27", "5"), ("chapter 6", "5")],
)
def test_chapters(figure, chapter):
    assert chapter_of(figure) == chapter


@pytest.mark.parametrize(
    "changes, cells",
    [
        (
            {},
            "| axis 0 to 40,000 Pa | 39,580 Pa (± mesh 700, steps 80) | plausible | fills 99% of "
            "the axis |",
        ),
        (
            {"mesh_error": 1.0, "time_step_error": None},
            "| axis 0 to 40,000 Pa | 39,580 Pa | plausible | fills 99% of the axis |",
        ),
        (
            {"verdict": "outside", "thesis_kind": "garbled"},
            "| axis 0 to 40,000 Pa? | 39,580 Pa (± mesh 700, steps 80) | **outside** |",
        ),
        (
            {"verdict": "not_comparable", "simulated": None},
            "| axis 0 to 40,000 Pa |  | not comparable |",
        ),
        (
            {"thesis_low": None, "units": "1"},
            "| axis 40,000 | 39,580 (± mesh 700, steps 80) | plausible |",
        ),
    ],
)
def test_a_row_says_what_the_thesis_has_what_is_here_and_why(changes, cells, reference, tmp_path):
    row = {
        "id": "T133",
        "figure": "4-11",
        "quantity": "highest pressure",
        "condition": "K = 1260 1/m",
        "role": "result",
        "thesis_low": 0.0,
        "thesis_high": 40000.0,
        "thesis_kind": "axis_range",
        "simulated": 39580.0,
        "mesh_error": 700.0,
        "time_step_error": 80.0,
        "sampling_error": 0.0,
        "units": "Pa",
        "verdict": "plausible",
        "note": "fills 99% of the axis",
    }
    pd.DataFrame([row | changes]).to_csv(tmp_path / "one.csv", index=False)
    page = pages(tmp_path / "one.csv", reference)["4"]
    assert f"| 4-11: highest pressure, K = 1260 1/m (T133) {cells}" in page

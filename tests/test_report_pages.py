"""Pages of the report: they hold their pictures and tables in themselves, and say what the thesis
says.
"""

import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from cysyk1999.publishing.html import of_markdown, page
from cysyk1999.publishing.html import report_pages as run

pytestmark = pytest.mark.unit
FIGURES = Path(__file__).parents[1] / "figures"


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    shown = [
        "thesis/fig_4-11.png",
        "studies/animation_stroke_10.gif",
        "tables/peers.csv",
        "tables/thesis_comparison.csv",
        "studies/explorer.html",
    ]
    job = SimpleNamespace(
        shown=[FIGURES / path for path in shown[:2]],
        published=[str(FIGURES / path) for path in shown[2:]],
        judged=[FIGURES / "tables/thesis_comparison_chapter4.md"],
        titles=["4-11: Profiles <of> pressure", "A stroke", "Peers", "The thesis", "The explorer"],
        pages=[str(folder / f"{k}.html") for k in range(5)],
    )
    run(job)
    return [Path(path).read_text(encoding="utf-8") for path in job.pages]


def test_a_figure_is_shown_with_what_the_thesis_says_of_it(pages):
    assert "<h1>4-11: Profiles &lt;of&gt; pressure</h1>" in pages[0]
    assert 'src="data:image/png;base64,' in pages[0] and "fig_4-11.csv" in pages[0]
    cells = re.findall(r"<td>(4-[\d]+): ", pages[0])
    assert len(cells) > 5 and set(cells) == {"4-11"}


def test_a_moving_picture_moves_and_a_table_is_shown(pages):
    assert 'src="data:image/gif;base64,' in pages[1] and "<td>" not in pages[1]
    assert "felupe" in pages[2].lower() and "<img" not in pages[2]


def test_the_comparison_is_shown_with_all_its_chapters_and_links_that_lead_nowhere_are_words(pages):
    assert pages[3].count("<h2>Results</h2>") == 3 and "<a " not in pages[3]
    assert pages[3].count("<tr>") > 300


def test_a_page_is_shown_as_it_is(pages):
    assert pages[4] == (FIGURES / "studies/explorer.html").read_text(encoding="utf-8")


def test_all_of_them_can_be_cited(pages):
    assert all("CITATION.cff" in text and "Cysyk" in text for text in pages[:4])


def test_wide_tables_scroll_by_themselves():
    assert of_markdown("| a |\n|---|\n| 1 |").startswith('<div class="table"><table>')
    assert page("t", "", "<p>x</p>").count("<p>") == 1

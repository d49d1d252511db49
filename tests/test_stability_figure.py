"""Heat map and table of the study of stability, from made-up measures."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import same_color

from cysyk1999.publishing.style import PAGE_WIDTH, TALLEST
from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.stability.cases import METHODS
from cysyk1999.studies.stability.picture import assemble, heat_map, long, table, tally

pytestmark = pytest.mark.unit


def rows(method, depth, **changed):
    row = {
        "number": 1,
        "case": "a",
        "group": "g",
        "method": method,
        "hard": "it is",
        "stable": "as all",
        "outcome": "stable",
        "completed": 1.0,
        "message": "",
        "saved": "",
        "cuts": 0.0,
        "factorisations": 2.0,
        "energy": 0.003,
        "complementarity": 1e-9,
        "det_f": 0.5,
        "checkerboard": 0.02,
        "halving": 0.01,
        "limit cuts": 0,
        "limit factorisations": 4,
        "limit energy": 0.03,
        "limit complementarity": 1e-3,
        "limit det_f": 0.1,
        "limit checkerboard": np.inf,
        "limit halving": 0.05,
        "depth_mm": depth,
        "force_N_per_m": 19.6,
    }
    other = {
        "number": 2,
        "case": "b",
        "completed": 0.0,
        "outcome": "fails cleanly",
        "message": "why",
        "depth_mm": np.nan,
        "saved": "3 steps",
    }
    return pd.DataFrame([row | changed, row | other])


@pytest.fixture
def frame():
    depths = {"default": 1.0, "full Q1": 0.5, "plain P2": 1.01}
    others = [rows(method, depth) for method, depth in depths.items()]
    return assemble([*others, rows("plain Newton", 1.0, cuts=3.0)])


def test_shares_of_the_limits(frame):
    share = long(frame).set_index(["case", "method", "measure"])["share"].sort_index()
    assert share["b", "default", "completed"] == np.inf and share["a", "plain Newton", "cuts"] > 1
    expected = {
        "completed": 0,
        "cuts": 0,
        "energy": 0.1,
        "det_f": 0.2,
        "checkerboard": np.nan,
        "off": np.nan,
    }
    assert share["a", "default"][list(expected)].to_dict() == pytest.approx(expected, nan_ok=True)
    off = [share["a", method, "off"] for method in ("full Q1", "plain P2")]
    assert off == pytest.approx([10, 0.2])


def test_parts_made_side_by_side_are_put_in_order(frame):
    parts = [rows(method, 1.0).iloc[[k]] for method in METHODS for k in (1, 0)]
    assert list(assemble(parts)["number"]) == [1] * 4 + [2] * 4


def test_table_tells_how_each_method_ended(frame):
    first, second = table(frame).to_dict("records")
    assert first["full Q1"].startswith("wrong: off by 50%") and first["plain P2"] == "stable"
    assert second["said"] == "why" and second["last state saved"] == "3 steps"


def test_runs_are_counted_by_how_they_ended(frame):
    """Where the default method has no answer to be off from, none is wrong; a silent failure would
    be counted.
    """
    frames = {method: part for method, part in long(frame).groupby("method")}
    assert tally(frames["default"]) == ["1 stable", "1 stopped and said why", "none silent"]
    assert tally(frames["full Q1"]) == ["1 wrong", "1 stopped and said why"]
    default = frame[frame["method"] == "default"].replace({"outcome": {"stable": "unsound"}})
    assert tally(long(default)) == ["1 outside limits", "1 stopped and said why"]


def test_table_in_markdown_has_five_columns_to_read(frame, tmp_path):
    of_b = (frame["method"] == "default") & (frame["case"] == "b")
    frame.loc[of_b, "relaxed"] = "load: 0.5 of it"
    publish_table(table(frame), tmp_path / "t.csv")
    head, _, first, second = (tmp_path / "t.md").read_text().splitlines()
    assert head == "| no. | case | what makes it hard | how it ended | nearest to its limit |"
    assert first == "| 1 | a | it is | stable | factors a step: 50% |"
    assert "fails cleanly: why; stable with load: 0.5 of it" in second
    assert len(pd.read_csv(tmp_path / "t.csv").columns) > 20


def test_picture_has_a_panel_a_method_and_marks_what_did_not_complete(frame):
    fig = heat_map(long(frame))
    first = [[label.get_text() for label in ax.get_yticklabels()][:1] for ax in fig.axes]
    assert first.count(["completed"]) == len(METHODS)
    panel = fig.axes[first.index(["completed"])]
    black = [patch for patch in panel.patches if same_color(patch.get_facecolor(), "black")]
    assert [patch.get_x() for patch in black] == [0.5]
    said = ["this package", "1 stable, 1 stopped and said why, none silent", "g"]
    assert [text.get_text() for text in panel.texts] == said
    assert fig.get_size_inches() == pytest.approx([PAGE_WIDTH, TALLEST])


def test_a_group_and_a_case_have_a_place_of_their_own_among_two_hundred():
    """Names of groups do not run into each other, and a case is wide enough to be seen: half a
    millimetre.
    """
    one = pd.concat([rows(method, 1.0)[:1] for method in METHODS])
    many = [one.assign(number=k, case=f"{k}: x", group=f"group {k // 13}") for k in range(1, 209)]
    ax = heat_map(long(assemble(many))).axes[0]
    names = [text for text in ax.texts if text.get_text().startswith("group")]
    wide = ax.get_position().width * PAGE_WIDTH * 25.4 / 208  # mm of a case
    apart = np.diff([text.xy[0] for text in names]) * wide
    assert len(names) == 17 and apart[1:-1].min() > 3 and wide > 0.5

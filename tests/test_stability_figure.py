"""Heat map and table of the study of stability, from made-up measures."""

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import same_color
from matplotlib.text import Text

from cysyk1999.publishing.style import PAGE_WIDTH, TALLEST
from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.stability.cases import METHODS, Limits
from cysyk1999.studies.stability.picture import assemble, heat_map, long, table, tally

pytestmark = pytest.mark.unit


MEASURED = {
    "cuts": 0.0,
    "factorisations": 2.0,
    "energy": 0.003,
    "complementarity": 1e-9,
    "det_f": 0.5,
    "checkerboard": 0.02,
    "halving": 0.01,
}
LIMITS = vars(Limits(checkerboard=np.inf))
SAID = ["number", "case", "outcome", "completed", "message", "saved"]


def rows(method, depth, **changed):
    """Case a, which ends as it should, and case b, which does not."""
    row = MEASURED | {f"limit {name}": LIMITS[name] for name in MEASURED}
    row |= {"group": "g", "method": method, "hard": "it is", "stable": "as all"}
    row |= {"depth_mm": depth, "force_N_per_m": 19.6} | changed
    row |= dict(zip(SAID, (1, "a", "stable", 1.0, "", ""), strict=True))
    other = dict(zip(SAID, (2, "b", "fails cleanly", 0.0, "why", "3 steps"), strict=True))
    return pd.DataFrame([row, row | other | {"depth_mm": np.nan}])


@pytest.fixture
def frame():
    return assemble(
        [
            rows("default", 1.0),
            rows("full Q1", 0.5),
            rows("plain P2", 1.01),
            rows("plain Newton", 1.0, cuts=3.0),
        ]
    )


def test_shares_of_the_limits(frame):
    share = long(frame).set_index(["case", "method", "measure"])["share"].sort_index()
    assert share["a", "default", "energy"] == pytest.approx(0.1)
    assert share["a", "default", "det_f"] == pytest.approx(0.2)
    assert share["a", "default", "completed"] == 0 and share["b", "default", "completed"] == np.inf
    assert share["a", "default", "cuts"] == 0 and share["a", "plain Newton", "cuts"] > 1
    assert share["a", "default"][["checkerboard", "off"]].isna().all()
    assert share["a", "full Q1", "off"] == pytest.approx(10)
    assert share["a", "plain P2", "off"] == pytest.approx(0.2)


def test_parts_made_side_by_side_are_put_in_order(frame):
    parts = [rows(method, 1.0).iloc[[k]] for method in METHODS for k in (1, 0)]
    assert list(assemble(parts)["number"]) == [1] * 4 + [2] * 4


def test_table_tells_how_each_method_ended(frame):
    out = table(frame).set_index("case")
    assert out.loc["a", "full Q1"].startswith("wrong: off by 50%")
    assert out.loc["a", "plain P2"] == "stable"
    assert out.loc["b", "said"] == "why" and out.loc["b", "last state saved"] == "3 steps"


def test_runs_are_counted_by_how_they_ended(frame):
    """Where the default method has no answer to be off from, none is wrong; a silent failure would
    be counted.
    """
    frames = {method: part for method, part in long(frame).groupby("method")}
    assert tally(frames["default"]) == ["1 stable", "1 stopped and said why", "none silent"]
    assert tally(frames["full Q1"]) == ["1 wrong", "1 stopped and said why"]
    frame.loc[(frame["method"] == "default") & (frame["case"] == "a"), "outcome"] = "unsound"
    told = tally(long(frame[frame["method"] == "default"]))
    assert told == ["1 outside limits", "1 stopped and said why"]


def test_table_in_markdown_has_five_columns_to_read(frame, tmp_path):
    failed = (frame["method"] == "default") & (frame["case"] == "b")
    frame.loc[failed, ["ended", "healed"]] = ["healed", "relaxed steps: half as long"]
    publish_table(table(frame), tmp_path / "t.csv")
    head, _, first, second = (tmp_path / "t.md").read_text().splitlines()
    assert head == "| no. | case | what makes it hard | how it ended | nearest to its limit |"
    assert first == "| 1 | a | it is | stable | factors a step: 20% |"
    assert "fails cleanly: why; healed: relaxed steps: half as long" in second
    assert len(pd.read_csv(tmp_path / "t.csv").columns) > 20


def test_picture_has_a_panel_a_method_and_marks_what_did_not_complete(frame):
    fig = heat_map(long(frame))
    panels = [ax for ax in fig.axes if "completed" in map(Text.get_text, ax.get_yticklabels())]
    assert len(panels) == len(METHODS)
    black = [p for p in panels[0].patches if same_color(p.get_facecolor(), "black")]
    assert [p.get_x() for p in black] == [0.5]
    tallied = "1 stable, 1 stopped and said why, none silent"
    assert [text.get_text() for text in panels[0].texts] == ["this package", tallied, "g"]
    assert fig.get_size_inches() == pytest.approx((PAGE_WIDTH, TALLEST))


def test_a_group_and_a_case_have_a_place_of_their_own_among_two_hundred():
    """Names of groups do not run into each other, and a case is wide enough to be seen: half a
    millimetre.
    """
    frames = [rows(method, 1.0).iloc[[0]] for method in METHODS]
    many = [
        f.assign(number=k, case=f"{k}: x", group=f"group {k // 13}")
        for f in frames
        for k in range(1, 209)
    ]
    fig = heat_map(long(assemble(many)))
    names = [text for text in fig.axes[0].texts if text.get_text().startswith("group")]
    of_a_case = fig.axes[0].get_position().width * PAGE_WIDTH * 25.4 / 208
    apart = np.diff([text.xy[0] for text in names]) * of_a_case
    assert len(names) == 17 and apart[1:-1].min() > 3 and of_a_case > 0.5

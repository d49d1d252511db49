"""Reference data: what is committed, and one line for each way in which a file can be wrong."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from cysyk1999.reference_data import (
    FORCE_DEPTH,
    ReferenceDataError,
    read_force_depth,
    read_surface_profiles,
)

pytestmark = pytest.mark.unit

REFERENCE = Path(__file__).parents[1] / "config" / "reference"
HEADER = "subject,indenter,depth_mm,speed_mm_per_s,force_N,source,how_obtained"
ROW = "me,flat plate,1.0,0,0.2,my notebook,load cell"


def test_committed_forces_are_four_subjects_under_three_indenters():
    data = read_force_depth(REFERENCE / "force_depth")
    assert list(data.columns) == list(FORCE_DEPTH)
    assert data.groupby("indenter").size().to_dict() == {
        "flat plate": 16,
        "flat probe 6.35 mm": 24,
        "point probe": 24,
    }
    assert set(data["subject"]) == {"1", "2", "3", "4"}
    assert (data["source"].str.contains("Dandekar") & (data["how_obtained"] != "")).all()


@pytest.mark.parametrize(
    "indenter, depth, mean",  # published means over the four subjects
    [
        ("flat plate", 0.5, 0.0372),
        ("flat plate", 2.0, 0.7685),
        ("flat probe 6.35 mm", 2.5, 0.5644),
        ("point probe", 3.0, 0.3362),
    ],
)
def test_committed_forces_have_the_published_means(indenter, depth, mean):
    data = read_force_depth(REFERENCE / "force_depth")
    chosen = data[(data["indenter"] == indenter) & (data["depth_mm"] == depth)]
    assert chosen["force_N"].mean() == pytest.approx(mean, abs=5e-4)


def test_committed_profiles_fall_with_distance_from_the_cylinder():
    data = read_surface_profiles(REFERENCE / "surface_profiles.csv")
    assert data.groupby("diameter_mm")["depth_mm"].nunique().to_dict() == {3.17: 6, 9.52: 6}
    for _, profile in data.groupby(["diameter_mm", "depth_mm"]):
        assert (np.diff(profile.sort_values("lateral_distance_mm")["deflection_mm"]) <= 0).all()
        assert profile["deflection_mm"].max() < profile["depth_mm"].iloc[0]


def test_a_subject_is_added_by_adding_a_file(tmp_path):
    folder = shutil.copytree(REFERENCE / "force_depth", tmp_path / "force_depth")
    (folder / "mine.csv").write_text(f"{HEADER}\n{ROW}\n")
    data = read_force_depth(folder)
    assert len(data) == len(read_force_depth(REFERENCE / "force_depth")) + 1
    assert data.loc[data["subject"] == "me", "force_N"].tolist() == [0.2]


def test_a_subject_of_the_same_name_in_another_file_is_another_subject(tmp_path):
    folder = shutil.copytree(REFERENCE / "force_depth", tmp_path / "force_depth")
    row = "1,flat plate,{},0,0.5,a source,measured"
    for stem, depth in (("anna", 1.0), ("bert", 1.0)):
        (folder / f"{stem}.csv").write_text("\n".join([HEADER, row.format(depth), row.format(2.0)]))
    data = read_force_depth(folder)
    assert set(data["subject"]) == {"1 (anna)", "1 (bert)", "1 (dandekar_2003)", "2", "3", "4"}
    counts = data["subject"].value_counts()
    assert (
        counts["1 (anna)"] == counts["1 (bert)"] == 2 and counts["1 (dandekar_2003)"] == counts["2"]
    )


def test_order_of_columns_and_trailing_lines_do_not_matter(tmp_path):
    path = tmp_path / "data.csv"
    path.write_text(
        "how_obtained,force_N,subject,indenter,depth_mm,speed_mm_per_s,source\nscale,0.2,me,flat "
        "plate,1,0,me\n\n\n"
    )
    assert list(read_force_depth(path).columns) == list(FORCE_DEPTH)


WRONG = {
    "empty file": ("", "holds no rows"),
    "header only": (HEADER, "has no rows"),
    "missing column": (
        f"{HEADER.replace(',force_N', '')}\n{ROW.replace(',0.2', '')}",
        "has no column force_N",
    ),
    "unit in another name": (
        f"{HEADER.replace('force_N', 'force_mN')}\n{ROW}",
        "has no column force_N",
    ),
    "unknown column": (f"{HEADER},hand\n{ROW},left", "column 'hand' is not known"),
    "repeated column": (f"{HEADER},source\n{ROW},again", "has the column 'source' twice"),
    "text for a number": (
        f"{HEADER}\n{ROW.replace('0.2', 'much')}",
        "row 2, column force_N: 'much'; allowed: a number above 0",
    ),
    "unit in a cell": (
        f"{HEADER}\n{ROW.replace('1.0', '1 mm')}",
        "row 2, column depth_mm: '1 mm'; allowed: a number above 0",
    ),
    "negative force": (f"{HEADER}\n{ROW.replace('0.2', '-0.2')}", "column force_N: '-0.2'"),
    "infinite depth": (f"{HEADER}\n{ROW.replace('1.0', 'inf')}", "column depth_mm: 'inf'"),
    "negative speed": (
        f"{HEADER}\n{ROW.replace(',0,', ',-1,')}",
        "speed_mm_per_s: '-1'; allowed: a number from 0",
    ),
    "no number": (f"{HEADER}\n{ROW.replace('0.2', '')}", "column force_N: ''"),
    "unknown indenter": (
        f"{HEADER}\n{ROW.replace('flat plate', 'thumb')}",
        "column indenter: 'thumb'; allowed: flat plate",
    ),
    "no source": (
        f"{HEADER}\n{ROW.replace('my notebook', ' ')}",
        "column source: ''; allowed: text",
    ),
    "long row": (f"{HEADER}\n{ROW},more", "has 8 cells in row 2, 7 in its header"),
    "twice": (
        f"{HEADER}\n{ROW}\n{ROW}",
        "row 3: subject 'me', flat plate, 1 mm, 0 mm/s is in row 2 already",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_refused_in_one_line(tmp_path, name):
    text, message = WRONG[name]
    path = tmp_path / "data.csv"
    path.write_text(text)
    with pytest.raises(ReferenceDataError) as caught:
        read_force_depth(path)
    said = str(caught.value)
    assert str(path) in said and message in said and "allowed" in said and "\n" not in said


def test_files_that_cannot_be_read_are_refused_in_one_line(tmp_path):
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00,a")
    for path, message in (
        (tmp_path / "none.csv", "cannot be read"),
        (tmp_path / "binary.csv", "UTF-16"),
        (tmp_path, "UTF-16"),
    ):
        with pytest.raises(ReferenceDataError, match=message):
            read_force_depth(path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(ReferenceDataError, match="holds no CSV file"):
        read_force_depth(tmp_path / "empty")

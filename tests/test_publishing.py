"""What is published: few digits, curves as fine as paper shows, everything else as it is."""

import numpy as np
import pandas as pd
import pytest

from cysyk1999.publishing.tables import MOST_SAMPLES, publish_table, read_frame, write_frame

pytestmark = pytest.mark.unit


def published(frame, tmp_path):
    publish_table(frame, tmp_path / "t.csv")
    return read_frame(tmp_path / "t.csv")


def curve(name, many):
    x = np.linspace(0.0, 1.0, many)
    return pd.DataFrame({"series": name, "pad": 1.0, "x (mm)": x, "y (Pa)": np.sin(9 * x)})


def test_numbers_have_five_digits_and_errors_three(tmp_path):
    frame = pd.DataFrame({"y (Pa)": [1234.567, 1.234567e-7], "mesh_error (%)": [0.123456, np.nan]})
    published(frame, tmp_path)
    assert (tmp_path / "t.csv").read_text().splitlines()[1:] == ["1234.6,0.123", "1.2346e-07,"]
    write_frame(frame, tmp_path / "result.csv")  # a result keeps its digits
    assert "1234.57,0.123456" in (tmp_path / "result.csv").read_text()


def test_of_a_long_curve_every_nth_sample_and_both_ends_are_left(tmp_path):
    long, short = curve("long", 2 * MOST_SAMPLES + 5), curve("short", MOST_SAMPLES)
    saved = published(pd.concat([long, short]), tmp_path)
    left = saved[saved["series"] == "long"]
    assert MOST_SAMPLES / 2 < len(left) <= MOST_SAMPLES + 1
    assert left["x (mm)"].iloc[[0, -1]].tolist() == [0.0, 1.0]
    steps = left["x (mm)"].diff().iloc[1:-1]
    assert steps.max() == pytest.approx(steps.min(), rel=0.05)
    assert (saved["series"] == "short").sum() == MOST_SAMPLES


def test_what_is_no_curve_keeps_its_rows(tmp_path):
    many = 2 * MOST_SAMPLES
    dots = np.random.default_rng(0).random(many)
    corners = np.repeat(np.arange(many // 4), 4)
    for numbers in ({"x (mm)": dots}, {"element": corners, "x (mm)": dots}):
        frame = pd.DataFrame({"series": "dots", **numbers})
        assert len(published(frame, tmp_path)) == many

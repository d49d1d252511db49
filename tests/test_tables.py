"""Tables as instruments, spreadsheets and numpy write them: each is read right, or refused in one
line that says why.
"""

import io
import itertools
import random

import numpy as np
import pandas as pd
import pytest

from fingerpad import load_scene
from fingerpad.documents import SceneError
from fingerpad.tables import TableError, read_table

pytestmark = pytest.mark.unit

X = np.arange(-6.0, 6.01, 0.5)
Y = np.round(0.1 * X**2, 4)
# a profile in which a decimal comma cannot be a sign between thousands everywhere
POINTS = list(zip(X, Y, strict=True))


def read_profile(folder, content):
    path = folder / "profile.csv"
    path.write_bytes(content)
    return load_scene(
        {
            "stimulus": {"shape": "sampled", "csv": str(path)},
            "motion": [{"press_to_force": "20 gf"}],
        }
    ).stimulus


def written(
    delimiter=",",
    comma=False,
    encoding="utf-8",
    header=("x (mm)", "y (mm)"),
    comment="",
    end="\n",
    before="",
    lateral=None,
    digits=4,
    scale=1.0,
    quoted=False,
    reverse=False,
    trailing="",
):
    """The profile's file in one of many ways."""

    def number(value):
        text = f"{value * scale:.{digits}f}"
        text = text.replace(".", ",") if comma else text
        return f'"{text}"' if quoted else text

    rows = [[number(x), *([] if lateral is None else [lateral]), number(y)] for x, y in POINTS]
    rows = rows[::-1] if reverse else rows
    lines = (
        [before] * bool(before)
        + [comment + delimiter.join(header)]
        + [delimiter.join(row) + trailing for row in rows]
    )
    return (end.join(lines) + end).encode(encoding)


MICRO = ("x (\u00b5m)", "y (\u00b5m)")
READ = {
    "plain": {},
    "semicolons": {"delimiter": ";"},
    "tabs": {"delimiter": "\t"},
    "spaces": {"delimiter": " "},
    "semicolons and decimal commas": {"delimiter": ";", "comma": True},
    "tabs and decimal commas": {"delimiter": "\t", "comma": True},
    "three decimals after a comma": {"delimiter": ";", "comma": True, "digits": 3},
    "quoted decimal commas": {"comma": True, "quoted": True},
    "quoted": {"quoted": True},
    "Windows-1252": {"encoding": "cp1252", "header": MICRO, "scale": 1e3, "digits": 1},
    "UTF-8 micrometres": {"header": MICRO, "scale": 1e3, "digits": 1},
    "byte order mark": {"encoding": "utf-8-sig"},
    "UTF-16": {"encoding": "utf-16"},
    "UTF-16 without a mark": {"encoding": "utf-16-le"},
    "UTF-16, big end first": {"encoding": "utf-16-be"},
    "UTF-16 tabs, as a spreadsheet's Unicode text": {"encoding": "utf-16", "delimiter": "\t"},
    "commented header": {"comment": "# "},
    "commented header, no space": {"comment": "#"},
    "commented header, spaces": {"comment": "# ", "delimiter": " "},
    "commented header, semicolons": {"comment": "# ", "delimiter": ";"},
    "percent sign": {"comment": "% "},
    "comments above": {"before": "# made by a scanner\n# on Monday"},
    "comments above a commented header": {"before": "# made by a scanner", "comment": "# "},
    "an empty line above": {"before": "\n"},
    "line ends of Windows": {"end": "\r\n"},
    "line ends of an old Mac": {"end": "\r"},
    "brackets": {"header": ("x [mm]", "y [mm]")},
    "slash": {"header": ("x / mm", "y / mm")},
    "underscore": {"header": ("x_mm", "y_mm")},
    "capitals": {"header": ("X (mm)", "Y (mm)")},
    "no space": {"header": ("x(mm)", "y(mm)"), "delimiter": " "},
    "heights called z": {"header": ("x (mm)", "z (mm)")},
    "x, y, z": {"header": ("x (mm)", "y (mm)", "z (mm)"), "lateral": "0"},
    "x, y, z elsewhere": {"header": ("x (mm)", "y (mm)", "z (mm)"), "lateral": "12.5"},
    "x, z, y": {"header": ("x (mm)", "z (mm)", "y (mm)"), "lateral": "0"},
    "another column": {"header": ("x (mm)", "quality", "y (mm)"), "lateral": "good"},
    "from right to left": {"reverse": True},
    "comma after each row": {"trailing": ","},
    "sep=": {"before": "sep=;", "delimiter": ";"},
    "metres": {"header": ("x (m)", "y (m)"), "scale": 1e-3, "digits": 7},
    "inches": {"header": ("x (inch)", "y (inch)"), "scale": 1 / 25.4, "digits": 12},
}


@pytest.mark.parametrize("name", READ)
def test_a_profile_is_read_right_however_it_is_written(tmp_path, name):
    ways = READ[name]
    stimulus = read_profile(tmp_path, written(**ways))
    rounding = 0.5 * 10.0 ** -ways.get("digits", 4) / ways.get("scale", 1.0)
    np.testing.assert_allclose(stimulus.x, 1e-3 * X, atol=1e-3 * rounding + 1e-15)
    np.testing.assert_allclose(stimulus.y, 1e-3 * Y, atol=1e-3 * rounding + 1e-15)


@pytest.mark.parametrize(
    "name", ["x, y, z", "x, z, y", "Windows-1252", "semicolons and decimal commas"]
)
def test_what_had_to_be_guessed_is_noted(tmp_path, name):
    assert read_profile(tmp_path, written(**READ[name])).notes
    assert not read_profile(tmp_path, written()).notes


def with_cell(text, row=3, column=1):
    """The plain file with one cell replaced."""
    lines = written().decode().splitlines()
    cells = lines[row - 1].split(",")
    cells[column] = text
    lines[row - 1] = ",".join(cells)
    return "\n".join(lines).encode()


REFUSED = {
    "decimal commas between commas": (written(comma=True), "has 4 cells in row 2, 2 in its header"),
    "commas that may be thousands": (
        b"x (um)\ty (um)\n-6,000\t3,600\n6,000\t3,600\n",
        "may be thousands",
    ),
    "points and commas": (
        written(delimiter=";", comma=True)[:-2] + b"1\n7.5;1,5\n",
        "decimal points, and '",
    ),
    "signs between thousands": (b"x (um);y (um)\n-1.234,5;0\n0;3\n", "between thousands"),
    "apostrophes": (b"x (um),y (um)\n-1'234.5,0\n0,3\n", "between thousands"),
    "an extra cell": (written()[:-1] + b",9\n", "has 3 cells in row 26"),
    "a cell too few": (written()[:-1] + b"\n7\n", "has 1 cells in row 27"),
    "rows parted by something else": (b"x (mm),y (mm)\n0;1\n1;1\n", "has 1 cells in row 2"),
    "no header": (b"0,1\n1,1\n", "has no header"),
    "units in a second row": (b"x,y\nmm,mm\n0,1\n1,1\n", "has no column 'x (mm)', but 'x', 'y'"),
    "columns of other names": (
        b"Distance (mm),Height (um)\n0,1\n1,1\n",
        "has no column 'x (mm)', but 'Distance (mm)'",
    ),
    "a column twice": (b"x (mm),x (mm),y (mm)\n0,0,1\n1,1,1\n", "'x (mm)' twice"),
    "three columns that move": (b"x (mm),y (mm),z (mm)\n0,0,1\n1,1,2\n", "all move"),
    "nan": (with_cell("nan"), "has 'nan' in row 3, column 'y (mm)'"),
    "missing": (with_cell(""), "has '' in row 3"),
    "stars": (with_cell("***"), "has '***' in row 3"),
    "infinite": (with_cell("1e999"), "has '1e999' in row 3"),
    "an underscore": (with_cell("1_0"), "has '1_0' in row 3"),
    "a unit in a cell": (with_cell("1 mm"), "has '1 mm' in row 3"),
    "a spreadsheet": (b"PK\x03\x04" + b"\0" * 100, "is a spreadsheet"),
    "an old spreadsheet": (b"\xd0\xcf\x11\xe0" + b"\0" * 100, "is a spreadsheet"),
    "no text": (
        b"x (mm),y (mm)\n" + bytes([0x81, 0x8D]) + b",1\n",
        "is not UTF-8 (byte 0x81 in row 2)",
    ),
    "bytes of zero": (b"x (mm),y (mm)\n0\0,1\n", "is binary"),
    "nothing": (b"", "holds no rows"),
    "a header alone": (b"x (mm),y (mm)\n", "fewer than two points"),
    "another separator": (b"sep=|\nx (mm)|y (mm)\n0|1\n", "parts its columns by '|'"),
    "an unknown unit": (b"x (mn),y (mm)\n0,1\n1,1\n", "unknown unit 'mn'"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_profile_is_refused_in_one_line(tmp_path, name):
    content, words = REFUSED[name]
    with pytest.raises(SceneError) as caught:
        read_profile(tmp_path, content)
    said = str(caught.value)
    for part in (words, "stimulus.csv: ", "profile.csv", "allowed: "):
        assert part in said
    assert "\n" not in said and len(said) < 500


@pytest.mark.parametrize("seed", range(50))
def test_fifty_ways_at_random_are_read_right_or_refused(tmp_path, seed):
    """Whatever combination: the points are right, or one line says why not. Never another
    profile.
    """
    draw = random.Random(seed)
    ways = {
        "delimiter": draw.choice([",", ";", "\t", " "]),
        "comma": draw.random() < 0.4,
        "encoding": draw.choice(["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"]),
        "comment": draw.choice(["", "", "# ", "%"]),
        "end": draw.choice(["\n", "\r\n", "\r"]),
        "before": draw.choice(["", "", "# a line", "\n"]),
        "quoted": draw.random() < 0.2,
        "reverse": draw.random() < 0.2,
        "digits": draw.choice([3, 4, 6]),
        "trailing": draw.choice(["", "", ","]),
    }
    if draw.random() < 0.3:
        ways |= {"lateral": draw.choice(["0", "1.5"]), "header": ("x (mm)", "y (mm)", "z (mm)")}
    try:
        stimulus = read_profile(tmp_path, written(**ways))
    except SceneError as error:
        assert "\n" not in str(error) and "allowed: " in str(error)
        return
    np.testing.assert_allclose(stimulus.x, 1e-3 * X, atol=1e-6)
    np.testing.assert_allclose(stimulus.y, 1e-3 * Y, atol=1e-6)


def test_numpy_and_pandas_files_are_read(tmp_path):
    points, names = np.column_stack([X, Y]), ["x (mm)", "y (mm)"]
    contents = []
    for delimiter, comments in itertools.product([",", ";", "\t", " "], ["# ", ""]):
        out = io.StringIO()
        header = delimiter.join(names)
        np.savetxt(out, points, delimiter=delimiter, header=header, comments=comments)
        contents.append(out.getvalue())
    for how in ({"sep": ","}, {"sep": ";", "decimal": ","}, {"sep": "\t"}):
        contents.append(pd.DataFrame(points, columns=names).to_csv(index=False, **how))
    for content in contents:
        stimulus = read_profile(tmp_path, content.encode())
        np.testing.assert_allclose(stimulus.y, 1e-3 * Y, atol=1e-12)


def test_rows_are_counted_as_an_editor_counts(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("# one\n\na,b\n1,2\n# three\n3,4\n")
    table = read_table(path)
    assert table.header == ("a", "b") and table.lines == [4, 6] and table.numbers(1) == [2.0, 4.0]
    path.write_text("# one\n\na,b\n1,2\n# three\n3,x\n")
    with pytest.raises(TableError, match=r"has 'x' in row 6, column 'b'"):
        read_table(path).numbers(1)

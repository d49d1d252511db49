"""The style: contrast on paper, colours apart for every reader, pages of a journal's size, notes of
two lines.
"""

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from PIL import Image

from cysyk1999.figures.axes import statement, statement_row
from cysyk1999.figures.registry import FIGURES
from cysyk1999.publishing import style
from cysyk1999.publishing.write import publish
from drawn import picture, saved

pytestmark = pytest.mark.unit

TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
EYES = {
    "trichromat": np.eye(3),
    "protanope": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranope": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}
"""What is left of linear RGB (Machado, Oliveira and Fernandes 2009, severity 1)."""
LINES = {
    (meaning, name): look["color"]
    for meaning, looks in style.MEANINGS.items()
    for name, look in looks.items()
} | {("second curve", ""): style.HIGHLIGHT}


def linear(colour):
    c = np.array(mpl.colors.to_rgb(colour))
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)


def contrast(colour, paper="white"):
    """Ratio of luminances (WCAG 2)."""
    one, other = sorted((float(TO_XYZ[1] @ linear(c)) for c in (colour, paper)), reverse=True)
    return (one + 0.05) / (other + 0.05)


def lab(colour, eye="trichromat"):
    """CIELAB of a colour as an eye sees it."""
    f = TO_XYZ @ np.clip(EYES[eye] @ linear(colour), 0, 1) / [0.95047, 1, 1.08883]
    f = np.where(f > 216 / 24389, np.cbrt(f), (24389 / 27 * f + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def apart(one, other, eye):
    return float(np.linalg.norm(lab(one, eye) - lab(other, eye)))


def test_measures_of_colour_are_the_known_ones():
    assert contrast("black") == pytest.approx(21, abs=0.01) and contrast(
        "#767676"
    ) == pytest.approx(4.54, abs=0.01)
    np.testing.assert_allclose(lab("#ff0000"), [53.24, 80.09, 67.20], atol=0.02)
    assert apart("#ff0000", "#6d5f00", "protanope") < 0.35 * apart(
        "#ff0000", "#6d5f00", "trichromat"
    )


@pytest.mark.parametrize("what, colour", LINES.items(), ids=" ".join)
def test_lines_have_a_contrast_of_three_to_one(what, colour):
    assert contrast(colour) >= 3.0


@pytest.mark.parametrize("paper", ["white", style.BAND])
def test_text_has_a_contrast_of_four_and_a_half_to_one(paper):
    assert all(contrast(colour, paper) >= 4.5 for colour in (style.INK, style.GREY))


@pytest.mark.parametrize("number", FIGURES)
def test_page_is_a_journals_and_its_text_is_never_coloured(number):
    grey = [
        mpl.colors.to_rgb(text.get_color())
        for text in picture(number).findobj(mpl.text.Text)
        if text.get_text().strip()
    ]
    assert all(np.ptp(colour) < 0.02 and contrast(colour) >= 4.5 for colour in grey)
    width, height = picture(number).get_size_inches() * 25.4
    assert min(abs(width - 183), abs(width - 89)) < 0.1 and height <= 170.01


def test_curvatures_are_one_sequence_even_in_the_logarithm():
    light = [lab(colour)[0] for colour in style.COLOURS.values()]
    assert (np.diff(light) > 2).all() and 19 < light[0] < 22 and 60 < light[-1] < 62
    assert [
        style.curvature_colour(float(name)) for name in style.COLOURS if name != "flat"
    ] == list(style.COLOURS.values())[1:]
    between = lab(style.curvature_colour(500))[0]
    assert light[9] < between < light[10] and style.curvature_colour(0) == style.COLOURS["flat"]
    assert style.look_of("curvature (1/m)", "157") == {"color": style.curvature_colour(157)}
    assert (
        apart(style.curvature_colour(157.48), style.COLOURS["158"], "trichromat") < 0.5
    )  # one curvature, pressed and stroked


@pytest.mark.parametrize("eye", EYES)
def test_neighbouring_curvatures_of_the_nine_surfaces_can_be_told_apart(eye):
    nine = [
        style.COLOURS[k] for k in ("flat", "79", "105", "158", "210", "315", "420", "630", "1260")
    ]
    assert (
        min(apart(a, b, eye) for a, b in zip(nine, nine[1:], strict=False)) >= 7
    )  # 4.3 in matplotlib's plasma for a protanope


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize(
    "meaning", [m for m in style.MEANINGS if m not in ("curvature (1/m)", "verdict")]
)
def test_what_is_told_apart_differs_by_colour_and_by_line_or_marker(meaning, eye):
    looks = list(style.MEANINGS[meaning].values())
    for k, one in enumerate(looks):
        for other in looks[k + 1 :]:
            assert one["color"] != other["color"] and (one["ls"], one["marker"]) != (
                other["ls"],
                other["marker"],
            )
            assert apart(one["color"], other["color"], eye) >= 8


@pytest.mark.parametrize("number", [n for n in FIGURES if n[0] != "3"])
def test_panels_are_lettered_from_a(number):
    fig = picture(number)
    tags = [t.get_text() for ax in fig.axes for t in ax.texts if t.get_fontweight() == "bold"]
    assert tags == list("abcdefghijklmnopqrstuvwxyz")[: len(tags)] and len(tags) != 1


# --- what the thesis says -------------------------------------------------------------------------


SAYS = statement_row(
    "TR99; 2 of 3 hold",
    "rates grow",
    "nine surfaces",
    "fails",
    "not for flat",
    "from 1 to 2; not for flat",
)


def test_statement_is_as_long_as_the_line_allows():
    frame = pd.DataFrame([SAYS])
    whole = "Thesis: rates grow (nine surfaces). Here: fails (from 1 to 2; not for flat)."
    assert statement(frame) == [f"{whole} In all 2 of 3 such statements hold."]
    narrow = " ".join(statement(frame, 28))
    assert narrow == "Thesis: rates grow. Here: fails (not for flat)."
    assert statement(pd.DataFrame({"source": ["simulated"]})) == []


@pytest.mark.parametrize("number", FIGURES)
def test_note_has_two_lines_and_says_what_the_thesis_says(number):
    frame = pd.concat([saved(number), pd.DataFrame([SAYS])], ignore_index=True)
    fig = FIGURES[number].draw(frame)
    note = fig.texts[-1].get_text()
    assert "Thesis: rates grow" in note.replace("\n", " ")
    assert len(note.split("\n")) <= (2 if FIGURES[number].width == style.PAGE_WIDTH else 4)


def test_a_picture_is_written_as_vectors_too_where_a_folder_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERPAD_VECTORS", str(tmp_path / "vectors"))
    for name in "ab":
        publish(FIGURES["4-7"].draw(saved("4-7")), saved("4-7"), tmp_path / f"{name}.png")
    one, other = ((tmp_path / "vectors" / f"{name}.pdf").read_bytes() for name in "ab")
    assert one == other and one.startswith(b"%PDF")


def test_pictures_in_few_colours_look_like_those_in_all(tmp_path):
    publish(FIGURES["3-5"].draw(saved("3-5")), saved("3-5"), tmp_path / "few.png")
    fig = FIGURES["3-5"].draw(saved("3-5"))
    fig.savefig(tmp_path / "all.png", dpi=300)
    few, whole = (
        np.asarray(Image.open(tmp_path / name).convert("RGB"), int)
        for name in ("few.png", "all.png")
    )
    assert (few[:5] == 255).all() and abs(few - whole).mean() < 1
    assert (tmp_path / "few.png").stat().st_size < 0.5 * (tmp_path / "all.png").stat().st_size

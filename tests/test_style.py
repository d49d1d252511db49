"""The style: contrast on paper, colours apart for every reader, pages of a journal's size, notes of
two lines.
"""

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest

from cysyk1999.figures.axes import statement, statement_row
from cysyk1999.figures.registry import FIGURES
from cysyk1999.publishing import style
from cysyk1999.publishing.write import in_few_colours, publish, write_vectors
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
def test_text_is_never_coloured(number):
    grey = [
        mpl.colors.to_rgb(text.get_color())
        for text in picture(number).findobj(mpl.text.Text)
        if text.get_text().strip()
    ]
    assert all(np.ptp(colour) < 0.02 and contrast(colour) >= 4.5 for colour in grey)


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


def test_the_second_curve_is_no_surfaces_speeds_or_forces_colour():
    others = [
        c
        for (meaning, _), c in LINES.items()
        if meaning.startswith(("curvature", "speed", "force"))
    ]
    assert min(apart(style.HIGHLIGHT, c, "trichromat") for c in others) > 25


@pytest.mark.parametrize("number", FIGURES)
def test_page_is_a_journals(number):
    fig = picture(number)
    width, height = fig.get_size_inches() * 25.4
    assert min(abs(width - 183), abs(width - 89)) < 0.1 and height <= 170.01
    sizes = {text.get_fontsize() for text in fig.findobj(mpl.text.Text) if text.get_text().strip()}
    assert min(sizes) >= 5.5 and max(sizes) <= 7
    assert (
        mpl.font_manager.FontProperties(family=style.RC["font.family"]).get_name() == "DejaVu Sans"
    )


@pytest.mark.parametrize("number", [n for n in FIGURES if n[0] != "3"])
def test_panels_are_lettered_from_a(number):
    fig = picture(number)
    tags = [t.get_text() for ax in fig.axes for t in ax.texts if t.get_fontweight() == "bold"]
    assert tags == list("abcdefghijklmnopqrstuvwxyz")[: len(tags)] and len(tags) != 1


# --- what the thesis says --------------------------------------------------------------------------------


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


def test_fonts_are_taken_apart_once_for_all_pictures_and_for_what_is_rare_once_more(
    tmp_path, monkeypatch
):
    from matplotlib.backends import _backend_pdf_ps
    from matplotlib.figure import Figure

    calls, own = [], _backend_pdf_ps.get_glyphs_subset

    def counted(*what):
        calls.append(what)
        return own(*what)

    def written(text):
        calls.clear()
        fig = Figure()
        fig.text(0.1, 0.5, text)
        write_vectors(fig, tmp_path / "a.pdf")
        return len(calls), (tmp_path / "a.pdf").read_bytes()

    monkeypatch.setattr(_backend_pdf_ps, "get_glyphs_subset", counted)
    texts = "pressure (kPa)", "first, 30 µm − 2 m²", "other: Ж", "pressure (kPa)"
    found = [written(text) for text in texts]
    assert [times for times, _ in found] == [1, 0, 1, 0]
    assert found[0][1] == found[3][1] and len({content for _, content in found}) == 3
    assert _backend_pdf_ps.get_glyphs_subset is counted


def test_pictures_in_few_colours_keep_white_and_all_colours_there_is_room_for():
    rng = np.random.default_rng(5)
    few = rng.integers(0, 256, (200, 3))
    pixels = np.full((40, 50, 4), 255, np.uint8)
    assert np.asarray(in_few_colours(pixels).convert("RGB")).min() == 255
    pixels[10:30, 10:20, :3] = few[:, None].reshape(20, 10, 3)
    assert (np.asarray(in_few_colours(pixels).convert("RGB")) == pixels[..., :3]).all()
    pixels[:, 20:45, :3] = rng.integers(0, 128, (40, 25, 3))
    found = in_few_colours(pixels)
    shown = np.asarray(found.convert("RGB")).astype(int)
    assert (
        len(found.getcolors()) <= 255
        and (shown[:, 45:] == 255).all()
        and (shown[:10, :10] == 255).all()
    )
    wrong = np.abs(shown - pixels[..., :3])
    assert wrong[:, 20:45].mean() < 8  # of 128 in each of three directions, 254 boxes


def test_a_small_bar_of_colours_keeps_its_steps_beside_a_large_field():
    bar = np.zeros((5, 256, 4), np.uint8) + np.uint8(255 * mpl.colormaps["viridis"](np.arange(256)))
    rng = np.random.default_rng(6)
    pixels = np.full((400, 600, 4), 255, np.uint8)
    pixels[:300] = bar[
        0, rng.integers(230, 256, (300, 600))
    ]  # the upper end of the map, in light and shade
    pixels[:300, :, :3] -= rng.integers(0, 30, (300, 600, 1), np.uint8)
    pixels[:100, :300, :3] = (
        196,
        154,
        120,
    )  # much of a picture has one colour, such as a layer's, and some is almost that
    pixels[100:105, :300, :3] = 200, 154, 120
    pixels[350:355, :256] = bar
    wrong = np.abs(np.asarray(in_few_colours(pixels).convert("RGB")).astype(int) - pixels[..., :3])
    assert wrong[:100, :300].max() == 0
    assert wrong[350:355].mean() < 3  # 9 if all colours went by how many pixels have them

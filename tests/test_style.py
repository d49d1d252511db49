"""The style: contrast on paper, colours apart for every reader, pages of a journal's size, notes of
two lines.
"""

from itertools import combinations, pairwise
from string import ascii_lowercase

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from PIL import Image
from skimage.color import rgb2xyz, xyz2lab
from skimage.color.colorconv import rgb_from_xyz, xyz_from_rgb

from cysyk1999.figures.axes import statement_row
from cysyk1999.figures.registry import FIGURES
from cysyk1999.publishing import style
from cysyk1999.publishing.write import publish
from drawn import picture, saved
from fingerpad.measures.features import SURFACES

pytestmark = pytest.mark.unit

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
LINES = {look["color"] for looks in style.MEANINGS.values() for look in looks.values()}


def contrast(colour, paper="white"):
    """Ratio of luminances (WCAG 2)."""
    other, one = sorted(rgb2xyz(mpl.colors.to_rgb(c))[1] for c in (colour, paper))
    return (one + 0.05) / (other + 0.05)


def lab(colour, eye="trichromat"):
    """CIELAB of a colour as an eye sees it."""
    linear = rgb_from_xyz @ rgb2xyz(mpl.colors.to_rgb(colour))
    return xyz2lab(xyz_from_rgb @ np.clip(EYES[eye] @ linear, 0, 1))


def apart(one, other, eye):
    return float(np.linalg.norm(lab(one, eye) - lab(other, eye)))


def test_measures_of_colour_are_the_known_ones():
    assert [contrast("black"), contrast("#767676")] == pytest.approx([21, 4.54], abs=0.01)
    np.testing.assert_allclose(lab("#ff0000"), [53.24, 80.09, 67.20], atol=0.02)
    seen, usual = (apart("#ff0000", "#6d5f00", eye) for eye in ("protanope", "trichromat"))
    assert seen < 0.35 * usual


@pytest.mark.parametrize("colour", sorted(LINES | {style.HIGHLIGHT, style.MEASURED, style.THESIS}))
def test_lines_have_a_contrast_of_three_to_one(colour):
    assert contrast(colour) >= 3.0


@pytest.mark.parametrize("paper", ["white", style.BAND])
@pytest.mark.parametrize("colour", [style.INK, style.GREY])
def test_text_has_a_contrast_of_four_and_a_half_to_one(colour, paper):
    assert contrast(colour, paper) >= 4.5


@pytest.mark.parametrize("number", FIGURES)
def test_page_is_a_journals_and_its_text_is_never_coloured(number):
    texts = [text for text in picture(number).findobj(mpl.text.Text) if text.get_text().strip()]
    for colour in {mpl.colors.to_rgb(text.get_color()) for text in texts}:
        assert np.ptp(colour) < 0.02 and contrast(colour) >= 4.5
    width, height = picture(number).get_size_inches() * 25.4
    assert min(abs(width - 183), abs(width - 89)) < 0.1 and height <= 170.01


def test_curvatures_are_one_sequence_whose_lightness_tells_them_apart():
    """Mutant: the sequence before, even in the logarithm, where 79 to 420 were one crimson."""
    of = style.curvature_colour
    light = [lab(colour)[0] for colour in style.COLOURS.values()]
    nine = [lab(style.COLOURS[label])[0] for label in SURFACES]
    assert (np.diff(light) > 2).all() and (np.diff(nine) > 4.5).all()
    assert np.ptp(light) > 48 and light[-1] < 62
    assert {name: of(float(name.replace("flat", "0"))) for name in style.COLOURS} == style.COLOURS
    assert light[9] < lab(of(500))[0] < light[10]
    assert style.look_of("curvature (1/m)", "157") == {"color": of(157)}
    # one curvature, pressed and stroked
    assert apart(of(157.48), style.COLOURS["158"], "trichromat") < 0.5


@pytest.mark.parametrize("eye", EYES)
def test_model_measurement_and_thesis_have_hues_of_their_own(eye):
    """Which no curvature, the model's colours in most pictures, comes near."""
    three = (style.HIGHLIGHT, style.MEASURED, style.THESIS, style.INK)
    assert min(apart(*pair, eye) for pair in combinations(three, 2)) >= 12
    least = 30 if eye == "trichromat" else 5
    for colour in (style.MEASURED, style.THESIS):
        assert min(apart(colour, other, eye) for other in style.COLOURS.values()) >= least


@pytest.mark.parametrize("number", FIGURES)
def test_no_text_is_smaller_than_six_points_at_the_width_of_print(number):
    texts = picture(number).findobj(mpl.text.Text)
    sizes = {text.get_fontsize() for text in texts if text.get_visible() and text.get_text()}
    assert min(sizes) >= style.SMALLEST


@pytest.mark.parametrize("eye", EYES)
def test_neighbouring_curvatures_of_the_nine_surfaces_can_be_told_apart(eye):
    nine = [style.COLOURS[label] for label in SURFACES]
    # 4.3 in matplotlib's plasma for a protanope
    assert min(apart(*pair, eye) for pair in pairwise(nine)) >= 7


@pytest.mark.parametrize("eye", EYES)
@pytest.mark.parametrize(
    "meaning", [m for m in style.MEANINGS if m not in ("curvature (1/m)", "verdict")]
)
def test_what_is_told_apart_differs_by_colour_and_by_line_or_marker(meaning, eye):
    for one, other in combinations(style.MEANINGS[meaning].values(), 2):
        assert one["ls"] != other["ls"] or one["marker"] != other["marker"]
        assert apart(one["color"], other["color"], eye) >= 8


@pytest.mark.parametrize("number", [n for n in FIGURES if n[0] != "3"])
def test_panels_are_lettered_from_a(number):
    fig = picture(number)
    tags = [t.get_text() for ax in fig.axes for t in ax.texts if t.get_fontweight() == "bold"]
    assert "".join(tags) == ascii_lowercase[: len(tags)] and len(tags) != 1


# --- what the thesis says -------------------------------------------------------------------------


SAYS = statement_row("partly", "Thesis: holds here in part. Fails: rates grow.", "Thesis: partly.")


@pytest.mark.parametrize("number", FIGURES)
def test_picture_has_one_mark_of_its_verdict_and_a_short_note(number):
    """The sentence is in the caption (`figures/README.md`), not in the picture."""
    frame = pd.concat([saved(number), pd.DataFrame([SAYS])], ignore_index=True)
    texts = [text.get_text() for text in FIGURES[number].draw(frame).texts]
    assert texts.count("◐ Thesis: partly") == 1 and "rates grow" not in " ".join(texts)
    assert len(texts[-1].split("\n")) <= (2 if FIGURES[number].width == style.PAGE_WIDTH else 3)


def test_a_picture_is_written_as_vectors_too_where_a_folder_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERPAD_VECTORS", str(tmp_path / "vectors"))
    for name in "ab":
        publish(FIGURES["4-7"].draw(saved("4-7")), saved("4-7"), tmp_path / f"{name}.png")
    one, other = ((tmp_path / "vectors" / f"{name}.pdf").read_bytes() for name in "ab")
    assert one == other and one.startswith(b"%PDF")


def test_pictures_in_few_colours_look_like_those_in_all(tmp_path):
    paths = few, whole = tmp_path / "few.png", tmp_path / "all.png"
    publish(FIGURES["3-5"].draw(saved("3-5")), saved("3-5"), few)
    FIGURES["3-5"].draw(saved("3-5")).savefig(whole, dpi=300)
    one, other = (np.asarray(Image.open(path).convert("RGB"), int) for path in paths)
    assert (one[:5] == 255).all() and abs(one - other).mean() < 1
    assert few.stat().st_size < 0.5 * whole.stat().st_size

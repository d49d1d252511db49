"""One style for every picture: what each colour, marker and line style means, the page, its title
and note, direct labels.

Pages follow the journals' widths (89 mm a column, 183 mm a page, 170 mm tall at most) with one face
at 6 to 7 pt: Arimo, which is as wide as Arial. Colours mean one thing each (`MEANINGS`): curvatures
are one sequence from navy to orange whose lightness keeps its order in grey and for colour-blind
readers; what has no order wears the colours of Okabe and Ito (2008), darkened where they are too
pale for a line, and a line style and a marker besides. What was measured is green, what the thesis
shows is olive, and neither is used for the model. Text is never coloured.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager
from functools import cache, wraps
from importlib.util import find_spec
from pathlib import Path
from string import ascii_lowercase

import numpy as np
from fontTools.ttLib import TTFont
from fontTools.varLib.instancer import instantiateVariableFont
from matplotlib import get_cachedir
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.colors import to_hex, to_rgba_array
from matplotlib.figure import Figure
from matplotlib.font_manager import fontManager
from matplotlib.legend_handler import HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon
from matplotlib.patheffects import withStroke
from matplotlib.style import context
from matplotlib.ticker import ScalarFormatter
from matplotlib.transforms import Affine2D
from pandas import DataFrame
from scipy.optimize import isotonic_regression

from fingerpad.files import write_atomically

INCH = 25.4  # mm
PAGE_WIDTH, COLUMN_WIDTH, TALLEST = 183 / INCH, 89 / INCH, 170 / INCH  # inch, of a journal's page
NOTE_SIZE = 6.0  # pt
NOTE_WIDTH = 182  # characters of a footnote's line on a page
INK, GREY, PALE, BAND = "0.15", "0.42", "0.8", "#f8f3df"
"""Text and what is not told apart; remarks and references; solids beyond the skin; the thesis's
range.
"""
HIGHLIGHT, MEASURED, THESIS = "#0072b2", "#00785a", "#7a6000"
"""The second of two curves of the model, whatever it is; what was measured; what the thesis's axes
show.
"""


@cache
def families() -> list[str]:
    """Families that text is set in: Arimo, if its package is there, and DejaVu Sans for what that
    lacks.

    The package holds one file for all weights, of which matplotlib reads only the lightest: the
    regular and the bold face are written beside matplotlib's own list of fonts.
    """
    if (package := find_spec("fontpkg_arimo")) is None:
        return ["DejaVu Sans"]
    (whole,) = Path(package.origin).parent.glob("files/Arimo[[]wght[]].ttf")
    for name, weight in (("Regular", 400), ("Bold", 700)):
        face = Path(get_cachedir()) / f"Arimo-{name}.ttf"
        if not face.exists():
            font = instantiateVariableFont(TTFont(whole), {"wght": weight}, updateFontNames=True)
            write_atomically(face, font.save)
        fontManager.addfont(face)
    return ["Arimo", "DejaVu Sans"]


RC = {
    "font.size": 7,
    "axes.titlesize": 7,
    "axes.labelsize": 7,
    "xtick.labelsize": 6.5,
    "ytick.labelsize": 6.5,
    "legend.fontsize": 6.5,
    "legend.title_fontsize": 6.5,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.titlepad": 5,
    "axes.labelpad": 3,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.minor.size": 1.5,
    "ytick.minor.size": 1.5,
    "xtick.major.pad": 2.5,
    "ytick.major.pad": 2.5,
    "lines.linewidth": 1.1,
    "lines.markersize": 4,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "axes.formatter.limits": (-4, 5),
    "pdf.fonttype": 42,
    "mathtext.fontset": "custom",
    "mathtext.fallback": "stixsans",
    "hatch.linewidth": 0.4,
    "errorbar.capsize": 1.5,
}
SMALLEST = 6.0
"""pt, of any text but exponents."""

SOLID, DASHED, DOTTED = "-", (0, (4, 1.8)), (0, (1, 1.4))
DASH_DOT, LONG = (0, (4, 1.5, 1, 1.5)), (0, (8, 2))
LINES = (SOLID, DASHED, DOTTED, DASH_DOT, LONG, (0, (2.5, 1)))
MARKERS = "os^Dv<>PXh"
Look = Mapping[str, object]

# --- what colours mean ----------------------------------------------------------------------------

COLOURS = {
    "flat": "#001b40",
    "26": "#001d5e",
    "39": "#1d1976",
    "52": "#421477",
    "79": "#610976",
    "105": "#83006e",
    "158": "#9f0064",
    "210": "#ba0059",
    "315": "#cf1c4b",
    "420": "#dc3c3b",
    "630": "#e2592a",
    "1260": "#e37513",
}
"""Of curvatures in 1/m: lightness from 10 to 61, where a line on white still has a contrast of 3,
in steps of five between the nine surfaces.
"""
CATEGORIES = ("#0072b2", "#d55e00", "#009e73", "#b5588f", "#7a6000", "#404040")
"""Okabe and Ito's blue, vermilion and green; their purple and yellow as dark as a line needs; and
grey.
"""


def _looks(
    names: Sequence[str], colours: Sequence[str] = CATEGORIES, lines: Sequence = LINES
) -> dict[str, Look]:
    return {
        name: {
            "color": colours[k % len(colours)],
            "ls": lines[k % len(lines)],
            "marker": MARKERS[k % len(MARKERS)],
        }
        for k, name in enumerate(names)
    }


MEANINGS: Mapping[str, Mapping[str, Look]] = {
    "curvature (1/m)": {name: {"color": colour} for name, colour in COLOURS.items()},
    "speed (mm/s)": _looks(
        ("1", "5", "10", "20", "40"),
        ("#00233d", "#004164", "#00608e", "#157fb2", "#3b9bd3"),
        (DOTTED, (0, (3, 1, 1, 1)), SOLID, LONG, DASHED),
    ),
    "force (gf)": _looks(
        ("10", "15", "20"), ("#3d2163", "#704f97", "#a081c1"), (DOTTED, DASHED, SOLID)
    ),
    "depth": _looks(
        ("first", "second", "third", "fourth"),
        ("#402613", "#6c4428", "#99633b", "#c48151"),
        (DOTTED, DASH_DOT, DASHED, SOLID),
    ),
    "subject": _looks(
        ("1", "2", "3", "4", "mean"), ("#004d3b", "#006c54", "#008c6e", "#3aa583", INK)
    ),
    "energy": _looks(
        (
            "instantaneous elastic",
            "long-term moduli",
            "half stress × strain",
            "recoverable",
            "long-term network",
        )
    ),
    "element": _looks(("Q2P1", "Q1P0", "P2B", "elastic half-plane", "water bed")),
    "accuracy": _looks(("draft", "0.05", "0.02")),
    "boundary": _looks(
        ("corneum", "dermis", "fat"), ("#402613", "#0072b2", "#7a6000"), (SOLID, DASH_DOT, DOTTED)
    ),
    "verdict": _looks(
        ("inside", "plausible", "holds", "outside", "fails", "not judged"),
        ("#0072b2", "#0072b2", "#0072b2", "#d55e00", "#d55e00", "#737373"),
        (SOLID,),
    ),
}
"""What is told apart -> its values, and how each looks. A test measures contrasts and distances,
colour-blind ones too.
"""

LAYER_COLOURS = {
    "stratum corneum": "#8c6d52",
    "epidermis": "#c49a78",
    "dermis": "#e3b7a8",
    "fat": "#f6e7c4",
    "bone": "#b9bec4",
}
"""Areas, always outlined: their lightness falls from the outside in but for the bone, which is
grey.
"""
FIELD = "cividis"
"""Map of strain energy and other fields: even for colour-blind readers."""


def look_of(meaning: str, name: str, *parts: str) -> dict[str, object]:
    """Parts (left out: ``color`` and ``ls``) of how a value of `MEANINGS` looks. Curvatures that
    are not in the table lie on the sequence between its own; KeyError for any other value that is
    not there.
    """
    if meaning == "curvature (1/m)" and name not in COLOURS:
        return {"color": curvature_colour(float(name))}
    look = MEANINGS[meaning][name]
    return {part: look[part] for part in parts or ("color", "ls") if part in look}


def curvature_colour(curvature: float) -> str:
    """Colour of any curvature (1/m; a plate: 0) between those of `COLOURS`, linear in its
    logarithm.
    """
    known = np.log([13.0, *(float(name) for name in COLOURS if name != "flat")])
    at = np.log(max(curvature, 1.0))  # np.interp stays within the ends
    channels = to_rgba_array(list(COLOURS.values())).T
    return to_hex([np.interp(at, known, channel) for channel in channels])


def ordered(meaning: str, names: Iterable[str]) -> dict[str, Look]:
    """Looks of some names by their order, of a meaning whose values are not known beforehand:
    ``depth``, ``subject``.
    """
    looks = list(MEANINGS[meaning].values())
    return {name: looks[k % len(looks)] for k, name in enumerate(dict.fromkeys(names))}


# --- pages ----------------------------------------------------------------------------------------


def styled(draw: Callable[[DataFrame], Figure]) -> Callable[[DataFrame], Figure]:
    """Run a drawing function under the shared style, whatever the caller's matplotlib settings are,
    and letter its panels.
    """

    @wraps(draw)
    def inner(frame: DataFrame) -> Figure:
        with theme():
            return finished(draw(frame))

    return inner


def theme() -> AbstractContextManager:
    """Matplotlib's own defaults with this style on top; the caller's settings come back
    afterwards.
    """
    faces = families()
    mathematics = {f"mathtext.{style}": faces[0] for style in ("rm", "it", "bf", "sf", "cal", "tt")}
    return context(RC | mathematics | {"font.family": faces}, after_reset=True)


def wrapped(lines: Iterable[str], width: int = NOTE_WIDTH) -> list[str]:
    """Paragraphs as lines of at most `width` characters, none of which begins with a percent
    sign.
    """
    together = (line.replace(" %", "\xa0%") for line in lines)
    return [part.replace("\xa0", " ") for line in together for part in textwrap.wrap(line, width)]


def note_width(width: float = PAGE_WIDTH) -> int:
    """Characters of a note's line in a picture so wide (inch)."""
    return round(NOTE_WIDTH * width / PAGE_WIDTH)


def sheet(
    title: str,
    note: Sequence[str],
    height: float,
    laid_out: bool = True,
    width: float = PAGE_WIDTH,
    shows: str = "",
    mark: str = "",
    icon: str = "",
) -> Figure:
    """Empty figure of a height and width (inch): the title, which is its finding, above, and below
    it what it `shows`; at the right a verdict's `mark` and an `icon` (:func:`draw_icon`); the
    note's lines at the foot.

    Panels are laid out in between, unless the caller does so (not `laid_out`).
    """
    fig = Figure(figsize=(width, height), layout="constrained" if laid_out else None)
    left, line = 0.08 / width, 0.128 / height
    if icon:
        draw_icon(fig, icon)
    free = width - 0.16 - 0.46 * bool(icon)
    lines = textwrap.wrap(title, round(20.5 * free))
    top = {"va": "top", "linespacing": 1.2}
    fig.text(left, 1 - 0.06 / height, "\n".join(lines), fontweight="bold", **top)
    small = {"fontsize": NOTE_SIZE, "color": GREY}
    under = 1 - 0.08 / height - line * len(lines)
    shown = textwrap.wrap(shows, round(23.5 * free))
    fig.text(left, under, "\n".join(shown), **small, **top)
    if mark and width > 1.2 * COLUMN_WIDTH:  # the verdict beside what it is on, or below it
        right = 1 - left - 0.5 * bool(icon) / width
        fig.text(right, under, mark, **small | {"color": INK}, ha="right", **top)
    elif mark:
        shown.append(mark)
        place = under - 0.105 * (len(shown) - 1) / height
        fig.text(left, place, mark, **small | {"color": INK}, **top)
    if laid_out:
        above, below = 0.13 + 0.128 * len(lines) + 0.105 * len(shown), 0.115 * len(note) + 0.07
        rect = (0.005, below / height, 0.99, 1 - (above + below) / height)
        pads = {"w_pad": 0.04, "hspace": 0.04} if shows else {"w_pad": 0.05}
        fig.get_layout_engine().set(rect=rect, h_pad=0.04, **pads)
    fig.text(left, 0.05 / height, "\n".join(note), va="bottom", linespacing=1.3, **small)
    return fig


def study_figure(
    title: str, note: Sequence[str], height: float, width: float = PAGE_WIDTH
) -> Figure:
    """`sheet` of a study: its finding as title, the note's paragraphs wrapped."""
    return sheet(title, wrapped(note, note_width(width)), height, width=width)


def draw_icon(fig: Figure, kind: str) -> None:
    """What is done to the finger, in the upper right corner of a page: words ``press`` (an arrow
    down) or ``stroke`` (a wavy surface, an arrow across), and ``receptor`` (a dot below the skin)
    if that is what answers.
    """
    width, height = fig.get_size_inches()
    place = Affine2D().translate(width - 0.3, height - 0.36) + fig.dpi_scale_trans
    own = {"transform": place, "lw": 0.6, "zorder": 5}

    def area(x: np.ndarray, y: np.ndarray, colour: str) -> None:
        fig.add_artist(Polygon(np.c_[x, y], fc=colour, ec=INK, **own))

    x = np.linspace(-1, 1, 41)
    area(0.22 * x, 0.16 * np.sqrt(1 - x**2), LAYER_COLOURS["dermis"])
    side = 0.175 + (0.02 * (1 - np.cos(4.5 * np.pi * x)) if "stroke" in kind else 0.09 * x**2)
    reach = 0.22 if "stroke" in kind else 0.1
    area(reach * np.r_[-1, x, 1], np.r_[0.28, side, 0.28], PALE)
    ends = ((-0.07, 0.32), (0.1, 0.32)) if "stroke" in kind else ((0.17, 0.32), (0.17, 0.19))
    arrow = {"arrowstyle": "->,head_length=1.6,head_width=1.1", "shrinkA": 0, "shrinkB": 0}
    fig.add_artist(FancyArrowPatch(*ends, color=INK, **arrow, **own | {"lw": 0.8}))
    if "receptor" in kind:
        fig.add_artist(Circle((0, 0.1), 0.022, fc=INK, ec="white", **own))


def leave_room(fig: Figure, above: float = 0.0, beside: float = 0.0) -> None:
    """Keep the panels from what the layout does not see: `above` (inch) under the title, `beside`
    (share of the width) at the right.
    """
    engine = fig.get_layout_engine()
    x, y, width, height = engine.get()["rect"]
    engine.set(rect=(x, y, width - beside, height - above / fig.get_figheight()))


class Powers(ScalarFormatter):
    """Ticks as text, which is drawn faster than mathematics and looks the same, and the power of
    ten beside an axis as mathematics.
    """

    def get_offset(self) -> str:
        """The power of ten."""
        self.set_useMathText(True)
        text = super().get_offset()
        self.set_useMathText(False)
        return text


def finished(fig: Figure) -> Figure:
    """A picture whose panels are drawn, with bold lower-case letters above their left ends if there
    is more than one; twins and insets have none, nor has a matrix of more panels than letters.
    """
    for ax in [each for outer in fig.axes for each in (outer, *outer.child_axes)]:
        for axis in (ax.xaxis, ax.yaxis):
            if type(axis.get_major_formatter()) is ScalarFormatter:
                axis.set_major_formatter(Powers())
    panels = [
        ax
        for ax in fig.axes
        if ax.get_subplotspec() is not None
        and ax.get_visible()
        and ax.axison
        and ax.get_label() not in ("<colorbar>", "twin")
    ]
    lettered = panels if 2 <= len(panels) <= 26 else ()
    look = {"ha": "right", "va": "baseline", "fontweight": "bold", "annotation_clip": False}
    for tag, ax in zip(ascii_lowercase, lettered, strict=False):
        ax.annotate(tag, (0, 1), (-4, 5), "axes fraction", "offset points", **look)
    return fig


def in_kilo(axis: Axis) -> None:
    """Ticks of an axis in thousands, and its label, if it has one, in the kilo of its unit."""
    axis.set_major_formatter(lambda value, _: f"{value / 1000:g}".replace("-", "−"))
    label = axis.get_label()
    label.set_text(label.get_text().replace("(Pa", "(kPa"))


# --- direct labels --------------------------------------------------------------------------------


def spread(values: Sequence[float], gap: float, low: float, high: float) -> np.ndarray:
    """Positions at least `gap` apart, in the order of `values` and closest to them (least squares).

    They stay within ``low .. high`` where there is room. Used to place direct labels. Ties keep
    their order.
    """
    values = np.asarray(values, float)
    order, steps = np.argsort(values, kind="stable"), gap * np.arange(len(values))
    shifted = isotonic_regression(values[order] - steps).x
    shifted = np.clip(shifted, low, max(low, high - steps[-1]))
    out = np.empty_like(values)
    out[order] = shifted + steps
    return out


def label_ends(
    ax: Axes, ends: dict[str, tuple[float, float]], x_label: float, heading: str
) -> None:
    """Label the trace of each surface directly at `x_label` (data units), joined to its end by a
    dotted grey hairline, which is no part of the trace.

    `ends` maps a surface label to the (x, y) of the trace's last point. Axis limits must be set
    already.
    """
    low, high = ax.get_ylim()
    gap = (high - low) * 0.115 / _axes_height(ax)
    heights = [y for _, y in ends.values()]
    positions = spread(heights, gap, low + gap * 0.4, high - gap * 1.6)
    small = {"va": "center", "fontsize": 6.5}
    for (label, (x, y)), position in zip(ends.items(), positions, strict=True):
        ax.plot([x, x_label], [y, position], color=GREY, lw=0.5, ls=(0, (1, 2)), clip_on=False)
        ax.plot(x_label, position, "s", ms=2.5, clip_on=False, color=_of_surface(label))
        ax.text(x_label, position, f"  {'flat plate' if label == 'flat' else label}", **small)
    ax.text(x_label, positions.max() + gap * 1.1, heading, **small)


def _of_surface(label: str) -> str:
    """Colour of a plate or of a curvature (1/m) by its label; ink for any other."""
    return curvature_colour(float(label)) if label.isdigit() else COLOURS.get(label, INK)


def _axes_height(ax: Axes) -> float:
    """Rough height of an axes in inch before the layout is solved."""
    spec = ax.get_subplotspec()
    ratios = spec.get_gridspec().get_height_ratios()
    share = sum(ratios[spec.rowspan.start : spec.rowspan.stop]) / sum(ratios)
    return max(0.5, (ax.figure.get_figheight() - 0.75) * share - 0.2)


def haloed() -> dict[str, object]:
    """Of a text: a white rim, where it stands on symbols or lines."""
    return {"path_effects": [withStroke(linewidth=1.6, foreground="white")]}


def handle(label: str, **look) -> Line2D:
    """An entry of a legend."""
    return Line2D([], [], label=label, **look)


def handles(looks: Mapping[str, Look]) -> list[Line2D]:
    """Entries of a legend: label -> what its line looks like."""
    return [handle(label, **look) for label, look in looks.items()]


def header_legend(
    fig: Figure, entries: Sequence[Line2D | tuple[Line2D, ...]], room: float = 0.16, **options
) -> None:
    """Legend in one row under the title, for which it keeps `room` (inch); the lines of a tuple
    stand side by side as one entry.
    """
    _, foot, _, high = fig.get_layout_engine().get()["rect"]
    leave_room(fig, above=room)
    labels = [(each[0] if isinstance(each, tuple) else each).get_label() for each in entries]
    place = {"loc": "upper left", "bbox_to_anchor": (0.012, foot + high)}
    look = {"handlelength": 2.6, "handletextpad": 0.4, "borderaxespad": 0.0, "ncols": len(labels)}
    look["handler_map"] = {tuple: HandlerTuple(None, pad=0.0)}
    fig.legend(entries, labels, **place | look | options)

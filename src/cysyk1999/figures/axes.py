"""Axes of the thesis: where its range ends, what is shaded beyond it, what the note under a picture
says.

Pictures are made from a frame whose rows say by their `source` what they are: simulated, a thesis's
axis range, measured.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle
from matplotlib.text import Text
from pandas import DataFrame, Series

from cysyk1999.measures.energy_of_1999 import FACTOR
from cysyk1999.measures.errors import PARTS, SHOWN_ABOVE, norm, total
from cysyk1999.measures.quantities import CURVATURE, DISTANCE, ENERGY_FACTOR, HEIGHT, TIME
from cysyk1999.publishing import style
from fingerpad.measures.features import PHASES, SIMULATED, STEADY, TOP, is_simulated

AT_REST = "before contact"
PHASE_LINES = {
    AT_REST: {"linestyle": style.DASHED, "linewidth": 0.6, "color": style.GREY},
    PHASES[0]: {"linestyle": "-", "linewidth": 0.6, "color": "0.57"},
    TOP: {"linestyle": "-", "linewidth": 1.8},
    STEADY: {"linestyle": "-", "linewidth": 0.9, "color": style.INK},
}
"""Dashed before, thin grey on the way, thick in the surface's colour at the top, thin black in the
end.
"""
FIRST, SECOND = {"linestyle": "-", "linewidth": 1.3}, {"linestyle": style.DASHED, "linewidth": 1.1}
"""Two quantities of one run."""
STATEMENT = "thesis statement ("
"""How the source of a row begins that holds what the thesis says of a figure, and whether it is so
here.
"""
MARKS = {"holds": "✓", "fails": "✗", "partly": "◐", "not judged": "–"}
"""What stands before a verdict."""
OTHER_PADS = "other model (pads"
"""How the source of a row of other pads begins."""
NOTE = {"fontsize": 6.5, "color": style.GREY}
"""Of a remark in a panel."""
BRACKET = {"color": style.THESIS, "shrinkA": 0, "shrinkB": 0}
"""Of a stretch that the thesis states, further than what its ends look like."""
RANGE = "thesis range"
"""Marks (`gid`) what shows the range of the thesis's axes."""
SURFACE = "surface"
"""Panel of the rows that hold the shape of a stroked surface."""


def surface_name(label: str) -> str:
    """Title of a surface: ``flat plate`` or ``K = 79 1/m``."""
    return "flat plate" if label == "flat" else f"K = {label} 1/m"


def look(name: str) -> dict[str, object]:
    """Colour of a surface (``210``) or colour and line of a velocity (``10 mm/s``); of anything
    else none.
    """
    speed = name.removesuffix(" mm/s")
    if name != speed in style.MEANINGS["speed (mm/s)"]:
        return style.look_of("speed (mm/s)", speed)
    return style.look_of("curvature (1/m)", name) if name in style.COLOURS else {}


def rows_of(frame: DataFrame, column: str, value: object) -> DataFrame:
    """Rows of one panel or trace, and the range rows that belong to every panel."""
    return frame[(frame[column] == value) | (frame[column].isna() & ~is_simulated(frame))]


def from_source(frame: DataFrame, *starts: str) -> DataFrame:
    """Rows whose source begins with a word, or with one of some."""
    return frame[frame["source"].str.startswith(starts)]


def simulated(frame: DataFrame) -> DataFrame:
    """Rows that were simulated."""
    return frame[is_simulated(frame)]


def legs(rows: DataFrame) -> tuple[DataFrame, DataFrame]:
    """The ramp and the hold of a trace whose time is there twice at the top of the ramp."""
    top = int(np.flatnonzero(np.diff(rows[TIME]) == 0)[0]) + 1
    return rows[:top], rows[top:]


def remark(ax: Axes, x: float, y: float, text: str, **look: object) -> None:
    """Words at a place of a panel, in shares of its width and height; a minus stands before
    negative numbers.
    """
    ax.text(x, y, text.replace("-", "−"), transform=ax.transAxes, **look)


# --- notes ----------------------------------------------------------------------------------------

FORMULA = f" by the formula of plane stress, × {FACTOR:g}"
"""How strain energy is read here."""


def footnote(
    frame: DataFrame, how: str = "", width: int = style.NOTE_WIDTH, lines: Lines = ()
) -> list[str]:
    """What a picture shows: simulated or predicted, with which errors, from which strain energy.

    `how` errors are taken, or of which `lines` through points they are (:func:`error_text`), is
    said as well.
    """
    shown = frame[is_simulated(frame)].dropna(axis=1, how="all").columns
    predicted = shown.str.contains(r"\(impulses/s\)|^burst_|^impulse_time|^trial").any()
    what = "Predicted by Eq 5-1, not measured" if predicted else "Simulated, not measured"
    meant, error = "", error_text(frame, lines)
    if width < style.NOTE_WIDTH / 2:  # of a column
        error = error.replace("Largest error", "Error")
    elif predicted:
        what = what.replace(",", "{},")
        meant = f" from strain energy{scaling(frame) or FORMULA}"
    elif shown.str.startswith("strain_energy").any():
        what, meant = what + "{}", f"; strain energy{FORMULA}"
    rest = f". {error}" if error else ""
    line = what.format(meant) + rest
    if error and how and len(line) + len(how) + 4 <= width:
        rest += f" ({how})"
    if frame["source"].str.startswith(OTHER_PADS).any():
        if len(what.format(meant) + rest) + 19 > width:
            meant = ""
        words = ". Faint bars: other pads that the thesis's figures do not tell from this one"
        line = what.format(meant) + rest
        rest += words if len(line) + len(words) < width else ". Bars: other pads"
    return style.wrapped([what.format(meant) + rest + "."], width)


def scaling(frame: DataFrame) -> str:
    """The factor of energies at another depth than 915 um, as `responses.law_at` has it; nothing
    where none is scaled.
    """
    factors = frame[ENERGY_FACTOR].dropna() if ENERGY_FACTOR in frame else []
    scaled = [factor for factor in factors if factor != 1]
    return f" × {scaled[0]:.3g} (mean of the holds then as 915 µm deep)" if scaled else ""


Lines = Sequence[tuple[str, str]]
"""Lines that points are joined to: the columns that name them and that hold what they show."""


def of_lines(frame: DataFrame, lines: Lines) -> DataFrame:
    """The errors of lines through points, one row a line: r.m.s. of what its points are wrong by,
    over that of their values.

    NaN in a part that is not known of one of its points; points of which none is known do not
    count.
    """
    parts, errors = list(PARTS), []
    for named, shown in lines:
        known = frame.dropna(subset=[shown]).dropna(subset=parts, how="all")
        for _, rows in known.groupby(named):
            off = rows[parts].mul(rows[shown], axis=0).to_numpy()
            size = np.linalg.norm(rows[shown]) or np.inf
            errors.append(np.linalg.norm(off, axis=0) / size)
    return DataFrame(errors, columns=parts)


def error_text(frame: DataFrame, lines: Lines = ()) -> str:
    """``Largest error: mesh 1.2 %, steps 0.3 %, sampling 0.1 %`` of the curve or point that is
    furthest off, with its surface where that stands out, and ``not known`` where only that of the
    mesh is not; nothing where none is known. Where points are joined to `lines` it is that of a
    line.
    """
    errors = of_lines(frame, lines) if lines else frame
    sums = total(errors)
    if not sums.notna().any():
        return ""
    worst = errors.loc[sums.idxmax(), list(PARTS)]
    named = dict(zip(("mesh", "steps", "sampling"), worst, strict=True))
    parts = [
        f"{part} {value:.1f} %" if value >= 0.05 or value == 0 else f"{part} <0.1 %"
        for part, value in named.items()
        if value == value
    ]
    if np.isnan(named["mesh"]) and not np.isnan(named["steps"]):  # a mesh of the user's own
        parts.insert(0, "mesh not known")
    of = " of a line" if lines else ""
    if "surface" in frame and not lines:
        far = sums.groupby(frame["surface"]).max().sort_values(ascending=False)
        if len(far) > 1 and far.iloc[0] > max(2 * far.iloc[1], SHOWN_ABOVE):
            of = f" of {surface_name(far.index[0])}"
    return f"Largest error{of}: {', '.join(parts)}"


def statement_row(verdict: str, *texts: str) -> dict[str, str]:
    """A row for a figure's frame that holds the verdict on what the thesis says of it, and that in
    words, from whole to short.
    """
    return {"source": f"{STATEMENT}{verdict}): {' | '.join(texts)}"}


def verdict(frame: DataFrame) -> str:
    """The shortest text of the row that `statement_row` makes, as a mark; nothing without such a
    row.
    """
    rows = frame["source"].astype(str)
    if not (found := rows[rows.str.startswith(STATEMENT)].tolist()):
        return ""
    word, _, texts = found[0].removeprefix(STATEMENT).partition("): ")
    return f"{MARKS.get(word, '')} {_typeset(texts).split(' | ')[-1].rstrip('.')}".strip()


def _typeset(text: str) -> str:
    """With a minus before negative numbers, a space before a percent sign and the square of R²."""
    return re.sub(r"(?<=\d)%", " %", re.sub(r"(?<![\w.])-(?=\d)", "−", text)).replace("R2 ", "R² ")


# --- curves ---------------------------------------------------------------------------------------


def curve(
    ax: Axes,
    rows: DataFrame,
    x: str,
    y: str,
    points: bool = False,
    whole: DataFrame | None = None,
    **look: object,
) -> Line2D:
    """A simulated curve, or points, of a frame's rows, with their error where it is above 2 %: as a
    faint band as high as the error's norm to either side, or as bars at points. `whole`: all rows
    of a curve of which these are a part.
    """
    (line,) = ax.plot(rows[x], rows[y], **look)
    if points:
        bars(ax, rows, x, y, rows[y].abs(), line.get_color())
        return line
    error = total(rows).max()
    of = (rows if whole is None else whole).dropna(subset=[x, y])
    if error > SHOWN_ABOVE and len(of):
        half = error / 100 * norm(of[x].to_numpy(float), of[y].to_numpy(float))
        faint = {"alpha": 0.18, "lw": 0, "zorder": line.get_zorder() - 0.5}
        ax.fill_between(rows[x], rows[y] - half, rows[y] + half, color=line.get_color(), **faint)
    return line


def bars(
    ax: Axes, rows: DataFrame, x: str, y: str, sizes: Series | float, colour: object = style.INK
) -> None:
    """Bars of the errors of points where they are above 2 % of `sizes`, in their unit."""
    half = total(rows) / 100 * sizes
    far = total(rows) > SHOWN_ABOVE
    if far.any():
        look = {"fmt": "none", "ecolor": colour, "elinewidth": 0.7, "zorder": 1}
        ax.errorbar(rows[x][far], rows[y][far], half[far], **look)


def draw_bands(
    ax: Axes,
    rows: DataFrame,
    x: str | None,
    y: str | None,
    place: Callable[[Series], float],
    width: float = 4.0,
) -> None:
    """What other pads show that the thesis's figures do not tell apart (`Data.bands`): a bar from
    the lowest to the highest.

    One of `x` and `y` is the column of the bars' ends, the other is None: there ``place(first row
    of a bar)`` is where it lies.
    """
    ends = from_source(rows, OTHER_PADS)
    draw = ax.hlines if x else ax.vlines
    shape = {"lw": width, "alpha": 0.35, "capstyle": "butt", "zorder": 1.5}
    for (_, first), (_, second) in zip(ends[::2].iterrows(), ends[1::2].iterrows(), strict=True):
        draw(place(first), first[x or y], second[x or y], **look(first["surface"]), **shape)


# --- limits ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Range:
    """What the thesis's axis shows, in data units: whether the data leave it, and whether its
    reading is uncertain.
    """

    low: float
    high: float
    left: bool
    uncertain: bool


def limit_axes(
    ax: Axes,
    frame: DataFrame,
    x: str | None = None,
    y: str | None = None,
    text: bool = True,
) -> None:
    """Set the axes of some columns to the thesis's ranges, and extend them only if the data leave
    these.

    Where an axis is extended, the thesis's range is shaded and, with `text`, labelled (one of
    several alike panels needs it). Without a range in the frame the axis is left to the data. An
    uncertain reading has a broken bracket.
    """
    across = x and _set_limits(ax, frame, x, "x")
    up = y and _set_limits(ax, frame, y, "y")
    if across and up and across.left and up.left:
        thesis_box(ax, across, up)
    elif across and across.left:
        ax.axvspan(across.low, across.high, **_band(across.uncertain))
    elif up and up.left:
        ax.axhspan(up.low, up.high, **_band(up.uncertain))
    if up:
        _bracket(ax, up, text)


def _ranges(frame: DataFrame, column: str) -> tuple[Series, bool]:
    """Ends of the thesis's ranges of a column, and whether the reading of one is uncertain."""
    rows = frame[frame["source"].str.contains("axis range") & frame[column].notna()]
    return rows[column], bool(rows["source"].str.contains("uncertain").any())


def _set_limits(ax: Axes, frame: DataFrame, column: str, axis: str) -> Range | None:
    """Set the limits of one axis; the thesis's range if the data leave it or its reading is
    uncertain.
    """
    ends, doubt = _ranges(frame, column)
    data = from_source(frame, SIMULATED, "measured")[column].dropna()
    set_limits = ax.set_ylim if axis == "y" else ax.set_xlim
    if ends.empty:
        if axis == "y" and len(data):
            set_limits(min(0.0, data.min()), data.max() * 1.06)
        return None
    low, high = ends.min(), ends.max()
    widest = data.abs().max()
    if axis == "x" and low < 0 and widest > high:  # a profile wider than the axis
        set_limits(-widest * 1.04, widest * 1.04)
        return Range(low, high, True, doubt)
    slack, bottom, top = 1e-3 * (high - low), low, high
    if axis == "y" and low < 0 and data.min() < low - slack:  # an axis from 0 starts there
        bottom = data.min() - 0.06 * (high - data.min())
    if axis == "y" and data.max() > high + slack:
        top = data.max() + 0.06 * (data.max() - low)
    set_limits(bottom, top)
    left = (bottom, top) != (low, high)
    return Range(low, high, left, doubt) if left or (doubt and axis == "y") else None


def _bracket(ax: Axes, up: Range, text: bool) -> None:
    """A bracket beside a vertical axis as long as the thesis's range; `text`: with its name."""
    beside = ax.get_yaxis_transform()
    line = BRACKET | {"arrowstyle": "|-|,widthA=.2,widthB=.2", "lw": 1.0}
    line |= {"ls": (0, (2, 2)) if up.uncertain else "-", "gid": RANGE}
    ends = (1.02, up.low), (1.02, up.high)
    ax.annotate("", *ends, xycoords=beside, textcoords=beside, arrowprops=line)
    words = "thesis axis,\nuncertain" if up.uncertain else "thesis axis\nrange"
    look = {"va": "center", "multialignment": "center", "linespacing": 1.0}
    look |= {"fontsize": 6, "rotation": 90, "color": style.GREY}
    middle = (1.03, (up.low + up.high) / 2)
    if text:
        ax.annotate(words, middle, xycoords=beside, **look)


def _band(uncertain: bool) -> dict[str, object]:
    """How the thesis's range is shaded: an uncertain one is hatched."""
    hatched = {"fc": "white", "ec": style.BAND, "hatch": "////"}
    return {"lw": 0, "zorder": 0, "gid": RANGE} | (hatched if uncertain else {"color": style.BAND})


def declare_range(fig: Figure, width: int) -> None:
    """Say what the thesis's ranges look like, if any is drawn: in the last line of the note where
    there is room for it, else in the first that is shaded if no bracket says it.
    """
    marks = [artist for artist in fig.findobj() if artist.get_gid() == RANGE]
    texts = [text.get_text() for text in fig.findobj(Text)]
    note = fig.texts[-1]
    last = note.get_text().rpartition("\n")[2]
    short = " Olive: range of the thesis's axes"
    for words in (f"{short} (broken or hatched: reading uncertain).", f"{short}."):
        if marks and len(last) + len(words) <= width:
            note.set_text(note.get_text() + words)
            return
    shaded = [mark for mark in marks if isinstance(mark, Rectangle)]
    if shaded and not any("thesis axis" in text or "thesis's axis" in text for text in texts):
        inside = {"xytext": (-3, -3), "textcoords": "offset points", "ha": "right", "va": "top"}
        look = {"fontsize": 6, "color": style.GREY}
        shaded[0].axes.annotate("thesis's axes", (1, 1), xycoords=shaded[0], **inside, **look)


def thesis_box(ax: Axes, x: Range, y: Range) -> None:
    """What the thesis's axes show as a rectangle; hatched if a reading of them is uncertain."""
    size = x.high - x.low, y.high - y.low
    band = _band(x.uncertain or y.uncertain)
    ax.add_patch(Rectangle((x.low, y.low), *size, **band))


def wide_limits(ax: Axes, rows: DataFrame, x: str, y: str) -> None:
    """Axes of the thesis's ranges, and of the data where they leave them at either end; what the
    thesis shows is then shaded.
    """
    box = []
    for column, set_limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
        ends, doubt = _ranges(rows, column)
        data = rows.loc[~rows["source"].str.contains("axis range"), column].dropna()
        low, high = (ends.min(), ends.max()) if len(ends) else (min(0.0, data.min()), data.max())
        wide = min(low, data.min()), max(high, data.max(), low + 1e-9)
        margin = 0.05 * (wide[1] - wide[0])
        on_the_axis = data.min() <= low + 0.2 * margin  # so that it does not cut the points
        set_limits(
            wide[0] - (margin if wide[0] < low else 0.4 * margin * on_the_axis),
            high if wide[1] == high and len(ends) else wide[1] + margin,
        )
        box.append(Range(low, high, wide != (low, high) and len(ends) > 0, doubt))
    if any(each.left or each.uncertain for each in box):
        thesis_box(ax, *box)


def together(frame: DataFrame, columns: Sequence[str]) -> DataFrame:
    """The frame with the simulated values of all columns in the first: an axis then holds them
    all.
    """
    first, *others = columns
    own = simulated(frame)
    copies = [own.assign(**{first: own[other]}) for other in others]
    return pd.concat([frame, *copies], ignore_index=True) if copies else frame


# --- the surface above ----------------------------------------------------------------------------


def solid(ax: Axes, x: Series, y: Series, top: float, **look: object) -> None:
    """A solid from its lower side up to a height: pale, its lower side as a line."""
    ax.fill_between(x, y, np.maximum(y, top), color=style.PALE, lw=0)
    ax.plot(x, y, **look)


def shape_of(frame: DataFrame) -> DataFrame:
    """The rows that hold the shape of the stroked surface."""
    return frame[frame["source"].str.endswith("shape of the stimulus")]


def draw_surface(ax: Axes, frame: DataFrame) -> None:
    """The surface, solid above, with the curvature of each convexity."""
    rows = shape_of(frame)
    x, y = rows[DISTANCE].to_numpy(), rows[HEIGHT].to_numpy()
    top = y.max() + 0.35
    solid(ax, x, y, top, color=style.INK, lw=0.9)
    ax.set(xlim=(x[0], x[-1]), ylim=(y.min() - 0.1, top), yticks=[-0.4, 0], ylabel="height\n(mm)")
    ax.tick_params(labelbottom=False)
    piece = (rows[CURVATURE].diff() != 0).cumsum()
    pieces = rows.groupby(piece).agg({DISTANCE: ["first", "last", "size"], CURVATURE: "first"})
    pieces.columns = ["start", "end", "size", "curvature"]
    pieces = pieces[(pieces["curvature"] > 0) & (pieces["size"] > 2)]
    room = 0.034 * (x[-1] - x[0])
    cut_off = (pieces["end"] == x[-1]) & (pieces["end"] - pieces["start"] < room)
    pieces = pieces[~cut_off]
    middles = (pieces["start"] + pieces["end"]) / 2
    places = style.spread(middles, room, x[0] + room / 2, x[-1] - room / 2)
    units = [" 1/m", *[""] * len(pieces)]
    for place, curvature, unit in zip(places, pieces["curvature"], units, strict=False):
        ax.text(place, top - 0.06, f"{curvature:.0f}{unit}", ha="center", va="top", fontsize=6)


def below_surface(fig: Figure, frame: DataFrame, count: int, along: bool = True) -> list[Axes]:
    """The surface above and so many panels below it, which are returned; `along`: they share its
    distances.
    """
    ratios = [0.55 if count == 1 else 0.7, *[3.0 / count] * count]
    top, *below = fig.subplots(1 + count, 1, sharex=along, height_ratios=ratios)
    draw_surface(top, frame)
    if not along:
        top.set_xticks([])
    return below

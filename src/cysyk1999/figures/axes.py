"""Axes of the thesis: where its range ends, what is shaded beyond it, what the note under a picture
says.

Pictures are made from a frame whose rows say by their `source` what they are: simulated, a thesis's
axis range, measured.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from cysyk1999.measures.errors import PARTS, SHOWN_ABOVE, norm, total
from cysyk1999.measures.quantities import CURVATURE, DISTANCE, HEIGHT
from cysyk1999.publishing import style
from fingerpad.measures.features import PHASES, STEADY, TOP, is_simulated

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

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
    if speed != name and speed in style.SPEED_COLOURS:
        return style.look_of("speed (mm/s)", speed)
    return style.look_of("curvature (1/m)", name) if name in style.COLOURS else {}


OTHER_PADS = "other model (pads"
"""How the source of a row of other pads begins."""


def rows_of(frame: pd.DataFrame, column: str, value: object) -> pd.DataFrame:
    """Rows of one panel or trace, and the range rows that belong to every panel."""
    return frame[(frame[column] == value) | (frame[column].isna() & ~is_simulated(frame))]


# --- notes -----------------------------------------------------------------------------------------------


def footnote(
    frame: pd.DataFrame, how: str = "", width: int = style.NOTE_WIDTH, lines: Lines = ()
) -> list[str]:
    """What a picture shows: simulated or predicted, with which errors, from which strain energy.

    `how` errors are taken, or of which `lines` through points they are (:func:`error_text`), is
    said as well.
    """
    own = frame[is_simulated(frame)]
    shown = [column for column in own if own[column].notna().any()]
    predicted = any(
        "(impulses/s)" in c or c.startswith(("burst_", "impulse_time", "trial")) for c in shown
    )
    error = error_text(frame, lines)
    energy = predicted or any(c.startswith("strain_energy") for c in shown)
    of = " from strain energy" if predicted else ""
    meant = (
        (" on instantaneous moduli" if predicted else "; strain energy on instantaneous moduli")
        if energy
        else ""
    )
    first = (
        f"Predicted by Eq 5-1{of}{meant}, not measured"
        if predicted
        else f"Simulated, not measured{meant}"
    )
    if width < style.NOTE_WIDTH / 2:  # of a column
        first = "Predicted by Eq 5-1, not measured" if predicted else "Simulated, not measured"
        error = error.replace("Largest error", "Error")
    line = ". ".join(filter(None, (first, error)))
    if error and how and len(line) + len(how) + 4 <= width:
        line += f" ({how})"
    if frame["source"].str.startswith(OTHER_PADS).any():
        words = ". Faint bars: other pads that the thesis's figures do not tell from this one"
        line = line if len(line) + 19 <= width else line.replace(f"{of}{meant}", "")
        line += words if len(line) + len(words) < width else ". Bars: other pads"
    return style.wrapped([line + "."], width)


Lines = Sequence[tuple[str, str]]
"""Lines that points are joined to: the columns that name them and that hold what they show."""


def of_lines(frame: pd.DataFrame, lines: Lines) -> pd.DataFrame:
    """The errors of lines through points, one row a line: r.m.s. of what its points are wrong by,
    over that of their values.

    NaN in a part that is not known of one of its points; points of which none is known do not
    count.
    """
    found = []
    for named, shown in lines:
        for _, rows in (
            frame.dropna(subset=[shown]).dropna(subset=list(PARTS), how="all").groupby(named)
        ):
            size = rows[shown].to_numpy(float)
            off = np.linalg.norm(rows[list(PARTS)].to_numpy(float) * size[:, None], axis=0)
            found.append(off / (np.linalg.norm(size) or np.inf))
    return pd.DataFrame(found, columns=list(PARTS))


def error_text(frame: pd.DataFrame, lines: Lines = ()) -> str:
    """``Largest error: mesh 1.2 %, steps 0.3 %, sampling 0.1 %`` of the curve or point that is
    furthest off, with its surface where that stands out, and ``not known`` where only that of the
    mesh is not; nothing where none is known. Where points are joined to `lines` it is that of a
    line.
    """
    if lines:
        return error_text(of_lines(frame, lines)).replace(
            "Largest error", "Largest error of a line"
        )
    sums = total(frame)
    if not sums.notna().any():
        return ""

    def shown(value: float) -> str:
        return f"{value:.1f} %" if value >= 0.05 or value == 0 else "<0.1 %"

    mesh, steps, sampling = frame.loc[sums.idxmax(), list(PARTS)]
    words = zip(("mesh", "steps", "sampling"), (mesh, steps, sampling), strict=True)
    said = ", ".join(f"{word} {shown(value)}" for word, value in words if value == value)
    if mesh != mesh and steps == steps:  # a mesh of the user's own
        said = f"mesh not known, {said}"
    of = ""
    if "surface" in frame:
        worst = sums.groupby(frame["surface"]).max().sort_values(ascending=False)
        if len(worst) > 1 and worst.iloc[0] > max(2 * worst.iloc[1], SHOWN_ABOVE):
            of = f" of {surface_name(worst.index[0])}"
    return f"Largest error{of}: {said}"


def statement_row(
    ids: str, words: str, condition: str, verdict: str, number: str, detail: str
) -> dict[str, str]:
    """A row that holds what the thesis says of a figure, and how it is here: for a figure's
    frame.
    """
    return {
        "source": f"{STATEMENT}{ids}): " + " | ".join((words, condition, verdict, number, detail))
    }


def statement(frame: pd.DataFrame, width: int = style.NOTE_WIDTH) -> list[str]:
    """``Thesis: ... Here: holds / fails (number).``, as long as a line allows; nothing without such
    a row.
    """
    rows = frame["source"].astype(str)
    if not (found := rows[rows.str.startswith(STATEMENT)].tolist()):
        return []
    room = width if width > style.NOTE_WIDTH / 2 else 2 * width - 8  # of a column two lines
    words, condition, verdict, number, detail = _typeset(found[0]).partition("): ")[2].split(" | ")
    for of, why in ((condition, detail), ("", detail), (condition, number), ("", number), ("", "")):
        told = f"; {why}" if "(" in why else why and f" ({why})"
        line = f"Thesis: {words}{of and f' ({of})'}. Here: {verdict}{told}."
        if len(line) <= room:
            break
    count = found[0].partition("; ")[2].partition(" hold): ")[0]
    if count and not count.endswith(" of 1") and len(line) + 38 <= room:
        line += f" In all {count} such statements hold."
    return style.wrapped([line], width)


def _typeset(text: str) -> str:
    """With a minus before negative numbers, a space before a percent sign and the square of R²."""
    return re.sub(r"(?<=\d)%", " %", re.sub(r"(?<![\w.])-(?=\d)", "−", text)).replace("R2 ", "R² ")


# --- curves ----------------------------------------------------------------------------------------------


def curve(
    ax: Axes,
    rows: pd.DataFrame,
    x: str,
    y: str,
    points: bool = False,
    whole: pd.DataFrame | None = None,
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
    known, all_of = total(rows), (rows if whole is None else whole).dropna(subset=[x, y])
    if known.max() > SHOWN_ABOVE and len(all_of):
        half = known.max() / 100 * norm(*(all_of[q].to_numpy(float) for q in (x, y)))
        faint = {
            "color": line.get_color(),
            "alpha": 0.18,
            "lw": 0,
            "zorder": line.get_zorder() - 0.5,
        }
        ax.fill_between(rows[x], rows[y] - half, rows[y] + half, **faint)
    return line


def bars(
    ax: Axes,
    rows: pd.DataFrame,
    x: str,
    y: str,
    sizes: pd.Series | float,
    colour: object = style.INK,
) -> None:
    """Bars of the errors of points where they are above 2 % of `sizes`, in their unit."""
    known = total(rows)
    far = known > SHOWN_ABOVE
    if far.any():
        half = (known / 100 * sizes)[far]
        ax.errorbar(
            rows[x][far], rows[y][far], half, fmt="none", ecolor=colour, elinewidth=0.7, zorder=1
        )


# --- limits ----------------------------------------------------------------------------------------------


def limit_axis(
    ax: Axes,
    frame: pd.DataFrame,
    column: str,
    axis: str = "y",
    text: bool = True,
    marked: bool = True,
) -> None:
    """Set one axis to the thesis's range found in `frame` and extend it only if simulated data
    leave it.

    Where it must be extended, the thesis's range is shaded and, with `text`, labelled (one of
    several alike panels needs it). Without a range in the frame the axis is left to the data. An
    uncertain reading has a broken bracket. Not `marked`: the limits alone.
    """
    found = _set_limits(ax, frame, column, axis)
    if marked:
        _mark(ax, **{axis: found}, text=text)


def limit_axes(ax: Axes, frame: pd.DataFrame, x: str, y: str, text: bool = True) -> None:
    """Set both axes as `limit_axis` does; where both are extended, what the thesis shows is one
    rectangle.
    """
    _mark(ax, _set_limits(ax, frame, x, "x"), _set_limits(ax, frame, y, "y"), text)


@dataclass(frozen=True)
class Range:
    """What the thesis's axis shows, in data units: whether the data leave it, and whether its
    reading is uncertain.
    """

    low: float
    high: float
    left: bool
    uncertain: bool


def draw_bands(
    ax: Axes,
    rows: pd.DataFrame,
    x: str | None,
    y: str | None,
    place: Callable[[pd.Series], float],
    width: float = 4.0,
) -> None:
    """What other pads show that the thesis's figures do not tell apart (`Data.bands`): a bar from
    the lowest to the highest.

    One of `x` and `y` is the column of the bars' ends, the other is None: there ``place(first row
    of a bar)`` is where it lies.
    """
    found = rows[rows["source"].astype(str).str.startswith(OTHER_PADS)]
    for k in range(0, len(found), 2):
        low, high = found.iloc[k : k + 2][x or y]
        at = place(found.iloc[k])
        draw = ax.hlines if x else ax.vlines
        draw(
            at,
            low,
            high,
            lw=width,
            color=look(found.iloc[k]["surface"])["color"],
            alpha=0.35,
            capstyle="butt",
            zorder=1.5,
        )


def together(frame: pd.DataFrame, columns: Sequence[str]) -> pd.DataFrame:
    """The frame with the simulated values of all columns in the first: an axis then holds them
    all.
    """
    first, *others = columns
    own = frame[is_simulated(frame)]
    return (
        pd.concat(
            [frame, *(own.assign(**{first: own[other]}) for other in others)], ignore_index=True
        )
        if others
        else frame
    )


def _set_limits(ax: Axes, frame: pd.DataFrame, column: str, axis: str) -> Range | None:
    """Set the limits of one axis; the thesis's range if the data leave it or its reading is
    uncertain.
    """
    ranges = (
        ~is_simulated(frame) & frame["source"].str.contains("axis range") & frame[column].notna()
    )
    values = frame.loc[ranges, column]
    doubt = bool(frame.loc[ranges, "source"].str.contains("uncertain").any())
    data = frame.loc[
        is_simulated(frame) | frame["source"].str.startswith("measured"), column
    ].dropna()
    set_limits = ax.set_ylim if axis == "y" else ax.set_xlim
    if values.empty:
        if axis == "y" and not data.empty:
            set_limits(min(0.0, data.min()), data.max() * 1.06)
        return None
    low, high = values.min(), values.max()
    if (
        axis == "x" and not data.empty and low < 0 and data.abs().max() > high
    ):  # a profile wider than the axis
        set_limits(-data.abs().max() * 1.04, data.abs().max() * 1.04)
        return Range(low, high, True, doubt)
    slack = 1e-3 * (high - low)
    free = axis == "y" and not data.empty
    below, above = (
        free and low < 0 and data.min() < low - slack,
        free and data.max() > high + slack,
    )  # an axis from 0 starts there
    set_limits(
        data.min() - 0.06 * (high - data.min()) if below else low,
        data.max() + 0.06 * (data.max() - low) if above else high,
    )
    return (
        Range(low, high, below or above, doubt)
        if below or above or (doubt and axis == "y")
        else None
    )


def _mark(ax: Axes, x: Range | None = None, y: Range | None = None, text: bool = True) -> None:
    """Shade the thesis's range where an axis goes beyond it, with a bracket beside a vertical
    one.
    """
    if x and y and x.left and y.left:
        thesis_box(ax, (x.low, x.high), (y.low, y.high), x.uncertain or y.uncertain)
    elif x and x.left:
        ax.axvspan(x.low, x.high, **_band(x.uncertain))
    elif y and y.left:
        ax.axhspan(y.low, y.high, **_band(y.uncertain))
    if y:
        bracket = {"xycoords": ("axes fraction", "data"), "textcoords": ("axes fraction", "data")}
        line = {
            "arrowstyle": "|-|,widthA=.2,widthB=.2",
            "color": style.GREY,
            "lw": 0.7,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        line["ls"] = (0, (2, 2)) if y.uncertain else "-"
        ax.annotate("", (1.02, y.low), (1.02, y.high), arrowprops=line, **bracket)
        words = "thesis axis,\nuncertain" if y.uncertain else "thesis axis\nrange"
        says = {
            "rotation": 90 if text else 0,
            "ha": "left",
            "va": "center",
            "multialignment": "center",
            "linespacing": 1.0,
        }
        ax.annotate(
            words if text else "?" * y.uncertain,
            (1.03, (y.low + y.high) / 2),
            xycoords=("axes fraction", "data"),
            fontsize=6,
            color=style.GREY,
            **says,
        )


def _band(uncertain: bool) -> dict[str, object]:
    """How the thesis's range is shaded: an uncertain one is hatched."""
    plain = {"lw": 0, "zorder": 0}
    return plain | (
        {"fc": "white", "ec": "0.9", "hatch": "///"} if uncertain else {"color": style.BAND}
    )


def thesis_box(ax: Axes, x: tuple[float, float], y: tuple[float, float], uncertain: bool) -> None:
    """What the thesis's axes show as a rectangle; hatched, with a question mark, if a reading of
    them is uncertain.
    """
    from matplotlib.patches import Rectangle

    ax.add_patch(Rectangle((x[0], y[0]), x[1] - x[0], y[1] - y[0], **_band(uncertain)))
    if uncertain:
        ax.annotate(
            "?",
            (x[1], y[1]),
            (-2, -2),
            textcoords="offset points",
            ha="right",
            va="top",
            fontsize=6.5,
            color=style.GREY,
        )


def wide_limits(ax: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """Axes of the thesis's ranges, and of the data where they leave them at either end; what the
    thesis shows is then shaded.
    """
    box, doubt = [], False
    for column, set_limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
        marks = rows["source"].str.contains("axis range") & rows[column].notna()
        ranges = rows.loc[~is_simulated(rows) & marks, column]
        doubt |= bool(rows.loc[marks, "source"].str.contains("uncertain").any())
        data = rows.loc[~rows["source"].str.contains("axis range"), column].dropna()
        low, high = (
            (ranges.min(), ranges.max()) if len(ranges) else (min(0.0, data.min()), data.max())
        )
        wide = min(low, data.min()), max(high, data.max(), low + 1e-9)
        margin = 0.05 * (wide[1] - wide[0])
        on_the_axis = data.min() <= low + 0.2 * margin  # so that it does not cut the points
        set_limits(
            wide[0] - (margin if wide[0] < low else 0.4 * margin * on_the_axis),
            high if wide[1] == high and len(ranges) else wide[1] + margin,
        )
        box.append((low, high, wide != (low, high) and len(ranges) > 0))
    if (doubt or any(beyond for *_, beyond in box)) and all(
        len(rows[column].dropna()) for column in (x, y)
    ):
        (left, right, _), (bottom, top, _) = box
        thesis_box(ax, (left, right), (bottom, top), doubt)


def leave_room_for_brackets(fig: Figure) -> None:
    """Narrow the panels by what the brackets beside extended axes take, which the layout does not
    see.
    """
    engine = fig.get_layout_engine()
    x, y, width, height = engine.get()["rect"]
    engine.set(rect=(x, y, width - 0.02, height))


# --- the surface above -----------------------------------------------------------------------------------


def shape_of(frame: pd.DataFrame) -> pd.DataFrame:
    """The rows that hold the shape of the stroked surface."""
    return frame[frame["source"].str.endswith("shape of the stimulus")]


def draw_surface(ax: Axes, frame: pd.DataFrame) -> None:
    """The surface, solid above, with the curvature of each convexity."""
    rows = shape_of(frame)
    x, y = rows[DISTANCE].to_numpy(), rows[HEIGHT].to_numpy()
    top = y.max() + 0.35
    ax.fill_between(x, y, top, color=style.PALE, lw=0)
    ax.plot(x, y, color=style.INK, lw=0.9)
    ax.set(xlim=(x[0], x[-1]), ylim=(y.min() - 0.1, top), yticks=[-0.4, 0])
    ax.tick_params(labelbottom=False)
    ax.set_ylabel("height\n(mm)")
    runs = [
        run
        for _, run in rows.groupby((rows[CURVATURE].diff() != 0).cumsum())
        if run[CURVATURE].iloc[0] > 0 and len(run) > 2
    ]
    room = 0.034 * (x[-1] - x[0])
    if (
        x[-1] in runs[-1][DISTANCE].to_numpy() and np.ptp(runs[-1][DISTANCE]) < room
    ):  # cut off by the picture's end
        runs.pop()
    places = [(run[DISTANCE].iloc[0] + run[DISTANCE].iloc[-1]) / 2 for run in runs]
    units = [" 1/m", *[""] * (len(runs) - 1)]
    for run, unit, place in zip(
        runs, units, style.spread(places, room, x[0] + room / 2, x[-1] - room / 2), strict=True
    ):
        ax.text(
            place,
            top - 0.06,
            f"{run[CURVATURE].iloc[0]:.0f}{unit}",
            ha="center",
            va="top",
            fontsize=6,
        )


def below_surface(fig: Figure, frame: pd.DataFrame, count: int, along: bool = True) -> list[Axes]:
    """The surface above and so many panels below it, which are returned; `along`: they share its
    distances.
    """
    ratios = [0.55 if count == 1 else 0.7, *[3.0 / count] * count]
    top, *below = fig.subplots(1 + count, 1, sharex=along, height_ratios=ratios)
    draw_surface(top, frame)
    if not along:
        top.set_xticks([])
    return below

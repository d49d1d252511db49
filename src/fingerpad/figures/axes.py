"""Axes of the thesis: where its range ends, what is shaded beyond it, what the note under a picture says.

Pictures are made from a frame whose rows say by their `source` what they are: simulated, a thesis's axis range, measured.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from fingerpad.measures.features import ERROR, PHASES, STEADY, TOP, is_simulated
from fingerpad.measures.quantities import CURVATURE, DISTANCE, HEIGHT
from fingerpad.publishing import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PHASE_LINES = {
    PHASES[0]: {"linestyle": (0, (1, 1.6)), "linewidth": 1.0},
    TOP: {"linestyle": (0, (4, 1.8)), "linewidth": 1.9},
    STEADY: {"linestyle": "-", "linewidth": 1.4},
}
SURFACE = "surface"
"""Panel of the rows that hold the shape of a stroked surface."""


def surface_name(label: str) -> str:
    """Title of a surface: ``flat plate`` or ``K = 79 1/m``."""
    return "flat plate" if label == "flat" else f"K = {label} 1/m"


def look(name: str) -> dict[str, object]:
    """Colour of a surface (``210``) or a velocity (``10 mm/s``); of anything else none."""
    speed = name.removesuffix(" mm/s")
    colour = style.COLOURS.get(name) or (style.SPEED_COLOURS.get(speed) if speed != name else None)
    return {"color": colour} if colour else {}


def rows_of(frame: pd.DataFrame, column: str, value: object) -> pd.DataFrame:
    """Rows of one panel or trace, and the range rows that belong to every panel."""
    return frame[(frame[column] == value) | (frame[column].isna() & ~is_simulated(frame))]


# --- notes -----------------------------------------------------------------------------------------------


def footnote(frame: pd.DataFrame, how: str = "") -> list[str]:
    """Lines under a picture: provenance, discretisation error (and `how` it is taken), and how thesis values are marked."""
    first = "Simulated in plane strain, not measured."
    if frame[ERROR].notna().any():
        error = f"Discretisation error {_error_text(frame)}{how and f' ({how})'}"
        first += f" {error}: difference to a mesh of up to twice the edge and half the time steps."
    lines = [first]
    if frame.loc[~is_simulated(frame), "source"].str.contains("axis range").any():
        lines.append(
            "Axes end where those of Cysyk (1999) end; a grey band marks the thesis's axis range where the simulation needs more."
        )
    return style.wrapped(lines)


def _error_text(frame: pd.DataFrame) -> str:
    """``≤ 1.2 %``; where one surface stands out, ``≤ 6.8 % for K = 1260 1/m, ≤ 1.9 % otherwise``."""

    def shown(value: float) -> str:
        return f"≤ {value:.1f} %" if value >= 0.1 else f"≤ {value:.1g} %"

    if "surface" in frame:
        worst = frame.groupby("surface")[ERROR].max().sort_values(ascending=False)
        if len(worst) > 1 and worst.iloc[0] > 2 * worst.iloc[1]:
            first, second = (shown(value) for value in worst.iloc[:2])
            return f"{first} for {surface_name(worst.index[0])}, {second} otherwise"
    return shown(frame[ERROR].max())


# --- limits ----------------------------------------------------------------------------------------------


def limit_axis(ax: Axes, frame: pd.DataFrame, column: str, axis: str = "y", text: bool = True) -> None:
    """Set one axis to the thesis's range found in `frame` and extend it only if simulated data leave it.

    Where it must be extended, the thesis's range is shaded and, with `text`, labelled (one of several alike panels
    needs it). Without a range in the frame the axis is left to the data.
    """
    _mark(ax, **{axis: _set_limits(ax, frame, column, axis)}, text=text)


def limit_axes(ax: Axes, frame: pd.DataFrame, x: str, y: str, text: bool = True) -> None:
    """Set both axes as `limit_axis` does; where both are extended, what the thesis shows is one rectangle."""
    _mark(ax, _set_limits(ax, frame, x, "x"), _set_limits(ax, frame, y, "y"), text)


def together(frame: pd.DataFrame, columns: Sequence[str]) -> pd.DataFrame:
    """The frame with the simulated values of all columns in the first: an axis then holds them all."""
    first, *others = columns
    own = frame[is_simulated(frame)]
    return pd.concat([frame, *(own.assign(**{first: own[other]}) for other in others)], ignore_index=True) if others else frame


def _set_limits(ax: Axes, frame: pd.DataFrame, column: str, axis: str) -> tuple[float, float] | None:
    """Set the limits of one axis; the thesis's range if the data leave it."""
    ranges = ~is_simulated(frame) & frame["source"].str.contains("axis range")
    values = frame.loc[ranges, column].dropna()
    data = frame.loc[is_simulated(frame) | frame["source"].str.startswith("measured"), column].dropna()
    set_limits = ax.set_ylim if axis == "y" else ax.set_xlim
    if values.empty:
        if axis == "y" and not data.empty:
            set_limits(min(0.0, data.min()), data.max() * 1.06)
        return None
    low, high = values.min(), values.max()
    if axis == "x" and not data.empty and low < 0 and data.abs().max() > high:  # a profile wider than the axis
        set_limits(-data.abs().max() * 1.04, data.abs().max() * 1.04)
        return low, high
    slack = 1e-3 * (high - low)
    free = axis == "y" and not data.empty
    below, above = (
        free and low < 0 and data.min() < low - slack,
        free and data.max() > high + slack,
    )  # an axis from 0 starts there
    set_limits(
        data.min() - 0.06 * (high - data.min()) if below else low, data.max() + 0.06 * (data.max() - low) if above else high
    )
    return (low, high) if below or above else None


def _mark(ax: Axes, x: tuple[float, float] | None = None, y: tuple[float, float] | None = None, text: bool = True) -> None:
    """Shade the thesis's range where an axis goes beyond it, with a bracket beside a vertical one."""
    from matplotlib.patches import Rectangle

    band = {"color": style.BAND, "lw": 0, "zorder": 0}
    if x and y:
        ax.add_patch(Rectangle((x[0], y[0]), x[1] - x[0], y[1] - y[0], **band))
    elif x:
        ax.axvspan(*x, **band)
    elif y:
        ax.axhspan(*y, **band)
    if y:
        bracket = {"xycoords": ("axes fraction", "data"), "textcoords": ("axes fraction", "data")}
        line = {"arrowstyle": "|-|,widthA=.2,widthB=.2", "color": style.GREY, "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (1.02, y[0]), (1.02, y[1]), arrowprops=line, **bracket)
    if y and text:
        ax.annotate("thesis axis range", (1.03, sum(y) / 2), xycoords=("axes fraction", "data"), rotation=90,
                    ha="left", va="center", fontsize=6, color=style.GREY)  # fmt: skip


def wide_limits(ax: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """Axes of the thesis's ranges, and of the data where they leave them at either end; what the thesis shows is then shaded."""
    from matplotlib.patches import Rectangle

    box = []
    for column, set_limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
        ranges = rows.loc[~is_simulated(rows) & rows["source"].str.contains("axis range"), column].dropna()
        data = rows.loc[~rows["source"].str.contains("axis range"), column].dropna()
        low, high = (ranges.min(), ranges.max()) if len(ranges) else (min(0.0, data.min()), data.max())
        wide = min(low, data.min()), max(high, data.max(), low + 1e-9)
        margin = 0.05 * (wide[1] - wide[0])
        set_limits(low if wide[0] == low else wide[0] - margin, high if wide[1] == high and len(ranges) else wide[1] + margin)
        box.append((low, high, wide != (low, high) and len(ranges) > 0))
    if any(beyond for *_, beyond in box) and all(len(rows[column].dropna()) for column in (x, y)):
        (left, right, _), (bottom, top, _) = box
        ax.add_patch(Rectangle((left, bottom), right - left, top - bottom, color=style.BAND, lw=0, zorder=0))


def leave_room_for_brackets(fig: Figure) -> None:
    """Narrow the panels by what the brackets beside extended axes take, which the layout does not see."""
    engine = fig.get_layout_engine()
    x, y, width, height = engine.get()["rect"]
    engine.set(rect=(x, y, width - 0.02, height))


# --- the surface above -----------------------------------------------------------------------------------


def shape_of(frame: pd.DataFrame) -> pd.DataFrame:
    """The rows that hold the shape of the stroked surface."""
    return frame[frame["source"].str.endswith("shape of the stimulus")]


def draw_surface(ax: Axes, frame: pd.DataFrame) -> None:
    """The surface, solid above, with the curvature of each convexity in 1/m."""
    rows = shape_of(frame)
    x, y = rows[DISTANCE].to_numpy(), rows[HEIGHT].to_numpy()
    top = y.max() + 0.35
    ax.fill_between(x, y, top, color="0.87", lw=0)
    ax.plot(x, y, color=style.INK, lw=1.0)
    ax.set(xlim=(x[0], x[-1]), ylim=(y.min() - 0.1, top), yticks=[-0.4, 0])
    ax.tick_params(labelbottom=False)
    ax.set_ylabel("mm")
    runs = [run for _, run in rows.groupby((rows[CURVATURE].diff() != 0).cumsum()) if run[CURVATURE].iloc[0] > 0 and len(run) > 2]
    room = 0.034 * (x[-1] - x[0])
    if x[-1] in runs[-1][DISTANCE].to_numpy() and np.ptp(runs[-1][DISTANCE]) < room:  # cut off by the picture's end
        runs.pop()
    places = [(run[DISTANCE].iloc[0] + run[DISTANCE].iloc[-1]) / 2 for run in runs]
    for run, place in zip(runs, style.spread(places, room, x[0] + room / 2, x[-1] - room / 2), strict=True):
        ax.text(place, top - 0.06, f"{run[CURVATURE].iloc[0]:.0f}", ha="center", va="top", fontsize=6.5)


def below_surface(fig: Figure, frame: pd.DataFrame, count: int, along: bool = True) -> list[Axes]:
    """The surface above and so many panels below it, which are returned; `along`: they share its distances."""
    ratios = [0.55 if count == 1 else 0.7, *[3.0 / count] * count]
    top, *below = fig.subplots(1 + count, 1, sharex=along, height_ratios=ratios)
    draw_surface(top, frame)
    if not along:
        top.set_xticks([])
    return below

"""One style for every figure: page-width pictures, one colour map for curvature, a line style a phase.

Colours of the surfaces come from one perceptually uniform, colour-blind-safe sequential map; the phases of an
indentation are told apart by line style alone, as in the thesis, so every figure also reads in grey.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from fingerpad.measures.features import ERROR, PHASES, STEADY, SURFACES, TOP, is_simulated

PAGE_WIDTH = 7.0  # inch, the text width of an A4 page
NOTE_WIDTH = 142  # characters of a footnote's line
GREY = "0.45"
BAND = "0.955"
INK = "0.15"

RC = {
    "font.family": "DejaVu Sans",
    "font.size": 8.5,
    "axes.titlesize": 8.5,
    "axes.labelsize": 8.5,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.linewidth": 0.7,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.titlelocation": "left",
    "axes.titlepad": 4,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "axes.formatter.use_mathtext": True,
    "axes.formatter.limits": (-4, 5),
}

_MAP = mpl.colormaps["plasma"]
COLOURS = {label: _MAP(x) for label, x in zip(SURFACES, np.linspace(0.0, 0.78, len(SURFACES)), strict=True)}

PHASE_LINES = {
    "during ramp": {"linestyle": (0, (1, 1.6)), "linewidth": 1.0},
    TOP: {"linestyle": (0, (4, 1.8)), "linewidth": 1.9},
    STEADY: {"linestyle": "-", "linewidth": 1.4},
}

LAYER_COLOURS = {
    "stratum corneum": "#8c6d52",
    "epidermis": "#c49a78",
    "dermis": "#e3b7a8",
    "fat": "#f6e7c4",
    "bone": "#b9bec4",
}


def styled(draw: Callable[[pd.DataFrame], Figure]) -> Callable[[pd.DataFrame], Figure]:
    """Run a drawing function under the shared style, whatever the caller's matplotlib settings are."""

    @wraps(draw)
    def inner(frame: pd.DataFrame) -> Figure:
        with theme():
            return draw(frame)

    return inner


@contextmanager
def theme() -> Iterator[None]:
    """Matplotlib's own defaults with this style on top; the caller's settings come back afterwards."""
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(RC)
        yield


def surface_name(label: str) -> str:
    """Panel title of a surface: ``flat plate`` or ``K = 79 1/m``."""
    return "flat plate" if label == "flat" else f"K = {label} 1/m"


def new_figure(
    frame: pd.DataFrame,
    number: str,
    title: str,
    height: float,
    note: list[str] | None = None,
    header: float = 0.0,
) -> Figure:
    """Empty page-wide figure of a height (inch), title line above, provenance and error note below.

    `header` (inch) leaves room under the title. The note is taken from the frame, so that a picture drawn
    from a saved CSV says the same.
    """
    width = PAGE_WIDTH
    fig = Figure(figsize=(width, height), layout="constrained")
    lines = note or footnote(frame)
    top, bottom = (0.30 + header) / height, (0.16 * len(lines) + 0.08) / height
    fig.get_layout_engine().set(rect=(0.005, bottom, 0.99, 1 - top - bottom), w_pad=0.04, h_pad=0.04, hspace=0.04)
    fig.text(0.012, 1 - 0.09 / height, f"Fig. {number}", ha="left", va="top", fontweight="bold", fontsize=9.5)
    fig.text(0.012 + 0.82 / width, 1 - 0.09 / height, title, ha="left", va="top", fontsize=9.5)
    fig.text(
        0.012,
        0.06 / height,
        "\n".join(lines),
        ha="left",
        va="bottom",
        fontsize=7,
        color=GREY,
        linespacing=1.35,
    )
    return fig


def study_figure(title: str, note: Sequence[str], height: float, header: float = 0.0) -> Figure:
    """Empty page-wide figure of a study, height in inch: a bold title above, the note's paragraphs wrapped below.

    `header` (inch) leaves room under the title.
    """
    fig = Figure(figsize=(PAGE_WIDTH, height), layout="constrained")
    lines = [part for line in note for part in textwrap.wrap(line, NOTE_WIDTH)]
    top, bottom = (0.30 + header) / height, (0.16 * len(lines) + 0.08) / height
    fig.get_layout_engine().set(rect=(0.005, bottom, 0.99, 1 - top - bottom), w_pad=0.05, h_pad=0.04)
    fig.text(0.012, 1 - 0.09 / height, title, ha="left", va="top", fontweight="bold", fontsize=9.5)
    fig.text(0.012, 0.06 / height, "\n".join(lines), ha="left", va="bottom", fontsize=7, color=GREY, linespacing=1.35)
    return fig


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
    return [part for line in lines for part in textwrap.wrap(line, NOTE_WIDTH)]


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


def limit_axis(ax: Axes, frame: pd.DataFrame, column: str, axis: str = "y", text: bool = True) -> None:
    """Set one axis to the thesis's range found in `frame` and extend it only if simulated data leave it.

    Where it must be extended, the thesis's range is shaded and, with `text`, labelled (one of several alike panels
    needs it). Without a range in the frame the axis is left to the data.
    """
    _mark(ax, **{axis: _set_limits(ax, frame, column, axis)}, text=text)


def limit_axes(ax: Axes, frame: pd.DataFrame, x: str, y: str) -> None:
    """Set both axes as `limit_axis` does; where both are extended, what the thesis shows is one rectangle."""
    _mark(ax, _set_limits(ax, frame, x, "x"), _set_limits(ax, frame, y, "y"))


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
    band = {"color": BAND, "lw": 0, "zorder": 0}
    if x and y:
        ax.add_patch(Rectangle((x[0], y[0]), x[1] - x[0], y[1] - y[0], **band))
    elif x:
        ax.axvspan(*x, **band)
    elif y:
        ax.axhspan(*y, **band)
    if y:
        bracket = {"xycoords": ("axes fraction", "data"), "textcoords": ("axes fraction", "data")}
        line = {"arrowstyle": "|-|,widthA=.2,widthB=.2", "color": GREY, "lw": 0.7, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (1.02, y[0]), (1.02, y[1]), arrowprops=line, **bracket)
    if y and text:
        ax.annotate("thesis axis range", (1.03, sum(y) / 2), xycoords=("axes fraction", "data"), rotation=90,
                    ha="left", va="center", fontsize=6, color=GREY)  # fmt: skip


def nine_panels(fig: Figure, labels: Sequence, xlabel: str, ylabel: str) -> dict[str, Axes]:
    """A 3 x 3 grid in the thesis's order (flat plate top left, sharpest bottom right), shared axis labels."""
    axes = fig.subplots(3, 3)
    axes[2, 1].set_xlabel(xlabel)
    axes[1, 0].set_ylabel(ylabel)
    return dict(zip(labels, axes.ravel(), strict=True))


def spread(values: Sequence[float], gap: float, low: float, high: float) -> np.ndarray:
    """Positions at least `gap` apart, in the order of `values` and closest to them (least squares).

    They stay within ``low .. high`` where there is room. Used to place direct labels. Ties keep their order.
    """
    from scipy.optimize import isotonic_regression  # here, for it is slow to import

    values = np.asarray(values, float)
    order = np.argsort(values, kind="stable")
    steps = gap * np.arange(len(values))
    shifted = isotonic_regression(values[order] - steps).x
    shifted = np.clip(shifted, low, max(low, high - steps[-1]))
    out = np.empty_like(values)
    out[order] = shifted + steps
    return out


def label_ends(ax: Axes, ends: dict[str, tuple[float, float]], x_label: float, heading: str = "") -> None:
    """Label each trace directly at `x_label` (data units), joined to its end by a hairline.

    `ends` maps a surface label to the (x, y) of the trace's last point. Axis limits must be set already.
    """
    low, high = ax.get_ylim()
    gap = (high - low) * 0.135 / _axes_height(ax)
    labels = list(ends)
    positions = spread([ends[k][1] for k in labels], gap, low + gap * 0.4, high - gap * (1.6 if heading else 0.5))
    for label, position in zip(labels, positions, strict=True):
        x, y = ends[label]
        ax.plot([x, x_label], [y, position], color=COLOURS[label], lw=0.6, alpha=0.7, clip_on=False)
        text = "flat plate" if label == "flat" else label
        ax.text(x_label, position, f" {text}", color=COLOURS[label], va="center", fontsize=8)
    if heading:
        ax.text(x_label, positions.max() + gap * 1.1, heading, va="center", ha="left", fontsize=7)


def _axes_height(ax: Axes) -> float:
    """Rough height of an axes in inch before the layout is solved."""
    spec = ax.get_subplotspec()
    ratios = spec.get_gridspec().get_height_ratios()
    rows = range(spec.rowspan.start, spec.rowspan.stop)
    share = sum(ratios[r] for r in rows) / sum(ratios)
    return max(0.5, (ax.figure.get_figheight() - 0.9) * share - 0.2)


def phase_legend(fig: Figure, phases: Sequence[str] = PHASES) -> None:
    """Legend of the phases' line styles, under the title."""
    header_legend(fig, [Line2D([], [], color=INK, label=p, **PHASE_LINES[p]) for p in phases])


def header_legend(fig: Figure, handles: Sequence[Line2D], **kwargs) -> None:
    """Legend in one row under the title, in the room that `new_figure` left by its `header`."""
    kwargs = {"handlelength": 2.6, "handletextpad": 0.4, "borderaxespad": 0.0} | kwargs
    place = {"loc": "upper left", "bbox_to_anchor": (0.012, 1 - 0.27 / fig.get_figheight())}
    fig.legend(handles=handles, ncols=len(handles), **place, **kwargs)

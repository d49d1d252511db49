"""One style for every picture: the page, its title and note, colours, line styles, labels that stay apart.

Colours of the surfaces come from one perceptually uniform, colour-blind-safe sequential map, those of velocities from another.
Matplotlib is imported when something is drawn: what only lists or describes pictures need not load it.
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import wraps
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

PAGE_WIDTH = 7.0  # inch, the text width of an A4 page
NOTE_WIDTH = 142  # characters of a footnote's line
GREY = "0.45"
BAND = "0.955"
INK = "0.15"

RC = {
    "font.family": "DejaVu Sans", "font.size": 8.5, "axes.titlesize": 8.5, "axes.labelsize": 8.5, "xtick.labelsize": 8,
    "ytick.labelsize": 8, "legend.fontsize": 8, "axes.edgecolor": INK, "axes.labelcolor": INK, "text.color": INK,
    "xtick.color": INK, "ytick.color": INK, "axes.linewidth": 0.7, "axes.spines.top": False, "axes.spines.right": False,
    "axes.titlelocation": "left", "axes.titlepad": 4, "xtick.major.width": 0.7, "ytick.major.width": 0.7,
    "lines.linewidth": 1.4, "lines.solid_capstyle": "round", "legend.frameon": False, "figure.facecolor": "white",
    "savefig.facecolor": "white", "axes.formatter.use_mathtext": True, "axes.formatter.limits": (-4, 5),
}  # fmt: skip

DASHED, DOTTED = (0, (4, 1.8)), (0, (1, 1.4))

COLOURS = {
    "flat": "#0d0887", "79": "#3f049c", "105": "#6700a8", "158": "#8d0ba5", "210": "#ad2793", "315": "#c8437b",
    "420": "#de5f65", "630": "#ef7e50", "1260": "#fb9f3a",
}  # fmt: skip
"""Of the nine surfaces, broad to sharp (matplotlib's plasma, 0 to 0.78)."""
SPEED_COLOURS = {"1": "#440154", "5": "#404588", "10": "#297a8e", "20": "#25ac82", "40": "#86d549"}
"""Of the stroking velocities in mm/s (viridis, 0 to 0.82)."""
SPEED_LINES = {"1": DOTTED, "5": (0, (3, 1, 1, 1)), "10": "-", "20": (0, (6, 1.5)), "40": (0, (3.5, 1.5))}
SHADES = ("#c8553d", "#1f77a4", "#3c8d5a", "#8a4fbf")
MARKERS = "os^D"
LAYER_COLOURS = {"stratum corneum": "#8c6d52", "epidermis": "#c49a78", "dermis": "#e3b7a8", "fat": "#f6e7c4", "bone": "#b9bec4"}


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
    import matplotlib as mpl

    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update(RC)
        yield


def colours(name: str, start: float, end: float, labels: Iterable[str]) -> dict[str, object]:
    """Labels in colours evenly spaced over a part of one of matplotlib's maps."""
    import matplotlib as mpl

    labels = list(labels)
    return dict(zip(labels, mpl.colormaps[name](np.linspace(start, end, len(labels))), strict=True))


def wrapped(lines: Iterable[str], width: int = NOTE_WIDTH) -> list[str]:
    """Paragraphs as lines of at most `width` characters."""
    return [part for line in lines for part in textwrap.wrap(line, width)]


def sheet(title: str, note: Sequence[str], height: float, number: str = "", header: float = 0.0, laid_out: bool = True) -> Figure:
    """Empty page-wide figure of a height (inch): title above, with the thesis's number if it has one, the note's lines below.

    `header` (inch) leaves room under the title. Panels are laid out in between, unless the caller does so (not `laid_out`).
    """
    from matplotlib.figure import Figure

    fig = Figure(figsize=(PAGE_WIDTH, height), layout="constrained" if laid_out else None)
    if laid_out:
        top, bottom = (0.30 + header) / height, (0.16 * len(note) + 0.08) / height
        pads = {"w_pad": 0.04, "hspace": 0.04} if number else {"w_pad": 0.05}
        fig.get_layout_engine().set(rect=(0.005, bottom, 0.99, 1 - top - bottom), h_pad=0.04, **pads)
    place = {"y": 1 - 0.09 / height, "ha": "left", "va": "top", "fontsize": 9.5}
    fig.text(0.012, s=f"Fig. {number}" if number else title, fontweight="bold", **place)
    if number:
        fig.text(0.012 + 0.82 / PAGE_WIDTH, s=title, **place)
    small = {"ha": "left", "va": "bottom", "fontsize": 7, "color": GREY, "linespacing": 1.35}
    fig.text(0.012, 0.06 / height, "\n".join(note), **small)
    return fig


def study_figure(title: str, note: Sequence[str], height: float, header: float = 0.0) -> Figure:
    """`sheet` of a study: a bold title, the note's paragraphs wrapped."""
    return sheet(title, wrapped(note), height, header=header)


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
    """Label the trace of each surface directly at `x_label` (data units), joined to its end by a hairline.

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


def handle(label: str, **look) -> Line2D:
    """An entry of a legend."""
    from matplotlib.lines import Line2D

    return Line2D([], [], label=label, **look)


def header_legend(fig: Figure, handles: Sequence[Line2D], **kwargs) -> None:
    """Legend in one row under the title, in the room that `sheet` left by its `header`."""
    kwargs = {"handlelength": 2.6, "handletextpad": 0.4, "borderaxespad": 0.0} | kwargs
    place = {"loc": "upper left", "bbox_to_anchor": (0.012, 1 - 0.27 / fig.get_figheight())}
    fig.legend(handles=handles, ncols=len(handles), **place, **kwargs)

"""Figure and table of the study of stability: measures by cases, one method below the other."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from cysyk1999.publishing.style import GREY, INK, PAGE_WIDTH, TALLEST, sheet, styled
from cysyk1999.publishing.tables import publish_table
from cysyk1999.publishing.write import publish
from cysyk1999.studies.stability.cases import DEFAULT, METHODS, TEACHING

MEASURES = {
    "completed": ("completed", "reached the end of the motion"),
    "cuts": ("step cuts", "times a load step had to be halved, in all"),
    "factorisations": ("factors a step", "matrices factorised, mean of the steps"),
    "effort": ("effort", "iterations a step over an easy neighbour's"),
    "balance": ("force balance", "what holds the pad less what pushes it"),
    "energy": ("energy balance", "work less stored and dissipated energy"),
    "complementarity": ("complementarity", "force times gap over force times node spacing"),
    "det_f": ("least det F", "least volume left; elements fold at 0"),
    "checkerboard": ("checkerboard", "pressure alternating from node to node"),
    "symmetry": ("mirror image", "a whole pad's skin less its mirror image"),
    "halving": ("half the step", "what half the step changes at ends of legs"),
    "solver": ("other solver", "what SuperLU changes, every sixth case"),
    "reference": ("true error", "to half the edges, over that of a draft"),
    "off": ("off this package", "difference of the last depth or force"),
}
"""Measure -> its name in the picture, and what it is. Checkerboard: r.m.s. of nodal pressure less
its 5-point average over the peak, inside the contact. Half the step: largest change of force,
depth, width, stored energy and tangential force at the ends of the legs.
"""
OF_TEACHING = [
    name
    for name in MEASURES
    if name not in ("effort", "balance", "symmetry", "halving", "solver", "reference")
]
"""What the teaching methods are shown by."""
OUTCOMES = {
    "stable": "stable",
    "labours": "right but laboured",
    "unsound": "outside limits",
    "wrong": "wrong",
    "admits its error": "wrong and said so",
    "fails cleanly": "stopped and said why",
    "breaks off": "broke off",
    "not done": "not done",
}
"""How runs end, and in words for many."""
OFF = 0.05
"""A method whose last depth or force is off the default's by more than this has not solved the
case.
"""


def assemble(studies: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Rows of all methods (of `cysyk1999.studies.stability.run.study`) with the column off, to the
    default's last state.
    """
    frame = pd.concat(studies).sort_values("number", kind="stable", ignore_index=True)
    states = ["depth_mm", "force_N_per_m"]
    default = frame[frame["method"] == DEFAULT].set_index("case")[states]
    theirs = default.loc[frame["case"]].to_numpy()
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = np.abs(frame[states].to_numpy() - theirs) / np.abs(theirs)
    apart[theirs == 0] = 0.0
    frame["off"] = apart.max(axis=1)
    unsure = frame.loc[(frame["method"] == DEFAULT) & (frame["outcome"] != "stable"), "case"]
    frame.loc[(frame["method"] == DEFAULT) | frame["case"].isin(unsure), "off"] = np.nan
    frame["limit off"] = OFF
    return frame


def long(frame: pd.DataFrame) -> pd.DataFrame:
    """One row a case, method and measure: value, limit, and the share of the limit that is used up
    (above 1: beyond it).
    """
    rows = []
    for row in frame[frame["outcome"] != "does not apply"].to_dict("records"):
        known = {key: row[key] for key in ("group", "case", "method")} | {"outcome": _outcome(row)}
        for name in MEASURES if row["method"] == DEFAULT else OF_TEACHING:
            value, limit = row.get(name, np.nan), row.get(f"limit {name}", np.nan)
            if name == "completed":
                limit, share = 1.0, 0.0 if value else np.inf
            elif name == "det_f":
                share = limit / max(value, 1e-9)
            elif np.isfinite(limit):
                share = value / max(limit, 0.5 if name == "cuts" else 1e-12)
            else:
                share = np.nan
            rows.append(known | {"measure": name, "value": value, "limit": limit, "share": share})
    return pd.DataFrame(rows)


def table(frame: pd.DataFrame) -> pd.DataFrame:
    """One row a case: hard, stable, what the default method did and measured, and how the other
    methods ended.

    The Markdown shows five columns of it: number, case, what makes it hard, how it ended, and what
    came nearest to its limit.
    """
    default = frame[frame["method"] == DEFAULT].set_index("case")
    out = default[["group", "hard", "stable", "outcome"]].rename(
        columns={"hard": "what makes it hard", "stable": "what counts as stable"}
    )
    for name in list(MEASURES)[1:-1]:
        out[MEASURES[name][0]] = default.get(name, np.nan)
    for method in TEACHING:
        rows = frame[frame["method"] == method].set_index("case").reindex(default.index)
        out[method] = [_ending(row) for row in rows.to_dict("records")]
    shares = long(frame[frame["method"] == DEFAULT]).set_index(["case", "measure"])["share"]
    out["nearest to its limit"] = [_nearest(shares[case]) for case in out.index]
    out.insert(4, "with remedies", default.get("ended", default["outcome"]))
    texts = {
        "healed": "what was relaxed",
        "message": "said",
        "saved": "last state saved",
    }
    for name, column in texts.items():
        out[column] = default.get(name, pd.Series("", default.index)).astype(object).fillna("")
    said = ": " + out["said"].where(out["said"] != "")
    mended = out["with remedies"] == "healed"
    healed = ("; healed: " + out["what was relaxed"]).where(mended, "")
    out["how it ended"] = out["outcome"] + said.fillna("") + healed
    out.insert(0, "case", out.index)
    out.insert(0, "no.", default["number"])
    shown = ["no.", "case", "what makes it hard", "how it ended", "nearest to its limit"]
    out.attrs["columns"] = shown
    return out


def _nearest(shares: pd.Series) -> str:
    """The measure that has used up most of its limit, and how much."""
    known = shares[np.isfinite(shares)]
    return f"{MEASURES[known.idxmax()][0]}: {known.max():.0%}" if len(known) else ""


def _outcome(row: dict) -> str:
    """How a run ended; wrong: where it should not."""
    return "wrong" if row["off"] > OFF else row["outcome"]


def _ending(row: dict) -> str:
    """How a teaching method ended, in a few words."""
    message = row["message"] if isinstance(row["message"], str) else ""
    if _outcome(row) == "wrong":
        message = message if row["outcome"] == "unsound" else ""
        return f"wrong: off by {row['off']:.0%}" + (message and f"; {message}")
    return str(row["outcome"]) + (message and f": {message}")


def tally(part: pd.DataFrame) -> list[str]:
    """How many cases of a method ended how; ``part``: its rows of :func:`long`."""
    ends = part.drop_duplicates("case")["outcome"].value_counts()
    texts = [f"{ends[outcome]} {text}" for outcome, text in OUTCOMES.items() if outcome in ends]
    return texts if "unsound" in ends or "wrong" in ends else [*texts, "none silent"]


# -- the picture ---

_LEFT, _RIGHT, _TOP, _BOTTOM = 1.0, 0.22, 1.3, 1.12  # inch beside the panels
_GAP = 0.17  # inch between them, where their titles stand


@styled
def heat_map(frame: pd.DataFrame) -> Figure:
    """Measures by cases for each method; colour tells how much of the limit is used up. ``frame``:
    of :func:`long`.
    """
    cases = frame.drop_duplicates("case").set_index("case")["group"]
    height, width = TALLEST, PAGE_WIDTH
    ends = ", ".join(tally(frame[frame["method"] == DEFAULT]))
    fig = sheet(f"{len(cases)} hard cases: {ends}", [], height, laid_out=False)
    picked = int((~cases.index.str.match(r"\d+: ")).sum())
    intro = (
        f"Simulated. Each of the {len(cases)} columns is a case (figures/tables/stability.md lists "
        f"them by number): {picked} "
        "picked by hand, and combinations in which every\ntwo hard levels of eleven factors meet, "
        "by stimulus. A row is a "
        "measure of how the run went: its worst value over the worst that still counts\nas stable. "
        "The methods below differ "
        "from this package in one thing each."
    )
    small = {"fontsize": 6, "color": GREY}
    fig.text(0.012, 1 - 0.24 / height, intro, va="top", linespacing=1.35, **small)
    shown = dict.fromkeys(METHODS, OF_TEACHING)
    shown[DEFAULT] = [name for name in MEASURES if name != "off"]
    rows = sum(map(len, shown.values()))
    pitch, top = (height - _TOP - _BOTTOM - _GAP * len(TEACHING)) / rows, height - _TOP
    left, wide = _LEFT / width, 1 - (_LEFT + _RIGHT) / width
    above = {"xytext": (0, 3), "xycoords": "axes fraction", "textcoords": "offset points"}
    for method, names in shown.items():
        low = top - pitch * len(names)
        ax = fig.add_axes((left, low / height, wide, pitch * len(names) / height))
        top = low - _GAP
        part = frame[frame["method"] == method]
        drawn = _panel(ax, part, cases, names)
        ax.annotate(METHODS[method], (0, 1), fontweight="bold", fontsize=6.2, **above)
        ax.annotate(", ".join(tally(part)), (0.25, 1), **above, **small)
        if method == DEFAULT:
            _groups(ax, cases)
    numbers = [1, *range(10, len(cases) + 1, 10)]
    ax.set_xticks(np.array(numbers) - 1, numbers, fontsize=6)
    _legend(fig, drawn, height, width)
    return fig


def _panel(ax: Axes, part: pd.DataFrame, cases: pd.Series, names: list[str]):
    """One method: its measures by cases; returns what its colours are of."""
    shares = part.pivot(index="measure", columns="case", values="share")
    share = shares.reindex(index=names, columns=cases.index).to_numpy(float)
    image = np.ma.masked_invalid(np.log10(np.clip(share, 1e-3, 1e3)))
    colours = mpl.colormaps["RdYlBu_r"].resampled(24).with_extremes(bad="0.88")
    look = {"aspect": "auto", "interpolation": "none"}
    drawn = ax.imshow(image, norm=TwoSlopeNorm(0.0, -2.0, 1.0), cmap=colours, **look)
    for i, j in np.argwhere(np.isposinf(share)):
        ax.add_patch(Rectangle((j - 0.5, i - 0.5), 1, 1, color="black", lw=0))
    for j in np.flatnonzero(~cases.index.isin(part["case"])):
        ax.add_patch(Rectangle((j - 0.5, -0.5), 1, len(names), color="white", lw=0))
    ax.set_yticks(range(len(names)), [MEASURES[name][0] for name in names], fontsize=6)
    ax.set_xticks([])
    ax.tick_params(length=0, pad=2)
    for row in range(1, len(names)):
        ax.axhline(row - 0.5, color="white", lw=0.5)
    for start in _starts(cases)[1:]:
        ax.axvline(start - 0.5, color="white", lw=1.2)
    ax.spines[:].set_visible(False)
    return drawn


def _starts(cases: pd.Series) -> np.ndarray:
    """Where groups begin."""
    return np.flatnonzero(cases != cases.shift())


def _groups(ax: Axes, cases: pd.Series) -> None:
    """Names of the groups over their cases."""
    starts = _starts(cases)
    turned = {"rotation": 50, "rotation_mode": "anchor", "va": "bottom", "fontsize": 6}
    for start, end in zip(starts, [*starts[1:], len(cases)], strict=True):
        middle = ((start + end - 1) / 2, -0.5)
        ax.annotate(cases.iloc[start], middle, (0, 13), textcoords="offset points", **turned)


def _legend(fig: Figure, drawn, height: float, width: float) -> None:
    """What a colour means, and what a row is."""
    place = fig.add_axes((0.1 / width, 0.62 / height, 1.45 / width, 0.09 / height))
    bar = fig.colorbar(drawn, cax=place, orientation="horizontal")
    bar.set_ticks([-2, -1, 0, 1], labels=["1 %", "10 %", "limit", "10 ×"], fontsize=6)
    bar.minorticks_off()
    bar.ax.set_title("share of the limit that is used up", fontsize=6)
    bar.outline.set_edgecolor(INK)
    kinds = {"black": "not completed", "0.88": "not judged", "white": "not tried, or no such mesh"}
    look = {"edgecolor": GREY, "lw": 0.4}
    close = {"handlelength": 1, "handleheight": 1, "labelspacing": 0.35, "borderaxespad": 0}
    fig.legend(
        handles=[Patch(facecolor=colour, label=text, **look) for colour, text in kinds.items()],
        loc="upper left",
        bbox_to_anchor=(0.08 / width, 0.42 / height),
        fontsize=6,
        **close,
    )
    tiny = {"fontsize": 6, "va": "top"}
    for k, (name, meaning) in enumerate(MEASURES.values()):
        column, row = divmod(k, (len(MEASURES) + 1) // 2)
        x, y = 1.8 + 2.75 * column, 0.82 - 0.108 * row
        fig.text(x / width, y / height, name, fontweight="bold", **tiny)
        fig.text((x + 0.78) / width, y / height, meaning, **tiny)


def stability_picture(job: SimpleNamespace) -> None:
    """Job: `methods` (CSV) -> `picture`, `table`."""
    frame = assemble([pd.read_csv(path) for path in job.methods])
    publish_table(table(frame), job.table[0])
    data = long(frame)
    publish(heat_map(data), data, job.picture[0])

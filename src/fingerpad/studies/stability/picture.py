"""Figure and table of the study of stability: cases by measures, one method beside the other."""

from __future__ import annotations

from collections.abc import Iterable

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from fingerpad.publishing.style import GREY, INK, TALLEST, sheet, styled

METHODS = {
    "default": "this package\n(default method)",
    "full Q1": "full Q1 elements\n(lock)",
    "plain P2": "plain P2 elements\n(oscillate)",
    "plain Newton": "plain Newton\n(not lagged)",
}
"""Method -> its title in the picture; the first is the one that is offered."""
DEFAULT, *TEACHING = METHODS
MEASURES = {
    "completed": ("completed", "reached the end of the motion"),
    "cuts": ("step cuts", "times a load step had to be halved, in all"),
    "factorisations": ("factors a step", "matrices factorised, mean of the steps"),
    "energy": ("energy balance", "work less stored and dissipated energy, over the largest work"),
    "complementarity": ("complementarity", "forces across gaps: force times gap over force times node spacing"),
    "det_f": ("least det F", "least volume left of any point; elements fold at 0"),
    "checkerboard": ("checkerboard", "contact pressure that alternates from node to node, over its peak"),
    "halving": ("half the step", "change of force, depth, width, energy by steps half as long"),
    "off": ("off the default", "difference of the last depth or force to this package's"),
}
"""Measure -> its name in the picture, and what it is. Checkerboard: r.m.s. of nodal pressure less its 5-point average over the
peak, inside the contact. Half the step: largest change of force, depth, width, stored energy and tangential force at the ends of
the legs."""
OUTCOMES = {
    "stable": "stable", "unsound": "outside limits", "wrong": "wrong", "admits its error": "wrong, but say so",
    "fails cleanly": "stop and say why", "breaks off": "break off",
}  # fmt: skip
"""How runs end, and in words for many."""
OFF = 0.05
"""A method whose last depth or force is off the default's by more than this has not solved the case."""


def assemble(studies: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Rows of all methods (of `fingerpad.studies.stability.run.study`) with the column off, to the default's last state."""
    frame = pd.concat(studies, ignore_index=True)
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
    """One row a case, method and measure: value, limit, and the share of the limit that is used up (above 1: beyond it)."""
    rows = []
    for row in frame.to_dict("records"):
        if row["outcome"] == "does not apply":
            continue
        for name in MEASURES:
            value, limit = row.get(name, np.nan), row.get(f"limit {name}", np.nan)
            if name == "completed":
                limit = 1.0
                share = 0.0 if value else np.inf
            elif name == "det_f":
                share = limit / max(value, 1e-9)
            else:
                share = value / max(limit, 0.5 if name == "cuts" else 1e-12) if np.isfinite(limit) else np.nan
            rows.append(
                {key: row[key] for key in ("group", "case", "method")}
                | {"outcome": _outcome(row)}
                | {"measure": name, "value": value, "limit": limit, "share": share}
            )
    return pd.DataFrame(rows)


def table(frame: pd.DataFrame) -> pd.DataFrame:
    """One row a case: hard, stable, what the default method did and measured, and how the other methods ended."""
    default = frame[frame["method"] == DEFAULT].set_index("case")
    out = default[["group", "hard", "stable", "outcome", "message", "saved"]].rename(
        columns={
            "hard": "what makes it hard", "stable": "what counts as stable", "message": "said", "saved": "last state saved"
        }
    )  # fmt: skip
    for name in list(MEASURES)[1:8]:
        out[MEASURES[name][0]] = default[name]
    for method in TEACHING:
        rows = frame[frame["method"] == method].set_index("case").reindex(default.index)
        out[method] = [_ended(row) for row in rows.to_dict("records")]
    out.insert(0, "case", out.index)
    return out.fillna({"said": "", "last state saved": ""})


def _outcome(row: dict) -> str:
    """How a run ended; wrong: where it should not."""
    return "wrong" if row["off"] > OFF else row["outcome"]


def _ended(row: dict) -> str:
    """How a teaching method ended, in a few words."""
    said = row["message"] if isinstance(row["message"], str) else ""
    if _outcome(row) == "wrong":
        return f"wrong: off by {row['off']:.0%}" + (f"; {said}" if row["outcome"] == "unsound" else "")
    return f"{row['outcome']}: {said}" if said else str(row["outcome"])


def tally(part: pd.DataFrame) -> list[str]:
    """How many cases of a method ended how; ``part``: its rows of :func:`long`."""
    ends = part.drop_duplicates("case")["outcome"].value_counts()
    said = [f"{ends[outcome]} {text}" for outcome, text in OUTCOMES.items() if outcome in ends]
    return said if "unsound" in ends or "wrong" in ends else [*said, "none fails silently"]


@styled
def heat_map(frame: pd.DataFrame) -> Figure:
    """Cases by measures for each method; colour tells how much of the limit is used up. ``frame``: of :func:`long`."""
    cases = list(frame["case"].drop_duplicates())
    below, above, height = 2.02, 1.22, TALLEST  # inch
    pitch = (height - below - above) / len(cases)
    fig = sheet("Stability in hard cases", [], height, laid_out=False)
    intro = (
        "Simulated. A row is a case, a column a measure of how the run went: its worst value over the worst that still counts "
        "as stable there\n(figures/tables/stability.md lists both). Blue: far inside. Yellow: at the limit. Red: beyond. The "
        "three methods to the right differ in one thing each."
    )
    fig.text(0.012, 1 - 0.24 / height, intro, ha="left", va="top", fontsize=6, color=GREY, linespacing=1.35)
    shown = {m: [n for n in MEASURES if n != ("off" if m == DEFAULT else "halving")] for m in METHODS}
    grid = fig.add_gridspec(1, len(METHODS), left=0.4, right=0.99, top=1 - above / height, bottom=below / height, wspace=0.07)
    norm, colours = TwoSlopeNorm(0.0, -2.0, 1.0), mpl.colormaps["RdYlBu_r"].with_extremes(bad="0.85")
    groups = frame.drop_duplicates("case").set_index("case")["group"].loc[cases]
    starts = [k for k in range(len(cases)) if k == 0 or groups.iloc[k] != groups.iloc[k - 1]]
    for k, method in enumerate(METHODS):
        ax = fig.add_subplot(grid[0, k])
        part = frame[frame["method"] == method]
        values = part.pivot(index="case", columns="measure", values="share").reindex(index=cases, columns=shown[method])
        share = values.to_numpy(float)
        with np.errstate(divide="ignore"):
            image = np.ma.masked_invalid(np.log10(np.clip(share, 1e-3, 1e3)))
        drawn = ax.imshow(image, norm=norm, cmap=colours, aspect="auto", interpolation="none")
        for i, j in np.argwhere(np.isposinf(share)):
            ax.add_patch(mpl.patches.Rectangle((j - 0.5, i - 0.5), 1, 1, color="black", lw=0))
        for i in np.flatnonzero(~np.isin(cases, part["case"])):
            ax.add_patch(mpl.patches.Rectangle((-0.5, i - 0.5), share.shape[1], 1, color="white", lw=0))
        ax.set_xticks(range(len(shown[method])), [MEASURES[name][0] for name in shown[method]], rotation=90, fontsize=6)
        ax.set_yticks(range(len(cases)), cases if k == 0 else [], fontsize=5.8)
        ax.tick_params(length=0, pad=2)
        ax.set_title(METHODS[method], fontsize=6.5, loc="center", pad=36)
        said = "\n".join(tally(part))
        ax.annotate(said, (0.5, 1), (0, 36), "axes fraction", "offset points", ha="center", va="top", fontsize=5.6, color=GREY)
        for start in starts[1:]:
            ax.axhline(start - 0.5, color="white", lw=1.8)
        ax.set_xticks(np.arange(share.shape[1] + 1) - 0.5, minor=True)
        ax.set_yticks(np.arange(len(cases) + 1) - 0.5, minor=True)
        ax.grid(which="minor", color="white", lw=0.5)
        ax.tick_params(which="minor", length=0)
        for spine in ax.spines.values():
            spine.set_visible(False)
        if k == 0:
            for start, end in zip(starts, [*starts[1:], len(cases)], strict=True):
                y = 1 - (above + pitch * (start + end) / 2) / height
                fig.text(0.022, y, groups.iloc[start], rotation=90, ha="center", va="center", fontsize=6, color=GREY)
    _legend(fig, drawn, height)
    return fig


def _legend(fig: Figure, drawn, height: float) -> None:
    """What a colour means, and what a column is."""
    bar = fig.colorbar(drawn, cax=fig.add_axes((0.03, 0.92 / height, 0.3, 0.1 / height)), orientation="horizontal")
    bar.set_ticks([-2, -1, 0, 1], labels=["1 %", "10 %", "limit", "10 ×"], fontsize=6)
    bar.minorticks_off()
    bar.ax.set_title("share of the limit that is used up", fontsize=6)
    bar.outline.set_edgecolor(INK)
    kinds = {
        "black": "not completed",
        "0.85": "not judged: no limit, or too few nodes touch",
        "white": "the method has no such mesh",
    }
    patches = [mpl.patches.Patch(facecolor=colour, edgecolor=GREY, lw=0.4, label=text) for colour, text in kinds.items()]
    fig.legend(
        handles=patches, loc="upper left", bbox_to_anchor=(0.02, 0.66 / height), fontsize=6, handlelength=1, handleheight=1,
        labelspacing=0.35, borderaxespad=0,
    )  # fmt: skip
    for k, (name, meaning) in enumerate(MEASURES.values()):
        y = (1.06 - 0.108 * k) / height
        fig.text(0.4, y, name, fontsize=6, va="top", fontweight="bold")
        fig.text(0.53, y, meaning, fontsize=6, va="top")

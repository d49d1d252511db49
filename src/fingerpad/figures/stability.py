"""Figure and table of the study of stability: cases by measures, one method beside the other."""

from __future__ import annotations

from collections.abc import Iterable

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure

from fingerpad.figures.style import GREY, INK, PAGE_WIDTH, styled

METHODS = {
    "default": "default",
    "full Q1": "full Q1\n(locks)",
    "plain P2": "plain P2\n(oscillates)",
    "plain Newton": "plain Newton\n(not lagged)",
}
"""Method -> its title in the picture; the first is the one that is offered."""
DEFAULT, *TEACHING = METHODS
MEASURES = {
    "completed": "completed",
    "cuts": "step cuts",
    "iterations": "iterations a step",
    "energy": "energy balance",
    "complementarity": "complementarity",
    "det_f": "least det F",
    "checkerboard": "checkerboard",
    "halving": "half the step",
    "off": "off the default",
}
"""Measure -> its name in the picture. Cuts: halvings of steps, in all. Iterations: Newton's, mean of the steps. Energy: work less
stored and dissipated energy over the largest work. Complementarity: sum of force times gap over total force times node spacing.
Checkerboard: r.m.s. of nodal pressure less its 5-point average over the peak, inside the contact. Half the step: largest change
of force, depth, width, stored energy and tangential force at the ends of the legs. Off the default: difference of the last depth
or force to the default method's."""
OFF = 0.05
"""A method whose last depth or force is off the default's by more than this has not solved the case."""


def assemble(studies: Iterable[pd.DataFrame]) -> pd.DataFrame:
    """Rows of all methods (see :func:`fingerpad.studies.stability.study`) with the column off, to the default's last state."""
    frame = pd.concat(studies, ignore_index=True)
    states = ["depth_mm", "force_N_per_m"]
    default = frame[frame["method"] == DEFAULT].set_index("case")[states]
    theirs = default.loc[frame["case"]].to_numpy()
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = np.abs(frame[states].to_numpy() - theirs) / np.abs(theirs)
    apart[theirs == 0] = 0.0
    frame["off"] = apart.max(axis=1)
    frame.loc[frame["method"] == DEFAULT, "off"] = np.nan
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
        out[MEASURES[name]] = default[name]
    for method in TEACHING:
        rows = frame[frame["method"] == method].set_index("case").reindex(default.index)
        out[method] = [_ended(row) for row in rows.to_dict("records")]
    out.insert(0, "case", out.index)
    return out.fillna({"said": "", "last state saved": ""})


def _ended(row: dict) -> str:
    """How a teaching method ended, in a few words."""
    if isinstance(row["off"], float) and row["off"] > OFF:
        beyond = f"; {row['message']}" if row["outcome"] == "unsound" else ""
        return f"wrong: off by {row['off']:.0%}{beyond}"
    return f"{row['outcome']}: {row['message']}" if isinstance(row["message"], str) and row["message"] else str(row["outcome"])


@styled
def heat_map(frame: pd.DataFrame) -> Figure:
    """Cases by measures for each method; colour tells how much of the limit is used up. ``frame``: of :func:`long`."""
    cases = list(frame["case"].drop_duplicates())
    height = 2.1 + 0.138 * len(cases)
    fig = Figure(figsize=(PAGE_WIDTH, height))
    fig.text(0.012, 1 - 0.09 / height, "Stability in hard cases", ha="left", va="top", fontweight="bold", fontsize=9.5)
    note = (
        "Simulated. Each column is a measure over its limit for the case (figures/tables/stability.md): blue is far inside, red\n"
        "beyond. Black: not completed. Grey: not judged, or too few nodes in contact. White: the method has no such mesh.\n"
        "Teaching methods differ in one thing each, on the same nodes; they are given up after 400 iterations."
    )
    fig.text(0.012, 0.06 / height, note, ha="left", va="bottom", fontsize=7, color=GREY, linespacing=1.35)
    shown = {m: [n for n in MEASURES if n != ("off" if m == DEFAULT else "halving")] for m in METHODS}
    grid = fig.add_gridspec(1, len(METHODS), left=0.335, right=0.915, top=1 - 0.72 / height, bottom=1.42 / height, wspace=0.07)
    norm, colours = TwoSlopeNorm(0.0, -2.0, 1.0), mpl.colormaps["RdYlBu_r"].with_extremes(bad="0.88")
    groups = frame.drop_duplicates("case").set_index("case")["group"].loc[cases]
    starts = [k for k in range(1, len(cases)) if groups.iloc[k] != groups.iloc[k - 1]]
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
        ax.set_xticks(range(len(shown[method])), [MEASURES[name] for name in shown[method]], rotation=90, fontsize=6.5)
        ax.set_yticks(range(len(cases)), cases if k == 0 else [], fontsize=6.5)
        ax.tick_params(length=0, pad=2)
        ax.set_title(METHODS[method], fontsize=7.5, loc="center", pad=4)
        for start in starts:
            ax.axhline(start - 0.5, color="white", lw=1.6)
        ax.set_xticks(np.arange(share.shape[1] + 1) - 0.5, minor=True)
        ax.set_yticks(np.arange(len(cases) + 1) - 0.5, minor=True)
        ax.grid(which="minor", color="white", lw=0.5)
        ax.tick_params(which="minor", length=0)
        for spine in ax.spines.values():
            spine.set_visible(False)
    bar = fig.colorbar(drawn, cax=fig.add_axes((0.935, 1 - 3.2 / height, 0.016, 2.4 / height)), ticks=[-2, -1, 0, 1])
    bar.ax.set_yticklabels(["1 %", "10 %", "limit", "10 x"], fontsize=6.5)
    bar.outline.set_edgecolor(INK)
    return fig

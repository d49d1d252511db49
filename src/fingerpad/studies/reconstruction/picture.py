"""Two pictures: what is believed of the pad, and how pads compare with every row of the evidence."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from fingerpad.publishing.style import COLOURS, GREY, INK, handle, header_legend, study_figure, styled
from fingerpad.studies.reconstruction import pads
from fingerpad.studies.reconstruction.evidence import FAMILIES, Evidence
from fingerpad.studies.reconstruction.inference import EPIDERMIS, SOFT
from fingerpad.studies.reconstruction.run import CHOSEN, SHOWN
from fingerpad.studies.reconstruction.unknowns import SCALED, Unknowns

LABELS = {
    SCALED: "line load\n(N/m)", "plate_length": "plate length\n(mm)", "apex_radius": "apex radius\n(mm)",
    "fat_thickness": "fat\n(mm)", "bone_half_width": "bone half-\nwidth (mm)", SOFT: "dermis, fat:\nfactor (1)",
    EPIDERMIS: "epidermis:\nfactor (1)",
}  # fmt: skip
BINS = 14
BEST = "most probable pad"


def posterior_frame(samples: pd.DataFrame, known: Unknowns) -> pd.DataFrame:
    """What is drawn: a row a sample, columns `SHOWN` with their units."""
    unit = {name: known.unknowns[name].unit if name in known.unknowns else "1" for name in SHOWN}
    return samples[["reading", *SHOWN]].rename(columns={name: f"{name} ({unit[name]})" for name in SHOWN})


@styled
def posterior_picture(frame: pd.DataFrame) -> Figure:
    """Histograms on the diagonal, densities of pairs below it, their correlations above it; a line for the pad chosen before."""
    columns = list(frame.columns[1:])
    before = {**pads.CHOSEN, SCALED: pads.CHOSEN["load_over_state"], "plate_length": 10.0, SOFT: 1.0, EPIDERMIS: 1.0}
    shares = frame["reading"].value_counts(normalize=True)
    told = ", ".join(f"{name.replace('_', ' ')} {share:.0%}" for name, share in shares.items() if share >= 0.01)
    note = [
        f"{len(frame)} samples, readings of the moduli by their evidence: {told}. Numbers: rank correlations. Orange: the pad "
        "chosen before, one size at a time.",
        "Factors are on the moduli taken for long-term ones; of instantaneous ones the Prony series leaves 0.576. Fitted to "
        "chapter 3 and half of chapter 4.",
    ]
    fig = study_figure("What the thesis's figures say of its pad", note, 7.4)
    n = len(columns)
    axes = fig.subplots(n, n)
    values = frame[columns]
    rank = values.corr(method="spearman").to_numpy()
    for i, row in enumerate(columns):
        for j, column in enumerate(columns):
            ax = axes[i, j]
            ax.tick_params(labelsize=6, length=2)
            if j > i:
                ax.axis("off")
                ax.text(
                    0.5, 0.5, f"{rank[i, j]:+.2f}", ha="center", va="center", fontsize=8, color=str(0.75 - 0.7 * abs(rank[i, j]))
                )
                continue
            if i == j:
                ax.hist(values[row], bins=2 * BINS, color=COLOURS["210"], alpha=0.8)
                ax.set_yticks([])
            else:
                ax.hist2d(values[column], values[row], bins=BINS, cmap="Purples", rasterized=True)
                ax.axhline(before[SHOWN[i]], color=COLOURS["1260"], lw=0.7)
            low, high = values[column].min(), values[column].max()
            pad = 0.04 * max(high - low, 1e-9)
            ax.set_xlim(low - pad, high + pad)
            if low - pad <= before[SHOWN[j]] <= high + pad:
                ax.axvline(before[SHOWN[j]], color=COLOURS["1260"], lw=0.7)
            if i > j:
                low, high = values[row].min(), values[row].max()
                ax.set_ylim(low - 0.04 * max(high - low, 1e-9), high + 0.04 * max(high - low, 1e-9))
            if i < n - 1:
                ax.set_xticklabels([])
            else:
                ax.set_xlabel(LABELS[SHOWN[j]], fontsize=6.5)
            if j > 0 or i == 0:
                ax.set_yticklabels([])
            if j == 0 and i > 0:
                ax.set_ylabel(LABELS[SHOWN[i]], fontsize=6.5)
    return fig


def evidence_frame(evidence: Evidence, shown: pd.DataFrame, best: str) -> pd.DataFrame:
    """A row a pad and row of the evidence: its interval, and where in it the number lies, 0 at the lower end, 1 at the upper."""
    rows = shown.merge(
        evidence.rows[["id", "figure", "surface", "measure", "low", "high", "tolerance", "unit", "role", "family"]], on="id"
    )
    rows["pad"] = rows["pad"].replace(best, BEST)
    return rows.assign(place=(rows["shown"] - rows["low"]) / (rows["high"] - rows["low"]))


@styled
def evidence_picture(frame: pd.DataFrame) -> Figure:
    """Every row of the evidence as a bar from its lower to its upper end, and pads: the most probable one and others."""
    drawn = frame[frame["pad"].str.startswith("drawn")]
    order = {family: k for k, family in enumerate(FAMILIES)}
    ids = frame.drop_duplicates("id")
    ids = ids.assign(k=ids["family"].map(order)).sort_values(
        ["role", "k"], key=lambda c: c.map({"fitted": 0, "held_out": 1, "apart": 2}) if c.name == "role" else c, kind="stable"
    )
    height = np.arange(len(ids))[::-1]
    at = dict(zip(ids["id"], height, strict=True))
    note = [
        "Bars: the interval that a figure leaves, all drawn as long; what is between its ends counts as met. White: not fitted. "
        f"Grey: {drawn['pad'].nunique()} pads drawn from what is believed, simulated. Numbers beyond three lengths of the bar "
        "stand at the margin.",
    ]
    fig = study_figure("The evidence, row by row", note, 9.6, header=0.2)
    ax = fig.subplots()
    for row in ids.itertuples():
        ax.barh(at[row.id], 1, height=0.72, color="0.86" if row.role == "fitted" else "white", edgecolor="0.7", lw=0.6)
    clip = (-2.0, 3.0)
    for part, style in (
        (drawn, dict(marker="o", ms=3, color=GREY, alpha=0.6)),
        (frame[frame["pad"] == CHOSEN], dict(marker="D", ms=4, color=COLOURS["1260"])),
        (frame[frame["pad"] == BEST], dict(marker="o", ms=4.5, color=COLOURS["79"])),
    ):
        part = part[np.isfinite(part["place"])]
        ax.plot(part["place"].clip(*clip), part["id"].map(at), ls="none", mec="none", **style)
    names = [f"{r.figure}  {r.surface}: {r.measure.replace('_', ' ')}" for r in ids.itertuples()]
    ax.set_yticks(height, names, fontsize=5.6)
    ax.set(
        xlim=(clip[0] - 0.1, clip[1] + 0.1), ylim=(-0.8, len(ids) - 0.2), xlabel="place in the interval: 0 lower end, 1 upper end"
    )
    for role in ("held_out", "apart"):
        first = ids[ids["role"] == role]["id"].map(at).max()
        ax.axhline(first + 0.5, color=INK, lw=0.8)
        ax.text(
            clip[1] + 0.08,
            first + 0.1,
            {"held_out": "held out", "apart": "inside the epidermis"}[role],
            ha="right",
            va="top",
            fontsize=7,
        )
    marks = [
        handle(BEST, marker="o", ls="none", color=COLOURS["79"]),
        handle("drawn", marker="o", ls="none", color=GREY),
        handle("chosen one at a time", marker="D", ls="none", color=COLOURS["1260"]),
    ]  # fmt: skip
    header_legend(fig, marks)
    return fig

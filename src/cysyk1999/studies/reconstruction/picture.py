"""Two pictures: what is believed of the pad, and how pads compare with every row of the
evidence.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.publishing.style import (
    CATEGORIES,
    GREY,
    INK,
    TALLEST,
    handle,
    header_legend,
    study_figure,
    styled,
)
from cysyk1999.publishing.write import publish
from cysyk1999.studies.reconstruction import pads
from cysyk1999.studies.reconstruction.evidence import FAMILIES, HALVES, Evidence, read_evidence
from cysyk1999.studies.reconstruction.run import HERE, SHOWN
from cysyk1999.studies.reconstruction.specimen import most_probable
from cysyk1999.studies.reconstruction.unknowns import (
    BULK,
    EPIDERMIS,
    SCALED,
    SOFT,
    Unknowns,
    read_unknowns,
)

LABELS = {
    SCALED: "line load\n(N/m)",
    "apex_radius": "apex radius\n(mm)",
    "fat_thickness": "fat\n(mm)",
    "bone_half_width": "bone half-\nwidth (mm)",
    BULK: "bulk\nmodulus (1)",
    SOFT: "dermis, fat:\nfactor (1)",
    EPIDERMIS: "epidermis:\nfactor (1)",
}
BINS = 14
BEST = "most probable pad"
CLIP = (-2.0, 3.0)
"""Of the evidence: farthest places shown."""


def posterior_frame(samples: pd.DataFrame, known: Unknowns) -> pd.DataFrame:
    """What is drawn: a row a sample, columns `SHOWN` with their units."""
    unit = {name: known.unknowns[name].unit if name in known.unknowns else "1" for name in SHOWN}
    return samples[["reading", *SHOWN]].rename(
        columns={name: f"{name} ({unit[name]})" for name in SHOWN}
    )


@styled
def posterior_picture(frame: pd.DataFrame) -> Figure:
    """Histograms on the diagonal, densities of pairs below it, their correlations above it; a line
    for the pad of nu = 0.48.
    """
    columns = list(frame.columns[1:])
    shares = frame["reading"].value_counts(normalize=True)
    told = ", ".join(
        f"{name.replace('_', ' ')} {share:.0%}" for name, share in shares.items() if share >= 0.02
    )
    note = [
        f"{len(frame)} samples; readings of the moduli: {told}. Factors: on the moduli as "
        "long-term ones, of instantaneous ones "
        "the series leaves 0.576; bulk modulus over that of nu = 0.48. Numbers: rank correlations. "
        "Orange: the pad of scenes. Histograms that are cut off end where the search did.",
    ]
    fig = study_figure("What the thesis's figures say of its pad", note, TALLEST)
    n, values = len(columns), frame[columns]
    axes = fig.subplots(n, n)
    rank = values.corr(method="spearman").to_numpy()
    margin = 0.04 * (values.max() - values.min()).clip(lower=1e-9)
    limits = np.column_stack([values.min() - margin, values.max() + margin])
    chosen = [pads.BEFORE[name] for name in SHOWN]
    line = {"color": CATEGORIES[1], "lw": 0.8}
    for (i, j), ax in np.ndenumerate(axes):
        ax.tick_params(labelsize=6, length=2)
        row, column = values[columns[i]], values[columns[j]]
        if j > i:
            ax.axis("off")
            words = f"{rank[i, j]:+.2f}".replace("-", "−")
            colour = INK if abs(rank[i, j]) >= 0.3 else GREY
            ax.text(0.5, 0.5, words, ha="center", va="center", color=colour)
            continue
        if i == j:
            ax.hist(row, bins=2 * BINS, color="0.6")
            ax.set_yticks([])
        else:
            ax.hist2d(column, row, bins=BINS, cmap="Greys", rasterized=True)
            ax.axhline(chosen[i], **line)
            ax.set_ylim(limits[i])
        ax.set_xlim(limits[j])
        if limits[j, 0] <= chosen[j] <= limits[j, 1]:
            ax.axvline(chosen[j], **line)
        if i < n - 1:
            ax.set_xticklabels([])
        else:
            ax.set_xlabel(LABELS[SHOWN[j]], fontsize=6.5)
        if j > 0 or i == 0:
            ax.set_yticklabels([])
        else:
            ax.set_ylabel(LABELS[SHOWN[i]], fontsize=6.5)
    return fig


def evidence_frame(evidence: Evidence, shown: pd.DataFrame, best: str) -> pd.DataFrame:
    """A row a pad and row of the evidence: its interval, and where in it the number lies, 0 at the
    lower end, 1 at the upper.
    """
    columns = "id figure surface measure low high tolerance unit family".split()
    rows = shown.merge(evidence.rows[columns].assign(half=evidence.halves), on="id")
    rows["pad"] = rows["pad"].replace(best, BEST)
    return rows.assign(place=(rows["shown"] - rows["low"]) / (rows["high"] - rows["low"]))


@styled
def evidence_picture(frame: pd.DataFrame) -> Figure:
    """Every row of the evidence as a bar from its lower to its upper end, and pads: the most
    probable one and others.
    """
    drawn = frame[frame["pad"].str.startswith("drawn")]
    order = {family: k for k, family in enumerate(FAMILIES)}
    ids = frame.drop_duplicates("id")
    ids = ids.assign(k=ids["family"].map(order)).sort_values("k", kind="stable")
    note = [
        "Bars: the interval that a figure leaves, all drawn as long; what is between its "
        "ends counts as met. "
        f"Grey: {drawn['pad'].nunique()} pads drawn from what is believed, simulated. "
        "Numbers beyond three lengths of the bar "
        "stand at the margin.",
    ]
    fig = study_figure("The evidence, row by row", note, TALLEST)
    looks = {
        "drawn": {"marker": "o", "ms": 2.4, "color": GREY, "alpha": 0.6},
        HERE: {"marker": "D", "ms": 3.2, "color": CATEGORIES[1]},
        BEST: {"marker": "o", "ms": 3.4, "color": CATEGORIES[0]},
    }
    for ax, half in zip(fig.subplots(1, 2), HALVES, strict=True):
        rows = ids[ids["half"] == half]
        at = dict(zip(rows["id"], range(len(rows)), strict=True))
        ax.barh(range(len(rows)), 1, height=0.72, color="0.86", edgecolor="0.7", lw=0.5)
        for name, look in looks.items():
            part = drawn if name == "drawn" else frame[frame["pad"] == name]
            part = part[np.isfinite(part["place"]) & part["id"].isin(rows["id"])]
            ax.plot(part["place"].clip(*CLIP), part["id"].map(at), ls="none", mec="none", **look)
        names = [
            f"{r.figure}  {r.surface}: {r.measure.replace('_', ' ')}" for r in rows.itertuples()
        ]
        ax.set_yticks(range(len(rows)), names, fontsize=6)
        ax.set(xlim=(CLIP[0] - 0.1, CLIP[1] + 0.1), ylim=(len(rows) - 0.3, -0.7))
        ax.set_title(f"figures with an {half} number")
        ax.set_xlabel("place in the interval, its ends at 0 and 1")
    handles = [handle(name, ls="none", **look) for name, look in reversed(looks.items())]
    header_legend(fig, handles, room=0.2)
    return fig


def reconstruction_pictures(job: SimpleNamespace) -> None:
    """Job: `unknowns`, `evidence`, `parts`: samples, predicted; `readings` -> `pictures`:
    posterior, evidence.
    """
    samples, shown = map(pd.read_csv, job.parts)
    frame = posterior_frame(samples, read_unknowns(job.unknowns[0]))
    publish(posterior_picture(frame), frame, job.pictures[0])
    best = f"best of {most_probable(pd.read_csv(job.readings[0]))}"
    frame = evidence_frame(Evidence(read_evidence(job.evidence[0])), shown, best)
    publish(evidence_picture(frame), frame, job.pictures[1])

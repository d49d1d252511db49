"""The parity plot: measured against predicted, and a table of a sentence for each dataset."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pandas import DataFrame

from cysyk1999.publishing.style import CATEGORIES, GREY, INK, study_figure, styled
from cysyk1999.publishing.tables import publish_table
from cysyk1999.publishing.write import publish
from fingerpad.benchmark.predict import CONSTANTS, NOT_PREDICTED
from fingerpad.benchmark.rows import datasets, titles
from fingerpad.benchmark.score import within_factor_2

PANELS = {
    "force": ("force (N)", "log", (4e-3, 3.0)),
    "deflection": ("deflection (mm)", "linear", (-0.4, 3.6)),
    "impulse_rate": ("SA-I impulse rate (1/s)", "linear", (-4.0, 165.0)),
}
"""Quantity -> name of its axes, their scale and their ends."""
SHORT = {
    "force_plate": "plate",
    "force_probe": "probe of 6.35 mm",
    "force_point": "point",
    "profile_cylinder_3mm": "cylinder of 3.17 mm",
    "profile_cylinder_10mm": "cylinder of 9.52 mm",
    "sa1_spheres": "spheres, at the centre",
    "sa1_sphere_profiles": "spheres, beside it",
    "sa1_bar_held": "bar of 3 mm",
    "sa1_grating": "grating",
}
"""Names of datasets in the legend."""
DATASET, ROW, MEASURED, HERE, HALF = "dataset", "row", "measured", "predicted", "half-space"
QUANTITY, UNIT, AT = "quantity", "unit", "at"


def parity_frame(here: DataFrame, half: DataFrame) -> DataFrame:
    """Held-out rows that this model predicts: measured, predicted, and the half-space's number.

    Parameters
    ----------
    here, half : DataFrame
        Tables of predictions of the benchmark.
    """
    both = here.merge(half[["dataset", "row", "predicted"]], on=["dataset", "row"])
    chosen = both[(both["role"] == "test") & both["predicted_x"].notna()]
    names = {"predicted_x": HERE, "predicted_y": HALF, "value": MEASURED}
    return chosen.rename(columns=names)[[DATASET, ROW, QUANTITY, UNIT, AT, MEASURED, HERE, HALF]]


@styled
def parity(frame: DataFrame) -> Figure:
    """Predicted against measured, one panel a unit, a colour a dataset, a band of a factor of 2."""
    near = within_factor_2(frame[HERE], frame[MEASURED])
    told = frame[HALF].notna()
    half = within_factor_2(frame[HALF], frame[MEASURED])
    title = (
        f"{near.sum()} of {len(frame)} held-out measurements are predicted within a factor of "
        f"two; a half-space does so for {half.sum()} of {told.sum()}"
    )
    note = (
        "Coloured: this model, only rows that nothing was fitted to. Grey crosses: an elastic "
        "half-space, its constants fitted to the same rows. Line: the same; band: a factor of two. "
        "Forces, human: Dandekar 2003. Profiles, human: MIT Touch Lab. Rates, monkey: Goodwin "
        "1995, Phillips and Johnson 1981; read from their figures by third parties."
    )
    fig = study_figure(title, [note], 3.1)
    for ax, (quantity, (label, scale, ends)) in zip(
        fig.subplots(1, len(PANELS)), PANELS.items(), strict=True
    ):
        _panel(ax, frame[frame[QUANTITY] == quantity], scale, ends)
        ax.set_xlabel(f"measured {label}")
        ax.set_ylabel("predicted")
    return fig


def _panel(ax: Axes, frame: DataFrame, scale: str, ends: tuple[float, float]) -> None:
    line = np.geomspace(*ends, 50) if scale == "log" else np.linspace(0, ends[1], 50)
    ax.fill_between(line, line / 2, 2 * line, color="0.92", lw=0, zorder=0)
    ax.plot(line, line, color=INK, lw=0.6, zorder=1)
    ax.plot(frame[MEASURED], frame[HALF], "x", ms=2.6, mew=0.5, color=GREY, alpha=0.7, zorder=2)
    for colour, (name, part) in zip(CATEGORIES, frame.groupby(DATASET, sort=False), strict=False):
        look = {"ms": 3.2, "mfc": colour, "mec": "white", "mew": 0.3, "zorder": 3}
        ax.plot(part[MEASURED], part[HERE], "o", label=SHORT[name], **look)
    ax.set(xscale=scale, yscale=scale, xlim=ends, ylim=ends)
    ax.set_box_aspect(1)
    ax.legend(loc="upper left", frameon=False, fontsize=6.5, handletextpad=0.1, borderpad=0.1)


def verdicts(scores: DataFrame) -> DataFrame:
    """One row a dataset: its score here, the half-space's, what was fitted, and a sentence."""
    rows, measured = [], datasets()
    for name, title in titles().items():
        row = {DATASET: name, "what": title, "numbers": len(measured[name])}
        mine = scores[(scores["dataset"] == name) & (scores["model"] == "fingerpad")]
        if mine.empty:
            rows.append(row | {"verdict": f"Not predicted: {NOT_PREDICTED[name]}."})
            continue
        one = mine.iloc[0]
        other = scores[(scores["dataset"] == name) & (scores["model"] == "half-space")].iloc[0]
        beaten = "" if one["r_squared"] > other["r_squared"] else " The half-space is nearer."
        rows.append(
            row
            | {
                "held out": one["rows"],
                "rms error": f"{one['rms']:.3g} {one['unit']}",
                "in standard deviations": one["rms_in_deviations"],
                "bias": one["bias"],
                "R2": one["r_squared"],
                "R2 of a half-space": other["r_squared"],
                "within the scatter (%)": 100 * one["within_scatter"],
                "within a factor of 2 (%)": 100 * one["within_factor_2"],
                "mesh error (%)": 100 * one["mesh_error"],
                "fitted": next(text for key, text in CONSTANTS.items() if name.startswith(key)),
                "verdict": one["verdict"] + beaten,
            }
        )
    return DataFrame(rows)


def draw_parity(job: SimpleNamespace) -> None:
    """`predictions` of this model and of a half-space, `scores` -> `picture` and `table`."""
    frame = parity_frame(*map(pd.read_csv, job.predictions))
    publish(parity(frame), frame, job.picture[0])
    publish_table(verdicts(pd.read_csv(job.scores[0])), job.table[0])

"""Five hundred fingers in one picture: bands of predicted rate against curvature, and what a study
should measure first.
"""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from cysyk1999.publishing.style import GREY, HIGHLIGHT, INK, study_figure, styled
from cysyk1999.studies.five_hundred_fingers.sensitivity import (
    CURVATURE,
    MEASURES,
    UNKNOWNS,
    bands,
    indices,
)

RATE = "predicted_rate_915_um_highest (impulses/s)"
SHOWN = 210.0
"""Curvature (1/m) of the matrix."""


def frame_of(table: pd.DataFrame) -> pd.DataFrame:
    """What is drawn, of the sweep's table: a row a finger, those that failed with their
    diagnosis.
    """
    return table[
        ["scene", CURVATURE, *UNKNOWNS, *MEASURES, "estimated_error (1)", "failed", "diagnosis"]
    ]


def table_of(frame: pd.DataFrame) -> pd.DataFrame:
    """The indices as a table."""
    return indices(frame[frame["failed"] == 0])


@styled
def fingers(frame: pd.DataFrame) -> Figure:
    """Scenes and bands of the predicted rate to the left, total Sobol indices to the right."""
    from matplotlib.ticker import FixedLocator, NullLocator

    done = frame[frame["failed"] == 0]
    found = indices(done, (SHOWN,))
    worst = found["total_95 (1)"].max()
    q2 = found.groupby("measure", sort=False)["q2 (1)"].first()
    note = [
        f"Simulated: {len(frame)} random fingers (dots), 20 gf at 40 gf/s, {len(frame) - len(done)} not converged; error "
        f"{100 * done['estimated_error (1)'].median():.0f} % in the middle; Eq 5-1 at 915 µm. Bands: 50 and 90 % of fingers by "
        f"an emulator that explains {100 * q2.min():.1f} to {100 * q2.max():.1f} % of what it has not seen. b: at {SHOWN:.0f} "
        f"1/m, 95 % interval at most ±{worst:.2f}.",
    ]
    fig = study_figure("Five hundred fingers: what a study should measure first", note, 4.3)
    left, right = fig.subplots(1, 2, width_ratios=[1.0, 1.15])
    band = bands(done, RATE)
    for low, high, alpha in ((0.05, 0.95, 0.22), (0.25, 0.75, 0.4)):
        left.fill_between(
            band[CURVATURE], band[low], band[high], color=HIGHLIGHT, alpha=alpha, lw=0
        )
    left.plot(done[CURVATURE], done[RATE], ".", color=GREY, ms=2.2, alpha=0.7)
    left.plot(band[CURVATURE], band[0.5], color=INK)
    left.set(
        xscale="log", xlabel="curvature (1/m)", ylabel="highest predicted SA-I rate (impulses/s)"
    )
    ticks = [26, 79, 158, 315, 630, 1260]
    left.xaxis.set_major_locator(FixedLocator(ticks))
    left.xaxis.set_minor_locator(NullLocator())
    left.set_xticklabels([str(tick) for tick in ticks])
    left.set_ylim(0, None)
    grid = found[found[CURVATURE] == SHOWN].pivot(
        index="unknown", columns="measure", values="total (1)"
    )[list(MEASURES.values())]
    grid = grid.loc[grid.sum(axis=1).sort_values(ascending=False).index]
    right.imshow(grid, cmap="Greys", vmin=0, vmax=1, aspect="auto")
    for i, row in enumerate(grid.to_numpy()):
        for j, value in enumerate(row):
            right.text(
                j,
                i,
                f"{value:.2f}",
                ha="center",
                va="center",
                color="white" if value > 0.55 else INK,
            )
    right.set_xticks(range(grid.shape[1]), grid.columns, rotation=40, ha="right")
    right.set_yticks(range(grid.shape[0]), grid.index)
    right.tick_params(length=0)
    right.set_title("share of each measure's variance (total Sobol index)")
    for side in right.spines.values():
        side.set_visible(False)
    return fig

"""The map of touch: contours over curvature and force of what the skin and a receptor feel, and
where small strain would do.

Drawn from the table of the sweep ``config/sweeps/map_of_touch.yaml`` alone.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from cysyk1999.publishing.style import FIELD, INK, study_figure, styled
from cysyk1999.publishing.write import publish

K, FORCE, RATE, STRAIN = "curvature (1/m)", "force (gf)", "rate (gf/s)", "strain"
DEPTH, WIDTH = "indentation_depth_end (mm)", "contact_width_end (mm)"
PRESSURE, ENERGY = "peak_pressure_end (Pa)", "strain_energy_915_um_end (Pa)"
IMPULSES = "predicted_rate_915_um_highest (impulses/s)"
COMPARED = (DEPTH, WIDTH, PRESSURE, ENERGY)
SHOWN = 40.0
"""Ramp rate (gf/s) of the panels that have one only: that of the thesis's chapter 4."""
TICKS = {1: "flat", 79: "79", 158: "158", 315: "315", 630: "630", 1260: "1260"}
_BEND = 60.0


def frame_of(table: pd.DataFrame) -> pd.DataFrame:
    """What is drawn, of the sweep's table: a row a scene, those that failed with their
    diagnosis.
    """
    return table[
        [
            "scene",
            K,
            FORCE,
            RATE,
            STRAIN,
            *COMPARED,
            IMPULSES,
            "estimated_error (1)",
            "failed",
            "diagnosis",
        ]
    ]


def small_strain_changes(frame: pd.DataFrame) -> pd.DataFrame:
    """Largest relative change (1) by small strain of depth, width, peak pressure and strain energy:
    force by curvature.
    """
    at = frame[frame[RATE] == SHOWN].set_index([FORCE, K])
    finite, small = (at[at[STRAIN] == word][list(COMPARED)] for word in ("finite", "small"))
    return (small / finite - 1).abs().max(axis=1, skipna=False).unstack()


def _over(frame: pd.DataFrame, column: str, rate: float = SHOWN) -> pd.DataFrame:
    rows = frame[(frame[STRAIN] == "finite") & (frame[RATE] == rate)]
    return rows.pivot(index=FORCE, columns=K, values=column)


def _levels(grids: list[pd.DataFrame], steps: tuple[float, ...]) -> np.ndarray:
    """Round levels: `steps` of every power of ten within the values."""
    values = np.concatenate([grid.values.ravel() for grid in grids])
    values = values[np.isfinite(values) & (values > 0)]
    powers = 10.0 ** np.arange(
        np.floor(np.log10(values.min())), np.ceil(np.log10(values.max())) + 1
    )
    levels = np.array([s * p for p in powers for s in steps])
    return levels[(levels > values.min()) & (levels < values.max())]


def _contours(ax: Axes, grid: pd.DataFrame, levels: np.ndarray, title: str) -> None:
    from matplotlib.colors import LogNorm

    norm = LogNorm(levels[0] / 2, levels[-1] * 8)  # no yellow under white lines
    low = max(levels[0] * 1e-3, 1e-9)
    high = levels[-1] * 4
    values = np.ma.masked_invalid(np.clip(grid.values, low, 0.99 * high))
    edges = [low, *levels, high]
    ax.contourf(grid.columns, grid.index, values, edges, cmap=FIELD, norm=norm)
    lines = ax.contour(grid.columns, grid.index, values, levels, colors="white", linewidths=0.7)
    ax.clabel(lines, fmt=lambda v: f"{v:g}", fontsize=6.5, colors="white")
    ax.set_title(title)


@styled
def contours(frame: pd.DataFrame) -> Figure:
    """Four maps of the held press, three of the predicted rate by ramp rate, and one of what small
    strain changes.
    """
    failed = int(frame["failed"].sum())
    error = frame.loc[frame[STRAIN] == "finite", "estimated_error (1)"]
    note = [
        f"{len(frame)} simulated presses and holds of 1 s, {failed} not converged (white); "
        "estimated error "
        f"{100 * error.median():.0f} % in the middle, {100 * error.max():.0f} % at most. Dots: "
        "the thesis's surfaces. a to d: "
        "end of the hold, ramp of 40 gf/s; e to g: largest rate by Eq 5-1, which has no ceiling; "
        "h: the most of a to d.",
    ]
    fig = study_figure("A map of touch: curvature, force and ramp rate", note, 4.9)
    axes = fig.subplots(2, 4, sharex=True, sharey=True)
    pa = 1e-3
    for ax, column, title, factor in zip(
        axes[0],
        COMPARED,
        (
            "indentation depth (mm)",
            "contact width (mm)",
            "peak pressure (kPa)",
            "energy at 915 µm (kPa)",
        ),
        (1, 1, pa, pa),
        strict=True,
    ):
        grid = factor * _over(frame, column)
        _contours(ax, grid, _levels([grid], (1, 2, 5)), title)
    rates = sorted(frame[RATE].unique())
    grids = [_over(frame, IMPULSES, rate) for rate in rates]
    levels = _levels([grid.clip(lower=1) for grid in grids], (1, 2, 5))
    for ax, grid, rate in zip(axes[1], grids, rates, strict=False):
        _contours(ax, grid, levels, f"SA-I, {rate:g} gf/s (impulses/s)")
    last = axes[1, 3]
    changes = 100 * small_strain_changes(frame)
    _contours(last, changes, np.array([5.0, 10, 20, 50, 100]), "small strain changes (%)")
    surfaces = sorted(frame[K].unique())
    for ax in axes.flat:
        ax.plot(
            surfaces,
            [20.0] * len(surfaces),
            "o",
            ms=2.6,
            mfc="white",
            mec=INK,
            mew=0.5,
            ls="none",
            clip_on=False,
        )
        ax.set_xscale(
            "function", functions=(lambda k: np.arcsinh(k / _BEND), lambda s: _BEND * np.sinh(s))
        )
        ax.set_xticks(list(TICKS), list(TICKS.values()), rotation=60)
        ax.set_xticks([], minor=True)
        ax.set_yscale("log")
        ax.set_yticks([2, 5, 10, 20, 50, 100, 200], ["2", "5", "10", "20", "50", "100", "200"])
        ax.set_yticks([], minor=True)
    for ax in axes[1]:
        ax.set_xlabel("curvature (1/m)")
    for ax in axes[:, 0]:
        ax.set_ylabel("force (gf)")
    return fig


def map_of_touch(job: SimpleNamespace) -> None:
    """Job: `scenes` (CSV) -> `picture`, its data beside it."""
    frame = frame_of(pd.read_csv(job.scenes[0]))
    publish(contours(frame), frame, job.picture[0])

"""The map of touch: contours over curvature and force of what the skin and a receptor feel, and
where small strain would do.

Drawn from the table of the sweep ``config/sweeps/map_of_touch.yaml`` alone.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from scipy.interpolate import RegularGridInterpolator

from cysyk1999.figures.findings import n
from cysyk1999.publishing.style import FIELD, INK, study_figure, styled
from cysyk1999.publishing.write import publish

K, FORCE, RATE, STRAIN = "curvature (1/m)", "force (gf)", "rate (gf/s)", "strain"
IMPULSES = "predicted_rate_915_um_highest (impulses/s)"
COMPARED = {
    "indentation_depth_end (mm)": ("indentation depth (mm)", 1.0),
    "contact_width_end (mm)": ("contact width (mm)", 1.0),
    "peak_pressure_end (Pa)": ("peak pressure (kPa)", 1e-3),
    "strain_energy_915_um_end (Pa)": ("energy at 915 µm (kPa)", 1e-3),
}
"""What small strain changes -> its title, and the factor to its unit."""
COLUMNS = ["scene", K, FORCE, RATE, STRAIN, *COMPARED, IMPULSES, "estimated_error (1)", "failed"]
COLUMNS += ["diagnosis"]
"""What is drawn, of the sweep's table: a row a scene, those that failed with their diagnosis."""
SHOWN = 40.0
"""Ramp rate (gf/s) of the panels that have one only: that of the thesis's chapter 4."""
TICKS = {1: "flat", 79: "79", 158: "158", 315: "315", 630: "630", 1260: "1260"}
FORCES = (2, 5, 10, 20, 50, 100, 200)
_BEND = 60.0
CEILING = 300.0
"""Impulses/s: an afferent cannot send more; Eq 5-1 knows no such limit."""


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


def _levels(grids: list[pd.DataFrame]) -> np.ndarray:
    """Round levels: 1, 2 and 5 of every power of ten within the values."""
    values = np.concatenate([grid.values.ravel() for grid in grids])
    low, high = values[values > 0].min(), np.nanmax(values)
    powers = np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1)
    levels = np.outer(10.0**powers, (1, 2, 5)).ravel()
    return levels[(levels > low) & (levels < high)]


def _contours(
    ax: Axes, grid: pd.DataFrame, levels: np.ndarray, title: str, ceiling: float = 0.0
) -> None:
    norm = LogNorm(levels[0] / 2, levels[-1] * 8)  # no yellow under white lines
    low, high = max(levels[0] * 1e-3, 1e-9), levels[-1] * 4
    where = _fine(grid.clip(levels[0] / 4, 0.99 * high))
    ax.contourf(*where, [low, *levels, high], cmap=FIELD, norm=norm)
    lines = ax.contour(*where, levels, colors="white", linewidths=0.7)
    middle = [path for path in lines.get_paths() if len(path.vertices) > 12]
    places = [path.vertices[len(path.vertices) // 2] for path in middle]
    ax.clabel(lines, fmt="%g", fontsize=6.5, colors="white", manual=places)
    ax.set_title(title)
    if ceiling and where[2].max() > ceiling:
        look = {"colors": "none", "hatches": ["////"]}
        ax.contourf(*where, [ceiling, where[2].max()], **look)


def _fine(grid: pd.DataFrame) -> tuple[np.ndarray, np.ndarray, np.ma.MaskedArray]:
    """A grid eight times as fine: the logarithm interpolated by monotone cubics over the axes as
    they are drawn; where a press did not converge, nothing.
    """
    across, up = np.arcsinh(grid.columns.to_numpy() / _BEND), np.log(grid.index.to_numpy())
    fine = [np.linspace(axis[0], axis[-1], 8 * len(axis)) for axis in (up, across)]
    at = np.meshgrid(*fine, indexing="ij")
    known = grid.interpolate(axis=1, limit_direction="both")
    values = RegularGridInterpolator((up, across), np.log(known.to_numpy()), method="pchip")(
        tuple(at)
    )
    missing = RegularGridInterpolator((up, across), grid.isna().to_numpy(float))(tuple(at)) > 0.01
    shown = np.ma.masked_array(np.exp(values), missing)
    return _BEND * np.sinh(fine[1]), np.exp(fine[0]), shown


@styled
def contours(frame: pd.DataFrame) -> Figure:
    """Four maps of the held press, three of the predicted rate by ramp rate, and one of what small
    strain changes.
    """
    failed = int(frame["failed"].sum())
    error = frame.loc[frame[STRAIN] == "finite", "estimated_error (1)"]
    note = (
        f"{len(frame)} simulated presses and holds of 1 s, {failed} not converged (white); "
        f"estimated error {100 * error.median():.0f} % in the middle, {100 * error.max():.0f} % at "
        "most. Dots: the thesis's surfaces. a to d: end of the hold, ramp of 40 gf/s; e to g: "
        f"largest rate by Eq 5-1 (hatched: above {CEILING:g}, more than a receptor can send); h: "
        "the most of a to d."
    )
    changes = 100 * small_strain_changes(frame)
    title = (
        f"From {n(frame[FORCE].min())} to {n(frame[FORCE].max())} gf and from a plate to "
        f"{n(frame[K].max(), 4)} 1/m, small strain changes results by {n(changes.min(axis=None))} "
        f"to {n(changes.max(axis=None))} %"
    )
    fig = study_figure(title, [note], 4.9)
    axes = fig.subplots(2, 4, sharex=True, sharey=True)
    for ax, (column, (title, factor)) in zip(axes[0], COMPARED.items(), strict=True):
        grid = factor * _over(frame, column)
        _contours(ax, grid, _levels([grid]), title)
    rates = {rate: _over(frame, IMPULSES, rate) for rate in sorted(frame[RATE].unique())}
    levels = _levels([grid.clip(1, CEILING) for grid in rates.values()])
    for ax, (rate, grid) in zip(axes[1], rates.items(), strict=False):
        _contours(ax, grid, levels, f"SA-I, {rate:g} gf/s (impulses/s)", CEILING)
    levels = np.array([5.0, 10, 20, 50, 100])
    _contours(axes[1, 3], changes, levels, "small strain changes (%)")
    surfaces = sorted(frame[K].unique())
    dots = {"ms": 2.6, "mfc": "white", "mec": INK, "mew": 0.5, "clip_on": False}
    bent = (lambda k: np.arcsinh(k / _BEND), lambda s: _BEND * np.sinh(s))
    for ax in axes.flat:
        ax.plot(surfaces, [20.0] * len(surfaces), "o", **dots)
        ax.set_xscale("function", functions=bent)
        ax.set_yscale("log")
        ax.set_xticks(list(TICKS), TICKS.values(), rotation=60)
        ax.set_yticks(FORCES, map(str, FORCES))
        ax.minorticks_off()
    for ax in axes[1]:
        ax.set_xlabel("curvature (1/m)")
    for ax in axes[:, 0]:
        ax.set_ylabel("force (gf)")
    return fig


def map_of_touch(job: SimpleNamespace) -> None:
    """Job: `scenes` (CSV) -> `picture`, its data beside it."""
    frame = pd.read_csv(job.scenes[0])[COLUMNS]
    publish(contours(frame), frame, job.picture[0])

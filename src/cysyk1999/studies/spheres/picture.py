"""Pictures of what is round: forces of four subjects under plate, probe and point, and the sheet of
one sphere from the skin to impulses. Each is drawn from its data frame alone.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator
from matplotlib.tri import Triangulation

from cysyk1999.figures.findings import n, span
from cysyk1999.measures.quantities import CURVATURE, GIVEN_RATE, SED, P, X, Y
from cysyk1999.publishing.style import (
    FIELD,
    GREY,
    INK,
    MEASURED,
    PALE,
    curvature_colour,
    handle,
    in_kilo,
    look_of,
    ordered,
    study_figure,
    styled,
)
from cysyk1999.receptors.fits import r_squared, rms
from fingerpad.measures.features import is_simulated

DEPTH, FORCE, LOW, HIGH = "depth (mm)", "force (N)", "force_low (N)", "force_high (N)"
AREA, LOAD, DISTANCE = "contact area (mm2)", "force (gf)", "distance (mm)"
IMPULSES = "impulses of the ramp over those under a plate (1)"
PROBES = {"plate": "fitted", "6.35 mm probe": "fitted", "point probe": "predicted"}
"""Panels of probes, in their order, and what was done with what was measured under each."""
FITTED_AT = 15
MARKED = {"10": "o", "15": "s", "20": "^"}


def _r2(frame: pd.DataFrame, probes: tuple[str, ...]) -> pd.Series:
    """R2 of every subject over some probes together."""
    rows = frame[frame["panel"].isin(probes)]
    shares = {}
    for who, group in rows.groupby("series"):
        data, ours = [], []
        for _, part in group.groupby("panel"):
            own = part[is_simulated(part)].sort_values(DEPTH)
            seen = part[~is_simulated(part)]
            data.append(seen[FORCE].to_numpy())
            ours.append(np.interp(seen[DEPTH], own[DEPTH], own[FORCE]))
        shares[who] = r_squared(np.concatenate(data), np.concatenate(ours))
    return pd.Series(shares)


@styled
def forces(frame: pd.DataFrame) -> Figure:
    """Force over depth under three probes, four subjects, and contact area over force."""
    fitted, point = _r2(frame, ("plate", "6.35 mm probe")), _r2(frame, ("point probe",))
    title = (
        "One dome for all and one modulus factor a subject: R² "
        f"{fitted.min():.3f} to {fitted.max():.3f} under plate and probe together; the point, "
        f"which was not fitted, is {'missed' if point.max() < 0.5 else 'met'} (R² "
        f"{n(point.min())} to {n(point.max())})"
    )
    note = (
        "Lines: simulated, bodies of revolution pressed slowly; bands: 95 % confidence of the "
        "factor. Points: measured (Dandekar, Raju and Srinivasan 2003; digitised by a third "
        "party). The point's tip, a cone of 30° with a radius of 0.5 mm, is assumed. Dotted: 1 N, "
        "above which a cap has not the shape of a pad. d, e: simulated; grey: ∝ force²ᐟ³, as area "
        "and depth of a ball under a plate are at small loads (Hertz), and as depth was found of "
        "fingertips (koreascience JAKO200111919995062)."
    )
    fig = study_figure(title, [note], 3.1)
    grid = fig.add_gridspec(2, 4)
    axes = [fig.add_subplot(grid[:, k]) for k in range(3)]
    looks = ordered("subject", sorted(frame["series"].unique()))
    for ax, (probe, done) in zip(axes[:3], PROBES.items(), strict=True):
        for who, look in looks.items():
            rows = frame[(frame["panel"] == probe) & (frame["series"] == who)]
            own, seen = rows[is_simulated(rows)], rows[~is_simulated(rows)]
            ax.fill_between(own[DEPTH], own[LOW], own[HIGH], color=look["color"], alpha=0.15, lw=0)
            ax.plot(own[DEPTH], own[FORCE], color=look["color"], lw=1.1)
            ax.plot(seen[DEPTH], seen[FORCE], look["marker"], color=look["color"], ms=3.5)
        if ax.get_ylim()[1] > 1:
            ax.axhline(1.0, color=GREY, lw=0.7, ls=":")
        ax.set(xlabel="indentation depth (mm)", title=f"{probe}, {done}", xlim=(0, None))
        ax.set_ylim(0, 1.12 * frame.loc[frame["panel"] == probe, FORCE].max())
    axes[0].set_ylabel(FORCE)
    entries = [
        handle(f"subject {who}", ls="none", marker=look["marker"], color=look["color"], ms=3.5)
        for who, look in looks.items()
    ]
    axes[0].legend(handles=entries, loc="upper left", handlelength=1.0)
    area, approach = fig.add_subplot(grid[0, 3]), fig.add_subplot(grid[1, 3])
    _over_force(area, frame, looks, AREA)
    _over_force(approach, frame, looks, DEPTH)
    area.set(ylabel="area (mm²)", title="contact under the plate")
    approach.set(xlabel=FORCE, ylabel="depth (mm)", title="approach of the plate")
    return fig


def _over_force(ax: Axes, frame: pd.DataFrame, looks, quantity: str) -> None:
    """A quantity over force under the plate, on logarithmic axes, beside force^(2/3)."""
    rows = frame[(frame["panel"] == "plate") & is_simulated(frame) & (frame[AREA] > 0)]
    for who, look in looks.items():
        own = rows[rows["series"] == who]
        ax.loglog(own[FORCE], own[quantity], color=look["color"], ls=look["ls"])
    force = np.array([rows[FORCE].min(), rows[FORCE].max()])
    first = rows.loc[rows[FORCE].idxmin()]
    law = first[quantity] * (force / first[FORCE]) ** (2 / 3)
    ax.loglog(force, law, color=GREY, lw=0.8, ls="--")
    for axis, steps in ((ax.xaxis, (1,)), (ax.yaxis, (1, 3))):
        axis.set_major_locator(LogLocator(10, steps))
        axis.set_major_formatter("{x:g}")
        axis.set_minor_locator(NullLocator())


# -- one sphere, from the skin to impulses ---------------------------------------------------------


@styled
def field(frame: pd.DataFrame) -> Figure:
    """A sphere on the pad and strain energy below it; pressure over radius; rates over curvature
    and force, fields over distance and impulses of the ramp, measured beside predicted.
    """
    panels = dict(list(frame.groupby("panel")))
    rates = panels["rates"]
    errors = {force: _error(part) for force, part in rates.groupby(LOAD)}
    others = [error for force, error in errors.items() if force != FITTED_AT]
    title = (
        f"Constants fitted to spheres at {FITTED_AT} gf predict those at other forces within "
        f"{span(pd.Series(others), 'impulses/s')} (r.m.s.), and fields over distance within "
        f"{n(_error(panels['fields']))}"
    )
    note = (
        "Lines and the field: simulated, a sphere on the thesis's pad as a body of revolution. "
        "Points: measured in monkeys (Goodwin, Browning and Wheat 1995; digitised by a third "
        "party). c, d: first second, Eq 5-1 at 915 µm, its A1 and threshold fitted to the squares "
        "of c alone. e: rapidly adapting, over the response under a plate of the same force, by "
        "a law with assumed constants. Curvature 0: a plate."
    )
    fig = study_figure(title, [note], 4.7)
    grid = fig.add_gridspec(2, 6)
    _section(fig, fig.add_subplot(grid[0, :4], anchor="W"), panels)
    _pressure(fig.add_subplot(grid[0, 4:]), panels["pressure"])
    _over_curvature(fig.add_subplot(grid[1, :2]), rates)
    _over_distance(fig.add_subplot(grid[1, 2:4]), panels["fields"])
    _rapid(fig.add_subplot(grid[1, 4:]), panels["rapidly adapting"])
    return fig


def _error(rows: pd.DataFrame) -> float:
    """Root mean square of predicted less measured rates, which stand in the same order."""
    own = is_simulated(rows)
    return rms(rows.loc[own, GIVEN_RATE].to_numpy() - rows.loc[~own, GIVEN_RATE].to_numpy())


def _section(fig: Figure, ax: Axes, panels) -> None:
    """Strain energy density in a section, with lines of equal energy, below the sphere."""
    half, sphere = panels["field"], panels["sphere"]
    x = np.concatenate([half[X], -half[X]])
    y, values = np.tile(half[Y], 2), np.log10(np.tile(half[SED].clip(lower=1e-3), 2))
    triangles = Triangulation(x, y)
    corners = np.column_stack([x, y])[triangles.triangles]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
    triangles.set_mask(sides > 0.9)
    top = np.ceil(3 * values.max()) / 3
    levels = np.linspace(top - 2.5, top, 31)
    drawn = ax.tricontourf(triangles, values, levels, cmap=FIELD, extend="both")
    lines = ax.tricontour(
        triangles, values, np.arange(top - 2.5, top, 1 / 3), colors="white", linewidths=0.4
    )
    lines.set_linestyle("solid")
    outline = sphere[sphere[Y] < half[Y].max() + 1.6]
    sides = np.concatenate([-outline[X].to_numpy()[::-1], outline[X].to_numpy()])
    heights = np.concatenate([outline[Y].to_numpy()[::-1], outline[Y].to_numpy()])
    ax.fill(sides, heights, fc=PALE, ec=INK, lw=0.8)
    ax.text(0, heights.max() - 0.2, "sphere", ha="center", va="top")
    ax.set(aspect="equal", xlabel=X.label, ylabel=Y.label, xlim=(-6, 6))
    ax.set_title(f"a sphere of 340 1/m at {FITTED_AT} gf, held")
    bar = fig.colorbar(drawn, ax=ax, label="strain energy density (Pa)", pad=0.01, aspect=18)
    ticks = np.arange(np.ceil(top - 2.5), top + 1e-9)
    bar.set_ticks(ticks, labels=[f"{10**tick:g}" for tick in ticks])
    bar.outline.set_visible(False)


def _pressure(ax: Axes, rows: pd.DataFrame) -> None:
    """Contact pressure over the distance from the axis, a line a curvature."""
    for curvature, line in rows.groupby(CURVATURE):
        name = "plate" if curvature == 0 else f"{curvature:g}"
        look = {"color": curvature_colour(curvature), "ls": "--" if curvature > 600 else "-"}
        ax.plot(line[X], line[P], label=name, **look)
    in_kilo(ax.yaxis)
    ax.set(xlabel="distance from the axis (mm)", xlim=(0, None), ylim=(0, None))
    ax.set(ylabel="contact pressure (kPa)", title=f"held at {FITTED_AT} gf")
    ax.legend(title="curvature (1/m)", loc="upper right")


def _over_curvature(ax: Axes, rows: pd.DataFrame) -> None:
    """Rates at three forces, predicted (lines) and measured (points)."""
    for force, part in rows.groupby(LOAD):
        own, seen = part[is_simulated(part)], part[~is_simulated(part)]
        name = f"{force:g}"
        ax.plot(own[CURVATURE], own[GIVEN_RATE], color=INK, ls=look_of("force (gf)", name)["ls"])
        look = {"color": MEASURED, "ls": "none", "ms": 3.5, "clip_on": False}
        label = f"{name} gf" + ", fitted" * (force == FITTED_AT)
        ax.plot(seen[CURVATURE], seen[GIVEN_RATE], marker=MARKED[name], label=label, **look)
    ax.set(xlabel=CURVATURE.label, ylabel="mean rate, first second (impulses/s)")
    ax.set(xlim=(0, None), ylim=(0, None), title="slowly adapting, under the centre")
    ax.legend(loc="upper left", handlelength=1.2)


def _over_distance(ax: Axes, rows: pd.DataFrame) -> None:
    """Receptive fields over distance, predicted and measured, a colour a curvature."""
    for curvature, part in rows.groupby(CURVATURE):
        own, seen = part[is_simulated(part)], part[~is_simulated(part)]
        colour = curvature_colour(curvature)
        ax.plot(own[DISTANCE], own[GIVEN_RATE], color=colour)
        look = {"color": colour, "ls": "none", "marker": "o", "ms": 3}
        ax.plot(seen[DISTANCE], seen[GIVEN_RATE], label=f"{curvature:g} 1/m", **look)
    ax.set(xlabel="distance from the centre of the field (mm)", ylim=(0, None))
    ax.set(title=f"slowly adapting, beside the centre, {FITTED_AT} gf")
    ax.legend(loc="upper right", handlelength=1.0)


def _rapid(ax: Axes, rows: pd.DataFrame) -> None:
    """Responses of rapidly adapting receptors over that under a plate, on a logarithmic axis."""
    for force, part in rows.groupby(LOAD):
        own, seen = part[is_simulated(part)], part[~is_simulated(part)]
        name = f"{force:g}"
        ax.plot(own[CURVATURE], own[IMPULSES], color=INK, ls=look_of("force (gf)", name)["ls"])
        look = {"color": MEASURED, "ls": "none", "ms": 3.5, "clip_on": False}
        ax.plot(seen[CURVATURE], seen[IMPULSES], marker=MARKED[name], label=f"{name} gf", **look)
    ax.set(xlabel=CURVATURE.label, xlim=(0, None), yscale="log")
    ax.set(ylabel="response over a plate's (1)", title="rapidly adapting")
    ax.set_yticks([1, 2, 5, 10], ["1", "2", "5", "10"])
    ax.minorticks_off()
    ax.legend(loc="upper left", handlelength=1.2)


STUDIES: dict[str, Callable[[pd.DataFrame], Figure]] = {
    "spheres_forces": forces,
    "spheres_field": field,
}
"""Study figure -> function of its data frame."""

"""The storyboard of a stroke: five deformed sections as one convexity passes, and on one axis of
distance what a row of receptors across the pad meets, feels and answers.
"""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import FancyArrowPatch
from scipy.interpolate import LinearNDInterpolator

from cysyk1999.figures.findings import n
from cysyk1999.measures.quantities import DISTANCE, SED, P, X, Y
from cysyk1999.measures.responses import RECEPTOR_DEPTH, SEED, predicted_rate, raster
from cysyk1999.publishing.style import (
    CATEGORIES,
    DASHED,
    GREY,
    INK,
    MEANINGS,
    haloed,
    handle,
    header_legend,
    in_kilo,
    study_figure,
    styled,
)
from cysyk1999.studies.views.frames import (
    SLIPS,
    STATE,
    STROKE,
    Histories,
    elements,
    lines,
    moved_nodes,
    nearest,
)
from cysyk1999.studies.views.picture import colour_bar, draw_field, energy_scale
from fingerpad.measures.features import PRESSURE, skin_at
from fingerpad.measures.strokes import arcs, distance, loaded

ROW = (-2.8e-3, -1.4e-3, 0.0, 1.4e-3, 2.8e-3)
"""Offsets (m) of the receptors that are followed, or the nearest that there are."""
WINDOW = (-4.9, 4.9, 2.4, 6.4)
"""mm, of the sections' elements."""
LOWEST = 1.0
"""mm, of lines, which end below the window."""
PASSES = 78.74
"""1/m, the convexity that passes."""
AROUND = 6.0
"""mm of the stroke before and after it passes that are shown."""
OFFSET, ANSWER = "offset (mm)", "impulses"
DRAG = "drag (mm)"
COLOURS = [look["color"] for look in MEANINGS["speed (mm/s)"].values()]
SECTION = "section"
INNER = 2.0
"""mm from the middle, within which receptors are under the contact all the time."""
RECEPTOR = {"color": COLOURS[2], "marker": "o", "ms": 3.4, "ls": "none"}


# --- data -----------------------------------------------------------------------------------------


def row_of(history: xr.Dataset) -> list[int]:
    """The receptors that are followed."""
    offsets = history["receptor_offset"].values
    return list(dict.fromkeys(int(np.argmin(abs(offsets - place))) for place in ROW))


def where_receptors_are(history: xr.Dataset, snapshot: int) -> pd.DataFrame:
    """Places of the followed receptors, at rest and at a snapshot."""
    points, moved = 1e3 * history["node_position"].values, moved_nodes(history, snapshot)
    near = points[:, 1] > 0
    x = 1e3 * history["receptor_offset"].values[row_of(history)]
    depth = 1e3 * history["receptor_depth"].values[row_of(history)]
    order = np.argsort(history["skin_x"].values)
    upper = order[history["skin_y"].values[order] > 0]
    skin = (1e3 * history[name].values[upper] for name in ("skin_x", "skin_y"))
    rest = np.column_stack([x, np.interp(x, *skin) - depth])
    there = LinearNDInterpolator(points[near], moved[near])(rest)
    kinds = {"at rest": rest, "receptor": there}
    parts = [
        pd.DataFrame({"series": k, OFFSET: x, X: v[:, 0], Y: v[:, 1]}) for k, v in kinds.items()
    ]
    return pd.concat(parts, ignore_index=True)


def skin_of(history: xr.Dataset, snapshot: int) -> pd.DataFrame:
    """The upper skin at rest, and at a snapshot its contact: where it sticks or slips."""
    k = nearest(history, "time", float(history["snapshot_time"].values[snapshot]))
    upper = np.flatnonzero(history["skin_y"].values > 0)
    upper = upper[np.argsort(history["skin_x"].values[upper])]
    x, y = skin_at(history, k)
    touching = upper[history[PRESSURE].values[k, upper] > 0]
    contact = {
        "series": "contact",
        X: 1e3 * x[touching],
        Y: 1e3 * y[touching],
        P: history[PRESSURE].values[k, touching],
        STATE: history["contact_state"].values[k, touching],
    }
    rest = {name: 1e3 * history[f"skin_{name[0]}"].values[upper] for name in (X, Y)}
    return pd.concat([pd.DataFrame({"series": "skin at rest", **rest}), pd.DataFrame(contact)])


def storyboard_rows(histories: Histories) -> pd.DataFrame:
    """Sections at the snapshots; traces of the followed receptors over the stroke distance."""
    history = histories[STROKE]
    stroke, parts = loaded(history), []
    along = 1e3 * distance(stroke)
    for snapshot, time in enumerate(history["snapshot_time"].values):
        at = float(np.interp(time, stroke["time"].values, along))
        k = nearest(history, "time", float(time))
        drag = 1e3 * float(history["centre_lateral_displacement"].values[k])
        around = lines(history, snapshot)
        pieces = elements(history, snapshot, WINDOW), around[around[Y] > LOWEST]
        pieces += where_receptors_are(history, snapshot), skin_of(history, snapshot)
        section = pd.concat(pieces, ignore_index=True)
        parts.append(
            section.assign(panel=f"{SECTION} {snapshot + 1}", **{DISTANCE: at, DRAG: drag})
        )
    (convexity,) = (a for a in arcs(stroke) if abs(a.curvature - PASSES) < 1)
    middle = 500 * (convexity.start + convexity.end)
    skin = np.flatnonzero(stroke["skin_y"].values > 0)
    skin = skin[np.argsort(stroke["skin_x"].values[skin])]
    at_rest, pressures = stroke["skin_x"].values[skin], stroke[PRESSURE].values[:, skin]
    for number, receptor in enumerate(row_of(history)):
        x = float(history["receptor_offset"].values[receptor])
        of = {OFFSET: 1e3 * x, "passes (mm)": middle - 1e3 * x}
        felt = {
            P: [np.interp(x, at_rest, values) for values in pressures],
            SED: stroke["strain_energy_density"].values[:, receptor],
        }
        trace = pd.DataFrame({"panel": "traces", DISTANCE: along, **felt, **of})
        rate = predicted_rate(history, RECEPTOR_DEPTH, offset=x)
        ticks = raster(rate, 1, SEED + number)[[DISTANCE]].assign(panel=ANSWER, **of)
        parts += [trace, ticks]
    rows = pd.concat(parts, ignore_index=True)
    near = rows[DISTANCE].between(middle - AROUND, middle + AROUND)
    return rows[near].reset_index(drop=True)


# --- picture --------------------------------------------------------------------------------------


def named(offset: float) -> str:
    """An offset (mm) in words."""
    return f"{offset:.1f}".replace("-", "−")


def peak_of(own: pd.DataFrame) -> tuple[float, float]:
    """Distance and size of the largest energy of one receptor while the convexity passes it."""
    passes = own["passes (mm)"].max()
    near = own[(own["panel"] == "traces") & (own[DISTANCE] - passes).between(-1.0, 2.5)]
    return tuple(near.loc[near[SED].idxmax(), [DISTANCE, SED]])


def _section(ax: Axes, rows: pd.DataFrame, scale) -> object:
    """One deformed section: field, skin at rest, contact, receptors and how they have moved."""
    drawn = draw_field(ax, rows[rows["series"] == "element"], rows, scale, 7.4)
    rest = rows[rows["series"] == "skin at rest"]
    ax.plot(rest[X], rest[Y], color=GREY, ls=DASHED, lw=0.6)
    contact = rows[rows["series"] == "contact"]
    for slips, colour in ((False, CATEGORIES[0]), (True, CATEGORIES[1])):
        part = contact[(contact[STATE] == SLIPS) == slips]
        ax.plot(part[X], part[Y], "o", ms=1.8, color=colour, zorder=4)
    before, now = (
        rows[rows["series"] == name].sort_values(OFFSET) for name in ("at rest", "receptor")
    )
    for k, (old, new) in enumerate(zip(before[[X, Y]].values, now[[X, Y]].values, strict=True)):
        ax.plot(*np.transpose([old, new]), color="white", lw=0.8, zorder=4)
        ax.plot(*old, "o", ms=2.2, mfc="none", mec="white", mew=0.6, zorder=4)
        ax.plot(*new, "o", ms=3.4, mfc=COLOURS[k], mec="white", mew=0.6, zorder=5)
    ax.set(xlim=(-4.6, 4.6), ylim=(2.7, 7.2), xticks=[-4, 0, 4], yticks=[3, 4, 5, 6])
    return drawn


def _traces(axes: list[Axes], frame: pd.DataFrame, marks: list[float]) -> None:
    """Pressure, energy and impulses of every receptor over the stroke distance."""
    offsets = sorted(frame[OFFSET].dropna().unique())
    press, felt, answer = axes
    for k, offset in enumerate(offsets):
        own = frame[frame[OFFSET] == offset]
        look = {"color": COLOURS[k], "lw": 1.1}
        trace = own[own["panel"] == "traces"]
        press.plot(trace[DISTANCE], trace[P], **look)
        felt.plot(trace[DISTANCE], trace[SED], **look)
        at = peak_of(own)
        where = {"textcoords": "offset points", "ha": "center", "fontsize": 6, **haloed()}
        felt.annotate(named(offset), at, (0, 2), color=COLOURS[k], **where)
        ticks = own.loc[own["panel"] == ANSWER, DISTANCE]
        answer.vlines(ticks, k - 0.35, k + 0.35, color=COLOURS[k], lw=0.9)
        answer.plot(own["passes (mm)"].max(), k, "v", ms=3.5, color=COLOURS[k], mfc="none")
    for ax in axes:
        for place in marks:
            ax.axvline(place, color=GREY, lw=0.5, ls=DASHED, zorder=0)
    press.set(ylabel="pressure\n(kPa)", ylim=(0, None))
    in_kilo(press.yaxis)
    felt.set(ylabel="strain energy\ndensity (Pa)", ylim=(0, None))
    answer.set_yticks(range(len(offsets)), map(named, offsets))
    answer.set(ylabel="impulses of\nreceptor at (mm)", ylim=(-0.6, len(offsets) - 0.4))
    answer.set(
        xlabel="stroke distance (mm)",
        xlim=frame.loc[frame["panel"] == "traces", DISTANCE].agg(["min", "max"]),
    )
    for ax in (press, felt):
        ax.tick_params(labelbottom=False)


@styled
def storyboard(frame: pd.DataFrame) -> Figure:
    """Five sections as one convexity passes from right to left; below, five receptors."""
    sections = [name for name in frame["panel"].unique() if name.startswith(SECTION)]
    drag = frame.loc[frame["panel"].isin(sections), DRAG].dropna()
    inner = frame[frame[OFFSET].abs() < INNER]
    late = [peak_of(own)[0] - own["passes (mm)"].max() for _, own in inner.groupby(OFFSET)]
    title = (
        f"The surface drags the skin along by {n(drag.abs().mean())} mm: a receptor feels a "
        f"convexity most {n(min(late))} to {n(max(late))} mm after it is over its place at rest"
    )
    note = (
        "Simulated, not measured: 79 1/m, 27 gf, 10 mm/s, friction 0.25. Receptors 915 µm deep; "
        "white rings: at rest; dashed: skin at rest, and the five instants. Triangles: the "
        "convexity's middle is over the receptor's place at rest. Impulses by Eq 5-1, one trial."
    )
    fig = study_figure(title, [note], 4.7)
    grid = fig.add_gridspec(4, len(sections), height_ratios=[1.35, 1, 1, 1])
    scale = energy_scale(frame)
    first, drawn, axes = None, None, []
    for k, name in enumerate(sections):
        ax = fig.add_subplot(grid[0, k], sharey=first)
        first = first or ax
        rows = frame[frame["panel"] == name]
        drawn = _section(ax, rows, scale)
        ax.set_title(f"at {rows[DISTANCE].iloc[0]:.1f} mm")
        ax.tick_params(labelleft=ax is first)
        arrow = {"arrowstyle": "->,head_length=3,head_width=2", "color": INK, "lw": 0.9}
        ax.add_patch(FancyArrowPatch((2.2, 7.0), (-2.2, 7.0), **arrow))
        axes.append(ax)
    first.set_ylabel(Y.label)
    colour_bar(fig, drawn, axes, "strain energy\ndensity (Pa)", aspect=9, shrink=0.85)
    marks = [float(frame.loc[frame["panel"] == name, DISTANCE].iloc[0]) for name in sections]
    below = [fig.add_subplot(grid[1, :])]
    below += [fig.add_subplot(grid[k, :], sharex=below[0]) for k in (2, 3)]
    _traces(below, frame, marks)
    looks = {"sticks": CATEGORIES[0], "slips": CATEGORIES[1]}
    entries = [handle(word, color=c, marker="o", ms=2.5, ls="none") for word, c in looks.items()]
    entries += [handle("receptor, from where it is at rest (ring)", **RECEPTOR)]
    header_legend(fig, entries, handletextpad=0.1, handlelength=1.4)
    return fig

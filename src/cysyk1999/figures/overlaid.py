"""Pages that lay nine surfaces, or five velocities, over each other, and show one of them whole
beside or below: what differs is seen at once.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Picture
from pandas import DataFrame

from cysyk1999.figures import axes as axs
from cysyk1999.figures.grammar import Figure, Lines, Phases
from cysyk1999.measures.quantities import DISTANCE, P_CENTRE, P_SCALED, SED, TIME, P
from cysyk1999.publishing import style
from fingerpad.measures.features import PHASES, SIMULATED, STEADY, SURFACES, TOP

EXAMPLE = "210"
"""The surface that is shown whole."""
VELOCITY = "10 mm/s"
"""The velocity that the others are compared with."""
IN_KILO = (P, P_CENTRE)
SMALL = {"fontsize": 6.5, "handlelength": 1.4, "borderaxespad": 0.2, "labelspacing": 0.3}


# --- surfaces -------------------------------------------------------------------------------------


def legend_of_surfaces(ax: Axes, **options: object) -> None:
    """A legend of the nine surfaces inside a panel."""
    entries = [
        style.handle("flat" if name == "flat" else name, **axs.look(name), lw=1.6)
        for name in SURFACES
    ]
    title = {"title": "curvature (1/m)", "title_fontsize": 6.5}
    ax.legend(handles=entries, **SMALL | title | options)


def legend_of_phases(ax: Axes, phases: tuple[str, ...], **options: object) -> None:
    """A legend of the lines of the example."""
    looks = {phase: axs.look(EXAMPLE) | axs.PHASE_LINES[phase] for phase in phases}
    ax.legend(handles=style.handles(looks), **SMALL | options)


def surfaces_at(ax: Axes, frame: DataFrame, spec: Figure, phase: str) -> None:
    """One curve a surface, at one instant."""
    rows = axs.simulated(frame)
    for name, curve in rows[rows["phase"] == phase].groupby("surface", sort=False):
        axs.curve(ax, curve, spec.x, spec.y[0], lw=1.1, **axs.look(name))


def ranges_beside(ax: Axes, ranges: DataFrame, y: str, title: str, width: float = 0.2) -> None:
    """The thesis's ranges of surfaces as bars at the right of a panel, broken where their reading
    is uncertain.
    """
    if ranges.empty:
        return
    side = ax.inset_axes((1.03, 0, width, 1), sharey=ax)
    for column, (label, rows) in enumerate(ranges.groupby("surface", sort=False)):
        doubt = rows["source"].str.contains("uncertain").any()
        line = axs.look(label) | {"lw": 2.2, "ls": (0, (0.6, 0.5)) if doubt else "-"}
        side.plot([column, column], rows[y], **line, solid_capstyle="butt")
    side.set(xticks=[], xlim=(-0.7, len(SURFACES) - 0.3))
    side.tick_params(labelleft=False)
    side.set_title(title, fontsize=6)


def thesis_axes(frame: DataFrame, y: str) -> DataFrame:
    """The thesis's ranges of a vertical axis, of every surface that has one."""
    rows = axs.from_source(frame, "thesis axis range")
    rows = rows[rows[y].notna() & rows["surface"].notna()]
    order = rows["surface"].map({name: k for k, name in enumerate(SURFACES)})
    return rows.loc[order.sort_values(kind="stable").index]


OF_THE_AXES = "thesis's axes\n(broken: uncertain)"


def skins(fig: Picture, frame: DataFrame, spec: Figure) -> None:
    """The skin under nine surfaces in steady state; under one at rest, at the top of the ramp and
    in steady state.
    """
    left, right = fig.subplots(1, 2, sharey=True)
    surfaces_at(left, frame, spec, STEADY)
    left.set_title("steady state, nine surfaces")
    legend_of_surfaces(left, loc="lower center", ncols=3)
    order = (axs.AT_REST, STEADY, TOP)
    Phases(order=order)(right, axs.rows_of(frame, "surface", EXAMPLE), spec)
    right.set_title(axs.surface_name(EXAMPLE))
    legend_of_phases(right, (axs.AT_REST, TOP, STEADY), loc="lower center")
    for ax in (left, right):
        axs.limit_axes(ax, frame, x=spec.x)
        ax.set(ylim=(3, 6), xticks=[-10, -5, 0, 5, 10], yticks=[3, 4, 5, 6], xlabel=spec.x.label)
    left.set_ylabel(spec.y[0].label)


def pressures_over_sinking(fig: Picture, frame: DataFrame, spec: Figure) -> None:
    """Pressure over displacement under nine surfaces at the top of the ramp; under one at every
    instant shown.
    """
    left, right = fig.subplots(1, 2, width_ratios=(1.25, 1))
    surfaces_at(left, frame, spec, TOP)
    left.set_title("top of the ramp, nine surfaces")
    ranges = thesis_axes(frame, P)
    left.set(xlim=(0, 1.5), ylim=(0, np.nanmax([ranges[P].max(), axs.simulated(frame)[P].max()])))
    ranges_beside(left, ranges, P, OF_THE_AXES)
    legend_of_surfaces(left, loc="upper left")
    rows = axs.rows_of(frame, "surface", EXAMPLE)
    axs.limit_axes(right, rows, spec.x, P)
    Phases()(right, rows, spec)
    right.set_title(axs.surface_name(EXAMPLE))
    legend_of_phases(right, (PHASES[0], TOP, STEADY), loc="upper left")
    for ax in (left, right):
        ax.set(xlabel=spec.x.label)
        style.in_kilo(ax.yaxis)
    left.set_ylabel("contact pressure (kPa)")


def energies_and_pressures(fig: Picture, frame: DataFrame, spec: Figure) -> None:
    """Strain energy, and scaled pressure, under nine surfaces; both under one."""
    left, middle, right = fig.subplots(1, 3, width_ratios=(1, 1.35, 1.1))
    for ax, q, look in ((left, SED, axs.FIRST), (middle, P_SCALED, axs.SECOND)):
        for name, rows in axs.simulated(frame).groupby("surface", sort=False):
            axs.curve(ax, rows, TIME, q, **axs.look(name) | look | {"linewidth": 1.1})
    ranges = thesis_axes(frame, SED)
    highest = np.nanmax([ranges[SED].max(), axs.simulated(frame)[P_SCALED].max()])
    for ax, words in ((left, "strain energy density"), (middle, "contact pressure × 0.04")):
        ax.set(title=words, ylim=(0, highest))
    middle.tick_params(labelleft=False)
    ranges_beside(middle, ranges, SED, OF_THE_AXES, 0.3)
    legend_of_surfaces(left, loc="upper right", ncols=2, columnspacing=1.0)
    rows = axs.rows_of(frame, "surface", EXAMPLE)
    axs.limit_axes(right, axs.together(rows, spec.y), y=SED)
    looks = {SED: axs.FIRST, P_SCALED: axs.SECOND}
    names = {SED: "strain energy", P_SCALED: "pressure × 0.04"}
    Lines(looks=looks, names=names)(right, rows, spec)
    right.set_title(f"both, {axs.surface_name(EXAMPLE)}")
    right.legend(loc="lower right", **SMALL | {"handlelength": 2.2})
    for ax in (left, middle, right):
        ax.set(xlim=(0, 2.5), xticks=[0, 1, 2], xlabel=TIME.label)
    left.set_ylabel("energy density, pressure × 0.04 (Pa)")


# --- velocities -----------------------------------------------------------------------------------

Traces = Mapping[str, DataFrame]


def traces_of(frame: DataFrame) -> Traces:
    """The simulated rows of every velocity."""
    return dict(list(axs.simulated(frame).dropna(subset=["series"]).groupby("series", sort=False)))


def apart(ax: Axes, rows: DataFrame, other: DataFrame, y: str, **look: object) -> float:
    """Draw what one trace over the way has more than another, in its unit; the largest of it."""
    x = rows[DISTANCE].to_numpy()
    more = rows[y].to_numpy() - np.interp(x, other[DISTANCE], other[y])
    ax.plot(x, more, **look)
    return np.abs(more).max()


def over_the_way(axes: list[Axes], frame: DataFrame) -> None:
    """Limits and words of panels that lie below each other over the stroke's distance."""
    axs.limit_axes(axes[-1], frame, x=DISTANCE)
    axes[-1].set_xlabel(DISTANCE.label)
    for ax in axes[:-1]:
        ax.tick_params(labelbottom=False)


def in_its_unit(ax: Axes, q: str, words: str) -> None:
    """Name a vertical axis in Pa or kPa."""
    ax.set_ylabel(f"{words} (Pa)")
    if q in IN_KILO:
        style.in_kilo(ax.yaxis)


def velocities(fig: Picture, frame: DataFrame, spec: Figure) -> None:
    """Five velocities over each other below the surface, and what they have more than the one of
    10 mm/s.
    """
    q, traces = spec.y[0], traces_of(frame)
    whole, more = axs.below_surface(fig, frame, 2)
    for name, rows in traces.items():
        axs.curve(whole, rows, DISTANCE, q, label=name, **axs.look(name) | {"lw": 1.0})
        if name != VELOCITY:
            apart(more, rows, traces[VELOCITY], q, **axs.look(name) | {"lw": 1.0})
    axs.limit_axes(whole, frame, y=q)
    more.axhline(0, lw=0.8, **axs.look(VELOCITY) | {"ls": "-"})
    over_the_way([whole, more], frame)
    whole.legend(loc="upper left", ncols=len(traces), handlelength=2.8)
    in_its_unit(whole, q, "contact pressure" if q in IN_KILO else "strain energy density")
    in_its_unit(more, q, f"more than\nat {VELOCITY}")
    fig.align_ylabels()


def laws_of_pressure(
    fig: Picture, frame: DataFrame, spec: Figure, laws: Mapping[str, Mapping[str, object]]
) -> None:
    """Strain energy at 10 mm/s, simulated and by laws (source -> line); below, what each law has
    more than the simulation, at five velocities.
    """
    whole, *below = axs.below_surface(fig, frame, 1 + len(laws))
    traces = traces_of(frame)
    for source, look in {SIMULATED: {"color": style.INK, "ls": "-", "lw": 1.2}, **laws}.items():
        name = source.removeprefix(f"{SIMULATED}: ")
        rows = traces[VELOCITY]
        axs.curve(whole, rows[rows["source"] == source], DISTANCE, SED, label=name, **look)
    whole.set_title(VELOCITY)
    axs.limit_axes(whole, frame, y=SED)
    most = 0.0
    for ax, source in zip(below, laws, strict=True):
        for speed, rows in traces.items():
            law, true = (rows[rows["source"] == each] for each in (source, SIMULATED))
            look = {**axs.look(speed), "lw": 1.0, "label": speed}
            most = max(most, apart(ax, law, true, SED, **look))
        ax.set_title(f"{source.removeprefix(f'{SIMULATED}: ')}, less the simulated")
        ax.axhline(0, color=style.GREY, lw=0.5, zorder=1)
    for ax in below:
        ax.set(ylim=(-1.08 * most, 1.55 * most))
    over_the_way([whole, *below], frame)
    below[0].legend(loc="upper center", ncols=len(traces), handlelength=2.8)
    whole.set_ylabel("strain energy\ndensity (Pa)")
    below[len(below) // 2].set_ylabel("law less simulated (Pa)")
    style.header_legend(fig, whole.lines)

"""Chapter 4: ramp-and-hold indentation by nine surfaces: shape, contact, pressure and strain energy.

Axes, panels and line styles follow the thesis (Cysyk 1999), so that a picture can be laid beside the original.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from fingerpad.figures import axes as axs
from fingerpad.figures.grammar import Data, Figure, Lines, Own, Panels, Phases, nine
from fingerpad.measures.features import (
    ERROR,
    PHASES,
    PRESSURE,
    PRESSURE_SCALE,
    STEADY,
    SURFACES,
    TOP,
    depth,
    energy_rate,
    error_percent,
    is_simulated,
    over_time,
    phase_indices,
    ramp_end,
    receptors_at,
    skin_at,
    surface_nodes,
    width,
)
from fingerpad.measures.quantities import (
    DEPTH,
    DOWN,
    FORCE,
    NODE,
    P_CENTRE,
    P_PEAK,
    P_SCALED,
    RATE,
    RECEPTOR,
    SED,
    TIME,
    WIDTH,
    P,
    X,
    Y,
    sed,
)  # fmt: skip
from fingerpad.measures.responses import DEPTHS
from fingerpad.measures.runs import FAST, NINE, PADS
from fingerpad.publishing import style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

SHOWN_DEPTH = 915e-6  # m, the receptor depth of Figs 4-21, 4-23, 4-28
UM = tuple(round(z * 1e6) for z in DEPTHS)
K210 = NINE.only(("210",))
THREE = FAST.only(("flat", "158", "1260"))
SHOWN = sed(SHOWN_DEPTH)
HOLD = {"xlim": (0, 2.5), "xticks": [0, 1, 2]}
PRESSURE_IDS = {label: f"T{125 + k}" for k, label in enumerate(SURFACES)}


def by_surface(ids: str, labels: tuple = SURFACES) -> dict:
    """Ids of the thesis's axes, one a surface (or another label) in their order."""
    return dict(zip(labels, ids.split(), strict=True))


WIDTH_IDS = by_surface("T106 T108 T110 T112 T114 T115 T116 T118 T120")


def one_panel(x_label: float, height: float = 4.6) -> Panels:
    """Nine traces against time, named at their ends."""
    return Panels(height=height, fill=Lines(ends=x_label))


# --- rows of their own -----------------------------------------------------------------------------------


def skin(data: Data) -> pd.DataFrame:
    """Deformed skin at the top of the ramp and in steady state: the upper side, one row a node."""
    parts = []
    for label, history, coarse in data.runs(NINE):
        error = error_percent(history, coarse, over_time(depth))
        keep = history["skin_y"].values > 0
        for index, phase in phase_indices(history)[-2:]:
            x, y = skin_at(history, index)
            parts.append(pd.DataFrame({"surface": label, "phase": phase, X: x[keep] * 1e3, Y: y[keep] * 1e3, ERROR: error}))
    return pd.concat(parts, ignore_index=True)


def implied_widths(data: Data) -> pd.DataFrame:
    """The ranges of the width in the hold that the axes of Fig 4-9 imply."""
    implied = data.axis("inverse", WIDTH_IDS, "surface")
    if not implied.empty:
        implied[WIDTH] = 1 / implied.pop("inverse")
        implied["source"] = implied["source"].str.replace("thesis axis range", "thesis range of Fig 4-9")
    return implied


def critical_distance(data: Data) -> pd.DataFrame:
    """The distance from the contact's edge that the thesis states, at the end of the hold."""
    if "T147" not in data.reference.index:
        return pd.DataFrame()
    edge = width(data.histories[K210["210"]])[-1] * 1e3 / 2
    return pd.DataFrame({"source": "distance stated in the thesis (T147)", X: [edge - data.reference.loc["T147", "low"], edge]})


def nodes(data: Data) -> pd.DataFrame:
    """Pressure against time at each skin node of the right half that ever touches."""
    ((_, history, coarse),) = data.runs(K210)
    shown = surface_nodes(history)
    rows = {
        NODE: np.repeat((history["skin_x"].values[shown] * 1e3).round(5), history.sizes["time"]),
        TIME: np.tile(history["time"].values, len(shown)),
        P: history[PRESSURE].values[:, shown].T.ravel(),
    }
    return pd.DataFrame(rows | {ERROR: error_percent(history, coarse, over_time(P_CENTRE.read))})


def profiles_and_receptors(data: Data) -> pd.DataFrame:
    """Pressure profiles, and strain energy along two depths, at the top of the ramp and in steady state."""
    pressure = data.profiles(THREE).query("phase != @PHASES[0]").drop(columns=DOWN)
    parts = [pressure.assign(panel="pressure")]
    for label, history, coarse in data.runs(THREE):
        for z in (800e-6, 915e-6):
            error = error_percent(history, coarse, over_time(sed(z).read))
            row = receptors_at(history, z)
            for index, phase in ((ramp_end(history), TOP), (history.sizes["time"] - 1, STEADY)):
                part = {"surface": label, "panel": f"{z * 1e6:.0f} um", "phase": phase, TIME: history["time"].values[index]}
                part |= {X: history["receptor_offset"].values[row] * 1e3}
                part |= {SED: history["strain_energy_density"].values[index, row], ERROR: error}
                parts.append(pd.DataFrame(part))
    return pd.concat(parts, ignore_index=True)


def axes_of_three(data: Data) -> pd.DataFrame:
    """The thesis's axes of Fig 4-20, panel by panel."""
    ids = {"pressure": (P, "T165a T165b T165c"), "800 um": (SED, "T166 T167 T168"), "915 um": (SED, "T169 T170 T171")}
    marks = [data.axis(q, by_surface(each, tuple(THREE)), "surface").assign(panel=panel) for panel, (q, each) in ids.items()]
    return pd.concat(marks, ignore_index=True)


def energy_rates(data: Data) -> pd.DataFrame:
    """Rate of the strain energy (see `energy_rate` for the differences taken)."""
    parts = []
    for label, history, coarse in data.runs(NINE):
        error = error_percent(history, coarse, lambda d: float(energy_rate(d, SHOWN_DEPTH)[RATE].max()))
        parts.append(energy_rate(history, SHOWN_DEPTH).assign(surface=label, **{ERROR: error}))
    return pd.concat(parts, ignore_index=True)


# --- what layouts do not say -----------------------------------------------------------------------------


def bars_of_the_hold(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """The thesis's ranges for the hold as bars on the right."""
    (ax,) = panels.values()
    ranges = frame[frame["source"].str.startswith("thesis range of Fig 4-9")]
    for column, (label, ends) in enumerate(ranges.groupby("surface", sort=False)[WIDTH]):
        x = 2.935 + 0.025 * (column % 3)
        ax.plot([x, x], [ends.min(), ends.max()], color=style.COLOURS[label], lw=3.5, alpha=0.4, solid_capstyle="butt")
    if not ranges.empty:
        text = "bars: range of the hold on\nthe axes of thesis Fig. 4-9"
        ax.text(2.99, 5.45, text, ha="right", va="bottom", fontsize=7, color=style.GREY)


def phase_legend(*phases: str):
    """Legend of the phases' line styles, under the title."""

    def extra(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
        fig = next(iter(panels.values())).figure
        style.header_legend(fig, [style.handle(p, color=style.INK, **axs.PHASE_LINES[p]) for p in phases or PHASES])

    return extra


def half_millimetres(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    for ax in panels.values():
        ax.set_xticks(np.arange(0, ax.get_xlim()[1] + 0.1, 0.5))
    phase_legend()(panels, frame)


def mark_critical_distance(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    (ax,) = panels.values()
    critical = frame.loc[frame["source"].str.startswith("distance stated"), X]
    if not critical.empty:
        y = 0.045 * ax.get_ylim()[1]
        ends = {"arrowstyle": "|-|,widthA=.3,widthB=.3", "color": style.GREY, "shrinkA": 0, "shrinkB": 0}
        ax.annotate("", (critical.min(), y), (critical.max(), y), arrowprops=ends)
        text = f"{np.ptp(critical):.1f} mm from the edge:\ncritical distance\nstated in the thesis"
        ax.text(critical.max() + 0.02, y, text, ha="left", va="bottom", fontsize=7, color=style.GREY)
    phase_legend()(panels, frame)


def energy_and_pressure(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    looks = {"strain energy density": STEADY, "scaled pressure": TOP}
    handles = [style.handle(name, color=style.INK, **axs.PHASE_LINES[phase]) for name, phase in looks.items()]
    style.header_legend(panels["flat"].figure, handles)


def surfaces_above(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    names = {label: "flat plate" if label == "flat" else f"{label} 1/m" for label in SURFACES}
    handles = [style.handle(name, color=style.COLOURS[label]) for label, name in names.items()]
    style.header_legend(panels[UM[0]].figure, handles, handlelength=1.0, columnspacing=1.2, fontsize=7)


def force_or_pressure(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """The force of all, or nine traces of the pressure, named at their ends."""
    if spec.y == (FORCE,):
        ax.plot(TIME, FORCE, data=frame[frame["surface"] == "flat"], color=style.INK)
        ax.set_yticks([0, 10, 20, 30])
    else:
        Lines(ends=2.62)(ax, frame, spec)


def every_node(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """One trace a contact node, the centre solid."""
    rows = frame[is_simulated(frame)]
    looks = {name: {"color": style.COLOURS["210"]} | axs.PHASE_LINES[name] for name in (STEADY, PHASES[0])}
    for x, trace in rows.groupby(NODE):
        ax.plot(trace[TIME], trace[P], **looks[STEADY if abs(x) < 1e-6 else PHASES[0]])
    spacing = np.diff(np.sort(rows[NODE].unique())).mean()
    names = "centre node", f"other nodes, about {spacing * 1e3:.0f} µm apart"
    ax.legend(handles=[style.handle(name, **look) for name, look in zip(names, looks.values(), strict=True)], loc="upper right")


def three_by_three(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Pressure above, strain energy at two depths below, three surfaces across."""
    axes = fig.subplots(3, 3)
    ticks = {"flat": (-5, 0, 5), "158": (-4, -2, 0, 2, 4), "1260": (-2, 0, 2)}
    titles = {
        "pressure": P.label,
        "800 um": "strain energy density (Pa)\n800 µm, epidermis",
        "915 um": "strain energy density (Pa)\n915 µm, dermis",
    }
    for row, (panel, ylabel) in zip(axes, titles.items(), strict=True):
        row[0].set_ylabel(ylabel)
        for ax, label in zip(row, ticks, strict=True):
            rows = axs.rows_of(axs.rows_of(frame, "panel", panel), "surface", label)
            shown = replace(spec, y=(P if panel == "pressure" else SED,))
            axs.limit_axis(ax, rows, shown.y[0])
            Phases()(ax, rows, shown)
            ax.set(xlim=(ticks[label][0], ticks[label][-1]), xticks=ticks[label])
    for top, bottom, label in zip(axes[0], axes[-1], ticks, strict=True):
        top.set_title(axs.surface_name(label))
        bottom.set_xlabel(X.label)
    phase_legend(TOP, STEADY)({"": axes[0, 0]}, frame)


def legs_of_rates(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """Strain energy rate, nine traces named in the ramp; each jumps at its top."""
    ends = {}
    for label, rows in frame[is_simulated(frame)].groupby("surface", sort=False):
        time, rate = rows[TIME].to_numpy(), rows[RATE].to_numpy()
        jump = int(np.flatnonzero(np.diff(time) == 0)[0]) + 1
        for leg in (slice(jump), slice(jump, None)):
            ax.plot(time[leg], rate[leg], color=style.COLOURS[label])
        ax.plot(time[jump - 1 : jump + 1], rate[jump - 1 : jump + 1], color=style.GREY, lw=0.5, zorder=1)
        ends[label] = (time[jump - 1], rate[jump - 1])
    style.label_ends(ax, ends, ends["flat"][0] * 1.3, "curvature (1/m)")
    lowest = frame.loc[is_simulated(frame), RATE].min()
    text = f"hold: rates below zero (to {lowest:.0f} Pa/s), off the axis"
    ax.text(1.75, 60, text, ha="center", fontsize=7, color=style.GREY)


FIGURES = (
    Figure("4-6", "Skin profile at the top of the ramp and in steady state, 20 gf", NINE, X, (Y,), {X: "T100", Y: "T101"},
           nine(SURFACES, 6.6, header=0.2, fill=Phases(order=(STEADY, TOP)), limit="x", ylabel=Y,
                set={"ylim": (3, 6), "xticks": [-10, 0, 10], "yticks": [3, 4, 5, 6]}),
           rows=skin, extra=phase_legend(TOP, STEADY)),
    Figure("4-7", "Indentation depth, 40 gf/s ramp to 20 gf, 2 s hold", NINE, TIME, (DEPTH,), {TIME: "T103", DEPTH: "T102"},
           one_panel(2.62)),
    Figure("4-8", "Contact width, 40 gf/s ramp to 20 gf, 2 s hold", NINE, TIME, (WIDTH,), {TIME: "T105", WIDTH: "T104"},
           one_panel(2.54), after=implied_widths, extra=bars_of_the_hold),
    Figure("4-10", "Contact pressure at the centre of the fingerpad", NINE, TIME, (FORCE, P_CENTRE),
           {TIME: "T124", FORCE: "T122", P_CENTRE: "T123"},
           Panels(height=6.6, pairs=((TIME, FORCE), (TIME, P_CENTRE)), shape=(2, 1), fill=force_or_pressure,
                  share={"sharex": True, "height_ratios": (1, 3.2)})),
    Figure("4-11", "Contact pressure across the contact region", NINE, X, (P,), {X: "T134", P: PRESSURE_IDS},
           nine(SURFACES, 6.8, header=0.2, fill=Phases(), xlabel="horizontal location (mm)"),
           rows=lambda data: data.profiles(NINE).drop(columns=DOWN), extra=phase_legend()),
    Figure("4-12", "Flat plate: pressure on a homogeneous and on the layered pad", PADS, X, (P,),
           {X: "T137", P: {"homogeneous": "T135", "layered": "T136"}},
           Panels(height=6.3, header=0.2, by="pad", names=tuple(PADS), shape=(2, 1), fill=Phases(colour="flat"), each=True,
                  set={"xlabel": X.label},
                  titles=lambda pad: f"({'ab'[list(PADS).index(pad)]}) {pad} pad"),
           key="pad", rows=lambda data: data.profiles(PADS).drop(columns=DOWN), extra=phase_legend()),
    Figure("4-13", "Contact pressure against vertical displacement of every contact node", NINE, DOWN, (P,),
           {DOWN: {k: "T143" if k in SURFACES[:3] else "T144" for k in SURFACES},
            # of 79 and 105 those of Fig 4-11: only a tick at 5000 Pa is legible in Fig 4-13 itself (T139)
            P: by_surface("T138 T126 T127 T140 T140 T140 T141 T141 T142")},
           nine(SURFACES, 6.8, header=0.2, fill=Phases()),
           rows=lambda data: data.profiles(NINE, half=True).drop(columns=X), extra=half_millimetres),
    Figure("4-14", "Pressure from the centre outwards over time, K = 210 1/m", K210, X, (P,), {X: "T146", P: "T145"},
           Panels(height=4.7, header=0.2, fill=Phases(), xlabel="distance from the centre (mm)"),
           rows=lambda data: data.profiles(K210, half=True).drop(columns=DOWN), after=critical_distance,
           extra=mark_critical_distance),
    Figure("4-15", "Maximum and centre pressure, K = 210 1/m", K210, TIME, (P_PEAK, P_CENTRE), {TIME: "T149", P_PEAK: "T148"},
           Panels(height=4.2,
                  fill=Lines(looks={P_CENTRE: axs.PHASE_LINES[TOP]}, names={P_PEAK: "maximum", P_CENTRE: "centre node"}),
                  ylabel=P.label, legend={"loc": "lower right", "handlelength": 2.6})),
    Figure("4-16", "Pressure at each node of the contact region, K = 210 1/m", K210, TIME, (P,), {TIME: "T151", P: "T150"},
           Panels(height=4.6, fill=every_node), rows=nodes),
    Figure("4-20", "Pressure and strain energy profiles, 150 gf/s ramp to 20 gf", THREE, X, (P,), {},
           Own(height=7.0, header=0.2, paint=three_by_three), rows=profiles_and_receptors, after=axes_of_three),
    Figure("4-21", f"Strain energy density at 915 µm and contact pressure × {PRESSURE_SCALE}, centre", NINE, TIME,
           (SHOWN, P_SCALED),
           {SED: by_surface("T173 T174 T175 T176 T177a T177b T178 T179", tuple(k for k in SURFACES if k != "158"))},
           nine(SURFACES, 6.8, header=0.2, limit="y", set=HOLD,
                fill=Lines(looks={SED: axs.PHASE_LINES[STEADY], P_SCALED: axs.PHASE_LINES[TOP]}),
                ylabel=f"strain energy density, contact pressure × {PRESSURE_SCALE} (Pa)"),
           checked=(SHOWN, P_CENTRE), extra=energy_and_pressure),
    Figure("4-23", "Strain energy density 915 µm under the centre", NINE, TIME, (SHOWN,), {TIME: "T189", SED: "T188"},
           one_panel(2.62)),
    Figure("4-24", "Strain energy density at nine depths under the centre", NINE, TIME, (SED,),
           {SED: by_surface("T192 T193 T194 T195 T196 T197 T198a T198b T198c", UM)},
           nine(UM, 7.2, header=0.22, by=RECEPTOR, limit="y", set=HOLD, fill=Lines(by="surface"),
                titles=lambda z: f"{z:.0f} µm ({'epidermis' if z < 850 else 'dermis'})"),
           key=RECEPTOR, extra=surfaces_above,
           rows=lambda data: pd.concat([data.traces(NINE, (TIME, sed(z))).assign(**{RECEPTOR: round(z * 1e6)}) for z in DEPTHS])),
    Figure("4-28", "Rate of strain energy density 915 µm under the centre", NINE, TIME, (RATE,), {TIME: "T206", RATE: "T205"},
           Panels(height=4.8, fill=legs_of_rates), rows=energy_rates),
)  # fmt: skip

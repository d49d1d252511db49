"""Chapter 4: ramp-and-hold indentation by nine surfaces: shape, contact, pressure and strain
energy.

Axes, panels and line styles follow the thesis (Cysyk 1999), so that a picture can be laid beside
the original.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.figures import axes as axs
from cysyk1999.figures.grammar import Data, Figure, Lines, Own, Panels, Phases, nine
from cysyk1999.measures.errors import (
    Curve,
    Errors,
    at_output,
    curve_errors,
    family_errors,
    over_time,
    shared_place,
)
from cysyk1999.measures.quantities import (
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
)
from cysyk1999.measures.responses import DEPTHS
from cysyk1999.measures.runs import FAST, NINE, PADS
from cysyk1999.publishing import style
from fingerpad.measures.features import (
    PHASES,
    PRESSURE,
    PRESSURE_SCALE,
    STEADY,
    SURFACES,
    TOP,
    energy_rate,
    is_simulated,
    phase_indices,
    pressure_at,
    ramp_end,
    receptors_at,
    skin_at,
    surface_nodes,
    width,
)
from fingerpad.planning.errors import PROFILE_ORDER

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


def one_panel(x_label: float, height: float = 2.7) -> Panels:
    """Nine traces against time, named at their ends."""
    return Panels(height=height, fill=Lines(ends=x_label))


OTHER_PADS = (
    "Faint bars: the span of other pads that the thesis's figures do not tell apart "
    "(figures/tables/reconstruction_posterior.md)."
)


# --- rows of their own -----------------------------------------------------------------------------------


def skin(data: Data) -> pd.DataFrame:
    """Skin at rest, at the top of the ramp and in steady state: the upper side, one row a node."""
    parts = []
    for label, history, coarse in data.runs(NINE):
        keep = history["skin_y"].values > 0
        at_rest = history["skin_x"].values, history["skin_y"].values
        outlines = [
            (axs.AT_REST, at_rest, Errors(np.nan, np.nan, np.nan))
        ]  # the scene alone tells it
        for index, phase in phase_indices(history)[-2:]:
            errors = curve_errors(history, coarse, at_output(float(history["time"][index]), sunk))
            outlines.append((phase, skin_at(history, index), errors))
        for phase, (x, y), errors in outlines:
            part = {"surface": label, "phase": phase, X: x[keep] * 1e3, Y: y[keep] * 1e3}
            parts.append(pd.DataFrame(part | errors.columns))
    return pd.concat(parts, ignore_index=True)


def sunk(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Lateral position at rest and displacement into the pad (m) of the upper skin at one
    output.
    """
    upper = history["skin_y"].values > 0
    return history["skin_x"].values[upper], -history["skin_displacement_y"].values[index, upper]


def implied_widths(data: Data) -> pd.DataFrame:
    """The ranges of the width in the hold that the axes of Fig 4-9 imply."""
    implied = data.axis("inverse", WIDTH_IDS, "surface")
    if not implied.empty:
        implied[WIDTH] = 1 / implied.pop("inverse")
        implied["source"] = implied["source"].str.replace(
            "thesis axis range", "thesis range of Fig 4-9"
        )
    return implied


def energies_of_other_pads(data: Data) -> pd.DataFrame:
    """How far the highest strain energies of other pads differ, by depth."""
    return data.bands(SED, {f"energy_{z}": {RECEPTOR: float(z)} for z in UM})


def critical_distance(data: Data) -> pd.DataFrame:
    """The distance from the contact's edge that the thesis states, at the end of the hold."""
    if "T147" not in data.reference.index:
        return pd.DataFrame()
    edge = width(data.histories[K210["210"]])[-1] * 1e3 / 2
    return pd.DataFrame(
        {
            "source": "distance stated in the thesis (T147)",
            X: [edge - data.reference.loc["T147", "low"], edge],
        }
    )


def nodes(data: Data) -> pd.DataFrame:
    """Pressure against time at each skin node of the right half that ever touches."""
    ((_, history, coarse),) = data.runs(K210)
    places = {node: float(history["skin_x"].values[node]) for node in surface_nodes(history)}
    curves = [
        over_time(partial(pressure_at, place=shared_place(x, coarse)), PROFILE_ORDER)
        for x in places.values()
    ]
    errors = family_errors(history, coarse, curves).columns
    parts = [
        pd.DataFrame(
            {
                NODE: round(x * 1e3, 5),
                TIME: history["time"].values,
                P: history[PRESSURE].values[:, node],
            }
            | errors
        )
        for node, x in places.items()
    ]
    return pd.concat(parts, ignore_index=True)


def profiles_and_receptors(data: Data) -> pd.DataFrame:
    """Pressure profiles, and strain energy along two depths, at the top of the ramp and in steady
    state.
    """
    pressure = data.profiles(THREE).query("phase != @PHASES[0]").drop(columns=DOWN)
    parts = [pressure.assign(panel="pressure")]
    for label, history, coarse in data.runs(THREE):
        for z in (800e-6, 915e-6):
            row = receptors_at(history, z)
            for index, phase in ((ramp_end(history), TOP), (history.sizes["time"] - 1, STEADY)):
                part = {
                    "surface": label,
                    "panel": f"{z * 1e6:.0f} um",
                    "phase": phase,
                    TIME: history["time"].values[index],
                }
                part |= {X: history["receptor_offset"].values[row] * 1e3}
                part |= {SED: history["strain_energy_density"].values[index, row]}
                along = at_output(float(history["time"][index]), partial(energy_along, depth=z))
                parts.append(pd.DataFrame(part | curve_errors(history, coarse, along).columns))
    return pd.concat(parts, ignore_index=True)


def energy_along(history: xr.Dataset, index: int, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Offset (m) and strain energy density (Pa) of the receptors at a depth (m) at one output."""
    row = receptors_at(history, depth)
    return history["receptor_offset"].values[row], history["strain_energy_density"].values[
        index, row
    ]


def axes_of_three(data: Data) -> pd.DataFrame:
    """The thesis's axes of Fig 4-20, panel by panel."""
    ids = {
        "pressure": (P, "T165a T165b T165c"),
        "800 um": (SED, "T166 T167 T168"),
        "915 um": (SED, "T169 T170 T171"),
    }
    marks = [
        data.axis(q, by_surface(each, tuple(THREE)), "surface").assign(panel=panel)
        for panel, (q, each) in ids.items()
    ]
    return pd.concat(marks, ignore_index=True)


def energy_rates(data: Data) -> pd.DataFrame:
    """Rate of the strain energy (see `energy_rate` for the differences taken), with the errors in
    the ramp, which is shown.
    """
    parts = []
    for label, history, coarse in data.runs(NINE):
        errors = curve_errors(
            history,
            coarse,
            Curve(lambda d: energy_rate(d, SHOWN_DEPTH)[: ramp_end(d) + 1].to_numpy().T),
        )
        parts.append(energy_rate(history, SHOWN_DEPTH).assign(surface=label, **errors.columns))
    return pd.concat(parts, ignore_index=True)


# --- what layouts do not say -----------------------------------------------------------------------------


def bars_of_the_hold(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """The thesis's ranges for the hold as bars at the right, broken where their reading is
    uncertain.
    """
    (ax,) = panels.values()
    ranges = frame[frame["source"].str.startswith("thesis range of Fig 4-9")]
    if ranges.empty:
        return
    side = ax.inset_axes((1.03, 0, 0.2, 1), sharey=ax)
    for (label, rows), column in zip(
        ranges.groupby("surface", sort=False), range(len(SURFACES)), strict=False
    ):
        doubt = rows["source"].str.contains("uncertain").any()
        side.plot(
            [column] * 2,
            [rows[WIDTH].min(), rows[WIDTH].max()],
            **axs.look(label),
            lw=2.2,
            solid_capstyle="butt",
            ls=(0, (0.6, 0.5)) if doubt else "-",
        )
    side.set(xticks=[], xlim=(-0.7, len(SURFACES) - 0.3))
    side.tick_params(labelleft=False)
    side.set_title("range of the hold,\nthesis's Fig. 4-9\n(broken: uncertain)", fontsize=6)


def phase_legend(*phases: str):
    """Legend of the phases' line styles, under the title; a line in the surfaces' colours is in
    those of some of them.
    """

    def extra(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
        fig = next(iter(panels.values())).figure
        names = list(frame["surface"].dropna().unique()) if "surface" in frame else [SURFACES[0]]
        some = names if len(names) < 4 else (names[0], names[len(names) // 2], names[-1])
        there = [p for p in phases or PHASES if (frame["phase"] == p).any()]
        style.header_legend(
            fig,
            [[style.handle(p, **axs.look(k) | axs.PHASE_LINES[p]) for k in some] for p in there],
        )

    return extra


def half_millimetres(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    for ax in panels.values():
        ax.set_xticks(np.arange(0, ax.get_xlim()[1] + 0.1, 0.5))
    phase_legend()(panels, frame)


def own_widths(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """Every surface on as much of the axis as it touches."""
    for label, ax in panels.items():
        reach = 1.12 * frame.loc[is_simulated(frame) & (frame["surface"] == label), X].abs().max()
        ax.set_xlim(-reach, reach)
    phase_legend()(panels, frame)


def beside_each_other(surface: str) -> float:
    """Time (s) at which the bar of a surface stands, round the top of the ramp."""
    return 0.5 + 0.03 * (SURFACES.index(surface) - 4)


def bars_of_pressure(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """The span of the highest pressures of other pads, at the middle of the contact."""
    own_widths(panels, frame)
    for label, ax in panels.items():
        axs.draw_bands(ax, frame[frame["surface"] == label], None, P, lambda row: 0.0, 5.0)


def bars_of_energy(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """The span of the highest strain energies of other pads."""
    for z, ax in panels.items():
        rows = axs.rows_of(frame, RECEPTOR, z) if RECEPTOR in frame else frame
        axs.draw_bands(ax, rows, None, SED, lambda row: beside_each_other(row["surface"]), 2.0)


def depths_and_bars(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    surfaces_above(panels, frame)
    bars_of_energy(panels, frame)


def pad_titles(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    panels["homogeneous"].set_title("homogeneous pad, its modulus such that it sinks as deep")
    panels["layered"].set_title("layered pad")
    phase_legend()(panels, frame)


def mark_critical_distance(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    (ax,) = panels.values()
    critical = frame.loc[frame["source"].str.startswith("distance stated"), X]
    if not critical.empty:
        y = 0.93 * ax.get_ylim()[1]
        ends = {
            "arrowstyle": "|-|,widthA=.3,widthB=.3",
            "color": style.GREY,
            "shrinkA": 0,
            "shrinkB": 0,
        }
        ax.annotate("", (critical.min(), y), (critical.max(), y), arrowprops=ends)
        text = f"{np.ptp(critical):.1f} mm from the edge:\ncritical distance\nstated in the thesis"
        ax.annotate(
            text,
            (critical.max(), y),
            (0, -5),
            "data",
            "offset points",
            ha="right",
            va="top",
            fontsize=6.5,
            color=style.GREY,
        )
    phase_legend()(panels, frame)


def energy_and_pressure(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    looks = {"strain energy density": axs.FIRST, "scaled pressure": axs.SECOND}
    handles = [style.handle(name, color=style.INK, **look) for name, look in looks.items()]
    style.header_legend(panels["flat"].figure, handles)


def surfaces_above(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    names = {label: "flat plate" if label == "flat" else f"{label} 1/m" for label in SURFACES}
    handles = [style.handle(name, **axs.look(label), lw=2) for label, name in names.items()]
    style.header_legend(panels[UM[0]].figure, handles, handlelength=1.0, columnspacing=1.2)


def force_or_pressure(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """The force of all, or nine traces of the pressure, named at their ends."""
    if spec.y == (FORCE,):
        ax.plot(TIME, FORCE, data=frame[frame["surface"] == "flat"], color=style.INK)
        ax.set_yticks([0, 10, 20, 30])
    else:
        Lines(ends=2.62)(ax, frame, spec)


def every_node(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """One trace a contact node, the centre thick."""
    rows = frame[is_simulated(frame)]
    thick, thin = axs.look("210") | {"lw": 1.8}, {"color": style.GREY, "lw": 0.7}
    for x, trace in rows.groupby(NODE):
        axs.curve(ax, trace, TIME, P, **thick if abs(x) < 1e-6 else thin)
    spacing = np.diff(np.sort(rows[NODE].unique())).mean()
    names = {"centre node": thick, f"other nodes, about {spacing * 1e3:.0f} µm apart": thin}
    ax.legend(
        handles=[style.handle(name, **look) for name, look in names.items()], loc="upper right"
    )


def three_by_three(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Pressure above, strain energy at two depths below, three surfaces across."""
    axes = fig.subplots(3, 3)
    ticks = {"flat": (-5, 0, 5), "158": (-4, -2, 0, 2, 4), "1260": (-2, 0, 2)}
    titles = {
        "pressure": "contact pressure (kPa)",
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
            if panel == "pressure":
                style.in_kilo(ax.yaxis)
            ax.set(xlim=(ticks[label][0], ticks[label][-1]), xticks=ticks[label])
    for top, bottom, label in zip(axes[0], axes[-1], ticks, strict=True):
        top.set_title(axs.surface_name(label))
        bottom.set_xlabel(X.label)
    phase_legend(TOP, STEADY)({"": axes[0, 0]}, frame)


def legs_of_rates(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """Strain energy rate in the ramp, nine traces named at its top, where each jumps; of the hold
    what is above zero.
    """
    own, ends = frame[is_simulated(frame)], {}
    seen = 0.01 * own[RATE].max()
    for label, rows in own.groupby("surface", sort=False):
        time, rate = rows[TIME].to_numpy(), rows[RATE].to_numpy()
        jump = int(np.flatnonzero(np.diff(time) == 0)[0]) + 1
        for leg in (slice(jump), slice(jump, None)):
            if rate[leg].max() > seen:
                axs.curve(ax, rows[leg], TIME, RATE, whole=rows[:jump], **axs.look(label))
        ax.plot(
            time[jump - 1 : jump + 1], rate[jump - 1 : jump + 1], color=style.GREY, lw=0.5, zorder=1
        )
        ends[label] = (time[jump - 1], rate[jump - 1])
    style.label_ends(ax, ends, ends["flat"][0] * 1.5, "curvature (1/m)")
    text = f"hold: rates below zero\n(to {own[RATE].min():.0f} Pa/s), off the axis".replace(
        "-", "−"
    )
    ax.text(0.97, 0.05, text, transform=ax.transAxes, ha="right", fontsize=6.5, color=style.GREY)


FIGURES = (
    Figure(
        "4-6",
        "Skin profile at the top of the ramp and in steady state, 20 gf",
        NINE,
        X,
        (Y,),
        {X: "T100", Y: "T101"},
        nine(
            SURFACES,
            5.6,
            header=0.16,
            fill=Phases(order=(axs.AT_REST, STEADY, TOP)),
            limit="x",
            ylabel=Y,
            set={"ylim": (3, 6), "xticks": [-10, 0, 10], "yticks": [3, 4, 5, 6]},
        ),
        rows=skin,
        extra=phase_legend(axs.AT_REST, TOP, STEADY),
    ),
    Figure(
        "4-7",
        "Indentation depth, 40 gf/s ramp to 20 gf, 2 s hold",
        NINE,
        TIME,
        (DEPTH,),
        {TIME: "T103", DEPTH: "T102"},
        one_panel(2.62),
        width=style.COLUMN_WIDTH,
    ),
    Figure(
        "4-8",
        "Contact width, 40 gf/s ramp to 20 gf, 2 s hold",
        NINE,
        TIME,
        (WIDTH,),
        {TIME: "T105", WIDTH: "T104"},
        one_panel(2.54, 3.2),
        after=implied_widths,
        extra=bars_of_the_hold,
    ),
    Figure(
        "4-10",
        "Contact pressure at the centre of the fingerpad",
        NINE,
        TIME,
        (FORCE, P_CENTRE),
        {TIME: "T124", FORCE: "T122", P_CENTRE: "T123"},
        Panels(
            height=4.9,
            pairs=((TIME, FORCE), (TIME, P_CENTRE)),
            shape=(2, 1),
            fill=force_or_pressure,
            share={"sharex": True, "height_ratios": (1, 3.2)},
        ),
    ),
    Figure(
        "4-11",
        "Contact pressure across the contact region",
        NINE,
        X,
        (P,),
        {X: "T134", P: PRESSURE_IDS},
        nine(
            SURFACES, 5.9, header=0.16, fill=Phases(), xlabel="horizontal location (mm)", limit="y"
        ),
        rows=lambda data: data.profiles(NINE).drop(columns=DOWN),
        extra=bars_of_pressure,
        measured="pads",
        after=lambda data: data.bands(P, {"peak": {}}),
        remarks=(OTHER_PADS,),
    ),
    Figure(
        "4-12",
        "Flat plate: pressure on a homogeneous and on the layered pad",
        PADS,
        X,
        (P,),
        {X: "T137", P: {"homogeneous": "T135", "layered": "T136"}},
        Panels(
            height=3.1,
            header=0.16,
            by="pad",
            names=tuple(PADS),
            shape=(1, 2),
            fill=Phases(colour="flat"),
            each=True,
            share={"sharey": True},
            set={"xlabel": X.label},
        ),
        key="pad",
        rows=lambda data: data.profiles(PADS).drop(columns=DOWN),
        extra=pad_titles,
    ),
    Figure(
        "4-13",
        "Contact pressure against vertical displacement of every contact node",
        NINE,
        DOWN,
        (P,),
        {
            DOWN: {k: "T143" if k in SURFACES[:3] else "T144" for k in SURFACES},
            # of 79 and 105 those of Fig 4-11: only a tick at 5000 Pa is legible in Fig 4-13 itself
            # (T139)
            P: by_surface("T138 T126 T127 T140 T140 T140 T141 T141 T142"),
        },
        nine(SURFACES, 5.9, header=0.16, fill=Phases()),
        rows=lambda data: data.profiles(NINE, half=True).drop(columns=X),
        extra=half_millimetres,
    ),
    Figure(
        "4-14",
        "Pressure from the centre outwards over time, K = 210 1/m",
        K210,
        X,
        (P,),
        {X: "T146", P: "T145"},
        Panels(height=3.5, header=0.16, fill=Phases(), xlabel="distance from the centre (mm)"),
        rows=lambda data: data.profiles(K210, half=True).drop(columns=DOWN),
        after=critical_distance,
        extra=mark_critical_distance,
    ),
    Figure(
        "4-15",
        "Maximum and centre pressure, K = 210 1/m",
        K210,
        TIME,
        (P_PEAK, P_CENTRE),
        {TIME: "T149", P_PEAK: "T148"},
        Panels(
            height=2.6,
            fill=Lines(
                looks={P_PEAK: axs.FIRST, P_CENTRE: axs.SECOND | {"color": style.HIGHLIGHT}},
                names={P_PEAK: "maximum", P_CENTRE: "centre node"},
            ),
            ylabel=P.label,
            legend={"loc": "lower right", "handlelength": 2.6},
        ),
        width=style.COLUMN_WIDTH,
    ),
    Figure(
        "4-16",
        "Pressure at each node of the contact region, K = 210 1/m",
        K210,
        TIME,
        (P,),
        {TIME: "T151", P: "T150"},
        Panels(height=3.4, fill=every_node),
        rows=nodes,
        how="all nodes together",
    ),
    Figure(
        "4-20",
        "Pressure and strain energy profiles, 150 gf/s ramp to 20 gf",
        THREE,
        X,
        (P,),
        {},
        Own(height=6.2, header=0.16, paint=three_by_three),
        rows=profiles_and_receptors,
        after=axes_of_three,
    ),
    Figure(
        "4-21",
        f"Strain energy density at 915 µm and contact pressure × {PRESSURE_SCALE}, centre",
        NINE,
        TIME,
        (SHOWN, P_SCALED),
        {
            SED: by_surface(
                "T173 T174 T175 T176 T177a T177b T178 T179",
                tuple(k for k in SURFACES if k != "158"),
            )
        },
        nine(
            SURFACES,
            5.9,
            header=0.16,
            limit="y",
            set=HOLD,
            fill=Lines(looks={SED: axs.FIRST, P_SCALED: axs.SECOND}),
            ylabel=f"strain energy density, contact pressure × {PRESSURE_SCALE} (Pa)",
        ),
        checked=(SHOWN, P_CENTRE),
        extra=energy_and_pressure,
    ),
    Figure(
        "4-23",
        "Strain energy density 915 µm under the centre",
        NINE,
        TIME,
        (SHOWN,),
        {TIME: "T189", SED: "T188"},
        one_panel(2.62, 3.0),
        width=style.COLUMN_WIDTH,
        measured="pads",
        extra=bars_of_energy,
        remarks=(OTHER_PADS,),
        after=lambda data: data.bands(SED, {"energy_915": {}}),
    ),
    Figure(
        "4-24",
        "Strain energy density at nine depths under the centre",
        NINE,
        TIME,
        (SED,),
        {SED: by_surface("T192 T193 T194 T195 T196 T197 T198a T198b T198c", UM)},
        nine(
            UM,
            6.2,
            header=0.18,
            by=RECEPTOR,
            limit="y",
            set=HOLD,
            fill=Lines(by="surface"),
            titles=lambda z: f"{z:.0f} µm ({'epidermis' if z < 850 else 'dermis'})",
        ),
        key=RECEPTOR,
        extra=depths_and_bars,
        measured="pads",
        after=energies_of_other_pads,
        remarks=(OTHER_PADS,),
        rows=lambda data: pd.concat(
            [data.traces(NINE, (TIME, sed(z))).assign(**{RECEPTOR: round(z * 1e6)}) for z in DEPTHS]
        ),
    ),
    Figure(
        "4-28",
        "Rate of strain energy density 915 µm under the centre",
        NINE,
        TIME,
        (RATE,),
        {TIME: "T206", RATE: "T205"},
        Panels(height=3.0, fill=legs_of_rates),
        rows=energy_rates,
        width=style.COLUMN_WIDTH,
    ),
)

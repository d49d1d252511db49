"""Chapter 4: ramp-and-hold indentation by nine surfaces: shape, contact, pressure and strain
energy.

Axes, panels and line styles follow the thesis (Cysyk 1999), so that a picture can be laid beside
the original.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures import overlaid
from cysyk1999.figures.grammar import Data, Figure, Lines, Page, Panels, Phases, nine, stacked
from cysyk1999.measures.errors import (
    PARTS,
    Curve,
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
    phase_indices,
    pressure_at,
    ramp_end,
    receptors_at,
    skin_at,
    surface_nodes,
)
from fingerpad.planning.errors import PROFILE_ORDER

SHOWN_DEPTH = 915e-6  # m, the receptor depth of Figs 4-21, 4-23, 4-28
UM = tuple(round(z * 1e6) for z in DEPTHS)
K210 = NINE.only(("210",))
THREE = FAST.only(("flat", "158", "1260"))
SHOWN = sed(SHOWN_DEPTH)
HOLD = {"xlim": (0, 2.5), "xticks": [0, 1, 2]}
ENERGY_AND_PRESSURE = f"strain energy density, contact pressure × {PRESSURE_SCALE} (Pa)"
PRESSURE_IDS = {label: f"T{125 + k}" for k, label in enumerate(SURFACES)}


def by_surface(ids: str, labels: Iterable = SURFACES) -> dict:
    """Ids of the thesis's axes, one a surface (or another label) in their order."""
    return dict(zip(labels, ids.split(), strict=True))


WIDTH_IDS = by_surface("T106 T108 T110 T112 T114 T115 T116 T118 T120")


# --- rows of their own ----------------------------------------------------------------------------


@stacked
def skin(data: Data) -> Iterator[Mapping]:
    """Skin at rest, at the top of the ramp and in steady state: the upper side, one row a node."""
    for label, history, coarse in data.runs(NINE):
        keep = history["skin_y"].values > 0
        rest = {X: 1e3 * history["skin_x"].values[keep], Y: 1e3 * history["skin_y"].values[keep]}
        unknown = dict.fromkeys(PARTS, np.nan)  # the scene alone tells the pad at rest
        yield {"surface": label, "phase": axs.AT_REST} | rest | unknown
        for index, phase in phase_indices(history)[-2:]:
            curve = at_output(float(history["time"][index]), sunk)
            x, y = (1e3 * each[keep] for each in skin_at(history, index))
            errors = curve_errors(history, coarse, curve).columns
            yield {"surface": label, "phase": phase, X: x, Y: y} | errors


def sunk(history: Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Lateral position at rest and displacement into the pad (m) of the upper skin at one
    output.
    """
    upper = history["skin_y"].values > 0
    return history["skin_x"].values[upper], -history["skin_displacement_y"].values[index, upper]


def implied_widths(data: Data) -> DataFrame:
    """The ranges of the width in the hold that the axes of Fig 4-9 imply."""
    implied = data.axis("inverse", WIDTH_IDS)
    if implied.empty:
        return implied
    source = implied["source"].str.replace("thesis axis range", "thesis range of Fig 4-9")
    return implied.assign(source=source, **{WIDTH: 1 / implied["inverse"]}).drop(columns="inverse")


@stacked
def nodes(data: Data) -> Iterator[Mapping]:
    """Pressure against time at each skin node of the right half that ever touches."""
    ((_, history, coarse),) = data.runs(K210)
    places = {node: float(history["skin_x"].values[node]) for node in surface_nodes(history)}
    curves = [
        over_time(partial(pressure_at, place=shared_place(x, coarse)), PROFILE_ORDER)
        for x in places.values()
    ]
    errors = family_errors(history, coarse, curves).columns
    for node, x in places.items():
        trace = {TIME: history["time"].values, P: history[PRESSURE].values[:, node]}
        yield {NODE: round(x * 1e3, 5)} | trace | errors


@stacked
def profiles_and_receptors(data: Data) -> Iterator[DataFrame | Mapping]:
    """Pressure profiles, and strain energy along two depths, at the top of the ramp and in steady
    state.
    """
    pressure = data.profiles(THREE)
    yield pressure[pressure["phase"] != PHASES[0]].assign(panel="pressure")
    for label, history, coarse in data.runs(THREE):
        for z in (800e-6, 915e-6):
            read = partial(energy_along, depth=z)
            for index, phase in phase_indices(history)[-2:]:
                time = float(history["time"][index])
                x, energies = read(history, index)
                errors = curve_errors(history, coarse, at_output(time, read)).columns
                of = {"surface": label, "panel": f"{z * 1e6:.0f} um", "phase": phase, TIME: time}
                yield of | {X: x * 1e3, SED: energies} | errors


def energy_along(history: Dataset, index: int, depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Offset (m) and strain energy density (Pa) of the receptors at a depth (m) at one output."""
    row = receptors_at(history, depth)
    return history["receptor_offset"].values[row], history[SED.name].values[index, row]


def axes_of_three(data: Data) -> DataFrame:
    """The thesis's axes of Fig 4-20, panel by panel."""
    ids = {
        "pressure": (P, "T165a T165b T165c"),
        "800 um": (SED, "T166 T167 T168"),
        "915 um": (SED, "T169 T170 T171"),
    }
    marks = [
        data.axis(q, by_surface(each, THREE)).assign(panel=panel)
        for panel, (q, each) in ids.items()
    ]
    return pd.concat(marks, ignore_index=True)


def energy_rates(data: Data) -> DataFrame:
    """Rate of the strain energy (see `energy_rate` for the differences taken), with the errors in
    the ramp, which is shown.
    """
    read = partial(energy_rate, depth=SHOWN_DEPTH)
    return data.table(NINE, read, Curve(lambda h: read(h)[: ramp_end(h) + 1].to_numpy().T))


@stacked
def energies(data: Data) -> Iterator[DataFrame]:
    """Strain energy against time at nine depths."""
    for z, um in zip(DEPTHS, UM, strict=True):
        yield data.traces(NINE, (TIME, sed(z))).assign(**{RECEPTOR: um})


# --- what layouts do not say ----------------------------------------------------------------------


def bars_of_the_hold(panels, frame):
    """The thesis's ranges for the hold as bars at the right."""
    ranges = axs.from_source(frame, "thesis range of Fig 4-9")
    title = "range of the hold,\nthesis's Fig. 4-9\n(broken: uncertain)"
    overlaid.ranges_beside(*panels.values(), ranges, WIDTH, title)


def phase_legend(panels, frame, phases=PHASES):
    """Legend of the phases' line styles, under the title; a line in the surfaces' colours is in
    those of some of them.
    """
    names = list(frame["surface"].dropna().unique()) if "surface" in frame else [SURFACES[0]]
    some = names if len(names) < 4 else (names[0], names[len(names) // 2], names[-1])
    entries = []
    for phase in phases:
        if (frame["phase"] == phase).any():
            looks = [axs.look(name) | axs.PHASE_LINES[phase] for name in some]
            lines = {look["color"]: style.handle(phase, **look) for look in looks}
            entries.append(tuple(lines.values()))
    style.header_legend(next(iter(panels.values())).figure, entries)


def bars_of_pressure(panels, frame):
    """Every surface on as much of the axis as it touches, with the span of the highest pressures
    of other pads beside the contact.
    """
    for label, ax in panels.items():
        rows = frame[frame["surface"] == label]
        reach = 1.12 * rows[X].abs().max()
        ax.set_xlim(-reach, reach)
        axs.draw_bands(ax, rows, None, P, lambda row, at=0.96 * reach: at, 5.0)
    phase_legend(panels, frame)


def legend_of_surfaces(panels, frame):
    """A legend of the surfaces."""
    handles = [
        style.handle("flat plate" if k == "flat" else f"{k} 1/m", **axs.look(k), lw=2)
        for k in SURFACES
    ]
    spaces = {"handlelength": 1.0, "columnspacing": 1.2}
    style.header_legend(panels[UM[0]].figure, handles, 0.18, **spaces)


def name_depth(ax, z):
    """A depth (um) and its layer above a panel."""
    ax.set_title(f"{z:.0f} µm ({'epidermis' if z < 850 else 'dermis'})")


def pad_titles(panels, frame):
    """Names of the two pads."""
    panels["homogeneous"].set_title("homogeneous pad, its modulus such that it sinks as deep")
    panels["layered"].set_title("layered pad")
    phase_legend(panels, frame)


def mark_peaks(panels, frame):
    """The peak of each profile that has left the centre, and how far it is from the edge."""
    (ax,) = panels.values()
    phase_legend(panels, frame)
    apart = []
    for _, rows in axs.simulated(frame).groupby(TIME):
        peak = rows.loc[rows[P].idxmax()]
        if peak[X] > 0:
            apart.append(rows[X].max() - peak[X])
            ax.plot(peak[X], peak[P], "o", ms=3.5, mfc="white", color=style.INK, zorder=4)
    if apart:
        span = " to ".join(dict.fromkeys(f"{x:.2f}" for x in (min(apart), max(apart))))
        text = f"from peak (circle) to edge:\n{span} mm; the thesis:\nabout 0.5 mm for each profile"
        axs.remark(ax, 0.98, 0.96, text, ha="right", va="top", **axs.NOTE)


def force_or_pressure(ax, frame, spec):
    """The force of all, or nine traces of the pressure, named at their ends."""
    if spec.y == (FORCE,):
        ax.plot(TIME, FORCE, data=frame[frame["surface"] == "flat"], color=style.INK)
        ax.set_yticks([0, 10, 20, 30])
    else:
        Lines(ends=2.62)(ax, frame, spec)


def every_node(ax, frame, spec):
    """One trace a contact node, the centre thick."""
    rows = axs.simulated(frame)
    thick, thin = axs.look("210") | {"lw": 1.8}, {"color": style.GREY, "lw": 0.7}
    for x, trace in rows.groupby(NODE):
        axs.curve(ax, trace, TIME, P, **thick if abs(x) < 1e-6 else thin)
    spacing = np.diff(np.sort(rows[NODE].unique())).mean()
    others = f"other nodes, about {spacing * 1e3:.0f} µm apart"
    ax.legend(handles=style.handles({"centre node": thick, others: thin}), loc="upper right")


def three_by_three(fig, frame, spec):
    """Pressure above, strain energy at two depths below, three surfaces across."""
    axes = fig.subplots(3, 3)
    ticks = {"flat": (-5, 0, 5), "158": (-4, -2, 0, 2, 4), "1260": (-2, 0, 2)}
    panels = {
        "pressure": (P, P.label),
        "800 um": (SED, f"{SED.label}\n800 µm, epidermis"),
        "915 um": (SED, f"{SED.label}\n915 µm, dermis"),
    }
    for row, (panel, (y, words)) in zip(axes, panels.items(), strict=True):
        row[0].set_ylabel(words)
        for ax, (label, places) in zip(row, ticks.items(), strict=True):
            rows = axs.rows_of(axs.rows_of(frame, "panel", panel), "surface", label)
            axs.limit_axes(ax, rows, y=y)
            Phases()(ax, rows, replace(spec, y=(y,)))
            ax.set(xlim=(places[0], places[-1]), xticks=places)
            if y == P:
                style.in_kilo(ax.yaxis)
                ax.set_title(axs.surface_name(label))
    for ax in axes[-1]:
        ax.set_xlabel(X.label)
    phase_legend({"": axes[0, 0]}, frame, (TOP, STEADY))


def legs_of_rates(ax, frame, spec):
    """Strain energy rate in the ramp, nine traces named at its top, where each jumps; of the hold
    what is above zero.
    """
    own, ends = axs.simulated(frame), {}
    for label, rows in own.groupby("surface", sort=False):
        ramp, hold = axs.legs(rows)
        for leg in (ramp, hold):
            if leg[RATE].max() > 0.01 * own[RATE].max():
                axs.curve(ax, leg, TIME, RATE, whole=ramp, **axs.look(label))
        jump = pd.concat([ramp[-1:], hold[:1]])
        ax.plot(jump[TIME], jump[RATE], color=style.GREY, lw=0.5, zorder=1)
        ends[label] = tuple(ramp[[TIME, RATE]].iloc[-1])
    style.label_ends(ax, ends, ends["flat"][0] * 1.5, "curvature (1/m)")
    text = f"hold: rates below zero\n(to {own[RATE].min():.0f} Pa/s), off the axis"
    axs.remark(ax, 0.97, 0.05, text, ha="right", **axs.NOTE)


FIGURES = (
    Figure(
        "4-6",
        "Skin profile at the top of the ramp and in steady state, 20 gf",
        NINE,
        X,
        (Y,),
        {X: "T100", Y: "T101"},
        Page(3.3, overlaid.skins),
        rows=skin,
    ),
    Figure(
        "4-7",
        "Indentation depth, 40 gf/s ramp to 20 gf, 2 s hold",
        NINE,
        TIME,
        (DEPTH,),
        {TIME: "T103", DEPTH: "T102"},
        Panels(2.7, fill=Lines(ends=2.62)),
        width=style.COLUMN_WIDTH,
    ),
    Figure(
        "4-8",
        "Contact width, 40 gf/s ramp to 20 gf, 2 s hold",
        NINE,
        TIME,
        (WIDTH,),
        {TIME: "T105", WIDTH: "T104"},
        Panels(3.2, fill=Lines(ends=2.54), extra=bars_of_the_hold),
        after=implied_widths,
    ),
    Figure(
        "4-10",
        "Contact pressure at the centre of the fingerpad",
        NINE,
        TIME,
        (FORCE, P_CENTRE),
        {TIME: "T124", FORCE: "T122", P_CENTRE: "T123"},
        Panels(
            4.9,
            names=((TIME, FORCE), (TIME, P_CENTRE)),
            fill=force_or_pressure,
            share={"sharex": True, "height_ratios": (1, 3.2)},
        ),
    ),
    Figure(
        "4-11",
        "Contact pressure across the contact region",
        NINE,
        X.reading(None, "horizontal location (mm)"),
        (P,),
        {X: "T134", P: PRESSURE_IDS},
        nine(SURFACES, 5.9, fill=Phases(), limit="y", extra=bars_of_pressure),
        rows=lambda data: data.profiles(NINE),
        measured="pads",
        after=lambda data: data.bands(P, {"peak": {}}),
    ),
    Figure(
        "4-12",
        "Flat plate: pressure on a homogeneous and on the layered pad",
        PADS,
        X,
        (P,),
        {X: "T137", P: {"homogeneous": "T135", "layered": "T136"}},
        Panels(
            3.1,
            by="pad",
            names=PADS,
            across=2,
            fill=Phases(colour="flat"),
            share={"sharey": True},
            extra=pad_titles,
        ),
        rows=lambda data: data.profiles(PADS),
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
        Page(3.3, overlaid.pressures_over_sinking, "surface"),
        rows=lambda data: data.profiles(NINE, DOWN, half=True),
    ),
    Figure(
        "4-14",
        "Pressure from the centre outwards over time, K = 210 1/m",
        K210,
        X.reading(None, "distance from the centre (mm)"),
        (P,),
        {X: "T146", P: "T145"},
        Panels(3.5, fill=Phases(), extra=mark_peaks),
        rows=lambda data: data.profiles(K210, half=True),
    ),
    Figure(
        "4-15",
        "Maximum and centre pressure, K = 210 1/m",
        K210,
        TIME,
        (P_PEAK.reading(P_PEAK.read, P.label), P_CENTRE),
        {TIME: "T149", P_PEAK: "T148"},
        Panels(
            2.6,
            fill=Lines(
                looks={P_PEAK: axs.FIRST, P_CENTRE: axs.SECOND | {"color": style.HIGHLIGHT}},
                names={P_PEAK: "maximum", P_CENTRE: "centre node"},
            ),
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
        Panels(3.4, fill=every_node),
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
        Page(6.2, three_by_three),
        rows=profiles_and_receptors,
        after=axes_of_three,
        judged_with=(NINE.only(THREE),),
    ),
    Figure(
        "4-21",
        f"Strain energy density at 915 µm and contact pressure × {PRESSURE_SCALE}, centre",
        NINE,
        TIME,
        (SED.reading(None, ENERGY_AND_PRESSURE), P_SCALED),
        {
            SED: by_surface(
                "T173 T174 T175 T176 T177a T177b T178 T179",
                [k for k in SURFACES if k != "158"],
            )
        },
        Page(3.3, overlaid.energies_and_pressures, "surface"),
        # with the errors of the pressure before it is scaled
        rows=lambda data: data.traces(NINE, (TIME, SHOWN, P_SCALED), (SHOWN, P_CENTRE)),
    ),
    Figure(
        "4-23",
        "Strain energy density 915 µm under the centre",
        NINE,
        TIME,
        (SHOWN,),
        {TIME: "T189", SED: "T188"},
        Panels(3.0, fill=Lines(ends=2.62)),
        width=style.COLUMN_WIDTH,
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
            by=RECEPTOR,
            set=HOLD,
            title=name_depth,
            extra=legend_of_surfaces,
        ),
        rows=energies,
    ),
    Figure(
        "4-28",
        "Rate of strain energy density 915 µm under the centre",
        NINE,
        TIME,
        (RATE,),
        {TIME: "T206", RATE: "T205"},
        Panels(3.0, fill=legs_of_rates),
        rows=energy_rates,
        width=style.COLUMN_WIDTH,
    ),
)

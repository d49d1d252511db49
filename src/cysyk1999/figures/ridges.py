"""Section 5.5: a pad with inner ridges, pressed by nine surfaces and stroked by a flat plate.

A ridge's tip is at x = 0: of the thesis's receptors at 915 um depth the middle one lies in the
epidermis, those beside it in the dermis, so receptors of equal material are shown beside it.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING

import pandas as pd

from cysyk1999.figures import axes as axs
from cysyk1999.figures.geometry import (
    LAYERS,
    NOTE,
    draw_mesh,
    layer_patches,
    mesh_rows,
    quality_of,
    stratum_corneum,
)
from cysyk1999.figures.grammar import HOW, Data, Figure, Lines, Own, Panels, stacked
from cysyk1999.measures.direction import BESIDE, DEPTH, OFFSETS, UNDER_TIP
from cysyk1999.measures.errors import curve_errors, over_stroke, total
from cysyk1999.measures.quantities import SED, STROKE_TIME, TIME, X, Y, sed
from cysyk1999.measures.runs import PLAIN, RIDGED, RIDGED_NINE, Runs
from cysyk1999.publishing import style
from fingerpad.measures.features import SIMULATED, is_simulated
from fingerpad.measures.strokes import loaded

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

WAYS = {"right": "plate to the right (thesis)", "left": "plate to the left"}
LAYERED = (
    "The tip of a ridge is at x = 0, 925 µm deep: at 915 µm the centre lies in the "
    "epidermis, x = ±46 µm in the dermis."
)
WINDOW = (5.0, 7.0)  # mm, half the width and the height of what Fig 5-25 shows
DETAIL = (-0.85, 0.85, 4.15, 6.05)  # mm
FLAT = RIDGED_NINE.only(("flat",)).without_companions()
PLACES = {"centre, x = 0 (epidermis of the tip)": 0.0, "x = 46 µm (dermis)": BESIDE}
EXTRA = "centre, 935 µm (dermis)"
LOOKS = {
    "x = −46 µm": {"color": style.HIGHLIGHT, "ls": "-"},
    "centre": {"color": style.INK, "ls": style.DASHED},
    "x = 46 µm": {"color": style.CATEGORIES[1], "ls": style.DOTTED, "lw": 1.4},
    EXTRA: {"color": style.GREY, "ls": (0, (6, 1.5, 1, 1.5)), "lw": 1.0},
}


def elements(data: Data) -> pd.DataFrame:
    """Elements of the ridged pad within the thesis's window."""
    rows = mesh_rows(data.meshes[FLAT["flat"]], stratum_corneum(data.histories[FLAT["flat"]]))
    rows = rows[
        (rows["series"] != "element") | (rows[X].abs().le(WINDOW[0] + 2.5) & rows[Y].ge(-2.5))
    ]
    whole = (
        rows.groupby("element")[Y].transform("size") >= 4
    )  # those cut by the window's edge are left out
    return rows[(rows["series"] != "element") | whole].reset_index(drop=True)


def mesh_and_detail(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """The ridged mesh, layers shaded, and a part of it enlarged."""
    from matplotlib.patches import Rectangle

    whole, detail = fig.subplots(1, 2, width_ratios=[1.32, 1.0])
    for ax, line in ((whole, 0.12), (detail, 0.3)):
        draw_mesh(ax, frame, line)
        ax.set(aspect="equal", xlabel=X.label, ylabel=Y.label)
    whole.set(xlim=(-WINDOW[0], WINDOW[0]), ylim=(0, WINDOW[1]), xticks=range(-5, 6))
    left, right, low, high = DETAIL
    detail.set(xlim=(left, right), ylim=(low, high))
    whole.add_patch(
        Rectangle((left, low), right - left, high - low, fill=False, ec=style.INK, lw=0.8)
    )
    small = {
        "ncols": 4,
        "handlelength": 1.0,
        "columnspacing": 0.9,
        "fontsize": 6.5,
        "borderaxespad": 0.2,
    }
    whole.legend(handles=layer_patches(LAYERS[:-1]), loc="upper left", **small)
    detail.plot(
        [-BESIDE * 1e3, 0, BESIDE * 1e3],
        [6.0 - DEPTH * 1e3] * 3,
        "o",
        mfc="white",
        mec=style.INK,
        ms=3.2,
        mew=0.7,
    )
    value = quality_of(frame)
    detail.set_title(
        f"{value['nodes (1)']:,.0f} nodes, smallest edge {value['smallest_edge (um)']:.0f} µm",
        fontsize=6.5,
    )


def at_two_places(data: Data) -> pd.DataFrame:
    """Strain energy at 915 um against time, nine surfaces, at the centre and beside it."""
    rows = stacked(
        {panel: data.traces(RIDGED_NINE, (TIME, sed(DEPTH, x))) for panel, x in PLACES.items()}
    )
    rows.insert(0, "source", rows.pop("source"))
    return rows


def named_at_both(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """Axes of their own, for the tip of a ridge is stiff, with the surfaces' names, and what the
    thesis's axis would be.
    """
    for panel, ax in panels.items():
        rows, ends = frame[frame["panel"] == panel], {}
        for label, trace in rows.groupby("surface", sort=False):
            ends[label] = (trace[TIME].iloc[-1], trace[SED].iloc[-1])
        ax.set_ylim(0, 1.1 * rows[SED].max())
        style.label_ends(ax, ends, 2.6, "1/m")
        axis = frame.loc[frame["source"].str.contains("axis range"), SED].max()
        if axis == axis:
            text = f"thesis's axis: to {axis:.0f} Pa, {axis / rows[SED].max():.1f} times as high"
            ax.text(
                0.03, 0.98, text, transform=ax.transAxes, va="top", fontsize=6.5, color=style.GREY
            )


def at_receptors(data: Data, runs: Runs) -> pd.DataFrame:
    """Strain energy over time at the thesis's three receptors, and under the tip if there are
    ridges, both ways.
    """
    places = {series: (DEPTH, x) for series, x in OFFSETS.items()} | (
        {EXTRA: (UNDER_TIP, 0.0)} if runs is RIDGED else {}
    )
    parts, right = [], runs["right"]
    for way, scene in runs.scenes.items():
        stroke = loaded(data.histories[scene])
        for series, (depth, x) in places.items():
            # the two ways are mirror images: the companion of the stroke to the right serves both,
            # read on either side
            side = sed(depth, x if way == "right" else -x).read
            errors = curve_errors(
                data.histories[right], data.coarse.get(right), over_stroke(side)
            ).columns
            part = {
                "source": SIMULATED,
                "panel": way,
                "series": series,
                TIME: STROKE_TIME.read(stroke),
            }
            parts.append(pd.DataFrame(part | {SED: sed(depth, x).read(stroke)} | errors))
    return pd.concat(parts, ignore_index=True)


def name_receptors(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    series = frame.loc[is_simulated(frame), "series"].unique()
    style.header_legend(
        panels["right"].figure, [style.handle(each, **LOOKS[each]) for each in series]
    )


def magnify_the_difference(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """In an inset, how much more than the centre the receptors beside it have."""
    name_receptors(panels, frame)
    own = frame[is_simulated(frame)]
    for way, ax in panels.items():
        curves = {
            series: rows for series, rows in own[own["panel"] == way].groupby("series", sort=False)
        }
        high = own[SED].min() / ax.get_ylim()[1] - 0.26  # below the curves
        inset, centre = ax.inset_axes((0.16, 0.12, 0.8, max(high, 0.15))), curves.pop("centre")
        for series, rows in curves.items():
            inset.plot(rows[TIME], rows[SED].to_numpy() - centre[SED].to_numpy(), **LOOKS[series])
        inset.axhline(0, color=style.GREY, lw=0.5, zorder=1)
        inset.set(xlim=ax.get_xlim(), facecolor="none")
        inset.set_title("difference from the centre (Pa)", fontsize=6.5)
        inset.tick_params(labelbottom=False)


def plate_stroked(
    number: str, pad: str, runs: Runs, axis: str, remark: str, extra=name_receptors
) -> Figure:
    """Figs 5-28 and 5-29."""

    def note(frame: pd.DataFrame) -> list[str]:
        beside = frame["series"].isin(["x = −46 µm", "x = 46 µm"]) | ~is_simulated(frame)
        others = total(frame[~beside]).groupby(frame["series"]).max().dropna()
        how = f"at x = ±46 µm, {HOW}" + "".join(
            f"; {each} {value:.1f} %" for each, value in others.items()
        )
        return axs.footnote(frame[beside], how)

    title = f"Strain energy density at 915 µm, flat plate stroked at 10 mm/s, {pad}"
    return Figure(
        number,
        title,
        runs,
        STROKE_TIME,
        (SED,),
        {TIME: "T318", SED: axis},
        Panels(
            height=3.0,
            header=0.16,
            by="panel",
            names=tuple(WAYS),
            shape=(1, 2),
            alike=True,
            marked="left",
            fill=Lines(by="series", looks=LOOKS),
            titles=WAYS.get,
            each=True,
            share={"sharey": True},
        ),
        rows=partial(at_receptors, runs=runs),
        note=note,
        extra=extra,
        remarks=(remark,),
    )


FIGURES = (
    Figure(
        "5-25",
        "Finite element mesh of the fingerpad with inner ridges",
        FLAT,
        X,
        (Y,),
        {X: "T309", Y: "T310"},
        Own(height=3.75, paint=mesh_and_detail),
        rows=elements,
        meshes=True,
        note=lambda frame: [NOTE],
        remarks=(
            "The thesis states neither pitch nor height of its ridges: 0.48 mm and 0.15 mm here, "
            "see "
            "config/reference/ridges.csv.",
            "Circles: the receptors of Figs 5-28 and 5-29.",
        ),
    ),
    Figure(
        "5-26",
        "Strain energy density at 915 µm, pad with inner ridges",
        RIDGED_NINE,
        TIME,
        (SED,),
        {TIME: "T312", SED: "T311"},
        Panels(
            height=3.4,
            by="panel",
            names=tuple(PLACES),
            shape=(1, 2),
            each=True,
            limit="",
            fill=Lines(by="surface"),
            titles=str,
            set={"xlim": (0, 3.05)},
        ),
        rows=at_two_places,
        remarks=(LAYERED,),
        extra=named_at_both,
    ),
    plate_stroked(
        "5-28",
        "no ridges",
        PLAIN,
        "T317",
        "Times count from the start of the stroke; the pad was pressed to 20 gf before.",
        magnify_the_difference,
    ),
    plate_stroked("5-29", "inner ridges", RIDGED, "T319", LAYERED),
)

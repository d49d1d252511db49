"""Section 5.5: a pad with inner ridges, pressed by nine surfaces and stroked by a flat plate.

A ridge's tip is at x = 0: of the thesis's receptors at 915 um depth the middle one lies in the
epidermis, those beside it in the dermis, so receptors of equal material are shown beside it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from matplotlib.patches import Rectangle
from pandas import DataFrame

from cysyk1999.figures import axes as axs
from cysyk1999.figures.geometry import (
    NOTE,
    draw_mesh,
    layer_patches,
    mesh_rows,
    stratum_corneum,
)
from cysyk1999.figures.grammar import HOW, Data, Figure, Lines, Page, Panels, stacked
from cysyk1999.measures.direction import BESIDE, DEPTH, OFFSETS, UNDER_TIP
from cysyk1999.measures.errors import curve_errors, over_stroke, total
from cysyk1999.measures.quantities import SED, STROKE_TIME, TIME, X, Y, sed
from cysyk1999.measures.runs import NINE, PLAIN, RIDGED, RIDGED_NINE, Runs
from cysyk1999.publishing import style
from fingerpad.measures.features import SIMULATED, is_simulated
from fingerpad.measures.strokes import loaded

WAYS = {"right": "plate to the right (thesis)", "left": "plate to the left"}
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


def elements(data: Data) -> DataFrame:
    """Elements of the ridged pad within the thesis's window."""
    rows = mesh_rows(data.meshes[FLAT["flat"]], stratum_corneum(data.histories[FLAT["flat"]]))
    inside = rows[X].abs().le(WINDOW[0] + 2.5) & rows[Y].ge(-2.5)
    rows = rows[(rows["series"] != "element") | inside]
    # elements cut by the window's edge are left out
    whole = rows.groupby("element")[Y].transform("size") >= 4
    return rows[(rows["series"] != "element") | whole]


def mesh_and_detail(fig, frame, spec):
    """The ridged mesh, layers shaded, and a part of it enlarged."""
    whole, detail = fig.subplots(1, 2, width_ratios=[1.32, 1.0])
    for ax, line in ((whole, 0.12), (detail, 0.3)):
        draw_mesh(ax, frame, line)
        ax.set(aspect="equal", xlabel=X.label, ylabel=Y.label)
    whole.set(xlim=(-WINDOW[0], WINDOW[0]), ylim=(0, WINDOW[1]), xticks=range(-5, 6))
    left, right, low, high = DETAIL
    detail.set(xlim=(left, right), ylim=(low, high))
    frame_of = {"fill": False, "ec": style.INK, "lw": 0.8}
    whole.add_patch(Rectangle((left, low), right - left, high - low, **frame_of))
    small = {"handlelength": 1.0, "columnspacing": 0.9, "borderaxespad": 0.2}
    whole.legend(handles=layer_patches(), loc="upper left", ncols=5, **small)
    at = [-BESIDE * 1e3, 0, BESIDE * 1e3], [6.0 - DEPTH * 1e3] * 3
    detail.plot(*at, "o", mfc="white", mec=style.INK, ms=3.2, mew=0.7)
    detail.set_title(f"circles: receptors, {DEPTH * 1e6:.0f} µm deep", fontsize=6.5)


@stacked
def at_two_places(data: Data) -> Iterator[DataFrame]:
    """Strain energy at 915 um against time, nine surfaces, at the centre and beside it."""
    for panel, x in PLACES.items():
        yield data.traces(RIDGED_NINE, (TIME, sed(DEPTH, x))).assign(panel=panel)


def named_at_both(panels, frame):
    """Axes of their own, for the tip of a ridge is stiff, with the surfaces' names, and what the
    thesis's axis would be.
    """
    axis = frame.loc[frame["source"].str.contains("axis range"), SED].max()
    for panel, ax in panels.items():
        rows = frame[frame["panel"] == panel]
        last = rows.groupby("surface", sort=False)[[TIME, SED]].last()
        highest = rows[SED].max()
        ax.set_ylim(0, 1.1 * highest)
        style.label_ends(ax, {label: tuple(end) for label, end in last.T.items()}, 2.6, "1/m")
        if axis == axis:
            text = f"thesis's axis: to {axis:.0f} Pa, {axis / highest:.1f} times as high"
            axs.remark(ax, 0.03, 0.98, text, va="top", **axs.NOTE)


@stacked
def at_receptors(data: Data, runs: Runs) -> Iterator[Mapping]:
    """Strain energy over time at the thesis's three receptors, and under the tip if there are
    ridges, both ways.
    """
    places = {series: (DEPTH, x) for series, x in OFFSETS.items()}
    if runs is RIDGED:
        places[EXTRA] = (UNDER_TIP, 0.0)
    right = data.histories[runs["right"]], data.coarse.get(runs["right"])
    for way, scene in runs.scenes.items():
        stroke = loaded(data.histories[scene])
        for series, (depth, x) in places.items():
            # the two ways are mirror images: the companion of the stroke to the right serves both,
            # read on either side
            side = sed(depth, x if way == "right" else -x)
            errors = curve_errors(*right, over_stroke(side.read)).columns
            of = {"source": SIMULATED, "panel": way, "series": series}
            energies = {TIME: STROKE_TIME.read(stroke), SED: sed(depth, x).read(stroke)}
            yield of | energies | errors


def name_receptors(panels, frame):
    """Legend of the receptors."""
    looks = {series: LOOKS[series] for series in axs.simulated(frame)["series"].unique()}
    style.header_legend(panels["right"].figure, style.handles(looks))


def magnify_the_difference(panels, frame):
    """In an inset, how much more than the centre the receptors beside it have."""
    name_receptors(panels, frame)
    own = axs.simulated(frame)
    for way, ax in panels.items():
        curves = dict(list(own[own["panel"] == way].groupby("series", sort=False)))
        centre = curves.pop("centre")[SED].to_numpy()
        high = own[SED].min() / ax.get_ylim()[1] - 0.26  # below the curves
        inset = ax.inset_axes((0.16, 0.12, 0.8, max(high, 0.15)))
        for series, rows in curves.items():
            inset.plot(rows[TIME], rows[SED].to_numpy() - centre, **LOOKS[series])
        inset.axhline(0, color=style.GREY, lw=0.5, zorder=1)
        inset.set(xlim=ax.get_xlim(), facecolor="none")
        inset.set_title("difference from the centre (Pa)", fontsize=6.5)
        inset.tick_params(labelbottom=False)


def plate_note(frame: DataFrame) -> list[str]:
    """The errors at the receptors beside the tip, and those of the others."""
    beside = frame["series"].isin(["x = −46 µm", "x = 46 µm"]) | ~is_simulated(frame)
    others = total(frame[~beside]).groupby(frame["series"]).max().dropna()
    rest = "".join(f"; {series} {value:.1f} %" for series, value in others.items())
    return axs.footnote(frame[beside], f"at x = ±46 µm, {HOW}{rest}")


def plate_stroked(number: str, pad: str, runs: Runs, axis: str, extra=name_receptors) -> Figure:
    """Figs 5-28 and 5-29."""
    return Figure(
        number,
        f"Strain energy density at 915 µm, flat plate stroked at 10 mm/s, {pad}",
        runs,
        STROKE_TIME,
        (SED,),
        {TIME: "T318", SED: axis},
        Panels(
            3.0,
            by="panel",
            names=WAYS,
            across=2,
            alike=True,
            marked="left",
            fill=Lines(by="series", looks=LOOKS),
            title=lambda ax, way: ax.set_title(WAYS[way]),
            share={"sharey": True},
            extra=extra,
        ),
        rows=partial(at_receptors, runs=runs),
        note=plate_note,
    )


FIGURES = (
    Figure(
        "5-25",
        "Finite element mesh of the fingerpad with inner ridges",
        FLAT,
        X,
        (Y,),
        {X: "T309", Y: "T310"},
        Page(3.75, mesh_and_detail),
        at_rest=True,
        rows=elements,
        note=lambda frame: [NOTE],
    ),
    Figure(
        "5-26",
        "Strain energy density at 915 µm, pad with inner ridges",
        RIDGED_NINE,
        TIME,
        (SED,),
        {TIME: "T312", SED: "T311"},
        Panels(
            3.4,
            by="panel",
            names=PLACES,
            across=2,
            limit="",
            extra=named_at_both,
            set={"xlim": (0, 3.05)},
        ),
        rows=at_two_places,
        judged_with=(NINE,),
    ),
    plate_stroked("5-28", "no ridges", PLAIN, "T317", magnify_the_difference),
    plate_stroked("5-29", "inner ridges", RIDGED, "T319"),
)

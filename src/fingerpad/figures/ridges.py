"""Section 5.5: a pad with inner ridges, pressed by nine surfaces and stroked by a flat plate.

Frames and pictures as in `chapter4` and `chapter5`. A ridge's tip is at x = 0: of the thesis's receptors at 915 um depth the
middle one lies in the epidermis, those beside it in the dermis, so receptors of equal material are shown beside it.
"""

from __future__ import annotations

from functools import partial

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from fingerpad.figures.chapter3 import LAYERS, NOTE, draw_mesh, mesh_rows, stratum_corneum
from fingerpad.figures.spec import FigureSpec, assemble, axis_rows
from fingerpad.measures.direction import BESIDE, DEPTH, OFFSETS, UNDER_TIP
from fingerpad.measures.features import (
    ERROR,
    SIMULATED,
    SURFACES,
    Histories,
    Meshes,
    Trace,
    at_ends,
    energy,
    error_percent,
    is_simulated,
    scene_name,
    scenes,
)
from fingerpad.measures.quantities import SED, TIME, X, Y
from fingerpad.measures.runs import PLAIN, RIDGED, Runs
from fingerpad.measures.strokes import loaded, rms_error, time_of
from fingerpad.publishing import style

WAYS = {"right": "(a) plate to the right (thesis)", "left": "(b) plate to the left"}
LAYERED = "The tip of a ridge is at x = 0, 925 µm deep: at 915 µm the centre lies in the epidermis, x = ±46 µm in the dermis."


# --- 5-25 ----------------------------------------------------------------------------------------------

WINDOW = (5.0, 7.0)  # mm, half the width and the height of what Fig 5-25 shows
DETAIL = (-0.85, 0.85, 4.15, 6.05)  # mm


def frame_5_25(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Elements of the ridged pad within the thesis's window."""
    name = scene_name("ridged_40", "flat")
    rows = mesh_rows(meshes[name], stratum_corneum(histories[name]))
    rows = rows[(rows["series"] != "element") | (rows[X].abs().le(WINDOW[0] + 0.4) & rows[Y].ge(-1.5))]
    whole = rows.groupby("element")[Y].transform("size") >= 4  # those cut by the window's edge are left out
    return assemble(rows[(rows["series"] != "element") | whole].reset_index(drop=True), axis_rows(reference, X, "T309"),
                    axis_rows(reference, Y, "T310"))  # fmt: skip


@style.styled
def fig_5_25(frame: pd.DataFrame) -> Figure:
    """The ridged mesh, layers shaded, and a part of it enlarged."""
    sizes = "The thesis states neither pitch nor height of its ridges: 0.48 mm and 0.15 mm here, see config/reference/ridges.csv."
    note = [NOTE, sizes, "Circles: the receptors of Figs 5-28 and 5-29."]
    fig = style.new_figure(frame, "5-25", "Finite element mesh of the fingerpad with inner ridges", 3.75, note=note)
    axes = fig.subplots(1, 2, width_ratios=[1.32, 1.0])
    for ax, line in zip(axes, (0.12, 0.3), strict=True):
        draw_mesh(ax, frame, line)
        ax.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    axes[0].set(xlim=(-WINDOW[0], WINDOW[0]), ylim=(0, WINDOW[1]), xticks=range(-5, 6))
    left, right, low, high = DETAIL
    axes[1].set(xlim=(left, right), ylim=(low, high))
    axes[0].add_patch(Rectangle((left, low), right - left, high - low, fill=False, ec=style.INK, lw=0.8))
    layers = [k for k in LAYERS if k != "bone"]
    handles = [Patch(facecolor=style.LAYER_COLOURS[k], edgecolor="0.25", lw=0.4, label=k) for k in layers]
    axes[0].legend(handles=handles, loc="upper left", ncols=4, handlelength=1.0, columnspacing=0.9, fontsize=7, borderaxespad=0.2)
    axes[1].plot([-BESIDE * 1e3, 0, BESIDE * 1e3], [6.0 - DEPTH * 1e3] * 3, "o", mfc="white", mec=style.INK, ms=3.2, mew=0.7)
    value = frame.dropna(subset="value").set_index("quantity")["value"]
    axes[1].set_title(f"{value['nodes (1)']:,.0f} nodes, smallest edge {value['smallest_edge (um)']:.0f} µm", fontsize=7.5)
    return fig


# --- 5-26 ----------------------------------------------------------------------------------------------

PLACES = {"centre, x = 0 (epidermis of the tip)": 0.0, "x = 46 µm (dermis)": BESIDE}


def frame_5_26(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy at 915 um against time, nine surfaces, at the centre and beside it."""
    parts = []
    for panel, offset in PLACES.items():
        read = partial(energy, depth=DEPTH, offset=offset)
        for label in SURFACES:
            name = scene_name("ridged_40", label)
            history = histories[name]
            part = {"panel": panel, "surface": label, TIME: history["time"].values, SED: read(history)}
            parts.append(pd.DataFrame(part | {ERROR: error_percent(history, coarse.get(name), *at_ends(read))}))
    return assemble(pd.concat(parts, ignore_index=True), axis_rows(reference, TIME, "T312"), axis_rows(reference, SED, "T311"))


@style.styled
def fig_5_26(frame: pd.DataFrame) -> Figure:
    """Nine traces, direct labels, at two places."""
    title = "Strain energy density at 915 µm, pad with inner ridges"
    fig = style.new_figure(frame, "5-26", title, 4.6, note=style.footnote(frame) + [LAYERED])
    axes = fig.subplots(1, 2, sharey=True)
    for ax, (tag, panel) in zip(axes, zip("ab", PLACES, strict=True), strict=True):
        style.limit_axis(ax, frame, TIME, "x")
        style.limit_axis(ax, frame, SED, text=False)
        ends = {}
        for label in SURFACES:
            rows = frame[(frame["panel"] == panel) & (frame["surface"] == label)]
            ax.plot(rows[TIME], rows[SED], color=style.COLOURS[label])
            ends[label] = (rows[TIME].iloc[-1], rows[SED].iloc[-1])
        if panel == next(iter(PLACES)):  # far below the axis's end: enlarged, in the colours of the other panel's labels
            large = ax.inset_axes((0.16, 0.4, 0.72, 0.5))
            for line in ax.get_lines():
                large.plot(*line.get_data(), color=line.get_color(), lw=1.1)
            large.set(xlim=(0, 2.6), ylim=(0, 1.06 * max(frame.loc[frame["panel"] == panel, SED])))
            large.set_title("enlarged", fontsize=7.5)
            large.tick_params(labelsize=7)
        else:
            style.label_ends(ax, ends, 2.6, "1/m")
        ax.set(xlabel="time (s)", title=f"({tag}) {panel}", xlim=(0, 3.05))
    axes[0].set_ylabel("strain energy density (Pa)")
    return fig


# --- 5-28, 5-29 ----------------------------------------------------------------------------------------

EXTRA = "centre, 935 µm (dermis)"
LOOKS = {
    "x = −46 µm": {"color": style.COLOURS["315"], "ls": "-"},
    "centre": {"color": style.INK, "ls": (0, (4, 1.8))},
    "x = 46 µm": {"color": "#1f77a4", "ls": (0, (1, 1.2))},
    EXTRA: {"color": style.GREY, "ls": (0, (6, 1.5, 1, 1.5)), "lw": 1.0},
}


def receptor(depth: float, offset: float) -> Trace:
    """Trace of the strain energy density (Pa) at a depth and offset (m)."""
    return lambda stroke: energy(stroke, depth, offset)


def _plate_frame(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, *, strokes: Runs, axis: str
) -> pd.DataFrame:
    """Strain energy over time at the thesis's three receptors, and under the tip if there are ridges, both ways."""
    places = {series: (DEPTH, x) for series, x in OFFSETS.items()}
    if strokes is RIDGED:
        places[EXTRA] = (UNDER_TIP, 0.0)
    parts, right = [], strokes["right"]
    for way, name in strokes.scenes.items():
        stroke = loaded(histories[name])
        for series, (depth, x) in places.items():
            # the two ways are mirror images: the companion of the stroke to the right serves both, read on either side
            side = receptor(depth, x if way == "right" else -x)
            error = rms_error(histories[right], coarse.get(right), side)
            trace = receptor(depth, x)(stroke)
            part = {"source": SIMULATED, "panel": way, "series": series, TIME: time_of(stroke), SED: trace, ERROR: error}
            parts.append(pd.DataFrame(part))
    return assemble(pd.concat(parts, ignore_index=True), axis_rows(reference, TIME, "T318"), axis_rows(reference, SED, axis))


def _draw_plate(frame: pd.DataFrame, number: str, title: str, note: list[str]) -> Figure:
    beside = frame["series"].isin(["x = −46 µm", "x = 46 µm"]) | ~is_simulated(frame)
    others = frame[~beside].groupby("series")[ERROR].max().dropna()
    how = "at x = ±46 µm, r.m.s. over the stroke" + "".join(f"; {each} {value:.1f} %" for each, value in others.items())
    note = style.footnote(frame[beside], how) + note
    fig = style.new_figure(frame, number, title, 3.9, note=note, header=0.2)
    axes = fig.subplots(1, 2, sharey=True)
    own = frame[is_simulated(frame)]
    series = own["series"].unique()
    for ax, (way, name) in zip(axes, WAYS.items(), strict=True):
        style.limit_axis(ax, frame, TIME, "x")
        style.limit_axis(ax, frame, SED, text=way == "left")
        for each in series:
            rows = own[(own["panel"] == way) & (own["series"] == each)]
            ax.plot(rows[TIME], rows[SED], **LOOKS[each])
        ax.set(xlabel="time (s)", title=name)
    axes[0].set_ylabel("strain energy density (Pa)")
    style.header_legend(fig, [style.Line2D([], [], label=each, **LOOKS[each]) for each in series])
    return fig


@style.styled
def fig_5_28(frame: pd.DataFrame) -> Figure:
    """Three receptors under a plain pad."""
    title = "Strain energy density at 915 µm, flat plate stroked at 10 mm/s, no ridges"
    return _draw_plate(
        frame, "5-28", title, ["Times count from the start of the stroke; the pad was pressed to 20 gram-weight before."]
    )


@style.styled
def fig_5_29(frame: pd.DataFrame) -> Figure:
    """Three receptors, and one just under the tip, of a pad with inner ridges."""
    title = "Strain energy density at 915 µm, flat plate stroked at 10 mm/s, inner ridges"
    return _draw_plate(frame, "5-29", title, [LAYERED])


FIGURES = (
    FigureSpec("5-25", "Mesh with inner ridges", (scene_name("ridged_40", "flat"),), frame_5_25, fig_5_25, companions=()),
    FigureSpec("5-26", "Strain energy over time, inner ridges", scenes("ridged_40"), frame_5_26, fig_5_26),
    FigureSpec("5-28", "Flat plate stroked, no ridges", tuple(PLAIN.scenes.values()),
               partial(_plate_frame, strokes=PLAIN, axis="T317"), fig_5_28, companions=(PLAIN["right"],)),
    FigureSpec("5-29", "Flat plate stroked, inner ridges", tuple(RIDGED.scenes.values()),
               partial(_plate_frame, strokes=RIDGED, axis="T319"), fig_5_29, companions=(RIDGED["right"],)),
)  # fmt: skip

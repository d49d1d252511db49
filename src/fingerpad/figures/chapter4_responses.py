"""Chapter 4, from skin to impulses: the laws of pressure and strain energy, and predicted rates of slowly adapting receptors.

The recordings that the thesis shows beside its model are not public. Its figures of recordings alone (4-2 to 4-5) are made from
predicted rates (Eq 5-1 with the thesis's constants) and say so in the picture; in those of comparisons (4-9, 4-18 to 4-29) the
predicted rates stand where the recorded ones did, with what can be read of those in the thesis, and with published rates and
another model's in panels of their own. A user's recordings under the same protocol are laid over (config/reference/recordings).
"""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from fingerpad.figures.spec import FigureSpec, assemble, axis_rows, rows_of
from fingerpad.measures.features import (
    ERROR,
    PRESSURE,
    SIMULATED,
    SURFACES,
    Histories,
    Meshes,
    at_ends,
    centre_pressure,
    energy,
    error_percent,
    force_gf,
    is_simulated,
    peak_pressure,
    ramp_end,
    scene_name,
    scenes,
    surface_nodes,
    width,
)
from fingerpad.measures.quantities import CURVATURE, FORCE, NODE, P_PEAK, RATE, SED, TIME, P
from fingerpad.measures.responses import (
    FREQUENCY,
    IMPULSE_RATE,
    NODE_COUNT,
    NODE_SURFACE,
    P_LAW,
    RECEPTOR_DEPTH,
    SED_LAW,
    SHALLOW_DEPTH,
    TRIALS,
    contact_nodes,
    curvature_of,
    energy_from_pressure,
    fit_nodes,
    fit_sum,
    mean_frequency,
    mean_pressure,
    peak_energy_rate,
    predicted_rate,
    pressed,
    pressure_by_law,
    raster,
    rate_in,
    shallow_law,
    straight_line,
)
from fingerpad.publishing import style
from fingerpad.receptors.fits import gain_and_threshold, r_squared
from fingerpad.receptors.laws import THESIS_RATE, rectified
from fingerpad.receptors.spikes import VARIATION

Reading = Callable[[xr.Dataset], float]
INVERSE_WIDTHS = dict(zip(SURFACES, ("T106", "T108", "T110", "T112", "T114", "T115", "T116", "T118", "T120"), strict=True))
HELD_RATES = {"flat": "T107", "79": "T109", "105": "T111", "158": "T113", "420": "T117", "630": "T119", "1260": "T121"}
AVERAGED, SEED = 100, 1999
"""Trials that the frequency of Fig 4-3 is the mean of, and the seed of every variability."""

IMPULSE = "impulse_time (s)"
INVERSE_WIDTH = "inverse_contact_width (1/mm)"
MEAN_P = "mean_centre_pressure (Pa)"
GIVEN_RATE = "impulse_rate (impulses/s)"
STEADY_RATE = "steady_rate (impulses/s)"
DOUBT = "surface_may_be (1/m)"
LAW_NOTE = (
    "Predicted, not recorded: Eq. 5-1 with the thesis's constants (0.081 (impulses/s)/Pa, 150 Pa; 0.0182 impulses/Pa, 100 Pa/s)"
)
PUBLISHED = "monkey, spheres; ours: cylinders"
CONTEXT = style.mpl.colormaps["viridis"](np.linspace(0.15, 0.75, 3))

PRINTED = ("T083", "T084", "T085", "T086", "T087")
"""Mean rates of the hold that can be read beside the rasters of Fig 4-2."""
ENERGIES = dict(zip(SURFACES, ("T181", "T182", "T183", "T184", "T185", "T186", "T187a", "T187b", "T187c"), strict=True))

# --- rows of frames --------------------------------------------------------------------------------------


def _numbers(histories: Histories, coarse: Histories, programme: str, columns: Mapping[str, Reading]) -> pd.DataFrame:
    """One row a surface: curvature, numbers, and their error: the largest, each relative to the largest among the surfaces."""
    found = pressed(histories, programme)
    rows = pd.DataFrame({column: {label: read(h) for label, h in found.items()} for column, read in columns.items()})
    largest = rows.abs().max()
    errors = {}
    for label in found:
        if (companion := coarse.get(scene_name(programme, label))) is None:
            errors[label] = float("nan")
            continue
        off = [abs(read(companion) - rows.loc[label, c]) / (largest[c] or 1.0) for c, read in columns.items()]
        errors[label] = 100 * max(off)
    rows.insert(0, CURVATURE, {label: curvature_of(h) for label, h in found.items()})
    return rows.assign(**{ERROR: errors}).rename_axis("surface").reset_index()


def _line(rows: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    """Two rows: the ends of the line through points, from 0 to the last of them, where it is not negative."""
    slope, offset, share = straight_line(rows[x], rows[y])
    low = max(0.0, -offset / slope) if slope > 0 else 0.0
    ends = np.array([low, rows[x].max()])
    source = f"{SIMULATED}: least-squares line, R2 {share:.3f}"
    return pd.DataFrame({"source": source, x: ends, y: slope * ends + offset})


def _given(
    rates: pd.DataFrame | None, reference: pd.DataFrame, window: str, ramp: float, column: str = GIVEN_RATE
) -> pd.DataFrame:
    """Rates recorded under the protocol of a figure: those printed in the thesis, and a user's."""
    if rates is None:
        return pd.DataFrame()
    same = rates[
        (rates["receptor"] == "SA-I")
        & (rates["species"] != "model")
        & rates["stimulus"].isin(("flat plate", "cylinder"))
        & (rates["force_gf"].sub(20).abs() < 0.5)
        & (rates["ramp_gf_per_s"] == ramp)
        & (rates["window"] == window)
    ]
    printed = {float(reference.loc[id_, "low"]): id_ for id_ in PRINTED if id_ in reference.index}
    of_thesis = same["source"].str.startswith("Cysyk 1999")
    same = same[~of_thesis | same["rate_per_s"].isin(printed)].reset_index(drop=True)
    of_thesis = same["source"].str.startswith("Cysyk 1999")
    sources = [
        f"stated in the thesis ({printed[rate]}, reading uncertain)" if thesis else f"measured ({recording}; {source})"
        for thesis, rate, recording, source in zip(of_thesis, same["rate_per_s"], same["recording"], same["source"], strict=True)
    ]
    return pd.DataFrame(
        {"source": sources, CURVATURE: same["curvature_per_m"], DOUBT: same["or_curvature_per_m"], column: same["rate_per_s"]}
    )


def _published(rates: pd.DataFrame | None, panel: str, window: str, model: bool, force: float | None = None) -> pd.DataFrame:
    """Published rates, or another model's, of pressed surfaces in a window, one series a recording."""
    if rates is None:
        return pd.DataFrame()
    rows = rates[(rates["species"] == "model") == model]
    rows = rows[(rows["window"] == window) & (rows["receptor"] == "SA-I") & ~rows["source"].str.startswith("Cysyk")]
    rows = rows[rows["stimulus"].isin(("sphere", "flat plate")) | model]
    spheres = rows.groupby("recording")["stimulus"].transform(lambda kinds: "sphere" in set(kinds))
    rows = rows[spheres.astype(bool) | model] if len(rows) else rows
    if force:
        rows = rows[rows["force_gf"] == force]
    kind = "other model (" if model else "measured ("
    return pd.DataFrame(
        {
            "source": kind + rows["source"] + ")",
            "panel": panel,
            "series": rows["recording"],
            CURVATURE: rows["curvature_per_m"],
            GIVEN_RATE: rows["rate_per_s"],
        }
    )


# --- drawing ---------------------------------------------------------------------------------------------


def _note(frame: pd.DataFrame, *lines: str, how: str = "") -> list[str]:
    """The usual lines under a picture and more, wrapped."""
    return [*style.footnote(frame, how), *(part for line in lines for part in textwrap.wrap(line, style.NOTE_WIDTH - 10))]


def _stamp(ax: Axes, text: str = "predicted", **place) -> None:
    """A word in the picture, so that it is not taken for a recording."""
    place = {"x": 0.985, "y": 0.03, "ha": "right", "va": "bottom"} | place
    ax.text(place.pop("x"), place.pop("y"), text, transform=ax.transAxes, fontsize=8, style="italic", color=style.GREY, **place)


def _limits(ax: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """Axes of the thesis's ranges, and of the data where they leave them; what the thesis shows is then shaded."""
    box = []
    for column, set_limits in ((x, ax.set_xlim), (y, ax.set_ylim)):
        ranges = rows.loc[~is_simulated(rows) & rows["source"].str.contains("axis range"), column].dropna()
        data = rows.loc[~rows["source"].str.contains("axis range"), column].dropna()
        low, high = (ranges.min(), ranges.max()) if len(ranges) else (min(0.0, data.min()), data.max())
        wide = min(low, data.min()), max(high, data.max(), low + 1e-9)
        margin = 0.05 * (wide[1] - wide[0])
        set_limits(low if wide[0] == low else wide[0] - margin, high if wide[1] == high and len(ranges) else wide[1] + margin)
        box.append((low, high, wide != (low, high) and len(ranges) > 0))
    if any(beyond for *_, beyond in box) and all(len(rows[column].dropna()) for column in (x, y)):
        (left, right, _), (bottom, top, _) = box
        ax.add_patch(Rectangle((left, bottom), right - left, top - bottom, color=style.BAND, lw=0, zorder=0))


def _points(ax: Axes, rows: pd.DataFrame, x: str, y: str, **look) -> None:
    """One point a surface, in the surfaces' colours."""
    look = {"marker": "o", "s": 30, "zorder": 3, "clip_on": False} | look
    colours = [style.COLOURS[label] for label in rows["surface"]]
    ax.scatter(rows[x], rows[y], color=colours, **look)


def _draw_given(ax: Axes, frame: pd.DataFrame, column: str = GIVEN_RATE) -> None:
    """What was recorded under the same protocol: a rate whose surface is one of two spans both."""
    if column not in frame:
        return
    rows = frame[frame["source"].str.contains(r"stated in the thesis|^measured")]
    rows = rows[rows["panel"].isna()] if "panel" in rows else rows
    printed = rows["source"].str.startswith("stated")
    for mine, look, label in (
        (rows[printed], {"marker": "s", "mfc": "none", "mec": style.INK}, "printed in the thesis (scan)"),
        (rows[~printed], {"marker": "D", "color": style.INK}, "recorded"),
    ):
        if mine.empty:
            continue
        other = mine[DOUBT].where(mine[DOUBT].notna(), mine[CURVATURE])
        ax.hlines(mine[column], mine[CURVATURE], other, color=style.INK, lw=0.8)
        ax.plot((mine[CURVATURE] + other) / 2, mine[column], ls="none", ms=5, zorder=4, label=label, **look)


def _source_text(rows: pd.DataFrame) -> str:
    """What follows the colon in the source of some simulated rows."""
    return rows["source"].iloc[0].partition(": ")[2].replace("R2", "R²")


# --- 4-2 to 4-5: what the thesis shows as recordings -----------------------------------------------------


def frame_4_2(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Predicted impulses of four trials a surface at 150 gf/s, the force, the mean predicted rate in the hold, printed ones."""
    numbers = _numbers(histories, coarse, "ramp150", {GIVEN_RATE: partial(rate_in, window="hold")})
    parts = [numbers.assign(panel="mean rate of the hold")]
    plate = histories[scene_name("ramp150", "flat")]
    parts.append(pd.DataFrame({"panel": "force", TIME: plate["time"].values, FORCE: force_gf(plate)}))
    for k, (label, history) in enumerate(pressed(histories, "ramp150").items()):
        impulses = raster(predicted_rate(history), TRIALS, SEED + k)
        named = [f"trial {n}" for n in impulses["trial"]]
        part = pd.DataFrame({"panel": "impulses", "surface": label, "series": named, IMPULSE: impulses[TIME]})
        parts.append(part.assign(**{ERROR: numbers.set_index("surface").loc[label, ERROR]}))
    marks = axis_rows(reference, FORCE, "T080")
    return assemble(pd.concat(parts, ignore_index=True), _given(rates, reference, "hold", 150), marks)


@style.styled
def fig_4_2(frame: pd.DataFrame) -> Figure:
    """Force above, nine times four predicted trains of impulses, mean rates of the hold at the right."""
    title = "Predicted impulses, 150 gf/s ramp to 20 gf, 2 s hold"
    note = _note(
        frame,
        f"{LAW_NOTE}, strain energy 915 µm under the centre; integrate-and-fire, coefficient of variation of the intervals "
        f"{VARIATION} (assumed), seed {SEED}. Right: mean predicted rate of the hold; grey: rates printed beside the recordings "
        "in Fig. 4-2 of Cysyk (1999), from a scan, where a rate between two rows may belong to either.",
        how="of the rate, relative to the largest",
    )
    fig = style.new_figure(frame, "4-2", title, 6.4, note=note)
    upper, ax = fig.subplots(2, 1, sharex=True, height_ratios=[1, 6.2])
    force = frame[frame[FORCE].notna() & is_simulated(frame)]
    upper.plot(force[TIME], force[FORCE], color=style.INK, clip_on=False)
    style.limit_axis(upper, frame, FORCE)
    upper.set(ylabel="force (gf)", yticks=[0, 20])
    place = {label: k for k, label in enumerate(SURFACES)}
    for (label, series), train in frame[frame[IMPULSE].notna()].groupby(["surface", "series"]):
        row = place[label] + (int(series.split()[1]) - 1) * 0.2 - 0.3
        ax.vlines(train[IMPULSE], row - 0.07, row + 0.07, color=style.COLOURS[label], lw=0.9)
    end = force[TIME].max()
    ax.set(xlim=(0, end), ylim=(8.6, -0.6), xlabel="time (s)", ylabel="curvature (1/m)", yticks=range(9))
    ax.set_yticklabels(["flat plate", *SURFACES[1:]])
    ax.tick_params(left=False)
    for k in range(8):
        ax.axhline(k + 0.5, color="0.9", lw=0.6, zorder=0)
    outside = ax.get_yaxis_transform()
    rows = frame[frame["panel"] == "mean rate of the hold"]
    for label, rate in zip(rows["surface"], rows[GIVEN_RATE], strict=True):
        ax.text(1.062, place[label], f"{rate:.1f}", transform=outside, ha="right", va="center", color=style.COLOURS[label])
    curvatures = rows.set_index("surface")[CURVATURE]
    for entry in frame[frame["source"].str.startswith(("stated", "measured"))].to_dict("records"):
        at = [float((curvatures - k).abs().argmin()) for k in (entry[CURVATURE], entry[DOUBT]) if k == k]
        ax.text(1.128, np.mean(at), f"{entry[GIVEN_RATE]:.1f}", transform=outside, ha="right", va="center", color=style.GREY)
    head = {"transform": outside, "va": "bottom", "ha": "right", "fontsize": 6.5}
    ax.text(1.066, -0.62, "predicted", color=style.INK, **head)
    ax.text(1.135, -0.62, "printed", color=style.GREY, **head)
    ax.text(1.135, 8.75, "impulses/s", color=style.INK, **head | {"va": "top"})
    upper.text(0.99, 0.5, "predicted, not recorded", transform=upper.transAxes, ha="right", va="center", style="italic",
               color=style.GREY)  # fmt: skip
    return fig


def frame_4_3(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Instantaneous frequency of predicted impulses at 40 gf/s, mean of many trials, and the rate they were made from."""
    errors = _numbers(histories, coarse, "ramp40", {IMPULSE_RATE: partial(rate_in, window="peak")}).set_index("surface")[ERROR]
    parts = []
    for k, (label, history) in enumerate(pressed(histories).items()):
        rate = predicted_rate(history)
        at = np.arange(0, 2.0001, 0.02)
        frequency = mean_frequency(raster(rate, AVERAGED, SEED + k), AVERAGED, at)
        parts += [
            frequency.assign(surface=label, series="frequency of impulses", **{ERROR: errors[label]}),
            rate[[TIME, IMPULSE_RATE]].assign(surface=label, series="rate", **{ERROR: errors[label]}),
        ]
    return assemble(
        pd.concat(parts, ignore_index=True),
        axis_rows(reference, TIME, "T091"),
        axis_rows(reference, FREQUENCY, "T090"),
    )


@style.styled
def fig_4_3(frame: pd.DataFrame) -> Figure:
    """Nine traces of predicted frequency, labelled at the right."""
    title = "Predicted instantaneous frequency, 40 gf/s ramp to 20 gf"
    note = _note(
        frame,
        f"{LAW_NOTE}, 915 µm under the centre. Thin: mean instantaneous frequency of {AVERAGED} trains of impulses "
        "(integrate-and-"
        f"fire, coefficient of variation {VARIATION}, assumed); wide: the rate they are made from.",
        how="of the peak rate, relative to the largest",
    )
    fig = style.new_figure(frame, "4-3", title, 4.9, note=note)
    ax = fig.subplots()
    both = frame.assign(**{FREQUENCY: frame[[FREQUENCY, IMPULSE_RATE]].max(axis=1)})
    both = both[(both[TIME] <= 2) | both[TIME].isna()]
    style.limit_axis(ax, both, FREQUENCY, text=False)
    ends = {}
    for label in SURFACES:
        rows = frame[frame["surface"] == label]
        rate, frequency = rows[rows["series"] == "rate"], rows[rows["series"] != "rate"]
        jump = int(np.flatnonzero(np.diff(rate[TIME]) == 0)[0]) + 1
        for leg in (rate[:jump], rate[jump:]):
            ax.plot(leg[TIME], leg[IMPULSE_RATE], color=style.COLOURS[label], lw=3.2, alpha=0.25)
        ax.plot(frequency[TIME], frequency[FREQUENCY], color=style.COLOURS[label], lw=1.0)
        ends[label] = (2.0, float(np.interp(2.0, rate[TIME], rate[IMPULSE_RATE])))
    ax.set(xlabel="time (s)", ylabel="instantaneous frequency (impulses/s)", xlim=(0, 2))
    style.label_ends(ax, ends, 2.12, "curvature (1/m)")
    _stamp(ax, "predicted, not recorded", y=0.97, va="top")
    return fig


def _peak_and_steady(
    histories: Histories, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None
) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    columns = {GIVEN_RATE: partial(rate_in, window="peak"), STEADY_RATE: partial(rate_in, window="steady")}
    given = [_given(rates, reference, "peak", 40), _given(rates, reference, "steady", 40, STEADY_RATE)]
    return _numbers(histories, coarse, "ramp40", columns), *given


def frame_4_4(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Predicted peak rate and rate in the last half of the hold, one row a surface, and the line through them."""
    rows, peak, steady = _peak_and_steady(histories, coarse, reference, rates)
    both = peak.merge(steady, on=["source", CURVATURE, DOUBT]) if len(peak) and len(steady) else pd.DataFrame()
    marks = axis_rows(reference, GIVEN_RATE, "T094"), axis_rows(reference, STEADY_RATE, "T095")
    return assemble(rows, _line(rows, GIVEN_RATE, STEADY_RATE), both, *marks)


@style.styled
def fig_4_4(frame: pd.DataFrame) -> Figure:
    """Steady against peak rate, nine points and a line."""
    note = _note(frame, f"{LAW_NOTE}, 915 µm under the centre. Steady: mean of the last half of the hold.", how=_HOW)
    fig = style.new_figure(frame, "4-4", "Predicted steady rate against peak rate, 40 gf/s ramp to 20 gf", 4.6, note=note)
    _draw_points_and_line(fig.subplots(), frame, GIVEN_RATE, STEADY_RATE)
    fig.axes[0].set(xlabel="peak rate (impulses/s)", ylabel="steady rate (impulses/s)")
    return fig


def _draw_points_and_line(ax: Axes, frame: pd.DataFrame, x: str, y: str) -> None:
    """Named points of nine surfaces, the line through them, and recordings if there are any."""
    _limits(ax, frame, x, y)
    line = frame[frame["source"].str.contains("line")]
    ax.plot(line[x], line[y], color=style.GREY, lw=1, label=_source_text(line))
    points = frame[frame["source"] == SIMULATED]
    _points(ax, points, x, y)
    _name_points(ax, points, x, y)
    mine = frame[frame["source"].str.startswith("measured")]
    if len(mine):
        ax.plot(mine[x], mine[y], "D", color=style.INK, ms=4.5, label="recorded")
    ax.legend(loc="upper left")
    _stamp(ax)


def _name_points(ax: Axes, rows: pd.DataFrame, x: str, y: str) -> None:
    """Curvatures beside points; those at the same place share a label."""
    rows = rows.sort_values([x, y])
    place = rows[[x, y]].to_numpy() / np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())])
    groups = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(place, axis=0).T) > 0.03)])
    for _, group in rows.groupby(groups):
        names = ["flat" if label == "flat" else label for label in group["surface"]]
        at = group[[x, y]].mean()
        across, up = ax.transLimits.transform(at)
        left = up < 0.06 or across > 0.9  # at the floor and the right end labels are above to the left
        how = {"va": "bottom" if left else "top", "ha": "right" if left else "left"}
        away = (-5, 4) if left else (5, -4)
        ax.annotate(", ".join(names), at, away, textcoords="offset points", fontsize=7, color=style.GREY, **how)


def frame_4_5(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Predicted peak and steady rate against curvature, with the line through each; Goodwin's rates apart."""
    rows, peak, steady = _peak_and_steady(histories, coarse, reference, rates)
    lines = [_line(rows, CURVATURE, column) for column in (GIVEN_RATE, STEADY_RATE)]
    marks = axis_rows(reference, GIVEN_RATE, "T096"), axis_rows(reference, CURVATURE, "T162")
    return assemble(rows, *lines, peak, steady, *marks)


@style.styled
def fig_4_5(frame: pd.DataFrame) -> Figure:
    """Peak (triangles) and steady rate (crosses) against curvature, dotted, with their lines."""
    note = _note(frame, f"{LAW_NOTE}, 915 µm under the centre. Steady: mean of the last half of the hold.", how=_HOW)
    fig = style.new_figure(frame, "4-5", "Predicted peak and steady rates against curvature", 4.6, note=note)
    ax = fig.subplots()
    _limits(ax, frame, CURVATURE, GIVEN_RATE)
    points = frame[frame["source"] == SIMULATED]
    for column, marker, name in ((GIVEN_RATE, "^", "peak"), (STEADY_RATE, "P", "steady")):
        ax.plot(points[CURVATURE], points[column], ":", color=style.GREY, lw=0.9)
        _points(ax, points, CURVATURE, column, marker=marker, s=38)
        line = frame[frame["source"].str.contains("line") & frame[column].notna()]
        (drawn,) = ax.plot(line[CURVATURE], line[column], color=style.INK, lw=1)
        _draw_given(ax, frame[frame[column].notna()], column)
        ends = line.iloc[-1]
        ax.annotate(f"{name}: {_source_text(line)}", (ends[CURVATURE], ends[column]), (0, 5), textcoords="offset points",
                    ha="right", fontsize=7, color=drawn.get_color())  # fmt: skip
    ax.set(xlabel="surface curvature (1/m)", ylabel="impulse rate (impulses/s)")
    kinds = ("^", "peak rate"), ("P", "steady rate")
    handles = [Line2D([], [], ls="none", marker=marker, color=style.INK, label=name) for marker, name in kinds]
    ax.legend(handles=handles + ax.get_legend_handles_labels()[0][:1], loc="upper left")
    _stamp(ax)
    return fig


# --- 4-9 -------------------------------------------------------------------------------------------------


def frame_4_9(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Predicted rate and inverse contact width in the hold, one row an output and surface."""
    errors = _numbers(histories, coarse, "ramp40", {IMPULSE_RATE: partial(rate_in, window="hold")}).set_index("surface")[ERROR]
    parts = []
    for label, history in pressed(histories).items():
        held = slice(ramp_end(history), None)
        rate = THESIS_RATE.terms(energy(history, RECEPTOR_DEPTH), 0.0)[0]
        part = {"surface": label, TIME: history["time"].values[held], INVERSE_WIDTH: 1e-3 / width(history)[held]}
        parts.append(pd.DataFrame(part | {IMPULSE_RATE: rate[held], ERROR: errors[label]}))
    marks = axis_rows(reference, INVERSE_WIDTH, INVERSE_WIDTHS), axis_rows(reference, IMPULSE_RATE, HELD_RATES)
    return assemble(pd.concat(parts, ignore_index=True), *marks)


@style.styled
def fig_4_9(frame: pd.DataFrame) -> Figure:
    """Nine panels; time runs from right to left, as the contact grows."""
    note = _note(frame, f"{LAW_NOTE}, 915 µm under the centre. Time runs leftwards: the contact grows.", how=_HOW)
    title = "Predicted rate against the inverse of the contact width in the hold"
    fig = style.new_figure(frame, "4-9", title, 7.0, note=note)
    axes = style.nine_panels(fig, SURFACES, "1 / contact width (1/mm)", "predicted rate (impulses/s)")
    for label, ax in axes.items():
        rows = rows_of(frame, "surface", label)
        _limits(ax, rows, INVERSE_WIDTH, IMPULSE_RATE)
        own = rows[is_simulated(rows)]
        ax.plot(own[INVERSE_WIDTH], own[IMPULSE_RATE], "o-", ms=3, lw=0.8, color=style.COLOURS[label])
        ax.set_title(style.surface_name(label))
        ax.locator_params(axis="x", nbins=4)
        if own[IMPULSE_RATE].max() == 0:
            ax.text(0.5, 0.2, "below the threshold:\nno impulses predicted", transform=ax.transAxes, ha="center", va="center",
                    fontsize=7, color=style.GREY)  # fmt: skip
    return fig


# --- 4-17, 4-22: laws ------------------------------------------------------------------------------------


def frame_4_17(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Pressure of twelve nodes as simulated, and by Eq 4-1 from each node's peak on: one set of constants, and a set for each."""
    name = scene_name("ramp40", NODE_SURFACE)
    history = histories[name]
    shown = surface_nodes(history)[:NODE_COUNT]
    nodes = contact_nodes(history, NODE_COUNT)
    together = fit_nodes("4-1", nodes)
    parts = []
    for node in shown:
        x = history["skin_x"].values[node] * 1e3
        part = pd.DataFrame({TIME: history["time"].values, P: history[PRESSURE].values[:, node]})
        parts.append(part.assign(series="simulated", **{NODE: round(x, 5)}))
        own = nodes[np.isclose(nodes[NODE], x)]
        if own["past_peak"].sum() < 4:
            continue
        for series, constants in (("one set", together), ("a set for each", fit_nodes("4-1", own))):
            law = pressure_by_law("4-1", own, constants)[[TIME, P_LAW]]
            parts.append(law.assign(series=f"Eq 4-1, {series}", **{NODE: round(x, 5)}))
    rows = pd.concat(parts, ignore_index=True)
    rows[ERROR] = error_percent(history, coarse.get(name), *at_ends(centre_pressure))
    return assemble(rows, axis_rows(reference, TIME, "T155"), axis_rows(reference, P, "T154"))


@style.styled
def fig_4_17(frame: pd.DataFrame) -> Figure:
    """Twelve panels: dotted simulated, solid and dashed by Eq 4-1."""
    title = "Pressure at twelve nodes and its decay by Eq. 4-1, K = 210 1/m"
    note = _note(
        frame,
        "Eq. 4-1, p = A1 / (distance to the contact's edge) + A2 (displacement below the edge's) + A3, from the peak of a "
        "node on; "
        "constants by least squares. Nodes count from one spacing inside the edge on.",
    )
    fig = style.new_figure(frame, "4-17", title, 6.9, note=note, header=0.2)
    axes = fig.subplots(4, 3, sharex=True, sharey=True)
    colour = style.COLOURS[NODE_SURFACE]
    looks = {
        "simulated": (P, {"ls": (0, (1, 1.2)), "lw": 1.8, "color": colour}),
        "Eq 4-1, one set": (P_LAW, {"ls": "-", "lw": 1.1, "color": style.INK}),
        "Eq 4-1, a set for each": (P_LAW, {"ls": (0, (4, 1.5)), "lw": 0.9, "color": style.GREY}),
    }
    wide = frame.assign(**{P: frame[P].fillna(frame[P_LAW])})
    nodes = frame[is_simulated(frame)].groupby(NODE)
    for ax in axes.ravel()[len(nodes) :]:  # a coarse mesh has fewer nodes in contact
        ax.set_visible(False)
    for k, (ax, (x, rows)) in enumerate(zip(axes.ravel(), nodes, strict=False)):
        for series, (column, look) in looks.items():
            own = rows[rows["series"] == series]
            ax.plot(own[TIME], own[column], **look)
        ax.set_title(f"x = {x:.3g} mm")
        style.limit_axis(ax, wide, P, text=k == 5)
        ax.set(xlim=(0, 2.5), xticks=[0, 1, 2])
    axes[3, 1].set_xlabel("time (s)")
    axes[2, 0].set_ylabel("contact pressure (Pa)", y=1.15)
    names = {"Eq 4-1, one set": "Eq. 4-1, one set of constants", "Eq 4-1, a set for each": "a set for each node"}
    style.header_legend(fig, [Line2D([], [], label=names.get(name, name), **look) for name, (_, look) in looks.items()])
    return fig


def frame_4_22(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy at 915 um as simulated and by Eq 4-4 from the contact pressure, one set of constants for nine surfaces."""
    surfaces = pressed(histories)
    law = fit_sum(surfaces.values(), RECEPTOR_DEPTH)
    shown = partial(energy, depth=RECEPTOR_DEPTH)
    parts = [
        energy_from_pressure(history, RECEPTOR_DEPTH, law).assign(
            surface=label,
            source=f"{SIMULATED}: Eq 4-4 with r {law.r * 1e3:.3g} mm, A1 {law.per_depth:.3g} 1/m2, A2 {law.constant:.3g} 1/m",
            **{ERROR: error_percent(history, coarse.get(scene_name("ramp40", label)), *at_ends(shown))},
        )
        for label, history in surfaces.items()
    ]
    return assemble(pd.concat(parts, ignore_index=True), axis_rows(reference, SED, ENERGIES))


@style.styled
def fig_4_22(frame: pd.DataFrame) -> Figure:
    """Nine panels: points simulated, line by Eq 4-4."""
    title = "Strain energy density at 915 µm, and from contact pressure by Eq. 4-4"
    constants = _source_text(frame[is_simulated(frame)]).removeprefix("Eq 4-4 with ").replace("m2", "m²")
    note = _note(frame, f"Points simulated; lines by Eq. 4-4 with one set of constants for all nine surfaces: {constants}.")
    fig = style.new_figure(frame, "4-22", title, 6.8, note=note)
    axes = style.nine_panels(fig, SURFACES, "time (s)", "strain energy density (Pa)")
    for label, ax in axes.items():
        rows = rows_of(frame, "surface", label)
        both = rows.assign(**{SED: rows[[SED, SED_LAW]].max(axis=1)})
        style.limit_axis(ax, both, SED)
        own = rows[is_simulated(rows)]
        ax.plot(own[TIME], own[SED], "o", ms=2.4, mfc="none", mew=0.7, color=style.COLOURS[label])
        ax.plot(own[TIME], own[SED_LAW], color=style.INK, lw=1)
        left = np.sqrt(np.mean((own[SED] - own[SED_LAW]) ** 2) / np.mean(own[SED] ** 2))
        ax.text(0.97, 0.06, f"r.m.s. residual {left:.0%}", transform=ax.transAxes, ha="right", fontsize=7, color=style.GREY)
        ax.set(title=style.surface_name(label), xlim=(0, 2.5), xticks=[0, 1, 2])
    return fig


# --- 4-18, 4-19: pressure as a predictor -----------------------------------------------------------------


def frame_4_18(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Predicted peak rate and largest pressure at any node, one row a surface, and the line through them; recorded peak rates."""
    columns = {P_PEAK: lambda d: float(peak_pressure(d).max()), GIVEN_RATE: partial(rate_in, window="peak")}
    rows = _numbers(histories, coarse, "ramp40", columns)
    given = _given(rates, reference, "peak", 40)
    if len(given):
        given[P_PEAK] = np.interp(given[CURVATURE], rows[CURVATURE], rows[P_PEAK])
    marks = axis_rows(reference, P_PEAK, "T159"), axis_rows(reference, GIVEN_RATE, "T160")
    return assemble(rows, _line(rows, P_PEAK, GIVEN_RATE), given, *marks)


@style.styled
def fig_4_18(frame: pd.DataFrame) -> Figure:
    """Peak rate against peak pressure, nine points and a line."""
    note = _note(frame, f"{LAW_NOTE}, 915 µm under the centre.", how=_HOW)
    fig = style.new_figure(frame, "4-18", "Predicted peak rate against peak contact pressure", 4.6, note=note)
    _draw_points_and_line(fig.subplots(), frame, P_PEAK, GIVEN_RATE)
    fig.axes[0].set(xlabel="peak contact pressure (Pa)", ylabel="peak rate (impulses/s)")
    return fig


def frame_4_19(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Rates as linear functions of the mean centre pressure: closest to Eq 5-1's in the hold, and to Goodwin's first second."""
    columns = {
        GIVEN_RATE: partial(rate_in, window="hold"),
        MEAN_P: mean_pressure,
        "first_second_pressure (Pa)": partial(mean_pressure, window="first second"),
    }
    rows = _numbers(histories, coarse, "ramp40", columns)
    early = rows.pop("first_second_pressure (Pa)")
    law = gain_and_threshold(rows[MEAN_P].to_numpy(), rows[GIVEN_RATE].to_numpy())
    share = r_squared(rows[GIVEN_RATE].to_numpy(), law(rows[MEAN_P]))
    by = rows.assign(source=f"{SIMULATED}: linear in the pressure, R2 {share:.3f}", **{GIVEN_RATE: law(rows[MEAN_P])})
    parts = [rows.assign(source=f"{SIMULATED}: Eq 5-1"), by]
    published = _published(rates, "published", "first second", model=False, force=20)
    if len(published):
        pressure = np.interp(published[CURVATURE], rows[CURVATURE], early)
        law = gain_and_threshold(pressure, published[GIVEN_RATE].to_numpy())
        share = r_squared(published[GIVEN_RATE].to_numpy(), law(pressure))
        source = f"{SIMULATED}: linear in the pressure, R2 {share:.3f}"
        inside = rows[CURVATURE] <= 1.01 * published[CURVATURE].max()
        fitted = {"source": source, "panel": "published", CURVATURE: rows[CURVATURE], MEAN_P: early, GIVEN_RATE: law(early)}
        parts.append(pd.DataFrame(fitted)[inside].assign(surface=rows["surface"], **{ERROR: rows[ERROR]}))
    marks = axis_rows(reference, GIVEN_RATE, "T161"), axis_rows(reference, CURVATURE, "T162")
    return assemble(pd.concat(parts, ignore_index=True), published, _given(rates, reference, "hold", 40), *marks)


@style.styled
def fig_4_19(frame: pd.DataFrame) -> Figure:
    """Left: rates by Eq 5-1 and by the pressure; right: Goodwin's rates and by the pressure."""
    note = _note(
        frame,
        f"{LAW_NOTE}, 915 µm under the centre. Left: mean over the hold, as in the thesis, whose recorded rates are not public. "
        "Right: Goodwin, Browning and Wheat (1995), digitised by a third party, impulses in the first second at 20 gf; gain and "
        "threshold of the line fitted to them.",
        how=_HOW,
    )
    title = "Mean rate from mean contact pressure, against curvature"
    fig = style.new_figure(frame, "4-19", title, 4.3, note=note)
    ax, beside = fig.subplots(1, 2, width_ratios=[1.55, 1])
    main, other = frame[frame["panel"].isna()] if "panel" in frame else frame, frame[_panel(frame, "published")]
    _limits(ax, main, CURVATURE, GIVEN_RATE)
    law = main[main["source"].str.contains("linear")]
    ax.plot(law[CURVATURE], law[GIVEN_RATE], color=style.INK, lw=1.1, label=_source_text(law))
    points = main[main["source"].str.contains("Eq 5-1")]
    ax.plot([], [], "o", color=style.GREY, label="Eq. 5-1, predicted from strain energy")
    _points(ax, points, CURVATURE, GIVEN_RATE)
    _draw_given(ax, main)
    ax.set(xlabel="curvature (1/m)", ylabel="mean rate of the hold (impulses/s)")
    ax.legend(loc="upper left")
    _stamp(ax)
    _beside(beside, other, "Goodwin 1995, first second")
    return fig


def _panel(frame: pd.DataFrame, name: str) -> pd.Series:
    return frame["panel"] == name if "panel" in frame else pd.Series(False, index=frame.index)


def _beside(ax: Axes, rows: pd.DataFrame, title: str, mismatch: str = PUBLISHED) -> None:
    """A panel of rates measured elsewhere or of another model (points), with ours (lines)."""
    ax.set_title(f"{title}\n{mismatch}", fontsize=7.5)
    if rows.empty:
        ax.text(0.5, 0.5, "no rates given", transform=ax.transAxes, ha="center", color=style.GREY)
        return
    own = is_simulated(rows)
    for k, (name, curve) in enumerate(rows[~own].groupby("series", sort=False)):
        look = dict(marker="os^D"[k % 4], color=CONTEXT[k % 3], ms=4.5)
        ax.plot(curve[CURVATURE], curve[GIVEN_RATE], ls="none", label=name, **look)
    keys = "series" if "series" in rows and rows.loc[own, "series"].notna().any() else "source"
    for name, curve in rows[own].groupby(keys, sort=False):
        same = [i for i, s in enumerate(rows.loc[~own, "series"].unique()) if name.split()[-2:] == s.split()[-2:]]
        colour = CONTEXT[same[0]] if same else style.INK
        label = _source_text(curve) if keys == "source" else name
        curve = curve.sort_values(CURVATURE)
        ax.plot(curve[CURVATURE], curve[GIVEN_RATE], color=colour, lw=1.1, label=label)
    top = rows[GIVEN_RATE].max()
    ax.set(xlim=(0, 1.04 * rows[CURVATURE].max()), ylim=(0, 1.5 * top), xlabel="curvature (1/m)")
    ax.legend(loc="upper left", fontsize=7, handlelength=1.6, borderaxespad=0.2, labelspacing=0.3)


# --- 4-25 to 4-27, 4-29: strain energy as a predictor ----------------------------------------------------

_HOW = "of what is plotted, relative to the largest"


def frame_4_25(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Mean predicted rate of the hold at 150 gf/s, and the rates printed in Fig 4-2."""
    rows = _numbers(histories, coarse, "ramp150", {GIVEN_RATE: partial(rate_in, window="hold")})
    marks = axis_rows(reference, GIVEN_RATE, "T201"), axis_rows(reference, CURVATURE, "T202")
    return assemble(rows, _given(rates, reference, "hold", 150), *marks)


@style.styled
def fig_4_25(frame: pd.DataFrame) -> Figure:
    """Predicted rates (line and points) and the printed ones (squares, over both curvatures they may belong to)."""
    note = _note(
        frame,
        f"{LAW_NOTE}, 915 µm under the centre; nothing is fitted here. Squares: mean rates printed beside Fig. 4-2 of Cysyk "
        "(1999), "
        "read from a scan (17.0 without its point); a bar joins the two surfaces that a rate may belong to.",
        how=_HOW,
    )
    title = "Predicted mean rate of the hold, 150 gf/s ramp to 20 gf"
    fig = style.new_figure(frame, "4-25", title, 4.6, note=note)
    ax = fig.subplots()
    _draw_rates(ax, frame)
    return fig


def _draw_rates(ax: Axes, frame: pd.DataFrame, ylabel: str = "mean rate of the hold (impulses/s)") -> None:
    """Predicted rates against curvature on the thesis's axes, with what was recorded under the same protocol."""
    _limits(ax, frame, CURVATURE, GIVEN_RATE)
    points = frame[is_simulated(frame) & frame["surface"].notna()]
    ax.plot(points[CURVATURE], points[GIVEN_RATE], color=style.GREY, lw=0.9, zorder=1)
    ax.plot([], [], "o-", color=style.GREY, lw=0.9, label="predicted by Eq. 5-1")
    _points(ax, points, CURVATURE, GIVEN_RATE)
    _draw_given(ax, frame)
    ax.set(xlabel="curvature (1/m)", ylabel=ylabel)
    ax.legend(loc="upper left")
    _stamp(ax, "points: predicted")


def _mean_rates(
    histories: Histories,
    coarse: Histories,
    reference: pd.DataFrame,
    rates: pd.DataFrame | None,
    depth: float,
    axes: tuple[str, str],
) -> pd.DataFrame:
    """Mean predicted rates of the hold at a depth; beside them published rates and TouchSim's, and ours in their windows."""
    law, text = THESIS_RATE, "Eq 5-1 at 915 um"
    if depth != RECEPTOR_DEPTH:
        law, factor = shallow_law(pressed(histories))
        text = f"Eq 5-1 at {depth * 1e6:.0f} um, energies times {factor:.3f}"
    source = f"{SIMULATED}: {text}"
    number = partial(rate_in, depth=depth, law=law)
    columns = {GIVEN_RATE: partial(number, window="hold")}
    parts = [_numbers(histories, coarse, "ramp40", columns)]
    for programme, force in (("press10", 10), ("press15", 15), ("ramp40", 20)):
        early = _numbers(histories, coarse, programme, {GIVEN_RATE: partial(number, window="first second")})
        parts.append(early.assign(panel="published", series=f"predicted, {force} gf"))
    steady = _numbers(histories, coarse, "ramp40", {GIVEN_RATE: partial(number, window="steady")})
    parts.append(steady.assign(panel="TouchSim", series="predicted, cylinders"))
    rows = pd.concat(parts, ignore_index=True)
    rows = rows[rows["panel"].isna() | (rows[CURVATURE] < 700)].assign(source=source)
    beside = _published(rates, "published", "first second", False), _published(rates, "TouchSim", "steady", True)
    marks = axis_rows(reference, GIVEN_RATE, axes[0]), axis_rows(reference, CURVATURE, axes[1])
    return assemble(rows, *beside, _given(rates, reference, "hold", 40), *marks)


def frame_4_26(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Mean predicted rates from 915 um at 40 gf/s; published rates and TouchSim's."""
    return _mean_rates(histories, coarse, reference, rates, RECEPTOR_DEPTH, ("T203", "T202"))


def frame_4_27(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """The same from 600 um."""
    return _mean_rates(histories, coarse, reference, rates, SHALLOW_DEPTH, ("T204", "T202"))


def _draw_mean_rates(frame: pd.DataFrame, number: str, depth: str) -> Figure:
    scaled = _source_text(frame[is_simulated(frame)]).partition(", energies ")[2]
    more = f" The thesis prints no constants for {depth}: energies {scaled}, the same mean as at 915 µm." if scaled else ""
    note = _note(
        frame,
        f"{LAW_NOTE}, {depth} under the centre.{more} Left: mean over the hold; the recorded rates are not public. Middle: "
        "Goodwin, "
        "Browning and Wheat (1995), digitised by a third party, impulses in the first second (force rate not stated). Right: "
        "TouchSim (Saal et al. 2017), a half-space, the last second of its hold.",
        how=_HOW,
    )
    title = f"Predicted mean rate of the hold from strain energy at {depth}, 40 gf/s"
    fig = style.new_figure(frame, number, title, 4.4, note=note)
    ax, published, model = fig.subplots(1, 3, width_ratios=[1.7, 1, 1])
    _draw_rates(ax, frame[frame["panel"].isna()])
    _beside(published, frame[_panel(frame, "published")], "Goodwin 1995, first second")
    _beside(model, frame[_panel(frame, "TouchSim")], "TouchSim, steady", "half-space; ours: layered pad")
    return fig


@style.styled
def fig_4_26(frame: pd.DataFrame) -> Figure:
    """Predicted rates from 915 um, beside published and another model's."""
    return _draw_mean_rates(frame, "4-26", "915 µm")


@style.styled
def fig_4_27(frame: pd.DataFrame) -> Figure:
    """The same from 600 um."""
    return _draw_mean_rates(frame, "4-27", "600 µm")


def frame_4_29(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, rates: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Predicted peak rates at two depths, the line in the peak rate of strain energy closest to each; TouchSim's first 200 ms."""
    parts = []
    for depth in (SHALLOW_DEPTH, RECEPTOR_DEPTH):
        law, factor = shallow_law(pressed(histories)) if depth == SHALLOW_DEPTH else (THESIS_RATE, 1.0)
        panel = f"{depth * 1e6:.0f} um"
        peak, slope_of = partial(rate_in, window="peak", depth=depth, law=law), partial(peak_energy_rate, depth=depth)
        columns = {GIVEN_RATE: peak, RATE: slope_of}
        rows = _numbers(histories, coarse, "ramp40", columns).assign(panel=panel)
        slope, offset, share = straight_line(rows[RATE], rows[GIVEN_RATE])
        parts.append(rows.assign(source=f"{SIMULATED}: Eq 5-1, energies times {factor:.3f}"))
        by = {GIVEN_RATE: rectified(slope * rows[RATE] + offset), ERROR: rows[ERROR]}
        parts.append(rows.assign(source=f"{SIMULATED}: linear in the peak energy rate, R2 {share:.3f}", **by))
    early = _numbers(histories, coarse, "ramp150", {GIVEN_RATE: partial(rate_in, window="first 200 ms")})
    early = early[early[CURVATURE] < 700].assign(panel="TouchSim", series="predicted, cylinders", source=f"{SIMULATED}: Eq 5-1")
    parts.append(early)
    given = [_given(rates, reference, "peak", 40).assign(panel=panel) for panel in ("600 um", "915 um")]
    given = [rows for rows in given if len(rows)]
    marks = [axis_rows(reference, GIVEN_RATE, "T207"), axis_rows(reference, CURVATURE, "T208")]
    return assemble(pd.concat(parts, ignore_index=True), _published(rates, "TouchSim", "first 200 ms", True), *given, *marks)


@style.styled
def fig_4_29(frame: pd.DataFrame) -> Figure:
    """(a) 600 um, (b) 915 um, and TouchSim's early rates."""
    scale = _source_text(frame[frame["source"].str.contains("energies")]).partition("times ")[2]
    note = _note(
        frame,
        f"{LAW_NOTE}. Points: both terms; line: the linear function of the peak rate of strain energy closest to them, as "
        "the thesis "
        f"predicts the recorded peaks, which are not public. (a) energies times {scale}: the thesis prints no constants for "
        "600 µm. "
        "Right: TouchSim (Saal et al. 2017), a half-space, mean of the first 200 ms, ramp of 100 ms; ours at 150 gf/s (133 ms), "
        "915 µm.",
        how=_HOW,
    )
    title = "Predicted peak rate, and from the peak rate of strain energy, against curvature"
    fig = style.new_figure(frame, "4-29", title, 4.4, note=note)
    axes = fig.subplots(1, 3, width_ratios=[1.25, 1.25, 1])
    for ax, tag, panel in zip(axes, "ab", ("600 um", "915 um"), strict=False):
        rows = frame[_panel(frame, panel) | frame["source"].str.contains("axis range")]
        _limits(ax, rows, CURVATURE, GIVEN_RATE)
        line = rows[rows["source"].str.contains("linear")]
        ax.plot(
            line[CURVATURE],
            line[GIVEN_RATE],
            color=style.INK,
            lw=1.1,
            label=_source_text(line).replace("peak energy", "peak\nenergy"),
        )
        ax.plot([], [], "o", color=style.GREY, label="predicted by Eq. 5-1")
        _points(ax, rows[rows["source"].str.contains("Eq 5-1")], CURVATURE, GIVEN_RATE)
        _draw_given(ax, rows.drop(columns="panel"))
        ax.set(xlabel="curvature (1/m)", title=f"({tag}) {panel.replace('um', 'µm')}")
        ax.legend(loc="lower right", fontsize=7, handlelength=1.4)
    axes[0].set_ylabel("peak rate (impulses/s)")
    model = frame[_panel(frame, "TouchSim")]
    _beside(axes[2], model, "TouchSim, first 200 ms", "half-space; ours: layered pad")
    return fig


_NINE, _FAST = scenes("ramp40"), scenes("ramp150")
_LOWER = tuple(scene_name(programme, k) for programme in ("press10", "press15") for k in ("flat", "79", "158", "315", "630"))
_RATES = "impulse_rates"
FIGURES = (
    FigureSpec("4-2", "Predicted impulses, 150 gf/s", _FAST, frame_4_2, fig_4_2, None, _RATES),
    FigureSpec("4-3", "Predicted instantaneous frequency", _NINE, frame_4_3, fig_4_3),
    FigureSpec("4-4", "Predicted steady rate against peak rate", _NINE, frame_4_4, fig_4_4, None, _RATES),
    FigureSpec("4-5", "Predicted peak and steady rates against curvature", _NINE, frame_4_5, fig_4_5, None, _RATES),
    FigureSpec("4-9", "Predicted rate against inverse contact width in the hold", _NINE, frame_4_9, fig_4_9),
    FigureSpec("4-17", "Pressure decay at twelve nodes and Eq 4-1", scenes("ramp40", (NODE_SURFACE,)), frame_4_17, fig_4_17),
    FigureSpec("4-18", "Predicted peak rate against peak pressure", _NINE, frame_4_18, fig_4_18, None, _RATES),
    FigureSpec("4-19", "Mean rate from mean pressure", _NINE, frame_4_19, fig_4_19, None, _RATES),
    FigureSpec("4-22", "Strain energy from contact pressure by Eq 4-4", _NINE, frame_4_22, fig_4_22),
    FigureSpec("4-25", "Predicted mean rate, 150 gf/s", _FAST, frame_4_25, fig_4_25, None, _RATES),
    FigureSpec("4-26", "Predicted mean rate from 915 um", (*_NINE, *_LOWER), frame_4_26, fig_4_26, None, _RATES),
    FigureSpec("4-27", "Predicted mean rate from 600 um", (*_NINE, *_LOWER), frame_4_27, fig_4_27, None, _RATES),
    FigureSpec(
        "4-29",
        "Predicted peak rate from strain energy rate",
        (*_NINE, *_FAST),
        frame_4_29,
        fig_4_29,
        None,
        _RATES,
    ),
)

"""Chapter 5: what a slowly adapting receptor makes of strokes, predicted by Eqs 4-4 and 5-1 with the thesis's constants.

Where the thesis shows recordings, which are not public, these figures show predictions on the same axes and say so: rates by
Eq 5-1 from the simulated strain energy, and impulses of a seeded integrate-and-fire receptor at these rates. Frames and pictures
as in `chapter5`; what a user puts into ``config/reference/recordings`` is laid over the bursts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import partial

import matplotlib as mpl
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fingerpad.figures.chapter5 import (
    COLOURS,
    HOW,
    SHALLOW_DEPTH,
    SHOWN_DEPTH,
    below_surface,
    by_speed,
    stroke_rows,
    surface_rows,
)
from fingerpad.figures.spec import FigureSpec, assemble, axis_rows, rows_of
from fingerpad.measures.features import (
    ERROR,
    SIMULATED,
    Histories,
    Meshes,
    Trace,
    error_percent,
    is_simulated,
    scene_name,
    scenes,
)
from fingerpad.measures.quantities import CURVATURE, DISTANCE, RATE, RECEPTOR, SED, SPEED, TIME, TRIAL
from fingerpad.measures.responses import (
    ASIDE,
    BURST_RATE,
    BURST_TIME,
    BURST_WIDTH,
    FREQUENCY,
    IMPULSE_RATE,
    SEED,
    STATIC,
    STROKES_SHOWN,
    burst_values,
    bursts,
    curvature_of,
    impulses_of,
    mean_frequency,
    plate_rate,
    predicted_rate,
    ramp_and_hold_rates,
    raster,
    skin_sample,
    skin_shift,
    stroke_histogram,
    stroke_law,
)
from fingerpad.measures.runs import CYLINDERS, RIDGED, WITHIN_350
from fingerpad.measures.strokes import FULL, SPEEDS, distance, energy_at, label_errors, loaded, rms_error, time_of
from fingerpad.publishing import style

PREDICTED = f"{SIMULATED}: predicted by Eq 5-1"
PREDICTED_ENERGY = {
    "constant shift": f"{SIMULATED}: Eq 4-4 and a constant shift",
    "shift of the skin": f"{SIMULATED}: Eq 4-4 and the shift of the skin",
}
BY_EQUATION = (
    "Predicted, nothing recorded: Eq 5-1 with the thesis's constants and the simulated strain energy {} µm under the centre."
)
CURVES = ("26", "39", "52", "79", "105", "157", "210", "315")
CURVE_COLOURS = dict(zip(CURVES, mpl.colormaps["plasma"](np.linspace(0.0, 0.82, len(CURVES))), strict=True))
RASTER, HISTOGRAM = "raster", "histogram"


def _equation(depth: float = SHOWN_DEPTH) -> str:
    return BY_EQUATION.format(f"{depth * 1e6:.0f}")


def _of(column: str, depth: float = SHOWN_DEPTH) -> Trace:
    """Trace of a column of `predicted_rate` at the loaded outputs of a stroke."""
    return lambda stroke: predicted_rate(stroke, depth)[column].to_numpy()


def _rate_error(histories: Histories, coarse: Histories, name: str, depth: float = SHOWN_DEPTH) -> float:
    return rms_error(histories[name], coarse.get(name), _of(IMPULSE_RATE, depth))


# --- impulses: 5-1, 5-22, 5-23 -------------------------------------------------------------------------


def _raster_frame(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, *,
    number: str, low: float, high: float, axis: str, depth: float = SHOWN_DEPTH,
) -> pd.DataFrame:  # fmt: skip
    """Predicted impulses of repeated strokes at 10 mm/s over a part of the surface (mm), and their histogram."""
    name, repetitions = FULL["10"], STROKES_SHOWN[number]
    rate, impulses = impulses_of(histories[name], repetitions, depth)
    ticks = impulses.rename(columns={"trial": TRIAL})[[TRIAL, DISTANCE]].assign(panel=RASTER)
    bars = stroke_histogram(rate, impulses, repetitions).assign(panel=HISTOGRAM)
    rows = pd.concat([ticks, bars], ignore_index=True)
    rows = rows[rows[DISTANCE].between(low, high)].assign(source=PREDICTED, series="10 mm/s")
    rows[RECEPTOR], rows[ERROR] = depth * 1e6, _rate_error(histories, coarse, name, depth)
    shape = surface_rows(histories[name], low, high)
    return assemble(pd.concat([shape, rows], ignore_index=True), axis_rows(reference, DISTANCE, axis))


def _draw_raster(ax: Axes, frame: pd.DataFrame, number: str) -> None:
    """One row of ticks a stroke, the first one above."""
    rows = frame[(frame["panel"] == RASTER) & is_simulated(frame)]
    count = STROKES_SHOWN[number]
    trains = [rows.loc[rows[TRIAL] == trial, DISTANCE].to_numpy() for trial in range(1, count + 1)]
    ax.eventplot(trains, lineoffsets=range(1, count + 1), linelengths=0.7, linewidths=0.9, colors=[style.INK])
    ax.set(ylim=(count + 0.6, 0.4), yticks=[1, count] if count > 5 else range(1, count + 1), ylabel="predicted stroke")
    ax.tick_params(left=False)


@style.styled
def fig_5_1(frame: pd.DataFrame) -> Figure:
    """Ten predicted rasters and their histogram."""
    title = "Predicted impulses of ten strokes at 10 mm/s"
    remarks = [_equation(), "The recorded stroke ended before the convexity of 315 1/m; bins of 0.5 mm."]
    fig, (ticks, bars) = below_surface(frame, "5-1", title, 5.6, panels=2, remarks=remarks)
    _draw_raster(ticks, frame, "5-1")
    _draw_bars(bars, frame, DISTANCE, 0.5)
    style.limit_axis(bars, frame, DISTANCE, "x")
    bars.set(xlabel="distance (mm)", ylabel="predicted rate\n(impulses/s)")
    return fig


def _draw_bars(ax: Axes, frame: pd.DataFrame, x: str, width: float) -> None:
    rows = frame[frame["panel"] == HISTOGRAM]
    ax.bar(rows[x], rows[IMPULSE_RATE], width, color=style.INK, lw=0)


@style.styled
def fig_5_22(frame: pd.DataFrame) -> Figure:
    """Four predicted rasters of a shallow receptor."""
    title = "Predicted impulses of four strokes at 10 mm/s, receptor 560 µm deep"
    fig, (ticks,) = below_surface(frame, "5-22", title, 3.4, remarks=[_equation(SHALLOW_DEPTH)])
    _draw_raster(ticks, frame, "5-22")
    style.limit_axis(ticks, frame, DISTANCE, "x")
    ticks.set(xlabel="distance (mm)")
    return fig


def frame_5_23(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Instantaneous frequency of predicted impulses of a shallow receptor, mean of 12 strokes at every velocity."""
    parts, repetitions = [surface_rows(histories[FULL["10"]], 40, 80)], STROKES_SHOWN["5-23"]
    at = np.arange(40, 80.01, 0.1)
    for series, name in by_speed(FULL).items():
        rate, impulses = impulses_of(histories[name], repetitions, SHALLOW_DEPTH)
        frequency = mean_frequency(impulses, repetitions, np.interp(at, rate[DISTANCE], rate[TIME]))[FREQUENCY]
        error = _rate_error(histories, coarse, name, SHALLOW_DEPTH)
        row = {"source": PREDICTED, "panel": series, "series": series, DISTANCE: at, FREQUENCY: frequency}
        parts.append(pd.DataFrame(row | {RECEPTOR: SHALLOW_DEPTH * 1e6, ERROR: error}))
    ids = {f"{v} mm/s": "T304" if v in ("20", "40") else "T304a" for v in SPEEDS}
    return assemble(
        pd.concat(parts, ignore_index=True),
        axis_rows(reference, DISTANCE, "T300"),
        axis_rows(reference, FREQUENCY, ids, key="panel"),
    )


def _leave_room_for_brackets(fig: Figure) -> None:
    """Narrow the panels by what the brackets beside extended axes take, which the layout does not see."""
    engine = fig.get_layout_engine()
    x, y, width, height = engine.get()["rect"]
    engine.set(rect=(x, y, width - 0.02, height))


@style.styled
def fig_5_23(frame: pd.DataFrame) -> Figure:
    """A panel a velocity under the surface."""
    title = "Predicted instantaneous frequency of a receptor 560 µm deep, mean of 12 strokes"
    fig, axes = below_surface(frame, "5-23", title, 7.0, panels=len(SPEEDS), remarks=[_equation(SHALLOW_DEPTH)])
    _leave_room_for_brackets(fig)
    for speed, ax in zip(SPEEDS, axes, strict=True):
        rows = rows_of(frame, "panel", f"{speed} mm/s")
        own = rows[is_simulated(rows)]
        ax.plot(own[DISTANCE], own[FREQUENCY], color=COLOURS[speed], lw=1.1)
        style.limit_axis(ax, rows, FREQUENCY, text=False)
        ax.text(0.008, 0.97, f"v = {speed} mm/s", transform=ax.transAxes, va="top", fontsize=8)
    style.limit_axis(axes[-1], frame, DISTANCE, "x")
    axes[len(axes) // 2].set_ylabel("predicted frequency\n(impulses/s)")
    axes[-1].set_xlabel("distance (mm)")
    return fig


# --- 5-27 ----------------------------------------------------------------------------------------------

WAYS = {"right": "(a) plate stroked to the right", "left": "(b) plate stroked to the left"}


def frame_5_27(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Predicted impulses of ten strokes of a plate over a pad with inner ridges, each way."""
    parts, right = [], RIDGED["right"]
    for way, name in RIDGED.scenes.items():
        rate = plate_rate(histories[name])
        ticks = raster(rate, STROKES_SHOWN["5-27"], SEED).rename(columns={"trial": TRIAL})[[TRIAL, DISTANCE]]
        # the two ways are mirror images: one companion, read on either side, serves both
        side = partial(_plate_trace, offset=ASIDE if way == "right" else -ASIDE)
        error = rms_error(histories[right], coarse.get(right), side)
        for panel, rows in ((RASTER, ticks), ("rate", rate[[DISTANCE, IMPULSE_RATE]])):
            parts.append(
                rows.assign(source=PREDICTED, series=way, panel=panel, **{RECEPTOR: round(SHOWN_DEPTH * 1e6), ERROR: error})
            )
    return assemble(pd.concat(parts, ignore_index=True))


def _plate_trace(stroke: xr.Dataset, offset: float) -> np.ndarray:
    """Predicted rate at every output, after a kink between legs where there is one."""
    return predicted_rate(stroke, SHOWN_DEPTH, offset=offset).drop_duplicates(TIME, keep="last")[IMPULSE_RATE].to_numpy()


@style.styled
def fig_5_27(frame: pd.DataFrame) -> Figure:
    """Ten predicted rasters each way, and their rate below."""
    title = "Predicted impulses of a flat plate stroked both ways at 10 mm/s, inner ridges"
    where = "The receptor lies 46 µm to the right of the centre, under the flank of a ridge."
    most = frame.groupby("series").size().idxmax()  # an error relative to next to no response tells nothing
    how = f"to the {most}, {HOW}"
    note = [*style.footnote(frame[frame["series"] == most], how), _equation().replace("under the centre", "deep"), where]
    fig = style.new_figure(frame, "5-27", title, 4.6, note=note)
    (*ticks,), (*rates,) = fig.subplots(2, 2, sharex=True, sharey="row", height_ratios=[1.6, 1])
    for way, top, below in zip(WAYS, ticks, rates, strict=True):
        rows = frame[frame["series"] == way]
        _draw_raster(top, rows, "5-27")
        rate = rows[rows["panel"] == "rate"]
        below.plot(rate[DISTANCE], rate[IMPULSE_RATE], color=style.INK, lw=1.2)
        if not (rows["panel"] == RASTER).any():
            top.text(0.5, 0.5, "no impulse predicted", transform=top.transAxes, ha="center", color=style.GREY)
        top.set_title(WAYS[way])
        below.set(xlabel="stroke distance (mm)", xlim=(0, 50))
    rates[0].set_ylim(0, None)
    ticks[1].set_ylabel("")
    rates[0].set_ylabel("predicted rate\n(impulses/s)")
    return fig


# --- bursts: 5-2, 5-3, 5-16, 5-17 ----------------------------------------------------------------------


def _burst_frame(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, recorded: pd.DataFrame | None = None, *,
    speeds: Sequence[str], columns: Sequence[str], ids: Iterable[tuple],
) -> pd.DataFrame:  # fmt: skip
    """Burst of each convexity at some velocities, and recorded ones; `ids` are arguments of `axis_rows`."""
    parts = []
    for speed in speeds:
        name, series = FULL[speed], f"{speed} mm/s"
        found = bursts(loaded(histories[name]))
        errors = [
            list(label_errors(histories[name], coarse.get(name), partial(burst_values, column=c)).values()) for c in columns
        ]
        with np.errstate(all="ignore"):
            error = np.fmax.reduce(np.array(errors, float))
        part = {"source": PREDICTED, "series": series, "panel": series, SPEED: float(speed), "convexity": found["convexity"]}
        parts.append(pd.DataFrame(part | {c: found[c] for c in (CURVATURE, *columns)} | {ERROR: error}))
    parts += [_recorded(recorded, speeds, columns)]
    return assemble(
        pd.concat([part for part in parts if len(part)], ignore_index=True),
        *(axis_rows(reference, column, id_, key="panel") for column, id_ in ids),
    )


def _recorded(rates: pd.DataFrame | None, speeds: Sequence[str], columns: Sequence[str]) -> pd.DataFrame:
    """Rows of recorded bursts of a slowly adapting receptor at some velocities: a user's, for none is public."""
    if rates is None:
        return pd.DataFrame()
    rows = rates[(rates["window"] == "burst") & (rates["receptor"] == "SA-I") & rates["speed_mm_per_s"].isin(map(float, speeds))]
    names = [f"{speed:g} mm/s" for speed in rows["speed_mm_per_s"]]
    found = {
        BURST_RATE: rows["rate_per_s"],
        BURST_WIDTH: rows["burst_width_mm"],
        BURST_TIME: rows["burst_width_mm"] / rows["speed_mm_per_s"],
    }
    part = {"source": "measured (" + rows["recording"] + ")", "series": names, "panel": names, SPEED: rows["speed_mm_per_s"]}
    return pd.DataFrame(part | {CURVATURE: rows["curvature_per_m"]} | {c: found[c] for c in columns})


def _is_recorded(frame: pd.DataFrame) -> pd.Series:
    return frame["source"].str.startswith("measured")


def _draw_bursts(ax: Axes, rows: pd.DataFrame, column: str, **look) -> None:
    """Predicted bursts as a line, recorded ones as crosses."""
    own, recorded = rows[rows["source"] == PREDICTED], rows[_is_recorded(rows)]
    ax.plot(own[CURVATURE], own[column], marker="o", ms=3.5, label="predicted", **{"color": style.INK} | look)
    if len(recorded):
        ax.plot(recorded[CURVATURE], recorded[column], "x", color=style.COLOURS["315"], label="recorded")


_BURST = "A burst is the time during which the strain energy is above 150 Pa; its rate is the mean predicted rate over that time."
frame_5_2 = partial(
    _burst_frame,
    speeds=("10",),
    columns=(BURST_WIDTH, BURST_RATE),
    ids=((CURVATURE, "T222"), (BURST_WIDTH, "T220"), (BURST_RATE, "T221")),
)


@style.styled
def fig_5_2(frame: pd.DataFrame) -> Figure:
    """Burst width (a) and rate (b) against curvature."""
    note = [*style.footnote(frame), _equation(), _BURST, "In the thesis (b) begins at 10 impulses/s."]
    fig = style.new_figure(frame, "5-2", "Predicted burst width and burst rate, 10 mm/s", 6.0, note=note)
    names = {BURST_WIDTH: "predicted burst width (mm)", BURST_RATE: "predicted burst rate (impulses/s)"}
    for ax, tag, column in zip(fig.subplots(2, 1), "ab", names, strict=True):
        style.limit_axes(ax, frame, CURVATURE, column)
        if column == BURST_RATE:
            ax.set_ylim(0, None)  # most of the predicted rates are below the 10 that the thesis's axis begins with
        _draw_bursts(ax, frame, column)
        ax.set(xlabel="curvature (1/m)", ylabel=names[column], title=f"({tag})")
    return fig


frame_5_3 = partial(
    _burst_frame,
    speeds=SPEEDS,
    columns=(BURST_WIDTH, BURST_RATE),
    ids=((SPEED, "T225"), (BURST_WIDTH, "T223"), (BURST_RATE, "T224")),
)


@style.styled
def fig_5_3(frame: pd.DataFrame) -> Figure:
    """Burst width (a) and rate (b) against velocity, a line a convexity."""
    note = [*style.footnote(frame), _equation(), _BURST]
    fig = style.new_figure(frame, "5-3", "Predicted burst width and burst rate at five velocities", 7.0, note=note)
    names = {BURST_WIDTH: "predicted burst width (mm)", BURST_RATE: "predicted burst rate (impulses/s)"}
    for ax, tag, column in zip(fig.subplots(2, 1), "ab", names, strict=True):
        style.limit_axes(ax, frame, SPEED, column)
        ends = {}
        for label, rows in frame[frame["source"] == PREDICTED].groupby("convexity", sort=False):
            ax.plot(rows[SPEED], rows[column], marker="o", ms=3, color=CURVE_COLOURS[label], lw=1.1)
            ends[label] = rows[column].iloc[-1]
        recorded = frame[_is_recorded(frame)]
        ax.plot(recorded[SPEED], recorded[column] if len(recorded) else [], "x", color=style.INK, ms=4)
        low, high = ax.get_ylim()
        gap = 0.055 * (high - low)
        for label, y in zip(ends, style.spread(list(ends.values()), gap, low + gap / 2, high - gap), strict=True):
            ax.plot([40.4, 42.3], [ends[label], y], color=CURVE_COLOURS[label], lw=0.6)
            ax.text(42.5, y, label, color=CURVE_COLOURS[label], va="center", fontsize=7.5)
        ax.text(42.5, high, "curvature (1/m)", va="top", fontsize=7)
        ax.set(xlabel="velocity (mm/s)", ylabel=names[column], title=f"({tag})")
    return fig


_FOUR = ("5", "10", "20", "40")
frame_5_16 = partial(
    _burst_frame,
    speeds=_FOUR,
    columns=(BURST_TIME,),
    ids=(
        (CURVATURE, "T273"),
        (BURST_TIME, {f"{v} mm/s": f"T{269 + k}" for k, v in enumerate(_FOUR)}),
    ),
)


@style.styled
def fig_5_16(frame: pd.DataFrame) -> Figure:
    """A panel a velocity."""
    note = [*style.footnote(frame), _BURST.split(";")[0] + " 915 µm under the centre. Predicted, nothing recorded."]
    fig = style.new_figure(frame, "5-16", "Predicted burst duration at four velocities", 5.4, note=note)
    axes = fig.subplots(2, 2)
    for speed, ax in zip(_FOUR, axes.ravel(), strict=True):
        rows = rows_of(frame, "panel", f"{speed} mm/s")
        _draw_bursts(ax, rows, BURST_TIME, color=COLOURS[speed])
        style.limit_axes(ax, rows, CURVATURE, BURST_TIME)
        ax.set(title=f"v = {speed} mm/s")
    for ax in axes[1]:
        ax.set_xlabel("curvature (1/m)")
    for ax in axes[:, 0]:
        ax.set_ylabel("predicted duration (s)")
    return fig


RESPONSES = {"peak": "ramp and hold, peak", "end of the hold": "ramp and hold, steady state"}
STROKED = "stroked at 10 mm/s"


def frame_5_17(
    histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame, recorded: pd.DataFrame | None = None
) -> pd.DataFrame:
    """Predicted rates against curvature: mean of the burst when stroked, peak and steady state when pressed."""
    rows = []
    for label in WITHIN_350:
        name = scene_name("ramp40", label)
        found = ramp_and_hold_rates(histories[name])
        for key, series in RESPONSES.items():
            error = error_percent(histories[name], coarse.get(name), lambda d, key=key: ramp_and_hold_rates(d)[key])
            rows.append((PREDICTED, series, curvature_of(histories[name]), found[key], error))
    frame = pd.DataFrame(rows, columns=["source", "series", CURVATURE, IMPULSE_RATE, ERROR])
    burst = _burst_frame(histories, meshes, coarse, reference, recorded, speeds=("10",), columns=(BURST_RATE,), ids=()).rename(
        columns={BURST_RATE: IMPULSE_RATE}
    )
    burst = burst.drop(columns=["panel", "convexity", SPEED]).assign(series=STROKED)
    return assemble(
        pd.concat([frame, burst], ignore_index=True),
        axis_rows(reference, CURVATURE, "T275"),
        axis_rows(reference, IMPULSE_RATE, "T274"),
    )


@style.styled
def fig_5_17(frame: pd.DataFrame) -> Figure:
    """Stroked (solid), pressed: peak (dashed), steady state (dotted)."""
    note = [*style.footnote(frame), _equation(), "Stroked: " + _BURST[0].lower() + _BURST[1:]]
    fig = style.new_figure(frame, "5-17", "Predicted impulse rate, stroked and pressed", 4.6, note=note)
    ax = fig.subplots()
    looks = {
        STROKED: {"ls": "-", "marker": "s", "color": style.COLOURS["315"]},
        RESPONSES["peak"]: {"ls": (0, (4, 1.8)), "marker": "o", "color": style.INK},
        RESPONSES["end of the hold"]: {"ls": (0, (1, 1.4)), "marker": "o", "mfc": "white", "color": style.INK},
    }
    for series, look in looks.items():
        rows = frame[(frame["source"] == PREDICTED) & (frame["series"] == series)]
        ax.plot(rows[CURVATURE], rows[IMPULSE_RATE], ms=4, label=f"predicted, {series}", **look)
    rows = frame[_is_recorded(frame)]
    if len(rows):
        ax.plot(rows[CURVATURE], rows[IMPULSE_RATE], "x", color=style.COLOURS["315"], label="recorded, stroked")
    style.limit_axes(ax, frame, CURVATURE, IMPULSE_RATE)
    ax.set(xlabel="curvature (1/m)", ylabel="predicted rate (impulses/s)")
    ax.legend(loc="upper left", handlelength=3)
    return fig


# --- 5-14 ----------------------------------------------------------------------------------------------


def frame_5_14(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy at 915 um, simulated and by Eq 4-4: constants of the ramps, shift constant or the skin's."""
    law, shift = stroke_law(histories)
    parts = [surface_rows(histories[FULL["10"]], 0, 80)]
    for series, name in by_speed(FULL).items():
        stroke = loaded(histories[name])
        sample = skin_sample(stroke, SHOWN_DEPTH)
        error = rms_error(histories[name], coarse.get(name), energy_at(SHOWN_DEPTH))
        shared = {"series": series, DISTANCE: distance(stroke) * 1e3, RECEPTOR: SHOWN_DEPTH * 1e6}
        parts.append(pd.DataFrame({"source": SIMULATED} | shared | {SED: sample.energy, ERROR: error}))
        shifts = {"constant shift": shift, "shift of the skin": skin_shift(stroke)}
        for how, source in PREDICTED_ENERGY.items():
            values = law.strain_energy(sample.x, sample.pressure, sample.indentation, shifts[how])
            parts.append(pd.DataFrame({"source": source} | shared | {SED: values}))
    rows = pd.concat(parts, ignore_index=True)
    return assemble(rows, axis_rows(reference, DISTANCE, "T262"), axis_rows(reference, SED, "T264"))


@style.styled
def fig_5_14(frame: pd.DataFrame) -> Figure:
    """A panel a velocity: simulated (solid), constant shift (dashed), shift of the skin (dotted)."""
    title = "Strain energy density 915 µm under the centre, simulated and by Eq 4-4"
    remarks = [
        "The error is that of the simulated energy. Eq 4-4 has the constants that fit the nine pressed surfaces;",
        "its constant shift is the one that fits the stroke at 10 mm/s.",
    ]
    fig, axes = below_surface(frame, "5-14", title, 7.4, panels=len(SPEEDS), header=0.2, remarks=remarks)
    looks = {
        SIMULATED: {"color": style.INK, "ls": "-", "lw": 1.3},
        PREDICTED_ENERGY["constant shift"]: {"color": style.COLOURS["315"], "ls": (0, (4, 1.8)), "lw": 1.2},
        PREDICTED_ENERGY["shift of the skin"]: {"color": COLOURS["10"], "ls": (0, (1, 1.2)), "lw": 1.1},
    }
    lines = []
    for speed, ax in zip(SPEEDS, axes, strict=True):
        own = frame[frame["series"] == f"{speed} mm/s"]
        lines = [
            ax.plot(rows[DISTANCE], rows[SED], label=source.removeprefix(f"{SIMULATED}: "), **look)[0]
            for source, look in looks.items()
            for rows in [own[own["source"] == source]]
        ]
        style.limit_axis(ax, frame, SED, text=speed == "10")
        ax.text(0.008, 0.97, f"v = {speed} mm/s", transform=ax.transAxes, va="top", fontsize=8)
    style.limit_axis(axes[-1], frame, DISTANCE, "x")
    axes[len(axes) // 2].set_ylabel("strain energy density (Pa)")
    axes[-1].set_xlabel("distance (mm)")
    style.header_legend(fig, lines)
    return fig


# --- 5-19, 5-20, 5-21 ----------------------------------------------------------------------------------


def _over_time(histories: Histories, coarse: Histories, columns: Iterable[str]) -> pd.DataFrame:
    """Columns of `predicted_rate` over time while the surface slides, 10 mm/s."""
    rows = stroke_rows(histories, coarse, by_speed({"10": FULL["10"]}), {TIME: time_of, **{c: _of(c) for c in columns}})
    return rows.drop(columns=DISTANCE)


def frame_5_19(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Strain energy and its rate at 915 um over time, 10 mm/s, and the histogram of 12 predicted strokes."""
    name, repetitions = FULL["10"], STROKES_SHOWN["5-19"]
    rate, impulses = impulses_of(histories[name], repetitions)
    bars = stroke_histogram(rate, impulses, repetitions)
    times = np.interp(bars[DISTANCE], rate[DISTANCE], rate[TIME] - rate[TIME].iloc[0])
    bars = pd.DataFrame(
        {"source": PREDICTED, "series": "10 mm/s", "panel": HISTOGRAM, TIME: times, IMPULSE_RATE: bars[IMPULSE_RATE]}
    )
    bars[ERROR] = _rate_error(histories, coarse, name)
    return assemble(
        pd.concat([_over_time(histories, coarse, (SED, RATE)), bars], ignore_index=True),
        axis_rows(reference, TIME, "T281"),
        axis_rows(reference, SED, "T278"),
        axis_rows(reference, RATE, "T279"),
        axis_rows(reference, IMPULSE_RATE, "T280"),
    )


@style.styled
def fig_5_19(frame: pd.DataFrame) -> Figure:
    """Energy cut at its threshold, positive rate, predicted histogram."""
    note = [*style.footnote(frame, HOW), _equation()]
    fig = style.new_figure(
        frame, "5-19", "Strain energy, its rate, and predicted impulses of 12 strokes at 10 mm/s", 6.4, note=note
    )
    _leave_room_for_brackets(fig)
    energy, rate, bars = fig.subplots(3, 1, sharex=True)
    rows = frame[frame["source"] == SIMULATED]
    energy.plot(rows[TIME], rows[SED].clip(lower=150), color=style.INK)
    rate.plot(rows[TIME], rows[RATE].clip(lower=0), color=style.INK)
    _draw_bars(bars, frame, TIME, 0.05)
    names = {
        SED: "strain energy density,\ncut at 150 (Pa)",
        RATE: "positive rate of\nstrain energy (Pa/s)",
        IMPULSE_RATE: "predicted rate\n(impulses/s)",
    }
    for ax, (column, name) in zip((energy, rate, bars), names.items(), strict=True):
        style.limit_axis(ax, frame, column, text=False)
        ax.set_ylabel(name)
    style.limit_axis(bars, frame, TIME, "x")
    bars.set_xlabel("time (s)")
    fig.align_ylabels()
    return fig


def frame_5_20(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Rate by Eq 5-1 over time, 10 mm/s, and what strain energy alone contributes."""
    rows = _over_time(histories, coarse, (IMPULSE_RATE, STATIC)).assign(source=PREDICTED)
    return assemble(rows, axis_rows(reference, TIME, "T288"), axis_rows(reference, IMPULSE_RATE, "T287"))


@style.styled
def fig_5_20(frame: pd.DataFrame) -> Figure:
    """Predicted rate (line) and the part of it that comes from strain energy (area)."""
    note = [*style.footnote(frame, HOW), _equation()]
    fig = style.new_figure(frame, "5-20", "Predicted impulse rate of a stroke at 10 mm/s", 4.2, note=note)
    ax, rows = fig.subplots(), frame[frame["source"] == PREDICTED]
    _draw_rate(ax, rows)
    style.limit_axes(ax, frame, TIME, IMPULSE_RATE)
    ax.set(xlabel="time (s)", ylabel="predicted rate (impulses/s)")
    ax.legend(loc="upper left")
    return fig


def _draw_rate(ax: Axes, rows: pd.DataFrame) -> None:
    ax.plot(rows[TIME], rows[IMPULSE_RATE], color=style.INK, lw=1.2, label="predicted by Eq 5-1")
    ax.fill_between(rows[TIME], rows[STATIC], color=COLOURS["10"], alpha=0.35, lw=0, label="of this from strain energy alone")


def frame_5_21(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Rate by Eq 5-1 over time for eight cylinders pressed at 40 gf/s and held."""
    parts = []
    for label in CYLINDERS:
        name = scene_name("ramp40", label)
        error = error_percent(histories[name], coarse.get(name), lambda d: ramp_and_hold_rates(d)["peak"])
        part = predicted_rate(histories[name])[[TIME, IMPULSE_RATE, STATIC]]
        parts.append(part.assign(source=PREDICTED, surface=label, **{ERROR: error}))
    return assemble(
        pd.concat(parts, ignore_index=True)[["source", "surface", TIME, IMPULSE_RATE, STATIC, ERROR]],
        axis_rows(reference, TIME, "T297"),
        axis_rows(reference, IMPULSE_RATE, {label: f"T{289 + k}" for k, label in enumerate(CYLINDERS)}),
    )


@style.styled
def fig_5_21(frame: pd.DataFrame) -> Figure:
    """Eight panels."""
    note = [*style.footnote(frame, "largest rate"), _equation()]
    fig = style.new_figure(frame, "5-21", "Predicted impulse rate of eight ramps and holds", 7.2, note=note)
    axes = fig.subplots(4, 2, sharex=True)
    for label, ax in zip(CYLINDERS, axes.ravel(), strict=True):
        rows = rows_of(frame, "surface", label)
        _draw_rate(ax, rows[rows["source"] == PREDICTED])
        style.limit_axis(ax, rows, IMPULSE_RATE, text=False)
        ax.set_title(style.surface_name(label))
    style.limit_axis(axes[-1, 0], frame, TIME, "x")
    axes[0, 0].legend(loc="upper right")
    for ax in axes[-1]:
        ax.set_xlabel("time (s)")
    for ax in axes[:, 0]:
        ax.set_ylabel("predicted rate\n(impulses/s)")
    return fig


_FULL = tuple(FULL.values())
_TEN = (FULL["10"],)
_RAMPS = scenes("ramp40")
FIGURES = (
    FigureSpec("5-1", "Predicted impulses, 10 mm/s", _TEN,
               partial(_raster_frame, number="5-1", low=0.0, high=70.0, axis="T217"), fig_5_1),
    FigureSpec("5-2", "Predicted burst width and rate, 10 mm/s", _TEN, frame_5_2, fig_5_2, measured="impulse_rates"),
    FigureSpec("5-3", "Predicted burst width and rate at five velocities", _FULL, frame_5_3, fig_5_3, measured="impulse_rates"),
    FigureSpec("5-14", "Strain energy by Eq 4-4 at five velocities", (*_RAMPS, *_FULL), frame_5_14, fig_5_14, companions=_FULL),
    FigureSpec("5-16", "Predicted burst duration", tuple(FULL[v] for v in _FOUR), frame_5_16, fig_5_16, measured="impulse_rates"),
    FigureSpec("5-17", "Predicted rates, stroked and pressed",
               (*scenes("ramp40", WITHIN_350), *_TEN), frame_5_17, fig_5_17, measured="impulse_rates"),
    FigureSpec("5-19", "Strain energy, its rate and predicted impulses", _TEN, frame_5_19, fig_5_19),
    FigureSpec("5-20", "Predicted rate of a stroke", _TEN, frame_5_20, fig_5_20),
    FigureSpec("5-21", "Predicted rates of ramps and holds", scenes("ramp40", CYLINDERS), frame_5_21, fig_5_21),
    FigureSpec("5-22", "Predicted impulses of a shallow receptor", _TEN,
               partial(_raster_frame, number="5-22", low=40.0, high=80.0, axis="T300", depth=SHALLOW_DEPTH), fig_5_22),
    FigureSpec("5-23", "Predicted frequency of a shallow receptor", _FULL, frame_5_23, fig_5_23),
    FigureSpec("5-27", "Predicted impulses of a plate stroked both ways", tuple(RIDGED.scenes.values()), frame_5_27, fig_5_27,
               companions=(RIDGED["right"],)),
)  # fmt: skip

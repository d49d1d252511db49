"""Chapter 5: what a slowly adapting receptor makes of strokes, predicted by Eqs 4-4 and 5-1 with
the thesis's constants.

Where the thesis shows recordings, which are not public, these figures show predictions on the same
axes and say so: rates by Eq 5-1 from the simulated strain energy, and impulses of a seeded
integrate-and-fire receptor at these rates, the same in every figure.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures import overlaid
from cysyk1999.figures.chapter5 import DEEP, OTHER, PREDICTED, SHALLOW, TEN, TEN_RUN
from cysyk1999.figures.chapter5_bursts import of_rate, rate_errors
from cysyk1999.figures.grammar import HOW, Data, Figure, Page, Panels, stack, stacked
from cysyk1999.measures.errors import (
    Curve,
    curve_errors,
    family_errors,
    over_stroke,
)
from cysyk1999.measures.quantities import (
    COUNT,
    DISTANCE,
    ENERGY_FACTOR,
    IMPULSE_RATE,
    RATE,
    RECEPTOR,
    SED,
    STATIC,
    STROKE_TIME,
    TIME,
    TRIAL,
    Q,
)
from cysyk1999.measures.responses import (
    ASIDE,
    SEED,
    STROKES_SHOWN,
    impulses_of,
    law_at,
    plate_rate,
    predicted_rate,
    raster,
    skin_sample,
    skin_shift,
    stroke_histogram,
    stroke_laws,
)
from cysyk1999.measures.runs import CYLINDERS, NINE, RIDGED, SPEEDS, WITHIN_350
from cysyk1999.publishing import style
from fingerpad.measures.features import SIMULATED
from fingerpad.measures.strokes import distance, energy_at, loaded, passages

BY_PRESSURE = {
    f"{SIMULATED}: Eq 4-4 and a constant shift": OTHER,
    f"{SIMULATED}: Eq 4-4 and the shift of the skin": {
        "color": style.GREY,
        "ls": style.DOTTED,
        "lw": 1.1,
    },
    f"{SIMULATED}: square of the sum and a constant shift": {
        "color": style.HIGHLIGHT,
        "ls": style.SOLID,
        "lw": 0.9,
    },
}
"""Sources of the energies by laws of the pressure, and their lines."""
RASTER, HISTOGRAM = "raster", "histogram"
FOUR = SPEEDS.only(("5 mm/s", "10 mm/s", "20 mm/s", "40 mm/s"))
EIGHT = NINE.only(CYLINDERS)
RESPONSES = {"peak": "ramp and hold, peak", "end": "ramp and hold, steady state"}
WITHIN = NINE.only(WITHIN_350)
STROKED = "stroked at 10 mm/s"
WAYS = {"right": "plate stroked to the right", "left": "plate stroked to the left"}
RATE_WORDS = "predicted rate\n(impulses/s)"


# --- rows -----------------------------------------------------------------------------------------


@stacked
def rasters(
    data: Data, number: str, low: float, high: float, depth: float = DEEP
) -> Iterator[DataFrame]:
    """Predicted impulses of the first of the repeated strokes at 10 mm/s over a part of the surface
    (mm), and their histogram.
    """
    ((_, history, coarse),) = data.runs(TEN_RUN)
    repetitions, (law, factor) = STROKES_SHOWN[number], law_at(data.histories, depth)
    rate, impulses = impulses_of(history, depth, law)
    impulses = impulses[impulses["trial"] <= repetitions]
    ticks = impulses.rename(columns={"trial": TRIAL})[[TRIAL, DISTANCE]]
    bars = stroke_histogram(rate, impulses, repetitions)
    of = {"source": PREDICTED, "series": TEN, RECEPTOR: depth * 1e6, ENERGY_FACTOR: factor}
    of |= rate_errors(history, coarse, depth, law, (low, high))
    yield data.surface(TEN_RUN[TEN], low, high)
    for panel, rows in ((RASTER, ticks), (HISTOGRAM, bars)):
        yield rows[rows[DISTANCE].between(low, high)].assign(panel=panel, **of)


@stacked
def shallow_histograms(data: Data) -> Iterator[DataFrame]:
    """Histogram of the predicted impulses of a shallow receptor, 12 strokes at every velocity."""
    way, (law, factor) = (40.0, 80.0), law_at(data.histories, SHALLOW)
    yield data.surface(TEN_RUN[TEN], *way)
    for series, history, coarse in data.runs(SPEEDS):
        bars = stroke_histogram(*impulses_of(history, SHALLOW, law))
        of = {"source": PREDICTED, "panel": HISTOGRAM, "series": series}
        of |= {RECEPTOR: SHALLOW * 1e6, ENERGY_FACTOR: factor}
        errors = rate_errors(history, coarse, SHALLOW, law, way)
        yield bars[bars[DISTANCE].between(*way)].assign(**of, **errors)


@stacked
def both_ways(data: Data) -> Iterator[DataFrame]:
    """Predicted impulses of ten strokes of a plate over a pad with inner ridges, each way."""
    right = RIDGED["right"]
    # the stroke to the left is the mirror image: the receptor on the other side
    sides = [over_stroke(partial(plate_trace, offset=offset)) for offset in (ASIDE, -ASIDE)]
    errors = family_errors(data.histories[right], data.coarse.get(right), sides).columns
    for way, scene in RIDGED.scenes.items():
        of = {"source": PREDICTED, "series": way, RECEPTOR: round(DEEP * 1e6), **errors}
        rate = plate_rate(data.histories[scene])
        ticks = raster(rate, STROKES_SHOWN["5-27"], SEED).rename(columns={"trial": TRIAL})
        yield ticks[[TRIAL, DISTANCE]].assign(panel=RASTER, **of)
        of[TRIAL] = np.nan  # so that the column is there where no impulse is predicted
        yield rate[[DISTANCE, IMPULSE_RATE]].assign(panel="rate", **of)


def plate_trace(stroke: Dataset, offset: float) -> np.ndarray:
    """Predicted rate at every output, after a kink between legs where there is one."""
    rate = predicted_rate(stroke, DEEP, offset=offset).drop_duplicates(TIME, keep="last")
    return rate[IMPULSE_RATE].to_numpy()


@stacked
def by_pressure(data: Data) -> Iterator[DataFrame | Mapping]:
    """Strain energy at 915 um, simulated and by laws of the pressure: constants of the ramps, shift
    constant or the skin's.
    """
    (law, shift), (square, own_shift) = stroke_laws(data.histories).values()
    yield data.surface(TEN_RUN[TEN], 0, 80)
    for series, history, coarse in data.runs(SPEEDS):
        stroke = loaded(history)
        sample = skin_sample(stroke, DEEP)
        errors = curve_errors(history, coarse, over_stroke(energy_at(DEEP))).columns
        of = {"series": series, DISTANCE: distance(stroke) * 1e3, RECEPTOR: DEEP * 1e6}
        yield of | {"source": SIMULATED, SED: sample.energy} | errors
        ways = (law, shift), (law, skin_shift(stroke)), (square, own_shift)
        for source, way in zip(BY_PRESSURE, ways, strict=True):
            yield of | {"source": source, SED: sample.by(*way)}


@stacked
def over_time(data: Data, columns: Sequence[Q]) -> Iterator[DataFrame]:
    """The surface, and columns of `predicted_rate` over time while it slides, 10 mm/s, with the
    convexity that passes.
    """
    ((_, history, _),) = data.runs(TEN_RUN)
    rows = data.traces(TEN_RUN, (DISTANCE, STROKE_TIME, *map(of_rate, columns)))
    for label, (start, end) in passages(loaded(history)).items():
        rows.loc[rows[DISTANCE].between(1e3 * start, 1e3 * end), "convexity"] = label
    yield data.surface(TEN_RUN[TEN], 0, 80)
    yield rows.drop(columns=DISTANCE)


@stacked
def energy_and_histogram(data: Data) -> Iterator[DataFrame]:
    """Strain energy and its rate at 915 um over time, 10 mm/s, and the histogram of 12 predicted
    strokes.
    """
    ((_, history, coarse),) = data.runs(TEN_RUN)
    rate, impulses = impulses_of(history)
    bars = stroke_histogram(rate, impulses)
    times = np.interp(bars[DISTANCE], rate[DISTANCE], rate[TIME] - rate[TIME].iloc[0])
    of = {"source": PREDICTED, "series": TEN, "panel": HISTOGRAM, TIME: times}
    yield over_time(data, (SED, RATE))
    yield bars[[COUNT, IMPULSE_RATE]].assign(**of, **rate_errors(history, coarse))


def predicted_over_time(data: Data) -> DataFrame:
    """The surface, and the rate by Eq 5-1 with its part from strain energy alone over time, 10
    mm/s.
    """
    rows = over_time(data, (IMPULSE_RATE, STATIC))
    return rows.assign(source=rows["source"].replace(SIMULATED, PREDICTED))


def pressed_rates(data: Data) -> DataFrame:
    """Rate by Eq 5-1 over time for eight cylinders pressed at 40 gf/s and held."""
    curve = Curve(lambda history: predicted_rate(history)[[TIME, IMPULSE_RATE]].to_numpy().T)
    rows = data.table(EIGHT, lambda h: predicted_rate(h)[[TIME, IMPULSE_RATE, STATIC]], curve)
    return rows.assign(source=PREDICTED)


# --- pictures -------------------------------------------------------------------------------------


def draw_raster(ax: Axes, frame: DataFrame, count: int) -> None:
    """One row of ticks a stroke, the first one above."""
    rows, places = frame[frame["panel"] == RASTER], range(1, count + 1)
    trains = [rows.loc[rows[TRIAL] == trial, DISTANCE].to_numpy() for trial in places]
    look = {"linelengths": 0.7, "linewidths": 0.8, "colors": [style.INK], "clip_on": False}
    ax.eventplot(trains, lineoffsets=places, **look)
    ax.set(ylim=(count + 0.6, 0.4), yticks=[1, count] if count > 5 else places)
    ax.set_ylabel("predicted stroke")
    ax.tick_params(left=False)


def draw_bars(ax: Axes, frame: DataFrame, x: Q, width: float) -> None:
    """The histogram of predicted impulses."""
    rows = frame[frame["panel"] == HISTOGRAM]
    ax.bar(rows[x], rows[IMPULSE_RATE], width, color=style.INK, lw=0)


def ticks_below_surface(fig, frame, spec):
    """Predicted rasters below the surface, and their histogram if the spec has one (y)."""
    panels = axs.below_surface(fig, frame, 1 + len(spec.y))
    draw_raster(panels[0], frame, STROKES_SHOWN[spec.number])
    if spec.y:
        draw_bars(panels[1], frame, DISTANCE, 0.5)
        panels[1].set_ylabel(RATE_WORDS)
    axs.limit_axes(panels[-1], frame, DISTANCE)
    panels[-1].set_xlabel(DISTANCE.label)


def plate_both_ways(fig, frame, spec):
    """Ten predicted rasters each way, and their rate below."""
    axes = fig.subplots(2, 2, sharex=True, sharey="row", height_ratios=[1.6, 1])
    for (way, title), (top, bottom) in zip(WAYS.items(), axes.T, strict=True):
        rows = frame[frame["series"] == way]
        draw_raster(top, rows, STROKES_SHOWN["5-27"])
        rate = rows[rows["panel"] == "rate"]
        axs.curve(bottom, rate, DISTANCE, IMPULSE_RATE, color=style.INK, lw=1.2)
        if RASTER not in set(rows["panel"]):
            axs.remark(top, 0.5, 0.5, "no impulse predicted", ha="center", color=style.GREY)
        top.set_title(title)
        bottom.set(xlabel="stroke distance (mm)", xlim=(0, 50))
    axes[1, 0].set(ylim=(0, None), ylabel=RATE_WORDS)
    axes[0, 1].set_ylabel("")


def plate_note(frame: DataFrame) -> list[str]:
    """The errors of either way: relative to next to no response one tells little."""
    place = "Receptor 46 µm right of a ridge's tip, 915 µm deep"
    parts = "Predicted by Eq 5-1, not measured", axs.error_text(frame), place
    return [" ".join(f"{part}." for part in parts if part)]


def bars_at_a_velocity(ax, rows, spec):
    """The histogram at one velocity."""
    draw_bars(ax, rows, DISTANCE, 0.5)


def say_brackets(panels, frame):
    """What the brackets beside the panels are."""
    ax = next(iter(panels.values()))
    style.leave_room(ax.figure, beside=0.02)
    text = "brackets: thesis's axis (broken: reading uncertain)"
    axs.remark(ax, 0.99, 0.97, text, ha="right", va="top", **axs.NOTE)


def aligned(panels, frame):
    """Labels of the vertical axes in one line."""
    fig = panels[TIME, SED].figure
    style.leave_room(fig, beside=0.02)
    fig.align_ylabels()


LEAST = {SED: 150, RATE: 0}
"""What the thesis cuts the two off at."""
CUT_ENERGY = SED.reading(None, "strain energy density,\ncut at 150 (Pa)")
CUT_RATE = RATE.reading(None, "positive rate of\nstrain energy (Pa/s)")
BINNED_RATE = IMPULSE_RATE.reading(None, RATE_WORDS)


def name_peaks(ax: Axes, rows: DataFrame, y: Q) -> None:
    """The curvature of each convexity (1/m) above the largest value while it passes."""
    for label, part in rows.groupby("convexity", sort=False):
        top = tuple(part.loc[part[y].idxmax(), [TIME, y]])
        place = {"xytext": (0, 1.5), "textcoords": "offset points", "ha": "center"}
        ax.annotate(label, top, va="bottom", fontsize=6, color=style.GREY, **place)


def energy_rate_or_bars(ax, frame, spec):
    """Energy cut at its threshold, positive rate with its peaks named, predicted histogram."""
    rows, (y,) = frame[frame["source"] == SIMULATED], spec.y
    if y == IMPULSE_RATE:
        draw_bars(ax, frame, TIME, 0.05)
    else:
        shown = rows.assign(**{y: rows[y].clip(lower=LEAST[y])})
        axs.curve(ax, shown, TIME, y, whole=rows, color=style.INK)
        if y == RATE:
            name_peaks(ax, shown, y)


def stroked_rate(ax, rows, spec):
    """Predicted rate with its peaks named."""
    draw_rate(ax, rows, spec)
    name_peaks(ax, rows[rows["source"] == PREDICTED], IMPULSE_RATE)


def draw_rate(ax, rows, spec):
    """Predicted rate (line) and the part of it that comes from strain energy (area)."""
    rows = rows[rows["source"] == PREDICTED]
    axs.curve(ax, rows, TIME, IMPULSE_RATE, color=style.INK, lw=1.2, label="predicted by Eq 5-1")
    area = {"color": "#9fc3d6", "lw": 0, "label": "of this from strain energy alone"}
    ax.fill_between(rows[TIME], rows[STATIC], **area)


def legend_of_the_first(panels, frame):
    """With the brackets that stand at some panels."""
    first = next(iter(panels.values()))
    line = {"color": style.GREY, "lw": 0.7, "ls": style.DASHED, "marker": "|", "ms": 4}
    first.plot([], [], label="thesis's axis (broken: reading uncertain)", **line)
    first.legend(loc="upper right")


FIGURES = (
    Figure(
        "5-1",
        "Predicted impulses of ten strokes at 10 mm/s",
        TEN_RUN,
        DISTANCE,
        (IMPULSE_RATE,),
        {DISTANCE: "T217"},
        Page(4.2, ticks_below_surface),
        rows=partial(rasters, number="5-1", low=0.0, high=70.0),
        how=HOW,
    ),
    Figure(
        "5-14",
        "Strain energy density 915 µm under the centre, simulated and from contact pressure",
        (SPEEDS, NINE.without_companions()),
        DISTANCE,
        (SED,),
        {DISTANCE: "T262", SED: "T264"},
        Page(5.6, partial(overlaid.laws_of_pressure, laws=BY_PRESSURE)),
        rows=by_pressure,
        surface=(0, 80),
    ),
    Figure(
        "5-19",
        "Strain energy, its rate, and predicted impulses of 12 strokes at 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (CUT_ENERGY, CUT_RATE, BINNED_RATE),
        {TIME: "T281", SED: "T278", RATE: "T279", IMPULSE_RATE: "T280"},
        Panels(
            5.4,
            names=tuple((TIME, y) for y in (CUT_ENERGY, CUT_RATE, BINNED_RATE)),
            extra=aligned,
            fill=energy_rate_or_bars,
            marked=RATE,
            share={"sharex": True},
        ),
        rows=energy_and_histogram,
        surface=(0, 80),
    ),
    Figure(
        "5-20",
        "Predicted impulse rate of a stroke at 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (IMPULSE_RATE,),
        {TIME: "T288", IMPULSE_RATE: "T287"},
        Panels(3.4, fill=stroked_rate, legend={"loc": "upper left"}),
        rows=predicted_over_time,
        surface=(0, 80),
    ),
    Figure(
        "5-21",
        "Predicted impulse rate of eight ramps and holds",
        EIGHT,
        TIME,
        (BINNED_RATE,),
        {TIME: "T297", IMPULSE_RATE: {label: f"T{289 + k}" for k, label in enumerate(EIGHT)}},
        Panels(
            6.0,
            by="surface",
            names=CYLINDERS,
            across=2,
            fill=draw_rate,
            marked="none",
            extra=legend_of_the_first,
            share={"sharex": True},
        ),
        rows=pressed_rates,
        how="largest rate",
    ),
    Figure(
        "5-22",
        "Predicted impulses of four strokes at 10 mm/s, receptor 560 µm deep",
        (TEN_RUN, NINE.without_companions()),
        DISTANCE,
        (),
        {DISTANCE: "T300"},
        Page(2.6, ticks_below_surface),
        how=HOW,
        rows=partial(rasters, number="5-22", low=40.0, high=80.0, depth=SHALLOW),
    ),
    Figure(
        "5-23",
        "Predicted impulse rate of a receptor 560 µm deep, 12 strokes in bins of 0.5 mm",
        (SPEEDS, NINE.without_companions()),
        DISTANCE,
        (BINNED_RATE,),
        {
            DISTANCE: "T300",
            IMPULSE_RATE: {
                series: "T304" if series[:2] in ("20", "40") else "T304a" for series in SPEEDS
            },
        },
        stack(5.8, marked="none", fill=bars_at_a_velocity, extra=say_brackets),
        rows=shallow_histograms,
        surface=(40, 80),
    ),
    Figure(
        "5-27",
        "Predicted impulses of a flat plate stroked both ways at 10 mm/s, inner ridges",
        RIDGED,
        DISTANCE,
        (IMPULSE_RATE,),
        {},
        Page(3.6, plate_both_ways),
        rows=both_ways,
        note=plate_note,
    ),
)

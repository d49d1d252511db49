"""Chapter 5: what a slowly adapting receptor makes of strokes, predicted by Eqs 4-4 and 5-1 with
the thesis's constants.

Where the thesis shows recordings, which are not public, these figures show predictions on the same
axes and say so: rates by Eq 5-1 from the simulated strain energy, and impulses of a seeded
integrate-and-fire receptor at these rates. What a user puts into ``config/reference/recordings`` is
laid over the bursts.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures.chapter5 import DEEP, OTHER, SHALLOW, TEN, TEN_RUN
from cysyk1999.figures.grammar import HOW, Data, Figure, Lines, Page, Panels, stack, stacked
from cysyk1999.measures.errors import (
    PARTS,
    Companion,
    Curve,
    curve_errors,
    family_errors,
    over_stroke,
)
from cysyk1999.measures.quantities import (
    BURST_RATE,
    BURST_TIME,
    BURST_WIDTH,
    CURVATURE,
    DISTANCE,
    FREQUENCY,
    IMPULSE_RATE,
    RATE,
    RECEPTOR,
    SED,
    SPEED,
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
    mean_frequency,
    plate_rate,
    predicted_rate,
    raster,
    shallow_law,
    skin_sample,
    skin_shift,
    stroke_histogram,
    stroke_law,
)
from cysyk1999.measures.runs import CYLINDERS, NINE, RIDGED, SPEEDS, WITHIN_350, Runs
from cysyk1999.measures.table import MEASURES, reading
from cysyk1999.publishing import style
from fingerpad.measures.features import SIMULATED
from fingerpad.measures.strokes import distance, energy_at, loaded
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate

PREDICTED = f"{SIMULATED}: predicted by Eq 5-1"
BY_PRESSURE = {
    f"{SIMULATED}: Eq 4-4 and a constant shift": OTHER,
    f"{SIMULATED}: Eq 4-4 and the shift of the skin": {
        "color": style.GREY,
        "ls": style.DOTTED,
        "lw": 1.1,
    },
}
"""Sources of the energies by the two laws, and their lines."""
RASTER, HISTOGRAM = "raster", "histogram"
FOUR = SPEEDS.only(("5 mm/s", "10 mm/s", "20 mm/s", "40 mm/s"))
EIGHT = NINE.only(CYLINDERS)
RESPONSES = {"peak": "ramp and hold, peak", "end": "ramp and hold, steady state"}
WITHIN = NINE.only(WITHIN_350)
STROKED = "stroked at 10 mm/s"
WAYS = {"right": "plate stroked to the right", "left": "plate stroked to the left"}
RATE_WORDS = "predicted rate\n(impulses/s)"


def of_rate(column: Q, depth: float = DEEP, law: ImpulseRate = THESIS_RATE) -> Q:
    """A column of `predicted_rate` at the loaded outputs of a stroke."""
    return column.reading(lambda stroke: predicted_rate(stroke, depth, law)[column].to_numpy())


def rate_errors(
    history: Dataset,
    coarse: Companion | None,
    depth: float = DEEP,
    law: ImpulseRate = THESIS_RATE,
    way: tuple[float, ...] = (),
) -> dict[str, float]:
    """Of the predicted rate from one place to another of the way (mm), over all of it where none
    are given.
    """
    rate = of_rate(IMPULSE_RATE, depth, law).read
    curve = over_stroke(rate, *(1e-3 * place for place in way))
    return curve_errors(history, coarse, curve).columns


def shallow(data: Data) -> ImpulseRate:
    """Eq 5-1 560 um deep, by the one rule of `shallow_law`."""
    return shallow_law(NINE.histories(data.histories), SHALLOW)[0]


# --- rows -----------------------------------------------------------------------------------------


@stacked
def rasters(
    data: Data, number: str, low: float, high: float, depth: float = DEEP
) -> Iterator[DataFrame]:
    """Predicted impulses of repeated strokes at 10 mm/s over a part of the surface (mm), and their
    histogram.
    """
    ((_, history, coarse),) = data.runs(TEN_RUN)
    repetitions, law = STROKES_SHOWN[number], THESIS_RATE if depth == DEEP else shallow(data)
    rate, impulses = impulses_of(history, repetitions, depth, law)
    ticks = impulses.rename(columns={"trial": TRIAL})[[TRIAL, DISTANCE]]
    bars = stroke_histogram(rate, impulses, repetitions)
    of = {"source": PREDICTED, "series": TEN, RECEPTOR: depth * 1e6}
    of |= rate_errors(history, coarse, depth, law, (low, high))
    yield data.surface(TEN_RUN[TEN], low, high)
    for panel, rows in ((RASTER, ticks), (HISTOGRAM, bars)):
        yield rows[rows[DISTANCE].between(low, high)].assign(panel=panel, **of)


@stacked
def frequencies(data: Data) -> Iterator[DataFrame | Mapping]:
    """Instantaneous frequency of predicted impulses of a shallow receptor, mean of 12 strokes at
    every velocity.
    """
    way, repetitions, law = (40.0, 80.0), STROKES_SHOWN["5-23"], shallow(data)
    at = np.arange(way[0], way[1] + 0.01, 0.1)
    yield data.surface(TEN_RUN[TEN], *way)
    for series, history, coarse in data.runs(SPEEDS):
        rate, impulses = impulses_of(history, repetitions, SHALLOW, law)
        times = np.interp(at, rate[DISTANCE], rate[TIME])
        frequency = mean_frequency(impulses, repetitions, times)[FREQUENCY]
        of = {"source": PREDICTED, "panel": series, "series": series, RECEPTOR: SHALLOW * 1e6}
        errors = rate_errors(history, coarse, SHALLOW, law, way)
        yield of | {DISTANCE: at, FREQUENCY: frequency} | errors


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
def burst_rows(data: Data, runs: Runs, columns: Mapping[Q, str]) -> Iterator[DataFrame | Mapping]:
    """Burst of each convexity at some velocities, and a user's recorded ones, for none is
    public.
    """
    own = data.numbers(runs, {q: MEASURES[name] for q, name in columns.items()}, own=True)
    speed = own["series"].str.removesuffix(" mm/s").astype(float)
    yield own.assign(source=PREDICTED, panel=own["series"], **{SPEED: speed})
    if (rates := data.measured) is None:
        return
    rows = rates.query("window == 'burst' and receptor == 'SA-I'")
    series = rows["speed_mm_per_s"].map("{:g} mm/s".format)
    width, speed = rows["burst_width_mm"], rows["speed_mm_per_s"]
    of = {"source": "measured (" + rows["recording"] + ")", "panel": series, "series": series}
    of |= {SPEED: speed, CURVATURE: rows["curvature_per_m"]}
    found = {BURST_RATE: rows["rate_per_s"], BURST_WIDTH: width, BURST_TIME: width / speed}
    recorded = DataFrame(of | {q: found[q] for q in columns})
    yield recorded[series.isin(list(runs))]


@stacked
def stroked_and_pressed(data: Data) -> Iterator[DataFrame]:
    """Predicted rates against curvature: mean of the burst when stroked, peak and steady state when
    pressed.
    """
    columns = ["source", "series", CURVATURE, IMPULSE_RATE, *PARTS]
    for at, series in RESPONSES.items():
        rows = data.numbers(WITHIN, {IMPULSE_RATE: reading("rate", at)}, own=True)
        yield rows.assign(source=PREDICTED, series=series)[columns]
    bursts = burst_rows(data, TEN_RUN, BURST_RATES).rename(columns={BURST_RATE: IMPULSE_RATE})
    yield bursts.assign(series=STROKED)[columns]


@stacked
def by_pressure(data: Data) -> Iterator[DataFrame | Mapping]:
    """Strain energy at 915 um, simulated and by Eq 4-4: constants of the ramps, shift constant or
    the skin's.
    """
    law, shift = stroke_law(data.histories)
    yield data.surface(TEN_RUN[TEN], 0, 80)
    for series, history, coarse in data.runs(SPEEDS):
        stroke = loaded(history)
        sample = skin_sample(stroke, DEEP)
        errors = curve_errors(history, coarse, over_stroke(energy_at(DEEP))).columns
        of = {"series": series, DISTANCE: distance(stroke) * 1e3, RECEPTOR: DEEP * 1e6}
        yield of | {"source": SIMULATED, SED: sample.energy} | errors
        for source, by in zip(BY_PRESSURE, (shift, skin_shift(stroke)), strict=True):
            yield of | {"source": source, SED: sample.by(law, by)}


def over_time(data: Data, columns: Sequence[Q]) -> DataFrame:
    """Columns of `predicted_rate` over time while the surface slides, 10 mm/s."""
    return data.traces(TEN_RUN, (STROKE_TIME, *map(of_rate, columns)))


@stacked
def energy_and_histogram(data: Data) -> Iterator[DataFrame]:
    """Strain energy and its rate at 915 um over time, 10 mm/s, and the histogram of 12 predicted
    strokes.
    """
    ((_, history, coarse),) = data.runs(TEN_RUN)
    repetitions = STROKES_SHOWN["5-19"]
    rate, impulses = impulses_of(history, repetitions)
    bars = stroke_histogram(rate, impulses, repetitions)
    times = np.interp(bars[DISTANCE], rate[DISTANCE], rate[TIME] - rate[TIME].iloc[0])
    of = {"source": PREDICTED, "series": TEN, "panel": HISTOGRAM, TIME: times}
    yield over_time(data, (SED, RATE))
    yield bars[[IMPULSE_RATE]].assign(**of, **rate_errors(history, coarse))


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


def against_velocity(ax, frame, spec):
    """A line a convexity, named at its end."""
    (y,), own, ends = spec.y, frame[frame["source"] == PREDICTED], {}
    for label, rows in own.groupby("convexity", sort=False):
        look = style.look_of("curvature (1/m)", label) | {"marker": "o", "ms": 3, "lw": 1.0}
        axs.curve(ax, rows, SPEED, y, points=True, **look)
        ends[label] = tuple(rows[[SPEED, y]].iloc[-1])
    measured = axs.from_source(frame, "measured")
    ax.plot(measured[SPEED], measured[y], "x", color=style.INK, ms=4)
    style.label_ends(ax, ends, 42.3, "curvature (1/m)")


def rates_from_zero(panels, frame):
    """Most of the predicted rates are below the 10 that the thesis's axis begins with."""
    panels[CURVATURE, BURST_RATE].set_ylim(0, None)


def three_laws(panels, frame):
    """Legend of the three lines of a panel."""
    style.header_legend(panels[TEN].figure, panels[TEN].lines)


def say_plateaus(panels, frame):
    """Between bursts the frequency is that of one long interval."""
    ax = next(iter(panels.values()))
    style.leave_room(ax.figure, beside=0.02)
    text = "level stretches: one interval from burst to burst; "
    text += "brackets: thesis's axis (?: reading uncertain)"
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


def energy_rate_or_bars(ax, frame, spec):
    """Energy cut at its threshold, positive rate, predicted histogram."""
    rows, (y,) = frame[frame["source"] == SIMULATED], spec.y
    if y == IMPULSE_RATE:
        draw_bars(ax, frame, TIME, 0.05)
    else:
        shown = rows.assign(**{y: rows[y].clip(lower=LEAST[y])})
        axs.curve(ax, shown, TIME, y, whole=rows, color=style.INK)


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
    first.plot([], [], label="thesis's axis (?: reading uncertain)", **line)
    first.legend(loc="upper right")


BURST_RATES = {BURST_RATE: "burst_rate"}
BURSTS = {BURST_WIDTH: "burst_width"} | BURST_RATES
PRESSED = {"marker": "o", "ms": 4, "color": style.INK, "clip_on": False, "zorder": 3}
OWN_BURSTS = {
    "color": style.INK,
    "marker": "o",
    "ms": 3.5,
    "lw": 0.8,
    "ls": "-",
    "clip_on": False,
    "zorder": 3,
}
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
        "5-2",
        "Predicted burst width and burst rate, 10 mm/s",
        TEN_RUN,
        CURVATURE,
        tuple(BURSTS),
        {CURVATURE: "T222", BURST_WIDTH: "T220", BURST_RATE: "T221"},
        Panels(
            3.0,
            names=tuple((CURVATURE, y) for y in BURSTS),
            extra=rates_from_zero,
            across=2,
            fill=Lines(looks={TEN: OWN_BURSTS}),
        ),
        rows=partial(burst_rows, runs=TEN_RUN, columns=BURSTS),
        measured="impulse_rates",
        joined="series",
    ),
    Figure(
        "5-3",
        "Predicted burst width and burst rate at five velocities",
        SPEEDS,
        SPEED,
        tuple(BURSTS),
        {SPEED: "T225", BURST_WIDTH: "T223", BURST_RATE: "T224"},
        Panels(3.4, names=tuple((SPEED, y) for y in BURSTS), across=2, fill=against_velocity),
        rows=partial(burst_rows, runs=SPEEDS, columns=BURSTS),
        measured="impulse_rates",
        joined="convexity",
    ),
    Figure(
        "5-14",
        "Strain energy density 915 µm under the centre, simulated and by Eq 4-4",
        (SPEEDS, NINE.without_companions()),
        DISTANCE,
        (SED,),
        {DISTANCE: "T262", SED: "T264"},
        stack(
            5.8,
            fill=Lines(
                by="source",
                names={source: source.removeprefix(f"{SIMULATED}: ") for source in BY_PRESSURE},
                looks={SIMULATED: {"color": style.INK, "ls": "-", "lw": 1.2}} | BY_PRESSURE,
            ),
            extra=three_laws,
        ),
        rows=by_pressure,
        surface=(0, 80),
    ),
    Figure(
        "5-16",
        "Predicted burst duration at four velocities",
        FOUR,
        CURVATURE,
        (BURST_TIME,),
        {CURVATURE: "T273", BURST_TIME: {series: f"T{269 + k}" for k, series in enumerate(FOUR)}},
        Panels(
            4.2,
            by="panel",
            names=FOUR,
            across=2,
            fill=Lines(looks=dict.fromkeys(FOUR, OWN_BURSTS)),
            title=lambda ax, series: ax.set_title(f"v = {series}"),
        ),
        rows=partial(burst_rows, runs=FOUR, columns={BURST_TIME: "burst_time"}),
        measured="impulse_rates",
        joined="series",
    ),
    Figure(
        "5-17",
        "Predicted impulse rate, stroked and pressed",
        (WITHIN, TEN_RUN),
        CURVATURE,
        (IMPULSE_RATE,),
        {CURVATURE: "T275", IMPULSE_RATE: "T274"},
        Panels(
            3.2,
            legend={"loc": "upper left", "handlelength": 3},
            fill=Lines(
                by="series",
                looks={
                    STROKED: {"ls": "-", "marker": "s", "ms": 3.5, "color": style.HIGHLIGHT},
                    RESPONSES["peak"]: PRESSED | {"ls": style.DASHED},
                    RESPONSES["end"]: PRESSED | {"ls": style.DOTTED, "mfc": "white"},
                },
                names={series: f"predicted, {series}" for series in (STROKED, *RESPONSES.values())}
                | {"recorded": "recorded, stroked"},
            ),
        ),
        rows=stroked_and_pressed,
        width=style.COLUMN_WIDTH,
        measured="impulse_rates",
        joined="series",
    ),
    Figure(
        "5-19",
        "Strain energy, its rate, and predicted impulses of 12 strokes at 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (CUT_ENERGY, CUT_RATE, BINNED_RATE),
        {TIME: "T281", SED: "T278", RATE: "T279", IMPULSE_RATE: "T280"},
        Panels(
            4.8,
            names=tuple((TIME, y) for y in (CUT_ENERGY, CUT_RATE, BINNED_RATE)),
            extra=aligned,
            fill=energy_rate_or_bars,
            marked=RATE,
            share={"sharex": True},
        ),
        rows=energy_and_histogram,
        how=HOW,
    ),
    Figure(
        "5-20",
        "Predicted impulse rate of a stroke at 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (IMPULSE_RATE,),
        {TIME: "T288", IMPULSE_RATE: "T287"},
        Panels(3.0, fill=draw_rate, legend={"loc": "upper left"}),
        rows=lambda data: over_time(data, (IMPULSE_RATE, STATIC)).assign(source=PREDICTED),
        how=HOW,
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
        "Predicted instantaneous frequency of a receptor 560 µm deep, mean of 12 strokes",
        (SPEEDS, NINE.without_companions()),
        DISTANCE,
        (FREQUENCY.reading(None, "predicted frequency\n(impulses/s)"),),
        {
            DISTANCE: "T300",
            FREQUENCY: {
                series: "T304" if series[:2] in ("20", "40") else "T304a" for series in SPEEDS
            },
        },
        stack(
            5.8,
            by="panel",
            marked="none",
            fill=Lines(looks={FREQUENCY: {"lw": 1.0, "ls": "-"}}),
            extra=say_plateaus,
        ),
        rows=frequencies,
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

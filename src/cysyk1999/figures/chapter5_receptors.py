"""Chapter 5: what a slowly adapting receptor makes of strokes, predicted by Eqs 4-4 and 5-1 with
the thesis's constants.

Where the thesis shows recordings, which are not public, these figures show predictions on the same
axes and say so: rates by Eq 5-1 from the simulated strain energy, and impulses of a seeded
integrate-and-fire receptor at these rates. What a user puts into ``config/reference/recordings`` is
laid over the bursts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.figures import axes as axs
from cysyk1999.figures.chapter5 import DEEP, OTHER, SHALLOW, TEN, TEN_RUN
from cysyk1999.figures.grammar import HOW, Data, Figure, Lines, Own, Panels, below, stack
from cysyk1999.measures.errors import (
    PARTS,
    Companion,
    Curve,
    Errors,
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
from cysyk1999.measures.table import reading
from cysyk1999.publishing import style
from fingerpad.measures.features import SIMULATED, is_simulated
from fingerpad.measures.strokes import distance, energy_at, loaded
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

PREDICTED = f"{SIMULATED}: predicted by Eq 5-1"
BY_PRESSURE = {
    "constant shift": f"{SIMULATED}: Eq 4-4 and a constant shift",
    "shift of the skin": f"{SIMULATED}: Eq 4-4 and the shift of the skin",
}
RASTER, HISTOGRAM = "raster", "histogram"
FOUR = SPEEDS.only(("5 mm/s", "10 mm/s", "20 mm/s", "40 mm/s"))
EIGHT = NINE.only(CYLINDERS)
BURST = (
    "A burst is the time during which the strain energy is above 150 Pa; its rate is the mean "
    "predicted rate over that time."
)
RESPONSES = {"peak": "ramp and hold, peak", "end": "ramp and hold, steady state"}
WITHIN = NINE.only(WITHIN_350)
STROKED = "stroked at 10 mm/s"
WAYS = {"right": "plate stroked to the right", "left": "plate stroked to the left"}
RATE_WORDS = "predicted rate\n(impulses/s)"


def equation(depth: float = DEEP) -> str:
    """What the pictures say of their rates."""
    return (
        "Predicted, not recorded: Eq 5-1 with the thesis's constants and the simulated strain "
        "energy "
        f"{depth * 1e6:.0f} µm under the centre."
    )


def of_rate(column: Q, depth: float = DEEP, law: ImpulseRate = THESIS_RATE) -> Q:
    """A column of `predicted_rate` at the loaded outputs of a stroke."""
    return column.reading(lambda stroke: predicted_rate(stroke, depth, law)[column].to_numpy())


def rate_errors(
    history: xr.Dataset,
    coarse: Companion | None,
    depth: float = DEEP,
    law: ImpulseRate = THESIS_RATE,
    way: tuple[float, ...] = (),
) -> Errors:
    """Of the predicted rate from one place to another of the way (mm), over all of it where none
    are given.
    """
    return curve_errors(
        history,
        coarse,
        over_stroke(of_rate(IMPULSE_RATE, depth, law).read, *(1e-3 * place for place in way)),
    )


def law_of(data: Data, depth: float) -> ImpulseRate:
    """Eq 5-1 at the thesis's depth, and by the one rule of `shallow_law` at another."""
    return (
        THESIS_RATE
        if depth == DEEP
        else shallow_law({k: data.histories[scene] for k, scene in NINE.scenes.items()}, depth)[0]
    )


# --- rows ------------------------------------------------------------------------------------------------


def rasters(data: Data, number: str, low: float, high: float, depth: float = DEEP) -> pd.DataFrame:
    """Predicted impulses of repeated strokes at 10 mm/s over a part of the surface (mm), and their
    histogram.
    """
    ((_, history, coarse),) = data.runs(TEN_RUN)
    repetitions, law = STROKES_SHOWN[number], law_of(data, depth)
    rate, impulses = impulses_of(history, repetitions, depth, law)
    ticks = impulses.rename(columns={"trial": TRIAL})[[TRIAL, DISTANCE]].assign(panel=RASTER)
    bars = stroke_histogram(rate, impulses, repetitions).assign(panel=HISTOGRAM)
    rows = pd.concat([ticks, bars], ignore_index=True)
    rows = rows[rows[DISTANCE].between(low, high)].assign(source=PREDICTED, series=TEN)
    rows = rows.assign(
        **{RECEPTOR: depth * 1e6} | rate_errors(history, coarse, depth, law, (low, high)).columns
    )
    return pd.concat([data.surface(TEN_RUN[TEN], low, high), rows], ignore_index=True)


def frequencies(data: Data) -> pd.DataFrame:
    """Instantaneous frequency of predicted impulses of a shallow receptor, mean of 12 strokes at
    every velocity.
    """
    way = (40.0, 80.0)
    parts, repetitions = [data.surface(TEN_RUN[TEN], *way)], STROKES_SHOWN["5-23"]
    at, law = np.arange(way[0], way[1] + 0.01, 0.1), law_of(data, SHALLOW)
    for series, history, coarse in data.runs(SPEEDS):
        rate, impulses = impulses_of(history, repetitions, SHALLOW, law)
        frequency = mean_frequency(
            impulses, repetitions, np.interp(at, rate[DISTANCE], rate[TIME])
        )[FREQUENCY]
        row = {
            "source": PREDICTED,
            "panel": series,
            "series": series,
            DISTANCE: at,
            FREQUENCY: frequency,
        }
        parts.append(
            pd.DataFrame(
                row
                | {RECEPTOR: SHALLOW * 1e6}
                | rate_errors(history, coarse, SHALLOW, law, way).columns
            )
        )
    return pd.concat(parts, ignore_index=True)


def both_ways(data: Data) -> pd.DataFrame:
    """Predicted impulses of ten strokes of a plate over a pad with inner ridges, each way."""
    parts, right = [], RIDGED["right"]
    sides = [
        over_stroke(partial(plate_trace, offset=offset)) for offset in (ASIDE, -ASIDE)
    ]  # the other way in a mirror
    errors = family_errors(data.histories[right], data.coarse.get(right), sides).columns
    for way, scene in RIDGED.scenes.items():
        rate = plate_rate(data.histories[scene])
        ticks = raster(rate, STROKES_SHOWN["5-27"], SEED).rename(columns={"trial": TRIAL})[
            [TRIAL, DISTANCE]
        ]
        for panel, rows in ((RASTER, ticks), ("rate", rate[[DISTANCE, IMPULSE_RATE]])):
            of = {
                "source": PREDICTED,
                "series": way,
                "panel": panel,
                RECEPTOR: round(DEEP * 1e6),
                **errors,
            }
            parts.append(rows.assign(**of))
    return pd.concat(parts, ignore_index=True)


def plate_trace(stroke: xr.Dataset, offset: float) -> np.ndarray:
    """Predicted rate at every output, after a kink between legs where there is one."""
    return (
        predicted_rate(stroke, DEEP, offset=offset)
        .drop_duplicates(TIME, keep="last")[IMPULSE_RATE]
        .to_numpy()
    )


def burst_rows(data: Data, runs: Runs, columns: Mapping[Q, str]) -> pd.DataFrame:
    """Burst of each convexity at some velocities, and a user's recorded ones, for none is
    public.
    """
    own = data.convexities(runs, columns)
    own.insert(1, SPEED, own["series"].str.removesuffix(" mm/s").astype(float))
    own.insert(1, "panel", own["series"])
    own.insert(0, "source", PREDICTED)
    if (rates := data.measured) is None:
        return own
    names = rates["speed_mm_per_s"].map("{:g} mm/s".format)
    rows = rates[
        (rates["window"] == "burst") & (rates["receptor"] == "SA-I") & names.isin(list(runs))
    ]
    found = {
        BURST_RATE: rows["rate_per_s"],
        BURST_WIDTH: rows["burst_width_mm"],
        BURST_TIME: rows["burst_width_mm"] / rows["speed_mm_per_s"],
    }
    part = {
        "source": "measured (" + rows["recording"] + ")",
        "series": names[rows.index],
        "panel": names[rows.index],
    }
    part |= {SPEED: rows["speed_mm_per_s"], CURVATURE: rows["curvature_per_m"]} | {
        c: found[c] for c in columns
    }
    return below(own, pd.DataFrame(part))


def stroked_and_pressed(data: Data) -> pd.DataFrame:
    """Predicted rates against curvature: mean of the burst when stroked, peak and steady state when
    pressed.
    """
    parts = [
        data.numbers(WITHIN, {IMPULSE_RATE: reading("rate", at)}, own=True).assign(
            source=PREDICTED, series=series
        )
        for at, series in RESPONSES.items()
    ]
    pressed = pd.concat(parts).sort_index(kind="stable")
    burst = (
        burst_rows(data, TEN_RUN, BURST_RATES)
        .rename(columns={BURST_RATE: IMPULSE_RATE})
        .assign(series=STROKED)
    )
    columns = ["source", "series", CURVATURE, IMPULSE_RATE, *PARTS]
    return pd.concat([pressed[columns], burst[columns]], ignore_index=True)


def by_pressure(data: Data) -> pd.DataFrame:
    """Strain energy at 915 um, simulated and by Eq 4-4: constants of the ramps, shift constant or
    the skin's.
    """
    law, shift = stroke_law(data.histories)
    parts = [data.surface(TEN_RUN[TEN], 0, 80)]
    for series, history, coarse in data.runs(SPEEDS):
        stroke = loaded(history)
        sample = skin_sample(stroke, DEEP)
        shared = {"series": series, DISTANCE: distance(stroke) * 1e3, RECEPTOR: DEEP * 1e6}
        errors = curve_errors(history, coarse, over_stroke(energy_at(DEEP)))
        parts.append(
            pd.DataFrame({"source": SIMULATED} | shared | {SED: sample.energy} | errors.columns)
        )
        shifts = {"constant shift": shift, "shift of the skin": skin_shift(stroke)}
        for how, source in BY_PRESSURE.items():
            parts.append(
                pd.DataFrame({"source": source} | shared | {SED: sample.by(law, shifts[how])})
            )
    return pd.concat(parts, ignore_index=True)


def over_time(data: Data, columns: Sequence[Q]) -> pd.DataFrame:
    """Columns of `predicted_rate` over time while the surface slides, 10 mm/s."""
    return data.traces(TEN_RUN, (STROKE_TIME, *map(of_rate, columns)))


def energy_and_histogram(data: Data) -> pd.DataFrame:
    """Strain energy and its rate at 915 um over time, 10 mm/s, and the histogram of 12 predicted
    strokes.
    """
    ((_, history, coarse),) = data.runs(TEN_RUN)
    repetitions = STROKES_SHOWN["5-19"]
    rate, impulses = impulses_of(history, repetitions)
    bars = stroke_histogram(rate, impulses, repetitions)
    times = np.interp(bars[DISTANCE], rate[DISTANCE], rate[TIME] - rate[TIME].iloc[0])
    part = {
        "source": PREDICTED,
        "series": TEN,
        "panel": HISTOGRAM,
        TIME: times,
        IMPULSE_RATE: bars[IMPULSE_RATE],
    }
    bars = pd.DataFrame(part | rate_errors(history, coarse).columns)
    return pd.concat([over_time(data, (SED, RATE)), bars], ignore_index=True)


def pressed_rates(data: Data) -> pd.DataFrame:
    """Rate by Eq 5-1 over time for eight cylinders pressed at 40 gf/s and held."""
    parts = []
    for label, history, coarse in data.runs(EIGHT):
        errors = curve_errors(
            history, coarse, Curve(lambda d: predicted_rate(d)[[TIME, IMPULSE_RATE]].to_numpy().T)
        )
        part = {
            "source": PREDICTED,
            "surface": label,
            **predicted_rate(history)[[TIME, IMPULSE_RATE, STATIC]],
        }
        parts.append(pd.DataFrame(part | errors.columns))
    return pd.concat(parts, ignore_index=True)


# --- pictures --------------------------------------------------------------------------------------------


def draw_raster(ax: Axes, frame: pd.DataFrame, count: int) -> None:
    """One row of ticks a stroke, the first one above."""
    rows = frame[(frame["panel"] == RASTER) & is_simulated(frame)]
    trains = [rows.loc[rows[TRIAL] == trial, DISTANCE].to_numpy() for trial in range(1, count + 1)]
    ax.eventplot(
        trains,
        lineoffsets=range(1, count + 1),
        linelengths=0.7,
        linewidths=0.8,
        colors=[style.INK],
        clip_on=False,
    )
    ax.set(
        ylim=(count + 0.6, 0.4),
        yticks=[1, count] if count > 5 else range(1, count + 1),
        ylabel="predicted stroke",
    )
    ax.tick_params(left=False)


def draw_bars(ax: Axes, frame: pd.DataFrame, x: Q, width: float) -> None:
    rows = frame[frame["panel"] == HISTOGRAM]
    ax.bar(rows[x], rows[IMPULSE_RATE], width, color=style.INK, lw=0)


def ticks_below_surface(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Predicted rasters below the surface, and their histogram if the spec has one (y)."""
    panels = axs.below_surface(fig, frame, 1 + len(spec.y))
    draw_raster(panels[0], frame, STROKES_SHOWN[spec.number])
    if spec.y:
        draw_bars(panels[1], frame, DISTANCE, 0.5)
        panels[1].set_ylabel(RATE_WORDS)
    axs.limit_axis(panels[-1], frame, DISTANCE, "x")
    panels[-1].set_xlabel(DISTANCE.label)


def plate_both_ways(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Ten predicted rasters each way, and their rate below."""
    (*ticks,), (*rates,) = fig.subplots(2, 2, sharex=True, sharey="row", height_ratios=[1.6, 1])
    for way, top, bottom in zip(WAYS, ticks, rates, strict=True):
        rows = frame[frame["series"] == way]
        draw_raster(top, rows, STROKES_SHOWN["5-27"])
        rate = rows[rows["panel"] == "rate"]
        axs.curve(bottom, rate, DISTANCE, IMPULSE_RATE, color=style.INK, lw=1.2)
        if not (rows["panel"] == RASTER).any():
            top.text(
                0.5,
                0.5,
                "no impulse predicted",
                transform=top.transAxes,
                ha="center",
                color=style.GREY,
            )
        top.set_title(WAYS[way])
        bottom.set(xlabel="stroke distance (mm)", xlim=(0, 50))
    rates[0].set_ylim(0, None)
    ticks[1].set_ylabel("")
    rates[0].set_ylabel(RATE_WORDS)


def plate_note(frame: pd.DataFrame) -> list[str]:
    """The errors of either way: relative to next to no response one tells little."""
    error = f"{axs.error_text(frame)}. " if axs.error_text(frame) else ""
    return [
        f"Predicted by Eq 5-1, not measured. {error}Receptor 46 µm right of a ridge's tip, 915 µm "
        "deep."
    ]


def against_velocity(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """A line a convexity, named at its end."""
    own, ends = frame[frame["source"] == PREDICTED], {}
    shades = {label: style.curvature_colour(float(label)) for label in own["convexity"].unique()}
    for label, rows in own.groupby("convexity", sort=False):
        axs.curve(
            ax, rows, SPEED, spec.y[0], points=True, marker="o", ms=3, color=shades[label], lw=1.0
        )
        ends[label] = rows[spec.y[0]].iloc[-1]
    points = frame[frame["source"].str.startswith("measured")]
    ax.plot(points[SPEED], points[spec.y[0]], "x", color=style.INK, ms=4)
    low, high = ax.get_ylim()
    gap = 0.062 * (high - low)
    places = style.spread(list(ends.values()), gap, low + gap / 2, high - 2 * gap)
    for label, place in zip(ends, places, strict=True):
        ax.plot([40.4, 42.3], [ends[label], place], color=shades[label], lw=0.7, clip_on=False)
        ax.text(42.5, place, label, va="center", fontsize=6.5)
    ax.text(42.5, max(places) + 1.2 * gap, "curvature\n(1/m)", va="bottom", fontsize=6.5)


def rates_from_zero(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """Most of the predicted rates are below the 10 that the thesis's axis begins with."""
    panels[CURVATURE, BURST_RATE].set_ylim(0, None)


def three_laws(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    ax = panels[TEN]
    style.header_legend(ax.figure, ax.lines)


def room_for_brackets(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    axs.leave_room_for_brackets(next(iter(panels.values())).figure)


def say_plateaus(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """Between bursts the frequency is that of one long interval."""
    room_for_brackets(panels, frame)
    first = next(iter(panels.values()))
    text = (
        "level stretches: one interval from burst to burst; brackets: thesis's axis (?: "
        "reading uncertain)"
    )
    first.text(
        0.99,
        0.97,
        text,
        transform=first.transAxes,
        ha="right",
        va="top",
        fontsize=6.5,
        color=style.GREY,
    )


def aligned(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    room_for_brackets(panels, frame)
    panels[TIME, SED].figure.align_ylabels()


CUT = {
    SED: (150, "strain energy density,\ncut at 150 (Pa)"),
    RATE: (0, "positive rate of\nstrain energy (Pa/s)"),
}


def energy_rate_or_bars(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """Energy cut at its threshold, positive rate, predicted histogram."""
    rows, y, words = frame[frame["source"] == SIMULATED], spec.y[0], RATE_WORDS
    if y == IMPULSE_RATE:
        draw_bars(ax, frame, TIME, 0.05)
    else:
        least, words = CUT[y]
        axs.curve(
            ax, rows.assign(**{y: rows[y].clip(lower=least)}), TIME, y, whole=rows, color=style.INK
        )
    ax.set_ylabel(words)


def draw_rate(ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
    """Predicted rate (line) and the part of it that comes from strain energy (area)."""
    rows = rows[rows["source"] == PREDICTED]
    axs.curve(ax, rows, TIME, IMPULSE_RATE, color=style.INK, lw=1.2, label="predicted by Eq 5-1")
    ax.fill_between(
        rows[TIME], rows[STATIC], color="#9fc3d6", lw=0, label="of this from strain energy alone"
    )


def legend_of_the_first(panels: Mapping[object, Axes], frame: pd.DataFrame) -> None:
    """With the brackets that stand at some panels."""
    first = next(iter(panels.values()))
    bracket = style.handle(
        "thesis's axis (?: reading uncertain)",
        color=style.GREY,
        lw=0.7,
        ls=style.DASHED,
        marker="|",
        ms=4,
    )
    first.legend(handles=[*first.get_legend_handles_labels()[0], bracket], loc="upper right")


SCALED = (
    "Energies are scaled as in Figs 4-27 and 4-29: to their mean at 915 µm over the nine surfaces."
)
RECORDED = {"color": style.HIGHLIGHT}
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
        Own(height=4.2, paint=ticks_below_surface),
        rows=partial(rasters, number="5-1", low=0.0, high=70.0),
        how=HOW,
        remarks=(
            equation(),
            "The recorded stroke ended before the convexity of 315 1/m; bins of 0.5 mm.",
        ),
    ),
    Figure(
        "5-2",
        "Predicted burst width and burst rate, 10 mm/s",
        TEN_RUN,
        CURVATURE,
        tuple(BURSTS),
        {CURVATURE: "T222", BURST_WIDTH: "T220", BURST_RATE: "T221"},
        Panels(
            height=3.0,
            pairs=tuple((CURVATURE, y) for y in BURSTS),
            shape=(1, 2),
            fill=Lines(by="series", looks={TEN: OWN_BURSTS}, recorded=RECORDED, bars=True),
        ),
        rows=partial(burst_rows, runs=TEN_RUN, columns=BURSTS),
        measured="impulse_rates",
        joined="series",
        extra=rates_from_zero,
        remarks=(equation(), BURST, "In the thesis (b) begins at 10 impulses/s."),
    ),
    Figure(
        "5-3",
        "Predicted burst width and burst rate at five velocities",
        SPEEDS,
        SPEED,
        tuple(BURSTS),
        {SPEED: "T225", BURST_WIDTH: "T223", BURST_RATE: "T224"},
        Panels(
            height=3.4, pairs=tuple((SPEED, y) for y in BURSTS), shape=(1, 2), fill=against_velocity
        ),
        rows=partial(burst_rows, runs=SPEEDS, columns=BURSTS),
        measured="impulse_rates",
        joined="convexity",
        remarks=(equation(), BURST),
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
            header=0.16,
            fill=Lines(
                by="source",
                names={
                    source: source.removeprefix(f"{SIMULATED}: ") for source in BY_PRESSURE.values()
                },
                looks={
                    SIMULATED: {"color": style.INK, "ls": "-", "lw": 1.2},
                    BY_PRESSURE["constant shift"]: OTHER,
                    BY_PRESSURE["shift of the skin"]: {
                        "color": style.GREY,
                        "ls": style.DOTTED,
                        "lw": 1.1,
                    },
                },
            ),
        ),
        rows=by_pressure,
        surface=(0, 80),
        extra=three_laws,
        remarks=(
            "The error is that of the simulated energy. Eq 4-4 has the constants that fit the "
            "nine pressed surfaces;",
            "its constant shift is the one that fits the stroke at 10 mm/s.",
        ),
    ),
    Figure(
        "5-16",
        "Predicted burst duration at four velocities",
        FOUR,
        CURVATURE,
        (BURST_TIME,),
        {CURVATURE: "T273", BURST_TIME: {series: f"T{269 + k}" for k, series in enumerate(FOUR)}},
        Panels(
            height=4.2,
            by="panel",
            names=tuple(FOUR),
            shape=(2, 2),
            each=True,
            fill=Lines(
                by="series", looks=dict.fromkeys(FOUR, OWN_BURSTS), recorded=RECORDED, bars=True
            ),
            titles=lambda series: f"v = {series}",
        ),
        key="panel",
        rows=partial(burst_rows, runs=FOUR, columns={BURST_TIME: "burst_time"}),
        measured="impulse_rates",
        joined="series",
        remarks=(BURST.split(";")[0] + " 915 µm under the centre. Predicted, nothing recorded.",),
    ),
    Figure(
        "5-17",
        "Predicted impulse rate, stroked and pressed",
        (WITHIN, TEN_RUN),
        CURVATURE,
        (IMPULSE_RATE,),
        {CURVATURE: "T275", IMPULSE_RATE: "T274"},
        Panels(
            height=3.2,
            legend={"loc": "upper left", "handlelength": 3},
            fill=Lines(
                by="series",
                recorded=RECORDED | {"label": "recorded, stroked"},
                bars=True,
                looks={
                    STROKED: {"ls": "-", "marker": "s", "ms": 3.5, "color": style.HIGHLIGHT},
                    RESPONSES["peak"]: PRESSED | {"ls": style.DASHED},
                    RESPONSES["end"]: PRESSED | {"ls": style.DOTTED, "mfc": "white"},
                },
                names={series: f"predicted, {series}" for series in (STROKED, *RESPONSES.values())},
            ),
        ),
        rows=stroked_and_pressed,
        width=style.COLUMN_WIDTH,
        measured="impulse_rates",
        joined="series",
        remarks=(equation(), "Stroked: " + BURST[0].lower() + BURST[1:]),
    ),
    Figure(
        "5-19",
        "Strain energy, its rate, and predicted impulses of 12 strokes at 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (SED, RATE, IMPULSE_RATE),
        {TIME: "T281", SED: "T278", RATE: "T279", IMPULSE_RATE: "T280"},
        Panels(
            height=4.8,
            pairs=tuple((TIME, y) for y in (SED, RATE, IMPULSE_RATE)),
            shape=(3, 1),
            fill=energy_rate_or_bars,
            marked=RATE,
            share={"sharex": True},
        ),
        rows=energy_and_histogram,
        how=HOW,
        remarks=(equation(),),
        extra=aligned,
    ),
    Figure(
        "5-20",
        "Predicted impulse rate of a stroke at 10 mm/s",
        TEN_RUN,
        STROKE_TIME,
        (IMPULSE_RATE,),
        {TIME: "T288", IMPULSE_RATE: "T287"},
        Panels(height=3.0, fill=draw_rate, legend={"loc": "upper left"}),
        rows=lambda data: over_time(data, (IMPULSE_RATE, STATIC)).assign(source=PREDICTED),
        how=HOW,
        remarks=(equation(),),
    ),
    Figure(
        "5-21",
        "Predicted impulse rate of eight ramps and holds",
        EIGHT,
        TIME,
        (IMPULSE_RATE,),
        {TIME: "T297", IMPULSE_RATE: {label: f"T{289 + k}" for k, label in enumerate(EIGHT)}},
        Panels(
            height=6.0,
            by="surface",
            names=CYLINDERS,
            shape=(4, 2),
            fill=draw_rate,
            each=True,
            marked="none",
            titles=axs.surface_name,
            ylabel=RATE_WORDS,
            share={"sharex": True},
        ),
        rows=pressed_rates,
        how="largest rate",
        remarks=(equation(),),
        extra=legend_of_the_first,
    ),
    Figure(
        "5-22",
        "Predicted impulses of four strokes at 10 mm/s, receptor 560 µm deep",
        (TEN_RUN, NINE.without_companions()),
        DISTANCE,
        (),
        {DISTANCE: "T300"},
        Own(height=2.6, paint=ticks_below_surface),
        how=HOW,
        remarks=(equation(SHALLOW), SCALED),
        rows=partial(rasters, number="5-22", low=40.0, high=80.0, depth=SHALLOW),
    ),
    Figure(
        "5-23",
        "Predicted instantaneous frequency of a receptor 560 µm deep, mean of 12 strokes",
        (SPEEDS, NINE.without_companions()),
        DISTANCE,
        (FREQUENCY,),
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
            ylabel="predicted frequency\n(impulses/s)",
        ),
        key="panel",
        rows=frequencies,
        surface=(40, 80),
        remarks=(equation(SHALLOW), SCALED),
        extra=say_plateaus,
    ),
    Figure(
        "5-27",
        "Predicted impulses of a flat plate stroked both ways at 10 mm/s, inner ridges",
        RIDGED,
        DISTANCE,
        (IMPULSE_RATE,),
        {},
        Own(height=3.6, paint=plate_both_ways),
        rows=both_ways,
        note=plate_note,
    ),
)

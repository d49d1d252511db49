"""Chapter 5: bursts of the impulses that strokes evoke, predicted where the thesis shows
recordings, which are not public.

A burst is what `fingerpad.measures.bursts.burst` says it is, of predicted trains as of recorded
ones. The trains are 12 repetitions of a seeded integrate-and-fire receptor (`fingerpad.receptors.
spikes`) at the rate by Eq 5-1. What a user puts into ``config/reference/recordings`` is laid over.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import partial

from matplotlib.axes import Axes
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures.chapter5 import DEEP, PREDICTED, TEN, TEN_RUN
from cysyk1999.figures.grammar import Data, Figure, Lines, Panels, stacked
from cysyk1999.measures.errors import PARTS, Companion, curve_errors, over_stroke
from cysyk1999.measures.quantities import (
    BURST_RATE,
    BURST_STROKES,
    BURST_TIME,
    BURST_WIDTH,
    CURVATURE,
    IMPULSE_RATE,
    LENGTH,
    RADIUS,
    SPEED,
    TIME_ABOVE,
    Q,
)
from cysyk1999.measures.responses import STROKES, predicted_rate
from cysyk1999.measures.runs import NINE, SPEEDS, WITHIN_350, Runs
from cysyk1999.measures.table import MEASURES, reading
from cysyk1999.publishing import style
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate

FOUR = SPEEDS.only(("5 mm/s", "10 mm/s", "20 mm/s", "40 mm/s"))
WITHIN = NINE.only(WITHIN_350)
RATES = {
    "stroked at 10 mm/s, peak": "convexity_rate",
    "stroked at 10 mm/s, mean of the burst": "burst_rate",
    "ramp and hold, peak": "peak",
    "ramp and hold, steady state": "end",
}
"""What Fig 5-17 compares, a peak beside a peak and a mean beside a mean -> measure, or condition of
the measure of pressed surfaces.
"""


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


# --- rows -----------------------------------------------------------------------------------------


@stacked
def burst_rows(data: Data, runs: Runs, columns: Mapping[Q, str]) -> Iterator[DataFrame | Mapping]:
    """Burst of each convexity at some velocities: columns and their measures, how many strokes have
    one, and the errors of the rate that the impulses are made from; and a user's recorded ones.
    """
    measures = {q: MEASURES[name] for q, name in columns.items()}
    own = data.numbers(runs, measures | {BURST_STROKES: MEASURES["burst_strokes"]})
    for series, history, coarse in data.runs(runs):
        of = {"source": PREDICTED, "panel": series, SPEED: float(series.removesuffix(" mm/s"))}
        yield own[own["series"] == series].assign(**of, **rate_errors(history, coarse))
    if (rates := data.measured) is None:
        return
    rows = rates.query("window == 'burst' and receptor == 'SA-I'")
    series = rows["speed_mm_per_s"].map("{:g} mm/s".format)
    width, speed = rows["burst_width_mm"], rows["speed_mm_per_s"]
    of = {"source": "measured (" + rows["recording"] + ")", "panel": series, "series": series}
    of |= {SPEED: speed, CURVATURE: rows["curvature_per_m"]}
    found = {BURST_RATE: rows["rate_per_s"], BURST_WIDTH: width, BURST_TIME: width / speed}
    recorded = DataFrame(of | {q: found[q] for q in columns if q in found})
    yield recorded[series.isin(list(runs))]


@stacked
def lengths(data: Data) -> Iterator[DataFrame]:
    """Stroke distance over which the centre node touches each convexity, at every velocity, and
    widths of bursts.
    """
    touched = data.numbers(SPEEDS, {LENGTH: MEASURES["contact_length"]}, own=True)
    for rows in (touched, burst_rows(data, FOUR, {BURST_WIDTH: "burst_width"})):
        yield rows.assign(**{RADIUS: 1e3 / rows[CURVATURE]})


@stacked
def durations(data: Data) -> Iterator[DataFrame]:
    """How long the strain energy is above its threshold while each convexity passes, and its
    bursts, at four velocities.
    """
    above = data.numbers(FOUR, {TIME_ABOVE: MEASURES["energy_time"]}, own=True)
    yield above.assign(panel=above["series"])
    yield burst_rows(data, FOUR, {BURST_TIME: "burst_time"})


@stacked
def stroked_and_pressed(data: Data) -> Iterator[DataFrame]:
    """Predicted rates against curvature, stroked and pressed: peaks and means."""
    columns = ["source", "series", CURVATURE, IMPULSE_RATE, *PARTS]
    for series, name in RATES.items():
        if name in MEASURES:
            rows = burst_rows(data, TEN_RUN, {BURST_RATE: name})
            rows = rows.rename(columns={BURST_RATE: IMPULSE_RATE})
            if name != "burst_rate":  # what is recorded are means of bursts
                rows = rows[rows["source"] == PREDICTED]
        else:
            rows = data.numbers(WITHIN, {IMPULSE_RATE: reading("rate", name)}, own=True)
            rows["source"] = PREDICTED
        yield rows.assign(series=series)[columns]


# --- pictures -------------------------------------------------------------------------------------


def widths_over_lengths(ax: Axes, frame: DataFrame, spec: Figure) -> None:
    """Length in contact: its range over the velocities, and one of them; widths of bursts at four
    velocities.
    """
    rows, (length, width) = axs.simulated(frame), spec.y
    touched = rows.dropna(subset=[length])
    extent = touched.groupby(spec.x)[length].agg(["min", "max"])
    apart = 100 * ((extent["max"] - extent["min"]) / extent.mean(axis=1)).max()
    words = f"length in contact, 1 to 40 mm/s:\nat most {apart:.0f} % apart"
    ax.fill_between(extent.index, *extent.to_numpy().T, color="#9fc3d6", lw=0, label=words)
    line = touched[touched["series"] == TEN].sort_values(spec.x)
    look = {"color": style.INK, "lw": 0.8, "label": f"length in contact, {TEN}"}
    axs.curve(ax, line, spec.x, length, points=True, **look)
    for (series, look), marker in zip(((v, axs.look(v)) for v in FOUR), "v^sD", strict=True):
        own = rows[rows["series"] == series]
        dots = {"ls": "none", "ms": 3, "mfc": "white", "mew": 0.8, "color": look["color"]}
        ax.plot(own[spec.x], own[width], marker, label=f"predicted burst, {series}", **dots)
    measured = axs.from_source(frame, "measured")
    if len(measured):
        ax.plot(measured[spec.x], measured[width], "x", color=style.MEASURED, label="recorded")


def against_velocity(ax: Axes, frame: DataFrame, spec: Figure) -> None:
    """A line a convexity, named at its end."""
    (y,), own, ends = spec.y, frame[frame["source"] == PREDICTED].dropna(subset=[spec.y[0]]), {}
    for label, rows in own.groupby("convexity", sort=False):
        look = style.look_of("curvature (1/m)", label) | {"marker": "o", "ms": 3, "lw": 1.0}
        axs.curve(ax, rows, SPEED, y, points=True, **look)
        ends[label] = tuple(rows[[SPEED, y]].iloc[-1])
    measured = axs.from_source(frame, "measured")
    ax.plot(measured[SPEED], measured[y], "x", color=style.INK, ms=4)
    style.label_ends(ax, ends, 42.3, "curvature (1/m)")


def all_rates(panels: Mapping[object, Axes], frame: DataFrame) -> None:
    """An axis from 0 where rates are below that of the thesis, and what the rates rest on."""
    ax, rows = panels[CURVATURE, BURST_RATE], frame[frame["source"] == PREDICTED]
    if rows[BURST_RATE].min() < ax.get_ylim()[0]:
        ax.set_ylim(0, None)
    few = rows[rows[BURST_STROKES] < STROKES]
    names = ", ".join(
        f"{label} ({count:.0f})"
        for label, count in zip(few["convexity"], few[BURST_STROKES], strict=True)
    )
    words = f"fewer than {STROKES} strokes have a burst at\n{names} 1/m" if names else ""
    axs.remark(ax, 0.02, 0.98, words, va="top", **axs.NOTE)


def durations_note(frame: DataFrame) -> list[str]:
    """What the line and the circles are, and their errors."""
    errors = axs.error_text(frame, [("series", q) for q in DURATIONS])
    words = "Line: simulated, not measured", "Circles: predicted by Eq 5-1, not measured", errors
    return [" ".join(f"{part}." for part in words if part)]


BURSTS = {BURST_WIDTH: "burst_width", BURST_RATE: "burst_rate"}
LENGTHS = LENGTH.reading(None, "length in contact,\nburst width (mm)"), BURST_WIDTH
DURATIONS = BURST_TIME, TIME_ABOVE
DOTS = {"marker": "o", "ms": 3.5, "color": style.INK, "clip_on": False, "zorder": 3}
OWN_BURSTS = DOTS | {"lw": 0.8, "ls": "-"}
PEAK = DOTS | {"ls": "-", "lw": 1.1}
STROKED = PEAK | {"marker": "s", "color": style.HIGHLIGHT}
MEAN = {"ls": style.DOTTED, "mfc": "white"}
FIGURES = (
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
            extra=all_rates,
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
        "5-4",
        "Length of each convexity in contact with the centre node, and predicted burst widths",
        SPEEDS,
        CURVATURE,
        LENGTHS,
        {CURVATURE: "T229", RADIUS: "T230", LENGTH: "T228"},
        Panels(
            3.2,
            names=((CURVATURE, *LENGTHS), (RADIUS, *LENGTHS)),
            across=2,
            fill=widths_over_lengths,
            legend={"loc": "upper left"},
        ),
        rows=lengths,
        measured="impulse_rates",
    ),
    Figure(
        "5-16",
        "Burst duration at four velocities, predicted from strain energy 915 µm deep above 150 Pa",
        FOUR,
        CURVATURE,
        DURATIONS,
        {CURVATURE: "T273", BURST_TIME: {series: f"T{269 + k}" for k, series in enumerate(FOUR)}},
        Panels(
            4.2,
            by="panel",
            names=FOUR,
            across=2,
            fill=Lines(
                looks={
                    BURST_TIME: DOTS | {"ls": "none", "mfc": "white"},
                    TIME_ABOVE: {"color": style.INK, "ls": "-", "lw": 1.1},
                },
                names={
                    TIME_ABOVE: "time of strain energy above 150 Pa",
                    BURST_TIME: f"bursts of {STROKES} predicted strokes, width by velocity",
                },
            ),
            title=lambda ax, series: ax.set_title(f"v = {series}"),
            legend={"loc": "upper right"},
        ),
        rows=durations,
        note=durations_note,
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
            3.5,
            legend={"loc": "lower left", "bbox_to_anchor": (-0.02, 1.0), "handlelength": 3},
            fill=Lines(
                by="series",
                looks=dict(zip(RATES, (STROKED, STROKED | MEAN, PEAK, PEAK | MEAN), strict=True)),
                names={"recorded": "recorded, mean of the burst"},
            ),
        ),
        rows=stroked_and_pressed,
        width=style.COLUMN_WIDTH,
        measured="impulse_rates",
        joined="series",
    ),
)

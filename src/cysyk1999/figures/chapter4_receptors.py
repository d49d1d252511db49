"""Chapter 4, from skin to impulses: the laws of pressure and strain energy, and predicted rates of
slowly adapting receptors.

The recordings that the thesis shows beside its model are not public. Its figures of recordings
alone (4-2 to 4-5) are made from predicted rates (Eq 5-1 with the thesis's constants) and say so in
the picture; in those of comparisons (4-9, 4-18 to 4-29) the predicted rates stand where the
recorded ones did, with what can be read of those in the thesis, and with published rates and
another model's in panels of their own. A user's recordings under the same protocol are laid over
(config/reference/recordings).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from pandas import DataFrame
from xarray import Dataset

from cysyk1999.figures import axes as axs
from cysyk1999.figures.chapter4 import HOLD, K210, WIDTH_IDS, by_surface
from cysyk1999.figures.grammar import Data, Figure, Page, Panels, nine, stacked
from cysyk1999.measures.errors import PARTS, Curve, curve_errors, over_time, shared_place
from cysyk1999.measures.quantities import (
    CURVATURE,
    DOUBT,
    ENERGY_FACTOR,
    FORCE,
    FREQUENCY,
    GIVEN_RATE,
    IMPULSE,
    IMPULSE_RATE,
    INVERSE_WIDTH,
    MEAN_P,
    NODE,
    P_LAW,
    P_PEAK,
    RATE,
    SED,
    SED_LAW,
    SED_SQUARE,
    STEADY_RATE,
    TIME,
    P,
)
from cysyk1999.measures.responses import (
    NODE_COUNT,
    RECEPTOR_DEPTH,
    SEED,
    SHALLOW_DEPTH,
    TRIALS,
    contact_nodes,
    energy_from_pressure,
    fit_nodes,
    law_at,
    laws_of_sum,
    mean_frequency,
    mean_pressure,
    node_places,
    peak_energy_rate,
    predicted_rate,
    pressure_by_law,
    raster,
    rate_in,
    straight_line,
)
from cysyk1999.measures.runs import FAST, LOWER, NINE, SPHERES, Runs
from cysyk1999.measures.table import reading
from cysyk1999.publishing import style
from cysyk1999.receptors.fits import gain_and_threshold, r_squared
from fingerpad.measures.features import (
    SIMULATED,
    SURFACES,
    energy,
    is_simulated,
    pressure_at,
    ramp_end,
)
from fingerpad.planning.errors import PROFILE_ORDER
from fingerpad.receptors.laws import rectified

AVERAGED = 100
"""Trials that the frequency of Fig 4-3 is the mean of."""
OFTEN = 8
"""Impulses/s from which on a train has enough of them in Fig 4-3 that their mean frequency is not
biased.
"""
TRAIN_PANELS = "force", "impulses", "mean rate of the hold"
PRINTED = ("T083", "T084", "T085", "T086", "T087")
"""Mean rates of the hold that can be read beside the rasters of Fig 4-2."""

RATES = "impulse_rates"
SPREAD = "standard deviation (impulses/s)"
"""Column of what is recorded: over repetitions, where it is given."""
GOODWIN = "Goodwin 1995, first second", "monkey, spheres; ours: {}"
HALF_SPACE = "half-space; ours: {}"
PEAK_RATE = GIVEN_RATE.reading(None, "peak rate (impulses/s)")
LOWER_RIGHT = {"loc": "lower right", "handlelength": 1.4}
FITTED = "linear in the pressure, fitted"
OF_THE_LARGEST = "of the largest"
OVER_NODES = "thesis range, widths as its nodes tell them"
"""How the source of a row begins that holds where a range begins with what nodes hide."""
PEAK, STEADY, HELD = (reading("rate", window) for window in ("peak", "steady", "hold"))

# --- rows -----------------------------------------------------------------------------------------


def line_through(rows: DataFrame, x: str, y: str) -> DataFrame:
    """Two rows: the ends of the line through points, from 0 to the last of them, where it is not
    negative.
    """
    slope, offset, share = straight_line(rows[x], rows[y])
    start = max(0.0, -offset / slope) if slope > 0 else 0.0
    ends = np.array([start, rows[x].max()])
    source = f"{SIMULATED}: least-squares line, R2 {share:.3f}"
    return DataFrame({"source": source, x: ends, y: slope * ends + offset})


def given(data: Data, window: str, ramp: float, column: str = GIVEN_RATE) -> DataFrame:
    """Rates recorded under the protocol of a figure: those printed in the thesis, and a user's."""
    if data.measured is None:
        return DataFrame()
    same = data.measured.query(
        "receptor == 'SA-I' and species != 'model' and stimulus in ('flat plate', 'cylinder')"
        " and abs(force_gf - 20) < 0.5 and ramp_gf_per_s == @ramp and window == @window"
    )
    printed = {data.reference.loc[k, "low"]: k for k in PRINTED if k in data.reference.index}
    of_thesis = same["source"].str.startswith("Cysyk 1999")
    same = same[~of_thesis | same["rate_per_s"].isin(printed)]
    rows = DataFrame(
        {
            "source": [
                f"stated in the thesis ({printed[row.rate_per_s]}, reading uncertain)"
                if row.source.startswith("Cysyk 1999")
                else f"measured ({row.recording}; {row.source})"
                for row in same.itertuples()
            ],
            CURVATURE: same["curvature_per_m"].to_numpy(),
            DOUBT: same["or_curvature_per_m"].to_numpy(),
            column: same["rate_per_s"].to_numpy(),
            SPREAD: same["sd_per_s"].to_numpy(),
        }
    )
    return rows if rows[SPREAD].notna().any() else rows.drop(columns=SPREAD)


def published(
    data: Data, panel: str, window: str, model: bool, force: float | None = None
) -> DataFrame:
    """Published rates, or another model's, of pressed surfaces in a window, one series a
    recording.
    """
    if (rates := data.measured) is None:
        return DataFrame()
    rows = rates.query(
        "receptor == 'SA-I' and window == @window and (species == 'model') == @model"
    )
    if not model:
        of_spheres = rates.loc[rates["stimulus"] == "sphere", "recording"]
        pressed = rows["stimulus"].isin(("sphere", "flat plate"))
        rows = rows[pressed & rows["recording"].isin(of_spheres)]
    if force:
        rows = rows[rows["force_gf"] == force]
    source = ("other model (" if model else "measured (") + rows["source"] + ")"
    of = {"source": source, "panel": panel, "series": rows["recording"]}
    return DataFrame(of | {CURVATURE: rows["curvature_per_m"], GIVEN_RATE: rows["rate_per_s"]})


@stacked
def trains_and_rates(data: Data) -> Iterator[DataFrame | Mapping]:
    """Predicted impulses of four trials a surface at 150 gf/s, the force, the mean predicted rate
    in the hold, printed ones.
    """
    numbers = data.numbers(FAST, {GIVEN_RATE: HELD})
    plate = data.histories[FAST["flat"]]
    yield numbers.assign(panel=TRAIN_PANELS[2])
    force = {q: q.read(plate) for q in (TIME, FORCE)}
    yield {"source": SIMULATED, "panel": "force"} | force
    errors = numbers.set_index("surface")[list(PARTS)]
    for k, (label, history, _) in enumerate(data.runs(FAST)):
        impulses = raster(predicted_rate(history), TRIALS, SEED + k)
        series = [f"trial {n}" for n in impulses["trial"]]
        of = {"source": SIMULATED, "panel": "impulses", "surface": label, "series": series}
        yield of | {IMPULSE: impulses[TIME], **errors.loc[label]}
    yield given(data, "hold", 150)


@stacked
def frequencies(data: Data) -> Iterator[DataFrame]:
    """Instantaneous frequency of predicted impulses at 40 gf/s, mean of many trials, and the rate
    they were made from.
    """
    at = np.arange(0, 2.0001, 0.02)
    curve = Curve(lambda history: predicted_rate(history)[[TIME, IMPULSE_RATE]].to_numpy().T)
    for k, (label, history, coarse) in enumerate(data.runs(NINE)):
        rate = predicted_rate(history)
        of = {"surface": label} | curve_errors(history, coarse, curve).columns
        frequency = mean_frequency(raster(rate, AVERAGED, SEED + k), AVERAGED, at)
        yield frequency.assign(series="frequency of impulses", **of)
        yield rate[[TIME, IMPULSE_RATE]].assign(series="rate", **of)


@stacked
def peak_and_steady(data: Data, over_curvature: bool) -> Iterator[DataFrame]:
    """Predicted peak rate and rate in the last half of the hold, one row a surface, and recorded
    ones: over curvature, or the steady one over the peak.
    """
    peak, steady = given(data, "peak", 40), given(data, "steady", 40, STEADY_RATE)
    rows = data.numbers(NINE, {GIVEN_RATE: PEAK, STEADY_RATE: STEADY})
    yield rows
    if over_curvature:
        yield line_through(rows, CURVATURE, GIVEN_RATE)
        yield line_through(rows, CURVATURE, STEADY_RATE)
        yield peak
        yield steady
    else:
        yield line_through(rows, GIVEN_RATE, STEADY_RATE)
        if len(peak) and len(steady):
            yield peak.merge(steady, on=["source", CURVATURE, DOUBT])


def widths_in_the_hold(data: Data) -> DataFrame:
    """Inverse contact width in the hold, one row an output and surface."""

    def read(history: Dataset) -> dict[str, np.ndarray]:
        held = history.isel(time=slice(ramp_end(history), None))
        return {q: q.read(held) for q in (TIME, INVERSE_WIDTH)}

    return data.table(NINE, read, Curve(lambda history: tuple(read(history).values())))


def widths_over_nodes(data: Data) -> DataFrame:
    """Where the ranges of Fig 4-9 begin when a width may be as much more as nodes hide of it."""
    ids = {label: id_ for label, id_ in WIDTH_IDS.items() if id_ in data.reference.index}
    if not ids:
        return DataFrame()
    rows = data.reference.loc[list(ids.values())]
    source = [f"{OVER_NODES} ({id_})" for id_ in rows.index]
    least = (rows["low"] * (1 - rows["tolerance"])).to_numpy()
    return DataFrame({"source": source, "surface": list(ids), INVERSE_WIDTH: least})


@stacked
def nodes_by_law(data: Data) -> Iterator[DataFrame]:
    """Pressure of twelve nodes as simulated, and by Eq 4-1 from each node's peak on: one set of
    constants, and a set for each.
    """
    ((_, history, coarse),) = data.runs(K210)
    nodes = contact_nodes(history, NODE_COUNT)
    together = fit_nodes("4-1", nodes)
    for place in node_places(NODE_COUNT):
        x = place * 1e3
        pressed = over_time(partial(pressure_at, place=shared_place(place, coarse)), PROFILE_ORDER)
        of = {NODE: round(x, 5)} | curve_errors(history, coarse, pressed).columns
        trace = {TIME: history["time"].values, P: pressure_at(history, place)}
        yield DataFrame(trace).assign(series="simulated", **of)
        own = nodes[np.isclose(nodes[NODE], x)]
        if own["past_peak"].sum() < 4:
            continue
        for series, constants in (("one set", together), ("a set for each", fit_nodes("4-1", own))):
            law = pressure_by_law("4-1", own, constants)[[TIME, P_LAW]]
            yield law.assign(series=f"Eq 4-1, {series}", **of)


def energy_by_pressure(data: Data) -> DataFrame:
    """Strain energy at 915 um as simulated, and from the contact pressure by Eq 4-4 and by the
    square of its sum, one set of constants for nine surfaces.
    """
    laws = laws_of_sum(data.histories)
    law, square = laws[SED_LAW], laws[SED_SQUARE]
    source = (
        f"{SIMULATED}: Eq 4-4 with r {law.r * 1e3:.3g} mm, A1 {law.per_depth:.3g} 1/m2, "
        f"A2 {law.constant:.3g} 1/m; square with r {square.r * 1e3:.3g} mm, "
        f"{square.square:.3g} 1/(Pa m2)"
    )
    shown = over_time(partial(energy, depth=RECEPTOR_DEPTH))
    read = partial(energy_from_pressure, depth=RECEPTOR_DEPTH, laws=laws)
    return data.table(NINE, read, shown).assign(source=source)


@stacked
def peaks_over_pressure(data: Data) -> Iterator[DataFrame]:
    """Predicted peak rate and largest pressure at any node, one row a surface, and the line through
    them; recorded peak rates.
    """
    rows = data.numbers(NINE, {P_PEAK: reading("highest_pressure", "highest"), GIVEN_RATE: PEAK})
    yield rows
    yield line_through(rows, P_PEAK, GIVEN_RATE)
    recorded = given(data, "peak", 40)
    if len(recorded):
        pressure = np.interp(recorded[CURVATURE], rows[CURVATURE], rows[P_PEAK])
        yield recorded.assign(**{P_PEAK: pressure})


@stacked
def linear_in_pressure(data: Data) -> Iterator[DataFrame]:
    """Rates as linear functions of the mean centre pressure: closest to Eq 5-1's in the hold, and
    to Goodwin's first second.
    """
    rows = data.numbers(NINE, {GIVEN_RATE: HELD, MEAN_P: mean_pressure})
    yield rows.assign(source=f"{SIMULATED}: Eq 5-1")
    law, source = fitted_in_pressure(rows[MEAN_P].to_numpy(), rows[GIVEN_RATE].to_numpy())
    yield rows.assign(source=source, **{GIVEN_RATE: law(rows[MEAN_P])})
    theirs = published(data, "published", "first second", False, 20)
    if len(theirs):
        for shape, runs in shaped(data, 20, NINE):
            yield pressure_against(data, runs, theirs).assign(series=f"{shape}, {FITTED}")
    yield theirs
    yield given(data, "hold", 40)


def fitted_in_pressure(pressure: np.ndarray, rates: np.ndarray) -> tuple:
    """The linear function of pressure closest to rates, and the source of its rows."""
    law = gain_and_threshold(pressure, rates)
    return law, f"{SIMULATED}: linear in the pressure, R2 {r_squared(rates, law(pressure)):.3f}"


def pressure_against(data: Data, runs: Runs, theirs: DataFrame) -> DataFrame:
    """Rates linear in the pressure of the first second, closest to published ones."""
    first = partial(mean_pressure, window="first second")
    rows = data.numbers(runs, {MEAN_P: first})
    at = np.interp(theirs[CURVATURE], rows[CURVATURE], rows[MEAN_P])
    law, source = fitted_in_pressure(at, theirs[GIVEN_RATE].to_numpy())
    part = {"source": source, "panel": "published", GIVEN_RATE: law(rows[MEAN_P])}
    return rows.assign(**part)[rows[CURVATURE] <= 1.01 * theirs[CURVATURE].max()]


def shaped(data: Data, force: int, cylinders: Runs) -> Iterator[tuple[str, Runs]]:
    """What stands for published spheres at a force: spheres, where they are simulated, and the
    cylinders of a plane section.
    """
    if SPHERES[force].are_in(data.histories):
        yield "spheres", SPHERES[force].without_companions()
    yield "cylinders", cylinders


@stacked
def held_rates(data: Data) -> Iterator[DataFrame]:
    """Mean predicted rate of the hold at 150 gf/s, and the rates printed in Fig 4-2."""
    yield data.numbers(FAST, {GIVEN_RATE: HELD})
    yield given(data, "hold", 150)


@stacked
def mean_rates(data: Data, depth: float) -> Iterator[DataFrame]:
    """Mean predicted rates of the hold at a depth; beside them published rates and TouchSim's, and
    ours in their windows.
    """
    law, factor = law_at(data.histories, depth)
    scaled = "" if factor == 1.0 else f", energies times {factor:.3f}"
    source = f"{SIMULATED}: Eq 5-1 at {depth * 1e6:.0f} um{scaled}"
    scale = {ENERGY_FACTOR: factor}

    def rates(runs: Runs, window: str) -> DataFrame:
        number = partial(rate_in, depth=depth, law=law, window=window)
        return data.numbers(runs, {GIVEN_RATE: number}).assign(source=source, **scale)

    yield rates(NINE, "hold")
    for force, cylinders in {**LOWER, 20: NINE}.items():
        for shape, runs in shaped(data, force, cylinders):
            early = rates(runs, "first second")
            yield within(early.assign(panel="published", series=f"{shape}, {force} gf"))
    for shape, runs in shaped(data, 20, NINE):
        steady = rates(runs, "steady")
        yield within(steady.assign(panel="TouchSim", series=f"predicted, {shape}"))
    yield published(data, "published", "first second", False)
    yield published(data, "TouchSim", "steady", True)
    yield given(data, "hold", 40)


def within(rows: DataFrame) -> DataFrame:
    """Rows of surfaces as curved as those that others pressed."""
    return rows[rows[CURVATURE] < 700]


@stacked
def peak_rates(data: Data) -> Iterator[DataFrame]:
    """Predicted peak rates at two depths, the line in the peak rate of strain energy closest to
    each; TouchSim's first 200 ms.
    """
    panels = {SHALLOW_DEPTH: "600 um", RECEPTOR_DEPTH: "915 um"}
    for depth, panel in panels.items():
        law, factor = law_at(data.histories, depth)
        rate = partial(rate_in, window="peak", depth=depth, law=law)
        rows = data.numbers(NINE, {GIVEN_RATE: rate, RATE: partial(peak_energy_rate, depth=depth)})
        rows["panel"], rows[ENERGY_FACTOR] = panel, factor
        slope, offset, share = straight_line(rows[RATE], rows[GIVEN_RATE])
        yield rows.assign(source=f"{SIMULATED}: Eq 5-1, energies times {factor:.3f}")
        source = f"{SIMULATED}: linear in the peak energy rate, R2 {share:.3f}"
        yield rows.assign(source=source, **{GIVEN_RATE: rectified(slope * rows[RATE] + offset)})
    early = data.numbers(FAST, {GIVEN_RATE: partial(rate_in, window="first 200 ms")})
    of = {"panel": "TouchSim", "series": "predicted, cylinders", "source": f"{SIMULATED}: Eq 5-1"}
    yield within(early.assign(**of))
    yield published(data, "TouchSim", "first 200 ms", True)
    for panel in panels.values():
        yield given(data, "peak", 40).assign(panel=panel)


# --- drawing --------------------------------------------------------------------------------------


def stamp(ax: Axes, text: str, x: float = 0.985, y: float = 0.03, va: str = "bottom") -> None:
    """A word in the picture, so that it is not taken for a recording."""
    axs.remark(ax, x, y, text, style="italic", color=style.GREY, ha="right", va=va)


def points(ax: Axes, rows: DataFrame, x: str, y: str, marker: str = "o", size: float = 30) -> None:
    """One point a surface, in the surfaces' colours; the errors of those over 2 % of the largest as
    bars.
    """
    axs.bars(ax, rows, x, y, rows[y].abs().max())
    colours = [axs.look(label)["color"] for label in rows["surface"]]
    look = {"marker": marker, "s": size, "zorder": 3, "clip_on": False}
    ax.scatter(rows[x], rows[y], color=colours, **look)


def draw_given(ax: Axes, frame: DataFrame, column: str = GIVEN_RATE) -> None:
    """What was recorded under the same protocol: a rate whose surface is one of two spans both."""
    printed = {"marker": "s", "mfc": "none", "mec": style.INK}
    recorded = {"marker": "D", "color": style.INK}
    for source, look, label in (
        ("stated in the thesis", printed, "printed in the thesis, uncertain"),
        ("measured", recorded, "recorded"),
    ):
        rows = axs.from_source(frame, source)
        if column not in frame or rows.empty:
            continue
        other = rows[DOUBT].fillna(rows[CURVATURE])
        middle = (rows[CURVATURE] + other) / 2
        ax.hlines(rows[column], rows[CURVATURE], other, color=style.INK, lw=0.8)
        ax.plot(middle, rows[column], ls="none", ms=5, zorder=4, label=label, **look)
        if SPREAD in rows:
            bar = {"ls": "none", "capsize": 2, "color": style.INK, "lw": 0.8, "zorder": 3}
            ax.errorbar(middle, rows[column], rows[SPREAD], **bar)


def source_text(rows: DataFrame) -> str:
    """What follows the colon in the source of some simulated rows."""
    return rows["source"].iloc[0].partition(": ")[2].replace("R2", "R²")


def trains(fig, frame, spec):
    """Force above, nine times four predicted trains of impulses, mean rates of the hold at the
    right.
    """
    upper, ax = fig.subplots(2, 1, sharex=True, height_ratios=[1, 6.2])
    force, impulses, held = (frame[frame["panel"] == name] for name in TRAIN_PANELS)
    upper.plot(force[TIME], force[FORCE], color=style.INK, clip_on=False)
    axs.limit_axes(upper, frame, y=FORCE)
    upper.set(ylabel=FORCE.label, yticks=[0, 20])
    for (label, series), train in impulses.groupby(["surface", "series"]):
        trial = int(series.removeprefix("trial "))
        row = SURFACES.index(label) + (trial - 1) * 0.2 - 0.3
        ax.vlines(train[IMPULSE], row - 0.07, row + 0.07, **axs.look(label), lw=0.8)
    ax.set(xlim=(0, force[TIME].max()), ylim=(8.6, -0.6), xlabel=TIME.label, ylabel=CURVATURE.label)
    ax.set_yticks(range(9), ["flat plate", *SURFACES[1:]])
    ax.tick_params(left=False)
    for k in range(8):
        ax.axhline(k + 0.5, color="0.9", lw=0.6, zorder=0)

    def at_the_right(x, y, text, **look):
        ax.text(x, y, text, transform=ax.get_yaxis_transform(), ha="right", **look)

    for row, rate in enumerate(held[GIVEN_RATE]):
        at_the_right(1.062, row, f"{rate:.1f}", va="center")
    for _, row in axs.from_source(frame, "stated", "measured").iterrows():
        at = [abs(held[CURVATURE] - k).argmin() for k in row[[CURVATURE, DOUBT]].dropna()]
        text = f"{row[GIVEN_RATE]:.1f}" + "?" * ("uncertain" in row["source"])
        at_the_right(1.135, np.mean(at), text, va="center", color=style.GREY)
    at_the_right(1.066, -0.62, "predicted", va="bottom", fontsize=6.5)
    at_the_right(1.135, -0.62, "printed", va="bottom", **axs.NOTE)
    at_the_right(1.135, 8.75, "impulses/s", va="top", fontsize=6.5)
    stamp(upper, "predicted, not recorded", x=0.99, y=0.5, va="center")


def nine_frequencies(ax, frame, spec):
    """Nine traces of predicted frequency, labelled at the right, over the rates they are made
    from.
    """
    ends, both = {}, axs.together(frame, (FREQUENCY, IMPULSE_RATE))
    axs.limit_axes(ax, both[~(both[TIME] > 2)], y=FREQUENCY, text=False)
    for label in SURFACES:
        rows, look = frame[frame["surface"] == label], axs.look(label)
        rate, frequency = rows[rows["series"] == "rate"], rows[rows["series"] != "rate"]
        for leg in axs.legs(rate):
            axs.curve(ax, leg, TIME, IMPULSE_RATE, whole=rate, lw=1.3, **look)
        often = np.interp(frequency[TIME], rate[TIME], rate[IMPULSE_RATE]) >= OFTEN
        dots = look | {"marker": ".", "ms": 2, "ls": "none"}
        ax.plot(frequency[TIME], frequency[FREQUENCY].where(often), **dots)
        ends[label] = (2.0, float(np.interp(2.0, rate[TIME], rate[IMPULSE_RATE])))
    style.label_ends(ax, ends, 2.12, "curvature (1/m)")
    dots = f"dots: mean frequency of its impulses,\nwhere over {OFTEN} a second"
    stamp(ax, f"predicted, not recorded\nlines: rate\n{dots}", x=0.8, y=0.99, va="top")


def points_and_line(ax, frame, spec):
    """Named points of nine surfaces, the line through them, and recordings if there are any."""
    x, y = spec.x, spec.y[0]
    axs.wide_limits(ax, frame, x, y)
    line = frame[frame["source"].str.contains("line")]
    ax.plot(line[x], line[y], color=style.GREY, lw=1, label=source_text(line))
    own = frame[frame["source"] == SIMULATED]
    points(ax, own, x, y)
    name_points(ax, own, x, y, line)
    recorded = axs.from_source(frame, "measured")
    if len(recorded):
        ax.plot(recorded[x], recorded[y], "D", color=style.INK, ms=4.5, label="recorded")
    stamp(ax, "predicted")


def name_points(ax: Axes, rows: DataFrame, x: str, y: str, line: DataFrame) -> None:
    """Curvatures beside points, on the side away from the line; those at the same place share a
    label.
    """
    rows = rows.sort_values([x, y])
    place = rows[[x, y]].to_numpy() / np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())])
    groups = np.append(0, np.cumsum(np.hypot(*np.diff(place, axis=0).T) > 0.03))
    for _, group in rows.groupby(groups):
        at = group[[x, y]].mean()
        across, up = ax.transLimits.transform(at)
        if up < 0.1:  # on the floor the name is above the point
            away, how = (0, 4), {"va": "bottom", "ha": "center"}
        elif at[y] <= np.interp(at[x], line[x], line[y]):
            away, how = (5, -4), {"va": "top", "ha": "left"}
        elif across > 0.08:
            away, how = (-5, 4), {"va": "bottom", "ha": "right"}
        else:
            away, how = (5, 4), {"va": "bottom", "ha": "left"}
        text = ", ".join(group["surface"])
        ax.annotate(text, at, away, textcoords="offset points", fontsize=6.5, **how)


def peak_and_steady_over_curvature(ax, frame, spec):
    """Peak (triangles) and steady rate (crosses), dotted, with their lines."""
    axs.wide_limits(ax, frame, CURVATURE, GIVEN_RATE)
    own, kinds = frame[frame["source"] == SIMULATED], []
    for column, marker, name in ((GIVEN_RATE, "^", "peak"), (STEADY_RATE, "P", "steady")):
        ax.plot(own[CURVATURE], own[column], ":", color=style.GREY, lw=0.9, zorder=1)
        points(ax, own, CURVATURE, column, marker, 38)
        line = frame[frame["source"].str.contains("line") & frame[column].notna()]
        ax.plot(line[CURVATURE], line[column], color=style.INK, lw=1)
        draw_given(ax, frame[frame[column].notna()], column)
        away = {"xytext": (0, 5), "textcoords": "offset points", "ha": "right", "fontsize": 6.5}
        ax.annotate(f"{name}: {source_text(line)}", line[[CURVATURE, column]].iloc[-1], **away)
        kinds.append(style.handle(f"{name} rate", ls=":", marker=marker, color=style.INK))
    ax.legend(handles=kinds + ax.get_legend_handles_labels()[0][:1], loc="upper left")
    stamp(ax, "predicted")


def widths_and_ranges(ax, frame, spec):
    """A line a surface, broad ones above, from the start of the hold (open) to its end, over the
    thesis's range; pale: what its nodes hide.
    """
    for k, label in enumerate(SURFACES):
        rows = frame[frame["surface"] == label]
        own, ends = axs.simulated(rows), axs.from_source(rows, "thesis axis range")
        begin = axs.from_source(rows, OVER_NODES)[INVERSE_WIDTH].min()
        bar = {"lw": 7, "solid_capstyle": "butt", "zorder": 0, "color": style.PALE}
        ax.plot([begin, ends[INVERSE_WIDTH].max()], [k, k], alpha=0.4, **bar)
        uncertain = ends["source"].str.contains("uncertain").any()
        broken = {"ls": (0, (0.5, 0.25)) if uncertain else "-"}
        ax.plot(ends[INVERSE_WIDTH], [k] * len(ends), **bar, **broken)
        look, values = axs.look(label), own[INVERSE_WIDTH]
        ax.plot(values, [k] * len(own), lw=1.2, **look)
        ax.plot(values.iloc[:1], k, "o", ms=4, mfc="white", **look)
        ax.plot(values.iloc[-1:], k, "o", ms=4, **look)
    ax.set(xscale="log", yticks=range(len(SURFACES)), ylim=(len(SURFACES) - 0.5, -0.5))
    ax.set_yticklabels(map(axs.surface_name, SURFACES))
    ticks = [0.2, 0.3, 0.5, 0.8, 1.2]
    ax.set_xticks(ticks, map(str, ticks))
    ax.minorticks_off()
    ax.set(xlabel=INVERSE_WIDTH.label, ylabel="")
    text = (
        "open: the hold begins\nfilled: it ends\ngrey: the thesis's axis\n"
        "(broken: uncertain);\npale: widths that its\nnodes may hide"
    )
    axs.remark(ax, 0.98, 0.96, text, ha="right", va="top", **axs.NOTE)


def twelve_nodes(fig, frame, spec):
    """Twelve panels: dotted simulated, solid and dashed by Eq 4-1."""
    axes = fig.subplots(4, 3, sharex=True, sharey=True)
    simulated = axs.look("210") | {"lw": 1.6, "label": "simulated"}
    one_set = {"ls": style.DASHED, "lw": 1.0, "color": style.INK}
    one_set["label"] = "Eq 4-1, one set of constants"
    own_set = {"ls": style.DOTTED, "lw": 1.0, "color": style.HIGHLIGHT}
    own_set["label"] = "a set for each node"
    laws = {"Eq 4-1, one set": one_set, "Eq 4-1, a set for each": own_set}
    for ax, (x, rows) in zip(axes.flat, axs.simulated(frame).groupby(NODE), strict=True):
        axs.curve(ax, rows[rows["series"] == "simulated"], TIME, P, **simulated)
        for series, look in laws.items():
            law = rows[rows["series"] == series]
            ax.plot(law[TIME], law[P_LAW], **look)
        style.in_kilo(ax.yaxis)
        ax.set(title=f"x = {x:.3g} mm", **HOLD)
    axs.limit_axes(axes[1, 2], axs.together(frame, (P, P_LAW)), y=P)
    axes[3, 1].set_xlabel(TIME.label)
    axes[2, 0].set_ylabel("contact pressure (kPa)", y=1.15)
    style.header_legend(fig, axes[0, 0].lines)


SUMS = {
    SED_LAW: {"label": "Eq 4-4", "color": style.INK, "lw": 1},
    SED_SQUARE: {"label": "square of its sum", "color": style.HIGHLIGHT, "lw": 1.2, "ls": "--"},
}
"""Lines of the laws of the pressure in Fig 4-22."""


def energy_and_laws(ax, rows, spec):
    """Points simulated, lines by the laws; of each law what is left between, and of all how much
    they fall in the hold.
    """
    own = axs.simulated(rows)
    look = {"marker": "o", "ms": 2.4, "mfc": "none", "mew": 0.7, "ls": "none"}
    axs.curve(ax, own, TIME, SED, label="simulated", **look, **axs.look(own["surface"].iloc[0]))
    top = own[SED].argmax()
    words = [f"points {own[SED].iloc[-1] / own[SED].iloc[top] - 1:+.0%} in the hold"]
    for (column, line), kind in zip(SUMS.items(), ("solid", "dashed"), strict=True):
        ax.plot(own[TIME], own[column], **line)
        left = np.linalg.norm(own[SED] - own[column]) / np.linalg.norm(own[SED])
        change = own[column].iloc[-1] / own[column].iloc[top] - 1
        words.append(f"{kind} {change:+.0%}, r.m.s. {left:.0%} off")
    axs.remark(ax, 0.97, 0.06, "\n".join(words), ha="right", **axs.NOTE)


def three_kinds(panels, frame):
    """Legend of the points and the two laws."""
    ax = next(iter(panels.values()))
    style.header_legend(ax.figure, ax.lines)


def left_note(frame: DataFrame) -> list[str]:
    """The usual line, of what is in no panel of its own: the large panel at the left."""
    left = frame["panel"].isna() | frame["panel"].isin(("600 um", "915 um"))
    return axs.footnote(frame[left], OF_THE_LARGEST)


def own_and_others(fig, frame, spec, fill, ratios, others, names=(None,)):
    """Panels of predicted rates (values of ``panel``; None: what is in none), and at their right
    rates of `others` (panel -> title and what differs), with ours.
    """
    if "panel" not in frame:
        frame = frame.assign(panel=np.nan)
    axes = fig.subplots(1, len(ratios), width_ratios=ratios)
    for ax, name in zip(axes, names, strict=False):
        ranges = frame["source"].str.contains("axis range")
        own = frame["panel"] == name if name else frame["panel"].isna()
        fill(ax, frame[own | ranges], spec)
        ax.set(xlabel=CURVATURE.label, title=name.replace("um", "µm") if name else "")
    axes[0].set_ylabel(spec.y[0].label)
    for ax, (name, (title, mismatch)) in zip(axes[len(names) :], others.items(), strict=True):
        beside(ax, frame[frame["panel"] == name], title, mismatch)
        ax.set_ylabel(f"mean rate, {title.partition(', ')[2]} (impulses/s)")


def page_of(**options) -> Page:
    """A page of predicted rates and those of others."""
    return Page(3.1, partial(own_and_others, **options))


def points_and_law(ax, rows, spec, words="predicted by Eq 5-1", legend=LOWER_RIGHT):
    """Points by Eq 5-1, and a linear function as a line."""
    axs.wide_limits(ax, rows, CURVATURE, GIVEN_RATE)
    line = rows[rows["source"].str.contains("linear")]
    label = source_text(line).replace("peak energy", "peak\nenergy")
    ax.plot(line[CURVATURE], line[GIVEN_RATE], color=style.INK, lw=1.1, label=label)
    ax.plot([], [], "o", color=style.GREY, label=words)
    points(ax, rows[rows["source"].str.contains("Eq 5-1")], CURVATURE, GIVEN_RATE)
    draw_given(ax, rows)
    ax.legend(**legend)


def stamped_law(ax, rows, spec):
    """The same, with a word that it is predicted."""
    words = "Eq 5-1, predicted from strain energy"
    points_and_law(ax, rows, spec, words, {"loc": "upper left"})
    stamp(ax, "predicted")


def beside(ax: Axes, rows: DataFrame, title: str, mismatch: str) -> None:
    """A panel of rates measured elsewhere or of another model (points), with ours of the same force
    (lines): how far apart they are.
    """
    if rows.empty:
        ax.set_title(f"{title}\n{mismatch.format('cylinders')}")
        axs.remark(ax, 0.5, 0.5, "no rates given", ha="center", color=style.GREY)
        return
    own = axs.simulated(rows).sort_values(CURVATURE)
    curves = dict(list(own.groupby("series", sort=False)))
    round_ = [name for name in curves if "spheres" in name]
    whose = f"{mismatch.partition(';')[0]}; grey: cylinders"
    ax.set_title(f"{title}\n{whose if round_ else mismatch.format('cylinders')}")
    times = []
    theirs = rows[~is_simulated(rows)].groupby("series", sort=False)
    for marker, (name, points) in zip(style.MARKERS, theirs, strict=False):
        seen = points["source"].str.startswith("measured").all()
        look = {"color": style.MEASURED if seen else style.HIGHLIGHT, "marker": marker}
        look |= {"ls": "none", "ms": 3.5, "clip_on": False, "zorder": 3}
        ax.plot(points[CURVATURE], points[GIVEN_RATE], **look, label=name)
        ours = curves[_same(name, [*round_, *curves])]
        at = np.interp(points[CURVATURE], ours[CURVATURE], ours[GIVEN_RATE])
        times += list((points[GIVEN_RATE] / at)[at > 1])
    for name, curve in curves.items():
        other = bool(round_) and name not in round_
        look = style.look_of("force (gf)", _force(name), "ls")
        look |= {"lw": 0.8, "color": style.GREY} if other else {"lw": 1.1, "color": style.INK}
        label = name if name.startswith("predicted") else f"predicted, {name}"
        label = "" if other and len(round_) > 1 else label
        ax.plot(curve[CURVATURE], curve[GIVEN_RATE], **look, label=label)
    ax.set(xlim=(0, 1.04 * rows[CURVATURE].max()), ylim=(0, 1.6 * rows[GIVEN_RATE].max()))
    ax.set_xlabel(CURVATURE.label)
    compared = times and not any(FITTED in name for name in curves)
    far = f"theirs over ours: {np.median(times):.1f} (median)" if compared else ""
    small = {"fontsize": 6, "handlelength": 1.8, "borderaxespad": 0.2, "labelspacing": 0.3}
    ax.legend(title=far, alignment="left", loc="upper left", **small)


def _same(name: str, curves: Sequence[str]) -> str:
    """The curve that a recording is compared with: of the force or shape that it ends with, or the
    first.
    """
    end = name.rpartition(", ")[2]
    return next((curve for curve in curves if curve.endswith(end)), curves[0])


def _force(name: str) -> str:
    """The force (gf) that a series names; 20 where it names none."""
    return next((force for force in ("10", "15") if f"{force} g" in name), "20")


def draw_rates(ax, frame, spec):
    """Predicted rates against curvature, with what was recorded under the same protocol."""
    axs.wide_limits(ax, frame, CURVATURE, GIVEN_RATE)
    own = frame[is_simulated(frame) & frame["surface"].notna()]
    line = {"color": style.GREY, "lw": 0.9}
    ax.plot(own[CURVATURE], own[GIVEN_RATE], **line, zorder=1)
    ax.plot([], [], "o-", **line, label="predicted by Eq 5-1")
    points(ax, own, CURVATURE, GIVEN_RATE)
    draw_given(ax, frame)
    stamp(ax, "points: predicted")
    ax.legend(loc="upper left")


def of_rates(number, title, rows, layout, thesis, **options) -> Figure:
    """A figure of rates over curvature, or of one rate over another."""
    shared = {"runs": NINE, "x": CURVATURE, "y": (GIVEN_RATE,)}
    shared |= {"how": OF_THE_LARGEST, "measured": RATES}
    return Figure(number, title, thesis=thesis, layout=layout, rows=rows, **shared | options)


def points_of(fill, **options) -> Panels:
    """One panel of points, on axes that hold all of them."""
    return Panels(3.0, limit="", fill=fill, **options)


def from_depth(number: str, depth: float, axis: str) -> Figure:
    """Figs 4-26 and 4-27."""
    title = f"Predicted mean rate of the hold from strain energy at {depth * 1e6:.0f} µm, 40 gf/s"
    others = {"published": GOODWIN, "TouchSim": ("TouchSim, steady", HALF_SPACE)}
    return of_rates(
        number,
        title,
        partial(mean_rates, depth=depth),
        page_of(fill=draw_rates, ratios=(1.7, 1, 1), others=others),
        {GIVEN_RATE: axis, CURVATURE: "T202"},
        runs=(NINE, *LOWER.values()),
        judged_with=tuple(SPHERES.values()),
        note=left_note,
    )


FIGURES = (
    Figure(
        "4-2",
        "Predicted impulses, 150 gf/s ramp to 20 gf, 2 s hold",
        FAST,
        TIME,
        (IMPULSE,),
        {FORCE: "T080"},
        Page(5.0, trains),
        rows=trains_and_rates,
        measured=RATES,
        how="of the largest rate",
    ),
    Figure(
        "4-3",
        "Predicted instantaneous frequency, 40 gf/s ramp to 20 gf",
        NINE,
        TIME,
        (FREQUENCY,),
        {TIME: "T091", FREQUENCY: "T090"},
        Panels(3.4, fill=nine_frequencies, limit="", set={"xlim": (0, 2)}),
        rows=frequencies,
    ),
    of_rates(
        "4-4",
        "Predicted steady rate against peak rate, 40 gf/s ramp to 20 gf",
        partial(peak_and_steady, over_curvature=False),
        points_of(points_and_line, legend={"loc": "upper left"}),
        {GIVEN_RATE: "T094", STEADY_RATE: "T095"},
        x=PEAK_RATE,
        y=(STEADY_RATE,),
    ),
    of_rates(
        "4-5",
        "Predicted peak and steady rates against curvature",
        partial(peak_and_steady, over_curvature=True),
        points_of(peak_and_steady_over_curvature),
        {GIVEN_RATE: "T096", CURVATURE: "T162"},
        x=CURVATURE.reading(None, "surface curvature (1/m)"),
        y=(GIVEN_RATE.reading(None, "impulse rate (impulses/s)"),),
    ),
    Figure(
        "4-9",
        "Inverse of the contact width in the hold",
        NINE,
        INVERSE_WIDTH,
        (INVERSE_WIDTH,),
        {INVERSE_WIDTH: WIDTH_IDS},
        Panels(3.2, fill=widths_and_ranges, limit=""),
        rows=widths_in_the_hold,
        after=widths_over_nodes,
        width=style.COLUMN_WIDTH,
    ),
    Figure(
        "4-17",
        "Pressure at twelve nodes and its decay by Eq 4-1, K = 210 1/m",
        K210,
        TIME,
        (P, P_LAW),
        {TIME: "T155", P: "T154"},
        Page(6.2, twelve_nodes),
        rows=nodes_by_law,
    ),
    of_rates(
        "4-18",
        "Predicted peak rate against peak contact pressure",
        peaks_over_pressure,
        points_of(points_and_line, legend={"loc": "upper left"}),
        {P_PEAK: "T159", GIVEN_RATE: "T160"},
        x=P_PEAK,
        y=(PEAK_RATE,),
        width=style.COLUMN_WIDTH,
    ),
    of_rates(
        "4-19",
        "Mean rate from mean contact pressure, against curvature",
        linear_in_pressure,
        page_of(fill=stamped_law, ratios=(1.55, 1), others={"published": GOODWIN}),
        {GIVEN_RATE: "T161", CURVATURE: "T162"},
        judged_with=(SPHERES[20],),
    ),
    Figure(
        "4-22",
        "Strain energy density at 915 µm, and from contact pressure",
        NINE,
        TIME,
        (SED, SED_LAW, SED_SQUARE),
        {SED: by_surface("T181 T182 T183 T184 T185 T186 T187a T187b T187c")},
        nine(
            SURFACES,
            5.8,
            fill=energy_and_laws,
            set=HOLD | {"xlim": (0, 2.58)},
            extra=three_kinds,
        ),
        rows=energy_by_pressure,
    ),
    of_rates(
        "4-25",
        "Predicted mean rate of the hold, 150 gf/s ramp to 20 gf",
        held_rates,
        points_of(draw_rates),
        {GIVEN_RATE: "T201", CURVATURE: "T202"},
        runs=FAST,
        width=style.COLUMN_WIDTH,
    ),
    from_depth("4-26", RECEPTOR_DEPTH, "T203"),
    from_depth("4-27", SHALLOW_DEPTH, "T204"),
    of_rates(
        "4-29",
        "Predicted peak rate, and from the peak rate of strain energy, against curvature",
        peak_rates,
        page_of(
            fill=points_and_law,
            ratios=(1.25, 1.25, 1),
            names=("600 um", "915 um"),
            others={"TouchSim": ("TouchSim, first 200 ms", HALF_SPACE)},
        ),
        {GIVEN_RATE: "T207", CURVATURE: "T208"},
        runs=(NINE, FAST),
        y=(PEAK_RATE,),
        note=left_note,
    ),
)

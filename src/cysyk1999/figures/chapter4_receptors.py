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

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.figures import axes as axs
from cysyk1999.figures.chapter4 import HOLD, K210, OTHER_PADS, WIDTH_IDS, by_surface
from cysyk1999.figures.grammar import Data, Figure, Own, Panels, below, nine
from cysyk1999.measures.errors import PARTS, Curve, curve_errors, over_time, shared_place
from cysyk1999.measures.quantities import (
    CURVATURE,
    DOUBT,
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
    STEADY_RATE,
    TIME,
    P,
    Q,
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
    fit_sum,
    mean_frequency,
    mean_pressure,
    node_places,
    peak_energy_rate,
    predicted_rate,
    pressure_by_law,
    raster,
    rate_in,
    shallow_law,
    straight_line,
)
from cysyk1999.measures.runs import FAST, LOWER, NINE
from cysyk1999.measures.table import reading
from cysyk1999.publishing import style
from cysyk1999.receptors.fits import gain_and_threshold, r_squared
from fingerpad.measures.features import (
    SIMULATED,
    SURFACES,
    energy,
    force_gf,
    is_simulated,
    pressure_at,
    ramp_end,
)
from fingerpad.planning.errors import PROFILE_ORDER
from fingerpad.receptors.laws import THESIS_RATE, rectified
from fingerpad.receptors.spikes import VARIATION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Picture

AVERAGED = 100
"""Trials that the frequency of Fig 4-3 is the mean of."""
OFTEN = 8
"""Impulses/s from which on a train has enough of them in Fig 4-3 that their mean frequency is not
biased.
"""
PRINTED = ("T083", "T084", "T085", "T086", "T087")
"""Mean rates of the hold that can be read beside the rasters of Fig 4-2."""

RATES = "impulse_rates"
SPREAD = "standard deviation (impulses/s)"
"""Column of what is recorded: over repetitions, where it is given."""
LAW_NOTE = (
    "Eq 5-1 with the thesis's constants (0.081 (impulses/s)/Pa, 150 Pa; 0.0182 "
    "impulses/Pa, 100 Pa/s)"
)
DEEP = f"{LAW_NOTE}, 915 µm under the centre."
STEADY_NOTE = f"{DEEP} Steady: mean of the last half of the hold."
GOODWIN = "Goodwin 1995, first second", "monkey, spheres; ours: cylinders"
HALF_SPACE = "half-space; ours: layered pad"
SCALED = (
    "The thesis prints no constants for this depth: energies are scaled to their mean at 915 "
    "µm over the nine surfaces."
)
BESIDE = (
    "Left: mean over the hold; the recorded rates are not public. Goodwin, Browning and Wheat "
    "(1995), digitised by a third "
    "party: impulses in the first second (force rate not stated). TouchSim (Saal et al. 2017): a "
    "half-space."
)
PEAK_WORDS = "peak rate (impulses/s)"
OF_THE_LARGEST = "of the largest"
OF = "panel"
"""Column that says which measure of other pads a bar shows."""
PEAK, STEADY, HELD = (reading("rate", window) for window in ("peak", "steady", "hold"))

RATE_OVER_TIME = Curve(lambda history: predicted_rate(history)[[TIME, IMPULSE_RATE]].to_numpy().T)

# --- rows ------------------------------------------------------------------------------------------------


def line_through(rows: pd.DataFrame, x: str, y: str) -> pd.DataFrame:
    """Two rows: the ends of the line through points, from 0 to the last of them, where it is not
    negative.
    """
    slope, offset, share = straight_line(rows[x], rows[y])
    ends = np.array([max(0.0, -offset / slope) if slope > 0 else 0.0, rows[x].max()])
    return pd.DataFrame(
        {
            "source": f"{SIMULATED}: least-squares line, R2 {share:.3f}",
            x: ends,
            y: slope * ends + offset,
        }
    )


def given(data: Data, window: str, ramp: float, column: str = GIVEN_RATE) -> pd.DataFrame:
    """Rates recorded under the protocol of a figure: those printed in the thesis, and a user's."""
    if (rates := data.measured) is None:
        return pd.DataFrame()
    same = rates[
        (rates["receptor"] == "SA-I")
        & (rates["species"] != "model")
        & rates["stimulus"].isin(("flat plate", "cylinder"))
        & (rates["force_gf"].sub(20).abs() < 0.5)
        & (rates["ramp_gf_per_s"] == ramp)
        & (rates["window"] == window)
    ]
    printed = {
        float(data.reference.loc[id_, "low"]): id_ for id_ in PRINTED if id_ in data.reference.index
    }
    of_thesis = same["source"].str.startswith("Cysyk 1999")
    same = same[~of_thesis | same["rate_per_s"].isin(printed)].reset_index(drop=True)
    sources = [
        f"stated in the thesis ({printed[row['rate_per_s']]}, reading uncertain)"
        if row["source"].startswith("Cysyk 1999")
        else f"measured ({row['recording']}; {row['source']})"
        for row in same.to_dict("records")
    ]
    shown = {
        CURVATURE: same["curvature_per_m"],
        DOUBT: same["or_curvature_per_m"],
        column: same["rate_per_s"],
    }
    if same["sd_per_s"].notna().any():
        shown[SPREAD] = same["sd_per_s"]
    return pd.DataFrame({"source": sources} | shown)


def published(
    data: Data, panel: str, window: str, model: bool, force: float | None = None
) -> pd.DataFrame:
    """Published rates, or another model's, of pressed surfaces in a window, one series a
    recording.
    """
    if (rates := data.measured) is None:
        return pd.DataFrame()
    rows = rates[(rates["species"] == "model") == model]
    rows = rows[
        (rows["window"] == window)
        & (rows["receptor"] == "SA-I")
        & ~rows["source"].str.startswith("Cysyk")
    ]
    rows = rows[rows["stimulus"].isin(("sphere", "flat plate")) | model]
    spheres = rows.groupby("recording")["stimulus"].transform(lambda kinds: "sphere" in set(kinds))
    rows = rows[spheres.astype(bool) | model] if len(rows) else rows
    if force:
        rows = rows[rows["force_gf"] == force]
    source = ("other model (" if model else "measured (") + rows["source"] + ")"
    shared = {"source": source, "panel": panel, "series": rows["recording"]}
    return pd.DataFrame(
        shared | {CURVATURE: rows["curvature_per_m"], GIVEN_RATE: rows["rate_per_s"]}
    )


def trains_and_rates(data: Data) -> pd.DataFrame:
    """Predicted impulses of four trials a surface at 150 gf/s, the force, the mean predicted rate
    in the hold, printed ones.
    """
    numbers = data.numbers(FAST, {GIVEN_RATE: HELD})
    plate = data.histories[FAST["flat"]]
    parts = [
        numbers.assign(panel="mean rate of the hold"),
        pd.DataFrame({"panel": "force", TIME: plate["time"].values, FORCE: force_gf(plate)}),
    ]
    errors = numbers.set_index("surface")[list(PARTS)]
    for k, (label, history, _) in enumerate(data.runs(FAST)):
        impulses = raster(predicted_rate(history), TRIALS, SEED + k)
        part = {
            "panel": "impulses",
            "surface": label,
            "series": [f"trial {n}" for n in impulses["trial"]],
        }
        parts.append(pd.DataFrame(part | {IMPULSE: impulses[TIME], **errors.loc[label]}))
    return below(pd.concat(parts, ignore_index=True), given(data, "hold", 150))


def frequencies(data: Data) -> pd.DataFrame:
    """Instantaneous frequency of predicted impulses at 40 gf/s, mean of many trials, and the rate
    they were made from.
    """
    parts, at = [], np.arange(0, 2.0001, 0.02)
    for k, (label, history, coarse) in enumerate(data.runs(NINE)):
        rate, errors = (
            predicted_rate(history),
            curve_errors(history, coarse, RATE_OVER_TIME).columns,
        )
        frequency = mean_frequency(raster(rate, AVERAGED, SEED + k), AVERAGED, at)
        parts += [
            frequency.assign(surface=label, series="frequency of impulses", **errors),
            rate[[TIME, IMPULSE_RATE]].assign(surface=label, series="rate", **errors),
        ]
    return pd.concat(parts, ignore_index=True)


def peak_and_steady(data: Data) -> tuple[pd.DataFrame, pd.DataFrame, pd.DataFrame]:
    """Predicted peak rate and rate in the last half of the hold, one row a surface, and recorded
    ones of either kind.
    """
    rows = data.numbers(NINE, {GIVEN_RATE: PEAK, STEADY_RATE: STEADY})
    return rows, given(data, "peak", 40), given(data, "steady", 40, STEADY_RATE)


def steady_over_peak(data: Data) -> pd.DataFrame:
    rows, peak, steady = peak_and_steady(data)
    both = (
        peak.merge(steady, on=["source", CURVATURE, DOUBT])
        if len(peak) and len(steady)
        else pd.DataFrame()
    )
    return below(rows, line_through(rows, GIVEN_RATE, STEADY_RATE), both)


def over_curvature(data: Data) -> pd.DataFrame:
    rows, peak, steady = peak_and_steady(data)
    return below(
        rows,
        *(line_through(rows, CURVATURE, column) for column in (GIVEN_RATE, STEADY_RATE)),
        peak,
        steady,
    )


def widths_of_other_pads(data: Data) -> pd.DataFrame:
    """How far the inverse contact widths of other pads differ as the hold begins and as it ends."""
    return data.bands(
        INVERSE_WIDTH, {m: {OF: m} for m in ("width_top", "width_end")}, lambda width: 1 / width
    )


def rate_and_width(data: Data) -> pd.DataFrame:
    """Predicted rate and inverse contact width in the hold, one row an output and surface."""

    def held_rate(history: xr.Dataset) -> np.ndarray:
        return THESIS_RATE.terms(energy(history, RECEPTOR_DEPTH), 0.0)[0][ramp_end(history) :]

    def held_time(history: xr.Dataset) -> np.ndarray:
        return history["time"].values[ramp_end(history) :]

    parts = []
    for label, history, coarse in data.runs(NINE):
        held = history.isel(time=slice(ramp_end(history), None))
        errors = curve_errors(history, coarse, Curve(lambda d: (held_time(d), held_rate(d))))
        part = {
            "surface": label,
            TIME: held["time"].values,
            INVERSE_WIDTH: INVERSE_WIDTH.read(held),
        }
        parts.append(pd.DataFrame(part | {IMPULSE_RATE: held_rate(history)} | errors.columns))
    return pd.concat(parts, ignore_index=True)


def nodes_by_law(data: Data) -> pd.DataFrame:
    """Pressure of twelve nodes as simulated, and by Eq 4-1 from each node's peak on: one set of
    constants, and a set for each.
    """
    ((_, history, coarse),) = data.runs(K210)
    nodes = contact_nodes(history, NODE_COUNT)
    together, parts = fit_nodes("4-1", nodes), []
    for place in node_places(NODE_COUNT):
        x = place * 1e3
        pressed = over_time(partial(pressure_at, place=shared_place(place, coarse)), PROFILE_ORDER)
        errors = curve_errors(history, coarse, pressed).columns
        part = pd.DataFrame({TIME: history["time"].values, P: pressure_at(history, place)})
        parts.append(part.assign(series="simulated", **{NODE: round(x, 5)}, **errors))
        own = nodes[np.isclose(nodes[NODE], x)]
        if own["past_peak"].sum() < 4:
            continue
        for series, constants in (("one set", together), ("a set for each", fit_nodes("4-1", own))):
            law = pressure_by_law("4-1", own, constants)[[TIME, P_LAW]]
            parts.append(law.assign(series=f"Eq 4-1, {series}", **{NODE: round(x, 5)}, **errors))
    return pd.concat(parts, ignore_index=True)


def energy_by_pressure(data: Data) -> pd.DataFrame:
    """Strain energy at 915 um as simulated and by Eq 4-4 from the contact pressure, one set of
    constants for nine surfaces.
    """
    runs = list(data.runs(NINE))
    law = fit_sum([history for _, history, _ in runs], RECEPTOR_DEPTH)
    source = (
        f"{SIMULATED}: Eq 4-4 with r {law.r * 1e3:.3g} mm, A1 {law.per_depth:.3g} 1/m2, A2 "
        f"{law.constant:.3g} 1/m"
    )
    shown = partial(energy, depth=RECEPTOR_DEPTH)
    parts = [
        energy_from_pressure(history, RECEPTOR_DEPTH, law).assign(
            surface=label, source=source, **curve_errors(history, coarse, over_time(shown)).columns
        )
        for label, history, coarse in runs
    ]
    return pd.concat(parts, ignore_index=True)


def peaks_over_pressure(data: Data) -> pd.DataFrame:
    """Predicted peak rate and largest pressure at any node, one row a surface, and the line through
    them; recorded peak rates.
    """
    rows = data.numbers(NINE, {P_PEAK: reading("highest_pressure", "highest"), GIVEN_RATE: PEAK})
    mine = given(data, "peak", 40)
    if len(mine):
        mine[P_PEAK] = np.interp(mine[CURVATURE], rows[CURVATURE], rows[P_PEAK])
    return below(rows, line_through(rows, P_PEAK, GIVEN_RATE), mine)


def linear_in_pressure(data: Data) -> pd.DataFrame:
    """Rates as linear functions of the mean centre pressure: closest to Eq 5-1's in the hold, and
    to Goodwin's first second.
    """
    early = Q("first_second_pressure", "Pa")
    rows = data.numbers(
        NINE,
        {
            GIVEN_RATE: HELD,
            MEAN_P: mean_pressure,
            early: partial(mean_pressure, window="first second"),
        },
    )
    early = rows.pop(early)
    parts, theirs = (
        [rows.assign(source=f"{SIMULATED}: Eq 5-1")],
        published(data, "published", "first second", False, 20),
    )

    def fitted(pressure: np.ndarray, rates: np.ndarray) -> tuple:
        law = gain_and_threshold(pressure, rates)
        return law, f"{SIMULATED}: linear in the pressure, R2 {r_squared(rates, law(pressure)):.3f}"

    law, source = fitted(rows[MEAN_P].to_numpy(), rows[GIVEN_RATE].to_numpy())
    parts.append(rows.assign(source=source, **{GIVEN_RATE: law(rows[MEAN_P])}))
    if len(theirs):
        law, source = fitted(
            np.interp(theirs[CURVATURE], rows[CURVATURE], early), theirs[GIVEN_RATE].to_numpy()
        )
        inside = rows[CURVATURE] <= 1.01 * theirs[CURVATURE].max()
        part = {
            "source": source,
            "panel": "published",
            CURVATURE: rows[CURVATURE],
            MEAN_P: early,
            GIVEN_RATE: law(early),
        }
        parts.append(
            pd.DataFrame(part)[inside].assign(surface=rows["surface"], **rows[list(PARTS)])
        )
    return below(pd.concat(parts, ignore_index=True), theirs, given(data, "hold", 40))


def held_rates(data: Data) -> pd.DataFrame:
    """Mean predicted rate of the hold at 150 gf/s, and the rates printed in Fig 4-2."""
    return below(data.numbers(FAST, {GIVEN_RATE: HELD}), given(data, "hold", 150))


def mean_rates(data: Data, depth: float) -> pd.DataFrame:
    """Mean predicted rates of the hold at a depth; beside them published rates and TouchSim's, and
    ours in their windows.
    """
    law, text = THESIS_RATE, "Eq 5-1 at 915 um"
    if depth != RECEPTOR_DEPTH:
        law, factor = shallow_law(NINE.histories(data.histories))
        text = f"Eq 5-1 at {depth * 1e6:.0f} um, energies times {factor:.3f}"
    number = partial(rate_in, depth=depth, law=law)
    parts = [data.numbers(NINE, {GIVEN_RATE: partial(number, window="hold")})]
    for force, runs in {**LOWER, 20: NINE}.items():
        early = data.numbers(runs, {GIVEN_RATE: partial(number, window="first second")})
        parts.append(early.assign(panel="published", series=f"predicted, {force} gf"))
    steady = data.numbers(NINE, {GIVEN_RATE: partial(number, window="steady")})
    parts.append(steady.assign(panel="TouchSim", series="predicted, cylinders"))
    rows = pd.concat(parts, ignore_index=True)
    rows = rows[rows["panel"].isna() | (rows[CURVATURE] < 700)].assign(
        source=f"{SIMULATED}: {text}"
    )
    beside = (
        published(data, "published", "first second", False),
        published(data, "TouchSim", "steady", True),
    )
    return below(rows, *beside, given(data, "hold", 40))


def peak_rates(data: Data) -> pd.DataFrame:
    """Predicted peak rates at two depths, the line in the peak rate of strain energy closest to
    each; TouchSim's first 200 ms.
    """
    parts = []
    for depth in (SHALLOW_DEPTH, RECEPTOR_DEPTH):
        law, factor = (
            shallow_law(NINE.histories(data.histories))
            if depth == SHALLOW_DEPTH
            else (THESIS_RATE, 1.0)
        )
        columns = {
            GIVEN_RATE: partial(rate_in, window="peak", depth=depth, law=law),
            RATE: partial(peak_energy_rate, depth=depth),
        }
        rows = data.numbers(NINE, columns).assign(panel=f"{depth * 1e6:.0f} um")
        slope, offset, share = straight_line(rows[RATE], rows[GIVEN_RATE])
        parts.append(rows.assign(source=f"{SIMULATED}: Eq 5-1, energies times {factor:.3f}"))
        by = {GIVEN_RATE: rectified(slope * rows[RATE] + offset)}
        parts.append(
            rows.assign(source=f"{SIMULATED}: linear in the peak energy rate, R2 {share:.3f}", **by)
        )
    early = data.numbers(FAST, {GIVEN_RATE: partial(rate_in, window="first 200 ms")})
    early = early[early[CURVATURE] < 700].assign(
        panel="TouchSim", series="predicted, cylinders", source=f"{SIMULATED}: Eq 5-1"
    )
    mine = [
        rows.assign(panel=panel)
        for panel in ("600 um", "915 um")
        if len(rows := given(data, "peak", 40))
    ]
    return below(
        pd.concat([*parts, early], ignore_index=True),
        published(data, "TouchSim", "first 200 ms", True),
        *mine,
    )


# --- drawing ---------------------------------------------------------------------------------------------


def stamp(
    ax: Axes, text: str = "predicted", x: float = 0.985, y: float = 0.03, va: str = "bottom"
) -> None:
    """A word in the picture, so that it is not taken for a recording."""
    ax.text(x, y, text, transform=ax.transAxes, style="italic", color=style.GREY, ha="right", va=va)


def points(ax: Axes, rows: pd.DataFrame, x: str, y: str, **look) -> None:
    """One point a surface, in the surfaces' colours; the errors of those over 2 % of the largest as
    bars.
    """
    look = {"marker": "o", "s": 30, "zorder": 3, "clip_on": False} | look
    axs.bars(ax, rows, x, y, rows[y].abs().max())
    ax.scatter(
        rows[x], rows[y], color=[axs.look(label)["color"] for label in rows["surface"]], **look
    )


def draw_given(ax: Axes, frame: pd.DataFrame, column: str = GIVEN_RATE) -> None:
    """What was recorded under the same protocol: a rate whose surface is one of two spans both."""
    if column not in frame:
        return
    rows = frame[frame["source"].str.contains(r"stated in the thesis|^measured")]
    printed = rows["source"].str.startswith("stated")
    for mine, look, label in (
        (
            rows[printed],
            {"marker": "s", "mfc": "none", "mec": style.INK},
            "printed in the thesis, uncertain",
        ),
        (rows[~printed], {"marker": "D", "color": style.INK}, "recorded"),
    ):
        if mine.empty:
            continue
        other = mine[DOUBT].where(mine[DOUBT].notna(), mine[CURVATURE])
        ax.hlines(mine[column], mine[CURVATURE], other, color=style.INK, lw=0.8)
        middle = (mine[CURVATURE] + other) / 2
        ax.plot(middle, mine[column], ls="none", ms=5, zorder=4, label=label, **look)
        if SPREAD in mine:
            ax.errorbar(
                middle,
                mine[column],
                mine[SPREAD],
                ls="none",
                capsize=2,
                color=style.INK,
                lw=0.8,
                zorder=3,
            )


def source_text(rows: pd.DataFrame) -> str:
    """What follows the colon in the source of some simulated rows."""
    return rows["source"].iloc[0].partition(": ")[2].replace("R2", "R²")


def trains(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Force above, nine times four predicted trains of impulses, mean rates of the hold at the
    right.
    """
    upper, ax = fig.subplots(2, 1, sharex=True, height_ratios=[1, 6.2])
    force = frame[frame[FORCE].notna() & is_simulated(frame)]
    upper.plot(force[TIME], force[FORCE], color=style.INK, clip_on=False)
    axs.limit_axis(upper, frame, FORCE)
    upper.set(ylabel=FORCE.label, yticks=[0, 20])
    place = {label: k for k, label in enumerate(SURFACES)}
    for (label, series), train in frame[frame[IMPULSE].notna()].groupby(["surface", "series"]):
        row = place[label] + (int(series.split()[1]) - 1) * 0.2 - 0.3
        ax.vlines(train[IMPULSE], row - 0.07, row + 0.07, **axs.look(label), lw=0.8)
    ax.set(
        xlim=(0, force[TIME].max()),
        ylim=(8.6, -0.6),
        xlabel=TIME.label,
        ylabel=CURVATURE.label,
        yticks=range(9),
    )
    ax.set_yticklabels(["flat plate", *SURFACES[1:]])
    ax.tick_params(left=False)
    for k in range(8):
        ax.axhline(k + 0.5, color="0.9", lw=0.6, zorder=0)
    outside = {"transform": ax.get_yaxis_transform(), "ha": "right"}
    rows = frame[frame["panel"] == "mean rate of the hold"]
    for label, rate in zip(rows["surface"], rows[GIVEN_RATE], strict=True):
        ax.text(1.062, place[label], f"{rate:.1f}", va="center", **outside)
    curvatures = rows.set_index("surface")[CURVATURE]
    for entry in frame[frame["source"].str.startswith(("stated", "measured"))].to_dict("records"):
        at = [
            float((curvatures - k).abs().argmin())
            for k in (entry[CURVATURE], entry[DOUBT])
            if k == k
        ]
        printed = f"{entry[GIVEN_RATE]:.1f}" + "?" * ("uncertain" in entry["source"])
        ax.text(1.135, np.mean(at), printed, va="center", color=style.GREY, **outside)
    outside |= {"fontsize": 6.5}
    ax.text(1.066, -0.62, "predicted", color=style.INK, va="bottom", **outside)
    ax.text(1.135, -0.62, "printed", color=style.GREY, va="bottom", **outside)
    ax.text(1.135, 8.75, "impulses/s", color=style.INK, va="top", **outside)
    upper.text(
        0.99,
        0.5,
        "predicted, not recorded",
        transform=upper.transAxes,
        ha="right",
        va="center",
        style="italic",
        color=style.GREY,
    )


def nine_frequencies(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """Nine traces of predicted frequency, labelled at the right, over the rates they are made
    from.
    """
    ends, both = {}, frame.assign(**{FREQUENCY: frame[[FREQUENCY, IMPULSE_RATE]].max(axis=1)})
    axs.limit_axis(ax, both[(both[TIME] <= 2) | both[TIME].isna()], FREQUENCY, text=False)
    for label in SURFACES:
        rows, look = frame[frame["surface"] == label], axs.look(label)
        rate, frequency = rows[rows["series"] == "rate"], rows[rows["series"] != "rate"]
        jump = int(np.flatnonzero(np.diff(rate[TIME]) == 0)[0]) + 1
        for leg in (rate[:jump], rate[jump:]):
            axs.curve(ax, leg, TIME, IMPULSE_RATE, whole=rate, lw=1.3, **look)
        often = np.interp(frequency[TIME], rate[TIME], rate[IMPULSE_RATE]) >= OFTEN
        ax.plot(
            frequency[TIME], frequency[FREQUENCY].where(often), ".", ms=2, **look | {"ls": "none"}
        )
        ends[label] = (2.0, float(np.interp(2.0, rate[TIME], rate[IMPULSE_RATE])))
    style.label_ends(ax, ends, 2.12, "curvature (1/m)")
    dots = f"dots: mean frequency of its impulses,\nwhere over {OFTEN} a second"
    stamp(ax, f"predicted, not recorded\nlines: rate\n{dots}", x=0.8, y=0.99, va="top")


def points_and_line(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """Named points of nine surfaces, the line through them, and recordings if there are any."""
    x, y = spec.x, spec.y[0]
    line = frame[frame["source"].str.contains("line")]
    ax.plot(line[x], line[y], color=style.GREY, lw=1, label=source_text(line))
    own = frame[frame["source"] == SIMULATED]
    points(ax, own, x, y)
    name_points(ax, own, x, y, line)
    mine = frame[frame["source"].str.startswith("measured")]
    if len(mine):
        ax.plot(mine[x], mine[y], "D", color=style.INK, ms=4.5, label="recorded")
    stamp(ax, "predicted")


def name_points(ax: Axes, rows: pd.DataFrame, x: str, y: str, line: pd.DataFrame) -> None:
    """Curvatures beside points, on the side away from the line; those at the same place share a
    label.
    """
    rows = rows.sort_values([x, y])
    place = rows[[x, y]].to_numpy() / np.array([np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())])
    groups = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(place, axis=0).T) > 0.03)])
    for _, group in rows.groupby(groups):
        at = group[[x, y]].mean()
        across, up = ax.transLimits.transform(at)
        floor = up < 0.1  # there the name is above the point
        above = floor or at[y] > np.interp(at[x], line[x], line[y])
        left = above and across > 0.08
        how = {
            "va": "bottom" if above else "top",
            "ha": "center" if floor else "right" if left else "left",
        }
        away = (0 if floor else -5 if left else 5, 4 if above else -4)
        ax.annotate(
            ", ".join(group["surface"]), at, away, textcoords="offset points", fontsize=6.5, **how
        )


def peak_and_steady_over_curvature(ax: Axes, frame: pd.DataFrame, spec: Figure) -> None:
    """Peak (triangles) and steady rate (crosses), dotted, with their lines."""
    own = frame[frame["source"] == SIMULATED]
    for column, marker, name in ((GIVEN_RATE, "^", "peak"), (STEADY_RATE, "P", "steady")):
        ax.plot(own[CURVATURE], own[column], ":", color=style.GREY, lw=0.9, zorder=1)
        points(ax, own, CURVATURE, column, marker=marker, s=38)
        line = frame[frame["source"].str.contains("line") & frame[column].notna()]
        ax.plot(line[CURVATURE], line[column], color=style.INK, lw=1)
        draw_given(ax, frame[frame[column].notna()], column)
        end = line.iloc[-1]
        ax.annotate(
            f"{name}: {source_text(line)}",
            (end[CURVATURE], end[column]),
            (0, 5),
            textcoords="offset points",
            ha="right",
            fontsize=6.5,
            color=style.INK,
        )
    kinds = [
        style.handle(f"{name} rate", ls=":", marker=m, color=style.INK)
        for m, name in (("^", "peak"), ("P", "steady"))
    ]
    ax.legend(handles=kinds + ax.get_legend_handles_labels()[0][:1], loc="upper left")
    stamp(ax)


def rate_over_width(ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
    """Time runs from right to left, as the contact grows."""
    axs.wide_limits(ax, rows, INVERSE_WIDTH, IMPULSE_RATE)
    own = rows[is_simulated(rows)]
    look = {"marker": "o", "ls": "-", "ms": 3, "lw": 0.8} | axs.look(own["surface"].iloc[0])
    axs.curve(ax, own, INVERSE_WIDTH, IMPULSE_RATE, **look)
    ends = {"width_top": own[IMPULSE_RATE].iloc[0], "width_end": own[IMPULSE_RATE].iloc[-1]}
    axs.draw_bands(ax, rows, INVERSE_WIDTH, None, lambda row: ends[row[OF]])
    ax.locator_params(axis="x", nbins=4)
    if own[IMPULSE_RATE].max() == 0:
        ax.text(
            0.5,
            0.2,
            "below the threshold:\nno impulses predicted",
            transform=ax.transAxes,
            ha="center",
            va="center",
            fontsize=6.5,
            color=style.GREY,
        )


def twelve_nodes(fig: Picture, frame: pd.DataFrame, spec: Figure) -> None:
    """Twelve panels: dotted simulated, solid and dashed by Eq 4-1."""
    axes = fig.subplots(4, 3, sharex=True, sharey=True)
    looks = {
        "simulated": (P, axs.look("210") | {"lw": 1.6}),
        "Eq 4-1, one set": (P_LAW, {"ls": style.DASHED, "lw": 1.0, "color": style.INK}),
        "Eq 4-1, a set for each": (
            P_LAW,
            {"ls": style.DOTTED, "lw": 1.0, "color": style.HIGHLIGHT},
        ),
    }
    wide = frame.assign(**{P: frame[P].fillna(frame[P_LAW])})
    nodes = frame[is_simulated(frame)].groupby(NODE)
    for k, (ax, (x, rows)) in enumerate(zip(axes.ravel(), nodes, strict=True)):
        for series, (column, look) in looks.items():
            own = rows[rows["series"] == series]
            axs.curve(
                ax,
                own if column == P else own.assign(**dict.fromkeys(PARTS, np.nan)),
                TIME,
                column,
                **look,
            )
        axs.limit_axis(ax, wide, P, marked=k == 5)
        style.in_kilo(ax.yaxis)
        ax.set(title=f"x = {x:.3g} mm", **HOLD)
    axes[3, 1].set_xlabel(TIME.label)
    axes[2, 0].set_ylabel("contact pressure (kPa)", y=1.15)
    names = {
        "Eq 4-1, one set": "Eq 4-1, one set of constants",
        "Eq 4-1, a set for each": "a set for each node",
    }
    style.header_legend(
        fig, [style.handle(names.get(name, name), **look) for name, (_, look) in looks.items()]
    )


def energy_and_law(ax: Axes, rows: pd.DataFrame, spec: Figure) -> None:
    """Points simulated, line by Eq 4-4, and what is left between them."""
    own = rows[is_simulated(rows)]
    axs.curve(
        ax,
        own,
        TIME,
        SED,
        marker="o",
        ls="none",
        ms=2.4,
        mfc="none",
        mew=0.7,
        **axs.look(own["surface"].iloc[0]),
    )
    ax.plot(own[TIME], own[SED_LAW], color=style.INK, lw=1)
    left = np.sqrt(np.mean((own[SED] - own[SED_LAW]) ** 2) / np.mean(own[SED] ** 2))
    ax.text(
        0.97,
        0.06,
        f"r.m.s. residual {left:.0%}",
        transform=ax.transAxes,
        ha="right",
        fontsize=6.5,
        color=style.GREY,
    )


def left_note(how: str) -> Callable[[pd.DataFrame], list[str]]:
    """The usual line, of what is in no panel of its own: the large panel at the left."""
    return lambda frame: axs.footnote(
        frame[frame["panel"].isna() | frame["panel"].isin(("600 um", "915 um"))], how
    )


@dataclass(frozen=True, kw_only=True)
class Beside:
    """Panels of predicted rates (values of ``panel``; None: what is in none), and at their right
    rates of others, with ours.
    """

    height: float
    fill: Callable[[Axes, pd.DataFrame], None]
    ratios: Sequence[float]
    others: Mapping[str, tuple[str, str]]
    names: Sequence[str | None] = (None,)
    legend: Mapping[str, object] = field(default_factory=lambda: {"loc": "upper left"})
    ylabel: str = GIVEN_RATE.label
    header: float = 0.0

    def draw(self, fig: Picture, frame: pd.DataFrame, spec: Figure) -> dict[object, Axes]:
        frame = frame if "panel" in frame else frame.assign(panel=np.nan)
        axes = fig.subplots(1, len(self.ratios), width_ratios=self.ratios)
        for ax, name in zip(axes, self.names, strict=False):
            ranges = frame["source"].str.contains("axis range")
            rows = frame[
                frame["panel"].isna() if name is None else (frame["panel"] == name) | ranges
            ]
            axs.wide_limits(ax, rows, CURVATURE, GIVEN_RATE)
            self.fill(ax, rows)
            ax.set(xlabel=CURVATURE.label, title=name.replace("um", "µm") if name else "")
            ax.legend(**self.legend)
        axes[0].set_ylabel(self.ylabel)
        for ax, (name, (title, mismatch)) in zip(
            axes[len(self.names) :], self.others.items(), strict=True
        ):
            beside(ax, frame[frame["panel"] == name], title, mismatch)
            ax.set_ylabel(f"mean rate, {title.partition(', ')[2]} (impulses/s)")
        return {}


def points_and_law(ax: Axes, rows: pd.DataFrame, words: str = "predicted by Eq 5-1") -> None:
    """Points by Eq 5-1, and a linear function as a line."""
    line = rows[rows["source"].str.contains("linear")]
    label = source_text(line).replace("peak energy", "peak\nenergy")
    ax.plot(line[CURVATURE], line[GIVEN_RATE], color=style.INK, lw=1.1, label=label)
    ax.plot([], [], "o", color=style.GREY, label=words)
    points(ax, rows[rows["source"].str.contains("Eq 5-1")], CURVATURE, GIVEN_RATE)
    draw_given(ax, rows)


def stamped_law(ax: Axes, rows: pd.DataFrame) -> None:
    points_and_law(ax, rows, "Eq 5-1, predicted from strain energy")
    stamp(ax)


def beside(ax: Axes, rows: pd.DataFrame, title: str, mismatch: str) -> None:
    """A panel of rates measured elsewhere or of another model (points), with ours of the same force
    (lines): how far apart they are.
    """
    ax.set_title(f"{title}\n{mismatch}")
    if rows.empty:
        ax.text(0.5, 0.5, "no rates given", transform=ax.transAxes, ha="center", color=style.GREY)
        return
    own, times = is_simulated(rows), []
    curves = dict(list(rows[own].groupby("series", sort=False))) if "series" in rows else {}
    fitted, curves = not curves, curves or {"linear in the pressure, fitted": rows[own]}
    for marker, (name, theirs) in zip(
        style.MARKERS, rows[~own].groupby("series", sort=False), strict=False
    ):
        same = [ours for ours in curves if ours.split()[-2:] == name.split()[-2:]] or list(curves)[
            :1
        ]
        look = style.look_of("force (gf)", _force(name), "color")
        look |= {"marker": marker, "ls": "none", "ms": 3.5, "clip_on": False, "zorder": 3}
        ax.plot(theirs[CURVATURE], theirs[GIVEN_RATE], **look, label=name)
        ours = curves[same[0]].sort_values(CURVATURE)
        at = np.interp(theirs[CURVATURE], ours[CURVATURE], ours[GIVEN_RATE])
        times += list((theirs[GIVEN_RATE] / at)[at > 1])
    for name, curve in curves.items():
        curve = curve.sort_values(CURVATURE)
        ax.plot(
            curve[CURVATURE],
            curve[GIVEN_RATE],
            **style.look_of("force (gf)", _force(name)),
            lw=1.1,
            label=name,
        )
    ax.set(
        xlim=(0, 1.04 * rows[CURVATURE].max()),
        ylim=(0, 1.6 * rows[GIVEN_RATE].max()),
        xlabel=CURVATURE.label,
    )
    far = f"theirs over ours: {np.median(times):.1f} (median)" if times and not fitted else ""
    ax.legend(
        title=far,
        alignment="left",
        loc="upper left",
        fontsize=6,
        handlelength=1.8,
        borderaxespad=0.2,
        labelspacing=0.3,
    )


def _force(name: str) -> str:
    """The force (gf) that a series names; 20 where it names none."""
    return next((force for force in ("10", "15") if f"{force} g" in name), "20")


def draw_rates(ax: Axes, frame: pd.DataFrame, spec: Figure | None = None) -> None:
    """Predicted rates against curvature, with what was recorded under the same protocol."""
    own = frame[is_simulated(frame) & frame["surface"].notna()]
    ax.plot(own[CURVATURE], own[GIVEN_RATE], color=style.GREY, lw=0.9, zorder=1)
    ax.plot([], [], "o-", color=style.GREY, lw=0.9, label="predicted by Eq 5-1")
    points(ax, own, CURVATURE, GIVEN_RATE)
    draw_given(ax, frame)
    stamp(ax, "points: predicted")


def of_rates(
    number: str, title: str, rows, layout, thesis: Mapping, runs=NINE, **options
) -> Figure:
    """A figure of rates over curvature, or of one rate over another."""
    options = {
        "how": OF_THE_LARGEST,
        "measured": RATES,
        "remarks": (DEEP,),
        "x": CURVATURE,
        "y": (GIVEN_RATE,),
    } | options
    return Figure(number, title, runs, thesis=thesis, layout=layout, rows=rows, **options)


def points_of(fill, legend: bool = True, **options) -> Panels:
    """One panel of points, on axes that hold all of them."""
    return Panels(
        height=3.0,
        limit="wide",
        fill=fill,
        legend={"loc": "upper left"} if legend else None,
        **options,
    )


def from_depth(number: str, depth: float, axis: str) -> Figure:
    """Figs 4-26 and 4-27."""
    words = f"{depth * 1e6:.0f} µm"
    title = f"Predicted mean rate of the hold from strain energy at {words}, 40 gf/s"
    return of_rates(
        number,
        title,
        partial(mean_rates, depth=depth),
        Beside(
            height=3.1,
            fill=draw_rates,
            ratios=(1.7, 1, 1),
            others={"published": GOODWIN, "TouchSim": ("TouchSim, steady", HALF_SPACE)},
        ),
        {GIVEN_RATE: axis, CURVATURE: "T202"},
        (NINE, *LOWER.values()),
        note=left_note(OF_THE_LARGEST),
        remarks=(LAW_NOTE, BESIDE),
    )


FIGURES = (
    Figure(
        "4-2",
        "Predicted impulses, 150 gf/s ramp to 20 gf, 2 s hold",
        FAST,
        TIME,
        (IMPULSE,),
        {FORCE: "T080"},
        Own(height=5.0, paint=trains),
        rows=trains_and_rates,
        measured=RATES,
        how="of the largest rate",
        remarks=(
            f"{LAW_NOTE}, strain energy 915 µm under the centre; integrate-and-fire, coefficient "
            "of variation of the "
            f"intervals {VARIATION} (assumed), seed {SEED}. Right: mean predicted rate of the "
            "hold; grey: rates printed "
            "beside the recordings in Fig. 4-2 of Cysyk (1999), from a scan, where a rate between "
            "two rows may belong to "
            "either.",
        ),
    ),
    Figure(
        "4-3",
        "Predicted instantaneous frequency, 40 gf/s ramp to 20 gf",
        NINE,
        TIME,
        (FREQUENCY,),
        {TIME: "T091", FREQUENCY: "T090"},
        Panels(height=3.4, fill=nine_frequencies, limit="", set={"xlim": (0, 2)}),
        rows=frequencies,
        remarks=(
            f"{DEEP} Thin: mean instantaneous frequency of {AVERAGED} trains of impulses "
            "(integrate-and-fire, "
            f"coefficient of variation {VARIATION}, assumed); wide: the rate they are made from.",
        ),
    ),
    of_rates(
        "4-4",
        "Predicted steady rate against peak rate, 40 gf/s ramp to 20 gf",
        steady_over_peak,
        points_of(points_and_line, xlabel=PEAK_WORDS),
        {GIVEN_RATE: "T094", STEADY_RATE: "T095"},
        x=GIVEN_RATE,
        y=(STEADY_RATE,),
        remarks=(STEADY_NOTE,),
    ),
    of_rates(
        "4-5",
        "Predicted peak and steady rates against curvature",
        over_curvature,
        points_of(
            peak_and_steady_over_curvature,
            False,
            xlabel="surface curvature (1/m)",
            ylabel="impulse rate (impulses/s)",
        ),
        {GIVEN_RATE: "T096", CURVATURE: "T162"},
        remarks=(STEADY_NOTE,),
    ),
    Figure(
        "4-9",
        "Predicted rate against the inverse of the contact width in the hold",
        NINE,
        INVERSE_WIDTH,
        (IMPULSE_RATE,),
        {
            INVERSE_WIDTH: WIDTH_IDS,
            IMPULSE_RATE: by_surface(
                "T107 T109 T111 T113 T117 T119 T121",
                ("flat", "79", "105", "158", "420", "630", "1260"),
            ),
        },
        nine(SURFACES, 5.8, fill=rate_over_width, limit=""),
        rows=rate_and_width,
        remarks=(f"{DEEP} Time runs leftwards: the contact grows.", OTHER_PADS),
        measured="pads",
        after=widths_of_other_pads,
    ),
    Figure(
        "4-17",
        "Pressure at twelve nodes and its decay by Eq 4-1, K = 210 1/m",
        K210,
        TIME,
        (P, P_LAW),
        {TIME: "T155", P: "T154"},
        Own(height=6.2, header=0.16, paint=twelve_nodes),
        rows=nodes_by_law,
        remarks=(
            "Eq 4-1, p = A1 / (distance to the contact's edge) + A2 (displacement below the "
            "edge's) + A3, from the peak "
            "of a node on; constants by least squares. Nodes count from one spacing inside the "
            "edge on.",
        ),
    ),
    of_rates(
        "4-18",
        "Predicted peak rate against peak contact pressure",
        peaks_over_pressure,
        points_of(points_and_line, ylabel=PEAK_WORDS),
        {P_PEAK: "T159", GIVEN_RATE: "T160"},
        x=P_PEAK,
        width=style.COLUMN_WIDTH,
    ),
    of_rates(
        "4-19",
        "Mean rate from mean contact pressure, against curvature",
        linear_in_pressure,
        Beside(height=3.1, fill=stamped_law, ratios=(1.55, 1), others={"published": GOODWIN}),
        {GIVEN_RATE: "T161", CURVATURE: "T162"},
        remarks=(
            f"{DEEP} Left: mean over the hold, as in the thesis, whose recorded rates are not "
            "public. Right: Goodwin, "
            "Browning and Wheat (1995), digitised by a third party, impulses in the first second "
            "at 20 gf; gain and "
            "threshold of the line fitted to them.",
        ),
    ),
    Figure(
        "4-22",
        "Strain energy density at 915 µm, and from contact pressure by Eq 4-4",
        NINE,
        TIME,
        (SED, SED_LAW),
        {SED: by_surface("T181 T182 T183 T184 T185 T186 T187a T187b T187c")},
        nine(SURFACES, 5.8, fill=energy_and_law, limit="y", set=HOLD | {"xlim": (0, 2.58)}),
        rows=energy_by_pressure,
        remarks=(
            "Points simulated; lines by Eq 4-4 with one set of constants for all nine surfaces.",
        ),
    ),
    of_rates(
        "4-25",
        "Predicted mean rate of the hold, 150 gf/s ramp to 20 gf",
        held_rates,
        points_of(draw_rates),
        {GIVEN_RATE: "T201", CURVATURE: "T202"},
        FAST,
        width=style.COLUMN_WIDTH,
        remarks=(
            f"{DEEP[:-1]}; nothing is fitted here. Squares: mean rates printed beside Fig. 4-2 of "
            "Cysyk (1999), read "
            "from a scan (17.0 without its point); a bar joins the two surfaces that a rate may "
            "belong to.",
        ),
    ),
    from_depth("4-26", RECEPTOR_DEPTH, "T203"),
    from_depth("4-27", SHALLOW_DEPTH, "T204"),
    of_rates(
        "4-29",
        "Predicted peak rate, and from the peak rate of strain energy, against curvature",
        peak_rates,
        Beside(
            height=3.1,
            fill=points_and_law,
            ratios=(1.25, 1.25, 1),
            names=("600 um", "915 um"),
            others={"TouchSim": ("TouchSim, first 200 ms", HALF_SPACE)},
            ylabel="peak rate (impulses/s)",
            legend={"loc": "lower right", "handlelength": 1.4},
        ),
        {GIVEN_RATE: "T207", CURVATURE: "T208"},
        (NINE, FAST),
        note=left_note(OF_THE_LARGEST),
        remarks=(LAW_NOTE, SCALED),
    ),
)

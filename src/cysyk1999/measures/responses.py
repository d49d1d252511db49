"""What receptors make of a history: samples for the laws, predicted rates, impulses, bursts.
Nothing here computes mechanics.

Functions take one history (see `fingerpad.results`) and return arrays in SI, or a tidy frame with
units in the column names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.energy_of_1999 import ELASTIC
from cysyk1999.measures.quantities import (
    BELOW_EDGE,
    BURST_IMPULSES,
    BURST_RATE,
    BURST_STROKES,
    BURST_TIME,
    BURST_WIDTH,
    COUNT,
    CURVATURE,
    DISTANCE,
    DOUBLE,
    DYNAMIC,
    EDGE_DISTANCE,
    FREQUENCY,
    IMPULSE_RATE,
    NODE,
    NODE_SPEED,
    P_LAW,
    RATE,
    SED,
    SED_LAW,
    SED_SQUARE,
    STATIC,
    TIME,
    TIME_ABOVE,
    P,
)
from cysyk1999.measures.runs import NINE
from cysyk1999.receptors.fits import (
    EQ_4_4,
    SQUARE,
    SkinSample,
    constant_shift,
    linear,
    r_squared,
    spatial_sum,
)
from fingerpad.measures.bursts import BIN, burst, is_double
from fingerpad.measures.features import (
    PRESSURE,
    Histories,
    centre_node,
    centre_pressure,
    energy,
    ramp_end,
    receptor_index,
    skin_at,
)
from fingerpad.measures.kept import kept
from fingerpad.measures.measure import speed_of, waves
from fingerpad.measures.strokes import FULL, convexities, distance, loaded, passages
from fingerpad.receptors.laws import (
    THESIS_RATE,
    ImpulseRate,
    SpatialSum,
    pressure_terms,
    rate_by_leg,
    time_above,
)
from fingerpad.receptors.spikes import VARIATION, binned_rate, instantaneous_frequency, trains
from fingerpad.results import scene_of

RECEPTOR_DEPTH = 915e-6
"""m; the depth that the thesis predicts impulse rates from."""

DEPTHS = tuple(d * 1e-6 for d in (560, 600, 640, 765, 800, 845, 870, 915, 960))
"""m; depths of the thesis's receptors, the first six in the epidermis."""
NODE_SURFACE, NODE_COUNT = "210", 12
"""Surface and number of nodes of Fig 4-17."""
NODE_SPACING = 67.2e-6
"""m; between the nodes of Fig 4-17 (Cysyk 1999), at whose places Eqs 4-1 to 4-3 are read on any
mesh.
"""
TRIALS = 4
"""Trials of a surface in Fig 4-2."""
SHALLOW_DEPTH = 600e-6
"""m; the depth that the thesis predicts the receptor of Fig 4-3 from."""
SEED = 1999
"""Of every predicted raster: the same pictures every time."""
ASIDE = 46e-6
"""m; to the right of the centre, where section 5.5 has one of its receptors."""
STROKES = 12
"""Repeated strokes that the thesis averages; of predicted ones its figures show the first."""
STROKES_SHOWN = {"5-1": 10, "5-22": 4, "5-27": 10}


def curvature_of(history: xr.Dataset) -> float:
    """Curvature (1/m) of a flat or cylindrical stimulus."""
    return getattr(scene_of(history).stimulus, "curvature", 0.0)


def is_stroke(history: xr.Dataset) -> bool:
    """Whether anything slid or was stepped."""
    return "stroke_distance" in history and bool(np.ptp(distance(history)) > 0)


def strokes(histories: Histories) -> dict[str, xr.Dataset]:
    """Histories of strokes over the wavy surface at a speed, by scene: those over most of it first,
    the slowest first.
    """
    scenes = {name: scene_of(history) for name, history in histories.items()}
    waved = [name for name, scene in scenes.items() if waves(scene)]

    def order(name: str) -> tuple[int, float]:
        return -len(scenes[name].stimulus.curvatures), speed_of(scenes[name])

    return {name: histories[name] for name in sorted(waved, key=order)}


# -- pressure and strain energy --------------------------------------------------------------------


def upper_skin(history: xr.Dataset) -> np.ndarray:
    """Indices of skin nodes from left to right, as far as anything ever touches and one node more
    on either side.
    """
    upper = np.flatnonzero(history["skin_y"].values > 0)
    upper = upper[np.argsort(history["skin_x"].values[upper])]
    touched = np.flatnonzero((history[PRESSURE].values[:, upper] > 0).any(axis=0))
    return upper[max(touched[0] - 1, 0) : touched[-1] + 2] if touched.size else upper


def sunk(history: xr.Dataset) -> np.ndarray:
    """Downward displacement (time) m of the skin over the receptor at the centre: its indentation.

    Under a pressed surface it is the indentation depth from first touch; under a stroked one it
    goes up and down with the surface, which the depth of the surface's frame does not.
    """
    return -history["skin_displacement_y"].values[:, centre_node(history)]


def skin_sample(
    history: xr.Dataset, depth: float, reference: np.ndarray | float = 0.0
) -> SkinSample:
    """Pressure on the skin and strain energy at a depth (m) under its centre, for Eq 4-4."""
    nodes = upper_skin(history)
    x, _ = skin_at(history)
    return SkinSample(
        x[:, nodes],
        history[PRESSURE].values[:, nodes],
        sunk(history),
        energy(history, depth),
        reference,
    )


def skin_shift(history: xr.Dataset) -> np.ndarray:
    """Lateral displacement (time) m of the skin over the receptor at the centre."""
    return history["centre_lateral_displacement"].values


LAWS_OF_SUM = {SED_LAW: EQ_4_4, SED_SQUARE: SQUARE}
"""Laws that predict the strain energy from the pressure (Fig 4-22), by their column."""


def fit_sum(
    histories: Iterable[xr.Dataset], depth: float, constants: Sequence[str] = EQ_4_4
) -> SpatialSum:
    """A law of pressure closest to the strain energy at a depth (m) under the centre of pressed
    surfaces.
    """
    return spatial_sum([skin_sample(history, depth) for history in histories], constants)


def laws_of_sum(histories: Histories, depth: float = RECEPTOR_DEPTH) -> dict[str, SpatialSum]:
    """`LAWS_OF_SUM`, each fitted to the nine pressed surfaces; KeyError if one is missing."""
    nine = [histories[scene] for scene in NINE.values()]
    return {column: fit_sum(nine, depth, law) for column, law in LAWS_OF_SUM.items()}


def stroke_laws(
    histories: Histories, depth: float = RECEPTOR_DEPTH
) -> dict[str, tuple[SpatialSum, float]]:
    """`laws_of_sum`, each with the constant shift (m) with which it comes closest to the stroke at
    10 mm/s.

    Raises KeyError if one of them was not simulated.
    """
    stroke = skin_sample(histories[FULL["10"]], depth)
    laws = laws_of_sum(histories, depth)
    return {column: (law, constant_shift(law, stroke)) for column, law in laws.items()}


def energy_from_pressure(
    history: xr.Dataset,
    depth: float,
    laws: Mapping[str, SpatialSum],
    shift: np.ndarray | float = 0.0,
) -> pd.DataFrame:
    """Strain energy density at a depth (m) as simulated and by laws of the pressure (Fig 4-22).

    laws: by the column of what they predict. shift: m, of the receptor to the side: a constant, or
    `skin_shift`.
    """
    sample = skin_sample(history, depth)
    by_law = {column: sample.by(law, shift) for column, law in laws.items()}
    frame = pd.DataFrame({TIME: history["time"].values, SED: sample.energy} | by_law)
    if is_stroke(history):
        frame[DISTANCE] = history["stroke_distance"].values * 1e3
    return frame


# -- nodes in contact, for Eqs 4-1 to 4-3 ----------------------------------------------------------


def node_places(count: int) -> np.ndarray:
    """Places (m) along the skin at rest of so many of the thesis's nodes, from the centre on."""
    return NODE_SPACING * np.arange(count)


def contact_nodes(history: xr.Dataset, count: int | None = None) -> pd.DataFrame:
    """Every output of every node of the thesis's that is in contact, from the centre to the right:
    what Eqs 4-1 to 4-3 relate.

    Nodes are left out while they are nearer to the contact's edge than one node spacing, since the
    inverse distance has no bound there; the edge that the thesis sees is itself a node.

    Parameters
    ----------
    count
        Of nodes from the centre on; left out, all that ever touch.

    Returns
    -------
    pd.DataFrame
        Columns time, node_x (undeformed), contact_pressure, distance to the contact's edge,
        displacement below that of the skin at the edge, downward speed, curvature of the surface,
        and ``ramp`` and ``past_peak`` (bool): up to the top of the ramp, and from the largest
        pressure of the node on.
    """
    nodes = upper_skin(history)
    skin = history["skin_x"].values[nodes]
    x_rest = node_places(count or 1 + int(skin[-1] / NODE_SPACING + 1e-9))

    def at_places(values: np.ndarray) -> np.ndarray:
        return np.array([np.interp(x_rest, skin, row) for row in values])

    everywhere = skin_at(history)[0][:, nodes]
    sunk = -history["skin_displacement_y"].values[:, nodes]
    x, down, pressure = map(at_places, (everywhere, sunk, history[PRESSURE].values[:, nodes]))
    time, top = history["time"].values, ramp_end(history)
    ramp, hold = (np.gradient(down[s], time[s], axis=0) for s in (slice(top + 1), slice(top, None)))
    speed = np.concatenate([ramp, hold[1:]])
    edge = history["contact_width"].values / 2
    at_edge = np.array([np.interp(*each) for each in zip(edge, everywhere, sunk, strict=True)])
    on = (pressure > 0) & (edge[:, None] - x >= NODE_SPACING)
    node, output = np.nonzero(on.T)  # every output of the first node, of the second, and so on
    columns = {
        TIME: time[output],
        NODE: x_rest[node] * 1e3,
        P: pressure[output, node],
        EDGE_DISTANCE: (edge[output] - x[output, node]) * 1e3,
        BELOW_EDGE: (down[output, node] - at_edge[output]) * 1e3,
        NODE_SPEED: speed[output, node] * 1e3,
        CURVATURE: curvature_of(history),
        "ramp": output <= top,
        "past_peak": output >= pressure.argmax(axis=0)[node],
    }
    return pd.DataFrame(columns)


def terms_of(law: str, nodes: pd.DataFrame) -> np.ndarray:
    """Terms (n, p) of Eq 4-1, 4-2 or 4-3 in SI, of rows of `contact_nodes`."""
    return pressure_terms(
        law,
        edge_distance=nodes[EDGE_DISTANCE].to_numpy() * 1e-3,
        displacement=nodes[BELOW_EDGE].to_numpy() * 1e-3,
        speed=nodes[NODE_SPEED].to_numpy() * 1e-3,
        curvature=nodes[CURVATURE].to_numpy(),
    )


LAW_ROWS: dict[str, Callable[[pd.DataFrame], pd.Series]] = {
    "4-1": lambda nodes: nodes["past_peak"],
    "4-1 read without an exponent": lambda nodes: nodes["past_peak"],
    "4-2": lambda nodes: nodes["ramp"],
    "4-3": lambda nodes: ~nodes["ramp"] & nodes["past_peak"],
}
"""Rows of `contact_nodes` that a law speaks of: from each node's peak on; during the ramp; during
the hold, from each node's peak on.
"""


def pressure_by_law(law: str, nodes: pd.DataFrame, constants: Sequence[float]) -> pd.DataFrame:
    """The rows of `contact_nodes` that a law speaks of, with the pressure it gives them (Fig
    4-17).
    """
    spoken_of = nodes[LAW_ROWS[law](nodes)]
    return spoken_of.assign(**{P_LAW: terms_of(law, spoken_of) @ np.asarray(constants)})


def fit_nodes(law: str, nodes: pd.DataFrame) -> np.ndarray:
    """Constants of Eq 4-1, 4-2 or 4-3 closest to the pressures of the rows of `contact_nodes` that
    it speaks of.
    """
    spoken_of = nodes[LAW_ROWS[law](nodes)]
    return linear(terms_of(law, spoken_of), spoken_of[P].to_numpy())


# -- rates and impulses ----------------------------------------------------------------------------


@kept
def predicted_rate(
    history: xr.Dataset,
    depth: float = RECEPTOR_DEPTH,
    law: ImpulseRate = THESIS_RATE,
    offset: float = 0.0,
) -> pd.DataFrame:
    """Impulse rate of a slowly adapting receptor by Eq 4-5 or 5-1 at a depth (m) under the centre,
    or at an offset (m) beside.

    Returns
    -------
    pd.DataFrame
        Columns time, strain energy, its rate, what each contributes, and the rate (impulses/s); for
        a stroke the stroke distance too. The time of a kink between legs is there twice (see
        `fingerpad.receptors.laws.rate_by_leg`).
    """
    time, values, rate = _by_leg(history, energy(history, depth, offset))
    static, dynamic = law.terms(values, rate)
    columns = {
        TIME: time,
        SED: values,
        RATE: rate,
        STATIC: static,
        DYNAMIC: dynamic,
        IMPULSE_RATE: law(values, rate),
    }
    if is_stroke(history):
        slid = history["stroke_distance"].values * 1e3
        columns[DISTANCE] = np.interp(time, history["time"].values, slid)
    return pd.DataFrame(columns)


def _by_leg(history: xr.Dataset, values: np.ndarray) -> tuple[np.ndarray, ...]:
    return rate_by_leg(history["time"].values, values, history["leg"].values)


def raster(
    frame: pd.DataFrame, repetitions: int, seed: int, variation: float = VARIATION
) -> pd.DataFrame:
    """Predicted impulses of repeated trials at a predicted rate: one row an impulse, columns trial
    (from 1), time, stroke distance.
    """
    time = frame[TIME].to_numpy()
    impulses = trains(time, frame[IMPULSE_RATE].to_numpy(), repetitions, seed, variation)
    out = pd.concat(
        [pd.DataFrame({"trial": k, TIME: train}) for k, train in enumerate(impulses, start=1)],
        ignore_index=True,
    )
    if DISTANCE in frame:
        out[DISTANCE] = np.interp(out[TIME], time, frame[DISTANCE])
    return out


@kept
def impulses_of(
    stroke: xr.Dataset, depth: float = RECEPTOR_DEPTH, law: ImpulseRate = THESIS_RATE
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Predicted rate of a stroke from where it begins to slide, and the impulses of `STROKES`
    repetitions of it (`raster`): those of every figure and number of a stroke.
    """
    frame = predicted_rate(loaded(stroke), depth, law)
    return frame, raster(frame, STROKES, SEED)


def plate_rate(stroke: xr.Dataset, offset: float = ASIDE) -> pd.DataFrame:
    """Predicted rate of a receptor beside the centre while a plate slides, stroke distances counted
    up either way.
    """
    rate = predicted_rate(loaded(stroke), RECEPTOR_DEPTH, offset=offset)
    return rate.assign(**{DISTANCE: rate[DISTANCE].abs()})


def stroke_histogram(
    frame: pd.DataFrame,
    impulses: pd.DataFrame,
    repetitions: int = STROKES,
    bin_width: float = BIN,
) -> pd.DataFrame:
    """Impulses of a raster in bins of the stroke distance (m): columns stroke_distance (of the
    bin's middle), impulses (of all strokes), predicted_rate (mean).

    Only whole bins while the surface slides. frame: of `predicted_rate`. impulses: of `raster`, of
    so many `repetitions`.
    """
    slides = np.concatenate([[False], np.diff(frame[DISTANCE].to_numpy()) > 0])
    slides[:-1] |= slides[1:]
    distance, time = frame[DISTANCE].to_numpy()[slides] * 1e-3, frame[TIME].to_numpy()[slides]
    edges = np.arange(distance[0], distance[-1] + 1e-9, bin_width)
    times = np.interp(edges, distance, time)
    rate = binned_rate([impulses[TIME].to_numpy()], times)  # of all strokes together
    columns = {DISTANCE: (edges[1:] + edges[:-1]) / 2 * 1e3, COUNT: np.rint(rate * np.diff(times))}
    return pd.DataFrame(columns | {IMPULSE_RATE: rate / repetitions})


def mean_frequency(impulses: pd.DataFrame, repetitions: int, at: np.ndarray) -> pd.DataFrame:
    """Instantaneous frequency of a raster, mean over its trials, at times `at` (s): columns time,
    predicted_frequency.
    """
    by_trial = impulses.groupby("trial")[TIME]
    values = [instantaneous_frequency(train.to_numpy(), at) for _, train in by_trial]
    return pd.DataFrame({TIME: at, FREQUENCY: np.sum(values, axis=0) / repetitions})


def time_mean(time, values, start: float | None = None, end: float | None = None) -> float:
    """Mean over time of a trace from `start` to `end` (s; left out, its ends), linear between
    samples, jumps where a time is twice.
    """
    time, values = np.asarray(time, float), np.asarray(values, float)
    a, b = time[0] if start is None else start, time[-1] if end is None else end
    inside = (time > a) & (time < b)
    t = np.concatenate([[a], time[inside], [b]])
    # on the side of a jump that lies within the window
    left = values[time == a][-1] if (time == a).any() else np.interp(a, time, values)
    right = values[time == b][0] if (time == b).any() else np.interp(b, time, values)
    y = np.concatenate([[left], values[inside], [right]])
    return float((np.diff(t) * (y[1:] + y[:-1]) / 2).sum() / (b - a))


def windowed(history: xr.Dataset, time, values, window: str) -> float:
    """A trace's number for a window of `cysyk1999.receptors.recordings.WINDOWS`; "steady" is the
    last half of the hold.
    """
    time, values = np.asarray(time), np.asarray(values)
    top, end = history.variables["time"].values[[ramp_end(history), -1]].tolist()
    if window == "peak":
        return float(values.max())
    start, stop = {
        "hold": (top, end),
        "steady": ((top + end) / 2, end),
        "first second": (0.0, 1.0),
        "first 200 ms": (0.0, 0.2),
    }[window]
    return time_mean(time, values, start, min(stop, end))


def rate_in(
    history: xr.Dataset, window: str, depth: float = RECEPTOR_DEPTH, law: ImpulseRate = THESIS_RATE
) -> float:
    """Predicted impulse rate (impulses/s) in a window of
    `cysyk1999.receptors.recordings.WINDOWS`.
    """
    frame = predicted_rate(history, depth, law)
    return windowed(history, frame[TIME], frame[IMPULSE_RATE], window)


def peak_energy_rate(history: xr.Dataset, depth: float) -> float:
    """Largest rate of the strain energy, Pa/s."""
    return float(predicted_rate(history, depth)[RATE].max())


def mean_pressure(history: xr.Dataset, window: str = "hold") -> float:
    """Mean pressure at the centre (Pa) in a window."""
    return windowed(history, history["time"].values, centre_pressure(history), window)


def law_at(runs: Histories, depth: float) -> tuple[ImpulseRate, float]:
    """Eq 5-1 at a depth (m), and the factor that its energies are multiplied by; runs: histories by
    scene, the nine pressed surfaces (`NINE`) among them. Raises KeyError for one that is not there.

    The thesis's constants belong to 915 um, where the factor is 1; it prints none for 560 or 600
    um. Energies at another depth are multiplied by one number, with which the mean over the nine
    surfaces of the mean energy in the hold is that at 915 um: what differs is how they depend on
    curvature. So are all rates that are predicted from another depth, pressed (Figs 4-27, 4-29) and
    stroked (5-22, 5-23).
    """
    law, factor = THESIS_RATE, 1.0
    if depth != RECEPTOR_DEPTH:
        held = [runs[scene] for scene in NINE.values()]
        deep, shallow = (
            np.mean([windowed(h, h["time"].values, energy(h, z), "hold") for h in held])
            for z in (RECEPTOR_DEPTH, depth)
        )
        factor = float(deep / shallow)
    thresholds = law.threshold / factor, law.rate_threshold / factor
    return ImpulseRate(law.per_energy * factor, law.per_rate * factor, *thresholds), factor


def straight_line(x, y) -> tuple[float, float, float]:
    """Slope, intercept and R2 of the least-squares line."""
    slope, offset = np.polyfit(x, y, 1)
    return float(slope), float(offset), r_squared(np.asarray(y), slope * np.asarray(x) + offset)


# -- bursts ----------------------------------------------------------------------------------------


@kept
def bursts(
    history: xr.Dataset, depth: float = RECEPTOR_DEPTH, law: ImpulseRate = THESIS_RATE
) -> pd.DataFrame:
    """The burst that each convexity of a stroked surface evokes in the predicted strokes of
    `impulses_of` (Figs 5-2 to 5-4, 5-16, 5-17, 5-22), by `fingerpad.measures.bursts.burst`: what a
    recording would be asked.

    Returns
    -------
    pd.DataFrame
        One row a convexity, in its `fingerpad.measures.strokes.passages`: its label and curvature;
        width, duration (width by velocity), rate, impulses and strokes of its burst; how many of
        the strokes that Fig 5-22 shows are two bursts; how long the strain energy is above the
        threshold of the law; the largest strain energy, energy rate and predicted rate.
    """
    rate, impulses = impulses_of(history, depth, law)
    trains = [1e-3 * impulses.loc[impulses["trial"] == k + 1, DISTANCE] for k in range(STROKES)]
    speed, rows = speed_of(scene_of(history)), []
    arcs = convexities(history)
    for label, (start, end) in passages(loaded(history)).items():
        part = rate[rate[DISTANCE].between(1e3 * start, 1e3 * end)]
        found = burst(trains, speed, start, end)
        shown = (train[train.between(start, end)] for train in trains[: STROKES_SHOWN["5-22"]])
        rows.append(
            {
                "convexity": label,
                CURVATURE: arcs[label].curvature,
                BURST_WIDTH: 1e3 * found.width,
                BURST_TIME: found.width / speed,
                BURST_RATE: found.rate,
                BURST_IMPULSES: found.impulses,
                BURST_STROKES: found.strokes,
                DOUBLE: sum(map(is_double, shown)),
                TIME_ABOVE: time_above(part[TIME], part[SED], law.threshold),
                f"largest {SED}": part[SED].max(),
                f"largest {RATE}": part[RATE].max(),
                f"largest {IMPULSE_RATE}": part[IMPULSE_RATE].max(),
            }
        )
    return pd.DataFrame(rows)


def burst_values(
    stroke: xr.Dataset,
    column: str,
    depth: float = RECEPTOR_DEPTH,
    law: ImpulseRate = THESIS_RATE,
) -> dict[str, float]:
    """A column of `bursts` by the convexity's label."""
    found = bursts(stroke, depth, law)
    return dict(zip(found["convexity"], found[column], strict=True))


def stimulus(history: xr.Dataset, name: str, depth: float) -> np.ndarray:
    """A candidate stimulus (time) of a receptor at a depth (m) under the centre, or on the skin
    over it: see `CANDIDATES`.
    """
    values = history.variables[CANDIDATES[name][0]].values
    return values[:, receptor_index(history, depth)] if values.ndim == 2 else values


CANDIDATES = {
    "strain energy, formula of plane stress": ("strain_energy_density", "Pa", True),
    "strain energy, instantaneous elastic": (ELASTIC, "Pa", True),
    "strain energy, long-term moduli": ("strain_energy_long_term_moduli", "Pa", True),
    "strain energy, half stress x strain": ("strain_energy_half_stress_strain", "Pa", True),
    "strain energy, recoverable": ("strain_energy_recoverable", "Pa", True),
    "strain energy, long-term network": ("strain_energy_network", "Pa", True),
    "compressive strain": ("compressive_strain", "1", True),
    "tensile strain": ("tensile_strain", "1", True),
    "von Mises stress": ("von_mises_stress", "Pa", True),
    # and dilatation, which is a fixed multiple of it
    "hydrostatic pressure": ("hydrostatic_pressure", "Pa", True),
    "contact pressure, centre": ("centre_pressure", "Pa", False),
    "contact pressure, peak": ("peak_pressure", "Pa", False),
    "indentation depth": ("indentation_depth", "m", False),
}
"""Candidate stimuli -> variable of a history, unit, and whether it is taken at a depth."""

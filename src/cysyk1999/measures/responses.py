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

from cysyk1999.measures.quantities import (
    BELOW_EDGE,
    BURST_RATE,
    BURST_TIME,
    BURST_WIDTH,
    CURVATURE,
    DISTANCE,
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
    STATIC,
    TIME,
    P,
)
from cysyk1999.measures.runs import NINE
from cysyk1999.receptors.fits import SkinSample, constant_shift, linear, r_squared, spatial_sum
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
from fingerpad.measures.skin import skin_curvature
from fingerpad.measures.strokes import FULL, convexities, distance, loaded, passage, place
from fingerpad.receptors.laws import (
    THESIS_RATE,
    ImpulseRate,
    SpatialSum,
    pressure_terms,
    rate_by_leg,
    time_above,
)
from fingerpad.receptors.rapidly_adapting import RapidlyAdapting
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
STROKES_SHOWN = {"5-1": 10, "5-19": 12, "5-22": 4, "5-23": 12, "5-27": 10}
"""Repeated strokes that the thesis's figures show or average."""
BIN = 0.5e-3
"""m; bins of the thesis's histograms over a stroke."""


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


def fit_sum(histories: Iterable[xr.Dataset], depth: float, with_depth: bool = True) -> SpatialSum:
    """Eq 4-4 closest to the strain energy at a depth (m) under the centre of pressed surfaces."""
    return spatial_sum([skin_sample(history, depth) for history in histories], with_depth)


def stroke_law(histories: Histories, depth: float = RECEPTOR_DEPTH) -> tuple[SpatialSum, float]:
    """Eq 4-4 of the nine pressed surfaces, and the constant shift (m) with which it comes closest
    to the stroke at 10 mm/s.

    Raises KeyError if one of them was not simulated.
    """
    law = fit_sum([histories[scene] for scene in NINE.values()], depth)
    return law, constant_shift(law, skin_sample(histories[FULL["10"]], depth))


def energy_from_pressure(
    history: xr.Dataset, depth: float, law: SpatialSum, shift: np.ndarray | float = 0.0
) -> pd.DataFrame:
    """Strain energy density at a depth (m) as simulated and by Eq 4-4 (Figs 4-22 and 5-14).

    shift: m, of the receptor to the side: a constant, or `skin_shift`.
    """
    sample = skin_sample(history, depth)
    time, by_law = history["time"].values, sample.by(law, shift)
    frame = pd.DataFrame({TIME: time, SED: sample.energy, SED_LAW: by_law})
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


def rapidly_adapting_rate(history: xr.Dataset, law: RapidlyAdapting) -> pd.DataFrame:
    """Impulse rate of a rapidly adapting receptor from the rate of the skin's curvature at the
    centre: columns time, curvature (1/m, of the deformed skin), its rate, and the impulse rate.
    """
    values = skin_curvature(history, centre_node(history))
    time, values, rate = _by_leg(history, values)
    columns = {TIME: time, CURVATURE: values, "curvature_rate (1/m/s)": rate}
    return pd.DataFrame({**columns, IMPULSE_RATE: law(rate)})


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


def impulses_of(
    history: xr.Dataset,
    repetitions: int,
    depth: float = RECEPTOR_DEPTH,
    law: ImpulseRate = THESIS_RATE,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Predicted rate of a stroke from where it begins to slide, and the impulses of some
    repetitions of it.
    """
    frame = predicted_rate(loaded(history), depth, law)
    return frame, raster(frame, repetitions, SEED)


def plate_rate(stroke: xr.Dataset, offset: float = ASIDE) -> pd.DataFrame:
    """Predicted rate of a receptor beside the centre while a plate slides, stroke distances counted
    up either way.
    """
    rate = predicted_rate(loaded(stroke), RECEPTOR_DEPTH, offset=offset)
    return rate.assign(**{DISTANCE: rate[DISTANCE].abs()})


def stroke_histogram(
    frame: pd.DataFrame, impulses: pd.DataFrame, repetitions: int, bin_width: float = BIN
) -> pd.DataFrame:
    """Mean rate of a raster in bins of the stroke distance (m): columns stroke_distance (of the
    bin's middle), predicted_rate.

    Only whole bins while the surface slides. frame: of `predicted_rate`. impulses: of `raster`, of
    so many `repetitions`.
    """
    slides = np.concatenate([[False], np.diff(frame[DISTANCE].to_numpy()) > 0])
    slides[:-1] |= slides[1:]
    distance, time = frame[DISTANCE].to_numpy()[slides] * 1e-3, frame[TIME].to_numpy()[slides]
    edges = np.arange(distance[0], distance[-1] + 1e-9, bin_width)
    rate = binned_rate([impulses[TIME].to_numpy()], np.interp(edges, distance, time)) / repetitions
    return pd.DataFrame({DISTANCE: (edges[1:] + edges[:-1]) / 2 * 1e3, IMPULSE_RATE: rate})


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


def shallow_law(
    histories: Mapping[str, xr.Dataset], depth: float = SHALLOW_DEPTH
) -> tuple[ImpulseRate, float]:
    """Eq 5-1 for another depth (m) than the thesis's, and the factor its energies are multiplied
    by; histories: of the nine.

    The thesis's constants belong to 915 um and it prints none for 560 or 600 um. Energies there are
    scaled by one number, with which the mean over surfaces of the mean energy in the hold is the
    same at both depths: what differs is how they depend on curvature. So do all rates that are
    predicted from another depth, pressed (Figs 4-27, 4-29) and stroked (5-22, 5-23).
    """
    deep, shallow = (
        np.mean([windowed(h, h["time"].values, energy(h, z), "hold") for h in histories.values()])
        for z in (RECEPTOR_DEPTH, depth)
    )
    factor, law = float(deep / shallow), THESIS_RATE
    thresholds = law.threshold / factor, law.rate_threshold / factor
    return ImpulseRate(law.per_energy * factor, law.per_rate * factor, *thresholds), factor


def straight_line(x, y) -> tuple[float, float, float]:
    """Slope, intercept and R2 of the least-squares line."""
    slope, offset = np.polyfit(x, y, 1)
    return float(slope), float(offset), r_squared(np.asarray(y), slope * np.asarray(x) + offset)


# -- bursts ----------------------------------------------------------------------------------------


@kept
def bursts(
    history: xr.Dataset,
    depth: float = RECEPTOR_DEPTH,
    law: ImpulseRate = THESIS_RATE,
    threshold: float | None = None,
) -> pd.DataFrame:
    """The burst that each convexity of a stroked surface makes (Figs 5-2 to 5-4, 5-16 and 5-17).

    A convexity passes while the point of the skin over the receptor is between the middles of the
    hollows on either side of it (the flats count up to where the first arc begins and the last one
    ends, and as far again as the half of the arc). Its burst is the time in that passage during
    which the strain energy is above `threshold` (Pa; left out, that of the law), crossings found
    between outputs; width is that time by the stroking velocity. The burst rate is the mean
    predicted rate over that time: impulses over duration.

    Returns
    -------
    pd.DataFrame
        One row a convexity: its label and curvature, burst width, duration and rate, the largest
        strain energy, energy rate and impulse rate.
    """
    frame = predicted_rate(history, depth, law)
    level = law.threshold if threshold is None else threshold
    moving = frame[DISTANCE].to_numpy() > frame[DISTANCE].iloc[0]
    frame = frame[moving]
    time, distance = frame[TIME].to_numpy(), frame[DISTANCE].to_numpy() * 1e-3
    speed = (distance[-1] - distance[0]) / (time[-1] - time[0])
    under = np.interp(time, history["time"].values, place(history))
    rows = []
    for label, arc in convexities(history).items():
        start, end = passage(history, arc, beyond=0.5)
        part = frame[(under >= start) & (under <= end)]
        if len(part) < 2:
            continue
        t, value, rate = part[TIME].to_numpy(), part[SED].to_numpy(), part[IMPULSE_RATE].to_numpy()
        duration = time_above(t, value, level)
        # the rate while the energy is above the level
        fine = np.linspace(t[0], t[-1], 20 * len(t))
        above = np.interp(fine, t, value) > level
        rows.append(
            {
                "convexity": label,
                CURVATURE: arc.curvature,
                BURST_TIME: duration,
                BURST_WIDTH: duration * speed * 1e3,
                BURST_RATE: float(np.interp(fine, t, rate)[above].mean()) if above.any() else 0.0,
                f"largest {SED}": float(value.max()),
                f"largest {RATE}": float(part[RATE].max()),
                f"largest {IMPULSE_RATE}": float(rate.max()),
            }
        )
    return pd.DataFrame(rows)


def burst_values(stroke: xr.Dataset, column: str) -> dict[str, float]:
    """A column of `bursts` by the convexity's label."""
    found = bursts(stroke)
    return dict(zip(found["convexity"], found[column], strict=True))


def stimulus(history: xr.Dataset, name: str, depth: float) -> np.ndarray:
    """A candidate stimulus (time) of a receptor at a depth (m) under the centre, or on the skin
    over it: see `CANDIDATES`.
    """
    values = history.variables[CANDIDATES[name][0]].values
    return values[:, receptor_index(history, depth)] if values.ndim == 2 else values


CANDIDATES = {
    "strain energy, instantaneous elastic": ("strain_energy_density", "Pa", True),
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

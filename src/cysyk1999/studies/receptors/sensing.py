"""Receptors beside the thesis's: a tactile sensor that knows the contact pressure only, and rapidly
adapting receptors.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from cysyk1999.measures.quantities import TIME
from cysyk1999.measures.responses import (
    IMPULSE_RATE,
    RECEPTOR_DEPTH,
    fit_sum,
    is_stroke,
    predicted_rate,
    rapidly_adapting_rate,
    skin_sample,
    strokes,
)
from cysyk1999.measures.runs import FAST, LOWER, NINE
from cysyk1999.receptors.fits import constant_shift
from cysyk1999.receptors.sensor import TactileSensor, taxel_pressure
from fingerpad.measures.features import Histories, ramp_end
from fingerpad.receptors.laws import THESIS_RATE, SpatialSum
from fingerpad.receptors.rapidly_adapting import ASSUMED_RATE, RapidlyAdapting
from fingerpad.receptors.spikes import integrated

PITCHES = (0.5e-3, 1.0e-3)
"""m; spacings of sensor arrays."""


def sensor_accuracy(histories: Histories) -> pd.DataFrame:
    """Impulse rates of the tactile sensor against those of the full model, Eq 5-1 on the simulated
    strain energy, scene by scene.

    The sensor's sum is fitted to the nine surfaces at 40 gf/s; all else is new to it. It is given
    the pressure at the pad's nodes where they are, with and without the depth of indentation, and
    the mean pressure on the faces of coarser arrays that stay in place.

    Returns:
        One row a scene and array: what the sensor knows, spacing, root-mean-square and largest
        error of the rate, both in impulses/s, the same over the full model's, and impulses of
        either over the scene.

    Raises:
        ValueError: no surface was pressed at 40 gf/s, so there is nothing to fit the sum to.
    """
    surfaces = NINE.histories(histories)
    if not surfaces:
        raise ValueError(
            "the sensor's constants are fitted to scenes ramp40_*; there is none among the "
            "histories"
        )
    laws = {
        True: fit_sum(surfaces.values(), RECEPTOR_DEPTH),
        False: fit_sum(surfaces.values(), RECEPTOR_DEPTH, with_depth=False),
    }
    chosen = {
        runs[k]: history
        for runs in (NINE, FAST, *LOWER.values())
        for k, history in runs.histories(histories).items()
    }
    chosen |= strokes(histories)
    shift = None
    if "stroke_10" in chosen:
        shift = constant_shift(laws[True], skin_sample(chosen["stroke_10"], RECEPTOR_DEPTH))
    rows = []
    for name, history in chosen.items():
        sample, time = skin_sample(history, RECEPTOR_DEPTH), history["time"].values
        full = predicted_rate(history)
        true = np.interp(time, full[TIME], full[IMPULSE_RATE])
        count = float(integrated(full[TIME], full[IMPULSE_RATE])[-1])
        arrays = [
            ("pressure and indentation", None),
            ("pressure", None),
            *(("pressure", pitch) for pitch in PITCHES),
        ]
        if is_stroke(history) and shift is not None:
            arrays.insert(0, ("pressure, indentation and shift", None))
        for knows, pitch in arrays:
            where = shift if "shift" in knows else 0.0
            rate = _sensed(
                sample, time, laws["indentation" in knows], "indentation" in knows, pitch, where
            )
            # the sensor's rate is that of the interval behind it
            middle = (time[1:] + time[:-1]) / 2
            own = np.interp(middle, full[TIME], full[IMPULSE_RATE])
            off = rate[1:] - own
            rows.append(
                {
                    "scene": name,
                    "knows": knows,
                    "spacing (mm)": 1e3 * (pitch or float(np.median(np.diff(sample.x[0])))),
                    "fitted to": "this and eight more"
                    if name in NINE.scenes.values()
                    else "ramp40",
                    "rms_error (impulses/s)": _weighted_rms(off, time),
                    "rms_error (% of the rms rate)": 100
                    * _weighted_rms(off, time)
                    / max(_weighted_rms(own, time), 1e-12),
                    "largest_error (impulses/s)": float(np.abs(off).max()),
                    "largest rate (impulses/s)": float(true.max()),
                    "impulses": float((rate[1:] * np.diff(time)).sum()),
                    "impulses of the full model": count,
                }
            )
    return pd.DataFrame(rows)


def _weighted_rms(values, time) -> float:
    """Root mean square over time of values (n - 1,) of the intervals between times (n,)."""
    return float(np.sqrt((values**2 * np.diff(time)).sum() / (time[-1] - time[0])))


def _sensed(
    sample, time, law: SpatialSum, with_depth: bool, pitch: float | None, shift: float
) -> np.ndarray:
    """Rates (time) of a sensor at the pad's nodes (they move: a new sensor a frame would be one),
    or of an array of a pitch (m).
    """
    if pitch is None:
        energy = law.strain_energy(
            sample.x, sample.pressure, sample.indentation if with_depth else 0.0, shift
        )
        change = np.concatenate([[0.0], np.diff(energy) / np.diff(time)])
        return THESIS_RATE(energy, change)
    reach = pitch * (np.ceil(np.abs(sample.x).max() / pitch) + 0.5)
    edges = np.arange(-reach, reach + pitch / 2, pitch)
    sensor = TactileSensor((edges[1:] + edges[:-1]) / 2, law)
    return sensor.rates(
        time,
        taxel_pressure(sample.x, sample.pressure, edges),
        sample.indentation if with_depth else 0.0,
    )


RAPIDLY_ADAPTING = {
    "curvature of the skin": (
        "curvature",
        RapidlyAdapting(threshold=500.0, scale=500.0, highest=100.0),
    ),
    "strain energy at 600 um": ("energy", ASSUMED_RATE),
}
"""Stimulus whose rate drives the receptor -> its key and law; thresholds, scales and the highest
rate are assumed, nothing at hand states them.
"""


def rapidly_adapting(histories: Histories) -> pd.DataFrame:
    """What the thesis reports of rapidly adapting receptors, asked of two laws: only at the ramp's
    beginning? whatever the curvature?

    Returns:
        One row a law and surface: impulses during the ramp and the hold, when the response ends as
        a share of the ramp (the end of the last output interval with a rate, so to within an output
        step), the largest rate.
    """
    rows = []
    for name, (key, law) in RAPIDLY_ADAPTING.items():
        for label, history in NINE.histories(histories).items():
            frame = rapidly_adapting_rate(history, law, key)
            time, rate = frame[TIME].to_numpy(), frame[IMPULSE_RATE].to_numpy()
            top = float(history["time"].values[ramp_end(history)])
            split = int(np.flatnonzero(time == top)[0]) + 1
            counts = [
                float(integrated(time[part], rate[part])[-1])
                for part in (slice(0, split), slice(split, None))
            ]
            last = np.flatnonzero(rate > 1e-6)
            ends = time[min(last[-1] + 1, len(time) - 1)] / top if len(last) else 0.0
            row = {
                "responds to the rate of": name,
                "surface": label,
                "impulses in the ramp": counts[0],
                "impulses in the hold": counts[1],
            }
            rows.append(
                row
                | {
                    "response ends (share of the ramp)": ends,
                    "largest rate (impulses/s)": float(rate.max()),
                }
            )
    return pd.DataFrame(rows)

"""Accuracy of a tactile sensor that knows the contact pressure only."""

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
    skin_sample,
    strokes,
)
from cysyk1999.measures.runs import FAST, LOWER, NINE
from cysyk1999.receptors.fits import EQ_4_4, PRESSURE_ONLY, SQUARE, SkinSample, constant_shift
from cysyk1999.receptors.sensor import TactileSensor, taxel_pressure
from fingerpad.measures.features import Histories
from fingerpad.receptors.laws import THESIS_RATE, SpatialSum
from fingerpad.receptors.spikes import integrated

PITCHES = (0.5e-3, 1.0e-3)
"""m; spacings of sensor arrays."""


def sensor_accuracy(histories: Histories) -> pd.DataFrame:
    """Impulse rates of the tactile sensor against those of the full model, Eq 5-1 on the simulated
    strain energy, scene by scene.

    The sensor's sum is fitted to the nine surfaces at 40 gf/s; all else is new to it. It is given
    the pressure at the pad's nodes where they are, with and without the depth of indentation, and
    the mean pressure on the faces of coarser arrays that stay in place.

    Returns
    -------
    DataFrame
        One row a scene and array: what the sensor knows, spacing, root-mean-square and largest
        error of the rate, both in impulses/s, the same over the full model's, and impulses of
        either over the scene.

    Raises
    ------
    ValueError
        No surface was pressed at 40 gf/s, so there is nothing to fit the sum to.
    """
    surfaces = NINE.histories(histories)
    if not surfaces:
        raise ValueError(
            "the sensor's constants are fitted to scenes ramp40_*; there is none among the "
            "histories"
        )
    with_depth, without, square = (
        fit_sum(surfaces.values(), RECEPTOR_DEPTH, law) for law in (EQ_4_4, PRESSURE_ONLY, SQUARE)
    )
    chosen = {
        runs[k]: history
        for runs in (NINE, FAST, *LOWER.values())
        for k, history in runs.histories(histories).items()
    } | strokes(histories)
    shift = None
    if "stroke_10" in chosen:
        shift = constant_shift(with_depth, skin_sample(chosen["stroke_10"], RECEPTOR_DEPTH))
    rows = []
    for name, history in chosen.items():
        sample, time = skin_sample(history, RECEPTOR_DEPTH), history["time"].values
        full = predicted_rate(history)
        step = np.diff(time)
        # the sensor's rate is that of the interval behind it
        own = np.interp(time[:-1] + step / 2, full[TIME], full[IMPULSE_RATE])
        spacing = float(np.median(np.diff(sample.x[0])))
        arrays = [
            ("pressure and indentation", spacing, _at_nodes(sample, time, with_depth)),
            ("pressure", spacing, _at_nodes(sample, time, without)),
            ("pressure, its sum squared", spacing, _at_nodes(sample, time, square)),
            *(("pressure", pitch, _on_array(sample, time, without, pitch)) for pitch in PITCHES),
        ]
        if is_stroke(history) and shift is not None:
            rate = _at_nodes(sample, time, with_depth, shift)
            arrays.insert(0, ("pressure, indentation and shift", spacing, rate))
        for knows, spacing, rate in arrays:
            off = rate[1:] - own
            error, size = (np.sqrt(values**2 @ step / np.ptp(time)) for values in (off, own))
            rows.append(
                {
                    "scene": name,
                    "knows": knows,
                    "spacing (mm)": 1e3 * spacing,
                    "fitted to": "this and eight more"
                    if name in NINE.scenes.values()
                    else "ramp40",
                    "rms_error (impulses/s)": error,
                    "rms_error (% of the rms rate)": 100 * error / max(size, 1e-12),
                    "largest_error (impulses/s)": np.abs(off).max(),
                    "largest rate (impulses/s)": np.interp(
                        time, full[TIME], full[IMPULSE_RATE]
                    ).max(),
                    "impulses": rate[1:] @ step,
                    "impulses of the full model": integrated(full[TIME], full[IMPULSE_RATE])[-1],
                }
            )
    return pd.DataFrame(rows)


def _at_nodes(sample: SkinSample, time, law: SpatialSum, shift: float = 0.0) -> np.ndarray:
    """Rates (time) of sensors at the pad's nodes, which move."""
    energy = sample.by(law, shift)
    return THESIS_RATE(energy, np.append(0.0, np.diff(energy) / np.diff(time)))


def _on_array(sample: SkinSample, time, law: SpatialSum, pitch: float) -> np.ndarray:
    """Rates (time) of an array of a pitch (m) that stays in place."""
    reach = pitch * (np.ceil(np.abs(sample.x).max() / pitch) + 0.5)
    edges = np.arange(-reach, reach + pitch / 2, pitch)
    sensor = TactileSensor((edges[1:] + edges[:-1]) / 2, law)
    return sensor.rates(time, taxel_pressure(sample.x, sample.pressure, edges))

"""Impulse rates at hand against simulated histories: which belong together, and Eq 5-1 asked for
the rates.

Rates are published or recorded (`cysyk1999.receptors.recordings`); histories are of cylinders, or
of spheres where those were pressed, on a human pad.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import PchipInterpolator

from cysyk1999.measures.quantities import TIME
from cysyk1999.measures.responses import (
    IMPULSE_RATE,
    RECEPTOR_DEPTH,
    curvature_of,
    predicted_rate,
    windowed,
)
from cysyk1999.measures.runs import SPHERES, Runs, surfaces
from cysyk1999.receptors.fits import GainAndThreshold, gain_and_threshold, jackknife, linear
from fingerpad.measures.features import Histories, energy, force_gf
from fingerpad.receptors.laws import THESIS_RATE, ImpulseRate
from fingerpad.results import scene_of

RATE_FITS = {
    "5-1, thesis's constants": {"mean of predicted less given": "impulses/s"},
    "5-1, A1 and threshold fitted": {"A1": "(impulses/s)/Pa", "threshold of the energy": "Pa"},
    "5-1, times a factor, plus A3 of Eq 4-5": {"factor": "1", "A3": "impulses/s"},
}
"""Ways to ask rates of Eq 5-1 -> what each tells, and units."""


def rate_sets(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Rates that one set of constants may be asked to predict: of one recording, then of all
    recordings of one source.

    Pressed surfaces only; a window at a time; three rates at least.
    """
    still = rates[rates["speed_mm_per_s"] == 0]
    for (source, window), group in still.groupby(["source", "window"], sort=False):
        recordings = list(group.groupby("recording", sort=False))
        for recording, part in recordings:
            if len(part) >= 3:
                yield f"{recording}, {window}", part
        if len(recordings) > 1 and group["species"].iloc[0] != "model":
            yield (
                f"{source.split(',')[0]} and others, {group['force_gf'].nunique()} forces, "
                f"{window}",
                group,
            )


def assignments(group: pd.DataFrame) -> list[np.ndarray]:
    """Curvatures (n,) 1/m in every reading of rates whose surface is one of two; a surface has one
    rate, and rates rise with curvature.
    """
    first, other = (
        group["curvature_per_m"].to_numpy(float),
        group["or_curvature_per_m"].to_numpy(float),
    )
    if np.isnan(other).all():
        return [first]
    options = [(a,) if np.isnan(b) else (a, b) for a, b in zip(first, other, strict=True)]
    order = np.argsort(group["rate_per_s"].to_numpy(), kind="stable")
    read = [np.array(choice) for choice in itertools.product(*options)]
    return [choice for choice in read if (np.diff(choice[order]) > 0).all()]


def matched_histories(
    histories: Histories, group: pd.DataFrame
) -> dict[float, list[xr.Dataset]] | None:
    """Histories of pressed surfaces for every force (gf) of a set of rates, by rising curvature;
    None if a force has fewer than four.

    Spheres stand for spheres where they are simulated, else cylinders do. Of several force rates
    the recording's is taken, else 40 gf/s.
    """
    found = {}
    for force, rows in group.groupby("force_gf"):
        ramp = rows["ramp_gf_per_s"].fillna(40).iloc[0]
        for runs in _programmes(rows, force, ramp):
            pressed = runs.histories(histories).values()
            chosen = [h for h in pressed if abs(float(force_gf(h)[-1]) / force - 1) < 0.01]
            if len(chosen) >= 4:
                found[force] = sorted(chosen, key=curvature_of)
                break
        else:
            return None
    return found


def _programmes(rows: pd.DataFrame, force: float, ramp: float) -> Iterator[Runs]:
    """Runs that may stand for rates at a force (gf), the closest to what was pressed first."""
    if rows["stimulus"].eq("sphere").any() and force in SPHERES:
        yield SPHERES[force]
    yield from map(surfaces, (f"ramp{ramp:g}", f"press{force:g}"))


def across(
    matched: Mapping[float, Sequence[xr.Dataset]],
    group: pd.DataFrame,
    curvature: np.ndarray,
    number,
) -> np.ndarray:
    """Numbers (n,) at the forces and curvatures of some rates: between simulated surfaces by a
    monotone cubic over curvature.

    number: history, window -> value.
    """
    out = np.empty(len(group))
    force, windows = group["force_gf"].to_numpy(), group["window"].to_numpy()
    for f, window in dict.fromkeys(zip(force, windows, strict=True)):
        curve = PchipInterpolator(
            [curvature_of(h) for h in matched[f]], [number(h, window) for h in matched[f]]
        )
        rows = (force == f) & (windows == window)
        out[rows] = curve(np.minimum(curvature[rows], curve.x[-1]))
    return out


def rate_fit(
    matched, group: pd.DataFrame, curvature: np.ndarray
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Every way of :data:`RATE_FITS` -> what it tells, with intervals over rates (k, 3), and the
    rates (n,) it predicts.

    curvature: (n,) 1/m, one reading of which surface each rate is of.
    """
    data = group["rate_per_s"].to_numpy(float)

    def by(law: ImpulseRate) -> np.ndarray:
        def number(history, window):
            frame = predicted_rate(history, RECEPTOR_DEPTH, law)
            return windowed(history, frame[TIME], frame[IMPULSE_RATE], window)

        return across(matched, group, curvature, number)

    def mean_energy(history, window):
        return windowed(history, history["time"].values, energy(history, RECEPTOR_DEPTH), window)

    thesis, held = by(THESIS_RATE), across(matched, group, curvature, mean_energy)
    dynamic, ones = thesis - by(THESIS_RATE.without_rate()), np.ones(len(data))

    def offset(rows):
        return [np.mean((thesis - data)[rows])]

    def static(rows):
        """Of the energy's mean: as good as the mean of the law while the energy does not cross
        the threshold.
        """
        law = gain_and_threshold(held[rows], (data - dynamic)[rows])
        return np.array([law.gain, law.threshold])

    def factor(rows):
        return linear(np.column_stack([thesis, ones])[rows], data[rows])

    constants = [jackknife(fit, list(range(len(data)))) for fit in (offset, static, factor)]
    _, fitted, (scale, spontaneous) = (found[:, 0] for found in constants)
    predicted = (
        thesis,
        GainAndThreshold(*fitted)(held) + dynamic,
        scale * thesis + spontaneous,
    )
    return dict(zip(RATE_FITS, zip(constants, predicted, strict=True), strict=True))


def kind(group: pd.DataFrame, matched: Mapping[float, Sequence[xr.Dataset]]) -> str:
    """Whose rates of which stimuli they are, and what is simulated."""
    species, stimuli = ("/".join(group[name].unique()) for name in ("species", "stimulus"))
    scenes = [scene_of(history) for histories in matched.values() for history in histories]
    is_round = all(scene.kinematics == "axisymmetric" for scene in scenes)
    ours = "spheres on a human pad of revolution" if is_round else "cylinders on a human pad"
    return f"{species}, {stimuli}; simulated: {ours}"

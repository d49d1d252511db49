"""Calibration of the coefficient of friction, which the thesis does not state, to the stretch of
the skin that it does.

A surface stroked over the pad drags the skin along: the node at the pad's centre trails by a
lateral displacement that grows with the coefficient. Strokes with several coefficients give the
mean of this displacement over the waves as a curve; the thesis's stretch picks one coefficient from
it. Stretch tells friction force over stiffness, so the coefficient is as good as the moduli.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import PchipInterpolator

from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.quantities import DISTANCE, LATERAL
from cysyk1999.publishing.write import without_round_off, write_frame
from cysyk1999.reference_data import read_friction
from cysyk1999.studies.calibration.force import ESTIMATE_COLUMNS
from fingerpad.results import scene_of

STROKE = "stroke_sub_10"
STRETCH, AXIS = "T232", "T266"
"""Rows of the thesis's numbers: the shift of pressure profiles by skin stretch, the axis of lateral
displacements (mm).
"""
ABOUT = 0.15e-3
"""What "about 1 mm" leaves open to either side, m."""
STEP = 0.05
"""The coefficient is given to the nearest of these: "about" leaves twice as much open to either
side.
"""
COEFFICIENT, LOWEST, HIGHEST = "coefficient (1)", "lowest (mm)", "highest (mm)"
VARIATIONS = {
    "stroke_sub_1": "1 mm/s",
    "stroke_sub_10": "10 mm/s, mesh and steps of the thesis's size",
    "stroke_sub_40": "40 mm/s",
    "calibration_stroke_more_fat": "5.0 mm of fat under the apex",
    "calibration_stroke_softer": "moduli fitted to measured forces",
}
"""Scene -> what it changes in the strokes of the curve."""


class Stretch(NamedTuple):
    """Lateral displacement of the centre over the waves at a coefficient of friction, m: mean over
    the way, least and greatest (signed, dragged to -x).
    """

    coefficient: float
    mean: float
    lowest: float
    highest: float


def stretch(history: xr.Dataset) -> Stretch:
    """The stretch of a stroke between the end of its lead-in and the start of its run-out.

    Raises
    ------
    ValueError
        The stroke ends before the last wave does, or is not over a wavy surface.
    """
    scene = scene_of(history)
    surface = scene.stimulus
    if surface.shape != "wavy":
        raise ValueError(f"{scene.name} does not stroke a wavy surface")
    start, end = surface.lead_in, surface.length - surface.run_out
    way, first = np.unique(history.stroke_distance.values, return_index=True)
    lateral = history.centre_lateral_displacement.values[first]
    if way[-1] < end * (1 - 1e-9):
        raise ValueError(
            f"{scene.name} strokes {way[-1] * 1e3:.4g} mm, the waves end at {end * 1e3:.4g} mm"
        )
    x = np.concatenate([[start], way[(way > start) & (way < end)], [end]])
    u = np.interp(x, way, lateral)
    mean = float(np.trapezoid(u, x) / (end - start))
    return Stretch(scene.friction, mean, float(u.min()), float(u.max()))


class StretchCurve:
    """Stretch over the coefficient of friction, monotone between the coefficients that were
    simulated.

    Parameters
    ----------
    points : iterable of Stretch
        At least two, of different coefficients.

    Raises
    ------
    ValueError
        There are fewer, or the skin is not dragged further by every larger coefficient.
    """

    def __init__(self, points: Iterable[Stretch]):
        self.points = sorted(points)
        coefficient = [point.coefficient for point in self.points]
        if len(set(coefficient)) < max(2, len(coefficient)):
            raise ValueError(
                "a curve needs at least two different coefficients of friction, each once"
            )
        self.of: dict[str, PchipInterpolator] = {}
        for name in ("mean", "lowest", "highest"):
            values = [getattr(point, name) for point in self.points]
            if not (np.diff(values) < 0).all():
                raise ValueError(
                    f"the {name} lateral displacement does not fall with every larger coefficient "
                    "of friction"
                )
            self.of[name] = PchipInterpolator(coefficient, values)

    def at(self, coefficient: float) -> Stretch:
        """Stretch at a coefficient."""
        return Stretch(coefficient, *(float(curve(coefficient)) for curve in self.of.values()))

    def coefficient_at(self, lateral: float, name: str = "mean") -> float:
        """Coefficient at which the mean, lowest or highest lateral displacement is `lateral` (m,
        negative).

        Raises
        ------
        ValueError
            None between the simulated coefficients has it.
        """
        first, last = (getattr(point, name) for point in (self.points[0], self.points[-1]))
        if not last <= lateral <= first:
            raise ValueError(
                f"a {name} lateral displacement of {lateral * 1e3:.3g} mm is beyond the strokes, "
                f"{first * 1e3:.3g} to {last * 1e3:.3g} mm"
            )
        return float(self.of[name].solve(lateral, extrapolate=False)[0])


def calibrate_friction(
    sweep: Iterable[xr.Dataset],
    histories: Mapping[str, xr.Dataset],
    numbers: pd.DataFrame,
    published: pd.DataFrame,
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Calibrate the coefficient of friction.

    Parameters
    ----------
    sweep : :data:`STROKE` with several coefficients, as drafts.
    histories : scenes of :data:`VARIATIONS`.
    numbers : the thesis's, columns id, low and high.
    published : of :func:`cysyk1999.reference_data.read_friction`.

    Returns
    -------
    The plotted data and the estimates.
    """
    stated = numbers.set_index("id")
    target = -1e-3 * stated.loc[STRETCH, "low"]
    axis = tuple(1e-3 * stated.loc[AXIS, ["low", "high"]].astype(float))
    sweep = sorted(sweep, key=lambda history: scene_of(history).friction)
    curve = StretchCurve(map(stretch, sweep))
    best = curve.at(curve.coefficient_at(target))._replace(mean=target)
    varied = {
        title: stretch(histories[name]) for name, title in VARIATIONS.items() if name in histories
    }
    rows = [
        *_best_rows(curve, best, axis),
        *_varied_rows(curve, varied, target),
        *_published_rows(published),
    ]
    estimates = pd.DataFrame(rows, columns=ESTIMATE_COLUMNS)
    return _frame(sweep, curve, best, varied, axis, published), estimates


def _frame(sweep, curve, best, varied, axis, published) -> pd.DataFrame:
    parts = []
    for history, point in zip(sweep, curve.points, strict=True):
        course = {
            "panel": "course",
            "series": f"{point.coefficient:g}",
            "source": "simulated",
            COEFFICIENT: point.coefficient,
            DISTANCE: 1e3 * history.stroke_distance.values,
            LATERAL: 1e3 * history.centre_lateral_displacement.values,
        }
        sliding = np.flatnonzero(history.leg.values == history.leg.values[-1])
        parts.append(pd.DataFrame(course).iloc[sliding[0] - 1 :])
    surface = scene_of(sweep[0]).stimulus
    ends = [1e3 * surface.lead_in, 1e3 * (surface.length - surface.run_out)]
    waves = {"panel": "waves", "series": "waves", "source": "simulated", DISTANCE: ends}
    parts.append(pd.DataFrame(waves))
    about = Stretch(np.nan, best.mean, best.mean - ABOUT, best.mean + ABOUT)
    other = {name: point for name, point in varied.items() if name != VARIATIONS[STROKE]}
    stated = {"about 1 mm, Fig 5-6": about, "axis of Fig 5-15": Stretch(np.nan, np.nan, *axis)}
    for panel, points in (
        ("stretch", [("strokes", point) for point in curve.points]),
        ("estimate", [("calibrated", best)]),
        ("variations", other.items()),
        ("stated", stated.items()),
    ):
        rows = [(name, point[0], *(1e3 * value for value in point[1:])) for name, point in points]
        frame = pd.DataFrame(rows, columns=["series", COEFFICIENT, LATERAL, LOWEST, HIGHEST])
        source = "stated (Cysyk 1999)" if panel == "stated" else "simulated"
        if rows:
            parts.append(frame.assign(panel=panel, source=source))
    chosen = published[published["quantity"] == "coefficient"]
    low, high = chosen["low"], chosen["high"].fillna(chosen["low"])
    cited = chosen["source"].str.replace(r"(\b\d{4}), .*", r"\1", regex=True)
    measured = {
        "panel": "published",
        "series": chosen["contact"].where(chosen["kind"] == "measured", chosen["condition"]),
        "source": chosen["kind"] + " (" + cited + ")",
        COEFFICIENT: (low + high) / 2,
        "lowest_coefficient (1)": low,
        "highest_coefficient (1)": high,
    }
    return pd.concat([*parts, pd.DataFrame(measured)], ignore_index=True)


def rounded(coefficient: float) -> float:
    """To the nearest multiple of :data:`STEP`."""
    return round(STEP * round(coefficient / STEP), 9)


def _row(study, quantity, value, units="1", note="", subject="thesis") -> dict:
    """A row of the estimates."""
    row = {"study": study, "subject": subject, "quantity": quantity, "estimate": value}
    return row | {"units": units, "note": note}


def _best_rows(curve: StretchCurve, best: Stretch, axis) -> Iterator[dict]:
    target, study = best.mean, "friction"
    mean, about = f"{-1e3 * target:g} mm", 1e3 * ABOUT
    note = f"the thesis states none; mean stretch over the waves at 10 mm/s {mean}"
    yield _row(study, "coefficient", best.coefficient, note=note)
    note = f"to {STEP:g}: that of the scenes; interval: the next two rows"
    yield _row(study, "coefficient, rounded", rounded(best.coefficient), note=note)
    for side, shift in (("least", ABOUT), ("most", -ABOUT)):
        note = (
            f"mean stretch {-1e3 * (target + shift):.3g} mm; "
            f"about is read as +-{about:g} mm, not a 95 % interval"
        )
        value = curve.coefficient_at(target + shift)
        yield _row(study, f"{side} coefficient for about {mean}", value, note=note)
    for side, name, lateral in (("least", "highest", axis[1]), ("most", "lowest", axis[0])):
        note = (
            f"the {name} displacement over the waves reaches {1e3 * lateral:g} mm, "
            "the end of the axis of Fig 5-15"
        )
        value = curve.coefficient_at(lateral, name)
        yield _row(study, f"{side} coefficient within the axis of Fig 5-15", value, note=note)
    note = "at the calibrated coefficient"
    yield _row(study, "lowest displacement over the waves", 1e3 * best.lowest, "mm", note)
    yield _row(study, "highest displacement over the waves", 1e3 * best.highest, "mm", note)
    slope = -1e3 * float(curve.of["mean"](best.coefficient, 1))
    note = "slope of the mean stretch at the calibrated coefficient"
    yield _row(study, "stretch per coefficient", slope, "mm", note)


def _varied_rows(curve: StretchCurve, varied: dict[str, Stretch], target) -> Iterator[dict]:
    for name, point in varied.items():
        study, here = f"friction: {name}", curve.at(point.coefficient).mean
        note = f"with {point.coefficient:g}, at which the curve gives {-1e3 * here:.4g} mm"
        yield _row(study, "mean stretch", -1e3 * point.mean, "mm", note)
        yield _row(study, "lowest displacement over the waves", 1e3 * point.lowest, "mm")
        yield _row(study, "highest displacement over the waves", 1e3 * point.highest, "mm")
        try:
            needed = curve.coefficient_at(target * here / point.mean)
        except ValueError:
            needed = np.nan
        note = "were the whole curve scaled by the ratio of the two stretches"
        yield _row(study, f"coefficient for {-1e3 * target:g} mm", needed, note=note)
    if fine := varied.get(VARIATIONS[STROKE]):
        change = 100 * (fine.mean / curve.at(fine.coefficient).mean - 1)
        name = "change of the stretch by mesh and steps of the thesis's size"
        yield _row("friction", name, change, "%", "the curve rests on coarser ones")


def _published_rows(published: pd.DataFrame) -> Iterator[dict]:
    for row in published.itertuples():
        single = np.isnan(row.high)
        value = f"{row.low:g}" if single else f"{row.low:g} to {row.high:g}"
        middle = row.low if single else (row.low + row.high) / 2
        quantity = "coefficient" if row.quantity == "coefficient" else "factor of change"
        note = f"{row.kind}: {value}; {row.condition}; {row.how_obtained}; {row.source}"
        yield _row("friction: published", quantity, middle, note=note, subject=row.contact)


def calibrate_friction_job(job: SimpleNamespace) -> None:
    """Job: `sweep`, `histories`, the tables `thesis` and `published` -> `data`: friction,
    friction_estimates.
    """
    histories, sweep = read_results(job.histories)[0], read_results(job.sweep)[0].values()
    result = calibrate_friction(
        sweep, histories, pd.read_csv(job.thesis[0]), read_friction(job.published[0])
    )
    for path, frame in zip(job.data, result, strict=True):
        write_frame(without_round_off(frame), Path(path))

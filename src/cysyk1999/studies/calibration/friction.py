"""Calibration of the coefficient of friction, which the thesis does not state, to the stretch of
the skin that it does.

A surface stroked over the pad drags the skin along: the node at the pad's centre trails by a
lateral displacement that grows with the coefficient. Strokes with several coefficients give the
mean of this displacement over the waves as a curve; the thesis's stretch picks one coefficient from
it. Stretch tells friction force over stiffness, so the coefficient is as good as the moduli.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import SimpleNamespace

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


@dataclass(frozen=True)
class Stretch:
    """Lateral displacement of the centre over the waves, m: mean over the way, least and greatest
    (signed, dragged to -x).
    """

    coefficient: float
    mean: float
    lowest: float
    highest: float


def stretch(history: xr.Dataset) -> Stretch:
    """What a stroke over a wavy surface does between the end of its lead-in and the start of its
    run-out.

    Raises:
        ValueError: the stroke ends before the last wave does, or does not go over a wavy surface in
        the positive direction.
    """
    scene = scene_of(history)
    if scene.stimulus.shape != "wavy":
        raise ValueError(f"{scene.name} does not stroke a wavy surface")
    surface = scene.stimulus
    start, end = surface.lead_in, surface.length - surface.run_out
    way, lateral = history.stroke_distance.values, history.centre_lateral_displacement.values
    if way[-1] < end * (1 - 1e-9):
        raise ValueError(
            f"{scene.name} strokes {way[-1] * 1e3:.4g} mm, the waves end at {end * 1e3:.4g} mm"
        )
    way, first = np.unique(way, return_index=True)
    lateral = lateral[first]
    inside = (way > start) & (way < end)
    x = np.concatenate([[start], way[inside], [end]])
    u = np.interp(x, way, lateral)
    return Stretch(
        scene.friction, float(np.trapezoid(u, x) / (end - start)), float(u.min()), float(u.max())
    )


class StretchCurve:
    """Stretch over the coefficient of friction, monotone between the coefficients that were
    simulated.

    Args:
        points: at least two, of different coefficients.

    Raises:
        ValueError: there are fewer, or the skin is not dragged further by every larger coefficient.
    """

    def __init__(self, points: Iterable[Stretch]):
        self.points = sorted(points, key=lambda point: point.coefficient)
        self.coefficient = np.array([point.coefficient for point in self.points])
        if len(self.points) < 2 or not (np.diff(self.coefficient) > 0).all():
            raise ValueError(
                "a curve needs at least two different coefficients of friction, each once"
            )
        self.values = {
            name: np.array([getattr(p, name) for p in self.points])
            for name in ("mean", "lowest", "highest")
        }
        for name, values in self.values.items():
            if not (np.diff(values) < 0).all():
                raise ValueError(
                    f"the {name} lateral displacement does not fall with every larger coefficient "
                    "of friction"
                )

    @cached_property
    def mean(self) -> PchipInterpolator:
        """Mean lateral displacement, m, over the coefficient."""
        return PchipInterpolator(self.coefficient, self.values["mean"])

    def coefficient_at(self, lateral: float, name: str = "mean") -> float:
        """Coefficient at which the mean, lowest or highest lateral displacement is `lateral` (m,
        negative).

        Raises:
            ValueError: none between the simulated coefficients has it.
        """
        values = self.values[name]
        if not values[-1] <= lateral <= values[0]:
            ends = f"{values[0] * 1e3:.3g} to {values[-1] * 1e3:.3g} mm"
            raise ValueError(
                f"a {name} lateral displacement of {lateral * 1e3:.3g} mm is beyond the strokes, "
                f"{ends}"
            )
        curve = PchipInterpolator(self.coefficient, values - lateral)
        return float(curve.roots(extrapolate=False)[0])


@dataclass(frozen=True)
class FrictionCalibration:
    """What the study makes: the plotted data and the estimates."""

    friction: pd.DataFrame
    estimates: pd.DataFrame


def calibrate_friction(
    sweep: Iterable[xr.Dataset],
    histories: Mapping[str, xr.Dataset],
    numbers: pd.DataFrame,
    published: pd.DataFrame,
) -> FrictionCalibration:
    """Calibrate the coefficient of friction.

    Args:
        sweep: :data:`STROKE` with several coefficients, as drafts. histories: scenes of
        :data:`VARIATIONS`. numbers: the thesis's, columns id, low and high. published: of
        :func:`cysyk1999.reference_data.read_friction`.
    """
    stated = numbers.set_index("id")
    target = -1e-3 * stated.loc[STRETCH, "low"]
    axis = tuple(1e-3 * stated.loc[AXIS, ["low", "high"]].astype(float))
    sweep = sorted(sweep, key=lambda history: scene_of(history).friction)
    curve = StretchCurve(map(stretch, sweep))
    varied = {
        VARIATIONS[name]: stretch(histories[name]) for name in VARIATIONS if name in histories
    }
    return FrictionCalibration(
        _frame(sweep, curve, varied, target, axis, published),
        _estimates(curve, varied, target, axis, published),
    )


def _frame(sweep, curve, varied, target, axis, published) -> pd.DataFrame:
    rows = []
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
        rows.append(pd.DataFrame(course).iloc[sliding[0] - 1 :])
    stimulus = scene_of(sweep[0]).stimulus
    ends = [1e3 * stimulus.lead_in, 1e3 * (stimulus.length - stimulus.run_out)]
    rows.append(
        pd.DataFrame({"panel": "waves", "series": "waves", "source": "simulated", DISTANCE: ends})
    )

    def marks(panel, source, points):
        values = [
            (k, s.coefficient, 1e3 * s.mean, 1e3 * s.lowest, 1e3 * s.highest) for k, s in points
        ]
        frame = pd.DataFrame(values, columns=["series", COEFFICIENT, LATERAL, LOWEST, HIGHEST])
        return frame.assign(panel=panel, source=source)

    rows.append(marks("stretch", "simulated", [("strokes", point) for point in curve.points]))
    rows.append(marks("estimate", "simulated", [("calibrated", _estimate(curve, target))]))
    if shown := {name: point for name, point in varied.items() if name != VARIATIONS[STROKE]}:
        rows.append(marks("variations", "simulated", shown.items()))
    cysyk = "stated (Cysyk 1999)"
    about = Stretch(np.nan, target, target - ABOUT, target + ABOUT)
    rows.append(
        marks(
            "stated",
            cysyk,
            [("about 1 mm, Fig 5-6", about), ("axis of Fig 5-15", Stretch(np.nan, np.nan, *axis))],
        )
    )
    chosen = published[published["quantity"] == "coefficient"]
    high = chosen["high"].fillna(chosen["low"])
    rows.append(
        pd.DataFrame(
            {
                "panel": "published",
                "series": np.where(
                    chosen["kind"] == "measured", chosen["contact"], chosen["condition"]
                ),
                "source": chosen["kind"]
                + " ("
                + chosen["source"].str.replace(r"(\b\d{4}), .*", r"\1", regex=True)
                + ")",
                COEFFICIENT: (chosen["low"] + high) / 2,
                "lowest_coefficient (1)": chosen["low"],
                "highest_coefficient (1)": high,
            }
        )
    )
    return pd.concat(rows, ignore_index=True)


def rounded(coefficient: float) -> float:
    """To the nearest multiple of :data:`STEP`."""
    return round(STEP * round(coefficient / STEP), 9)


def _estimate(curve: StretchCurve, target: float) -> Stretch:
    best = curve.coefficient_at(target)
    ranges = (
        float(PchipInterpolator(curve.coefficient, curve.values[name])(best))
        for name in ("lowest", "highest")
    )
    return Stretch(best, target, *ranges)


def _estimates(curve, varied, target, axis, published) -> pd.DataFrame:
    rows, best = [], _estimate(curve, target)
    slope = 1e3 * float(curve.mean(best.coefficient, 1))
    mean, about = f"{-1e3 * target:g} mm", 1e3 * ABOUT

    def add(study, quantity, value, units="1", note="", subject="thesis"):
        row = {
            "study": study,
            "subject": subject,
            "quantity": quantity,
            "estimate": value,
            "units": units,
            "note": note,
        }
        rows.append(row)

    study = "friction"
    add(
        study,
        "coefficient",
        best.coefficient,
        note=f"the thesis states none; mean stretch over the waves at 10 mm/s {mean}",
    )
    add(
        study,
        "coefficient, rounded",
        rounded(best.coefficient),
        note=f"to {STEP:g}: that of the scenes; interval: the next two rows",
    )
    for side, shift in (("least", ABOUT), ("most", -ABOUT)):
        value = curve.coefficient_at(target + shift)
        note = (
            f"mean stretch {-1e3 * (target + shift):.3g} mm; about is read as +-{about:g} mm, "
            "not a 95 % interval"
        )
        add(study, f"{side} coefficient for about {mean}", value, note=note)
    for side, name, lateral in (("least", "highest", axis[1]), ("most", "lowest", axis[0])):
        note = (
            f"the {name} displacement over the waves reaches {1e3 * lateral:g} mm, the end of "
            "the axis of Fig 5-15"
        )
        add(
            study,
            f"{side} coefficient within the axis of Fig 5-15",
            curve.coefficient_at(lateral, name),
            note=note,
        )
    add(
        study,
        "lowest displacement over the waves",
        1e3 * best.lowest,
        "mm",
        "at the calibrated coefficient",
    )
    add(
        study,
        "highest displacement over the waves",
        1e3 * best.highest,
        "mm",
        "at the calibrated coefficient",
    )
    add(
        study,
        "stretch per coefficient",
        -slope,
        "mm",
        "slope of the mean stretch at the calibrated coefficient",
    )
    for name, point in varied.items():
        study, here = f"friction: {name}", float(curve.mean(point.coefficient))
        note = f"with {point.coefficient:g}, at which the curve gives {-1e3 * here:.4g} mm"
        add(study, "mean stretch", -1e3 * point.mean, "mm", note)
        add(study, "lowest displacement over the waves", 1e3 * point.lowest, "mm")
        add(study, "highest displacement over the waves", 1e3 * point.highest, "mm")
        try:
            needed = curve.coefficient_at(target * here / point.mean)
        except ValueError:
            needed = np.nan
        add(
            study,
            f"coefficient for {mean}",
            needed,
            note="were the whole curve scaled by the ratio of the two stretches",
        )
    if fine := varied.get(VARIATIONS[STROKE]):
        change = 100 * (fine.mean / float(curve.mean(fine.coefficient)) - 1)
        add(
            "friction",
            "change of the stretch by mesh and steps of the thesis's size",
            change,
            "%",
            "the curve rests on coarser ones",
        )
    for row in published.itertuples():
        value = f"{row.low:g}" if np.isnan(row.high) else f"{row.low:g} to {row.high:g}"
        middle = row.low if np.isnan(row.high) else (row.low + row.high) / 2
        quantity = "coefficient" if row.quantity == "coefficient" else "factor of change"
        note = f"{row.kind}: {value}; {row.condition}; {row.how_obtained}; {row.source}"
        add("friction: published", quantity, middle, note=note, subject=row.contact)
    return pd.DataFrame(rows, columns=ESTIMATE_COLUMNS)


def calibrate_friction_job(job: SimpleNamespace) -> None:
    """Job: `sweep`, `histories`, the tables `thesis` and `published` -> `data`: friction,
    friction_estimates.
    """
    histories, sweep = read_results(job.histories)[0], read_results(job.sweep)[0].values()
    result = calibrate_friction(
        sweep, histories, pd.read_csv(job.thesis[0]), read_friction(job.published[0])
    )
    for path, frame in zip(job.data, (result.friction, result.estimates), strict=True):
        write_frame(without_round_off(frame), Path(path))

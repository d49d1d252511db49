"""Calibration of the coefficient of friction, which the thesis does not state, to the stretch of
the skin that it does.

A surface stroked over the pad drags the skin along: the node at the pad's centre trails by a
lateral displacement that grows with the coefficient. Strokes with several coefficients give the
mean of this displacement over the waves as a curve; the thesis's stretch picks one coefficient from
it. Stretch tells friction force over stiffness, so the coefficient is as good as the moduli.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr
from scipy.interpolate import PchipInterpolator

from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.quantities import DISTANCE, LATERAL
from cysyk1999.publishing.tables import without_round_off, write_frame
from cysyk1999.reference_data import read_friction, read_reference
from cysyk1999.studies.calibration.force import ESTIMATE_COLUMNS, estimate
from fingerpad import load_scene, plan
from fingerpad.healing import simulate
from fingerpad.results import scene_of, write_history

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
row = partial(estimate, "friction", "thesis")
"""A row of the estimates of the curve: quantity, value, unit, note."""


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
    if scene.stimulus.shape != "wavy":
        raise ValueError(f"{scene.name} does not stroke a wavy surface")
    start, end = waves(history)
    way, first = np.unique(history.stroke_distance.values, return_index=True)
    if way[-1] < end * (1 - 1e-9):
        raise ValueError(
            f"{scene.name} strokes {way[-1] * 1e3:.4g} mm, the waves end at {end * 1e3:.4g} mm"
        )
    x = np.concatenate([[start], way[(way > start) & (way < end)], [end]])
    u = np.interp(x, way, history.centre_lateral_displacement.values[first])
    mean = float(np.trapezoid(u, x) / (end - start))
    return Stretch(scene.friction, mean, float(u.min()), float(u.max()))


def waves(history: xr.Dataset) -> tuple[float, float]:
    """Where the waves of a stroked surface begin and end, m along it."""
    surface = scene_of(history).stimulus
    return surface.lead_in, surface.length - surface.run_out


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

    def __init__(self, points: Iterable[Stretch]) -> None:
        self.points = sorted(points)
        coefficients, *curves = map(np.array, zip(*self.points, strict=True))
        if len(set(coefficients)) < max(2, len(coefficients)):
            raise ValueError(
                "a curve needs at least two different coefficients of friction, each once"
            )
        self.of = {}
        for name, lateral in zip(Stretch._fields[1:], curves, strict=True):
            if not (np.diff(lateral) < 0).all():
                raise ValueError(
                    f"the {name} lateral displacement does not fall with every larger coefficient "
                    "of friction"
                )
            self.of[name] = PchipInterpolator(coefficients, lateral)

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
        if found := self.of[name].solve(lateral, extrapolate=False).tolist():
            return found[0]
        first, last = (1e3 * getattr(self.points[k], name) for k in (0, -1))
        raise ValueError(
            f"a {name} lateral displacement of {lateral * 1e3:.3g} mm is beyond the strokes, "
            f"{first:.3g} to {last:.3g} mm"
        )


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
    axis = Stretch(np.nan, np.nan, *(1e-3 * stated.loc[AXIS, ["low", "high"]].astype(float)))
    sweep = sorted(sweep, key=lambda history: scene_of(history).friction)
    curve = StretchCurve(map(stretch, sweep))
    best = curve.at(curve.coefficient_at(target))._replace(mean=target)
    varied = {
        title: stretch(histories[name]) for name, title in VARIATIONS.items() if name in histories
    }
    about = Stretch(np.nan, target, target - ABOUT, target + ABOUT)
    panels = {
        "stretch": [("strokes", point) for point in curve.points],
        "estimate": [("calibrated", best)],
        "variations": [pair for pair in varied.items() if pair[0] != VARIATIONS[STROKE]],
        "stated": [("about 1 mm, Fig 5-6", about), ("axis of Fig 5-15", axis)],
    }
    frame = pd.concat([_courses(sweep), *_points(panels), _measured(published)], ignore_index=True)
    rows = [
        *_best_rows(curve, best, axis),
        *_varied_rows(curve, varied, target),
        *_published_rows(published),
    ]
    return frame, pd.DataFrame(rows, columns=ESTIMATE_COLUMNS)


def _courses(sweep: Iterable[xr.Dataset]) -> pd.DataFrame:
    """Lateral displacement along every stroke, and where the waves begin and end."""
    parts = []
    for history in sweep:
        friction, sliding = scene_of(history).friction, history.leg.values == history.leg.values[-1]
        course = {
            "panel": "course",
            "series": f"{friction:g}",
            "source": "simulated",
            COEFFICIENT: friction,
            DISTANCE: 1e3 * history.stroke_distance.values,
            LATERAL: 1e3 * history.centre_lateral_displacement.values,
        }
        parts.append(pd.DataFrame(course).iloc[np.argmax(sliding) - 1 :])
    ends = [1e3 * end for end in waves(history)]
    mark = {"panel": "waves", "series": "waves", "source": "simulated", DISTANCE: ends}
    return pd.concat([*parts, pd.DataFrame(mark)])


def _points(panels: Mapping[str, list[tuple[str, Stretch]]]) -> Iterator[pd.DataFrame]:
    for panel, points in panels.items():
        if points:
            names, stretches = zip(*points, strict=True)
            frame = pd.DataFrame(stretches) * [1, 1e3, 1e3, 1e3]
            frame.columns = [COEFFICIENT, LATERAL, LOWEST, HIGHEST]
            source = "stated (Cysyk 1999)" if panel == "stated" else "simulated"
            yield frame.assign(panel=panel, series=names, source=source)


def _measured(published: pd.DataFrame) -> pd.DataFrame:
    """Published coefficients."""
    chosen = published[published["quantity"] == "coefficient"]
    low, high = chosen["low"], chosen["high"].fillna(chosen["low"])
    cited = chosen["source"].str.replace(r"(\b\d{4}), .*", r"\1", regex=True)
    columns = {
        "panel": "published",
        "series": chosen["contact"].where(chosen["kind"] == "measured", chosen["condition"]),
        "source": chosen["kind"] + " (" + cited + ")",
        COEFFICIENT: (low + high) / 2,
        "lowest_coefficient (1)": low,
        "highest_coefficient (1)": high,
    }
    return pd.DataFrame(columns)


def rounded(coefficient: float) -> float:
    """To the nearest multiple of :data:`STEP`."""
    return round(STEP * round(coefficient / STEP), 9)


def _best_rows(curve: StretchCurve, best: Stretch, axis: Stretch) -> Iterator[dict]:
    target, mean = best.mean, f"{-1e3 * best.mean:g} mm"
    note = f"the thesis states none; mean stretch over the waves at 10 mm/s {mean}"
    yield row("coefficient", best.coefficient, note=note)
    note = f"to {STEP:g}: that of the scenes; interval: the next two rows"
    yield row("coefficient, rounded", rounded(best.coefficient), note=note)
    for side, shift in (("least", ABOUT), ("most", -ABOUT)):
        value = curve.coefficient_at(target + shift)
        note = (
            f"mean stretch {-1e3 * (target + shift):.3g} mm; "
            f"about is read as +-{1e3 * ABOUT:g} mm, not a 95 % interval"
        )
        yield row(f"{side} coefficient for about {mean}", value, note=note)
    for side, name in (("least", "highest"), ("most", "lowest")):
        end = getattr(axis, name)
        note = (
            f"the {name} displacement over the waves reaches {1e3 * end:g} mm, "
            "the end of the axis of Fig 5-15"
        )
        value = curve.coefficient_at(end, name)
        yield row(f"{side} coefficient within the axis of Fig 5-15", value, note=note)
    note = "at the calibrated coefficient"
    yield row("lowest displacement over the waves", 1e3 * best.lowest, "mm", note)
    yield row("highest displacement over the waves", 1e3 * best.highest, "mm", note)
    slope = -1e3 * float(curve.of["mean"](best.coefficient, 1))
    note = "slope of the mean stretch at the calibrated coefficient"
    yield row("stretch per coefficient", slope, "mm", note)


def _varied_rows(curve: StretchCurve, varied: dict[str, Stretch], target) -> Iterator[dict]:
    for name, point in varied.items():
        here, of = (
            curve.at(point.coefficient).mean,
            partial(estimate, f"friction: {name}", "thesis"),
        )
        note = f"with {point.coefficient:g}, at which the curve gives {-1e3 * here:.4g} mm"
        yield of("mean stretch", -1e3 * point.mean, "mm", note)
        yield of("lowest displacement over the waves", 1e3 * point.lowest, "mm")
        yield of("highest displacement over the waves", 1e3 * point.highest, "mm")
        try:
            needed = curve.coefficient_at(target * here / point.mean)
        except ValueError:
            needed = np.nan
        note = "were the whole curve scaled by the ratio of the two stretches"
        yield of(f"coefficient for {-1e3 * target:g} mm", needed, note=note)
    if fine := varied.get(VARIATIONS[STROKE]):
        change = 100 * (fine.mean / curve.at(fine.coefficient).mean - 1)
        name = "change of the stretch by mesh and steps of the thesis's size"
        yield row(name, change, "%", "the curve rests on coarser ones")


def _published_rows(published: pd.DataFrame) -> Iterator[dict]:
    names = {"coefficient": "coefficient", "factor": "factor of change"}
    for known in published.itertuples():
        ends = [end for end in (known.low, known.high) if not np.isnan(end)]
        value = " to ".join(f"{end:g}" for end in ends)
        note = f"{known.kind}: {value}; {known.condition}; {known.how_obtained}; {known.source}"
        quantity, middle = names[known.quantity], np.mean(ends)
        yield estimate("friction: published", known.contact, quantity, middle, note=note)


def calibrate_friction_job(job: SimpleNamespace) -> None:
    """Job: `sweep`, `histories`, the tables `thesis` and `published` -> `data`: friction,
    friction_estimates.
    """
    histories, sweep = (read_results(paths)[0] for paths in (job.histories, job.sweep))
    tables = read_reference(job.thesis[0]).reset_index(), read_friction(job.published[0])
    result = calibrate_friction(sweep.values(), histories, *tables)
    for path, frame in zip(job.data, result, strict=True):
        write_frame(without_round_off(frame), Path(path))


def strokes_with_friction(job: SimpleNamespace) -> None:
    """Job: `scene`, `coefficients` -> `histories`, one for each coefficient."""
    stroke = load_scene(job.scene[0]).with_accuracy("draft")
    for coefficient, history in zip(job.coefficients, job.histories, strict=True):
        scene = stroke.varied({"friction": float(coefficient)})
        write_history(simulate(scene, plan(scene)), history)

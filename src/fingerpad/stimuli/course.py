"""A course of depth or force over time, as an instrument writes it, in as few straight pieces as
its noise allows.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from fingerpad.stimuli.columns import columns_with_units
from fingerpad.tables import TableError, read_table

EXACT = 5e-3
"""Of the largest value of a course, by which the pieces may be off."""
NOISE = 8.0
"""Standard deviations of the noise, by which they may be off where that is more: from one extreme
to the other.
"""
MOST_PIECES = 2000
"""Of a course."""
_DIMENSIONS = {"time": "time", "depth": "length", "force": "force"}
_ALLOWED = "the columns 'time (s)' and 'depth (mm)', or 'time (s)' and 'force (gf)'"


class Course(NamedTuple):
    """Corners of a course: ``times`` (n,) s from zero, ``values`` (n,) in m or N, and which:
    "depth" or "force".
    """

    times: tuple[float, ...]
    values: tuple[float, ...]
    kept: str


def read_course(path: str | Path) -> Course:
    """Read a course from a table with the columns time and depth, or time and force.

    What lies below zero is taken for zero, where the noise of an instrument at rest is.

    Raises
    ------
    OSError, TableError : there is no such table; the message is one line.
    """
    table = read_table(path)
    columns = columns_with_units(table, _DIMENSIONS, _ALLOWED)
    if ("depth" in columns) == ("force" in columns):
        both = "both depth and force" if "depth" in columns else "neither depth nor force"
        raise TableError(f"has {both} among its columns {', '.join(table.header)[:60]}", _ALLOWED)
    if "time" not in columns:
        raise TableError(f"has no column 'time (s)', but {', '.join(table.header)[:60]}", _ALLOWED)
    kept = "depth" if "depth" in columns else "force"
    times, values = (
        np.array(table.numbers(k)) * factor for k, factor in (columns["time"], columns[kept])
    )
    if len(times) < 2:
        raise TableError("has fewer than two rows", "a row for each sample")
    late = np.flatnonzero(np.diff(times) <= 0)
    if len(late):
        raise TableError(
            f"has a time in row {table.lines[late[0] + 1]} that is not later than the one before",
            "times that rise",
        )
    if not values.max() > 0:
        raise TableError(f"has no {kept} above zero", f"a {kept} that presses")
    if values.min() < -0.2 * values.max():
        row = table.lines[int(np.argmin(values))]
        raise TableError(
            f"has a {kept} far below zero in row {row}: it presses the other way",
            "pressing is positive",
        )
    values = np.maximum(values, 0.0)
    within = max(EXACT * values.max(), NOISE * _noise(values))
    times = times - times[0]
    corners = corners_of(times, values, within)
    if len(corners) > MOST_PIECES:
        raise TableError(
            f"has {len(corners)} pieces that differ by more than its noise",
            f"up to {MOST_PIECES}; a shorter one",
        )
    # between the corners, the pieces that fit all samples best
    knots = np.pad(times[corners], 1, mode="edge")
    from scipy.interpolate import make_lsq_spline  # a tenth of a second

    fitted = np.maximum(make_lsq_spline(times, values, knots, k=1).c, 0.0)
    return Course(tuple(times[corners].tolist()), tuple(fitted.tolist()), kept)


def _noise(values: np.ndarray) -> float:
    """Standard deviation of the noise of samples, from their second differences, which leave
    nothing of a slope.
    """
    if len(values) < 20:
        return 0.0
    return float(1.4826 * np.median(np.abs(np.diff(values, 2))) / np.sqrt(6))


def corners_of(times: np.ndarray, values: np.ndarray, within: float) -> np.ndarray:
    """Indices of samples between which straight pieces are off by no more than ``within`` (Douglas
    and Peucker 1973).
    """
    kept, todo = {0, len(times) - 1}, [(0, len(times) - 1)]
    while todo:
        first, last = todo.pop()
        if last - first < 2:
            continue
        between = slice(first + 1, last)
        share = (times[between] - times[first]) / (times[last] - times[first])
        off = np.abs(values[between] - values[first] - share * (values[last] - values[first]))
        k = first + 1 + int(np.argmax(off))
        if off.max() > within:
            kept.add(k)
            todo += [(first, k), (k, last)]
    return np.array(sorted(kept))

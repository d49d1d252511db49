"""A profile given by points, as measured ones are: its file, its smoothing and its ends."""

from __future__ import annotations

import hashlib
import json
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import ConfigDict, Field
from pydantic.json_schema import SkipJsonSchema

from fingerpad.documents import HIDE, Problem
from fingerpad.fields import quantity
from fingerpad.stimuli.columns import columns_with_units, read_file
from fingerpad.stimuli.curve import Curve, share_of_height
from fingerpad.stimuli.shapes.shape import CurvedShape
from fingerpad.stimuli.smoothing import SKIN_EDGE, WAVE, cutoffs, is_rough, smoothed
from fingerpad.tables import Table, TableError, read_table


def _needs_its_file(schema: dict[str, Any]) -> None:
    schema["required"] = ["csv"]
    schema["properties"]["csv"] |= schema["properties"]["csv"].pop("anyOf")[0]


class Sampled(CurvedShape):
    """Rigid profile given by points of its lower surface: y is up, the solid lies above, and x = 0
    is over the pad's apex.

    Only differences of y matter: the profile comes down until it touches.
    figures/studies/profile_convention.png shows it.
    """

    internal: ClassVar = frozenset({"x", "y", "read_as", "axis"})
    follows: ClassVar = {"csv": ("x", "y", "read_as")}

    model_config = ConfigDict(json_schema_extra=_needs_its_file)
    kinematics: ClassVar = ("plane_strain", "axisymmetric")
    shape: Literal["sampled"] = "sampled"
    csv: Path | None = None
    """File with the columns `x (mm)` and `y (mm)`, or another unit of length in them; x strictly
    increasing.
    """
    smooth: quantity("length", words=("auto", "none")) = "auto"
    """Structure finer than nodes can feel: `auto` filters it out where there is any, `none` keeps
    it, or a cut-off wavelength.
    """
    ends: Literal["open", "level", "slope"] = "open"
    """What lies beyond the points: nothing (`open`), a `level` surface, or the `slope` of the last
    two, for ever.
    """
    x: SkipJsonSchema[tuple[float, ...]]
    y: SkipJsonSchema[tuple[float, ...]]
    read_as: SkipJsonSchema[tuple[str, ...]] = Field((), exclude=True, repr=False)
    """How the file was read where that had to be guessed, in words."""
    axis: SkipJsonSchema[bool] = Field(False, exclude=True, repr=False)
    """Whether it is turned about x = 0."""

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Reads the points from the file."""
        if "x" not in data:
            if data.get("csv") is None:
                raise Problem(
                    "is missing", "the path of a CSV file, or in Python x and y", ("csv",), HIDE
                )
            data["csv"], profile = read_file(data, "csv", context, _read_profile, _ALLOWED)
            data["x"], data["y"], data["read_as"] = profile
        return data | {
            key: tuple(map(float, data[key]))
            for key in "xy"
            if isinstance(data.get(key), np.ndarray)
        }

    @cached_property
    def curve(self) -> Points:
        return Points(self.x, self.y, self.ends, self.smooth, axis=self.axis)

    def turned(self):
        """With the mirror images of its points, which begin on the axis, or are mirrored."""
        x, y = np.array(self.x), np.array(self.y)
        if np.array_equal(x, -x[::-1]) and np.array_equal(y, y[::-1]):
            return self if self.axis else self.model_copy(update={"axis": True})
        if x[0] < 0:
            problem = f"has points beyond the axis of revolution, from x = {x[0] * 1e3:.4g} mm"
            raise Problem(problem, "points from x = 0 on", ("csv",))
        on = slice(1 if x[0] == 0 else 0, None)
        points = {"x": tuple(np.append(-x[::-1], x[on]).tolist())}
        points["y"] = tuple(np.append(y[::-1], y[on]).tolist())
        return self.model_copy(update=points | {"axis": True})

    @property
    def notes(self):
        return self.read_as

    def recorded(self):
        """The file's name, and a hash of its points."""
        points = json.dumps([self.x, self.y]).encode()
        return {"csv": self.csv and self.csv.name, "sha256": hashlib.sha256(points).hexdigest()}


_ALLOWED = "a CSV file with the columns 'x (mm)' and 'y (mm)', x strictly increasing"
NARROWEST, WIDEST = 10e-6, 10.0
"""Widths (m) between which a profile is believed to be in the unit that its columns name."""


def _read_profile(path: Path) -> tuple[tuple[float, ...], tuple[float, ...], tuple[str, ...]]:
    """Points (x, y) of a profile in m, and how its file was read where that had to be guessed.

    Raises
    ------
    TableError : they are no numbers, x does not increase, or their size is not believable.
    """
    table = read_table(path)
    found = _profile_columns(table)
    x, y, *z = (np.array(table.numbers(k)) * factor for k, factor in found.values())
    notes, lines = list(table.notes), list(table.lines)
    if len(x) < 2:
        raise TableError("has fewer than two points", _ALLOWED)
    if z:
        lateral = "z" if np.ptp(y) else "y"
        if np.ptp(y) and np.ptp(*z):
            raise TableError(
                "has columns x, y and z that all move",
                "a profile along one line: x and heights, y (or z) the same in all rows",
            )
        y, heights = (y, "y") if lateral == "z" else (*z, "z")
        notes.append(f"heights are read from {heights}, for {lateral} does not move")
    if x[0] > x[-1]:
        x, y, lines = x[::-1], y[::-1], lines[::-1]
    falls = np.flatnonzero(~(np.diff(x) > 0))
    if len(falls):
        line = lines[falls[0] + 1]
        raise TableError(f"is not single-valued: x does not increase in row {line}", _ALLOWED)
    width = x[-1] - x[0]
    if not NARROWEST <= width <= WIDEST:
        size = f"{width:.3g} m" if width > WIDEST else f"{width * 1e6:.3g} um"
        name = table.header[found["x"][0]]
        raise TableError(
            f"is {size} wide by its column '{name}'",
            "10 um to 10 m; is the unit another one, um, mm or m?",
        )
    return tuple(x.tolist()), tuple(y.tolist()), tuple(f"{path.name}: {note}" for note in notes)


def _profile_columns(table: Table) -> dict[str, tuple[int, float]]:
    """x, the heights, and z where there are both y and z -> where the column is, and its unit in m.
    Raises `TableError`.
    """
    allowed = "the columns 'x (mm)' and 'y (mm)', or um, or m"
    found = columns_with_units(table, dict.fromkeys("xyz", "length"), allowed)
    for name in ("x", "y"):
        if name not in found and not (name == "y" and "z" in found):
            columns = ", ".join(f"'{name[:30]}'" for name in table.header[:6])
            raise TableError(f"has no column '{name} (mm)', but {columns}", allowed)
    return {name: found[name] for name in "xyz" if name in found}


class Points(Curve):
    """A single-valued profile given by samples, joined by straight lines.

    Parameters
    ----------
    x, y
        (n,) m; x strictly increasing. The lowest point is moved to height zero.
    ends
        What is beyond the first and the last sample: nothing ("open"), a "level" surface at their
        heights, or the "slope" of the lines there, for ever.
    smooth
        "auto", "none" or a cut-off wavelength, m (see :meth:`felt`).
    rounding
        m, radius with which open ends turn away from the skin.
    axis
        Whether it is turned about x = 0, between whose samples to either side it is round: points
        of a scan know no tip.

    Raises
    ------
    ValueError
        Fewer than two samples or x not strictly increasing.
    """

    irregular = True
    #: rad, slope of the sides into which open ends turn
    side = np.radians(80.0)

    def __init__(self, x, y, ends="open", smooth="auto", rounding=0.0, axis=False):
        self.samples = self.measured = np.asarray(x, float), np.asarray(y, float) - np.min(y)
        self.ends, self.smooth, self.axis = ends, smooth, axis
        x, y = self.samples
        bend = np.zeros(max(len(x) - 1, 0))
        if axis and len(x) > 3:
            x, y, bend = self._round_on_axis(x, y)
        if ends != "slope" and len(x) >= 2 and np.all(np.diff(x) > 0):
            right = self._end(x[-2:], y[-2:], rounding)
            left = self._end(-x[1::-1], y[1::-1], rounding)
            self.own = slice(len(left[0]), len(left[0]) + len(bend))
            x = np.concatenate([-np.array(left[0][::-1]), x, right[0]])
            y, bend = (
                np.concatenate([left[k][::-1], inner, right[k]]) for k, inner in ((1, y), (2, bend))
            )
        super().__init__(x, y, bend)
        self.known = tuple(map(float, self.samples[0][[0, -1]]))
        if ends == "open":
            self.reach = self._open_reach(x, rounding)

    def _open_reach(self, x, rounding):
        """First and last place (m) that can touch first: an end that falls goes on to fall until
        its rounding (radius in m) turns it away. x: (n,) m, of the profile with its ends.
        """
        (first, *_, last), y = self.known, self.samples[1]
        left = x[1] if rounding and y[0] < y[1] else first
        right = x[-2] if rounding and y[-1] < y[-2] else last
        return float(left), float(right)

    def _end(self, x, y, rounding):
        """x, y (k,) m and curvature (k,) 1/m of the pieces that follow the last of two samples on
        the right.
        """
        (x, last), (y, height) = x, y
        if self.ends == "level":
            return [last + (last - x)], [height], [0.0]
        slope = np.arctan2(height - y, last - x)
        turn = max(self.side - slope, 0.0) / 2
        xs, ys, bends = [], [], []
        if rounding and turn:
            chord = 2 * rounding * np.sin(turn)
            last, height = (
                last + chord * np.cos(slope + turn),
                height + chord * np.sin(slope + turn),
            )
            xs, ys, bends = [last], [height], [1 / rounding]
        length = rounding or 1e-4
        steep = slope + 2 * turn
        return (
            [*xs, last + length * np.cos(steep)],
            [*ys, height + length * np.sin(steep)],
            [*bends, 0.0],
        )

    def _round_on_axis(self, x, y):
        """Mirrored points without that on the axis, and bends between them: an arc where it was, as
        steep at its ends as the surface beside the axis.
        """
        first = int(np.searchsorted(x, 0.0, side="right"))
        inner = first - 1 if x[first - 1] == 0 else first
        slope = np.arctan2(y[inner + 1] - y[inner], x[inner + 1] - x[inner])
        self.tip, self.flank = float(x[first]), abs(float(np.tan(slope)))
        on = np.arange(len(x)) != (inner if inner < first else -1)
        bend = np.zeros(on.sum() - 1)
        bend[len(bend) // 2] = np.sin(slope) / self.tip
        return x[on], y[on], bend

    def corners(self):
        inner = super().corners()
        if self.ends != "open":
            return inner
        first, last = self.known
        inner = inner[(inner[:, 0] > first) & (inner[:, 0] < last)]
        return np.vstack([(first, np.pi / 2, np.inf), inner, (last, np.pi / 2, np.inf)])

    def outline(self, x):
        height = self._height(x)
        return np.where((x >= self.reach[0]) & (x <= self.reach[1]), height, np.nan)

    def _farthest(self, x, y, height):
        within = super()._farthest(x, y, height)
        left = x < (self.known[0] + self.known[1]) / 2
        beyond = np.where(left, self.known[0] - x, x - self.known[1])
        # away from the steep sides the samples' own slopes count; beside them, how far their end is
        # away
        end = np.hypot(beyond, y - np.where(left, *self.samples[1][[0, -1]]))
        inside = np.where(
            -beyond > within, np.abs(y - height) * share_of_height(self.steepness), within
        )
        return np.where(beyond > 0, np.minimum(within, end), inside)

    def cutoffs(self, edge):
        """Cut-off wavelengths (m) that come into question for a skin with nodes ``edge`` m apart; 0
        is none.
        """
        if self.smooth == "none":
            return [0.0]
        return cutoffs(*self.samples, edge) if self.smooth == "auto" else [self.smooth]

    def at(self, smoothing, edge):
        points = smoothed(*self.samples, smoothing) if smoothing else self.samples
        felt = Points(*points, self.ends, self.smooth, rounding=edge, axis=self.axis)
        felt.smoothing, felt.measured = smoothing, self.samples
        if felt.tip and smoothing > 4 * felt.tip:  # as the filter left it
            felt.tip = smoothing / 4
            rise = np.diff(felt.outline(np.array([felt.tip, 2 * felt.tip])))[0]
            felt.flank = abs(float(rise / felt.tip))
        return felt

    def bulge(self, x: float, half_width: float) -> float:
        """Curvature (1/m) around the place near ``x`` m that stands out most, fitted over
        ``half_width`` m to either side.
        """
        near = np.linspace(x - half_width, x + half_width, 65)
        height = self.outline(near)
        if not np.isfinite(height).sum() > 3:
            return 0.0
        lowest = near[np.nanargmin(height)]
        near = np.linspace(lowest - half_width, lowest + half_width, 65)
        height = self.outline(near)
        there = np.isfinite(height)
        return float(2 * np.polyfit(near[there] - lowest, height[there], 2)[0])

    def moved(self, first: float, last: float) -> float:
        """Largest change (m) of the measured heights by the smoothing between two places (m), one
        as a whole apart.
        """
        x, y = self.measured
        near = (x >= first) & (x <= last)
        if not self.smoothing or not near.any():
            return 0.0
        change = self._height(x[near]) - y[near]
        return float(np.ptp(change) / 2)

    def advice(self, spacing):
        if not self.smoothing and not is_rough(*self.measured, max(spacing, SKIN_EDGE)):
            return None
        x, _ = self.measured
        apart = float(np.median(np.diff(x)))
        cutoff = max(2 * self.smoothing, WAVE * max(spacing, SKIN_EDGE))
        return (
            f"smoothing of the profile, whose corners are {apart * 1e6:.3g} um apart, "
            f"the nodes {spacing * 1e6:.3g} um: "
            f'stimulus.smooth: "{cutoff * 1e6:.0f} um" or more'
        )

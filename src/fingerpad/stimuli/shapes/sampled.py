"""A profile given by points, as measured ones are: its file, its smoothing and its ends."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
from collections.abc import Callable, Iterator
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import ConfigDict
from pydantic.json_schema import SkipJsonSchema

from fingerpad.documents import HIDE, Problem
from fingerpad.fields import quantity
from fingerpad.files import read_input
from fingerpad.stimuli.curve import Curve, share_of_height
from fingerpad.stimuli.shapes.shape import CurvedShape
from fingerpad.stimuli.smoothing import SKIN_EDGE, WAVE, cutoffs, is_rough, smoothed
from fingerpad.units import QuantityError, parse_number, parse_quantity


def _needs_its_file(schema: dict[str, Any]) -> None:
    schema["required"] = ["csv"]
    schema["properties"]["csv"] |= schema["properties"]["csv"].pop("anyOf")[0]


class Sampled(CurvedShape):
    """Rigid profile given by points of its lower surface: y is up, the solid lies above, and x = 0 is over the pad's apex.

    Only differences of y matter: the profile comes down until it touches. figures/studies/profile_convention.png shows it.
    """

    internal: ClassVar = frozenset({"x", "y"})
    follows: ClassVar = {"csv": ("x", "y")}

    model_config = ConfigDict(json_schema_extra=_needs_its_file)
    shape: Literal["sampled"] = "sampled"
    csv: Path | None = None
    """File with the columns `x (mm)` and `y (mm)`, or another unit of length in them; x strictly increasing."""
    smooth: quantity("length", words=("auto", "none")) = "auto"
    """Structure finer than nodes can feel: `auto` filters it out where there is any, `none` keeps it, or a cut-off wavelength."""
    ends: Literal["open", "level", "slope"] = "open"
    """What lies beyond the points: nothing (`open`), a `level` surface, or the `slope` of the last two, for ever."""
    x: SkipJsonSchema[tuple[float, ...]]
    y: SkipJsonSchema[tuple[float, ...]]

    @classmethod
    def fill(cls, data: dict[str, Any], context: Any) -> dict[str, Any]:
        """Reads the points from the file."""
        if "x" not in data:
            if data.get("csv") is None:
                raise Problem("is missing", "the path of a CSV file, or in Python x and y", ("csv",), HIDE)
            if not isinstance(data["csv"], (str, Path)):
                raise Problem("is not a path", "the path of a CSV file", ("csv",))
            data["csv"] = Path(data["csv"]).expanduser() if context is None else context.resolve(data["csv"])
            data["x"], data["y"] = _read_profile(data["csv"])
        return data | {key: tuple(map(float, data[key])) for key in "xy" if isinstance(data.get(key), np.ndarray)}

    @cached_property
    def curve(self) -> Points:
        return Points(self.x, self.y, self.ends, self.smooth)

    def recorded(self):
        """The file's name, and a hash of its points."""
        points = json.dumps([self.x, self.y]).encode()
        return {"csv": self.csv and self.csv.name, "sha256": hashlib.sha256(points).hexdigest()}


_COLUMN = re.compile(r"\s*([xy])\s*\((.*)\)\s*", re.IGNORECASE)
NARROWEST, WIDEST = 10e-6, 10.0
"""Widths (m) between which a profile is believed to be in the unit that its columns name."""
MOST_LINES = 500_000
"""Of the file of a profile."""


def _read_profile(path: Path) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Points of a profile, m; `Problem` unless they are numbers with x strictly increasing, of a believable size."""

    def wrong(problem: str, allowed: str = "a CSV file with the columns 'x (mm)' and 'y (mm)', x strictly increasing") -> Problem:
        return Problem(problem, allowed, ("csv",))

    try:
        content = read_input(path, "table")
        if max(map(content.count, (b"\n", b"\r"))) > MOST_LINES:
            raise wrong(
                f"has more than {MOST_LINES} lines", f"up to {MOST_LINES}; a profile needs no more than the skin can feel"
            )
        rows = _rows(content.decode("utf-8-sig"))
        line, header = next(rows, (0, None))
        columns, factors = _profile_columns(header, wrong) if header else ([], [])
        points: list[tuple[float, ...]] = []
        for line, row in rows:
            point = tuple(
                factor * parse_number(row[k] if k < len(row) else "") for k, factor in zip(columns, factors, strict=True)
            )
            if points and point[0] <= points[-1][0]:
                raise wrong(f"is not single-valued: x does not increase in row {line}")
            points.append(point)
    except FileNotFoundError:
        raise wrong("is not an existing file") from None
    except QuantityError:
        raise wrong(f"has no finite number in row {line}") from None
    except Problem:
        raise
    except (OSError, ValueError, csv.Error) as error:
        raise wrong(f"cannot be read ({getattr(error, 'strerror', None) or type(error).__name__})") from None
    if len(points) < 2:
        raise wrong("has fewer than two points")
    x, y = zip(*points, strict=True)
    width = x[-1] - x[0]
    if not NARROWEST <= width <= WIDEST:
        size = f"{width:.3g} m" if width > WIDEST else f"{width * 1e6:.3g} um"
        raise wrong(
            f"is {size} wide by its column '{header[columns[0]]}'", "10 um to 10 m; is the unit another one, um, mm or m?"
        )
    return x, y


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """The rows of a CSV file that say something, with the number of the line each ends in."""
    at = 0

    def lines() -> Iterator[str]:
        nonlocal at
        for line in io.StringIO(text, newline=""):
            at += 1
            if line.strip() and line.lstrip()[0] != "#":
                yield line

    for row in csv.reader(lines(), skipinitialspace=True):
        yield at, row


def _profile_columns(header: list[str], wrong: Callable[..., Problem]) -> tuple[list[int], list[float]]:
    """Where x and y stand in a row, and their units in m."""
    found: dict[str, tuple[int, float]] = {}
    for k, name in enumerate(header):
        match = _COLUMN.fullmatch(name)
        if match and match[1].lower() not in found:
            try:
                found[match[1].lower()] = k, parse_quantity(f"1 {match[2]}", "length")
            except QuantityError as error:
                raise wrong(f"has the column '{name}', which {error.problem}") from None
    for name in "xy":
        if name not in found:
            raise wrong(f"has no column '{name} (mm)'")
    return [found[name][0] for name in "xy"], [found[name][1] for name in "xy"]


class Points(Curve):
    """A single-valued profile given by samples, joined by straight lines.

    Args:
        x, y: (n,) m; x strictly increasing. The lowest point is moved to height zero.
        ends: what is beyond the first and the last sample: nothing ("open"), a "level" surface at their heights, or the "slope"
            of the lines there, for ever. smooth: "auto", "none" or a cut-off wavelength, m (see :meth:`felt`).
        rounding: m, radius with which open ends turn away from the skin.

    Raises:
        ValueError: fewer than two samples or x not strictly increasing.
    """

    irregular = True
    #: rad, slope of the sides into which open ends turn
    side = np.radians(80.0)

    def __init__(self, x, y, ends="open", smooth="auto", rounding=0.0):
        self.samples = self.measured = np.asarray(x, float), np.asarray(y, float) - np.min(y)
        self.ends, self.smooth = ends, smooth
        x, y = self.samples
        bend = np.zeros(max(len(x) - 1, 0))
        if ends != "slope" and len(x) >= 2 and np.all(np.diff(x) > 0):
            right = self._end(x[-2:], y[-2:], rounding)
            left = self._end(-x[1::-1], y[1::-1], rounding)
            self.own = slice(len(left[0]), len(left[0]) + len(bend))
            x = np.concatenate([-np.array(left[0][::-1]), x, right[0]])
            y, bend = (np.concatenate([left[k][::-1], inner, right[k]]) for k, inner in ((1, y), (2, bend)))
        super().__init__(x, y, bend)
        self.known = tuple(map(float, self.samples[0][[0, -1]]))
        if ends == "open":
            self.reach = self.known

    def _end(self, x, y, rounding):
        """x, y (k,) m and curvature (k,) 1/m of the pieces that follow the last of two samples on the right."""
        (x, last), (y, height) = x, y
        if self.ends == "level":
            return [last + (last - x)], [height], [0.0]
        slope = np.arctan2(height - y, last - x)
        turn = max(self.side - slope, 0.0) / 2
        xs, ys, bends = [], [], []
        if rounding and turn:
            chord = 2 * rounding * np.sin(turn)
            last, height = last + chord * np.cos(slope + turn), height + chord * np.sin(slope + turn)
            xs, ys, bends = [last], [height], [1 / rounding]
        length = rounding or 1e-4
        steep = slope + 2 * turn
        return [*xs, last + length * np.cos(steep)], [*ys, height + length * np.sin(steep)], [*bends, 0.0]

    def outline(self, x):
        height = self._height(x)
        return np.where((x >= self.reach[0]) & (x <= self.reach[1]), height, np.nan)

    def _farthest(self, x, y, height):
        within = super()._farthest(x, y, height)
        left = x < (self.known[0] + self.known[1]) / 2
        beyond = np.where(left, self.known[0] - x, x - self.known[1])
        # away from the steep sides the samples' own slopes count; beside them, how far their end is away
        end = np.hypot(beyond, y - np.where(left, *self.samples[1][[0, -1]]))
        inside = np.where(-beyond > within, np.abs(y - height) * share_of_height(self.steepness), within)
        return np.where(beyond > 0, np.minimum(within, end), inside)

    def cutoffs(self, edge):
        """Cut-off wavelengths (m) that come into question for a skin with nodes ``edge`` m apart; 0 is none."""
        if self.smooth == "none":
            return [0.0]
        return cutoffs(*self.samples, edge) if self.smooth == "auto" else [self.smooth]

    def felt(self, edge):
        """The profile without what may be noise to a skin with nodes ``edge`` m apart: after the longest of its cut-offs."""
        return self.at(self.cutoffs(edge)[-1], edge)

    def at(self, smoothing, edge):
        points = smoothed(*self.samples, smoothing) if smoothing else self.samples
        felt = Points(*points, self.ends, self.smooth, rounding=edge)
        felt.smoothing, felt.measured = smoothing, self.samples
        return felt

    def bulge(self, x: float, half_width: float) -> float:
        """Curvature (1/m) around the place near ``x`` m that stands out most, fitted over ``half_width`` m to either side."""
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
        """Largest change (m) of the measured heights by the smoothing between two places (m), one as a whole apart."""
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
        apart, cutoff = float(np.median(np.diff(x))), max(2 * self.smoothing, WAVE * max(spacing, SKIN_EDGE))
        return (
            f"smoothing of the profile, whose corners are {apart * 1e6:.3g} um apart, the nodes {spacing * 1e6:.3g} um: "
            f'stimulus.smooth: "{cutoff * 1e6:.0f} um" or more'
        )

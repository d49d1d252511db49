"""What a curve or a number that is shown is wrong by, in three parts found apart from each other.

mesh
    what is left by what it changes by on its companions' coarser mesh, with the run's own steps and
    outputs, if it converges with the order that was measured, pressure profiles with a lower one
    (`remains`), and edges are longer as the root of the nodes is smaller: geometry, ridges above
    all, keeps some as short. On a mesh of the user's own by what it changes by with its linear
    quads made quadratic, or the other way round; of all other elements it is not known.
time steps
    the same of what it changes by on that mesh when every two steps are made one, read at the
    outputs that are left; of a stroke, when steps may be twice as long and what lies between its
    states off by twice as much.
sampling
    what straight lines between outputs leave out: what it changes by when every second output is
    left out, over 2^p. The order p is seen when every fourth is left: 2 of a smooth curve, 3/2 of
    one with a kink, 1/2 of one with a jump.

Each is a norm over the very curve shown, in per cent of the curve's own. They are estimates, not
bounds: figures/tables/accuracy_shown has them beside what curves change by on finer meshes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import astuple, dataclass
from functools import cached_property, lru_cache
from typing import Any, ClassVar, TypeVar

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad.measures.features import Feature, Trace
from fingerpad.measures.kept import kept
from fingerpad.measures.strokes import distance, loaded
from fingerpad.planning.errors import COARSER, ORDER, REMAINS, STEPS_REMAIN, remains
from fingerpad.results import scene_of

MESH, STEPS, SAMPLING = PARTS = ("mesh_error (%)", "time_step_error (%)", "sampling_error (%)")
"""Columns of the three parts of an error."""
LEFT = REMAINS, STEPS_REMAIN, 1.0
"""What is left of a value's changes: on the companions' mesh, by their steps, and (all of it) by
what sampling leaves out.
"""
SHOWN_ABOVE = 2.0
"""Per cent from which on an error is drawn as a band or a bar."""

Number = TypeVar("Number", float, np.ndarray, pd.Series, pd.DataFrame)
"""A number, or some."""

_SMOOTH, _ROUGH = 2.0, 0.0  # orders at which straight lines come closer to a curve
_FEW = 5  # outputs, of which fewer do not show an order
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Companion:
    """A scene on a coarser mesh: with the run's own steps, and with `both` coarser, every two steps
    made one.
    """

    EDGES: ClassVar[float] = COARSER  # over the run's own, where plans do not tell nodes

    mesh: xr.Dataset
    both: xr.Dataset

    @cached_property
    def sparse(self) -> xr.Dataset:
        """The one with the run's own steps at the outputs of the other: what these two differ by is
        the steps'.
        """
        return (
            self.mesh if self.mesh.sizes["time"] == self.both.sizes["time"] else thinned(self.mesh)
        )

    def apart(self, history: xr.Dataset) -> xr.Dataset | None:
        """The one with the run's own steps; None where its mesh has as many nodes as the run's: it
        tells nothing of its error.
        """
        own, other = (
            _planned(each).get("discretisation", {}).get("nodes") for each in (history, self.mesh)
        )
        return None if own is not None and own == other else self.mesh

    def remains(self, history: xr.Dataset, order: float = ORDER) -> float:
        """What a curve is wrong by over what it changes by on the other mesh, if that is
        :meth:`apart`.

        Its edges are taken to be longer as the root of its nodes is smaller (representative size;
        Celik et al. 2008, Eq 2).
        """
        own, other = _planned(history), _planned(self.mesh)
        if not own or _external(own):
            return remains(self.EDGES, order)
        nodes, others = (each["discretisation"]["nodes"] for each in (own, other))
        return remains((nodes / others) ** 0.5, order)

    def mesh_error(self, history: xr.Dataset, curve: Curve) -> float:
        """What a curve is wrong by because of the mesh, as a norm in the unit of its values; NaN
        where that is not known.
        """
        if (other := self.apart(history)) is None:
            return np.nan
        (x, y), (xm, ym) = curve(history), curve(other)
        # over the skin at the nodes of the coarser mesh: what is between them is no error of these
        change = (
            norm(x, y - np.interp(x, xm, ym))
            if curve.outputs
            else norm(xm, ym - np.interp(xm, x, y))
        )
        return self.remains(history, curve.order) * change

    def number(self, history: xr.Dataset, own: Number, other: Number) -> Number:
        """A number, of what it is on the run's `own` mesh and on the other, on one with edges
        `COARSER` times as long.
        """
        return own + self.remains(history) / REMAINS * (other - own)


def _planned(history: xr.Dataset) -> dict[str, Any]:
    return _plan(history.attrs.get("plan", "{}"))


@lru_cache(maxsize=256)
def _plan(text: str) -> dict[str, Any]:
    return json.loads(text)


def _external(planned: Mapping[str, Any]) -> bool:
    return "mesh_size_SI" in planned and planned["mesh_size_SI"] is None


def instead(
    history: xr.Dataset, companion: Companion | None, read: Callable[[xr.Dataset], Number]
) -> tuple[Number, ...]:
    """What is read in place of a run's: on a coarser mesh, and there with its own steps and coarser
    ones; NaN: not known.
    """
    own = read(history)
    if companion is None:
        return (own * np.nan,) * 3
    other = companion.apart(history)
    mesh = own * np.nan if other is None else companion.number(history, own, read(other))
    return mesh, read(companion.sparse), read(companion.both)


Companions = Mapping[str, Companion]


@dataclass(frozen=True)
class Errors:
    """The three parts of an error; NaN where nothing was simulated that tells."""

    mesh: float
    steps: float
    sampling: float

    @classmethod
    def left(cls, *changes: float) -> Errors:
        """Of what a value changes by on the companions' mesh, by their steps and by sampling, what
        is left (:data:`LEFT`).
        """
        return cls(*(share * change for share, change in zip(LEFT, changes, strict=True)))

    @property
    def total(self) -> float:
        """Their sum."""
        return float(np.nansum(astuple(self)))

    @property
    def columns(self) -> dict[str, float]:
        """The parts by the columns `PARTS` of a data frame."""
        return dict(zip(PARTS, astuple(self), strict=True))


def total(frame: pd.DataFrame) -> pd.Series:
    """The sum of the parts in each row of a frame; NaN in those without any."""
    return frame[list(PARTS)].sum(axis=1, min_count=1)


# --- curves ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Curve:
    """A curve that is shown.

    Attributes
    ----------
    read
        ``read(history)``: places (n,), in one direction, twice where the curve jumps, and values
        (n,).
    outputs
        Whether its points are outputs; else they are places on the skin at one output.
    order
        With which it converges with the mesh.
    """

    read: Callable[[xr.Dataset], tuple[np.ndarray, np.ndarray]]
    outputs: bool = True
    order: float = ORDER

    def __call__(self, history: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
        """Places that grow, and values."""
        x, y = (np.asarray(part, float) for part in self.read(history))
        way = 1.0 if x[-1] >= x[0] else -1.0
        x = way * x
        # of a jump the later side lies a little later, so that it can be interpolated
        apart = np.concatenate([[0.0], np.where(np.diff(x) > 0, 0.0, 1e-12 * (np.ptp(x) or 1.0))])
        return x + apart, y

    def sparse(self, history: xr.Dataset, every: int) -> list[tuple[np.ndarray, np.ndarray]]:
        """The curve of every so many-th output and of the ends of legs; or of so many points, from
        each of the first ones on.
        """
        if self.outputs:
            return [self(thinned(history, every))]
        x, y = self(history)
        ends = [0, len(x) - 1]
        kept = [np.union1d(ends, np.arange(start, len(x), every)) for start in range(every)]
        return [(x[k], y[k]) for k in kept]


def over_time(trace: Trace, order: float = ORDER) -> Curve:
    """A trace over time."""
    return Curve(lambda history: (history["time"].values, trace(history)), order=order)


def over_stroke(trace: Trace, low: float = -np.inf, high: float = np.inf) -> Curve:
    """A trace of the loaded outputs of a stroke, over its distance, from `low` to `high` (m) of
    it.
    """

    def read(history: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
        x, y = distance(stroke := loaded(history)), trace(stroke)
        shown = (x >= low) & (x <= high)
        return x[shown], y[shown]

    return Curve(read)


def at_output(
    time: float,
    read: Callable[[xr.Dataset, int], tuple[np.ndarray, np.ndarray]],
    order: float = ORDER,
) -> Curve:
    """A curve over the skin, ``read(history, index)``, at the output nearest to a time (s)."""
    return Curve(
        lambda history: read(history, int(np.argmin(abs(history["time"].values - time)))),
        False,
        order,
    )


@kept
def thinned(history: xr.Dataset, every: int = 2) -> xr.Dataset:
    """Every so many-th output of each leg, and the last of each; of a stroke, of its loaded
    outputs.
    """
    if "stroke_distance" in history and np.ptp(history["stroke_distance"].values):
        history = loaded(history)
    leg = history["leg"].values
    # the unloaded pad is where the first leg begins, and the end of each where the next does
    first = np.searchsorted(leg, leg)
    count = np.arange(len(leg)) - first + (first > 0)
    shown = (count % every == 0) | np.append(np.diff(leg) != 0, True)
    return history.isel(time=np.flatnonzero(shown))


def norm(x: np.ndarray, y: np.ndarray) -> float:
    """Root mean square (in y's unit) of a curve over its places."""
    span = x[-1] - x[0]
    return float(np.sqrt(np.trapezoid(y**2, x) / span if span > 0 else np.mean(y**2)))


def curve_errors(history: xr.Dataset, companion: Companion | None, *curves: Curve) -> Errors:
    """Errors of the curve that is furthest off, in per cent of its norm. Mesh and steps are NaN
    without a companion.
    """
    return furthest(_of_curve(history, companion, curve) for curve in curves)


def family_errors(
    history: xr.Dataset, companion: Companion | None, curves: Iterable[Curve]
) -> Errors:
    """Errors of curves drawn as one family: r.m.s. of all of them over that of what they show, in
    per cent.

    For many lines of one quantity on one axis, of which some hardly rise from zero: relative to
    themselves these tell nothing.
    """
    curves = list(curves)
    size = np.array([norm(*curve(history)) for curve in curves])
    parts = np.array([astuple(_of_curve(history, companion, curve)) for curve in curves])
    rising = np.where(size[:, None] > 0, size[:, None] * parts, 0.0)
    return Errors(*np.linalg.norm(rising, axis=0) / (np.linalg.norm(size) or np.inf))


def _of_curve(history: xr.Dataset, companion: Companion | None, curve: Curve) -> Errors:
    share = 100 / (norm(*curve(history)) or np.inf)
    mesh, steps = np.nan, np.nan
    if companion is not None:
        (x, y), sparse = curve(companion.both), curve(companion.sparse)
        mesh = companion.mesh_error(history, curve)
        steps = STEPS_REMAIN * norm(x, y - np.interp(x, *sparse))
    return Errors(share * mesh, share * steps, share * sampling(history, curve))


def shared_place(place: float, companion: Companion | None) -> float:
    """Place (m) along the skin at rest of the companions' node nearest to a place."""
    if companion is None:
        return place
    x = companion.mesh["skin_x"].values[companion.mesh["skin_y"].values > 0]
    return float(x[np.argmin(abs(x - place))])


def sampling(history: xr.Dataset, curve: Curve) -> float:
    """What straight lines between its points leave out of a curve, as a norm in the unit of its
    values.

    Left out every second point, the lines miss by 2^p times as much. Where the values themselves
    follow from differences of outputs, as rates do, those that stay change too, by 2^p - 1 times
    what they are wrong by. Of a surface stepped over the pad nothing is left out: it is pressed at
    these points.
    """
    stepped = "scene" in history.attrs and any(leg.fresh for leg in scene_of(history).motion)
    if curve.outputs and stepped:
        return 0.0
    x, y = curve(history)
    rough = [curve.sparse(history, every) for every in (2, 4)]
    second, fourth = (
        np.sqrt(np.mean([norm(x, y - np.interp(x, *each)) ** 2 for each in found]))
        for found in rough
    )
    if second <= _ROUND_OFF * norm(x, y):
        return 0.0
    order = np.clip(np.log2(fourth / second), _ROUGH, _SMOOTH) if len(x) >= _FEW else _ROUGH
    at, kept = rough[0][0]
    derived = not np.allclose(kept, np.interp(at, x, y), rtol=1e-6, atol=1e-6 * abs(y).max())
    return float(second / max(2**order - derived, 1.0))


# --- numbers --------------------------------------------------------------------------------------


def number_errors(history: xr.Dataset, companion: Companion | None, *features: Feature) -> Errors:
    """Errors of the number, or numbers together, that are furthest off, in per cent of their
    size.
    """
    return furthest(_of_number(history, companion, feature) for feature in features)


def _of_number(history: xr.Dataset, companion: Companion | None, feature: Feature) -> Errors:
    def read(found: xr.Dataset) -> np.ndarray:
        return np.atleast_1d(feature(found))

    own, (mesh, sparse, both) = read(history), instead(history, companion, read)
    share = 100 / (np.linalg.norm(own) or np.inf)
    pairs = (own, mesh), (sparse, both), (own, read(thinned(history)))
    return Errors.left(*(share * float(np.linalg.norm(a - b)) for a, b in pairs))


def furthest(found: Iterable[Errors]) -> Errors:
    """The errors whose sum is largest."""
    return max(found, key=lambda errors: errors.total)

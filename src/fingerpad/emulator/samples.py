"""What a sweep's histories show: every quantity at the same moments, shares of the press and times
of the hold. Pressures are brought to shares of the half width of the contact, so a moving edge does
not smear.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fingerpad.documents import SceneError
from fingerpad.emulator.basis import SOONEST, cubic_weights, held, spread
from fingerpad.emulator.model import ENERGY, SLID, Moments, in_logarithm
from fingerpad.emulator.question import Knob
from fingerpad.results import read_history
from fingerpad.stimuli.motion import NO_TIME
from fingerpad.units import dimension_of, parse_quantity

HOLDS, SLIDES = 12, 32
"""Moments of a hold, and of a slide."""
ARCS = 41
"""Places on the right half of the skin."""
GROWN = "grown"
"""Folder of a sweep in which the sweeps are that were added to it."""


@dataclass(frozen=True)
class Samples:
    """What a sweep's histories show.

    Attributes
    ----------
    points : (n, knobs) SI.
    values : name -> (n, ...) values at all moments.
    """

    points: np.ndarray
    values: dict[str, np.ndarray]

    def only(self, rows: np.ndarray) -> Samples:
        """Some of the scenes."""
        return Samples(self.points[rows], {name: v[rows] for name, v in self.values.items()})

    def and_also(self, more: Samples) -> Samples:
        """These scenes, then more."""
        values = {name: np.concatenate([v, more.values[name]]) for name, v in self.values.items()}
        return Samples(np.concatenate([self.points, more.points]), values)


@dataclass(frozen=True)
class Swept:
    """A sweep and what was added to it.

    Attributes
    ----------
    folder : Path
        Of the sweep.
    about : dict
        Its provenance.
    knobs, base, moments, grids
        See `Emulator`.
    samples : Samples
        Of the scenes that can be emulated, the sweep's own first.
    drawn : int
        How many are the sweep's own.
    lost : int
        How many others could be simulated.
    """

    folder: Path
    about: Mapping[str, Any]
    knobs: list[Knob]
    base: Mapping[str, Any]
    moments: Moments
    grids: Mapping[str, np.ndarray]
    samples: Samples
    drawn: int
    lost: int

    @classmethod
    def read(cls, folder: Path) -> Swept:
        """Read the histories of a sweep. Raises SceneError."""
        design = _design(folder)
        knobs, base = _knobs(folder, design), json.loads(design["about"]["base_scene"])
        moments = _moments(folder, base)
        histories = list(_histories(folder, design, len(knobs)))
        grids = _grids(histories[0][1], moments)
        samples, lost = _samples(histories, moments, grids)
        about, drawn = design["about"], len(samples.points)
        found = cls(folder, about, knobs, base, moments, grids, samples, drawn, lost)
        for more in sorted((folder / GROWN).glob("*/design.json")):
            found = found.with_more(more.parent)
        return found

    def with_more(self, folder: Path) -> Swept:
        """With another sweep of the same scene over the same keys. Raises SceneError."""
        design, own = _design(folder), [knob.key for knob in self.knobs]
        base = json.loads(design["about"]["base_scene"])
        keys = [p["key"] for p in design["parameters"]]
        if keys != own:
            raise SceneError(f"{folder}: is over {', '.join(keys)}; allowed: {', '.join(own)}")
        if any(base[k] != self.base[k] for k in base.keys() - {"name", "tags", "accuracy"}):
            raise SceneError(f"{folder}: has another scene; allowed: that of the sweep")
        histories = list(_histories(folder, design, len(keys)))
        more, lost = _samples(histories, self.moments, self.grids)
        if not len(more.points):
            return replace(self, lost=self.lost + lost)
        return replace(self, samples=self.samples.and_also(more), lost=self.lost + lost)


def _design(folder: Path) -> dict[str, Any]:
    try:
        return json.loads((folder / "design.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise SceneError(f"{folder}: holds no sweep; allowed: the folder of a sweep") from None


def _knobs(folder: Path, design: Mapping[str, Any]) -> list[Knob]:
    """The axes of a sweep; their box is what was drawn from, or from the least to the largest
    value.
    """
    over, knobs = json.loads(design["about"]["sweep"])["over"], []
    for p in design["parameters"]:
        if not p["unit"]:
            allowed = "numbers; make a sweep and an emulator for each of its values"
            raise SceneError(f"{folder}: over.{p['key']}: is not a number; allowed: {allowed}")
        if p["key"] in ("motion[1].hold", "motion[1].slide"):
            allowed = "the longest alone; a shorter one is its beginning"
            raise SceneError(f"{folder}: over.{p['key']}: is no knob; allowed: {allowed}")
        per = 1.0 if p["unit"] == "1" else _si(p["unit"])
        axis = over.get(p["key"], {})
        ends = axis.get("range") or axis.get("uniform")
        ends = [_number(e, per) for e in ends] if ends else [per * v for v in p["values"]]
        even = axis.get("spacing") != "logarithmic" and "lognormal" not in axis
        warp = "linear" if even or min(ends) <= 0 else "logarithm"
        knobs.append(Knob(p["key"], p["name"], p["unit"], per, min(ends), max(ends), warp))
    return knobs


def _si(unit: str) -> float:
    return _number(f"1 {unit}", 1.0)


def _number(value: Any, per: float) -> float:
    if not isinstance(value, str):
        return per * float(value)
    dimension = dimension_of(value.partition(" ")[2])
    assert dimension, value  # the sweep has read it
    return parse_quantity(value, dimension)


def _histories(folder: Path, design: Mapping[str, Any], knobs: int) -> Iterator[tuple]:
    """Point and history of each scene that could be simulated."""
    sizes = tuple(design["dimensions"].values())
    names, found = list(design["dimensions"]), 0
    for number, key in enumerate(design["keys"]):
        place = dict(zip(names, np.unravel_index(number, sizes), strict=True))
        file = folder / "histories" / f"{key}.nc"
        if not file.exists():
            continue
        found += 1
        point = [p["values"][place[p["dimension"]]] for p in design["parameters"]]
        scale = [1.0 if p["unit"] == "1" else _si(p["unit"]) for p in design["parameters"]]
        yield np.array(point, float) * scale, read_history(file)
    if not found:
        raise SceneError(f"{folder}: keeps no histories; allowed: a sweep with histories: true")


def _moments(folder: Path, base: Mapping[str, Any]) -> Moments:
    """The moments of the sweep's motion: a press, alone or before a hold or a slide."""
    legs = base["motion"]
    kinds = [next(iter(leg.keys() & {"press_to_force", "hold", "slide"}), "") for leg in legs]
    keeps = legs[-1].get("keep", "force") == "force"
    if kinds[0] != "press_to_force" or kinds[1:] not in ([], ["hold"], ["slide"]) or not keeps:
        allowed = "a press to a force, alone or before one hold or one slide under that force"
        raise SceneError(f"{folder}: its scenes move otherwise; allowed: {allowed}")
    rises = legs[0].get("rate") is not None
    press = np.linspace(0.1, 1.0, 10) if rises else np.ones(1)
    if kinds[1:] == ["slide"]:
        return Moments(press, np.linspace(0, legs[1]["slide"], SLIDES + 1)[1:], slid=True)
    longest = legs[1]["hold"] if len(legs) > 1 else 0.0
    holds = np.expm1(np.linspace(0, held(longest), HOLDS + 1))[1:] * SOONEST
    return Moments(press, holds if longest else np.zeros(0))


def _grids(first: xr.Dataset, moments: Moments) -> dict[str, np.ndarray]:
    """What a sweep's histories share: places of the skin and of receptors."""
    most = float(np.abs(first.skin_arc.values).max()) * 0.98
    half = np.linspace(0, most, ARCS)
    grids = {
        "arc": np.concatenate([-half[:0:-1], half]) if moments.slid else half,
        "receptor_depth": first.receptor_depth.values,
        "receptor_offset": first.receptor_offset.values,
    }
    for name in ("skin_x", "skin_y"):
        grids[name] = np.interp(grids["arc"], first.skin_arc.values, first[name].values)
    return grids


def _samples(histories: list[tuple], moments: Moments, grids: Mapping[str, np.ndarray]):
    """Samples, and how many histories had nothing to emulate."""
    points, rows, lost = [], [], 0
    for point, history in histories:
        row = _row(history, moments, grids)
        if all(np.isfinite(value).all() for value in row.values()):
            points.append(point)
            rows.append(row)
        else:
            lost += 1
    values = {name: np.array([row[name] for row in rows]) for name in (rows[0] if rows else ())}
    return Samples(np.array(points).reshape(len(points), -1), values), lost


@np.errstate(divide="ignore", invalid="ignore")
def _row(history: xr.Dataset, moments: Moments, grids: Mapping[str, np.ndarray]):
    """Quantities of a history at all moments, as they are emulated."""
    weights, own = _at_moments(history, moments)

    def at(values: np.ndarray) -> np.ndarray:
        return np.tensordot(weights, values[own], 1)

    row = {}
    for name in moments.scalars:
        row[name] = np.exp(at(np.log(history[name].values)))
    load, depth = history.force.values, history.indentation_depth.values
    centre = _centres(history) if moments.slid else np.zeros(len(load))
    if moments.slid:
        lateral = history.tangential_force.values / load
        row |= dict(zip(SLID, (at(centre / depth), at(lateral)), strict=True))
    roots = np.sqrt(history.strain_energy_density.values) / load[:, None]
    if in_logarithm(ENERGY, "contact_radius" in history):
        row[ENERGY] = np.exp(at(np.log(roots)))
    else:
        row[ENERGY] = at(roots)
    row["pressure_shape"] = at(_pressure_shapes(history, load, centre, moments.places))
    arc = history.skin_arc.values
    for name in ("skin_displacement_x", "skin_displacement_y"):
        moved = history[name].values / depth[:, None]
        row[name] = at(np.array([np.interp(grids["arc"], arc, r) for r in moved]))
    row["estimated_error"] = np.array([float(history.attrs["estimated_error"])])
    return row


def _at_moments(history: xr.Dataset, moments: Moments) -> tuple[np.ndarray, np.ndarray]:
    """Weights (moments, outputs) that give a history's values at all moments, and which outputs."""
    time, leg = history.time.values, history.leg.values
    touching = np.flatnonzero(history.force.values > 0)
    own = touching[leg[touching] == 0]
    top = own[-1]
    press = own[np.concatenate([np.diff(time[own]) > NO_TIME, [True]])]
    if len(moments.press) == 1:
        press = press[-1:]
    grid = np.log(history.force.values[press] / history.force.values[top])
    first = cubic_weights(grid, np.log(moments.press))
    later = np.concatenate([[top], np.flatnonzero(leg == 1)])
    along = history.stroke_distance.values if moments.slid else time
    rest = cubic_weights(moments.even(along[later] - along[top]), moments.even(moments.later))
    weights = np.zeros((len(moments), len(press) + len(later)))
    weights[: len(first), : len(press)] = first
    if len(moments.later):
        weights[len(first) :, len(press) :] = rest
    return weights, np.concatenate([press, later])


def _centres(history: xr.Dataset) -> np.ndarray:
    """Where (time) the middle of the pressure lies, m."""
    place = history.skin_x.values + history.skin_displacement_x.values
    pressure = history.contact_pressure.values
    return (pressure * place).sum(axis=1) / pressure.sum(axis=1)


def _pressure_shapes(history: xr.Dataset, load, centre, places: np.ndarray) -> np.ndarray:
    """Pressure (time, places) over the mean pressure, at shares of the contact's half width."""
    place = history.skin_x.values + history.skin_displacement_x.values
    half, turned = history.contact_width.values / 2, "contact_radius" in history
    upper = (history.skin_y.values > 0) & (history.skin_arc.values >= (0 if places[0] == 0 else -1))
    found = np.zeros((len(load), len(places)))
    for k in np.flatnonzero((half > 0) & (load > 0)):
        x, p = (place[k, upper] - centre[k]) / half[k], history.contact_pressure.values[k, upper]
        found[k] = np.interp(places, x, p) * spread(half[k], turned) / load[k]
    return found

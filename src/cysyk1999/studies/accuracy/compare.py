"""A run against a finer one: its largest error, and the error that it states itself."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from fingerpad import load_scene
from fingerpad.planning.plan import Plan
from fingerpad.results import states_found
from fingerpad.scenes.scene import Scene

DEPTHS = (600e-6, 915e-6)
"""m, of the receptors that are looked at."""
QUANTITIES = (
    "indentation_depth",
    "contact_width",
    "centre_pressure",
    "peak_pressure",
    "strain_energy_density",
)
FINEST = "finest"
"""Name of the run that the others are compared with."""
BELIEVED, TRUE = "believed error (%)", "true error (%)"


def looked_at(scene: Scene, depths: tuple[float, ...] = DEPTHS) -> Scene:
    """A scene with receptors under the centre at some depths (m) only."""
    receptors = {"outputs.receptors.depths": depths, "outputs.receptors.offsets": (0.0,)}
    return scene.varied(receptors)


def resized(chosen: Plan, **edges: Any) -> Plan:
    """A plan with other edges of its mesh."""
    return replace(chosen, mesh_size=replace(chosen.mesh_size, **edges))


def difference(
    found: xr.Dataset, truth: xr.Dataset, quantities: Iterable[str] = QUANTITIES
) -> tuple[float, str]:
    """Largest relative difference of two histories, and the quantity that has it.

    At the end of every leg; the pressure in the middle relative to the largest, for it may be next
    to nothing. Of a leg that strokes it is the root mean square over its way, relative to the
    largest value on it: what a surface with hollows leaves at one moment may be next to nothing.
    """
    off = dict.fromkeys(quantities, 0.0)
    for leg in np.unique(truth.leg.values[1:]):
        one, other = (
            history.isel(time=1 + np.flatnonzero(history.leg.values[1:] == leg))
            for history in (found, truth)
        )
        way, places = np.abs(one.stroke_distance.values), np.abs(other.stroke_distance.values)
        order = np.argsort(places)
        for name in off:
            values, exact = (np.atleast_2d(history[name].values.T) for history in (one, other))
            if np.ptp(places) > 0:
                there = [np.interp(way, places[order], curve[order]) for curve in exact]
                error = np.sqrt(np.mean((values - np.stack(there)) ** 2, axis=1))
                scale = np.abs(exact).max(axis=1)
            else:
                error = np.abs(values[:, -1] - exact[:, -1])
                central = name == "centre_pressure"
                scale = np.abs(other.peak_pressure.values[-1] if central else exact[:, -1])
            off[name] = max(off[name], float((error / scale).max()))
    worst = max(off, key=off.get)
    return off[worst], worst


def belief(
    history: xr.Dataset,
    truth: xr.Dataset | None,
    quantities: Iterable[str] = QUANTITIES,
    **more: Any,
) -> dict[str, Any]:
    """The error that a run states, its true one (no truth: unknown) and in what, and its cost."""
    error, worst = (np.nan, "") if truth is None else difference(history, truth, quantities)
    cost = json.loads(history.attrs["cost"])
    return {
        BELIEVED: 100 * float(history.attrs["estimated_error"]),
        TRUE: 100 * error,
        "worst quantity": worst,
        **more,
        "nodes": cost["nodes"],
        "steps": states_found(history),
        "process time (s)": cost["cpu_s"],
    }


def by_surface(
    rows: Callable[[str, Scene], Iterable[dict[str, Any]]],
    surfaces: Iterable[str],
    scenes: Iterable[str],
) -> pd.DataFrame:
    """The rows of all surfaces, of the files of their scenes."""
    pairs = zip(surfaces, map(load_scene, scenes), strict=True)
    return pd.DataFrame([row for surface, scene in pairs for row in rows(surface, scene)])


def covered(rows: pd.DataFrame) -> pd.Series:
    """Which of the runs that are compared with a finer one are no wronger than they state."""
    asked = rows[rows[TRUE].notna()]
    return asked[BELIEVED] >= asked[TRUE]

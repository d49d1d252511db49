"""The measures of all scenes as one long table: what claims, sensitivities and figures of numbers
rest on.

The workflow writes it (``<results>/measures.csv``) from every history, its companion on a coarser
mesh, and the meshes. A row is a number: scene, quantity, condition, unit, value, and what takes its
place in `Instead`. The error of anything made of these numbers follows from what it changes by when
another column is read.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from os import PathLike
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures import of_presses, of_scenes, of_strokes
from cysyk1999.measures.errors import Companions, Errors, thinned
from cysyk1999.measures.inputs import read_results
from fingerpad.files import write_atomically
from fingerpad.measures.features import Feature, Histories, Meshes
from fingerpad.measures.kept import LazyMapping
from fingerpad.measures.measure import Measure, measures_of
from fingerpad.results import scene_of

INSTEAD = ("mesh_companion", "sparse_mesh_companion", "companion", "sparse")
"""Columns of numbers on a mesh with edges half as long again (as those on the companions' tell), on
these of the outputs that are left with coarser steps, with these steps, and of every second output
of the histories themselves.
"""
COLUMNS = ("scene", "quantity", "condition", "unit", "value", *INSTEAD)

MEASURES: dict[str, Measure] = {
    **measures_of(of_scenes),
    **measures_of(of_presses),
    **measures_of(of_strokes),
}
"""Every measure of the table, by its name."""


def reading(name: str, at: str = "") -> Feature:
    """What a measure finds in a history under one of its conditions."""
    return lambda history: MEASURES[name](history)[at]


Find = Callable[[str, str], Mapping[str, float]]
"""find(quantity, scene): condition -> value. Raises KeyError."""


class Measures:
    """Numbers by quantity, scene and condition, from a table or, when first asked for, from
    histories.
    """

    def __init__(self, find: Find) -> None:
        self.find = find

    def __call__(self, quantity: str, scene: str, condition: str = "") -> float:
        """One number. Raises KeyError saying what was not simulated."""
        found = self.find(quantity, scene)
        if condition not in found:
            raise KeyError(f"{quantity} ({condition}) of {scene}")
        return found[condition]

    def standing_in(self, scenes: Mapping[str, str]) -> Measures:
        """The same with other scenes in the place of some; all others are missing."""
        return Measures(lambda quantity, scene: self.find(quantity, scenes[scene]))

    @classmethod
    def of(cls, histories: Histories, meshes: Meshes | None = None) -> Measures:
        """Read of histories and meshes, each number once, when it is asked for."""
        runs = LazyMapping(histories.__getitem__, histories)

        @cache
        def find(quantity: str, scene: str) -> Mapping[str, float]:
            measure, history = MEASURES[quantity], runs[scene]
            described = scene_of(history)
            if not measure.where(described):
                raise KeyError(f"{quantity} of {scene}")
            if measure.of == "scene":
                return measure(described)
            return measure((meshes or {})[scene] if measure.of == "mesh" else history, runs)

        return cls(find)

    @classmethod
    def in_table(cls, table: pd.DataFrame, column: str = "value") -> Measures:
        """Of a column of the measures table, ``value`` or one of `INSTEAD`; what has a value but
        nothing there is missing.
        """
        rows = table[table[column].notna() | table["value"].isna()]
        known: dict[tuple[str, str], dict[str, float]] = {}
        for row in rows.itertuples(index=False):
            known.setdefault((row.quantity, row.scene), {})[row.condition] = getattr(row, column)
        scenes = set(rows["scene"])

        def find(quantity: str, scene: str) -> Mapping[str, float]:
            if (quantity, scene) not in known:
                raise KeyError(scene if scene not in scenes else f"{quantity} of {scene}")
            return known[quantity, scene]

        return cls(find)


class Instead(NamedTuple):
    """Measures of what is simulated or read more coarsely, by the columns `INSTEAD`."""

    mesh: Measures
    sparse_mesh: Measures
    both: Measures
    sparse: Measures

    @classmethod
    def of(cls, histories: Histories, coarse: Companions, own: Measures | None = None) -> Instead:
        """Read of histories and their companions when first asked for; own: of the histories."""
        own = own or Measures.of(histories)

        def on_another_mesh(scene: str) -> xr.Dataset:
            if (other := coarse[scene].apart(histories[scene])) is None:
                raise KeyError(scene)
            return other

        def numbers(read: Callable[[str], xr.Dataset], scenes: Iterable[str]) -> Measures:
            return Measures.of(LazyMapping(read, scenes))

        mesh = numbers(on_another_mesh, coarse)

        def half_as_coarse(quantity: str, scene: str) -> Mapping[str, float]:
            fine = own.find(quantity, scene)
            return {
                at: coarse[scene].number(histories[scene], fine[at], value)
                for at, value in mesh.find(quantity, scene).items()
                if at in fine
            }

        return cls(
            Measures(half_as_coarse),
            numbers(lambda scene: coarse[scene].sparse, coarse),
            numbers(lambda scene: coarse[scene].both, coarse),
            numbers(lambda scene: thinned(histories[scene]), histories),
        )

    @classmethod
    def in_table(cls, table: pd.DataFrame) -> Instead:
        """Of the measures table."""
        return cls(*(Measures.in_table(table, column) for column in INSTEAD))

    def errors(self, number: Callable[[Measures], float], value: float) -> Errors:
        """The errors of a number that is made of measures, in its unit."""

        def known(measures: Measures) -> float:
            try:
                return number(measures)
            except KeyError:
                return np.nan

        mesh, sparse_mesh, both, sparse = map(known, self)
        return Errors.left(abs(value - mesh), abs(sparse_mesh - both), abs(value - sparse))


def measures_table(histories: Histories, coarse: Companions, meshes: Meshes) -> pd.DataFrame:
    """Every measure of every scene, columns `COLUMNS`; empty where nothing was simulated on a
    coarser mesh, or that shows it.
    """
    fine, rows = Measures.of(histories, meshes), []
    others = Instead.of(histories, coarse, fine)
    for scene in histories:
        for name, measure in MEASURES.items():
            values = _known(fine, name, scene, told=True)
            solved = values and measure.of in ("history", "stroke")
            replaced = [_known(each, name, scene) if solved else {} for each in others]
            for at, value in values.items():
                instead = (found.get(at, np.nan) for found in replaced)
                rows.append((scene, name, at, measure.unit, value, *instead))
    return pd.DataFrame(rows, columns=COLUMNS)


def _known(
    measures: Measures, quantity: str, scene: str, told: bool = False
) -> Mapping[str, float]:
    """A measure of a scene; nothing where it has none. A scene unlike the thesis's that breaks one
    must not cost all tables: that is `told` in a warning.
    """
    try:
        return measures.find(quantity, scene)
    except KeyError:
        return {}
    except (ValueError, IndexError, ZeroDivisionError) as error:
        if told:
            warnings.warn(f"measure {quantity} is left out of {scene}: {error}", stacklevel=2)
        return {}


def write_measures(table: pd.DataFrame, path: str | PathLike) -> None:
    """Write the table with all digits."""
    write_atomically(Path(path), lambda p: table.to_csv(p, index=False, lineterminator="\n"))


def read_measures(path: str | PathLike) -> pd.DataFrame:
    """The table that `write_measures` wrote."""
    empty = dict.fromkeys(("value", *INSTEAD), [""])
    kinds = {"condition": str} | dict.fromkeys(empty, float)
    return pd.read_csv(path, dtype=kinds, keep_default_na=False, na_values=empty)


def measure(job: SimpleNamespace) -> None:
    """Job: `histories`, `meshes`, `coarse` -> `measures`."""
    histories, meshes, coarse = read_results([*job.histories, *job.meshes, *job.coarse], True)
    write_measures(measures_table(histories, coarse, meshes), job.measures[0])

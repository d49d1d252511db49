"""The measures of all scenes as one long table: what claims, sensitivities and figures of numbers
rest on.

The workflow writes it (``<results>/measures.csv``) from every history, its companion on a coarser
mesh, and the meshes. A row is a number: scene, quantity, condition, unit, value, and what takes its
place in `Instead`. The error of anything made of these numbers follows from what it changes by when
another column is read.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures import of_presses, of_scenes, of_strokes
from cysyk1999.measures.errors import Companion, Companions, Errors, thinned
from cysyk1999.measures.inputs import read_results
from fingerpad.files import write_atomically
from fingerpad.measures.features import Feature, Histories, Meshes
from fingerpad.measures.kept import Each
from fingerpad.measures.measure import Measure, Together, measures_of
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
        runs, seen = Together(histories), {}

        def find(quantity: str, scene: str) -> Mapping[str, float]:
            if (quantity, scene) not in seen:
                seen[quantity, scene] = read(MEASURES[quantity], scene, runs, meshes or {})
            return seen[quantity, scene]

        return cls(find)

    @classmethod
    def in_table(cls, table: pd.DataFrame, column: str = "value") -> Measures:
        """Of a column of the measures table, ``value`` or one of `INSTEAD`; what has a value but
        nothing there is missing.
        """
        rows = table[table[column].notna() | table["value"].isna()] if column != "value" else table
        seen: dict[tuple[str, str], dict[str, float]] = {}
        for row in rows.itertuples(index=False):
            seen.setdefault((row.quantity, row.scene), {})[row.condition] = getattr(row, column)
        scenes = set(rows["scene"])

        def find(quantity: str, scene: str) -> Mapping[str, float]:
            if (quantity, scene) not in seen:
                raise KeyError(scene if scene not in scenes else f"{quantity} of {scene}")
            return seen[quantity, scene]

        return cls(find)


def read(measure: Measure, scene: str, runs: Together, meshes: Meshes) -> dict[str, float]:
    """A measure of a scene. Raises KeyError where the scene has none, or it was not simulated."""
    history = runs[scene]
    described = scene_of(history)
    if not measure.where(described):
        raise KeyError(f"{measure.name} of {scene}")
    if measure.of == "scene":
        return measure(described)
    if measure.of == "mesh":
        return measure(meshes[scene])
    return measure(runs.strokes[scene] if measure.of == "stroke" else history, runs)


@dataclass(frozen=True)
class Instead:
    """Measures of what is simulated or read more coarsely, by the columns `INSTEAD`."""

    mesh: Measures
    sparse_mesh: Measures
    both: Measures
    sparse: Measures

    @classmethod
    def of(cls, histories: Histories, coarse: Companions) -> Instead:
        """Read of histories and their companions when first asked for."""
        own, mesh, *others = map(Measures.of, (histories, *_instead(histories, coarse)))

        def find(quantity: str, scene: str) -> Mapping[str, float]:
            return _coarser(
                coarse[scene],
                histories[scene],
                own.find(quantity, scene),
                mesh.find(quantity, scene),
            )

        return cls(Measures(find), *others)

    @classmethod
    def in_table(cls, table: pd.DataFrame) -> Instead:
        """Of the measures table."""
        return cls(*(Measures.in_table(table, column) for column in INSTEAD))

    def errors(self, number: Callable[[Measures], float], value: float) -> Errors:
        """The errors of a number that is made of measures, in its unit."""
        each = (self.mesh, self.sparse_mesh, self.both, self.sparse)
        mesh, sparse_mesh, both, sparse = (_number(number, measures) for measures in each)
        return Errors.left(abs(value - mesh), abs(sparse_mesh - both), abs(value - sparse))


def _number(number: Callable[[Measures], float], measures: Measures) -> float:
    try:
        return number(measures)
    except KeyError:
        return float("nan")


def _coarser(
    companion: Companion, history: xr.Dataset, own: Mapping[str, float], other: Mapping[str, float]
) -> dict[str, float]:
    """A measure on a mesh with edges half as long again, of what it is on the run's own and on its
    companion's.
    """
    return {
        at: companion.number(history, own[at], value) for at, value in other.items() if at in own
    }


def _instead(histories: Histories, coarse: Companions) -> tuple[Histories, ...]:
    def on_another_mesh(scene: str) -> xr.Dataset:
        if (found := coarse[scene].apart(histories[scene])) is None:
            raise KeyError(scene)
        return found

    return (
        Each(on_another_mesh, coarse),
        Each(lambda scene: coarse[scene].sparse, coarse),
        Each(lambda scene: coarse[scene].both, coarse),
        Each(lambda scene: thinned(histories[scene]), histories),
    )


def measures_table(histories: Histories, coarse: Companions, meshes: Meshes) -> pd.DataFrame:
    """Every measure of every scene, columns `COLUMNS`; empty where nothing was simulated on a
    coarser mesh, or that shows it.
    """
    fine, others, rows = (
        Together(histories),
        [Together(each) for each in _instead(histories, coarse)],
        [],
    )
    for scene in histories:
        for measure in MEASURES.values():
            values = _read(measure, scene, fine, meshes)
            solved = measure.of in ("history", "stroke") and values
            found = [
                _read(measure, scene, runs, {}, said=False) if solved else {} for runs in others
            ]
            if found[0]:
                found[0] = _coarser(coarse[scene], histories[scene], values, found[0])
            for condition, value in values.items():
                instead = (each.get(condition, np.nan) for each in found)
                rows.append((scene, measure.name, condition, measure.unit, value, *instead))
    return pd.DataFrame(rows, columns=COLUMNS)


def _read(
    measure: Measure, scene: str, runs: Together, meshes: Meshes, said: bool = True
) -> dict[str, float]:
    try:
        return read(measure, scene, runs, meshes)
    except KeyError:
        return {}
    except (
        ValueError,
        IndexError,
        ZeroDivisionError,
    ) as error:  # a scene unlike the thesis's must not cost all tables
        if said:
            warnings.warn(f"measure {measure.name} is left out of {scene}: {error}", stacklevel=2)
        return {}


def write_measures(table: pd.DataFrame, path: str | PathLike) -> None:
    """Write the table with all digits."""
    write_atomically(Path(path), lambda p: table.to_csv(p, index=False, lineterminator="\n"))


def read_measures(path: str | PathLike) -> pd.DataFrame:
    """The table that `write_measures` wrote."""
    table = pd.read_csv(path, dtype=str, keep_default_na=False)
    numbers = {
        column: [float(v) if v else np.nan for v in table[column]] for column in ("value", *INSTEAD)
    }
    return table.assign(**numbers)


def measure(job: SimpleNamespace) -> None:
    """Job: `histories`, `meshes`, `coarse` -> `measures`."""
    histories, meshes, coarse = read_results([*job.histories, *job.meshes, *job.coarse])
    write_measures(measures_table(histories, coarse, meshes), job.measures[0])

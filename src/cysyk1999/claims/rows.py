"""How the number of a row of the reference table is made of measures: columns `measure`, `at` and
`of` of `thesis_numbers.csv`.

``of`` names scenes, or sets of them (`SETS`), and may begin with what is made of several numbers:
``largest of`` (left out: the same), ``least of``, ``mean of``, ``sum of`` or ``number of`` (how
many were simulated). ``each of`` names scenes of which the thesis leaves open which is meant:
each is judged, and the hardest verdict stands. ``at`` is the measure's condition; left out, all of
its conditions count.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from cysyk1999.claims.verdicts import hardest
from cysyk1999.measures.errors import Errors
from cysyk1999.measures.runs import (
    CYLINDERS,
    FAST,
    NINE,
    RIDGED_NINE,
    SPEEDS,
    SUB_SPEEDS,
    WITHIN_350,
    WITHIN_400,
)
from cysyk1999.measures.steady import DEPTH_SCENES, SPEED_SCENES
from cysyk1999.measures.table import MEASURES, Instead, Measures

SETS: dict[str, tuple[str, ...]] = {
    "nine": tuple(NINE.values()),
    "fast_nine": tuple(FAST.values()),
    "ridged_nine": tuple(RIDGED_NINE.values()),
    "cylinders": tuple(NINE[k] for k in CYLINDERS),
    "within_350": tuple(NINE[k] for k in WITHIN_350),
    "cylinders_within_400": tuple(NINE[k] for k in WITHIN_400 if k != "flat"),
    "five_strokes": tuple(SPEEDS.values()),
    "three_strokes": tuple(SUB_SPEEDS.values()),
    "four_depths": tuple(DEPTH_SCENES.values()),
    "three_speeds": tuple(SPEED_SCENES.values()),
}
"""Sets of scenes by the name they have in the column `of`."""

GIVEN = ("input", "count")
"""Roles of what goes into the simulations: printed in full, without an error."""

MADE: dict[str, Callable[[list[float]], float]] = {
    "largest": max,
    "least": min,
    "mean": np.mean,
    "sum": sum,
    "number": len,
    "each": max,
}


@dataclass(frozen=True)
class Number:
    """The number of a row: ``number(measures)``, in the unit of its measure. Raises KeyError for
    what was not simulated.
    """

    measure: str
    at: str
    made: str
    scenes: tuple[str, ...]

    @classmethod
    def of(cls, row: Mapping) -> Number:
        """Read a row of the reference table. Raises ValueError, naming the row, for an unknown
        measure or unit that differs.
        """
        name, units = row["measure"], row["units"]
        if name not in MEASURES:
            known = ", ".join(sorted(MEASURES))
            raise ValueError(f"{row.name}: measure '{name}' is not one of {known}")
        if (unit := MEASURES[name].unit) != units:
            raise ValueError(f"{row.name}: units '{units}', its measure {name} has '{unit}'")
        made, found, names = row["of"].partition(" of ")
        if not found:
            made, names = "largest", row["of"]
        if made not in MADE:
            raise ValueError(f"{row.name}: of '{row['of']}' begins with none of {', '.join(MADE)}")
        scenes = tuple(scene for word in names.split() for scene in SETS.get(word, (word,)))
        return cls(name, row["at"], made, scenes)

    @property
    def readings(self) -> list[Number]:
        """The numbers that may be meant."""
        if self.made != "each":
            return [self]
        return [replace(self, made="largest", scenes=(scene,)) for scene in self.scenes]

    def __call__(self, measures: Measures) -> float:
        return float(MADE[self.made](list(self._values(measures))))

    def _values(self, measures: Measures) -> Iterator[float]:
        for scene in self.scenes:
            try:
                if self.at:
                    yield measures(self.measure, scene, self.at)
                else:
                    yield from measures.find(self.measure, scene).values()
            except KeyError:
                if self.made != "number":
                    raise


def numbers(reference: pd.DataFrame) -> dict[str, Number]:
    """The number of every row of the reference table that has one, by id. Raises ValueError as
    `Number.of` does.
    """
    return {
        id_: Number.of(row) for id_, row in reference.iterrows() if row["role"] not in ("", "trend")
    }


def judged(
    entry: pd.Series, fine: Measures, instead: Instead
) -> tuple[Number, float, Errors, str, str]:
    """A row's number, its value, its errors, its verdict and how far outside it is; of several that
    may be meant the one with the hardest verdict.

    What goes into the simulations, and what a scene alone tells, has no error. Raises KeyError for
    what was not simulated.
    """
    number = Number.of(entry)
    found = number.readings
    values, errors = [each(fine) for each in found], [Errors(0.0, 0.0, 0.0)] * len(found)
    if entry["role"] not in GIVEN and MEASURES[number.measure].of != "scene":
        errors = [instead.errors(*each) for each in zip(found, values, strict=True)]
    k, *verdict = hardest(values, [error.total for error in errors], entry)
    return found[k], values[k], errors[k], *verdict

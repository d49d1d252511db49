"""The evidence: what the thesis shows of its pad, how it read it, and how far a model is from it.

A row of ``config/reference/reconstruction_evidence.csv`` is an interval that the figure or text
leaves to a number: of an axis, for example, from its last tick but one to its end, where a program
that ends axes at the next tick has drawn it. A number inside is as good as another; beyond an end
it counts by its distance in tolerances. Rows are fitted, held out (half of chapter 4: the surfaces
and figures that the posterior does not see), or apart (energies inside the epidermis).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
import pandas as pd

from cysyk1999.reference_data import Column, ReferenceDataError, read_table
from cysyk1999.studies.reconstruction import pads

EVIDENCE = Path("config/reference/reconstruction_evidence.csv")
ROLES = ("fitted", "held_out", "apart")
FAMILIES = (
    "plate",
    "depth",
    "width",
    "pressure",
    "time course",
    "dermal energy",
    "epidermal energy",
)
SEEN = 1.02
"""Least ratio of a pressure to another by which a picture tells that it is larger."""
SURFACES = (pads.PLATE, *pads.SURFACES, *(f"{k}{pads.FAST}" for k in pads.SURFACES))
COLUMNS = {
    "id": Column(text=True),
    "figure": Column(text=True),
    "page": Column(above=0.0),
    "surface": Column(words=SURFACES),
    "measure": Column(words=(*pads.MEASURES, *pads.FORCES)),
    "factor": Column(above=0.0),
    "low": Column(),
    "high": Column(),
    "unit": Column(words=("N", "mm", "Pa", "Pa/s", "1")),
    "tolerance": Column(above=0.0),
    "role": Column(words=ROLES),
    "family": Column(words=FAMILIES),
    "reading": Column(text=True),
    "thesis_ids": Column(text=True),
}
"""factor: what a simulated number is multiplied by to be what the thesis shows. tolerance: one
standard deviation beyond an end. thesis_ids: rows of ``thesis_numbers.csv`` that say the same.
"""


def read_evidence(path: str | Path) -> pd.DataFrame:
    """The table, columns `COLUMNS`.

    Raises ReferenceDataError: also for an id twice, an interval upside down or a unit that is not
    the measure's.
    """
    table = read_table(path, COLUMNS)
    for row, record in enumerate(table.itertuples(index=False), start=2):
        unit = pads.units(record.surface).get(record.measure)
        expected = "N" if unit == "N/m" else unit
        if expected != record.unit:
            raise ReferenceDataError(
                f"{path}: row {row}, column unit: '{record.unit}'; allowed: "
                f"{expected or 'no such measure'}"
            )
        if not record.low < record.high:
            raise ReferenceDataError(
                f"{path}: row {row}, column high: '{record.high:g}'; allowed: more than "
                f"{record.low:g}"
            )
    if not table["id"].is_unique:
        twice = table["id"][table["id"].duplicated()].iloc[0]
        raise ReferenceDataError(f"{path}: column id: '{twice}' is there twice; allowed: each once")
    return table


@dataclass(frozen=True)
class Evidence:
    """Rows of the evidence, ready for many predictions at once.

    Attributes:
        rows: the table. keys: "surface: measure" of each row.
    """

    rows: pd.DataFrame

    @cached_property
    def keys(self) -> list[str]:
        """What each row is read of."""
        return [
            f"{s}: {m}" for s, m in zip(self.rows["surface"], self.rows["measure"], strict=True)
        ]

    def of_role(self, *roles: str) -> Evidence:
        """The rows of some roles."""
        return Evidence(self.rows[self.rows["role"].isin(roles)].reset_index(drop=True))

    def shown(self, values: np.ndarray, soft: np.ndarray, plate_length: np.ndarray) -> np.ndarray:
        """What the thesis would show (..., rows).

        Args:
            values: (..., rows) as simulated, of `keys`. soft: (...) factor on all moduli.
            plate_length: (...) mm, of chapter 3.
        """
        return np.asarray(values) * self._scale(
            np.asarray(soft)[..., None], np.asarray(plate_length)[..., None]
        )

    def _scale(self, soft: np.ndarray, plate_length: np.ndarray) -> np.ndarray:
        factor, scaled, force = self._units
        return factor * np.where(scaled, soft, 1.0) * np.where(force, 1e-3 * plate_length, 1.0)

    @cached_property
    def _units(self) -> tuple[np.ndarray, ...]:
        """Of each row: its factor, whether it grows with the moduli, whether it is a force."""
        unit = self.rows["unit"].to_numpy(str)
        return self.rows["factor"].to_numpy(float), ~np.isin(unit, pads.SCALE_FREE), unit == "N"

    @cached_property
    def _ends(self) -> tuple[np.ndarray, ...]:
        """Of each row: lower end, upper end, tolerance."""
        return tuple(self.rows[k].to_numpy(float) for k in ("low", "high", "tolerance"))

    def departure(self, shown: np.ndarray, more: np.ndarray | float = 0.0) -> np.ndarray:
        """Distance (..., rows) outside the interval in standard deviations, 0 inside; `more`: that
        of the prediction itself.
        """
        low, high, tolerance = self._ends
        outside = np.maximum(np.maximum(low - shown, shown - high), 0.0)
        return outside / np.hypot(tolerance, more)

    def distance(self, shown: np.ndarray) -> np.ndarray:
        """Sum of squared departures (...): 0 for a model that nothing in the rows speaks
        against.
        """
        return (self.departure(shown) ** 2).sum(axis=-1)

    def by_family(self, shown: np.ndarray) -> dict[str, float]:
        """Distance of one prediction (rows,) by family."""
        squared = self.departure(shown) ** 2
        families = self.rows["family"].to_numpy()
        return {
            family: float(squared[families == family].sum()) for family in dict.fromkeys(families)
        }

    def as_thesis(self, shown: np.ndarray) -> Evidence:
        """The evidence that a model would have left: intervals as wide, its own numbers (rows,)
        between ticks as far apart.

        What is bounded from above only stays so, with a bound a third above the number.
        """
        rows = self.rows.copy()
        width = rows["high"] - rows["low"]
        one_sided = rows["low"].to_numpy() == 0
        low = np.floor((shown - rows["low"]) / width) * width + rows["low"]
        sign = (
            rows["family"].to_numpy() == "time course"
        )  # of these only the sign, or the side of one, is told
        ratio = (
            sign
            & (rows["unit"].to_numpy() == "1")
            & rows["measure"].str.contains("over").to_numpy()
        )
        low = np.where(one_sided, 0.0, low)
        high = np.where(one_sided, np.maximum(1.3 * shown, 1e-9), low + width)
        for told, at, least, most in ((sign & ~ratio, 0.0, -1.0, 1.0), (ratio, SEEN, 0.0, 2.0)):
            above = shown > at
            low = np.where(told, np.where(above, at, least), low)
            high = np.where(told, np.where(above, most, at), high)
        return Evidence(rows.assign(low=low, high=high))


def values_of(found: Mapping[str, float], evidence: Evidence) -> np.ndarray:
    """Simulated numbers (rows,) by the evidence's keys; NaN for what was not simulated."""
    return np.array([found.get(key, np.nan) for key in evidence.keys])

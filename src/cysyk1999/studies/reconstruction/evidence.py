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

from cysyk1999.reference_data import NUMBER, POSITIVE, TEXT, ReferenceDataError, one_of, read_table
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
    "id": TEXT,
    "figure": TEXT,
    "page": POSITIVE,
    "surface": one_of(*SURFACES),
    "measure": one_of(*pads.MEASURES, *pads.FORCES),
    "factor": POSITIVE,
    "low": NUMBER,
    "high": NUMBER,
    "unit": one_of("N", "mm", "Pa", "Pa/s", "1"),
    "tolerance": POSITIVE,
    "role": one_of(*ROLES),
    "family": one_of(*FAMILIES),
    "reading": TEXT,
    "thesis_ids": TEXT,
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

    def wrong(where: str, value: object, allowed: str) -> ReferenceDataError:
        return ReferenceDataError(f"{path}: {where}: '{value}'; allowed: {allowed}")

    for row, record in enumerate(table.itertuples(index=False), start=2):
        unit = pads.units(record.surface).get(record.measure, "no such measure")
        unit = "N" if unit == "N/m" else unit
        if unit != record.unit:
            raise wrong(f"row {row}, column unit", record.unit, unit)
        if not record.low < record.high:
            raise wrong(f"row {row}, column high", f"{record.high:g}", f"more than {record.low:g}")
    if not table["id"].is_unique:
        twice = table["id"][table["id"].duplicated()].iloc[0]
        raise ReferenceDataError(f"{path}: column id: '{twice}' is there twice; allowed: each once")
    return table


@dataclass(frozen=True)
class Evidence:
    """Rows of the evidence, ready for many predictions at once.

    Attributes
    ----------
    rows : DataFrame
        The table, columns `COLUMNS`.
    """

    rows: pd.DataFrame

    @cached_property
    def keys(self) -> list[str]:
        """What each row is read of: "surface: measure"."""
        return list(self.rows["surface"] + ": " + self.rows["measure"])

    @cached_property
    def _numbers(self) -> dict[str, np.ndarray]:
        """Columns as arrays: many small predictions are judged."""
        columns = ("low", "high", "tolerance", "factor", "unit")
        return {name: self.rows[name].to_numpy() for name in columns}

    def of_role(self, *roles: str) -> Evidence:
        """The rows of some roles."""
        return Evidence(self.rows[self.rows["role"].isin(roles)].reset_index(drop=True))

    def values(self, simulated: Mapping[str, float]) -> np.ndarray:
        """Simulated numbers (rows,) by the rows' keys; NaN for what was not simulated."""
        return np.array([simulated.get(key, np.nan) for key in self.keys])

    def shown(self, values: np.ndarray, soft, plate_length) -> np.ndarray:
        """What the thesis would show.

        Parameters
        ----------
        values : (..., rows) as simulated, of `keys`.
        soft : (...) factor on all moduli.
        plate_length : (...) mm, of chapter 3.

        Returns
        -------
        (..., rows) in the rows' units.
        """
        soft, length = (np.asarray(number, float)[..., None] for number in (soft, plate_length))
        unit, factor = self._numbers["unit"], self._numbers["factor"]
        scale = np.where(np.isin(unit, pads.SCALE_FREE), 1.0, soft)
        return values * (factor * scale * np.where(unit == "N", 1e-3 * length, 1.0))

    def departure(self, shown: np.ndarray, deviation: np.ndarray | float = 0.0) -> np.ndarray:
        """Distance (..., rows) outside the interval in standard deviations, 0 inside; `deviation`:
        that of the prediction itself.
        """
        low, high, tolerance = (self._numbers[k] for k in ("low", "high", "tolerance"))
        outside = np.maximum(np.maximum(low - shown, shown - high), 0.0)
        return outside / np.hypot(tolerance, deviation)

    def distance(self, shown: np.ndarray) -> np.ndarray:
        """Sum of squared departures (...): 0 for a model inside all intervals."""
        return (self.departure(shown) ** 2).sum(axis=-1)

    def as_thesis(self, shown: np.ndarray) -> Evidence:
        """The evidence that a model would have left: intervals as wide, its own numbers (rows,)
        between ticks as far apart.

        A number that is bounded from above only stays so, with a bound a third above it. Of a time
        course only the sign, or the side of one, is known.
        """
        rows, least, width = self.rows, self.rows["low"], self.rows["high"] - self.rows["low"]
        low = np.floor((shown - least) / width) * width + least
        bounded, course = least == 0, rows["family"] == "time course"
        ratio = course & (rows["unit"] == "1") & rows["measure"].str.contains("over")
        cases = [ratio & (shown > SEEN), ratio, course & (shown > 0), course, bounded]
        low = np.select(cases, [SEEN, 0.0, 0.0, -1.0, 0.0], low)
        high = np.select(cases, [2.0, SEEN, 1.0, 0.0, np.maximum(1.3 * shown, 1e-9)], low + width)
        return Evidence(rows.assign(low=low, high=high))

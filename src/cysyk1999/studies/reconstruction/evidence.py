"""The evidence: what the thesis shows of its pad, how it read it, and how far a model is from it.

A row of ``config/reference/reconstruction_evidence.csv`` is an interval that the figure or text
leaves to a number: of an axis, for example, from its last tick but one to its end, where a program
that ends axes at the next tick has drawn it. A number inside is as good as another; beyond an end
it counts by its distance in tolerances. The rows are two halves, by the parity of their figures'
numbers, so that each half can be judged by what the other one says.
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
HALVES = ("odd", "even")
"""Of the evidence, by the number of the figure: all rows of a figure are in one."""
CHAPTERS = ("chapter 4", "sections 5.1 to 5.4", "section 5.5")
"""Parts of the thesis that may each have a definition of the strain energy of its own."""
RIDGES = 25
"""Number of the first figure of section 5.5."""
FAMILIES = (
    "plate",
    "depth",
    "width",
    "pressure",
    "time course",
    "dermal energy",
    "epidermal energy",
    "stroke",
)
SEEN = 1.02
"""Least ratio of a pressure to another by which a picture tells that it is larger."""
SURFACES = (
    *(pads.PLATE, pads.WAVY, pads.STROKED_PLATE),
    *pads.SURFACES,
    *(f"{k}{pads.FAST}" for k in pads.SURFACES),
)
COLUMNS = {
    "id": TEXT,
    "figure": TEXT,
    "page": POSITIVE,
    "surface": one_of(*SURFACES),
    "measure": one_of(*pads.MEASURES, *pads.FORCES, *pads.STROKED, *pads.STROKED_FLAT),
    "factor": POSITIVE,
    "low": NUMBER,
    "high": NUMBER,
    "unit": one_of("N", "mm", "Pa", "Pa/s", "1"),
    "tolerance": POSITIVE,
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
        unit = self.rows["unit"]
        columns = ("low", "high", "tolerance", "factor")
        energy = self.rows["measure"].str.startswith("energy")
        kinds = {"scaled": ~unit.isin(pads.SCALE_FREE), "force": unit == "N", "energy": energy}
        kinds["late"] = energy & self.chapters.isin(CHAPTERS[1:])
        return {k: self.rows[k].to_numpy() for k in columns} | {
            k: v.to_numpy() for k, v in kinds.items()
        }

    @cached_property
    def halves(self) -> pd.Series:
        """Which half (rows,) each row is of."""
        odd = self.rows["figure"].str.split("-").str[1].astype(int) % 2 == 1
        return odd.map({True: HALVES[0], False: HALVES[1]})

    def of(self, half: str) -> Evidence:
        """The rows of one half; all of them for any other word."""
        rows = self.rows[self.halves == half] if half in HALVES else self.rows
        return Evidence(rows.reset_index(drop=True))

    @cached_property
    def chapters(self) -> pd.Series:
        """Which of `CHAPTERS` each row (rows,) is of; empty for chapter 3."""
        chapter, number = (self.rows["figure"].str.split("-").str[k].astype(int) for k in (0, 1))
        cases = [chapter == 4, (chapter == 5) & (number < RIDGES), chapter == 5]
        return pd.Series(np.select(cases, CHAPTERS, ""), self.rows.index)

    def defined(self, definitions: Mapping[str, str]) -> Evidence:
        """The same with energies by other definitions (`pads.DEFINITIONS`), by chapter."""
        measure = self.rows["measure"]
        energy = measure.str.startswith(("energy", "falls"))
        ending = self.chapters.map(definitions).fillna("").where(energy, "")
        return Evidence(self.rows.assign(measure=measure + ending))

    def values(self, simulated: Mapping[str, float]) -> np.ndarray:
        """Simulated numbers (rows,) by the rows' keys; NaN for what was not simulated."""
        return np.array([simulated.get(key, np.nan) for key in self.keys])

    def shown(self, values: np.ndarray, soft, plate_length, energy=1.0, late=1.0) -> np.ndarray:
        """What the thesis would show.

        Parameters
        ----------
        values : (..., rows) as simulated, of `keys`.
        soft : (...) factor on all moduli.
        plate_length : (...) mm, of chapter 3.
        energy, late : (...) factors on strain energies, and on those of chapter 5 beside.

        Returns
        -------
        (..., rows) in the rows' units.
        """
        factors = {"scaled": soft, "force": 1e-3 * plate_length, "energy": energy, "late": late}
        scale = self._numbers["factor"]
        for kind, factor in factors.items():
            factor = np.asarray(factor, float)[..., None]
            scale = scale * np.where(self._numbers[kind], factor, 1.0)
        return values * scale

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
        over, falls, late = (rows["measure"].str.contains(k) for k in ("over", "falls", "late"))
        cases = [over & (shown > SEEN), over, falls & (shown > 1), falls, late & (shown > 0), late]
        low = np.select([*cases, least == 0], [SEEN, 0, 1, 0, 0, -1, 0], low)
        above = np.maximum(1.3 * shown, 1e-9)
        high = np.select([*cases, least == 0], [2, SEEN, 2, 1, 1, 0, above], low + width)
        return Evidence(rows.assign(low=low, high=high))

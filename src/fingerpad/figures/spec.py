"""What a figure is: the scenes it needs, a function to its data, and one from the data to the picture."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import pandas as pd
from matplotlib.figure import Figure

from fingerpad.measures.features import SIMULATED, is_simulated
from fingerpad.receptors.recordings import read_rates
from fingerpad.reference_data import read_force_depth, read_surface_profiles

FrameFunction = Callable[..., pd.DataFrame]


@dataclass(frozen=True)
class FigureSpec:
    """One figure.

    Attributes
    ----------
    number, title
        The thesis's figure number (``4-10``) and a short title of our own.
    needs
        Names of the scenes whose histories (and meshes) the frame is made from.
    frame
        ``frame(histories, meshes, coarse, reference)``: the tidy data frame, units in the column names.
        `coarse` holds the companions on a coarser mesh (may be empty: the error column is then NaN);
        `reference` is the table of `read_reference` (may be empty: thesis ranges are then left out).
    draw
        ``draw(frame)``: the picture, a function of the frame alone.
    companions
        Names of the scenes whose coarse companions the frame reads; None: of all that it needs.
    measured
        Name of the measured data (a key of `MEASURED`) that the frame takes as a fifth argument; empty: none.
    """

    number: str
    title: str
    needs: tuple[str, ...]
    frame: FrameFunction
    draw: Callable[[pd.DataFrame], Figure]
    companions: tuple[str, ...] | None = None
    measured: str = ""

    @property
    def read_companions(self) -> tuple[str, ...]:
        """Names of the scenes whose companions the frame reads."""
        return self.needs if self.companions is None else self.companions

    def measurements(self, folder: str | PathLike) -> tuple[pd.DataFrame, ...]:
        """The measured data in `folder` that `frame` takes after its four arguments: one table or none."""
        return (MEASURED[self.measured][1](self.measured_files(folder)),) if self.measured else ()

    def measured_files(self, folder: str | PathLike) -> list[Path]:
        """The files in `folder` that the measured data are read from."""
        patterns = MEASURED[self.measured][0].split() if self.measured else []
        return [path for pattern in patterns for path in sorted(Path(folder).glob(pattern))]


def _only_file(paths: list[Path]) -> pd.DataFrame:
    (path,) = paths
    return read_surface_profiles(path)


MEASURED: Mapping[str, tuple[str, Callable[[list[Path]], pd.DataFrame]]] = {
    "force_depth": ("force_depth/*.csv", read_force_depth),
    "surface_profiles": ("surface_profiles.csv", _only_file),
    "impulse_rates": ("impulse_rates/*.csv recordings/*.csv", lambda paths: read_rates(*paths)),
}
"""Measured data by name: their files in the folder of reference data (one pattern or more), and their reader."""


def axis_rows(reference: pd.DataFrame, column: str, ids: str | Mapping[str, str], key: str = "surface") -> pd.DataFrame:
    """Rows that mark a thesis axis range: two rows (ends) a range, `source` saying so.

    `ids` is one id for the whole figure, or a mapping panel -> id with the panel's name in the column `key`.
    """
    keyed = ids if isinstance(ids, Mapping) else {None: ids}
    rows = []
    for panel, id_ in keyed.items():
        if id_ not in reference.index:
            continue
        entry = reference.loc[id_]
        doubt = ", reading uncertain" if entry["kind"] == "garbled" else ""
        for end in ("low", "high"):
            row = {"source": f"thesis axis range ({id_}{doubt})", column: entry[end]}
            rows.append(row if panel is None else {key: panel, **row})
    return pd.DataFrame(rows)


def assemble(simulated: pd.DataFrame, *marks: pd.DataFrame) -> pd.DataFrame:
    """Simulated rows followed by the rows that mark thesis ranges, with a `source` column first."""
    if "source" not in simulated:
        simulated.insert(0, "source", SIMULATED)
    return pd.concat([simulated, *(m for m in marks if not m.empty)], ignore_index=True)


def rows_of(frame: pd.DataFrame, column: str, value: str) -> pd.DataFrame:
    """Rows of one panel or trace, and the range rows that belong to every panel."""
    return frame[(frame[column] == value) | (frame[column].isna() & ~is_simulated(frame))]

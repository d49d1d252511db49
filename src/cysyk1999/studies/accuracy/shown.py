"""Are the errors that figures state those of their curves?

A figure is made twice: with the companions of its scenes, from which it states its errors, and with
runs on meshes of half the edges in their place. What a curve changes by then is nearly all of its
error; the rest follows from the order with which curves converge.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.figures.grammar import Figure
from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.errors import MESH, PARTS, Companion, Companions, Curve, norm
from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.tables import write_frame
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.accuracy.finer import FINER
from fingerpad.measures.features import Histories, Meshes

STATED, STATED_MESH, TRUE = "stated error (%)", "stated mesh error (%)", "true error (%)"


class Finer(Companion):
    """A finer run in a companion's place."""

    EDGES = FINER

    def mesh_error(self, history: xr.Dataset, curve: Curve) -> float:
        """What a curve is wrong by as it is drawn.

        Over the skin it is drawn straight from node to node. What that leaves out the finer mesh
        shows in full; only what its nodes change by goes on to change.
        """
        (x, y), (at, fine) = curve(history), curve(self.mesh)
        there = np.interp(x, at, fine)
        wrong = self.remains(history, curve.order) * (there - y)
        if curve.outputs:
            return norm(x, wrong)
        return norm(at, np.interp(at, x, wrong) + fine - np.interp(at, x, there))


def shown(
    figures: Iterable[tuple[Figure, tuple[pd.DataFrame, ...]]],
    results: tuple[Histories, Meshes, Companions],
    finer: Mapping[str, xr.Dataset],
    reference: pd.DataFrame,
) -> pd.DataFrame:
    """One row a curve or number with an error of its own, of figures all of whose companions there
    are finer runs of.

    Parameters
    ----------
    figures
        With their measured data.
    results
        Of :func:`cysyk1999.measures.inputs.read_results`.
    finer
        Scene -> history on a mesh with edges `FINER` times as long.
    reference
        The thesis's numbers.
    """
    histories, meshes, coarse = results
    truth = {scene: Finer(history, history) for scene, history in finer.items()}
    rows = []
    for spec, measured in figures:
        if not spec.read_companions or not truth.keys() >= set(spec.read_companions):
            continue
        stated, true = (
            spec.frame(histories, meshes, each, reference, *measured) for each in (coarse, truth)
        )
        named = [column for column in _SERIES if column in stated]
        both = (
            stated[named].fillna("").astype(str).agg(" ".join, axis=1).str.strip().to_frame("curve")
        )
        both[STATED_MESH], both[STATED] = stated[MESH], stated[list(PARTS)].sum(axis=1, min_count=1)
        both[TRUE] = true[MESH]
        found = both[(both[STATED_MESH] > 0) & np.isfinite(both[TRUE])].drop_duplicates()
        rows.append(found.assign(figure=spec.number))
    table = pd.concat(rows, ignore_index=True)
    return table[["figure", "curve", STATED_MESH, STATED, TRUE]]


_SERIES = ("panel", "surface", "series", "pad", "phase", "place", "convexity")


def accuracy_shown(job: SimpleNamespace) -> None:
    """Job: `histories`, `meshes`, `coarse`, `finer`, the table `reference` -> `data` (CSV) of the
    figures `numbers`.
    """
    folder = Path(job.reference[0]).parent
    figures = [(FIGURES[number], FIGURES[number].measurements(folder)) for number in job.numbers]
    results = read_results([*job.histories, *job.meshes, *job.coarse], True)
    finer, reference = read_results(job.finer, True)[0], read_reference(job.reference[0])
    write_frame(shown(figures, results, finer, reference), Path(job.data[0]))

"""What the job of figures does."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pandas as pd

from cysyk1999.claims.said import said
from cysyk1999.figures.axes import statement_row
from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.publishing.tables import published
from cysyk1999.publishing.write import publish
from cysyk1999.reference_data import read_reference
from fingerpad.measures.kept import LazyMapping


def draw_figures(job: SimpleNamespace) -> None:
    """`histories`, `meshes`, `coarse`, the table `reference` -> `pictures` of the `modules`."""
    reference = job.reference[0]
    specs = {s.number: s for module in job.modules for s in import_module(module).FIGURES}
    results = read_results([*job.histories, *job.meshes, *job.coarse], True)
    table = read_reference(reference)
    for picture in job.pictures:
        spec = specs[Path(picture).stem.removeprefix("fig_")]
        frame = spec.frame(*results, table, *spec.measurements(Path(reference).parent))
        frame = published(with_statement(spec, frame, results, table))
        publish(spec.draw(frame), frame, picture)


def with_statement(spec, frame, results, reference):
    """The frame of a figure, and a row with the verdict on what the thesis says of it."""
    histories, meshes, coarse = (
        LazyMapping(found.__getitem__, filter(found.__contains__, spec.judged_by))
        for found in results
    )
    measures = Measures.of(histories, meshes)
    coarser = Instead.of(histories, coarse, measures)
    statement = said(spec.number, measures, coarser, reference)
    if statement is None:
        return frame
    row = pd.DataFrame([statement_row(statement.verdict, *statement.texts)])
    return pd.concat([frame, row], ignore_index=True)

"""Histories and meshes -> figures of one chapter and the plotted data beside each, with what the
thesis says of it.
"""

import importlib
from dataclasses import astuple
from pathlib import Path

import pandas as pd

from cysyk1999.claims.said import said
from cysyk1999.figures.axes import statement_row
from cysyk1999.measures.inputs import read_results
from cysyk1999.measures.table import Instead, Measures
from cysyk1999.publishing.write import publish
from cysyk1999.reference_data import read_reference
from fingerpad.measures.kept import Each


def run(job):
    """`histories`, `meshes`, `coarse`, the table `reference`, measured data beside it -> `pictures`
    of the `modules`.
    """
    (reference,) = job.reference
    specs = {
        spec.number: spec
        for module in job.modules
        for spec in importlib.import_module(module).FIGURES
    }
    results, table = (
        read_results([*job.histories, *job.meshes, *job.coarse]),
        read_reference(reference),
    )
    for picture in job.pictures:
        spec = specs[Path(picture).stem.removeprefix("fig_")]
        frame = with_statement(
            spec,
            spec.frame(*results, table, *spec.measurements(Path(reference).parent)),
            results,
            table,
        )
        publish(spec.draw(frame), frame, picture)


def with_statement(spec, frame, results, reference):
    """The frame of a figure with a row that holds what the thesis says of it, judged by the
    figure's own scenes.
    """
    histories, meshes, coarse = (
        Each(each.__getitem__, filter(each.__contains__, spec.needs)) for each in results
    )
    found = said(
        spec.number, Measures.of(histories, meshes), Instead.of(histories, coarse), reference
    )
    if found is None:
        return frame
    return pd.concat([frame, pd.DataFrame([statement_row(*astuple(found))])], ignore_index=True)

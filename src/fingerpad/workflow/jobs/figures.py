"""Histories and meshes -> figures of one chapter and the plotted data beside each."""

import importlib
from pathlib import Path

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish
from fingerpad.reference_data import read_reference


def run(job):
    """`histories`, `meshes`, `coarse`, the table `reference`, measured data beside it -> `pictures` of the module `chapter`."""
    (chapter,), (reference,) = job.chapter, job.reference
    specs = {spec.number: spec for spec in importlib.import_module(chapter).FIGURES}
    results, table = read_results([*job.histories, *job.meshes, *job.coarse]), read_reference(reference)
    for picture in job.pictures:
        spec = specs[Path(picture).stem.removeprefix("fig_")]
        frame = spec.frame(*results, table, *spec.measurements(Path(reference).parent))
        publish(spec.draw(frame), frame, picture)

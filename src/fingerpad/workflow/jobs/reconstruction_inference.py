"""Evidence and pads simulated -> posterior, readings, emulator, recovery and what chosen pads show."""

from pathlib import Path

import pandas as pd

from fingerpad.publishing.write import publish_table, write_frame
from fingerpad.studies.reconstruction.evidence import Evidence, read_evidence
from fingerpad.studies.reconstruction.run import chosen_pads, families, posterior_table, predicted, recovery_table, study
from fingerpad.studies.reconstruction.unknowns import read_unknowns


def run(job):
    """`unknowns`, `evidence`, `design` -> `tables` (posterior, readings, emulator, recovery, families), `parts` (two)."""
    evidence = Evidence(read_evidence(job.evidence[0]))
    found = study(read_unknowns(job.unknowns[0]), evidence, pd.read_csv(job.design[0]))
    chosen = chosen_pads(found.posteriors, found.samples)
    shown = predicted(evidence, chosen)
    tables = (
        posterior_table(found.posteriors, found.samples), found.readings, found.emulator, recovery_table(found.recovered),
        families(evidence, shown, chosen),
    )  # fmt: skip
    for table, path in zip(tables, job.tables, strict=True):
        publish_table(table, path)
    for part, path in zip((found.samples, shown), job.parts, strict=True):
        write_frame(part, Path(path))

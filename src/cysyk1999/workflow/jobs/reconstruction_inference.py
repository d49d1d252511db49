"""Evidence and pads simulated -> posterior, readings, emulator, recovery, what chosen pads show,
and the most probable one.
"""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import publish_table, write_frame
from cysyk1999.studies.reconstruction.evidence import Evidence, read_evidence
from cysyk1999.studies.reconstruction.run import (
    bands,
    chosen_pads,
    families,
    posterior_table,
    predicted,
    recovery_table,
    simulate_pads,
    study,
)
from cysyk1999.studies.reconstruction.specimen import specimen_text
from cysyk1999.studies.reconstruction.unknowns import read_unknowns
from fingerpad.files import write_text


def run(job):
    """`unknowns`, `evidence`, `design` -> `tables` (posterior, readings, emulator, recovery,
    families), `parts` (samples, predicted, bands), `specimen`.
    """
    evidence = Evidence(read_evidence(job.evidence[0]))
    found = study(read_unknowns(job.unknowns[0]), evidence, pd.read_csv(job.design[0]))
    chosen = chosen_pads(found.posteriors, found.samples)
    simulated = simulate_pads(evidence, chosen)
    shown, posterior = (
        predicted(evidence, chosen, simulated),
        posterior_table(found.posteriors, found.samples),
    )
    tables = (
        posterior,
        found.readings,
        found.emulator,
        recovery_table(found.recovered),
        families(evidence, shown, chosen),
    )
    for table, path in zip(tables, job.tables, strict=True):
        publish_table(table, path)
    for part, path in zip((found.samples, shown, bands(chosen, simulated)), job.parts, strict=True):
        write_frame(part, Path(path))
    write_text(job.specimen[0], specimen_text(posterior, found.readings))

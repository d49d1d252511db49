"""Unknowns with their ranges -> pads drawn evenly, and what they show. Goes on from the records of
a run that was stopped.
"""

from pathlib import Path

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.reconstruction.design import run_design, table
from cysyk1999.studies.reconstruction.unknowns import read_unknowns


def run(job):
    """`unknowns`, `records` -> `design`."""
    records = Path(job.records[0])
    run_design(read_unknowns(job.unknowns[0]), records)
    write_frame(table(records), Path(job.design[0]))

"""Samples of the posterior and what chosen pads show -> the pictures and their data."""

import pandas as pd

from cysyk1999.publishing.write import publish
from cysyk1999.studies.reconstruction.evidence import Evidence, read_evidence
from cysyk1999.studies.reconstruction.picture import (
    evidence_frame,
    evidence_picture,
    posterior_frame,
    posterior_picture,
)
from cysyk1999.studies.reconstruction.specimen import most_probable
from cysyk1999.studies.reconstruction.unknowns import read_unknowns


def run(job):
    """`unknowns`, `evidence`, `parts`: samples, predicted; `readings` -> `pictures`: posterior,
    evidence.
    """
    samples, shown = map(pd.read_csv, job.parts)
    frame = posterior_frame(samples, read_unknowns(job.unknowns[0]))
    publish(posterior_picture(frame), frame, job.pictures[0])
    best = f"best of {most_probable(pd.read_csv(job.readings[0]))}"
    frame = evidence_frame(Evidence(read_evidence(job.evidence[0])), shown, best)
    publish(evidence_picture(frame), frame, job.pictures[1])

"""Histories, companions, published and recorded rates -> tables of what receptors make of them."""

from pathlib import Path

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.publishing.write import publish_table
from cysyk1999.receptors.recordings import read_rates
from cysyk1999.studies.receptors.candidate_stimuli import candidate_stimuli
from cysyk1999.studies.receptors.run import receptor_fits
from cysyk1999.studies.receptors.sensing import sensor_accuracy


def run(job):
    """`rates`, `histories`, `coarse` -> `tables`."""
    rates = read_rates(*job.rates)
    histories, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    tables = {
        "receptor_fits": lambda: receptor_fits(histories, coarse, rates),
        "candidate_stimuli": lambda: candidate_stimuli(histories, rates),
        "sensor_accuracy": lambda: sensor_accuracy(histories),
    }
    for table in map(Path, job.tables):
        publish_table(tables[table.stem](), table)

"""Results, and those on finer meshes -> errors that figures state beside those of their curves."""

from pathlib import Path

from cysyk1999.figures.registry import FIGURES
from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import publish_table
from cysyk1999.reference_data import read_reference
from cysyk1999.studies.accuracy.shown import shown


def run(job):
    """`histories`, `meshes`, `coarse`, `finer`, the table `reference` -> `table`, of the figures
    `numbers`.
    """
    folder = Path(job.reference[0]).parent
    figures = [(FIGURES[number], FIGURES[number].measurements(folder)) for number in job.numbers]
    results, finer = (
        read_results([*job.histories, *job.meshes, *job.coarse]),
        read_results(job.finer)[0],
    )
    publish_table(shown(figures, results, finer, read_reference(job.reference[0])), job.table[0])

"""Tabulate what receptors make of results: receptor_table.py TABLE OUT.csv [RATES.csv | HISTORY.nc ...]"""

import sys
from pathlib import Path

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish_table
from fingerpad.receptors.recordings import read_rates
from fingerpad.reference_data import ReferenceDataError
from fingerpad.studies.receptors.candidate_stimuli import candidate_stimuli
from fingerpad.studies.receptors.run import receptor_fits
from fingerpad.studies.receptors.sensing import rapidly_adapting, sensor_accuracy

name, out, *paths = sys.argv[1:]
try:
    rates = read_rates(*(path for path in paths if path.endswith(".csv")))
except ReferenceDataError as error:
    print(error, file=sys.stderr)
    sys.exit(2)
histories, _, coarse = read_results(path for path in paths if path.endswith(".nc"))
tables = {
    "receptor_fits": lambda: receptor_fits(histories, coarse, rates),
    "candidate_stimuli": lambda: candidate_stimuli(histories, rates),
    "sensor_accuracy": lambda: sensor_accuracy(histories),
    "rapidly_adapting": lambda: rapidly_adapting(histories),
}
publish_table(tables[name](), Path(out))

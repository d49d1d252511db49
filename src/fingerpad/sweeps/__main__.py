"""One job of a sweep in a process of its own.

``python -m fingerpad.sweeps batch TODO RECORDS`` runs scenes; ``python -m fingerpad.sweeps collect
FOLDER DATASET TABLE`` gathers their records.
"""

import sys
from pathlib import Path

from fingerpad.sweeps.batch import run_batch
from fingerpad.sweeps.collect import collect_layout

if __name__ == "__main__":
    job, *paths = sys.argv[1:]
    {"batch": run_batch, "collect": collect_layout}[job](*map(Path, paths))

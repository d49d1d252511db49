"""Scenes outside the study at several accuracies -> what their runs believe of their error, and the
truth.
"""

from pathlib import Path

import pandas as pd

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.belief import beliefs, prepared
from fingerpad import load_scene


def run(job):
    """`names` of the scenes, `scene` that they vary -> `rows` (CSV), one for each scene."""
    for name, path in zip(job.names, job.rows, strict=True):
        write_frame(
            pd.DataFrame(beliefs(prepared(name, load_scene(job.scene[0])), name)), Path(path)
        )

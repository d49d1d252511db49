"""Steady forces of subjects and the elastic curve -> the constant of each, how certain, and a
specimen of each.
"""

import json
from pathlib import Path

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.publishing.write import write_frame
from cysyk1999.reference_data import read_force_depth
from cysyk1999.studies.calibration.force import calibrate, write_specimens


def run(job):
    """`forces`, `histories`, `coarse` -> `data` (CSV, named as the calibration's frames), the
    folder `specimens`.
    """
    histories, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    forces = read_force_depth(job.forces)
    result = calibrate(histories, coarse, forces)
    for path in map(Path, job.data):
        write_frame(getattr(result, path.stem), path)
    scene = json.loads(histories["calibration_plate"].attrs["scene"])
    write_specimens(job.specimens[0], result, scene["specimen"], forces)

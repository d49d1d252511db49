"""Cases and whole strokes -> the directional index against place, height, friction and mesh, and
contact in islands.
"""

from pathlib import Path

from cysyk1999.measures.inputs import read_coarse, read_results
from cysyk1999.publishing.write import without_round_off, write_frame
from cysyk1999.studies.ridges.frames import frames


def run(job):
    """`cases`, `histories`, `coarse` -> `data` (CSV, named as the study's frames)."""
    strokes, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    made = frames(read_results(job.cases)[0], strokes, coarse)
    for path in map(Path, job.data):
        write_frame(without_round_off(made[path.stem]), path)

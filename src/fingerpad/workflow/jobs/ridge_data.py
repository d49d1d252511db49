"""Cases and whole strokes -> the directional index against place, height, friction and mesh, and contact in islands."""

from pathlib import Path

from fingerpad.measures.inputs import read_coarse, read_results
from fingerpad.publishing.write import without_round_off, write_frame
from fingerpad.studies.ridges.frames import frames


def run(job):
    """`cases`, `histories`, `coarse` -> `data` (CSV, named as the study's frames)."""
    strokes, coarse = read_results(job.histories)[0], read_coarse(job.coarse)
    made = frames(read_results(job.cases)[0], strokes, coarse)
    for path in map(Path, job.data):
        write_frame(without_round_off(made[path.stem]), path)

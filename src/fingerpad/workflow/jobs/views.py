"""Histories -> pictures of what happens inside, and the plotted data beside each."""

from pathlib import Path

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish, without_round_off
from fingerpad.studies.views.frames import FRAMES
from fingerpad.studies.views.picture import VIEWS


def run(job):
    """`histories` -> `pictures`, named as in VIEWS."""
    histories, _, _ = read_results(job.histories)
    for picture in job.pictures:
        name = Path(picture).stem
        frame = without_round_off(FRAMES[name][0](histories))
        publish(VIEWS[name](frame), frame, picture)

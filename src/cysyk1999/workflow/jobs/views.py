"""Histories -> pictures of what happens inside, and the plotted data beside each."""

from pathlib import Path

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import publish, without_round_off
from cysyk1999.studies.views.frames import FRAMES
from cysyk1999.studies.views.picture import VIEWS


def run(job):
    """`histories` -> `pictures`, named as in VIEWS."""
    histories, _, _ = read_results(job.histories)
    for picture in job.pictures:
        name = Path(picture).stem
        frame = without_round_off(FRAMES[name][0](histories))
        publish(VIEWS[name](frame), frame, picture)

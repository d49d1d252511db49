"""Histories of the nine surfaces -> the definitions of strain energy over the ramp and hold, and
which fall in the hold.
"""

from cysyk1999.measures.inputs import read_results
from cysyk1999.publishing.write import publish, without_round_off
from cysyk1999.studies.strain_energy_meanings import fig_meanings, frame_meanings


def run(job):
    """`histories`, `coarse` -> `picture`."""
    histories, _, coarse = read_results([*job.histories, *job.coarse])
    frame = without_round_off(frame_meanings(histories, coarse))
    publish(fig_meanings(frame), frame, job.picture[0])

"""Draw the definitions of strain energy over a ramp and hold: strain_energy_meanings.py FIGURE.png [HISTORY.nc ...]"""

import sys

from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import publish
from fingerpad.studies.strain_energy_meanings import fig_meanings, frame_meanings

png, *paths = sys.argv[1:]
histories, _, coarse = read_results(paths)
frame = frame_meanings(histories, coarse)
publish(fig_meanings(frame), frame, png)

"""Make a moving picture of a stroke: animation.py HISTORY.nc ANIMATION.gif"""

import sys

from fingerpad.figures.animation import animate
from fingerpad.results import read_history

history, gif = sys.argv[1:]
animate(read_history(history), gif)

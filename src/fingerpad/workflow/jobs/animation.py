"""The full fields of a history -> a moving picture."""

from fingerpad.figures.animation import animate
from fingerpad.results import read_history


def run(job):
    """`history` -> `gif`."""
    animate(read_history(job.history[0]), job.gif[0])

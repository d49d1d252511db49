"""The full fields of histories -> moving pictures."""

from cysyk1999.figures.animation import animate
from fingerpad.results import read_history


def run(job):
    """`histories` -> `gifs`."""
    for history, gif in zip(job.histories, job.gifs, strict=True):
        animate(read_history(history), gif)

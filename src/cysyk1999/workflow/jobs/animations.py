"""The full fields of histories -> moving pictures, as GIF and as film."""

from cysyk1999.figures.animation import animate
from fingerpad.results import read_history


def run(job):
    """`histories` -> `gifs`, `films`."""
    for history, gif, film in zip(job.histories, job.gifs, job.films, strict=True):
        animate(read_history(history), gif, film)

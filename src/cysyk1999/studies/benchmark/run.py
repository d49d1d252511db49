"""Predictions of every model at hand, and their scores."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from types import SimpleNamespace

from fingerpad.benchmark.command import predictions_of
from fingerpad.benchmark.rows import datasets
from fingerpad.benchmark.score import Predictions, score, write_predictions, write_scores
from fingerpad.files import write_atomically


def predictions(job: SimpleNamespace) -> None:
    """`measured` datasets -> `predictions`: a table a model, and scores of all."""
    measured = datasets()
    models = predictions_of(measured)
    *tables, scores = job.predictions

    def write(found: Predictions, path: Path) -> None:
        with path.open("w", newline="", encoding="utf-8") as file:
            write_predictions(found, file, measured)

    for path in tables:
        write_atomically(path, partial(write, models[Path(path).stem]))
    scored = {name: score(found, measured) for name, found in models.items()}
    write_atomically(scores, partial(write_scores, scored))

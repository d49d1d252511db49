"""The command ``fingerpad benchmark``."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from fingerpad.benchmark.rows import BenchmarkError, datasets
from fingerpad.benchmark.score import (
    Predictions,
    Score,
    read_predictions,
    score,
    write_predictions,
    write_scores,
)
from fingerpad.files import staged

THIS_MODEL, HALF_SPACE = "fingerpad", "half-space"


def options(add: Callable[..., Any]) -> None:
    """Add the command's words; `add` is a parser's ``add_argument``."""
    is_set: dict[str, Any] = {"action": "store_true"}
    add("words", nargs="*", metavar="score FILE.csv", help="score a file; without, this model")
    named = "one dataset; may be given again (default: all)"
    add("--dataset", action="append", default=[], metavar="NAME", help=named)
    written = "also write predictions and scores there"
    add("--out", metavar="DIR", type=Path, help=written)
    add("--template", **is_set, help="print the table that a model fills in, and do no more")


def benchmark(options: argparse.Namespace) -> None:
    """Write a template, score a file, or simulate and score all that is there.

    Raises
    ------
    BenchmarkError
        The words or the file are wrong.
    """
    measured = datasets(options.dataset)
    if options.template:
        write_predictions({}, sys.stdout, measured)
        return
    words = options.words
    if words and (words[0] != "score" or len(words) != 2):
        raise BenchmarkError(f"'{' '.join(words)}' is no task; allowed: score FILE.csv, or nothing")
    if words:
        models = {Path(words[1]).stem: read_predictions(words[1])}
    else:
        models = predictions_of(measured)
    scores = {
        name: score({key: found[key] for key in found if key[0] in measured}, measured)
        for name, found in models.items()
    }
    if not any(scores.values()):
        raise BenchmarkError(
            f"{words[1] if words else 'the datasets'}: no row with the role test is predicted; "
            "allowed: one or more"
        )
    show(scores)
    if options.out:
        write(options.out, models, scores, measured)


def predictions_of(measured: dict) -> dict[str, Predictions]:
    """Every model at hand -> its predictions: this one, the half-space, and published ones."""
    from fingerpad.benchmark import predict  # simulates: nothing that a score needs

    return {
        THIS_MODEL: predict.this_model(measured),
        HALF_SPACE: predict.half_space_model(measured),
        **predict.others(),
    }


def write(
    out: Path, models: dict[str, Predictions], scores: dict[str, list[Score]], measured: dict
) -> None:
    """A table of predictions for each model, and the scores of all, into a folder."""
    out.mkdir(parents=True, exist_ok=True)
    with staged(out) as stage:
        write_scores(scores, stage / "scores.csv")
        for name, found in models.items():
            with (stage / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
                write_predictions(found, file, measured)


def show(scores: dict[str, list[Score]]) -> None:
    """A table of scores on standard output."""
    table = Table(box=None, pad_edge=False)
    titles = ("dataset", "model", "rows", "rms error", "in sd", "R2", "bias", "in scatter")
    for title in (*titles, "within x2", "mesh error", "verdict"):
        table.add_column(title, overflow="fold")
    for name in dict.fromkeys(each.dataset for found in scores.values() for each in found):
        for model, found in scores.items():
            for each in (one for one in found if one.dataset == name):
                table.add_row(name, model, *_cells(each))
    Console(width=None if sys.stdout.isatty() else 200).print(table)


def _cells(found: Score) -> list[str]:
    def number(value: float, scale: float = 1.0, unit: str = "") -> str:
        return f"{scale * value:.3g}{unit}" if math.isfinite(value) else "-"

    return [
        f"{found.predicted}/{found.rows}",
        f"{found.rms:.3g} {found.unit}",
        number(found.rms_in_deviations),
        number(found.r_squared),
        number(found.bias),
        number(found.within_scatter, 100, " %"),
        number(found.within_factor_2, 100, " %"),
        number(found.mesh_error, 100, " %"),
        found.verdict,
    ]

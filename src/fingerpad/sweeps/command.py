"""The commands ``fingerpad sweep`` and ``fingerpad plan SWEEP.yaml``."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import netCDF4
from rich.console import Console
from rich.progress import (
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Table
from rich.text import Text

from fingerpad.documents import SceneError, read_yaml
from fingerpad.processes import progress_bar
from fingerpad.sweeps.design import Design, Parameter
from fingerpad.sweeps.engine import Layout, held, lay_out, run_layout
from fingerpad.sweeps.forecast import forecast
from fingerpad.sweeps.language import Read, load_sweep

PLANNING = (TaskProgressColumn(), TimeRemainingColumn())
RUNNING = (
    TextColumn("{task.completed} of {task.total} scenes"),
    TextColumn("{task.fields[failed]} failed"),
    TimeElapsedColumn(),
    TextColumn("left"),
    TimeRemainingColumn(),
)
"""Columns of the bars of a sweep."""


def read(path: Path, accuracy: str | None) -> Read:
    """The sweep of a file, at the accuracy of the command line. Raises SceneError."""
    document = read_yaml(path)
    if isinstance(document, dict) and "scene" not in document and "stimulus" in document:
        raise SceneError(
            f"{path}: is a scene, not a sweep; "
            "allowed: fingerpad run, or a sweep, which has the keys scene and over"
        )
    loaded = load_sweep(path)
    if accuracy is None:
        return loaded
    try:
        return replace(loaded, base=loaded.base.with_accuracy(accuracy))
    except SceneError as error:
        text = str(error).replace(f"{loaded.base.name}: accuracy", "--accuracy", 1)
        raise SceneError(text) from None


def plan(path: Path, accuracy: str | None, cores: int, as_json: bool) -> None:
    """Print what a sweep would take. Raises SceneError."""
    design = Design(read(path, accuracy))
    design.check()
    with progress_bar("planning", as_json, *PLANNING, total=len(design)) as show:
        cost = forecast(design, show)
    scenes = cost.scenes
    content = {
        "sweep": design.read.name,
        "scenes": len(design),
        "dimensions": design.dimensions,
        "effects": dict(cost.effects),
        "nodes": [int(scenes.nodes.min()), int(scenes.nodes.max())],
        "largest_expected_error": float(scenes.error.max()),
        "predicted_cost_s": round(float(scenes.cost_s.sum()), 1),
        "predicted_memory_MB": round(scenes.memory_MB.max()),
        "cores": cores,
        "predicted_wall_s": round(cost.wall_s(cores), 1),
    }
    if as_json:
        print(json.dumps(content, indent=2))
    else:
        _print(content, design.parameters)


def _print(content: dict[str, Any], parameters: list[Parameter]) -> None:
    console = Console(highlight=False, soft_wrap=True)
    title = f"Sweep {content['sweep']}: {content['scenes']} scenes"
    table = Table("key", "values", title=title, title_justify="left")
    for p in parameters:
        sampled = p.dimension != p.name
        values = sorted(p.values) if sampled else p.values
        shown = [f"{v:.4g}" if isinstance(v, float) else str(v) for v in values]
        text = ", ".join(shown) if len(shown) <= 6 else f"{shown[0]} to {shown[-1]}"
        unit = f" {p.unit}" if p.unit not in ("", "1") else ""
        count = f"{len(shown)}{' samples' if sampled else ''}"
        table.add_row(Text(p.key), Text(f"{count}: {text}{unit}"))
    console.print(table, soft_wrap=False)
    effects = [f"{name.replace('_', ' ')} in {n}" for name, n in content["effects"].items()]
    low, high = content["nodes"]
    nodes = f"{low} to {high}" if high != low else f"{low}"
    cores = content["cores"]
    lines = (
        f"effects: {', '.join(effects) or 'none'} of {content['scenes']}",
        f"nodes: {nodes}; largest expected error {content['largest_expected_error']:.1%}",
        f"predicted cost: {_time(content['predicted_cost_s'])} of one core, "
        f"{content['predicted_memory_MB']} MB a process; "
        f"about {_time(content['predicted_wall_s'])} on {cores} core{'s' if cores > 1 else ''}",
    )
    for line in lines:
        console.print(Text(line))


def _time(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.2g} s" if seconds < 100 else f"{seconds:.0f} s"
    return f"{seconds / 60:.3g} min" if seconds < 7200 else f"{seconds / 3600:.3g} h"


def sweep(options: Any) -> None:
    """Run a sweep. Raises SceneError, SweepError and NotFinished."""
    loaded = read(options.sweep, options.accuracy)
    folder = options.out or Path("results/sweeps") / loaded.name
    with held(folder) as lock:
        with progress_bar("planning", options.quiet, *PLANNING) as show:
            layout = lay_out(loaded, folder, options.cores, options.force, options.again, show)
        quiet = options.quiet or not layout.missing
        with progress_bar(layout.name, quiet, *RUNNING, total=layout.missing, failed=0) as show:
            run_layout(layout, options.cores, options.profile, show, lock)
    if not options.quiet:
        print(_closing(layout))


def _closing(layout: Layout) -> str:
    file = layout.folder / "sweep.nc"
    with netCDF4.Dataset(file) as dataset:
        failed, doubted = int(dataset.failed), int(dataset.doubted)
    ran = "all run"
    if layout.missing < layout.scenes:
        ran = f"{layout.missing} run, {layout.scenes - layout.missing} known from before"
    lost = f"; {failed} could not be simulated, see the column diagnosis" if failed else ""
    lost += f"; {doubted} completed in doubt, see the column doubts" if doubted else ""
    return f"{layout.scenes} scenes ({ran}){lost}; results in {file} and sweep.csv"

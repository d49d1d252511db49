"""What ``fingerpad sweep`` and ``fingerpad plan SWEEP.yaml`` do."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.documents import SceneError, read_yaml
from fingerpad.files import is_file

if TYPE_CHECKING:
    from fingerpad.sweeps.design import Design
    from fingerpad.sweeps.engine import Layout
    from fingerpad.sweeps.forecast import Forecast
    from fingerpad.sweeps.language import Read


def is_sweep(path: Path) -> bool:
    """Does a file describe a sweep: variations of a scene that it names?"""
    try:
        document = read_yaml(path) if is_file(path) else None
    except SceneError:
        return False  # what is wrong with it is said where it is read
    return isinstance(document, dict) and "over" in document and "scene" in document


def read(path: Path, accuracy: str | None) -> Read:
    """The sweep of a file, at the accuracy asked for. Raises SceneError."""
    from fingerpad.sweeps.language import load_sweep

    document = read_yaml(path)
    if isinstance(document, dict) and "scene" not in document and "stimulus" in document:
        raise SceneError(
            f"{path}: is a scene, not a sweep; allowed: fingerpad run, or a sweep, which has the keys scene and over"
        )
    found = load_sweep(path)
    if accuracy is None:
        return found
    try:
        return replace(found, base=found.base.with_accuracy(accuracy))
    except SceneError as error:
        raise SceneError(
            str(error).replace(f"{found.base.name}: accuracy", "--accuracy", 1)
        ) from None


def plan(path: Path, accuracy: str | None, cores: int, as_json: bool) -> None:
    """Print what a sweep would take. Raises SceneError."""
    from fingerpad.sweeps.design import Design
    from fingerpad.sweeps.forecast import forecast

    design = Design(read(path, accuracy))
    design.check()
    with _bar("planning", len(design), as_json) as show:
        found = forecast(design, show)
    if as_json:
        print(json.dumps(_said(design, found, cores), indent=2))
    else:
        _print(design, found, cores)


def _said(design: Design, found: Forecast, cores: int) -> dict[str, Any]:
    return {
        "sweep": design.read.name,
        "scenes": len(design),
        "dimensions": design.dimensions,
        "effects": dict(found.effects),
        "nodes": list(found.nodes),
        "largest_expected_error": found.worst_error,
        "predicted_cost_s": round(sum(found.cost_s), 1),
        "predicted_memory_MB": round(max(found.memory_MB)),
        "cores": cores,
        "predicted_wall_s": round(found.wall_s(cores), 1),
    }


def _print(design: Design, found: Forecast, cores: int) -> None:
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    said, console = _said(design, found, cores), Console(highlight=False)
    table = Table(
        "key",
        "values",
        title=f"Sweep {said['sweep']}: {said['scenes']} scenes",
        title_justify="left",
    )
    for p in design.parameters:
        unit = f" {p.unit}" if p.unit not in ("", "1") else ""
        shown = [
            f"{v:.4g}" if isinstance(v, float) else str(v)
            for v in (sorted(p.values) if p.dimension != p.name else p.values)
        ]
        values = ", ".join(shown) if len(shown) <= 6 else f"{shown[0]} to {shown[-1]}"
        table.add_row(
            Text(p.key),
            Text(f"{len(shown)}{' samples' if p.dimension != p.name else ''}: {values}{unit}"),
        )
    console.print(table)
    effects = (
        ", ".join(f"{name.replace('_', ' ')} in {n}" for name, n in found.effects.items()) or "none"
    )
    console.print(Text(f"effects: {effects} of {len(design)}"), soft_wrap=True)
    low, high = found.nodes
    console.print(
        Text(
            f"nodes: {low}{f' to {high}' if high != low else ''}; largest expected error {found.worst_error:.1%}"
        )
    )
    wall = _time(said["predicted_wall_s"])
    console.print(
        Text(
            f"predicted cost: {_time(said['predicted_cost_s'])} of one core, {said['predicted_memory_MB']} MB a process; "
            f"about {wall} on {cores} core{'s' if cores > 1 else ''}"
        ),
        soft_wrap=True,
    )


def _time(seconds: float) -> str:
    if seconds < 120:
        return f"{seconds:.2g} s" if seconds < 100 else f"{seconds:.0f} s"
    return f"{seconds / 60:.3g} min" if seconds < 7200 else f"{seconds / 3600:.3g} h"


def sweep(options: Any) -> int:
    """Run a sweep; the exit code: 0, or 3 if it did not come to its end. Raises SceneError and
    SweepError.
    """
    from fingerpad.sweeps.engine import NotFinished, held, lay_out, run_layout

    found = read(options.sweep, options.accuracy)
    folder = options.out or Path("results/sweeps") / found.name
    with held(folder) as lock:
        with _bar("planning", None, options.quiet) as show:
            layout = lay_out(found, folder, options.cores, options.force, options.again, show)
        try:
            with _watching(layout, options.quiet) as watch:
                run_layout(layout, options.cores, options.profile, watch, lock)
        except NotFinished as error:
            print(f"fingerpad: {error}", file=sys.stderr)
            return 3
    if not options.quiet:
        print(_closing(layout))
    return 0


def _closing(layout: Layout) -> str:
    import netCDF4

    with netCDF4.Dataset(layout.folder / "sweep.nc") as file:
        failed = int(file.failed)
    ran = (
        f"{layout.missing} run, {layout.scenes - layout.missing} known from before"
        if layout.missing < layout.scenes
        else "all run"
    )
    lost = f"; {failed} could not be simulated, see the column diagnosis" if failed else ""
    return f"{layout.scenes} scenes ({ran}){lost}; results in {layout.folder / 'sweep.nc'} and sweep.csv"


@contextlib.contextmanager
def _bar(name: str, total: int | None, quiet: bool) -> Iterator[Callable[[int], None] | None]:
    """A bar of scenes on a terminal's standard error, as a function to call with how many are done;
    else None.
    """
    if quiet or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as progress:
        task = progress.add_task(name, total=total)
        yield lambda done: progress.update(task, completed=done)


@contextlib.contextmanager
def _watching(layout: Layout, quiet: bool) -> Iterator[Callable[[int, int], None] | None]:
    """The progress of a sweep: scenes done, failed, time left."""
    if quiet or not sys.stderr.isatty() or not layout.missing:
        yield None
        return
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    columns = (
        TextColumn(layout.name),
        BarColumn(),
        TextColumn("{task.completed} of {task.total} scenes"),
        TextColumn("{task.fields[failed]} failed"),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(
        *columns, console=Console(stderr=True), transient=True, speed_estimate_period=120
    ) as progress:
        task = progress.add_task(layout.name, total=layout.missing, failed=0)
        yield lambda done, failed: progress.update(task, completed=done, failed=failed)

"""What sweeps cost: scenes a second and core, memory over a thousand scenes, and what grows with
their number.

    python -m cysyk1999.studies.sweep_bench [SCENES]        figures/tables/sweeps.csv, sweeps.md

Process times are user and system, so that a busy machine counts little; walls are medians of runs
of the command itself on an idle machine, one core and two in turn. Laying out and collecting are
measured up to ten thousand scenes, collecting with records that were made up: what a record says
costs the same whoever wrote it.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

PRESS = {"shape": "cylinder", "curvature": "210 1/m"}
KINDS = {
    "steady press, finite strain": {"motion": [{"press_to_force": "20 gf"}]},
    "ramp and hold": {"motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}]},
    "steady press, small strain": {
        "motion": [{"press_to_force": "20 gf"}],
        "effects": {"finite_strain": "off"},
    },
}
REPEATS = 3
"""Runs of a command of which the median is told; one of ten thousand scenes is run once."""


def text_of(kind: str, scenes: int) -> dict[str, Any]:
    """A sweep over the curvature of a scene at draft, as its file says it."""
    over = {
        "stimulus.curvature": {
            "range": ["80 1/m", "800 1/m"],
            "count": scenes,
            "spacing": "logarithmic",
        }
    }
    return {"scene": {"stimulus": PRESS} | KINDS[kind], "over": over, "accuracy": "draft"}


def sweep_of(kind: str, scenes: int) -> Any:
    """The same, checked."""
    from fingerpad.sweeps.language import load_sweep

    return load_sweep(text_of(kind, scenes), "bench")


def of_command(
    kind: str, scenes: int, cores: tuple[int, ...], repeats: int = REPEATS
) -> list[dict[str, Any]]:
    """`fingerpad sweep` from start to finish, on so many cores in turn: medians of the walls, and
    how many times the scenes.
    """
    walls: dict[int, list[float]] = {n: [] for n in cores}
    with tempfile.TemporaryDirectory() as name:
        text = Path(name) / "sweep.yaml"
        text.write_text(json.dumps(text_of(kind, scenes)))
        for k in range(repeats):
            for n in cores:
                start, out = time.perf_counter(), f"{name}/{k}_{n}"
                command = [
                    Path(sys.executable).with_name("fingerpad"),
                    "sweep",
                    text,
                    "--out",
                    out,
                    "--cores",
                    str(n),
                ]
                subprocess.run(command, check=True, capture_output=True)
                walls[n].append(time.perf_counter() - start)
                print(f"{kind}, {scenes} scenes, {n} cores: {walls[n][-1]:.1f} s", flush=True)
    median = {n: float(np.median(found)) for n, found in walls.items()}
    rows = []
    for n in cores:
        what = f"{kind}, the command on {n} core{'s' * (n > 1)}"
        rows += [
            _row(
                what,
                scenes,
                f"wall time, median of {repeats}" if repeats > 1 else "wall time",
                median[n],
                "s",
            ),
            _row(what, scenes, "scenes a second", scenes / median[n], "1/s"),
        ]
        if repeats > 1:
            rows.append(
                _row(
                    what,
                    scenes,
                    "spread of the walls over their median",
                    np.ptp(walls[n]) / median[n],
                    "1",
                )
            )
    if set(cores) >= {1, 2}:
        rows.append(
            _row(
                f"{kind}, the command",
                scenes,
                "scenes on two cores over scenes on one",
                median[1] / median[2],
                "1",
            )
        )
    return rows


def of_worker(kind: str, scenes: int) -> list[dict[str, Any]]:
    """One process with some scenes: its process time a scene, all included, and its memory."""
    from fingerpad.sweeps.engine import lay_out
    from fingerpad.sweeps.records import read_records

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        layout = lay_out(sweep_of(kind, scenes), folder, 1)
        # all of them in one process, whatever their batches would be
        specs = [
            json.loads((folder / "todo" / f"{batch}.json").read_text()) for batch in layout.batches
        ]
        whole = specs[0] | {"scenes": [scene for spec in specs for scene in spec["scenes"]]}
        todo, records = folder / "todo" / "all.json", folder / "batches" / "all.jsonl"
        todo.write_text(json.dumps(whole))
        code = (
            "import resource, sys; from pathlib import Path; from fingerpad.sweeps.batch import "
            "run_batch; "
            "run_batch(Path(sys.argv[1]), Path(sys.argv[2])); t = "
            "resource.getrusage(resource.RUSAGE_SELF); "
            "print('CPU', t.ru_utime + t.ru_stime, t.ru_maxrss / 1024)"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, todo, records], capture_output=True, text=True, check=True
        )
        cpu, peak = map(float, done.stdout.split("CPU ")[1].split())
        found = list(read_records(records))
    memory = np.array([record["memory_MB"] for record in found])
    start = min(100, len(memory) // 2)
    return [
        _row(kind, scenes, "process time a scene, all included", cpu / scenes, "s"),
        _row(
            kind,
            scenes,
            "process time a scene, simulation alone",
            np.mean([r["cpu_s"] for r in found[1:]]),
            "s",
        ),
        _row(kind, scenes, "largest memory", peak, "MB"),
        _row(
            kind,
            scenes,
            f"largest memory after scene {start} over memory then",
            memory[start:].max() / memory[start],
            "1",
        ),
    ]


def of_laying_out(scenes: int) -> list[dict[str, Any]]:
    """Checking, planning and dividing: process time a scene, and files."""
    from fingerpad.sweeps.engine import lay_out

    with tempfile.TemporaryDirectory() as name:
        read, start = sweep_of("steady press, finite strain", scenes), time.process_time()
        layout = lay_out(read, Path(name), 2)
        cpu = time.process_time() - start
        files = sum(1 for path in Path(name).rglob("*") if path.is_file())
    kind = "laying out"
    return [
        _row(kind, scenes, "process time a scene", cpu / scenes, "s"),
        _row(kind, scenes, "batches", len(layout.batches), "count"),
        _row(kind, scenes, "files", files, "count"),
    ]


def of_collecting(scenes: int, measures: int = 30) -> list[dict[str, Any]]:
    """One dataset and one table of made-up records: process time and the largest memory of the
    process.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        values = np.random.default_rng(1).random((scenes, measures)).round(6).tolist()
        with (folder / "all.jsonl").open("w") as file:
            for n, row in enumerate(values):
                said = [[f"measure_{k}", "end", "mm", value] for k, value in enumerate(row)]
                file.write(
                    json.dumps(
                        {
                            "key": f"{n:020d}",
                            "number": n,
                            "diagnosis": "",
                            "measures": said,
                            "nodes": 1,
                        }
                    )
                    + "\n"
                )
        one = {
            "name": "k",
            "key": "k",
            "unit": "mm",
            "dimension": "k",
            "values": list(range(scenes)),
            "source": "",
        }
        keys = [f"{n:020d}" for n in range(scenes)]
        (folder / "design.json").write_text(
            json.dumps(
                {"dimensions": {"k": scenes}, "parameters": [one], "keys": keys, "about": {}}
            )
        )
        code = (
            "import json, resource, sys; from pathlib import Path; from fingerpad.sweeps.collect "
            "import collect; "
            "p = Path(sys.argv[1]); "
            "collect(json.loads((p / 'design.json').read_text()), [p / 'all.jsonl'], p / 'a.nc', "
            "p / 'a.csv'); "
            "t = resource.getrusage(resource.RUSAGE_SELF); print(t.ru_utime + t.ru_stime, "
            "t.ru_maxrss / 1024)"
        )
        done = subprocess.run(
            [sys.executable, "-c", code, folder], capture_output=True, text=True, check=True
        )
        cpu, peak = map(float, done.stdout.split())
        size = (folder / "a.nc").stat().st_size / 1e6
    kind = f"collecting {measures} measures"
    return [
        _row(kind, scenes, "process time", cpu, "s"),
        _row(kind, scenes, "largest memory", peak, "MB"),
        _row(kind, scenes, "dataset", size, "MB"),
    ]


def _row(what: str, scenes: int, quantity: str, value: float, unit: str) -> dict[str, Any]:
    print(f"{what}, {scenes} scenes: {quantity} {value:.4g} {unit}", flush=True)
    return {
        "what": what,
        "scenes": scenes,
        "quantity": quantity,
        "value": float(value),
        "unit": unit,
    }


def main(most: int = 1000) -> None:
    """Measure and write the table."""
    from cysyk1999.publishing.write import publish_table

    press, _, small = KINDS
    rows = []
    for scenes in (most // 10, most, 10 * most):
        rows += of_collecting(scenes)
    for scenes in (most // 10, most, 10 * most):
        rows += of_laying_out(scenes)
    for kind, scenes in zip(KINDS, (most // 5, most // 10, most), strict=True):
        rows += of_worker(kind, scenes)
    rows += of_command(press, most, (1, 2))
    rows += of_command(small, most // 10, (2,)) + of_command(small, most, (2,), 1)
    publish_table(pd.DataFrame(rows), "figures/tables/sweeps.csv")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))

"""Speed on this machine: ``python -m cysyk1999.studies.bench [speed|sweeps]``.

``speed`` (the default) writes ``figures/tables/speed.csv`` and ``.md``; ``sweeps`` writes
``sweeps.csv`` and ``.md``. Times are process times of one
thread, medians of repeats, unless wall is said. Ratios are medians of pairs measured in turn, so
that a busy machine slows both: they may be quoted; absolute times belong to the machine.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from threadpoolctl import threadpool_limits

from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.common.documents import FLAT, RAMP, SCENES, cylinder, force, scene_of
from cysyk1999.studies.common.plans import seconds, seconds_of_children
from fingerpad.healing import simulate
from fingerpad.mechanics.linear_solver import condensation
from fingerpad.planning.plan import Plan, plan
from fingerpad.results import provenance, states_found
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.simulation import Simulation
from fingerpad.sweeps.engine import lay_out
from fingerpad.sweeps.language import load_sweep
from fingerpad.sweeps.records import read_records

TABLES = SCENES.parents[1] / "figures" / "tables"
Rows = Iterator[tuple]
SPEED = ["what", "value", "unit", "how", "repeats", "wanted"]
"""Columns of a row of speed; the last is the largest value that is wanted."""
SWEEPS = ["what", "scenes", "quantity", "value", "unit"]


def median(call: Callable, repeats: int, clock: Callable[[], float] = time.process_time) -> float:
    """Median time (s) of a call."""
    return float(np.median([seconds(call, clock) for _ in range(repeats)]))


def ratio(one: Callable, other: Callable, repeats: int) -> float:
    """Process time of a call over that of another: median of pairs in turn."""
    return float(np.median([seconds(one) / seconds(other) for _ in range(repeats)]))


def planned(name: str, **changes: Any) -> tuple[Scene, Plan]:
    """A scene of the configuration and its plan."""
    scene = load_scene(SCENES / f"{name}.yaml").varied(changes)
    return scene, plan(scene)


def counted(history: Any) -> tuple[int, int, int]:
    """Steps, Newton iterations and cuts of a history."""
    return states_found(history), int(history.newton_iterations.sum()), int(history.cutbacks.sum())


def _factoring(run: Simulation) -> tuple[Callable[[], None], Callable[[], None], np.ndarray]:
    """Factor, and factor and solve, the tangent of a body as it is; and its coefficients."""
    space = run.body.space
    tangent, load = run.body.tangent()
    data, right = tangent.copy(), space.to_equations(load)
    plain = condensation(space.pattern, np.zeros(0, dtype=np.int64))

    def factor_and_solve() -> None:
        plain.factor(data)
        plain.forward(right)

    return partial(plain.factor, data), factor_and_solve, data


def newton_iteration(repeats: int = 15) -> Rows:
    """One Newton iteration of the whole pad beside factorisation and solution of its matrix."""
    run = Simulation(*planned("ramp40_k210", effects={"symmetry": False}), None)
    stepper, steps = run.stepper, list(run.steps())
    stepper.run(steps[:10])
    factor, factor_and_solve, data = _factoring(run)
    state = stepper.save()

    def iteration() -> None:
        stepper.restore(state)
        stepper.iterate("force", steps[10].force)

    run.body.begin_step(steps[10].dt)
    iteration()
    size = f"{len(run.body.space.points)} nodes, {run.body.space.size} unknowns"
    size += f", {len(stepper.zone.nodes)} skin nodes in the contact zone"
    times = ratio(iteration, factor_and_solve, repeats)
    yield "Newton iteration / (factor + solve)", times, "1", size, repeats, 1.8
    times = ratio(partial(stepper.solver.factor, data), factor, repeats)
    yield "factor with Schur complement / plain factor", times, "1", size, repeats, 1.25
    once = 1e3 * median(factor_and_solve, repeats)
    yield "factor + solve", once, "ms", size, repeats, None


def presses(repeats: int = 3) -> Rows:
    """Ramps and holds at figure resolution, and what inner ridges cost."""
    for name in ("ramp40_flat", "ramp40_k210", "ramp40_k1260"):
        scene, chosen = planned(name)
        steps, iterations, _ = counted(simulate(scene, chosen))
        how = f"{chosen.nodes} nodes (half pad), {steps} steps, "
        how += f"{iterations} Newton iterations, meshing included"
        took = median(partial(simulate, scene, chosen), repeats)
        yield f"ramp and hold, {name}", took, "s", how, repeats, 3
    ridged, plain = planned("ridged_40_flat"), planned("ramp40_flat")
    times = ratio(partial(simulate, *ridged), partial(simulate, *plain), repeats)
    nodes = plain[1].nodes, ridged[1].nodes
    how = f"ramp and hold, flat: {nodes[0]} and {nodes[1]} nodes (half pad), "
    how += f"{times:.2f} times the process time"
    what = "inner ridges, cost a node over the plain pad's"
    yield what, times * nodes[0] / nodes[1], "1", how, repeats, 3
    for label, stimulus in (("flat", FLAT), ("1260 1/m", cylinder(1259.84))):
        for nu in (0.48, 0.4999):
            layers = {name: {"poisson_ratio": nu} for name in ("epidermis", "dermis", "fat")}
            document = {"stimulus": stimulus, "motion": [force(20)], "accuracy": {"steps": 1}}
            history = simulate(scene_of(document | {"specimen": {"layers": layers}}, label))
            _, iterations, cuts = counted(history)
            how = f"20 gram-weight, {label}, nu = {nu}, {cuts} cuts"
            yield "full load in one step", iterations, "iterations", how, 1, 6


def strokes() -> Rows:
    """The five full strokes over the wavy surface, and a factorisation on its mesh after each."""
    times, counts, ratios, nodes = [], [], [], set()
    for speed in (1, 5, 10, 20, 40):
        scene, chosen = planned(f"stroke_{speed}")
        start = time.process_time()
        counts.append(counted(simulate(scene, chosen)))
        times.append(time.process_time() - start)
        _, factor_and_solve, _ = _factoring(Simulation(scene, chosen, None))
        ratios.append(times[-1] / median(factor_and_solve, 5))
        nodes.add(chosen.nodes)
    steps, iterations, cuts = np.sum(counts, axis=0)
    how = f"{' and '.join(map(str, sorted(nodes)))} nodes, {steps} steps, {cuts} cuts, "
    how += "80 mm each at 1 to 40 mm/s"
    own = f"; median of the five, {min(ratios):.0f} to {max(ratios):.0f}; on its own mesh"
    over = float(np.median(ratios))
    yield "five full strokes", sum(times), "s", how, 1, 240
    yield "a full stroke / (factor + solve)", over, "1", how + own, 1, 500
    yield "iterations a step of a stroke", iterations / steps, "1", how, 1, 3


def command(*words: str | Path) -> Callable[[], Any]:
    """A call of a process that must end well."""
    return partial(subprocess.run, list(map(str, words)), check=True, capture_output=True)


def overhead(repeats: int = 5) -> Rows:
    """What a simulation process costs before it simulates."""
    code = "import fingerpad, fingerpad.simulation as s; "
    code += f"scene = fingerpad.load_scene({str(SCENES / 'ramp40_flat.yaml')!r}); "
    code += "s.Simulation(scene, fingerpad.plan(scene), None)"
    took = median(command(sys.executable, "-c", code), repeats, time.perf_counter)
    how = "wall time of a process that imports, plans, meshes and builds the model of ramp40_flat"
    yield "process overhead per job", took, "s", how, repeats, 1.5


# -- sweeps ---

PRESS, HELD, SMALL = "steady press, finite strain", "ramp and hold", "steady press, small strain"
KINDS = {
    PRESS: {"motion": [force(20)]},
    HELD: {"motion": RAMP},
    SMALL: {"motion": [force(20)], "effects": {"finite_strain": "off"}},
}


def sweep_of(kind: str, scenes: int) -> dict[str, Any]:
    """A sweep over the curvature of a scene at draft."""
    curvatures = {"range": ["80 1/m", "800 1/m"], "count": scenes, "spacing": "logarithmic"}
    scene = {"stimulus": cylinder(210)} | KINDS[kind]
    return {"scene": scene, "over": {"stimulus.curvature": curvatures}, "accuracy": "draft"}


def of_command(kind: str, scenes: int, cores: int, repeats: int = 3) -> Rows:
    """``fingerpad sweep`` on so many cores: walls, process time a scene, memory of its records."""
    with tempfile.TemporaryDirectory() as name:
        file, out = Path(name, "sweep.yaml"), Path(name)
        file.write_text(json.dumps(sweep_of(kind, scenes)))
        words = (sys.executable, "-m", "fingerpad", "sweep", file, "--cores", cores, "--out")
        before = seconds_of_children()
        walls = [seconds(command(*words, out / str(k)), time.perf_counter) for k in range(repeats)]
        cpu = seconds_of_children() - before
        batches = [list(read_records(path)) for path in sorted(out.glob("0/**/*.jsonl"))]
    whole = f"{kind}, the command on {cores} core{'s' * (cores > 1)}"
    middle = float(np.median(walls))
    took = f"wall time, median of {repeats}" if repeats > 1 else "wall time"
    yield whole, scenes, took, middle, "s"
    yield whole, scenes, "scenes a second", scenes / middle, "1/s"
    if repeats > 1:
        spread = np.ptp(walls) / middle
        yield whole, scenes, "spread of the walls over their median", spread, "1"
    alone = np.mean([record["cpu_s"] for batch in batches for record in batch[1:]])
    a_scene = "process time a scene"
    yield kind, scenes, f"{a_scene}, all included", cpu / scenes / repeats, "s"
    yield kind, scenes, f"{a_scene}, simulation alone", alone, "s"
    memory = [np.array([record["memory_MB"] for record in batch]) for batch in batches]
    yield kind, scenes, "largest memory", max(map(np.max, memory)), "MB"
    start = min(100, len(memory[0]) // 2)
    growth = max(batch[start:].max() / batch[start] for batch in memory)
    yield kind, scenes, f"largest memory after scene {start} over memory then", growth, "1"


def of_laying_out(scenes: int) -> Rows:
    """Checking, planning and dividing: process time a scene, and files."""
    with tempfile.TemporaryDirectory() as name:
        read, start = load_sweep(sweep_of(PRESS, scenes), "bench"), time.process_time()
        layout = lay_out(read, Path(name), 2)
        cpu = time.process_time() - start
        files = sum(path.is_file() for path in Path(name).rglob("*"))
    yield "laying out", scenes, "process time a scene", cpu / scenes, "s"
    yield "laying out", scenes, "batches", len(layout.batches), "count"
    yield "laying out", scenes, "files", files, "count"


COLLECT = """
import json, sys
from pathlib import Path
from time import process_time
from fingerpad.results import peak_memory_MB
from fingerpad.sweeps.collect import collect
folder = Path(sys.argv[1])
design = json.loads((folder / "design.json").read_text())
collect(design, [folder / "all.jsonl"], folder / "a.nc", folder / "a.csv")
print(process_time(), peak_memory_MB(), (folder / "a.nc").stat().st_size / 1e6)
"""


def of_collecting(scenes: int, measures: int = 30) -> Rows:
    """Dataset and table of made-up records: process time, memory, size."""
    keys = [f"{n:020d}" for n in range(scenes)]
    parameter = {"name": "k", "key": "k", "unit": "mm", "dimension": "k", "source": ""}
    parameter["values"] = list(range(scenes))
    design = {"dimensions": {"k": scenes}, "parameters": [parameter], "keys": keys, "about": {}}
    values = np.random.default_rng(1).random((scenes, measures)).round(6).tolist()
    with tempfile.TemporaryDirectory() as name:
        Path(name, "design.json").write_text(json.dumps(design))
        with Path(name, "all.jsonl").open("w") as file:
            for n, numbers in enumerate(values):
                found = [[f"measure_{k}", "end", "mm", x] for k, x in enumerate(numbers)]
                record = {"key": keys[n], "number": n, "diagnosis": "", "nodes": 1}
                file.write(json.dumps(record | {"measures": found}) + "\n")
        said = command(sys.executable, "-c", COLLECT, name)().stdout.split()
    what = f"collecting {measures} measures"
    for quantity, value, unit in zip(
        ("process time", "largest memory", "dataset"), said, ("s", "MB", "MB"), strict=True
    ):
        yield what, scenes, quantity, float(value), unit


def sweeps(most: int = 1000) -> pd.DataFrame:
    """What sweeps cost, by number of scenes."""
    sizes = most // 10, most, 10 * most
    rows = [
        each for measured in (of_collecting, of_laying_out) for n in sizes for each in measured(n)
    ]
    one, two = (list(of_command(PRESS, most, cores)) for cores in (1, 2))
    gain = one[0][3] / two[0][3]
    what = "scenes on two cores over scenes on one"
    rows += [*one, *two, (f"{PRESS}, the command", most, what, gain, "1")]
    rows += [*of_command(HELD, most // 10, 1, 1), *of_command(SMALL, most, 2, 1)]
    return pd.DataFrame(rows, columns=SWEEPS)


def speed() -> pd.DataFrame:
    """What presses, strokes and their parts cost, and the machine."""
    with threadpool_limits(1):
        rows = [*newton_iteration(), *presses(), *strokes(), *overhead()]
    table = pd.DataFrame(rows, columns=SPEED)
    value, wanted = table["value"], table.pop("wanted")
    table["value"] = [float(f"{each:.4g}") for each in value]
    table.insert(3, "target", [f"<= {most:g}" if most else "" for most in wanted.fillna(0)])
    table.insert(4, "met", (value <= wanted).where(wanted.notna(), ""))
    table.insert(5, "repeats", table.pop("repeats"))
    made_by = provenance()
    known = [made_by["processor"], f"{os.cpu_count()} cores, 1 thread, python {made_by['python']}"]
    known += [f"{name} {made_by['packages'][name]}" for name in ("numpy", "numba", "mkl")]
    table["machine"] = ", ".join(known)
    table.attrs["columns"] = list(table.columns[:-1])
    return table


if __name__ == "__main__":
    name = (sys.argv[1:] or ["speed"])[0]
    publish_table({"speed": speed, "sweeps": sweeps}[name](), TABLES / f"{name}.csv")

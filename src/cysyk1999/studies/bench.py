"""Speed of the solver on this machine: ``python -m cysyk1999.studies.bench [--workflow]``.

Everything is measured in one process with one thread, as medians of repeated runs; ratios within
the process are what may be quoted, absolute times belong to the machine named in the table. Writes
figures/tables/speed.csv and .md.
"""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse  # noqa: E402
import statistics  # noqa: E402
import subprocess  # noqa: E402
import sys  # noqa: E402
import time  # noqa: E402
from functools import partial  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402
import pandas as pd  # noqa: E402
from threadpoolctl import threadpool_limits  # noqa: E402

from cysyk1999.receptors.sensor import TactileSensor  # noqa: E402
from fingerpad.files import write_atomically  # noqa: E402
from fingerpad.mechanics.linear_solver import condensation  # noqa: E402
from fingerpad.planning.plan import plan  # noqa: E402
from fingerpad.receptors.laws import SpatialSum  # noqa: E402
from fingerpad.results import provenance, states_found  # noqa: E402
from fingerpad.scenes.scene import (
    Cylinder,
    Discretisation,
    Flat,
    Layer,
    Layers,
    PressToForce,
    Scene,
    load_scene,
)  # noqa: E402
from fingerpad.simulation import Simulation, simulate  # noqa: E402

ROOT = Path(__file__).resolve().parents[3]
SCENES = ROOT / "config" / "scenes"
COLUMNS = ["what", "value", "unit", "target", "met", "repeats", "how"]


def seconds(call, repeats: int) -> tuple[float, float, float]:
    """Least, median and largest process time (s) of ``call``."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times), statistics.median(times), max(times)


def newton_iteration(repeats: int = 15) -> list[list]:
    """One Newton iteration of the whole pad against factorisation and solution of the same
    matrix.
    """
    scene = load_scene(SCENES / "ramp40_k210.yaml").varied({"effects": {"symmetry": False}})
    run = Simulation(scene, plan(scene), None)
    stepper, body = run.stepper, run.body
    steps = list(run.steps())
    stepper.run(steps[:10])
    plain, data, right = _plain(body)

    def factor_and_solve():
        plain.factor(data)
        plain.forward(right)

    state = stepper.save()
    target = steps[10].force

    def iteration():
        stepper.restore(state)
        stepper.iterate("force", target)

    body.begin_step(steps[10].dt)
    iteration()
    ratios, schur = [], []
    for _ in range(repeats):  # in pairs, so that a busy machine slows both
        a = seconds(factor_and_solve, 1)[1]
        ratios.append(seconds(iteration, 1)[1] / a)
        b = seconds(lambda: plain.factor(data), 1)[1]
        schur.append(seconds(lambda: stepper.solver.factor(data), 1)[1] / b)
    nodes = len(body.space.points)
    how = (
        f"{nodes} nodes, {body.space.size} unknowns, {len(stepper.zone.nodes)} skin nodes in "
        "the contact zone"
    )
    ratio, schur_ratio = statistics.median(ratios), statistics.median(schur)
    return [
        ["Newton iteration / (factor + solve)", ratio, "1", "<= 1.8", ratio <= 1.8, repeats, how],
        [
            "factor with Schur complement / plain factor",
            schur_ratio,
            "1",
            "<= 1.25",
            schur_ratio <= 1.25,
            repeats,
            how,
        ],
        ["factor + solve", 1e3 * seconds(factor_and_solve, repeats)[1], "ms", "", "", repeats, how],
    ]


def ramp_and_hold(repeats: int = 3) -> list[list]:
    """The nine-shape scenes at figure resolution: broadest, middle and sharpest."""
    rows = []
    for name in ("ramp40_flat", "ramp40_k210", "ramp40_k1260"):
        scene = load_scene(SCENES / f"{name}.yaml")
        chosen = plan(scene)
        history = simulate(scene, chosen)
        _, median, _ = seconds(lambda scene=scene, chosen=chosen: simulate(scene, chosen), repeats)
        steps, iterations = states_found(history), int(history.newton_iterations.sum())
        how = (
            f"{chosen.nodes} nodes (half pad), {steps} steps, {iterations} Newton iterations, "
            "meshing included"
        )
        rows.append([f"ramp and hold, {name}", median, "s", "<= 3", median <= 3, repeats, how])
    return rows


def ridges(repeats: int = 3) -> list[list]:
    """A ramp and hold on a pad with inner ridges against the plain one: process time a node."""
    scenes = [load_scene(SCENES / f"{name}.yaml") for name in ("ramp40_flat", "ridged_40_flat")]
    plans = [plan(scene) for scene in scenes]
    ratios = []
    for _ in range(repeats):  # in pairs, so that a busy machine slows both
        plain, ridged = (
            seconds(lambda s=s, p=p: simulate(s, p), 1)[1]
            for s, p in zip(scenes, plans, strict=True)
        )
        ratios.append(ridged / plain)
    nodes = plans[1].nodes / plans[0].nodes
    ratio = statistics.median(ratios) / nodes
    how = (
        f"ramp and hold, flat: {plans[0].nodes} and {plans[1].nodes} nodes (half pad), "
        f"{ratio * nodes:.2f} times the process time"
    )
    return [
        [
            "inner ridges, cost a node over the plain pad's",
            ratio,
            "1",
            "<= 3",
            ratio <= 3,
            repeats,
            how,
        ]
    ]


def strokes() -> list[list]:
    """The five full strokes over the wavy surface, one after the other, and a factorisation on its
    own mesh after each.
    """
    scenes = [load_scene(SCENES / f"stroke_{speed}.yaml") for speed in (1, 5, 10, 20, 40)]
    plans = [plan(scene) for scene in scenes]
    total, histories, ratios = 0.0, [], []
    for scene, chosen in zip(scenes, plans, strict=True):
        start = time.process_time()
        histories.append(simulate(scene, chosen))
        total += (spent := time.process_time() - start)
        plain, data, right = _plain(Simulation(scene, chosen, None).body)
        ratios.append(spent / seconds(partial(_factor_and_solve, plain, data, right), 5)[1])
    steps, iterations, cuts = (
        sum(int(f(h)) for h in histories)
        for f in (states_found, lambda h: h.newton_iterations.sum(), lambda h: h.cutbacks.sum())
    )
    outputs = np.diff(histories[0].stroke_distance.values).max() * 1e3
    nodes = " and ".join(map(str, sorted({chosen.nodes for chosen in plans})))
    how = (
        f"{nodes} nodes, {steps} steps, {cuts} cuts, 80 mm each at 1 to 40 mm/s, outputs every "
        f"{outputs:.2g} mm"
    )
    ratio = statistics.median(ratios)
    return [
        ["five full strokes", total, "s", "<= 240", total <= 240, 1, how],
        [
            "a full stroke / (factor + solve)",
            ratio,
            "1",
            "<= 500",
            ratio <= 500,
            1,
            f"{how}; median of the five, {min(ratios):.0f} to {max(ratios):.0f}; on its own mesh, "
            "in double precision",
        ],
        [
            "iterations a step of a stroke",
            iterations / steps,
            "1",
            "<= 3",
            iterations <= 3 * steps,
            1,
            how,
        ],
    ]


def _factor_and_solve(plain, data, right) -> None:
    plain.factor(data)
    plain.forward(right)


def _plain(body):
    """A solver without any condensation, the tangent's coefficients and a right-hand side of a body
    as it is.
    """
    data, force = body.tangent()
    return (
        condensation(body.space.pattern, np.zeros(0, dtype=np.int64)),
        data.copy(),
        body.space.to_equations(force),
    )


def one_step() -> list[list]:
    """The whole load in one step: Newton iterations, which no machine changes."""
    rows = []
    base = load_scene(SCENES / "ramp40_flat.yaml")
    for stimulus, label in ((Flat(), "flat"), (Cylinder(curvature=1259.84), "1260 1/m")):
        for nu in (0.48, 0.4999):
            history = simulate(_steady(base, stimulus, nu))
            count, cuts = int(history.newton_iterations.sum()), int(history.cutbacks.sum())
            how = f"20 gram-weight, {label}, nu = {nu}, {cuts} cuts"
            rows.append(
                [
                    "full load in one step",
                    count,
                    "iterations",
                    "<= 6",
                    count <= 6 and not cuts,
                    1,
                    how,
                ]
            )
    return rows


def _steady(base: Scene, stimulus, nu: float) -> Scene:
    layers = Layers(
        **{
            name: Layer(youngs_modulus=layer.youngs_modulus, poisson_ratio=nu)
            for name, layer in (
                (name, getattr(base.specimen.layers, name))
                for name in ("epidermis", "dermis", "fat")
            )
        }
    )
    return base.varied(
        {
            "specimen.layers": layers,
            "stimulus": stimulus,
            "motion": (PressToForce(press_to_force=20 * 9.80665e-3, rate=None),),
            "accuracy": Discretisation(element=None, skin_edge=None, steps=1),
        }
    )


def overhead(repeats: int = 5) -> list[list]:
    """What a simulation process costs before it simulates: start, imports, scene, plan, compiled
    kernels.
    """
    code = (
        "import fingerpad, fingerpad.results, fingerpad.simulation as s;"
        f"scene = fingerpad.load_scene({str(SCENES / 'ramp40_flat.yaml')!r}); s.Simulation(scene, "
        "fingerpad.plan(scene), None)"
    )
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", code], check=True)
        times.append(time.perf_counter() - start)
    median = statistics.median(times)
    how = "wall time of a process that imports, plans, meshes and builds the model of ramp40_flat"
    return [["process overhead per job", median, "s", "<= 1.5", median <= 1.5, repeats, how]]


def tactile_sensor(frames: int = 20_000, repeats: int = 5) -> list[list]:
    """Impulse rates from contact pressure, Eqs 4-4 and 5-1: a sample of one receptor, frame by
    frame and as a whole recording.
    """
    x = np.linspace(-4e-3, 4e-3, 113)
    time, pressure = (
        np.arange(frames) * 1e-3,
        1e4 * np.random.default_rng(0).random((frames, len(x))),
    )
    sensor = TactileSensor(x, SpatialSum(r=0.475e-3, per_depth=3.38e4, constant=9.85))

    def step_by_step():
        sensor.reset()
        for t, frame in zip(time, pressure, strict=True):
            sensor.step(t, frame, 1e-3)

    rows = []
    for way, call in (
        ("step by step", step_by_step),
        ("whole recording", lambda: sensor.rates(time, pressure, 1e-3)),
    ):
        median = 1e6 * seconds(call, repeats)[1] / frames
        rows.append(
            [
                f"tactile sensor, {way}",
                median,
                "us per sample",
                "",
                "",
                repeats,
                f"{len(x)} pressures, {frames} frames",
            ]
        )
    return rows


def workflow() -> list[list]:
    """The whole default target from nothing, on two cores (results are made again)."""
    command = [str(Path(sys.executable).parent / "snakemake")]
    start = time.perf_counter()
    subprocess.run([*command, "--forceall", "--cores", "2", "--quiet"], check=True, cwd=ROOT)
    wall = time.perf_counter() - start
    return [
        ["make figures, after set-up", wall, "s", "", "", 1, "wall time, 2 cores, every job rerun"]
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--workflow", action="store_true", help="also time the default workflow target from nothing"
    )
    parser.add_argument("--out", type=Path, default=ROOT / "figures" / "tables" / "speed.csv")
    options = parser.parse_args()
    with threadpool_limits(1):
        rows = [
            *newton_iteration(),
            *ramp_and_hold(),
            *ridges(),
            *strokes(),
            *one_step(),
            *tactile_sensor(),
        ]
    rows += overhead()
    if options.workflow:
        rows += workflow()
    table = pd.DataFrame(rows, columns=COLUMNS)
    table["value"] = [float(f"{value:.4g}") for value in table["value"]]
    made_by = provenance()
    machine = (
        f"{made_by['processor']}, {os.cpu_count()} cores, 1 thread, python {made_by['python']}, "
        + ", ".join(f"{name} {made_by['packages'][name]}" for name in ("numpy", "numba", "mkl"))
    )
    table["machine"] = machine
    print(table.drop(columns="machine").to_markdown(index=False))
    print(machine)
    write_atomically(options.out, lambda path: table.to_csv(path, index=False))
    text = (
        f"{table.drop(columns='machine').to_markdown(index=False)}\n\nMedians, process time "
        f"unless wall is said; {machine}.\n"
    )
    write_atomically(
        options.out.with_suffix(".md"), lambda path: path.write_text(text, encoding="utf-8")
    )


if __name__ == "__main__":
    main()

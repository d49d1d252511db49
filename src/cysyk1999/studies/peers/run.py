"""The same elastic press through public finite element packages and through this one: answers and
cost side by side.

Same mesh of linear quads with one pressure an element, same law (neo-Hooke with U = kappa/2 (J -
1)^2), plane strain and the whole pad, or half of its section turned, pressed to a depth by a plate,
a cylinder or a sphere without friction.
Each package is a process of its own with one thread, finds the contact itself, and takes as few
increments as it converges with; the processes take turns, so that a busy machine slows all. Process
times are user and system time, of all of the process and of its loop alone. The peers are optional:
``pip install -e .[peers]``; one that is not installed has no rows.
"""

from __future__ import annotations

import inspect
import json
import os
import subprocess
import sys
import tempfile
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import yaml

from cysyk1999.publishing.tables import publish_table
from cysyk1999.studies.common.meshes import split
from cysyk1999.studies.common.plans import seconds_of_children
from cysyk1999.studies.peers import with_felupe, with_ngsolve
from fingerpad import load_scene, plan
from fingerpad.results import provenance
from fingerpad.specimen import mesh_for, write_pad
from fingerpad.specimen.materials import Prony, moduli

INCREMENTS = (1, 2, 4, 8, 16)
"""Tried with each package until it converges."""
PRESSES = {
    "plate": ({"shape": "flat"}, 0.8),
    "cylinder 1260 1/m": ({"shape": "cylinder", "curvature": "1260 1/m"}, 0.5),
    "sphere 200 1/m": ({"shape": "sphere", "curvature": "200 1/m"}, 0.8),
}
"""Stimulus and depth (mm); a sphere presses a body of revolution."""
PATIENCE = 600.0
"""Seconds after which a process is taken to diverge."""
PEERS = {"felupe": with_felupe, "ngsolve": with_ngsolve}
_OWN = """
import json, sys, time
from fingerpad.cli import main
from fingerpad.mechanics.stepping import QuasiStatic

plain = QuasiStatic.run
def run(*given):
    start = time.process_time()
    done = plain(*given)
    print(json.dumps({"loop": time.process_time() - start}))
    return done

QuasiStatic.run = run
sys.exit(main(["run", *sys.argv[1:], "--quiet", "--force"]))
"""  # the command line with a clock round its loop


def scenes(name: str, folder: Path, edge: str = "165 um") -> tuple[Path, Path]:
    """Write a press as a scene on the mesh it shares with the peers, as their problem, and as a
    scene on the planner's own mesh.

    Returns
    -------
    tuple of Path
        Both scenes.
    """
    stimulus, depth = PRESSES[name]
    document = {
        "specimen": {"layers": "homogeneous"},
        "stimulus": stimulus,
        "motion": [{"press_to_depth": f"{depth} mm"}],
        "effects": {"finite_strain": "on"},
    }
    if stimulus["shape"] == "sphere":
        document["kinematics"] = "axisymmetric"
    base = load_scene(document | {"accuracy": {"skin_edge": edge}})
    mesh = mesh_for(base, plan(base))
    mesh = split(mesh.right_half() if base.axisymmetric else mesh, "quad4")
    write_pad(mesh, folder / "pad.msh")
    elastic = {"layers": "homogeneous", "prony": "none"}
    same = document | {
        "specimen": {"mesh": "pad.msh"} | elastic,
        "accuracy": {"element": "Q1P0", "steps": 1},
        "effects": {"finite_strain": "on"},
    }
    if not base.axisymmetric:
        same["effects"] = same["effects"] | {"symmetry": "off"}
    own = document | {"specimen": elastic, "accuracy": "thesis"}
    files = folder / "same.yaml", folder / "own.yaml"
    for file, content in zip(files, (same, own), strict=True):
        file.write_text(yaml.safe_dump(content, sort_keys=False))
    layer = base.specimen.layers.fat
    known = moduli(layer.youngs_modulus, layer.poisson_ratio, Prony(), "long_term")
    held = np.concatenate([mesh.curves[curve] for curve in ("bone", "nail")])
    axis = mesh.curves.get("symmetry", np.zeros((0, 2), int))
    np.savez(
        folder / "problem.npz",
        points=mesh.points,
        cells=mesh.cells,
        skin=np.unique(mesh.curves["skin"]),
        held=np.unique(held),
        skin_edges=mesh.curves["skin"],
        held_edges=held,
        axis=np.unique(axis),
        axis_edges=axis,
        turned=base.axisymmetric,
        mu=float(known.shear_long_term),
        bulk=float(known.bulk),
        depth=depth * 1e-3,
        curvature=getattr(base.stimulus, "curvature", 0.0),
    )
    return files


def timed(command: list[str]) -> dict[str, Any] | None:
    """What a process prints last, with its process time as ``process``; None if it fails."""
    before = seconds_of_children()
    threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    how = {"capture_output": True, "text": True, "env": os.environ | threads}
    try:
        done = subprocess.run(command, timeout=PATIENCE, check=True, **how)
    except (subprocess.TimeoutExpired, subprocess.CalledProcessError):
        return None
    spent = seconds_of_children() - before
    return json.loads(done.stdout.strip().splitlines()[-1]) | {"process": spent}


def own(scene: Path) -> dict[str, Any] | None:
    """`fingerpad run` of a scene, timed."""
    out = scene.with_suffix("")
    found = timed([sys.executable, "-c", _OWN, str(scene), "--out", str(out)])
    if found is None:
        return None
    summary = json.loads((out / "summary.json").read_text())
    run, leg = summary["run"], summary["legs"][-1]
    return found | {
        "force": leg.get("force_N_per_m", leg["force_N"]),
        "iterations": run["newton_iterations"],
        "increments": run["steps"],
        "nodes": run["nodes"],
    }


def peer(name: str, folder: Path, increments: int) -> dict[str, Any] | None:
    """What a peer finds with so many increments, timed; None if it does not converge."""
    problem, code = str(folder / "problem.npz"), PEERS[name].__file__
    found = timed([sys.executable, code, problem, str(increments)])
    nodes = len(np.load(problem)["points"])
    return found and found | {"increments": increments, "nodes": nodes}


def enough(name: str, folder: Path) -> int | None:
    """As few of :data:`INCREMENTS` as a peer needs; None if none is enough."""
    return next((n for n in INCREMENTS if peer(name, folder, n)), None)


def study(
    presses: tuple[str, ...] = tuple(PRESSES), repeats: int = 5, edge: str = "165 um"
) -> pd.DataFrame:
    """One row a press and package: force, medians and spreads of process times (s), ratios to this
    package on the same mesh.
    """
    rows = []
    for press in presses:
        with tempfile.TemporaryDirectory() as path:
            folder = Path(path)
            same, free = scenes(press, folder, edge)
            calls = {"fingerpad": partial(own, same), "fingerpad, own mesh": partial(own, free)}
            texts = {"fingerpad": same.read_text(), "fingerpad, own mesh": free.read_text()}
            for name in filter(find_spec, PEERS):
                increments = enough(name, folder)
                package = f"{name} {version(name)}"
                if increments is None:
                    print(f"{press}: {name} does not converge", flush=True)
                    continue
                calls[package] = partial(peer, name, folder, increments)
                texts[package] = inspect.getsource(PEERS[name].press)
            turns = [{name: call() for name, call in calls.items()} for _ in range(repeats)]
            base = [turn["fingerpad"] for turn in turns]
            for name in calls:
                row = {"press": press, "package": name}
                row |= _row([turn[name] for turn in turns], base) | {"lines": _lines(texts[name])}
                rows.append(row | {"repeats": repeats, "machine": provenance()["processor"]})
    return pd.DataFrame(rows)


def _row(runs: list[dict[str, Any]], base: list[dict[str, Any]]) -> dict[str, Any]:
    """Answers and costs of a package's runs beside those of this package in the same turns."""
    force = runs[0]["force"]
    row = {"nodes": runs[0]["nodes"], "force (N/m, of a sphere N)": force}
    row["force off (1)"] = abs(force / base[0]["force"] - 1)
    for part in ("process", "loop"):
        times, own_times = (np.array([run[part] for run in each]) for each in (runs, base))
        row[f"{part} (s)"] = np.median(times)
        row[f"{part} spread (s)"] = np.ptp(times)
        row[f"{part} ratio (1)"] = np.median(times / own_times)
    return row | {name: runs[0][name] for name in ("iterations", "increments")}


def _lines(text: str) -> int:
    """Lines of code."""
    lines = (line.strip() for line in text.splitlines())
    return sum(1 for line in lines if line and not line.startswith(("#", '"""')))


def peers_table(job: SimpleNamespace) -> None:
    """Job: -> `table`."""
    publish_table(study(), job.table[0])

"""The same elastic press through public finite element packages and through this one: answers and
cost side by side.

Same mesh of linear quads with one pressure an element, same law (neo-Hooke with U = kappa/2 (J -
1)^2), plane strain, the whole pad, pressed to a depth by a plate or a cylinder without friction.
Each package is a process of its own with one thread, finds the contact itself, and takes as few
increments as it converges with; the processes take turns, so that a busy machine slows all. Process
times are user and system time, of all of the process and of its loop alone. The peers are optional:
``pip install -e .[peers]``; one that is not installed has no rows.
"""

from __future__ import annotations

import inspect
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import yaml

from cysyk1999.publishing.write import publish_table
from cysyk1999.studies.accuracy.meshes import quarters
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
}
"""Stimulus and depth (mm)."""
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
    """Writes a press as a scene on the mesh it shares with the peers, as their problem, and as one
    on the planner's own mesh.

    Returns:
        Both scenes.
    """
    stimulus, depth = PRESSES[name]
    document = {
        "specimen": {"layers": "homogeneous"},
        "stimulus": stimulus,
        "motion": [{"press_to_depth": f"{depth} mm"}],
        "effects": {"finite_strain": "on"},
    }
    base = load_scene(document | {"accuracy": {"skin_edge": edge}})
    mesh = quarters(mesh_for(base, plan(base)))
    write_pad(mesh, folder / "pad.msh")
    same = document | {
        "specimen": {"mesh": "pad.msh", "layers": "homogeneous", "prony": "none"},
        "accuracy": {"element": "Q1P0", "steps": 1},
        "effects": {"finite_strain": "on", "symmetry": "off"},
    }
    own = document | {"specimen": {"layers": "homogeneous", "prony": "none"}, "accuracy": "thesis"}
    for file, content in (("same.yaml", same), ("own.yaml", own)):
        (folder / file).write_text(yaml.safe_dump(content, sort_keys=False))
    layer = base.specimen.layers.fat
    known = moduli(layer.youngs_modulus, layer.poisson_ratio, Prony(), "long_term")
    held = np.concatenate([mesh.curves[curve] for curve in ("bone", "nail")])
    np.savez(
        folder / "problem.npz",
        points=mesh.points,
        cells=mesh.cells,
        skin=np.unique(mesh.curves["skin"]),
        held=np.unique(held),
        skin_edges=mesh.curves["skin"],
        held_edges=held,
        mu=float(known.shear_long_term),
        bulk=float(known.bulk),
        depth=depth * 1e-3,
        curvature=getattr(base.stimulus, "curvature", 0.0),
    )
    return folder / "same.yaml", folder / "own.yaml"


def timed(command: list[str]) -> dict[str, Any] | None:
    """What a process prints last, with its process time as ``process``; None if it fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    threads = dict.fromkeys(("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, env=os.environ | threads, timeout=PATIENCE
        )
    except subprocess.TimeoutExpired:
        return None
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        return None
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads(done.stdout.strip().splitlines()[-1]) | {"process": spent}


def own(scene: Path) -> dict[str, Any] | None:
    """`fingerpad run` of a scene, timed."""
    out = scene.with_suffix("")
    found = timed([sys.executable, "-c", _OWN, str(scene), "--out", str(out)])
    if found is None:
        return None
    told = json.loads((out / "summary.json").read_text())
    last = told["legs"][-1]
    run = {
        "iterations": told["run"]["newton_iterations"],
        "increments": told["run"]["steps"],
        "nodes": told["run"]["nodes"],
    }
    return found | {"force": last["force_N_per_m"]} | run


def peer(name: str, folder: Path) -> tuple[list[str], dict[str, Any]]:
    """A peer's command with as few increments as it needs, and what it found with them.

    Raises:
        RuntimeError: none of :data:`INCREMENTS` is enough.
    """
    for increments in INCREMENTS:
        command = [
            sys.executable,
            PEERS[name].__file__,
            str(folder / "problem.npz"),
            str(increments),
        ]
        found = timed(command)
        if found is not None:
            return command, found | {"increments": increments}
    raise RuntimeError(f"{name} does not converge with {INCREMENTS[-1]} increments")


def study(
    presses: tuple[str, ...] = tuple(PRESSES), repeats: int = 5, edge: str = "165 um"
) -> pd.DataFrame:
    """One row a press and package: force, medians and spreads of process times (s), ratios to this
    package on the same mesh.
    """
    rows = []
    installed = [name for name in PEERS if _version(name)]
    for press in presses:
        with tempfile.TemporaryDirectory() as path:
            folder = Path(path)
            same, free = scenes(press, folder, edge)
            nodes = len(np.load(folder / "problem.npz")["points"])
            commands, known = {}, {}
            for name in installed:
                try:
                    commands[name], known[name] = peer(name, folder)
                except RuntimeError as error:
                    print(f"{press}: {error}", flush=True)
            calls = {
                "fingerpad": lambda same=same: own(same),
                "fingerpad, own mesh": lambda free=free: own(free),
            }
            calls |= {
                name: (lambda command=command: timed(command)) for name, command in commands.items()
            }
            runs: dict[str, list[dict[str, Any]]] = {name: [] for name in calls}
            for _ in range(repeats):
                for name, call in calls.items():
                    runs[name].append(call())
            base = runs["fingerpad"]
            lines = {name: _lines(inspect.getsource(PEERS[name].press)) for name in installed}
            lines |= {
                name: _lines(file.read_text())
                for name, file in (("fingerpad", same), ("fingerpad, own mesh", free))
            }
            for name, found in runs.items():
                package = f"{name} {_version(name)}" if name in installed else name
                row = {
                    "press": press,
                    "package": package,
                    "nodes": found[0].get("nodes", nodes),
                    "force (N/m)": found[0]["force"],
                }
                row["force off (1)"] = abs(found[0]["force"] / base[0]["force"] - 1)
                for part in ("process", "loop"):
                    times = [run[part] for run in found]
                    row |= {
                        f"{part} (s)": statistics.median(times),
                        f"{part} spread (s)": max(times) - min(times),
                    }
                    row[f"{part} ratio (1)"] = statistics.median(
                        [a[part] / b[part] for a, b in zip(found, base, strict=True)]
                    )
                row |= {
                    "iterations": found[0]["iterations"],
                    "increments": (known.get(name) or found[0])["increments"],
                }
                rows.append(
                    row
                    | {
                        "lines": lines[name],
                        "repeats": repeats,
                        "machine": provenance()["processor"],
                    }
                )
    return pd.DataFrame(rows)


def _lines(text: str) -> int:
    """Lines that say something."""
    return sum(
        1
        for line in text.splitlines()
        if line.strip() and not line.strip().startswith(("#", '"""'))
    )


def _version(name: str) -> str:
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def peers_table(job: SimpleNamespace) -> None:
    """Job: -> `table`."""
    if find_spec("felupe") is None:
        raise ValueError("FElupe is not installed; pip install -e .[peers]")
    publish_table(study(), job.table[0])

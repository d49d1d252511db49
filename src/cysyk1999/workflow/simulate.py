"""What the jobs of simulations do."""

from __future__ import annotations

import json
from itertools import groupby
from pathlib import Path
from types import SimpleNamespace

from fingerpad import healing
from fingerpad.files import write_atomically, write_text
from fingerpad.planning.plan import companion, plan
from fingerpad.results import FIELDS, summary, write_history
from fingerpad.scenes.scene import load_scene
from fingerpad.specimen import mesh_for, read_pad_mesh, write_pad


def simulate(job: SimpleNamespace) -> None:
    """`scenes` -> plan.json, mesh.msh and summary.json beside each of `histories`.

    `accuracies`: as_stated, or what replaces a scene's own. `strides`: 0 for the scene itself; for
    a companion on a coarser mesh the number of time steps merged into one. A companion whose steps
    stay the same, as of steady presses, is not solved again.
    """
    cases = zip(job.scenes, job.accuracies, map(int, job.strides), job.histories, strict=True)
    for (path, accuracy, coarser), group in groupby(cases, lambda case: (*case[:2], case[2] > 0)):
        scene = load_scene(path)
        if accuracy != "as_stated":
            scene = scene.with_accuracy(accuracy)
        own, mesh, solved = plan(scene), None, {}
        for *_, stride, history in group:
            file = Path(history).with_name("mesh.msh")
            how = companion(scene, own, stride) if coarser else own
            how.write(file.with_name("plan.json"))
            if mesh is None:
                built = mesh_for(scene, how)
                write_pad(built, file)
                mesh, content = read_pad_mesh(file, built.regions, built.fixed), file.read_bytes()
            else:
                write_atomically(file, lambda p, content=content: p.write_bytes(content))
            if how.outputs not in solved:
                solved[how.outputs] = healing.simulate(scene, how, mesh=mesh)
            result = solved[how.outputs]
            write_text(file.with_name("summary.json"), json.dumps(summary(result), indent=2) + "\n")
            write_history(result, history)
            print(history, flush=True)


def simulate_fields(job: SimpleNamespace) -> None:
    """`scenes` -> `histories` with the whole field of strain energy at the snapshots of each."""
    for path, history in zip(job.scenes, job.histories, strict=True):
        scene = load_scene(path)
        result = healing.simulate(scene, fields=bool(scene.outputs.snapshots))
        others = [f"snapshot_{name}" for name in FIELDS if name != "strain_energy_density"]
        write_history(result.drop_vars(others, errors="ignore"), history)
        print(history, result.attrs["cost"], flush=True)

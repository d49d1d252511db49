"""Scenes -> plans, meshes and histories of their whole motions, one after the other in one process."""

import json
from pathlib import Path

from fingerpad import load_scene, plan, simulate
from fingerpad.files import write_text
from fingerpad.results import summary, write_history
from fingerpad.specimen import mesh_for, read_pad_mesh, write_pad


def run(job):
    """`scenes`, `accuracies` (as_stated or what replaces it) -> plan.json, mesh.msh, summary.json beside each of `histories`."""
    for path, accuracy, history in zip(job.scenes, job.accuracies, job.histories, strict=True):
        scene = load_scene(path)
        if accuracy != "as_stated":
            scene = scene.with_accuracy(accuracy)
        folder, how = Path(history).parent, plan(scene)
        how.write(folder / "plan.json")
        built, file = mesh_for(scene, how), folder / "mesh.msh"
        write_pad(built, file)
        # what is published is what is solved
        dataset = simulate(scene, how, mesh=read_pad_mesh(file, built.regions, built.fixed))
        write_text(folder / "summary.json", json.dumps(summary(dataset), indent=2) + "\n")
        write_history(dataset, history)
        print(history, flush=True)

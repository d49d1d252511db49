"""Scenes and their companions -> plans, meshes and histories of their whole motions, one after the
other in one process.
"""

import json
from itertools import groupby
from pathlib import Path

from fingerpad import load_scene, plan
from fingerpad.files import write_atomically, write_text
from fingerpad.planning.plan import companion
from fingerpad.results import summary, write_history
from fingerpad.simulation import simulate
from fingerpad.specimen import mesh_for, read_pad_mesh, write_pad


def run(job):
    """`scenes` -> plan.json, mesh.msh, summary.json beside each of `histories`.

    `accuracies`: as_stated or what replaces it. `strides`: 0 of the scene itself, of a companion on
    a coarser mesh how many steps are one; where that leaves as many as before, as of steady
    presses, nothing is solved anew.
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
            if how.outputs not in solved:  # what is published is what is solved
                solved[how.outputs] = simulate(scene, how, mesh=mesh)
            made = solved[how.outputs]
            write_text(file.with_name("summary.json"), json.dumps(summary(made), indent=2) + "\n")
            write_history(made, history)
            print(history, flush=True)

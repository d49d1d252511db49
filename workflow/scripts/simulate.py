"""Simulate a scene on its mesh: simulate.py SCENE.yaml ACCURACY PLAN.json MESH.msh HISTORY.nc"""

import sys

from fingerpad.effects import read_plan
from fingerpad.results import simulate, write_history
from fingerpad.scene import load_scene
from fingerpad.specimen import read_pad_mesh

scene_path, accuracy, plan_path, mesh_path, out = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.model_copy(update={"accuracy": accuracy})
write_history(simulate(scene, read_plan(plan_path), mesh=read_pad_mesh(mesh_path)), out)

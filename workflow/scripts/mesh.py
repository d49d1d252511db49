"""Mesh the pad as a plan says: mesh.py SCENE.yaml ACCURACY PLAN.json MESH.msh"""

import sys

from fingerpad.effects import read_plan
from fingerpad.scene import load_scene
from fingerpad.specimen import mesh_for

scene_path, accuracy, plan_path, out = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.model_copy(update={"accuracy": accuracy})
mesh = mesh_for(scene, read_plan(plan_path))
mesh.write(out)
print(mesh.quality())

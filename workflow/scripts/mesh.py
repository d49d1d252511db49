"""Plan a scene and mesh the pad as the plan says: mesh.py SCENE.yaml ACCURACY PLAN.json MESH.msh"""

import sys

from fingerpad import load_scene, plan
from fingerpad.specimen import mesh_for

scene_path, accuracy, plan_path, mesh_path = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.with_accuracy(accuracy)
chosen = plan(scene)
chosen.write(plan_path)
mesh = mesh_for(scene, chosen)
mesh.write(mesh_path)
print(mesh.quality())

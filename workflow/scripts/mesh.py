"""Mesh the pad as the scene's plan says: mesh.py SCENE.yaml ACCURACY MESH.msh"""

import sys

from fingerpad import load_scene, plan
from fingerpad.specimen import mesh_for

scene_path, accuracy, out = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.with_accuracy(accuracy)
mesh = mesh_for(scene, plan(scene))
mesh.write(out)
print(mesh.quality())

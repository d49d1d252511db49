"""Simulate a scene with another friction: stroke_with_friction.py SCENE.yaml ACCURACY COEFFICIENT MESH.msh HISTORY.nc"""

import sys

from fingerpad import load_scene, plan, simulate
from fingerpad.results import write_history
from fingerpad.specimen import read_pad_mesh

scene_path, accuracy, coefficient, mesh_path, out = sys.argv[1:]
scene = load_scene(scene_path).with_accuracy(accuracy).model_copy(update={"friction": float(coefficient)})
write_history(simulate(scene, plan(scene), mesh=read_pad_mesh(mesh_path)), out)

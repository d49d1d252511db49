"""Simulate a scene on its mesh: simulate.py SCENE.yaml ACCURACY MESH.msh HISTORY.nc"""

import sys

from fingerpad import load_scene, plan, simulate
from fingerpad.results import write_history
from fingerpad.specimen import read_pad_mesh

scene_path, accuracy, mesh_path, out = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.with_accuracy(accuracy)
write_history(simulate(scene, plan(scene), mesh=read_pad_mesh(mesh_path)), out)

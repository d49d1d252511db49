"""Choose effects and discretisation of a scene: plan.py SCENE.yaml ACCURACY PLAN.json"""

import sys

from fingerpad import load_scene, plan

scene_path, accuracy, out = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.with_accuracy(accuracy)
plan(scene).write(out)

"""Choose effects and discretisation of a scene: plan.py SCENE.yaml ACCURACY PLAN.json"""

import sys

from fingerpad.effects import plan
from fingerpad.scene import load_scene

scene_path, accuracy, out = sys.argv[1:]
scene = load_scene(scene_path)
if accuracy != "as_stated":
    scene = scene.model_copy(update={"accuracy": accuracy})
plan(scene).write(out)

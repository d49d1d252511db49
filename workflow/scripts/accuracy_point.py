"""Run one point of the study of accuracy: accuracy_point.py POINT SCENE.yaml RECORD.json"""

import json
import sys

from fingerpad import load_scene
from fingerpad.files import write_text
from fingerpad.studies.accuracy import measure, points

name, scene, out = sys.argv[1:]
write_text(out, json.dumps(measure(points()[name], load_scene(scene)), indent=1) + "\n")

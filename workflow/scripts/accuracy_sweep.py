"""Run a sweep of the study of accuracy: accuracy_sweep.py SWEEP SCENE.yaml RECORDS.json"""

import json
import sys

from fingerpad import load_scene
from fingerpad.files import write_text
from fingerpad.studies.accuracy.run import measure_all, sweeps

name, scene, out = sys.argv[1:]
records = []
for record in measure_all(sweeps()[name], load_scene(scene)):
    print(record["name"], f"{record['cost']['cpu_s'][0]:.1f} s", record["failure"], flush=True)
    records.append(record)
write_text(out, json.dumps(records, indent=1) + "\n")

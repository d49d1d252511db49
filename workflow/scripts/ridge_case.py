"""Simulate a case of the study of ridges: ridge_case.py SCENE.yaml HEIGHT_FRICTION_MESH HISTORY.nc"""

import sys

from fingerpad import load_scene
from fingerpad.results import write_history
from fingerpad.studies.ridges import Case, run_case

scene, case, out = sys.argv[1:]
write_history(run_case(load_scene(scene), Case.named(case)), out)

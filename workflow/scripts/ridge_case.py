"""Simulate cases of the study of ridges, named by folders: ridge_case.py SCENE.yaml HEIGHT_FRICTION_MESH/HISTORY.nc ..."""

import sys
from pathlib import Path

from fingerpad import load_scene
from fingerpad.results import write_history
from fingerpad.studies.ridges.run import Case, run_case

scene, *histories = sys.argv[1:]
for history in map(Path, histories):
    write_history(run_case(load_scene(scene), Case.named(history.parent.name)), history)

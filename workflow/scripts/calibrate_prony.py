"""Fit the Prony series: calibrate_prony.py RELAXATION.csv SCENE.yaml ACCURACY MESH.msh OUT/prony.csv HISTORY.nc ...

Writes prony.csv and prony_estimates.csv side by side. Simulates the scene once, with the series fitted first.
"""

import sys
from pathlib import Path

from fingerpad import load_scene, plan, simulate
from fingerpad.measures.inputs import read_results
from fingerpad.publishing.write import write_frame
from fingerpad.reference_data import read_relaxation
from fingerpad.specimen import read_pad_mesh
from fingerpad.studies.calibration.relaxation import study, with_series

relaxation, scene_path, accuracy, mesh_path, out, *paths = sys.argv[1:]
scene, mesh = load_scene(scene_path), read_pad_mesh(mesh_path)
if accuracy != "as_stated":
    scene = scene.with_accuracy(accuracy)
how = plan(scene)


def full(prony):
    return simulate(with_series(scene, prony), how, mesh=mesh).force.values * scene.specimen.contact_length


histories, _, _ = read_results(paths)
names = ("calibration_plate", "calibration_instantaneous", "calibration_ramp_hold")
result = study(*(histories[name] for name in names), read_relaxation(relaxation), full)
write_frame(result.prony, Path(out))
write_frame(result.estimates, Path(out).with_name("prony_estimates.csv"))

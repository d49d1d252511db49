"""Scenes of figures on finer meshes, by which the errors that figures state are judged
(`cysyk1999.studies.accuracy.shown`).
"""

from __future__ import annotations

from types import SimpleNamespace

from fingerpad.healing import simulate
from fingerpad.planning.plan import companion, plan
from fingerpad.results import write_history
from fingerpad.scenes.scene import load_scene

FINER = 0.5
"""Edges of the finer runs over those of the scenes."""
MADE_FINER = (
    "stroke_",
    "ramp40_",
    "ramp150_",
    "press10_",
    "press15_",
    "step_sub",
    "plate_",
    "ridged_stroke_",
    "ridged_40_",
)
"""First letters of the scenes that are made finer: all of figures but chapter 3's and the
homogeneous pad.
"""


def accuracy_finer(job: SimpleNamespace) -> None:
    """Job: `scenes` -> `histories`."""
    for scene, history in zip(map(load_scene, job.scenes), job.histories, strict=True):
        write_history(simulate(scene, companion(scene, plan(scene), coarser=FINER)), history)
        print(history, flush=True)

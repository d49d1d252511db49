"""A stroke, as a draft -> its histories with other coefficients of friction in place of the
scene's.
"""

from fingerpad import load_scene, plan
from fingerpad.results import write_history
from fingerpad.simulation import simulate


def run(job):
    """`scene`, `coefficients` -> `histories`, one for each coefficient."""
    stroke = load_scene(job.scene[0]).with_accuracy("draft")
    for coefficient, history in zip(job.coefficients, job.histories, strict=True):
        scene = stroke.varied({"friction": float(coefficient)})
        write_history(simulate(scene, plan(scene)), history)

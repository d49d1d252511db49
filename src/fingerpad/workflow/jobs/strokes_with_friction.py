"""A stroke on its coarse mesh -> its histories with other coefficients of friction in place of the scene's."""

from fingerpad import load_scene, plan
from fingerpad.results import write_history
from fingerpad.simulation import solve
from fingerpad.specimen import read_pad_mesh


def run(job):
    """`scene`, `accuracy`, `mesh`, `coefficients` -> `histories`, one for each coefficient."""
    stroke, mesh = load_scene(job.scene[0]).with_accuracy(job.accuracy[0]), read_pad_mesh(job.mesh[0])
    for coefficient, history in zip(job.coefficients, job.histories, strict=True):
        scene = stroke.varied({"friction": float(coefficient)})
        write_history(solve(scene, plan(scene), mesh=mesh), history)

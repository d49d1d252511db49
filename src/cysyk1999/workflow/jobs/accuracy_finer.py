"""Scenes -> histories on meshes with half the edges, with their own steps."""

from cysyk1999.studies.accuracy.shown import FINER
from fingerpad import load_scene, plan, simulate
from fingerpad.planning.plan import companion
from fingerpad.results import write_history


def run(job):
    """`scenes` -> `histories`."""
    for scene, history in zip(map(load_scene, job.scenes), job.histories, strict=True):
        write_history(simulate(scene, companion(scene, plan(scene), coarser=FINER)), history)
        print(history, flush=True)

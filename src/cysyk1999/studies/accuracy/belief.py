"""Does a run know its error? Scenes that the study of accuracy has not seen, at several accuracies.

The truth is a run on the preset "fine", made finer in narrow contacts; it has an error of its own.
A run knows its error if the error it states covers the one it has
(:func:`cysyk1999.studies.accuracy.compare.difference`).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import yaml

from cysyk1999.publishing.tables import write_frame
from cysyk1999.studies.accuracy.compare import FINEST, belief, looked_at, resized
from cysyk1999.studies.common.documents import CONFIG
from cysyk1999.studies.common.plans import finer
from fingerpad import load_scene
from fingerpad.healing import simulate
from fingerpad.planning.plan import Plan, plan
from fingerpad.scenes.scene import Scene

LEVELS = ("draft", 0.05, 0.02)
"""Accuracies that are asked for."""
OUTSIDE: dict[str, dict[str, Any]] = yaml.safe_load(
    (CONFIG / "accuracy" / "outside.yaml").read_text(encoding="utf-8")
)
"""Scenes outside the study by what is different in them."""
STILL_FINER = 1.4
"""By how much the edges of a stroke's truth are shorter than the preset's, which is what a tight
tolerance comes to itself.
"""


def outside(base: Scene) -> dict[str, Scene]:
    """The scenes of :data:`OUTSIDE` with the receptors that are looked at, to be run finely."""
    scene = looked_at(base).varied({"outputs.snapshots": ()}).with_accuracy("fine")
    return {name: scene.varied(changes) for name, changes in OUTSIDE.items()}


def finest(scene: Scene) -> Plan:
    """The plan of the truth: the preset, in the contact at least 20 elements to its half width; of
    a stroke still finer.
    """
    chosen = plan(scene)
    if chosen.strokes:
        return finer(chosen, STILL_FINER)
    half_width = chosen.contact.half_width
    edge = half_width / 20
    if edge >= chosen.mesh_size.skin_edge:
        return chosen
    focus = tuple((float(x), edge) for x in np.linspace(0.0, 1.2 * half_width, 13))
    return replace(resized(chosen, focus=focus, skin_radial_edge=edge), contact_edge=edge)


def beliefs(scene: Scene, name: str, levels: tuple = LEVELS) -> list[dict[str, Any]]:
    """Run a scene at every level and as :func:`finest`: what each states and how wrong it is."""
    truth = simulate(scene, finest(scene))
    rows = []
    for level in levels:
        run = simulate(scene.with_accuracy(level))
        rows.append({"scene": name, "accuracy": str(level)} | belief(run, truth))
    return [*rows, {"scene": name, "accuracy": FINEST} | belief(truth, None)]


def accuracy_belief(job: SimpleNamespace) -> None:
    """Job: `names` of the scenes, `scene` that they vary -> `rows` (CSV), one for each scene."""
    scenes = outside(load_scene(job.scene[0]))
    for name, path in zip(job.names, job.rows, strict=True):
        write_frame(pd.DataFrame(beliefs(scenes[name], name)), Path(path))

"""Errors of strokes on meshes and with steps of several lengths, over plates and over waves.

The strokes are drawn at random. Each run is compared with one on the finest mesh with steps half as
long (:func:`~cysyk1999.studies.accuracy.compare.difference`), at the end of the press before, on
which friction leaves its mark, and over the way. Errors do not fall evenly: they depend on where a
corner of the waves lies between nodes, and at which output the contact leaves the centre. So two
numbers count: the largest error of all strokes, and the root of their mean square, which a longer
stroke comes nearer to, for it has as much in it as many of these.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import cycle
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd

from cysyk1999.publishing.tables import publish_table, read_frame, write_frame
from cysyk1999.studies.accuracy.compare import difference
from cysyk1999.studies.accuracy.drawn import DRAWN, SCENES
from cysyk1999.studies.accuracy.run import DEFAULT_ROWS, DEFAULT_STEPS
from cysyk1999.studies.common.documents import FLAT, scene_of
from fingerpad.healing import simulate
from fingerpad.planning.errors import PLATES, WAVES
from fingerpad.planning.plan import Plan, plan
from fingerpad.planning.rules import RULES
from fingerpad.scenes.scene import Scene

MESHES, STEPS = (2, 4, 7, 10, 14), (10, 20, 40)
"""Elements across the epidermis, with the default's steps of a leg; and steps of a leg, on the
default's mesh.
"""
FINEST = 22, 40
"""Elements and steps of the truth."""
STROKED_OVER = PLATES, WAVES
RATE, SPEEDS = "40 gf/s", ("5 mm/s", "10 mm/s", "20 mm/s", "40 mm/s")
"""With which the same are pressed and, one after the other, stroked, where the skin relaxes."""
LARGEST, MEAN = "largest", "root mean square"
"""Columns: of the errors of all strokes."""


def strokes(over: str) -> dict[str, Scene]:
    """The strokes over plates or over waves, by name: those over waves as they are drawn, or over a
    plate instead, steady ones, and then all in time.
    """
    change = {"stimulus": FLAT} if over == PLATES else {}
    waves = {f"22_{name}": each for name, each in SCENES.items() if each["class"] == "wavy"}
    waves |= {f"23_{name}": each for name, each in DRAWN["strokes"].items()}
    found = {name: document | change for name, document in waves.items()}
    for (name, document), speed in zip(list(found.items()), cycle(SPEEDS), strict=False):
        press, slide = document["motion"]
        timed = [press | {"rate": RATE}, slide | {"speed": speed, "keep": "force"}]
        found[f"{name}_timed"] = document | {"motion": timed}
    for document in found.values():
        document.pop("class", None)
    return {name: scene_of(document, name) for name, document in found.items()}


def discretised(scene: Scene, rows: int, steps: int) -> Plan:
    """The plan of a scene with so many elements across the epidermis and steps a leg, elsewhere as
    tolerances are met.
    """
    known = RULES.errors
    these = replace(known, mesh={rows: known.mesh[rows]}, time={steps: known.time[steps]})
    only = replace(RULES, errors=these, least_steps_stroked=steps)
    once = scene.with_accuracy({"tolerance": 0.05, "once": True})
    return replace(plan(once, only), asked_error=None)


def stroke_errors(over: str, name: str, scene: Scene) -> Iterator[dict[str, object]]:
    """A row a mesh and a length of steps: relative error, and the quantity that has it."""
    truth = simulate(scene, discretised(scene, *FINEST))
    each = [*((rows, DEFAULT_STEPS) for rows in MESHES), *((DEFAULT_ROWS, n) for n in STEPS)]
    for rows, steps in dict.fromkeys(each):
        off, worst = difference(simulate(scene, discretised(scene, rows, steps)), truth)
        row = {"over": over, "scene": name, "rows": rows, "steps": steps}
        yield row | {"error": off, "worst quantity": worst}


def strokes_table(found: pd.DataFrame) -> pd.DataFrame:
    """Relative errors by mesh, and what fewer or more steps than the default's add to them.

    ``found`` has the rows of :func:`stroke_errors` of all scenes. No error is below that of a finer
    mesh or shorter step.
    """
    errors = found.groupby(["over", "rows", "steps"])["error"]
    of_all = pd.DataFrame(
        {LARGEST: errors.max(), MEAN: errors.agg(lambda each: np.sqrt(np.mean(each**2)))}
    ).unstack("over")
    mesh = of_all.xs(DEFAULT_STEPS, level="steps").rename_axis("count")
    steps = (
        (of_all.xs(DEFAULT_ROWS, level="rows") - mesh.loc[DEFAULT_ROWS])
        .clip(lower=0.0)
        .rename_axis("count")
    )
    both = pd.concat(
        {"mesh": mesh[::-1].cummax()[::-1], "steps": steps[::-1].cummax()[::-1]}, names=["kind"]
    )
    both.columns = [f"{over}, {which}" for which, over in both.columns]
    return both.map(lambda error: float(f"{error:.2g}")).reset_index()


def accuracy_strokes(job: SimpleNamespace) -> None:
    """Job: `over`, what is stroked -> `rows` (CSV) of all strokes."""
    over = job.over[0]
    rows = [
        row for name, scene in strokes(over).items() for row in stroke_errors(over, name, scene)
    ]
    write_frame(pd.DataFrame(rows), Path(job.rows[0]))


def accuracy_strokes_table(job: SimpleNamespace) -> None:
    """Job: `parts` (CSV), one below the other -> `table`."""
    publish_table(
        strokes_table(pd.concat([read_frame(Path(part)) for part in job.parts], ignore_index=True)),
        job.table[0],
    )

"""Does a run know its error under any stimulus? Scenes drawn at random outside the cylinders.

The truth is the same scene on the finest run's mesh made finer still; of a true edge, where nodes
are held or are not, that of a rounding by a hundredth of the half width.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.compare import FINEST, QUANTITIES, belief, resized
from cysyk1999.studies.accuracy.own import finer_own, unseen, write_own
from cysyk1999.studies.accuracy.ridges import TRUTH
from cysyk1999.studies.common.documents import FLAT, cylinder, force, scene_of
from cysyk1999.studies.common.meshes import pad_of
from cysyk1999.studies.common.plans import OutOfTime, finer, time_limit
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.plan import Plan, plan
from fingerpad.scenes.scene import Bar, Sampled, Scene
from fingerpad.simulation import simulate
from fingerpad.specimen.files import write_pad
from fingerpad.specimen.pad import all_over
from fingerpad.specimen.ridges import wave_of

IN_TURN = ("bar", "fillet", "line", "sampled", "wavy", "ridges", "external", "force")
CLASSES = (*IN_TURN, "corners", "own")
SEED, SCENES, CORNERED, OWN = 22, 60, 20, 20
"""Of the scenes drawn. Seeds 20 and 21 set the rules of edges, fillets, waves and measured
profiles. Of 22, unseen then, 59 were covered and a bar's true edge believed 11.0 % where it was
wrong by 11.3: its floor became 15 %, and nothing else changed. On the inferred pad the same rules
covered 58 of them, which raised the rules' ``safety`` and the factor of measured profiles
(``bumps``): 60 of 60 is fitted. Strokes over waves had a factor as well while their errors were
those of their last moment; as root mean squares over the way they need none. Of the strokes of seed
23, unseen, one in seven was missed: steps of steady ones did not count; of eleven of seed 24,
unseen after that, ten were covered, and one was wrong by 3.1 % and believed 2.8. The last are
profiles with corners: wedges, bumps of straight lines, and curves sampled at a few points and at
many.
"""
LEVELS = (0.1, 0.05)
"""Accuracies that are asked for, one drawn for each scene; an external mesh is what it is."""
FINER, FINER_STILL, ROUNDED = 1.7, 2.5, 200
"""By how much the truth's edges are shorter than the run's, of strokes and large meshes and of
others; among ridges they are shorter still; a true edge is rounded by the width over this.
"""
PATIENCE = 60.0
"""s of process time that the truth of a true edge may take, before it is rounded more."""
BESIDE = 6, (0.7, 1.1), 0.24
"""Receptors drawn beside ridges: their number, and the bounds of their depths and of their offsets
to either side, mm.
"""
REACH = 8e-3
"""m, that sampled profiles reach to either side."""


def drawn(seed: int = SEED, count: int = SCENES) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Name, class and document of each scene, the classes in turn, those with corners and meshes of
    one's own last; what an external mesh is made of stands under ``made``.
    """
    draw = np.random.default_rng(seed)
    for number in range(count):
        kind = IN_TURN[number % len(IN_TURN)]
        yield f"{kind}_{number}", kind, _in_turn(draw, kind, np.random.default_rng((seed, number)))
    for number in range(CORNERED):
        corners = _cornered(np.random.default_rng((seed, count + number)), number)
        yield f"corners_{number}", "corners", corners
    yield from unseen(seed, OWN)


def _between(draw: np.random.Generator) -> Callable[[float, float], float]:
    """Numbers of four digits between bounds, evenly in their logarithms."""
    return lambda low, high: float(f"{np.exp(draw.uniform(np.log(low), np.log(high))):.4g}")


def _in_turn(draw: np.random.Generator, kind: str, own: np.random.Generator) -> dict[str, Any]:
    """A document; the order of the draws decides what a seed gives.

    What came to the scenes later is drawn by a generator of its own.
    """
    between = _between(draw)

    def pick(*values):
        return values[draw.integers(len(values))]

    def load(low, high):
        return [force(between(low, high), between(20, 100) if draw.integers(3) == 0 else None)]

    def bar(rounded):
        width = between(0.6, 4)
        fillet = float(f"{draw.uniform(0.05, 0.6) * width / 2:.3g}") if rounded else 0
        return {"shape": "bar", "width": f"{width} mm", "fillet": f"{fillet} mm"}

    document: dict[str, Any] = {
        "motion": load(3, 30),
        "stimulus": pick(FLAT, cylinder(between(20, 600))),
    }
    document["accuracy"] = LEVELS[0] if kind in ("wavy", "ridges") else pick(*LEVELS)
    if kind in ("bar", "fillet"):
        document["stimulus"] = bar(kind == "fillet")
    elif kind == "line":
        document |= {"stimulus": {"shape": "line"}, "motion": load(1, 20)}
    elif kind == "sampled":
        x = np.linspace(-REACH, REACH, 2 * round(REACH / (1e-6 * between(10, 40))) + 1)
        y = between(20, 400) * x**2 / 2
        for _ in range(draw.integers(1, 4)):
            wave = between(0.6e-3, 4e-3)
            height = between(0.003, 0.012) * wave
            y = y + height * np.cos(2 * np.pi * x / wave + pick(0.0, np.pi, draw.uniform(0, 6)))
        document["stimulus"] = _sampled(x, y)
    elif kind == "wavy":
        curvatures = [f"{between(60, 500)} 1/m" for _ in range(2)]
        ends = {"lead_in": f"{between(1, 3)} mm", "run_out": "5 mm"}
        document["stimulus"] = {"shape": "wavy", "curvatures": curvatures, **ends}
        document["motion"] = [force(between(5, 25)), {"slide": f"{between(1, 2.5)} mm"}]
        document["friction"] = pick(0.0, 0.3)
    elif kind == "ridges":
        inner = {"height": f"{between(50, 150)} um", "phase": pick("tip", "valley")}
        document["specimen"] = {"ridges": {"inner": inner}}
        document["stimulus"] = pick(FLAT, cylinder(between(20, 600)), bar(True))
        document["outputs"] = {"receptors": _beside(own)}
        document["accuracy"] = float(own.choice((*LEVELS, 0.02)))
    elif kind == "external":
        element = between(80e-6, 300e-6), pick("quad9", "quad4", "tri6")
        document["made"] = dict(zip(("edge", "element"), element, strict=True))
    elif kind == "force":
        document["motion"] = pick(load(1e-4, 0.03), load(50, 120))
    return document


def _sampled(x: np.ndarray, y: np.ndarray) -> Sampled:
    return Sampled(csv=Path("drawn.csv"), x=tuple(x), y=tuple(y - y.min()))


def _cornered(draw: np.random.Generator, number: int) -> dict[str, Any]:
    """A profile with corners in a document; every fourth is a smooth one sampled densely, which has
    none.
    """
    bend = float(np.exp(draw.uniform(np.log(20), np.log(400))))
    if number % 4 == 0:  # a wedge
        x = np.array([-REACH, 0.0, REACH])
        y = np.abs(x) * draw.uniform(0.1, 0.6)
    elif number % 4 == 1:  # a bump with a flat top on a curve
        top, foot = draw.uniform(0.2e-3, 0.8e-3), draw.uniform(0.3e-3, 1e-3)
        high = draw.uniform(0.05e-3, 0.3e-3)
        x = np.array([-REACH, -top - foot, -top, top, top + foot, REACH])
        y = np.array([high, high, 0.0, 0.0, high, high]) + 0.1 * bend * x**2
    else:
        x = np.linspace(-REACH, REACH, int(draw.integers(15, 40)) if number % 4 == 2 else 1601)
        y = bend * x**2 / 2
    motion = [force(_between(draw)(3, 30))]
    accuracy = float(draw.choice(LEVELS))
    return {"motion": motion, "stimulus": _sampled(x, y), "accuracy": accuracy}


def _beside(draw: np.random.Generator) -> dict[str, list[str]]:
    """Receptors beside ridges, in a document."""
    count, depths, aside = BESIDE
    return {
        "depths": [f"{depth:.3f} mm" for depth in np.sort(draw.uniform(*depths, count))],
        "offsets": [f"{offset:.3f} mm" for offset in np.sort(draw.uniform(-aside, aside, 2))],
    }


def truth_of(scene: Scene, last: Plan) -> xr.Dataset:
    """History of the truth, beside runs the finest of which was solved as ``last`` says."""
    if last.unbounded and isinstance(scene.stimulus, Bar):
        return _of_true_edge(scene)
    ridges = scene.specimen.ridges if last.effects["ridges"].on else None
    light = last.effects["symmetry"].on and last.nodes <= 5000
    made = finer(last, FINER_STILL if light or ridges else FINER)
    if ridges:  # of which a mesh has some elements however coarse it is
        focus = all_over(1.5 * ridges.inner.pitch, 3 * wave_of(ridges.inner) / TRUTH)
        made = resized(made, focus=(*made.mesh_size.focus, *focus))
    return simulate(scene, made)


def _of_true_edge(scene: Scene) -> xr.Dataset:
    """The truth of a bar's true edge: that of a small rounding; of twice or four times that where
    it is too sharp, or takes too long.
    """
    width = scene.stimulus.width
    for share in (1, 2, 4, 8):
        stimulus = Bar(width=width, fillet=share * width / ROUNDED)
        sharp = scene.varied({"stimulus": stimulus, "accuracy": 0.05})
        last = share == 8
        try:
            with time_limit(10 * PATIENCE if share > 2 else PATIENCE):
                return simulate(sharp, finer(plan(sharp), 1.5))
        except (NonConvergence, OutOfTime):
            if last:
                raise


def beliefs(name: str, kind: str, document: dict[str, Any], folder: Path) -> list[dict[str, Any]]:
    """Run a drawn scene as it is and as finely as the truth: a row each. ``folder`` takes an
    external mesh.
    """
    runs = _on_own if "own" in document else _of_any
    run, truth, quantities = runs(name, dict(document), folder)
    asked = {"scene": name, "class": kind}
    rows = []
    for accuracy, history, other in (
        (str(document["accuracy"]), run, truth),
        (FINEST, truth, None),
    ):
        count = len(json.loads(history.attrs["runs"]))
        row = belief(history, other, quantities, runs=count)
        rows.append(asked | {"accuracy": accuracy} | row)
    return rows


Runs = tuple[xr.Dataset, xr.Dataset, list[str]]


def _of_any(name: str, document: dict[str, Any], folder: Path) -> Runs:
    """History and truth of a scene, and the quantities that have bounds in it."""
    made, stimulus = document.pop("made", None), document["stimulus"]
    sampled = isinstance(stimulus, Sampled)
    scene = asked = scene_of(document | ({"stimulus": FLAT} if sampled else {}), name)
    if sampled:
        scene = asked = scene.varied({"stimulus": stimulus})
    if made:
        edge, path = made["edge"], folder / f"{name}.msh"
        mesh = pad_of(scene, made["element"], skin_edge=edge, layer_edge=0.9 * edge)
        write_pad(mesh, path)
        asked = scene_of(document | {"specimen": {"mesh": str(path)}}, name)
    run = simulate(asked)
    if made:
        last = plan(scene.with_accuracy(0.02))
    else:
        last = Plan.from_dict(json.loads(run.attrs["plan"]))
    unbounded = {"peak_pressure": run.attrs["singular"], "centre_pressure": last.unbounded.centre}
    bounded = [name for name in QUANTITIES if not unbounded.get(name)]
    return run, truth_of(scene, last), bounded


def _on_own(name: str, document: dict[str, Any], folder: Path) -> Runs:
    """The same on a mesh of one's own; the truth is on a finer mesh of the same shape."""
    own, path, histories = document.pop("own"), folder / f"{name}.msh", []
    document["specimen"] = document["specimen"] | {"mesh": str(path)}
    for made in (own, finer_own(own)):
        write_own(made, path)
        histories.append(simulate(scene_of(document, name)))
    return (*histories, list(QUANTITIES))


def accuracy_drawn(job: SimpleNamespace) -> None:
    """Job: `kind`, the class -> `rows` (CSV) of all its scenes."""
    with tempfile.TemporaryDirectory() as folder:
        scenes = [(name, kind, document) for name, kind, document in drawn() if kind == job.kind[0]]
        rows = [row for scene in scenes for row in beliefs(*scene, Path(folder))]
    write_frame(pd.DataFrame(rows), Path(job.rows[0]))

"""Scenes drawn at random outside the cylinders, by class of stimulus, to ask whether runs know
their error there as well.

The classes: bars with true edges, filleted bars, lines, sampled profiles, strokes over waves, pads
with inner ridges, external meshes, very small and large forces, profiles with corners, and meshes
of one's own as gmsh makes them. The truth is the same scene on the finest run's mesh made finer
still; of a true edge, where nodes are held or are not, that of a rounding by a hundredth of the
half width.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.belief import FINEST, QUANTITIES, difference, finer, record
from cysyk1999.studies.accuracy.own import finer_own, unseen, write_own
from cysyk1999.studies.accuracy.ridges import TRUTH
from cysyk1999.studies.accuracy.run import split
from cysyk1999.studies.stability.hard_cases import FLAT, cylinder, force, scene_of
from fingerpad.planning.plan import Plan, plan
from fingerpad.scenes.scene import Bar, Sampled, Scene
from fingerpad.specimen.build import build_pad_mesh
from fingerpad.specimen.files import write_pad
from fingerpad.specimen.pad import all_over
from fingerpad.specimen.ridges import wave_of

CLASSES = (
    "bar",
    "fillet",
    "line",
    "sampled",
    "wavy",
    "ridges",
    "external",
    "force",
    "corners",
    "own",
)
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
HEAVY = ("wavy", "ridges")
"""Classes tried at the first of these only, or at one of their own."""
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


def drawn(seed: int = SEED, count: int = SCENES) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Name, class and document of each scene, the classes in turn; what an external mesh is made of
    stands under ``made``.
    """
    draw = np.random.default_rng(seed)

    def between(low, high):
        return float(f"{np.exp(draw.uniform(np.log(low), np.log(high))):.4g}")

    def pick(*values):
        return values[draw.integers(len(values))]

    def load(low, high):
        return [force(between(low, high), between(20, 100) if draw.integers(3) == 0 else None)]

    def bar(rounded):
        width = between(0.6, 4)
        fillet = float(f"{draw.uniform(0.05, 0.6) * width / 2:.3g}") if rounded else 0
        return {"shape": "bar", "width": f"{width} mm", "fillet": f"{fillet} mm"}

    for number in range(count):
        kind = CLASSES[number % (len(CLASSES) - 2)]
        document: dict[str, Any] = {
            "motion": load(3, 30),
            "stimulus": pick(FLAT, cylinder(between(20, 600))),
        }
        document["accuracy"] = pick(*LEVELS) if kind not in HEAVY else LEVELS[0]
        if kind in ("bar", "fillet"):
            document["stimulus"] = bar(kind == "fillet")
        elif kind == "line":
            document |= {"stimulus": {"shape": "line"}, "motion": load(1, 20)}
        elif kind == "sampled":
            x = np.linspace(-8e-3, 8e-3, 2 * round(8e-3 / (1e-6 * between(10, 40))) + 1)
            y = between(20, 400) * x**2 / 2
            for _ in range(draw.integers(1, 4)):
                wave = between(0.6e-3, 4e-3)
                y = y + between(0.003, 0.012) * wave * np.cos(
                    2 * np.pi * x / wave + pick(0.0, np.pi, draw.uniform(0, 6))
                )
            document["stimulus"] = Sampled(csv=Path("drawn.csv"), x=tuple(x), y=tuple(y - y.min()))
        elif kind == "wavy":
            curvatures = [f"{between(60, 500)} 1/m" for _ in range(2)]
            document["stimulus"] = {
                "shape": "wavy",
                "curvatures": curvatures,
                "lead_in": f"{between(1, 3)} mm",
                "run_out": "5 mm",
            }
            document |= {
                "motion": [force(between(5, 25), None), {"slide": f"{between(1, 2.5)} mm"}],
                "friction": pick(0.0, 0.3),
            }
        elif kind == "ridges":
            document["specimen"] = {
                "ridges": {
                    "inner": {"height": f"{between(50, 150)} um", "phase": pick("tip", "valley")}
                }
            }
            document["stimulus"] = pick(FLAT, cylinder(between(20, 600)), bar(True))
            own = np.random.default_rng((seed, number))  # these came to the scenes later
            document |= {
                "outputs": {"receptors": _beside(own)},
                "accuracy": float(own.choice((*LEVELS, 0.02))),
            }
        elif kind == "external":
            document["made"] = {
                "edge": between(80e-6, 300e-6),
                "element": pick("quad9", "quad4", "tri6"),
            }
        elif kind == "force":
            document["motion"] = pick(load(1e-4, 0.03), load(50, 120))
        yield f"{kind}_{number}", kind, document
    for number in range(CORNERED):
        yield (
            f"corners_{number}",
            "corners",
            _cornered(np.random.default_rng((seed, count + number)), number),
        )
    yield from unseen(seed, OWN)


def _cornered(draw: np.random.Generator, number: int) -> dict[str, Any]:
    """A profile with corners in a document; every fourth is a smooth one sampled densely, which has
    none.
    """
    bend, reach = float(np.exp(draw.uniform(np.log(20), np.log(400)))), 8e-3
    if number % 4 == 0:  # a wedge
        x = np.array([-reach, 0.0, reach])
        y = np.abs(x) * draw.uniform(0.1, 0.6)
    elif number % 4 == 1:  # a bump with a flat top on a curve
        top, foot, high = (
            draw.uniform(0.2e-3, 0.8e-3),
            draw.uniform(0.3e-3, 1e-3),
            draw.uniform(0.05e-3, 0.3e-3),
        )
        x = np.array([-reach, -top - foot, -top, top, top + foot, reach])
        y = np.array([high, high, 0.0, 0.0, high, high]) + 0.1 * bend * x**2
    else:
        x = np.linspace(-reach, reach, int(draw.integers(15, 40)) if number % 4 == 2 else 1601)
        y = bend * x**2 / 2
    stimulus = Sampled(csv=Path("drawn.csv"), x=tuple(x), y=tuple(y - y.min()))
    motion = [force(float(f"{np.exp(draw.uniform(np.log(3), np.log(30))):.4g}"), None)]
    return {"motion": motion, "stimulus": stimulus, "accuracy": float(draw.choice(LEVELS))}


def _beside(draw: np.random.Generator) -> dict[str, list[str]]:
    """Receptors beside ridges, in a document."""
    count, depths, aside = BESIDE
    return {
        "depths": [f"{depth:.3f} mm" for depth in np.sort(draw.uniform(*depths, count))],
        "offsets": [f"{offset:.3f} mm" for offset in np.sort(draw.uniform(-aside, aside, 2))],
    }


def truth_of(scene: Scene, last: Plan) -> Any:
    """History of the truth, beside runs the finest of which was solved as ``last`` says."""
    from fingerpad.simulation import simulate

    if last.unbounded and isinstance(scene.stimulus, Bar):
        return _of_true_edge(scene, ROUNDED)
    ridges = scene.specimen.ridges if last.effects["ridges"].on else None
    light = last.effects["symmetry"].on and last.nodes <= 5000
    made = finer(last, FINER_STILL if light or ridges else FINER)
    if ridges:  # of which a mesh has some elements however coarse it is
        focus = all_over(1.5 * ridges.inner.pitch, 3 * wave_of(ridges.inner) / TRUTH)
        made = replace(
            made, mesh_size=replace(made.mesh_size, focus=(*made.mesh_size.focus, *focus))
        )
    return simulate(scene, made)


def _of_true_edge(scene, rounded):
    """The truth of a bar's true edge: that of a rounding by its width over ``rounded``; twice or
    four times that where it is too sharp, or takes too long.
    """
    from cysyk1999.studies.stability.run import Late, in_time
    from fingerpad.mechanics.stepping import NonConvergence
    from fingerpad.simulation import simulate

    width = scene.stimulus.width
    sharp = scene.varied({"stimulus": Bar(width=width, fillet=width / rounded), "accuracy": 0.05})
    try:
        with in_time(PATIENCE if rounded > ROUNDED / 4 else 10 * PATIENCE):
            return simulate(sharp, finer(plan(sharp), 1.5))
    except (NonConvergence, Late):
        if rounded < ROUNDED / 4:
            raise
    return _of_true_edge(scene, rounded / 2)


def beliefs(name: str, kind: str, document: dict[str, Any], folder: Path) -> list[dict[str, Any]]:
    """Run a drawn scene as it is and as finely as the truth: a row each. ``folder`` takes an
    external mesh.
    """
    from fingerpad.simulation import simulate

    document = dict(document)
    if "own" in document:
        return _beliefs_on_own(name, kind, document, folder)
    made, stimulus = document.pop("made", None), document.pop("stimulus")
    document["stimulus"] = FLAT if isinstance(stimulus, Sampled) else stimulus
    scene = asked = scene_of(document, name)
    if isinstance(stimulus, Sampled):
        scene = asked = scene.varied({"stimulus": stimulus})
    if made:
        edge, size = made["edge"], plan(scene.with_accuracy("thesis")).mesh_size
        mesh = build_pad_mesh(
            scene.specimen.outline, replace(size, skin_edge=edge, layer_edge=0.9 * edge)
        )
        path = folder / f"{name}.msh"
        write_pad(mesh if made["element"] == "quad9" else split(mesh, made["element"]), path)
        asked = scene_of(document | {"specimen": {"mesh": str(path)}}, name)
    run = simulate(asked)
    last = (
        plan(scene.with_accuracy(0.02)) if made else Plan.from_dict(json.loads(run.attrs["plan"]))
    )
    truth = truth_of(scene, last)
    rows = []
    unbounded = {"peak_pressure": run.attrs["singular"], "centre_pressure": last.unbounded.centre}
    bounded = [name for name in QUANTITIES if not unbounded.get(name)]
    for level, history in ((str(document["accuracy"]), run), (FINEST, truth)):
        error, worst = difference(run, truth, bounded) if history is run else (np.nan, "")
        found = record(history, error, worst, runs=len(json.loads(history.attrs["runs"])))
        rows.append({"scene": name, "class": kind, "accuracy": level} | found)
    return rows


def _beliefs_on_own(
    name: str, kind: str, document: dict[str, Any], folder: Path
) -> list[dict[str, Any]]:
    """The same of a scene on a mesh of one's own; its truth is on a finer mesh of the same
    shape.
    """
    from fingerpad.simulation import simulate

    histories = []
    for own in (document["own"], finer_own(document["own"])):
        path = folder / f"{name}.msh"
        write_own(own, path)
        wanted = {key: value for key, value in document.items() if key != "own"}
        histories.append(
            simulate(
                scene_of(wanted | {"specimen": wanted["specimen"] | {"mesh": str(path)}}, name)
            )
        )
    error, worst = difference(*histories)
    asked = {"scene": name, "class": kind}
    return [
        asked | {"accuracy": accuracy} | record(history, *what, runs=1)
        for accuracy, history, what in zip(
            ("draft", FINEST), histories, ((error, worst), (np.nan, "")), strict=True
        )
    ]


def accuracy_drawn(job: SimpleNamespace) -> None:
    """Job: `kind`, the class -> `rows` (CSV) of all its scenes."""
    with tempfile.TemporaryDirectory() as folder:
        scenes = [(name, kind, document) for name, kind, document in drawn() if kind == job.kind[0]]
        rows = [row for scene in scenes for row in beliefs(*scene, Path(folder))]
    write_frame(pd.DataFrame(rows), Path(job.rows[0]))

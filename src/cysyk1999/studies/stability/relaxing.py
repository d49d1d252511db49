"""A case with what its message advises to relax, so that the advice can be tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial, reduce
from typing import Any

from cysyk1999.studies.common.documents import cylinder
from cysyk1999.studies.stability.cases import Case
from fingerpad.mechanics.stepping import hard_here

HERE = hard_here(())
Change = Callable[[Case], Case]


def _with(case: Case, **keys: Any) -> Case:
    return replace(case, scene=case.scene | keys, may_fail=False)


def _loaded(case: Case, share: float) -> Case:
    """The case with so much of its forces and depths."""
    motion = []
    for leg in case.scene["motion"]:
        leg = dict(leg)
        for target in {"press_to_force", "press_to_depth"} & leg.keys():
            value, unit = leg[target].split()
            leg[target] = f"{share * float(value):g} {unit}"
        motion.append(leg)
    return _with(case, motion=motion)


def _loads(*shares: float) -> dict[str, Change]:
    return {f"load: {share:g} of it": partial(_loaded, share=share) for share in shares}


def _usual_layers(case: Case) -> Case:
    """The case with the usual moduli in layers that have their own."""
    case = _layers(case, youngs_modulus="15 kPa")
    specimen = case.scene.get("specimen", {})
    if "epidermis" not in specimen.get("layers", {}):
        return case
    skin = specimen["layers"]["epidermis"] | {"youngs_modulus": "0.15 MPa"}
    return _with(case, specimen=specimen | {"layers": specimen["layers"] | {"epidermis": skin}})


def _layers(case: Case, **keys: Any) -> Case:
    """The case with these keys in all its layers."""
    specimen = case.scene.get("specimen", {})
    if "layers" in specimen:
        layers = {name: layer | keys for name, layer in specimen["layers"].items()}
        return _with(case, specimen=specimen | {"layers": layers})
    for shape in {"slab", "half_round"} & specimen.keys():
        layers = [layer | keys for layer in specimen[shape]["layers"]]
        return _with(case, specimen=specimen | {shape: specimen[shape] | {"layers": layers}})
    return case


def _pressed_only(case: Case) -> Case:
    return _with(case, motion=case.scene["motion"][:1])


def _rounded(case: Case) -> Case:
    stimulus = case.scene["stimulus"]
    if stimulus["shape"] == "bar":
        return _with(case, stimulus=stimulus | {"fillet": "0.3 mm"})
    if stimulus["shape"] == "sampled":
        return _with(case, stimulus=stimulus | {"smooth": "1 mm"})
    return _with(case, stimulus=cylinder(2500))


def _steps(case: Case) -> Case:
    return replace(case, steps=8 * case.steps_per_leg)


def _thesis_mesh(case: Case) -> Case:
    return _with(replace(case, mesh=None), accuracy="thesis")


def _finite(case: Case) -> Case:
    return _with(case, effects=case.scene["effects"] | {"finite_strain": "on"})


STEPS = {"time: 8 times the steps": _steps}
MESH = {"mesh: planned for accuracy: thesis": _thesis_mesh}
LOAD = _loads(0.2)
LAYERS = {"layers: usual": _usual_layers}
ROUNDED = {"stimulus: rounded": _rounded}
ADVICE: dict[str, dict[str, Change]] = {
    "smaller depth or force": _loads(0.5, 0.2, 0.04),
    "fillet": ROUNDED,
    "smoothing": {"stimulus: smoothed": _rounded},
    "smaller steps": STEPS,
    "more steps": STEPS,
    "finer": MESH,
}
"""Words of an advice -> changes that follow it, by name, in the order in which they are tried."""
HARD: dict[str, dict[str, Change]] = {
    "times as stiff": LAYERS,
    "hardly stiffer": LAYERS,
    "Poisson's ratio": {"Poisson's ratio: 0.48": partial(_layers, poisson_ratio=0.48)},
    "a force of": LOAD,
    "a depth of": LOAD,
    "a true edge": ROUNDED,
    "as sharp as": ROUNDED,
    "corners or bumps": ROUNDED,
    "friction": {"friction: none": partial(_with, friction=0.0)},
    "the law": {"law: neo-Hooke": partial(_layers, law="neo_hooke")},
    "small strain": {"strain: finite": _finite},
    "a stroke": {"motion: pressed only": _pressed_only},
    "not refined": MESH,
}
"""Words of what is hard in a scene -> the change that makes it easier, by name."""


def _named(known: dict[str, dict[str, Change]], text: str) -> dict[str, Change]:
    """Changes whose words stand in a text."""
    return {
        name: change for words in known if words in text for name, change in known[words].items()
    }


def relaxed(case: Case, message: str) -> Iterator[tuple[str, Case]]:
    """What the message of a failed run advises to relax, in words, and the case with it relaxed.

    One thing after the other, and last all that is hard at once. A wrong result, whose message has
    no advice, is tried on a finer mesh.
    """
    advice, _, hard = message.partition(HERE)
    advice = advice.partition("; try ")[2] or "a finer mesh"
    easier = _named(HARD, hard)
    yield from ((name, change(case)) for name, change in (_named(ADVICE, advice) | easier).items())
    if len(easier) > 1:
        yield "all that is hard", reduce(lambda less, change: change(less), easier.values(), case)

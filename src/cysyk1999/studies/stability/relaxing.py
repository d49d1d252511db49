"""What a failed run's advice says to relax, and the case with that relaxed: so that the advice can
be tried.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import reduce
from typing import Any

from cysyk1999.studies.stability.hard_cases import Case, cylinder
from fingerpad.mechanics.stepping import hard_here

_TARGETS = ("press_to_force", "press_to_depth")
_SHARES = (0.5, 0.2, 0.04)
HERE = hard_here(())


def _loaded(share: float) -> Callable[[Case], Case]:
    """The case with so much of its forces and depths."""

    def less(text: str) -> str:
        value, unit = text.split()
        return f"{share * float(value):g} {unit}"

    def change(case: Case) -> Case:
        legs = [
            {key: less(value) if key in _TARGETS else value for key, value in leg.items()}
            for leg in case.scene["motion"]
        ]
        return _with(case, motion=legs)

    return change


def _of_layers(**keys: Any) -> Callable[[Case], Case]:
    """The case with these keys in all its layers; with none of their own moduli where nothing is
    said.
    """

    def change(case: Case) -> Case:
        specimen = dict(case.scene.get("specimen", {}))
        part = next((part for part in ("layers", "slab", "half_round") if part in specimen), None)
        if part is None:
            return case
        usual = keys or {"youngs_modulus": "15 kPa"}
        layers = specimen[part] if part == "layers" else specimen[part]["layers"]
        if isinstance(layers, dict):
            skin = {} if keys else {"epidermis": {"youngs_modulus": "0.15 MPa"}}
            changed: Any = {
                name: layer | usual | skin.get(name, {}) for name, layer in layers.items()
            }
        else:
            changed = [layer | usual for layer in layers]
        return _with(
            case,
            specimen=specimen
            | {part: changed if part == "layers" else specimen[part] | {"layers": changed}},
        )

    return change


def _without(key: str) -> Callable[[Case], Case]:
    return lambda case: replace(
        case, scene={k: v for k, v in case.scene.items() if k != key}, may_fail=False
    )


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


def _meshed(accuracy: Any) -> Callable[[Case], Case]:
    return lambda case: _with(replace(case, mesh=None), accuracy=accuracy)


def _with(case: Case, **keys: Any) -> Case:
    return replace(case, scene=case.scene | keys, may_fail=False)


ADVICE: dict[str, tuple[tuple[str, Callable[[Case], Case]], ...]] = {
    "smaller depth or force": tuple(
        (f"load: {share:g} of it", _loaded(share)) for share in _SHARES
    ),
    "fillet": (("stimulus: rounded", _rounded),),
    "smoothing": (("stimulus: smoothed", _rounded),),
    "smaller steps": (("time: 8 times the steps", _steps),),
    "more steps": (("time: 8 times the steps", _steps),),
    "finer": (("mesh: planned for accuracy: thesis", _meshed("thesis")),),
}
"""Words of an advice -> what they say to relax, in the order in which it is tried."""


HARD: dict[str, tuple[str, Callable[[Case], Case]]] = {
    "times as stiff": ("layers: usual", _of_layers()),
    "hardly stiffer": ("layers: usual", _of_layers()),
    "Poisson's ratio": ("Poisson's ratio: 0.48", _of_layers(poisson_ratio=0.48)),
    "a force of": ("load: 0.2 of it", _loaded(0.2)),
    "a depth of": ("load: 0.2 of it", _loaded(0.2)),
    "a true edge": ("stimulus: rounded", _rounded),
    "as sharp as": ("stimulus: rounded", _rounded),
    "corners or bumps": ("stimulus: rounded", _rounded),
    "friction": ("friction: none", _without("friction")),
    "the law": ("law: neo-Hooke", _of_layers(law="neo_hooke")),
    "small strain": (
        "strain: finite",
        lambda case: _with(case, effects=case.scene["effects"] | {"finite_strain": "on"}),
    ),
    "a stroke": ("motion: pressed only", _pressed_only),
    "not refined": ("mesh: planned for accuracy: thesis", _meshed("thesis")),
}
"""Words of what is hard in a scene -> what they say to ask less of."""


def relaxed(case: Case, message: str) -> Iterator[tuple[str, Case]]:
    """What the message of a failed run says to relax, in words, and the case with it relaxed; a
    wrong one wants a finer mesh.

    One thing after the other, and last all at once that is hard.
    """
    advice, _, hard = message.partition(HERE)
    advice = advice.partition("; try ")[2] or "a finer mesh"
    advised = [each for words, changes in ADVICE.items() if words in advice for each in changes]
    less = dict(each for words, each in HARD.items() if words in hard)
    yield from ((said, change(case)) for said, change in (dict(advised) | less).items())
    if len(less) > 1:
        yield "all that is hard", reduce(lambda easier, change: change(easier), less.values(), case)

"""What a failed run's advice says to relax, and the case with that relaxed: so that the advice can be tried."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

from fingerpad.studies.stability.hard_cases import Case, cylinder

_TARGETS = ("press_to_force", "press_to_depth")


def _loaded(share: float) -> Callable[[Case], Case]:
    """The case with so much of its forces and depths."""

    def less(text: str) -> str:
        value, unit = text.split()
        return f"{share * float(value):g} {unit}"

    def change(case: Case) -> Case:
        legs = [{key: less(value) if key in _TARGETS else value for key, value in leg.items()} for leg in case.scene["motion"]]
        return _with(case, motion=legs)

    return change


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
    "smaller depth or force": tuple((f"load: {share:g} of it", _loaded(share)) for share in (0.5, 0.04)),
    "fillet": (("stimulus: rounded", _rounded),),
    "smoothing": (("stimulus: smoothed", _rounded),),
    "smaller steps": (("time: 8 times the steps", _steps),),
    "more steps": (("time: 8 times the steps", _steps),),
    "finer": (("mesh: planned for accuracy: thesis", _meshed("thesis")),),
}
"""Words of an advice -> what they say to relax, in the order in which it is tried."""


def relaxed(case: Case, message: str) -> Iterator[tuple[str, Case]]:
    """What the message of a failed run says to relax, in words, and the case with it relaxed; a wrong one wants a finer mesh."""
    advice = message.partition("; try ")[2] or "a finer mesh"
    for words, changes in ADVICE.items():
        if words in advice:
            yield from ((said, change(case)) for said, change in changes)

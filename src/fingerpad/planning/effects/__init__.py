"""The effects that a plan decides on: one file each, with its question, its rules, its decision and
the scenes that show it.

A new one is a file that is called as the effect and ends in ``EFFECT = PlannedEffect(...)``; no
list names it. One of your own is registered while it is needed (:func:`registered`). Scene
language, plan, simulation, the study of effects, its tables and its picture read the register and
name no effect.
"""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from graphlib import TopologicalSorter
from importlib import import_module

from fingerpad.planning.effect import Effect, Parts, PlannedEffect
from fingerpad.scenes.effects import EFFECTS as NAMES
from fingerpad.scenes.scene import Scene

_FOUND: list[PlannedEffect] = [import_module(f"{__name__}.{name}").EFFECT for name in NAMES]

EFFECTS: dict[str, PlannedEffect] = {
    effect.name: effect for effect in sorted(_FOUND, key=lambda effect: effect.place)
}
"""Name -> effect, in the order of their places."""


def in_order() -> list[PlannedEffect]:
    """The effects, each after those that its decision asks about."""
    wants = {name: effect.after for name, effect in EFFECTS.items()}
    return [EFFECTS[name] for name in TopologicalSorter(wants).static_order()]


def parts_of(scene: Scene, effects: Mapping[str, Effect]) -> Parts:
    """What the effects that are on make of a simulation of ``scene``."""
    parts = Parts(scene)
    for name, effect in effects.items():
        if effect.on:
            parts = EFFECTS[name].turn_on(parts)
    return parts


@contextmanager
def registered(effect: PlannedEffect) -> Iterator[None]:
    """An effect of one's own, for as long as this lasts: in scenes, plans and simulations."""
    EFFECTS[effect.name] = effect
    NAMES.append(effect.name)
    try:
        yield
    finally:
        NAMES.remove(effect.name)
        del EFFECTS[effect.name]

"""What a measure is: a number with a unit, or one under each of some conditions, that is read of a
scene.

What it is read of says what it can tell. A measure of the *scene* alone is an input: it is known
before anything is simulated. One of the *mesh* counts parts of the model. Only one of the *history*
is a result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import ModuleType
from typing import Literal

import xarray as xr

from fingerpad.measures.features import Histories
from fingerpad.measures.strokes import loaded
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.pad import PadMesh

Values = Mapping[str, float]
"""Condition -> value; the condition of a single number is empty."""


def anywhere(scene: Scene) -> bool:
    return True


@dataclass(frozen=True)
class Measure:
    """A measure, called with a scene, a mesh or a history.

    Attributes
    ----------
    name, unit
        As in the measures table.
    read
        A number, or a mapping condition -> number, in `unit`. Raises KeyError where the scene does
        not show it.
    where
        Whether a scene has it.
    of
        What `read` takes; of a stroke its `loaded` outputs.
    beside
        Whether `read` takes, as second argument, all histories by scene.
    """

    name: str
    unit: str
    read: Callable[..., float | Values]
    where: Callable[[Scene], bool] = anywhere
    of: Literal["scene", "mesh", "history", "stroke"] = "history"
    beside: bool = False

    def __call__(
        self, subject: Scene | PadMesh | xr.Dataset, runs: Histories | None = None
    ) -> dict[str, float]:
        subject = loaded(subject) if self.of == "stroke" else subject
        found = self.read(subject, runs) if self.beside else self.read(subject)
        return (
            {k: float(v) for k, v in found.items()}
            if isinstance(found, Mapping)
            else {"": float(found)}
        )


def measure(
    unit: str,
    where: Callable[[Scene], bool] = anywhere,
    of: Literal["scene", "mesh", "history", "stroke"] = "history",
    beside: bool = False,
) -> Callable[[Callable[..., float | Values]], Measure]:
    """Decorator: the function is the measure of its name."""
    return lambda read: Measure(read.__name__, unit, read, where, of, beside)


def measures_of(module: ModuleType) -> dict[str, Measure]:
    """The measures of a module, by name: those that stand alone, and those in tuples."""
    return {
        m.name: m
        for each in vars(module).values()
        for m in (each if isinstance(each, tuple) else (each,))
        if isinstance(m, Measure)
    }


# --- kinds of scenes


def named(scenes: Iterable[str]) -> Callable[[Scene], bool]:
    """These scenes only, for what compares two of them."""
    names = frozenset(scenes)
    return lambda scene: scene.name in names


def strokes(scene: Scene) -> bool:
    """Something slides or is stepped over the pad."""
    return any(leg.along for leg in scene.motion)


def cylinders(scene: Scene) -> bool:
    return scene.stimulus.shape == "cylinder"


def speed_of(scene: Scene) -> float:
    """Speed (m/s) of the first leg that slides at one; 0 if none does."""
    return next((leg.speed for leg in scene.motion if leg.strokes and leg.speed), 0.0)


def slides(scene: Scene) -> bool:
    """Something slides over the pad at a speed."""
    return speed_of(scene) > 0


def waves(scene: Scene) -> bool:
    """Strokes of the wavy surface at a speed."""
    return wavy(scene) and slides(scene)


def wavy(scene: Scene) -> bool:
    """Strokes of the wavy surface."""
    return scene.stimulus.shape == "wavy"


def plates(scene: Scene) -> bool:
    """Strokes of a flat plate."""
    return scene.stimulus.shape == "flat" and strokes(scene)


def held(scene: Scene) -> bool:
    """Presses to a force at a rate, and held."""
    return forced(scene) and scene.motion[0].rate is not None and not strokes(scene)


def forced(scene: Scene) -> bool:
    """Presses to a force."""
    return scene.motion[0].force is not None


def deep(scene: Scene) -> bool:
    """Presses to a depth."""
    return scene.motion[0].depth is not None

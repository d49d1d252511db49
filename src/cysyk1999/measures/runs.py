"""Scenes that are looked at together, each set said once: the name that every one of them goes by,
and its scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

import xarray as xr

from fingerpad.measures.features import SURFACES, Histories, scene_name
from fingerpad.measures.strokes import FULL, STEPPED, SUB

CYLINDERS = SURFACES[1:]
"""Of the nine surfaces all but the flat plate."""
WITHIN_350, WITHIN_400 = (
    tuple(label for label in SURFACES if label == "flat" or float(label) <= most)
    for most in (350, 400)
)
"""Surfaces as curved as the stroked one, with the flat plate, on the thesis's axes of Figs 5-17 and
5-18.
"""


@dataclass(frozen=True)
class Runs(Mapping[str, str]):
    """Scenes by name: a mapping of names to scenes.

    Attributes
    ----------
    column
        Of the names in a data frame: ``surface``, ``series``, ``panel``.
    scenes
        Name -> scene.
    stroke
        Whether they are strokes, read at their `loaded` outputs against the stroke distance.
    companions
        Names of the scenes whose coarse companions are read; None: of all.
    """

    column: str
    scenes: Mapping[str, str]
    stroke: bool = False
    companions: tuple[str, ...] | None = None

    def __iter__(self) -> Iterator[str]:
        return iter(self.scenes)

    def __getitem__(self, name: str) -> str:
        return self.scenes[name]

    def __len__(self) -> int:
        return len(self.scenes)

    def only(self, names: Iterable[str]) -> Runs:
        """Some of them, in the order asked for. Raises KeyError for an unknown name."""
        return replace(self, scenes={name: self.scenes[name] for name in names})

    def are_in(self, histories: Histories) -> bool:
        """Whether all of them are there."""
        return all(scene in histories for scene in self.scenes.values())

    def without_companions(self) -> Runs:
        """The same, read without their coarse companions."""
        return replace(self, companions=())

    def histories(self, histories: Histories) -> dict[str, xr.Dataset]:
        """Their histories by name, as far as they are there."""
        return {name: histories[scene] for name, scene in self.scenes.items() if scene in histories}

    @property
    def companion_scenes(self) -> tuple[str, ...]:
        """Scenes whose coarse companions are read."""
        return tuple(
            scene
            for name, scene in self.scenes.items()
            if self.companions is None or name in self.companions
        )


def surfaces(programme: str, labels: Iterable[str] = SURFACES) -> Runs:
    """Surfaces pressed in a force programme: ``ramp40``, ``ramp150``, ``press10``, ``press15``,
    ``ridged_40``.
    """
    return Runs("surface", {label: scene_name(programme, label) for label in labels})


def by_speed(scenes: Mapping[str, str]) -> Runs:
    """Strokes by velocity: ``10 mm/s``."""
    return Runs("series", {f"{speed} mm/s": scene for speed, scene in scenes.items()}, stroke=True)


NINE, FAST, RIDGED_NINE = (surfaces(programme) for programme in ("ramp40", "ramp150", "ridged_40"))
"""The nine surfaces pressed to 20 gram-weight: at 40 gf/s, at 150 gf/s, and on a pad with inner
ridges.
"""

LOWER = {
    force: surfaces(f"press{force}", ("flat", "79", "158", "315", "630")) for force in (10, 15)
}
"""Five surfaces pressed to less, by force in gram-weight."""

SPHERES = {
    force: surfaces(f"spheres_{force}", ("flat", "81", "172", "256", "340", "521", "694"))
    for force in (10, 15, 20)
}
"""A plate and spheres as Goodwin pressed them, on the pad as a body of revolution, by force in
gram-weight.
"""

PADS = Runs("pad", {"homogeneous": "homogeneous_flat", "layered": "ramp40_flat"})
"""The flat plate on two pads."""

SPEEDS, SUB_SPEEDS = by_speed(FULL), by_speed(SUB)
"""Strokes at five velocities over all eight convexities, and at three over the first two."""

STEPPED_OVER = Runs("series", {"stepped": STEPPED}, stroke=True)
"""The first two convexities stepped over the pad."""

PLAIN, RIDGED = (
    Runs(
        "panel",
        {way: f"{pad}_stroke_{way}" for way in ("right", "left")},
        stroke=True,
        companions=("right",),
    )
    for pad in ("plate", "ridged")
)
"""A flat plate stroked both ways over a plain pad and one with inner ridges. The two are mirror
images of each other: the companion of the stroke to the right, read on either side, serves both.
"""

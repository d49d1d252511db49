"""From a sweep to its scenes: which values each has, in which place of the result, and that every one of them is valid."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fingerpad.documents import SceneError
from fingerpad.fields import as_written
from fingerpad.files import is_file
from fingerpad.scenes.scene import Scene
from fingerpad.sweeps.language import Column, Read, Unit, quantiles, resolved


@dataclass(frozen=True)
class Parameter:
    """An axis of a sweep in its results.

    Attributes:
        name: what it is called. key: the dotted key of the scene. unit: of its values, "" for words. dimension: of the result
        that it runs along. values: along that dimension, numbers in `unit` or words. source: where a distribution is from.
    """

    name: str
    key: str
    unit: str
    dimension: str
    values: list[Any]
    source: str = ""

    @property
    def column(self) -> str:
        """Header of its column."""
        return f"{self.name} ({self.unit})" if self.unit else self.name


class Design:
    """The scenes of a sweep, by number from 0; the last dimension runs fastest.

    Args:
        read: a checked sweep.
    """

    def __init__(self, read: Read) -> None:
        self.read = read
        axes = read.sweep.over
        self._drawn = [key for key, axis in axes.items() if axis.drawn or isinstance(axis, Column)]
        self._listed = [key for key in axes if key not in self._drawn]
        folder = read.file.absolute().parent
        said = [key for key in axes if not axes[key].drawn]
        self._written = {key: [resolved(key, value, folder) for value in axes[key].written()] for key in said}
        self._values = {key: axes[key].labels() for key in said} | self._draws()

    def _draws(self) -> dict[str, list[float]]:
        """Key -> values of what is drawn, to 12 digits, in its unit."""
        sweep = self.read.sweep
        drawn = [key for key in self._drawn if sweep.over[key].drawn]
        if not drawn:
            return {}
        from scipy.stats import qmc

        makers = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol}
        with np.errstate(all="ignore"):
            import warnings

            with warnings.catch_warnings():  # of samples that are no power of two
                warnings.simplefilter("ignore")
                shares = makers[sweep.design](len(drawn), rng=np.random.default_rng(sweep.seed)).random(sweep.samples)
        return {
            key: [float(f"{value:.12g}") for value in quantiles(sweep.over[key], shares[:, k])] for k, key in enumerate(drawn)
        }

    @cached_property
    def dimensions(self) -> dict[str, int]:
        """Dimension of the result -> its length: of the draws ("scene", "draw" where they are crossed), then of each axis."""
        names = self.read.names
        draws = {"draw" if self._listed else "scene": len(self._values[self._drawn[0]])} if self._drawn else {}
        return draws | {names[key]: len(self._written[key]) for key in self._listed}

    @cached_property
    def parameters(self) -> list[Parameter]:
        """The axes, in the order of the sweep."""
        found = []
        for key, axis in self.read.sweep.over.items():
            unit: Unit | None = axis.unit
            name = self.read.names[key]
            dimension = next(iter(self.dimensions)) if key in self._drawn else name
            source = getattr(axis, "source", None) or ""
            found.append(Parameter(name, key, unit.text if unit else "", dimension, self._values[key], source))
        return found

    def __len__(self) -> int:
        return math.prod(self.dimensions.values())

    def place(self, number: int) -> tuple[int, ...]:
        """Index of a scene along each dimension."""
        return tuple(int(k) for k in np.unravel_index(number, tuple(self.dimensions.values())))

    def changes(self, number: int) -> dict[str, Any]:
        """What is special to a scene: key -> value as a scene takes it."""
        place = dict(zip(self.dimensions, self.place(number), strict=True))
        out = {}
        for parameter in self.parameters:
            k = place[parameter.dimension]
            if parameter.key in self._written:
                out[parameter.key] = self._written[parameter.key][k]
            else:
                out[parameter.key] = self.read.sweep.over[parameter.key].unit.written(parameter.values[k])
        return out

    def said(self, number: int) -> str:
        """A scene in words, for messages."""
        return ", ".join(f"{key} = {value}" for key, value in self.changes(number).items())

    def scene(self, number: int) -> Scene:
        """A scene. Raises SceneError, one line, that names what is special to it."""
        try:
            return self.read.base.varied(as_written(self.changes(number)))
        except SceneError as error:
            raise SceneError(f"{self.shown}: scene {number} ({self.said(number)}): {self.without_name(error)}") from None

    @property
    def shown(self) -> str:
        """The sweep's file, or its name."""
        return str(self.read.file) if is_file(self.read.file) else self.read.name

    def without_name(self, error: Exception) -> str:
        """An error's message without the base scene's name."""
        return str(error).removeprefix(f"{self.read.base.name}: ")

    def __iter__(self) -> Iterator[Scene]:
        return map(self.scene, range(len(self)))

    def check(self) -> None:
        """SceneError, one line, unless every scene is valid and every measure that is kept is one of its first scene."""
        from fingerpad.measures.table import KNOWN

        first = self.scene(0)
        for i, name in enumerate(self.read.sweep.keep):
            if not KNOWN[name].where(first):
                raise SceneError(
                    f"{self.shown}: keep[{i}]: '{name}' is not a measure of such a scene; allowed: measures of any scene"
                )
        for number in range(1, len(self)):
            self.scene(number)

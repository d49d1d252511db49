"""From a sweep to its scenes: the values of each, its place in the result, and its validity."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fingerpad.documents import SceneError
from fingerpad.fields import as_written
from fingerpad.files import is_file
from fingerpad.measures.known import known
from fingerpad.scenes.scene import Scene
from fingerpad.sweeps.language import Column, Read, quantiles, resolved


@dataclass(frozen=True)
class Parameter:
    """An axis of a sweep in its results.

    Attributes
    ----------
    name, key : str
        Its name, and the dotted key of the scene.
    unit : str
        Unit of its values, "" for words.
    dimension : str
        Dimension of the result that it runs along.
    values : list
        Values along that dimension, numbers in `unit` or words.
    source : str
        Where a distribution is from.
    """

    name: str
    key: str
    unit: str
    dimension: str
    values: list[Any]
    source: str = ""


class Design:
    """The scenes of a sweep, by number from 0; the last dimension runs fastest.

    Parameters
    ----------
    read : Read
        A checked sweep.
    """

    def __init__(self, read: Read) -> None:
        self.read = read
        axes, folder = read.sweep.over, read.file.absolute().parent
        self._together = [k for k, axis in axes.items() if axis.drawn or isinstance(axis, Column)]
        self._values = self._draws()
        self._written = {
            key: [axes[key].unit.written(value) for value in values]
            for key, values in self._values.items()
        }
        for key in axes.keys() - self._values.keys():
            self._values[key] = axes[key].labels()
            self._written[key] = [resolved(key, value, folder) for value in axes[key].written()]

    def _draws(self) -> dict[str, list[float]]:
        """Key -> values of what is drawn, to 12 digits, in its unit."""
        sweep = self.read.sweep
        drawn = [key for key in self._together if sweep.over[key].drawn]
        if not drawn:
            return {}
        from scipy.stats import qmc  # a second to import

        samplers = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol}
        sampler = samplers[sweep.design](len(drawn), rng=np.random.default_rng(sweep.seed))
        with warnings.catch_warnings():  # of samples that are no power of two
            warnings.simplefilter("ignore")
            shares = sampler.random(sweep.samples)
        return {
            key: [float(f"{value:.12g}") for value in quantiles(sweep.over[key], column)]
            for key, column in zip(drawn, shares.T, strict=True)
        }

    @cached_property
    def dimensions(self) -> dict[str, int]:
        """Dimension of the result -> its length.

        Samples are the first, "scene", or "draw" where they are crossed with other axes.
        """
        crossed = [key for key in self.read.sweep.over if key not in self._together]
        sizes = {self.read.names[key]: len(self._values[key]) for key in crossed}
        if self._together:
            first = "draw" if crossed else "scene"
            sizes = {first: len(self._values[self._together[0]])} | sizes
        return sizes

    @cached_property
    def parameters(self) -> list[Parameter]:
        """The axes, in the order of the sweep."""
        parameters = []
        for key, axis in self.read.sweep.over.items():
            name = self.read.names[key]
            dimension = next(iter(self.dimensions)) if key in self._together else name
            unit, source = axis.unit.text if axis.unit else "", getattr(axis, "source", None) or ""
            parameters.append(Parameter(name, key, unit, dimension, self._values[key], source))
        return parameters

    def __len__(self) -> int:
        return math.prod(self.dimensions.values())

    def changes(self, number: int) -> dict[str, Any]:
        """What distinguishes a scene from the base scene: key -> value as a scene takes it."""
        place = np.unravel_index(number, tuple(self.dimensions.values()))
        at = dict(zip(self.dimensions, place, strict=True))
        return {p.key: self._written[p.key][at[p.dimension]] for p in self.parameters}

    def scene(self, number: int) -> Scene:
        """A scene. Raises SceneError, one line, that names its values."""
        try:
            return self.read.base.varied(as_written(self.changes(number)))
        except SceneError as error:
            raise self.error(number, error) from None

    def error(self, number: int, error: Exception) -> SceneError:
        """The error of a scene as one line that names the sweep and the scene's values."""
        values = ", ".join(f"{key} = {value}" for key, value in self.changes(number).items())
        message = str(error).removeprefix(f"{self.read.base.name}: ")
        return SceneError(f"{self.shown}: scene {number} ({values}): {message}")

    @property
    def shown(self) -> str:
        """The sweep's file, or its name."""
        return str(self.read.file) if is_file(self.read.file) else self.read.name

    def __iter__(self) -> Iterator[Scene]:
        return map(self.scene, range(len(self)))

    def check(self) -> None:
        """Raise SceneError, one line, if a scene is not valid or has no measure that is kept."""
        first, measures = self.scene(0), known(self.read.sweep.keep)
        for i, name in enumerate(self.read.sweep.keep):
            if not measures[name].where(first):
                raise SceneError(
                    f"{self.shown}: keep[{i}]: '{name}' is not a measure of such a scene; "
                    "allowed: measures of any scene"
                )
        for number in range(1, len(self)):
            self.scene(number)

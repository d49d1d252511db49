"""What is made of a history and asked for again, kept as long as the history is."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

import xarray as xr

Further = ParamSpec("Further")
Made = TypeVar("Made")


def kept(
    make: Callable[Concatenate[xr.Dataset, Further], Made],
) -> Callable[Concatenate[xr.Dataset, Further], Made]:
    """The function, which makes something of a history, not called again for the same one: neither
    of the two is changed.
    """
    made: dict[tuple, Made] = {}

    @wraps(make)
    def found(history: xr.Dataset, *further: Further.args, **named: Further.kwargs) -> Made:
        key = (id(history), further, tuple(named.items()))
        if key not in made:
            new = make(history, *further, **named)
            if new is history:  # which would keep itself
                return new
            made[key] = new
            weakref.finalize(history, made.pop, key, None)
        return made[key]

    return found


class Each(Mapping):
    """Name -> what `make` makes of it, when first asked for, under the names of another mapping."""

    def __init__(self, make: Callable[[str], Any], names: Iterable[str]) -> None:
        self._make, self._names = make, tuple(names)
        self._made: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names  # without making it, as Mapping would

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

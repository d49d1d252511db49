"""What is computed once: results kept as long as their history or histories, and lazy mappings."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import wraps
from typing import Any, Concatenate, ParamSpec, TypeVar

Source = TypeVar("Source")
Options = ParamSpec("Options")
Result = TypeVar("Result")


def kept(
    function: Callable[Concatenate[Source, Options], Result],
) -> Callable[Concatenate[Source, Options], Result]:
    """Decorator: a function of a history, or of a `LazyMapping` of histories, is called once for
    each of them and its other arguments.

    The result is dropped with the history. Neither of the two may be changed.
    """
    results: dict[tuple, Result] = {}

    @wraps(function)
    def cached(history: Source, *options: Options.args, **named: Options.kwargs) -> Result:
        key = (id(history), options, tuple(named.items()))
        if key not in results:
            result = function(history, *options, **named)
            if result is history:  # which would keep itself
                return result
            results[key] = result
            weakref.finalize(history, results.pop, key, None)
        return results[key]

    return cached


class LazyMapping(Mapping):
    """Name -> what a function makes of the name, called when it is first asked for."""

    def __init__(self, function: Callable[[str], Any], names: Iterable[str]) -> None:
        self._function, self._names = function, tuple(names)
        self._values: dict[str, Any] = {}

    def __getitem__(self, name: str) -> Any:
        if name not in self._names:
            raise KeyError(name)
        if name not in self._values:
            self._values[name] = self._function(name)
        return self._values[name]

    def __contains__(self, name: object) -> bool:
        return name in self._names  # without making it, as Mapping would

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

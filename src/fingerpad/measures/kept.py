"""What is made of a history and asked for again, kept as long as the history is."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec, TypeVar

import xarray as xr

Further = ParamSpec("Further")
Made = TypeVar("Made")


def kept(make: Callable[Concatenate[xr.Dataset, Further], Made]) -> Callable[Concatenate[xr.Dataset, Further], Made]:
    """The function, which makes something of a history, not called again for the same one: neither of the two is changed."""
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

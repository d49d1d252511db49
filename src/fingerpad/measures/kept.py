"""What is made of a history and asked for again, kept as long as the history is."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from functools import wraps
from typing import Concatenate, ParamSpec

import xarray as xr

Further = ParamSpec("Further")


def kept(
    make: Callable[Concatenate[xr.Dataset, Further], xr.Dataset],
) -> Callable[Concatenate[xr.Dataset, Further], xr.Dataset]:
    """The function, which makes a dataset of a history, not called again for the same one: what is read is not changed."""
    made: dict[tuple, xr.Dataset] = {}

    @wraps(make)
    def found(history: xr.Dataset, *further: Further.args, **named: Further.kwargs) -> xr.Dataset:
        key = (id(history), further, tuple(named.items()))
        if key not in made:
            new = make(history, *further, **named)
            if new is history:  # which would keep itself
                return new
            made[key] = new
            weakref.finalize(history, made.pop, key, None)
        return made[key]

    return found

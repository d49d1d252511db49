"""Roots of functions of one number: scipy's solvers take half a second to import, which no plan of
a scene needs.
"""

from __future__ import annotations

from collections.abc import Callable


def root(function: Callable[[float], float], low: float, high: float, within: float = 0.0) -> float:
    """A root between ``low`` and ``high``, by halving, to the last bit or to ``within``.

    Raises:
        ValueError: the function has one sign at both ends.
    """
    at_low, at_high = function(low), function(high)
    if at_low == 0:
        return low
    if at_high == 0:
        return high
    if (at_low > 0) == (at_high > 0):
        raise ValueError(f"no change of sign from {low} to {high}")
    while high - low > within:
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if (function(middle) > 0) == (at_low > 0):
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)

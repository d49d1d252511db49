"""What a trend is: a proposition about measures that holds or fails, under the id of the row that
the thesis states it in.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np

from cysyk1999.claims.verdicts import digits, joined
from cysyk1999.measures.table import Measures

ALIKE = 0.15
"""Largest relative difference of values that are about the same."""
HARDLY = 10.0
"""Largest spread (%) over the velocities that hardly matters: standard deviation over mean."""
NEGLIGIBLE = 15.0
"""Largest change (%) of a peak from the slowest to the fastest stroke that is "small and
negligible" (section 5.4).
"""
FOLLOWS = 0.9
"""Least correlation of a trace that follows another."""


@dataclass(frozen=True)
class Trend:
    """Outcome of a trend: whether it holds, the number shown, and a remark."""

    holds: bool
    shown: float
    note: str = ""


TRENDS: dict[str, Callable[[Measures], Trend]] = {}
"""Every trend by its id: ``TRENDS[id](measures)``. Raises KeyError for what was not simulated."""


def trend(id_: str, **given) -> Callable[[Callable[..., Trend]], Callable[..., Trend]]:
    """Decorator: the function, with what is given, tests the trend of this id."""

    def enter(check: Callable[..., Trend]) -> Callable[..., Trend]:
        if id_ in TRENDS:
            raise ValueError(f"{id_} is tested twice")
        TRENDS[id_] = partial(check, **given) if given else check
        return check

    return enter


def of_each(
    m: Measures, quantity: str, scenes: Mapping[str, str], condition: str = ""
) -> dict[str, float]:
    """A number of each of several scenes, by their names."""
    return {name: m(quantity, scene, condition) for name, scene in scenes.items()}


def everywhere(outcome: Mapping[str, bool], what: str = "", needed: int | None = None) -> Trend:
    """Whether something holds in every case; the number shown counts those for which it does."""
    failing = [label for label, holds in outcome.items() if not holds]
    count = len(outcome) - len(failing)
    note = joined(what, f"not for {', '.join(failing)}" if failing else "")
    return Trend(count >= (needed or len(outcome)), count, note)


def ordered(values: Mapping[str, float], what: str, growing: bool = True) -> Trend:
    """Whether the values of the surfaces, broad to sharp, only grow (or only fall)."""
    names, numbers = list(values), list(values.values())
    wrong = [
        f"{a} to {b}"
        for (a, x), (b, y) in pairwise(values.items())
        if (y <= x if growing else y >= x)
    ]
    note = f"{what}: {digits(numbers[0])} ({names[0]}) to {digits(numbers[-1])} ({names[-1]})"
    return Trend(
        not wrong,
        len(values) - len(wrong),
        note + (f"; not from {', '.join(wrong)}" if wrong else ""),
    )


def stepwise(values: Mapping[str, float], unit: str, sign: int = 1) -> Trend:
    """Whether each value is larger (sign 1) or smaller (-1) than the one before."""
    outcome = [True, *(sign * (b - a) > 0 for a, b in pairwise(values.values()))]
    return everywhere(dict(zip(values, outcome, strict=True)), listed(values, unit))


def listed(values: Mapping[str, float], unit: str, count: int = 3) -> str:
    """Labelled values with their unit, to so many digits."""
    return (", ".join(f"{k}: {digits(v, count)}" for k, v in values.items()) + f" {unit}").rstrip()


def spreads(values: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Spread (%) of each labelled value over the velocities: standard deviation over mean."""
    return {
        k: 100 * float(np.std([v[k] for v in values]) / (np.mean([v[k] for v in values]) or np.nan))
        for k in values[0]
    }

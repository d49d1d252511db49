"""What a trend is: a proposition about measures that holds or fails, under the id of the row that
the thesis states it in.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import pairwise

import numpy as np

from cysyk1999.claims.verdicts import digits
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


NAMED = 4
"""Cases that are named one by one; of more it is said how many they are, where the others are
named.
"""


@dataclass(frozen=True)
class Trend:
    """Outcome of a trend: whether it holds, the number shown, a remark, and of which cases it
    holds.
    """

    holds: bool
    shown: float
    note: str = ""
    parts: Mapping[str, bool] = field(default_factory=dict)

    @property
    def parted(self) -> str:
        """``holds for A, B; fails for C``, where there is both; of many the fewer are named."""
        good, bad = ([k for k, v in self.parts.items() if bool(v) == w] for w in (True, False))
        if not good or not bad:
            return ""
        named = [", ".join(good), ", ".join(bad)]
        if max(len(good), len(bad)) > NAMED:
            many = len(good) <= len(bad)
            named[many] = f"the other {len((good, bad)[many])}"
        return f"holds for {named[0]}; fails for {named[1]}"


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
    count = sum(map(bool, outcome.values()))
    return Trend(count >= (needed or len(outcome)), count, what, outcome)


def ordered(values: Mapping[str, float], what: str, growing: bool = True) -> Trend:
    """Whether the values of the surfaces, broad to sharp, only grow (or only fall)."""
    names, numbers = list(values), list(values.values())
    outcome = {
        f"{a} to {b}": y > x if growing else y < x for (a, x), (b, y) in pairwise(values.items())
    }
    note = f"{what}: {digits(numbers[0])} ({names[0]}) to {digits(numbers[-1])} ({names[-1]})"
    return Trend(all(outcome.values()), 1 + sum(outcome.values()), note, outcome)


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

"""Rows in which every pair of hard levels of two factors meets: a pairwise covering array, drawn
greedily from a seed.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence

import numpy as np

Row = dict[str, str]
_TRIED = 5  # rows drawn for each that is taken


def covering(
    factors: Mapping[str, Sequence[str]], allowed: Callable[[Row], bool], seed: int, most: int
) -> list[Row]:
    """Rows, a level of every factor each, in which every pair of hard levels that may meet does;
    the same for the same seed.

    Each row is the best of a few drawn ones: it begins with a pair that has not met yet, and takes
    the level that makes most new pairs, until none makes any (Cohen, Dalal, Fredman and Patton
    1997, the AETG system). The other factors stay easy.

    Args:
        factors: names and their levels, the easy one first. allowed: of a pair of levels; a row is,
        if all its pairs are. most: hard levels in a row.
    """
    levels = [(factor, level) for factor, names in factors.items() for level in names[1:]]
    draw, rows = random.Random(seed), []
    fits = np.array(
        [[f != g and allowed({f: one, g: other}) for g, other in levels] for f, one in levels]
    )
    left = fits.copy()

    def drawn(waiting):
        chosen = list(draw.choice(waiting))
        open_to, new = fits[chosen].all(0), left[chosen].sum(0)
        while len(chosen) < most and (gain := np.where(open_to, new, 0)).any():
            taken = draw.choice(np.flatnonzero(gain == gain.max()).tolist())
            chosen.append(taken)
            open_to, new = open_to & fits[taken], new + left[taken]
        return chosen

    while left.any():
        waiting = np.argwhere(np.triu(left)).tolist()
        best = max(
            (drawn(waiting) for _ in range(_TRIED)), key=lambda row: left[np.ix_(row, row)].sum()
        )
        left[np.ix_(best, best)] = False
        rows.append(
            {factor: names[0] for factor, names in factors.items()} | dict(levels[k] for k in best)
        )
    return rows

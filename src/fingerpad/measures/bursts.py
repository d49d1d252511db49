"""What a burst of impulses is, of recorded and of predicted trains alike.

Each convexity of a stroked surface evokes a burst, the hollow behind it a pause (LaMotte and
Srinivasan 1996, J Neurophysiol 76:3787, abstract). Width and rate are means of repeated strokes
(Cysyk 1999, section 5.2: 12 strokes, bins of 0.5 mm). No threshold of a rate or an energy enters.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

BIN = 0.5e-3
"""m; bins of the thesis's histograms over a stroke."""
SILENCE = 2.0
"""How many times as long as any other interval a silence is that parts a train into two bursts."""


class Burst(NamedTuple):
    """What repeated strokes answer to one stretch of a surface.

    Attributes
    ----------
    width
        m, from the first to the last bin that holds an impulse; mean of all strokes, 0 of a stroke
        without an impulse.
    rate
        impulses/s, between the first and the last impulse; mean of all strokes, 0 of a stroke
        without a burst.
    impulses
        Mean number in a stroke.
    strokes
        How many strokes have a burst: two impulses or more, not all at one place.
    """

    width: float
    rate: float
    impulses: float
    strokes: int


def burst(
    trains: Sequence[np.ndarray],
    speed: float,
    start: float = -np.inf,
    end: float = np.inf,
    bin_width: float = BIN,
) -> Burst:
    """The burst that repeated strokes show between two places of the surface.

    The rate of a stroke is the number of intervals between its first and its last impulse over the
    time between these two. A single impulse is no burst: its stroke has the rate 0 and counts in
    the mean, so that a mean of many strokes is not one of the few that answer.

    Parameters
    ----------
    trains
        Places (m,) of the impulses on the surface, m, in any order; one array a stroke, empty if
        it has none.
    speed
        Of the stroke, m/s, above 0.
    start, end
        Where the stretch begins and ends, m; an impulse at `end` is beyond it.
    bin_width
        m, above 0; bins begin at multiples of it.

    Raises
    ------
    ValueError
        There is no stroke, or `speed` or `bin_width` is not above 0.

    Examples
    --------
    Two strokes at 10 mm/s, impulses 1 mm apart; the second has one more.

    >>> import numpy as np
    >>> strokes = [np.array([3.1e-3, 4.1e-3]), np.array([3.2e-3, 4.2e-3, 5.2e-3])]
    >>> found = burst(strokes, speed=10e-3)
    >>> round(found.rate, 6), round(1e3 * found.width, 6), found.impulses, found.strokes
    (10.0, 2.0, 2.5, 2)
    """
    if not len(trains) or speed <= 0 or bin_width <= 0:
        raise ValueError("a burst needs a stroke, and a speed and a bin width above 0")
    places = (np.asarray(train, float) for train in trains)
    inside = [np.sort(train[(train >= start) & (train < end)]) for train in places]
    bins = [np.ptp(np.floor(train / bin_width + 1e-9)) + 1 if train.size else 0 for train in inside]
    bursts = [train for train in inside if train.size > 1 and train[0] < train[-1]]
    rates = [(train.size - 1) * speed / np.ptp(train) for train in bursts]
    return Burst(
        float(np.mean(bins)) * bin_width,
        float(sum(rates)) / len(trains),
        sum(train.size for train in inside) / len(trains),
        len(bursts),
    )


def is_double(train: np.ndarray) -> bool:
    """Whether a stroke's impulses are two bursts: one silence is `SILENCE` times as long as every
    other interval or longer, with two impulses or more on either side of it.

    train: (m,) places or times of the impulses, increasing.

    >>> is_double([0.0, 1.0, 4.0, 5.0]), is_double([0.0, 1.0, 2.0, 5.0])
    (True, False)
    """
    intervals = np.diff(np.asarray(train, float))
    if len(intervals) < 3:
        return False
    longest = int(intervals.argmax())
    others = np.delete(intervals, longest)
    return bool(0 < longest < len(intervals) - 1 and intervals[longest] >= SILENCE * others.max())

"""How far a stroke goes in one step, and the contact between the states that are found.

Outputs of a stroke are close to one another; states are found only where the straight way from one
to the next is too far from the truth. What it is off by is seen without any further solution: the
state before last is left out, and what lies between those on either side is held to it. A line
through two points with a curve of second derivative ``f''`` between them misses it by ``f'' h h' /
2`` where it is left out and by ``f'' h^2 / 8`` at most between the last two.

Pressure is not interpolated node by node, for a bump passes over many nodes in a step. It goes
along with the surface, and beside its edges with these, which is where it is smooth; its square is
interpolated, which is linear at the edge of a smooth contact.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from fingerpad.stimuli.motion import STEADY, Step

_BESIDE = 2.0
"""Ways of an edge past the surface, over which what lies inside it goes along with the edge less
and less.
"""
_NOT_FAR = 2.5
"""Ways of the surface, from the middle of one, within which an edge is the same edge."""
_MARGIN = 12
"""Nodes beside a contact that are looked at."""
_FEW = 0.02
"""Share of the force, of which no less sticks, or slips, where it counts."""
_TOO_FAR = 2.0
"""Tolerances beyond which a stride is taken back."""


@dataclass(frozen=True)
class Between:
    """What lies between two states: ``longest`` m from one to the next, ``tolerance`` of the
    pressure there, relative.
    """

    longest: float
    tolerance: float


@dataclass(frozen=True, eq=False)
class Touch:
    """The contact of one state: places ``x`` (ns,) m of the skin's nodes across, ``pressure`` (ns,)
    Pa, the contact's outermost ``edges`` m, how far the pad has come along the surface
    (``distance`` m), the drag over the force, and the share of the force that is carried where the
    skin sticks.
    """

    x: np.ndarray
    pressure: np.ndarray
    edges: tuple[float, float]
    distance: float
    drag: float
    sticks: float = 0.0

    @cached_property
    def patches(self) -> np.ndarray:
        """(k, 2) m, edges of every piece of skin that touches: where the squares of its last two
        pressures fall to zero.
        """
        x, square = self.x, self.pressure**2
        on = np.flatnonzero(square > 0)
        if not len(on):
            return np.zeros((0, 2))
        found = []
        for run in np.split(on, np.flatnonzero(np.diff(on) > 1) + 1):
            for last, inside, beyond in (
                (run[0], run[:2][-1], max(run[0] - 1, 0)),
                (run[-1], run[-2:][0], min(run[-1] + 1, len(x) - 1)),
            ):
                room = x[beyond] - x[last]
                fall = square[inside] - square[last]
                way = square[last] / fall * (x[last] - x[inside]) if fall > 0 else room / 2
                found.append(x[last] + (way if abs(way) < abs(room) else room))
        out = np.array(found).reshape(-1, 2)
        if np.isfinite(self.edges).all():
            out[0, 0], out[-1, 1] = self.edges
        return out


@dataclass(frozen=True)
class Passage:
    """The contact at a ``share`` of the way from a ``first`` to a ``last`` state, at nodes at ``x``
    (ns,) m by then.

    ``origin``: (2, k) m, where in either state the contact was that is at the nodes of ``window``;
    None where it cannot be told: there each node goes its own straight way.
    """

    first: Touch
    last: Touch
    share: float
    window: slice
    origin: np.ndarray | None

    @classmethod
    def at(cls, first: Touch, last: Touch, share: float, x: np.ndarray) -> Passage:
        """See the class."""
        window, anchors = _way(first, last)
        origin = None
        if anchors is not None and np.all(np.diff(x[window]) > 0):
            now = (1 - share) * anchors[0] + share * anchors[1]
            origin = np.stack([x[window] + np.interp(x[window], now, at - now) for at in anchors])
        return cls(first, last, share, window, origin)

    def pressure(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """(ns,) Pa, of pressures (ns,) in either state."""
        first, last = self._carried(first**2, last**2, falls=True)
        return (1 - self.share) * np.sqrt(first) + self.share * np.sqrt(last)

    def value(self, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """(ns,) of anything else that goes along with the contact, of values (ns,) in either
        state.
        """
        first, last = self._carried(first, last)
        return (1 - self.share) * first + self.share * last

    def _carried(self, *values, falls=False):
        """Of each state what is at its nodes (ns,), where that is by now; ``falls``: to zero at the
        contact's edges.
        """
        if self.origin is None:
            return values
        moved = np.zeros((2, len(values[0])))
        ends = zip(moved, values, (self.first, self.last), self.origin, strict=True)
        for out, each, touch, at in ends:
            x, known = touch.x[self.window], each[self.window]
            if falls:
                edges = np.sort(touch.patches.ravel())
                beyond = np.searchsorted(x, edges).clip(1, len(x) - 1)
                between = (known[beyond] > 0) != (known[beyond - 1] > 0)
                x = np.insert(x, beyond[between], edges[between])
                known = np.insert(known, beyond[between], 0.0)
            out[self.window] = np.interp(at, x, known)
        return moved


@lru_cache(maxsize=4)
def _way(first: Touch, last: Touch) -> tuple[slice, np.ndarray | None]:
    """The nodes where there is contact in either of two states, and beside it, and their
    anchors.
    """
    on = np.flatnonzero((first.pressure > 0) | (last.pressure > 0))
    if not len(on):
        return slice(0, 0), None
    window = slice(max(on[0] - _MARGIN, 0), on[-1] + 1 + _MARGIN)
    rising = all(np.all(np.diff(touch.x[window]) > 0) for touch in (first, last))
    return window, _anchors(first, last) if rising else None


def _anchors(first: Touch, last: Touch) -> np.ndarray | None:
    """(2, k) m, places of the same points of the contact in two states: edges, and what lies well
    inside them; None if unknown.

    A piece of the contact that has come or gone has no edges in the other state, and fades where it
    is.
    """
    # the surface goes as the pad comes along it the other way
    along = first.distance - last.distance
    pieces, pieces_then = first.patches, last.patches
    lefts, rights = (_same(pieces[:, side], pieces_then[:, side], along) for side in (0, 1))
    found = [(pieces[i, 0], pieces_then[j, 0]) for i, j in lefts.items()]
    found += [(pieces[i, 1], pieces_then[j, 1]) for i, j in rights.items()]
    for i in lefts.keys() & rights.keys():
        if lefts[i] == rights[i]:
            (left, right), (left_then, right_then) = pieces[i], pieces_then[lefts[i]]
            beside = _BESIDE * max(abs(left_then - left - along), abs(right_then - right - along))
            if right - left > 2 * beside > 0:
                found += [
                    (left + beside, left + beside + along),
                    (right - beside, right - beside + along),
                ]
    out = np.array(sorted(found)).reshape(-1, 2).T
    return out if out.size and np.all(np.diff(out) > 0) else None


def _same(edges: np.ndarray, then: np.ndarray, along: float) -> dict[int, int]:
    """Which edges (k,) m, all left or all right, are which then: nearest to one another and, if the
    surface moves, not far.
    """
    if not len(edges) or not len(then):
        return {}
    apart = np.abs(then - edges[:, None] - along / 2)
    far = _NOT_FAR * abs(along) if along else np.inf
    nearest, back = apart.argmin(axis=1), apart.argmin(axis=0)
    return {i: int(j) for i, j in enumerate(nearest) if back[j] == i and apart[i, j] <= far}


def missed(before: Touch, middle: Touch, found: Touch) -> float:
    """What lies between the last two of three states is off by at most, relative to all of the
    pressure; or of the drag.
    """
    ways = abs(middle.distance - before.distance), abs(found.distance - middle.distance)
    if not min(ways) or not middle.pressure.any():
        return 0.0
    share = ways[0] / sum(ways)
    passed = Passage.at(before, found, share, middle.x).pressure(before.pressure, found.pressure)
    off = np.abs(passed - middle.pressure).sum() / middle.pressure.sum()
    drag = abs((1 - share) * before.drag + share * found.drag - middle.drag)
    most = max(abs(touch.drag) for touch in (before, middle, found))
    return float(max(off, drag / most if most else 0.0) * ways[1] / (4 * ways[0]))


class Strides:
    """Scheduled steps, those that need not be found joined to strides as long as what lies between
    allows.

    Parameters
    ----------
    steps
        As scheduled.
    between
        None: every step is found.
    """

    def __init__(self, steps: Iterator[Step], between: Between | None = None):
        self._steps, self._between = iter(steps), between
        self._waiting: deque[Step] = deque()
        self._taken, self._wanted, self._at, self._leg, self._most = 0, 0.0, 0.0, -1, 0

    def next(self) -> tuple[Step, tuple[Step, ...]] | None:
        """The next step, and the scheduled ones that it passes; None after the last."""
        taken: list[Step] = []
        while True:
            if len(self._waiting) == len(taken):
                following = next(self._steps, None)
                if following is None:
                    return None  # a leg's last step is always found
                self._waiting.append(following)
            step = self._waiting[len(taken)]
            if step.leg != self._leg:  # which may begin otherwise than the one before has ended
                self._leg, self._wanted = step.leg, 0.0
            if taken and abs(step.distance - self._at) > self._wanted * (1 + 1e-9):
                break
            taken.append(step)
            if step.solved or len(taken) == self._most:
                break
        self._taken = len(taken)
        last = taken[-1]
        return replace(last, dt=min(sum(step.dt for step in taken), STEADY)), tuple(taken[:-1])

    def judge(self, before: Touch, middle: Touch, found: Touch) -> bool:
        """Is what lies between the last two good enough? The next stride is as long as it may be by
        this.
        """
        if self._between is None:
            return True
        off = missed(before, middle, found) / self._between.tolerance
        # from stick to slip, or back
        turning = any(_FEW < touch.sticks < 1 - _FEW for touch in (middle, found))
        if (off > _TOO_FAR or turning) and self._taken > 1:
            return False
        if turning:
            self._wanted = 0.0
            return True
        way = abs(found.distance - middle.distance)
        self._wanted = min(
            way * float(np.clip(off**-0.5 if off else 2.0, 0.5, 2.0)), self._between.longest
        )
        return True

    def shorten(self) -> bool:
        """Make the stride half as long; False where it passes nothing."""
        if self._taken < 2:
            return False
        self._most = self._taken // 2
        self._wanted = abs(self._waiting[self._most - 1].distance - self._at)
        return True

    def found(self, step: Step) -> None:
        """A state has been found at the end of the stride."""
        for _ in range(self._taken):
            self._waiting.popleft()
        self._at, self._most = step.distance, 0

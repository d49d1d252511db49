"""Motion programmes: the legs of a scene turned into steps."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

#: Duration (s) that stands for "until nothing changes any more": every Prony branch has relaxed after it.
STEADY = 1e9


@dataclass(frozen=True)
class Step:
    """One step: leg number, end time s, duration s (:data:`STEADY`: to the steady state), and what is reached at its end.

    Exactly one of ``force`` (N per m of contact length) and ``depth`` (m) is given. ``distance`` (m) is how far the pad has come
    along the surface. A ``fresh`` step lifts the pad, lets it recover fully and presses it there again.
    """

    leg: int
    time: float
    dt: float
    force: float | None = None
    depth: float | None = None
    distance: float = 0.0
    fresh: bool = False


def geometric(duration: float, count: int, first: float) -> np.ndarray:
    """``count`` step sizes (s) that sum to ``duration``, start at ``first`` and grow by a constant ratio (never shrink)."""
    if count == 1 or first * count >= duration * (1 - 1e-9):
        return np.full(count, duration / count)
    from scipy.optimize import brentq  # here, for it is slow to import

    ratio = brentq(lambda q: first * (q**count - 1) / (q - 1) - duration, 1 + 1e-9, 1 + (duration / first) ** (1 / (count - 1)))
    steps = first * ratio ** np.arange(count)
    return steps * (duration / steps.sum())


def programme(
    legs: Sequence,
    *,
    steps: int,
    contact_length: float,
    timed: bool = True,
    snapshots: Sequence[float] = (),
    present: Callable[[], tuple[float, float, float]] | None = None,
    slide_step: float | None = None,
) -> Iterator[Step]:
    """Steps of a motion programme, leg by leg.

    Args:
        legs: validated legs (press_to_force/rate, press_to_depth/speed, hold, lift, slide/speed/keep, step/every), SI, newtons.
        steps: per leg. contact_length: m, turns N into N/m.
        timed: does time matter? If not, a press is load increments and a hold one step.
        snapshots: times (s) at which a step must end.
        present: asked when a leg begins for the force (N/m) and depth (m) reached so far, which a change between force and
            depth control needs, and for the depth (m) at which the undeformed skin is no more than touched, where a lift ends;
            without it such a leg is taken to start from zero, and a lift to end there.
        slide_step: m, longest step of a slide; without it a slide has ``steps`` of them.
    """
    time, force, depth, distance, last = 0.0, 0.0, 0.0, 0.0, None
    for number, leg in enumerate(legs):
        kind = next(key for key in ("press_to_force", "press_to_depth", "hold", "lift", "slide", "step") if hasattr(leg, key))
        target = getattr(leg, kind)
        reached = present() if present else (force or 0.0, depth or 0.0, 0.0)
        if kind == "hold":
            sizes = geometric(target, steps, min(last or target / steps, target / steps)) if timed else np.array([target])
            goals = [(force, depth, distance)] * len(sizes)
        elif kind in ("slide", "step"):
            if kind == "step":
                count, speed = round(abs(target) / leg.every), None
            else:
                count, speed = math.ceil(abs(target) / slide_step * (1 - 1e-9)) if slide_step else steps, leg.speed
                if leg.keep == "force":
                    force, depth = reached[0] if force is None else force, None
                else:
                    force, depth = None, reached[1] if depth is None else depth
            last = None if speed is None else abs(target) / speed / count
            sizes = np.full(count, last or STEADY)
            goals = [(force, depth, distance + target * k / count) for k in range(1, count + 1)]
        else:
            by_force = kind == "press_to_force"
            start, end = reached[0 if by_force else 1], target / contact_length if by_force else target
            end = reached[2] if kind == "lift" else end
            speed = leg.rate and leg.rate / contact_length if by_force else leg.speed
            # a steady press is path-independent: increments only guide Newton's method and let the energy be balanced
            count = min(steps, 8) if speed is None else steps
            last = None if speed is None else abs(end - start) / speed / count
            sizes = np.full(count, STEADY if speed is None else last)
            path = [start + (end - start) * k / count for k in range(1, count)] + [end]
            goals = [(value, None, distance) if by_force else (None, value, distance) for value in path]
        for dt, goal in zip(sizes, goals, strict=True):
            begin, time = time, time + (float(dt) if dt < STEADY else 0.0)
            for cut in sorted(t for t in snapshots if begin + 1e-9 * time < t < time - 1e-9 * time):
                share = (cut - begin) / (time - begin)
                force, depth, distance = _between((force, depth, distance), goal, share)
                yield Step(number, cut, cut - begin, force, depth, distance)
                begin = cut
            yield Step(number, time, time - begin if dt < STEADY else STEADY, *goal, fresh=kind == "step")
            force, depth, distance = goal


def _between(before, after, share):
    return (None if b is None else b if a is None else a + share * (b - a) for a, b in zip(before, after, strict=True))

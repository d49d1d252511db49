"""Changed plans, the time that their runs take, and a limit on it."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from fingerpad.planning.plan import Plan


def finer(chosen: Plan, share: float) -> Plan:
    """A plan with edges ``share`` times as short; steps that take time are half as long."""
    size = chosen.mesh_size
    size = replace(
        size,
        skin_edge=size.skin_edge / share,
        layer_edge=size.layer_edge / share,
        growth=max(size.growth ** (1 / share), 1.03),
        focus=tuple((x, edge / share) for x, edge in size.focus),
        skin_radial_edge=size.skin_radial_edge and size.skin_radial_edge / share,
    )
    return replace(
        chosen,
        mesh_size=size,
        steps_per_leg=chosen.steps_per_leg * (2 if chosen.timed else 1),
        slide_step=chosen.slide_step / 1.5,
        asked_error=None,
    )


def with_effects(chosen: Plan, state: str | None = None, **switched: bool) -> Plan:
    """A plan with effects switched; ``state`` of the moduli is that without viscosity."""
    effects = {
        name: replace(effect, on=switched.get(name, effect.on))
        for name, effect in chosen.effects.items()
    }
    timed = effects["viscoelasticity"].on
    state = "long_term" if timed else state or chosen.state
    return replace(chosen, effects=effects, timed=timed, state=state)


def seconds(call: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Time (s) that a call takes."""
    start = clock()
    call()
    return clock() - start


def seconds_of_children() -> float:
    """Process time (s) of the processes that this one has started and that have ended."""
    times = os.times()
    return times.children_user + times.children_system


class OutOfTime(BaseException):
    """A time limit is over; no Exception, so that a simulation does not handle it itself."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise :class:`OutOfTime` after so much process time (s)."""

    def stop(*_):
        raise OutOfTime

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)

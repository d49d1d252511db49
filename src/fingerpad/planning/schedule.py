"""A scene's motion as steps, and how long its legs take."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial
from math import ceil

import numpy as np

from fingerpad.scenes.scene import Scene
from fingerpad.stimuli.motion import STEADY, Step, programme

_MOST_INCREMENTS = 8
_ROUND_EDGES = 4
"""Increments of a steady press by a stimulus with edges, round which nodes pop."""
_PARTS = 5
"""Outputs of the longest step of a slide."""
_OUTPUTS = 28
"""Outputs while an arc of the surface passes: the centre touches the sharpest convexities for three
quarters of their length.
"""
_MOST_PARTS = 16
"""Of the longest step of a slide."""
_AROUND = 1.5e-3
"""How far (m) behind an arc, half of it before one: the skin is dragged along."""
_MORE = 2.2
"""States that are found of a slide, over its longest steps."""
BETWEEN = 30.0
"""1/m: by how much of its pressure a stroke may be off between two states, over the skin's edge:
what nodes make of it as they come and go is that large. Three times as much takes as long, for long
steps need more factorisations.
"""
NEWTON = 15.0
"""1/m: the force that may be left out of balance in a stroke, relative, over the skin's edge."""


def schedule(
    scene: Scene,
    steps_per_leg: int,
    timed: bool,
    slide_step: float | None = None,
    stride: int = 1,
    every: int = 1,
    pieces: int = 1,
    present=None,
):
    """Steps of the scene's motion (see :func:`fingerpad.stimuli.motion.programme`).

    A steady press is one step, which is cut where Newton's method does not converge. Friction
    remembers how it was loaded, and who gives the number of steps by hand (``slide_step`` None)
    wants to see them: then there are more. A run in trouble takes ``pieces`` times as many.
    """
    increments = _ROUND_EDGES if scene.stimulus.singular else 1
    if scene.friction or slide_step is None:
        increments = _MOST_INCREMENTS
    return programme(
        scene.motion,
        steps=steps_per_leg,
        contact_length=scene.specimen.contact_length,
        timed=timed,
        snapshots=scene.outputs.snapshots,
        present=present,
        slide_step=slide_step,
        increments=min(steps_per_leg, pieces * increments),
        parts=partial(_parts, scene, slide_step) if slide_step else None,
        stride=stride,
        every=every,
    )


def expected_states(steps: Iterable[Step], slide_step: float | None, stride: int = 1) -> int:
    """How many states will be found, roughly, of the scheduled steps."""
    solved, way, last = 0, 0.0, 0.0
    for step in steps:
        solved += step.solved
        way += 0.0 if step.solved else abs(step.distance - last)
        last = step.distance
    return solved + (ceil(_MORE * way / (slide_step * stride)) if slide_step else 0)


def _parts(scene: Scene, slide_step: float, place: np.ndarray) -> np.ndarray:
    """Into how many parts (k,) the longest steps of a slide are cut by outputs at places (k,) m."""
    parts = np.full(len(place), _PARTS)
    for arc in scene.stimulus.segments:
        if arc.curvature > 0:
            near = (place > arc.start - _AROUND / 2) & (place < arc.end + _AROUND)
            wanted = round(_OUTPUTS * slide_step / (arc.end - arc.start))
            parts = np.where(near, np.maximum(parts, min(wanted, _MOST_PARTS)), parts)
    return parts.astype(int)


def leg_durations(scene: Scene) -> list[float | None]:
    """Seconds of each leg; None for steady ones."""
    out: list[float | None] = [None] * len(scene.motion)
    for step in schedule(scene, 1, True):
        out[step.leg] = None if step.dt >= STEADY else (out[step.leg] or 0.0) + step.dt
    return out

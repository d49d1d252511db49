"""A scene's motion as steps, and how long its legs take."""

from __future__ import annotations

from functools import partial

import numpy as np

from fingerpad.scenes.scene import Scene
from fingerpad.stimuli.motion import STEADY, programme

_MOST_INCREMENTS = 8
_ROUND_EDGES = 4
"""Increments of a steady press by a stimulus with edges, round which nodes pop."""
_OUTPUTS = 28
"""Steps while an arc of the surface passes: the centre touches the sharpest convexities for three quarters of their length."""
_MOST_PARTS = 8
"""Of the longest step of a slide."""
_AT_START = 4
"""Parts of it where a slide begins and the skin starts to slip."""
_AROUND = 1.5e-3
"""How far (m) after a slide begins, and behind an arc, half of it before one: the skin is dragged along."""


def schedule(scene: Scene, steps_per_leg: int, timed: bool, slide_step: float | None = None, stride: int = 1, present=None):
    """Steps of the scene's motion (see :func:`fingerpad.stimuli.motion.programme`).

    A steady press is one step, which is cut where Newton's method does not converge. Friction remembers how it was loaded, and
    who gives the number of steps by hand (``slide_step`` None) wants to see them: then there are more.
    """
    on_the_way = bool(scene.friction) or slide_step is None
    return programme(
        scene.motion,
        steps=steps_per_leg,
        contact_length=scene.specimen.contact_length,
        timed=timed,
        snapshots=scene.outputs.snapshots,
        present=present,
        slide_step=slide_step,
        increments=min(steps_per_leg, _MOST_INCREMENTS if on_the_way else _ROUND_EDGES if scene.stimulus.singular else 1),
        parts=partial(_parts, scene, slide_step) if slide_step else None,
        stride=stride,
    )


def _parts(scene: Scene, slide_step: float, done: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Into how many parts (k,) the longest steps of a slide are cut, ``done`` (k,) m after it began, at places (k,) m."""
    parts = np.where(np.abs(done) < _AROUND, _AT_START, 1)
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

"""A scene's motion as steps, and how long its legs take."""

from __future__ import annotations

from fingerpad.scenes.scene import Scene
from fingerpad.stimuli.motion import STEADY, programme


def schedule(scene: Scene, steps_per_leg: int, timed: bool, slide_step: float | None = None, present=None):
    """Steps of the scene's motion (see :func:`fingerpad.stimuli.motion.programme`)."""
    return programme(
        scene.motion,
        steps=steps_per_leg,
        contact_length=scene.specimen.contact_length,
        timed=timed,
        snapshots=scene.outputs.snapshots,
        present=present,
        slide_step=slide_step,
    )


def leg_durations(scene: Scene) -> list[float | None]:
    """Seconds of each leg; None for steady ones."""
    out: list[float | None] = [None] * len(scene.motion)
    for step in schedule(scene, 1, True):
        out[step.leg] = None if step.dt >= STEADY else (out[step.leg] or 0.0) + step.dt
    return out

"""Symmetry: half the pad where pad, stimulus and motion are mirror images."""

from __future__ import annotations

from dataclasses import replace

from fingerpad.planning.effect import CYLINDER, PLATE, RAMP, Case, Effect, PlannedEffect, Shown
from fingerpad.specimen.ridges import RidgedPad


def decide(case: Case) -> Effect:
    """On where everything is its own mirror image in x = 0."""
    if case.scene.axisymmetric:
        return Effect(True, "a body of revolution: half its section is turned about x = 0")
    if not case.profile.symmetric:
        return Effect(False, "the stimulus is not symmetric about x = 0")
    if case.moves:
        return Effect(False, "the motion is not symmetric: the pad moves along the surface")
    if case.external is not None and not case.external.symmetric:
        return Effect(False, "the external mesh is not its own mirror image in x = 0")
    if case.decided["ridges"].on:
        if not RidgedPad(case.scene.specimen.outline, case.scene.specimen.ridges).symmetric:
            return Effect(False, "the ridges are not their own mirror image in x = 0")
    return Effect(
        True, "pad, stimulus and motion are mirror images in x = 0: half the unknowns suffice"
    )


LOPSIDED = {
    "stimulus": {
        "shape": "wavy",
        "curvatures": ["104.99 1/m", "209.97 1/m"],
        "lead_in": "1 mm",
        "run_out": "5 mm",
    }
}

EFFECT = PlannedEffect(
    name="symmetry",
    place=1,
    question="is half the pad enough?",
    decide=decide,
    turn_on=lambda parts: replace(parts, half=True),
    possible=lambda case: False,  # where the planner has not found it, it is not there
    after=("ridges",),
    always="half the pad: whenever pad, stimulus and motion are mirror images",
    shown=(
        Shown("lopsided wave", True, LOPSIDED | RAMP),
        Shown("ramp and hold, 210 1/m", False, CYLINDER | RAMP),
        Shown("ramp and hold, flat", False, PLATE | RAMP),
    ),
    title="symmetry (half the pad)",
    marker="s",
)

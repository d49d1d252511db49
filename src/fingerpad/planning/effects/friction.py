"""Coulomb friction between skin and stimulus."""

from __future__ import annotations

from dataclasses import replace

from fingerpad.planning.effect import (
    CYLINDER,
    OWN_PAIR,
    PLATE,
    PRESS,
    RAMP,
    Case,
    Effect,
    PlannedEffect,
    Shown,
    rule,
)


def decide(case: Case) -> Effect:
    """On in strokes with a coefficient; in presses where it changes more than the accuracy."""
    coefficient, rules = case.scene.friction, case.rules
    if coefficient == 0:
        return Effect(False, "the coefficient is 0")
    if any(leg.strokes for leg in case.scene.motion):
        return Effect(True, f"the skin is stroked with a coefficient of {coefficient:g}")
    worth = min(rules.pressing_friction * coefficient, rules.most_pressing_friction)
    why = (
        f"nothing slides; in a press a coefficient of {coefficient:g} changes up to {worth:.1%}, "
        f"{case.tolerance:.1%} is allowed"
    )
    return Effect(worth > case.tolerance, why)


STROKE = {"motion": [PRESS, {"slide": "4 mm", "speed": "10 mm/s"}]}

EFFECT = PlannedEffect(
    name="friction",
    place=4,
    question="does the skin stick to the stimulus?",
    decide=decide,
    turn_on=lambda parts: replace(parts, friction=parts.scene.friction),
    possible=lambda case: case.scene.friction != 0,
    # friction is left out of presses when what it changes is within the accuracy
    rules={
        "pressing_friction": rule(
            2.0, "friction of a press: on when this times the coefficient exceeds the accuracy"
        ),
        "most_pressing_friction": rule(
            0.2, "friction of a press: what that product comes to at most", OWN_PAIR
        ),
        "frictional": rule(
            1.2, "predicted cost: a step with friction over one without", "figures/tables/speed.md"
        ),
    },
    dearer=lambda rules: rules.frictional,
    always="friction: whenever the skin is stroked with a coefficient above 0",
    shown=(
        Shown("stroke of a plate, 0.7", True, PLATE | STROKE | {"friction": 0.7}),
        Shown("pressed only, flat, 0.7", True, PLATE | RAMP | {"friction": 0.7}),
        Shown("pressed only, 210 1/m, 0.01", False, CYLINDER | RAMP | {"friction": 0.01}),
    ),
    title="friction",
    marker="D",
)

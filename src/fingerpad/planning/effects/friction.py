"""Coulomb friction between skin and stimulus."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fingerpad.planning.effect import OWN_PAIR, Case, Effect, PlannedEffect, Shown, rule


@dataclass(frozen=True)
class FrictionRules:
    """Friction is left out of presses when what it changes is within the accuracy."""

    pressing_friction: float = rule(
        2.0, "friction of a press: on when this times the coefficient exceeds the accuracy"
    )
    most_pressing_friction: float = rule(
        0.2, "friction of a press: what that product comes to at most", OWN_PAIR
    )
    frictional: float = rule(
        1.2, "predicted cost: a step with friction over one without", "figures/tables/speed.md"
    )


def decide(case: Case) -> Effect:
    """On in strokes with a coefficient; in presses where it changes more than the accuracy."""
    coefficient, rules = case.scene.friction, case.rules
    if coefficient == 0:
        return Effect(False, "the coefficient is 0")
    if any(leg.strokes for leg in case.scene.motion):
        return Effect(True, f"the skin is stroked with a coefficient of {coefficient:g}")
    worth = min(rules.pressing_friction * coefficient, rules.most_pressing_friction)
    number = (
        f"in a press a coefficient of {coefficient:g} changes up to {worth:.1%}, "
        f"{case.tolerance:.1%} is allowed"
    )
    return Effect(worth > case.tolerance, f"nothing slides; {number}")


_PLATE, _CYLINDER = {"shape": "flat"}, {"shape": "cylinder", "curvature": "209.97 1/m"}
_RAMP = [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}]
_STROKE = [_RAMP[0], {"slide": "4 mm", "speed": "10 mm/s"}]

EFFECT = PlannedEffect(
    name="friction",
    question="does the skin stick to the stimulus?",
    decide=decide,
    turn_on=lambda parts: replace(parts, friction=parts.scene.friction),
    possible=lambda case: case.scene.friction != 0,
    rules=FrictionRules,
    dearer=lambda rules: rules.frictional,
    always="friction: whenever the skin is stroked with a coefficient above 0",
    shown=(
        Shown(
            "stroke of a plate, 0.7", True, {"stimulus": _PLATE, "friction": 0.7, "motion": _STROKE}
        ),
        Shown(
            "pressed only, flat, 0.7", True, {"stimulus": _PLATE, "friction": 0.7, "motion": _RAMP}
        ),
        Shown(
            "pressed only, 210 1/m, 0.01",
            False,
            {"stimulus": _CYLINDER, "friction": 0.01, "motion": _RAMP},
        ),
    ),
    title="friction",
    marker="D",
)

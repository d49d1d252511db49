"""Viscoelasticity: relaxation of the shear stress, or its long-term or instantaneous limit."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fingerpad.planning.effect import Case, Effect, LeftOut, PlannedEffect, Shown, rule
from fingerpad.planning.schedule import leg_durations
from fingerpad.specimen.materials import Prony


@dataclass(frozen=True)
class ViscoelasticityRules:
    """Shares of the accuracy; answers change by up to 2 and 7 times as much."""

    relaxation_share: float = rule(
        0.4, "viscoelasticity: off when stress can relax by less than this share of the accuracy"
    )
    lag_share: float = rule(
        0.15, "viscoelasticity: off when stress lags behind by less than this share of the accuracy"
    )


def decide(case: Case) -> Effect:
    """On unless nothing relaxes in the time the motion takes, or all does."""
    return _decide(case)[0]


def _decide(case: Case) -> tuple[Effect, str]:
    """The decision, and the moduli to solve with where time is left out: the instantaneous ones if
    the motion is over before anything relaxes.
    """
    scene, rules, tolerance = case.scene, case.rules, case.tolerance
    prony = Prony(
        tuple(t.g for t in scene.specimen.prony), tuple(t.tau for t in scene.specimen.prony)
    )
    if not prony:
        return Effect(False, "the specimen has no Prony series"), "long_term"
    durations = [
        case.contact.depth / leg.speed if leg.releases and leg.speed else duration
        for leg, duration in zip(scene.motion, leg_durations(scene), strict=True)
    ]
    if all(d is None for d in durations):
        return Effect(
            False, "no leg names a rate: steady states need the long-term moduli only"
        ), "long_term"
    timed = [d for d in durations if d is not None]
    limit, relaxed = rules.relaxation_share * tolerance, 1 - float(prony.relaxation(sum(timed)))
    if None not in durations and relaxed < limit:
        why = (
            f"the motion is over before {relaxed:.2%} of the stress can relax ({limit:.2%} "
            "allowed): instantaneous moduli"
        )
        return Effect(False, why), "instantaneous"
    loading = []
    for duration, leg in zip(durations, scene.motion, strict=True):
        if duration is None or not leg.loads:
            continue
        if leg.strokes:
            if case.profile.steepness == 0 and scene.friction == 0:
                continue  # a smooth plate sliding changes nothing
            # the narrowest contact is a new one, and the skin has stretched anew, after half its
            # width
            duration = min(duration, case.contact.half_width / leg.speed)
        loading.append(leg.quickest or duration)
    limit = rules.lag_share * tolerance
    lag = max((float(np.sum(prony.beta * np.asarray(prony.tau)) / d) for d in loading), default=0.0)
    if lag < limit:
        why = (
            f"so slow that viscosity adds at most {lag:.2%} to the stress ({limit:.2%} "
            "allowed): long-term moduli"
        )
        return Effect(False, why), "long_term"
    why = f"{relaxed:.0%} of the shear stress can relax within the {sum(timed):.3g} s of the motion"
    return Effect(True, why), "long_term"


def _ramp(rate: str) -> list[dict[str, str]]:
    return [{"press_to_force": "20 gf", "rate": rate}]


_CYLINDER = {"shape": "cylinder", "curvature": "209.97 1/m"}

EFFECT = PlannedEffect(
    name="viscoelasticity",
    question="does stress relax while the motion lasts?",
    decide=decide,
    turn_on=lambda parts: replace(parts, relaxes=True),
    left_out=lambda case: LeftOut(moduli=_decide(case)[1]),
    possible=lambda case: bool(case.scene.specimen.prony),
    rules=ViscoelasticityRules,
    shown=(
        Shown(
            "ramp of 0.5 s and hold",
            True,
            {"stimulus": _CYLINDER, "motion": [*_ramp("40 gf/s"), {"hold": "2 s"}]},
        ),
        Shown(
            "ramp of 3 ms, instantaneous moduli",
            False,
            {"stimulus": _CYLINDER, "motion": _ramp("6666.67 gf/s")},
            "instantaneous",
        ),
        Shown("ramp of 3 hours", False, {"stimulus": _CYLINDER, "motion": _ramp("0.002 gf/s")}),
    ),
    title="viscoelasticity",
    marker="o",
)

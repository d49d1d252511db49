"""Viscoelasticity: relaxation of the shear stress, or its long-term or instantaneous limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fingerpad.planning.effect import (
    CYLINDER,
    RAMP,
    Case,
    Effect,
    LeftOut,
    PlannedEffect,
    Shown,
    rule,
)
from fingerpad.planning.schedule import leg_durations
from fingerpad.specimen.materials import Prony


def decide(case: Case) -> Effect:
    """On unless nothing relaxes in the time the motion takes, or all does."""
    return _decide(case)[0]


def _decide(case: Case) -> tuple[Effect, str]:
    """The decision, and the moduli to solve with where time is left out: the instantaneous ones if
    the motion is over before anything relaxes.
    """
    scene, rules, tolerance = case.scene, case.rules, case.tolerance
    terms = scene.specimen.prony
    prony = Prony(tuple(term.g for term in terms), tuple(term.tau for term in terms))
    on, state = False, "long_term"
    durations = [
        case.contact.depth / leg.speed if leg.releases and leg.speed else duration
        for leg, duration in zip(scene.motion, leg_durations(scene), strict=True)
    ]
    timed = [duration for duration in durations if duration is not None]
    relaxed = 1 - float(prony.relaxation(sum(timed)))
    most_relaxed, most_lag = rules.relaxation_share * tolerance, rules.lag_share * tolerance
    if not prony:
        why = "the specimen has no Prony series"
    elif not timed:
        why = "no leg names a rate: steady states need the long-term moduli only"
    elif None not in durations and relaxed < most_relaxed:
        state = "instantaneous"
        why = (
            f"the motion is over before {relaxed:.2%} of the stress can relax "
            f"({most_relaxed:.2%} allowed): instantaneous moduli"
        )
    elif (lag := _lag(case, prony, durations)) < most_lag:
        why = (
            f"so slow that viscosity adds at most {lag:.2%} to the stress ({most_lag:.2%} "
            "allowed): long-term moduli"
        )
    else:
        on = True
        why = (
            f"{relaxed:.0%} of the shear stress can relax within the {sum(timed):.3g} s of the "
            "motion"
        )
    return Effect(on, why), state


def _lag(case: Case, prony: Prony, durations: list[float | None]) -> float:
    """Share of the stress that viscosity adds in the quickest leg that loads."""
    lag = 0.0
    for duration, leg in zip(durations, case.scene.motion, strict=True):
        if duration is None or not leg.loads:
            continue
        if leg.strokes:
            if case.profile.steepness == 0 and case.scene.friction == 0:
                continue  # a smooth plate sliding changes nothing
            # the narrowest contact is a new one, and the skin has stretched anew, after half its
            # width
            duration = min(duration, case.contact.half_width / leg.speed)
        lag = max(
            lag, float(np.sum(prony.beta * np.asarray(prony.tau)) / (leg.quickest or duration))
        )
    return lag


def _ramp(rate: str) -> dict[str, list]:
    return {"motion": [{"press_to_force": "20 gf", "rate": rate}]}


EFFECT = PlannedEffect(
    name="viscoelasticity",
    place=2,
    question="does stress relax while the motion lasts?",
    decide=decide,
    turn_on=lambda parts: replace(parts, relaxes=True),
    left_out=lambda case: LeftOut(moduli=_decide(case)[1]),
    possible=lambda case: bool(case.scene.specimen.prony),
    # shares of the accuracy; answers change by up to 2 and 7 times as much
    rules={
        "relaxation_share": rule(
            0.4,
            "viscoelasticity: off when stress can relax by less than this share of the accuracy",
        ),
        "lag_share": rule(
            0.15,
            "viscoelasticity: off when stress lags behind by less than this share of the accuracy",
        ),
    },
    shown=(
        Shown("ramp of 0.5 s and hold", True, CYLINDER | RAMP),
        Shown(
            "ramp of 3 ms, instantaneous moduli",
            False,
            CYLINDER | _ramp("6666.67 gf/s"),
            "instantaneous",
        ),
        Shown("ramp of 3 hours", False, CYLINDER | _ramp("0.002 gf/s")),
    ),
    title="viscoelasticity",
    marker="o",
)

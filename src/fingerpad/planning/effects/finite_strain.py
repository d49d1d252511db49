"""Finite strain: large displacements, rotations and strains, or their linear theory."""

from __future__ import annotations

from dataclasses import replace

from fingerpad.laws import departure
from fingerpad.planning.effect import (
    CYLINDER,
    PLATE,
    RAMP,
    Case,
    Effect,
    LeftOut,
    PlannedEffect,
    Shown,
    rule,
)


def small_strain_error(case: Case) -> float:
    """Of small strain in the headline quantities, at most: over depth / soft thickness; under edges
    also the strain itself.

    And by how much the layers' laws depart from the one that small strain is the limit of.
    """
    error = case.rules.small_strain_error * case.contact.depth / case.pad.soft_thickness
    return (max(error, case.contact.strain) if case.profile.singular else error) + _laws(case)


def _laws(case: Case) -> float:
    """By how much the layers' laws depart from the one that small strain is the limit of."""
    laws = [layer.law for layer in case.scene.specimen.materials.values()]
    return max(departure(law.law, law.constants, case.contact.strain) for law in laws)


def decide(case: Case) -> Effect:
    """On where small strain would be wrong by more than the accuracy."""
    error = small_strain_error(case)
    source = "from the depth and the layers' laws" if _laws(case) else "from the depth"
    why = (
        f"small strain would be wrong by up to {error:.1%} ({source}), {case.tolerance:.1%} is "
        "allowed"
    )
    return Effect(error > case.tolerance, why)


NEEDLE = {"stimulus": {"shape": "cylinder", "curvature": "1259.84 1/m"}}
LIGHT = {"motion": [{"press_to_force": "0.02 gf", "rate": "0.04 gf/s"}, {"hold": "2 s"}]}

EFFECT = PlannedEffect(
    name="finite_strain",
    place=3,
    question="are displacements and strains large?",
    decide=decide,
    turn_on=lambda parts: replace(parts, large_strain=True),
    left_out=lambda case: LeftOut(small_strain_error(case)),
    instead="small strain",
    # small strain is used where its error is within the accuracy
    rules={
        "small_strain_error": rule(
            4.6, "finite strain: on when this times depth / soft thickness exceeds the accuracy"
        )
    },
    dearer=lambda rules: (
        rules.seconds_finite
        * rules.iterations_finite
        / (rules.seconds_small * rules.iterations_small)
    ),
    shown=(
        Shown("20 gf, 1260 1/m", True, NEEDLE | RAMP),
        Shown("20 gf, flat", True, PLATE | RAMP),
        Shown("0.02 gf, 210 1/m", False, CYLINDER | LIGHT),
    ),
    title="finite strain",
    marker="^",
)

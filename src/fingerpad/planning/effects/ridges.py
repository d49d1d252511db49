"""Ridges of epidermis and skin."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fingerpad.planning.effect import Case, Effect, PlannedEffect, Shown, rule


@dataclass(frozen=True)
class RidgeRules:
    """Low inner ridges are left out of presses when what they change is within the accuracy."""

    ridge_change: float = rule(3.0, "ridges, inner, pressed: on when this times height / pitch exceeds the accuracy")
    ridge_width: float = rule(
        1 / 3, "half width of the contact, over the pitch, below which ridges change the more the narrower it is"
    )
    ridge_contrast: float = rule(
        11.0, "ridges: always on where the epidermis is stiffer than this times the dermis",
        "the thesis's moduli, 10; not studied beyond",
    )  # fmt: skip


def decide(case: Case) -> Effect:
    """On where the specimen has ridges, unless they are low inner ones that change less of a press than the accuracy."""
    specimen, rules = case.scene.specimen, case.rules
    ridges, layers = specimen.ridges, specimen.layers
    if ridges is None:
        return Effect(False, "the specimen has none")
    inner, outer = ridges.inner, ridges.outer
    why = f"the specimen has inner ridges {inner.pitch * 1e3:.3g} mm apart, {inner.height * 1e3:.3g} mm high"
    if outer is not None:
        why += f", and outer ones {(outer.period or inner.pitch) * 1e3:.3g} mm apart, {outer.height * 1e3:.3g} mm high"
    border = specimen.outline.epidermis_thickness
    depths = case.scene.outputs.receptors.depths
    known = (
        outer is None
        and not case.moves
        and layers.epidermis.youngs_modulus <= rules.ridge_contrast * layers.dermis.youngs_modulus
        and min((abs(depth - border) for depth in depths), default=border) > 2 * inner.height
    )
    narrow = max(1.0, rules.ridge_width * inner.pitch / max(case.contact.half_width, 1e-6))
    worth = rules.ridge_change * narrow * inner.height / inner.pitch
    if not known or worth > case.tolerance:
        return Effect(True, why)
    return Effect(False, f"{why}: they change up to {worth:.1%} of a press, {case.tolerance:.1%} is allowed")


def resolved(effect: Effect, layered: tuple, edge: float) -> tuple[Effect, float]:
    """The effect with how finely ridges are meshed, and the skin's edge (m) under the apex; ``edge`` without ridges."""
    from fingerpad.specimen.layered import ridge_resolution, skin_edge

    per_ridge, per_height = ridge_resolution(*layered)
    said = f"{per_ridge:.1f} elements from ridge to ridge, {per_height} rows within their height of the interface"
    return replace(effect, why=f"{effect.why}: {said}"), skin_edge(*layered[:3], edge)


_PRESS = {
    "stimulus": {"shape": "cylinder", "curvature": "209.97 1/m"},
    "motion": [{"press_to_force": "20 gf", "rate": "40 gf/s"}, {"hold": "2 s"}],
}

EFFECT = PlannedEffect(
    name="ridges",
    question="do ridges change the answers?",
    decide=decide,
    possible=lambda case: case.scene.specimen.ridges is not None,
    rules=RidgeRules,
    always="ridges: in strokes, outer ones, and near receptors whenever the specimen has them",
    shown=(
        Shown("inner, 0.15 mm high", True, _PRESS | {"specimen": {"ridges": "inner"}}),
        Shown("inner, 3 um high", False, _PRESS | {"specimen": {"ridges": {"inner": {"height": "3 um"}}}}),
    ),
    title="ridges",
    marker="v",
)

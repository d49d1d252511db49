"""Ridges of epidermis and skin."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fingerpad.planning.bounds import PlanError, check_size, micrometres
from fingerpad.planning.effect import (
    CYLINDER,
    RAMP,
    Case,
    Effect,
    Meshed,
    PlannedEffect,
    Shown,
    rule,
)
from fingerpad.scenes.scene import Scene
from fingerpad.scenes.specimen import Ridges
from fingerpad.specimen.layered import apex_column, ridge_resolution, skin_edge
from fingerpad.specimen.pad import MeshSize, all_over
from fingerpad.specimen.ridges import wave_of

_ROUND_OFF = 1e-12


def decide(case: Case) -> Effect:
    """On where the specimen has ridges, unless they are low inner ones that change less of a press
    than the accuracy.
    """
    specimen, rules = case.scene.specimen, case.rules
    ridges, layers = specimen.ridges, specimen.layers
    if ridges is None:
        return Effect(False, "the specimen has none")
    inner, outer = ridges.inner, ridges.outer
    why = (
        f"the specimen has inner ridges {inner.pitch * 1e3:.3g} mm apart, "
        f"{inner.height * 1e3:.3g} mm high"
    )
    if outer is not None:
        why += (
            f", and outer ones {(outer.period or inner.pitch) * 1e3:.3g} mm apart, "
            f"{outer.height * 1e3:.3g} mm high"
        )
    known = (
        outer is None
        and not case.moves
        and layers.epidermis.youngs_modulus <= rules.ridge_contrast * layers.dermis.youngs_modulus
        and not _felt(case.scene, rules)
    )
    narrow = max(1.0, rules.ridge_width * inner.pitch / max(case.contact.half_width, 1e-6))
    worth = rules.ridge_change * narrow * inner.height / inner.pitch
    if not known or worth > case.tolerance:
        return Effect(True, why)
    return Effect(
        False, f"{why}: they change up to {worth:.1%} of a press, {case.tolerance:.1%} is allowed"
    )


def _felt(scene: Scene, rules: Any) -> bool:
    """Whether a receptor is beside ridges."""
    border, height = scene.specimen.outline.epidermis_thickness, scene.specimen.ridges.inner.height
    return any(
        abs(depth - border) <= rules.ridge_near * height for depth in scene.outputs.receptors.depths
    )


def error_beside(inner: Any, elements: float, rules: Any) -> float:
    """Relative error of strain energies beside inner ridges, with so many elements from one ridge
    to the next.
    """
    return rules.ridge_error * inner.height / wave_of(inner) * elements**-rules.ridge_order


def mesh(case: Case, size: MeshSize, edge: float) -> Meshed:
    """The mesh, finer among ridges that receptors are beside, as the tolerance asks for."""
    specimen = case.scene.specimen
    size, error = _finer(case, size)
    check_size(case.scene, size, case.rules)
    _check_ridges(specimen.ridges, case.rules.most_nodes)
    ridges, corneum = specimen.ridges, specimen.layers.stratum_corneum is not None
    per_ridge, per_height = ridge_resolution(specimen.outline, size, ridges, corneum)
    middle = wave_of(ridges.inner) / (apex_column(size, ridges) / 3)
    said = (
        f"{per_ridge:.1f} elements from ridge to ridge, {middle:.1f} in the middle, "
        f"{per_height} rows within their height of the interface"
    )
    return Meshed(size, skin_edge(size, ridges, edge), error, said)


def _finer(case: Case, size: MeshSize) -> tuple[MeshSize, float]:
    """The mesh with the edges that receptors beside ridges need, and the error that is left."""
    scene, rules = case.scene, case.rules
    if not _felt(scene, rules):
        return size, 0.0
    ridges = scene.specimen.ridges
    wave, column = wave_of(ridges.inner), apex_column(size, ridges)
    by_hand = scene.by_hand.skin_edge is not None
    share = rules.ridge_stroked if case.moves else 1.0
    allowed = np.inf if by_hand else case.tolerance * share
    needed = (allowed / error_beside(ridges.inner, 1.0, rules)) ** (1 / rules.ridge_order)
    wanted = max(3 * wave * needed * (1 - _ROUND_OFF), rules.least_edge)
    if wanted < column:
        reach = max(map(abs, scene.outputs.receptors.offsets), default=0.0) + ridges.inner.pitch
        size, column = replace(size, focus=(*size.focus, *all_over(reach, wanted))), wanted
    return size, error_beside(ridges.inner, wave / (column / 3), rules)


def _check_ridges(ridges: Ridges, most_nodes: float) -> None:
    """Refuses ridges so narrow that they need more nodes than are allowed."""
    wave = wave_of(ridges.inner)
    nodes = 8 * 20 * 8 * (ridges.half_width + ridges.inner.pitch) / wave
    if nodes > most_nodes:
        least = micrometres(wave * nodes / most_nodes)
        raise PlanError(
            f"specimen.ridges.inner.pitch: {ridges.half_width / wave:.2g} ridges to either side "
            f"make {nodes:.2g} nodes; allowed: {most_nodes:g} nodes, a pitch of about "
            f"{least} um"
        )


EFFECT = PlannedEffect(
    name="ridges",
    place=5,
    question="do ridges change the answers?",
    decide=decide,
    turn_on=lambda parts: replace(parts, ridges=parts.scene.specimen.ridges),
    mesh=mesh,
    possible=lambda case: case.scene.specimen.ridges is not None,
    # low inner ridges are left out of presses when what they change is within the accuracy
    rules={
        "ridge_change": rule(
            3.0, "ridges, inner, pressed: on when this times height / pitch exceeds the accuracy"
        ),
        "ridge_width": rule(
            1 / 3,
            "half width of the contact, over the pitch, below which ridges change the more the "
            "narrower it is",
        ),
        "ridge_contrast": rule(
            11.0,
            "ridges: always on where the epidermis is stiffer than this times the dermis",
            "the thesis's moduli, 10; not studied beyond",
        ),
        "ridge_error": rule(
            7.0,
            "error of strain energies beside ridges: this times height / pitch, times (element / "
            "pitch) to a power",
            "figures/tables/accuracy_ridges.csv",
        ),
        "ridge_order": rule(1.5, "that power", "figures/tables/accuracy_ridges.csv"),
        "ridge_stroked": rule(
            0.5,
            "share of a tolerance that strain energies beside ridges are meshed for in strokes, "
            "whose rates follow from them",
            "figures/studies/accuracy_shown.csv",
        ),
        "ridge_near": rule(
            2.0,
            "receptors are beside ridges within so many heights of the depth at which the "
            "epidermis ends",
            "figures/tables/accuracy_ridges.csv",
        ),
    },
    always="ridges: in strokes, outer ones, and near receptors whenever the specimen has them",
    shown=(
        Shown("inner, 0.15 mm high", True, CYLINDER | RAMP | {"specimen": {"ridges": "inner"}}),
        Shown(
            "inner, 3 um high",
            False,
            CYLINDER | RAMP | {"specimen": {"ridges": {"inner": {"height": "3 um"}}}},
        ),
    ),
    title="ridges",
    marker="v",
)

"""What of a scene decides on its contact: motion, pad and surface, and the narrowest piece that has
to be resolved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fingerpad.planning.bounds import PlanError
from fingerpad.planning.effect import Case
from fingerpad.planning.estimates import ContactEstimate
from fingerpad.planning.rules import Rules
from fingerpad.planning.schedule import leg_durations
from fingerpad.planning.stack_estimate import pad_estimate
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.files import read_specimen_mesh
from fingerpad.specimen.measures import apex_edge
from fingerpad.specimen.pad import PadMesh
from fingerpad.stimuli.shapes.flat import Flat

_USUAL_FORCE = 0.01  # N, with which a finger touches
_BENDS, _SAME = 30, 1e-3  # steps in which a cone's bend over its contact is found, and how well
_INSIDE = 1.3  # times the contact, a face is not pressed to its edges
_FLATTER = 0.8  # pieces less than so much narrower than the contact are the contact


def case_of(scene: Scene, rules: Rules, narrowest: float | None = None) -> Case:
    """A scene with its contact estimated, before anything is decided.

    Parameters
    ----------
    narrowest
        m, half-width of the narrowest contact that a run has found, in place of the estimated one.

    Raises
    ------
    PlanError
        A measured profile is not over the finger, or the contact is narrower than any element.
    """
    external, stimulus = external_mesh(scene), scene.stimulus
    _check_over_pad(scene, external)
    # noise is no contact's curvature
    profile = stimulus.felt(_usual_edge(scene, external, rules))
    pad = pad_estimate(scene.specimen, external, stimulus.face, scene.axisymmetric)
    case = Case(scene, rules, external, profile, pad)
    # a surface is flat where it is pressed first, unless it is all curved; on its way the pad meets
    # the sharpest convexity
    curved = case.moves or not profile.uneven
    contact = worst_contact(case, profile.convexity if curved else 0.0)
    case = _within_face(replace(case, contact=contact))
    narrow = _narrowest(case, narrowest)
    case = replace(case, contact=replace(case.contact, narrowest=narrow))
    _check_width(case)
    return case


def external_mesh(scene: Scene) -> PadMesh | None:
    """The scene's own mesh, if it names one."""
    if scene.specimen.mesh is None:
        return None
    return read_specimen_mesh(scene.specimen, scene.axisymmetric).elevated()


def _usual_edge(scene: Scene, external: PadMesh | None, rules: Rules) -> float:
    """Edge (m) of the skin before the contact is known: of the mesh given, the preset, or the one
    by hand; else of the thesis.
    """
    if external is not None:
        return apex_edge(external)
    level = scene.accuracy if isinstance(scene.accuracy, str) else "thesis"
    return scene.by_hand.skin_edge or rules.presets[level].skin_edge


def _check_over_pad(scene: Scene, external: PadMesh | None) -> None:
    """`PlanError` for a measured profile that is not over the finger when it comes down."""
    first, last = scene.stimulus.known
    if external is not None:
        half = (
            np.abs(external.points[:, 0]).max()
            if external.half
            else np.ptp(external.points[:, 0]) / 2
        )
    else:
        half = scene.specimen.half_width
    if first > half / 2 or last < -half / 2:
        name = getattr(scene.stimulus.csv, "name", "x, y")
        raise PlanError(
            f"{scene.name}: stimulus.csv: '{name}' has points from x = {first * 1e3:.4g} mm to "
            f"{last * 1e3:.4g} mm, none of them over the finger; "
            "allowed: points around x = 0, which comes down on its apex"
        )


def worst_contact(case: Case, curvature: float) -> ContactEstimate:
    """The deepest contact of the motion with a surface of ``curvature`` 1/m."""
    scene, pad, profile = case.scene, case.pad, case.profile
    # at a kept depth the surface comes as much deeper as it reaches below its start
    keeps_depth = any(leg.kept == "depth" for leg in scene.motion)
    worst = ContactEstimate()
    for leg in scene.motion:
        if leg.force is not None:
            pressed, to = pad.pressed, leg.force / scene.specimen.contact_length
        elif leg.depth is not None:
            pressed, to = pad.pressed_to, leg.depth
        else:
            continue
        now, bend = pressed(to, curvature), curvature
        for _ in range(_BENDS if curvature == profile.convexity else 0):
            before, bend = bend, profile.bend_over(now.half_width)
            if abs(bend - before) <= _SAME * before:
                break
            now = pressed(to, bend)
        if keeps_depth:
            now = pad.pressed_to(now.depth + profile.dip, curvature)
        worst = max(worst, now, key=lambda estimate: estimate.depth)
    if np.isfinite(profile.face):
        wide = max(worst.half_width, profile.face)
        worst = replace(worst, half_width=wide, strain=max(worst.strain, 0.5))
    return worst


def _within_face(case: Case) -> Case:
    """The case with a plate for a profile whose face the contact is well inside of."""
    face = case.profile.face - case.profile.edge_radius
    if case.moves or not np.isfinite(face):
        return case
    plate = replace(case, profile=Flat())
    contact = worst_contact(plate, 0.0)
    inside = _INSIDE * contact.half_width < face
    return replace(plate, contact=contact) if inside else case


def _narrowest(case: Case, found: float | None) -> float | None:
    """Half-width (m) of the least piece of the contact where that is not the contact itself: a
    face, a tip, a bump; or found.
    """
    profile, half_width = case.profile, case.contact.half_width
    least = np.inf if found is None else found
    if profile.edges or (not profile.irregular and profile.reach[1] < half_width):
        least = min(least, profile.reach[1])
    elif profile.irregular:
        low, high = case.way
        bump = case.pad.least_piece(
            case.force, profile.outline, low - half_width, high + half_width
        )
        if bump < _FLATTER * half_width:
            least = min(least, bump)
    ridges = case.scene.specimen.ridges
    if ridges is not None and ridges.outer is not None:
        # the skin touches with the tops of its ridges
        least = min(least, (ridges.outer.period or ridges.inner.pitch) / 4)
    return float(least) if np.isfinite(least) else None


def earliest_half_width(case: Case, timed: bool) -> float:
    """Half width (m) of the contact before anything relaxes: narrower as the root of the modulus is
    larger.
    """
    specimen, contact = case.scene.specimen, case.contact
    relaxes = timed and specimen.moduli == "long_term"
    share = (1 - sum(term.g for term in specimen.prony)) ** 0.5 if relaxes else 1.0
    earliest = share * contact.half_width
    return earliest if contact.narrowest is None else min(earliest, contact.narrowest)


def _check_width(case: Case) -> None:
    """Refuses contacts narrower than any element."""
    scene, least = case.scene, case.rules.least_half_width
    if case.contact.half_width >= least:
        return
    said = (
        f"the contact would be {case.contact.half_width * 1e9:.2g} nm to either side; allowed: "
        f"{least * 1e9:g} nm or more"
    )
    usual = max(case.force, _USUAL_FORCE / scene.specimen.contact_length)
    if case.pad.pressed(usual, max(scene.stimulus.convexity, 0.0)).half_width >= least:
        i, leg = next((i, leg) for i, leg in enumerate(scene.motion) if leg.presses)
        raise PlanError(f"motion[{i}].{leg.key}: so little that {said}")
    key = ".curvature" if hasattr(scene.stimulus, "curvature") else ""
    raise PlanError(f"stimulus{key}: so sharp that {said}")


def inertia_ratio(case: Case) -> float:
    """rho v^2 / mu of the softest layer, what leaving inertia out of the equations neglects;
    `PlanError` where it is too large.
    """
    scene, limit = case.scene, case.rules.inertia_limit
    layers = scene.specimen.materials.values()
    softest = min(layer.youngs_modulus / (2 * (1 + layer.poisson_ratio)) for layer in layers)
    speed = [0.0] * len(scene.motion)
    for i, (leg, duration) in enumerate(zip(scene.motion, leg_durations(scene), strict=True)):
        if leg.loads and (duration or leg.speed):
            speed[i] = leg.speed or (leg.depth or case.contact.depth) / (leg.quickest or duration)
    inertia = 1000.0 * max(speed) ** 2 / softest
    if inertia > limit:
        raise PlanError(
            f"motion[{speed.index(max(speed))}]: so fast that inertia matters "
            f"(rho v^2 / mu = {inertia:.2g}); allowed: up to {limit:g}"
        )
    return inertia

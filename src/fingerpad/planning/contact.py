"""What of a scene decides on its contact: motion, pad and surface, and the narrowest piece that has
to be resolved.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fingerpad.planning.bounds import PlanError
from fingerpad.planning.estimates import ContactEstimate, PadEstimate
from fingerpad.planning.rules import Rules
from fingerpad.planning.schedule import leg_durations
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.files import read_specimen_mesh
from fingerpad.specimen.pad import PadMesh
from fingerpad.stimuli.profile import Profile

_USUAL_FORCE = 0.01  # N, with which a finger touches
_FLATTER = 0.8  # pieces less than so much narrower than the contact are the contact


def moves_along(scene: Scene) -> bool:
    return any(leg.along for leg in scene.motion)


def way_of(scene: Scene) -> tuple[float, float]:
    """Least and largest x (m) of the stimulus that comes over the middle of the pad."""
    way = np.cumsum([0.0, *(leg.along for leg in scene.motion)])
    return float(way.min()), float(way.max())


def external_mesh(scene: Scene) -> PadMesh | None:
    """The scene's own mesh, if it names one."""
    return None if scene.specimen.mesh is None else read_specimen_mesh(scene.specimen).elevated()


def check_over_pad(scene: Scene, external: PadMesh | None) -> None:
    """`PlanError` for a measured profile that is not over the finger when it comes down."""
    first, last = scene.stimulus.known
    if external is not None:
        half = np.ptp(external.points[:, 0]) / 2
    else:
        half = (scene.specimen.outline or scene.specimen.stack).half_width
    if first > half / 2 or last < -half / 2:
        name = getattr(scene.stimulus.csv, "name", "x, y")
        there = f"from x = {first * 1e3:.4g} mm to {last * 1e3:.4g} mm"
        raise PlanError(
            f"{scene.name}: stimulus.csv: '{name}' has points {there}, none of them over the "
            "finger; "
            "allowed: points around x = 0, which comes down on its apex"
        )


def worst_contact(
    scene: Scene, pad: PadEstimate, profile: Profile, curvature: float
) -> ContactEstimate:
    """The deepest contact of the motion with a surface of ``curvature`` 1/m."""
    specimen = scene.specimen
    # at a kept depth the surface comes as much deeper as it reaches below its start
    keeps_depth = any(leg.kept == "depth" for leg in scene.motion)
    worst = ContactEstimate(0.0, 0.0, 0.0)
    for leg in scene.motion:
        if leg.force is not None:
            now = pad.pressed(leg.force / specimen.contact_length, curvature)
        elif leg.depth is not None:
            now = pad.pressed_to(leg.depth, curvature)
        else:
            continue
        if keeps_depth:
            now = pad.pressed_to(now.depth + profile.dip, curvature)
        worst = max(worst, now, key=lambda estimate: estimate.depth)
    if np.isfinite(profile.face):
        wide = max(worst.half_width, profile.face)
        worst = replace(worst, half_width=wide, strain=max(worst.strain, 0.5))
    return worst


def least_half_width(
    scene: Scene, pad: PadEstimate, profile: Profile, contact: ContactEstimate, found: float | None
) -> float | None:
    """Half-width (m) of the least piece of the contact where that is not the contact itself: a
    face, a tip, a bump; or found.
    """
    least = np.inf if found is None else found
    if profile.edges or (not profile.irregular and profile.reach[1] < contact.half_width):
        least = min(least, profile.reach[1])
    elif profile.irregular:
        low, high = way_of(scene)
        force = pressing_force(scene, pad, contact)
        bump = pad.least_piece(
            force, profile.outline, low - contact.half_width, high + contact.half_width
        )
        least = min(least, bump if bump < _FLATTER * contact.half_width else np.inf)
    if scene.specimen.ridges is not None and scene.specimen.ridges.outer is not None:
        period = scene.specimen.ridges.outer.period or scene.specimen.ridges.inner.pitch
        least = min(least, period / 4)  # the skin touches with the tops of its ridges
    return float(least) if np.isfinite(least) else None


def earliest_half_width(scene: Scene, contact: ContactEstimate, timed: bool) -> float:
    """Half width (m) of the contact before anything relaxes: narrower as the root of the modulus is
    larger.
    """
    relaxes = timed and scene.specimen.moduli == "long_term"
    share = (1 - sum(term.g for term in scene.specimen.prony)) ** 0.5 if relaxes else 1.0
    earliest = share * contact.half_width
    return earliest if contact.narrowest is None else min(earliest, contact.narrowest)


def contact_reach(scene: Scene, contact: ContactEstimate) -> float:
    """How far (m) the contact reaches to either side."""
    return min(contact.half_width, scene.stimulus.face)


def pressing_force(scene: Scene, pad: PadEstimate, contact: ContactEstimate) -> float:
    """Largest force (N/m) of the motion: that of its legs, or what presses to the estimated
    depth.
    """
    forces = [leg.force for leg in scene.motion if leg.force is not None]
    return max(forces) / scene.specimen.contact_length if forces else pad.force_of(contact.depth)


def rounding_of(
    scene: Scene, pad: PadEstimate, profile: Profile, contact: ContactEstimate
) -> float:
    """Length (m) of the contact on the rounded edges of a face."""
    return pad.on_rounding(
        pressing_force(scene, pad, contact),
        profile.reach[1] - profile.edge_radius,
        profile.edge_radius,
    )


def check_width(scene: Scene, pad: PadEstimate, contact: ContactEstimate, rules: Rules) -> None:
    """Refuses contacts narrower than any element."""
    if contact.half_width >= rules.least_half_width:
        return
    force = pressing_force(scene, pad, contact)
    least = rules.least_half_width * 1e9
    said = (
        f"the contact would be {contact.half_width * 1e9:.2g} nm to either side; allowed: "
        f"{least:g} nm or more"
    )
    usual = max(force, _USUAL_FORCE / scene.specimen.contact_length)
    if pad.pressed(usual, max(scene.stimulus.convexity, 0.0)).half_width >= rules.least_half_width:
        i, leg = next((i, leg) for i, leg in enumerate(scene.motion) if leg.presses)
        raise PlanError(f"motion[{i}].{leg.key}: so little that {said}")
    key = ".curvature" if hasattr(scene.stimulus, "curvature") else ""
    raise PlanError(f"stimulus{key}: so sharp that {said}")


def inertia_ratio_of(scene: Scene, contact: ContactEstimate) -> tuple[float, int]:
    """rho v^2 / mu of the softest layer, what leaving inertia out of the equations neglects; and
    the fastest leg.
    """
    layers = scene.specimen.materials.values()
    softest = min(layer.youngs_modulus / (2 * (1 + layer.poisson_ratio)) for layer in layers)
    speed = [0.0] * len(scene.motion)
    for i, (leg, duration) in enumerate(zip(scene.motion, leg_durations(scene), strict=True)):
        if leg.loads and (duration or leg.speed):
            speed[i] = leg.speed or (leg.depth or contact.depth) / (leg.quickest or duration)
    fastest = int(np.argmax(speed))
    return 1000.0 * speed[fastest] ** 2 / softest, fastest

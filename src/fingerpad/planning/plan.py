"""Scene -> plan: which effects the scene calls for, which discretisation, why, and the cost.

Nothing is solved here. Every choice carries a sentence with the number that decided it, and every
choice can be overridden in the scene. The thresholds and measured constants stand together in
:class:`fingerpad.planning.rules.Rules`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.planning.bounds import PlanError, check_memory, check_size, micrometres, percent
from fingerpad.planning.contact import (
    check_over_pad,
    check_width,
    earliest_half_width,
    external_mesh,
    inertia_ratio_of,
    least_half_width,
    moves_along,
    pressing_force,
    rounding_of,
    way_of,
    worst_contact,
)
from fingerpad.planning.discretisation import (
    edges_error,
    element_for,
    height_at_receptors,
    mesh_size_for,
    peak_is_unbounded,
    preset_for,
    raised_for,
    usual_edge,
    wander_of,
)
from fingerpad.planning.effect import Case, Effect, Parts
from fingerpad.planning.effects import EFFECTS, in_order, parts_of
from fingerpad.planning.errors import COARSER, estimated_error, own_errors, stroke_of
from fingerpad.planning.estimates import ContactEstimate
from fingerpad.planning.plan_data import Plan, read_plan
from fingerpad.planning.rules import RULES, Preset, Rules
from fingerpad.planning.schedule import expected_states, schedule
from fingerpad.planning.stack_estimate import pad_estimate, specimen_said
from fingerpad.planning.surface import surface_of
from fingerpad.planning.unbounded import Unbounded, ends_unbounded, in_words, seen_corners
from fingerpad.scenes.scene import Discretisation, Scene, load_scene
from fingerpad.specimen import counted, shortest_edge
from fingerpad.specimen.measures import apex_edge, skin_ends
from fingerpad.specimen.pad import MeshSize, PadMesh
from fingerpad.stimuli.profile import Profile

__all__ = ["RULES", "Plan", "PlanError", "Rules", "companion", "plan", "read_plan", "refined"]

_WORTH = 0.9  # of an error, to which a finer mesh must bring it to be run on


def plan(scene: Scene | str | Path | Mapping[str, Any], rules: Rules | None = None) -> Plan:
    """Decide effects and discretisation of a scene.

    Parameters
    ----------
    scene
        A checked scene, or a file or dictionary of one.
    rules
        Thresholds (default: :data:`RULES`).

    Returns
    -------
    Plan

    Raises
    ------
    SceneError
        The file or the dictionary is wrong.
    PlanError
        An override asks for what the scene cannot have, or the mesh for more than the machine has.
    MeshError
        An external mesh cannot be read, or the pad has no room for its ridges.

    Examples
    --------
    >>> press = {
    ...     "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    ...     "motion": [{"press_to_force": "20 gf"}],
    ...     "accuracy": "draft",
    ... }
    >>> chosen = plan(press)
    >>> chosen.effects["friction"].on, chosen.effects["friction"].why
    (False, 'the coefficient is 0')
    >>> chosen.estimated_error < 0.15
    True
    """
    return _planned(load_scene(scene), rules or RULES)


def _planned(
    scene: Scene, rules: Rules, narrowest: float | None = None, aim: float | None = None
) -> Plan:
    """The plan of a scene.

    Parameters
    ----------
    narrowest
        m, half-width of the narrowest contact that a run has found, in place of the estimated one.
    aim
        Relative error that the mesh is made for where that is less than the scene asks.
    """
    external = external_mesh(scene)
    measured = scene.stimulus
    check_over_pad(scene, external)
    # noise is no contact's curvature
    profile = measured.felt(usual_edge(scene, external, rules))
    pad = pad_estimate(scene.specimen, external, measured.face)
    moves, stroke = moves_along(scene), stroke_of(scene, profile.uneven)
    # a surface is flat where it is pressed first, unless it is all curved; on its way the pad meets
    # the sharpest convexity
    curvature = profile.convexity if moves or not profile.uneven else 0.0
    contact = worst_contact(scene, pad, profile, curvature)
    contact = replace(contact, narrowest=least_half_width(scene, pad, profile, contact, narrowest))
    check_width(scene, pad, contact, rules)
    inertia = _inertia(scene, contact, rules)
    rounded = profile.edges and not profile.unbounded
    rounding = rounding_of(scene, pad, profile, contact) if rounded else 0.0
    preset, by_hand = preset_for(scene, rules, contact, aim, stroke)
    tolerance = preset.tolerance
    case = Case(scene, profile, pad, contact, external, moves, tolerance, rules, {})
    effects = _decided(case)
    parts = parts_of(scene, effects)
    left_out = {name: EFFECTS[name].left_out(case) for name in effects}

    timed = parts.relaxes
    steps_per_leg, slide_step, every = preset.steps, preset.slide_step, 1
    if by_hand and by_hand.steps:
        steps_per_leg, slide_step = max(1, round(by_hand.steps / len(scene.motion))), None
    elif timed:
        steps_per_leg = max(steps_per_leg, scene.outputs.per_leg or 0)
        every = steps_per_leg // preset.steps
    scheduled = list(schedule(scene, steps_per_leg, timed, slide_step, every=every))
    outputs, steps = len(scheduled), expected_states(scheduled, slide_step)
    contact_error: dict[str, Any] = {
        "half_width": earliest_half_width(scene, contact, timed),
        "steps": steps_per_leg / every if timed or moves else None,
        "stroke": stroke,
        "bumpy": scene.stimulus.irregular,
        "rules": rules,
    }
    if external is None:
        mesh = _built(case, preset, by_hand, effects, parts, rounding, contact_error)
    else:
        mesh = _given(case, external, by_hand, rounding, contact_error)
    nodes = mesh.nodes // 2 + 1 if parts.half else mesh.nodes
    check_memory(scene, nodes, outputs, rules)

    surface = surface_of(
        measured,
        mesh.edge,
        way_of(scene),
        pad,
        partial(worst_contact, scene, pad, profile),
        pressing_force(scene, pad, contact),
        rules.profile_share * tolerance,
    )
    at_edges, edges_said = edges_error(profile, mesh.edge_at_edges, rounding, rules)
    mesh_error = surface.error + max(mesh.in_contact, at_edges, mesh.at_receptors)
    without = {name: left_out[name].error for name, effect in effects.items() if not effect.on}
    for name, error in list(without.items()):
        total = sum(without.values()) + mesh_error
        asked = None if name in scene.effects else scene.tolerance
        if error and asked is not None and total > asked:
            effects[name] = Effect(
                True,
                f"{EFFECTS[name].instead} would be wrong by up to {error:.1%} beside the mesh's "
                f"{mesh_error:.1%}: too much for both",
            )
            del without[name]
    sources = {
        f"edges of {micrometres(mesh.edge)} um in a contact of "
        f"{micrometres(contact_error['half_width'])} um to either side": mesh.in_contact,
        edges_said: at_edges,
        f"elements {mesh.place} that receptors are in": mesh.at_receptors,
        **{EFFECTS[name].instead: error for name, error in without.items()},
        "what the mesh cannot feel of the profile": surface.error,
    }
    unresolved = peak_is_unbounded(profile, mesh.edge_at_edges, rounding, rules)
    unresolved = unresolved and not profile.unbounded
    final = measured.at(surface.smoothing, mesh.edge)
    instantaneous = any(each.moduli == "instantaneous" for each in left_out.values())
    return Plan(
        effects=effects | mesh.effects,
        state="instantaneous" if instantaneous else "long_term",
        element=mesh.element,
        mesh_size=mesh.size,
        contact=contact,
        steps_per_leg=steps_per_leg,
        slide_step=slide_step,
        steps=steps,
        timed=timed,
        nodes=nodes,
        smallest_edge=mesh.smallest,
        inertia_ratio=inertia,
        contact_edge=mesh.edge,
        estimated_error=sum(without.values()) + mesh_error,
        predicted_cost_s=_cost(nodes, steps, effects, rules),
        small_strain_error=sum(without.values()),
        least_error=max(at_edges, mesh.at_receptors),
        error_from=max(sources, key=sources.__getitem__),
        asked_error=scene.tolerance,
        once=scene.once,
        unbounded=_unbounded(case, final, mesh.external, mesh.edge, unresolved),
        specimen=(*specimen_said(scene.specimen, mesh.external), *mesh.notes, *measured.notes),
        surface=surface,
        strokes=moves,
        outputs=outputs,
        every=every,
        unresolved_edge=unresolved,
        errors=mesh.errors,
        receptor_height=mesh.receptor_height,
    )


@dataclass(frozen=True)
class _Mesh:
    """The mesh of a plan, and what it is expected to be wrong by.

    ``edge``: m, of the skin under the apex; ``edge_at_edges``: m, where the profile has edges.
    ``in_contact``, ``at_receptors``: relative errors. ``effects``: whose reasons name the mesh.
    """

    element: str
    nodes: int
    smallest: float
    edge: float
    edge_at_edges: float
    in_contact: float
    place: str
    size: MeshSize | None = None
    at_receptors: float = 0.0
    effects: dict[str, Effect] = field(default_factory=dict)
    external: PadMesh | None = None
    errors: dict[str, float] = field(default_factory=dict)
    receptor_height: float | None = None
    notes: tuple[str, ...] = ()


def _built(
    case: Case,
    preset: Preset,
    by_hand: Discretisation | None,
    effects: Mapping[str, Effect],
    parts: Parts,
    rounding: float,
    contact_error: Mapping[str, Any],
) -> _Mesh:
    """A mesh that is built for the scene."""
    scene, profile, pad, rules = case.scene, case.profile, case.pad, case.rules
    # on its way over a surface the contact is also flat
    widest = case.contact
    if case.moves and profile.uneven:
        widest = worst_contact(scene, pad, profile, 0.0)
    wander = wander_of(scene, pad, profile, parts.friction, rules) if case.moves else 0.0
    size = mesh_size_for(
        scene, preset, profile, case.contact, widest.half_width, wander, rounding, rules
    )
    # a contact that moves leaves the middle, where a stroked pad is finer
    at_apex = [] if case.moves else [edge for x, edge in size.focus if x == 0]
    edge = min([size.skin_edge, *at_apex])
    finest = min([edge, *(each for _, each in size.focus)])
    at_receptors, meshed_effects = 0.0, {}
    for name, effect in effects.items():
        if effect.on and (mesh := EFFECTS[name].mesh):
            meshed = mesh(case, size, edge)
            meshed_effects[name] = replace(effect, why=f"{effect.why}: {meshed.said}")
            size, edge = meshed.size, meshed.edge
            at_receptors = max(at_receptors, meshed.error)
    check_size(scene, size, rules)
    nodes, smallest = counted(scene.specimen, size, parts.ridges)
    edge_at_edges = min(edge, finest)
    if profile.edge_radius and scene.tolerance is None:
        # presets are fine beside the face, not where it ends and the pressure is largest
        grown = edge_at_edges + np.log(size.growth) * profile.edge_radius
        edge_at_edges = min(grown, size.skin_edge)
    return _Mesh(
        element_for(by_hand, None),
        nodes,
        smallest,
        edge,
        edge_at_edges,
        estimated_error(edge, body_edge=size.skin_edge, **contact_error),
        "among ridges",
        size,
        at_receptors,
        meshed_effects,
    )


def _given(
    case: Case,
    external: PadMesh,
    by_hand: Discretisation | None,
    rounding: float,
    contact_error: Mapping[str, Any],
) -> _Mesh:
    """The scene's own mesh, raised to quadratic elements where the accuracy needs it."""
    scene, profile = case.scene, case.profile

    def errors(mesh: PadMesh, element: str) -> dict[str, float]:
        height = height_at_receptors(scene, mesh)
        return own_errors(element, apex_edge(mesh), at_receptors=height, **contact_error)

    def largest(mesh: PadMesh) -> float:
        at_edges, _ = edges_error(profile, apex_edge(mesh), rounding, case.rules)
        return max(*errors(mesh, element_for(None, mesh)).values(), at_edges)

    external, raised = raised_for(by_hand, external, case.tolerance, largest)
    element, edge = element_for(by_hand, external), apex_edge(external)
    by_quantity = errors(external, element)
    return _Mesh(
        element,
        len(external.points),
        shortest_edge(external),
        edge,
        edge,
        max(by_quantity.values()),
        "in the mesh",
        external=external,
        errors=by_quantity,
        receptor_height=height_at_receptors(scene, external),
        notes=tuple(filter(None, [raised])),
    )


def _inertia(scene: Scene, contact: ContactEstimate, rules: Rules) -> float:
    """rho v^2 / mu of the motion, which a quasi-static solution neglects; refuses too large
    ones.
    """
    inertia, fastest = inertia_ratio_of(scene, contact)
    if inertia > rules.inertia_limit:
        raise PlanError(
            f"motion[{fastest}]: so fast that inertia matters (rho v^2 / mu = {inertia:.2g}); "
            f"allowed: up to {rules.inertia_limit:g}"
        )
    return inertia


def _unbounded(
    case: Case, profile: Profile, external: PadMesh | None, edge: float, unresolved: bool
) -> Unbounded:
    """Where contact is expected at which pressure has no bound."""
    scene, pad, half_width = case.scene, case.pad, case.contact.half_width
    low, high = way_of(scene)
    pressure = 2 / np.pi * pressing_force(scene, pad, case.contact) / half_width
    corners = (
        profile.tangents()
        if unresolved
        else seen_corners(profile.corners(), pad.stiff, pressure, edge / 2, half_width)
    )
    corners = corners[(corners >= low - half_width) & (corners <= high + half_width)]
    places, friction = list(in_words(profile, corners)), scene.friction > 0
    if external is not None:
        for node, angle in skin_ends(external):
            x = external.points[node, 0]
            if abs(x) <= half_width and ends_unbounded(angle, friction):
                places.append(f"the end of the skin at x = {x * 1e3:.4g} mm")
    centre = np.any((corners >= low - 2 * edge) & (corners <= high + 2 * edge))
    return Unbounded(tuple(places), bool(centre))


def refined(
    scene: Scene,
    before: Plan,
    error: float,
    narrowest: float,
    runs: int = 1,
    rules: Rules | None = None,
) -> Plan | str:
    """The plan of another run of a scene whose run missed its tolerance.

    Parameters
    ----------
    before
        The plan of the run.
    error
        Relative, what the run estimates of itself.
    narrowest
        m, half-width of the narrowest contact that it found.
    runs
        So far.

    Returns
    -------
    Plan or str
        The plan, or why there is none ("" where none is wanted).
    """
    rules = rules or RULES
    asked = before.asked_error
    if asked is None or before.missed(error) is None or before.once:
        return ""
    if before.mesh_size is None:
        return "an external mesh is not refined"
    if runs >= rules.most_runs:
        return f"after {runs} runs"
    # what misses by some share is aimed at by as much below
    aim = asked * min(_WORTH, max(asked / error, 0.25))
    finer = _planned(scene, rules, narrowest, aim)
    if finer.estimated_error > _WORTH * error:
        return "a finer mesh would not help"
    if finer.nodes > rules.most_nodes_again:
        return f"{percent(finer.estimated_error)} would need {finer.nodes} nodes"
    return finer


def companion(scene: Scene, own: Plan, stride: int = 1, coarser: float = COARSER) -> Plan:
    """The plan of a run's companion: its `own` in all but edges so many times as long, and so many
    steps made one.

    An external mesh keeps its edges: linear quads are solved as quadratic ones and the other way
    round, all others as they are.
    """
    scheduled = list(
        schedule(scene, own.steps_per_leg, own.timed, own.slide_step, stride, own.every)
    )
    steps = expected_states(scheduled, own.slide_step, stride)
    out, parts = replace(own, stride=stride, steps=steps, outputs=len(scheduled)), own.parts(scene)
    if own.mesh_size is not None:
        size = own.mesh_size.coarser(coarser)
        nodes, smallest = counted(scene.specimen, size, parts.ridges)
        nodes = nodes // 2 + 1 if parts.half else nodes
        edge, error = coarser * own.contact_edge, coarser * own.estimated_error
        out = replace(
            out,
            mesh_size=size,
            nodes=nodes,
            smallest_edge=smallest,
            contact_edge=edge,
            estimated_error=error,
        )
    elif (external := external_mesh(scene)) and external.element == "quad4":
        element = "Q1P0" if own.element == "Q2P1" else "Q2P1"
        nodes = len(external.elevated(element).points)
        out = replace(out, element=element, nodes=nodes // 2 + 1 if parts.half else nodes)
    return replace(out, predicted_cost_s=_cost(out.nodes, steps, out.effects, RULES))


def _decided(case: Case) -> dict[str, Effect]:
    """Every effect as it is decided, or as the scene will have it; in the order of the register."""
    decided: dict[str, Effect] = {}
    for planned in in_order():
        now = replace(case, decided=dict(decided))
        effect, wanted = planned.decide(now), case.scene.effects.get(planned.name)
        if wanted is not None and wanted != effect.on:
            if wanted and not planned.possible(now):
                raise PlanError(
                    f"{case.scene.name}: effects.{planned.name}: on, but {effect.why}; "
                    "allowed: off or auto"
                )
            planner = f"the planner: {'on' if effect.on else 'off'}, {effect.why}"
            effect = Effect(wanted, f"asked for in the scene ({planner})")
        decided[planned.name] = effect
    return {name: decided[name] for name in EFFECTS}


def _cost(nodes: int, steps: int, effects: Mapping[str, Effect], rules: Rules) -> float:
    """Seconds of one core."""
    work = rules.seconds_small * rules.iterations_small * nodes * steps
    for name, effect in effects.items():
        work *= EFFECTS[name].dearer(rules) if effect.on else 1.0
    return float(rules.seconds_start + work)

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
    case_of,
    earliest_half_width,
    external_mesh,
    inertia_ratio,
    worst_contact,
)
from fingerpad.planning.discretisation import (
    edges_error,
    element_for,
    height_at_receptors,
    mesh_size_for,
    preset_for,
    raised_for,
    tip_error,
    unresolved_edge,
)
from fingerpad.planning.effect import Case, Effect, Parts
from fingerpad.planning.effects import EFFECTS, in_order, parts_of
from fingerpad.planning.errors import COARSER, ContactErrors
from fingerpad.planning.plan_data import Plan, read_plan
from fingerpad.planning.rules import RULES, Preset, Rules
from fingerpad.planning.schedule import expected_states, schedule
from fingerpad.planning.stack_estimate import specimen_said
from fingerpad.planning.surface import Surface, surface_of
from fingerpad.planning.unbounded import (
    Unbounded,
    ends_unbounded,
    in_words,
    seen_corners,
    unseen_error,
)
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.specimen import counted, shortest_edge
from fingerpad.specimen.measures import apex_edge, skin_ends
from fingerpad.specimen.pad import MeshSize, PadMesh

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
    case = case_of(scene, rules, narrowest)
    inertia = inertia_ratio(case)
    preset = preset_for(case, aim)
    case = replace(case, tolerance=preset.tolerance)
    case = replace(case, decided=_decided(case))
    effects, parts = dict(case.decided), parts_of(scene, case.decided)
    timed, by_hand = parts.relaxes, scene.by_hand

    steps_per_leg, slide_step, every = preset.steps, preset.slide_step, 1
    if by_hand.steps:
        steps_per_leg, slide_step = max(1, round(by_hand.steps / len(scene.motion))), None
    elif timed:
        steps_per_leg = max(steps_per_leg, scene.outputs.per_leg or 0)
        every = steps_per_leg // preset.steps
    scheduled = list(schedule(scene, steps_per_leg, timed, slide_step, every=every))
    outputs, steps = len(scheduled), expected_states(scheduled, slide_step)
    errors = ContactErrors(
        rules,
        earliest_half_width(case, timed),
        steps_per_leg / every if timed or case.moves else None,
        case.stroke,
        scene.stimulus.irregular,
        scene.axisymmetric,
    )
    mesh = _built(case, preset, parts, errors) if case.external is None else _given(case, errors)
    cut = parts.half and not (mesh.external is not None and mesh.external.half)
    nodes = mesh.nodes // 2 + 1 if cut else mesh.nodes
    check_memory(scene, nodes, outputs, rules)

    surface = surface_of(case, mesh.edge, partial(worst_contact, case))
    at_edges, edges_said = edges_error(case, mesh.edge_at_edges)
    felt = scene.stimulus.at(surface.smoothing, mesh.edge)
    at_tip, tip_said = tip_error(case, felt, mesh.edge_at_tip)
    at_corners = _unseen(case, mesh.edge, surface)
    mesh_error = surface.error + max(
        mesh.in_contact, at_edges, at_tip, at_corners, mesh.at_receptors
    )
    left_out = {name: EFFECTS[name].left_out(case) for name in effects}
    without = {name: left_out[name].error for name, effect in effects.items() if not effect.on}
    for name, error in list(without.items()):
        asked = None if name in scene.effects else scene.tolerance
        if error and asked is not None and sum(without.values()) + mesh_error > asked:
            effects[name] = Effect(
                True,
                f"{EFFECTS[name].instead} would be wrong by up to {error:.1%} beside the mesh's "
                f"{mesh_error:.1%}: too much for both",
            )
            del without[name]
    sources = {
        f"edges of {micrometres(mesh.edge)} um in a contact of "
        f"{micrometres(errors.half_width)} um to either side": mesh.in_contact,
        edges_said: at_edges,
        tip_said: at_tip,
        "corners between the points of the profile": at_corners,
        f"elements {mesh.place} that receptors are in": mesh.at_receptors,
        **{EFFECTS[name].instead: error for name, error in without.items()},
        "what the mesh cannot feel of the profile": surface.error,
    }
    instantaneous = any(each.moduli == "instantaneous" for each in left_out.values())
    return Plan(
        effects=effects | mesh.effects,
        state="instantaneous" if instantaneous else "long_term",
        element=mesh.element,
        mesh_size=mesh.size,
        contact=case.contact,
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
        least_error=max(at_edges, at_tip, mesh.at_receptors),
        error_from=max(sources, key=sources.__getitem__),
        asked_error=scene.tolerance,
        once=scene.once,
        unbounded=_unbounded(case, mesh, surface),
        specimen=(
            *specimen_said(scene.specimen, mesh.external, scene.axisymmetric),
            *filter(None, [mesh.raised]),
            *scene.stimulus.notes,
        ),
        surface=surface,
        strokes=case.moves,
        outputs=outputs,
        every=every,
        unresolved_edge=unresolved_edge(case, mesh.edge_at_edges),
        errors=mesh.errors,
        receptor_height=mesh.receptor_height,
        checked=scene.relaxing is not None and (case.moves or scene.stimulus.irregular),
    )


@dataclass(frozen=True)
class _Mesh:
    """The mesh of a plan, and what it is expected to be wrong by.

    ``edge``: m, of the skin under the apex; ``edge_at_edges``, ``edge_at_tip``: m, where the
    profile has edges, or a tip on the axis.
    ``in_contact``, ``at_receptors``: relative errors. ``effects``: whose reasons name the mesh.
    ``raised``: why an external mesh was raised to quadratic elements.
    """

    element: str
    nodes: int
    smallest: float
    edge: float
    edge_at_edges: float
    edge_at_tip: float
    in_contact: float
    place: str
    size: MeshSize | None = None
    at_receptors: float = 0.0
    effects: dict[str, Effect] = field(default_factory=dict)
    external: PadMesh | None = None
    errors: dict[str, float] = field(default_factory=dict)
    receptor_height: float | None = None
    raised: str = ""


def _built(case: Case, preset: Preset, parts: Parts, errors: ContactErrors) -> _Mesh:
    """A mesh that is built for the scene."""
    scene, profile = case.scene, case.profile
    # on its way over a surface the contact is also flat
    flat = case.moves and profile.uneven
    widest = worst_contact(case, 0.0) if flat else case.contact
    size = mesh_size_for(case, preset, widest.half_width, parts.friction)
    # a contact that moves leaves the middle, where a stroked pad is finer
    at_apex = [] if case.moves else [edge for x, edge in size.focus if x == 0]
    edge = min([size.skin_edge, *at_apex])
    finest = min([edge, *(each for _, each in size.focus)])
    at_receptors, effects = 0.0, {}
    for name, effect in case.decided.items():
        if effect.on and (mesh := EFFECTS[name].mesh):
            meshed = mesh(case, size, edge)
            effects[name] = replace(effect, why=f"{effect.why}: {meshed.said}")
            size, edge = meshed.size, meshed.edge
            at_receptors = max(at_receptors, meshed.error)
    check_size(scene, size, case.rules)
    nodes, smallest = counted(scene.specimen, size, parts.ridges)
    edge_at_edges = min(edge, finest)
    if profile.edge_radius and scene.tolerance is None:
        # presets are fine beside the face, not where it ends and the pressure is largest
        grown = edge_at_edges + np.log(size.growth) * profile.edge_radius
        edge_at_edges = min(grown, size.skin_edge)
    return _Mesh(
        element_for(scene.by_hand.element, None),
        nodes,
        smallest,
        edge,
        edge_at_edges,
        finest,
        errors.on_built_mesh(edge, size.skin_edge),
        "among ridges",
        size,
        at_receptors,
        effects,
    )


def _given(case: Case, errors: ContactErrors) -> _Mesh:
    """The scene's own mesh, raised to quadratic elements where the accuracy needs it."""
    scene = case.scene

    def by_quantity(mesh: PadMesh, element: str) -> dict[str, float]:
        return errors.on_own_mesh(element, apex_edge(mesh), height_at_receptors(scene, mesh))

    def largest(mesh: PadMesh) -> float:
        at_edges, _ = edges_error(case, apex_edge(mesh))
        return max(*by_quantity(mesh, element_for(None, mesh)).values(), at_edges)

    external, raised = raised_for(case, largest)
    element, edge = element_for(scene.by_hand.element, external), apex_edge(external)
    found = by_quantity(external, element)
    return _Mesh(
        element,
        len(external.points),
        shortest_edge(external),
        edge,
        edge,
        edge,
        max(found.values()),
        "in the mesh",
        external=external,
        errors=found,
        receptor_height=height_at_receptors(scene, external),
        raised=raised,
    )


def _corners(case: Case, edge: float, surface: Surface) -> tuple[np.ndarray, float, float, float]:
    """What :func:`seen_corners` has to know but the width of the contact, on skin with edges of
    ``edge`` m.
    """
    half_width = case.contact.half_width
    pressure = 2 / np.pi * case.force / half_width
    if case.scene.axisymmetric:
        pressure = 1.5 / np.pi * case.force / half_width**2
    corners = case.scene.stimulus.at(surface.smoothing, edge).corners()
    return corners, case.pad.stiff, pressure, edge / 2


def _unseen(case: Case, edge: float, surface: Surface) -> float:
    """Error because of the corners between the points of a profile that is turned; in plane strain
    it is in the factor on measured ones.
    """
    if not (case.scene.axisymmetric and case.scene.stimulus.irregular):
        return 0.0
    half_width = case.contact.half_width
    corners, modulus, pressure, node = _corners(case, edge, surface)
    touched = corners[np.abs(corners[:, 0]) <= half_width]
    return unseen_error(touched, modulus, pressure, node, half_width)


def _unbounded(case: Case, mesh: _Mesh, surface: Surface) -> Unbounded:
    """Where contact is expected at which pressure has no bound."""
    half_width, (low, high) = case.contact.half_width, case.way
    profile = case.scene.stimulus.at(surface.smoothing, mesh.edge)
    if unresolved_edge(case, mesh.edge_at_edges):
        corners = profile.tangents()
    else:
        corners = seen_corners(*_corners(case, mesh.edge, surface), half_width)
    corners = corners[(corners >= low - half_width) & (corners <= high + half_width)]
    places, friction = list(in_words(profile, corners)), case.scene.friction > 0
    if mesh.external is not None:
        for node, angle in skin_ends(mesh.external):
            x = mesh.external.points[node, 0]
            if abs(x) <= half_width and ends_unbounded(angle, friction):
                places.append(f"the end of the skin at x = {x * 1e3:.4g} mm")
    near = (corners >= low - 2 * mesh.edge) & (corners <= high + 2 * mesh.edge)
    return Unbounded(tuple(places), bool(near.any()))


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
    out, parts, nodes = replace(own, stride=stride), own.parts(scene), 0
    scheduled = list(schedule(scene, *out.stepping))
    steps = expected_states(scheduled, own.slide_step, stride)
    if own.mesh_size is not None:
        size = own.mesh_size.coarser(coarser)
        nodes, smallest = counted(scene.specimen, size, parts.ridges)
        out = replace(
            out,
            mesh_size=size,
            smallest_edge=smallest,
            contact_edge=coarser * own.contact_edge,
            estimated_error=coarser * own.estimated_error,
        )
    elif (external := external_mesh(scene)) and external.element == "quad4":
        element = "Q1P0" if own.element == "Q2P1" else "Q2P1"
        nodes = len(external.elevated(element).points)
        out = replace(out, element=element)
    if nodes:
        out = replace(out, nodes=nodes // 2 + 1 if parts.half else nodes)
    cost = _cost(out.nodes, steps, out.effects, RULES)
    return replace(out, steps=steps, outputs=len(scheduled), predicted_cost_s=cost)


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

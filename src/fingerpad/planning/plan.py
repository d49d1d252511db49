"""Scene -> plan: which effects the scene calls for, which discretisation, why, and what it will cost.

Nothing is solved here. Every choice carries a sentence with the number that decided it, and every choice can be overridden in
the scene. The thresholds and measured constants stand together in :class:`Rules`.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.planning.bounds import PlanError, check_memory, check_size, micrometres, percent, receptors_of
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
    edges_chosen,
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
from fingerpad.planning.effect import Case, Effect
from fingerpad.planning.effects import EFFECTS, finite_strain, in_order, viscoelasticity
from fingerpad.planning.effects import ridges as ridge_effect
from fingerpad.planning.errors import COARSER, estimated_error, own_errors, stroke_of
from fingerpad.planning.estimates import ContactEstimate
from fingerpad.planning.rules import RULES, Rules
from fingerpad.planning.schedule import BETWEEN, NEWTON, expected_states, schedule
from fingerpad.planning.stack_estimate import pad_estimate, specimen_said
from fingerpad.planning.surface import Surface, surface_of
from fingerpad.planning.unbounded import OF_STROKES, Unbounded, ends_unbounded, in_words, seen_corners
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.specimen import counted, shortest_edge
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.measures import apex_edge, skin_ends
from fingerpad.specimen.pad import MeshSize, PadMesh

if TYPE_CHECKING:
    from collections.abc import Mapping

_OUT_OF_BALANCE = 2e-3  # relative, at most, whatever the mesh
_WORTH = 0.9  # of an error, to which a finer mesh must bring it to be run on
_SKIN_NODES = 6.0  # at most, over the square root of all nodes of the pad


@dataclass(frozen=True)
class Plan:
    """Everything decided about a scene before it is solved.

    Attributes:
        effects: friction, viscoelasticity, finite_strain, symmetry, ridges. state: moduli used when viscosity is off
        ("long_term" or "instantaneous"). element: key of the element. mesh_size: of a built mesh, None for an external one.
        contact: the estimate behind the choices. steps_per_leg: time steps or load increments of each leg; steps: all of them, of
        strokes, whose error chooses them, as many as are expected; outputs: of the history.
        slide_step: m, longest step of a slide; None when steps are given by hand. timed: does time matter?
        nodes, smallest_edge (m): of the mesh that is solved on. inertia_ratio: rho v^2 / mu, neglected.
        contact_edge: m, skin edge under the apex; estimated_error: relative, of the headline quantities; small_strain_error: the
        part of it that small strain is to blame for; least_error: at least this because of the profile's edges or of the elements
        that receptors are in. error_from: what most of it comes from. asked_error: the tolerance, None where none is asked for;
        once: whether it is tried for once only. unbounded: where contact is expected at which pressure has no bound, so that a
        peak is the mesh's; the run says where it was. unresolved_edge: whether edges are rounded, but finer than the mesh can
        tell. errors: on a mesh of one's own, by quantity; receptor_height: there the largest height of elements that receptors
        are in, over their depth. specimen: sentences on what is touched, and what of it the scene left out. surface: what the
        mesh makes of a measured profile. stride: so many steps are made one. strokes: does the pad move along the surface, so
        that errors are of a way? every: of so many outputs of presses and holds a state is found at one, for more are asked for
        than the accuracy needs.
    """

    effects: dict[str, Effect]
    state: str
    element: str
    mesh_size: MeshSize | None
    contact: ContactEstimate
    steps_per_leg: int
    slide_step: float | None
    steps: int
    timed: bool
    nodes: int
    smallest_edge: float
    inertia_ratio: float
    contact_edge: float
    estimated_error: float
    predicted_cost_s: float
    small_strain_error: float = 0.0
    least_error: float = 0.0
    error_from: str = ""
    asked_error: float | None = None
    once: bool = False
    unbounded: Unbounded = Unbounded()
    specimen: tuple[str, ...] = ()
    surface: Surface = Surface()
    stride: int = 1
    strokes: bool = False
    outputs: int = 0
    every: int = 1
    unresolved_edge: bool = False
    errors: dict[str, float] = field(default_factory=dict)
    receptor_height: float | None = None

    @property
    def covers(self) -> str:
        """The quantities that the error is of."""
        return self.unbounded.covers + self.strokes * OF_STROKES

    def missed(self, error: float | None = None) -> str | None:
        """What to say where ``error`` (default: the expected one) exceeds the tolerance; None where it does not."""
        planned = error is None
        error = self.estimated_error if planned else error
        if self.asked_error is None or error <= self.asked_error * (1 + 1e-9):
            return None
        had = "not to be had: expected" if planned else "got"
        return f"asked {percent(self.asked_error)}, {had} {percent(error)}: {self.error_from}"

    def result_bytes(self, scene: Scene, fields: bool = False) -> float:
        """Bytes that the files of a run of ``scene`` will take at most, roughly; ``fields``: with those for ParaView."""
        nodes = self.nodes * (2 if self.effects["symmetry"].on else 1)
        each_time = 8 * (20 + 7 * _SKIN_NODES * nodes**0.5 + 13 * receptors_of(scene))
        snapshots = len(scene.outputs.snapshots) or int(fields)
        return 3e5 + (self.outputs + 1) * each_time + (snapshots + 1) * nodes * (200 if fields else 40)

    @property
    def stepping(self) -> tuple[int, bool, float | None, int, int]:
        """What :func:`schedule` needs to know: steps of a leg, does time matter, longest step of a slide (m), stride, every."""
        return self.steps_per_leg, self.timed, self.slide_step, self.stride, self.every

    @property
    def states_per_leg(self) -> float:
        """As many steps of a leg as its time error is of."""
        return self.steps_per_leg / (self.stride * self.every)

    @property
    def between(self) -> tuple[float, float] | None:
        """Of a stroke: the longest way (m) between two states, and by how much of the pressure what lies between may be off.

        The latter is the mesh's, whatever the stride: twice as much hides bumps that bear little of the load.
        """
        return (self.slide_step * self.stride, BETWEEN * self.contact_edge) if self.strokes and self.slide_step else None

    @property
    def newton_tolerance(self) -> float | None:
        """Force out of balance, over that of the contact, that a stroke leaves: as good as its mesh is; None: the usual one."""
        return min(NEWTON * self.contact_edge, _OUT_OF_BALANCE) if self.between else None

    @property
    def discretisation(self) -> dict[str, Any]:
        """Element, nodes, smallest edge and steps, as printed and as written to plan.json."""
        out = {
            "element": self.element,
            "nodes": self.nodes,
            "smallest_edge_um": round(self.smallest_edge * 1e6, 3),
            "steps": self.steps,
            "outputs": self.outputs,
        }
        if self.mesh_size is not None:
            out |= {
                "contact_edge_um": round(self.contact_edge * 1e6, 3),
                "skin_edge_um": round(self.mesh_size.skin_edge * 1e6, 3),
                "fine_half_width_mm": round(self.mesh_size.fine_half_width * 1e3, 3),
            }
        if self.surface.smoothing:
            out["profile_smoothed_um"] = round(self.surface.smoothing * 1e6, 3)
            out["profile_moved_um"] = round(self.surface.moved * 1e6, 3)
        return out

    def to_dict(self) -> dict[str, Any]:
        """JSON-able description (plan.json); :func:`read_plan` reads it back."""
        return {
            "effects": {name: asdict(effect) for name, effect in self.effects.items()},
            "discretisation": self.discretisation,
            "moduli_state": self.state,
            "estimated_error": self.estimated_error,
            "predicted_cost_s": round(self.predicted_cost_s, 2),
            "contact_estimate_SI": asdict(self.contact),
            "mesh_size_SI": None if self.mesh_size is None else asdict(self.mesh_size),
            "smallest_edge_SI": self.smallest_edge,
            "inertia_ratio": self.inertia_ratio,
            "contact_edge_SI": self.contact_edge,
            "steps_per_leg": self.steps_per_leg,
            "slide_step_SI": self.slide_step,
            "stride": self.stride,
            "every": self.every,
            "timed": self.timed,
            "small_strain_error": self.small_strain_error,
            "specimen": list(self.specimen),
            "surface_SI": asdict(self.surface),
            "least_error": self.least_error,
            "error_from": self.error_from,
            "error_covers": self.covers,
            "asked_error": self.asked_error,
            "tolerance_met": None if self.asked_error is None else self.missed() is None,
            "once": self.once,
            "strokes": self.strokes,
            "unbounded_peak": bool(self.unbounded),
            "unbounded_at": list(self.unbounded.places),
            "unbounded_at_centre": self.unbounded.centre,
            "unresolved_edge": self.unresolved_edge,
            "errors_by_quantity": self.errors,
            "receptor_height": self.receptor_height,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Plan:
        """The plan of which :meth:`to_dict` is the description."""
        size = data["mesh_size_SI"]
        if size is not None:
            size = MeshSize(**size | {"focus": tuple(tuple(pair) for pair in size["focus"])})
        known, places = data["discretisation"], data.get("unbounded_at", ["an edge"] if data["unbounded_peak"] else [])
        unbounded = Unbounded(tuple(places), data.get("unbounded_at_centre", False))
        return cls(
            {name: Effect(**effect) for name, effect in data["effects"].items()}, data["moduli_state"], known["element"], size,
            ContactEstimate(**data["contact_estimate_SI"]), data["steps_per_leg"], data["slide_step_SI"], known["steps"],
            data["timed"], known["nodes"], data["smallest_edge_SI"], data["inertia_ratio"], data["contact_edge_SI"],
            data["estimated_error"], data["predicted_cost_s"], data["small_strain_error"], data["least_error"],
            data["error_from"], data["asked_error"], data["once"], unbounded, tuple(data["specimen"]),
            Surface(**data["surface_SI"]), data["stride"], data.get("strokes", False), known.get("outputs", known["steps"]),
            data.get("every", 1), data.get("unresolved_edge", False), data.get("errors_by_quantity", {}),
            data.get("receptor_height"),
        )  # fmt: skip

    def write(self, path: str | Path) -> None:
        """Write plan.json, whole or not at all."""
        from fingerpad.files import write_text

        write_text(path, json.dumps(self.to_dict(), indent=2) + "\n")


def plan(
    scene: Scene | str | Path | Mapping[str, Any],
    rules: Rules | None = None,
    found: float | None = None,
    tolerance: float | None = None,
) -> Plan:
    """Decide effects and discretisation of ``scene``.

    Args:
        scene: a checked scene, or a file or dictionary of one. rules: thresholds (default: :data:`RULES`). found: half-width m of
        the narrowest contact that a run has shown, in place of the estimated one. tolerance: what the mesh is made for where that
        is less than the scene asks.

    Raises:
        PlanError: an override asks for what the scene cannot have, or the mesh for more than the machine has. MeshError: an
        external mesh cannot be read, or the pad has no room for its ridges.
    """
    scene, rules = load_scene(scene), rules or RULES
    external = external_mesh(scene)
    measured = scene.stimulus
    check_over_pad(scene, external)
    # noise is no contact's curvature
    profile = measured.felt(usual_edge(scene, external, rules))
    pad = pad_estimate(scene.specimen, external, measured.face)
    moves, stroke = moves_along(scene), stroke_of(scene, profile.uneven)
    # a surface is flat where it is pressed first, unless it is all curved; on its way the pad meets the sharpest convexity
    contact = worst_contact(scene, pad, profile, profile.convexity if moves or not profile.uneven else 0.0)
    contact = replace(contact, narrowest=least_half_width(scene, pad, profile, contact, found))
    check_width(scene, pad, contact, rules)
    inertia, fastest = inertia_ratio_of(scene, contact)
    if inertia > rules.inertia_limit:
        raise PlanError(
            f"motion[{fastest}]: so fast that inertia matters (rho v^2 / mu = {inertia:.2g}); "
            f"allowed: up to {rules.inertia_limit:g}"
        )
    rounding = rounding_of(scene, pad, profile, contact) if profile.edges and not profile.unbounded else 0.0
    preset, by_hand = preset_for(scene, rules, contact, tolerance, stroke)
    tolerance = preset.tolerance
    case = Case(scene, profile, pad, contact, external, moves, tolerance, rules, {})
    effects = _decided(case)
    ridges, state = scene.specimen.ridges if effects["ridges"].on else None, viscoelasticity.moduli_state(case)
    timed = effects["viscoelasticity"].on
    steps_per_leg, slide_step, every = preset.steps, preset.slide_step, 1
    if by_hand and by_hand.steps:
        steps_per_leg, slide_step = max(1, round(by_hand.steps / len(scene.motion))), None
    elif timed:
        steps_per_leg = max(steps_per_leg, scene.outputs.per_leg or 0)
        every = steps_per_leg // preset.steps
    scheduled = list(schedule(scene, steps_per_leg, timed, slide_step, every=every))
    outputs, steps = len(scheduled), expected_states(scheduled, slide_step)
    time, narrowest, raised = steps_per_leg / every if timed or moves else None, earliest_half_width(scene, contact, timed), ""
    bumpy = scene.stimulus.irregular
    if external is not None:
        own = partial(own_errors, rules=rules, bumpy=bumpy)

        def on_mesh(mesh: PadMesh) -> float:
            edge = apex_edge(mesh)
            found = own(KINDS[mesh.element].solved, edge, narrowest, height_at_receptors(scene, mesh), time, stroke)
            return max(*found.values(), edges_error(profile, edge, rounding, rules)[0])

        external, raised = raised_for(by_hand, external, tolerance, on_mesh)
    element = element_for(by_hand, external)
    errors, height = {}, None
    if external is None:
        at_receptors = 0.0
        # on its way over a surface the contact is also flat
        widest = worst_contact(scene, pad, profile, 0.0) if moves and profile.uneven else contact
        wander = wander_of(scene, pad, profile, effects["friction"].on, rules) if moves else 0.0
        size = mesh_size_for(scene, preset, profile, contact, widest.half_width, wander, rounding, rules)
        # a contact that moves leaves the middle, where a stroked pad is finer
        edge = size.skin_edge if moves else min([size.skin_edge, *(edge for x, edge in size.focus if x == 0)])
        at_focus = min([edge, *(each for _, each in size.focus)])
        if ridges is not None:
            size, at_receptors = ridge_effect.meshed(scene, size, tolerance if edges_chosen(scene) else None, moves, rules)
        check_size(scene, size, ridges, rules)
        nodes, smallest = counted(scene.specimen, size, ridges)
        if ridges is not None:
            layered = scene.specimen.outline, size, ridges, scene.specimen.layers.stratum_corneum is not None
            effects["ridges"], edge = ridge_effect.resolved(effects["ridges"], layered, edge)
    else:
        size, nodes, at_receptors, height = None, len(external.points), 0.0, height_at_receptors(scene, external)
        smallest, edge = shortest_edge(external), apex_edge(external)
    if effects["symmetry"].on:
        nodes = nodes // 2 + 1
    check_memory(scene, nodes, outputs, rules)
    may_change = rules.profile_share * tolerance
    pressed, force = partial(worst_contact, scene, pad, profile), pressing_force(scene, pad, contact)
    surface = surface_of(measured, edge, way_of(scene), pad, pressed, force, may_change)
    around = None if size is None else size.skin_edge
    at_edge = edge if size is None else min(edge, at_focus)
    if size is not None and profile.edge_radius and scene.tolerance is None:
        # presets are fine beside the face, not where it ends and the pressure is largest
        at_edge = min(at_edge + np.log(size.growth) * profile.edge_radius, size.skin_edge)
    at_edges, edges_said = edges_error(profile, at_edge, rounding, rules)
    if external is None:
        in_contact = estimated_error(edge, narrowest, time, stroke, around, rules=rules, bumpy=bumpy)
    else:
        errors = own(element, edge, narrowest, height, time, stroke)
        in_contact = max(errors.values())
    mesh = surface.error + max(in_contact, at_edges, at_receptors)
    linear = 0.0 if effects["finite_strain"].on else finite_strain.small_strain_error(case)
    if linear and scene.tolerance is not None and "finite_strain" not in scene.effects and linear + mesh > scene.tolerance:
        effects["finite_strain"], linear = finite_strain.beside_mesh(case, mesh), 0.0
    sources = {
        f"edges of {micrometres(edge)} um in a contact of {micrometres(narrowest)} um to either side": in_contact,
        edges_said: at_edges,
        f"elements {'in the mesh' if size is None else 'among ridges'} that receptors are in": at_receptors,
        "small strain": linear,
        "what the mesh cannot feel of the profile": surface.error,
    }
    unresolved = not profile.unbounded and peak_is_unbounded(profile, at_edge, rounding, rules)
    return Plan(
        effects, state, element, size, contact, steps_per_leg, slide_step, steps, timed, nodes, smallest, inertia, edge,
        linear + mesh, _cost(nodes, steps, effects, rules), linear, max(at_edges, at_receptors),
        max(sources, key=sources.get), scene.tolerance, scene.once,
        _unbounded(scene, measured.at(surface.smoothing, edge), external, pad, contact, edge, unresolved),
        (*specimen_said(scene.specimen, external), *filter(None, [raised]), *measured.notes), surface, strokes=moves,
        outputs=outputs, every=every, unresolved_edge=unresolved, errors=errors, receptor_height=height,
    )  # fmt: skip


def _unbounded(scene, profile, external, pad, contact, edge: float, unresolved: bool) -> Unbounded:
    """Where contact is expected at which pressure has no bound."""
    half_width, (low, high) = contact.half_width, way_of(scene)
    pressure = 2 / np.pi * pressing_force(scene, pad, contact) / half_width
    corners = (
        profile.tangents() if unresolved else seen_corners(profile.corners(), pad.stiff, pressure, edge / 2, half_width)
    )
    corners = corners[(corners >= low - half_width) & (corners <= high + half_width)]
    places, friction = list(in_words(profile, corners)), scene.friction > 0
    for node, angle in skin_ends(external) if external is not None else ():
        x = external.points[node, 0]
        if abs(x) <= half_width and ends_unbounded(angle, friction):
            places.append(f"the end of the skin at x = {x * 1e3:.4g} mm")
    centre = np.any((corners >= low - 2 * edge) & (corners <= high + 2 * edge))
    return Unbounded(tuple(places), bool(centre))


def refined(scene: Scene, before: Plan, error: float, narrowest: float, runs: int = 1, rules: Rules | None = None) -> Plan | str:
    """The plan of another run of a scene that was solved as ``before`` says, or why there is none ("" where none is wanted).

    Args:
        error: what the run estimates of itself. narrowest: half-width m of the narrowest contact that it found. runs: so far.
    """
    rules = rules or RULES
    if before.missed(error) is None or before.once:
        return ""
    if before.mesh_size is None:
        return "an external mesh is not refined"
    if runs >= rules.most_runs:
        return f"after {runs} runs"
    # what misses by some share is aimed at by as much below
    finer = plan(scene, rules, narrowest, before.asked_error * min(_WORTH, max(before.asked_error / error, 0.25)))
    if finer.estimated_error > _WORTH * error:
        return "a finer mesh would not help"
    if finer.nodes > rules.most_nodes_again:
        return f"{percent(finer.estimated_error)} would need {finer.nodes} nodes"
    return finer


def companion(scene: Scene, own: Plan, stride: int = 1, coarser: float = COARSER) -> Plan:
    """The plan of a run's companion: its `own` in all but edges so many times as long, and so many steps made one.

    An external mesh keeps its edges: linear quads are solved as quadratic ones and the other way round, all others as they are.
    """
    scheduled = list(schedule(scene, own.steps_per_leg, own.timed, own.slide_step, stride, own.every))
    steps = expected_states(scheduled, own.slide_step, stride)
    out = replace(own, stride=stride, steps=steps, outputs=len(scheduled))
    if own.mesh_size is not None:
        size = own.mesh_size.coarser(coarser)
        ridges = scene.specimen.ridges if own.effects["ridges"].on else None
        nodes, smallest = counted(scene.specimen, size, ridges)
        nodes = nodes // 2 + 1 if own.effects["symmetry"].on else nodes
        edge, error = coarser * own.contact_edge, coarser * own.estimated_error
        out = replace(out, mesh_size=size, nodes=nodes, smallest_edge=smallest, contact_edge=edge, estimated_error=error)
    elif (external := external_mesh(scene)).element == "quad4":
        element = "Q1P0" if own.element == "Q2P1" else "Q2P1"
        nodes = len(external.elevated(element).points)
        out = replace(out, element=element, nodes=nodes // 2 + 1 if own.effects["symmetry"].on else nodes)
    return replace(out, predicted_cost_s=_cost(out.nodes, steps, out.effects, RULES))


def read_plan(path: str | Path) -> Plan:
    """The plan written to ``path`` by :meth:`Plan.write`."""
    return Plan.from_dict(json.loads(Path(path).read_text(encoding="utf-8")))


def _decided(case: Case) -> dict[str, Effect]:
    """Every effect as it is decided, or as the scene will have it; in the order of the register."""
    found: dict[str, Effect] = {}
    for each in in_order():
        now = replace(case, decided=dict(found))
        effect, wanted = each.decide(now), case.scene.effects.get(each.name)
        if wanted is not None and wanted != effect.on:
            if wanted and not each.possible(now):
                raise PlanError(f"{case.scene.name}: effects.{each.name}: on, but {effect.why}; allowed: off or auto")
            effect = Effect(wanted, f"asked for in the scene (the planner: {'on' if effect.on else 'off'}, {effect.why})")
        found[each.name] = effect
    return {name: found[name] for name in EFFECTS}


def _cost(nodes: int, steps: int, effects: dict[str, Effect], rules: Rules) -> float:
    nodes = nodes * float(np.prod([EFFECTS[name].dearer(rules) for name, effect in effects.items() if effect.on]))
    if effects["finite_strain"].on:
        work = rules.seconds_finite * rules.iterations_finite
    else:
        work = rules.seconds_small * rules.iterations_small
    return float(rules.seconds_start + work * nodes * steps)

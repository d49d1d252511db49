"""Scene -> plan: which effects the scene calls for, which discretisation, why, and what it will cost.

Nothing is solved here. Every choice carries a sentence with the number that decided it, and every choice can be overridden in
the scene. The thresholds and measured constants stand together in :class:`Rules`.
"""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.laws import departure
from fingerpad.planning.estimates import ContactEstimate, PadEstimate
from fingerpad.planning.stack_estimate import pad_estimate, specimen_said
from fingerpad.planning.surface import Surface, surface_of
from fingerpad.scenes.scene import Discretisation, Scene
from fingerpad.specimen import counted, quality_of
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.files import read_specimen_mesh
from fingerpad.specimen.materials import Prony
from fingerpad.specimen.measures import apex_edge
from fingerpad.specimen.pad import MeshSize, PadMesh
from fingerpad.stimuli.motion import STEADY, programme
from fingerpad.stimuli.profile import Profile

if TYPE_CHECKING:
    from collections.abc import Mapping


class PlanError(ValueError):
    """The scene asks for a combination that cannot be planned; the message is one line."""


@dataclass(frozen=True)
class Preset:
    """A discretisation: edges m, steps per leg, longest step of a slide m.

    ``tolerance`` is what an effect left out may change. ``focus`` is the edge m to which the mesh is refined in the contact,
    along the skin and into it (None: not refined unless the contact is narrower than an edge).
    """

    skin_edge: float
    layer_edge: float
    steps: int
    growth: float
    tolerance: float
    slide_step: float | None
    focus: float | None = None


@dataclass(frozen=True)
class MeasuredErrors:
    """Largest relative error of depth, width, centre and peak pressure and strain energies, as the study of accuracy found it.

    The same numbers as figures/tables/accuracy_planner.csv. Between them errors are interpolated in logarithms.

    Attributes:
        half_widths: m, of the contact with 1260 1/m, 210 1/m and the flat plate at the top of the ramp. edge: m, along the skin,
        where 7 elements go across the epidermis. mesh: elements across the epidermis -> error (half_widths). time: steps of a leg
        -> error (half_widths). stroke_mesh, stroke_time: those of the plate's stroke.
    """

    half_widths: tuple[float, ...] = (0.29e-3, 0.88e-3, 2.06e-3)
    edge: float = 134.4e-6
    mesh: Mapping[int, tuple[float, ...]] = field(
        default_factory=lambda: {
            1: (0.57, 0.31, 0.089),
            2: (0.2, 0.048, 0.026),
            4: (0.092, 0.026, 0.0077),
            7: (0.043, 0.017, 0.0023),
            10: (0.023, 0.0049, 0.0017),
            14: (0.0099, 0.0049, 0.0017),
            22: (0.0099, 0.0049, 0.0017),
        }
    )
    time: Mapping[int, tuple[float, ...]] = field(
        default_factory=lambda: {
            5: (0.0033, 0.0066, 0.0076),
            10: (0.0013, 0.002, 0.0027),
            20: (0.00045, 0.00063, 0.00096),
            40: (0.000071, 0.00029, 0.00035),
            80: (0.000053, 0.00016, 0.00031),
        }
    )
    stroke_mesh: Mapping[int, float] = field(
        default_factory=lambda: {1: 0.1, 2: 0.055, 4: 0.018, 7: 0.01, 10: 0.01, 14: 0.01, 22: 0.01}
    )
    stroke_time: Mapping[int, float] = field(default_factory=lambda: {5: 0.046, 10: 0.02, 20: 0.0099, 40: 0.0027, 80: 0.001})


@dataclass(frozen=True)
class Rules:
    """Thresholds and measured constants of the planner.

    Attributes:
        presets: by name.
        errors: what a tolerance is met with, and what a run believes of itself.
        mesh_order, time_order: with which errors are taken to go on beyond the meshes and steps that were measured.
        edge_share: of an element's edge, by which an edge of the contact may be misplaced: a quarter of the node spacing.
        safety: factor on both, for errors swing with where nodes happen to lie.
        fillet_error, fillet_order: of the peak pressure, over that power of element edge / length of the contact on the rounded
            edge that presses. edge_error: of the centre
            pressure and the strain energies, over element edge / half width of the face, under a true edge; edge_floor: what it
            does not fall below, for the skin's node at the edge is held by it or is not.
        linear_triangle, linear_quad: by how much coarser P2B and Q1P0 elements of external meshes count than their edges.
        least_edge: m, of an element; shorter ones are not made. least_half_width: m, of a contact; narrower ones are refused.
        most_nodes: of a mesh, and most_memory: share of the machine's, that a plan may ask for; bytes_node, bytes_step: needed
            for each node, and for each node and step.
        most_runs: of a scene whose run missed its tolerance; most_nodes_again: of a mesh on which it is run again.
        least_steps: of a leg; fewer would do for its end, but a curve of fewer is none.
        small_strain_error: of small strain in the headline quantities, over depth / soft thickness, at most; small strain is used
            when that is within the accuracy asked for.
        pressing_friction: change of the headline quantities by friction in a press, over the coefficient; most_pressing_friction:
            what it comes to where the whole contact sticks. Friction is left out of presses when that is within the accuracy.
        relaxation_share, lag_share: viscosity is left out when the stress that can relax, or by which it lags behind, is below
            these shares of the accuracy; answers change by up to 2 and 7 times as much.
        ridge_change: of strain energy by low inner ridges in a press, over height / pitch, at most; ridge_contrast: of epidermis
            to dermis, up to which that holds; ridge_width: half width of the contact, over the pitch, below which it grows as the
            contact is narrower. Ridges are left out of presses when it is within the accuracy.
        fine_half_width: m, least extent of the fine skin mesh to either side of the apex.
        inertia_limit: largest rho v^2 / mu at which a quasi-static solution is offered.
        skin_stretch: m, by which friction carries the contact along, added to the fine skin mesh.
        edges_per_half_width: a contact with less than one edge to either side gets this many under the apex.
        seconds_*: measured process time of one reference core (see benchmarks): start-up, per node and Newton iteration with
            finite and with small strain, and per node and step for output. frictional: cost of a step with friction over one
            without.
    """

    presets: Mapping[str, Preset] = field(
        default_factory=lambda: {
            "draft": Preset(268.8e-6, 243e-6, 10, 1.35, 0.06, 0.5e-3),
            "thesis": Preset(134.4e-6, 121.5e-6, 20, 1.2, 0.02, 0.25e-3),
            "fine": Preset(67.2e-6, 60.7e-6, 40, 1.15, 0.007, 0.125e-3),
        }
    )
    errors: MeasuredErrors = field(default_factory=MeasuredErrors)
    mesh_order: float = 1.0
    time_order: float = 1.0
    edge_share: float = 0.125
    safety: float = 1.5
    fillet_error: float = 0.2
    fillet_order: float = 1.5
    edge_error: float = 0.65
    edge_floor: float = 0.08
    linear_triangle: float = 1.6
    linear_quad: float = 2.0
    least_edge: float = 1e-7
    least_half_width: float = 2e-7
    most_nodes: float = 2e6
    most_memory: float = 0.8
    bytes_node: float = 1e4
    bytes_step: float = 20.0
    most_runs: int = 3
    most_nodes_again: float = 3e5
    least_steps: int = 10
    small_strain_error: float = 4.6
    pressing_friction: float = 2.0
    most_pressing_friction: float = 0.2
    relaxation_share: float = 0.4
    lag_share: float = 0.15
    ridge_change: float = 3.0
    ridge_width: float = 1 / 3
    ridge_contrast: float = 11.0
    fine_half_width: float = 3.4e-3
    skin_stretch: float = 1.0e-3
    edges_per_half_width: float = 2.0
    inertia_limit: float = 0.1
    seconds_start: float = 1.2
    seconds_finite: float = 3.0e-6
    seconds_small: float = 1.0e-6
    iterations_finite: float = 2.6
    iterations_small: float = 2.0
    frictional: float = 1.2


RULES = Rules()
_RECEPTOR_BYTES = 400  # of a receptor and step: what is sampled, kept twice
_FINEST_FOCUS = 14  # halvings of the edge in the contact that are tried
_MOST_COLUMNS = 2000  # of refined elements to either side
_FLATTER = 0.8  # pieces less than so much narrower than the contact are the contact
_THESIS_ROWS = 7  # elements across the epidermis of the thesis's preset


@dataclass(frozen=True)
class Effect:
    """Whether an effect is simulated, and why."""

    on: bool
    why: str


@dataclass(frozen=True)
class Plan:
    """Everything decided about a scene before it is solved.

    Attributes:
        effects: friction, viscoelasticity, finite_strain, symmetry, ridges. state: moduli used when viscosity is off
        ("long_term" or "instantaneous"). element: key of the element. mesh_size: of a built mesh, None for an external one.
        contact: the estimate behind the choices. steps_per_leg: time steps or load increments of each leg; steps: all of them.
        slide_step: m, longest step of a slide; None when steps are given by hand. timed: does time matter?
        nodes, smallest_edge (m): of the mesh that is solved on. inertia_ratio: rho v^2 / mu, neglected.
        contact_edge: m, skin edge under the apex; estimated_error: relative, of the headline quantities; small_strain_error: the
        part of it that small strain is to blame for; edge_error: at least this because of the profile's edges. error_from: what
        most of it comes from. asked_error: the tolerance, None where none is asked for; once: whether it is tried for once only.
        unbounded_peak: whether the profile has a true edge, where pressure has no bound and a peak is the mesh's. specimen:
        sentences on what is touched, and what of it the scene left out. surface: what the mesh makes of a measured profile.
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
    edge_error: float = 0.0
    error_from: str = ""
    asked_error: float | None = None
    once: bool = False
    unbounded_peak: bool = False
    specimen: tuple[str, ...] = ()
    surface: Surface = Surface()

    @property
    def covers(self) -> str:
        """The quantities that the error is of."""
        if self.unbounded_peak:
            return "depth, width, centre pressure, strain energy; the peak at the edge is unbounded"
        return "depth, width, pressure, strain energy"

    def missed(self, error: float | None = None) -> str | None:
        """What to say where ``error`` (default: the expected one) exceeds the tolerance; None where it does not."""
        planned = error is None
        error = self.estimated_error if planned else error
        if self.asked_error is None or error <= self.asked_error * (1 + 1e-9):
            return None
        had = "not to be had: expected" if planned else "got"
        return f"asked {_percent(self.asked_error)}, {had} {_percent(error)}: {self.error_from}"

    @property
    def stepping(self) -> tuple[int, bool, float]:
        """What :func:`schedule` needs to know: steps of each leg, does time matter, longest step of a slide (m)."""
        return self.steps_per_leg, self.timed, self.slide_step

    @property
    def discretisation(self) -> dict[str, Any]:
        """Element, nodes, smallest edge and steps, as printed and as written to plan.json."""
        out = {
            "element": self.element,
            "nodes": self.nodes,
            "smallest_edge_um": round(self.smallest_edge * 1e6, 3),
            "steps": self.steps,
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
            "timed": self.timed,
            "small_strain_error": self.small_strain_error,
            "specimen": list(self.specimen),
            "surface_SI": asdict(self.surface),
            "edge_error": self.edge_error,
            "error_from": self.error_from,
            "error_covers": self.covers,
            "asked_error": self.asked_error,
            "tolerance_met": None if self.asked_error is None else self.missed() is None,
            "once": self.once,
            "unbounded_peak": self.unbounded_peak,
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Plan:
        """The plan of which :meth:`to_dict` is the description."""
        size = data["mesh_size_SI"]
        if size is not None:
            size = MeshSize(**size | {"focus": tuple(tuple(pair) for pair in size["focus"])})
        known = data["discretisation"]
        return cls(
            {name: Effect(**effect) for name, effect in data["effects"].items()}, data["moduli_state"], known["element"], size,
            ContactEstimate(**data["contact_estimate_SI"]), data["steps_per_leg"], data["slide_step_SI"], known["steps"],
            data["timed"], known["nodes"], data["smallest_edge_SI"], data["inertia_ratio"], data["contact_edge_SI"],
            data["estimated_error"], data["predicted_cost_s"], data["small_strain_error"], data["edge_error"], data["error_from"],
            data["asked_error"], data["once"], data["unbounded_peak"], tuple(data["specimen"]), Surface(**data["surface_SI"]),
        )  # fmt: skip

    def write(self, path: str | Path) -> None:
        """Write plan.json, whole or not at all."""
        from fingerpad.files import write_text

        write_text(path, json.dumps(self.to_dict(), indent=2) + "\n")


def plan(scene: Scene, rules: Rules | None = None, found: float | None = None, tolerance: float | None = None) -> Plan:
    """Decide effects and discretisation of ``scene``.

    Args:
        scene: a checked scene. rules: thresholds (default: :data:`RULES`). found: half-width m of the narrowest contact that a
        run has shown, in place of the estimated one. tolerance: what the mesh is made for where that is less than the scene asks.

    Raises:
        PlanError: an override asks for what the scene cannot have, or the mesh for more than the machine has. MeshError: an
        external mesh cannot be read, or the pad has no room for its ridges.
    """
    rules = rules or RULES
    external = _external(scene)
    measured = scene.stimulus
    _check_over_pad(scene, external)
    # noise is no contact's curvature
    profile = measured.felt(_usual_edge(scene, external, rules))
    pad = pad_estimate(scene.specimen, external, measured.face)
    moves = _moves(scene)
    # a surface is flat where it is pressed first, unless it is all curved; on its way the pad meets the sharpest convexity
    contact = _worst_contact(scene, pad, profile, profile.convexity if moves or not profile.uneven else 0.0)
    contact = replace(contact, narrowest=_narrowest(scene, pad, profile, contact, found))
    _check_width(scene, pad, contact, rules)
    inertia, fastest = _inertia_ratio(scene, contact)
    if inertia > rules.inertia_limit:
        raise PlanError(
            f"motion[{fastest}]: so fast that inertia matters (rho v^2 / mu = {inertia:.2g}); "
            f"allowed: up to {rules.inertia_limit:g}"
        )
    rounding = _on_rounding(scene, pad, profile, contact) if profile.edges and not profile.unbounded else 0.0
    preset, by_hand = _preset(scene, rules, contact, tolerance)
    tolerance = preset.tolerance
    chosen = (layer.law for layer in scene.specimen.materials.values())
    laws = max(departure(one.law, one.constants, contact.strain) for one in chosen)
    ridged = _ridges(scene, moves, contact, tolerance, rules)
    ridges = scene.specimen.ridges if scene.effects.get("ridges", ridged.on) else None
    effects = {
        "friction": _friction(scene, tolerance, rules),
        "viscoelasticity": Effect(False, ""),
        "finite_strain": _finite_strain(pad, profile, contact, laws, tolerance, rules),
        "symmetry": _symmetry(scene, profile, external, ridges),
        "ridges": ridged,
    }
    effects["viscoelasticity"], state = _viscoelasticity(scene, profile, contact, tolerance, rules)
    _apply_overrides(scene, effects)
    timed = effects["viscoelasticity"].on
    steps_per_leg, slide_step = preset.steps, preset.slide_step
    if by_hand and by_hand.steps:
        steps_per_leg, slide_step = max(1, round(by_hand.steps / len(scene.motion))), None
    steps = sum(1 for _ in schedule(scene, steps_per_leg, timed, slide_step=slide_step))
    element = _element(by_hand, external)
    if external is None:
        # on its way over a surface the contact is also flat
        widest = _worst_contact(scene, pad, profile, 0.0) if moves and profile.uneven else contact
        wander = _wander(scene, pad, profile, effects["friction"].on, rules) if moves else 0.0
        size = _mesh_size(scene, preset, profile, contact, widest.half_width, wander, rounding, rules)
        _check_size(scene, size, ridges, rules)
        nodes, smallest = counted(scene.specimen, size, ridges)
        edge = min([size.skin_edge, *(edge for x, edge in size.focus if x == 0)])
        if ridges is not None:
            layered = scene.specimen.outline, size, ridges, scene.specimen.layers.stratum_corneum is not None
            effects["ridges"], edge = _resolved(effects["ridges"], layered, edge)
    else:
        size, nodes = None, len(external.points)
        smallest, edge = quality_of(external)["smallest_edge_m"], _coarseness(external, rules) * apex_edge(external)
    if effects["symmetry"].on:
        nodes = nodes // 2 + 1
    _check_memory(scene, nodes, steps, rules)
    linear = 0.0 if effects["finite_strain"].on else _small_strain_error(pad, profile, contact, rules) + laws
    surface = surface_of(measured, edge, _way(scene), pad, partial(_worst_contact, scene, pad, profile))
    around = None if size is None else size.skin_edge
    time = steps_per_leg if timed else None
    narrowest = _earliest(scene, contact, timed)
    at_edge = edge if size is None else min([edge, *(each for _, each in size.focus)])
    at_edges, edges_said = _edge_error(profile, at_edge, rounding, rules)
    in_contact = estimated_error(edge, narrowest, time, moves, around, rules)
    sources = {
        f"edges of {_micrometres(edge)} um in a contact of {_micrometres(narrowest)} um to either side": in_contact,
        edges_said: at_edges,
        "small strain": linear,
        "what the mesh cannot feel of the profile": surface.error,
    }
    return Plan(
        effects, state, element, size, contact, steps_per_leg, slide_step, steps, timed, nodes, smallest, inertia, edge,
        linear + surface.error + max(in_contact, at_edges), _cost(nodes, steps, effects, rules), linear, at_edges,
        max(sources, key=sources.get), scene.tolerance, scene.once, _unbounded(profile, at_edge, rounding, rules),
        specimen_said(scene.specimen, external), surface,
    )  # fmt: skip


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
    finer = plan(scene, rules, narrowest, before.asked_error * min(1.0, max(before.asked_error / error, 0.25)))
    if finer.estimated_error > 0.9 * error:
        return "a finer mesh would not help"
    if finer.nodes > rules.most_nodes_again:
        return f"{_percent(finer.estimated_error)} would need {finer.nodes} nodes"
    return finer


def schedule(scene: Scene, steps_per_leg: int, timed: bool, slide_step: float | None = None, present=None):
    """Steps of the scene's motion (see :func:`fingerpad.stimuli.motion.programme`)."""
    return programme(
        scene.motion,
        steps=steps_per_leg,
        contact_length=scene.specimen.contact_length,
        timed=timed,
        snapshots=scene.outputs.snapshots,
        present=present,
        slide_step=slide_step,
    )


def read_plan(path: str | Path) -> Plan:
    """The plan written to ``path`` by :meth:`Plan.write`."""
    return Plan.from_dict(json.loads(Path(path).read_text(encoding="utf-8")))


def _moves(scene: Scene) -> bool:
    return any(leg.along for leg in scene.motion)


# -- the choices --------------------------------------------------------------------------------------------------------


def _way(scene: Scene) -> tuple[float, float]:
    """Least and largest x (m) of the stimulus that comes over the middle of the pad."""
    way = np.cumsum([0.0, *(leg.along for leg in scene.motion)])
    return float(way.min()), float(way.max())


def _check_over_pad(scene: Scene, external: PadMesh | None) -> None:
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
            f"{scene.name}: stimulus.csv: '{name}' has points {there}, none of them over the finger; "
            "allowed: points around x = 0, which comes down on its apex"
        )


def _usual_edge(scene: Scene, external: PadMesh | None, rules: Rules) -> float:
    """Edge (m) of the skin before the contact is known: of the mesh given, the preset, or the one by hand; else of the thesis."""
    if external is not None:
        return apex_edge(external)
    by_hand = getattr(scene.accuracy, "skin_edge", None)
    return by_hand or rules.presets[scene.accuracy if isinstance(scene.accuracy, str) else "thesis"].skin_edge


def _external(scene: Scene) -> PadMesh | None:
    """The scene's own mesh, if it names one."""
    return None if scene.specimen.mesh is None else read_specimen_mesh(scene.specimen).elevated()


def _worst_contact(scene: Scene, pad: PadEstimate, profile: Profile, curvature: float) -> ContactEstimate:
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


def _inertia_ratio(scene: Scene, contact: ContactEstimate) -> tuple[float, int]:
    """rho v^2 / mu of the softest layer, what leaving inertia out of the equations neglects; and the fastest leg."""
    layers = scene.specimen.materials.values()
    softest = min(layer.youngs_modulus / (2 * (1 + layer.poisson_ratio)) for layer in layers)
    speed = [0.0] * len(scene.motion)
    for i, (leg, duration) in enumerate(zip(scene.motion, leg_durations(scene), strict=True)):
        if leg.loads and (duration or leg.speed):
            speed[i] = leg.speed or (leg.depth or contact.depth) / duration
    fastest = int(np.argmax(speed))
    return 1000.0 * speed[fastest] ** 2 / softest, fastest


def _preset(
    scene: Scene, rules: Rules, contact: ContactEstimate, tolerance: float | None
) -> tuple[Preset, Discretisation | None]:
    """The discretisation asked for: a named one, the cheapest that meets a tolerance, or one by hand."""
    accuracy = scene.accuracy
    by_hand = accuracy if isinstance(accuracy, Discretisation) else None
    if isinstance(accuracy, str):
        return rules.presets[accuracy], None
    if scene.tolerance is not None:
        return _cheapest(scene, min(scene.tolerance, tolerance or 1.0), contact, rules), by_hand
    thesis = rules.presets["thesis"]
    if by_hand is not None:
        edge = accuracy.skin_edge or thesis.skin_edge
        scale = edge / thesis.skin_edge
        error = estimated_error(edge, max(contact.half_width, 1e-5), rules=rules)
        return replace(thesis, skin_edge=edge, layer_edge=thesis.layer_edge * scale, tolerance=error), by_hand
    raise AssertionError(accuracy)


def _cheapest(scene: Scene, tolerance: float, contact: ContactEstimate, rules: Rules) -> Preset:
    """Of the measured meshes and steps those of least nodes times steps that meet it; if none does, those of least error.

    A mesh that suffices for the widest contact measured is refined under a narrower one that stays where it is.
    """
    thesis, known = rules.presets["thesis"], rules.errors
    timed = bool(scene.specimen.prony) and any(duration is not None for duration in leg_durations(scene))
    moves, half_width = _moves(scene), _earliest(scene, contact, timed)
    still = not moves and scene.specimen.mesh is None and scene.specimen.ridges is None
    outer = 3 if scene.specimen.ridges is not None and scene.specimen.ridges.outer is not None else 1  # columns of outer ridges
    found = []
    for rows, steps in product(known.mesh, (n for n in known.time if n >= rules.least_steps)):
        edge, growth = known.edge * _THESIS_ROWS / rows, min(thesis.growth ** (_THESIS_ROWS / rows), 3.0)
        time = steps if timed else None
        for finer in [2**k for k in range(_FINEST_FOCUS)] if still else (1,):
            # the right half has about 7 columns and 4 rows an element across the epidermis
            more = np.log(finer) / np.log(growth)
            wide = 1.2 * _reach(scene, contact) / edge * (finer - 1)
            if finer > 1 and (edge / finer < rules.least_edge or wide > _MOST_COLUMNS):
                break
            error = estimated_error(edge / finer / outer, half_width, time, moves, edge, rules)
            work = (7 * rows + more + wide) * (4 * rows + more) * steps
            found.append((max(error - tolerance, 0.0), work, edge / finer, edge, growth, steps))
    _, _, focus, edge, growth, steps = min(found)
    outline, slide_step = scene.specimen.outline, thesis.slide_step * thesis.steps / steps
    # so many elements across the epidermis, however thick it is
    layer_edge = thesis.layer_edge * edge / thesis.skin_edge
    if outline is not None:
        layer_edge = min(layer_edge, outline.epidermis_thickness * edge / known.edge / _THESIS_ROWS)
    return Preset(edge, layer_edge, steps, growth, tolerance, slide_step, focus=focus if focus < edge else None)


def _earliest(scene: Scene, contact: ContactEstimate, timed: bool) -> float:
    """Half width (m) of the contact before anything relaxes: narrower as the root of the modulus is larger."""
    relaxes = timed and scene.specimen.moduli == "long_term"
    share = (1 - sum(term.g for term in scene.specimen.prony)) ** 0.5 if relaxes else 1.0
    earliest = share * contact.half_width
    return earliest if contact.narrowest is None else min(earliest, contact.narrowest)


def _reach(scene: Scene, contact: ContactEstimate) -> float:
    """How far (m) the contact reaches to either side."""
    return min(contact.half_width, scene.stimulus.face)


def _narrowest(scene: Scene, pad: PadEstimate, profile: Profile, contact: ContactEstimate, found: float | None) -> float | None:
    """Half-width (m) of the least piece of the contact where that is not the contact itself: a face, a tip, a bump; or found."""
    least = np.inf if found is None else found
    if profile.edges or (not profile.irregular and profile.reach[1] < contact.half_width):
        least = min(least, profile.reach[1])
    elif profile.irregular:
        low, high = _way(scene)
        force = _force(scene, pad, contact)
        bump = pad.least_piece(force, profile.outline, low - contact.half_width, high + contact.half_width)
        least = min(least, bump if bump < _FLATTER * contact.half_width else np.inf)
    if scene.specimen.ridges is not None and scene.specimen.ridges.outer is not None:
        period = scene.specimen.ridges.outer.period or scene.specimen.ridges.inner.pitch
        least = min(least, period / 4)  # the skin touches with the tops of its ridges
    return float(least) if np.isfinite(least) else None


def _force(scene: Scene, pad: PadEstimate, contact: ContactEstimate) -> float:
    """Largest force (N/m) of the motion: that of its legs, or what presses to the estimated depth."""
    forces = [leg.force for leg in scene.motion if leg.force is not None]
    return max(forces) / scene.specimen.contact_length if forces else pad.force_of(contact.depth)


def _on_rounding(scene: Scene, pad: PadEstimate, profile: Profile, contact: ContactEstimate) -> float:
    """Length (m) of the contact on the rounded edges of a face."""
    return pad.on_rounding(_force(scene, pad, contact), profile.reach[1] - profile.edge_radius, profile.edge_radius)


def _edge_error(profile: Profile, edge: float, rounding: float, rules: Rules) -> tuple[float, str]:
    """Error because of the profile's own edges, meshed with ``edge`` m: of a rounded one the peak pressure's; and what it is."""
    if not profile.edges:
        return 0.0, ""
    if _unbounded(profile, edge, rounding, rules):
        error = max(rules.edge_error * edge / profile.reach[1], rules.edge_floor)
        return error, "at a true edge the skin is held or is not, by a node; a fillet that is resolved converges"
    said = f"edges of {_micrometres(edge)} um on {_micrometres(rounding)} um of a rounded edge"
    return rules.fillet_error * (edge / rounding) ** rules.fillet_order, said


def _unbounded(profile: Profile, edge: float, rounding: float, rules: Rules) -> bool:
    """Whether the pressure at the profile's edges is the mesh's: they are true ones, or roundings that ``edge`` m cannot tell."""
    return profile.unbounded or (bool(profile.edges) and rules.fillet_error * (edge / rounding) ** rules.fillet_order > 1)


def _edge_size(profile: Profile, preset: Preset, asked: float | None, rounding: float, rules: Rules) -> float:
    """Element edge (m) at the profile's own edges: as presets have it, and finer where a tolerance asks for that."""
    edge = min(preset.skin_edge / 4, profile.edge_radius / 2) if profile.edge_radius else preset.skin_edge / 4
    if asked is None:
        return edge
    if profile.unbounded:
        wanted = max(asked, rules.edge_floor) / rules.edge_error * profile.reach[1]
    else:
        wanted = (asked / rules.fillet_error) ** (1 / rules.fillet_order) * rounding
    return max(min(edge, wanted), rules.least_edge)


def _coarseness(external: PadMesh, rules: Rules) -> float:
    """By how much coarser the elements of an external mesh count than their edges."""
    return {"quad4": rules.linear_quad, "tri6": rules.linear_triangle}.get(external.element, 1.0)


# -- what is not to be had ----------------------------------------------------------------------------------------------


def _check_width(scene: Scene, pad: PadEstimate, contact: ContactEstimate, rules: Rules) -> None:
    """Refuses contacts narrower than any element."""
    if contact.half_width >= rules.least_half_width:
        return
    force = _force(scene, pad, contact)
    least = rules.least_half_width * 1e9
    said = f"the contact would be {contact.half_width * 1e9:.2g} nm to either side; allowed: {least:g} nm or more"
    if pad.pressed(force, 0.0).half_width < rules.least_half_width:
        i, leg = next((i, leg) for i, leg in enumerate(scene.motion) if leg.presses)
        raise PlanError(f"motion[{i}].{leg.key}: so little that {said}")
    key = ".curvature" if hasattr(scene.stimulus, "curvature") else ""
    raise PlanError(f"stimulus{key}: so sharp that {said}")


def _check_size(scene: Scene, size: MeshSize, ridges: Any, rules: Rules) -> None:
    """Refuses meshes of more nodes than are allowed, from above and before anything is allocated."""
    outline = scene.specimen.outline
    fine = scene.specimen.soft_thickness if outline is None else outline.epidermis_thickness + outline.dermis_thickness
    rows = fine / size.layer_edge + 4
    nodes = 8 * rows * (size.fine_half_width / size.skin_edge + len(size.focus))
    if nodes > rules.most_nodes:
        key = "accuracy.skin_edge" if getattr(scene.accuracy, "skin_edge", None) else "accuracy"
        least = size.skin_edge * (nodes / rules.most_nodes) ** 0.5
        raise PlanError(
            f"{key}: edges of {_micrometres(size.skin_edge)} um make {nodes:.2g} nodes; "
            f"allowed: {rules.most_nodes:g} nodes, edges of about {_micrometres(least)} um"
        )
    if ridges is not None:
        wave = ridges.inner.pitch / (2 if ridges.inner.limiting else 1)
        nodes = 8 * 20 * 8 * (ridges.half_width + ridges.inner.pitch) / wave
        if nodes > rules.most_nodes:
            raise PlanError(
                f"specimen.ridges.inner.pitch: {ridges.half_width / wave:.2g} ridges to either side make {nodes:.2g} nodes; "
                f"allowed: {rules.most_nodes:g} nodes, a pitch of about {_micrometres(wave * nodes / rules.most_nodes)} um"
            )


def _check_memory(scene: Scene, nodes: int, steps: int, rules: Rules) -> None:
    """Refuses what would need more memory than the machine has, or more nodes than are allowed."""
    machine = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    receptors = len(scene.outputs.receptors.depths) * len(scene.outputs.receptors.offsets)
    needed = {
        "accuracy": nodes * rules.bytes_node,
        "accuracy.steps" if getattr(scene.accuracy, "steps", None) else "motion": nodes * steps * rules.bytes_step,
        "outputs.receptors": receptors * (steps + 1) * _RECEPTOR_BYTES,
    }
    if nodes > rules.most_nodes:
        raise PlanError(f"accuracy: {nodes} nodes; allowed: {rules.most_nodes:g}")
    if sum(needed.values()) > rules.most_memory * machine:
        worst = max(needed, key=needed.get)
        raise PlanError(
            f"{worst}: {nodes} nodes, {steps} steps and {receptors} receptors need about {sum(needed.values()) / 1e9:.2g} GB "
            f"of memory; allowed: {rules.most_memory * machine / 1e9:.2g} GB on this machine"
        )


def _micrometres(length: float) -> str:
    return f"{length * 1e6:.3g}"


def _percent(error: float) -> str:
    return f"{100 * error:.2g} %" if error < 0.995 else "more than 100 %"


def estimated_error(
    edge: float,
    half_width: float,
    steps: int | None = None,
    stroked: bool = False,
    body_edge: float | None = None,
    rules: Rules = RULES,
) -> float:
    """Expected relative error of depth, width, pressure and strain energy at the legs' ends, from :class:`MeasuredErrors`.

    And at least what an edge of the contact between two nodes may be misplaced by.

    Args:
        edge: m, skin edge in the contact. half_width: m, of the contact: estimated before a run, found after it.
        steps: of a leg; None when time does not matter. stroked: does the pad move along the surface?
        body_edge: m, skin edge around the contact where that is coarser: no finer than the widest contact measured needs it.
    """
    found = [_measured_error(edge, half_width, steps, stroked, rules), rules.safety * rules.edge_share * edge / half_width]
    if body_edge is not None and body_edge > edge:
        found.append(_measured_error(body_edge, rules.errors.half_widths[-1], steps, stroked, rules))
    return float(max(found))


def _measured_error(edge: float, half_width: float, steps: int | None, stroked: bool, rules: Rules) -> float:
    known = rules.errors
    # narrower contacts than were measured are similar to the narrowest one on a coarser mesh
    alike = edge * max(known.half_widths[0] / half_width, 1.0)
    rows = known.edge * _THESIS_ROWS / alike

    def between(count, table, order):
        columns = [_read(count, tuple(table), column, order) for column in zip(*table.values(), strict=True)]
        return float(np.exp(np.interp(np.log(half_width), np.log(known.half_widths), np.log(columns))))

    def stroke(count, table, order):
        return _read(count, tuple(table), tuple(table.values()), order) if stroked else 0.0

    # a stroke's errors come on top of those of a press as narrow
    error = between(rows, known.mesh, rules.mesh_order) + stroke(rows, known.stroke_mesh, rules.mesh_order)
    if steps is not None:
        error += between(steps, known.time, rules.time_order) + stroke(steps, known.stroke_time, rules.time_order)
    return rules.safety * error


def _read(count: float, counts: tuple[int, ...], errors: tuple[float, ...], order: float) -> float:
    """Error at ``count`` between measured ones, in logarithms; beyond them it goes on with ``order``."""
    inside = np.clip(count, counts[0], counts[-1])
    error = np.exp(np.interp(np.log(inside), np.log(counts), np.log(errors)))
    return float(error * (inside / count) ** order)


def _friction(scene: Scene, tolerance: float, rules: Rules) -> Effect:
    if scene.friction == 0:
        return Effect(False, "the coefficient is 0")
    if any(leg.strokes for leg in scene.motion):
        return Effect(True, f"the skin is stroked with a coefficient of {scene.friction:g}")
    worth = min(rules.pressing_friction * scene.friction, rules.most_pressing_friction)
    number = f"in a press a coefficient of {scene.friction:g} changes up to {worth:.1%}, {tolerance:.1%} is allowed"
    return Effect(worth > tolerance, f"nothing slides; {number}")


def _small_strain_error(pad: PadEstimate, profile: Profile, contact: ContactEstimate, rules: Rules) -> float:
    error = rules.small_strain_error * contact.depth / pad.soft_thickness
    return max(error, contact.strain) if profile.singular else error


def _finite_strain(
    pad: PadEstimate, profile: Profile, contact: ContactEstimate, laws: float, tolerance: float, rules: Rules
) -> Effect:
    error = _small_strain_error(pad, profile, contact, rules) + laws
    source = "from the depth and the layers' laws" if laws else "from the depth"
    return Effect(error > tolerance, f"small strain would be wrong by up to {error:.1%} ({source}), {tolerance:.1%} is allowed")


def _ridges(scene: Scene, moves: bool, contact: ContactEstimate, tolerance: float, rules: Rules) -> Effect:
    ridges, layers = scene.specimen.ridges, scene.specimen.layers
    if ridges is None:
        return Effect(False, "the specimen has none")
    inner, outer = ridges.inner, ridges.outer
    why = f"the specimen has inner ridges {inner.pitch * 1e3:.3g} mm apart, {inner.height * 1e3:.3g} mm high"
    if outer is not None:
        why += f", and outer ones {(outer.period or inner.pitch) * 1e3:.3g} mm apart, {outer.height * 1e3:.3g} mm high"
    border = scene.specimen.outline.epidermis_thickness
    known = (
        outer is None and not moves and layers.epidermis.youngs_modulus <= rules.ridge_contrast * layers.dermis.youngs_modulus
        and min((abs(depth - border) for depth in scene.outputs.receptors.depths), default=border) > 2 * inner.height
    )  # fmt: skip
    narrow = max(1.0, rules.ridge_width * inner.pitch / max(contact.half_width, 1e-6))
    worth = rules.ridge_change * narrow * inner.height / inner.pitch
    if not known or worth > tolerance:
        return Effect(True, why)
    return Effect(False, f"{why}: they change up to {worth:.1%} of a press, {tolerance:.1%} is allowed")


def _resolved(effect: Effect, layered: tuple, edge: float) -> tuple[Effect, float]:
    """The ridges' effect with how finely they are meshed, and the skin's edge (m) under the apex; `edge` without ridges."""
    from fingerpad.specimen.layered import ridge_resolution, skin_edge

    per_ridge, per_height = ridge_resolution(*layered)
    said = f"{per_ridge:.1f} elements from ridge to ridge, {per_height} rows within their height of the interface"
    return replace(effect, why=f"{effect.why}: {said}"), skin_edge(*layered[:3], edge)


def _symmetry(scene, profile, external, ridges) -> Effect:
    if not profile.symmetric:
        return Effect(False, "the stimulus is not symmetric about x = 0")
    if _moves(scene):
        return Effect(False, "the motion is not symmetric: the pad moves along the surface")
    if external is not None and not external.symmetric:
        return Effect(False, "the external mesh is not its own mirror image in x = 0")
    if ridges is not None:
        from fingerpad.specimen.ridges import RidgedPad

        if not RidgedPad(scene.specimen.outline, ridges).symmetric:
            return Effect(False, "the ridges are not their own mirror image in x = 0")
    return Effect(True, "pad, stimulus and motion are mirror images in x = 0: half the unknowns suffice")


def _viscoelasticity(
    scene: Scene, profile: Profile, contact: ContactEstimate, tolerance: float, rules: Rules
) -> tuple[Effect, str]:
    prony = Prony(tuple(t.g for t in scene.specimen.prony), tuple(t.tau for t in scene.specimen.prony))
    if not prony:
        return Effect(False, "the specimen has no Prony series"), "long_term"
    durations = [
        contact.depth / leg.speed if leg.releases and leg.speed else duration
        for leg, duration in zip(scene.motion, leg_durations(scene), strict=True)
    ]
    if all(d is None for d in durations):
        return Effect(False, "no leg names a rate: steady states need the long-term moduli only"), "long_term"
    timed = [d for d in durations if d is not None]
    limit, relaxed = rules.relaxation_share * tolerance, 1 - float(prony.relaxation(sum(timed)))
    if None not in durations and relaxed < limit:
        why = f"the motion is over before {relaxed:.2%} of the stress can relax ({limit:.2%} allowed): instantaneous moduli"
        return Effect(False, why), "instantaneous"
    loading = []
    for duration, leg in zip(durations, scene.motion, strict=True):
        if duration is None or not leg.loads:
            continue
        if leg.strokes:
            if profile.steepness == 0 and scene.friction == 0:
                continue  # a smooth plate sliding changes nothing
            # the narrowest contact is a new one, and the skin has stretched anew, after half its width
            duration = min(duration, contact.half_width / leg.speed)
        loading.append(duration)
    limit = rules.lag_share * tolerance
    lag = max((float(np.sum(prony.beta * np.asarray(prony.tau)) / d) for d in loading), default=0.0)
    if lag < limit:
        why = f"so slow that viscosity adds at most {lag:.2%} to the stress ({limit:.2%} allowed): long-term moduli"
        return Effect(False, why), "long_term"
    why = f"{relaxed:.0%} of the shear stress can relax within the {sum(timed):.3g} s of the motion"
    return Effect(True, why), "long_term"


def leg_durations(scene: Scene) -> list[float | None]:
    """Seconds of each leg; None for steady ones."""
    out: list[float | None] = [None] * len(scene.motion)
    for step in schedule(scene, 1, True):
        out[step.leg] = None if step.dt >= STEADY else (out[step.leg] or 0.0) + step.dt
    return out


def _apply_overrides(scene: Scene, effects: dict[str, Effect]) -> None:
    for name, wanted in scene.effects.items():
        effect = effects[name]
        if wanted == effect.on:
            continue
        none = {"ridges": scene.specimen.ridges is None, "friction": scene.friction == 0}
        if wanted and none.get(name):
            raise PlanError(f"{scene.name}: effects.{name}: on, but {effect.why}; allowed: off or auto")
        if wanted and name == "symmetry":
            raise PlanError(f"{scene.name}: effects.symmetry: on, but {effect.why}; allowed: off or auto")
        if wanted and name == "viscoelasticity" and not scene.specimen.prony:
            raise PlanError(f"{scene.name}: effects.viscoelasticity: on, but {effect.why}; allowed: off or auto")
        effects[name] = Effect(wanted, f"asked for in the scene (the planner: {'on' if effect.on else 'off'}, {effect.why})")


def _element(by_hand: Discretisation | None, external: PadMesh | None) -> str:
    natural = KINDS[external.element if external else "quad9"].solved
    if by_hand is None or by_hand.element is None or by_hand.element == natural:
        return natural
    raise PlanError(
        f"accuracy.element: {by_hand.element} does not fit the mesh of {external.element if external else 'quad9'}; "
        f"allowed: {natural}"
    )


def _wander(scene: Scene, pad: PadEstimate, profile: Profile, friction: bool, rules: Rules) -> float:
    """How far (m) a stroke takes the contact from the middle of the pad: to where the pad is as steep as the surface."""
    way = np.cumsum([leg.along for leg in scene.motion])
    return min(profile.steepness * pad.apex_radius, np.abs(way).max()) + rules.skin_stretch * friction


def _mesh_size(
    scene: Scene,
    preset: Preset,
    profile: Profile,
    contact: ContactEstimate,
    half_width: float,
    wander: float,
    rounding: float,
    rules: Rules,
) -> MeshSize:
    offsets = max((abs(x) for x in scene.outputs.receptors.offsets), default=0.0)
    fine = max(rules.fine_half_width, 1.3 * half_width, half_width + wander, offsets)
    focus, radial = (), None
    if preset.focus is not None:
        # fine all over the contact, somewhat wider than it is estimated, and not at the apex only
        reach = 1.2 * min(half_width, _reach(scene, contact))
        places = np.linspace(0.0, reach, max(2, round(reach / preset.focus / 2) + 1))
        focus, radial = tuple((float(x), preset.focus) for x in places), preset.focus
    if profile.edges:
        edge = _edge_size(profile, preset, None if scene.tolerance is None else preset.tolerance, rounding, rules)
        focus += tuple((x, edge) for x in sorted({abs(x) for x in profile.edges}))
        if scene.tolerance is not None:
            radial = min(edge, radial or edge)
    elif preset.focus is None and _refined_at_apex(scene) and preset.skin_edge > contact.half_width:
        focus = ((0.0, max(contact.half_width / rules.edges_per_half_width, rules.least_edge)),)
    return MeshSize(
        skin_edge=preset.skin_edge,
        fine_half_width=min(fine, 0.9 * scene.specimen.half_width),
        layer_edge=preset.layer_edge,
        growth=preset.growth,
        focus=focus,
        skin_radial_edge=radial,
    )


def _refined_at_apex(scene: Scene) -> bool:
    """Whether a contact narrower than an edge is refined for: not where edges are given by hand or the contact moves."""
    return not isinstance(scene.accuracy, Discretisation) and not _moves(scene)


def _cost(nodes: int, steps: int, effects: dict[str, Effect], rules: Rules) -> float:
    if effects["friction"].on:
        nodes = nodes * rules.frictional
    if effects["finite_strain"].on:
        work = rules.seconds_finite * rules.iterations_finite
    else:
        work = rules.seconds_small * rules.iterations_small
    return float(rules.seconds_start + work * nodes * steps)

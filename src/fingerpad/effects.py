"""Scene -> plan: which effects the scene calls for, which discretisation, why, and what it will cost.

Nothing is solved here. Every choice carries a sentence with the number that decided it, and every choice can be overridden in
the scene. The thresholds and measured constants stand together in :class:`Rules`.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.estimates import ContactEstimate, PadEstimate
from fingerpad.scene import Discretisation, Hold, PressToDepth, PressToForce, Scene, Slide, StepAndRepeat
from fingerpad.specimen.external import read_pad_mesh
from fingerpad.specimen.materials import Prony
from fingerpad.specimen.measures import apex_edge, apex_measures
from fingerpad.specimen.mesh import MeshSize, PadMesh, count_nodes, smallest_edge
from fingerpad.stimuli.motion import STEADY, programme
from fingerpad.stimuli.profiles import Curve, Profile, profile_of

if TYPE_CHECKING:
    from collections.abc import Mapping


class PlanError(ValueError):
    """The scene asks for a combination that cannot be planned; the message is one line."""


@dataclass(frozen=True)
class Preset:
    """A discretisation: edges m, steps per leg, longest step of a slide m, and the error it was measured to have.

    The error is the largest of the headline quantities.
    """

    skin_edge: float
    layer_edge: float
    steps: int
    growth: float
    error: float
    slide_step: float | None


@dataclass(frozen=True)
class Rules:
    """Thresholds and measured constants of the planner.

    Attributes:
        presets: by name; errors are measured on the ramp-and-hold family against a mesh of half the edge and steps of ``fine``.
        mesh_order: observed order with which that error falls with the skin edge.
        small_strain_error: of small strain in the headline quantities, over depth / soft thickness, at most; small strain is used
            when that is within the accuracy asked for.
        pressing_friction: change of the headline quantities by friction in a press, over the coefficient; most_pressing_friction:
            what it comes to where the whole contact sticks. Friction is left out of presses when that is within the accuracy.
        relaxation_share: viscosity is left out when what it can change is below this share of the accuracy.
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
    mesh_order: float = 1.5
    small_strain_error: float = 4.6
    pressing_friction: float = 2.0
    most_pressing_friction: float = 0.2
    relaxation_share: float = 0.25
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
        contact_edge: m, skin edge under the apex; estimated_error: relative, of the headline quantities.
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
        }

    def write(self, path: str | Path) -> None:
        """Write plan.json, whole or not at all."""
        from fingerpad.files import write_text

        write_text(path, json.dumps(self.to_dict(), indent=2) + "\n")


def plan(scene: Scene, rules: Rules = RULES) -> Plan:
    """Decide effects and discretisation of ``scene``.

    Raises:
        PlanError: an override asks for what the scene cannot have. MeshError: an external mesh cannot be read, or the pad has no
        room for its ridges.
    """
    external = _external(scene)
    ridges = scene.specimen.ridges if scene.effects.get("ridges", True) else None
    profile = profile_of(scene.stimulus)
    pad = _pad(scene, external)
    moves = _moves(scene)
    # a surface is flat where it is pressed first, unless it is all curved; on its way the pad meets the sharpest convexity
    contact = _worst_contact(scene, pad, profile, profile.convexity if moves or not isinstance(profile, Curve) else 0.0)
    inertia, fastest = _inertia_ratio(scene, contact)
    if inertia > rules.inertia_limit:
        raise PlanError(
            f"motion[{fastest}]: so fast that inertia matters (rho v^2 / mu = {inertia:.2g}); "
            f"allowed: up to {rules.inertia_limit:g}"
        )
    preset, by_hand = _preset(scene, rules, contact)
    tolerance = preset.error
    effects = {
        "friction": _friction(scene, tolerance, rules),
        "viscoelasticity": Effect(False, ""),
        "finite_strain": _finite_strain(pad, profile, contact, tolerance, rules),
        "symmetry": _symmetry(scene, profile, external, ridges),
        "ridges": _ridges(scene),
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
        widest = _worst_contact(scene, pad, profile, 0.0) if moves and isinstance(profile, Curve) else contact
        wander = _wander(scene, pad, profile, effects["friction"].on, rules) if moves else 0.0
        size = _mesh_size(scene, preset, profile, contact, widest.half_width, wander, rules)
        layered = scene.specimen.outline, size, ridges, scene.specimen.layers.stratum_corneum is not None
        nodes, smallest = count_nodes(*layered), smallest_edge(*layered)
        edge = min([size.skin_edge, *(edge for x, edge in size.focus if x == 0)])
        if ridges is not None:
            effects["ridges"], edge = _resolved(effects["ridges"], layered, edge)
    else:
        size, nodes = None, len(external.points)
        smallest, edge = external.quality()["smallest_edge_m"], apex_edge(external)
    if effects["symmetry"].on:
        nodes = nodes // 2 + 1
    error = estimated_error(edge, contact.half_width, rules)
    return Plan(
        effects, state, element, size, contact, steps_per_leg, slide_step, steps, timed, nodes, smallest, inertia, edge, error,
        _cost(nodes, steps, effects, rules),
    )  # fmt: skip


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
    data = json.loads(Path(path).read_text(encoding="utf-8"))
    size = data["mesh_size_SI"]
    if size is not None:
        size = MeshSize(**size | {"focus": tuple(tuple(pair) for pair in size["focus"])})
    known = data["discretisation"]
    return Plan(
        {name: Effect(**effect) for name, effect in data["effects"].items()}, data["moduli_state"], known["element"], size,
        ContactEstimate(**data["contact_estimate_SI"]), data["steps_per_leg"], data["slide_step_SI"], known["steps"],
        data["timed"], known["nodes"], data["smallest_edge_SI"], data["inertia_ratio"], data["contact_edge_SI"],
        data["estimated_error"], data["predicted_cost_s"],
    )  # fmt: skip


def _moves(scene: Scene) -> bool:
    return any(isinstance(leg, (Slide, StepAndRepeat)) for leg in scene.motion)


# -- the choices --------------------------------------------------------------------------------------------------------


def _external(scene: Scene) -> PadMesh | None:
    """The scene's own mesh, if it names one."""
    if scene.specimen.mesh is None:
        return None
    mesh = read_pad_mesh(scene.specimen.mesh).elevated()
    if scene.specimen.layers.stratum_corneum is not None and "stratum_corneum" not in mesh.regions:
        raise PlanError("specimen.layers.stratum_corneum: is no surface of the mesh; allowed: a mesh with it, or no such layer")
    return mesh


def _pad(scene: Scene, external: PadMesh | None) -> PadEstimate:
    specimen, layers = scene.specimen, scene.specimen.layers

    def plane(layer):
        return layer.youngs_modulus / (1 - layer.poisson_ratio**2)

    if specimen.outline is not None:
        outline = specimen.outline
        radius, epidermis, soft = outline.apex_radius, outline.epidermis_thickness, outline.soft_thickness
    else:
        radius, epidermis, soft = apex_measures(external)
    softest = min(plane(layers.dermis), plane(layers.fat))
    relax = 1.0
    if specimen.moduli == "instantaneous" and specimen.prony:
        relax = 1 - sum(term.g for term in specimen.prony)
    return PadEstimate(radius, epidermis, soft, relax * plane(layers.epidermis), relax * softest)


def _worst_contact(scene: Scene, pad: PadEstimate, profile: Profile, curvature: float) -> ContactEstimate:
    """The deepest contact of the motion with a surface of ``curvature`` 1/m."""
    specimen = scene.specimen
    # at a kept depth the surface comes as much deeper as it reaches below its start
    keeps_depth = any(isinstance(leg, Slide) and leg.keep == "depth" for leg in scene.motion)
    worst = ContactEstimate(0.0, 0.0, 0.0)
    for leg in scene.motion:
        if isinstance(leg, PressToForce):
            now = pad.pressed(leg.press_to_force / specimen.contact_length, curvature)
        elif isinstance(leg, PressToDepth):
            now = pad.pressed_to(leg.press_to_depth, curvature)
        else:
            continue
        if keeps_depth:
            now = pad.pressed_to(now.depth + profile.dip, curvature)
        worst = max(worst, now, key=lambda estimate: estimate.depth)
    if scene.stimulus.shape == "bar":
        wide = max(worst.half_width, scene.stimulus.width / 2)
        worst = replace(worst, half_width=wide, strain=max(worst.strain, 0.5))
    return worst


def _inertia_ratio(scene: Scene, contact: ContactEstimate) -> tuple[float, int]:
    """rho v^2 / mu of the softest layer, what leaving inertia out of the equations neglects; and the fastest leg."""
    layers = scene.specimen.layers
    softest = min(
        layer.youngs_modulus / (2 * (1 + layer.poisson_ratio)) for layer in (layers.epidermis, layers.dermis, layers.fat)
    )
    speed = [0.0] * len(scene.motion)
    for i, (leg, duration) in enumerate(zip(scene.motion, leg_durations(scene), strict=True)):
        if duration and not isinstance(leg, Hold):
            depth = leg.press_to_depth if isinstance(leg, PressToDepth) else contact.depth
            speed[i] = getattr(leg, "speed", None) or depth / duration
    fastest = int(np.argmax(speed))
    return 1000.0 * speed[fastest] ** 2 / softest, fastest


def _preset(scene: Scene, rules: Rules, contact: ContactEstimate) -> tuple[Preset, Discretisation | None]:
    """The discretisation asked for: a named one, the cheapest that meets a tolerance, or one by hand."""
    accuracy = scene.accuracy
    if isinstance(accuracy, str):
        return rules.presets[accuracy], None
    thesis = rules.presets["thesis"]
    if isinstance(accuracy, Discretisation):
        edge = accuracy.skin_edge or thesis.skin_edge
        scale = edge / thesis.skin_edge
        error = estimated_error(edge, contact.half_width, rules)
        return replace(thesis, skin_edge=edge, layer_edge=thesis.layer_edge * scale, error=error), accuracy
    scale = (accuracy / estimated_error(thesis.skin_edge, contact.half_width, rules)) ** (1 / rules.mesh_order)
    scale = float(np.clip(scale, 0.15, 3.0))
    steps = int(np.clip(round(thesis.steps * (thesis.error / accuracy) ** 0.5), 6, 200))
    slide_step = thesis.slide_step * thesis.steps / steps
    return Preset(thesis.skin_edge * scale, thesis.layer_edge * scale, steps, thesis.growth, accuracy, slide_step), None


def estimated_error(edge: float, half_width: float, rules: Rules = RULES) -> float:
    """Expected relative error of depth, width, pressure and strain energy: the measured law error ~ (edge / width)^order.

    Args:
        edge: m, skin edge in the contact. half_width: m, of the contact: estimated before a run, found after it.
    """
    thesis = rules.presets["thesis"]
    # the presets' errors were measured at the sharpest of the thesis's cylinders, contact half-width 0.35 mm
    relative = (edge / thesis.skin_edge) * min(0.35e-3 / max(half_width, 1e-5), 10.0)
    return float(thesis.error * max(relative, 0.25 * edge / thesis.skin_edge) ** rules.mesh_order)


def _friction(scene: Scene, tolerance: float, rules: Rules) -> Effect:
    if scene.friction == 0:
        return Effect(False, "the coefficient is 0")
    if any(isinstance(leg, Slide) for leg in scene.motion):
        return Effect(True, f"the skin is stroked with a coefficient of {scene.friction:g}")
    worth = min(rules.pressing_friction * scene.friction, rules.most_pressing_friction)
    number = f"in a press a coefficient of {scene.friction:g} changes up to {worth:.1%}, {tolerance:.1%} is allowed"
    return Effect(worth > tolerance, f"nothing slides; {number}")


def _finite_strain(pad: PadEstimate, profile: Profile, contact: ContactEstimate, tolerance: float, rules: Rules) -> Effect:
    error = rules.small_strain_error * contact.depth / pad.soft_thickness
    if profile.singular:
        error = max(error, contact.strain)
    return Effect(
        error > tolerance, f"small strain would be wrong by up to {error:.1%} (from the depth), {tolerance:.1%} is allowed"
    )


def _ridges(scene: Scene) -> Effect:
    ridges = scene.specimen.ridges
    if ridges is None:
        return Effect(False, "the specimen has none")
    inner, outer = ridges.inner, ridges.outer
    why = f"the specimen has inner ridges {inner.pitch * 1e3:.3g} mm apart, {inner.height * 1e3:.3g} mm high"
    if outer is not None:
        why += f", and outer ones {(outer.period or inner.pitch) * 1e3:.3g} mm apart, {outer.height * 1e3:.3g} mm high"
    return Effect(True, why)


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
    durations = leg_durations(scene)
    if all(d is None for d in durations):
        return Effect(False, "no leg names a rate: steady states need the long-term moduli only"), "long_term"
    timed = [d for d in durations if d is not None]
    limit = rules.relaxation_share * tolerance
    relaxed = 1 - float(prony.relaxation(sum(timed)))
    if None not in durations and relaxed < limit:
        why = f"the motion is over before {relaxed:.2%} of the stress can relax ({limit:.2%} allowed): instantaneous moduli"
        return Effect(False, why), "instantaneous"
    loading = []
    for duration, leg in zip(durations, scene.motion, strict=True):
        if duration is None or isinstance(leg, Hold):
            continue
        if isinstance(leg, Slide):
            if profile.steepness == 0 and scene.friction == 0:
                continue  # a smooth plate sliding changes nothing
            # the narrowest contact is a new one, and the skin has stretched anew, after half its width
            duration = min(duration, contact.half_width / leg.speed)
        loading.append(duration)
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
        if wanted and (name == "ridges" or (name == "friction" and scene.friction == 0)):
            raise PlanError(f"{scene.name}: effects.{name}: on, but {effect.why}; allowed: off or auto")
        if wanted and name == "symmetry":
            raise PlanError(f"{scene.name}: effects.symmetry: on, but {effect.why}; allowed: off or auto")
        if wanted and name == "viscoelasticity" and not scene.specimen.prony:
            raise PlanError(f"{scene.name}: effects.viscoelasticity: on, but {effect.why}; allowed: off or auto")
        effects[name] = Effect(wanted, f"asked for in the scene (the planner: {'on' if effect.on else 'off'}, {effect.why})")


def _element(by_hand: Discretisation | None, external: PadMesh | None) -> str:
    natural = {"quad9": "Q2P1", "quad4": "Q1P0", "tri6": "P2B"}[external.element if external else "quad9"]
    if by_hand is None or by_hand.element is None or by_hand.element == natural:
        return natural
    raise PlanError(
        f"accuracy.element: {by_hand.element} does not fit the mesh of {external.element if external else 'quad9'}; "
        f"allowed: {natural}"
    )


def _wander(scene: Scene, pad: PadEstimate, profile: Profile, friction: bool, rules: Rules) -> float:
    """How far (m) a stroke takes the contact from the middle of the pad: to where the pad is as steep as the surface."""
    way = np.cumsum([getattr(leg, "slide", None) or getattr(leg, "step", 0.0) for leg in scene.motion])
    return min(profile.steepness * pad.apex_radius, np.abs(way).max()) + rules.skin_stretch * friction


def _mesh_size(
    scene: Scene, preset: Preset, profile: Profile, contact: ContactEstimate, half_width: float, wander: float, rules: Rules
) -> MeshSize:
    outline = scene.specimen.outline
    offsets = max((abs(x) for x in scene.outputs.receptors.offsets), default=0.0)
    fine = max(rules.fine_half_width, 1.3 * half_width, half_width + wander, offsets)
    focus = ()
    if profile.edges:
        fillet = getattr(profile, "fillet", 0.0)
        edge = min(preset.skin_edge / 4, fillet / 2) if fillet else preset.skin_edge / 4
        focus = tuple((x, edge) for x in sorted({abs(x) for x in profile.edges}))
    elif not isinstance(scene.accuracy, Discretisation) and not _moves(scene) and preset.skin_edge > contact.half_width:
        focus = ((0.0, contact.half_width / rules.edges_per_half_width),)
    return MeshSize(
        skin_edge=preset.skin_edge,
        fine_half_width=min(fine, 0.9 * outline.half_width),
        layer_edge=preset.layer_edge,
        growth=preset.growth,
        focus=focus,
    )


def _cost(nodes: int, steps: int, effects: dict[str, Effect], rules: Rules) -> float:
    if effects["friction"].on:
        nodes = nodes * rules.frictional
    if effects["finite_strain"].on:
        work = rules.seconds_finite * rules.iterations_finite
    else:
        work = rules.seconds_small * rules.iterations_small
    return float(rules.seconds_start + work * nodes * steps)

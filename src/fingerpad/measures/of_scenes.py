"""Inputs: measures of a scene alone, known before anything is simulated; and the counts of its mesh."""

from __future__ import annotations

import math

import numpy as np

from fingerpad.measures.measure import cylinders, deep, forced, held, measure, named, slides, strokes, wavy
from fingerpad.measures.steady import PLATE
from fingerpad.receptors.laws import THESIS_RATE
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.mesh import PadMesh, corner_count
from fingerpad.specimen.quality import quality
from fingerpad.stimuli.profiles import profile_of
from fingerpad.units import parse_quantity

GF = parse_quantity("1 gf", "force")
CYLINDERS = (79, 105, 158, 210, 315, 420, 630, 1260)
WAVES = (26, 39, 52, 79, 105, 157, 210, 315)
"""Curvatures (1/m) as the thesis lists them: of the pressed cylinders, and of the wavy surface."""
TRIALS = 4
"""Trials of a surface in Fig 4-2."""
NODE_SURFACE, NODE_COUNT = "210", 12
"""Surface and number of nodes of Fig 4-17."""


def of_specimen(scene: Scene) -> bool:
    """Scenes of the built-in outline."""
    return scene.specimen.outline is not None


# --- stimulus --------------------------------------------------------------------------------------------


@measure("mm", cylinders, "scene")
def diameter(scene):
    return 2e3 / scene.stimulus.curvature


@measure("mm", lambda scene: scene.stimulus.shape == "bar", "scene")
def bar_width(scene):
    return 1e3 * scene.stimulus.width


@measure("%", lambda scene: cylinders(scene) or wavy(scene), "scene")
def departure_of_curvature(scene):
    """Of the curvatures from the ones that the thesis lists, the largest."""
    if wavy(scene):
        found = [arc.curvature for arc in profile_of(scene.stimulus).segments if arc.curvature > 0]
        return max(100 * abs(k / listed - 1) for k, listed in zip(found, WAVES, strict=False))
    k = scene.stimulus.curvature
    return 100 * abs(k - min(CYLINDERS, key=lambda listed: abs(listed - k))) / k


@measure("mm", wavy, "scene")
def largest_radius(scene):
    return round(1e3 / min(scene.stimulus.curvatures), 6)


@measure("deg", wavy, "scene")
def half_angle(scene):
    return math.degrees(scene.stimulus.half_angle)


@measure("1/m", wavy, "scene")
def convexity_curvature(scene):
    """By the thesis's name of the convexity: its curvature, rounded."""
    arcs = [arc.curvature for arc in profile_of(scene.stimulus).segments if arc.curvature > 0]
    return {f"{k:.0f}": k for k in arcs}


@measure("1/m", wavy, "scene")
def hollow_curvature(scene):
    """The sharpest hollow's."""
    return -min(piece.curvature for piece in profile_of(scene.stimulus).segments)


@measure("mm", wavy, "scene")
def peak_to_valley(scene):
    """Height of the surface between its first and its last convexity."""
    profile = profile_of(scene.stimulus)
    ends = [end for arc in profile.segments if arc.curvature > 0 for end in (arc.start, arc.end)]
    return 1e3 * np.ptp(profile.outline(np.linspace(min(ends), max(ends), 4001)))


# --- motion ----------------------------------------------------------------------------------------------


def _depths(scene: Scene) -> list[float]:
    return [round(leg.press_to_depth * 1e3, 9) for leg in scene.motion if hasattr(leg, "press_to_depth")]


@measure("mm", deep, "scene")
def pressed_depth(scene):
    return {"first": _depths(scene)[0], "deepest": _depths(scene)[-1]}


@measure("mm", deep, "scene")
def depth_step(scene):
    return np.diff([0.0, *_depths(scene)]).max()


@measure("count", deep, "scene")
def thesis_depths(scene):
    """How many of the thesis's four depths are pressed to."""
    return len({0.5, 1.0, 1.5, 2.0} & set(_depths(scene)))


@measure("mm/s", lambda scene: deep(scene) and scene.motion[0].speed is not None, "scene")
def press_speed(scene):
    return 1e3 * scene.motion[0].speed


@measure("gf", forced, "scene")
def held_force(scene):
    return scene.motion[0].press_to_force / GF


@measure("gf/s", held, "scene")
def ramp_rate(scene):
    return scene.motion[0].rate / GF


@measure("s", held, "scene")
def ramp_time(scene):
    return scene.motion[0].press_to_force / scene.motion[0].rate


@measure("s", held, "scene")
def hold_time(scene):
    return sum(leg.hold for leg in scene.motion if hasattr(leg, "hold"))


@measure("mm/s", slides, "scene")
def stroke_speed(scene):
    return 1e3 * next(leg.speed for leg in scene.motion if hasattr(leg, "slide"))


@measure("mm", lambda scene: any(hasattr(leg, "step") for leg in scene.motion), "scene")
def step(scene):
    return 1e3 * next(leg.every for leg in scene.motion if hasattr(leg, "step"))


@measure("1", strokes, "scene")
def friction(scene):
    return scene.friction


@measure("N/m", forced, "scene")
def line_load(scene):
    return scene.motion[0].press_to_force / scene.specimen.contact_length


# --- specimen --------------------------------------------------------------------------------------------


@measure("um", of_specimen, "scene")
def thickness(scene):
    return {k: 1e6 * getattr(scene.specimen.outline, f"{k}_thickness") for k in ("stratum_corneum", "epidermis", "dermis")}


@measure("mm", of_specimen, "scene")
def apex_radius(scene):
    return 1e3 * scene.specimen.outline.apex_radius


@measure("1", of="scene")
def poisson_ratio(scene):
    return scene.specimen.layers.dermis.poisson_ratio


def _moduli(scene: Scene) -> dict[str, float]:
    layers = scene.specimen.layers
    return {k: getattr(layers, k).youngs_modulus * 1e-6 for k in ("epidermis", "dermis", "fat")}


@measure("MPa", of="scene")
def modulus(scene):
    return _moduli(scene)


@measure("1", of="scene")
def ratio_of_moduli(scene):
    epidermis, dermis, fat = _moduli(scene).values()
    return {"epidermis to dermis": epidermis / dermis, "dermis to fat": dermis / fat}


@measure("1", of="scene")
def prony_share(scene):
    return {str(i): term.g for i, term in enumerate(scene.specimen.prony, start=1)}


@measure("s", of="scene")
def prony_time(scene):
    return {str(i): term.tau for i, term in enumerate(scene.specimen.prony, start=1)}


@measure("1", of="scene")
def relaxation(scene):
    left = 1 - sum(term.g for term in scene.specimen.prony)
    return {"at once": left + sum(term.g for term in scene.specimen.prony), "long after": left}


@measure("MPa", of="scene")
def instantaneous_modulus(scene):
    """The long-term modulus over the long-time relaxation."""
    left = 1.0 if scene.specimen.moduli == "instantaneous" else 1 - sum(term.g for term in scene.specimen.prony)
    return {k: v / left for k, v in _moduli(scene).items()}


# --- what figures and predictions take as given ----------------------------------------------------------


@measure("count", named([PLATE]), "scene")
def measured_subjects(scene):
    """Of the thesis's Fig 3-7; the fifth one's data are not at hand."""
    raise KeyError("the fifth subject's data")


@measure("count", held, "scene")
def trials(scene):
    return TRIALS


@measure("count", held, "scene")
def nodes_shown(scene):
    return NODE_COUNT


@measure("(impulses/s)/Pa", forced, "scene")
def rate_per_energy(scene):
    return THESIS_RATE.per_energy


@measure("impulses/Pa", forced, "scene")
def rate_per_energy_rate(scene):
    return THESIS_RATE.per_rate


@measure("Pa", forced, "scene")
def energy_threshold(scene):
    return THESIS_RATE.threshold


@measure("Pa/s", forced, "scene")
def energy_rate_threshold(scene):
    return THESIS_RATE.rate_threshold


# --- the mesh --------------------------------------------------------------------------------------------


@measure("count", of="mesh")
def nodes(mesh: PadMesh):
    return quality(mesh)["nodes"]


@measure("count", of="mesh")
def elements(mesh: PadMesh):
    return quality(mesh)["elements"]


@measure("um", of="mesh")
def smallest_edge(mesh: PadMesh):
    """Of elements in epidermis and dermis within 2 mm of the middle, on the upper side."""
    corners = mesh.points[mesh.cells[:, : corner_count(mesh.element)]]
    middle = corners.mean(axis=1)
    near = (mesh.region < mesh.regions.index("fat")) & (abs(middle[:, 0]) < 2e-3) & (middle[:, 1] > 0)
    edges = corners[near] - np.roll(corners[near], 1, axis=1)
    return np.hypot(edges[..., 0], edges[..., 1]).min() * 1e6


@measure("mm", of="mesh")
def section(mesh: PadMesh):
    return {side: 1e3 * np.ptp(mesh.points[:, axis]) for axis, side in enumerate(("width", "height"))}


@measure("count", of="mesh")
def shaded_layers(mesh: PadMesh):
    """Layers with elements, the stratum corneum and the bone."""
    return len(mesh.regions) + 2

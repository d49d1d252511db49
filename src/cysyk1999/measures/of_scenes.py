"""Inputs: measures of a scene alone, known before anything is simulated; and the counts of its
mesh.
"""

from __future__ import annotations

import math
from functools import partial

import numpy as np

from cysyk1999.measures.responses import NODE_COUNT, TRIALS
from cysyk1999.measures.steady import PLATE
from fingerpad.measures.measure import (
    Measure,
    anywhere,
    cylinders,
    deep,
    forced,
    held,
    named,
    slides,
    speed_of,
    strokes,
    wavy,
)
from fingerpad.receptors.laws import THESIS_RATE
from fingerpad.scenes.scene import Scene
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.pad import PadMesh
from fingerpad.stimuli.curve import Segment
from fingerpad.units import parse_quantity

GF = parse_quantity("1 gf", "force")
CYLINDERS = (79, 105, 158, 210, 315, 420, 630, 1260)
WAVES = (26, 39, 52, 79, 105, 157, 210, 315)
"""Curvatures (1/m) as the thesis lists them: of the pressed cylinders, and of the wavy surface."""


def bar(scene: Scene) -> bool:
    return scene.stimulus.shape == "bar"


def steps(scene: Scene) -> bool:
    return any(leg.fresh for leg in scene.motion)


def timed(scene: Scene) -> bool:
    """Presses to a depth at a speed."""
    return deep(scene) and scene.motion[0].speed is not None


def finger(scene: Scene) -> bool:
    """Scenes of the built-in outline with its layers."""
    return scene.specimen.outline is not None


def _convex(scene: Scene) -> list[Segment]:
    return [arc for arc in scene.stimulus.segments if arc.curvature > 0]


def _departure(scene: Scene) -> float:
    """Largest departure (%) of the curvatures from the ones that the thesis lists."""
    if wavy(scene):
        return max(
            100 * abs(arc.curvature / listed - 1)
            for arc, listed in zip(_convex(scene), WAVES, strict=False)
        )
    k = scene.stimulus.curvature
    return 100 * abs(k - min(CYLINDERS, key=lambda listed: abs(listed - k))) / k


def _height(scene: Scene) -> float:
    """Height (mm) of the wavy surface between its first and its last convexity."""
    ends = [end for arc in _convex(scene) for end in (arc.start, arc.end)]
    return 1e3 * np.ptp(scene.stimulus.outline(np.linspace(min(ends), max(ends), 4001)))


def _depths(scene: Scene) -> list[float]:
    """Depths (mm) pressed to, in their order."""
    return [round(leg.depth * 1e3, 9) for leg in scene.motion if leg.depth is not None]


def _moduli(scene: Scene) -> dict[str, float]:
    """Young's modulus (MPa) of the layers."""
    return {
        k: getattr(scene.specimen.layers, k).youngs_modulus * 1e-6
        for k in ("epidermis", "dermis", "fat")
    }


def _ratios(scene: Scene) -> dict[str, float]:
    epidermis, dermis, fat = _moduli(scene).values()
    return {"epidermis to dermis": epidermis / dermis, "dermis to fat": dermis / fat}


def _left(scene: Scene) -> float:
    """Long-time relaxation."""
    return 1 - sum(term.g for term in scene.specimen.prony)


def _relaxation(scene: Scene) -> dict[str, float]:
    return {
        "at once": _left(scene) + sum(term.g for term in scene.specimen.prony),
        "long after": _left(scene),
    }


def _instantaneous(scene: Scene) -> dict[str, float]:
    """Instantaneous modulus (MPa): the long-term one over the long-time relaxation."""
    left = 1.0 if scene.specimen.moduli == "instantaneous" else _left(scene)
    return {k: v / left for k, v in _moduli(scene).items()}


def _subjects(scene: Scene) -> float:
    """Measured subjects of Fig 3-7."""
    raise KeyError("the fifth subject's data are not at hand")


given = partial(Measure, of="scene")

STIMULUS = (
    given("diameter", "mm", lambda s: 2e3 / s.stimulus.curvature, cylinders),
    given("bar_width", "mm", lambda s: 1e3 * s.stimulus.width, bar),
    given("departure_of_curvature", "%", _departure, lambda s: cylinders(s) or wavy(s)),
    given("largest_radius", "mm", lambda s: round(1e3 / min(s.stimulus.curvatures), 6), wavy),
    given("half_angle", "deg", lambda s: math.degrees(s.stimulus.half_angle), wavy),
    # by the thesis's name of the convexity: its curvature, rounded
    given(
        "convexity_curvature",
        "1/m",
        lambda s: {f"{arc.curvature:.0f}": arc.curvature for arc in _convex(s)},
        wavy,
    ),
    given(
        "hollow_curvature",
        "1/m",
        lambda s: -min(arc.curvature for arc in s.stimulus.segments),
        wavy,
    ),
    given("peak_to_valley", "mm", _height, wavy),
)

MOTION = (
    given(
        "pressed_depth", "mm", lambda s: {"first": _depths(s)[0], "deepest": _depths(s)[-1]}, deep
    ),
    given("depth_step", "mm", lambda s: np.diff([0.0, *_depths(s)]).max(), deep),
    # how many of the thesis's four depths are pressed to
    given("thesis_depths", "count", lambda s: len({0.5, 1.0, 1.5, 2.0} & set(_depths(s))), deep),
    given("press_speed", "mm/s", lambda s: 1e3 * s.motion[0].speed, timed),
    given("held_force", "gf", lambda s: s.motion[0].force / GF, forced),
    given("ramp_rate", "gf/s", lambda s: s.motion[0].rate / GF, held),
    given("ramp_time", "s", lambda s: s.motion[0].force / s.motion[0].rate, held),
    given("hold_time", "s", lambda s: sum(leg.hold for leg in s.motion if leg.key == "hold"), held),
    given("stroke_speed", "mm/s", lambda s: 1e3 * speed_of(s), slides),
    given("step", "mm", lambda s: 1e3 * next(leg.every for leg in s.motion if leg.fresh), steps),
    given("friction", "1", lambda s: s.friction, strokes),
    given("line_load", "N/m", lambda s: s.motion[0].force / s.specimen.contact_length, forced),
)

LAYERS = ("stratum_corneum", "epidermis", "dermis")
SPECIMEN = (
    given(
        "thickness",
        "um",
        lambda s: {k: 1e6 * getattr(s.specimen.outline, f"{k}_thickness") for k in LAYERS},
        finger,
    ),
    given("apex_radius", "mm", lambda s: 1e3 * s.specimen.outline.apex_radius, finger),
    given("poisson_ratio", "1", lambda s: s.specimen.layers.dermis.poisson_ratio, finger),
    given("modulus", "MPa", _moduli, finger),
    given("ratio_of_moduli", "1", _ratios, finger),
    given("instantaneous_modulus", "MPa", _instantaneous, finger),
    given(
        "prony_share",
        "1",
        lambda s: {str(i): term.g for i, term in enumerate(s.specimen.prony, start=1)},
    ),
    given(
        "prony_time",
        "s",
        lambda s: {str(i): term.tau for i, term in enumerate(s.specimen.prony, start=1)},
    ),
    given("relaxation", "1", _relaxation),
)

TAKEN = (
    given("measured_subjects", "count", _subjects, named([PLATE])),
    given("trials", "count", lambda s: TRIALS, held),
    given("nodes_shown", "count", lambda s: NODE_COUNT, held),
    given("rate_per_energy", "(impulses/s)/Pa", lambda s: THESIS_RATE.per_energy, forced),
    given("rate_per_energy_rate", "impulses/Pa", lambda s: THESIS_RATE.per_rate, forced),
    given("energy_threshold", "Pa", lambda s: THESIS_RATE.threshold, forced),
    given("energy_rate_threshold", "Pa/s", lambda s: THESIS_RATE.rate_threshold, forced),
)
"""What figures and predictions take as given."""


def _smallest_edge(mesh: PadMesh) -> float:
    """Smallest element edge (um) in epidermis and dermis within 2 mm of the middle, on the upper
    side.
    """
    corners = mesh.points[mesh.cells[:, : KINDS[mesh.element].corners]]
    middle = corners.mean(axis=1)
    near = (
        (mesh.region < mesh.regions.index("fat")) & (abs(middle[:, 0]) < 2e-3) & (middle[:, 1] > 0)
    )
    edges = corners[near] - np.roll(corners[near], 1, axis=1)
    return np.hypot(edges[..., 0], edges[..., 1]).min() * 1e6


counted = partial(Measure, of="mesh")

MESH = (
    counted("nodes", "count", lambda mesh: len(mesh.points), anywhere),
    counted("elements", "count", lambda mesh: len(mesh.cells), anywhere),
    counted("smallest_edge", "um", _smallest_edge, finger),
    counted(
        "section",
        "mm",
        lambda mesh: {
            k: 1e3 * np.ptp(mesh.points[:, i]) for i, k in enumerate(("width", "height"))
        },
    ),
    # layers with elements, the stratum corneum and the bone
    counted("shaded_layers", "count", lambda mesh: len(mesh.regions) + 2, finger),
)

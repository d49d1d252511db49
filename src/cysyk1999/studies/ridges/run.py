"""Strokes of a plate over pads with other ridges: other heights, coefficients of friction and
meshes, for the study of ridges.

They are shorter than the scenes' strokes, what is asked for has settled by then; see
:mod:`cysyk1999.measures.direction`.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

import numpy as np

from cysyk1999.measures.direction import BESIDE, DEPTH
from cysyk1999.studies.common.ridges import boundary
from fingerpad import load_scene
from fingerpad.healing import simulate
from fingerpad.planning.plan import plan
from fingerpad.results import write_history
from fingerpad.scenes.scene import Discretisation, Receptors, Scene, Slide
from fingerpad.scenes.specimen import Outline, Ridges
from fingerpad.specimen import OutlineCurve, PadMesh, RidgedPad, mesh_for

WAY, STEPS = 4e-3, 24
"""Length of a case's stroke, m; time steps of press and stroke together."""
EDGES = {"coarse": 268.8e-6, "thesis": 134.4e-6, "fine": 67.2e-6}
"""Element edge (m) along the skin, by the mesh's name: a companion of up to twice the edge, the
scenes', half of it.
"""
AS_DRAWN = {"curved": (False, 0.0), "straight": (True, 0.0), "shifted": (True, 0.5)}
"""Meshes with the ridges drawn on the thesis's own 0.12 mm elements: whether sides are straight,
and elements between the ridge's tip and the nearest element corner (the thesis does not say how its
ridges were meshed).
"""
FLANK, AWAY = 120e-6, 25e-6
"""Offset of a flank of the ridges, and how far from the boundary the receptors are that follow it,
m.
"""
GRID = tuple(
    tuple(np.round(np.arange(first, last + 1, 20) * 1e-6, 9).tolist())
    for first, last in ((700, 1100), (-240, 240))
)
"""Depths and offsets of a map round a ridge, m."""


class Case(NamedTuple):
    """A short stroke: ridge height in um (0: the plain pad), coefficient of friction, name of the
    mesh.
    """

    height: float
    friction: float
    mesh: str

    @classmethod
    def named(cls, name: str) -> Case:
        """The case that `str` names."""
        height, friction, mesh = name.split("_")
        return cls(float(height), float(friction), mesh)

    def __str__(self) -> str:
        return f"{self.height:g}_{self.friction:g}_{self.mesh}"


def tip_at_depth(outline: Outline, phase: float) -> float:
    """Lateral position (m) at the thesis's depth of a ridge tip that the skin has at `phase`
    (m).
    """
    return phase * (1 - DEPTH / outline.apex_radius)


def case_scene(base: Scene, case: Case) -> Scene:
    """The scene of a stroke with another height, coefficient, mesh and shorter way."""
    edge, phase = EDGES.get(case.mesh, EDGES["thesis"]), 0.0
    if case.mesh in AS_DRAWN:
        phase = AS_DRAWN[case.mesh][1] * edge
    outline, inner, ridges = base.specimen.outline, "specimen.ridges.inner", None
    if case.height:
        changes = {f"{inner}.height": case.height * 1e-6, f"{inner}.phase": phase or "tip"}
        ridges = base.varied(changes).specimen.ridges
    tip = tip_at_depth(outline, phase)
    flank = boundary(outline, ridges, tip + FLANK)
    depths = {*GRID[0], DEPTH, round(flank - AWAY, 9), round(flank + AWAY, 9)}
    offsets = (round(tip + x, 9) for x in sorted({*GRID[1], -BESIDE, BESIDE}))
    press, slide, *_ = base.motion
    return base.varied(
        {
            "name": f"ridges_{case}",
            "specimen.ridges": ridges,
            "friction": case.friction,
            "motion": (press, Slide(slide=-WAY, speed=slide.speed)),
            "outputs.receptors": Receptors(depths=tuple(sorted(depths)), offsets=tuple(offsets)),
            "accuracy": Discretisation(skin_edge=edge, steps=STEPS),
            "effects": {"ridges": False} if case.mesh in AS_DRAWN else {},
        }
    )


def ridges_drawn(mesh: PadMesh, outline: Outline, ridges: Ridges, straight: bool) -> PadMesh:
    """A plain mesh whose nodes are moved to where inner ridges have them, as one draws ridges on a
    mesh that is there.

    Parameters
    ----------
    mesh : of second-order quads.
    straight : whether only corners are moved and the sides between them are straight.
    """
    pad = RidgedPad(outline, ridges)
    points = mesh.points.copy()
    near = np.flatnonzero((np.abs(points[:, 0]) < pad.extent + 1e-3) & (points[:, 1] > 0))
    s, depth = _coordinates(pad.curve, points[near])
    moved = (np.abs(s) < pad.extent) & (depth > pad.above) & (depth < pad.below)
    near, s, depth = near[moved], s[moved], depth[moved]
    points[near] = pad.curve.point(pad.curve.theta_at(s), pad.depth(s, depth))
    if straight:
        cells = mesh.cells[np.isin(mesh.cells, near).any(axis=1)]
        for k in range(4):
            points[cells[:, 4 + k]] = (points[cells[:, k]] + points[cells[:, (k + 1) % 4]]) / 2
        points[cells[:, 8]] = points[cells[:, :4]].mean(axis=1)
        skin = np.unique(mesh.curves["skin"])
        points[skin] = mesh.points[skin]
    return replace(mesh, points=points)


def _coordinates(curve: OutlineCurve, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths from the apex and depths (m) of points (n, 2) near the apex, by Newton steps."""
    s = curve.arc_length(curve.theta_at_x(points[:, 0]))
    for _ in range(20):
        theta = curve.theta_at(s)
        skin, normal = curve.point(theta), curve.normal(theta)
        depth = np.sum((skin - points) * normal, axis=1)
        along = np.sum((points - skin) * np.column_stack((normal[:, 1], -normal[:, 0])), axis=1)
        s = s + along / (1 - depth * curve.curvature(theta))
    return s, depth


def ridge_cases(job: SimpleNamespace) -> None:
    """Job: `scene` -> `histories`, whose folders name the cases."""
    base = load_scene(job.scene[0])
    for history in map(Path, job.histories):
        case = Case.named(history.parent.name)
        scene = case_scene(base, case)
        chosen, specimen = plan(scene), scene.specimen
        mesh = mesh_for(scene, chosen)
        if case.mesh in AS_DRAWN:
            straight, _ = AS_DRAWN[case.mesh]
            mesh = ridges_drawn(mesh, specimen.outline, specimen.ridges, straight)
        write_history(simulate(scene, chosen, mesh=mesh), history)

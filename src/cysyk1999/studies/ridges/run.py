"""Strokes of a plate over pads with other ridges: other heights, coefficients of friction and
meshes, for the study of ridges.

They are shorter than the scenes' strokes, what is asked for has settled by then; see
:mod:`cysyk1999.measures.direction`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from fingerpad.planning.plan import plan
from fingerpad.scenes.scene import Discretisation, Receptors, Scene, Slide
from fingerpad.simulation import simulate
from fingerpad.specimen import OutlineCurve, RidgedPad, mesh_for

if TYPE_CHECKING:
    from fingerpad.scenes.scene import Outline
    from fingerpad.scenes.specimen import Ridges
    from fingerpad.specimen import PadMesh

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
DEPTH, BESIDE = 915e-6, 46e-6
"""The thesis's receptor depth and offset, m (not those of the figures, which would bring all of
them in).
"""
FLANK, AWAY = 120e-6, 25e-6
"""Offset of a flank of the ridges, and how far from the boundary the receptors are that follow it,
m.
"""
GRID = (
    tuple(np.round(np.arange(700, 1101, 20) * 1e-6, 9)),
    tuple(np.round(np.arange(-240, 241, 20) * 1e-6, 9)),
)
"""Depths and offsets of a map round a ridge, m."""


@dataclass(frozen=True)
class Case:
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


def boundary(outline: Outline, ridges: Ridges | None, x: float) -> float:
    """Depth (m) at which the epidermis ends at the lateral position `x` (m, near the apex, of the
    boundary itself).
    """
    depth = outline.epidermis_thickness
    if ridges is None:
        return depth
    pad = RidgedPad(outline, ridges)
    for _ in range(8):
        depth = pad.interface + float(pad.interface_shift(x / (1 - depth / outline.apex_radius)))
    return depth


def tip_at_depth(outline: Outline, phase: float) -> float:
    """Lateral position (m) at the thesis's depth of a ridge tip that the skin has at `phase`
    (m).
    """
    return phase * (1 - DEPTH / outline.apex_radius)


def case_scene(base: Scene, case: Case) -> Scene:
    """The scene of a stroke with another height, coefficient, mesh and shorter way."""
    drawn = AS_DRAWN.get(case.mesh)
    edge = EDGES["thesis"] if drawn else EDGES[case.mesh]
    outline = base.specimen.outline
    phase = drawn[1] * edge if drawn else 0.0
    ridges, tip = None, tip_at_depth(outline, phase)
    if case.height:
        changes = {"height": case.height * 1e-6, "phase": phase or "tip"}
        ridges = base.varied(
            {f"specimen.ridges.inner.{key}": value for key, value in changes.items()}
        ).specimen.ridges
    flank = boundary(outline, ridges, tip + FLANK)
    depths = sorted({*GRID[0], DEPTH, round(flank - AWAY, 9), round(flank + AWAY, 9)})
    offsets = sorted({*GRID[1], -BESIDE, BESIDE})
    press, slide, *_ = base.motion
    return base.varied(
        {
            "name": f"ridges_{case}",
            "specimen.ridges": ridges,
            "friction": case.friction,
            "motion": (press, Slide(slide=-WAY, speed=slide.speed)),
            "outputs.receptors": Receptors(
                depths=tuple(depths), offsets=tuple(round(tip + x, 9) for x in offsets)
            ),
            "accuracy": Discretisation(skin_edge=edge, steps=STEPS),
            "effects": {"ridges": False} if drawn else {},
        }
    )


def run_case(base: Scene, case: Case) -> xr.Dataset:
    """The history of a case, without labels. Raises what :func:`fingerpad.simulate` does."""
    scene = case_scene(base, case)
    chosen = plan(scene)
    mesh = mesh_for(scene, chosen)
    if case.mesh in AS_DRAWN:
        mesh = ridges_drawn(
            mesh, scene.specimen.outline, scene.specimen.ridges, AS_DRAWN[case.mesh][0]
        )
    return simulate(scene, chosen, mesh=mesh)


def ridges_drawn(mesh: PadMesh, outline: Outline, ridges: Ridges, straight: bool) -> PadMesh:
    """A plain mesh whose nodes are moved to where inner ridges have them, as one draws ridges on a
    mesh that is there.

    Args:
        mesh: of second-order quads. straight: whether only corners are moved and the sides between
        them are straight.
    """
    pad = RidgedPad(outline, ridges)
    points = mesh.points.copy()
    near = np.flatnonzero((np.abs(points[:, 0]) < pad.extent + 1e-3) & (points[:, 1] > 0))
    s, depth = _named(pad.curve, points[near])
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


def _named(curve: OutlineCurve, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Arc lengths from the apex and depths (m) of points (n, 2) near the apex, by Newton steps."""
    s = curve.arc_length(curve.theta_at_x(points[:, 0]))
    for _ in range(20):
        theta = curve.theta_at(s)
        skin, normal = curve.point(theta), curve.normal(theta)
        depth = np.sum((skin - points) * normal, axis=1)
        along = np.sum((points - skin) * np.column_stack((normal[:, 1], -normal[:, 0])), axis=1)
        s = s + along / (1 - depth * curve.curvature(theta))
    return s, depth

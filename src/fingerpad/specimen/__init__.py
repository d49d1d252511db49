"""The specimen: outline, layers, mesh and materials of the pad."""

from __future__ import annotations

from typing import Any

from fingerpad.specimen.build import build_pad_mesh, count_nodes, size_of
from fingerpad.specimen.files import read_pad_mesh, read_specimen_mesh, write_pad
from fingerpad.specimen.halving import halved
from fingerpad.specimen.layered import ridge_resolution
from fingerpad.specimen.outline import OutlineCurve, OutlineError
from fingerpad.specimen.pad import MeshError, MeshSize, PadMesh, skin_chain
from fingerpad.specimen.quality import quality_of, quality_table, shortest_edge
from fingerpad.specimen.ridges import RidgedPad
from fingerpad.specimen.stacks import build_stack_mesh

__all__ = [
    "MeshError",
    "MeshSize",
    "OutlineCurve",
    "OutlineError",
    "PadMesh",
    "RidgedPad",
    "build_pad_mesh",
    "count_nodes",
    "counted",
    "halved",
    "mesh_for",
    "quality_of",
    "quality_table",
    "read_pad_mesh",
    "ridge_resolution",
    "shortest_edge",
    "skin_chain",
    "write_pad",
]


def counted(specimen: Any, size: MeshSize, ridges: Any) -> tuple[int, float]:
    """Number of nodes and shortest edge (m) of the mesh of an outline (with `ridges` or None), a
    slab or a half-round.
    """
    if specimen.stack is not None:
        mesh = build_stack_mesh(specimen.stack, size)
        return len(mesh.points), shortest_edge(mesh)
    return size_of(specimen.outline, size, ridges, specimen.layers.stratum_corneum is not None)


def mesh_for(scene: Any, plan: Any) -> PadMesh:
    """The mesh of a scene: the external mesh it names, its edges halved as often as the plan says,
    or else its outline, slab or half-round meshed as the plan says.

    Raises
    ------
    OutlineError, MeshError
        See `build_pad_mesh`, `build_stack_mesh` and `read_pad_mesh`.
    """
    specimen = scene.specimen
    if specimen.mesh is not None:
        mesh = read_specimen_mesh(specimen, scene.axisymmetric)
        for _ in range(plan.relaxed.halvings):
            mesh = halved(mesh)
        return mesh
    if specimen.stack is not None:
        return build_stack_mesh(specimen.stack, plan.mesh_size)
    ridges = plan.parts(scene).ridges
    corneum = specimen.layers.stratum_corneum is not None
    return build_pad_mesh(specimen.outline, plan.mesh_size, ridges, corneum)

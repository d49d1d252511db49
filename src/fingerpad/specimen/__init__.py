"""The specimen: outline, layers, mesh and materials of the pad."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module

_HOME = {
    "OutlineCurve": "fingerpad.specimen.outline",
    "OutlineError": "fingerpad.specimen.outline",
    "MeshError": "fingerpad.specimen.pad",
    "MeshSize": "fingerpad.specimen.pad",
    "PadMesh": "fingerpad.specimen.pad",
    "build_pad_mesh": "fingerpad.specimen.build",
    "count_nodes": "fingerpad.specimen.build",
    "skin_chain": "fingerpad.specimen.pad",
    "read_pad_mesh": "fingerpad.specimen.files",
    "write_pad": "fingerpad.specimen.files",
    "quality_of": "fingerpad.specimen.quality",
    "shortest_edge": "fingerpad.specimen.quality",
    "quality_table": "fingerpad.specimen.quality",
    "RidgedPad": "fingerpad.specimen.ridges",
    "ridge_resolution": "fingerpad.specimen.layered",
}

__all__ = ["mesh_for", *_HOME]


def __getattr__(name: str):
    if name in _HOME:
        return getattr(import_module(_HOME[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


@lru_cache(maxsize=64)  # of a sweep many scenes may have the same mesh
def _counted_layers(*layered) -> tuple[int, float]:
    from fingerpad.specimen.build import count_nodes, smallest_edge

    return count_nodes(*layered), smallest_edge(*layered)


def counted(specimen, size, ridges) -> tuple[int, float]:
    """Nodes and shortest edge (m) of the mesh of such a size of an outline (with `ridges` or None),
    a slab or a half-round.
    """
    if specimen.stack is not None:
        from fingerpad.specimen.quality import shortest_edge
        from fingerpad.specimen.stacks import build_stack_mesh

        mesh = build_stack_mesh(specimen.stack, size)
        return len(mesh.points), shortest_edge(mesh)
    return _counted_layers(
        specimen.outline, size, ridges, specimen.layers.stratum_corneum is not None
    )


def mesh_for(scene, plan):
    """The mesh of a scene: its external mesh if it names one, else its outline, slab or half-round
    meshed as the plan says.

    Raises
    ------
    OutlineError, MeshError : see `build_pad_mesh`, `build_stack_mesh` and `read_pad_mesh`.
    """
    if scene.specimen.mesh is not None:
        from fingerpad.specimen.files import read_specimen_mesh

        return read_specimen_mesh(scene.specimen)
    if scene.specimen.stack is not None:
        from fingerpad.specimen.stacks import build_stack_mesh

        return build_stack_mesh(scene.specimen.stack, plan.mesh_size)
    from fingerpad.specimen.build import build_pad_mesh

    specimen = scene.specimen
    return build_pad_mesh(
        specimen.outline,
        plan.mesh_size,
        plan.parts(scene).ridges,
        specimen.layers.stratum_corneum is not None,
    )

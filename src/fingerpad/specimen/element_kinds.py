"""The one table of element kinds: how gmsh and meshio call them, and how the solver treats them by
default.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """One kind of element; nodes are corners counter-clockwise, mid-side nodes (0-1, 1-2, ...),
    centre.

    Attributes:
        name: as in `PadMesh.element`. corners, nodes: their numbers. gmsh: its element type.
        meshio: its name there, and in VTK. solved: key of the mixed element it is solved with (see
        :mod:`fingerpad.mechanics.elements`), None where it is raised or completed first. mirrored:
        order of the nodes of the mirror image that is counter-clockwise again.
    """

    name: str
    corners: int
    nodes: int
    gmsh: int
    meshio: str
    solved: str | None
    mirrored: tuple[int, ...]

    @property
    def quadratic(self) -> bool:
        """Whether there are mid-side nodes."""
        return self.nodes > self.corners


KINDS = {
    kind.name: kind
    for kind in (
        Kind("tri3", 3, 3, 2, "triangle", None, (1, 0, 2)),
        Kind("tri6", 3, 6, 9, "triangle6", "P2B", (1, 0, 2, 3, 5, 4)),
        Kind("quad4", 4, 4, 3, "quad", "Q1P0", (1, 0, 3, 2)),
        Kind("quad8", 4, 8, 16, "quad8", None, (1, 0, 3, 2, 4, 7, 6, 5)),
        Kind("quad9", 4, 9, 10, "quad9", "Q2P1", (1, 0, 3, 2, 4, 7, 6, 5, 8)),
        Kind("tri7", 3, 7, 42, "triangle7", "P2B", (1, 0, 2, 3, 5, 4, 6)),
    )
}
LINES = {2: 1, 3: 8}  # gmsh's type of a line, by its number of nodes


def kind_of(nodes: int) -> Kind:
    """The kind with that many nodes; raises KeyError when there is none."""
    return {kind.nodes: kind for kind in KINDS.values()}[nodes]

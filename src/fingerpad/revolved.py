"""A section that is turned about x = 0, as a solid for ParaView."""

from __future__ import annotations

import meshio
import numpy as np

SLICES = 24
HALF_TURN = np.pi
"""rad: half of the body, so that the section shows."""
_SOLID = {"quad": "hexahedron", "triangle": "wedge", "line": "quad"}
"""Corners of a cell of the section -> the cell that it becomes."""


def revolved(section: meshio.Mesh, slices: int = SLICES, turn: float = HALF_TURN) -> meshio.Mesh:
    """A section of one block of cells turned about x = 0: y stays the axis.

    Cells keep their corners alone; on the axis some coincide. Vectors at nodes turn with them;
    components of tensors stay those in the section.

    Parameters
    ----------
    section
        Points (n, 3), of which z is 0; its values at nodes and in cells are kept.
    slices
        Cells around.
    turn : float
        rad.

    Returns
    -------
    meshio.Mesh

    Examples
    --------
    >>> import meshio
    >>> square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    >>> half = revolved(meshio.Mesh(square, [("quad", [[0, 1, 2, 3]])]), slices=4)
    >>> half.points.shape, half.cells[0].type, len(half.cells[0].data)
    ((20, 3), 'hexahedron', 4)
    """
    block = section.cells[0]
    flat = next(kind for kind in _SOLID if block.type.startswith(kind))
    corners = np.asarray(block.data)[:, : {"quad": 4, "triangle": 3, "line": 2}[flat]]
    used, cells = np.unique(corners, return_inverse=True)
    cells, angles = cells.reshape(corners.shape), np.linspace(0.0, turn, slices + 1)
    levels = [cells + k * len(used) for k in range(slices + 1)]
    far = slice(None, None, -1) if flat == "line" else slice(None)
    solid = [
        np.hstack([one, other[:, far]]) for one, other in zip(levels[:-1], levels[1:], strict=True)
    ]
    return meshio.Mesh(
        _turned(section.points[used], angles),
        [(_SOLID[flat], np.concatenate(solid))],
        {name: _at_nodes(values[used], angles) for name, values in section.point_data.items()},
        {
            name: [np.concatenate([values[0]] * slices)]
            for name, values in section.cell_data.items()
        },
    )


def _turned(vectors: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """Vectors (n, 3) of the section at every angle (n * angles, 3)."""
    x, y = vectors[:, 0], vectors[:, 1]
    return np.concatenate([np.column_stack([x * np.cos(a), y, x * np.sin(a)]) for a in angles])


def _at_nodes(values: np.ndarray, angles: np.ndarray) -> np.ndarray:
    if values.ndim == 2 and values.shape[1] == 3:
        return _turned(values, angles)
    return np.concatenate([values] * len(angles))

"""Structured meshes (quad9, quad4, tri6) of mapped unit squares, as the package's own mesh
dataclass.
"""

import numpy as np

from fingerpad.specimen.pad import PadMesh

#: Mesh kind that each element runs on.
KIND = {
    "Q2P1": "quad9",
    "Q2": "quad9",
    "Q2R": "quad9",
    "Q1P0": "quad4",
    "Q1": "quad4",
    "P2B": "tri6",
    "P2": "tri6",
}


def mapped(columns, rows, mapping, kind="quad9", distortion=0.0, region=None):
    """Mesh of the image of the unit square under ``mapping`` ((n, 2) -> (n, 2)).

    ``columns`` and ``rows``: numbers of elements, or the ascending edges of the elements in [0, 1].
    ``distortion`` moves the inner corners at random by up to that share of the edge, mid-side nodes
    staying in the middle. ``region``: function of the element centres in the unit square (ne, 2) ->
    (ne,) layer numbers; all zero unless given. Curves bottom, right, top, left run clockwise (the
    body on their right), as the skin of a pad does.
    """
    xs = np.linspace(0, 1, columns + 1) if np.isscalar(columns) else np.asarray(columns, float)
    ys = np.linspace(0, 1, rows + 1) if np.isscalar(rows) else np.asarray(rows, float)
    nx, ny = len(xs) - 1, len(ys) - 1
    corner = np.stack(np.meshgrid(xs, ys, indexing="ij"), -1)
    inner = np.zeros((nx + 1, ny + 1, 1))
    inner[1:-1, 1:-1] = 1
    edge = np.array([1 / nx, 1 / ny])
    corner = corner + distortion * inner * edge * np.random.default_rng(1).uniform(
        -1, 1, corner.shape
    )

    grid = np.empty((2 * nx + 1, 2 * ny + 1, 2))
    grid[::2, ::2] = corner
    grid[1::2, ::2] = (corner[1:] + corner[:-1]) / 2
    grid[::2, 1::2] = (corner[:, 1:] + corner[:, :-1]) / 2
    grid[1::2, 1::2] = (corner[1:, 1:] + corner[:-1, 1:] + corner[1:, :-1] + corner[:-1, :-1]) / 4
    if kind == "tri6":  # the centre lies on the diagonal that splits the quad
        grid[1::2, 1::2] = (corner[1:, 1:] + corner[:-1, :-1]) / 2
    number = np.arange(grid.shape[0] * grid.shape[1]).reshape(grid.shape[:2])
    i, j = (2 * part.ravel() for part in np.meshgrid(np.arange(nx), np.arange(ny), indexing="ij"))
    steps = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
    cells = np.stack([number[i + a, j + b] for a, b in steps], 1)
    layer = (
        np.zeros(len(cells), int)
        if region is None
        else np.asarray(region(grid.reshape(-1, 2)[cells[:, 8]]))
    )
    rims = {
        "bottom": number[::-1, 0],
        "right": number[-1, ::-1],
        "top": number[:, -1],
        "left": number[0],
    }
    curves = {name: np.stack([rim[:-2:2], rim[2::2], rim[1::2]], 1) for name, rim in rims.items()}

    points = mapping(grid.reshape(-1, 2))
    if kind == "tri6":
        halves = [[0, 1, 2, 4, 5, 8], [0, 2, 3, 8, 6, 7]]
        cells = cells[:, halves].reshape(-1, 6)
        layer = np.repeat(layer, 2)
    elif kind == "quad4":
        cells = cells[:, :4]
        kept = np.unique(cells)
        renumber = np.full(len(points), -1)
        renumber[kept] = np.arange(len(kept))
        points, cells = points[kept], renumber[cells]
        curves = {name: renumber[curve[:, :2]] for name, curve in curves.items()}
    return PadMesh(
        points=points,
        cells=cells.astype(np.int32),
        element=kind,
        region=layer.astype(np.int8),
        curves={name: curve.astype(np.int32) for name, curve in curves.items()},
        symmetric=False,
    )


def rectangle(
    columns,
    rows,
    width=1.0,
    height=1.0,
    kind="quad9",
    distortion=0.0,
    origin=(0.0, 0.0),
    region=None,
):
    """Rectangle with its lower left corner at ``origin``."""
    return mapped(columns, rows, lambda s: s * (width, height) + origin, kind, distortion, region)


def quarter_annulus(radial, around, inner, outer, kind="quad9"):
    """Quarter of a ring; curve left is the hole (r = inner), right the outside, bottom y = 0, top x
    = 0.
    """

    def mapping(s):
        r, angle = inner * (outer / inner) ** s[:, 0], s[:, 1] * np.pi / 2
        return np.stack([r * np.cos(angle), r * np.sin(angle)], 1)

    return mapped(radial, around, mapping, kind)


def cook_membrane(n, kind="quad9"):
    """Cook's tapered panel, n x n elements; clamped edge left, loaded edge right."""

    def mapping(s):
        low, high = 44 * s[:, 0], 44 + 16 * s[:, 0]
        return np.stack([48 * s[:, 0], low + s[:, 1] * (high - low)], 1)

    return mapped(n, n, mapping, kind)


def nodes_of(mesh, *curves):
    """Node numbers on the named curves."""
    return np.unique(np.concatenate([mesh.curves[name].ravel() for name in curves]))


def graded(fine_share, fine, coarse):
    """Element edges in [0, 1]: ``fine`` equal ones up to ``fine_share``, then ``coarse`` growing
    ones.
    """
    first = np.linspace(0, fine_share, fine + 1)
    ratio = _growth((1 - fine_share) / (fine_share / fine), coarse)
    steps = ratio ** np.arange(1, coarse + 1)
    return np.append(first, fine_share + (1 - fine_share) * np.cumsum(steps) / steps.sum())


def _growth(total, count):
    """q with q + q^2 + ... + q^count = total."""
    low, high = 0.1, 10.0
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (
            (middle, high) if (middle ** np.arange(1, count + 1)).sum() < total else (low, middle)
        )
    return (low + high) / 2

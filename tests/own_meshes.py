"""Small meshes as a user brings them: slabs of quads, with a skin and a base."""

import numpy as np

from fingerpad.specimen import PadMesh, write_pad


def slab_mesh(edge, low=-10e-3, high=10e-3, left=-10e-3, right=10e-3, height=5e-3, y=None):
    """Linear quads from x = ``left`` to ``right`` m, rows at heights ``y``; the skin is the top
    from ``low`` to ``high`` m.
    """
    x = np.linspace(left, right, round((right - left) / edge) + 1)
    y = np.linspace(0, height, round(height / edge) + 1) if y is None else y
    points = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
    number = np.arange(len(points)).reshape(len(x), len(y))
    corners = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    cells = np.stack(corners, axis=-1).reshape(-1, 4).astype(np.int32)
    inside = (x[:-1] >= low - 1e-9) & (x[1:] <= high + 1e-9)
    skin = np.column_stack([number[:-1, -1], number[1:, -1]])[inside].astype(np.int32)
    base = np.column_stack([number[1:, 0], number[:-1, 0]]).astype(np.int32)
    curves, regions = {"skin": skin, "base": base}, np.zeros(len(cells), np.int8)
    return PadMesh(
        points, cells, "quad4", regions, curves, symmetric=False, regions=("foam",), fixed=("base",)
    )


def slab(path, edge, low=-10e-3, high=10e-3, left=-10e-3, right=10e-3):
    """Write a slab of quadratic quads (see :func:`slab_mesh`) to a .msh file."""
    write_pad(slab_mesh(edge, low, high, left, right).raised(), path)


def SLAB(path):
    """A scene on such a mesh."""
    return {
        "specimen": {
            "mesh": str(path),
            "layers": {"foam": {"youngs_modulus": "50 kPa", "poisson_ratio": 0.3}},
            "contact_length": "10 mm",
        },
        "stimulus": {"shape": "cylinder", "curvature": "200 1/m"},
        "motion": [{"press_to_force": "20 gf"}],
        "outputs": {"receptors": {"depths": ["0.5 mm"], "offsets": ["1 mm"]}},
        "accuracy": {"skin_edge": "0.5 mm"},
    }

"""Small meshes as a user brings them: slabs of quads, with a skin and a base."""

from dataclasses import replace

import numpy as np

from fingerpad.specimen import PadMesh, read_pad_mesh, write_pad
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.quality import jacobians


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


def read_back(mesh, folder, **names):
    """The mesh as it is read from its file."""
    write_pad(mesh, folder / "own.msh")
    return read_pad_mesh(folder / "own.msh", **names)


def compact(mesh):
    """The mesh without the nodes that no element uses."""
    used = np.unique(mesh.cells)
    number = np.full(len(mesh.points), -1, np.int32)
    number[used] = np.arange(len(used))
    curves = {name: number[facets] for name, facets in mesh.curves.items()}
    return replace(mesh, points=mesh.points[used], cells=number[mesh.cells], curves=curves)


def turned(mesh, degrees):
    """The mesh turned about the origin."""
    angle = np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return replace(mesh, points=mesh.points @ turn.T)


def areas(mesh):
    """Area of each layer by the Gauss rule of its elements."""
    points, weights = KINDS[mesh.element].rule(5)
    area = np.linalg.det(jacobians(mesh, points)) @ weights
    return np.bincount(mesh.region, area, minlength=len(mesh.regions))


def places(points):
    """Points (n, 2), or rows of numbers, as a set."""
    return set(map(tuple, points.tolist()))


def linear(mesh):
    curves = {name: facets[:, :2] for name, facets in mesh.curves.items()}
    return compact(replace(mesh, cells=mesh.cells[:, :4], element="quad4", curves=curves))


def split(mesh, element, *orders):
    """Every quad as triangles of so many of its nodes."""
    cells = np.concatenate([mesh.cells[:, order] for order in orders])
    region = np.tile(mesh.region, len(orders))
    return replace(mesh, cells=cells, element=element, region=region, symmetric=False)


def triangles(mesh):
    return split(mesh, "tri6", [0, 1, 2, 4, 5, 8], [0, 2, 3, 8, 6, 7])


def linear_triangles(mesh):
    return split(linear(mesh), "tri3", [0, 1, 2], [0, 2, 3])

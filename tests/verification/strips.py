"""Right half of a layered strip on a rigid base between smooth walls, pressed from above."""

import numpy as np
from meshes import KIND, graded, nodes_of, rectangle
from problems import boundary, make_body

from fingerpad.reference_solutions.layered import Layer


def half_strip(
    layers,
    half_length,
    element="Q2P1",
    strain="small",
    prony=None,
    *,
    fine=0.1,
    columns=(16, 12),
    rows=None,
):
    """Mesh and body of ``layers`` (at most three :class:`Layer`, from the top) on 0 <= x <=
    half_length.

    ``fine``: share of the length with ``columns[0]`` equal columns, followed by ``columns[1]``
    growing ones. ``rows``: list of the numbers of rows of each layer, or for one layer a pair
    (equal ones in the same length, growing ones).
    """
    depth = sum(layer.thickness for layer in layers)
    xs = graded(fine, *columns)
    rows = columns if rows is None else rows
    if isinstance(rows, tuple):
        ys = 1 - graded(fine * half_length / depth, *rows)[::-1]
    else:
        ends = 1 - np.cumsum([0.0, *(layer.thickness / depth for layer in layers)])
        parts = [
            np.linspace(low, high, n + 1)[:-1]
            for low, high, n in zip(ends[1:], ends[:-1], rows, strict=True)
        ]
        ys = np.append(np.concatenate(parts[::-1]), 1.0)
    bounds = np.cumsum([layer.thickness / depth for layer in layers])[:-1]
    mesh = rectangle(
        xs,
        ys,
        half_length,
        depth,
        KIND[element],
        origin=(0.0, -depth),
        region=lambda centre: np.searchsorted(bounds, 1 - centre[:, 1]),
    )
    fixed = boundary(mesh, "bottom")
    fixed[nodes_of(mesh, "left", "right"), 0] = True
    shear = np.array([layer.shear_modulus for layer in layers])
    poisson = np.array([layer.poisson_ratio for layer in layers])
    bulk = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson))
    missing = (0, 3 - len(layers))
    shear, bulk = np.pad(shear, missing, "edge"), np.pad(bulk, missing, "edge")
    return mesh, make_body(mesh, fixed, shear, bulk, element, strain, prony)


__all__ = ["Layer", "half_strip"]

"""Measures of a meshed pad: the skin's apex, layer thicknesses, and points at a depth below the
skin.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from fingerpad.specimen.outline import OutlineLike, bisect, curve_of
from fingerpad.specimen.pad import MeshError, PadMesh, element_edges, skin_chain

_TOO_DEEP = (
    "receptors: no point of the pad lies at that depth and offset; "
    "allowed: depths inside the soft tissue"
)


def _fine_skin(mesh: PadMesh) -> np.ndarray:
    """Points (k, 2) m along the skin of a whole mesh, following curved edges."""
    facets, s = mesh.curves["skin"], np.linspace(-1, 1, 16)
    if facets.shape[1] == 3:
        shape = np.stack([s * (s - 1) / 2, s * (s + 1) / 2, 1 - s * s])
    else:
        shape = np.stack([(1 - s) / 2, (1 + s) / 2])
    return np.einsum("as,fai->fsi", shape, mesh.points[facets]).reshape(-1, 2)


def touched_side(skin: np.ndarray) -> np.ndarray:
    """Whether points (n, 2) m along a skin are on the side that is touched.

    All are of a skin that never turns back, however high it is; of others those of the upper half,
    and those above x = 0.
    """
    (x, y), way = skin.T, np.diff(skin[:, 0])
    if not len(way) or (way >= -1e-9 * np.ptp(x)).all():
        return np.ones(len(x), bool)
    forward = np.append(way > 0, way[-1] > 0)
    middle = y[np.argmin(np.where(forward, np.abs(x), np.inf))]
    return y >= min(y.max() - 0.5 * np.ptp(y), middle)


def _skin_over_zero(mesh: PadMesh) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates x and y (ns,) m of the skin's nodes; `MeshError` if none is over x = 0."""
    x, y = mesh.points[skin_chain(mesh)].T
    if not (x.min() <= 0 <= x.max()):
        raise MeshError(
            "mesh: the skin does not cross x = 0; allowed: a pad whose apex lies near x = 0"
        )
    return x, y


def skin_ends(mesh: PadMesh) -> list[tuple[int, float]]:
    """Nodes at which the skin ends, and the angle (rad) between it and the boundary that goes on,
    through the material.
    """
    skin = mesh.curves["skin"][:, :2].tolist()
    others = [facets[:, :2] for name, facets in mesh.curves.items() if name != "skin"]
    others = np.concatenate(others)
    before, after = dict(others[:, ::-1].tolist()), dict(others.tolist())
    (left, second), (second_last, right) = skin[0], skin[-1]
    ends = [(right, second_last, after.get(right))]
    if not mesh.half:
        ends.insert(0, (left, before.get(left), second))
    angles = []
    for node, back, ahead in ends:
        if back is not None and ahead is not None:
            one, two = mesh.points[[back, ahead]] - mesh.points[node]
            # material lies to the right of the way
            angle = np.arctan2(one[0] * two[1] - one[1] * two[0], one @ two)
            angles.append((node, float(angle % (2 * np.pi))))
    return angles


def layers_below(mesh: PadMesh, middle: float = 0.0) -> list[tuple[str, float]]:
    """Names and thicknesses (m) of the layers straight below the skin at x = ``middle`` (m), down
    to the first gap or the base.

    Raises
    ------
    MeshError
        The skin does not cross x = 0.
    """
    _skin_over_zero(mesh)
    # beside the middle, where nodes often are
    at = middle + (1 if middle <= 0 else -1) * 1e-6 * np.ptp(mesh.points[:, 0])
    start, end = mesh.points[element_edges(mesh.cells, mesh.element)[:, :2].T]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = (at - start[:, 0]) / (end[:, 0] - start[:, 0])
    height = start[:, 1] + share * (end[:, 1] - start[:, 1])
    height[~((share >= 0) & (share <= 1))] = np.nan
    height = height.reshape(-1, len(mesh.cells))
    crossed = np.count_nonzero(np.isfinite(height), axis=0) >= 2
    low, high = np.nanmin(height[:, crossed], axis=0), np.nanmax(height[:, crossed], axis=0)
    near = 1e-6 * np.ptp(mesh.points[:, 1])
    layers: dict[str, float] = {}
    bottom = -np.inf
    for k in np.argsort(-high):
        if high[k] < bottom - near:
            break
        name = mesh.regions[mesh.region[crossed][k]]
        layers[name] = layers.get(name, 0.0) + float(high[k] - low[k])
        bottom = low[k]
    return list(layers.items())


def _near_apex(x: np.ndarray) -> tuple[np.ndarray, float]:
    """Which of the skin's nodes at ``x`` (ns,) m are near x = 0, and how far (m) that reaches."""
    reach = 0.075 * np.ptp(x)
    return np.abs(x) < max(reach, 3 * np.abs(np.diff(x)).min()), reach


def apex_radius(mesh: PadMesh) -> float:
    """Radius of curvature (m) of the skin at x = 0; 1000 m for a flat or hollow one."""
    x, y = mesh.points[skin_chain(mesh)].T
    near, _ = _near_apex(x)
    if len(np.unique(x[near])) < 3:
        return 1e3
    return float(1 / max(-2 * np.polyfit(x[near], y[near], 2)[0], 1e-3))


def apex_measures(mesh: PadMesh) -> tuple[float, float, float]:
    """Radius of curvature of the skin at x = 0, thickness of the epidermis there, and of all soft
    tissue to the bone, m.

    Raises
    ------
    MeshError
        There is no skin, or no bone below it, at x = 0.
    """
    x, y = _skin_over_zero(mesh)
    near, reach = _near_apex(x)
    top = y[near].max()
    bone = mesh.points[np.unique(mesh.curves["bone"])]
    aside = np.abs(bone[:, 0])
    under = bone[(aside <= aside.min() + reach) & (bone[:, 1] < top), 1]
    if not len(under):
        raise MeshError(
            "mesh: there is no bone below x = 0; allowed: a curve named bone under the apex"
        )
    soft = top - under.max()
    layer = mesh.points[np.unique(mesh.cells[mesh.region < mesh.regions.index("dermis")])]
    column = layer[np.abs(layer[:, 0]) < reach, 1]
    epidermis = top - column.min() if len(column) else soft / 4
    return apex_radius(mesh), float(epidermis), float(soft)


def apex_edge(mesh: PadMesh) -> float:
    """Length (m) of the skin's element edges around x = 0 on the side that is touched."""
    ends = mesh.points[mesh.curves["skin"][:, :2]]
    middle = ends.mean(axis=1)
    high = touched_side(middle)
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    nearest = np.argsort(np.where(high, np.abs(middle[:, 0]), np.inf))[:4]
    return float(lengths[nearest].mean())


def below_skin(mesh: PadMesh, depths: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Points (n, 2) m at lateral position ``offsets`` whose distance to the undeformed skin is
    ``depths`` (n,) m.

    On the axis of a symmetric pad that is straight below the apex; elsewhere depth is measured
    along the skin's normal, as the layers are.

    Raises
    ------
    MeshError
        No point of that depth exists at that offset.
    """
    depths, offsets = np.broadcast_arrays(
        np.atleast_1d(np.asarray(depths, float)), np.asarray(offsets, float)
    )
    if not depths.size:
        return np.zeros((0, 2))
    skin = _fine_skin(mesh)
    upper = skin[touched_side(skin)]
    upper = upper[np.argsort(upper[:, 0])]
    beside = offsets[(offsets < upper[0, 0]) | (offsets > upper[-1, 0])]
    if len(beside):
        first, last = upper[[0, -1], 0] * 1e3
        raise MeshError(
            f"receptors: there is no skin over x = {beside[0] * 1e3:.3g} mm; "
            f"allowed: offsets from {first:.3g} mm to {last:.3g} mm"
        )
    high = np.interp(offsets, upper[:, 0], upper[:, 1])

    tree = KDTree(skin)

    def below(height):
        return tree.query(np.column_stack([offsets, height]))[0]

    low, high = bisect(lambda height: below(height) > depths, high - 4 * depths, high)
    found = (low + high) / 2
    if np.any(np.abs(below(found) - depths) > 1e-3 * depths):
        raise MeshError(_TOO_DEEP)
    return np.column_stack([offsets, found])


def below_outline(outline: OutlineLike, depths: np.ndarray, offsets: np.ndarray) -> np.ndarray:
    """Points (n, 2) m at lateral position ``offsets`` whose depth below the smooth outline is
    ``depths`` (n,) m.

    For pads with outer ridges, whose own skin is no measure of depth; otherwise the same as
    :func:`below_skin`.

    Raises
    ------
    MeshError
        No point of that depth exists at that offset.
    """
    depths, offsets = map(np.ravel, np.broadcast_arrays(depths, np.asarray(offsets, float)))
    curve = curve_of(outline)
    _, high = bisect(
        lambda theta: curve.point(theta, depths)[:, 0] < np.abs(offsets),
        np.zeros(len(depths)),
        np.full(len(depths), np.pi / 2),
    )
    found = curve.point(np.where(offsets == 0, 0.0, high), depths)
    if np.any(np.abs(found[:, 0] - np.abs(offsets)) > 1e-9):
        raise MeshError(_TOO_DEEP)
    return found * np.column_stack((np.where(offsets < 0, -1.0, 1.0), np.ones(len(depths))))

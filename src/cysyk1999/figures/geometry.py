"""Geometry of the pad for pictures: boundaries of its layers, elements of its mesh, sections under
an indenter.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.patches import Patch, PathPatch
from matplotlib.path import Path
from pandas import DataFrame, Series
from scipy.interpolate import LinearNDInterpolator
from xarray import Dataset

from cysyk1999.measures.errors import PARTS, Companion, Errors, number_errors
from cysyk1999.measures.quantities import X, Y
from cysyk1999.measures.steady import leg_of, pressed_depths
from cysyk1999.publishing import style
from fingerpad.measures.features import skin_at
from fingerpad.results import scene_of
from fingerpad.specimen import quality
from fingerpad.specimen.element_kinds import KINDS, kind_of
from fingerpad.specimen.pad import PadMesh, element_edges

LAYERS = tuple(style.LAYER_COLOURS)
"""Layers from the outside in, and the bone."""
NOTE = (
    "The model's own geometry and mesh, not measured; the MRI sections of Cysyk (1999) are not "
    "available."
)


def stratum_corneum(history: Dataset) -> float:
    """Thickness (m) of the stratum corneum in a history's scene, which must have a parametric
    outline.
    """
    return scene_of(history).specimen.outline.stratum_corneum_thickness


# --- lines ----------------------------------------------------------------------------------------


def boundaries(mesh: PadMesh) -> dict[str, np.ndarray]:
    """Closed boundary lines: ``skin`` (with the nail side), ``dermis``, ``fat``, ``bone``.

    Node numbers (n,). A layer's line is its outer boundary, where it meets the layer outside it.
    Raises ValueError for a half mesh.
    """
    if mesh.half:
        raise ValueError("boundaries are drawn from the whole mesh, not from a half of it")
    sides = element_edges(mesh.cells, mesh.element)
    owner = np.tile(mesh.region, KINDS[mesh.element].corners)
    pairs = np.sort(sides[:, :2], axis=1)
    order = np.lexsort(pairs.T)
    same = (pairs[order[1:]] == pairs[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    alone = np.setdiff1d(order, np.append(first, second))
    rim = sorted(loops(_halves(sides[alone])), key=lambda loop: np.ptp(mesh.points[loop, 0]))
    lines = {"skin": rim[-1], "bone": rim[0]}
    between = np.sort([owner[first], owner[second]], axis=0).T
    for name in ("dermis", "fat"):
        index = mesh.regions.index(name)
        met = (between == (index - 1, index)).all(axis=1)
        lines[name] = max(loops(_halves(sides[first[met]])), key=len)
    return lines


def _halves(sides: np.ndarray) -> np.ndarray:
    """Element sides (start, end[, middle]) as straight edges (n, 2), through the middle node if
    any.
    """
    return sides if sides.shape[1] == 2 else np.vstack((sides[:, [0, 2]], sides[:, [2, 1]]))


def loops(edges: np.ndarray) -> list[np.ndarray]:
    """Join edges (n, 2) of node numbers, of any direction, into lines; closed ones repeat a
    node.
    """
    neighbours: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    found = []
    while neighbours:
        ends = [node for node, near in neighbours.items() if len(near) == 1]
        line = [*ends, *neighbours][:1]
        while near := neighbours[line[-1]]:
            step = near.pop()
            neighbours[step].remove(line[-1])
            line.append(step)
        neighbours = {node: near for node, near in neighbours.items() if near}
        found.append(np.array(line))
    return found


def densify(line: np.ndarray, spacing: float) -> np.ndarray:
    """Points (m, 2) along a polyline (n, 2), at most `spacing` apart."""
    length = np.append(0.0, np.cumsum(np.hypot(*np.diff(line, axis=0).T)))
    at = np.linspace(0, length[-1], int(length[-1] / spacing) + 2)
    return np.column_stack([np.interp(at, length, line[:, k]) for k in (0, 1)])


def inward(loop: np.ndarray, distance: float) -> np.ndarray:
    """Closed line moved by `distance` (m) along its inward normals (mean of the adjoining
    edges').
    """
    points = loop[:-1]
    after = np.roll(points, -1, axis=0)
    tangent = after - np.roll(points, 1, axis=0)
    normal = tangent[:, ::-1] * (-1, 1) / np.hypot(*tangent.T)[:, None]
    area = np.sum(points[:, 0] * after[:, 1] - after[:, 0] * points[:, 1])
    moved = points + np.sign(area) * distance * normal
    return np.vstack((moved, moved[:1]))


def surface_deflection(history: Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Lateral position (m) on the deformed skin and height there over the undeformed skin at that
    place (m).
    """
    x, y = history["skin_x"].values, history["skin_y"].values
    upper = np.flatnonzero(y > 0)
    moved_x, moved_y = (each[upper] for each in skin_at(history, index))
    return moved_x, moved_y - np.interp(moved_x, x[upper], y[upper])


# --- mesh -----------------------------------------------------------------------------------------


def mesh_rows(mesh: PadMesh, corneum: float) -> DataFrame:
    """Outline of every element (one row a point) with its layer, the bone's rim, the nail's side
    that is held, and the quality.

    Also the skin and the line `corneum` (m) under it, where the stratum corneum ends.
    """
    rim = {name: mesh.points[nodes] for name, nodes in boundaries(mesh).items()}
    polygons = [_outline(mesh, nodes) for nodes in mesh.cells]
    numbers = np.repeat(np.arange(len(polygons)), [len(p) for p in polygons])
    x, y = 1e3 * np.concatenate(polygons).T
    elements = {"series": "element", "element": numbers}
    elements["layer"] = np.array(mesh.regions)[mesh.region][numbers]
    skin = densify(rim["skin"], 0.1e-3)
    lines = {"rim": rim["bone"], "skin": skin, "inner": inward(skin, corneum)}
    if "nail" in mesh.curves:
        lines["held"] = mesh.points[loops(mesh.curves["nail"][:, :2])[0]]
    found, shown = quality.quality_of(mesh), rim["skin"]
    top = shown[(np.abs(shown[:, 0]) < 1e-3) & (shown[:, 1] > 0)]
    values = {
        "nodes (1)": found["nodes"],
        "elements (1)": found["elements"],
        "node_spacing_under_contact (um)": 1e6 * np.median(np.hypot(*np.diff(top, axis=0).T)),
        "smallest_edge (um)": found["smallest_edge_m"] * 1e6,
        "worst_scaled_jacobian (1)": found["worst_scaled_jacobian"],
    }
    parts = [elements | {X: x.round(4), Y: y.round(4)}]
    for series, line in lines.items():
        of = {"series": series, "layer": "bone" if series == "rim" else "stratum corneum"}
        parts.append(of | {X: line[:, 0] * 1e3, Y: line[:, 1] * 1e3})
    parts.append({"series": "quality", "quantity": list(values), "value": list(values.values())})
    frame = pd.concat(map(DataFrame, parts), ignore_index=True)
    return frame.assign(**dict.fromkeys(PARTS, np.nan))


def _outline(mesh: PadMesh, nodes: np.ndarray, straight: float = 5e-6) -> np.ndarray:
    """Points (n, 2) in m round one element; middle nodes only where a side is bent by over
    `straight`.
    """
    corners = KINDS[mesh.element].corners
    first = mesh.points[nodes[:corners]]
    if len(nodes) == corners:
        return first
    middle = mesh.points[nodes[corners : 2 * corners]]
    bent = np.hypot(*(middle - (first + np.roll(first, -1, axis=0)) / 2).T) > straight
    return np.concatenate(
        [[a, m] if b else [a] for a, m, b in zip(first, middle, bent, strict=True)]
    )


def draw_mesh(ax: Axes, frame: DataFrame, line: float = 0.22) -> None:
    """Elements in the colours of their layers, and the bone."""
    lines = {name: rows[[X, Y]].to_numpy() for name, rows in frame.groupby("series")}
    elements = frame.dropna(subset="element").groupby("element")
    polygons = [points[[X, Y]].to_numpy() for _, points in elements]
    colours = elements["layer"].first().map(style.LAYER_COLOURS)
    ax.fill(*lines["rim"].T, facecolor=style.LAYER_COLOURS["bone"], edgecolor="none")
    ax.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors="none"))
    ring = Path.make_compound_path(Path(lines["skin"]), Path(lines["inner"][::-1]))
    ax.add_patch(PathPatch(ring, fc=style.LAYER_COLOURS["stratum corneum"], ec="none"))
    edges = {"facecolors": "none", "edgecolors": "0.25", "linewidths": line}
    ax.add_collection(PolyCollection(polygons, **edges))
    if "held" in lines:
        ax.plot(*lines["held"].T, color=style.INK, lw=2.4, solid_capstyle="butt")


def layer_patches(layers: tuple[str, ...] = LAYERS) -> list:
    """Entries of a legend of the layers."""
    return [
        Patch(facecolor=style.LAYER_COLOURS[k], edgecolor="0.25", lw=0.4, label=k) for k in layers
    ]


def quality_of(frame: DataFrame) -> Series:
    """Numbers of the mesh by their names, of the rows of `mesh_rows`."""
    return frame.dropna(subset="value").set_index("quantity")["value"]


# --- sections -------------------------------------------------------------------------------------


def mesh_of(history: Dataset) -> PadMesh:
    """The mesh of a history with full fields: its nodes, elements and layers."""
    cells = history["element_nodes"].values
    points, region = history["node_position"].values, history["element_region"].values
    return PadMesh(points, cells, kind_of(cells.shape[1]).name, region, {}, True)


def section(history: Dataset, depth: float) -> dict[str, np.ndarray]:
    """Layer boundaries (n, 2) in m at the end of a press to `depth` (0: undeformed), and the
    indenter's lower side.

    Lines as in `boundaries`, and ``corneum``, the inner side of the stratum corneum: material
    points at its thickness under the skin, moved as the epidermis round them.
    """
    mesh = mesh_of(history)
    points, nodes, moved = mesh.points, boundaries(mesh), np.zeros_like(mesh.points)
    if depth:
        moved = history["snapshot_displacement"].values[leg_of(history, depth)]
    lines = {name: points[line] + moved[line] for name, line in nodes.items()}
    lines["corneum"] = inward(densify(points[nodes["skin"]], 0.1e-3), stratum_corneum(history))
    if depth:  # in mm: in m the search for triangles takes many times as long
        near = np.unique(mesh.cells[mesh.region == 0])
        motion = LinearNDInterpolator(points[near] * 1e3, moved[near])
        lines["corneum"] += motion(lines["corneum"] * 1e3)
    x = np.linspace(-8.4e-3, 8.4e-3, 1681)
    height = scene_of(history).stimulus.outline(x) + points[:, 1].max() - depth
    lines["indenter"] = np.column_stack((x, height))[np.isfinite(height)]
    return lines


def section_errors(history: Dataset, coarse: Companion | None) -> Errors:
    """Errors of the vertical displacement of the layers' boundaries under the apex, at the deepest
    press.
    """

    def sunk(d: Dataset, layer: str) -> float:
        nodes, deepest = boundaries(mesh_of(d))[layer], leg_of(d, max(pressed_depths(d)))
        x, y = d["node_position"].values[nodes].T
        apex = nodes[np.argmin(np.where(y > 0, abs(x), np.inf))]
        return float(d["snapshot_displacement"].values[deepest, apex, 1])

    layers = [partial(sunk, layer=layer) for layer in ("dermis", "fat")]
    return number_errors(history, coarse, *layers)

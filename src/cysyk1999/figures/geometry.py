"""Geometry of the pad for pictures: boundaries of its layers, elements of its mesh, sections under
an indenter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
import xarray as xr

from cysyk1999.measures.errors import PARTS, Companion, Errors, number_errors
from cysyk1999.measures.quantities import X, Y
from cysyk1999.measures.steady import leg_of, pressed_depths
from cysyk1999.publishing import style
from fingerpad.measures.features import skin_at
from fingerpad.results import scene_of
from fingerpad.specimen import quality
from fingerpad.specimen.element_kinds import KINDS, kind_of
from fingerpad.specimen.pad import PadMesh, element_edges

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LAYERS = tuple(style.LAYER_COLOURS)
"""Layers from the outside in, and the bone."""
NOTE = (
    "The model's own geometry and mesh, not measured; the MRI sections of Cysyk (1999) are not "
    "available."
)


def stratum_corneum(history: xr.Dataset) -> float:
    """Thickness (m) of the stratum corneum in a history's scene, which must have a parametric
    outline.
    """
    return scene_of(history).specimen.outline.stratum_corneum_thickness


# --- lines -----------------------------------------------------------------------------------------------


def boundaries(mesh: PadMesh, as_nodes: bool = False) -> dict[str, np.ndarray]:
    """Closed boundary lines: ``skin`` (with the nail side), ``dermis``, ``fat``, ``bone``.

    Points (n, 2) in m, or node numbers (n,) if `as_nodes`. A layer's line is its outer boundary,
    where it meets the layer outside it. Raises ValueError for a half mesh.
    """
    if mesh.half:
        raise ValueError("boundaries are drawn from the whole mesh, not from a half of it")
    sides = element_edges(mesh.cells, mesh.element)
    edges = sides[:, :2]
    owner = np.tile(np.arange(len(mesh.cells)), KINDS[mesh.element].corners)
    order = np.lexsort(np.sort(edges, axis=1).T)
    pairs = np.sort(edges, axis=1)[order]
    same = (pairs[1:] == pairs[:-1]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    low, high = mesh.region[owner[first]], mesh.region[owner[second]]
    alone = np.ones(len(edges), bool)
    alone[first] = alone[second] = False
    rim = sorted(loops(_halves(sides[alone])), key=lambda loop: np.ptp(mesh.points[loop, 0]))
    lines = {"skin": rim[-1], "bone": rim[0]}
    for name in ("dermis", "fat"):
        index = mesh.regions.index(name)
        inner = ((low == index - 1) & (high == index)) | ((high == index - 1) & (low == index))
        lines[name] = max(loops(_halves(sides[first][inner])), key=len)
    return lines if as_nodes else {name: mesh.points[line] for name, line in lines.items()}


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
        start = next(
            (n for n, near in neighbours.items() if len(near) == 1), next(iter(neighbours))
        )
        line = [start]
        while near := neighbours.get(line[-1]):
            step = near.pop()
            neighbours[step].remove(line[-1])
            line.append(step)
        for node in set(line):
            if not neighbours.get(node, True):
                del neighbours[node]
        found.append(np.array(line))
    return found


def densify(line: np.ndarray, spacing: float) -> np.ndarray:
    """Points (m, 2) along a polyline (n, 2), at most `spacing` apart."""
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))))
    at = np.linspace(0, length[-1], int(length[-1] / spacing) + 2)
    return np.column_stack([np.interp(at, length, line[:, k]) for k in (0, 1)])


def inward(loop: np.ndarray, distance: float) -> np.ndarray:
    """Closed line moved by `distance` (m) along its inward normals (mean of the adjoining
    edges').
    """
    points = loop[:-1]
    tangent = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    normal = np.column_stack((-tangent[:, 1], tangent[:, 0])) / np.hypot(*tangent.T)[:, None]
    area = np.sum(
        points[:, 0] * np.roll(points[:, 1], -1) - np.roll(points[:, 0], -1) * points[:, 1]
    )
    moved = points + np.sign(area) * distance * normal
    return np.vstack((moved, moved[:1]))


def surface_deflection(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Lateral position (m) on the deformed skin and height there over the undeformed skin at that
    place (m).
    """
    x, y = history["skin_x"].values, history["skin_y"].values
    upper = np.flatnonzero(y > 0)
    moved_x, moved_y = (each[upper] for each in skin_at(history, index))
    return moved_x, moved_y - np.interp(moved_x, x[upper], y[upper])


# --- mesh ------------------------------------------------------------------------------------------------


def mesh_rows(mesh: PadMesh, corneum: float) -> pd.DataFrame:
    """Outline of every element (one row a point) with its layer, the bone's rim, the nail's side
    that is held, and the quality.

    Also the skin and the line `corneum` (m) under it, where the stratum corneum ends.
    """
    layer, lines = np.array(mesh.regions)[mesh.region], boundaries(mesh)
    polygons = [_outline(mesh, nodes) for nodes in mesh.cells]
    counts, points = [len(p) for p in polygons], np.concatenate(polygons) * 1e3
    numbers = {
        "element": np.repeat(np.arange(len(polygons)), counts),
        "layer": np.repeat(layer, counts),
    }
    elements = (
        {"series": "element"} | numbers | {X: points[:, 0].round(4), Y: points[:, 1].round(4)}
    )
    bone = {
        "series": "rim",
        "layer": "bone",
        X: lines["bone"][:, 0] * 1e3,
        Y: lines["bone"][:, 1] * 1e3,
    }
    skin, inner = densify(lines["skin"], 0.1e-3), inward(densify(lines["skin"], 0.1e-3), corneum)
    held = (
        mesh.points[loops(mesh.curves["nail"][:, :2])[0]]
        if "nail" in mesh.curves
        else np.empty((0, 2))
    )
    edges = [
        {"series": series, "layer": "stratum corneum", X: line[:, 0] * 1e3, Y: line[:, 1] * 1e3}
        for series, line in (("skin", skin), ("inner", inner), ("held", held))
    ]
    found, apex = quality.quality_of(mesh), np.abs(lines["skin"][:, 0]) < 1e-3
    top = apex & (lines["skin"][:, 1] > 0)
    values = {
        "nodes (1)": found["nodes"],
        "elements (1)": found["elements"],
        "node_spacing_under_contact (um)": 1e6
        * float(np.median(np.hypot(*np.diff(lines["skin"][top], axis=0).T))),
        "smallest_edge (um)": found["smallest_edge_m"] * 1e6,
        "worst_scaled_jacobian (1)": found["worst_scaled_jacobian"],
    }
    judged = {"series": "quality", "quantity": list(values), "value": list(values.values())}
    parts = [pd.DataFrame(each) for each in (elements, bone, *edges, judged)]
    return pd.concat(parts, ignore_index=True).assign(**dict.fromkeys(PARTS, np.nan))


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


def draw_mesh(ax: Axes, frame: pd.DataFrame, line: float = 0.22) -> None:
    """Elements in the colours of their layers, and the bone."""
    from matplotlib.collections import PolyCollection

    elements = frame[frame["series"] == "element"]
    start = np.flatnonzero(np.diff(elements["element"].to_numpy(), prepend=-1))
    polygons = np.split(elements[[X, Y]].to_numpy(), start[1:])
    colours = [style.LAYER_COLOURS[layer] for layer in elements["layer"].to_numpy()[start]]
    rim = frame[frame["series"] == "rim"]
    ax.fill(rim[X], rim[Y], facecolor=style.LAYER_COLOURS["bone"], edgecolor="none")
    ax.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors="none"))
    draw_corneum(
        ax, *(frame.loc[frame["series"] == name, [X, Y]].to_numpy() for name in ("skin", "inner"))
    )
    ax.add_collection(
        PolyCollection(polygons, facecolors="none", edgecolors="0.25", linewidths=line)
    )
    held = frame[frame["series"] == "held"]
    if len(held):
        ax.plot(held[X], held[Y], color=style.INK, lw=2.4, solid_capstyle="butt")


def draw_corneum(ax: Axes, skin: np.ndarray, inner: np.ndarray) -> None:
    """The stratum corneum: between the skin (n, 2) and the line its thickness below, both closed,
    in mm.
    """
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    if len(skin) and len(inner):
        codes = [[Path.MOVETO, *[Path.LINETO] * (len(line) - 1)] for line in (skin, inner)]
        ring = Path(np.vstack((skin, inner[::-1])), np.concatenate(codes))
        ax.add_patch(
            PathPatch(ring, facecolor=style.LAYER_COLOURS["stratum corneum"], edgecolor="none")
        )


def layer_patches(layers: tuple[str, ...] = LAYERS) -> list:
    """Entries of a legend of the layers."""
    from matplotlib.patches import Patch

    return [
        Patch(facecolor=style.LAYER_COLOURS[k], edgecolor="0.25", lw=0.4, label=k) for k in layers
    ]


def quality_of(frame: pd.DataFrame) -> pd.Series:
    """Numbers of the mesh by their names, of the rows of `mesh_rows`."""
    return frame.dropna(subset="value").set_index("quantity")["value"]


# --- sections --------------------------------------------------------------------------------------------


def section(history: xr.Dataset, depth: float, corneum: bool = False) -> dict[str, np.ndarray]:
    """Layer boundaries (n, 2) in m at the end of a press to `depth` (0: undeformed), and the
    indenter's lower side.

    Lines as in `boundaries`, and if asked ``corneum``, the inner side of the stratum corneum:
    material points at its thickness under the skin, moved as the epidermis round them.
    """
    from scipy.interpolate import LinearNDInterpolator  # here, for it is slow to import

    points = history["node_position"].values
    cells, region = history["element_nodes"].values, history["element_region"].values
    numbered = boundaries(
        PadMesh(points, cells, kind_of(cells.shape[1]).name, region, {}, True), as_nodes=True
    )
    moved = (
        history["snapshot_displacement"].values[leg_of(history, depth)]
        if depth
        else np.zeros_like(points)
    )
    lines = {name: points[nodes] + moved[nodes] for name, nodes in numbered.items()}
    if corneum:
        inner = inward(densify(points[numbered["skin"]], 0.1e-3), stratum_corneum(history))
        epidermis = np.unique(cells[region == 0])
        # in mm: in m its search for triangles takes many times as long
        motion = (
            LinearNDInterpolator(points[epidermis] * 1e3, moved[epidermis])(inner * 1e3)
            if depth
            else 0.0
        )
        lines["corneum"] = inner + motion
    x = np.linspace(-8.4e-3, 8.4e-3, 1681)
    height = scene_of(history).stimulus.outline(x) + points[:, 1].max() - depth
    lines["indenter"] = np.column_stack((x, height))[np.isfinite(height)]
    return lines


def section_rows(
    panel: str, state: str, lines: dict[str, np.ndarray], layers: tuple[str, ...], errors: Errors
) -> pd.DataFrame:
    """Some lines of a `section` as rows."""
    parts = [
        pd.DataFrame(
            {
                "panel": panel,
                "phase": state,
                "layer": k,
                X: lines[k][:, 0] * 1e3,
                Y: lines[k][:, 1] * 1e3,
            }
            | errors.columns
        )
        for k in layers
    ]
    return pd.concat(parts, ignore_index=True)


def section_errors(history: xr.Dataset, coarse: Companion | None) -> Errors:
    """Errors of the vertical displacement of the layers' boundaries under the apex, at the deepest
    press.
    """

    def under_apex(layer: str):
        def feature(d: xr.Dataset) -> float:
            before, after = (section(d, z)[layer] for z in (0.0, max(pressed_depths(d))))
            node = int(np.argmin(np.where(before[:, 1] > 0, abs(before[:, 0]), np.inf)))
            return float(after[node, 1] - before[node, 1])

        return feature

    return number_errors(history, coarse, under_apex("dermis"), under_apex("fat"))


def draw_indenter(ax: Axes, rows: pd.DataFrame) -> None:
    """The indenter from its lower side up to where the picture ends."""
    side = rows[rows["layer"] == "indenter"]
    if len(side):
        ax.fill_between(side[X], side[Y], np.maximum(side[Y], 7.4), color=style.PALE, lw=0)
        ax.plot(side[X], side[Y], color=style.GREY, lw=0.7)

"""Chapter 3: the model's section and its mesh. The MRI images are not available and are not imitated."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from fingerpad.figures.spec import FigureSpec, assemble, axis_rows
from fingerpad.measures.features import ERROR, Histories, Meshes, scene_of
from fingerpad.publishing import style
from fingerpad.specimen.mesh import PadMesh, corner_count, element_edges

X, Y = "x (mm)", "y (mm)"
LAYERS = ("stratum corneum", "epidermis", "dermis", "fat", "bone")
SCENE = "ramp40_flat"
NOTE = "The model's own geometry and mesh, not measured; the MRI sections of Cysyk (1999) are not available."


def frame_3_4(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Closed boundaries of the section, outside to inside, named by the layer they enclose."""
    loops = boundaries(meshes[SCENE])
    loops["stratum corneum"] = loops["skin"]
    loops["epidermis"] = inward(loops["skin"], stratum_corneum(histories[SCENE]))
    parts = [
        pd.DataFrame({"layer": layer, X: loops[layer][:, 0] * 1e3, Y: loops[layer][:, 1] * 1e3, ERROR: np.nan})
        for layer in LAYERS
    ]
    return assemble(pd.concat(parts, ignore_index=True))


@style.styled
def fig_3_4(frame: pd.DataFrame) -> Figure:
    """Boundaries of the section: layers, symmetry, stratum corneum."""
    fig = style.new_figure(frame, "3-4", "Boundaries of the finite element model", 2.9, note=[NOTE])
    axes = fig.subplots(1, 3, sharey=True)
    titles = ("(a) layers and bone", "(b) symmetric, smooth, offset", "(c) with stratum corneum")
    loops = {layer: rows[[X, Y]].to_numpy() for layer, rows in frame.groupby("layer")}
    skin, apex = loops["stratum corneum"], {layer: loop[:, 1].max() for layer, loop in loops.items()}
    for ax, title in zip(axes, titles, strict=True):
        ax.set(
            title=title,
            aspect="equal",
            xlim=(-10, 10),
            ylim=(-8.2, 9.6),
            xlabel="x (mm)",
            yticks=[-6, -3, 0, 3, 6],
        )
    axes[0].set_ylabel("y (mm)")

    _fill(axes[0], {k: v for k, v in loops.items() if k != "epidermis"}, merged=True)
    bands = {"epidermis": ("stratum corneum", -7.0), "dermis": ("dermis", -1.0)}
    inner = {"epidermis": "dermis", "dermis": "fat"}
    for name, (outer, x) in bands.items():
        y = (_upper(loops[outer], x) + _upper(loops[inner[name]], x)) / 2
        _point_out(axes[0], name, (x, y), (x, 8.3))
    axes[0].text(0, (apex["fat"] + apex["bone"]) / 2, "fat", ha="center", va="center", fontsize=7)
    axes[0].text(0, (loops["bone"][:, 1].min() + apex["bone"]) / 2, "bone", ha="center", va="center", fontsize=7)
    size = f"{np.ptp(skin[:, 0]):.1f} × {np.ptp(skin[:, 1]):.1f} mm"
    axes[0].text(0, -7.3, size, ha="center", va="center", fontsize=7)

    for layer in ("stratum corneum", "dermis", "fat", "bone"):
        x, y = loops[layer].T
        axes[1].plot(x, y, color=style.INK, lw=1.0)
        axes[1].plot(-x, y, color=style.COLOURS["630"], lw=1.0, ls=(0, (2, 3)))
    axes[1].axvline(0, ymax=0.83, color=style.GREY, lw=0.6, ls=(0, (6, 2, 1, 2)))
    thick = apex["stratum corneum"] - apex["dermis"], apex["dermis"] - apex["fat"]
    text = f"epidermis {thick[0]:.2f} mm, dermis {thick[1]:.2f} mm\ndashed: mirror image"
    axes[1].text(0, 9.3, text, ha="center", va="top", fontsize=7)

    _fill(axes[2], loops, merged=False)
    corneum = apex["stratum corneum"] - apex["epidermis"]
    _point_out(axes[2], f"stratum corneum, {corneum:.2f} mm", (0, 5.85), (0, 8.3))
    return fig


def _upper(loop: np.ndarray, x: float) -> float:
    """Height at which a closed line passes `x` on its upper side."""
    near = loop[np.argsort(abs(loop[:, 0] - x))]
    return float(near[near[:, 1] > loop[:, 1].mean()][0, 1])


def _point_out(ax: Axes, text: str, at: tuple[float, float], label: tuple[float, float]) -> None:
    """Name a place with a hairline."""
    line = {"arrowstyle": "-", "lw": 0.6, "color": style.INK, "shrinkA": 0, "shrinkB": 0}
    ax.annotate(text, at, label, ha="center", va="center", fontsize=7, arrowprops=line)


def _fill(ax: Axes, loops: dict[str, np.ndarray], merged: bool) -> None:
    """Paint the layers outside to inside; `merged` gives the outermost band the epidermis's colour."""
    for layer in LAYERS:
        if layer in loops:
            colour = style.LAYER_COLOURS["epidermis" if merged and layer == "stratum corneum" else layer]
            ax.fill(*loops[layer].T, facecolor=colour, edgecolor=style.INK, lw=0.6)


def frame_3_5(histories: Histories, meshes: Meshes, coarse: Histories, reference: pd.DataFrame) -> pd.DataFrame:
    """Outline of every element (one row a point) with its layer, the bone's rim, and the mesh's quality."""
    frame = mesh_rows(meshes[SCENE], stratum_corneum(histories[SCENE]))
    return assemble(frame, axis_rows(reference, X, "T039a"), axis_rows(reference, Y, "T040a"))


def mesh_rows(mesh: PadMesh, corneum: float) -> pd.DataFrame:
    """Elements, rim of the bone and quality of a mesh; elements within `corneum` (m) of the skin are of the stratum corneum."""
    from scipy.spatial import cKDTree  # here, for it is slow to import

    corners = mesh.points[mesh.cells[:, : corner_count(mesh.element)]]
    layer = np.array(mesh.regions)[mesh.region]
    loops = boundaries(mesh)
    depth = cKDTree(densify(loops["skin"], 20e-6)).query(corners.mean(axis=1))[0]
    layer = np.where((layer == "epidermis") & (depth < corneum), "stratum corneum", layer)
    polygons = [element_outline(mesh, nodes) for nodes in mesh.cells]
    counts = [len(p) for p in polygons]
    points = np.concatenate(polygons) * 1e3
    elements = pd.DataFrame(
        {
            "series": "element",
            "element": np.repeat(np.arange(len(polygons)), counts),
            "layer": np.repeat(layer, counts),
            X: points[:, 0].round(4),
            Y: points[:, 1].round(4),
        }
    )
    bone = pd.DataFrame({"series": "rim", "layer": "bone", X: loops["bone"][:, 0] * 1e3, Y: loops["bone"][:, 1] * 1e3})
    values = mesh.quality()
    quality = pd.DataFrame(
        {
            "series": "quality",
            "quantity": ["nodes (1)", "elements (1)", "smallest_edge (um)", "worst_scaled_jacobian (1)"],
            "value": [
                values["nodes"],
                values["elements"],
                values["smallest_edge_m"] * 1e6,
                values["worst_scaled_jacobian"],
            ],
        }
    )
    frame = pd.concat([elements, bone, quality], ignore_index=True)
    frame[ERROR] = np.nan
    return frame


@style.styled
def fig_3_5(frame: pd.DataFrame) -> Figure:
    """The mesh, layers shaded."""
    fig = style.new_figure(frame, "3-5", "Finite element mesh of the fingerpad", 5.3, note=[NOTE])
    ax = fig.subplots()
    draw_mesh(ax, frame)
    ax.set(aspect="equal", xlim=(-10, 10), ylim=(-6.6, 6.6), xlabel="x (mm)", ylabel="y (mm)")
    ax.set(xticks=range(-10, 11, 2), yticks=range(-6, 7, 2))
    handles = [Patch(facecolor=style.LAYER_COLOURS[k], edgecolor="0.25", lw=0.4, label=k) for k in LAYERS]
    ax.legend(handles=handles, loc="upper left", handlelength=1.2, bbox_to_anchor=(0.0, 1.02))
    value = frame.dropna(subset="value").set_index("quantity")["value"]
    text = (
        f"{value['nodes (1)']:,.0f} nodes\n{value['elements (1)']:,.0f} elements\n"
        f"smallest edge {value['smallest_edge (um)']:.0f} µm\n"
        f"worst scaled Jacobian {value['worst_scaled_jacobian (1)']:.2f}"
    )
    ax.text(9.9, 6.75, text, ha="right", va="top", fontsize=7.5, linespacing=1.4)
    return fig


def draw_mesh(ax: Axes, frame: pd.DataFrame, line: float = 0.22) -> None:
    """Elements in the colours of their layers, and the bone."""
    elements = frame[frame["series"] == "element"]
    start = np.flatnonzero(np.diff(elements["element"].to_numpy(), prepend=-1))
    polygons = np.split(elements[[X, Y]].to_numpy(), start[1:])
    colours = [style.LAYER_COLOURS[layer] for layer in elements["layer"].to_numpy()[start]]
    rim = frame[frame["series"] == "rim"]
    ax.fill(rim[X], rim[Y], facecolor=style.LAYER_COLOURS["bone"], edgecolor="none")
    ax.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors="0.25", linewidths=line))


def element_outline(mesh: PadMesh, nodes: np.ndarray, straight: float = 5e-6) -> np.ndarray:
    """Points (n, 2) in m round one element; middle nodes only where a side is bent by over `straight`."""
    corners = corner_count(mesh.element)
    first = mesh.points[nodes[:corners]]
    if len(nodes) == corners:
        return first
    middle = mesh.points[nodes[corners : 2 * corners]]
    bent = np.hypot(*(middle - (first + np.roll(first, -1, axis=0)) / 2).T) > straight
    return np.concatenate([[a, m] if b else [a] for a, m, b in zip(first, middle, bent, strict=True)])


def stratum_corneum(history) -> float:
    """Thickness (m) of the stratum corneum in a history's scene, which must have a parametric outline."""
    return scene_of(history)["specimen"]["outline"]["stratum_corneum_thickness"]


def boundaries(mesh: PadMesh, as_nodes: bool = False) -> dict[str, np.ndarray]:
    """Closed boundary lines: ``skin`` (with the nail side), ``dermis``, ``fat``, ``bone``.

    Points (n, 2) in m, or node numbers (n,) if `as_nodes`. A layer's line is its outer boundary, where it meets the layer
    outside it. Raises ValueError for a half mesh.
    """
    if mesh.half:
        raise ValueError("boundaries are drawn from the whole mesh, not from a half of it")
    sides = element_edges(mesh.cells, mesh.element)
    edges = sides[:, :2]
    owner = np.tile(np.arange(len(mesh.cells)), corner_count(mesh.element))
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
    """Element sides (start, end[, middle]) as straight edges (n, 2), through the middle node if any."""
    return sides if sides.shape[1] == 2 else np.vstack((sides[:, [0, 2]], sides[:, [2, 1]]))


def loops(edges: np.ndarray) -> list[np.ndarray]:
    """Join edges (n, 2) of node numbers, of any direction, into lines; closed ones repeat a node."""
    neighbours: dict[int, list[int]] = {}
    for a, b in edges.tolist():
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    found = []
    while neighbours:
        start = next((n for n, near in neighbours.items() if len(near) == 1), next(iter(neighbours)))
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
    """Closed line moved by `distance` (m) along its inward normals (mean of the adjoining edges')."""
    points = loop[:-1]
    tangent = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    normal = np.column_stack((-tangent[:, 1], tangent[:, 0])) / np.hypot(*tangent.T)[:, None]
    area = np.sum(points[:, 0] * np.roll(points[:, 1], -1) - np.roll(points[:, 0], -1) * points[:, 1])
    moved = points + np.sign(area) * distance * normal
    return np.vstack((moved, moved[:1]))


FIGURES = (
    FigureSpec("3-4", "Boundaries of the model", (SCENE,), frame_3_4, fig_3_4),
    FigureSpec("3-5", "Finite element mesh", (SCENE,), frame_3_5, fig_3_5),
)

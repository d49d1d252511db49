"""Moving pictures: a surface on the pad, its layers deform, pressure, what a receptor feels and
what it answers follow.

Made from the full fields (snapshots) of a history, one frame each, as an animated GIF. The same
history gives the same bytes. Colours end between the extremes of the part of the pad that is
judged; beside the clamp of the nail, whose ends are singular, the pad is grey.
"""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.tri import Triangulation
from PIL import Image
from xarray import Dataset

from cysyk1999.figures.geometry import boundaries, mesh_of
from cysyk1999.measures.quantities import IMPULSE_RATE, SED, TIME
from cysyk1999.measures.responses import (
    RECEPTOR_DEPTH,
    curvature_of,
    is_stroke,
    predicted_rate,
)
from cysyk1999.publishing import style
from fingerpad.files import write_atomically
from fingerpad.measures.features import PRESSURE, force_gf, profile
from fingerpad.measures.measure import speed_of
from fingerpad.measures.strokes import profile_and_height
from fingerpad.results import read_history, scene_of
from fingerpad.specimen.element_kinds import KINDS
from fingerpad.specimen.pad import PadMesh

SIZE, DPI = (5.4, 5.7), 85  # inch, dots an inch
FRAME_TIME = 100  # ms
MOST_FRAMES = 24
"""Frames of a GIF: more snapshots than these are thinned."""
COLOURS = 40
"""In the one palette of all frames."""
HALF_WIDTH, LOW, HIGH = 11.6, -6.8, 7.6  # mm, of the section shown: the whole skin, dragged along
JUDGED, CLAMPED = -1.0, -2.2  # mm, above which elements set the scale, and are coloured at all
FIELD = "snapshot_strain_energy_density"


def animate(history: Dataset, gif: str | PathLike) -> None:
    """Write a history with snapshots as an animated GIF.

    Raises
    ------
    ValueError
        The history has no snapshots.
    """
    if "snapshot_time" not in history:
        raise ValueError("the history has no snapshots to make a moving picture of")
    count = history.sizes["snapshot"]
    every = -(-count // MOST_FRAMES)
    shown = history.isel(snapshot=slice(None, None, every))
    with style.theme():
        frames = [Image.fromarray(frame) for frame in drawn(shown)]
    some = np.concatenate([np.asarray(frames[k]) for k in (0, len(frames) // 2, -1)])
    palette = Image.fromarray(some).quantize(COLOURS, kmeans=1)
    first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames)
    options = {"save_all": True, "append_images": others, "loop": 0, "optimize": False}
    options["duration"] = FRAME_TIME * count // len(frames)
    write_atomically(Path(gif), lambda p: first.save(p, format="GIF", **options))


def _coloured(history: Dataset, judged: np.ndarray) -> tuple[np.ndarray, Normalize, str]:
    """Values (snapshot, element) to be coloured, their scale and label: strain energy if there is
    some, else mean stress. The `judged` elements set the scale.
    """
    energy = FIELD in history
    values = history[FIELD if energy else "snapshot_pressure"].values
    values = np.maximum(values, 1e-6) if energy else -1e-3 * values
    high = np.percentile(values[:, judged], 99.8)
    if energy:
        return values, LogNorm(3e-3 * high, high), "strain energy density (Pa)"
    return values, Normalize(0.0, high), "mean stress, compression (kPa)"


def drawn(history: Dataset) -> list[np.ndarray]:
    """One picture (height, width, 3) a snapshot."""
    time = history["time"].values
    at = [int(abs(time - t).argmin()) for t in history["snapshot_time"].values]
    shape, heights = profile_and_height(history)
    mesh = mesh_of(history)
    cells = mesh.cells[:, : KINDS[mesh.element].corners]
    borders = [line[np.isin(line, cells)] for line in boundaries(mesh).values()]
    points = 1e3 * (mesh.points + history["snapshot_displacement"].values)
    x, y = 1e3 * mesh.points[cells].mean(axis=1).T
    values, norm, label = _coloured(history, (y > JUDGED) & (abs(x) < 8))
    upper = history["skin_y"].values > 0
    stroke, rate, force = is_stroke(history), predicted_rate(history), force_gf(history)
    distance = 1e3 * history["stroke_distance"].values if stroke else np.zeros(len(time))

    fig = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    canvas = FigureCanvasAgg(fig)
    grid = fig.add_gridspec(3, 2, height_ratios=[3.2, 1.0, 1.0])
    section, below = fig.add_subplot(grid[0, :]), fig.add_subplot(grid[1:, 0])
    felt, answer = fig.add_subplot(grid[1, 1]), fig.add_subplot(grid[2, 1])
    # neither edges nor smoothed sides: both draw the mesh
    body = PolyCollection([], color="0.82", edgecolor="none", antialiased=False)
    window = Rectangle((-HALF_WIDTH, CLAMPED), 2 * HALF_WIDTH, HIGH, transform=section.transData)
    parts, painted = list(_layers(mesh, cells)), []
    lines = LineCollection([], colors=style.INK, lw=0.7)
    section.add_collection(body)
    section.add_collection(lines)
    section.set(xlim=(-HALF_WIDTH, HALF_WIDTH), ylim=(LOW, HIGH), aspect="equal")
    section.set(xlabel="x (mm)", ylabel="y (mm)")
    fig.colorbar(
        ScalarMappable(norm, style.FIELD),
        ax=section,
        label=label,
        shrink=0.8,
        pad=0.01,
        extend="both",
    )
    across = np.linspace(-HALF_WIDTH, HALF_WIDTH, 721)
    reach = 0.575e3 * history["contact_width"].values.max() + 1.5 * stroke
    highest = 1.05e-3 * history[PRESSURE].values[at].max()
    below.set(xlim=(-reach, reach), xlabel="x (mm)")
    below.set(ylim=(0, highest), ylabel="contact pressure (kPa)")
    (curve,) = below.plot([], [], color=style.INK)
    start = time[history["leg"].values > 0][0] if stroke else 0.0
    dots = {}
    for ax, column, words in (
        (felt, SED, "energy, 915 µm\n(Pa)"),
        (answer, IMPULSE_RATE, "rate, Eq 5-1\n(impulses/s)"),
    ):
        ax.plot(rate[TIME], rate[column], color=style.GREY, lw=0.8)
        highest = rate.loc[rate[TIME] >= start, column].max()
        ax.set(xlim=(0, rate[TIME].iloc[-1]), ylim=(0, 1.1 * highest), ylabel=words)
        (dots[column],) = ax.plot([], [], "o", color=style.HIGHLIGHT, ms=5)
    felt.tick_params(labelbottom=False)
    answer.set_xlabel("time (s)")
    (receptor,) = section.plot([], [], "o", mfc="white", mec=style.INK, ms=4.5, mew=0.8, zorder=5)
    middle = 0.0, mesh.points[:, 1].max() - RECEPTOR_DEPTH
    beside = np.linalg.norm(mesh.points - middle, axis=1).argmin()
    title = section.set_title("", fontfamily="DejaVu Sans Mono")
    block = section.fill_between([], [], HIGH + 1, color="0.72", ec=style.INK, lw=0.8)
    words, frames = _heading(history), []
    for k, index in enumerate(at):
        surface = 1e3 * (heights[index] + shape.outline(1e-3 * (across + distance[index])))
        shown = np.isfinite(surface) & (surface < HIGH + 1)
        block.set_data(across[shown], surface[shown], HIGH + 1)
        body.set_verts(points[k][cells])
        while painted:
            painted.pop().remove()
        for rows, nodes, triangles, node in parts:
            mean = _at_nodes(values[k][rows], node)
            look = {"shading": "gouraud", "cmap": style.FIELD, "norm": norm}
            painted.append(
                section.tripcolor(Triangulation(*points[k][nodes].T, triangles), mean, **look)
            )
            painted[-1].set_clip_path(window)
        lines.set_segments([points[k][line] for line in borders])
        receptor.set_data(*points[k][beside][:, None])
        place, pressure = profile(history, index)
        curve.set_data(1e3 * place[upper], 1e-3 * pressure[upper])
        for column, dot in dots.items():
            dot.set_data([time[index]], [np.interp(time[index], rate[TIME], rate[column])])
        moved = f"{distance[index]:5.1f} mm   " if stroke else ""
        title.set_text(f"{words}{time[index]:5.2f} s   {moved}{force[index]:4.1f} gf")
        canvas.draw()
        fig.set_layout_engine("none")  # laid out once: nothing moves between frames
        frames.append(np.array(canvas.buffer_rgba())[..., :3])
    return frames


def _layers(mesh: PadMesh, cells: np.ndarray) -> Iterator[tuple[np.ndarray, ...]]:
    """Of each layer: its elements, its corner nodes, its triangles (m, 3) and the corners of its
    elements, both as places among the nodes.
    """
    for region in np.unique(mesh.region):
        rows = np.flatnonzero(mesh.region == region)
        nodes, node = np.unique(cells[rows], return_inverse=True)
        node = node.reshape(len(rows), -1)
        last = node.shape[1] - 1
        yield rows, nodes, np.concatenate([node[:, [0, k, k + 1]] for k in range(1, last)]), node


def _at_nodes(values: np.ndarray, node: np.ndarray) -> np.ndarray:
    """Values of a layer's elements at its nodes: the mean of those that meet there."""
    each = np.repeat(values, node.shape[1])
    return np.bincount(node.ravel(), each) / np.bincount(node.ravel())


def _heading(history: Dataset) -> str:
    """What is shown: the stroking velocity of the scene, or the curvature that is pressed."""
    if speed := speed_of(scene_of(history)):
        return f"stroked at {1e3 * speed:g} mm/s   "
    curvature = curvature_of(history)
    return f"K = {curvature:.0f} 1/m   " if curvature else ""


def animations(job: SimpleNamespace) -> None:
    """Job: `histories` with whole fields -> `gifs`."""
    for history, gif in zip(job.histories, job.gifs, strict=True):
        animate(read_history(history), gif)

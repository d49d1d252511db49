"""A moving picture of one stroke: the surface slides over the pad, its layers deform, the pressure follows.

Made from the full fields (snapshots) of a history, one frame each. The same history gives the same bytes.
"""

from __future__ import annotations

import io
from os import PathLike
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure

from fingerpad.files import write_atomically
from fingerpad.measures.features import PRESSURE, profile
from fingerpad.measures.measure import speed_of
from fingerpad.measures.steady import force_N
from fingerpad.measures.strokes import profile_and_height
from fingerpad.publishing import style
from fingerpad.results import scene_of
from fingerpad.specimen.element_kinds import kind_of

SIZE, DPI = (6.4, 6.2), 100  # inch, dots an inch
FRAME_TIME = 100  # ms
COLOURS = mpl.colormaps["YlOrRd"]
SHADES, GREYS = 96, 48  # in the one palette of all frames
HALF_WIDTH, LOW, HIGH = 10.5, -6.6, 7.4  # mm, of the section shown


def animate(history: xr.Dataset, path: str | PathLike) -> None:
    """Write the stroke of a history with snapshots as an animated GIF. Raises ValueError for a history without snapshots."""
    if "snapshot_time" not in history:
        raise ValueError("the history has no snapshots to make a moving picture of")
    with style.theme():
        frames = _frames(history)
    palette = _palette()
    first, *others = (_indexed(frame, palette) for frame in frames)
    options = {"save_all": True, "append_images": others, "duration": FRAME_TIME, "loop": 0, "optimize": False}
    stream = io.BytesIO()
    first.save(stream, format="GIF", **options)
    write_atomically(Path(path), lambda p: p.write_bytes(stream.getvalue()))


def _palette() -> np.ndarray:
    """The colours (n, 3) of all frames: those of the map, and greys from black to white."""
    mapped = (255 * COLOURS(np.linspace(0, 1, SHADES))[:, :3]).round()
    return np.concatenate([mapped, np.repeat(np.linspace(0, 255, GREYS).round()[:, None], 3, axis=1)]).astype(np.uint8)


def _indexed(frame: np.ndarray, palette: np.ndarray):
    """A frame (height, width, 3) as an image of the palette's closest colours."""
    from PIL import Image

    packed, inverse = np.unique(frame.reshape(-1, 3).astype(np.int32) @ (65536, 256, 1), return_inverse=True)
    colours = np.stack([packed >> 16, (packed >> 8) & 255, packed & 255], axis=-1)
    distance = ((colours[:, None] - palette[None].astype(np.int32)) ** 2).sum(axis=-1)
    image = Image.fromarray(distance.argmin(axis=1).astype(np.uint8)[inverse.ravel()].reshape(frame.shape[:2]), "P")
    image.putpalette(palette.tobytes())
    return image


def _frames(history: xr.Dataset) -> list[np.ndarray]:
    """One picture (height, width, 3) a snapshot."""
    time, shape = history["time"].values, profile_and_height(history)[0]
    at = [int(abs(time - t).argmin()) for t in history["snapshot_time"].values]
    heights = profile_and_height(history)[1]
    stress = -1e-3 * history["snapshot_pressure"].values
    cells = history["element_nodes"].values[:, : kind_of(history.sizes["element_node"]).corners]
    points = history["node_position"].values + history["snapshot_displacement"].values
    layer_lines = _borders(points[0], cells, history["element_region"].values)

    fig = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    canvas = FigureCanvasAgg(fig)
    section, below = fig.subplots(2, 1, sharex=True, height_ratios=[3.1, 1.0])
    low, high = 0.0, float(np.percentile(stress, 99.5))
    body = PolyCollection(1e3 * points[0][cells], array=stress[0], cmap=COLOURS, edgecolor="face", lw=0.3)
    body.set_clim(low, high)
    lines = LineCollection(1e3 * points[0][layer_lines], colors=style.INK, lw=0.8)
    section.add_collection(body)
    section.add_collection(lines)
    section.set(xlim=(-HALF_WIDTH, HALF_WIDTH), ylim=(LOW, HIGH), aspect="equal", ylabel="y (mm)")
    fig.colorbar(body, ax=section, label="mean stress, compression (kPa)", shrink=0.8, pad=0.02, extend="both")
    x = np.linspace(-HALF_WIDTH, HALF_WIDTH, 721)
    distance = np.interp(history["snapshot_time"].values, time, history["stroke_distance"].values)
    top = 1.05e-3 * float(history[PRESSURE].values[at].max())
    below.set(ylim=(0, top), xlabel="x (mm)", ylabel="contact pressure\n(kPa)")
    (curve,) = below.plot([], [], color=style.INK)
    title = section.set_title("", fontfamily="DejaVu Sans Mono")
    speed = _speed(history)

    frames, block = [], None
    for k, index in enumerate(at):
        if block is not None:
            block.remove()
        surface = 1e3 * (heights[index] + shape.outline(x * 1e-3 + distance[k]))
        block = section.fill_between(x, surface, HIGH + 1, color="0.72", ec=style.INK, lw=1.0)
        body.set_verts(1e3 * points[k][cells])
        body.set_array(stress[k])
        lines.set_segments(1e3 * points[k][layer_lines])
        curve.set_data(*_profile(history, index))
        title.set_text(f"{speed}{1e3 * distance[k]:5.1f} mm   {force_N(history)[index]:.2f} N")
        canvas.draw()
        fig.set_layout_engine("none")  # laid out once: nothing moves between frames
        frames.append(np.array(canvas.buffer_rgba())[..., :3])
    return frames


def _profile(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Deformed position (mm) and pressure (kPa) of the upper skin nodes at an output."""
    (x, p), upper = profile(history, index), history["skin_y"].values > 0
    return 1e3 * x[upper], 1e-3 * p[upper]


def _speed(history: xr.Dataset) -> str:
    """Heading: the stroking velocity of the scene, if it states one."""
    speed = speed_of(scene_of(history))
    return f"stroked at {1e3 * speed:g} mm/s   " if speed else ""


def _borders(points: np.ndarray, cells: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Node pairs (n, 2) of the element edges on the rim and between layers; `cells` are corner nodes."""
    import skfem  # here, for it is slow to import

    mesh = (skfem.MeshTri if cells.shape[1] == 3 else skfem.MeshQuad)(points.T, cells.T)
    one, other = mesh.f2t
    return mesh.facets[:, (other < 0) | (region[one] != region[other])].T

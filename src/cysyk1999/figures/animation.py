"""Moving pictures: a surface on the pad, its layers deform, pressure, what a receptor feels and
what it answers follow.

Made from the full fields (snapshots) of a history, one frame each: an animated GIF and a film
(WebM). The same history gives the same bytes of the GIF. Colours end at what the shown part of the
pad has between its extremes: a singular point, such as the end of the nail's clamp, does not own
the scale.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from cysyk1999.measures.quantities import IMPULSE_RATE, SED, TIME
from cysyk1999.measures.responses import is_stroke, predicted_rate
from cysyk1999.publishing import style
from fingerpad.files import write_atomically
from fingerpad.measures.features import PRESSURE, force_gf, profile
from fingerpad.measures.measure import speed_of
from fingerpad.measures.strokes import profile_and_height
from fingerpad.results import read_history, scene_of
from fingerpad.specimen.element_kinds import kind_of

if TYPE_CHECKING:
    from PIL.Image import Image

SIZE, DPI = (5.4, 5.7), 100  # inch, dots an inch
FRAME_TIME = 100  # ms
MOST_FRAMES = 46
"""Frames of a GIF: more snapshots than these are thinned; the film has all."""
SHADES, GREYS = 64, 32  # in the one palette of all frames
HALF_WIDTH, LOW, HIGH = 10.0, -6.6, 7.6  # mm, of the section shown
JUDGED = -1.0  # mm, above which elements set the scale of the colours
FIELD = "snapshot_strain_energy_density"


def animate(history: xr.Dataset, gif: str | PathLike, film: str | PathLike | None = None) -> None:
    """Write a history with snapshots as an animated GIF, and as a film (WebM) if asked.

    Raises:
        ValueError: the history has no snapshots.
    """
    if "snapshot_time" not in history:
        raise ValueError("the history has no snapshots to make a moving picture of")
    with style.theme():
        frames, colours = _frames(history)
    few = frames[:: -(-len(frames) // MOST_FRAMES)]
    first, *others = _indexed(few, _palette(colours))
    longer = FRAME_TIME * len(frames) // len(few)
    options = {
        "save_all": True,
        "append_images": others,
        "duration": longer,
        "loop": 0,
        "optimize": False,
    }
    stream = io.BytesIO()
    first.save(stream, format="GIF", **options)
    write_atomically(Path(gif), lambda p: p.write_bytes(stream.getvalue()))
    if film is not None:
        write_atomically(Path(film), lambda p: _write_film(frames, p))


def _write_film(frames: list[np.ndarray], path: Path) -> None:
    """Frames (height, width, 3) as WebM (VP9), by the ffmpeg that imageio-ffmpeg brings along."""
    from imageio_ffmpeg import write_frames  # here, for only films need it

    high, wide = frames[0].shape[:2]
    exact = (
        "-crf 34 -b:v 0 -cpu-used 4 -threads 1 -fflags +bitexact -flags:v +bitexact -f webm".split()
    )
    writer = write_frames(
        str(path),
        (wide, high),
        fps=1000 / FRAME_TIME,
        codec="libvpx-vp9",
        output_params=exact,
        macro_block_size=2,
        quality=None,
    )
    writer.send(None)
    for frame in frames:
        writer.send(np.ascontiguousarray(frame).tobytes())
    writer.close()


def _palette(colours: mpl.colors.Colormap) -> np.ndarray:
    """The colours (n, 3) of all frames: those of the map, greys from black to white, and the
    highlight.
    """
    mapped = (255 * colours(np.linspace(0, 1, SHADES))[:, :3]).round()
    mark = 255 * np.array([mpl.colors.to_rgb(style.HIGHLIGHT)])
    greys = np.repeat(np.linspace(0, 255, GREYS).round()[:, None], 3, axis=1)
    return np.concatenate([mapped, greys, mark]).round().astype(np.uint8)


def _indexed(frames: list[np.ndarray], palette: np.ndarray) -> Iterator[Image]:
    """Frames (height, width, 3) as images of the palette's closest colours, each colour looked for
    once.
    """
    from PIL.Image import fromarray

    closest = np.full(
        1 << 24, 255, np.uint8
    )  # by colour; 255: not known yet, for no palette is that long
    for frame in frames:
        red, green, blue = np.moveaxis(frame.astype(np.int32), -1, 0)
        packed = red << 16 | green << 8 | blue
        new = np.unique(packed[closest[packed] == 255])
        colours = np.stack([new >> 16, new >> 8 & 255, new & 255], axis=-1)
        closest[new] = (
            ((colours[:, None] - palette[None].astype(np.int32)) ** 2).sum(axis=-1).argmin(axis=1)
        )
        image = fromarray(closest[packed], "P")
        image.putpalette(palette.tobytes())
        yield image


def _coloured(
    history: xr.Dataset, middle: np.ndarray
) -> tuple[np.ndarray, Normalize, mpl.colors.Colormap, str]:
    """Values (snapshot, element) to be coloured, their scale, map and label: strain energy if there
    is some, else mean stress.
    """
    judged = (middle[:, 1] > JUDGED) & (abs(middle[:, 0]) < 8)
    if FIELD in history:
        values = np.maximum(history[FIELD].values, 1e-6)
        high = float(np.percentile(values[:, judged], 99.8))
        return (
            values,
            LogNorm(3e-3 * high, high),
            mpl.colormaps[style.FIELD],
            "strain energy density (Pa)",
        )
    values = -1e-3 * history["snapshot_pressure"].values
    high = float(np.percentile(values[:, judged], 99.8))
    return (
        values,
        Normalize(0.0, high),
        mpl.colormaps[style.FIELD],
        "mean stress, compression (kPa)",
    )


def _frames(history: xr.Dataset) -> tuple[list[np.ndarray], mpl.colors.Colormap]:
    """One picture (height, width, 3) a snapshot, and the map of their colours."""
    time = history["time"].values
    at = [int(abs(time - t).argmin()) for t in history["snapshot_time"].values]
    shape, heights = profile_and_height(history)
    cells = history["element_nodes"].values[:, : kind_of(history.sizes["element_node"]).corners]
    rest = history["node_position"].values
    points = rest + history["snapshot_displacement"].values
    values, norm, colours, label = _coloured(history, 1e3 * rest[cells].mean(axis=1))
    layer_lines = _borders(points[0], cells, history["element_region"].values)
    stroke = is_stroke(history)
    distance = (
        history["stroke_distance"].values if "stroke_distance" in history else np.zeros(len(time))
    )

    fig = Figure(figsize=SIZE, dpi=DPI, layout="constrained")
    canvas = FigureCanvasAgg(fig)
    grid = fig.add_gridspec(3, 2, height_ratios=[3.2, 1.0, 1.0])
    section, below = fig.add_subplot(grid[0, :]), fig.add_subplot(grid[1:, 0])
    felt, answer = fig.add_subplot(grid[1, 1]), fig.add_subplot(grid[2, 1])
    body = PolyCollection(
        1e3 * points[0][cells], array=values[0], cmap=colours, norm=norm, edgecolor="face", lw=0.2
    )
    lines = LineCollection(1e3 * points[0][layer_lines], colors=style.INK, lw=0.7)
    section.add_collection(body)
    section.add_collection(lines)
    section.set(
        xlim=(-HALF_WIDTH, HALF_WIDTH),
        ylim=(LOW, HIGH),
        aspect="equal",
        ylabel="y (mm)",
        xlabel="x (mm)",
    )
    fig.colorbar(body, ax=section, label=label, shrink=0.8, pad=0.01, extend="both")
    x = np.linspace(-HALF_WIDTH, HALF_WIDTH, 721)
    top = 1.05e-3 * float(history[PRESSURE].values[at].max())
    reach = 1.15e3 * float(history["contact_width"].values.max())
    below.set(
        ylim=(0, top), xlim=(-reach / 2 - 1.5 * stroke, reach / 2 + 1.5 * stroke), xlabel="x (mm)"
    )
    below.set_ylabel("contact pressure (kPa)")
    (curve,) = below.plot([], [], color=style.INK)
    rate = predicted_rate(history)
    passed = rate[TIME] >= (time[history["leg"].values > 0][0] if stroke else 0.0)
    for ax, column, words in (
        (felt, SED, "energy, 915 µm\n(Pa)"),
        (answer, IMPULSE_RATE, "rate, Eq 5-1\n(impulses/s)"),
    ):
        ax.plot(rate[TIME], rate[column], color=style.GREY, lw=0.8)
        ax.set(
            xlim=(0, rate[TIME].iloc[-1]),
            ylim=(0, 1.1 * rate.loc[passed, column].max()),
            ylabel=words,
        )
    felt.tick_params(labelbottom=False)
    answer.set_xlabel("time (s)")
    dots = [ax.plot([], [], "o", color=style.HIGHLIGHT, ms=5)[0] for ax in (felt, answer)]
    title = section.set_title("", fontfamily="DejaVu Sans Mono")
    block = section.fill_between([], [], HIGH + 1, color="0.72", ec=style.INK, lw=0.8)
    words, force = _heading(history), force_gf(history)

    def show(k: int) -> None:
        index = at[k]
        surface = 1e3 * (heights[index] + shape.outline(x * 1e-3 + distance[index]))
        shown = np.isfinite(surface) & (surface < HIGH + 1)
        block.set_data(x[shown], surface[shown], HIGH + 1)
        body.set_verts(1e3 * points[k][cells])
        body.set_array(values[k])
        lines.set_segments(1e3 * points[k][layer_lines])
        curve.set_data(*_profile(history, index))
        for dot, column in zip(dots, (SED, IMPULSE_RATE), strict=True):
            dot.set_data([time[index]], [np.interp(time[index], rate[TIME], rate[column])])
        moved = f"{1e3 * distance[index]:5.1f} mm   " if stroke else ""
        title.set_text(f"{words}{time[index]:5.2f} s   {moved}{force[index]:4.1f} gf")

    show(0)
    canvas.draw()
    fig.set_layout_engine("none")  # laid out once: nothing moves between frames
    changing = [
        artist for each in ((body, block), (curve,), dots[:1], dots[1:]) for artist in _above(*each)
    ]
    for artist in changing:
        artist.set_animated(True)
    canvas.draw()
    still = canvas.copy_from_bbox(fig.bbox)
    frames = []
    for k in range(len(at)):
        show(k)
        canvas.restore_region(still)
        for artist in changing:
            artist.draw(canvas.renderer)
        frames.append(np.array(canvas.buffer_rgba())[..., :3])
    return frames, colours


def _above(*moving: Artist) -> list[Artist]:
    """Of axes the lowest of some artists and what is drawn over it, in that order."""
    drawn = sorted(
        (each for each in moving[0].axes.get_children() if each is not moving[0].axes.patch),
        key=Artist.get_zorder,
    )
    return drawn[min(map(drawn.index, moving)) :]


def _profile(history: xr.Dataset, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Deformed position (mm) and pressure (kPa) of the upper skin nodes at an output."""
    (x, p), upper = profile(history, index), history["skin_y"].values > 0
    return 1e3 * x[upper], 1e-3 * p[upper]


def _heading(history: xr.Dataset) -> str:
    """What is shown: the stroking velocity of the scene, or the curvature that is pressed."""
    scene = scene_of(history)
    if speed := speed_of(scene):
        return f"stroked at {1e3 * speed:g} mm/s   "
    curvature = getattr(scene.stimulus, "curvature", None)
    return f"K = {curvature:.0f} 1/m   " if curvature else ""


def _borders(points: np.ndarray, cells: np.ndarray, region: np.ndarray) -> np.ndarray:
    """Node pairs (n, 2) of the element edges on the rim and between layers; `cells` are corner
    nodes.
    """
    import skfem  # here, for it is slow to import

    mesh = (skfem.MeshTri if cells.shape[1] == 3 else skfem.MeshQuad)(points.T, cells.T)
    one, other = mesh.f2t
    return mesh.facets[:, (other < 0) | (region[one] != region[other])].T


def animations(job: SimpleNamespace) -> None:
    """Job: `histories` with whole fields -> `gifs` and `films`."""
    for history, gif, film in zip(job.histories, job.gifs, job.films, strict=True):
        animate(read_history(history), gif, film)

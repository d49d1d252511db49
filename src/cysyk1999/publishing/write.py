"""Pictures, written whole or not at all, with their plotted data side by side."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
from pandas import DataFrame
from PIL import Image

from cysyk1999.publishing.style import theme
from cysyk1999.publishing.tables import read_frame, write_published
from fingerpad.files import write_atomically

DPI = 300
COLOURS = 64
"""Most colours of a picture: inked dots move by one of 255 levels in the mean."""
VECTORS = "FINGERPAD_VECTORS"
"""Environment variable that names the folder PDFs are written to; the workflow sets it."""


def settle(fig: Figure, dpi: float = DPI) -> None:
    """Lay a picture out once for all its files, with rounded edges of its panels: the layout's
    last digits differ from one process to the next.
    """
    fig.set_dpi(dpi)
    engine = fig.get_layout_engine()
    if engine is None:
        return
    with theme():  # ticks and the layout are made only now
        engine.execute(fig)
    fig.set_layout_engine("none")
    for axes in fig.axes:
        for which in ("original", "active"):
            place = axes.get_position(original=which == "original")
            axes.set_position(Bbox.from_extents(np.round(place.extents, 12)), which=which)


def write_picture(fig: Figure, path: Path, dpi: float = DPI) -> None:
    """Write a picture as PNG at a fixed resolution, in few colours and without metadata: same data,
    same bytes.
    """
    settle(fig, dpi)
    canvas = FigureCanvasAgg(fig)
    with theme():
        canvas.draw()  # savefig would draw all of it twice
    picture = Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
    few = picture.quantize(COLOURS, kmeans=1, dither=Image.Dither.NONE)
    write_atomically(path, lambda p: few.save(p, format="PNG", optimize=True, dpi=(dpi, dpi)))


def write_vectors(fig: Figure, path: Path) -> None:
    """Write a picture as PDF without dates: same data, same bytes."""
    settle(fig)
    undated = {"CreationDate": None, "Producer": None}
    with theme():
        write_atomically(path, lambda p: FigureCanvasPdf(fig).print_pdf(p, metadata=undated))


def publish(fig: Figure, frame: DataFrame, png_path: str | os.PathLike) -> None:
    """Write ``fig_X.png``, beside it ``fig_X.csv`` with the plotted data, and ``fig_X.pdf`` into
    the folder of vectors if one is named (environment variable `VECTORS`).
    """
    png = Path(png_path)
    write_published(frame, png.with_suffix(".csv"))
    write_picture(fig, png)
    if folder := os.environ.get(VECTORS):
        write_vectors(fig, Path(folder) / f"{png.stem}.pdf")


def draw_study(job: SimpleNamespace) -> None:
    """Job: each of `data` (CSV) -> the picture in its place, by `STUDIES` of the module `study`."""
    draw = import_module(job.study[0]).STUDIES
    for data, picture in zip(job.data, job.pictures, strict=True):
        frame, name = read_frame(Path(data)), Path(picture).stem
        publish(draw[name if name in draw else Path(data).stem](frame), frame, picture)

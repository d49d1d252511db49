"""Publishing: a picture and its plotted data, a table as CSV and as Markdown, written side by side,
whole or not at all.
"""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.figure import Figure
from pandas import DataFrame
from PIL import Image

from cysyk1999.publishing.style import theme
from fingerpad.files import write_atomically, write_text

DPI = 300
COLOURS = 256
"""Most colours of a committed picture: a third of the bytes of true colour, no visible change."""
FLOAT_FORMAT = "%.6g"
VECTORS = "FINGERPAD_VECTORS"
"""Environment variable that names the folder PDFs are written to; the workflow sets it."""
TEXT_COLUMNS = (
    "source",
    "surface",
    "phase",
    "layer",
    "panel",
    "series",
    "quantity",
    "pad",
    "convexity",
)


def without_round_off(frame: DataFrame, least: float = 1e-11) -> DataFrame:
    """The frame with zeros for what is below `least` of a column's largest, so that two machines
    publish the same bytes.
    """
    for column in frame.select_dtypes("float"):
        size = frame[column].abs()
        frame[column] = frame[column].mask(size < least * size.max(), 0.0)
    return frame


def write_frame(frame: DataFrame, path: Path) -> None:
    """Write a frame as CSV, six significant digits."""
    write_atomically(
        path, lambda p: frame.to_csv(p, index=False, float_format=FLOAT_FORMAT, lineterminator="\n")
    )


def read_frame(path: Path) -> DataFrame:
    """Read a figure's CSV back: text columns as text (surface "79" too), everything else as
    numbers.
    """
    return pd.read_csv(path, dtype=dict.fromkeys(TEXT_COLUMNS, str))


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
            axes.set_position(np.round(place.bounds, 12), which=which)


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
    write_atomically(path, lambda p: few.save(p, format="PNG", compress_level=6, dpi=(dpi, dpi)))


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
    write_frame(frame, png.with_suffix(".csv"))
    write_picture(fig, png)
    if folder := os.environ.get(VECTORS):
        write_vectors(fig, Path(folder) / f"{png.stem}.pdf")


def markdown(frame: DataFrame) -> str:
    """The table as Markdown: whole numbers in full, others to four digits, empty cells for missing
    values.
    """

    def cell(value: object) -> str:
        if pd.isna(value):
            return ""
        if not isinstance(value, float):
            return str(value)
        digits = len(f"{abs(value):.0f}") if value.is_integer() else 0
        return f"{value:.{max(4, digits)}g}"

    rows = [frame.columns, ["---"] * len(frame.columns), *frame.map(cell).itertuples(index=False)]
    return "".join(f"| {' | '.join(row)} |\n" for row in rows)


def publish_table(frame: DataFrame, csv_path: str | os.PathLike) -> None:
    """Write ``name.csv`` and, beside it, ``name.md``, headed by ``frame.attrs["summary"]`` if there
    is one, with the columns that ``frame.attrs["columns"]`` names if it does.
    """
    path = Path(csv_path)
    write_frame(frame, path)
    text = markdown(frame[frame.attrs.get("columns", list(frame.columns))])
    if summary := frame.attrs.get("summary"):
        text = f"{summary}\n\n{text}"
    write_text(path.with_suffix(".md"), text)


def join_tables(job: SimpleNamespace) -> None:
    """Job: `parts` (CSV), one below the other -> `table`."""
    parts = [read_frame(Path(part)) for part in job.parts]
    publish_table(pd.concat(parts, ignore_index=True), job.table[0])


def draw_study(job: SimpleNamespace) -> None:
    """Job: each of `data` (CSV) -> the picture in its place, by `STUDIES` of the module `study`."""
    draw = import_module(job.study[0]).STUDIES
    for data, picture in zip(job.data, job.pictures, strict=True):
        frame, name = read_frame(Path(data)), Path(picture).stem
        publish(draw[name if name in draw else Path(data).stem](frame), frame, picture)

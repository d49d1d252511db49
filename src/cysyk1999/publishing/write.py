"""Publishing: a picture and its plotted data, a table as CSV and as Markdown, written side by side,
whole or not at all.
"""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from cysyk1999.publishing.fonts import shared_fonts
from cysyk1999.publishing.style import theme
from fingerpad.files import write_atomically

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL.Image import Image

DPI = 300
COLOURS = 255
"""Most colours of a committed picture: a third of the bytes of true colour, and no difference to
see.
"""
EXACT = 32
"""Colours of a picture that are kept as they are, those of most pixels."""
SOME = 64
"""Most pixels that any other colour counts as when few are chosen for all of them."""
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


def without_round_off(frame: pd.DataFrame, least: float = 1e-11) -> pd.DataFrame:
    """The frame with zeros for what is below `least` of a column's largest: so that two machines
    publish the same bytes.
    """
    for column in frame.select_dtypes("float"):
        size = frame[column].abs()
        frame[column] = frame[column].mask(size < least * size.max(), 0.0)
    return frame


def write_frame(frame: pd.DataFrame, path: Path) -> None:
    """Write a frame as CSV, six significant digits."""
    write_atomically(
        path, lambda p: frame.to_csv(p, index=False, float_format=FLOAT_FORMAT, lineterminator="\n")
    )


def read_frame(path: Path) -> pd.DataFrame:
    """Read a figure's CSV back: text columns as text (surface "79" too), everything else as
    numbers.
    """
    with open(path, encoding="utf-8") as stream:
        header = stream.readline().strip().split(",")
    return pd.read_csv(path, dtype={c: str for c in TEXT_COLUMNS if c in header})


def settle(fig: Figure, dpi: float = DPI) -> None:
    """Lay a picture out, once for all its files: a solver of layouts differs in the last digit from
    one process to the next.
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
            axes.set_position([round(edge, 12) for edge in place.bounds], which=which)


def write_picture(fig: Figure, path: Path, dpi: float = DPI) -> None:
    """Write a picture as PNG at a fixed resolution, in few colours and without metadata: same data,
    same bytes.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    settle(fig, dpi)
    canvas = FigureCanvasAgg(fig)
    with theme():
        canvas.draw()  # savefig would draw all of it twice
    few = in_few_colours(np.asarray(canvas.buffer_rgba()))
    write_atomically(path, lambda p: few.save(p, format="PNG", compress_level=6, dpi=(dpi, dpi)))


def in_few_colours(pixels: np.ndarray) -> Image:
    """A picture of opaque pixels (height, width, 4) uint8 with `COLOURS` at most, white always
    among them.

    The `EXACT` that most pixels have stay what they are; the others are shared out among the rest,
    none of which counts as more than `SOME` pixels: else a large field has all of them, and the bar
    that explains it three.
    """
    from PIL import Image

    words = pixels.view("<u4")[..., 0] & 0xFFFFFF
    inked = words != 0xFFFFFF
    ink = words[inked]
    found, counts = np.unique(ink, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    found, counts = found[order], counts[order]
    palette = found.astype("<u4").view(np.uint8).reshape(-1, 4)[:, :3]
    entries = np.arange(len(found))
    if len(found) > COLOURS - 1:
        counts = np.minimum(counts[EXACT:], SOME)
        rest = Image.fromarray(np.repeat(palette[EXACT:], counts, axis=0)[None])
        few = rest.quantize(
            COLOURS - 1 - EXACT, Image.Quantize.MEDIANCUT, kmeans=1, dither=Image.Dither.NONE
        )
        entries[EXACT:] = EXACT + np.asarray(few)[0, np.cumsum(counts) - 1].astype(int)
        palette = np.concatenate(
            [palette[:EXACT], np.array(few.getpalette(), np.uint8).reshape(-1, 3)]
        )
    entry_of = np.zeros(1 << 24, np.uint8)
    entry_of[found] = entries + 1
    places = np.zeros(inked.shape, np.uint8)
    places[inked] = entry_of[ink]
    out = Image.fromarray(places)
    out.putpalette([255, 255, 255, *palette.ravel().tolist()])
    return out


def write_vectors(fig: Figure, path: Path) -> None:
    """Write a picture as PDF without dates: same data, same bytes."""
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    settle(fig)
    canvas, unsaid = FigureCanvasPdf(fig), {"CreationDate": None, "Producer": None}
    with theme(), shared_fonts():
        write_atomically(path, lambda p: canvas.print_pdf(p, metadata=unsaid))


def publish(fig: Figure, frame: pd.DataFrame, png_path: str | os.PathLike) -> None:
    """Write ``fig_X.png``, beside it ``fig_X.csv`` with the plotted data, and ``fig_X.pdf`` into
    the folder of vectors if one is named (environment variable `VECTORS`).
    """
    png = Path(png_path)
    write_frame(frame, png.with_suffix(".csv"))
    write_picture(fig, png)
    if folder := os.environ.get(VECTORS):
        write_vectors(fig, Path(folder) / f"{png.stem}.pdf")


def markdown(frame: pd.DataFrame) -> str:
    """The table as Markdown: whole numbers in full, others to four digits, empty cells for missing
    values.
    """

    def cell(value: object) -> str:
        if isinstance(value, float):
            if value != value:
                return ""
            digits = max(4, len(f"{abs(value):.0f}")) if value.is_integer() else 4
            return f"{value:.{digits}g}"
        return "" if value is None or value is pd.NA else str(value)

    lines = ["| " + " | ".join(frame.columns) + " |", "|" + " --- |" * len(frame.columns)]
    lines += [
        "| " + " | ".join(cell(v) for v in row) + " |" for row in frame.itertuples(index=False)
    ]
    return "\n".join(lines) + "\n"


def publish_table(frame: pd.DataFrame, csv_path: str | os.PathLike) -> None:
    """Write ``name.csv`` (format %s) and, beside it, ``name.md``, headed by
    ``frame.attrs["summary"]`` if there is one, with the columns that ``frame.attrs["columns"]``
    names if it does.
    """
    path = Path(csv_path)
    write_frame(frame, path)
    shown = frame[frame.attrs.get("columns", list(frame.columns))]
    text = "".join(f"{line}\n\n" for line in [frame.attrs.get("summary")] if line) + markdown(shown)
    write_atomically(path.with_suffix(".md"), lambda p: p.write_text(text, encoding="utf-8"))


publish_table.__doc__ = publish_table.__doc__ % FLOAT_FORMAT


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

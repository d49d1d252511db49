"""Every figure from made-up results, made and drawn once for all tests: frames as published and
read back, pictures of these.
"""

import tempfile
from functools import cache
from pathlib import Path

import synthetic
from cysyk1999.figures.registry import CHAPTERS, FIGURES
from cysyk1999.publishing.style import theme
from cysyk1999.publishing.tables import read_frame, write_frame
from cysyk1999.reference_data import read_reference

REFERENCE = Path(__file__).parents[1] / "config/reference/thesis_numbers.csv"
LAWS = ("4-9", "4-17", "4-22", "5-14")


@cache
def results():
    """Made-up histories, meshes, companions 1 and 1.25 % away, and the reference table."""
    histories = synthetic.histories()
    return histories, synthetic.meshes(histories), synthetic.companions(), read_reference(REFERENCE)


@cache
def frame(number):
    """The frame of a figure."""
    return FIGURES[number].frame(*results(), *FIGURES[number].measurements(REFERENCE.parent))


@cache
def saved(number):
    """The frame, written and read back."""
    with tempfile.TemporaryDirectory() as folder:
        write_frame(frame(number), Path(folder) / "frame.csv")
        return read_frame(Path(folder) / "frame.csv")


@cache
def picture(number):
    """The picture, drawn from what was saved. To be looked at, not changed."""
    fig = FIGURES[number].draw(saved(number))
    with theme():
        fig.draw_without_rendering()
    return fig


RATES = tuple(
    s.number
    for name, specs in CHAPTERS.items()
    if name.endswith(("_receptors", "_bursts"))
    for s in specs
    if s.number not in LAWS
)
"""Figures of rates: a threshold makes more or less than 1 % of what is 1 % away."""

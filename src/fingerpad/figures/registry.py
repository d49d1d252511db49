"""The thesis figures of chapters 3 to 5, redrawn from simulated histories, one module a chapter.

A figure is a function of its data frame, and the frame is saved beside the picture::

    spec = FIGURES["4-10"]
    reference = read_reference("config/reference/thesis_numbers.csv")
    frame = spec.frame(histories, meshes, coarse, reference, *spec.measurements("config/reference"))
    publish(spec.draw(frame), frame, "figures/thesis/fig_4-10.png")
"""

from fingerpad.figures import (
    chapter3,
    chapter3_verification,
    chapter4,
    chapter4_responses,
    chapter5,
    chapter5_responses,
    ridges,
)
from fingerpad.figures.spec import FigureSpec

CHAPTERS = {
    module.__name__: module.FIGURES
    for module in (chapter3, chapter3_verification, chapter4, chapter4_responses, chapter5, chapter5_responses, ridges)
}
"""Module -> its figures: those of one module are drawn in one process."""
FIGURES: dict[str, FigureSpec] = {
    spec.number: spec
    for spec in sorted((s for specs in CHAPTERS.values() for s in specs), key=lambda s: [int(n) for n in s.number.split("-")])
}

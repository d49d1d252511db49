"""The thesis figures of chapters 3 to 5, redrawn from simulated histories, one module a chapter.

A figure is a function of its data frame, and the frame is saved beside the picture::

    spec = FIGURES["4-10"]
    reference = read_reference("config/reference/thesis_numbers.csv")
    frame = spec.frame(histories, meshes, coarse, reference, *spec.measurements("config/reference"))
    publish(spec.draw(frame), frame, "figures/thesis/fig_4-10.png")
"""

from fingerpad.figures import chapter3, chapter3_verification, chapter4, chapter5, chapter5_responses, ridges
from fingerpad.figures.io import publish, read_frame
from fingerpad.figures.spec import FigureSpec, read_reference

FIGURES: dict[str, FigureSpec] = {
    s.number: s
    for s in (
        *chapter3.FIGURES,
        *chapter3_verification.FIGURES,
        *chapter4.FIGURES,
        *chapter5.FIGURES,
        *chapter5_responses.FIGURES,
        *ridges.FIGURES,
    )
}

__all__ = ["FIGURES", "FigureSpec", "publish", "read_frame", "read_reference"]

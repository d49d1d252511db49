"""The figures of the thesis, chapters 3 to 5, one module of specs a chapter. Nothing here loads
matplotlib.

::

    spec = FIGURES["4-10"]
    reference = read_reference("config/reference/thesis_numbers.csv")
    frame = spec.frame(histories, meshes, coarse, reference, *spec.measurements("config/reference"))
    publish(spec.draw(frame), frame, "figures/thesis/fig_4-10.png")
"""

from __future__ import annotations

from cysyk1999.figures import (
    chapter3,
    chapter4,
    chapter4_receptors,
    chapter5,
    chapter5_bursts,
    chapter5_receptors,
    ridges,
)
from cysyk1999.figures.grammar import Figure

CHAPTERS: dict[str, tuple[Figure, ...]] = {
    module.__name__: module.FIGURES
    for module in (
        chapter3,
        chapter4,
        chapter4_receptors,
        chapter5,
        chapter5_bursts,
        chapter5_receptors,
        ridges,
    )
}
"""Module -> its figures: those of one module are drawn in one process."""
FIGURES: dict[str, Figure] = {
    spec.number: spec
    for spec in sorted(
        (s for specs in CHAPTERS.values() for s in specs),
        key=lambda s: [int(n) for n in s.number.split("-")],
    )
}
"""The figures by the thesis's number, in its order."""

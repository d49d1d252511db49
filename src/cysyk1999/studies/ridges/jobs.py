"""The jobs of the study of inner ridges."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.measures.direction import KEY
from cysyk1999.project import Project
from cysyk1999.studies.ridges.frames import FRAMES, ridge_data
from cysyk1999.studies.ridges.run import Case, ridge_cases

RIDGED = "ridged_stroke_right"
"""The scene whose ridges are varied; those it has itself are `KEY`."""
MESHES = (("fine",), ("curved", "straight", "shifted"))
"""Further meshes for the ridges of RIDGED, by process."""


@part("ridges", in_default=True)
def ridges(project: Project) -> Iterator[Job]:
    """Pads with ridges: the study of the direction of strokes."""
    heights, (height, friction) = project.config.ridge_heights, KEY
    if not heights:
        return
    cases = [Case(h, friction, mesh) for h in heights for mesh in ("thesis", "coarse")]
    groups = [cases[k : k + 4] for k in range(0, len(cases), 4)]
    if height in heights:
        groups += [[Case(height, friction, mesh) for mesh in meshes] for meshes in MESHES]
    histories = [
        [project.result(f"ridges/{case}/history.nc") for case in group] for group in groups
    ]
    more = {"mem_mb": 2000, "runtime": 30, "priority": 1}
    for k, made in enumerate(histories, start=1):
        values, name = project.values_of(RIDGED), f"ridge_cases_{k}"
        yield Job(ridge_cases, project.reads(RIDGED), {"histories": made}, values, name, **more)
    data = [project.result(f"ridges/{name}.csv") for name in FRAMES]
    yield Job(ridge_data, {"cases": sum(histories, [])}, {"data": data}, priority=1)
    yield project.study_pictures("ridges", FRAMES, data, "cysyk1999.studies.ridges.picture")

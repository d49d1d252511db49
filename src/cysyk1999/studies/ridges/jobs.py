"""The jobs of the study of inner ridges."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.ridges.frames import ridge_data
from cysyk1999.studies.ridges.run import ridge_cases

RIDGED, OUTER = "ridged_stroke_right", ("ridged_outer_stroke_right", "ridged_outer_stroke_left")
HEIGHT, FRICTION = 150, 0.35
"""Height (um) of ridges and coefficient of friction of RIDGED; the study varies one at a time."""
MESHES = (("fine",), ("curved", "straight", "shifted"))
"""Further meshes for that case, by process."""


@part("ridges", in_default=True)
def ridges(project: Project) -> Iterator[Job]:
    """Pads with ridges: the study of the direction of strokes."""
    c = project.config
    if not c.ridge_heights:
        return
    pairs = [(h, FRICTION) for h in c.ridge_heights] + [(HEIGHT, mu) for mu in c.ridge_frictions]
    pairs = list(dict.fromkeys(pairs))
    both = [[f"{h:g}_{mu:g}_{mesh}" for mesh in ("thesis", "coarse")] for h, mu in pairs]
    groups = [sum(both[k : k + 2], []) for k in range(0, len(both), 2)]
    if (HEIGHT, FRICTION) in pairs:
        groups += [[f"{HEIGHT}_{FRICTION}_{mesh}" for mesh in meshes] for meshes in MESHES]
    cases = []
    for k, group in enumerate(groups, start=1):
        histories = [project.result(f"ridges/{name}/history.nc") for name in group]
        cases += histories
        made, values = {"histories": histories}, project.values_of(RIDGED)
        more = {"mem_mb": 2000, "runtime": 30, "priority": 1}
        yield Job(ridge_cases, project.reads(RIDGED), made, values, f"ridge_cases_{k}", **more)
    names = ["offset", "height", "friction", "mesh", "outer"]
    data = [project.result(f"ridges/{name}.csv") for name in names]
    read = {
        "cases": cases,
        "histories": project.histories(OUTER),
        "coarse": project.companions(OUTER[:1]),
    }
    yield Job(ridge_data, read, {"data": data}, priority=1)
    yield project.study_pictures("ridges", names, data, "cysyk1999.studies.ridges.picture")

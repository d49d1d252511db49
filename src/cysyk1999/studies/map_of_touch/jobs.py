"""The jobs of the map of touch: a published sweep and its picture."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import ALL_CORES, Job, part
from cysyk1999.project import Project
from cysyk1999.studies.map_of_touch.picture import map_of_touch
from cysyk1999.studies.map_of_touch.run import run_sweep


@part("map_of_touch")
def jobs(project: Project) -> Iterator[Job]:
    """A sweep over curvature, force and rate: a picture; about five minutes of one core."""
    name, folder = "map_of_touch", "results/sweeps/map_of_touch"
    sweep = {"sweep": [project.at(f"config/sweeps/{name}.yaml")]}
    read, table = sweep | {"files": [project.thesis_specimen()]}, f"{folder}/sweep.csv"
    yield Job(
        run_sweep,
        read,
        {"dataset": [f"{folder}/sweep.nc"]},
        name=f"sweep_{name}",
        modules=("fingerpad.sweeps.__main__",),
        also=[table],
        mem_mb=2000,
        runtime=120,
        threads=ALL_CORES,
    )
    yield Job(map_of_touch, {"scenes": [table]}, {"picture": project.pictures([name])})

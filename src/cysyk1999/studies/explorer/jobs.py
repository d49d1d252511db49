"""The job of the explorer: a sweep, its emulator, and the page."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import ALL_CORES, Job, part
from cysyk1999.project import Project
from cysyk1999.studies.explorer.run import pad_page


@part("explorer")
def explorer(project: Project) -> Iterator[Job]:
    """The pad's emulator and its page to play with; half an hour of two cores."""
    sweep = [project.at("config/sweeps/pad.yaml")]
    read = {"sweep": sweep, "files": [project.thesis_specimen()]}
    made = {
        "emulator": [project.result("explorer/pad.emulator")],
        "page": [f"{project.config.studies}/explorer.html"],
        "table": project.tables(["emulator"]),
    }
    modules = ("fingerpad.sweeps.__main__",)
    more = {"mem_mb": 2000, "runtime": 120, "threads": ALL_CORES}
    yield Job(pad_page, read, made, modules=modules, **more)

"""The jobs of the study of effects."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.effects.picture import effects_picture
from cysyk1999.studies.effects.run import effects_study


@part("effects")
def effects(project: Project) -> Iterator[Job]:
    """What each effect changes and costs, and the planner's choices and rules against that."""
    files = [project.thesis_specimen(), project.at("config/effects/drawn.yaml")]
    read = {"files": files}
    data = {name: project.result(f"effects/{name}.csv") for name in ("changes", "choices")}
    for name, path in data.items():
        made = {"data": [path]}
        yield Job(effects_study, read, made, {"part": [name]}, f"effects_{name}", runtime=30)
    made = {
        "picture": project.pictures(["effects"]),
        "tables": project.tables(["effects", "planner_rules"]),
        "data": project.tables(["planner_choices"]),
    }
    yield Job(effects_picture, {"parts": [*data.values()]}, made)

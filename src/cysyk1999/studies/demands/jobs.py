"""The jobs of the three pictures: drawn from the tables of other studies."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cysyk1999.job import Job, digest, part
from cysyk1999.project import Project
from cysyk1999.studies.demands.picture import TABLES, draw_demand


@part("demands")
def demands(project: Project) -> Iterator[Job]:
    """What accuracy costs, how hard cases end, what effects change: from tables that are there.

    Of tables that are there the content counts, not who made them: studies of hours do not start
    again because their code has changed. Those that are not there are made.
    """
    for name, needed in TABLES.items():
        tables, made = project.tables(needed), {"picture": project.pictures([name])}
        if all(Path(table).exists() for table in tables):
            values = {"tables": tables, "written": [*map(digest, tables)]}
            yield Job(draw_demand, {}, made, values, name)
        else:
            yield Job(draw_demand, {"tables": tables}, made, name=name)

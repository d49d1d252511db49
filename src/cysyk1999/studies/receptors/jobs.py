"""The job of the tables of receptors."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.receptors.run import TABLES, receptor_tables

FELT = ("ramp40", "ramp150", "press10", "press15", "stroke", "stroke_sub", "spheres")
"""Families of scenes whose rates are predicted."""


@part("receptor_tables", in_default=True)
def jobs(project: Project) -> Iterator[Job]:
    """Tables of what receptors make of the histories."""
    c = project.config
    if names := [name for name in TABLES if name in c.table_names]:
        compared = project.of_families(c.scenes, "ramp40", "stroke")
        read = {
            "rates": project.rates,
            "histories": project.histories(project.of_families([*c.scenes, *c.variants], *FELT)),
            "coarse": project.companions(
                s for s in compared if s.startswith("ramp40_") or s == "stroke_10"
            ),
        }
        yield Job(receptor_tables, read, {"tables": project.tables(names)}, priority=1)

"""The job of the comparison with other finite element packages."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.peers.run import peers_table


@part("peers", extra="felupe")
def peers(project: Project) -> Iterator[Job]:
    """The same press through public finite element packages, if they are installed: a table."""
    files = [project.thesis_specimen(), project.at("config/specimens/homogeneous.yaml")]
    yield Job(peers_table, {"files": files}, {"table": project.tables(["peers"])}, mem_mb=2000)

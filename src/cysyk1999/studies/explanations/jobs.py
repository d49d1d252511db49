"""The jobs of the study of readings that the thesis leaves open."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.explanations.run import (
    FILE,
    PRESSED,
    READ_ONLY,
    READINGS,
    STROKED,
    explanation,
    explanations_read,
    explanations_table,
)


@part("explanations")
def explanations(project: Project) -> Iterator[Job]:
    """Which reading of what the thesis leaves open brings about what does not hold here: a table;
    25 minutes of one core.
    """
    scenes, simulated = [*PRESSED, *STROKED], [name for name in READINGS if name not in READ_ONLY]
    words = {name: re.sub("[^a-z]+", "_", name) for name in (*READ_ONLY, *simulated)}
    data = {name: project.result(f"explanations/{word}.csv") for name, word in words.items()}
    known = {
        "reference": project.reference,
        "study": [project.at(FILE)],
    }
    read = known | {"histories": project.histories(project.measured)}
    made = {"data": [data[name] for name in READ_ONLY]}
    yield Job(explanations_read, read, made, {"names": list(READ_ONLY)}, mem_mb=2000)
    folder, written = os.path.dirname(project.scene(scenes[0])), project.written(*scenes)
    more = {"mem_mb": 2000, "runtime": 60}
    for name in simulated:
        values = {"name": [name], "scenes": [folder], "written": written}
        read, made = known | project.reads(*scenes), {"data": [data[name]]}
        yield Job(explanation, read, made, values, f"explanation_{words[name]}", **more)
    read = known | {
        "comparison": project.tables(["thesis_comparison"]),
        "readings": [*data.values()],
    }
    made = {"tables": project.tables(["explanations", "explanations_readings"])}
    yield Job(explanations_table, read, made, {"names": list(data)})

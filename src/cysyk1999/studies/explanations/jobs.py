"""The jobs of the study of readings that the thesis leaves open."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.explanations.run import (
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
    scenes, names = [*PRESSED, *STROKED], [*READ_ONLY, *(n for n in READINGS if n not in READ_ONLY)]
    words = {name: re.sub("[^a-z]+", "_", name) for name in names}
    data = {name: project.result(f"explanations/{word}.csv") for name, word in words.items()}
    reference = {"reference": [project.at("config/reference/thesis_numbers.csv")]}
    read = reference | {"histories": project.histories(project.measured)}
    made = {"data": [data[name] for name in READ_ONLY]}
    yield Job(explanations_read, read, made, {"names": list(READ_ONLY)}, mem_mb=2000)
    read = reference | project.reads(*scenes)
    for name in names[len(READ_ONLY) :]:
        values = {
            "name": [name],
            "scenes": [os.path.dirname(project.scene(scenes[0]))],
            "written": project.written(*scenes),
        }
        made, more = {"data": [data[name]]}, {"mem_mb": 2000, "runtime": 60}
        yield Job(explanation, read, made, values, f"explanation_{words[name]}", **more)
    read = reference | {
        "comparison": project.tables(["thesis_comparison"]),
        "readings": [*data.values()],
    }
    made = {"tables": project.tables(["explanations", "explanations_readings"])}
    yield Job(explanations_table, read, made, {"names": names})

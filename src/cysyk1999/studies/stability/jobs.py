"""The jobs of the study of hard cases."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.stability.cases import FILES, PARTS
from cysyk1999.studies.stability.picture import stability_picture
from cysyk1999.studies.stability.run import stability_method, stability_unseen


@part("stability")
def stability(project: Project) -> Iterator[Job]:
    """How stable the method is in hard cases, beside simpler methods: a heat map and a table."""
    cases = [project.at(f"config/stability/{name}") for name in FILES]
    read, data = {"files": [project.thesis_specimen(), *cases]}, []
    for method, parts in PARTS.items():
        name = method.replace(" ", "_")
        for k in range(1, parts + 1):
            data.append(project.result(f"stability/{name}_{k}.csv"))
            values = {"method": [name], "part": [f"{k}/{parts}"]}
            made = {"data": data[-1:]}
            yield Job(stability_method, read, made, values, f"stability_{name}_{k}", runtime=30)
    made = {"picture": project.pictures(["stability"]), "table": project.tables(["stability"])}
    yield Job(stability_picture, {"methods": data}, made)


SEEDS = (11, 12, 13, 14)
"""Of the cases whose ends are published; none was used to tune anything."""
UNSEEN_PARTS = 4


@part("stability_unseen")
def unseen(project: Project) -> Iterator[Job]:
    """Hard cases that are drawn anew, by a seed: how they end, a table."""
    seed = project.config.seed
    cases = [project.at(f"config/stability/{name}") for name in FILES]
    read, rows = {"files": [project.thesis_specimen(), *cases]}, []
    for number in (seed,) if seed else SEEDS:
        for k in range(1, UNSEEN_PARTS + 1):
            rows.append(project.result(f"stability/unseen_{number}_{k}.csv"))
            values = {"seed": [str(number)], "part": [f"{k}/{UNSEEN_PARTS}"]}
            name = f"stability_unseen_{number}_{k}"
            yield Job(stability_unseen, read, {"rows": rows[-1:]}, values, name, runtime=60)
    table = f"stability_unseen_{seed}" if seed else "stability_unseen"
    yield project.joined("stability_unseen_table", table, rows)

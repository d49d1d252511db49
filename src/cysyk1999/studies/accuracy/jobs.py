"""The jobs of the study of accuracy."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.accuracy.belief import OUTSIDE, accuracy_belief
from cysyk1999.studies.accuracy.drawn import CLASSES, accuracy_drawn
from cysyk1999.studies.accuracy.edges import accuracy_edges
from cysyk1999.studies.accuracy.errors import accuracy_tables
from cysyk1999.studies.accuracy.finer import MADE_FINER, accuracy_finer
from cysyk1999.studies.accuracy.own import accuracy_own
from cysyk1999.studies.accuracy.picture import accuracy_pictures
from cysyk1999.studies.accuracy.ridges import SURFACES, accuracy_ridges
from cysyk1999.studies.accuracy.run import EDGED, FAMILY, accuracy_sweep, sweeps
from cysyk1999.studies.accuracy.shown import accuracy_shown
from cysyk1999.studies.accuracy.strokes import (
    STROKED_OVER,
    accuracy_strokes,
    accuracy_strokes_table,
)
from cysyk1999.studies.accuracy.turned import accuracy_turned
from cysyk1999.studies.accuracy.turned_drawn import PARTS, accuracy_turned_drawn

BASE = FAMILY["210"]
"""The scene that most parts of the study vary."""
LONG = {"mem_mb": 3000, "runtime": 60}
PICTURES = {
    "accuracy": ("error", "error_stroke", "growth"),
    "accuracy_belief": ("belief",),
    "accuracy_drawn": ("drawn",),
    "accuracy_ridges": ("ridges",),
    "accuracy_shown": ("shown",),
}
"""Table -> pictures that are drawn of it."""


@part("accuracy")
def accuracy(project: Project) -> Iterator[Job]:
    """What accuracy costs in time, and whether runs know their error; 1.5 h of one core."""
    yield from _sweeps(project)
    for do, scenes in (
        (accuracy_edges, EDGED.values()),
        (accuracy_ridges, [*map(FAMILY.get, SURFACES)]),
    ):
        made = {"table": project.tables([do.__name__])}
        yield Job(do, project.reads(*scenes), made, project.values_of(*scenes), **LONG)
    read, values = project.reads(BASE), project.values_of(BASE)
    made = {"rows": [project.result("accuracy/own.csv")], "table": project.tables(["accuracy_own"])}
    yield Job(accuracy_own, read, made, values, **LONG)
    drawn = read | {"files": [*read["files"], project.at("config/accuracy/drawn.yaml")]}
    rows = {over: project.result(f"accuracy/strokes/{over}.csv") for over in STROKED_OVER}
    for over, path in rows.items():
        name = f"accuracy_strokes_{over}"
        yield Job(accuracy_strokes, drawn, {"rows": [path]}, {"over": [over]}, name, **LONG)
    table = {"table": project.tables(["accuracy_strokes"])}
    yield Job(accuracy_strokes_table, {"parts": [*rows.values()]}, table)
    names = list(OUTSIDE)
    rows = [project.result(f"accuracy/belief/{name}.csv") for name in names]
    files = [*read["files"], project.at("config/accuracy/outside.yaml")]
    varied = read | {"files": files}
    for k in range(0, len(names), 7):
        made, more = {"rows": rows[k : k + 7]}, {"names": names[k : k + 7], **values}
        yield Job(accuracy_belief, varied, made, more, f"accuracy_belief_{k // 7 + 1}", **LONG)
    yield project.joined("accuracy_beliefs", "accuracy_belief", rows)
    rows = {kind: project.result(f"accuracy/drawn/{kind}.csv") for kind in CLASSES}
    for kind, path in rows.items():
        more = {"kind": [kind], **values}
        yield Job(accuracy_drawn, drawn, {"rows": [path]}, more, f"accuracy_drawn_{kind}", **LONG)
    yield project.joined("accuracy_drawn", "accuracy_drawn", [*rows.values()])
    yield from _turned(project)
    yield from _shown(project)
    for table, pictures in PICTURES.items():
        made = {"pictures": project.pictures(pictures, "accuracy_")}
        yield Job(
            accuracy_pictures, {"table": project.tables([table])}, made, name=f"{table}_picture"
        )


def _sweeps(project: Project) -> Iterator[Job]:
    """Scenes on ever finer meshes, and the tables of them that the planner reads."""
    records = {name: project.result(f"accuracy/{name}.json") for name in sweeps()}
    for name, path in records.items():
        scene = FAMILY[name.split("_")[0]]
        values = {"sweep": [name], **project.values_of(scene)}
        made = {"records": [path]}
        yield Job(accuracy_sweep, project.reads(scene), made, values, f"accuracy_{name}", **LONG)
    read = project.reads(*FAMILY.values()) | {"records": [*records.values()]}
    names = ["accuracy", "accuracy_orders", "accuracy_planner", "presets"]
    values = project.values_of(*FAMILY.values())
    yield Job(accuracy_tables, read, {"tables": project.tables(names)}, values)


def _turned(project: Project) -> Iterator[Job]:
    """Bodies of revolution: the table of them that the planner reads, and whether runs know their
    error.
    """
    rows, read = [project.result("accuracy/turned.csv")], project.reads(BASE)
    made = {"rows": rows, "table": project.tables(["accuracy_turned_planner"])}
    yield Job(accuracy_turned, read, made, **LONG)
    drawn = [project.result(f"accuracy/turned/{k}.csv") for k in range(PARTS)]
    for k, path in enumerate(drawn):
        name, which = f"accuracy_turned_drawn_{k}", {"part": [str(k)]}
        yield Job(accuracy_turned_drawn, read, {"rows": [path]}, which, name, **LONG)
    yield project.joined("accuracy_turned_table", "accuracy_turned", drawn)


def _shown(project: Project) -> Iterator[Job]:
    """Whether the errors that figures state are those of their curves."""
    finer = {name for name in project.coarse if name.startswith(tuple(MADE_FINER))}
    figures = [
        f for f in project.drawn if f.read_companions and finer.issuperset(f.read_companions)
    ]
    needs = list(dict.fromkeys(scene for figure in figures for scene in figure.needs))

    def path(scene: str) -> str:
        return project.result(f"accuracy/finer/{scene}/history.nc")

    for batch, names in project.batches().items():
        if scenes := [name for name in names if name in finer]:
            made, values = {"histories": [*map(path, scenes)]}, project.values_of(*scenes)
            name = f"accuracy_finer_{batch}"
            yield Job(accuracy_finer, project.reads(*scenes), made, values, name, mem_mb=3000)
    read = {
        "reference": [project.at("config/reference/thesis_numbers.csv")],
        "histories": project.histories(needs),
        "meshes": project.meshes(needs),
        "coarse": project.both_companions(scene for scene in needs if scene in project.coarse),
        "finer": [*map(path, sorted(finer))],
    }
    values = {"numbers": [figure.number for figure in figures]}
    made = {"data": project.tables(["accuracy_shown"])}
    yield Job(accuracy_shown, read, made, values, mem_mb=4000)

"""The jobs of pictures of what happens inside the pad, and of tables that compare."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.strain_energy_meanings import strain_energy_meanings
from cysyk1999.studies.views.frames import FRAMES
from cysyk1999.studies.views.picture import draw_views
from cysyk1999.studies.views.tables import table_pictures
from fingerpad.scenes.families import moves_along

OF_TABLES = {"scorecard": "thesis_comparison", "candidate_stimuli": "candidate_stimuli"}
"""Picture -> the table that it is drawn of."""


@part("views", in_default=True)
def views(project: Project) -> Iterator[Job]:
    """Pictures of what happens inside, of scenes that the configuration has, and of tables."""
    c = project.config
    known, scenes = {*c.every_scene, *c.field_scenes}, {n: s for n, (_, s) in FRAMES.items()}
    there = [name for name in scenes if known.issuperset(scenes[name])]
    for called, strokes in (("views_of_presses", False), ("views_of_strokes", True)):
        moves = {n: any(moves_along(project.scene(s)) for s in scenes[n]) for n in there}
        if names := [name for name in there if moves[name] == strokes]:
            needed = dict.fromkeys(scene for name in names for scene in scenes[name])
            read = {"histories": [project.full_history(scene) for scene in needed]}
            yield Job(draw_views, read, {"pictures": project.pictures(names)}, name=called)
    if names := [name for name, table in OF_TABLES.items() if table in c.table_names]:
        read = {
            "tables": project.tables(OF_TABLES[name] for name in names),
            "reference": [project.at("config/reference/thesis_numbers.csv")],
        }
        yield Job(table_pictures, read, {"pictures": project.pictures(names)})


@part("meanings", in_default=True)
def meanings(project: Project) -> Iterator[Job]:
    """The definitions of strain energy compared, if the configuration has the nine surfaces."""
    nine = project.of_families(project.config.scenes, "ramp40")
    if len(nine) >= 9:
        read = {"histories": project.histories(nine), "coarse": project.both_companions(nine)}
        made = {"picture": project.pictures(["strain_energy_meanings"])}
        yield Job(strain_energy_meanings, read, made)

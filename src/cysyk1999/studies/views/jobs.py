"""The jobs of pictures of what happens inside the pad, and of tables that compare."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.strain_energy_meanings import strain_energy_meanings
from cysyk1999.studies.views.run import FRAMES, draw_views
from cysyk1999.studies.views.tables import table_pictures
from fingerpad.scenes.families import moves_along

OF_TABLES = {"scorecard": "thesis_comparison", "candidate_stimuli": "candidate_stimuli"}
"""Picture -> the table that it is drawn of."""


@part("views", in_default=True)
def views(project: Project) -> Iterator[Job]:
    """Pictures of what happens inside, of scenes that the configuration has, and of tables."""
    known = {*project.config.every_scene, *project.config.field_scenes}
    jobs: dict[str, dict[str, tuple[str, ...]]] = {"views_of_presses": {}, "views_of_strokes": {}}
    for picture, (_, scenes) in FRAMES.items():
        if known.issuperset(scenes):
            strokes = any(moves_along(project.scene(scene)) for scene in scenes)
            jobs["views_of_strokes" if strokes else "views_of_presses"][picture] = scenes
    for name, scenes_of in jobs.items():
        if scenes_of:
            needed = dict.fromkeys(scene for scenes in scenes_of.values() for scene in scenes)
            read = {"histories": [project.full_history(scene) for scene in needed]}
            yield Job(draw_views, read, {"pictures": project.pictures(scenes_of)}, name=name)
    tables = project.config.table_names
    if pictures := [picture for picture, table in OF_TABLES.items() if table in tables]:
        read = {
            "tables": project.tables(OF_TABLES[picture] for picture in pictures),
            "reference": project.reference,
        }
        yield Job(table_pictures, read, {"pictures": project.pictures(pictures)})


@part("meanings", in_default=True)
def meanings(project: Project) -> Iterator[Job]:
    """The definitions of strain energy compared, if the configuration has the nine surfaces."""
    nine = project.of_families(project.config.scenes, "ramp40")
    if len(nine) >= 9:
        read = {"histories": project.histories(nine), "coarse": project.both_companions(nine)}
        made = {"picture": project.pictures(["strain_energy_meanings"])}
        yield Job(strain_energy_meanings, read, made)

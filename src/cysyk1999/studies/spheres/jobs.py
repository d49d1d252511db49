"""The jobs of what is round: four subjects as domes, and Goodwin's spheres."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.spheres.domes import PROBES, spheres_domes
from cysyk1999.studies.spheres.rates import spheres_rates

FIELD = "spheres_field_15_k340"


@part("spheres")
def spheres(project: Project) -> Iterator[Job]:
    """Domes fitted to forces of four subjects, and spheres on receptive fields: tables, pictures
    and specimens; about a quarter of an hour of one core.
    """

    def measured(*names: str) -> list[str]:
        return [project.at(f"src/fingerpad/benchmark/measured/{name}.csv") for name in names]

    pictures, data = ["forces"], [project.result("spheres/forces.csv")]
    read = {
        "unknowns": [project.at("config/spheres/dome.yaml")],
        "specimen": [project.thesis_specimen()],
        "forces": measured(*PROBES),
    }
    made = {
        "data": data[:1],
        "tables": project.tables(["spheres_domes", "spheres_sizes"]),
        "specimens": [project.result("spheres/specimens")],
    }
    yield Job(spheres_domes, read, made, runtime=60)
    scenes = project.of_families(project.config.every_scene, "spheres")
    if scenes:
        pictures, data = [*pictures, "field"], [*data, project.result("spheres/field.csv")]
        read = {
            "histories": project.histories(scenes),
            "held": measured("sa1_spheres"),
            "fields": measured("sa1_sphere_profiles"),
            "rapid": measured("fa1_spheres"),
            **project.reads(FIELD),
        }
        made = {"data": data[1:], "table": project.tables(["spheres_rates"])}
        yield Job(spheres_rates, read, made, project.values_of(FIELD))
    yield project.study_pictures("spheres", pictures, data, "cysyk1999.studies.spheres.picture")

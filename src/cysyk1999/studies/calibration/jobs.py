"""The jobs of the calibration: modulus and friction."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.calibration.force import calibrate_forces
from cysyk1999.studies.calibration.friction import (
    STROKE,
    calibrate_friction_job,
    strokes_with_friction,
)

RAMP, PLATE = "calibration_ramp_hold", "calibration_plate"


@part("calibration", in_default=True)
def calibration(project: Project) -> Iterator[Job]:
    """The pad calibrated to measured forces: figures, table and specimens."""
    c = project.config
    if not c.calibration_scenes:
        return

    def data(*names: str) -> list[str]:
        return [project.result(f"calibration/{name}.csv") for name in names]

    figures, tables = ["fit", "identifiability"], ["estimates"]
    read = {
        "forces": project.forces,
        "histories": project.histories(scene for scene in c.calibration_scenes if scene != RAMP),
        "coarse": project.companions([PLATE]),
    }
    made = {"data": data(*figures, *tables), "specimens": [project.result("specimens")]}
    yield Job(calibrate_forces, read, made, name="calibrate", priority=1)
    if c.friction_coefficients:
        strokes = {
            f"{mu:g}": project.result(f"friction/{mu:g}/history.nc")
            for mu in c.friction_coefficients
        }
        for k in (0, 1):  # two processes for two cores
            coefficients = list(strokes)[k::2]
            values = project.values_of(STROKE) | {"coefficients": coefficients}
            made = {"histories": [strokes[mu] for mu in coefficients]}
            name, more = f"strokes_with_friction_{k + 1}", {"mem_mb": 2000, "priority": 1}
            yield Job(strokes_with_friction, project.reads(STROKE), made, values, name, **more)
        read = {
            "thesis": [project.at("config/reference/thesis_numbers.csv")],
            "published": [project.at("config/reference/friction.csv")],
            "sweep": list(strokes.values()),
            "histories": project.histories(c.friction_scenes),
        }
        made = {"data": data("friction", "friction_estimates")}
        yield Job(calibrate_friction_job, read, made, name="calibrate_friction", priority=1)
        figures, tables = [*figures, "friction"], [*tables, "friction_estimates"]
    picture = "cysyk1999.studies.calibration.picture"
    yield project.study_pictures("calibration", figures, data(*figures), picture)
    yield project.joined("calibration_table", "calibration", data(*tables))

"""The jobs of the reconstruction: the pad that made the thesis's figures."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.reconstruction.design import reconstruction_design
from cysyk1999.studies.reconstruction.epidermis import reconstruction_epidermis
from cysyk1999.studies.reconstruction.picture import reconstruction_pictures
from cysyk1999.studies.reconstruction.run import reconstruction_inference

TABLES = ("posterior", "readings", "emulator", "recovery", "families")


@part("reconstruction")
def reconstruction(project: Project) -> Iterator[Job]:
    """The pad of 1999, inferred from the thesis's figures: tables and pictures; about an hour of
    one core.
    """
    evidence = {"evidence": [project.at("config/reference/reconstruction_evidence.csv")]}
    unknowns = {"unknowns": [project.at("config/reconstruction/unknowns.yaml")]}
    start = {"files": [project.at("config/specimens/long_term.yaml")]}
    records = {"records": [project.result("reconstruction/design.jsonl")]}
    design = {"design": [f"{project.config.studies}/reconstruction_design.csv"]}
    long = {"runtime": 180, "mem_mb": 2000}
    yield Job(reconstruction_design, unknowns | start, design, records, **long)
    tables = project.tables(f"reconstruction_{name}" for name in TABLES)
    names = ("samples", "predicted", "bands")
    parts = [project.result(f"reconstruction/{name}.csv") for name in names]
    made = {
        "tables": tables,
        "parts": parts,
        "specimen": [project.result("reconstruction/thesis.yaml")],
    }
    yield Job(reconstruction_inference, unknowns | start | evidence | design, made, **long)
    read = evidence | start | {"posterior": tables[:1]}
    made = {"table": project.tables(["reconstruction_epidermis"])}
    yield Job(reconstruction_epidermis, read, made, **long)
    read = unknowns | evidence | {"parts": parts[:2], "readings": tables[1:2]}
    made = {"pictures": project.pictures(["posterior", "evidence"], "reconstruction_")}
    yield Job(reconstruction_pictures, read, made)

"""The jobs of the reconstruction: the pad that made the thesis's figures."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.publishing.write import draw_study
from cysyk1999.studies.reconstruction.design import reconstruction_design
from cysyk1999.studies.reconstruction.picture import reconstruction_pictures
from cysyk1999.studies.reconstruction.run import reconstruction_inference
from cysyk1999.studies.reconstruction.ways import reconstruction_ways

DRAWN_APART = "cysyk1999.studies.reconstruction.shares"
TABLES = ("posterior", "readings", "energies", "emulator", "recovery", "families")


@part("reconstruction")
def reconstruction(project: Project) -> Iterator[Job]:
    """The pad of 1999, inferred from the thesis's figures: tables and pictures; about an hour of
    one core.
    """
    evidence = {"evidence": [project.at("config/reference/reconstruction_evidence.csv")]}
    unknowns = {"unknowns": [project.at("config/reconstruction/unknowns.yaml")]}
    start = {"files": [project.at("config/specimens/long_term.yaml")]}
    records = {"records": [project.result("reconstruction/design.jsonl")]}
    design = {"design": [project.result("reconstruction/design.csv")]}
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
    pad = {"files": [project.at("config/specimens/thesis.yaml")]}
    shares = {"data": [project.result("reconstruction/shares.csv")]}
    made = {"table": project.tables(["reconstruction_ways"])} | shares
    yield Job(reconstruction_ways, evidence | pad, made, **long)
    made, module = {"pictures": project.pictures(["shares"], "reconstruction_")}, DRAWN_APART
    yield Job(draw_study, shares, made, {"study": [module]}, "reconstruction_shares", (module,))
    read = unknowns | evidence | {"parts": parts[:2], "readings": tables[1:2]}
    made = {"pictures": project.pictures(["posterior", "evidence"], "reconstruction_")}
    yield Job(reconstruction_pictures, read, made)

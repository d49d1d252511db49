"""The jobs of the benchmark: predictions, then their picture and table."""

from __future__ import annotations

from collections.abc import Iterator

from cysyk1999.job import Job, part
from cysyk1999.project import Project
from cysyk1999.studies.benchmark.picture import draw_parity
from cysyk1999.studies.benchmark.run import predictions
from fingerpad.benchmark.rows import MEASURED


@part("benchmark", in_default=True)
def benchmark(project: Project) -> Iterator[Job]:
    """Published measurements against predictions: this model, a half-space, other models."""
    if "benchmark" not in project.config.table_names:
        return
    measured = sorted(map(str, MEASURED.glob("*.csv")))
    folder = project.result("benchmark")
    tables = [f"{folder}/{name}.csv" for name in ("fingerpad", "half-space", "touchsim", "scores")]
    others = sorted(map(str, (MEASURED.parent / "others").glob("*.csv")))
    read = {"measured": measured, "files": [*others, project.thesis_specimen()]}
    yield Job(predictions, read, {"predictions": tables}, runtime=20, mem_mb=1500)
    read = {"predictions": tables[:2], "scores": tables[-1:], "measured": measured}
    made = {"picture": project.pictures(["parity"]), "table": project.tables(["benchmark"])}
    yield Job(draw_parity, read, made)

"""A finished run as a Workflow Run RO-Crate (Leo and others 2024, PLoS ONE 19:e0309210).

``python -m cysyk1999.workflow.archive config/thesis.yaml results/archive`` copies inputs, code and
outputs into one folder. Its ``ro-crate-metadata.json`` says what made what of what; ``costs.csv``
says what it took.
"""

from __future__ import annotations

import base64
import json
import shutil
import sys
from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from pathlib import Path

import pandas as pd
import yaml
from rocrate.rocrate import ROCrate

from cysyk1999.config import read_config
from cysyk1999.job import Job
from cysyk1999.project import COMPANIONS, Project
from cysyk1999.publishing.tables import write_frame
from fingerpad.documents import SceneError, read_yaml

CODE = (
    "workflow",
    "profiles",
    "src",
    "setup.py",
    "pyproject.toml",
    "requirements.lock",
    "Makefile",
)
ABOUT = ("README.md", "LICENSE", "CITATION.cff")
PROFILES = (
    "https://w3id.org/ro/wfrun/process/0.5",
    "https://w3id.org/ro/wfrun/workflow/0.5",
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0",
)
LICENSE = "https://spdx.org/licenses/GPL-3.0-or-later"
SKIPPED = shutil.ignore_patterns("__pycache__", "*.egg-info", "*.pyc")

COSTS = {
    "wall time (s)": "wall_s",
    "process time (s)": "cpu_s",
    "memory (MB)": "peak_rss_MB",
    "nodes (1)": "nodes",
    "steps (1)": "steps",
    "iterations (1)": "newton_iterations",
}
"""Columns of ``costs.csv`` for a scene, and the keys of its summary."""

Finished = list[tuple[Job, Mapping]]
"""Jobs with Snakemake's record of each."""


class NotRun(ValueError):
    """There is no finished run to archive; one line."""


def archive(file: str | Path, out: str | Path) -> Path:
    """Write the crate of a configuration's finished run in the working directory.

    Parameters
    ----------
    file : path
        The configuration.
    out : path
        Folder of the crate; one that is there is replaced.

    Raises
    ------
    SceneError
        The configuration is wrong.
    NotRun
        A result is missing.
    """
    project = Project(read_config(read_yaml(Path(file)), file), file, ".")
    finished = finished_jobs(project)
    partial = Path(f"{out}.part")
    shutil.rmtree(partial, ignore_errors=True)
    for path in ("Snakefile", *CODE, *ABOUT, "config"):
        _copy(Path(path), partial)
    for job, _ in finished:
        for path in job.made:
            _copy(Path(path), partial)
    write_frame(costs(finished), partial / "costs.csv")
    _crate(str(file), finished, project.config.results, partial).write(partial)
    shutil.rmtree(out, ignore_errors=True)
    partial.rename(out)
    return Path(out)


def finished_jobs(project: Project) -> Finished:
    """Jobs of the default target with their records, in the order in which they ended."""
    makers = {path: job for job in project.jobs() for path in job.made}
    todo, jobs = sorted(project.default()), {}
    while todo:
        if (job := makers.get(todo.pop())) and job.name not in jobs:
            jobs[job.name] = job
            todo += job.read
    found = []
    for job in jobs.values():
        if missing := [path for path in job.made if not Path(path).exists()]:
            raise NotRun(f"{missing[0]} is not there; run the workflow first")
        record = _record(job.made[0])
        if record is None:
            raise NotRun(f"{job.made[0]} has no record of its job; run the workflow first")
        found.append((job, record))
    return sorted(found, key=lambda pair: pair[1]["endtime"])


def _record(path: str) -> dict | None:
    """What Snakemake recorded of the job that made a file."""
    name = base64.urlsafe_b64encode(path.encode()).decode()
    *folders, last = [name[k : k + 254] for k in range(0, len(name), 254)]
    file = Path(".snakemake/metadata", *(f"@{folder}" for folder in folders), last)
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def costs(finished: Finished) -> pd.DataFrame:
    """What every job took, and what each scene of a simulation took."""
    rows = []
    for job, record in finished:
        times = {"started": _time(record["starttime"]), "ended": _time(record["endtime"])}
        wall = record["endtime"] - record["starttime"]
        rows.append({"job": job.name} | times | {"wall time (s)": wall})
        for path in map(Path, job.made):
            if path.name == "summary.json":
                run = json.loads(path.read_text(encoding="utf-8"))["run"]
                scene = {"job": job.name, "scene": "/".join(path.parts[-3:-1])}
                rows.append(scene | {column: run[key] for column, key in COSTS.items()})
    return pd.DataFrame(rows)


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="seconds")


def _copy(path: Path, folder: Path) -> None:
    target = folder / path
    target.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        shutil.copytree(path, target, ignore=SKIPPED, dirs_exist_ok=True)
    elif path.exists():
        shutil.copy2(path, target)


def _crate(file: str, finished: Finished, results: str, folder: Path) -> ROCrate:
    """The crate of the files in a folder."""
    about = yaml.safe_load((folder / "CITATION.cff").read_text(encoding="utf-8"))
    crate = ROCrate()
    crate.name, crate.license = f"A run of {about['title']}", LICENSE
    crate.description = " ".join(about["abstract"].split())
    crate.root_dataset["conformsTo"] = [{"@id": profile} for profile in PROFILES]
    workflow = crate.add_workflow(
        folder / "Snakefile",
        "Snakefile",
        main=True,
        lang="snakemake",
        properties={"name": about["title"], "version": about["version"]},
    )
    parts = {}

    def add(path: str) -> None:
        if path not in parts:
            source = folder / path
            new = crate.add_directory if source.is_dir() else crate.add_file
            parts[path] = new(source, path, properties={"name": path})

    def home(path: str) -> str:
        """Where a result is listed: itself, or the folder of its scene."""
        own = Path(path).parent
        scene = own.is_relative_to(results) and own.parent.name in ("simulations", *COMPANIONS)
        return own.as_posix() if scene else path

    config = (p for p in (folder / "config").rglob("*") if p.is_file())
    inputs = sorted(path.relative_to(folder).as_posix() for path in config)
    outputs = list(dict.fromkeys(home(path) for job, _ in finished for path in job.made))
    copied = [path for path in (*CODE, *ABOUT) if (folder / path).exists()]
    for path in (*inputs, *copied, *outputs, "costs.csv"):
        add(path)

    def action(
        name: str, start: float, end: float, read: Iterable[str], made: Iterable[str]
    ) -> None:
        times = {"startTime": _time(start), "endTime": _time(end)}
        status = {"actionStatus": "http://schema.org/CompletedActionStatus"}
        entity = crate.add_action(
            workflow,
            identifier=f"#{name}",
            object=[parts[path] for path in dict.fromkeys(map(home, read)) if path in parts],
            result=[parts[path] for path in dict.fromkeys(map(home, made))],
            properties={"name": name} | times | status,
        )
        crate.root_dataset.append_to("mentions", entity)

    started = min(record["starttime"] for _, record in finished)
    action("run", started, finished[-1][1]["endtime"], inputs, [*outputs, "costs.csv"])
    for job, record in finished:
        action(f"job-{job.name}", record["starttime"], record["endtime"], job.read, job.made)
    return crate


def main(words: list[str]) -> int:
    """Write an archive; exit code 2, in one line, if nothing was run."""
    if len(words) != 2:
        print("usage: python -m cysyk1999.workflow.archive CONFIG.yaml FOLDER", file=sys.stderr)
        return 2
    try:
        print(archive(*words))
    except (SceneError, NotRun) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

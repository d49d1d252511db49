"""A finished run as a Workflow Run RO-Crate: ``python -m cysyk1999.workflow.archive
config/thesis.yaml results/archive``.

Inputs, code, outputs, what made what of what, and what it took, in one folder. Its
``ro-crate-metadata.json`` says what is in it, by the profiles Workflow RO-Crate 1.0 and Process and
Workflow Run Crate 0.5 (Leo and others 2024, PLoS ONE 19:e0309210).
"""

from __future__ import annotations

import base64
import hashlib
import json
import shutil
import sys
from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path

import pandas as pd
import yaml

from cysyk1999.config import read_config
from cysyk1999.publishing.write import write_frame
from cysyk1999.workflow.products import COMPANIONS, PARTS, Job, Products
from fingerpad.documents import SceneError, read_yaml
from fingerpad.files import write_text

CODE = (
    "Snakefile",
    "workflow",
    "profiles",
    "src",
    "setup.py",
    "pyproject.toml",
    "requirements.lock",
    "Makefile",
)
ABOUT = ("README.md", "LICENSE", "CITATION.cff")
PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
CONTEXT = [
    "https://w3id.org/ro/crate/1.1/context",
    {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"},
]
SNAKEMAKE = "https://w3id.org/workflowhub/workflow-ro-crate#snakemake"
LICENSE = "https://spdx.org/licenses/GPL-3.0-or-later"
BIOSCHEMAS = "https://bioschemas.org/profiles/{}/1.0-RELEASE"
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.egg-info", "*.pyc")
KINDS = {
    ".csv": "text/csv",
    ".png": "image/png",
    ".gif": "image/gif",
    ".md": "text/markdown",
    ".yaml": "application/yaml",
}


class NotRun(ValueError):
    """There is no finished run to archive; one line."""


def archive(file: str | Path, out: str | Path) -> Path:
    """Write the crate of a configuration's finished run, made by the workflow in the working
    directory, into the folder `out`.

    Raises:
        SceneError: the configuration is wrong. NotRun: a result is missing. One line.
    """
    config = read_config(read_yaml(Path(file)), file)
    products = Products(config, file, ".")
    finished = _finished(products)
    partial = Path(f"{out}.part")
    shutil.rmtree(partial, ignore_errors=True)
    for path in (*CODE, *ABOUT, "config"):
        _take(Path(path), partial)
    placed = {
        path: _place(path, partial, config.results) for _, _, paths in finished for path in paths
    }
    costs = _costs(finished)
    write_frame(costs, partial / "costs.csv")
    graph = list(_graph(str(file), finished, placed, partial))
    crate = {"@context": CONTEXT, "@graph": graph}
    write_text(
        partial / "ro-crate-metadata.json", json.dumps(crate, indent=1, ensure_ascii=False) + "\n"
    )
    shutil.rmtree(out, ignore_errors=True)
    partial.rename(out)
    return Path(out)


# -- what was run --------------------------------------------------------------------------------------------------------------


def _finished(products: Products) -> list[tuple[Job, Mapping, list[str]]]:
    """Jobs of the default target in the order they ended: with Snakemake's record of each, and what
    it made.
    """
    default = {
        *products.targets("catalogue", *PARTS, figures=""),
        *products.histories(products.config.scenes),
    }
    makers = {path: job for job in products.jobs() for path in _made(job)}
    todo, jobs = sorted(default), {}
    while todo:
        path = todo.pop()
        if (job := makers.get(path)) and job.name not in jobs:
            jobs[job.name] = job
            todo += [read for paths in job.inputs.values() for read in paths]
    found = []
    for job in jobs.values():
        made = _made(job)
        if missing := [path for path in made if not Path(path).exists()]:
            raise NotRun(f"{missing[0]} is not there; run the workflow first")
        record = _record(made[0])
        if record is None:
            raise NotRun(
                f"{made[0]} was not made by the workflow here (no record of its job); run the workflow first"
            )
        found.append((job, record, made))
    return sorted(found, key=lambda each: each[1]["endtime"])


def _made(job: Job) -> list[str]:
    return [*(path for paths in job.outputs.values() for path in paths), *job.beside]


def _record(path: str) -> dict | None:
    """What Snakemake has kept of the job that made a file."""
    name = base64.urlsafe_b64encode(path.encode()).decode()
    step = 255 - 1
    parts = [name[k : k + step] for k in range(0, len(name), step)]
    file = Path(".snakemake/metadata", *(f"@{part}" for part in parts[:-1]), parts[-1])
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None


def _costs(finished: Iterable[tuple[Job, Mapping, list[str]]]) -> pd.DataFrame:
    """What every job took, and of simulations what each scene did."""
    rows = []
    for job, record, made in finished:
        took = {
            "job": job.name,
            "started": _time(record["starttime"]),
            "ended": _time(record["endtime"]),
        }
        rows.append(took | {"wall time (s)": record["endtime"] - record["starttime"]})
        for path in made:
            if path.endswith("summary.json"):
                run = json.loads(Path(path).read_text(encoding="utf-8"))["run"]
                scene = {
                    "job": job.name,
                    "scene": "/".join(Path(path).parts[-3:-1]),
                    "wall time (s)": run["wall_s"],
                }
                scene |= {
                    "process time (s)": run["cpu_s"],
                    "memory (MB)": run["peak_rss_MB"],
                    "nodes (1)": run["nodes"],
                }
                rows.append(
                    scene | {"steps (1)": run["steps"], "iterations (1)": run["newton_iterations"]}
                )
    return pd.DataFrame(rows)


def _time(seconds: float) -> str:
    return datetime.fromtimestamp(seconds, UTC).isoformat(timespec="seconds")


# -- files ---------------------------------------------------------------------------------------------------------------------


def _take(path: Path, folder: Path) -> None:
    target = folder / path
    target.parent.mkdir(parents=True, exist_ok=True)
    if path.is_dir():
        shutil.copytree(path, target, ignore=LEFT_OUT, dirs_exist_ok=True)
    elif path.exists():
        shutil.copy2(path, target)


def _place(path: str, folder: Path, results: str) -> str:
    """Take a result; its entity in the crate: itself, or the folder of the scene it belongs to."""
    _take(Path(path), folder)
    own = Path(path).parent
    if own.is_relative_to(results) and own.parent.name in ("simulations", *COMPANIONS):
        return f"{own.as_posix()}/"
    return f"{path}/" if Path(path).is_dir() else path


# -- the graph -----------------------------------------------------------------------------------------------------------------


def _ref(*ids: str) -> list[dict[str, str]]:
    return [{"@id": each} for each in dict.fromkeys(ids)]


def _graph(
    file: str,
    finished: list[tuple[Job, Mapping, list[str]]],
    placed: Mapping[str, str],
    folder: Path,
) -> Iterator[dict]:
    about = yaml.safe_load((folder / "CITATION.cff").read_text(encoding="utf-8"))
    ended, started = (
        finished[-1][1]["endtime"],
        min(record["starttime"] for _, record, _ in finished),
    )
    inputs = sorted(
        p.relative_to(folder).as_posix() for p in (folder / "config").rglob("*") if p.is_file()
    )
    code = [path for path in (*CODE, *ABOUT) if (folder / path).is_file() and path != "Snakefile"]
    folders = [f"{path}/" for path in CODE if (folder / path).is_dir()]
    outputs = list(dict.fromkeys(placed.values()))
    jobs = sorted({f"src/cysyk1999/workflow/jobs/{job.run}.py" for job, _, _ in finished})
    parts = ["Snakefile", *inputs, *code, *folders, *jobs, *outputs, "costs.csv"]
    actions = [f"#job-{job.name}" for job, _, _ in finished]
    yield {
        "@id": "ro-crate-metadata.json",
        "@type": "CreativeWork",
        "about": {"@id": "./"},
        "conformsTo": _ref(
            "https://w3id.org/ro/crate/1.1", "https://w3id.org/workflowhub/workflow-ro-crate/1.0"
        ),
    }
    yield {
        "@id": "./",
        "@type": "Dataset",
        "name": f"A run of {about['title']}",
        "description": " ".join(about["abstract"].split()),
        "datePublished": _time(ended)[:10],
        "license": {"@id": LICENSE},
        "author": _ref("#developers"),
        "publisher": {"@id": "#developers"},
        "conformsTo": _ref(*PROFILES),
        "mainEntity": {"@id": "Snakefile"},
        "hasPart": _ref(*parts),
        "mentions": _ref("#run", *actions),
    }
    for profile, (name, version) in PROFILES.items():
        yield {"@id": profile, "@type": "CreativeWork", "name": name, "version": version}
    yield {
        "@id": LICENSE,
        "@type": "CreativeWork",
        "name": about["license"],
        "url": LICENSE,
        "identifier": about["license"],
        "description": "GNU General Public License, version 3 or later",
    }
    yield {"@id": "#developers", "@type": "Organization", "name": about["authors"][0]["name"]}
    yield from _workflow(file, about)
    yield {
        "@id": "#run",
        "@type": "CreateAction",
        "name": f"Run of {file}",
        "description": f"Snakemake made the default target of {file}: {len(finished)} jobs",
        "instrument": {"@id": "Snakefile"},
        "agent": {"@id": "#developers"},
        "startTime": _time(started),
        "endTime": _time(ended),
        "actionStatus": "http://schema.org/CompletedActionStatus",
        "object": _ref(*inputs),
        "result": _ref(*outputs, "costs.csv"),
    }
    known = set(parts)
    for (job, record, made), action in zip(finished, actions, strict=True):
        read = [placed.get(path, path) for paths in job.inputs.values() for path in paths]
        yield {
            "@id": action,
            "@type": "CreateAction",
            "name": job.name,
            "description": f"Job {job.name} of the workflow",
            "instrument": {"@id": f"src/cysyk1999/workflow/jobs/{job.run}.py"},
            "agent": {"@id": "#developers"},
            "startTime": _time(record["starttime"]),
            "endTime": _time(record["endtime"]),
            "actionStatus": "http://schema.org/CompletedActionStatus",
            "object": _ref(*(path for path in read if path in known)),
            "result": _ref(*(placed[path] for path in made)),
        }
    for path in jobs:
        yield {
            "@id": path,
            "@type": ["File", "SoftwareSourceCode"],
            "name": Path(path).name,
            "encodingFormat": "text/x-python",
            "version": about["version"],
            "description": f"What jobs of the kind {Path(path).stem} do",
        }
    for path in folders:
        yield {
            "@id": path,
            "@type": "Dataset",
            "name": path,
            "description": f"Code of the workflow: {path}",
        }
    for path in (*inputs, *code, *outputs):
        yield _data(
            path, folder, {file: {"exampleOfWork": {"@id": "#configuration"}}}.get(path, {})
        )
    yield _data("costs.csv", folder, {"exampleOfWork": {"@id": "#costs"}}) | {
        "description": "What every job and scene took"
    }


def _workflow(file: str, about: Mapping) -> Iterator[dict]:
    yield {
        "@id": "Snakefile",
        "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"],
        "name": about["title"],
        "description": " ".join(about["abstract"].split()),
        "version": about["version"],
        "license": {"@id": LICENSE},
        "author": _ref("#developers"),
        "creator": _ref("#developers"),
        "programmingLanguage": {"@id": SNAKEMAKE},
        "encodingFormat": "text/x-python",
        "conformsTo": {"@id": BIOSCHEMAS.format("ComputationalWorkflow")},
        "input": _ref("#configuration"),
        "output": _ref("#costs"),
    }
    yield {
        "@id": SNAKEMAKE,
        "@type": "ComputerLanguage",
        "name": "Snakemake",
        "url": {"@id": "https://snakemake.readthedocs.io"},
        "identifier": {"@id": "https://doi.org/10.1093/bioinformatics/bts480"},
    }
    for name, what, example in (
        ("configuration", "What is simulated and drawn", file),
        ("costs", "What it took", "costs.csv"),
    ):
        yield {
            "@id": f"#{name}",
            "@type": "FormalParameter",
            "name": name,
            "description": what,
            "additionalType": "File",
            "workExample": {"@id": example},
            "conformsTo": {"@id": BIOSCHEMAS.format("FormalParameter")},
        }


def _data(path: str, folder: Path, more: Mapping) -> dict:
    """The entity of an input or output."""
    if path.endswith("/"):
        return {
            "@id": path,
            "@type": "Dataset",
            "name": path,
            "description": f"Results: {path}",
        } | more
    kind = KINDS.get(Path(path).suffix, "text/plain")
    data = (folder / path).read_bytes()
    described = {"README.md": {"about": {"@id": "./"}}}.get(path, {})
    return (
        {
            "@id": path,
            "@type": "File",
            "name": Path(path).name,
            "description": path,
            "encodingFormat": kind,
            "contentSize": str(len(data)),
            "sha256": hashlib.sha256(data).hexdigest(),
        }
        | described
        | more
    )


def main(words: list[str]) -> int:
    """Write an archive; exit code 2 if there is nothing to write it of, in one line."""
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

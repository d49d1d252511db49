"""A rule for every job, and a target for every part, that the package's modules `jobs` declare.

A rule's inputs also hold a list of the source files that the job imports, with their digests, and the environment as it was
installed: an edit reruns what it can change. One list stands for a hundred files, which Snakemake would read for every job.
"""

import os
import shlex
from pathlib import Path

from cysyk1999.job import parts
from fingerpad.files import write_text

# The environment as the Makefile installed it, else as it is locked.
INSTALLED = ROOT / ".venv" / "installed.lock"
ENVIRONMENT = os.path.relpath(INSTALLED if INSTALLED.exists() else ROOT / "requirements.lock")


def marked(job):
    """The outputs of a job by key: pages for the report, histories as never empty."""
    for key, paths in job.outputs.items():
        if key == "pages":
            paths = [report(p, category=job.category, labels=dict(job.labels[p])) for p in paths]
        if key == "histories":
            paths = ensure(paths, non_empty=True)
        yield key, directory(paths) if key == "specimens" else paths


def command(job):
    """The shell command of a job, once its files are known."""

    def words(wildcards, input, output):
        places = {"input": input, "output": output}
        start = ["env", f"FINGERPAD_VECTORS={job.pdf}"] if job.pdf else []
        start += [sys.executable, "-m", "cysyk1999.workflow", f"{job.do.__module__}:{job.kind}"]
        start += ["--log", log_of(job)]
        for place, key in job.words:
            values = job.values[key] if place == "params" else places[place].get(key)
            start += [f"--{key}", *([values] if isinstance(values, str) else values)]
        return shlex.join(map(str, start))

    return words


def code_of(job):
    """The job's list of sources, written only where one of them has changed."""
    path = Path(PROJECT.result(f"code/{job.name}.txt"))
    if not (path.exists() and path.read_text(encoding="utf-8") == job.code):
        write_text(path, job.code)
    return str(path)


def log_of(job):
    return PROJECT.result(f"logs/{job.name}.log")


for job in PROJECT.jobs():

    rule:
        name:
            job.name
        input:
            code_of(job),
            ENVIRONMENT,
            **{key: ancient(paths) if key == "scene_files" else paths for key, paths in job.inputs.items()},
        output:
            *job.beside,
            **dict(marked(job)),
        params:
            **job.values,
            command=command(job),
        log:
            log_of(job),
        priority: job.priority
        threads: job.threads
        resources:
            mem_mb=job.mem_mb,
            runtime=job.runtime,
        shell:
            "{params.command}"

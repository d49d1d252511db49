"""A rule for every job of the configuration: cysyk1999.workflow.products says what each reads and writes, its module what it does.

Inputs beside those are a list of the package's files that the job imports, found by following imports, with their digests, and the
environment as it was installed: by content, so that an edit reruns what it can change. One list in place of a hundred files, which
Snakemake would all read again for every job.
"""

import os
import shlex
from importlib.util import find_spec
from pathlib import Path

from fingerpad.files import write_text

# The environment as it was installed by the Makefile, else as it is locked: a changed package reruns what uses it.
INSTALLED = ROOT / ".venv" / "installed.lock"
ENVIRONMENT = os.path.relpath(INSTALLED if INSTALLED.exists() else ROOT / "requirements.lock")


def shown(job):
    """The outputs of a job by their keys, marked for the report, histories as never empty."""
    for key, paths in job.outputs.items():
        flags = [(path, job.reported(key, path)) for path in paths]
        marked = [report(path, **how) if how else path for path, how in flags]
        yield key, ensure(marked, non_empty=True) if key == "histories" else directory(marked) if key == "specimens" else marked


def command(job):
    """The shell command of a job once its files are known, files and parameters by their keys."""

    def told(wildcards, input, output):
        given = {"input": input, "output": output}
        words = ["env", f"FINGERPAD_VECTORS={job.vectors}"] if job.vectors else []
        words += [sys.executable, "-m", "cysyk1999.workflow", job.run, "--log", log_of(job)]
        for place, key in job.words:
            values = job.values[key] if place == "params" else given[place].get(key)
            words += [f"--{key}", *([values] if isinstance(values, str) else values)]
        return shlex.join(map(str, words))

    return told


def code_of(job):
    """The job's list of sources, written anew only where one of them has changed."""
    path = Path(PRODUCTS.result(f"code/{job.name}.txt"))
    if not (path.exists() and path.read_text(encoding="utf-8") == job.code):
        write_text(path, job.code)
    return str(path)


def log_of(job):
    return PRODUCTS.result(f"logs/{job.name}.log")


for job in PRODUCTS.jobs():

    rule:
        name:
            job.name
        input:
            code_of(job),
            ENVIRONMENT,
            **{key: ancient(paths) if key == "scene_files" else paths for key, paths in job.inputs.items()},
        output:
            *job.beside,
            **dict(shown(job)),
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


def peers_if_installed(wildcards):
    """The table, or nothing but a line that says why."""
    if find_spec("felupe"):
        return PRODUCTS.targets("peers")
    print("peers: FElupe is not installed, so there is nothing to compare with; pip install -e .[peers]", file=sys.stderr)
    return []

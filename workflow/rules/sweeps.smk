"""A sweep: batches of its scenes, each in one process, then one dataset and one table.

Inputs:  sweep.json, design.json, todo/<batch>.json (`fingerpad.sweeps.engine`).
Outputs: batches/<batch>.jsonl, sweep.nc, sweep.csv.

`fingerpad sweep FILE --out DIR --profile PROFILE` lays a folder out and runs these rules in it; so
does `snakemake sweep --config sweep=FILE [sweep_out=DIR]` through the project's Snakefile.
"""

import shlex
import sys
from pathlib import Path

from fingerpad.sweeps.engine import held, lay_out, read_layout
from fingerpad.sweeps.forecast import SECONDS_PROCESS

if "sweep" in config and workflow.is_main_process:
    from fingerpad.documents import SceneError
    from fingerpad.sweeps.language import load_sweep

    try:
        read = load_sweep(config["sweep"])
        folder = Path(config.get("sweep_out", f"results/sweeps/{read.name}"))
        held_folder = held(folder)
        held_folder.__enter__()  # for as long as this process lives
        SWEEP = lay_out(read, folder, workflow.resource_settings.cores or 1)
    except SceneError as error:  # one line, without Snakemake's words round it
        print(error, file=sys.stderr)
        sys.exit(2)
else:
    stem = Path(config["sweep"]).stem if "sweep" in config else ""
    SWEEP = read_layout(config.get("sweep_out", f"results/sweeps/{stem}") if stem else ".")

HERE = SWEEP.folder
TELL = ">{log:q} 2>&1 || {{ echo \"{rule}: $(tail -n 1 {log:q})\" >&2; exit 1; }}"
"""All output goes into the log; a failed job shows its last line."""


def predicted(wildcards, attempt):
    """Minutes of a batch: thrice the plan's prediction; twice as much at each retry."""
    seconds = SECONDS_PROCESS + SWEEP.batches[wildcards.batch]["cost_s"]
    return int((3 * seconds / 60 + 5) * 2 ** (attempt - 1))


def needed(wildcards, attempt):
    """Memory (MB) of a batch, with a third to spare; twice as much at each retry."""
    return int(4 / 3 * SWEEP.batches[wildcards.batch]["memory_MB"] * 2 ** (attempt - 1))


localrules:
    sweep,
    sweep_collect,


rule sweep:
    """Every scene of a sweep, as a dataset and a table."""
    input:
        HERE / "sweep.nc",
        HERE / "sweep.csv",


rule sweep_batch:
    input:
        HERE / "todo/{batch}.json",
    output:
        HERE / "batches/{batch}.jsonl",
    log:
        HERE / "logs/{batch}.log",
    resources:
        mem_mb=needed,
        runtime=predicted,
    params:
        python=shlex.quote(sys.executable),
    shell:
        "{params.python} -m fingerpad.sweeps batch {input:q} {output:q} " + TELL


rule sweep_collect:
    input:
        HERE / "design.json",
        [HERE / name for name in SWEEP.known],
        [HERE / f"batches/{name}.jsonl" for name in SWEEP.batches],
    output:
        dataset=HERE / "sweep.nc",
        table=HERE / "sweep.csv",
    log:
        HERE / "logs/collect.log",
    params:
        python=shlex.quote(sys.executable),
        folder=HERE,
        digest=SWEEP.digest,
    shell:
        "{params.python} -m fingerpad.sweeps collect {params.folder:q} "
        "{output.dataset:q} {output.table:q} " + TELL

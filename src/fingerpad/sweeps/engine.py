"""The folder of a sweep, its division into batches, and the processes that run them.

    sweep.json               batches with their predicted cost and memory, and earlier records
    design.json              dimensions, parameters, and the key (a digest) of each scene
    todo/<batch>.json        the scenes of a batch
    batches/<batch>.jsonl    their records, .part while the batch runs
    histories/<key>.nc       where histories are kept
    logs/<batch>.log         what the processes print
    sweep.nc, sweep.csv      the result

Batches run in processes of this machine, or on a cluster through Snakemake. The name of a batch is
a digest of its scenes, so a rerun finds what was run before, whatever else has changed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import xarray as xr

from fingerpad.documents import SceneError
from fingerpad.files import BUILT_IN, InUse, disk_is_full, locked, unusable, write_text
from fingerpad.results import provenance
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.sweeps.design import Design
from fingerpad.sweeps.forecast import divided, forecast
from fingerpad.sweeps.language import Read, load_sweep
from fingerpad.sweeps.records import UNFINISHED, Writer, code, key_of, read_records

RULES = next(
    path
    for path in (BUILT_IN / "sweeps.smk", BUILT_IN.parent / "workflow" / "rules" / "sweeps.smk")
    if path.exists()
)
"""The Snakemake rules of a sweep, which the project's Snakefile includes."""
JOB = [sys.executable, "-P", "-m", "fingerpad.sweeps"]
"""The command of a batch or a collection."""
MOST_TRIES = 3
"""Processes that are started for a batch before it counts as failed."""


class SweepError(SceneError):
    """The sweep cannot be run like this; one line."""


class NotFinished(RuntimeError):
    """A sweep did not come to its end; one line. What was done is kept."""


@dataclass(frozen=True)
class Layout:
    """What is to be done for a sweep in a folder.

    Attributes
    ----------
    folder : Path
        The sweep's folder.
    name, digest : str
        The sweep's name, and a digest of its scenes.
    batches : dict
        Name -> scenes (count), cost_s, memory_MB.
    known : list of str
        Files with records of earlier layouts, relative to `folder`.
    scenes, missing : int
        Number of scenes, and of those in `batches`.
    """

    folder: Path
    name: str
    digest: str
    batches: Mapping[str, Mapping[str, float]]
    known: list[str]
    scenes: int
    missing: int

    def done(self) -> dict[str, int]:
        """How many of the missing scenes are ``completed``, and how many of these ``failed``."""
        completed = failed = 0
        for name in self.batches:
            for ending in (".jsonl", UNFINISHED):
                with contextlib.suppress(OSError):
                    text = (self.folder / "batches" / f"{name}{ending}").read_bytes()
                    completed += text.count(b"\n")
                    failed += text.count(b"\n") - text.count(b'"diagnosis": ""')
                    break
        return {"completed": completed, "failed": max(failed, 0)}


def read_layout(folder: str | Path) -> Layout:
    """The layout in a folder. Raises SweepError if there is none."""
    try:
        content = json.loads((Path(folder) / "sweep.json").read_text(encoding="utf-8"))
        return Layout(Path(folder), **content)
    except (OSError, ValueError, TypeError):
        raise SweepError(f"{folder}: holds no sweep; allowed: the folder of a sweep") from None


def lay_out(
    read: Read,
    folder: Path,
    cores: int,
    force: bool = False,
    again: bool = False,
    progress: Callable[..., object] | None = None,
) -> Layout:
    """Check and plan every scene of a sweep; divide those without a record into batches.

    Parameters
    ----------
    read : Read
        The sweep.
    folder : Path
        Its folder.
    cores : int
        Processes at a time, for which the batches are made.
    force : bool
        Use the folder though it holds another sweep.
    again : bool
        Also run scenes again that failed before.
    progress : callable, optional
        Called with ``completed``, the number of scenes that are planned.

    Raises
    ------
    SceneError
        A scene is wrong or cannot be planned; one line, and nothing was written.
    SweepError
        The folder holds another sweep, or has no room; likewise.
    """
    before = None
    with contextlib.suppress(SweepError):
        before = read_layout(folder)
    if before and before.name != read.name and not force:
        raise SweepError(
            f"--out: '{folder}' holds the sweep '{before.name}'; "
            "allowed: another --out, or --force to replace it"
        )
    design = Design(read)
    design.check()
    keep, histories = read.sweep.keep, read.sweep.histories
    keys = [key_of(scene, keep, histories) for scene in design]
    described = _described(design, keys)
    digest = _digest([described["dimensions"], described["parameters"], keys])
    if before and not again and (before.name, before.digest) == (read.name, digest):
        if all((folder / name).exists() for name in before.known):
            return before
    expected = forecast(design, progress).scenes
    known = _known_records(folder, again)
    first = {key: number for number, key in reversed(list(enumerate(keys)))}
    missing = sorted(number for key, number in first.items() if key not in known)
    needed = expected.result_bytes[missing].sum()
    if folder.is_dir() and disk_is_full(folder, needed):
        raise SweepError(
            f"--out: '{folder}' has no room for about {needed / 1e6:.2g} MB of results; "
            "allowed: a folder that has"
        )
    base = read.base.model_dump(mode="json")
    if read.base.specimen.mesh is not None:  # batches run in other folders
        base["specimen"]["mesh"] = str(read.base.specimen.mesh.absolute())
    batches = {}
    for numbers in divided(missing, expected.cost_s.tolist(), cores):
        name = _digest([keys[n] for n in numbers] + [again])[:12]
        batches[name] = {
            "scenes": len(numbers),
            "cost_s": round(float(expected.cost_s[numbers].sum()), 3),
            "memory_MB": round(expected.memory_MB[numbers].max()),
        }
        scenes = [[n, keys[n], design.changes(n)] for n in numbers]
        batch = {"base": base, "keep": list(keep), "histories": histories, "scenes": scenes}
        write_text(folder / "todo" / f"{name}.json", json.dumps(batch))
        # records under this name can only be failures that are tried again
        (folder / "batches" / f"{name}.jsonl").unlink(missing_ok=True)
    write_text(folder / "design.json", json.dumps(described))
    content: dict[str, Any] = {
        "name": read.name,
        "digest": digest,
        "batches": batches,
        "known": sorted({known[key] for key in first if key in known}),
        "scenes": len(keys),
        "missing": len(missing),
    }
    write_text(folder / "sweep.json", json.dumps(content, indent=1) + "\n")
    return Layout(folder, **content)


def _known_records(folder: Path, again: bool) -> dict[str, str]:
    """Key of every scene with a record in a folder -> the file; without failures where `again`."""
    known: dict[str, str] = {}
    for file in sorted((folder / "batches").glob("*")):
        if file.suffix == UNFINISHED:
            Writer(file).close()  # removes a line that was cut off
            file = file.replace(file.with_name(f"{file.stem}-kept.jsonl"))
        if file.suffix == ".jsonl":
            for record in read_records(file):
                if not (again and record["diagnosis"]):
                    known.setdefault(record["key"], file.relative_to(folder).as_posix())
    return known


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def _described(design: Design, keys: list[str]) -> dict[str, Any]:
    """The content of design.json; "about" becomes the attributes of the dataset."""
    read = design.read
    sweep = read.sweep.model_dump(mode="json", exclude={"over", "scene"}, exclude_none=True)
    sweep["over"] = {
        key: axis.model_dump(mode="json", exclude_none=True)
        for key, axis in read.sweep.over.items()
    }
    about = {
        "title": f"fingerpad sweep {read.name}",
        "sweep": json.dumps(sweep),
        "base_scene": json.dumps(read.base.canonical()),
        "provenance": json.dumps(provenance()),
        "code": code(),
        "Conventions": "CF-1.11",
    }
    parameters = [vars(p) for p in design.parameters]
    return {"dimensions": design.dimensions, "parameters": parameters, "keys": keys, "about": about}


@contextlib.contextmanager
def held(folder: Path) -> Iterator[tuple[int, ...]]:
    """Make a sweep's folder and lock it for this process; yields the lock's descriptors.

    Raises SweepError.
    """
    path = str(folder.absolute())
    if wrong := unusable(Path(path)) or ("braces" if set("{}") & set(path) else ""):
        raise SweepError(f"--out: '{folder}' has {wrong} in its name; allowed: a folder without")
    folder.mkdir(parents=True, exist_ok=True)
    try:
        with locked(folder) as lock:
            yield lock
    except InUse:
        raise SweepError(
            f"'{folder}' is being written by another sweep; allowed: another folder, or later"
        ) from None


def run_layout(
    layout: Layout,
    cores: int,
    profile: str | None = None,
    watch: Callable[..., object] | None = None,
    lock: tuple[int, ...] = (),
) -> None:
    """Run the batches of a sweep and collect them.

    Parameters
    ----------
    layout : Layout
        What is to be run.
    cores : int
        Processes at a time.
    profile : str, optional
        Folder of a Snakemake profile, for a cluster; without one, processes of this machine.
    watch : callable, optional
        Called now and then with `Layout.done`.
    lock : tuple of int
        Descriptors that lock the folder (`held`). Processes that outlive this one keep the lock.

    Raises
    ------
    SweepError
        A profile is given, but Snakemake is not installed.
    NotFinished
        A batch or the collection failed for good. What was done is kept.
    KeyboardInterrupt
        Likewise.
    """
    folder = layout.folder
    (folder / "logs").mkdir(exist_ok=True)

    def run(jobs: Mapping[str, list[Any]], **how: Any) -> str:
        return _run_jobs(folder, jobs, lambda: watch and watch(**layout.done()), lock, **how)

    if profile:
        problem = run({"snakemake": _snakemake(profile)}, tries=1, cwd=folder)
    else:
        files = {name: folder / "batches" / f"{name}.jsonl" for name in layout.batches}
        batches = {
            name: [*JOB, "batch", folder / "todo" / f"{name}.json", file]
            for name, file in files.items()
            if not file.exists()
        }
        results = [folder, folder / "sweep.nc", folder / "sweep.csv"]
        problem = run(batches, cores=cores) or run({"collect": [*JOB, "collect", *results]})
    if problem:
        done = layout.scenes - layout.missing + layout.done()["completed"]
        raise NotFinished(
            f"{done} of {layout.scenes} scenes are done and kept; {problem}; "
            "the same command goes on from there"
        )


def _snakemake(profile: str) -> list[str]:
    """The command that runs a sweep by a profile, in the sweep's folder."""
    if find_spec("snakemake") is None:
        raise SweepError(
            "--profile: Snakemake is not installed; allowed: pip install 'fingerpad[workflow]', "
            "or no --profile"
        )
    words = [sys.executable, "-P", "-m", "snakemake", "--snakefile", str(RULES)]
    words += ["--rerun-incomplete", "--keep-going", "--nocolor", "--nolock"]
    return [*words, "--workflow-profile", str(Path(profile).absolute()), "sweep"]


def _run_jobs(
    folder: Path,
    jobs: Mapping[str, list[Any]],
    show: Callable[[], object],
    lock: tuple[int, ...],
    cores: int = 1,
    tries: int = MOST_TRIES,
    cwd: Path | None = None,
) -> str:
    """Run commands, some at a time, each with its log; returns the last line of one that failed."""
    waiting, started, problem = list(jobs), Counter[str](), ""
    running: dict[str, subprocess.Popen] = {}
    try:
        while waiting or running:
            while waiting and len(running) < cores:
                name = waiting.pop(0)
                started[name] += 1
                with (folder / "logs" / f"{name}.log").open("w", encoding="utf-8") as log:
                    running[name] = subprocess.Popen(
                        list(map(str, jobs[name])),
                        cwd=cwd,
                        stdin=subprocess.DEVNULL,
                        stdout=log,
                        stderr=log,
                        start_new_session=True,
                        pass_fds=lock,
                    )
            show()
            time.sleep(0.1)
            for name in [name for name, process in running.items() if process.poll() is not None]:
                if not running.pop(name).returncode:
                    continue
                if started[name] < tries:
                    waiting.append(name)
                else:
                    problem = f"{name}: {_last_line(folder / 'logs' / f'{name}.log')}"
        show()
    finally:
        for end in (signal.SIGINT, signal.SIGTERM):  # on the first, Snakemake cancels its jobs
            for process in running.values():
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, end)
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(timeout=30)
    return problem


def _last_line(log: Path) -> str:
    """The last line of a log, or of the job of Snakemake's that failed; and where the rest is."""
    lines = log.read_text(encoding="utf-8", errors="replace").split("\n")
    lines = [line.strip() for line in lines if line.strip()]
    jobs = [line for line in lines if line.startswith(("sweep_batch:", "sweep_collect:"))]
    last = (jobs or lines or ["it failed"])[-1]
    return f"{last[:300]} (all of it: {log.absolute()})"


def sweep(
    scene: Scene | str | Path | Mapping[str, Any],
    over: Mapping[str, Any],
    *,
    out: str | Path | None = None,
    cores: int = 1,
    profile: str | None = None,
    **more: Any,
) -> xr.Dataset:
    """Simulate variations of a scene.

    Parameters
    ----------
    scene : Scene, path or dict
        The base scene.
    over : dict
        Dotted key of the scene -> values, as in a sweep's file: a list such as
        ``["79 1/m", "210 1/m"]``, ``{"range": ["2 gf", "200 gf"], "count": 9}``, a distribution,
        words, or a folder.
    out : path, optional
        Folder of the sweep, in which scenes that are there are not run again; none is kept without.
    cores : int
        Processes at a time.
    profile : str, optional
        A Snakemake profile, for a cluster.
    **more
        Further keys of a sweep: design, samples, seed, keep, histories, accuracy.

    Returns
    -------
    xarray.Dataset
        A dimension for each key of a grid, measures with units, `estimated_error`, and a
        `diagnosis` of each scene that could not be simulated.

    Raises
    ------
    SceneError, SweepError
        The sweep or one of its scenes is wrong (before anything is run).
    NotFinished
        A batch failed.

    Examples
    --------
    >>> press = {
    ...     "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    ...     "motion": [{"press_to_force": "20 gf"}],
    ...     "accuracy": "draft",
    ... }
    >>> found = sweep(press, {"stimulus.curvature": ["79 1/m", "420 1/m"]})
    >>> found.indentation_depth_end.values.round(2).tolist()
    [1.01, 1.21]
    """
    base = load_scene(scene)
    with contextlib.ExitStack() as stack:
        if out is None:
            temporary = tempfile.TemporaryDirectory(prefix="fingerpad-")
            folder, name = Path(stack.enter_context(temporary)), "sweep"
        else:
            folder, name = Path(out), Path(out).name
        lock = stack.enter_context(held(folder))
        layout = lay_out(load_sweep({"over": over, **more}, name, base), folder, cores)
        run_layout(layout, cores, profile, lock=lock)
        return xr.load_dataset(folder / "sweep.nc", engine="netcdf4")

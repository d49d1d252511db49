"""The folder of a sweep, its division into batches, and Snakemake, which runs them here or on a
cluster.

    sweep.json               batches with their predicted cost and memory, and files of records from before
    design.json              dimensions, parameters, and the key (digest of the content) of every scene
    todo/<batch>.json        the scenes of a batch
    batches/<batch>.jsonl    their records, .part while they are being made
    histories/<key>.nc       where histories are kept
    sweep.nc, sweep.csv      the result

A batch is called after the content of its scenes, so that what was run is found again whatever else
has changed.
"""

from __future__ import annotations

import contextlib
import getpass
import hashlib
import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fingerpad.files import BUILT_IN, cache_folder, disk_is_full, locked, unusable, write_text

if TYPE_CHECKING:
    import xarray as xr

    from fingerpad.scenes.scene import Scene
    from fingerpad.sweeps.language import Read

RULES = next(
    p
    for p in (BUILT_IN / "sweeps.smk", BUILT_IN.parent / "workflow" / "rules" / "sweeps.smk")
    if p.exists()
)
"""The rules of a sweep, which the project's Snakefile includes."""


class SweepError(ValueError):
    """The sweep cannot be run like this; one line."""


class NotFinished(RuntimeError):
    """A sweep did not come to its end; one line. What was done is kept."""


@dataclass(frozen=True)
class Layout:
    """What is to be done for a sweep in a folder.

    Attributes:
        folder: the sweep's. batches: name -> scenes (count), cost_s, memory_MB. known: files of
        records from before. scenes: of the sweep; missing: of these, those that are in batches;
        expected_s: what the missing ones will cost, of one core.
    """

    folder: Path
    name: str
    digest: str
    batches: Mapping[str, Mapping[str, float]]
    known: list[str]
    scenes: int
    missing: int

    @property
    def expected_s(self) -> float:
        return sum(batch["cost_s"] for batch in self.batches.values())

    def done(self) -> tuple[int, int]:
        """How many of the missing scenes have a record by now, and how many of these have
        failed.
        """
        done = failed = 0
        for name in self.batches:
            for ending in (".jsonl", ".part"):
                with contextlib.suppress(OSError):
                    text = (self.folder / "batches" / f"{name}{ending}").read_bytes()
                    done += text.count(b"\n")
                    failed += text.count(b"\n") - text.count(b'"diagnosis": ""')
                    break
        return done, max(failed, 0)


def read_layout(folder: str | Path) -> Layout:
    """The layout in a folder. Raises SweepError if there is none."""
    try:
        said = json.loads((Path(folder) / "sweep.json").read_text(encoding="utf-8"))
        return Layout(Path(folder), **said)
    except (OSError, ValueError, TypeError):
        raise SweepError(f"{folder}: holds no sweep; allowed: the folder of a sweep") from None


def lay_out(
    read: Read, folder: Path, cores: int, force: bool = False, again: bool = False, progress=None
) -> Layout:
    """Check and plan every scene of a sweep, and divide those that have no record yet into batches.

    Args:
        force: whether another sweep's folder is taken over. again: whether scenes that failed
        before are tried again.

    Raises:
        SceneError: a scene is wrong, or cannot be planned; SweepError: the folder is another
        sweep's. One line, and nothing was written.
    """
    from fingerpad.sweeps.design import Design
    from fingerpad.sweeps.forecast import divided, forecast
    from fingerpad.sweeps.records import UNFINISHED, key_of, read_records

    before = None
    with contextlib.suppress(SweepError):
        before = read_layout(folder)
    if before and before.name != read.name and not force:
        raise SweepError(
            f"--out: '{folder}' holds the sweep '{before.name}'; allowed: another --out, or --force to replace it"
        )
    design = Design(read)
    design.check()
    keep, histories = read.sweep.keep, read.sweep.histories
    keys = [key_of(scene, keep, histories) for scene in design]
    about = _described(design, keys)
    digest = _digest([about["dimensions"], about["parameters"], keys])
    if (
        before
        and before.name == read.name
        and before.digest == digest
        and not again
        and all((folder / name).exists() for name in before.known)
    ):
        return before
    expected = forecast(design, progress)
    # of the files of an earlier layout all are kept that a scene is found in
    found: dict[str, str] = {}
    for file in sorted((folder / "batches").glob("*")):
        if file.suffix == UNFINISHED:
            file = _kept(file)
        if file.suffix == ".jsonl":
            for record in read_records(file):
                if record["key"] not in found and not (again and record["diagnosis"]):
                    found[record["key"]] = file.relative_to(folder).as_posix()
    missing, seen = [], set(found)
    for number, key in enumerate(keys):
        if key not in seen:
            seen.add(key)
            missing.append(number)
    needed = sum(expected.result_bytes[n] for n in missing)
    if folder.is_dir() and disk_is_full(folder, needed):
        raise SweepError(
            f"--out: '{folder}' has no room for about {needed / 1e6:.2g} MB of results; allowed: a folder that has"
        )
    batches = {}
    for numbers in divided(missing, expected.cost_s, cores):
        name = _digest([keys[n] for n in numbers] + [again])[:12]
        batches[name] = {
            "scenes": len(numbers),
            "cost_s": round(sum(expected.cost_s[n] for n in numbers), 3),
            "memory_MB": round(max(expected.memory_MB[n] for n in numbers)),
        }
        spec = {
            "base": _base(read.base),
            "keep": list(keep),
            "histories": histories,
            "scenes": [[n, keys[n], design.changes(n)] for n in numbers],
        }
        write_text(folder / "todo" / f"{name}.json", json.dumps(spec))
    wanted = set(keys)
    known = sorted({file for key, file in found.items() if key in wanted})
    write_text(folder / "design.json", json.dumps(about))
    said = {
        "name": read.name,
        "digest": digest,
        "batches": batches,
        "known": known,
        "scenes": len(keys),
        "missing": len(missing),
    }
    write_text(folder / "sweep.json", json.dumps(said, indent=1) + "\n")
    return Layout(folder, **said)


def _base(scene: Scene) -> dict[str, Any]:
    """The base scene as plain data; batches run in other folders, so paths in it are absolute."""
    data = scene.model_dump(mode="json")
    if scene.specimen.mesh is not None:
        data["specimen"]["mesh"] = str(scene.specimen.mesh.absolute())
    return data


def _digest(content: Any) -> str:
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:16]


def _kept(file: Path) -> Path:
    """Records of a batch that was not finished, by a name under which they count as whole."""
    from fingerpad.sweeps.records import Writer

    Writer(file).close()  # without a line that was cut off
    return file.replace(file.with_name(f"{file.stem}-kept.jsonl"))


def _described(design: Any, keys: list[str]) -> dict[str, Any]:
    """What is collected, and what is said of it in the dataset."""
    from fingerpad.results import provenance
    from fingerpad.sweeps.records import code

    read = design.read
    said = read.sweep.model_dump(mode="json", exclude={"over", "scene"}, exclude_none=True)
    over = {
        key: axis.model_dump(mode="json", exclude_none=True)
        for key, axis in read.sweep.over.items()
    }
    about = {
        "title": f"fingerpad sweep {read.name}",
        "sweep": json.dumps(said | {"over": over}),
        "base_scene": json.dumps(read.base.canonical()),
        "provenance": json.dumps(provenance()),
        "code": code(),
        "Conventions": "CF-1.11",
    }
    parameters = [vars(p) for p in design.parameters]
    return {"dimensions": design.dimensions, "parameters": parameters, "keys": keys, "about": about}


@contextlib.contextmanager
def held(folder: Path) -> Iterator[tuple[int, ...]]:
    """The folder of a sweep, for this process alone, by the descriptors yielded. Raises
    SweepError.
    """
    if (wrong := unusable(folder.absolute())) or set("{}") & set(str(folder.absolute())):
        raise SweepError(
            f"--out: '{folder}' has {wrong or 'braces'} in its name; allowed: a folder without"
        )
    folder.mkdir(parents=True, exist_ok=True)
    with contextlib.ExitStack() as stack:
        try:
            lock = stack.enter_context(locked(folder))
        except BlockingIOError:
            raise SweepError(
                f"'{folder}' is being written by another sweep; allowed: another folder, or later"
            ) from None
        yield lock


def run_layout(
    layout: Layout,
    cores: int,
    profile: str | None = None,
    watch: Callable[[int, int], object] | None = None,
    lock: tuple[int, ...] = (),
) -> None:
    """Let Snakemake run the batches of a sweep and collect them.

    Args:
        profile: folder of a Snakemake profile, of a cluster for example. watch: called now and then
        with `Layout.done`. lock: by which the folder is `held`; Snakemake holds it too, for it goes
        on where this process is killed.

    Raises:
        NotFinished: a batch or the collection failed for good. KeyboardInterrupt. What was done is
        kept in either case.
    """
    folder = layout.folder.absolute()
    (folder / "logs").mkdir(exist_ok=True)
    # started in the folder: Snakemake takes braces in names for wildcards
    words = [sys.executable, "-P", "-m", "snakemake", "--snakefile", str(RULES)]
    words += ["--rerun-incomplete", "--keep-going", "--nocolor"]
    words += (
        ["--workflow-profile", str(Path(profile).absolute())]
        if profile
        else ["--cores", str(cores), "--retries", "2"]
    )
    (folder / ".snakemake" / "locks").mkdir(parents=True, exist_ok=True)
    for lock in (folder / ".snakemake" / "locks").glob(
        "*.lock"
    ):  # the folder is ours, so whoever set them is dead
        lock.unlink()
    log = folder / "logs" / "snakemake.log"
    with log.open("w", encoding="utf-8") as said:
        process = subprocess.Popen(
            [*words, "sweep"],
            cwd=folder,
            env=_surroundings(folder),
            stdout=said,
            stderr=said,
            stdin=subprocess.DEVNULL,
            start_new_session=True,
            pass_fds=lock,
        )
        try:
            while True:
                if watch:
                    watch(*layout.done())
                try:
                    code = process.wait(timeout=0.5)
                    break
                except subprocess.TimeoutExpired:
                    continue
        except BaseException:
            # first in order, so that jobs on a cluster are cancelled; then whatever is left here
            process.send_signal(signal.SIGINT)
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(timeout=30)
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGTERM)
            process.wait()
            raise
    if watch:
        watch(*layout.done())
    if code:
        done = layout.scenes - layout.missing + layout.done()[0]
        raise NotFinished(
            f"{done} of {layout.scenes} scenes are done and kept; {_why(folder)}; the same command goes on from there"
        )


def _surroundings(folder: Path) -> dict[str, str]:
    """Environment for Snakemake, also where the user has no name, or no home that can be written,
    as in a container.
    """
    own, out = folder / ".snakemake", dict(os.environ)
    if cache_folder("") is None:
        out |= {"XDG_CACHE_HOME": str(own / "cache"), "XDG_CONFIG_HOME": str(own / "config")}
    try:
        getpass.getuser()
    except (KeyError, OSError):
        out["LOGNAME"] = "nobody"
    return out


def _why(folder: Path) -> str:
    """The last thing that a job said when it failed, else Snakemake."""
    text = (folder / "logs" / "snakemake.log").read_text(encoding="utf-8", errors="replace")
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    own = [line for line in lines if line.startswith(("sweep_batch:", "sweep_collect:"))]
    wrong = [line for line in lines if "rror" in line and "log" not in line]
    said = (own or wrong or ["Snakemake failed"])[-1]
    return f"{said[:300]} (all of it: {folder / 'logs' / 'snakemake.log'})"


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

    Args:
        scene: the base scene, a file, or a dictionary. over: dotted key of it -> values, as in a
        sweep's file: a list such as ``["79 1/m", "210 1/m"]``, ``{"range": ["2 gf", "200 gf"],
        "count": 9}``, a distribution, words, or a folder. out: folder of the sweep, in which what
        is there is not run again (default: none is kept). cores: processes at a time. profile: of
        Snakemake, for a cluster. more: further keys of a sweep: design, samples, seed, keep,
        histories, accuracy.

    Returns:
        The labelled dataset: a dimension for each key of a grid, measures with units,
        `estimated_error`, and of scenes that could not be simulated a `diagnosis`.

    Raises:
        SceneError, SweepError: the sweep or one of its scenes is wrong (before anything is run).
        NotFinished: a batch failed.
    """
    import tempfile

    import xarray as xr

    from fingerpad.scenes.scene import load_scene
    from fingerpad.sweeps.language import load_sweep

    base = load_scene(scene)
    with contextlib.ExitStack() as stack:
        folder = (
            Path(out)
            if out is not None
            else Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="fingerpad-")))
        )
        lock = stack.enter_context(held(folder))
        layout = lay_out(
            load_sweep({"over": over, **more}, folder.name if out else "sweep", base), folder, cores
        )
        run_layout(layout, cores, profile, lock=lock)
        return xr.load_dataset(folder / "sweep.nc", engine="netcdf4")

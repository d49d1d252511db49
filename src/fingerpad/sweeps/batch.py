"""Scenes of a sweep in one process, one after the other, with a record of each.

A scene that cannot be simulated is a record with its diagnosis; one that has killed its process
twice is not tried again. Imports, kernels and the meshes of equal pads are shared.
"""

from __future__ import annotations

import contextlib
import errno
import json
import signal
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from fingerpad.healing import simulate
from fingerpad.measures.kept import LazyMapping
from fingerpad.measures.known import known
from fingerpad.planning.plan import plan
from fingerpad.results import states_found, write_history
from fingerpad.scenes.scene import Scene, scene_of_record
from fingerpad.sweeps.records import UNFINISHED, Writer

MOST_DEATHS = 2
"""Processes that a scene may kill before it counts as failed."""
OF_THE_DISK = (errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EROFS)


def run_batch(todo: Path, records: Path) -> None:
    """Run the scenes of the file `todo` that have no record in `records` yet.

    Raises
    ------
    OSError
        A record or a history cannot be written; all records before are there.
    """
    batch = json.loads(todo.read_text(encoding="utf-8"))
    base, unfinished = scene_of_record(batch["base"]), records.with_suffix(UNFINISHED)
    before = signal.signal(signal.SIGTERM, _stop)  # an end in order is not the scene's fault
    write, running = Writer(unfinished), records.with_suffix(".at")
    try:
        for number, key, changes in batch["scenes"]:
            if key in write.known:
                continue
            history = records.parent.parent / "histories" / f"{key}.nc"
            if (deaths := _deaths(running).get(key, 0)) >= MOST_DEATHS:
                killed = f"its process was killed {deaths} times while it ran"
                record = _failed(f"{killed}; is there memory enough?")
            else:
                with _noted(running, key):
                    record = _record(base, changes, batch, history)
            write({"key": key, "number": number} | record)
            print(number, key, record["diagnosis"] or "done", flush=True)
    finally:
        write.close()
        signal.signal(signal.SIGTERM, before)
    running.unlink(missing_ok=True)
    unfinished.replace(records)


def _stop(*_: Any) -> None:
    raise KeyboardInterrupt


def _record(
    base: Scene, changes: Mapping[str, Any], batch: Mapping[str, Any], history: Path
) -> dict[str, Any]:
    """The record of a scene, simulated or failed; OSError if its history cannot be written."""
    started = time.perf_counter()
    try:
        scene = base.varied(changes)
        return measured(scene, batch["keep"], history if batch["histories"] else None)
    except Exception as error:  # noqa: BLE001 - one bad scene never stops a sweep
        if isinstance(error, OSError) and error.errno in OF_THE_DISK:
            raise
        name = type(error).__name__
        own = type(error).__module__.startswith("fingerpad.")  # whose message says it all
        return _failed(str(error) if own else f"{name}: {error}", time.perf_counter() - started)


def _failed(diagnosis: str, wall: float = 0.0) -> dict[str, Any]:
    text = " ".join(diagnosis.split())[:500]
    return {"diagnosis": text, "measures": [], "wall_s": round(wall, 4)}


def measured(scene: Scene, keep: list[str], file: Path | None = None) -> dict[str, Any]:
    """Simulate a scene and measure it.

    Parameters
    ----------
    scene : Scene
        The scene.
    keep : list of str
        Names of measures.
    file : Path, optional
        Where the history is kept.

    Returns
    -------
    dict
        The record; its measures are [quantity, condition, unit, value] each.
    """
    history = simulate(scene, plan=plan(scene))
    cost = json.loads(history.attrs["cost"])
    runs = LazyMapping(lambda name: history, [scene.name])
    values, measures = [], known(keep)
    for name in keep:
        measure = measures[name]
        if measure.where(scene):
            try:
                found = measure(scene) if measure.of == "scene" else measure(history, runs)
            except KeyError:  # this scene does not show it
                continue
            values += [[name, condition, measure.unit, value] for condition, value in found.items()]
    if file is not None:
        file.parent.mkdir(exist_ok=True)
        write_history(history, file)
    return {
        "diagnosis": "",
        "doubts": "; ".join(json.loads(history.attrs.get("doubts", "[]"))),
        "relaxed": json.loads(history.attrs.get("relaxed", "{}")).get("kept", ""),
        "measures": values,
        "estimated_error": float(history.attrs["estimated_error"]),
        "nodes": cost["nodes"],
        "steps": states_found(history),
        "iterations": int(history.newton_iterations.sum()),
        "cpu_s": cost["cpu_s"],
        "wall_s": cost["wall_s"],
        "memory_MB": _resident_MB(),
    }


def _resident_MB() -> float:
    """Memory of the process, MB; 0 where the system does not say."""
    try:
        return round(int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6, 1)
    except (OSError, ValueError):
        return 0.0


def _deaths(running: Path) -> dict[str, int]:
    """Key of the scene that killed the process before -> how often it did."""
    try:
        return json.loads(running.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


@contextlib.contextmanager
def _noted(running: Path, key: str) -> Iterator[None]:
    """Note in a file that a scene runs; the note stays if the process is killed."""
    running.write_text(json.dumps({key: _deaths(running).get(key, 0) + 1}), encoding="utf-8")
    try:
        yield
    finally:
        running.unlink(missing_ok=True)

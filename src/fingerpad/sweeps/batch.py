"""Scenes of a sweep in one process, one after the other: imports, kernels and grids of equal pads
are shared.

Each scene's record is written when it is done. A scene that cannot be simulated is a record with
its diagnosis; one that has killed its process twice is not tried again.
"""

from __future__ import annotations

import errno
import json
import signal
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fingerpad.scenes.scene import Scene, scene_of_record
from fingerpad.sweeps.records import UNFINISHED, Writer

MOST_DEATHS = 2
"""Of processes in a scene, after which it counts as failed."""


def run_batch(todo: Path, records: Path) -> None:
    """Run the scenes of the file `todo` that `records` does not know yet.

    Raises:
        OSError: a record or a history cannot be written; all records before are there.
    """
    spec = json.loads(todo.read_text(encoding="utf-8"))
    base = scene_of_record(spec["base"])
    unfinished = records.with_suffix(UNFINISHED)
    before = signal.signal(
        signal.SIGTERM, _stop
    )  # whoever ends this process in order is not the scene's fault
    write, watch = Writer(unfinished), _Watch(records.with_suffix(".at"))
    try:
        for number, key, changes in spec["scenes"]:
            if key in write.known:
                continue
            if (deaths := watch.deaths(key)) >= MOST_DEATHS:
                record = _failed(
                    f"its process was killed {deaths} times while it ran; is there memory enough?"
                )
            else:
                with watch.over(key):
                    record = _one(
                        base,
                        number,
                        changes,
                        spec,
                        records.parent.parent / "histories" / f"{key}.nc",
                    )
            write({"key": key, "number": number} | record)
            write.known.add(key)
            print(number, key, record["diagnosis"] or "done", flush=True)
    finally:
        write.close()
        signal.signal(signal.SIGTERM, before)
    unfinished.replace(records)


def _stop(*_: Any) -> None:
    raise KeyboardInterrupt


def _one(
    base: Scene, number: int, changes: Mapping[str, Any], spec: Mapping[str, Any], file: Path
) -> dict[str, Any]:
    """The record of a scene, whatever becomes of it; OSError only if its history cannot be
    written.
    """
    started = time.perf_counter()
    try:
        return measured(base.varied(changes), spec["keep"], file if spec["histories"] else None)
    except OSError as error:
        if error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EACCES, errno.EROFS):
            raise
        return _failed(f"{type(error).__name__}: {error}")
    except Exception as error:  # noqa: BLE001 - one bad scene never stops a sweep
        own = type(error).__module__.startswith("fingerpad.")  # which say in one line what is wrong
        said = str(error) if own else f"{type(error).__name__}: {error}"
        return _failed(said, time.perf_counter() - started)


def _failed(diagnosis: str, wall: float = 0.0) -> dict[str, Any]:
    return {
        "diagnosis": " ".join(diagnosis.split())[:500],
        "measures": [],
        "wall_s": round(wall, 4),
    }


def measured(scene: Scene, keep: list[str], file: Path | None = None) -> dict[str, Any]:
    """Simulate a scene and read the measures `keep` of it: a record.

    Measures are [quantity, condition, unit, value] each. `file`: where the history is kept.
    """
    from fingerpad.measures.known import known
    from fingerpad.measures.measure import Runs
    from fingerpad.planning.plan import plan
    from fingerpad.results import states_found, write_history
    from fingerpad.simulation import simulate

    chosen = plan(scene)
    history = simulate(scene, plan=chosen)
    cost = json.loads(history.attrs["cost"])
    values, runs, measures = [], Runs({scene.name: history}), known(keep)
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
    """Memory that the process holds now, MB; 0 where that is not told."""
    try:
        return round(int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6, 1)
    except (OSError, ValueError):
        return 0.0


class _Watch:
    """Remembers in a file which scene runs, so that the process after one that was killed knows in
    which.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._died: dict[str, int] = json.loads(path.read_text(encoding="utf-8"))
        except (OSError, ValueError):
            self._died = {}
        self._key = ""

    def deaths(self, key: str) -> int:
        """How many processes have died in a scene."""
        return self._died.get(key, 0)

    def over(self, key: str) -> _Watch:
        self._key = key
        return self

    def __enter__(self) -> None:
        self._path.write_text(json.dumps({self._key: self.deaths(self._key) + 1}), encoding="utf-8")

    def __exit__(self, *_: Any) -> None:
        self._path.unlink(missing_ok=True)

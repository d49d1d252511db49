"""gmsh, in a process of its own.

gmsh has one session in a process, reads the user's configuration files and wants the main thread
for its signals. Here nothing of that reaches the caller: its own gmsh session, its threads and its
settings stay as they are, and a mesh that crashes gmsh crashes only this process. The process is
started when it is first needed and ends with the one that started it.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import pickle
import select
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from itertools import accumulate, pairwise
from pathlib import Path
from typing import Any

import numpy as np

PATIENCE = 60.0
"""s that gmsh is given for a task: damaged files may keep it busy for ever, a mesh of half a
million elements takes five.
"""


class GmshError(RuntimeError):
    """gmsh could not do what it was asked; the message is its own, in one line."""


class GmshMissing(ImportError):
    """gmsh cannot be loaded here; the message is one line that says what is missing and how to
    install it.
    """


# --- the caller's side --------------------------------------------------------------------------


class _Worker:
    """The process of gmsh, shared by the threads of this one."""

    def __init__(self) -> None:
        self._lock, self._process, self._owner = threading.Lock(), None, 0

    def ask(self, task: str, *arguments: Any) -> Any:
        """What a task of :data:`TASKS` gives for arguments.

        Raises
        ------
        GmshError : gmsh raised an error, or ended. GmshMissing : it cannot be loaded.
        """
        with self._lock:
            process = self._started()
            try:
                pickle.dump((task, arguments), process.stdin)
                process.stdin.flush()
                if not select.select([process.stdout], [], [], PATIENCE)[0]:
                    raise TimeoutError
                kind, answer = pickle.load(process.stdout)
            except TimeoutError:
                self._end()
                raise GmshError(f"it has not come to an end in {PATIENCE:g} s") from None
            except (EOFError, OSError, pickle.UnpicklingError):
                self._end()
                raise GmshError(f"it ended with code {process.returncode}") from None
            except (
                BaseException
            ):  # an interrupt: what is still to come of the answer would be taken for another's
                self._end()
                raise
        if kind != "done":
            raise (GmshMissing if kind == "missing" else GmshError)(answer)
        return answer

    def _started(self) -> subprocess.Popen:
        if self._process is None or self._owner != os.getpid() or self._process.poll() is not None:
            self._owner = os.getpid()  # a forked child has pipes to a process that is not its own
            self._process = subprocess.Popen(
                [sys.executable, "-P", __file__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                start_new_session=True,  # Ctrl-C is for the caller
                env=os.environ
                | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OMP_NUM_THREADS": "1"},
            )
        return self._process

    def close(self) -> None:
        """End the process, if there is one and it is this process's own."""
        if self._process is not None and self._owner == os.getpid():
            self._end()

    def _end(self) -> None:
        self._process.kill()
        for pipe in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()
        self._process.wait()


_WORKER = _Worker()
ask = _WORKER.ask
atexit.register(_WORKER.close)


# --- the side of gmsh ---------------------------------------------------------------------------


@contextlib.contextmanager
def _session(gmsh):
    """A quiet session that reads no configuration."""
    gmsh.initialize(["fingerpad", "-v", "0"], readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield gmsh
    finally:
        gmsh.finalize()


def rectangle(gmsh, columns: int, bands: tuple[int, ...]) -> np.ndarray:
    """Second-order quads of a rectangle: x counts columns, -y rows, in bands of so many.

    Returns
    -------
    (elements, 9, 2) int, half steps (column, row) of each element's nodes, band after band.
    """
    import pygmsh

    with tempfile.TemporaryDirectory(prefix="fingerpad-") as empty:
        os.environ["GMSH_HOME"] = empty  # pygmsh lets gmsh read what is there
        with pygmsh.geo.Geometry(init_argv=["fingerpad", "-v", "0"]) as geometry:
            gmsh.option.setNumber("General.Terminal", 0)
            gmsh.option.setNumber("Mesh.SecondOrderIncomplete", 0)
            for low, high in pairwise(accumulate(bands, initial=0)):
                corners = [(0, -low), (0, -high), (columns, -high), (columns, -low)]
                band = geometry.add_polygon(corners)
                for line, count in zip(band.lines, 2 * (high - low, columns), strict=True):
                    geometry.set_transfinite_curve(line, count + 1, "Progression", 1.0)
                geometry.set_transfinite_surface(band.surface, "Left", band.points)
                geometry.set_recombined_surfaces([band.surface])
            grid = geometry.generate_mesh(dim=2, order=2)
    (quads,) = [block.data for block in grid.cells if block.type == "quad9"]
    return np.rint(2.0 * grid.points[:, :2] * (1.0, -1.0)).astype(np.int64)[quads]


def write(gmsh, path: str, points: np.ndarray, curves: list[tuple], surfaces: list[tuple]) -> None:
    """Write a .msh file (version 4.1). `points` (n, 2) mm; of each group (name, gmsh's element
    type, node numbers from 1).
    """
    with _session(gmsh):
        gmsh.option.setNumber("Mesh.MshFileVersion", 4.1)
        gmsh.option.setNumber("Mesh.Binary", 0)
        for dimension, groups in ((1, curves), (2, surfaces)):
            for number, (name, _, _) in enumerate(groups, start=1):
                gmsh.model.addDiscreteEntity(dimension, number)
                gmsh.model.addPhysicalGroup(dimension, [number], number, name)
        tags = np.arange(1, len(points) + 1)
        gmsh.model.mesh.addNodes(2, 1, tags, np.column_stack((points, np.zeros(len(tags)))).ravel())
        for groups in (curves, surfaces):
            for number, (_, kind, nodes) in enumerate(groups, start=1):
                gmsh.model.mesh.addElementsByType(number, kind, [], nodes)
        gmsh.model.mesh.reclassifyNodes()
        gmsh.write(path)


def read(gmsh, path: str) -> tuple[np.ndarray, np.ndarray, dict, dict, int]:
    """What is in a .msh file, nodes by their tags.

    Returns
    -------
    tags : (n,) array
        Node tags.
    places : (n, 3) array
        Where the nodes are.
    surfaces, curves : dict
        Name -> list of (gmsh's type, element tags, node tags). A group without a name has its
        number.
    count : int
        Number of all surface elements, in a group or not.
    """
    with _session(gmsh), tempfile.TemporaryDirectory(prefix="fingerpad-") as folder:
        # alone, for gmsh runs what stands in a .opt file beside a mesh
        link = Path(folder) / "alone.msh"
        link.symlink_to(Path(path).absolute())
        gmsh.open(str(link))
        tags, places, _ = gmsh.model.mesh.getNodes()
        groups: tuple[dict, dict] = ({}, {})
        for dimension in (1, 2):
            for _, group in gmsh.model.getPhysicalGroups(dimension):
                name = gmsh.model.getPhysicalName(dimension, group) or str(group)
                for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
                    blocks = zip(*gmsh.model.mesh.getElements(dimension, entity), strict=True)
                    groups[dimension - 1].setdefault(name, []).extend(blocks)
        count = sum(len(part) for part in gmsh.model.mesh.getElements(2)[1])
    return tags, places.reshape(-1, 3), groups[1], groups[0], count


TASKS: dict[str, Callable] = {"rectangle": rectangle, "write": write, "read": read}
"""What the process can be asked for."""


def _watch(parent: int) -> None:
    """End this process where whoever started it has gone, however busy gmsh is."""
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)


def _serve() -> None:
    """Answer until nobody asks any more."""
    questions, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what libraries print is no answer
    missing = ""
    threading.Thread(target=_watch, args=(os.getppid(),), daemon=True).start()
    try:
        import gmsh
    except (ImportError, OSError) as error:
        missing = (
            f"gmsh cannot be loaded: {error}; "
            "on Debian: sudo apt-get install -y libglu1-mesa libxcursor1 libxinerama1"
        )
    while True:
        try:
            task, arguments = pickle.load(questions)
        except EOFError:
            return
        try:
            answer = ("missing", missing) if missing else ("done", TASKS[task](gmsh, *arguments))
        except Exception as error:  # noqa: BLE001 - gmsh raises nothing more specific
            answer = "failed", " ".join(str(error).split()) or type(error).__name__
        pickle.dump(answer, answers)
        answers.flush()


if __name__ == "__main__":
    _serve()

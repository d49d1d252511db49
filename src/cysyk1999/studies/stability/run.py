"""How stable the method is in hard cases, beside simpler methods in the same cases.

Each case of :mod:`cysyk1999.studies.stability.hard_cases` is simulated by the default method,
through the door a user has, and by three methods that differ from it in one thing each, on the same
nodes. What a run did is measured; what counts as stable is the case's.
"""

from __future__ import annotations

import json
import os
import signal
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from threadpoolctl import threadpool_limits

from cysyk1999.publishing.write import write_frame
from cysyk1999.studies.accuracy.belief import finer as finely
from cysyk1999.studies.accuracy.meshes import quarters, triangles
from cysyk1999.studies.stability.catalogue import CATALOGUE, HALVED, REFERENCE, SECOND_SOLVER
from cysyk1999.studies.stability.hard_cases import Case
from cysyk1999.studies.stability.invariants import (
    ENDS,
    Held,
    difference,
    excess,
    iterations,
    measures,
    mirrored,
)
from cysyk1999.studies.stability.relaxing import HERE, relaxed
from fingerpad.mechanics.stepping import NonConvergence, hard_here
from fingerpad.planning.hardness import hard_in
from fingerpad.planning.plan import plan
from fingerpad.planning.rules import RULES
from fingerpad.results import states_found
from fingerpad.simulation import Simulation
from fingerpad.specimen import mesh_for
from fingerpad.specimen.pad import PadMesh

METHODS = ("default", "full Q1", "plain P2", "plain Newton")
STABLE, LABOURS, ADMITS, CLEAN, SILENT = (
    "stable",
    "labours",
    "admits its error",
    "fails cleanly",
    "unsound",
)
UNCLEAN, UNDONE = "breaks off", "not done"
"""Outcomes of a run. Labours: it completed and what it found is within all limits, but not what it
took, or another run to compare it with did not complete; admits its error: the error that it
estimates is a half or more, or it notes what is wrong; unsound: it completed outside its limits and
says nothing; breaks off: an error that is not a diagnosis; not done: not in
:data:`SLOWEST`.
"""
EFFORT = ("cuts", "factorisations", "effort")
"""Measures of what a run took."""
NOTED = {
    "energy": "the energy found",
    "halving": "more steps",
    "det_f": "of its volume",
    "solver": "states near to one another",
    "checkerboard": "from node to node",
}
"""Measure -> the words by which a run notes that it is wrong."""
SLOWEST = 120.0
"""s of process time after which a simulation is let go."""
MOST_ITERATIONS = 200
"""A teaching method is given up after so many Newton iterations; the default method is not."""
SOLVER = "FINGERPAD_LINEAR_SOLVER"
FINER = 2.0
"""By how much shorter the edges of a reference are; its steps are half as long."""


# -- methods ------------------------------------------------------------------------------------------------------------------


class _NoReceptors:
    """Stands for receptors where an element has no pressure field that they could read."""

    def __call__(self, body, dt):
        pass

    def sample(self, body):
        return {}


class Teaching(Simulation):
    """A simulation by another element, or by plain Newton, without receptors."""

    def __init__(self, scene, chosen, mesh, lagged: bool):
        super().__init__(scene, chosen, mesh)
        self.body.lagged = lagged
        iterate = self.stepper.iterate
        self._left = MOST_ITERATIONS

        def counted(*args, **kwargs):
            self._left -= 1
            if self._left < 0:
                raise NonConvergence(
                    self.stepper.time,
                    f"given up after {MOST_ITERATIONS} iterations",
                    "another method",
                )
            return iterate(*args, **kwargs)

        self.stepper.iterate = counted

    def _receptors(self, instantaneous):
        self.depth = self.offset = np.zeros(0)
        return _NoReceptors()


def _split(mesh: PadMesh, element: str, change) -> PadMesh | None:
    """The mesh for an element, or None where it cannot be made of it."""
    kind = {"Q1": "quad4", "P2": "tri6"}[element]
    return mesh if mesh.element == kind else change(mesh) if mesh.element == "quad9" else None


def simulation(
    case: Case, method: str, folder: Path, refined: int = 1, finer: float = 1.0
) -> Simulation | None:
    """A case ready to run by a method with its steps divided by ``refined`` and its edges by
    ``finer``; None where the method has no such mesh.
    """
    scene = case.read(folder)
    chosen = plan(scene)
    if finer > 1:
        chosen = finely(chosen, finer)
    # without a slide, its step stands for steps that are given by hand: what is pressed is pressed
    # in as many
    slides = chosen.slide_step and any(leg.strokes for leg in scene.motion)
    slide_step = chosen.slide_step / refined if slides else None
    chosen = replace(chosen, steps_per_leg=case.steps_per_leg * refined, slide_step=slide_step)
    if method == METHODS[0]:
        return Simulation(scene, chosen, None)
    mesh, element, lagged = mesh_for(scene, chosen).elevated(), chosen.element, True
    if method == "full Q1":
        element, mesh = "Q1", _split(mesh, "Q1", quarters)
    elif method == "plain P2":
        element, mesh = "P2", _split(mesh, "P2", triangles)
    else:
        lagged = False
    return mesh and Teaching(scene, replace(chosen, element=element), mesh, lagged)


# -- runs ---------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Run:
    """A case by a method: history (of a failed run up to its last converged state), message, and
    what was measured.
    """

    history: xr.Dataset | None
    completed: bool
    outcome: str
    message: str
    measured: Mapping[str, float]


@contextmanager
def second_solver() -> Iterator[None]:
    """The other linear solver, SuperLU, for as long as this lasts."""
    before = os.environ.get(SOLVER)
    os.environ[SOLVER] = "superlu"
    try:
        yield
    finally:
        os.environ.pop(SOLVER)
        if before is not None:
            os.environ[SOLVER] = before


class Late(BaseException):
    """The time of a simulation is over."""


@contextmanager
def in_time(seconds: float = SLOWEST) -> Iterator[None]:
    """Raises :class:`Late`, which no part of a simulation takes for its own, after so much process
    time (s).
    """

    def late(*_):
        raise Late

    before = signal.signal(signal.SIGPROF, late)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _simulate(
    case: Case, method: str = METHODS[0], refined: int = 1, finer: float = 1.0
) -> tuple[xr.Dataset, float] | None:
    """History of a case and how well forces balanced in it; None where the method has no such
    mesh.
    """
    with tempfile.TemporaryDirectory() as folder, threadpool_limits(1):
        made = simulation(case, method, Path(folder), refined, finer)
        if made is None:
            return None
        held = Held(made)
        with in_time():
            history = made.run(held)
    return history, held.balance(history)


def run(case: Case, method: str = METHODS[0], compare: bool = True) -> Run | None:
    """Simulate a case by a method, and again to :func:`compared`; None where the method has no mesh
    for it.
    """
    found = _run(case, method)
    return compared(case, found) if compare and found is not None else found


def _run(case, method):
    try:
        made = _simulate(case, method)
    except NonConvergence as failure:
        kept = getattr(failure, "dataset", None)
        diagnosed = bool(failure.reason and failure.advice) and (
            kept is None or _sound_so_far(kept)
        )
        return Run(
            kept,
            False,
            CLEAN if diagnosed else UNCLEAN,
            str(failure),
            measures(kept) if kept is not None else {},
        )
    except Late:
        return Run(None, False, UNDONE, f"not done in {SLOWEST:g} s", {})
    except (
        ArithmeticError,
        ValueError,
        np.linalg.LinAlgError,
    ) as error:  # what a user would see as a traceback
        return Run(None, False, UNCLEAN, f"{type(error).__name__}: {error}", {})
    if made is None:
        return None
    history, balance = made
    measured = measures(history) | {"balance": balance}
    if method == METHODS[0] and _is_mirrored(case):
        measured["symmetry"] = mirrored(history)
    if case.may_fail:
        error = history.attrs["estimated_error"]
        return Run(
            history,
            True,
            ADMITS if error >= 0.5 else SILENT,
            f"estimated error {error:.2g}",
            measured,
        )
    return judged(case, history, measured)


def _is_mirrored(case: Case) -> bool:
    """Whether a case that is solved with the whole pad is its own mirror image."""
    effects = case.document["effects"]
    if effects.get("symmetry") != "off":
        return False
    halved = replace(
        case, scene=case.scene | {"effects": {k: v for k, v in effects.items() if k != "symmetry"}}
    )
    with tempfile.TemporaryDirectory() as folder:
        return plan(halved.read(Path(folder))).effects["symmetry"].on


def compared(case: Case, found: Run) -> Run:
    """A run by the default method, judged also by runs beside it; one that broke off, or may, is
    left as it is.

    The effort of its easy neighbour always; half the step, the second solver and the reference in
    some, for they cost as much as all the rest (:data:`HALVED`, :data:`SECOND_SOLVER`,
    :data:`REFERENCE`).
    """
    if not found.completed or case.may_fail:
        return found
    measured = dict(found.measured)
    if case.name in HALVED:
        measured["halving"] = _apart(case, found.history, refined=2)
    measured["effort"] = iterations(found.history) / _effort(
        json.dumps(case.neighbour.document), case.neighbour
    )
    if case.name in SECOND_SOLVER:
        with second_solver():
            measured["solver"] = _apart(case, found.history)
    if case.name in REFERENCE:
        believed = max(found.history.attrs["estimated_error"], RULES.presets["draft"].tolerance)
        measured["reference"] = _apart(case, found.history, ENDS[:4], 2, FINER) / believed
    return judged(case, found.history, measured)


def _apart(
    case: Case,
    history: xr.Dataset,
    names: Iterable[str] = ENDS,
    refined: int = 1,
    finer: float = 1.0,
) -> float:
    """Difference to another run of a case; infinite where that is not completed, nan where it is
    not done in time.
    """
    try:
        return difference(_simulate(case, METHODS[0], refined, finer)[0], history, names)
    except NonConvergence:
        return np.inf
    except Late:
        return np.nan


_EFFORTS: dict[tuple[str, int], float] = {}


def _effort(said: str, neighbour: Case) -> float:
    """Iterations of a case a step, which many cases may have as their neighbour."""
    key = said, neighbour.steps_per_leg
    if key not in _EFFORTS:
        _EFFORTS[key] = iterations(_simulate(neighbour)[0])
    return _EFFORTS[key]


def judged(case: Case, history: xr.Dataset, measured: Mapping[str, float]) -> Run:
    """A completed run with its outcome."""
    beyond, notes = excess(measured, case.limits), history.attrs["notes"]
    wrong = [name for name in beyond if name not in EFFORT and np.isfinite(measured[name])]
    admitted = history.attrs["estimated_error"] >= 0.5 or all(
        name in NOTED and NOTED[name] in notes for name in wrong
    )
    outcome = STABLE if not beyond else LABOURS if not wrong else ADMITS if admitted else SILENT
    return Run(history, True, outcome, "; ".join(beyond.values()), measured)


def _sound_so_far(kept: xr.Dataset) -> bool:
    """Is the last saved state one to look at?"""
    return (
        not kept.attrs["complete"]
        and bool(np.isfinite(kept.force).all())
        and float(kept.complementarity_error.max()) < 1e-3
    )


def cured(case: Case, found: Run) -> str:
    """What of a case that is not stable, relaxed as its message says, makes it so; in words, empty
    where nothing does.
    """
    message = found.message
    if HERE not in message:  # of a run that was completed a note says it
        with tempfile.TemporaryDirectory() as folder:
            message += f"; {hard_here(hard_in(case.read(Path(folder))))}"
    return next(
        (
            said
            for said, easier in relaxed(case, message)
            if run(easier, compare=False).outcome == STABLE
        ),
        "",
    )


def study(method: str, part: int = 1, parts: int = 1) -> pd.DataFrame:
    """One row a case: what makes it hard, what counts as stable, the outcome and every measure with
    its limit.

    Of the whole catalogue, or of one of so many parts of it, which may be made side by side.

    The columns depth_mm and force_N_per_m are the state at the end, by which methods are compared.
    """
    rows = []
    for number, case in list(enumerate(CATALOGUE.values(), start=1))[part - 1 :: parts]:
        row: dict[str, Any] = {
            "number": number,
            "case": case.name,
            "group": case.group,
            "method": method,
        }
        row |= {"hard": case.hard, "stable": case.stable}
        if method != METHODS[0] and case.name not in HALVED:
            continue
        done = run(case, method, compare=method == METHODS[0])
        if done is None:
            rows.append(row | {"outcome": "does not apply"})
            continue
        saved = ""
        if not done.completed:
            saved = (
                "none had converged"
                if done.history is None
                else f"{states_found(done.history)} steps"
            )
        row |= {
            "outcome": done.outcome,
            "completed": float(done.completed),
            "message": done.message,
            "saved": saved,
        }
        if method == METHODS[0] and done.outcome != STABLE:
            row["relaxed"] = cured(case, done)
        row |= dict(done.measured) | {
            f"limit {key}": getattr(case.limits, key) for key in done.measured
        }
        if done.completed:
            row |= {
                "depth_mm": 1e3 * done.history.indentation_depth.values[-1],
                "force_N_per_m": done.history.force.values[-1],
            }
        rows.append(row)
        print(f"{method}, {case.name}: {done.outcome} {done.message}", flush=True)
    return pd.DataFrame(rows)


def stability_method(job: SimpleNamespace) -> None:
    """Job: `method`, `part` (such as 1/4) -> `data`."""
    part, parts = map(int, job.part[0].split("/"))
    write_frame(study(job.method[0].replace("_", " "), part, parts), Path(job.data[0]))

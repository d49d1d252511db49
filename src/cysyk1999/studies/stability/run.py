"""How stable the method is in hard cases, beside simpler methods in the same cases.

Each case of :mod:`cysyk1999.studies.stability.cases` is simulated by the default method, as a user
would do it, and by three methods that differ from it in one thing each, on the same nodes.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from unittest.mock import patch

import numpy as np
import pandas as pd
import xarray as xr
from threadpoolctl import threadpool_limits

from cysyk1999.publishing.tables import write_frame
from cysyk1999.studies.common.meshes import shuffled, split
from cysyk1999.studies.common.plans import OutOfTime, time_limit
from cysyk1999.studies.common.plans import finer as finer_plan
from cysyk1999.studies.stability.cases import CATALOGUE, DEFAULT, Case, unseen
from cysyk1999.studies.stability.invariants import (
    ENDS,
    Reactions,
    difference,
    excess,
    iterations,
    measures,
    mirrored,
)
from fingerpad.healing import Try, attempt, cut
from fingerpad.healing import healed as remedied
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.plan import Plan, plan
from fingerpad.planning.rules import RULES
from fingerpad.results import states_found
from fingerpad.scenes.scene import Scene
from fingerpad.simulation import Simulation
from fingerpad.specimen import mesh_for

STABLE = "stable"
HEALED = "healed"
"""Not stable as planned; right within all limits after what a run relaxes by itself."""
LABOURS = "labours"
"""Right within all limits, but not what the run took, or a comparison that did not complete."""
ADMITS = "admits its error"
"""The error that the run estimates is a half or more, or it doubts what is wrong."""
CLEAN = "fails cleanly"
SILENT = "unsound"
"""Completed outside its limits, and says nothing."""
UNCLEAN = "breaks off"
"""An error that is not a diagnosis."""
UNDONE = "not done"
"""Not done in :data:`SLOWEST`."""
EFFORT = ("cuts", "factorisations", "effort")
"""Measures of what a run took."""
NOTED = {
    "energy": ("the energy found",),
    "halving": ("more steps", "steps half as long"),
    "det_f": ("of its volume",),
    "solver": ("states near to one another", "steps half as long"),
    "checkerboard": ("from node to node",),
}
"""Measure -> words of a doubt that it is wrong: what goes one way or another by the length of its
steps may do so by round-off.
"""
SLOWEST = 120.0
"""Most process time (s) of a simulation."""
MOST_ITERATIONS = 200
"""A teaching method is given up after so many Newton iterations; the default method is not."""
SOLVER = "FINGERPAD_LINEAR_SOLVER"
FINER = 2.0
"""By how much shorter the edges of a reference are; its steps are half as long."""
SPLIT = {"full Q1": ("Q1", "quad4"), "plain P2": ("P2", "tri6")}
"""Teaching method -> its element, and the kind of mesh that it needs."""


def simulation(
    case: Case, method: str, folder: Path, refined: int = 1, finer: float = 1.0
) -> Simulation | None:
    """A case ready to run by a method; None where the method has no mesh for it.

    Parameters
    ----------
    case : Case
    method : str
        Key of :data:`cysyk1999.studies.stability.cases.METHODS`.
    folder : Path
        Takes the case's external mesh.
    refined, finer : int, float
        Steps are divided by the first, edges by the second.
    """
    scene, chosen = _planned(case, folder, refined, finer)
    if method == DEFAULT:
        return Simulation(scene, chosen, None)
    mesh = mesh_for(scene, chosen).elevated()
    element, kind = SPLIT.get(method, (chosen.element, mesh.element))
    if mesh.element == "quad9" != kind:
        mesh = split(mesh, kind)
    if mesh.element != kind:
        return None
    made = Simulation(scene, replace(chosen, element=element), mesh)
    made.body.lagged = method in SPLIT
    _give_up_late(made.stepper)
    made.stepper.patience = 0
    return made


def _planned(case: Case, folder: Path, refined: int = 1, finer: float = 1.0) -> tuple[Scene, Plan]:
    """A case's scene and how it is solved."""
    scene = case.read(folder)
    chosen = plan(scene)
    if finer > 1:
        chosen = finer_plan(chosen, finer)
    # Without a slide its step must be None, or a press would take the planner's own steps.
    slides = chosen.slide_step and any(leg.strokes for leg in scene.motion)
    slide_step = chosen.slide_step / refined if slides else None
    steps = refined * chosen.steps * case.steps_per_leg // (chosen.steps_per_leg or 1)
    chosen = replace(chosen, steps_per_leg=case.steps_per_leg * refined, slide_step=slide_step)
    return scene, replace(chosen, steps=max(steps, 1))


def _give_up_late(stepper) -> None:
    """Let a stepper fail after :data:`MOST_ITERATIONS`."""
    iterate, count = stepper.iterate, 0

    def counted(*args, **kwargs):
        nonlocal count
        count += 1
        if count > MOST_ITERATIONS:
            reason = f"given up after {MOST_ITERATIONS} iterations"
            raise NonConvergence(stepper.time, reason, "another method")
        return iterate(*args, **kwargs)

    stepper.iterate = counted


@dataclass(frozen=True)
class Run:
    """A case by a method: its history (up to the last converged state), outcome and measures, and
    what it broke off with.
    """

    history: xr.Dataset | None
    completed: bool
    outcome: str
    message: str
    measured: Mapping[str, float]
    problem: NonConvergence | None = None


def second_solver() -> AbstractContextManager:
    """Solve by the other linear solver, SuperLU."""
    return patch.dict(os.environ, {SOLVER: "superlu"})


def other_order(seed: int = 1) -> AbstractContextManager:
    """Number nodes and elements in another order, drawn by a seed."""
    return patch(
        "fingerpad.simulation.mesh_for",
        lambda scene, chosen: shuffled(mesh_for(scene, chosen), seed),
    )


def _simulate(
    case: Case, method: str = DEFAULT, refined: int = 1, finer: float = 1.0
) -> tuple[xr.Dataset, float] | None:
    """History and force balance of a case; None where the method has no mesh for it."""
    with tempfile.TemporaryDirectory() as folder, threadpool_limits(1):
        made = simulation(case, method, Path(folder), refined, finer)
        if made is None:
            return None
        reactions = Reactions(made)
        with time_limit(SLOWEST):
            history = made.run(reactions)
    return history, reactions.balance(history)


def run(case: Case, method: str = DEFAULT) -> Run | None:
    """Simulate a case by a method; None where the method has no mesh for it."""
    try:
        made = _simulate(case, method)
    except NonConvergence as failure:
        kept = getattr(failure, "dataset", None)
        sound = kept is None or _sound_so_far(kept)
        outcome = CLEAN if failure.reason and failure.advice and sound else UNCLEAN
        measured = {} if kept is None else measures(kept)
        return Run(kept, False, outcome, str(failure), measured, failure)
    except OutOfTime:
        return Run(None, False, UNDONE, f"not done in {SLOWEST:g} s", {})
    except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
        # What a user would see as a traceback.
        return Run(None, False, UNCLEAN, f"{type(error).__name__}: {error}", {})
    if made is None:
        return None
    history, balance = made
    measured = measures(history) | {"balance": balance}
    if method == DEFAULT and _is_mirrored(case):
        measured["symmetry"] = mirrored(history)
    if case.may_fail:
        error = history.attrs["estimated_error"]
        outcome = ADMITS if error >= 0.5 else SILENT
        return Run(history, True, outcome, f"estimated error {error:.2g}", measured)
    return judged(case, history, measured)


def _is_mirrored(case: Case) -> bool:
    """Whether a case that is solved with the whole pad is its own mirror image."""
    effects = dict(case.document["effects"])
    if effects.pop("symmetry", "") != "off":
        return False
    half = replace(case, scene=case.scene | {"effects": effects})
    with tempfile.TemporaryDirectory() as folder:
        return plan(half.read(Path(folder))).effects["symmetry"].on


def compared(case: Case, found: Run) -> Run:
    """A run by the default method, judged also by other runs; a failed one is left as it is.

    The iterations of its easy neighbour are always compared, the others as the catalogue says: half
    the step, the second solver and a reference cost as much as all the rest.
    """
    if not found.completed or case.may_fail:
        return found
    history, measured = found.history, dict(found.measured)
    if "halving" in case.compare:
        measured["halving"] = _apart(case, history, refined=2)
    neighbour = json.dumps([case.neighbour.document, case.neighbour.steps])
    measured["effort"] = iterations(history) / _effort(neighbour)
    if "solver" in case.compare:
        with second_solver():
            measured["solver"] = _apart(case, history)
    if "reference" in case.compare:
        believed = max(history.attrs["estimated_error"], RULES.presets["draft"].tolerance)
        measured["reference"] = _apart(case, history, ENDS[:4], 2, FINER) / believed
    return judged(case, history, measured)


def _apart(
    case: Case,
    history: xr.Dataset,
    names: Iterable[str] = ENDS,
    refined: int = 1,
    finer: float = 1.0,
) -> float:
    """Difference to another run of a case: inf where that fails, nan where it is out of time."""
    try:
        return difference(_simulate(case, DEFAULT, refined, finer)[0], history, names)
    except NonConvergence:
        return np.inf
    except OutOfTime:
        return np.nan


@cache
def _effort(neighbour: str) -> float:
    """Iterations a step of an easy case, which many cases may have as their neighbour; nan where
    it goes through its own pad.
    """
    scene, steps = json.loads(neighbour)
    with suppress(NonConvergence):
        return iterations(_simulate(Case("neighbour", "", "", scene, steps=steps))[0])
    return np.nan


def judged(case: Case, history: xr.Dataset, measured: Mapping[str, float]) -> Run:
    """A completed run with its outcome."""
    beyond, doubts = excess(measured, case.limits), history.attrs.get("doubts", "")
    noted = {name for name, words in NOTED.items() if any(each in doubts for each in words)}
    wrong = [name for name in beyond if name not in EFFORT and np.isfinite(measured[name])]
    if not beyond:
        outcome = STABLE
    elif not wrong:
        outcome = LABOURS
    else:
        outcome = ADMITS if history.attrs["estimated_error"] >= 0.5 or noted >= {*wrong} else SILENT
    return Run(history, True, outcome, "; ".join(beyond.values()), measured)


def _sound_so_far(kept: xr.Dataset) -> bool:
    """Whether the last saved state of a failed run is sound."""
    if kept.attrs["complete"] or not np.isfinite(kept.force).all():
        return False
    return float(kept.complementarity_error.max()) < 1e-3


def healed(case: Case, found: Run) -> Run:
    """A run that is not stable, as a user's run would go on from it: with what its message says
    relaxed.

    It is judged like any other: also by half its steps where the catalogue says so.
    """
    if not found.completed and found.problem is None:
        return found
    try:
        with tempfile.TemporaryDirectory() as folder, threadpool_limits(1):
            first = Try(*_planned(case, Path(folder)), found.history, found.problem)
            with time_limit(2 * SLOWEST):
                best = remedied(first)
            if best.problem is not None or best.history is first.history:
                return found
            if best.plan is first.plan:  # it doubts itself now
                return judged(case, best.history, found.measured)
            measured = measures(best.history)
            if "halving" in case.compare:
                measured["halving"] = _half_steps_apart(best)
    except OutOfTime:
        return found
    made = judged(case, best.history, measured)
    if made.outcome == STABLE:
        return replace(made, outcome=HEALED, message=f"relaxed {best.plan.relaxed.said[-1]}")
    return made


def _half_steps_apart(best: Try) -> float:
    """Difference of a healed run to the same with half its steps: inf where that fails."""
    shorter = cut(best.plan, 2)
    free = replace(shorter, relaxed=replace(shorter.relaxed, most_factorisations=0))
    with time_limit(SLOWEST):
        other = attempt(best.scene, free)
    return np.inf if other.problem is not None else difference(other.history, best.history, ENDS)


def study(method: str, part: int = 1, parts: int = 1) -> pd.DataFrame:
    """Run the catalogue, or one of so many parts of it, by a method.

    Returns
    -------
    pandas.DataFrame
        A row a case: what makes it hard, what counts as stable, the outcome, and every measure
        with its limit. ``depth_mm`` and ``force_N_per_m`` are the state at the end, by which
        methods are compared.
    """
    rows = []
    for number, case in list(enumerate(CATALOGUE.values(), start=1))[part - 1 :: parts]:
        if method == DEFAULT or "halving" in case.compare:
            known = {"number": number, "case": case.name, "group": case.group, "method": method}
            known |= {"hard": case.hard, "stable": case.stable}
            rows.append(known | _row(case, method))
            print(f"{method}, {case.name}: {rows[-1]['outcome']}", flush=True)
    return pd.DataFrame(rows)


def _row(case: Case, method: str) -> dict[str, Any]:
    done = run(case, method)
    if done is None:
        return {"outcome": "does not apply"}
    if method == DEFAULT:
        done = compared(case, done)
    history, saved = done.history, ""
    if not done.completed:
        saved = "none had converged" if history is None else f"{states_found(history)} steps"
    row = {"outcome": done.outcome, "completed": float(done.completed)}
    row |= {"message": done.message, "saved": saved}
    if method == DEFAULT:
        better = ended(case, done)
        row |= {"ended": better.outcome, "healed": better.message * (better.outcome == HEALED)}
    row |= dict(done.measured)
    row |= {f"limit {name}": getattr(case.limits, name) for name in done.measured}
    if done.completed:
        row["depth_mm"] = 1e3 * history.indentation_depth.values[-1]
        row["force_N_per_m"] = history.force.values[-1]
    return row


def ended(case: Case, done: Run) -> Run:
    """How a case ends by what a run relaxes itself; one that may fail cleanly, and does, is stable
    as the catalogue has it.
    """
    if done.outcome == STABLE or (case.may_fail and done.outcome in (CLEAN, ADMITS)):
        return replace(done, outcome=STABLE)
    return healed(case, done)


def unseen_study(seed: int, part: int = 1, parts: int = 1) -> pd.DataFrame:
    """Run cases that were drawn by a seed, or one of so many parts of them.

    Returns
    -------
    pandas.DataFrame
        A row a case: seed, case, group, what makes it hard, how it ends as planned and with
        remedies, what was said, and process time (s).
    """
    rows = []
    for case in [*unseen(seed).values()][part - 1 :: parts]:
        begun = time.process_time()
        done = compared(case, run(case))
        better = ended(case, done)
        rows.append(
            {
                "seed": seed,
                "case": case.name,
                "group": case.group,
                "what makes it hard": case.hard,
                "as planned": done.outcome,
                "outcome": better.outcome,
                "said": better.message,
                "process time (s)": round(time.process_time() - begun, 1),
            }
        )
        print(f"{case.name}: {better.outcome}", flush=True)
    return pd.DataFrame(rows)


def stability_unseen(job: SimpleNamespace) -> None:
    """Job: `seed`, `part` (such as 1/4) -> `rows` (CSV)."""
    part, parts = map(int, job.part[0].split("/"))
    write_frame(unseen_study(int(job.seed[0]), part, parts), Path(job.rows[0]))


def stability_method(job: SimpleNamespace) -> None:
    """Job: `method`, `part` (such as 1/4) -> `data`."""
    part, parts = map(int, job.part[0].split("/"))
    write_frame(study(job.method[0].replace("_", " "), part, parts), Path(job.data[0]))

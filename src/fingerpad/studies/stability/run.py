"""How stable the method is in hard cases, beside simpler methods in the same cases.

Each case of :mod:`fingerpad.studies.stability.hard_cases` is simulated by the default method, through the door a user has, and by
three methods that differ from it in one thing each, on the same nodes. What a run did is measured; what counts as stable is the
case's.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from threadpoolctl import threadpool_limits

from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.plan import plan
from fingerpad.results import leg_ends
from fingerpad.simulation import Simulation
from fingerpad.specimen import mesh_for
from fingerpad.specimen.pad import PadMesh
from fingerpad.studies.accuracy.meshes import quarters, triangles
from fingerpad.studies.stability.hard_cases import CATALOGUE, Case, Limits

METHODS = ("default", "full Q1", "plain P2", "plain Newton")
STABLE, ADMITS, CLEAN, SILENT, UNCLEAN = "stable", "admits its error", "fails cleanly", "unsound", "breaks off"
"""Outcomes of a run. Admits its error: the error that it estimates is a half or more; unsound: it completed outside its limits;
breaks off: an error that is not a diagnosis."""
MOST_ITERATIONS = 400
"""A teaching method is given up after so many Newton iterations; the default method is not."""
ENDS = ("force", "indentation_depth", "stored_energy", "contact_width", "tangential_force")
"""What half the step is compared by, at the ends of the legs."""


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
                raise NonConvergence(self.stepper.time, f"given up after {MOST_ITERATIONS} iterations", "another method")
            return iterate(*args, **kwargs)

        self.stepper.iterate = counted

    def _receptors(self, instantaneous):
        self.depth = self.offset = np.zeros(0)
        return _NoReceptors()


def _split(mesh: PadMesh, element: str, change) -> PadMesh | None:
    """The mesh for an element, or None where it cannot be made of it."""
    kind = {"Q1": "quad4", "P2": "tri6"}[element]
    return mesh if mesh.element == kind else change(mesh) if mesh.element == "quad9" else None


def simulation(case: Case, method: str, folder: Path, refined: int = 1) -> Simulation | None:
    """A case ready to run by a method with its steps divided by ``refined``; None where the method has no such mesh."""
    scene = case.read(folder)
    chosen = plan(scene)
    # without a slide, its step stands for steps that are given by hand: what is pressed is pressed in as many
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


# -- measures -----------------------------------------------------------------------------------------------------------------


def checkerboard(pressure: np.ndarray, smoothed: np.ndarray) -> float:
    """R.m.s. of nodal pressure less its 5-point average over the peak pressure, inside the contact.

    Inside: from the third to the third last touching node (ns,), nodes that have been lifted off between them included. nan where
    there are fewer than three.
    """
    on = np.flatnonzero(pressure > 0)
    if len(on) < 7:
        return np.nan
    inside = slice(on[2], on[-3] + 1)
    return float(np.sqrt(np.mean((pressure - smoothed)[inside] ** 2)) / pressure.max())


def measures(history: xr.Dataset) -> dict[str, float]:
    """What a history tells of the run that made it (their meaning: :data:`fingerpad.studies.stability.picture.MEASURES`)."""
    ends = leg_ends(history)
    work = np.abs(history.external_work.values)
    kept = history.stored_energy + history.dissipated_energy + history.frictional_dissipation
    pressures = zip(ends.contact_pressure.values, ends.contact_pressure_smoothed.values, strict=True)
    boards = [checkerboard(pressure, smoothed) for pressure, smoothed in pressures]
    return {
        "cuts": float(history.cutbacks.sum()),
        "factorisations": json.loads(history.attrs["cost"])["factorisations"] / max(history.sizes["time"] - 1, 1),
        "energy": float(np.abs(history.external_work - kept).max() / max(work.max(), 1e-300)),
        "complementarity": float(history.complementarity_error.max()),
        "det_f": float(history.min_detF.min()),
        "checkerboard": max((b for b in boards if np.isfinite(b)), default=np.nan),
    }


def difference(one: xr.Dataset, other: xr.Dataset, names: Iterable[str] = ENDS) -> float:
    """Largest difference at the ends of the legs, each quantity over its largest value there."""
    pairs = [(leg_ends(one)[name].values, leg_ends(other)[name].values) for name in names]
    return max(float(np.abs(a - b).max() / max(np.abs(a).max(), 1e-12)) for a, b in pairs)


# -- runs ---------------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Run:
    """A case by a method: history (of a failed run up to its last converged state), message, and what was measured."""

    history: xr.Dataset | None
    completed: bool
    outcome: str
    message: str
    measured: Mapping[str, float]


def _simulate(case, method, refined):
    with tempfile.TemporaryDirectory() as folder, threadpool_limits(1):
        made = simulation(case, method, Path(folder), refined)
        return made and made.run(None)


def run(case: Case, method: str = METHODS[0], halve: bool = True) -> Run | None:
    """Simulate a case by a method, and once more with half the step; None where the method has no mesh for it."""
    found = _run(case, method)
    return halved(case, found, method) if halve and found is not None else found


def _run(case, method):
    try:
        history = _simulate(case, method, 1)
    except NonConvergence as failure:
        kept = failure.dataset if failure.records else None
        diagnosed = bool(failure.reason and failure.advice) and (kept is None or _sound_so_far(kept))
        return Run(kept, False, CLEAN if diagnosed else UNCLEAN, str(failure), measures(kept) if kept is not None else {})
    except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:  # what a user would see as a traceback
        return Run(None, False, UNCLEAN, f"{type(error).__name__}: {error}", {})
    if history is None:
        return None
    measured = measures(history)
    if case.may_fail:
        error = history.attrs["estimated_error"]
        return Run(history, True, ADMITS if error >= 0.5 else SILENT, f"estimated error {error:.2g}", measured)
    return _judged(case, history, measured)


def halved(case: Case, found: Run, method: str = METHODS[0]) -> Run:
    """A run, judged also by how much half its step changes; one that broke off, or may, is left as it is."""
    if not found.completed or case.may_fail:
        return found
    try:
        change = difference(_simulate(case, method, 2), found.history)
    except NonConvergence:
        change = np.inf
    return _judged(case, found.history, {**found.measured, "halving": change})


def _judged(case, history, measured):
    beyond = excess(measured, case.limits)
    return Run(history, True, SILENT if beyond else STABLE, "; ".join(beyond), measured)


def _sound_so_far(kept: xr.Dataset) -> bool:
    """Is the last saved state one to look at?"""
    return not kept.attrs["complete"] and bool(np.isfinite(kept.force).all()) and float(kept.complementarity_error.max()) < 1e-3


def excess(measured: Mapping[str, float], limits: Limits) -> list[str]:
    """What lies outside the limits, as text."""
    out = []
    for name, value in measured.items():
        most = getattr(limits, name)
        if value < most if name == "det_f" else value > most:
            out.append(f"{name} {value:.3g}")
    return out


def study(method: str, cases: Iterable[str] = CATALOGUE) -> pd.DataFrame:
    """One row a case: what makes it hard, what counts as stable, the outcome and every measure with its limit.

    The columns depth_mm and force_N_per_m are the state at the end, by which methods are compared.
    """
    rows = []
    for name in cases:
        case = CATALOGUE[name]
        row: dict[str, Any] = {"case": name, "group": case.group, "method": method, "hard": case.hard, "stable": case.stable}
        done = run(case, method, halve=method == METHODS[0])
        if done is None:
            rows.append(row | {"outcome": "does not apply"})
            continue
        saved = ""
        if not done.completed:
            saved = "none had converged" if done.history is None else f"{done.history.sizes['time'] - 1} steps"
        row |= {"outcome": done.outcome, "completed": float(done.completed), "message": done.message, "saved": saved}
        row |= dict(done.measured) | {f"limit {key}": getattr(case.limits, key) for key in done.measured}
        if done.completed:
            row |= {"depth_mm": 1e3 * done.history.indentation_depth.values[-1], "force_N_per_m": done.history.force.values[-1]}
        rows.append(row)
        print(f"{method}, {name}: {done.outcome} {done.message}", flush=True)
    return pd.DataFrame(rows)

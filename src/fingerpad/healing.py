"""A run that is in trouble, run again with less asked of its method: one thing after the other, the
cheapest first, until it runs well or a budget of work is spent. Where the skin may pass a corner
one way or another, a run that went well is compared with one whose steps are half as long.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from fingerpad.compiled import Stopwatch
from fingerpad.documents import SceneError
from fingerpad.mechanics.stepping import NonConvergence
from fingerpad.planning.bounds import PlanError, check_memory, micrometres, percent
from fingerpad.planning.plan import RULES, Plan, external_mesh
from fingerpad.planning.plan import plan as planned
from fingerpad.receptors.recovery import ReceptorError
from fingerpad.results import leg_ends, states_found
from fingerpad.scenes.scene import Bar, Cylinder, Line, Punch, Relaxing, Sampled, Scene, load_scene
from fingerpad.simulation import solve
from fingerpad.specimen import MeshError, OutlineError, counted
from fingerpad.specimen.pad import PadMesh
from fingerpad.stimuli.motion import NO_TIME

MOST_FACTORISATIONS = 10.0
MOST_CUTS = 2
"""Matrices factorised, mean of the states, and cuts of steps above which a run labours."""
MOST_HALVED, MOST_CHANGE = 2, 0.05
"""How often the steps of a run that meets a corner are halved, and by what share that may change it
at last, or it doubts itself.
"""
FINER = (1.4, 1.9)
"""By how much shorter the edges of a built mesh are made: nearly twice and four times the nodes."""
EASY_FACTORISATIONS = 2.0
"""Matrices factorised for a state of an easy run, which a relaxed run is planned to be."""
LEAST_MATRICES = 100.0
"""Matrices that a run which broke off counts for at least: it may have done so at once."""
POWER = 1.5
"""Of the nodes, with which the cost of a matrix grows (George 1973)."""
TIP = 2.0
"""Edges of the skin that the radius of a relaxed edge or tip is long."""
MOST_MOVED = 0.1
"""Of its height, by which smoothing may move a profile: beyond, it is another surface."""
FINE, LABOURS, DOUBTS, BROKE_OFF = range(4)
WORDS = ("ran well", "laboured", "doubted itself", "broke off")
_COMPARED = {
    "force": "force",
    "indentation_depth": "depth",
    "stored_energy": "stored energy",
    "contact_width": "width",
    "tangential_force": "side force",
}
"""What two runs of a scene are compared by, and what it is called."""
_TOLD = 5e-3
"""Changes less than this share are none worth telling."""


@dataclass(frozen=True)
class Try:
    """One run: how it was asked for and how it ended.

    Attributes
    ----------
    scene, plan
        What was run.
    history : xarray.Dataset or None
        Up to the last converged state; None where no step had converged.
    problem : NonConvergence or None
        What it broke off with.
    """

    scene: Scene
    plan: Plan
    history: Any
    problem: NonConvergence | None = None

    @property
    def rank(self) -> int:
        """How it went: 0 (well) to 3 (broke off)."""
        return BROKE_OFF if self.problem is not None else _rank(self.history)

    @property
    def factorisations(self) -> int:
        """Matrices that it factorised."""
        if self.problem is not None:
            return self.problem.factorisations
        return json.loads(self.history.attrs["cost"])["factorisations"]

    @property
    def advice(self) -> str:
        """What its message says to try."""
        if self.problem is not None:
            return self.problem.advice
        if self.rank == DOUBTS:
            doubts = json.loads(self.history.attrs["doubts"])
            return "; ".join(doubt.partition(": ")[2] for doubt in doubts)
        return "more steps, a finer mesh"

    @property
    def why(self) -> str:
        """What was the matter, in words."""
        if self.problem is not None:
            return self.problem.reason
        if self.rank == DOUBTS:
            return json.loads(self.history.attrs["doubts"])[0].partition(":")[0]
        cuts, factors = int(self.history.cutbacks.sum()), _factors(self.history)
        many = f"{cuts} cuts of steps" if cuts > MOST_CUTS else ""
        return many or f"{factors:.0f} factorisations a state"


@dataclass(frozen=True)
class Remedy:
    """A scene and plan with something relaxed; ``said``: what, in words."""

    said: str
    scene: Scene
    plan: Plan


def simulate(
    scene: Scene | str | Path | Mapping[str, Any],
    plan: Plan | None = None,
    mesh: PadMesh | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    fields: bool = False,
) -> xr.Dataset:
    """Simulate a scene.

    A run that misses the tolerance it was asked for is refined and run again, a few times at most,
    unless the scene says ``once`` or a mesh is given. A run that breaks off, labours or doubts
    itself is run again with something relaxed that the scene leaves to the plan, unless the scene
    says ``on_trouble: stop``; the history's notes say what was relaxed and what that changed. The
    history describes the run that is kept, but its times are those of all runs together.

    Parameters
    ----------
    scene : Scene, path or dict
        The scene, checked or as a document.
    plan : Plan, optional
        How it is solved (default: ``fingerpad.plan(scene)``).
    mesh : PadMesh, optional
        Mesh of the whole pad (default: built or read as the plan says).
    progress : callable, optional
        Called after each step with a dict of time_s, end_time_s, contact_width_mm, iterations,
        cutbacks; without it a notebook shows a bar.
    fields : bool
        Whether to keep full fields of strain energy, strain and stress, at the scene's snapshots or
        of the last state.

    Returns
    -------
    xarray.Dataset
        The history of the whole pad, in SI (see :mod:`fingerpad.results`).

    Raises
    ------
    SceneError
        The scene is wrong.
    PlanError, MeshError, OutlineError
        It cannot be planned or meshed; nothing was solved.
    ReceptorError
        A receptor lies outside the soft tissue.
    NonConvergence
        A step failed for good, whatever was relaxed. Its ``dataset`` is the history of the first
        run up to the last converged step; a KeyboardInterrupt has the same, if a step had
        converged.

    Examples
    --------
    >>> press = {
    ...     "stimulus": {"shape": "cylinder", "curvature": "210 1/m"},
    ...     "motion": [{"press_to_force": "20 gf"}],
    ...     "accuracy": "draft",
    ... }
    >>> history = simulate(press)
    >>> round(1e3 * float(history.contact_width[-1]), 1)
    2.7
    >>> history.fingerpad.force_N.values.round(3).tolist()
    [0.0, 0.196]
    """
    scene = load_scene(scene)
    plan = plan or planned(scene)
    watch = Stopwatch()
    best = healed(attempt(scene, plan, mesh, progress, fields), mesh, progress, fields)
    if best.problem is not None:
        raise best.problem
    cost = json.loads(best.history.attrs["cost"]) | watch.read()
    return best.history.assign_attrs(cost=json.dumps(cost, sort_keys=True))


def attempt(
    scene: Scene,
    plan: Plan,
    mesh: PadMesh | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    fields: bool = False,
) -> Try:
    """One run as it is planned, also if it breaks off; arguments as of :func:`simulate`."""
    try:
        return Try(scene, plan, solve(scene, plan, mesh, progress, fields))
    except NonConvergence as problem:
        return Try(scene, plan, getattr(problem, "dataset", None), problem)


def healed(
    first: Try,
    mesh: PadMesh | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    fields: bool = False,
) -> Try:
    """The best of a run and, if it is in trouble, of relaxed ones.

    Parameters
    ----------
    first : Try
        The run as planned.
    mesh, progress, fields
        As of :func:`simulate`.

    Returns
    -------
    Try
        Its history, or its problem, says what was tried.
    """
    how = first.scene.relaxing
    if how is None:
        return first
    runs = _Runs(
        how.budget * _work(first), partial(attempt, mesh=mesh, progress=progress, fields=fields)
    )
    first = _compared(first, how, runs)
    if first.rank == FINE:
        return first
    best, tried = _best(first, how, mesh, runs)
    if best.problem is not None:
        best.problem.tried = tuple(tried)
        return best
    return replace(best, history=_told(first, best, tried))


def changes(
    one: xr.Dataset, other: xr.Dataset, names: Iterable[str] = tuple(_COMPARED)
) -> dict[str, float]:
    """Largest difference of each quantity at the ends of the legs, over its largest value there.

    A side force is taken over no less than a tenth of the force: a thousandth of that is a tenth
    of what forces must balance within.

    Examples
    --------
    >>> one = xr.Dataset({"leg": ("time", [0, 0, 0]), "force": ("time", [0.0, 1.0, 2.0])})
    >>> changes(one, one.assign(force=("time", [0.0, 1.0, 1.5])), ["force"])
    {'force': 0.25}
    """
    return _apart(leg_ends(one), leg_ends(other), names)


def _apart(one: xr.Dataset, other: xr.Dataset, names: Iterable[str]) -> dict[str, float]:
    """Largest difference of each quantity between two histories of the same outputs."""
    scale = {name: max(float(np.abs(one[name]).max()), 1e-12) for name in names}
    if scale.keys() >= {"force", "tangential_force"}:
        scale["tangential_force"] = max(scale["tangential_force"], 0.1 * scale["force"])
    return {
        name: float(np.abs(one[name].values - other[name].values).max() / most)
        for name, most in scale.items()
    }


@dataclass
class _Runs:
    """Further runs; ``left``: the work that they may still take together."""

    left: float
    attempt: Callable[[Scene, Plan], Try]

    def __call__(self, remedy: Remedy, best: Try) -> Try:
        """A remedy's run, which says what is relaxed and takes no more than half of what is left.
        ``best``: the run before, which an interrupt leaves whole.
        """
        try:
            found = self.attempt(remedy.scene, _saying(remedy, self.left / 2))
        except KeyboardInterrupt as stop:
            if best.problem is None:
                vars(stop)["dataset"] = best.history
            raise
        self.left -= found.plan.nodes**POWER * found.factorisations
        return found


def _compared(first: Try, how: Relaxing, runs: _Runs) -> Try:
    """A run that met a corner; or the same with steps half as long, where those change it. Its
    notes say what they changed. It doubts itself if still shorter ones change it too.
    """
    if first.problem is not None or not (first.plan.checked and first.history.attrs["singular"]):
        return first
    by_hand = first.scene.by_hand.steps and how.relax != "everything"
    best, said, change = first, [], 0.0
    for _ in range(1 if by_hand else MOST_HALVED):
        shorter = runs(next(_steps(best.scene, best.plan, everything=True)), best)
        if shorter.problem is not None:
            said.append(f"with steps half as long it breaks off ({shorter.why})")
            break
        found = changes(best.history, shorter.history)
        most = max(found, key=found.__getitem__)
        change, how_much = found[most], f"{percent(found[most])} ({_COMPARED[most]})"
        said.append(f"with steps half as long the result changes by at most {how_much}")
        if change <= MOST_CHANGE:
            better = shorter if shorter.rank < best.rank and not by_hand else best
            return _noting(better, first, ", then ".join(said))
        best = best if by_hand else shorter
    doubt = f"{', then '.join(said)}: repeat with a finer mesh to check"
    return _noting(best, first, doubt, change)


def _noting(found: Try, first: Try, note: str, change: float | None = None) -> Try:
    """A run with a note of what shorter steps changed; by ``change``, where that is a doubt: its
    error is no less. ``first``: the run before any were tried.
    """
    known = found.history.attrs
    more = {"notes": json.dumps([*json.loads(known["notes"]), note])}
    if change is not None:
        more["doubts"] = json.dumps([*json.loads(known.get("doubts", "[]")), note])
        error = max(known["estimated_error"], change)
        more |= {"estimated_error": error, "largest_error": max(known["largest_error"], change)}
        legs = json.loads(known["estimated_error_of_legs"])
        more["estimated_error_of_legs"] = json.dumps([max(leg, change) for leg in legs])
        blamed = replace(found.plan, error_from="its steps, where the skin meets a corner")
        missed = blamed.missed(error) if change > known["estimated_error"] else ""
        more |= {"tolerance": missed} if missed else {}
    if found is not first:
        more["relaxed"] = json.dumps(_record(first, found, note, ["steps: half as long"]))
    return replace(found, history=found.history.assign_attrs(more))


def _best(first: Try, how: Relaxing, mesh: PadMesh | None, runs: _Runs) -> tuple[Try, list[str]]:
    """The best of a run in trouble and of the relaxed ones; what was tried, in words."""
    tried: list[str] = []
    best = first
    for remedy in remedies(first, how, mesh):
        if _easy(remedy.plan) > runs.left / 2:  # the other half is for what comes after it
            tried.append(f"{remedy.said} (not tried: it would cost too much)")
            continue
        try:
            check_memory(remedy.scene, remedy.plan.nodes, remedy.plan.outputs, RULES)
            found = _compared(runs(remedy, best), how, runs)
        except (MeshError, OutlineError, PlanError, ReceptorError) as reason:
            tried.append(f"{remedy.said} (not tried: {reason})")
            continue
        tried.append(remedy.said)
        if found.rank < best.rank:
            best = found
        if best.rank == FINE:
            break
    return best, tried


def _saying(remedy: Remedy, share: float) -> Plan:
    """The plan of a remedy, which says what is relaxed and takes no more than its share."""
    relaxed, most = remedy.plan.relaxed, max(int(share / remedy.plan.nodes**POWER), 1)
    said = (*relaxed.said, remedy.said)
    return replace(remedy.plan, relaxed=replace(relaxed, said=said, most_factorisations=most))


def _rank(history: xr.Dataset) -> int:
    """How a completed run went."""
    if json.loads(history.attrs.get("doubts", "[]")):
        return DOUBTS
    labours = history.cutbacks.sum() > MOST_CUTS or _factors(history) > MOST_FACTORISATIONS
    return LABOURS if labours else FINE


def _factors(history: xr.Dataset) -> float:
    """Matrices factorised, mean of the states that were found."""
    factorisations = json.loads(history.attrs["cost"])["factorisations"]
    return factorisations / max(states_found(history), 1)


def _easy(plan: Plan) -> float:
    """What an easy run of a plan takes, by its nodes and matrices: seconds would differ from
    machine to machine.
    """
    return EASY_FACTORISATIONS * plan.nodes**POWER * plan.steps


def _work(first: Try) -> float:
    """What a run in trouble took, or, if that is more, what one that labours would take."""
    least = max(MOST_FACTORISATIONS * first.plan.steps, LEAST_MATRICES * (first.rank == BROKE_OFF))
    return first.plan.nodes**POWER * max(first.factorisations, least)


# --- what can be relaxed, the cheapest first ------------------------------------------------------


def remedies(first: Try, how: Relaxing, mesh: PadMesh | None = None) -> Iterator[Remedy]:
    """What the message of a run says to relax: what only costs, the cheapest first; then what
    changes the surface, of which a run that only labours has no need.
    """
    scene, plan, everything = first.scene, first.plan, how.relax == "everything"
    costing: list[Remedy] = []
    if "step" in first.advice:
        costing += _steps(scene, plan, everything)
    if mesh is None and "mesh" in first.advice:
        costing += _meshes(scene, plan, everything)
    if "round-off" in first.advice or "singular" in first.why:
        costing += _solver(scene, plan)
    yield from sorted(costing, key=lambda remedy: round(_easy(remedy.plan) / _easy(plan)))
    if first.rank == BROKE_OFF or "fillet" in first.advice:
        yield from _blunter(scene, plan, everything)


def _solver(scene: Scene, plan: Plan) -> Iterator[Remedy]:
    if not plan.relaxed.precise:
        relaxed = replace(plan.relaxed, precise=True)
        said = "linear solver: factors in double precision"
        yield Remedy(said, scene, replace(plan, relaxed=relaxed))


def _steps(scene: Scene, plan: Plan, everything: bool) -> Iterator[Remedy]:
    if scene.by_hand.steps and not everything:
        return
    for pieces, said in ((2, "steps: half as long"), (4, "steps: a quarter as long")):
        yield Remedy(said, scene, cut(plan, pieces))


def cut(plan: Plan, pieces: int) -> Plan:
    """A plan with so many times the steps."""
    return replace(
        plan,
        steps_per_leg=pieces * plan.steps_per_leg,
        slide_step=plan.slide_step and plan.slide_step / pieces,
        steps=pieces * plan.steps,
        outputs=pieces * plan.outputs,
        relaxed=replace(plan.relaxed, pieces=pieces * plan.relaxed.pieces),
    )


def _meshes(scene: Scene, plan: Plan, everything: bool) -> Iterator[Remedy]:
    by_hand = scene.by_hand
    if (by_hand.skin_edge or by_hand.element) and not everything:
        return
    if plan.mesh_size is None:
        yield from _own_meshes(scene, plan)
        return
    for finer in FINER:
        size = plan.mesh_size.coarser(1 / finer)
        try:
            nodes, smallest = counted(scene.specimen, size, plan.parts(scene).ridges)
        except MeshError:
            return
        following = replace(
            plan,
            mesh_size=size,
            nodes=nodes // 2 + 1 if plan.parts(scene).half else nodes,
            smallest_edge=smallest,
            contact_edge=plan.contact_edge / finer,
            estimated_error=plan.estimated_error / finer,
        )
        yield Remedy(f"mesh: edges {finer:g} times as fine", scene, following)


def _own_meshes(scene: Scene, plan: Plan) -> Iterator[Remedy]:
    """Of an external mesh: linear quads raised, or all elements divided, inside its geometry."""
    external = external_mesh(scene)
    if external is None:
        return
    if external.element == "quad4" and plan.element == "Q1P0":
        nodes = round(plan.nodes * len(external.raised().points) / len(external.points))
        raised = replace(plan, element="Q2P1", nodes=nodes)
        yield Remedy("mesh: linear quads raised to quadratic ones", scene, raised)
    halvings = replace(plan.relaxed, halvings=plan.relaxed.halvings + 1)
    following = replace(
        plan,
        nodes=4 * plan.nodes,
        contact_edge=plan.contact_edge / 2,
        smallest_edge=plan.smallest_edge / 2,
        estimated_error=plan.estimated_error / 2,
        relaxed=halvings,
    )
    yield Remedy("mesh: each element divided into four", scene, following)


def _blunter(scene: Scene, plan: Plan, everything: bool) -> Iterator[Remedy]:
    """A rounding as large as the mesh can resolve, on a true edge or a tip finer than the nodes."""
    radius = TIP * plan.contact_edge
    for said, changes in _roundings(scene, radius, everything):
        try:
            blunter = scene.varied(changes)
            following = planned(blunter)
        except (SceneError, PlanError, MeshError):
            continue
        if following.surface.moved > MOST_MOVED * np.ptp(getattr(scene.stimulus, "y", 0.0)):
            continue
        following = replace(
            following,
            steps_per_leg=plan.steps_per_leg,
            slide_step=plan.slide_step,
            relaxed=plan.relaxed,
        )
        yield Remedy(said, blunter, following)


def _roundings(
    scene: Scene, radius: float, everything: bool
) -> Iterator[tuple[str, dict[str, Any]]]:
    stimulus, size = scene.stimulus, f"{micrometres(radius)} um"
    if isinstance(stimulus, Bar | Punch):
        wide = stimulus.width if isinstance(stimulus, Bar) else stimulus.diameter
        radius = min(radius, wide / 2)
        if stimulus.fillet < radius and (everything or stimulus.fillet == 0):
            said = f"stimulus: a fillet of {micrometres(radius)} um on its edges"
            yield said, {"stimulus.fillet": radius}
    elif isinstance(stimulus, Line) and stimulus.fillet < radius:
        blunt = Cylinder(curvature=1 / radius)
        yield f"stimulus: a tip of radius {size}", {"stimulus": blunt}
    elif isinstance(stimulus, Cylinder) and everything and stimulus.curvature * radius > 1:
        yield f"stimulus: a tip of radius {size}", {"stimulus.curvature": 1 / radius}
    elif isinstance(stimulus, Sampled) and (everything or stimulus.smooth == "auto"):
        cut_off = 4 * radius
        said = f"stimulus: its profile smoothed at {micrometres(cut_off)} um"
        yield said, {"stimulus.smooth": cut_off}


# --- what is told of it ---------------------------------------------------------------------------


def _told(first: Try, best: Try, tried: list[str]) -> xr.Dataset:
    """The history of the best run, with what was relaxed in its notes and attributes."""
    history = best.history
    if not tried:
        return history
    notes = json.loads(history.attrs["notes"])
    trouble = f"{WORDS[first.rank]} ({first.why})"
    if best is first:
        notes.append(f"the run {trouble}; relaxed in vain: {', '.join(tried)}")
    else:
        kept = best.plan.relaxed.said[-1]
        changed = _changed(first, history)
        rest = "" if best.rank == FINE else f"; it still {WORDS[best.rank]} ({best.why})"
        notes.append(f"as planned the run {trouble}: relaxed {kept}; {changed}{rest}")
    relaxed = _record(first, best, first.why, tried)
    history.attrs |= {"notes": json.dumps(notes), "relaxed": json.dumps(relaxed)}
    return history


def _record(first: Try, best: Try, why: str, tried: list[str]) -> dict[str, Any]:
    """What a history and its summary say of what was relaxed; ``kept`` is in the history."""
    return {
        "trouble": WORDS[first.rank],
        "why": why,
        "tried": tried,
        "kept": (best.plan.relaxed.said or [""])[-1],
        "ended": WORDS[best.rank],
    }


def _changed(first: Try, history: xr.Dataset) -> str:
    """What the relaxed run has that the first one did not: at the ends of its legs, or where the
    first one broke off.
    """
    reached = ""
    if first.problem is not None:
        reached = f"it had reached t = {first.problem.time:.6g} s"
        if first.history is None or first.history.time.values[-1] < NO_TIME:
            return reached  # its steps take no time, and others have others
        reached += "; there "
        names = list(_COMPARED)
        end = first.history[names].isel(time=[-1])
        found = _apart(end, history[names].interp(time=end.time), names)
    else:
        found = changes(first.history, history)
    said = [f"the {_COMPARED[n]} by {percent(size)}" for n, size in found.items() if size > _TOLD]
    less = f"depth, force, width and energy by less than {percent(_TOLD)}"
    return f"{reached}that changed {', '.join(said) or less}"

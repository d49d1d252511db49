"""One scene, simulated: the plan composes body, contact and receptors; the stepper runs; the
history is unfolded.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.spatial import KDTree
from threadpoolctl import threadpool_limits

from fingerpad.dense_output import at_outputs
from fingerpad.laws import assign
from fingerpad.machine_code import compiling
from fingerpad.mechanics.finite_strain import FiniteStrainBody
from fingerpad.mechanics.pressure import checkerboard, smoothed_pressure
from fingerpad.mechanics.small_strain import SmallStrainBody
from fingerpad.mechanics.space import PlaneStrain, Space
from fingerpad.mechanics.stepping import (
    FOLDED,
    NewtonSettings,
    NonConvergence,
    QuasiStatic,
    Record,
    Skin,
    hard_here,
)
from fingerpad.mechanics.strides import Between
from fingerpad.planning.bounds import PlanError
from fingerpad.planning.effects import EFFECTS
from fingerpad.planning.errors import estimated_error, own_errors, stroke_of
from fingerpad.planning.hardness import hard_in
from fingerpad.planning.plan import Plan, plan, refined
from fingerpad.planning.rules import RULES
from fingerpad.planning.schedule import schedule
from fingerpad.planning.unbounded import (
    OF_STROKES,
    Unbounded,
    ends_unbounded,
    in_words,
    seen_corners,
)
from fingerpad.receptors.material_points import MaterialPoints
from fingerpad.results import (
    FIELDS,
    Arrays,
    add_snapshots,
    arrays,
    peak_memory_MB,
    provenance,
    skin_arc,
)
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.specimen import mesh_for
from fingerpad.specimen.materials import Prony, moduli
from fingerpad.specimen.measures import below_outline, below_skin, skin_ends, touched_side
from fingerpad.specimen.pad import PadMesh, skin_chain
from fingerpad.stimuli.motion import INSTANT, NO_TIME, among, apart

if TYPE_CHECKING:
    import xarray as xr

_plan = plan

#: Unprojected volumetric stiffness under edge indenters, in shear moduli.
EDGE_STIFFNESS = 5.0
_UNLOADED = 0.5  # of a force that was reached before
_WIDTHS = 64  # of the contact, at which its error is looked up
_NO_CONTACT = 1e-5  # m, half-width that stands for none
# of the work, noted as missing energy beyond it; of a press at once the work is not known as well
_UNBALANCED = 0.03
_SQUEEZED = 0.1  # det F, noted below it
_UNEVEN = 0.15  # of the peak pressure, r.m.s. from node to node, noted beyond it
_STIFF_IN_BULK = (
    200.0  # bulk over shear modulus, beyond which single precision does not tell them apart
)


def simulate(
    scene: Scene | str | Path | Mapping[str, Any],
    plan: Plan | None = None,
    mesh: PadMesh | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    fields: bool = False,
) -> xr.Dataset:
    """Simulate a scene.

    Args:
        scene: a checked scene, or a file or dictionary of one. plan: how (default:
        ``fingerpad.plan(scene)``). mesh: the whole pad's mesh (default: built or read as the plan
        says). A run that misses the tolerance that its plan was asked for is refined and run again,
        a few times at most, unless the scene says ``once`` or a mesh is given; the history tells of
        its last plan. progress: called after each step with time_s, end_time_s, contact_width_mm,
        iterations, cutbacks. fields: full fields of strain energy, strain and stress as well, at
        the scene's snapshots, or of the last state.

    Returns:
        The history of the whole pad (see :mod:`fingerpad.results`).

    Raises:
        SceneError: the file or the dictionary is wrong. PlanError, MeshError, OutlineError: the
        input cannot be meshed or planned (before anything is solved). ReceptorError: a receptor
        lies outside the soft tissue. NonConvergence: a step failed for good; its ``dataset`` is the
        history up to the last converged step. A KeyboardInterrupt has the same ``dataset``, if a
        step had converged.
    """
    made = load_scene(scene)
    return _labelled(lambda: solve(made, plan, mesh, progress, fields))


def solve(
    scene: Scene,
    plan: Plan | None = None,
    mesh: PadMesh | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    fields: bool = False,
) -> Arrays:
    """:func:`simulate` without labels, for who only writes its result: so is the ``dataset`` of
    what it raises.
    """
    chosen = plan or _plan(scene)
    with threadpool_limits(1):
        history = Simulation(scene, chosen, mesh, fields).solve(progress)
        runs = [_told(history)]
        why_not = "a mesh was given" if mesh is not None else ""
        while mesh is None:
            following = refined(
                scene,
                chosen,
                history.attrs["estimated_error"],
                history.attrs["narrowest_half_width"],
                len(runs),
            )
            if isinstance(following, str):
                why_not = following
                break
            try:
                again = Simulation(scene, following, None, fields).solve(progress)
            except NonConvergence:
                why_not = f"the refined run on {following.nodes} nodes did not converge"
                break
            except KeyboardInterrupt as stop:
                stop.dataset = history  # the run before is whole
                raise
            runs.append(_told(again))
            chosen, history = following, again
    missed = chosen.missed(history.attrs["estimated_error"])
    tolerance = {
        "asked_error": np.nan if chosen.asked_error is None else chosen.asked_error,
        "tolerance": "" if missed is None else f"{missed}; {why_not}".removesuffix("; "),
        "runs": json.dumps(runs),
    }
    history.attrs |= tolerance
    return history


def _labelled(made: Callable[[], Arrays]) -> xr.Dataset:
    """What is ``made``, and what it leaves when it breaks off, with labels."""
    try:
        return made().labelled()
    except (NonConvergence, KeyboardInterrupt) as stop:
        if getattr(stop, "dataset", None) is not None:
            stop.dataset = stop.dataset.labelled()
        raise


def _told(history: Arrays) -> dict[str, Any]:
    """What is kept of a run that may be run again: its nodes and its own estimate of its error."""
    return {
        "nodes": json.loads(history.attrs["cost"])["nodes"],
        "estimated_error": history.attrs["estimated_error"],
    }


class Simulation:
    """The parts of one simulation, composed by its plan, and their way back to the whole pad."""

    def __init__(self, scene: Scene, plan: Plan, mesh: PadMesh | None, fields: bool = False):
        self.cpu, self.wall, self.compiling = time.process_time(), time.perf_counter(), compiling()
        self.scene, self.plan = scene, plan
        self.whole = (mesh or mesh_for(scene, plan)).elevated(plan.element)
        self.mesh = self.whole.right_half() if plan.effects["symmetry"].on else self.whole
        self.share = 0.5 if self.mesh.half else 1.0
        specimen = scene.specimen
        self.prony = Prony(tuple(t.g for t in specimen.prony), tuple(t.tau for t in specimen.prony))
        self.profile = scene.stimulus.at(plan.surface.smoothing, plan.contact_edge)
        self.body, instantaneous = self._body()
        self.receptors = self._receptors(instantaneous)
        self.skin = self._skin()
        self.skin_ends, self.corners = skin_ends(self.mesh), self.profile.corners()
        shear, bulk = (
            modulus[np.isin(self.mesh.cells, self.skin.nodes).any(axis=1)]
            for modulus in (self.body.shear, self.body.bulk)
        )
        self.modulus = float((4 * shear * (3 * bulk + shear) / (3 * bulk + 4 * shear)).max())
        self.fields = (
            MaterialPoints.centres(self.body, instantaneous if self.prony else None)
            if fields
            else None
        )
        friction = scene.friction if plan.effects["friction"].on else None
        observers = (self.receptors, self.fields) if fields else (self.receptors,)
        soft = float((self.body.bulk / self.body.shear).max()) < _STIFF_IN_BULK
        tolerance = {"force_tolerance": plan.newton_tolerance} if plan.newton_tolerance else {}
        settings = NewtonSettings(single=soft, **tolerance)
        self.stepper = QuasiStatic(
            self.body, self.skin, self.profile, settings, observers, friction=friction
        )
        self._require_room()
        for name, effect in EFFECTS.items():
            if effect.compose and name in plan.effects and plan.effects[name].on:
                effect.compose(self)

    def _body(self):
        specimen, plan, mesh = self.scene.specimen, self.plan, self.mesh
        fixed = np.zeros(mesh.points.shape, bool)
        for name in mesh.fixed:
            fixed[np.unique(mesh.curves[name])] = True
        if mesh.half:
            fixed[np.unique(mesh.curves["symmetry"]), 0] = True
        space = Space(
            mesh.points,
            mesh.cells,
            mesh.element,
            fixed,
            plan.element,
            PlaneStrain(specimen.contact_length),
        )
        layers = [specimen.material(name) for name in mesh.regions]
        known = moduli(
            [layer.youngs_modulus for layer in layers],
            [layer.poisson_ratio for layer in layers],
            self.prony,
            specimen.moduli,
        )
        shear = known.shear_long_term if plan.state == "long_term" else known.shear_instantaneous
        prony = self.prony if plan.effects["viscoelasticity"].on else None
        laws = assign([(layer.law.law, layer.law.constants) for layer in layers], mesh.region)
        args = (space, shear[mesh.region], known.bulk[mesh.region], prony)
        if plan.effects["finite_strain"].on:
            body = FiniteStrainBody(
                *args, pointwise=EDGE_STIFFNESS if self.profile.singular else None, laws=laws
            )
        else:
            body = SmallStrainBody(*args, laws=laws)
        return body, known.shear_instantaneous[mesh.region]

    def _receptors(self, instantaneous):
        receptors = self.scene.outputs.receptors
        depth, offset = (
            grid.ravel() for grid in np.meshgrid(receptors.depths, receptors.offsets, indexing="ij")
        )
        ridges = self.scene.specimen.ridges if self.plan.effects["ridges"].on else None
        if ridges is not None and ridges.outer is not None:
            points = below_outline(self.scene.specimen.outline, depth, offset)
        else:
            points = below_skin(self.whole, depth, offset)
        if self.mesh.half:
            points = np.abs(points * [1, 0]) + points * [0, 1]
        self.depth, self.offset = depth, offset
        return MaterialPoints(
            self.body, points, instantaneous if self.prony else None, self.mesh.half
        )

    def _skin(self):
        chain = skin_chain(self.mesh)
        x, y = self.mesh.points[chain].T
        apex = _apex(self.mesh.points[chain])
        spacing = float(np.hypot(np.diff(x), np.diff(y)).min())
        reach = 1.4 * self.plan.contact.half_width
        near = np.flatnonzero((np.abs(x - x[apex]) <= reach) & touched_side(y))
        start = (int(near.min()) - 8, int(near.max()) + 9)
        return Skin(chain, self.mesh.curves["skin"], spacing, start)

    def _require_room(self):
        """The stimulus must not come down on what is held: ends of the skin that are part of a
        fixed curve.
        """
        mesh = self.mesh
        held = np.intersect1d(
            self.skin.nodes, np.concatenate([np.unique(mesh.curves[name]) for name in mesh.fixed])
        )
        if not len(held):
            return
        depth = max(leg.depth or 0.0 for leg in self.scene.motion)
        room = self.profile.evaluate(mesh.points[held] - [0.0, self.stepper.height - depth])[0]
        if room.min() <= 1e-9 * np.ptp(mesh.points[:, 0]):
            x = 1e3 * mesh.points[held[np.argmin(room)], 0]
            raise PlanError(
                f"stimulus: comes down on the end of the skin at x = {x:.3g} mm, which is held; allowed: a narrower or more "
                "curved one, less depth, or a pad that is free there"
            )

    def run(self, progress) -> xr.Dataset:
        """The history; ``progress`` as in :func:`simulate`."""
        return _labelled(lambda: self.solve(progress))

    def solve(self, progress) -> Arrays:
        """The same without labels."""
        states: list[dict[str, np.ndarray]] = [self.receptors.sample(self.body)]
        done: list[Record] = []
        # one a leg and time: of the increments of a steady leg, all at one time, the last
        snapshots: dict[tuple[int, float], dict[str, np.ndarray]] = {}
        wanted = sorted(self.scene.outputs.snapshots)
        total = self._nominal_end()
        counts = {"iterations": 0, "cutbacks": 0}

        def after(record: Record):
            states.append(self._sampled(done[-1].time if done else 0.0))
            done.append(record)
            if among(wanted, record.time):
                snapshots[record.leg, record.time] = self._full_field(record)
            if progress:
                counts["iterations"] += record.iterations
                counts["cutbacks"] += record.halvings
                width = (
                    1e3 * np.ptp(self._edges(record)) / self.share
                    if record.nodal_force.any()
                    else 0.0
                )
                progress(
                    {"time_s": record.time, "end_time_s": total, "contact_width_mm": float(width)}
                    | counts
                )

        try:
            records = self.stepper.run(
                self.steps(), after, self.plan.between and Between(*self.plan.between)
            )
        except (NonConvergence, KeyboardInterrupt) as stop:
            stop.dataset = (
                self._history(done, states[: len(done) + 1], snapshots, complete=False)
                if done
                else None
            )
            stop.hard = hard_in(self.scene)
            raise
        if self.fields is not None and not snapshots and not wanted:
            snapshots[records[-1].leg, records[-1].time] = self._full_field(records[-1])
        return self._history(records, states, snapshots, complete=True)

    def _sampled(self, before: float) -> dict[str, np.ndarray]:
        """What the receptors feel now; an element that folds where one lies, between its quadrature
        points, ends the run.
        """
        with np.errstate(invalid="ignore"):
            sampled = self.receptors.sample(self.body)
        for name, values in sampled.items():
            if not np.isfinite(values).all():
                depth = 1e6 * self.depth[int(np.flatnonzero(~np.isfinite(values))[0])]
                raise NonConvergence(
                    before,
                    f"an element turns inside out at the receptor {depth:.4g} um deep ({name})",
                    FOLDED,
                )
        return sampled

    def _present(self):
        return self.stepper.force / self.share, self.stepper.depth, self.stepper.touching_depth()

    def steps(self):
        """Steps of the motion with forces on the part of the pad that is solved."""
        for step in schedule(self.scene, *self.plan.stepping, present=self._present):
            yield step if step.force is None else replace(step, force=step.force * self.share)

    def _nominal_end(self):
        last = 0.0
        for step in schedule(self.scene, *self.plan.stepping):
            last = step.time
        return last or 1.0

    def _errors(self, records, width) -> dict[str, Any]:
        """The plan's error law at the contact that was found: of legs' ends, the worst of these,
        the largest of any step.

        Of a leg's end at least a half where but a few nodes touch, and at least the share of the
        work that has gone missing in strokes: what jumps of nodes over sharp edges have cost. What
        has been unloaded to less than half of a force before is judged beside what that force did,
        and so are the steps on the way to a larger contact; a finger that is let go has no error
        left.
        """
        width, force = np.asarray(width[1:]), np.array([record.force for record in records])
        touching = np.array(
            [np.count_nonzero(record.nodal_force) / self.share for record in records]
        )
        ends = _leg_ends(records)
        lost = self._lost_work(records)
        stroke = (
            stroke_of(self.scene, self.profile.uneven)
            if any(record.distance for record in records)
            else None
        )
        own = {
            k: max(self._error_at(width[k], stroke), lost, 0.5 if touching[k] < 4 else 0.0)
            for k in ends
        }
        legs = []
        for k in ends:
            largest = int(np.argmax(force[: k + 1]))
            unloaded = force[k] < _UNLOADED * force[largest] and width[k] < width[largest]
            legs.append(own[k] * width[k] / width[largest] if unloaded else own[k])
        widths = np.unique(
            width[width > 0]
        )  # the law is smooth: some of a thousand tell the largest error of all
        some = widths[
            np.unique(np.linspace(0, len(widths) - 1, min(len(widths), _WIDTHS)).astype(int))
        ]
        beside = [self._error_at(each, stroke) * each / width.max() for each in some]
        judged = [k for k, error in zip(ends, legs, strict=True) if error == own[k]]
        narrowest = min((width[k] for k in judged), default=0.0)
        return {
            "estimated_error": float(max(legs)),
            "estimated_error_of_legs": json.dumps([float(error) for error in legs]),
            "largest_error": float(max([*legs, *beside])),
            "narrowest_half_width": max(narrowest / 2, 1e-9),
        }

    def _error_at(self, width, stroke) -> float:
        """The error law for a contact of ``width`` m, on a stroke if there is one."""
        plan = self.plan
        half_width = min(width / 2, plan.contact.narrowest or np.inf)
        around = plan.mesh_size and plan.mesh_size.skin_edge
        steps = plan.states_per_leg if plan.timed or plan.strokes else None
        edge, half_width, bumpy = (
            plan.contact_edge,
            half_width or _NO_CONTACT,
            self.scene.stimulus.irregular,
        )
        if plan.mesh_size is None:
            own = own_errors(
                plan.element,
                edge,
                half_width,
                plan.receptor_height,
                steps,
                stroke,
                rules=RULES,
                bumpy=bumpy,
            )
            found = max(own.values())
        else:
            found = estimated_error(
                edge, half_width, steps, stroke, around, rules=RULES, bumpy=bumpy
            )
        return max(found, plan.least_error) + plan.small_strain_error + plan.surface.error

    def _unbounded(self, record: Record) -> Unbounded:
        """Where in the contact of a state pressure has no bound."""
        on = self.skin.nodes[record.nodal_force > 0]
        if not len(on):
            return Unbounded()
        x = self.stepper.points[on, 0] + record.displacement[on, 0] + record.distance
        x = np.concatenate([x, -x]) if self.mesh.half else x
        near = self.plan.contact_edge + self.profile.edge_radius
        if self.plan.unresolved_edge:
            corners = np.array(self.profile.edges)
        else:
            pressure, half_width = (record.nodal_force / record.length).max(), np.ptp(x) / 2
            there = slice(*np.searchsorted(self.corners[:, 0], [x.min() - near, x.max() + near]))
            corners = seen_corners(
                self.corners[there], self.modulus, pressure, self.skin.spacing, half_width
            )
        corners = (
            corners[[np.abs(x - corner).min() <= near for corner in corners]]
            if len(corners)
            else corners
        )
        places = list(in_words(self.profile, corners))
        for node, angle in self.skin_ends:
            if node in on and ends_unbounded(angle, self.stepper.friction is not None):
                places.append(
                    f"the end of the skin at x = {self.mesh.points[node, 0] * 1e3:.4g} mm"
                )
        return Unbounded(tuple(places), bool(np.any(np.abs(corners - record.distance) <= 2 * near)))

    def _lost_work(self, records) -> float:
        missing = [
            record.work - record.energies[0] - record.energies[2] - record.frictional
            for record in records
        ]
        drift = [
            abs(now - before)
            for now, before, record, last in zip(
                missing[1:], missing, records[1:], records, strict=False
            )
            if record.leg == last.leg and self.scene.motion[record.leg].strokes
        ]
        return (
            sum(drift) / max((abs(record.work) for record in records), default=1.0)
            if drift
            else 0.0
        )

    def _doubts(self, records, pressures) -> Iterator[str]:
        """What should make a person doubt the states that were found."""
        missing = [
            record.work - record.energies[0] - record.energies[2] - record.frictional
            for record in records
        ]
        missing = np.abs(missing).max() / max(max(abs(record.work) for record in records), 1e-300)
        least = min(record.smallest_jacobian for record in records)
        if self.plan.timed and missing > _UNBALANCED and self.stepper.external is None:
            yield f"the energy found is off the work that was done by up to {missing:.1%}: more steps or a finer mesh will tell"
        if least < _SQUEEZED and not self.body.geometrically_linear:
            yield f"an element keeps {least:.1%} of its volume at one point: a finer mesh, or a fillet, will tell"
        uneven = max(
            (board for each in pressures if np.isfinite(board := checkerboard(*each))), default=0.0
        )
        if uneven > _UNEVEN and not any(self.unbounded):
            yield f"pressure goes up and down from node to node, by {uneven:.0%} of its peak (r.m.s.): a finer mesh will tell"
        if self.stepper.wavered:
            yield "states near to one another may be in equilibrium, and round-off choose between them: smaller steps will tell"

    def _notes(self, records, pressures):
        """What a person should know of the states that were found, and of the contact with a
        measured profile.

        pressures: (ns,) Pa at the ends of legs, at the nodes of the skin and their 5-point
        averages.
        """
        doubts, hard = list(self._doubts(records, pressures)), hard_in(self.scene)
        doubts += [f"or try {hard_here(hard)}"] if doubts and hard else []
        notes = [
            *doubts,
            *self.scene.stimulus.notes,
            *(note for note in self.plan.surface.notes if "expected" not in note),
        ]
        for record in records:
            on = self.skin.nodes[record.nodal_force > 0]
            x = self.stepper.points[on, 0] + record.displacement[on, 0] + record.distance
            over = np.array(
                [
                    self.profile.known[0] - x.min(initial=np.inf),
                    x.max(initial=-np.inf) - self.profile.known[1],
                ]
            )
            if over.max() > -self.plan.contact_edge:
                end = self.profile.known[int(over.argmax())]
                return [
                    *notes,
                    f"contact reached the end of the profile's points at x = {end * 1e3:.3g} mm, t = {record.time:.3g} s",
                ]
        return notes

    # -- back to the whole pad --------------------------------------------------------------------------------------

    def _full_field(self, record: Record) -> dict[str, np.ndarray]:
        """What a snapshot holds of the body that is solved, and the outline of the stimulus."""
        field = {
            "displacement": record.displacement,
            "pressure": self._element_pressure(),
            "indenter": self._outline(record),
        }
        if self.fields is not None:
            found = self.fields.sample(self.body) | self.fields.stress_and_strain(self.body)
            field |= {name: found[name] for name in FIELDS}
        return field

    def _outline(self, record: Record, points: int = 801) -> np.ndarray:
        """(n, 2) m, the stimulus where it is over the pad; NaN where there is none."""
        low, high = self.whole.points.min(0), self.whole.points.max(0)
        x = np.linspace(low[0], high[0], points)
        y = self.profile.outline(x + record.distance) + self.stepper.height - record.depth
        return np.column_stack([x, np.where(y <= high[1] + np.ptp([low[1], high[1]]), y, np.nan)])

    def _element_pressure(self):
        modes = self.body.dilatation()
        space = self.body.space
        mean = np.einsum("eq,eqb,eb->e", space.weight, space.psi, modes) / space.weight.sum(1)
        return self.body.bulk * mean

    def _edges(self, record):
        """Of the contact, gaps within it included; of a half model from the middle on."""
        return (0.0, record.edges[1]) if self.mesh.half else record.edges

    def _gaps(self, record) -> float:
        """Length (m) of skin within the contact that does not touch."""
        on = np.flatnonzero(record.nodal_force > 0)
        if not len(on):
            return 0.0
        inside = slice(0 if self.mesh.half else on[0], on[-1])
        length = np.where(record.nodal_force[inside] > 0, 0.0, record.length[inside])
        return float(length.sum())

    def _history(self, records: list[Record], states, snapshots, complete: bool):
        unfold = _Unfolding(self.whole, self.mesh, self.skin.nodes)
        count = len(records) + 1
        chain = skin_chain(self.whole)
        out = {
            name: np.zeros(count)
            for name in (
                "force",
                "tangential_force",
                "indentation_depth",
                "contact_width",
                "touching_width",
                "centre_pressure",
                "peak_pressure",
                "centre_lateral_displacement",
                "residual",
                "complementarity_error",
                "energy_balance_error",
                "external_work",
                "stored_energy",
                "dissipated_energy",
                "frictional_dissipation",
                "stroke_distance",
            )
        }
        out |= {
            name: np.zeros(count, np.int32) for name in ("leg", "newton_iterations", "cutbacks")
        }
        out["min_detF"] = np.ones(count)
        for name in (
            "contact_pressure",
            "contact_pressure_smoothed",
            "skin_displacement_x",
            "skin_displacement_y",
        ):
            out[name] = np.zeros((count, len(chain)))
        if self.stepper.friction is not None:
            out |= {name: np.zeros((count, len(chain))) for name in ("tangential_traction", "slip")}
            out["contact_state"] = np.zeros((count, len(chain)), np.int8)
        apex = _apex(self.whole.points[chain])
        for k, record in enumerate(records, start=1):
            length = record.length
            smooth = smoothed_pressure(record.nodal_force, length, self.mesh.half)
            edges = self._edges(record)
            u = record.displacement[self.skin.nodes]
            row = {
                "force": record.force / self.share,
                "tangential_force": 0.0 if self.mesh.half else record.tangential_force,
                "indentation_depth": record.depth,
                "contact_width": max(np.nan_to_num(edges[1] - edges[0]), 0.0) / self.share,
                "touching_width": max(np.nan_to_num(edges[1] - edges[0] - self._gaps(record)), 0.0)
                / self.share,
                "residual": record.residual,
                "complementarity_error": record.complementarity,
                "energy_balance_error": record.energy_error,
                "external_work": record.work / self.share,
                "stored_energy": (record.energies[0] + record.energies[1]) / self.share,
                "dissipated_energy": record.dissipated / self.share,
                "frictional_dissipation": record.frictional / self.share,
                "stroke_distance": record.distance,
                "leg": record.leg,
                "newton_iterations": record.iterations,
                "cutbacks": record.halvings,
                "min_detF": record.smallest_jacobian,
                "contact_pressure": unfold.skin(record.nodal_force / length),
                "contact_pressure_smoothed": unfold.skin(smooth),
                "skin_displacement_x": unfold.skin(u[:, 0], odd=True),
                "skin_displacement_y": unfold.skin(u[:, 1]),
            }
            if record.state is not None:
                row["tangential_traction"] = unfold.skin(record.tangential / length, odd=True)
                row |= {
                    "slip": unfold.skin(record.slip, odd=True),
                    "contact_state": unfold.skin(record.state),
                }
            for name, value in row.items():
                out[name][k] = value
            out["peak_pressure"][k] = out["contact_pressure"][k].max()
            out["centre_pressure"][k] = out["contact_pressure"][k, apex]
            out["centre_lateral_displacement"][k] = out["skin_displacement_x"][k, apex]
        for name in states[0]:
            out[name] = np.array([state[name] for state in states])
        widths = out["contact_width"]
        pressures = [
            (out["contact_pressure"][k + 1], out["contact_pressure_smoothed"][k + 1])
            for k in _leg_ends(records)
        ]
        time_found = np.array([0.0] + [record.time for record in records])
        out, times = at_outputs(
            out, time_found, records, self.whole.points[chain, 0], apex, self.mesh.half
        )
        coordinates = {
            "time": apart(times),
            "receptor_depth": self.depth,
            "receptor_offset": self.offset,
            "skin_x": self.whole.points[chain, 0],
            "skin_y": self.whole.points[chain, 1],
            "skin_arc": skin_arc(*self.whole.points[chain].T, apex),
        }
        self.unbounded = [self._unbounded(record) for record in records]
        worst = max(
            self.unbounded, key=lambda each: (each.centre, len(each.text)), default=Unbounded()
        )
        once = compiling() - self.compiling  # for the first of all simulations on these elements
        cost = {
            "cpu_s": round(time.process_time() - self.cpu - once, 4),
            "compiling_s": round(once, 4),
            "wall_s": round(time.perf_counter() - self.wall, 4),
            "peak_rss_MB": round(peak_memory_MB(), 1),
            "nodes": int(len(self.mesh.points)),
            "unknowns": int(self.body.space.size),
            "factorisations": int(self.stepper.factorisations),
            "linear_solver": self.stepper.solver.name,
        }
        history = arrays(
            out,
            coordinates,
            {
                "title": f"fingerpad history of {self.scene.name}",
                "complete": int(complete),
                "scene": self.scene.canonical(),
                "plan": self.plan.to_dict(),
                "cost": cost,
                **self._errors(records, widths),
                "error_covers": worst.covers + self.plan.strokes * OF_STROKES,
                "singular": int(bool(worst)),
                "unbounded_at": worst.text,
                "unbounded_at_of_legs": json.dumps(
                    [self.unbounded[k].text for k in _leg_ends(records)]
                ),
                "notes": self._notes(records, pressures),
                "provenance": provenance(),
            },
        )
        history["time"].attrs["comment"] = (
            f"states of a leg that takes no time stand {INSTANT:g} s apart"
        )
        if snapshots:
            found = {
                name: [field[name] for field in snapshots.values()]
                for name in next(iter(snapshots.values()))
            }
            add_snapshots(
                history,
                [history["time"].values[_last(out["leg"], times, *key)] for key in snapshots],
                self.whole.points,
                self.whole.cells,
                self.whole.region,
                np.array([unfold.nodes(u) for u in found.pop("displacement")]),
                np.array([unfold.elements(p) for p in found.pop("pressure")]),
                self.whole.regions,
                np.array(found.pop("indenter")),
                {
                    name: np.array([unfold.elements(values, name) for values in each])
                    for name, each in found.items()
                },
            )
        wanted = self.scene.outputs.responses
        if wanted and out["leg"].size > 1 and coordinates["time"][-1] > NO_TIME:
            from fingerpad.receptors.respond import respond  # here, for xarray is slow to import

            history = Arrays.of(history.labelled().merge(respond(history.labelled(), wanted)))
        if worst:
            for name in (
                "peak_pressure",
                "contact_pressure",
                *(["centre_pressure"] if worst.centre else []),
            ):
                history[name].attrs["comment"] = (
                    f"pressure is unbounded at {worst.text}: its largest value is the mesh's"
                )
        return history


def _last(legs: np.ndarray, times: np.ndarray, leg: int, time: float) -> int:
    """The last output of a leg at a time."""
    return int(np.flatnonzero((legs == leg) & (np.abs(times - time) <= 1e-9 * time))[-1])


def _leg_ends(records) -> list[int]:
    """Which of the states found are the last ones of their legs."""
    return [
        k
        for k, record in enumerate(records)
        if k + 1 == len(records) or records[k + 1].leg != record.leg
    ]


def _apex(skin: np.ndarray) -> int:
    """Index of the skin node (ns, 2) nearest to x = 0 on the side that is touched."""
    x, y = skin.T
    return int(np.argmin(np.where(touched_side(y), np.abs(x), np.inf)))


class _Unfolding:
    """Values of the solved mesh on the whole mesh; the identity when the whole pad was solved."""

    def __init__(self, whole: PadMesh, solved: PadMesh, skin_nodes: np.ndarray):
        self.left = whole.points[:, 0] < 0 if solved.half else np.zeros(len(whole.points), bool)
        self._mirrored = (
            whole.points[whole.cells].mean(1)[:, 0] < 0
            if solved.half
            else np.zeros(len(whole.cells), bool)
        )
        if not solved.half:
            self.node = np.arange(len(whole.points))
            self.element = np.arange(len(whole.cells))
        else:
            self.node = _mirror_match(solved.points, whole.points)
            self.element = _mirror_match(
                solved.points[solved.cells].mean(1), whole.points[whole.cells].mean(1)
            )
        chain = skin_chain(whole)
        position = np.full(len(solved.points), -1)
        position[skin_nodes] = np.arange(len(skin_nodes))
        self._skin, self._skin_left = position[self.node[chain]], self.left[chain]

    def nodes(self, field):
        out = field[self.node].copy()
        out[self.left, 0] *= -1
        return out

    def elements(self, values, name=""):
        out = values[self.element]
        if name == "cauchy_stress":  # the shear stress xy changes its sign in a mirror
            out[self._mirrored, 2] *= -1
        return out

    def skin(self, values, odd=False):
        out = values[self._skin]
        return np.where(self._skin_left, -out, out) if odd else out


def _mirror_match(solved, whole):
    right, near = np.column_stack([np.abs(whole[:, 0]), whole[:, 1]]), 1e-6 * np.ptp(whole[:, 0])
    distance, index = KDTree(solved).query(right)
    assert distance.max() <= near, "the half mesh is not half of the whole"
    return index

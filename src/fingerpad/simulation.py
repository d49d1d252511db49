"""One scene, simulated: the plan composes body, contact and receptors; the stepper runs; the
history is unfolded.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from scipy.spatial import KDTree
from threadpoolctl import threadpool_limits

from fingerpad.compiled import Stopwatch
from fingerpad.dense_output import at_outputs
from fingerpad.laws import assign
from fingerpad.mechanics.finite_strain import FiniteStrainBody
from fingerpad.mechanics.kinematics import KINEMATICS
from fingerpad.mechanics.pressure import checkerboard, smoothed_pressure
from fingerpad.mechanics.small_strain import SmallStrainBody
from fingerpad.mechanics.space import Space
from fingerpad.mechanics.stepping import (
    FOLDED,
    VOLUME_TOLERANCE,
    NewtonSettings,
    NonConvergence,
    QuasiStatic,
    Record,
    Skin,
    hard_here,
)
from fingerpad.mechanics.strides import Between
from fingerpad.planning.bounds import PlanError
from fingerpad.planning.errors import ContactErrors, stroke_of
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
    unseen_error,
)
from fingerpad.processes import told_in_a_notebook
from fingerpad.receptors.material_points import MaterialPoints
from fingerpad.receptors.recovery import ReceptorError
from fingerpad.receptors.respond import respond
from fingerpad.results import (
    FIELDS,
    add_snapshots,
    history_of,
    peak_memory_MB,
    provenance,
    skin_arc,
)
from fingerpad.scenes.scene import Scene, load_scene
from fingerpad.specimen import mesh_for
from fingerpad.specimen.materials import Prony, moduli
from fingerpad.specimen.measures import (
    below_outline,
    below_skin,
    layers_below,
    skin_ends,
    touched_side,
)
from fingerpad.specimen.pad import PadMesh, skin_chain
from fingerpad.stimuli.motion import INSTANT, NO_TIME, among, apart

_plan = plan

#: Unprojected volumetric stiffness under edge indenters, in shear moduli.
EDGE_STIFFNESS = 5.0
#: What to try where a stimulus goes through.
PASSED = "a finer skin mesh, a wider or blunter stimulus, or a smaller force"
#: A leg that ends below this share of a force reached before counts as unloaded.
UNLOADED_FORCE = 0.5
#: Number of contact widths at which the error law is looked up.
ERROR_WIDTHS = 64
#: m, half-width that stands for no contact.
NO_CONTACT_WIDTH = 1e-5
#: Warn above this share of the work that is missing from the energy.
MAX_ENERGY_WARNING = 0.03
#: Warn below this det F.
MIN_DET_F_WARNING = 0.1
#: Warn above this unevenness of pressure from node to node (r.m.s. over the peak).
MAX_UNEVEN_WARNING = 0.15
#: How often a step that failed is gone on with from its last good state.
PATIENCE = 1
#: Force out of balance, over that of the contact, that a body of revolution leaves: a point beside
#: the axis may carry no more than a ten-thousandth of it.
ROUND_TOLERANCE = 1e-5
#: Bulk over shear modulus above which the tangent needs double precision.
MAX_BULK_SINGLE = 200.0


def solve(
    scene: Scene | str | Path | Mapping[str, Any],
    plan: Plan | None = None,
    mesh: PadMesh | None = None,
    progress: Callable[[dict[str, Any]], None] | None = None,
    fields: bool = False,
) -> xr.Dataset:
    """Simulate a scene as it is planned: :func:`fingerpad.healing.simulate`, which has the same
    parameters and errors, without its answers to trouble.
    """
    scene = load_scene(scene)
    chosen = plan or _plan(scene)
    with threadpool_limits(1), told_in_a_notebook(progress) as progress:
        history = Simulation(scene, chosen, mesh, fields).run(progress)
        runs = [_outcome(history)]
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
            following = replace(following, relaxed=chosen.relaxed)
            try:
                again = Simulation(scene, following, None, fields).run(progress)
            except NonConvergence:
                why_not = f"the refined run on {following.nodes} nodes did not converge"
                break
            except KeyboardInterrupt as stop:
                vars(stop)["dataset"] = history  # the run before is whole
                raise
            runs.append(_outcome(again))
            chosen, history = following, again
    missed = chosen.missed(history.attrs["estimated_error"])
    history.attrs |= {
        "asked_error": np.nan if chosen.asked_error is None else chosen.asked_error,
        "tolerance": "" if missed is None else f"{missed}; {why_not}".removesuffix("; "),
        "runs": json.dumps(runs),
    }
    return history


def _outcome(history: xr.Dataset) -> dict[str, Any]:
    """What is kept of a run that may be run again: its nodes and its own estimate of its error."""
    return {
        "nodes": json.loads(history.attrs["cost"])["nodes"],
        "estimated_error": history.attrs["estimated_error"],
    }


class Simulation:
    """The parts of one simulation, composed by its plan, and their way back to the whole pad."""

    def __init__(self, scene: Scene, plan: Plan, mesh: PadMesh | None, fields: bool = False):
        self.watch = Stopwatch()
        self.scene, self.plan, self.parts = scene, plan, plan.parts(scene)
        self.whole = (mesh or mesh_for(scene, plan)).elevated(plan.element)
        self.mesh = self.whole.right_half() if self.parts.half else self.whole
        self.kinematics, self.sides = KINEMATICS[scene.kinematics], 2 if self.mesh.half else 1
        if scene.axisymmetric:  # half the section is the whole body
            self.whole = self.mesh
        self.share = 1.0 if scene.axisymmetric else 1 / self.sides
        specimen = self.parts.scene.specimen
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
        self.fields, observers = None, [self.receptors]
        if fields:
            self.fields = MaterialPoints.centres(self.body, instantaneous if self.prony else None)
            observers.append(self.fields)
        soft = float((self.body.bulk / self.body.shear).max()) < MAX_BULK_SINGLE
        settings = NewtonSettings(single=soft and not plan.relaxed.precise)
        if self.kinematics.round:
            usual = VOLUME_TOLERANCE * settings.force_tolerance
            settings = replace(settings, force_tolerance=ROUND_TOLERANCE, volume_tolerance=usual)
        if plan.newton_tolerance:
            settings = replace(settings, force_tolerance=plan.newton_tolerance)
        self.stepper = QuasiStatic(
            self.body,
            self.skin,
            self.profile,
            settings,
            observers,
            friction=self.parts.friction,
            patience=PATIENCE if scene.relaxing else 0,
            most=plan.relaxed.most_factorisations,
        )
        self._require_room()

    def _body(self):
        specimen, plan, mesh = self.parts.scene.specimen, self.plan, self.mesh
        fixed = np.zeros(mesh.points.shape, bool)
        for name in mesh.fixed:
            fixed[np.unique(mesh.curves[name])] = True
        if mesh.half:
            fixed[np.unique(mesh.curves["symmetry"]), 0] = True
        kind = mesh.element, fixed, plan.element, self.kinematics
        space = Space(mesh.points, mesh.cells, *kind)
        layers = [specimen.material(name) for name in mesh.regions]
        known = moduli(
            [layer.youngs_modulus for layer in layers],
            [layer.poisson_ratio for layer in layers],
            self.prony,
            specimen.moduli,
        )
        shear = known.shear_long_term if plan.state == "long_term" else known.shear_instantaneous
        prony = self.prony if self.parts.relaxes else None
        laws = assign([(layer.law.law, layer.law.constants) for layer in layers], mesh.region)
        args = (space, shear[mesh.region], known.bulk[mesh.region], prony)
        if self.parts.large_strain:
            pointwise = EDGE_STIFFNESS if self.profile.singular else None
            body = FiniteStrainBody(*args, pointwise=pointwise, laws=laws)
        else:
            body = SmallStrainBody(*args, laws=laws)
        return body, known.shear_instantaneous[mesh.region]

    def _receptors(self, instantaneous):
        receptors = self.scene.outputs.receptors
        depth, offset = (
            grid.ravel() for grid in np.meshgrid(receptors.depths, receptors.offsets, indexing="ij")
        )
        ridges = self.parts.ridges
        if self.scene.axisymmetric:
            offset = np.abs(offset)
        if ridges is not None and ridges.outer is not None:
            points = below_outline(self.scene.specimen.outline, depth, offset)
        else:
            points = below_skin(self.whole, depth, offset)
        if self.mesh.half:
            points = np.abs(points * [1, 0]) + points * [0, 1]
        self.depth, self.offset = depth, offset
        try:
            return MaterialPoints(
                self.body, points, instantaneous if self.prony else None, self.mesh.half
            )
        except ReceptorError as error:
            room = min(
                sum(thickness for _, thickness in layers_below(self.whole, x))
                for x in receptors.offsets
            )
            raise ReceptorError(
                f"{error}; allowed: depths below {room * 1e3:.3g} mm, where the pad ends"
            ) from None

    def _skin(self):
        chain = skin_chain(self.mesh)
        x, y = self.mesh.points[chain].T
        apex = _apex(self.mesh.points[chain])
        spacing = float(np.hypot(np.diff(x), np.diff(y)).min())
        reach = 1.4 * self.plan.contact.half_width
        near = np.flatnonzero(
            (np.abs(x - x[apex]) <= reach) & touched_side(self.mesh.points[chain])
        )
        start = (int(near.min()) - 8, int(near.max()) + 9)
        return Skin(chain, self.mesh.curves["skin"], spacing, start)

    def _require_room(self):
        """The stimulus must not come down on what is held: ends of the skin that are part of a
        fixed curve.
        """
        mesh = self.mesh
        fixed = np.concatenate([mesh.curves[name].ravel() for name in mesh.fixed])
        held = np.intersect1d(self.skin.nodes, fixed)
        if not len(held):
            return
        depth = max(leg.depth or 0.0 for leg in self.scene.motion)
        room = self.profile.evaluate(mesh.points[held] - [0.0, self.stepper.height - depth])[0]
        if room.min() <= 1e-9 * np.ptp(mesh.points[:, 0]):
            x = 1e3 * mesh.points[held[np.argmin(room)], 0]
            raise PlanError(
                f"stimulus: comes down on the end of the skin at x = {x:.3g} mm, which is held; "
                "allowed: a narrower or more curved one, less depth, or a pad that is free there"
            )

    def run(self, progress) -> xr.Dataset:
        """The history; ``progress`` as in :func:`fingerpad.healing.simulate`."""
        states: list[dict[str, np.ndarray]] = [self.receptors.sample(self.body)]
        done: list[Record] = []
        # one a leg and time: of the increments of a steady leg, all at one time, the last
        snapshots: dict[tuple[int, float], dict[str, np.ndarray]] = {}
        wanted = sorted(self.scene.outputs.snapshots)
        *_, last = schedule(self.scene, *self.plan.stepping)
        counts = {"iterations": 0, "cutbacks": 0}
        between = self.plan.between and Between(*self.plan.between)

        height = float(np.ptp(self.mesh.points[:, 1]))

        def after(record: Record):
            if record.depth > height:
                reason = (
                    f"the stimulus is {1e3 * record.depth:.3g} mm deep in a pad that is "
                    f"{1e3 * height:.3g} mm high"
                )
                raise NonConvergence(
                    done[-1].time if done else 0.0,
                    f"{reason}, so it has passed between nodes",
                    PASSED,
                )
            states.append(self._sampled(done[-1].time if done else 0.0))
            done.append(record)
            if among(wanted, record.time):
                snapshots[record.leg, record.time] = self._full_field(record)
            if progress:
                counts["iterations"] += record.iterations
                counts["cutbacks"] += record.halvings
                width = 1e3 * self._width(record)
                times = {"time_s": record.time, "end_time_s": last.time or 1.0}
                progress(times | {"contact_width_mm": width} | counts)

        try:
            records = self.stepper.run(self.steps(), after, between)
        except (NonConvergence, KeyboardInterrupt) as stop:
            known = {"hard": hard_in(self.scene), "factorisations": self.stepper.factorisations}
            vars(stop).update(dataset=None, **known)
            if done:
                whole = self._history(done, states[: len(done) + 1], snapshots, False)
                vars(stop)["dataset"] = whole
            raise
        if self.fields is not None and not snapshots and not wanted:
            snapshots[records[-1].leg, records[-1].time] = self._full_field(records[-1])
        return self._history(records, states, snapshots, True)

    def _sampled(self, before: float) -> dict[str, np.ndarray]:
        """What the receptors feel now; an element that folds where one lies, between its quadrature
        points, ends the run.
        """
        with np.errstate(invalid="ignore"):
            sampled = self.receptors.sample(self.body)
        for name, values in sampled.items():
            if not np.isfinite(values).all():
                depth = 1e6 * self.depth[int(np.flatnonzero(~np.isfinite(values))[0])]
                where = f"the receptor {depth:.4g} um deep ({name})"
                raise NonConvergence(before, f"an element turns inside out at {where}", FOLDED)
        return sampled

    def steps(self):
        """Steps of the motion with forces on the part of the pad that is solved."""
        stepper = self.stepper

        def present():
            return stepper.force / self.share, stepper.depth, stepper.touching_depth()

        for step in schedule(self.scene, *self.plan.stepping, present=present):
            yield step if step.force is None else replace(step, force=step.force * self.share)

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
        ends, lost = _leg_ends(records), self._lost_work(records)
        strokes = any(record.distance for record in records)
        stroke = stroke_of(self.scene, self.profile.uneven) if strokes else None
        legs, judged = [], []
        for k in ends:
            few = self.sides * np.count_nonzero(records[k].nodal_force) < 4
            error = max(self._error_at(width[k], stroke), lost, 0.5 if few else 0.0)
            error = max(error, self._unseen(records[k]))
            largest = int(np.argmax(force[: k + 1]))
            if force[k] < UNLOADED_FORCE * force[largest] and width[k] < width[largest]:
                error *= width[k] / width[largest]
            else:
                judged.append(width[k])
            legs.append(float(error))
        # the law is smooth: some of a thousand widths tell the largest error of all
        widths = np.unique(width[width > 0])
        some = np.linspace(0, len(widths) - 1, min(len(widths), ERROR_WIDTHS)).astype(int)
        beside = [self._error_at(w, stroke) * w / width.max() for w in widths[np.unique(some)]]
        return {
            "estimated_error": max(legs),
            "estimated_error_of_legs": json.dumps(legs),
            "largest_error": float(max([*legs, *beside])),
            "narrowest_half_width": max(min(judged, default=0.0) / 2, 1e-9),
        }

    def _error_at(self, width, stroke) -> float:
        """The error law for a contact of ``width`` m, on a stroke if there is one."""
        plan, bumpy = self.plan, self.scene.stimulus.irregular
        half_width = min(width / 2, plan.contact.narrowest or np.inf) or NO_CONTACT_WIDTH
        steps = plan.states_per_leg if plan.timed or plan.strokes else None
        turned = self.scene.axisymmetric
        errors = ContactErrors(RULES, half_width, steps, stroke, bumpy, turned)
        if plan.mesh_size is None:
            by_quantity = errors.on_own_mesh(plan.element, plan.contact_edge, plan.receptor_height)
            error = max(by_quantity.values())
        else:
            error = errors.on_built_mesh(plan.contact_edge, plan.mesh_size.skin_edge)
        return max(error, plan.least_error) + plan.small_strain_error + plan.surface.error

    def _unbounded(self, record: Record) -> Unbounded:
        """Where in the contact of a state pressure has no bound."""
        on, x = self._touching(record)
        if not len(on):
            return Unbounded()
        x = np.concatenate([x, -x]) if self.mesh.half else x
        near = self.plan.contact_edge
        if self.plan.unresolved_edge:
            corners = self.profile.tangents()
        else:
            corners = seen_corners(*self._corners(record, x))
        if len(corners):
            corners = corners[[np.abs(x - corner).min() <= near for corner in corners]]
        places = list(in_words(self.profile, corners))
        for node, angle in self.skin_ends:
            if node in on and ends_unbounded(angle, self.stepper.friction is not None):
                end = self.mesh.points[node, 0] * 1e3
                places.append(f"the end of the skin at x = {end:.4g} mm")
        return Unbounded(tuple(places), bool(np.any(np.abs(corners - record.distance) <= 2 * near)))

    def _corners(self, record, x):
        """What :func:`seen_corners` has to know of a state that touches the profile at x (k,) m."""
        near, pressure = self.plan.contact_edge, (record.nodal_force / record.length).max()
        there = slice(*np.searchsorted(self.corners[:, 0], [x.min() - near, x.max() + near]))
        known = self.modulus, pressure, self.skin.spacing, np.ptp(x) / 2
        return self.corners[there], *known

    def _unseen(self, record) -> float:
        """Error because of the corners between the points of a profile that is turned."""
        _, x = self._touching(record)
        if not (self.scene.axisymmetric and self.scene.stimulus.irregular and len(x)):
            return 0.0
        return unseen_error(*self._corners(record, np.concatenate([x, -x])))

    def _touching(self, record):
        """Nodes of the skin that touch (k,), and where on the profile they are (k,), m."""
        on = self.skin.nodes[record.nodal_force > 0]
        return on, self.stepper.points[on, 0] + record.displacement[on, 0] + record.distance

    def _lost_work(self, records) -> float:
        """Share of the work that has gone missing in strokes."""
        missing, most = _missing_work(records)
        strokes = np.array([bool(self.scene.motion[record.leg].strokes) for record in records])
        same_leg = np.diff([record.leg for record in records]) == 0
        drift = np.abs(np.diff(missing))[same_leg & strokes[1:]]
        return sum(drift) / most if len(drift) else 0.0

    def _doubts(self, records, pressures) -> Iterator[str]:
        """What should make a person doubt the states that were found."""
        missing, most = _missing_work(records)
        missing = np.abs(missing).max() / max(most, 1e-300)
        least = min(record.smallest_jacobian for record in records)
        if self.plan.timed and missing > MAX_ENERGY_WARNING:
            off = f"the energy found is off the work that was done by up to {missing:.1%}"
            yield f"{off}: repeat with more steps or a finer mesh to check"
        if least < MIN_DET_F_WARNING and not self.body.geometrically_linear:
            volume = f"an element keeps {least:.1%} of its volume at one point"
            yield f"{volume}: repeat with a finer mesh, or a fillet, to check"
        uneven = np.nanmax([0.0, *(checkerboard(*pair) for pair in pressures)])
        if uneven > MAX_UNEVEN_WARNING and not any(self.unbounded):
            share = f"{uneven:.0%} of its peak (r.m.s.)"
            uneven_by = f"pressure goes up and down from node to node, by {share}"
            yield f"{uneven_by}: repeat with a finer mesh to check"
        if self.stepper.wavered:
            near = "states near to one another may be in equilibrium"
            yield f"{near}, and round-off choose between them: repeat with smaller steps to check"

    def _notes(self, records, pressures):
        """What a person should know of the states that were found, and of the contact with a
        measured profile.

        pressures: (ns,) Pa at the ends of legs, at the nodes of the skin and their 5-point
        averages.
        """
        doubts, hard = list(self._doubts(records, pressures)), hard_in(self.scene)
        self.doubts = doubts[:]
        doubts += [f"or try {hard_here(hard)}"] if doubts and hard else []
        if resumed := self.stepper.resumed:
            when = " and ".join(f"t = {time:.6g} s" for time in resumed)
            doubts.append(f"broke off after {when}, and went on from there in smaller steps")
        notes = [
            *doubts,
            *self.scene.stimulus.notes,
            *(note for note in self.plan.surface.notes if "expected" not in note),
        ]
        low, high = self.profile.known
        for record in records:
            x = self._touching(record)[1]
            beyond = {low: low - x.min(initial=np.inf), high: x.max(initial=-np.inf) - high}
            end = max(beyond, key=beyond.get)
            if beyond[end] > -self.plan.contact_edge:
                where = f"x = {end * 1e3:.3g} mm, t = {record.time:.3g} s"
                return [*notes, f"contact reached the end of the profile's points at {where}"]
        return notes

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

    def _width(self, record, gaps=0.0) -> float:
        """Width (m) of the contact of the whole pad, less ``gaps`` (m) of the part solved; the
        diameter of a round one.
        """
        left, right = (0.0, record.edges[1]) if self.mesh.half else record.edges
        return float(max(np.nan_to_num(right - left - gaps), 0.0) * self.sides)

    def _gaps(self, record, length) -> float:
        """Length (m, or m^2: of what is in ``length``) of skin in the contact that does not
        touch.
        """
        on = np.flatnonzero(record.nodal_force > 0)
        if not len(on):
            return 0.0
        inside = slice(0 if self.mesh.half else on[0], on[-1])
        return float(np.where(record.nodal_force[inside] > 0, 0.0, length[inside]).sum())

    def _ways(self, record) -> np.ndarray:
        """Length (ns,) m of skin along the section that belongs to each node."""
        if not self.scene.axisymmetric:
            return record.length
        skin = self.stepper.points[self.skin.nodes] + record.displacement[self.skin.nodes]
        half = np.hypot(*np.diff(skin, axis=0).T) / 2
        return np.append(half, 0.0) + np.append(0.0, half)

    def _row(self, record: Record, unfold: _Unfolding, apex: int) -> dict[str, Any]:
        """What a history holds of one state, for the whole pad."""
        length, share, half = record.length, self.share, self.mesh.half
        smooth = smoothed_pressure(record.nodal_force, length, half)
        u = record.displacement[self.skin.nodes]
        pressure, lateral = unfold.skin(record.nodal_force / length), unfold.skin(u[:, 0], odd=True)
        row = {
            "force": record.force / share,
            "tangential_force": 0.0 if half else record.tangential_force,
            "indentation_depth": record.depth,
            "contact_width": self._width(record),
            "touching_width": self._width(record, self._gaps(record, self._ways(record))),
            "centre_pressure": pressure[apex],
            "peak_pressure": pressure.max(),
            "centre_lateral_displacement": lateral[apex],
            "residual": record.residual,
            "complementarity_error": record.complementarity,
            "energy_balance_error": record.energy_error,
            "external_work": record.work / share,
            "stored_energy": (record.energies[0] + record.energies[1]) / share,
            "dissipated_energy": record.dissipated / share,
            "frictional_dissipation": record.frictional / share,
            "stroke_distance": record.distance,
            "leg": np.int32(record.leg),
            "newton_iterations": np.int32(record.iterations),
            "cutbacks": np.int32(record.halvings),
            "min_detF": record.smallest_jacobian,
            "contact_pressure": pressure,
            "contact_pressure_smoothed": unfold.skin(smooth),
            "skin_displacement_x": lateral,
            "skin_displacement_y": unfold.skin(u[:, 1]),
        }
        if self.scene.axisymmetric:
            radius = row["contact_width"] / 2
            area = np.pi * radius**2 - self._gaps(record, length)
            row |= {"contact_radius": radius, "contact_area": max(area, 0.0)}
        if record.state is not None:
            row["tangential_traction"] = unfold.skin(record.tangential / length, odd=True)
            row["slip"] = unfold.skin(record.slip, odd=True)
            row["contact_state"] = unfold.skin(record.state)
        return row

    def _history(self, records: list[Record], states, snapshots, complete: bool):
        unfold = _Unfolding(self.whole, self.mesh, self.skin.nodes)
        chain = skin_chain(self.whole)
        skin, ends = self.whole.points[chain], _leg_ends(records)
        apex = _apex(skin)
        rows = [self._row(record, unfold, apex) for record in records]
        # before all of them the unloaded pad
        rows.insert(0, {name: np.zeros_like(value) for name, value in rows[0].items()})
        out = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        out["min_detF"][0] = 1.0
        out |= {name: np.array([state[name] for state in states]) for name in states[0]}
        widths = out["contact_width"]
        pressures = [
            (out["contact_pressure"][k + 1], out["contact_pressure_smoothed"][k + 1]) for k in ends
        ]
        time_found = np.array([0.0] + [record.time for record in records])
        out, times = at_outputs(out, time_found, records, skin[:, 0], apex, self.mesh.half)
        coordinates = {
            "time": apart(times),
            "receptor_depth": self.depth,
            "receptor_offset": self.offset,
            "skin_x": skin[:, 0],
            "skin_y": skin[:, 1],
            "skin_arc": skin_arc(skin[:, 0], skin[:, 1], apex),
        }
        self.unbounded = [self._unbounded(record) for record in records]
        worst = max(
            self.unbounded, key=lambda each: (each.centre, len(each.text)), default=Unbounded()
        )
        cost = {
            **self.watch.read(),
            "peak_rss_MB": round(peak_memory_MB(), 1),
            "nodes": int(len(self.mesh.points)),
            "unknowns": int(self.body.space.size),
            "factorisations": int(self.stepper.factorisations),
            "linear_solver": self.stepper.solver.name,
        }
        history = history_of(
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
                "unbounded_at_of_legs": json.dumps([self.unbounded[k].text for k in ends]),
                "notes": self._notes(records, pressures),
                "provenance": provenance(),
            },
        )
        history["time"].attrs["comment"] = (
            f"states of a leg that takes no time stand {INSTANT:g} s apart"
        )
        if snapshots:
            first, *_ = found = list(snapshots.values())
            fields = {
                name: np.array([unfold.field(name, field[name]) for field in found])
                for name in first
            }
            outputs = [_last(out["leg"], times, *key) for key in snapshots]
            add_snapshots(history, history["time"].values[outputs], self.whole, fields)
        if self.doubts:
            history.attrs["doubts"] = json.dumps(self.doubts)
        wanted = self.scene.outputs.responses
        if wanted and out["leg"].size > 1 and coordinates["time"][-1] > NO_TIME:
            history = history.merge(respond(history, wanted))
        if worst:
            comment = f"pressure is unbounded at {worst.text}: its largest value is the mesh's"
            names = ["peak_pressure", "contact_pressure"] + ["centre_pressure"] * worst.centre
            for name in names:
                history[name].attrs["comment"] = comment
        return history


def _last(legs: np.ndarray, times: np.ndarray, leg: int, time: float) -> int:
    """The last output of a leg at a time."""
    return int(np.flatnonzero((legs == leg) & (np.abs(times - time) <= 1e-9 * time))[-1])


def _leg_ends(records) -> list[int]:
    """Which of the states found are the last ones of their legs."""
    legs = [record.leg for record in records]
    return np.flatnonzero(np.diff(legs, append=-1)).tolist()


def _missing_work(records) -> tuple[np.ndarray, float]:
    """Work that is not in the energy of the states (states,), J/m, and the largest work."""
    missing = [
        record.work - record.energies[0] - record.energies[2] - record.frictional
        for record in records
    ]
    return np.array(missing), max(abs(record.work) for record in records)


def _apex(skin: np.ndarray) -> int:
    """Index of the skin node (ns, 2) nearest to x = 0 on the side that is touched."""
    return int(np.argmin(np.where(touched_side(skin), np.abs(skin[:, 0]), np.inf)))


class _Unfolding:
    """Values of the solved mesh on the whole mesh; the identity when the whole pad was solved."""

    def __init__(self, whole: PadMesh, solved: PadMesh, skin_nodes: np.ndarray):
        middle = solved.points[solved.cells].mean(1), whole.points[whole.cells].mean(1)
        skin = solved.points[skin_nodes], whole.points[skin_chain(whole)]
        self._nodes = _mirror(solved.points, whole.points, solved.half)
        self._elements = _mirror(*middle, solved.half)
        self._skin = _mirror(*skin, solved.half)

    def field(self, name, values):
        """A full field by its name; mirrored, x and the shear stress xy change their sign."""
        if name == "indenter":
            return values
        index, mirrored = self._nodes if name == "displacement" else self._elements
        out, odd = values[index], {"displacement": 0, "cauchy_stress": 2}
        if name in odd:
            out[mirrored, odd[name]] *= -1
        return out

    def skin(self, values, odd=False):
        index, mirrored = self._skin
        out = values[index]
        return np.where(mirrored, -out, out) if odd else out


def _mirror(solved, whole, half):
    """Which of the solved points (n, 2) each point of the whole pad is, and whether mirrored."""
    if not half:
        return np.arange(len(whole)), np.zeros(len(whole), bool)
    right, near = np.column_stack([np.abs(whole[:, 0]), whole[:, 1]]), 1e-6 * np.ptp(whole[:, 0])
    distance, index = KDTree(solved).query(right)
    assert distance.max() <= near, "the half mesh is not half of the whole"
    return index, whole[:, 0] < 0

"""Quasi-static stepping: Newton's method with the exact contact problem inside, step cutting, and
checks of every state.

The stepper is composed of a body (small or finite strain, with or without Prony branches), the skin
that may touch and a rigid profile. It knows nothing of scenes, plans or files. Time enters only
through the step sizes; inertia is never solved.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial

import numpy as np

from fingerpad.mechanics.contact import ContactError, Rows, Zone, solve_contact
from fingerpad.mechanics.contact_points import PER_NODE, ContactPoints
from fingerpad.mechanics.linear_solver import FactorisationError, Narrowed, condensation
from fingerpad.mechanics.pressure import contact_edges
from fingerpad.mechanics.strides import Between, Strides, Touch
from fingerpad.stimuli.motion import STEADY, Step

_FOLDS = 0.02
"""det F below which an iteration does not go."""
FOLDED = "a finer skin mesh, a fillet on sharp edges, or a smaller depth or force"
"""What to try where an element turns inside out."""


class NonConvergence(RuntimeError):
    """A step could not be completed even after cutting.

    Attributes:
        time: s, where the last converged state stands. reason: what failed. advice: what to try.
        hard: what is hard in the scene, for who knows it. records: the records of every converged
        scheduled step.
    """

    hard: tuple[str, ...] = ()

    def __init__(self, time: float, reason: str, advice: str, where: str = ""):
        super().__init__(f"no convergence after t = {time:.6g} s{where}: {reason}; try {advice}")
        self.time, self.reason, self.advice, self.records = time, reason, advice, []

    def __str__(self):
        return super().__str__() + (f"; or {hard_here(self.hard)}" if self.hard else "")


def hard_here(hard: tuple[str, ...]) -> str:
    """What is hard in a scene, in one clause."""
    return f"less of what is hard here: {', '.join(hard)}"


class _StepFailure(RuntimeError):
    """One attempt at a step failed; the message is the reason."""


class _TooFar(_StepFailure):
    """What lies between two states is not known well enough from them."""


@dataclass(frozen=True)
class NewtonSettings:
    """Tolerances relative to the current contact force and to the node spacing, and limits.

    Forces on nodes may be out of balance by ``force_tolerance``, their sum by ``whole``; what
    pressures and volumes are apart by may be ``volume`` times as large a share of the pressures
    (norms over the elements). A force that goes to zero is as good as zero within ``least_scale``
    tolerances of the largest there was. ``snap_iterations`` are allowed on top when a node is
    popping round an edge: through an unstable state Newton's method only descends. All attempts at
    a scheduled step may take ``most_iterations``. Factors are kept within a step while what they
    leave is within ``chord`` tolerances and they would end, as they go on, ``outlook`` iterations
    later; and from step to step until the steps that they served have taken ``patience`` iterations
    beyond the fewest of one, which is what new ones cost, while what answers at once in a step has
    changed by no more than ``stiffening``. A zone ``loose`` times as wide as it need be is drawn
    together, and, once there has been a stroke, one ``spare`` times as wide condensed anew. A push
    that points farther than ``aside`` (rad) from the vertical is one at the side. An iteration goes
    only as far as det F stays above ``squeeze`` of what it was, where that is at least a fifth of
    its way. ``single``: the tangent is factored in single precision, as the next iteration corrects
    what that is wrong by; until a step does not converge.
    """

    force_tolerance: float = 1e-4
    whole: float = 5e-4
    volume: float = 10.0
    least_scale: float = 1e-3
    gap_tolerance: float = 1e-3
    max_iterations: int = 14
    snap_iterations: int = 60
    most_iterations: int = 400
    max_halvings: int = 10
    energy_share: float = 0.35
    chord: float = 100.0
    outlook: float = 2.0
    patience: int = 4
    stiffening: float = 0.1
    aside: float = np.radians(50.0)
    spare: float = 2.0
    loose: float = 1.25
    squeeze: float = 0.25
    single: bool = False


@dataclass(frozen=True)
class Skin:
    """The part of the boundary that may touch.

    Attributes:
        nodes: (ns,) ordered along the skin. edges: (m, 2 or 3) boundary edges (start, end[,
        middle]), body on their right. spacing: m, smallest distance of neighbouring nodes. start:
        indices (first, last + 1) of the first contact zone.
    """

    nodes: np.ndarray
    edges: np.ndarray
    spacing: float
    start: tuple[int, int]


@dataclass
class Record:
    """What one converged step left behind (arrays over the skin's nodes are (ns,)).

    Forces at the points where the skin touches are put down to the nearest nodes, and so are the
    lengths of skin that they act on: one over the other is the mean pressure of the points on
    either side of a node.
    """

    leg: int
    time: float
    depth: float
    force: float
    tangential_force: float
    nodal_force: np.ndarray
    gradient: np.ndarray  # (ns, 2) direction of the force; zero where nothing touches
    length: np.ndarray  # m of the skin as it is now
    edges: tuple[float, float]  # m, of the contact, from outermost to outermost; NaN without
    displacement: np.ndarray  # (n, 2)
    iterations: int
    halvings: int
    residual: float
    complementarity: float
    smallest_jacobian: float
    energy_error: float
    work: float
    energies: tuple[
        float, float, float
    ]  # J/m, of the network and what the points of contact give way; springs; work on branches
    dissipated: float
    distance: float = 0.0
    frictional: float = 0.0
    tangential: np.ndarray | None = (
        None  # (ns,) N/m along the tangent; the three only with friction
    )
    slip: np.ndarray | None = None  # (ns,) m, of the skin over the profile in this step
    state: np.ndarray | None = None  # (ns,) 0 open, 1 sticks, 2 slips
    passed: tuple[Step, ...] = ()  # outputs since the state before, at which none was found


@dataclass(frozen=True)
class _Past:
    """A state before a step of ``dt``: displacement (n, 2) m, dilatation (the body's own), contact
    forces (np,) N/m, depth m.
    """

    dt: float
    u: np.ndarray
    pressed: np.ndarray
    force: np.ndarray
    depth: float

    def plus(self, weights, others):
        """Linear combination of this state and others."""
        states, parts = [self, *others], ("u", "pressed", "force", "depth")
        return _Past(
            self.dt,
            *(
                sum(w * getattr(s, part) for w, s in zip(weights, states, strict=True))
                for part in parts
            ),
        )


def first_touch(skin: np.ndarray, profile) -> float:
    """Height (m) of the origin of ``profile`` where, moving straight down, it first touches
    ``skin`` (ns, 2) m; NaN if it misses.

    Where the skin stands out most against the profile: at a node, or between two if the profile
    fits between them.
    """
    x, y = skin.T
    height = y - profile.outline(x)
    if np.isnan(height).all():
        high = np.flatnonzero(y > y.max() - np.ptp(y) / 2)
        high = high[np.argsort(x[high])]
        first, last = np.clip(profile.reach, x[high[0]], x[high[-1]])
        between = np.linspace(first, last, 65)
        height = np.interp(between, x[high], y[high]) - profile.outline(between)
    return float(np.nan if np.isnan(height).all() else np.nanmax(height))


class QuasiStatic:
    """Walks a schedule of steps.

    Args:
        body: FiniteStrainBody or SmallStrainBody, unloaded. skin: where contact may happen.
        profile: the rigid shape. observers: callables ``(body, dt)`` run after each converged
        substep (receptors keep their own history so). external: (n, 2) dead nodal forces, N/m, or
        None. friction: Coulomb's coefficient; None leaves friction out altogether.
    """

    def __init__(
        self,
        body,
        skin: Skin,
        profile,
        settings: NewtonSettings | None = None,
        observers=(),
        external=None,
        friction=None,
    ):
        self.body, self.skin, self.profile = body, skin, profile
        self.settings = settings or NewtonSettings()
        self._single = self.settings.single
        self.observers = observers
        self.external = external
        self.points = body.space.points
        stiffest = np.zeros(len(self.points))
        np.maximum.at(
            stiffest, body.space.cells.ravel(), np.repeat(body.shear, body.space.cells.shape[1])
        )
        along, across = body.space.equation[skin.nodes[0]]
        mirrored = along < 0 <= across and abs(self.points[skin.nodes[0], 0]) < 1e-9 * np.ptp(
            self.points[:, 0]
        )
        self.places = ContactPoints.on(
            self.points,
            skin.nodes,
            skin.edges,
            stiffest[skin.edges].min(axis=1),
            bool(mirrored),
            profile.convexity,
        )
        self._valleys, places = None, len(self.places)
        if profile.valleys:
            from fingerpad.mechanics.valleys import Valleys

            self._valleys, places = (
                Valleys(profile, places, skin.spacing / PER_NODE, friction or 0.0),
                2 * places,
            )
        self.contact_force = np.zeros(places)
        self.active = np.zeros(places, bool)
        self.depth = self.distance = 0.0
        self.time = 0.0
        self.work = self._gross = self._missing = self.force = self._tangential = 0.0
        self._most_force = self._most_work = self._pressed = 0.0
        self._energies = (0.0, 0.0, 0.0)
        self.friction = None
        if friction is not None:
            from fingerpad.mechanics.friction import Coulomb

            self.friction = Coulomb(friction, places)
        self._factors = self._flexible = self._stiffness = self._found = self._nodal = (
            self._touched
        ) = None
        self._served: list[int] = []  # iterations of the steps that the factors have served
        self._set_zone(*(PER_NODE * end for end in skin.start))
        self.height = self._first_touch()
        self._reach_what_touches()
        self._unloaded = body.save()
        self._past: list[_Past] = []
        self._touches: list[Touch] = []  # the last two states'
        self._quadratic = False
        self.total_iterations = self.total_halvings = self.factorisations = self._spent = 0
        self.wavered = (
            0  # attempts that ended going to and fro between states that are nearly in equilibrium
        )

    # -- geometry ---------------------------------------------------------------------------------------------------

    def _set_zone(self, first, last):
        """Condense onto the points of the skin from ``first`` to before ``last``."""
        self._outer = self.places.whole(first, last)
        nodes, shape = self.places.shape(self._outer)
        softness = self.places.soft(self._outer), self.places.soft(self._outer, odd=True)
        self._wide = Zone(nodes, self.body.space.equation, shape, *softness)
        self.solver, self._schur = (
            condensation(self.body.space.pattern, self._wide.condensed, self._single),
            None,
        )
        self._narrow(first, last)

    def _narrow(self, first, last):
        """Let contact be solved for on some points of those that are condensed onto."""
        first, last = max(first, self._outer.start), min(last, self._outer.stop)
        self._range = self.places.whole(first, last)
        self.zone = self._wide.part(
            slice(self._range.start - self._outer.start, self._range.stop - self._outer.start)
        )
        self._narrowed = Narrowed(self.solver, self.zone.condensed)
        if self._schur is not None:
            self._take(self._schur)

    def _take(self, schur):
        """Take over the Schur complement of all that is condensed onto, with which contact is
        solved for where it may be.
        """
        self._schur = schur
        if not self._narrowed.take(schur):
            self._narrow(self._outer.start, self._outer.stop)

    def _reach_what_touches(self):
        """Widen the zone to where the profile touches first: the edges of a hole are not where its
        middle is.
        """
        gap = self.profile.evaluate(self._position(slice(None)))[0]
        first = np.flatnonzero(gap <= gap.min() + 0.1 * self.skin.spacing)
        if first[0] < self._range.start or first[-1] >= self._range.stop:
            self._widen_to(first)

    def _widen_to(self, places):
        """Let the zone reach some points of the skin (k,), ascending, and a few beyond."""
        first, last = min(self._range.start, places[0] - 16), max(self._range.stop, places[-1] + 17)
        inside = self._outer.start <= places[0] and places[-1] < self._outer.stop
        (self._narrow if inside else self._set_zone)(first, last)

    def _grow_zone(self):
        """Make room round a contact that fills its zone: among the points that are condensed onto,
        or of these more.
        """
        first, last = self._round(np.flatnonzero(self._touching()), 16, 8)
        self._narrow(min(first, self._range.start), max(last, self._range.stop))
        if self._zone_is_tight():
            first, last = self._outer.start, self._outer.stop
            more = max(16, (last - first) // 3)
            self._set_zone(first - more if first else 0, last + more)

    def _round(self, on, least, share):
        """First and last point + 1 of a zone with ``least`` points or a ``share``-th of a contact
        ``on`` (k,) to either side.
        """
        more = max(least, np.ptp(on) // share)
        return max(on[0] - more, 0), min(on[-1] + 1 + more, len(self.places))

    def _follow(self):
        """Draw the zone together round a contact that has moved on: every iteration pays for its
        size.

        What is condensed onto is left as wide as it was made before the first stroke: a press comes
        to fill it.
        """
        on = np.flatnonzero(self._touching())
        if len(on):
            first, last = self._round(on, 24, 4)
            if self.distance and len(self._wide) > self.settings.spare * (last - first):
                self._set_zone(first, last)
            first, last = self._round(on, 16, 8)
            if len(self.zone) > self.settings.loose * (last - first):
                self._narrow(first, last)

    def _zone_is_tight(self, margin=6):
        """Does contact come so near, in points, to an end of the zone that is not an end of the
        skin?
        """
        on = np.flatnonzero(self._touching()[self._range])
        if not len(on):
            return False
        low = self._range.start > 0 and on[0] < margin
        return low or (self._range.stop < len(self.places) and on[-1] >= len(self.zone) - margin)

    def _touching(self):
        """(np,) bool: the points that touch, on one side of a valley or both."""
        return self.active.reshape(-1, len(self.places)).any(axis=0)

    def _position(self, which):
        """(k, 2) m, of some points of the skin in the profile's frame."""
        return self.places.at(self.points + self.body.u, which) - np.array(
            [-self.distance, self.height - self.depth]
        )

    def _rows(self) -> Rows:
        """The constraints of the zone, worked out once where the body and the profile are."""
        where = self.zone, self.body.u, self.height, self.depth, self.distance
        if self._found is None or not all(
            a is b for a, b in zip(where, self._found[0], strict=True)
        ):
            zone, points = self.zone, self._position(self._range)
            single = self.profile.evaluate(points)
            if self._valleys is None:
                rows = Rows(zone, self._range, None, *single)
            else:
                kept = [self.contact_force, self.active]
                kept += [] if self.friction is None else self.friction.kept
                rows = self._valleys.rows(zone, self._range, points, single, kept)
            self._found = where, rows
        return self._found[1]

    def _first_touch(self) -> float:
        """Height of the profile's origin at which it just touches the undeformed skin."""
        skin = np.concatenate([self.points[self.skin.nodes], self.places.at(self.points)])
        height = first_touch(skin + np.array([self.distance, 0.0]), self.profile)
        if np.isnan(height):
            raise NonConvergence(
                self.time,
                f"the stimulus left the pad at {self.distance * 1e3:.3g} mm",
                "a shorter way",
            )
        return height

    def touching_depth(self) -> float:
        """Depth (m) at which the profile just touches the undeformed skin where it is now; zero
        where it came down first.
        """
        return self.height - self._first_touch()

    # -- one step ---------------------------------------------------------------------------------------------------

    def save(self):
        """The state to come back to: body, contact forces, active nodes, depth, distance,
        friction.
        """
        friction = self.friction and self.friction.save()
        return (
            self.body.save(),
            self.contact_force.copy(),
            self.active.copy(),
            self.depth,
            self.distance,
            friction,
        )

    def restore(self, state):
        """Come back to a saved state."""
        self.body.restore(state[0])
        self.contact_force, self.active, self.depth, self.distance = (
            state[1].copy(),
            state[2].copy(),
            *state[3:5],
        )
        if self.friction is not None:
            self.friction.restore(state[5])
        self._factors = None

    def _start_again(self, distance):
        """Lift the profile off, let the body recover, and come down to first touch at another
        stroke distance (m).
        """
        self.body.restore(self._unloaded)
        self.contact_force[:], self.active[:] = 0, False
        self.distance = distance
        self.depth = self.touching_depth()
        if self.friction is not None:
            self.friction.release()
        for observe in self.observers:
            observe(self.body, STEADY)
        self.force = self._tangential = 0.0
        # what was put in has come out again: the balance goes on from here
        self.work = self._gross = self._most_work = (
            0.0 if self.friction is None else self.friction.dissipated
        )
        self._energies = (0.0, 0.0, 0.0)
        self._factors = self._stiffness = None
        self._past.clear()

    def _attempt(self, control, target, guessed=False):
        """Solve one step to convergence; returns (iterations, residual) or raises _StepFailure.

        From a state that was ``guessed`` Newton's method converges at once or not well.
        """
        settings = self.settings
        limit, iteration, before = settings.max_iterations, 0, np.inf
        self._softened = False
        keep = self._factors_fit()
        while iteration < limit:
            iteration += 1
            self._spent += 1
            if self._softened:
                limit = settings.max_iterations + settings.snap_iterations
            if self._zone_is_tight():
                self._grow_zone()
                keep = keep and self._factors_fit()
            try:
                residual = self.iterate(control, target, reuse=keep)
            except (FactorisationError, ContactError) as error:
                raise _StepFailure(str(error)) from error
            if not np.isfinite(residual):
                raise _StepFailure("the residual is not finite")
            if residual <= 1.0 and not self._zone_is_tight(1) and not self._touches_elsewhere():
                self._served.append(iteration)
                if (
                    self._softened
                    or sum(self._served) - len(self._served) * min(self._served)
                    >= settings.patience
                ):
                    self._factors = None
                return iteration, residual
            if guessed and residual > before:
                raise _StepFailure("the state that was guessed is a bad one")
            ahead = residual * (residual / before) ** settings.outlook
            keep = (
                residual <= settings.chord
                and ahead <= 1.0
                and not self._softened
                and self._factors_fit()
            )
            before = residual
        self.wavered += self._softened
        raise _StepFailure(f"{limit} Newton iterations did not suffice")

    def _factors_fit(self):
        """Are there factors of this zone, and of a step in which as much of the stress answers at
        once?
        """
        return (
            self._factors is not None
            and self._factors[0] is self.solver
            and abs(self.body.factor - self._factors[1])
            <= self.settings.stiffening * self.body.factor
        )

    def iterate(self, control, target, reuse=False):
        """One Newton iteration; returns the residual over its tolerance.

        ``reuse``: with the factors of the one before, in the same zone.
        """
        body, settings = self.body, self.settings
        space = body.space
        if reuse:
            internal = body.against(self._internal)
        else:
            schur, internal = body.linearise(self.solver)
            self._take(schur)
            if not body.smallest_jacobian > 0:
                raise _StepFailure("an element has turned inside out")
            self.factorisations += 1
            self._factors, self._served = (self.solver, body.factor), []
        load = -internal if self.external is None else self.external - internal
        rows, schur, reduced = (
            self._rows(),
            self._narrowed.schur,
            self._narrowed.forward(space.to_equations(load)),
        )
        goal = {"force": target} if control == "force" else {"depth_change": target - self.depth}
        known = (
            schur,
            reduced,
            rows.gap,
            rows.gradient,
            rows.curvature,
            self.contact_force[rows.place],
            self.active[rows.place],
        )
        # the geometric term of the gaps is part of the tangent, and kept as long as the rest of it
        same = (
            self._flexible is not None
            and self._flexible[0] is rows.zone
            and self._flexible[1] is schur
        )
        goal["flexible"] = self._flexible[2] if same else None
        if self.friction is None:
            step = solve_contact(rows.zone, *known, **goal)
        else:
            step = self.friction.solve(
                rows.zone, rows.place, *known, self._motion(rows.zone), partner=rows.partner, **goal
            )
        self._flexible = None if step.softened else (rows.zone, schur, step.flexible)
        self._softened |= step.softened
        self._stiff = step.stiffness
        du = space.to_nodes(self._narrowed.backward(step.condensed_displacement))
        u, depth = body.u, self.depth
        share, least = 1.0, max(_FOLDS, settings.squeeze * body.smallest_jacobian)
        while True:
            body.advance(du, share)
            internal = body.internal_force()
            if body.smallest_jacobian > least or body.geometrically_linear:
                break
            share /= 2
            least = _FOLDS if share < 0.2 else least
            if share < 0.05:
                raise _StepFailure("an element would turn inside out")
            body.displace(u)
        self._internal = internal
        self.depth = depth + share * step.depth_change
        self.contact_force[:] = 0
        self.active[:] = False
        self.contact_force[rows.place], self.active[rows.place] = step.force, step.active
        if self.friction is not None:
            self.friction.accept(rows.place, step)
        rows, stuck = self._rows(), 0.0
        active = self.active[rows.place]
        if self.friction is not None:
            stuck = self.friction.creep(
                rows.place, active, rows.gradient, self._motion(rows.zone), rows.zone.softness_along
            )
        push, _ = self._forces()
        unbalanced = -internal if self.external is None else self.external - internal
        unbalanced[self.zone.nodes] += self.zone.shape.T @ push
        scale = max(
            step.force.sum(), np.abs(self.external).sum() if self.external is not None else 0.0
        )
        scale = max(scale, settings.least_scale * self._most_force)
        if scale == 0:  # nothing touches: the body must come back to rest
            scale = body.space.measure.out_of_plane_stretch * np.abs(internal).sum() + 1e-30
        unbalanced[space.fixed] = 0.0
        equilibrium, whole = (
            np.linalg.norm(unbalanced) / scale,
            np.linalg.norm(unbalanced.sum(axis=0)) / scale,
        )
        gap = rows.closing(self.contact_force[rows.place])
        opening = np.abs(gap[active]).max(initial=0.0)
        penetration = max(0.0, -gap.min(initial=0.0))
        balance = 0.0
        if control == "force" and target > 0:
            balance = abs(target + push[:, 1].sum()) / target
        amiss, pressed = body.volume_amiss()
        self._pressed = max(self._pressed, pressed)
        volume = amiss / max(pressed, settings.least_scale * self._pressed, 1e-300)
        residual = max(
            equilibrium / settings.force_tolerance,
            whole / settings.whole,
            balance / settings.force_tolerance,
            volume / (settings.volume * settings.force_tolerance),
            max(opening, penetration, stuck) / (settings.gap_tolerance * self.skin.spacing),
        )
        return residual if share == 1.0 else max(residual, 2.0)

    def _motion(self, zone):
        """(nz, 2) m: how far the points of a zone have moved over the profile since the step
        began.
        """
        u, depth, distance = self._begin
        return zone.shape @ (self.body.u - u)[zone.nodes] + np.array(
            [self.distance - distance, self.depth - depth]
        )

    def _touches_elsewhere(self):
        """Does skin outside the zone penetrate the profile? Then the zone has grown to it."""
        outside = np.ones(len(self.places), bool)
        outside[self._range] = False
        outside = np.flatnonzero(outside)
        if not len(outside):
            return False
        gap = self.profile.evaluate(self._position(outside))[0]
        deep = outside[gap < -self.settings.gap_tolerance * self.skin.spacing]
        if not len(deep):
            return False
        self._widen_to(deep)
        return True

    def _forces(self):
        """Force of the profile on the zone's points (nz, 2) N/m, and the frictional part of it
        (None without friction).
        """
        rows = self._rows()
        push = rows.of_points(self.contact_force[rows.place, None] * rows.gradient)
        if self.friction is None:
            return push, None
        pull = rows.of_points(self.friction.pull(rows.place, rows.gradient))
        return push + pull, pull

    def _check_energy(self, work, energies, lost, moved):
        """A false equilibrium shows: its energy is not what was put in (which large steps know with
        a margin).

        Small steps of a stroke (``moved``) have no such excuse: what goes missing in them, where
        nodes jump over edges, adds up.
        """
        if (
            self.external is not None
        ):  # dead loads, put on at once, do twice the work that is stored
            return
        change = energies[0] + energies[2] - self._energies[0] - self._energies[2] + lost
        share = self.settings.energy_share
        margin = share * (abs(work) + abs(change)) + 0.02 * abs(self.work)
        missing = self._missing + (work - change if moved else 0.0)
        if abs(work - change) > margin or abs(missing) > share * (self._gross + abs(work)):
            raise _StepFailure("the energy found is not the work that was done")
        self._missing = missing

    def _clearance(self):
        """m, between the profile and the points of the skin where nothing touches: nodes may be
        nearer to it.
        """
        return max(float(self._rows().gap.min()), 0.0)

    def _pressing_work(self, force, way, stiffness, clearance=0.0):
        """Work (J/m) of the force on a way (m) into the pad: by the trapezoidal rule, which is
        right for small steps.

        It need not be small: where contact begins or ends the force grows by a power of the way,
        which the ``stiffness`` (N/m^2; None: not known) at the other end tells, beside a
        ``clearance`` (m) on the way; else it is a cubic with the stiffness of either end.
        """
        trapezoidal = 0.5 * (self.force + force) * way
        if stiffness is None:
            return trapezoidal
        if not self.force or not force:
            most, slope = max(self.force, force), stiffness if force else self._stiffness
            way = np.sign(way) * max(abs(way) - clearance, 0.0)
            power = slope * abs(way) / most if slope and most else 1.0
            return most * way / (1 + max(power, 0.0))
        return trapezoidal - (
            0.0 if self._stiffness is None else way**2 / 12 * (stiffness - self._stiffness)
        )

    def _advance(self, dt, control, target, distance, predict, good=None):
        """One substep with predictor, check and commit. ``good``: asked of the contact that was
        found, before it is accepted.
        """
        state = self.save()
        self._begin = self.body.u, self.depth, self.distance
        # a steady stroke takes no time: its steps are as long as their way
        size = dt if dt < STEADY else abs(distance - self.distance) or dt
        body, past = self.body, self._now(size)
        try:
            clearance = 0.0 if self.force else self._clearance()
            self.distance = distance
            body.begin_step(dt)
            guesses = self._predictions(size) if predict else []
            guess = guesses[-1 if self._quadratic else 0] if guesses else past
            self._internal = body.displace(guess.u, guess.pressed)
            if guesses and not body.smallest_jacobian > 0.1:
                self._internal = body.displace(past.u, past.pressed)
            elif guesses:
                self.contact_force, self.depth = np.maximum(guess.force, 0), guess.depth
            iterations, residual = self._attempt(control, target, bool(guesses))
            if guesses:
                self._quadratic = (
                    np.argmin(
                        [np.linalg.norm((body.u - guess.u)[self.zone.nodes]) for guess in guesses]
                    )
                    > 0
                )
            push, pull = self._forces()
            tangential, force = 0.0 - push.sum(0)
            if force < -1e-9 * self.contact_force.sum():
                raise _StepFailure("the indenter is pulled instead of pushed")
            if good is not None and not good():
                raise _TooFar
            self.body.commit()
            stiffness = self._stiff if distance == state[4] else None
            clearance = clearance if force else self._clearance()
            work = self._pressing_work(force, self.depth - state[3], stiffness, clearance)
            work += 0.5 * (self._tangential + tangential) * (distance - state[4])
            lost = (
                self.friction.commit(self._range, pull, self._motion(self.zone))
                if self.friction
                else 0.0
            )
            network, *others = self.body.energies()
            rows, pressing = self._rows(), self.contact_force[self._rows().place]
            energies = (
                network + 0.5 * float(pressing @ (rows.closing(pressing) - rows.gap)),
                *others,
            )
            self._check_energy(work, energies, lost, distance != state[4])
        except _StepFailure:
            self.restore(state)
            raise
        for observe in self.observers:
            observe(self.body, dt)
        self.force, self._tangential, self._stiffness = float(force), float(tangential), stiffness
        self.work += float(work)
        self._gross += abs(float(work))
        self._most_force, self._most_work = (
            max(self._most_force, self.force),
            max(self._most_work, abs(self.work)),
        )
        self._energies = energies
        self._past = [past, *self._past[:1]]
        return iterations, residual

    def _now(self, dt):
        return _Past(dt, self.body.u, self.body.pressed, self.contact_force, self.depth)

    def _predictions(self, dt):
        """Where the path goes on to in a step of ``dt``: along the straight line through the last
        two states, and along the parabola through the last three if there are as many.
        """
        now, found = self._now(dt), []
        sizes = [past.dt for past in self._past]
        if sizes:
            ratio = dt / sizes[0]
            found.append(now.plus([1 + ratio, -ratio], self._past[:1]))
        if len(sizes) > 1:
            one, both = sizes[0], sum(sizes)
            weights = [
                (dt + one) * (dt + both) / (one * both),
                -dt * (dt + both) / (one * sizes[1]),
                dt * (dt + one) / (both * sizes[1]),
            ]
            found.append(now.plus(weights, self._past))
        return found

    def run(
        self,
        steps: Iterable[Step],
        on_step: Callable[[Record], None] | None = None,
        between: Between | None = None,
    ) -> list[Record]:
        """Walk the schedule; returns one record per state that was found: of every step or, where
        it says that none needs to be found and ``between`` how good what lies between must be, of
        as many as it takes.

        Raises:
            NonConvergence: a step fails even after ``max_halvings`` halvings or
            ``most_iterations``; its ``records`` hold what
                converged.
        """
        records: list[Record] = []
        strides, last = Strides(iter(steps), between), None
        self._touches.clear()
        while (following := strides.next()) is not None:
            step, passed = following
            try:
                iterations, halvings, residual = self._complete(
                    step, last, records, strides if between else None
                )
            except _TooFar:
                strides.shorten()
                continue
            except NonConvergence as problem:
                problem.records = records
                raise
            strides.found(step)
            last = step if not halvings else None
            self.total_iterations += iterations
            self.total_halvings += halvings
            if between:
                self._touches = [*self._touches[-1:], self._touch()]
            record = self._record(step, iterations, halvings, residual, passed)
            records.append(record)
            if on_step:
                on_step(record)
        return records

    def _complete(self, step, last, records, strides):
        """Go to the end of a step, in parts where it does not converge; returns iterations,
        halvings and the residual.

        Raises:
            _TooFar: what it passes would not be known well enough, or it is better tried with less.
        """
        control = "force" if step.force is not None else "depth"
        target = step.force if control == "force" else step.depth
        begin = self.force if control == "force" else self.depth
        if step.fresh:
            self._start_again(step.distance)
            begin = 0.0 if control == "force" else self.depth
        start = self.distance
        # a steady press goes in strides as long as its way: what the last one did is no guide to
        # the next
        pressed = step.dt >= STEADY and step.distance == self.distance
        smooth = (
            last is not None
            and last.leg == step.leg
            and last.dt > 0
            and not step.fresh
            and not pressed
        )
        done, size, iterations, halvings = 0.0, 1.0, 0, 0
        self._spent = 0
        if not smooth:
            self._past.clear()
            self._factors = None
        predict = smooth
        self._follow()
        while done < 1.0:
            size = min(size, 1.0 - done)
            whole = done + size >= 1.0
            goal = target if whole else begin + (done + size) * (target - begin)
            place = step.distance if whole else start + (done + size) * (step.distance - start)
            judged = partial(self._good, strides) if strides and size == 1.0 else None
            try:
                used, residual = self._advance(
                    size * step.dt, control, goal, place, predict and size == 1.0, judged
                )
            except _TooFar:
                raise
            except _StepFailure as failure:
                if strides and strides.shorten():  # first doubt the stride
                    raise _TooFar from failure
                if predict and size == 1.0:
                    predict = False  # then the predictor, then the precision, then the step
                    continue
                if self._single:
                    self._single = False
                    self._set_zone(self._outer.start, self._outer.stop)
                    continue
                size /= 2
                halvings += 1
                self._give_up_if_vain(failure, size, halvings, records)
                continue
            done += size
            iterations += used
            self.time = step.time - (1.0 - done) * step.dt if step.dt < STEADY else step.time
            size *= 2
        return iterations, halvings, residual

    def _good(self, strides):
        """Is the contact, as it was found, near enough to those before?"""
        return len(self._touches) < 2 or strides.judge(*self._touches, self._touch())

    def _touch(self):
        rows = self._rows()
        if self._touched is not None and self._touched[0] is rows:
            return self._touched[1]
        force, gradient, length, edges = self._on_nodes()
        x = (self.points + self.body.u)[self.skin.nodes, 0]
        push, pull = self._forces()
        drag, press = push.sum(0)
        stuck = self.contact_force[self.friction.state == 0].sum() if self.friction else 0.0
        share = float(stuck / max(self.contact_force.sum(), 1e-300))
        self._touched = (
            rows,
            Touch(
                x,
                force / length,
                edges,
                self.distance,
                float(drag / press) if press else 0.0,
                share,
            ),
        )
        return self._touched[1]

    def _give_up_if_vain(self, failure, size, halvings, records):
        """NonConvergence where smaller parts of a step are of no use."""
        aside = bool(records) and self._slips_off(records[-1])
        spent = self._spent > self.settings.most_iterations
        if size >= 0.5**self.settings.max_halvings and not spent and not (aside and halvings > 1):
            return
        where = f" (depth {self.depth * 1e3:.4g} mm, force {self.force:.4g} N/m of the meshed part)"
        reason, advice = str(failure), self._advice(str(failure))
        if spent:
            reason = f"{self._spent} Newton iterations did not suffice for a step cut {halvings} times; {reason}"
        if aside:
            way = f"{self.distance * 1e3:.3g} mm"
            reason, advice = f"the stimulus left the pad at {way}", f"a way of less than {way}"
        raise NonConvergence(self.time, reason, advice, where) from failure

    def _slips_off(self, record):
        """Was the pad touched, on its way along the profile, by its side only? Then nothing can
        hold it there.
        """
        push = -(record.nodal_force @ record.gradient)
        return bool(record.distance) and abs(push[0]) > np.tan(self.settings.aside) * push[1]

    def _advice(self, reason):
        spacing = float(np.median(PER_NODE * self.places.spacing[self._range]))
        about_profile = self.profile.advice(spacing)
        if about_profile:
            return about_profile
        if "inside out" in reason:
            return FOLDED
        if "carry the force" in reason:
            return "depth control, or a profile that stays above the pad"
        if "energy" in reason:
            return "smaller steps, a finer skin mesh, or a fillet on sharp edges that pass over the skin"
        return "more steps, a finer mesh, or depth instead of force control"

    def _on_nodes(self):
        """Force (ns,) N/m on the skin's nodes, its direction (ns, 2), their length (ns,) m, and the
        contact's edges.
        """
        rows, places, part = self._rows(), self.places, self._range
        if self._nodal is not None and self._nodal[0] is rows:
            return self._nodal[1]
        push = np.zeros((len(places), 2))
        push[part] = rows.of_points(self.contact_force[rows.place][:, None] * rows.gradient)
        normal = np.hypot(*push.T)
        nodal, force = places.of_nodes(push), places.of_nodes(normal)
        gradient = np.divide(
            nodal, np.hypot(*nodal.T)[:, None], out=np.zeros_like(nodal), where=force[:, None] > 0
        )
        position = self.points + self.body.u
        # the linear theory knows no deformed lengths
        length = places.lengths(self.points if self.body.geometrically_linear else position)
        pressure = normal[part] / length[part]
        mirrored = part.start == 0 and places.mirrored
        edges = contact_edges(
            places.at(position, part)[:, 0], pressure, places.spacing[part], mirrored
        )
        self._nodal = rows, (force, gradient, places.of_nodes(length), edges)
        return self._nodal[1]

    def _record(self, step, iterations, halvings, residual, passed):
        force, gradient, length, edges = self._on_nodes()
        rows = self._rows()
        kept = self.contact_force[rows.place]
        total = max(kept.sum(), 1e-300)
        slack = np.abs(rows.closing(kept)) * kept
        network, spring, branch_work = self._energies
        friction = self.friction
        frictional = friction.dissipated if friction else 0.0
        # a body that is let go gives the work back: there is nothing left to relate an error to
        balance = abs(self.work - network - branch_work - frictional) / max(
            abs(self.work), 0.1 * self._most_work, 1e-300
        )
        return Record(
            step.leg,
            step.time,
            self.depth,
            self.force,
            self._tangential,
            force,
            gradient,
            length,
            edges,
            self.body.u.copy(),
            iterations,
            halvings,
            residual * self.settings.force_tolerance,
            float(slack.sum() / (total * self.skin.spacing)),
            float(self.body.smallest_jacobian),
            float(balance) if self.work else 0.0,
            self.work,
            self._energies,
            branch_work - spring,
            self.distance,
            frictional,
            *(friction.record(self.active, self.places) if friction else ()),
            passed=passed,
        )

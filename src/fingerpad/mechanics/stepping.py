"""Quasi-static stepping: Newton's method with the exact contact problem inside, step cutting, and
checks of every state.

The stepper is composed of a body (small or finite strain, with or without Prony branches), the skin
that may touch and a rigid profile. It knows nothing of scenes, plans or files. Time enters only
through the step sizes; inertia is never solved.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import partial
from operator import mul
from typing import NamedTuple

import numpy as np

from fingerpad.mechanics.contact import ContactError, Rows, Zone, solve_contact
from fingerpad.mechanics.contact_points import PER_NODE, ContactPoints
from fingerpad.mechanics.friction import STICK, Coulomb
from fingerpad.mechanics.linear_solver import FactorisationError, Narrowed, condensation
from fingerpad.mechanics.pressure import contact_edges
from fingerpad.mechanics.strides import Between, Strides, Touch
from fingerpad.mechanics.valleys import Valleys
from fingerpad.stimuli.motion import STEADY, Step

#: An iteration stays above this det F.
MIN_DET_F = 0.02
#: It also stays above this share of the smallest det F before it, where that is at least a fifth
#: of its way.
DET_F_SHARE = 0.25
#: Tolerance of the sum of all forces, relative to the contact force.
SUM_TOLERANCE = 5e-4
#: Tolerance of volumes, relative to the pressures, in units of the force tolerance, unless settings
#: have their own.
VOLUME_TOLERANCE = 10.0
#: A force below this share of the largest so far is judged by that share.
LEAST_SCALE = 1e-3
#: More iterations while a node snaps round an edge: through an unstable state Newton's method only
#: descends.
SNAP_ITERATIONS = 60
#: Iterations of all attempts at a scheduled step.
MOST_ITERATIONS = 400
MAX_HALVINGS = 10
#: Largest share of a step that is tried at once where it goes on from its last good state.
RESUMED_SHARE = 0.125
#: Largest share of the work that the energy found may differ by.
ENERGY_SHARE = 0.35
#: Reuse the factorised tangent while the residual is below this many tolerances.
REUSE_BELOW = 100.0
#: Reuse it only where convergence is expected within this many iterations more.
REUSE_AHEAD = 2.0
#: Factor anew when the steps since the last factorisation have taken this many iterations too many.
REUSE_PATIENCE = 4
#: Factor anew when the share of the stress that answers at once has changed by this much.
REUSE_FACTOR_CHANGE = 0.1
#: A push that points farther than this (rad) from the vertical comes from the side.
SIDE_ANGLE = np.radians(50.0)
#: During a stroke, condense anew where the condensed zone is this many times as wide as needed.
CONDENSED_WIDTH = 2.0
#: Narrow the contact zone where it is this many times as wide as needed.
ZONE_WIDTH = 1.25
FOLDED = "a finer skin mesh, a fillet on sharp edges, or a smaller depth or force"
"""What to try where an element turns inside out."""


class NonConvergence(RuntimeError):
    """A step could not be completed even after cutting.

    Attributes
    ----------
    time : float
        s, of the last converged state.
    reason, advice : str
        What failed, and what to try.
    hard : tuple of str
        What is hard in the scene, if known.
    records : list of Record
        Of every converged scheduled step.
    halvings : int
        How often the step was cut; 0 where more attempts at it are of no use.
    factorisations : int
        Matrices factorised in all, if known.
    tried : tuple of str
        What was relaxed in vain.
    """

    hard: tuple[str, ...] = ()
    halvings = factorisations = 0
    tried: tuple[str, ...] = ()

    def __init__(self, time: float, reason: str, advice: str, where: str = ""):
        super().__init__(time, reason, advice, where)  # all, so that a process can pass it on
        self.time, self.reason, self.advice, self.where = time, reason, advice, where
        self.records: list[Record] = []

    def __str__(self):
        text = f"no convergence after t = {self.time:.6g} s{self.where}: {self.reason}"
        text += f"; try {self.advice}" + (f"; or {hard_here(self.hard)}" if self.hard else "")
        return text + (f"; relaxed in vain: {', '.join(self.tried)}" if self.tried else "")


def hard_here(hard: tuple[str, ...]) -> str:
    """Advice to make a scene easier, naming what is hard in it."""
    return f"less of what is hard here: {', '.join(hard)}"


class _StepFailure(RuntimeError):
    """One attempt at a step failed; the message is the reason."""


class _TooFar(_StepFailure):
    """What lies between two states is not known well enough from them."""


@dataclass(frozen=True)
class NewtonSettings:
    """Tolerances of Newton's method.

    Parameters
    ----------
    force_tolerance : float
        Largest out-of-balance force on the nodes, relative to the contact force.
    volume_tolerance : float or None
        Largest wrong pressure, relative to the pressures.
    gap_tolerance : float
        Largest wrong gap, penetration or slip of a sticking point, relative to the node spacing.
    max_iterations : int
        Iterations of one attempt at a step.
    single : bool
        Factor the tangent in single precision, until a step does not converge: the next iteration
        corrects its error.
    """

    force_tolerance: float = 1e-4
    volume_tolerance: float | None = None
    gap_tolerance: float = 1e-3
    max_iterations: int = 14
    single: bool = False


@dataclass(frozen=True)
class Skin:
    """The part of the boundary that may touch.

    Attributes
    ----------
    nodes
        (ns,) ordered along the skin.
    edges
        (m, 2 or 3) boundary edges (start, end[, middle]), body on their right.
    spacing
        m, smallest distance of neighbouring nodes.
    start
        Indices (first, last + 1) of the first contact zone.
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


class _State(NamedTuple):
    """A state to predict the next one from."""

    u: np.ndarray  # (n, 2) m
    pressed: np.ndarray | float  # what the body has besides: its dilatation
    force: np.ndarray  # (np,) N/m
    depth: float  # m


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

    Parameters
    ----------
    body
        FiniteStrainBody or SmallStrainBody, unloaded.
    skin
        Where contact may happen.
    profile
        The rigid shape.
    observers
        Callables ``(body, dt)`` run after each converged substep (receptors keep their own history
        so).
    external
        (n, 2) dead nodal forces, N/m, or None.
    friction
        Coulomb's coefficient; None leaves friction out altogether.
    patience
        How often a step that failed is gone on with from its last good state, in small shares.
    most
        Matrices factorised after which the run is given up; 0: never.
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
        patience=0,
        most=0,
    ):
        self._most = most
        self.patience = patience
        self.resumed: list[float] = []  # times (s) at which steps were gone on with
        self._share = 1.0  # largest of a step that is tried at once
        self.body, self.skin, self.profile, self.observers = body, skin, profile, observers
        self.settings = settings or NewtonSettings()
        self._single = self.settings.single
        self.points = body.space.points
        self.external = np.zeros_like(body.u) if external is None else external
        stiffest = np.zeros(len(self.points))
        np.maximum.at(
            stiffest, body.space.cells.ravel(), np.repeat(body.shear, body.space.cells.shape[1])
        )
        (along, across), x = body.space.equation[skin.nodes[0]], self.points[:, 0]
        mirrored = bool(along < 0 <= across and abs(x[skin.nodes[0]]) < 1e-9 * np.ptp(x))
        stiffest = stiffest[skin.edges].min(axis=1)
        self.places = ContactPoints.on(
            self.points,
            skin.nodes,
            skin.edges,
            stiffest,
            mirrored,
            profile.convexity,
            body.space.kinematics,
        )
        self._valleys, places = None, len(self.places)
        if profile.valleys:
            reach = skin.spacing / PER_NODE
            self._valleys = Valleys(profile, places, reach, friction or 0.0)
            places = 2 * places
        self.contact_force, self.active = np.zeros(places), np.zeros(places, bool)
        self.depth = self.distance = self.time = 0.0
        self.work = self._gross = self._missing = self.force = self._tangential = 0.0
        self._most_force = self._most_work = self._pressed = 0.0
        self._energies = (0.0, 0.0, 0.0)
        self.friction = None if friction is None else Coulomb(friction, places)
        self._factors = self._flexible = self._stiffness = None
        self._found: tuple[tuple, Rows] | None = None
        self._nodal = None
        self._served: list[int] = []  # iterations of the steps that the factors have served
        self._set_zone(*(PER_NODE * end for end in skin.start))
        self.height = self._first_touch()
        self._reach_what_touches()
        self._unloaded = body.save()
        self._past: list[tuple[float, _State]] = []  # before the last steps, with their sizes
        self._touches: list[Touch] = []  # the last two states'
        self._quadratic = False
        self.total_iterations = self.factorisations = self._spent = 0
        self.wavered = 0  # attempts that ended wavering between states nearly in equilibrium

    def _set_zone(self, first, last):
        """Condense onto the points of the skin from ``first`` to before ``last``."""
        self._outer = self.places.whole(first, last)
        nodes, shape = self.places.shape(self._outer)
        softness = self.places.soft(self._outer), self.places.soft(self._outer, odd=True)
        self._wide = Zone(nodes, self.body.space.equation, shape, *softness)
        self.solver = condensation(self.body.space.pattern, self._wide.condensed, self._single)
        self._schur = None
        self._narrow(first, last)

    def _narrow(self, first, last):
        """Let contact be solved for on some points of those that are condensed onto."""
        first, last = max(first, self._outer.start), min(last, self._outer.stop)
        self._range, begin = self.places.whole(first, last), self._outer.start
        self.zone = self._wide.part(slice(self._range.start - begin, self._range.stop - begin))
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
            if self.distance and len(self._wide) > CONDENSED_WIDTH * (last - first):
                self._set_zone(first, last)
            first, last = self._round(on, 16, 8)
            if len(self.zone) > ZONE_WIDTH * (last - first):
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
        origin = np.array([-self.distance, self.height - self.depth])
        return self.places.at(self.points + self.body.u, which) - origin

    def _rows(self) -> Rows:
        """The constraints of the zone, worked out once where the body and the profile are."""
        where = self.zone, self.body.u, self.height, self.depth, self.distance
        if self._found and all(a is b for a, b in zip(where, self._found[0], strict=True)):
            return self._found[1]
        points = self._position(self._range)
        single = self.profile.evaluate(points)
        if self._valleys is None:
            rows = Rows(self.zone, self._range, np.full(len(self.zone), -1), *single)
        else:
            kept = [self.contact_force, self.active, *(self.friction.kept if self.friction else ())]
            rows = self._valleys.rows(self.zone, self._range, points, single, kept)
        self._found = where, rows
        return rows

    def _first_touch(self) -> float:
        """Height of the profile's origin at which it just touches the undeformed skin."""
        skin = np.concatenate([self.points[self.skin.nodes], self.places.at(self.points)])
        height = first_touch(skin + np.array([self.distance, 0.0]), self.profile)
        if np.isnan(height):
            reason = f"the stimulus left the pad at {self.distance * 1e3:.3g} mm"
            raise NonConvergence(self.time, reason, "a shorter way")
        return height

    def touching_depth(self) -> float:
        """Depth (m) at which the profile just touches the undeformed skin where it is now; zero
        where it came down first.
        """
        return self.height - self._first_touch()

    def save(self):
        """The state to come back to: body, contact forces, active nodes, depth, distance,
        friction.
        """
        contact = self.contact_force.copy(), self.active.copy()
        friction = self.friction and self.friction.save()
        return self.body.save(), contact, self.depth, self.distance, friction

    def restore(self, state):
        """Come back to a saved state."""
        body, contact, self.depth, self.distance, friction = state
        self.body.restore(body)
        self.contact_force, self.active = (values.copy() for values in contact)
        if self.friction:
            self.friction.restore(friction)
        self._factors = None

    def _start_again(self, distance):
        """Lift the profile off, let the body recover, and come down to first touch at another
        stroke distance (m).
        """
        self.body.restore(self._unloaded)
        self.contact_force[:], self.active[:] = 0, False
        self.distance = distance
        self.depth = self.touching_depth()
        if self.friction:
            self.friction.release()
        for observe in self.observers:
            observe(self.body, STEADY)
        self.force = self._tangential = 0.0
        # what was put in has come out again: the balance goes on from here
        dissipated = self.friction.dissipated if self.friction else 0.0
        self.work = self._gross = self._most_work = dissipated
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
            if 0 < self._most <= self.factorisations:
                reason = f"{self._most} matrices did not suffice"
                raise NonConvergence(self.time, reason, "a larger on_trouble.budget")
            if self._softened:
                limit = settings.max_iterations + SNAP_ITERATIONS
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
                    or sum(self._served) - len(self._served) * min(self._served) >= REUSE_PATIENCE
                ):
                    self._factors = None
                return iteration, residual
            if guessed and residual > before:
                raise _StepFailure("the state that was guessed is a bad one")
            ahead = residual * (residual / before) ** REUSE_AHEAD
            keep = (
                residual <= REUSE_BELOW
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
        if self._factors is None or self._factors[0] is not self.solver:
            return False
        now = self.body.factor
        return abs(now - self._factors[1]) <= REUSE_FACTOR_CHANGE * now

    def iterate(self, control, target, reuse=False):
        """One Newton iteration; returns the residual over its tolerance.

        ``reuse``: with the factors of the one before, in the same zone.
        """
        body, space = self.body, self.body.space
        if reuse:
            internal = body.against(self._internal)
        else:
            schur, internal = body.linearise(self.solver)
            self._take(schur)
            if not body.smallest_jacobian > 0:
                raise _StepFailure("an element has turned inside out")
            self.factorisations += 1
            self._factors, self._served = (self.solver, body.factor), []
        rows, schur = self._rows(), self._narrowed.schur
        reduced = self._narrowed.forward(space.to_equations(self.external - internal))
        goal = {"force": target} if control == "force" else {"depth_change": target - self.depth}
        # the geometric term of the gaps is part of the tangent, and kept as long as the rest of it
        zone, tangent, flexible = self._flexible or (None, None, None)
        goal["flexible"] = flexible if zone is rows.zone and tangent is schur else None
        known = schur, reduced, self.contact_force[rows.place], self.active[rows.place]
        if self.friction is None:
            step = solve_contact(rows, *known, **goal)
        else:
            step = self.friction.solve(rows, *known, self._motion(rows.zone), **goal)
        self._flexible = None if step.softened else (rows.zone, schur, step.flexible)
        self._softened |= step.softened
        self._stiff = step.stiffness
        du = space.to_nodes(self._narrowed.backward(step.condensed_displacement))
        share = self._go(du)
        self.depth += share * step.depth_change
        for values, new in ((self.contact_force, step.force), (self.active, step.active)):
            values[:] = 0
            values[rows.place] = new
        if self.friction:
            self.friction.accept(rows.place, step)
        residual = self._residual(step.force.sum(), target if control == "force" else 0.0)
        return residual if share == 1.0 else max(residual, 2.0)

    def _go(self, du):
        """Move the body by ``du`` (n, 2) m, or by the share of it, which is returned, that keeps
        every element from folding.
        """
        body, u, share = self.body, self.body.u, 1.0
        least = max(MIN_DET_F, DET_F_SHARE * body.smallest_jacobian)
        while True:
            body.advance(du, share)
            self._internal = body.internal_force()
            if body.smallest_jacobian > least or body.geometrically_linear:
                return share
            share /= 2
            least = MIN_DET_F if share < 0.2 else least
            if share < 0.05:
                raise _StepFailure("an element would turn inside out")
            body.displace(u)

    def _residual(self, pressing, force):
        """Largest of all errors of the present state over their tolerances.

        ``pressing``: N/m, sum of the contact forces. ``force``: N/m, asked for; 0 if a depth is.
        """
        body, settings, rows, stuck = self.body, self.settings, self._rows(), 0.0
        active = self.active[rows.place]
        if self.friction:
            motion, softness = self._motion(rows.zone), rows.zone.softness_along
            stuck = self.friction.creep(rows.place, active, rows.gradient, motion, softness)
        push, _ = self._forces()
        unbalanced = self.external - self._internal
        unbalanced[self.zone.nodes] += self.zone.shape.T @ push
        scale = max(pressing, np.abs(self.external).sum(), LEAST_SCALE * self._most_force)
        if scale == 0:  # nothing touches: the body must come back to rest
            scale = np.abs(self._internal).sum() + 1e-30
        unbalanced[body.space.fixed] = 0.0
        equilibrium = np.linalg.norm(unbalanced) / scale
        whole = np.linalg.norm(unbalanced.sum(axis=0)) / scale
        gap = rows.closing(self.contact_force[rows.place])
        opening = np.abs(gap[active]).max(initial=0.0)
        penetration = max(0.0, -gap.min(initial=0.0))
        balance = abs(force + push[:, 1].sum()) / force if force > 0 else 0.0
        amiss, pressed = body.volume_amiss()
        self._pressed = max(self._pressed, pressed)
        volume = amiss / max(pressed, LEAST_SCALE * self._pressed, 1e-300)
        return max(
            equilibrium / settings.force_tolerance,
            whole / SUM_TOLERANCE,
            balance / settings.force_tolerance,
            volume / (settings.volume_tolerance or VOLUME_TOLERANCE * settings.force_tolerance),
            max(opening, penetration, stuck) / (settings.gap_tolerance * self.skin.spacing),
        )

    def _motion(self, zone):
        """(nz, 2) m: how far the points of a zone have moved over the profile since the step
        began.
        """
        u, depth, distance = self._begin
        way = np.array([self.distance - distance, self.depth - depth])
        return zone.shape @ (self.body.u - u)[zone.nodes] + way

    def _touches_elsewhere(self):
        """Does skin outside the zone penetrate the profile? Then the zone has grown to it."""
        outside = np.delete(np.arange(len(self.places)), self._range)
        gap = self.profile.evaluate(self._position(outside))[0]
        deep = outside[gap < -self.settings.gap_tolerance * self.skin.spacing]
        if len(deep):
            self._widen_to(deep)
        return len(deep) > 0

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
        if self.external.any():  # dead loads, put on at once, do twice the work that is stored
            return
        change = energies[0] + energies[2] - self._energies[0] - self._energies[2] + lost
        share = ENERGY_SHARE
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
        if self._stiffness is None:
            return trapezoidal
        return trapezoidal - way**2 / 12 * (stiffness - self._stiffness)

    def _advance(self, dt, control, target, distance, predict, good=None):
        """One substep with predictor, check and commit. ``good``: asked of the contact that was
        found, before it is accepted.
        """
        saved = self.save()
        self._begin = self.body.u, self.depth, self.distance
        begin_depth, begin_distance = self._begin[1:]
        # a steady stroke takes no time: its steps are as long as their way
        size = dt if dt < STEADY else abs(distance - begin_distance) or dt
        body, past = self.body, self._now()
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
                nodes = self.zone.nodes
                off = [np.linalg.norm((body.u - guess.u)[nodes]) for guess in guesses]
                self._quadratic = np.argmin(off) > 0
            push, pull = self._forces()
            tangential, force = map(float, 0.0 - push.sum(0))
            if force < -1e-9 * self.contact_force.sum():
                raise _StepFailure("the indenter is pulled instead of pushed")
            if good is not None and not good():
                raise _TooFar
            body.commit()
            moved = distance != begin_distance
            stiffness = None if moved else self._stiff
            clearance = clearance if force else self._clearance()
            work = self._pressing_work(force, self.depth - begin_depth, stiffness, clearance)
            work += 0.5 * (self._tangential + tangential) * (distance - begin_distance)
            lost = 0.0
            if self.friction:
                lost = self.friction.commit(self._range, pull, self._motion(self.zone))
            rows = self._rows()
            pressing = self.contact_force[rows.place]
            network, *others = body.energies()
            smoothing = 0.5 * float(pressing @ (rows.closing(pressing) - rows.gap))
            energies = (network + smoothing, *others)
            self._check_energy(work, energies, lost, moved)
        except _StepFailure:
            self.restore(saved)
            raise
        for observe in self.observers:
            observe(body, dt)
        self.force, self._tangential, self._stiffness = force, tangential, stiffness
        self.work += float(work)
        self._gross += abs(float(work))
        self._most_force = max(self._most_force, force)
        self._most_work = max(self._most_work, abs(self.work))
        self._energies = energies
        self._past = [(size, past), *self._past[:1]]
        return iterations, residual

    def _now(self):
        return _State(self.body.u, self.body.pressed, self.contact_force, self.depth)

    def _predictions(self, dt):
        """States after a step of ``dt``: on the straight line through the last two states, and on
        the parabola through the last three if there are as many.
        """
        sizes, states = [size for size, _ in self._past], [self._now(), *(s for _, s in self._past)]
        weights = []
        if sizes:
            ratio = dt / sizes[0]
            weights.append([1 + ratio, -ratio])
        if len(sizes) > 1:
            one, both = sizes[0], sum(sizes)
            now = (dt + one) * (dt + both) / (one * both)
            before = -dt * (dt + both) / (one * sizes[1])
            weights.append([now, before, dt * (dt + one) / (both * sizes[1])])
        return [
            _State(*(sum(map(mul, share, values)) for values in zip(*states, strict=True)))
            for share in weights
        ]

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
            NonConvergence: a step fails even after MAX_HALVINGS halvings or
            MOST_ITERATIONS iterations; its ``records`` hold what
                converged.
        """
        records: list[Record] = []
        strides, last = Strides(iter(steps), between), None
        self._touches.clear()
        lost, begun = 0, self.time
        while (following := strides.next()) is not None:
            step, passed = following
            if lost:  # what is left of it
                left = step.dt if step.dt >= STEADY else step.dt - (self.time - begun)
                step = replace(step, dt=left, fresh=False)
            try:
                iterations, halvings, residual = self._complete(
                    step, last, records, strides if between else None
                )
            except _TooFar:
                strides.shorten()
                continue
            except NonConvergence as problem:
                if self.patience > 0 and problem.halvings:
                    self.patience, self._share, last = self.patience - 1, RESUMED_SHARE, None
                    self.resumed.append(self.time)
                    lost += problem.halvings
                    continue
                problem.records = records
                raise
            strides.found(step)
            halvings, lost, begun, self._share = halvings + lost, 0, step.time, 1.0
            last = step if not halvings else None
            self.total_iterations += iterations
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
        same_leg = last is not None and last.leg == step.leg and last.dt > 0
        predict = same_leg and not step.fresh and not pressed
        done, size, iterations, halvings, self._spent = 0.0, 1.0, 0, 0, 0
        if not predict:
            self._past.clear()
            self._factors = None
        self._follow()
        while done < 1.0:
            size = min(size, self._share, 1.0 - done)
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
        force, _, length, edges = self._on_nodes()
        x = (self.points + self.body.u)[self.skin.nodes, 0]
        drag, press = self._forces()[0].sum(0)
        stuck = self.contact_force[self.friction.state == STICK].sum() if self.friction else 0.0
        share = float(stuck / max(self.contact_force.sum(), 1e-300))
        drag = float(drag / press) if press else 0.0
        return Touch(x, force / length, edges, self.distance, drag, share)

    def _give_up_if_vain(self, failure, size, halvings, records):
        """NonConvergence where smaller parts of a step are of no use."""
        aside = bool(records) and self._slips_off(records[-1])
        spent = self._spent > MOST_ITERATIONS
        if size >= 0.5**MAX_HALVINGS and not spent and not (aside and halvings > 1):
            return
        unit = self.body.space.kinematics.force_unit
        force = f"{self.force:.4g} {unit}"
        where = f" (depth {self.depth * 1e3:.4g} mm, force {force} of the meshed part)"
        reason, advice = str(failure), self._advice(str(failure))
        if spent:
            tried = (
                f"{self._spent} Newton iterations did not suffice for a step cut {halvings} times"
            )
            reason = f"{tried}; {reason}"
        if aside:
            way = f"{self.distance * 1e3:.3g} mm"
            reason, advice = f"the stimulus left the pad at {way}", f"a way of less than {way}"
        problem = NonConvergence(self.time, reason, advice, where)
        problem.halvings = 0 if aside else halvings
        raise problem from failure

    def _slips_off(self, record):
        """Was the pad touched, on its way along the profile, by its side only? Then nothing can
        hold it there.
        """
        push = -(record.nodal_force @ record.gradient)
        return bool(record.distance) and abs(push[0]) > np.tan(SIDE_ANGLE) * push[1]

    def _advice(self, reason):
        spacing = float(np.median(PER_NODE * self.places.spacing[self._range]))
        if about_profile := self.profile.advice(spacing):
            return about_profile
        if "inside out" in reason:
            return FOLDED
        if "energy" in reason:
            fillet = "a fillet on sharp edges that pass over the skin"
            return f"smaller steps, a finer skin mesh, or {fillet}"
        return "more steps, a finer mesh, or depth instead of force control"

    def _on_nodes(self):
        """Force (ns,) N/m on the skin's nodes, its direction (ns, 2), their length (ns,) m, and the
        contact's edges.
        """
        rows, places, part = self._rows(), self.places, self._range
        if self._nodal and self._nodal[0] is rows:
            return self._nodal[1]
        push = np.zeros((len(places), 2))
        push[part] = rows.of_points(self.contact_force[rows.place][:, None] * rows.gradient)
        normal = np.hypot(*push.T)
        nodal, force = places.of_nodes(push), places.of_nodes(normal)
        size = np.hypot(*nodal.T)[:, None]
        gradient = np.divide(nodal, size, out=np.zeros_like(nodal), where=force[:, None] > 0)
        position = self.points + self.body.u
        # the linear theory knows no deformed lengths
        length = places.lengths(self.points if self.body.geometrically_linear else position)
        pressure = normal[part] / length[part]
        mirrored, x = part.start == 0 and places.mirrored, places.at(position, part)[:, 0]
        edges = contact_edges(x, pressure, places.spacing[part], mirrored)
        self._nodal = rows, (force, gradient, places.of_nodes(length), edges)
        return self._nodal[1]

    def _record(self, step, iterations, halvings, residual, passed):
        force, gradient, length, edges = self._on_nodes()
        rows, friction = self._rows(), self.friction
        pressing = self.contact_force[rows.place]
        slack = np.abs(rows.closing(pressing)) * pressing
        network, spring, branch_work = self._energies
        frictional = friction.dissipated if friction else 0.0
        # a body that is let go gives the work back: there is nothing left to relate an error to
        missing = abs(self.work - network - branch_work - frictional)
        balance = missing / max(abs(self.work), 0.1 * self._most_work, 1e-300)
        tangential = friction.record(self.active, self.places) if friction else (None, None, None)
        return Record(
            leg=step.leg,
            time=step.time,
            depth=self.depth,
            distance=self.distance,
            force=self.force,
            tangential_force=self._tangential,
            nodal_force=force,
            gradient=gradient,
            length=length,
            edges=edges,
            displacement=self.body.u.copy(),
            tangential=tangential[0],
            slip=tangential[1],
            state=tangential[2],
            iterations=iterations,
            halvings=halvings,
            residual=residual * self.settings.force_tolerance,
            complementarity=float(slack.sum() / max(pressing.sum(), 1e-300) / self.skin.spacing),
            smallest_jacobian=float(self.body.smallest_jacobian),
            energy_error=float(balance) if self.work else 0.0,
            work=self.work,
            energies=self._energies,
            dissipated=branch_work - spring,
            frictional=frictional,
            passed=passed,
        )

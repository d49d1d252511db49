"""Coulomb friction, solved exactly together with unilateral contact in the condensed (Schur)
system.

Beside its normal multiplier ``f >= 0`` every touching point has a tangential one, ``tau`` along ``t
= (-n_y, n_x)``, n the gap's gradient. With ``s`` the slip of the point over the profile since the
step began,

    |tau| <= mu f,    s = 0 where |tau| < mu f,    tau = -mu f sign(s) where s != 0,

which is implicit (backward Euler) in time. Each linearised problem is solved to the end by
exchanging states (open, sticking, slipping either way) until every node satisfies its own: the
trial rule |tau - c s| <= mu f of the primal-dual active set method (Alart and Curnier 1991; Hueber,
Stadler and Wohlmuth 2008). The global tangent stays symmetric, for friction only ever meets the
small dense system. What a zone's softness adds to the gaps it takes from the slip, of the friction
that has changed in the step.
"""

from typing import cast

import numpy as np

from fingerpad.mechanics import kernels
from fingerpad.mechanics.contact import (
    ContactError,
    ContactStep,
    Flexibility,
    Rows,
    controlled,
    pressing_stiffness,
    require_stable,
    respond,
    tangents,
    until_stable,
)

#: What :attr:`Coulomb.state` holds where there is contact: 0 sticks, +-1 slips with the friction on
#: the skin along +-t.
STICK = 0


class Coulomb:
    """Coulomb's law with one coefficient, and the state of every point of the skin.

    Parameters
    ----------
    coefficient : float
        Of friction.
    count : int
        Number of places where contact may be: points of the skin, twice as many where the profile
        has valleys, on both sides of which a point may lean.

    Attributes
    ----------
    tangential : (count,) N/m
        Force on the skin along the tangent.
    state : (count,)
        0 sticks, -1 or 1 slips with the friction to that side.
    slip : (count,) m
        Since the step began.
    dissipated : float
        J/m so far.
    """

    def __init__(self, coefficient: float, count: int):
        self.coefficient = float(coefficient)
        self.tangential = np.zeros(count)
        self._before = np.zeros(count)  # the tangential force when the step began
        self.state = np.zeros(count, np.int8)
        self.slip = np.zeros(count)
        self.dissipated = 0.0
        self._pull = np.zeros((count, 2))

    @property
    def kept(self) -> list[np.ndarray]:
        """What belongs to the places and goes with a point from one side of a valley to the
        other.
        """
        return [self.tangential, self._before, self.state]

    def save(self):
        """The state to come back to."""
        return self.tangential.copy(), self.state.copy(), self._pull, self.dissipated

    def restore(self, saved) -> None:
        """Come back to a saved state."""
        self.tangential, self.state = saved[0].copy(), saved[1].copy()
        self._pull, self.dissipated = saved[2:]
        self._before = saved[0].copy()

    def release(self) -> None:
        """Contact is lost altogether."""
        self.tangential[:], self._before[:], self.state[:], self._pull = 0, 0, 0, 0 * self._pull

    def solve(
        self,
        rows: Rows,
        schur,
        right,
        previous_force,
        active,
        motion,
        *,
        force: float | None = None,
        depth_change: float | None = None,
        flexible: Flexibility | None = None,
    ) -> ContactStep:
        """Solve the linearised unilateral and frictional problem exactly.

        Parameters
        ----------
        motion : (nr, 2) array
            m, of the points over the profile since the step began. The other parameters are those
            of :func:`contact.solve_contact`.

        Raises
        ------
        ContactError
            No consistent set of states is found.
        """
        zone, part = rows.zone, rows.place
        tangent = tangents(rows.gradient)
        moved = np.einsum("ni,ni->n", motion, tangent) - zone.softness_along @ self._before[part]

        def attempt(flexible):
            answer = respond(zone, flexible, right, [rows.gradient, tangent])
            offset = answer.free + np.concatenate([rows.gap, moved])
            offset, load = controlled(answer, offset, force, depth_change)
            f, tau, found, on, state, yields = _solve(
                self.coefficient, answer, offset, load, active, self.state[part], rows.partner
            )
            require_stable(flexible, answer.compliance[: len(f), : len(f)], on)
            dd = found if depth_change is None else depth_change
            du = answer.displacement(np.concatenate([f, tau]), dd)
            return ContactStep(
                du, dd, f, on, flexible, stiffness=yields, tangential=tau, state=state
            )

        return until_stable(attempt, rows, schur, previous_force, flexible)

    def accept(self, part: slice, step: ContactStep) -> None:
        """Take over forces and states of a solution."""
        self.tangential[:], self.state[:] = 0, 0
        self.tangential[part], self.state[part] = step.tangential, cast(np.ndarray, step.state)

    def pull(self, part: slice, gradient: np.ndarray) -> np.ndarray:
        """(nz, 2) N/m tangential force on the points of the zone, whose gap gradients (nz, 2)
        are.
        """
        return self.tangential[part, None] * tangents(gradient)

    def creep(
        self,
        part: slice,
        active: np.ndarray,
        gradient: np.ndarray,
        motion: np.ndarray,
        softness: np.ndarray,
    ) -> float:
        """Record the slip; returns the largest one (m) of a point that should stick. softness:
        along the skin, of the zone.
        """
        self.slip[:] = 0
        slip = np.einsum("ni,ni->n", motion, tangents(gradient))
        slip = slip + softness @ (self.tangential - self._before)[part]
        self.slip[part] = slip * active
        return float(np.abs(self.slip[part][self.state[part] == STICK]).max(initial=0.0))

    def commit(self, part: slice, pull: np.ndarray, motion: np.ndarray) -> float:
        """The step has converged, (nz, 2) N/m pull at the points; returns what friction dissipated,
        J/m (trapezoidal in time).
        """
        full = np.zeros_like(self._pull)
        full[part] = pull
        lost = -0.5 * float(np.sum((self._pull[part] + pull) * motion))
        self._pull, self._before = full, self.tangential.copy()
        self.dissipated += lost
        return lost

    def record(self, active: np.ndarray, places) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Tangential force, slip and state (0 open, 1 sticks, 2 slips) of every skin node (ns,),
        for the record.

        A node slips where all points round it that touch slip one way, on the average as far as
        they.
        """
        active = active.astype(float)
        touching, sliding, tangential, slip = (
            places.of_nodes(each.reshape(-1, len(places)).sum(axis=0))
            for each in (active, active * self.state, self.tangential, active * self.slip)
        )
        on, slides = touching > 0, np.abs(sliding) > touching * (1 - 1e-9)
        if places.mirrored:  # what is odd has no value on the axis
            tangential[0], slides[0] = 0.0, False
        slip = np.divide(slip, touching, out=np.zeros_like(slip), where=on & slides)
        return tangential, slip, np.where(on, np.where(slides, 2, 1), 0).astype(np.int8)


class _Cycling(ContactError):
    """No consistent set of states was found."""


def _solve(mu, answer, offset, load, active, state, partner):
    """Forces f and tau, depth change, closed gaps, states and stiffness of the linearised problem.

    A node that comes into contact slips at first, against its motion: entering as sticking makes
    the states cycle. Where friction is so large that slipping nodes wedge themselves in it is the
    other way round. If neither ends, Tresca's problem (given bounds of the friction, which always
    has a solution) is solved again and again with the bounds that its own pressures give.
    """
    problem = answer, offset, load, partner
    for entering_sticks in (False, True):
        try:
            return _exchange(mu, *problem, active, state, entering_sticks)
        except _Cycling:
            pass
    f, bound = _exchange(0.0, *problem, active, 0 * state)[0], None
    for _ in range(60):
        bound = mu * f if bound is None else 0.5 * (bound + mu * f)
        found = _exchange(mu, *problem, active, state, bound=bound)
        f, _, _, active, state, _ = found
        if np.abs(mu * f - bound).max() <= 1e-6 * mu * f.max():
            return found
    raise _Cycling("stick and slip keep cycling")


def _exchange(mu, answer, offset, load, partner, active, state, entering_sticks=False, bound=None):
    """Exchange states until all are consistent; ``bound``: (nz,) N/m of the friction, instead of mu
    times the normal force.

    A node that leans on both sides of a valley is held by them: it cannot slip, so no friction is
    asked of it.
    """
    n = len(active)
    a, lever = answer.compliance, answer.lever
    active, state = active.copy(), state.astype(int)
    if not active.any() and load is not None:
        nearest = np.argmin(offset[:n])
        active[nearest], state[nearest] = True, -np.sign(offset[n + nearest])
    # below zero where a load on a sharp curve outweighs the body: it yields all the same
    yielding = np.abs(np.diag(a)[n:])
    # cannot move along the tangent: a wall carries its friction
    held = yielding <= 1e-12 * yielding.max(initial=0.0)
    state[held] = -np.sign(offset[n:][held])
    stiffness = 0.5 / np.where(held, np.inf, yielding)
    scale = max(np.abs(offset).max(), 1e-12)
    best, patience, seen, single = 2 * n + 1, 10, set(), set()
    for exchange in range(1, 60 + 2 * n):
        free = ~((partner >= 0) & active & active[partner])
        on, stick = np.flatnonzero(active), np.flatnonzero(active & (state == STICK) & ~held & free)
        share = mu * state * free if bound is None else np.zeros(n)
        given = np.zeros(n) if bound is None else bound * state * (active & free)
        i, j = len(on), len(stick)
        size = i + j + (load is not None)
        transposed, right = np.empty((size, size)), np.zeros((size, 2))
        kernels.exchanged(a, share, on, stick, transposed)
        system = transposed.T
        needed = offset if bound is None else offset + a[:, n:] @ given
        right[:i, 0], right[i : i + j, 0] = -needed[:n][on], -needed[n:][stick]
        if load is not None:
            system[:i, -1], system[i : i + j, -1] = lever[:n][on], lever[n:][stick]
            system[-1, :i] = -lever[:n][on] - share[on] * lever[n:][on]
            system[-1, i : i + j] = -lever[n:][stick]
            system[-1, -1], right[-1] = answer.corner, (load + lever[n:] @ given, 1.0)
        try:
            solution = np.linalg.solve(system, right)
        except np.linalg.LinAlgError as error:
            raise ContactError("the frictional contact compliance is singular") from error
        f, tau = np.zeros(n), np.zeros(n)
        f[on] = solution[:i, 0]
        tau[on] = share[on] * f[on] + given[on]
        tau[stick] = solution[i : i + j, 0]
        dd = solution[-1, 0] if load is not None else 0.0
        gap, slip = (offset + a @ np.concatenate([f, tau]) + lever * dd).reshape(2, n)
        tiny = 1e-12 * np.abs(f).max(initial=0.0)
        wrong = np.where(active, f < -tiny, gap < -1e-11 * scale)
        sliding = active & (state != STICK) & ~wrong & ~held & free
        most = mu * np.maximum(f, 0) if bound is None else bound
        over = np.abs(tau) > most * (1 + 1e-10) + tiny
        slides = active & (state == STICK) & ~wrong & free & over
        sticks = sliding & (state * slip > 1e-11 * scale)
        count = int(wrong.sum() + slides.sum() + sticks.sum())
        if not count:
            f[~active] = tau[~active] = 0
            # held fast, though it may have come a long way in this step
            state = np.where(free | (state != STICK), state, 1)
            if load is None:
                yields = pressing_stiffness(answer, system, np.concatenate([on, n + stick]), share)
            # what is left of the depth's own equation: the second solution is of a unit of it
            else:
                yields = 1 / solution[-1, 1] if solution[-1, 1] else None
            state = np.where(active, state, 0).astype(np.int8)
            return np.maximum(f, 0), tau, dd, active, state, yields
        key = (active.tobytes(), state.tobytes())
        if count < best:
            best, patience = count, 10
        elif patience and key not in seen:
            patience -= 1
        else:  # one at a time, which either ends or comes round
            if (*key, exchange % 2) in single:
                break
            single.add((*key, exchange % 2))
            last = np.flatnonzero(wrong | slides | sticks)[-1 if exchange % 2 else 0]
            only = np.arange(n) == last
            wrong, slides, sticks = wrong & only, slides & only, sticks & only
        seen.add(key)
        reverse = sticks & (stiffness * state * slip > 2 * most)
        entering = wrong & ~active
        state = np.where(
            slides, np.sign(tau), np.where(reverse, -state, np.where(sticks, STICK, state))
        ).astype(int)
        state = np.where(entering, 0 if entering_sticks else -np.sign(slip), state).astype(int)
        flipped = active ^ wrong
        if load is not None and not flipped.any():
            # someone must carry the force, if not in this state then in the next
            only = np.argmax(np.where(active, f, -np.inf))
            flipped[only], state[only] = True, (state[only] + 2) % 3 - 1
        active = flipped
    raise _Cycling("stick and slip keep cycling")

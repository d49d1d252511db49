"""A history at all its outputs, from the states that were found: between them no more is solved
(Hairer, Norsett and Wanner 1993, section II.6, call that dense output).

What the body does goes from state to state along cubic splines through them, twice continuously
differentiable, for rates are asked of it: one a leg, and another wherever a piece of the contact
has come or gone, or all of a stroked one first slips, which leaves a kink. They are over the way of
a stroke, else over time. The contact goes along with the surface
(:mod:`fingerpad.mechanics.strides`); where nothing moves along it, it is as wide as splines say,
and nodes that stay in it have curves of their own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import Akima1DInterpolator, CubicHermiteSpline, CubicSpline

from fingerpad.mechanics.stepping import Record
from fingerpad.mechanics.strides import Passage, Touch

_OF_THE_STEP = ("leg", "residual", "complementarity_error", "energy_balance_error", "min_detF")
"""What an output has of the state it leads to."""
_TAKEN = ("newton_iterations", "cutbacks")
"""What it took to find a state: between them nothing."""
_PRESSURES = ("contact_pressure", "contact_pressure_smoothed")
"""What goes along with the contact and falls to zero at its edges."""
_LEAST = 4
"""States, through fewer of which goes no cubic."""
_SAME = 1e-6
"""Of a width, which has not changed if it has by less."""


def at_outputs(
    found: dict[str, np.ndarray],
    time: np.ndarray,
    records: Sequence[Record],
    skin_x: np.ndarray,
    apex: int,
    half: bool = False,
):
    """The arrays of a history (states, ...) and its times (states,) s at all outputs.

    Parameters
    ----------
    found
        At the unloaded pad and each of ``records``.
    skin_x
        (skin nodes,) m, undeformed.
    apex
        The middle skin node.
    half
        Are the records' edges of the right half?.
    """
    count = [len(record.passed) + 1 for record in records]
    state = np.concatenate([[0], np.repeat(np.arange(1, len(records) + 1), count)]).astype(int)
    passed = np.concatenate([[False], *(np.arange(n) < n - 1 for n in count)]).astype(bool)
    out = {"interpolated": passed.astype(np.int8)} | {
        name: values[state] for name, values in found.items()
    }
    time = np.asarray(time)
    times = time[state]
    if not passed.any():
        return out, times
    steps = [step for record in records for step in record.passed]
    times[passed] = [step.time for step in steps]
    place, share = found["stroke_distance"][state], np.ones(len(state))
    place[passed] = [step.distance for step in steps]
    smooth = [name for name in found if name not in (*_OF_THE_STEP, *_TAKEN, "stroke_distance")]
    for leg in np.unique(found["leg"][state[passed]]):
        own = np.flatnonzero(found["leg"] == leg)
        own = own[own > 0]
        knots, here = np.append(max(own[0] - 1, 0), own), passed & np.isin(state, own)
        way = np.sign(found["stroke_distance"][own[-1]] - found["stroke_distance"][knots[0]])
        known, at = (way * found["stroke_distance"], way * place) if way else (time, times)
        kinks = _kinks(found["contact_pressure"][knots] > 0)
        if way and "contact_state" in found:
            kinks = np.union1d(kinks, _slip_begins(found["contact_state"][knots]))
        for name in smooth:
            values = found[name][knots]
            if name in _PRESSURES and not way:
                out[name][here] = _of_nodes(known[knots], values, at[here])
            else:
                curves = _through(known[knots], values.reshape(len(knots), -1), kinks, at[here])
                out[name][here] = curves.reshape(-1, *values.shape[1:])
        last = state[here]
        share[here] = (at[here] - known[last - 1]) / (known[last] - known[last - 1])
        if not way:
            width = found["contact_width"]
            grown = width[last] - width[last - 1]
            changed = np.abs(grown) > _SAME * width[last]
            share[here] = np.where(
                changed,
                (out["contact_width"][here] - width[last - 1]) / np.where(changed, grown, 1.0),
                share[here],
            ).clip(0, 1)
    out["stroke_distance"] = place
    for name in _TAKEN:
        out[name][passed] = 0
    _contact(out, found, state, passed, share, records, skin_x, half)
    out["peak_pressure"] = out["contact_pressure"].max(axis=1)
    out["centre_pressure"] = out["contact_pressure"][:, apex]
    return out, times


def _kinks(touches: np.ndarray) -> np.ndarray:
    """States (k,) that have more pieces of contact, or fewer, than the one before; touches:
    (states, ns), of nodes.
    """
    pieces = np.count_nonzero(np.diff(touches.astype(np.int8), axis=1, prepend=0) > 0, axis=1)
    return np.flatnonzero(np.diff(pieces)) + 1


def _slip_begins(states: np.ndarray) -> np.ndarray:
    """The first state (1,) in which all of the contact slips, of those (n, ns) of nodes of a
    stroke; none (0,) if it does from the start, or never.
    """
    slips = (states == 2).any(axis=1) & ~(states == 1).any(axis=1)
    return np.flatnonzero(slips)[:1] if not slips[0] else np.zeros(0, int)


def _through(place, values, kinks, at):
    """Values (k, nc) at places (k,) of curves through those (n, nc) at rising places (n,): splines
    from one of the states ``kinks`` to before the next. What lies between two splines goes on as
    they do, but neither higher nor lower than its ends (Fritsch and Carlson 1980).
    """
    slopes = _slopes(place, values, kinks)
    out = CubicHermiteSpline(place, values, slopes)(at)
    for ends in np.column_stack([kinks - 1, kinks]):
        inside = (at > place[ends[0]]) & (at < place[ends[1]])
        most = 3 * np.diff(values[ends], axis=0) / np.diff(place[ends])
        held = np.clip(slopes[ends], np.minimum(most, 0), np.maximum(most, 0))
        out[inside] = CubicHermiteSpline(place[ends], values[ends], held)(at[inside])
    return out


def _slopes(place, values, kinks):
    """Of splines through values (n, nc) at places (n,), and where these would be of few states
    Akima's, which no kink nearby misleads much.
    """
    if len(place) < _LEAST:
        return np.gradient(values, place, axis=0)
    pieces = np.split(np.arange(len(place)), kinks)
    slopes = np.empty(values.shape)
    if min(map(len, pieces)) < _LEAST:
        slopes[:] = Akima1DInterpolator(place, values, method="makima")(place, 1)
    for each in pieces:
        if len(each) >= _LEAST:
            slopes[each] = CubicSpline(place[each], values[each])(place[each], 1)
    return slopes


def _contact(out, found, state, passed, share, records, skin_x, half):
    """Pressure, traction, slip and state of the contact between states, into ``out``; share:
    (outputs,) of the way from one.
    """
    x, frictional = skin_x + out["skin_displacement_x"], "contact_state" in found

    def touch(k):
        edges = records[k - 1].edges if k else (np.nan, np.nan)
        edges = (-edges[1], edges[1]) if half else edges
        moved = skin_x + found["skin_displacement_x"][k]
        return Touch(moved, found["contact_pressure"][k], edges, found["stroke_distance"][k], 0.0)

    for k in np.unique(state[passed]):
        first, last = touch(k - 1), touch(k)
        outputs, before, still = np.flatnonzero(state == k), 0.0, first.distance == last.distance
        if frictional:
            ratios = [_ratio(found, j) for j in (k - 1, k)]
            states = [_spread(found, j, found["contact_state"][j]) for j in (k - 1, k)]
            slipped = _spread(found, k, found["slip"][k])
        for i in outputs:
            here = Passage.at(first, last, share[i], x[i]) if passed[i] else None
            if here:
                for name in _PRESSURES:
                    ends = found[name][[k - 1, k]]
                    carried = here.pressure(*ends)
                    out[name][i] = (
                        _pressing(out[name][i], carried, ends, share[i]) if still else carried
                    )
            if not frictional:
                continue
            if here:
                ratio, most, both = (
                    here.value(*ratios),
                    here.value(*np.abs(ratios)),
                    here.value(*states),
                )
                # what slips in both states, and the same way, slips between them
                slides = (both > 2 - 1e-9) & (np.abs(ratio) > most - 1e-9)
                pressure = out["contact_pressure"][i]
                out["tangential_traction"][i] = pressure * ratio
                out["contact_state"][i] = np.where(slides, 2, 1) * (pressure > 0)
            slip = slipped if passed[i] else found["slip"][k]
            out["slip"][i] = slip * (share[i] - before) * (out["contact_state"][i] == 2)
            before = share[i]


def _of_nodes(place, pressure, at):
    """Pressures (k, ns) at places (k,) of nodes under which nothing passes, from those (n, ns) at
    places (n,): their squares, which grow evenly from where a node begins to touch, along Akima's
    curves.
    """
    squares = Akima1DInterpolator(place, pressure**2, method="makima")(at)
    return np.sqrt(np.maximum(squares, 0.0))


def _pressing(of_nodes, carried, ends, share):
    """Pressure (ns,) under a press: nodes that touch in the states at both ``ends`` (2, ns) have
    their own; one that comes or goes has what goes along with the contact's edge, but no more than
    if its square grew from the first moment.
    """
    touches = ends > 0
    most = ends.max(axis=0) * np.sqrt(np.where(touches[1], share, 1 - share))
    return np.where(touches.all(axis=0), of_nodes, np.minimum(carried, most))


def _ratio(found, k):
    """Traction over pressure (skin nodes,) in a state."""
    pressure = found["contact_pressure"][k]
    return _spread(
        found, k, found["tangential_traction"][k] / np.where(pressure > 0, pressure, 1.0)
    )


def _spread(found, k, values):
    """Values (skin nodes,) of the contact in a state; beside it those of its edges."""
    on = np.flatnonzero(found["contact_pressure"][k] > 0)
    return np.interp(np.arange(len(values)), on, values[on]) if len(on) else np.zeros(len(values))

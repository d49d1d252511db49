"""A history at all its outputs, from the states that were found: between them no more is solved (Hairer, Norsett and Wanner 1993,
section II.6, call that dense output).

What the body does goes from state to state along a cubic spline through them, twice continuously differentiable, for rates are
asked of it: one a leg, and another where contact is lost or comes back. The contact goes along with the surface
(:mod:`fingerpad.mechanics.strides`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fingerpad.mechanics.stepping import Record
from fingerpad.mechanics.strides import Passage, Touch

_OF_THE_STEP = ("leg", "residual", "complementarity_error", "energy_balance_error", "min_detF")
"""What an output has of the state it leads to."""
_TAKEN = ("newton_iterations", "cutbacks")
"""What it took to find a state: between them nothing."""
_LEAST = 4
"""States, of which fewer are joined by straight lines."""


def at_outputs(found: dict[str, np.ndarray], time: np.ndarray, records: Sequence[Record], skin_x: np.ndarray, apex: int):
    """The arrays of a history (states, ...) and its times (states,) s at all outputs.

    Args:
        found: at the unloaded pad and each of ``records``. skin_x: (skin nodes,) m, undeformed. apex: the middle skin node.
    """
    count = [len(record.passed) + 1 for record in records]
    state = np.concatenate([[0], np.repeat(np.arange(1, len(records) + 1), count)]).astype(int)
    passed = np.concatenate([[False], *(np.arange(n) < n - 1 for n in count)]).astype(bool)
    out = {"interpolated": passed.astype(np.int8)} | {name: values[state] for name, values in found.items()}
    times = np.asarray(time)[state]
    if not passed.any():
        return out, times
    steps = [step for record in records for step in record.passed]
    times[passed] = [step.time for step in steps]
    place = found["stroke_distance"][state]
    place[passed] = [step.distance for step in steps]
    smooth = [name for name in found if name not in (*_OF_THE_STEP, *_TAKEN, "stroke_distance")]
    for leg in np.unique(found["leg"][state[passed]]):
        own = np.flatnonzero(found["leg"] == leg)
        own = own[own > 0]
        knots, here = np.append(max(own[0] - 1, 0), own), passed & np.isin(state, own)
        way = np.sign(found["stroke_distance"][own[-1]] - found["stroke_distance"][knots[0]]) or 1.0
        pieces = _pieces(found["force"][knots] > 0)
        which = np.searchsorted(way * found["stroke_distance"][knots[pieces[1:, 0]]], way * place[here], side="right")
        for piece, (first, last) in enumerate(pieces):
            part, inside = knots[first : last + 1], np.flatnonzero(here)[which == piece]
            for name in smooth:
                out[name][inside] = _through(way * found["stroke_distance"][part], found[name][part], way * place[inside])
    out["stroke_distance"] = place
    for name in _TAKEN:
        out[name][passed] = 0
    _contact(out, found, state, passed, place, records, skin_x)
    out["peak_pressure"], out["centre_pressure"] = out["contact_pressure"].max(axis=1), out["contact_pressure"][:, apex]
    return out, times


def _pieces(touches: np.ndarray) -> np.ndarray:
    """(k, 2) first and last state of the pieces that states (n,) fall into: of those that touch or do not, one at the end shared.

    The state without contact beside one with it is of both: force has gone to zero there.
    """
    beside = np.zeros(len(touches), bool)
    beside[1:-1] = ~touches[1:-1] & (touches[:-2] | touches[2:])
    ends = np.unique([0, *np.flatnonzero(beside), len(touches) - 1])
    return np.column_stack([ends[:-1], ends[1:]])


def _through(place, values, at):
    """Values (k, ...) at places (k,) of a smooth curve through those (n, ...) at rising places (n,)."""
    if len(place) < _LEAST:
        flat = values.reshape(len(place), -1)
        return np.stack([np.interp(at, place, each) for each in flat.T], axis=-1).reshape(len(at), *values.shape[1:])
    from scipy.interpolate import CubicSpline

    return CubicSpline(place, values)(at)


def _contact(out, found, state, passed, place, records, skin_x):
    """Pressure, traction, slip and state of the contact between states, into ``out``."""
    x, frictional = skin_x + out["skin_displacement_x"], "contact_state" in found

    def touch(k):
        edges, drag = (records[k - 1].edges, 0.0) if k else ((np.nan, np.nan), 0.0)
        moved = skin_x + found["skin_displacement_x"][k]
        return Touch(moved, found["contact_pressure"][k], edges, found["stroke_distance"][k], drag)

    for k in np.unique(state[passed]):
        first, last = touch(k - 1), touch(k)
        outputs = np.flatnonzero(state == k)
        way = last.distance - first.distance
        before = first.distance
        for i in outputs:
            here = Passage.at(first, last, (place[i] - first.distance) / way, x[i]) if passed[i] else None
            if here:
                for name in ("contact_pressure", "contact_pressure_smoothed"):
                    out[name][i] = here.pressure(*found[name][[k - 1, k]])
            if not frictional:
                continue
            if here:
                ratios = [_ratio(found, j) for j in (k - 1, k)]
                ratio, most = here.value(*ratios), here.value(*np.abs(ratios))
                both = here.value(*(_spread(found, j, found["contact_state"][j]) for j in (k - 1, k)))
                # what slips in both states, and the same way, slips between them
                slides = (both > 2 - 1e-9) & (np.abs(ratio) > most - 1e-9)
                pressure = out["contact_pressure"][i]
                out["tangential_traction"][i] = pressure * ratio
                out["contact_state"][i] = np.where(slides, 2, 1) * (pressure > 0)
            slip = _spread(found, k, found["slip"][k]) if passed[i] else found["slip"][k]
            out["slip"][i] = slip * (place[i] - before) / way * (out["contact_state"][i] == 2)
            before = place[i]


def _ratio(found, k):
    """Traction over pressure (skin nodes,) in a state."""
    pressure = found["contact_pressure"][k]
    return _spread(found, k, found["tangential_traction"][k] / np.where(pressure > 0, pressure, 1.0))


def _spread(found, k, values):
    """Values (skin nodes,) of the contact in a state; beside it those of its edges."""
    on = np.flatnonzero(found["contact_pressure"][k] > 0)
    return np.interp(np.arange(len(values)), on, values[on]) if len(on) else np.zeros(len(values))

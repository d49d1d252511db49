"""Drag a rigid profile over the skin of a small mesh: what it does to every node, and blocks to do
it on.
"""

from dataclasses import dataclass

import numpy as np
from meshes import graded, nodes_of, rectangle
from pressing import TIGHT, Pressed, over_skin, skin_of
from problems import boundary, lame_constants, make_body

from fingerpad.mechanics.stepping import QuasiStatic, Record, Step

STICK, SLIP = 1, 2  # of Record.state


@dataclass(frozen=True)
class Dragged:
    """A state over the skin nodes: x (m), pressure and traction on the profile (Pa, + is against a
    positive slide).

    Without friction the traction is zero, nothing sticks and everything in contact slips.
    """

    x: np.ndarray
    pressure: np.ndarray
    traction: np.ndarray
    stick: np.ndarray
    slip: np.ndarray
    nodal_force: np.ndarray
    drag: np.ndarray  # N/m, of the traction
    pressed: Pressed
    record: Record
    moved: np.ndarray  # m, along x

    @property
    def ratio(self):
        """Tangential over normal force."""
        return self.record.tangential_force / self.record.force


def dragged(body, skin, record, records=()):
    """:class:`Dragged` of one record."""
    pressed = over_skin(body, skin, records or [record], record)
    touching = record.nodal_force > 0
    if record.tangential is None:
        drag, stick, slip = np.zeros(len(touching)), np.zeros_like(touching), touching
    else:
        drag, stick, slip = (
            -record.tangential,
            touching & (record.state == STICK),
            touching & (record.state == SLIP),
        )
    moved = record.displacement[skin.nodes, 0]
    return Dragged(
        pressed.x,
        pressed.pressure,
        drag / record.length,
        stick,
        slip,
        record.nodal_force,
        drag,
        pressed,
        record,
        moved,
    )


def stroke(body, mesh, steps, profile, friction, settings=TIGHT, curve="top", external=None):
    """Run a schedule with friction; returns every step's :class:`Dragged`."""
    skin = skin_of(mesh, curve)
    stepper = QuasiStatic(body, skin, profile, settings, external=external, friction=friction)
    records = stepper.run(steps)
    return [dragged(body, skin, record, records) for record in records]


def slide(force, distance, count, press=1, depth=None, dt=1.0):
    """Press to ``force`` (or ``depth``) in ``press`` steps, then slide in ``count``; the press is
    leg 0.
    """
    goal = ("force", force) if depth is None else ("depth", depth)
    down = [Step(0, k * dt, dt, **{goal[0]: goal[1] * k / press}) for k in range(1, press + 1)]
    along = [
        Step(1, (press + k) * dt, dt, **{goal[0]: goal[1]}, distance=distance * k / count)
        for k in range(1, count + 1)
    ]
    return down + along


def drag_to(stepper, record, targets, first):
    """Records in which the tangential force has reached each of ``targets`` (N/m), from the state
    of ``record``.

    The force grows ever more slowly with the distance, so secants after a ``first`` small slide (m,
    either sign) come near without going beyond. Where nothing resists, the last record stands for
    all that cannot be reached.
    """
    out, force, slope = [], record.force, None
    for target in targets:
        for _ in range(30):
            left = target - record.tangential_force
            if abs(left) < 1e-5 * abs(target) + 1e-9 * force or slope == 0:
                break
            size = first if slope is None else left / slope
            step = Step(
                record.leg + 1, record.time + 1, 1.0, force=force, distance=record.distance + size
            )
            before, record = record, stepper.run([step])[-1]
            slope = (record.tangential_force - before.tangential_force) / size
            slope = 0 if abs(slope * size) < 1e-9 * force else slope
        out.append(record)
    return out


def block(
    half_length,
    depth,
    poisson,
    shear=1.0,
    columns=(20, 12),
    fine=1.25,
    strain="small",
    element=None,
    rows=None,
):
    """Whole block between smooth walls on a rigid base, fine at its middle.

    ``columns`` and ``rows``: equal ones within ``fine`` of the middle, growing ones beyond.
    """
    right = graded(fine / half_length, *columns)
    xs = np.concatenate([0.5 - right[:0:-1] / 2, 0.5 + right / 2])
    ys = 1 - graded(fine / depth, *(rows or columns))[::-1]
    mesh = rectangle(xs, ys, 2 * half_length, depth, origin=(-half_length, -depth))
    fixed = boundary(mesh, "bottom")
    fixed[nodes_of(mesh, "left", "right"), 0] = True
    young = 2 * shear * (1 + poisson)
    return mesh, make_body(mesh, fixed, *lame_constants(young, poisson), element, strain)

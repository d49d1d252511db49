"""The closest point of a curve of lines and arcs, as a compiled loop over points."""

from math import atan2, cos, hypot, inf, sin

import numpy as np
from numba import njit

from fingerpad.compiled import JIT


@njit(**JIT)
def closest(points, below, within, ends, pieces, limits, distance, gradient, curvature):
    """Signed distance (n,), its gradient (n, 2) and curvature (n,) at ``points`` (n, 2), into the
    last three.

    ``below`` (n,) bool: is the point in the solid? ``within`` (n,) m: farther along x the surface
    cannot be closest. ``ends`` (x, y, kink, bisector), each (m + 1,); ``pieces`` (centre (m, 2),
    tangent (m, 2), side, radius, line, reach); ``limits`` (overlap, touch): as
    :class:`fingerpad.stimuli.curve.Curve` has them. Returns how many pieces were looked at.
    """
    end_x, end_y, kink, bisector = ends
    centre, tangent, side, radius, line, reach = pieces
    overlap, touch = limits
    last, looked = len(end_x) - 2, 0
    for k in range(len(points)):
        x, y = points[k, 0], points[k, 1]
        first = np.searchsorted(end_x[1:-1], x - within[k])
        final = np.searchsorted(end_x[1:-1], x + within[k], side="right")
        looked += final + 1 - first
        to_piece, to_corner, on, at = inf, inf, first, first
        for piece in range(first, final + 1):
            arm_x, arm_y = x - centre[piece, 0], y - centre[piece, 1]
            along = arm_x * tangent[piece, 0] + arm_y * tangent[piece, 1]
            across = arm_x * tangent[piece, 1] - arm_y * tangent[piece, 0]
            past = -inf
            if line[piece]:
                away = abs(across)
                if piece < last:
                    past = along - reach[piece]
                if piece > 0:
                    past = max(past, -along)
            else:
                away = abs(hypot(along, across) - radius[piece])
                if piece < last:
                    past = radius[piece] * (abs(atan2(along, side[piece] * across)) - reach[piece])
            if past <= overlap and away < to_piece:
                to_piece, on = away, piece
            if piece > 0:
                corner = hypot(x - end_x[piece], y - end_y[piece])
                if corner < to_corner:
                    to_corner, at = corner, piece
        if to_corner < to_piece - overlap:
            sign = -1.0 if below[k] else 1.0
            bend = sign / max(to_corner, touch)
            distance[k], curvature[k] = sign * to_corner, bend
            gradient[k, 0], gradient[k, 1] = bend * (x - end_x[at]), bend * (y - end_y[at])
        elif line[on]:
            arm_x, arm_y = x - centre[on, 0], y - centre[on, 1]
            distance[k], curvature[k] = arm_x * tangent[on, 1] - arm_y * tangent[on, 0], 0.0
            gradient[k, 0], gradient[k, 1] = tangent[on, 1], -tangent[on, 0]
        else:
            arm_x, arm_y = x - centre[on, 0], y - centre[on, 1]
            length = hypot(arm_x, arm_y)
            bend = side[on] / max(length, 1e-15)
            distance[k], curvature[k] = side[on] * (length - radius[on]), bend
            gradient[k, 0], gradient[k, 1] = bend * arm_x, bend * arm_y
        if to_corner < touch and abs(kink[at]) > 1e-9:
            gradient[k, 0], gradient[k, 1], curvature[k] = (
                sin(bisector[at]),
                -cos(bisector[at]),
                0.0,
            )
    return looked

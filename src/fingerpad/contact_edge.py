"""Where contact ends, beside the last place that bears pressure."""

import math

import numpy as np

_EDGES = 3
"""Edges of the skin's elements from the contact's edge in, over which pressure is looked at."""
_HANKEL = np.add.outer(np.arange(3), np.arange(3))
"""Which power of x is in a row and column of the normal equations of a parabola."""


def edge_of(x: np.ndarray, pressure: np.ndarray, spacing: float, on_edge: int) -> float:
    """Where pressure falls to zero to the right of where it is known, m.

    Inside the edge of a smooth contact the pressure grows like the square root of the distance, its
    square evenly, and bends as the contact is wide (Johnson 1985, section 5.1): the edge is where a
    parabola through the squares vanishes, least squares over some elements, which weigh less and
    less to either side, so that it moves on evenly from point to point. Where pressure does not
    fall to the edge, as under an edge of the profile, contact ends half a spacing beyond the last
    point.

    Parameters
    ----------
    x
        (n,) m, ascending places of one contact.
    pressure
        (n,) Pa, above zero.
    spacing
        m, of the last places.
    on_edge
        How many of them there are to an edge of the skin's elements.
    """
    plain, reach = float(x[-1] + spacing / 2), _EDGES * on_edge * float(spacing)
    known = x > plain - reach - 4 * spacing  # further in there is no weight
    along, pressure = (x[known] - plain) / reach, pressure[known]
    powers = along ** np.arange(5)[:, None]
    squares = powers[:3] * pressure**2
    edge = plain
    for _ in range(4):
        inside = np.clip(along + (1 + (plain - edge) / reach), 0.0, 1.0)
        weight = inside**2 * pressure
        terms = min(np.count_nonzero(weight) - 1, 3)  # of a parabola, or of a line
        if terms < 2:
            return plain
        normal = (powers @ weight)[_HANKEL[:terms, :terms]]
        try:
            roots = _roots(*np.linalg.solve(normal, squares[:terms] @ weight).tolist())
        except np.linalg.LinAlgError:
            return plain
        near = [reach * root for root in roots if -4 * spacing < reach * root < 2 * spacing]
        if not near:
            return plain
        edge = plain + min(near, key=abs)
    return float(edge)


def _roots(height: float, slope: float, bend: float = 0.0) -> list[float]:
    """Real roots of ``height + slope x + bend x^2``."""
    inside = slope * slope - 4 * bend * height
    if inside < 0:
        return []
    q = -(slope + math.copysign(math.sqrt(inside), slope)) / 2
    if not q:
        return [0.0]
    return [height / q, q / bend] if bend else [height / q]

"""Where contact ends, beside the last place that bears pressure."""

import math

import numpy as np

_EDGES = 3
"""Edges of the skin's elements from the contact's edge in, over which pressure is looked at."""


def edge_of(x: np.ndarray, pressure: np.ndarray, spacing: float, on_edge: int) -> float:
    """Where pressure falls to zero to the right of where it is known, m.

    Inside the edge of a smooth contact the pressure grows like the square root of the distance, its
    square evenly, and bends as the contact is wide (Johnson 1985, section 5.1): the edge is where a
    parabola through the squares vanishes, least squares over some elements, which weigh less and
    less to either side, so that it moves on evenly from point to point. Where pressure does not
    fall to the edge, as under an edge of the profile, contact ends half a spacing beyond the last
    point.

    Args:
        x: (n,) m, ascending places of one contact. pressure: (n,) Pa, above zero. spacing: m, of
        the last places. on_edge: how many of them there are to an edge of the skin's elements.
    """
    plain, reach = float(x[-1] + spacing / 2), _EDGES * on_edge * float(spacing)
    known = x > plain - reach - 4 * spacing  # further in there is no weight
    x, pressure = x[known], pressure[known]
    edge, along = plain, (x - plain) / reach
    terms = np.array([np.ones_like(along), along, along * along, along**3, along**4])
    squares = terms[:3] * pressure**2
    for _ in range(4):
        weight = (
            np.minimum(np.maximum(along + (1 + (plain - edge) / reach), 0.0), 1.0) ** 2 * pressure
        )
        roots = _roots(*_parabola(terms @ weight, squares @ weight, np.count_nonzero(weight) - 2))
        near = [reach * root for root in roots if -4 * spacing < reach * root < 2 * spacing]
        if not near:
            return plain
        edge = plain + min(near, key=abs)
    return edge


def _parabola(moments, values, degree):
    """Coefficients, highest power first, of a parabola or line by least squares; none where there
    is none.

    moments: (5,) weighed sums of the powers of x. values: (3,) the same of the first three times y.
    degree: at most.
    """
    if degree < 1:
        return ()
    s0, s1, s2, s3, s4 = moments.tolist()
    y0, y1, y2 = values.tolist()
    if degree == 1:
        whole = s0 * s2 - s1 * s1
        return ((s0 * y1 - s1 * y0) / whole, (s2 * y0 - s1 * y1) / whole) if whole else ()
    a, b, d = s2 - s1 * s1 / s0, s3 - s2 * s1 / s0, s4 - s2 * s2 / s0
    if not a or not (last := d - b * b / a):
        return ()
    once, twice = y1 - s1 * y0 / s0, y2 - s2 * y0 / s0
    square = (twice - b * once / a) / last
    slope = (once - b * square) / a
    return square, slope, (y0 - s1 * slope - s2 * square) / s0


def _roots(*coefficients):
    """Real roots of a line or a parabola, highest power first; none of nothing."""
    if not coefficients:
        return []
    if len(coefficients) == 2 or not coefficients[0]:
        slope, height = coefficients[-2:]
        return [-height / slope] if slope else []
    a, b, c = coefficients
    inside = b * b - 4 * a * c
    if inside < 0:
        return []
    q = -(b + math.copysign(math.sqrt(inside), b)) / 2
    return [q / a, c / q] if q else [0.0]

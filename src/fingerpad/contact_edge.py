"""Where contact ends, beside the last place that bears pressure."""

import numpy as np

_EDGES = 3
"""Edges of the skin's elements from the contact's edge in, over which pressure is looked at."""


def edge_of(x: np.ndarray, pressure: np.ndarray, spacing: float, on_edge: int) -> float:
    """Where pressure falls to zero to the right of where it is known, m.

    Inside the edge of a smooth contact the pressure grows like the square root of the distance, its square evenly, and bends as
    the contact is wide (Johnson 1985, section 5.1): the edge is where a parabola through the squares vanishes, least squares over
    some elements, which weigh less and less to either side, so that it moves on evenly from point to point. Where pressure does
    not fall to the edge, as under an edge of the profile, contact ends half a spacing beyond the last point.

    Args:
        x: (n,) m, ascending places of one contact. pressure: (n,) Pa, above zero. spacing: m, of the last places.
        on_edge: how many of them there are to an edge of the skin's elements.
    """
    plain, reach = x[-1] + spacing / 2, _EDGES * on_edge * spacing
    edge, square = plain, pressure**2
    for _ in range(4):
        weight = np.clip(1 - (edge - x) / reach, 0, 1) ** 2 * pressure
        use = weight > 0
        degree = min(2, np.count_nonzero(use) - 2)
        if degree < 1:
            return float(plain)
        terms = np.vander((x[use] - plain) / reach, degree + 1)
        weighed = terms.T * weight[use]
        try:
            roots = _roots(*np.linalg.solve(weighed @ terms, weighed @ square[use]))
        except np.linalg.LinAlgError:
            return float(plain)
        near = [reach * root for root in roots if -4 * spacing < reach * root < 2 * spacing]
        if not near:
            return float(plain)
        edge = plain + min(near, key=abs)
    return float(edge)


def _roots(*coefficients):
    """Real roots of a line or a parabola, highest power first."""
    if len(coefficients) == 2 or not coefficients[0]:
        slope, height = coefficients[-2:]
        return [-height / slope] if slope else []
    a, b, c = coefficients
    inside = b * b - 4 * a * c
    if inside < 0:
        return []
    q = -(b + np.copysign(np.sqrt(inside), b)) / 2
    return [q / a, c / q] if q else [0.0]

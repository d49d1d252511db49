"""From forces on the skin to smoothed pressure and the edges of the contact."""

import numpy as np

_REACH = 12
"""Spacings of the contact's points from its edge in, over which pressure is looked at: three edges of the skin's elements."""


def smoothed_pressure(nodal_force, length, mirrored: bool) -> np.ndarray:
    """5-point (1, 2, 3, 2, 1) average of force over the same average of length, (ns,) Pa.

    ``mirrored``: the first node lies on a symmetry axis, beyond which the pattern continues; its force and length are halves.
    """
    kernel = np.array([1.0, 2.0, 3.0, 2.0, 1.0])

    def average(values):
        if mirrored:
            whole = np.concatenate([values[2:0:-1], [2 * values[0]], values[1:]])
            return np.convolve(np.pad(whole, (0, 2)), kernel, mode="valid")
        return np.convolve(np.pad(values, 2), kernel, mode="valid")

    smooth = average(nodal_force) / average(length)
    return np.where(nodal_force > 0, smooth, 0.0)


def contact_edges(x, pressure, spacing, mirrored: bool = False) -> tuple[float, float]:
    """Left and right edge of the contact (m), from outermost to outermost; (nan, nan) without contact.

    Args:
        x: (n,) m, lateral position of points of the skin in order. pressure: (n,) Pa. spacing: (n,) m between them. mirrored: the
            first one lies beside a symmetry axis at x = 0, beyond which the pattern continues.

    Inside the edge of a smooth contact the pressure grows like the square root of the distance, its square evenly, and bends as
    the contact is wide (Johnson 1985, section 5.1): the edge is where a parabola through the squares vanishes, least squares over
    some elements, which weigh less and less to either side, so that it moves on evenly from point to point. Where pressure does
    not fall to the edge, as under an edge of the profile, contact ends half a spacing beyond the last point.
    """
    if mirrored:
        x, pressure, spacing = (
            np.concatenate([sign * each[::-1], each]) for sign, each in ((-1, x), (1, pressure), (1, spacing))
        )
    on = np.flatnonzero(pressure > 0)
    if not len(on):
        return np.nan, np.nan
    run = np.split(on, np.flatnonzero(np.diff(on) > 1) + 1)
    left, right = run[0][::-1], run[-1]
    return -_edge(-x[left], pressure[left], spacing[left[-1]]), _edge(x[right], pressure[right], spacing[right[-1]])


def _edge(x, pressure, spacing):
    """Where the pressure (n,) at ascending places falls to zero on the right."""
    plain, reach = x[-1] + spacing / 2, _REACH * spacing
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
